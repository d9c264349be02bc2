"""Measured files to records: what every column becomes, what is refused, what is tidied, what is said."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from pin_wear import PIN_WEAR

from press_linkage import truing_models
from truing import Effect, Float, Model, Unknown, axis, found, given, inputs, results
from truing.declare.sources import Condition
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.errors import InputError
from truing.evaluate import evaluate_rows
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.setup import Setup, default_setup

PRESS = next(model for model in truing_models() if model.name == "press_linkage")
Read = Callable[..., Records]
Refused = Callable[..., list[str]]
PEAK = Condition("peak", "kN", derived="running_maximum of load")


@inputs
class Spring:
    """A spring of a kind, pressed."""

    kind: Literal["soft", "hard"] = given("soft", note="which spring")
    coils: int = given(4, note="active coils")
    is_wet: bool = given(False, note="oiled")
    force: Float = given(10.0, "N", at_least=0, at_most=1000, note="force")
    turn: Float = given(0.0, "deg", note="angle of the table")
    sizes: tuple[float, ...] = given((1.0, 2.0), note="sizes of the wire")
    cover: Float = given(None, "mm", note="cover, if there is one")


@results
class Pressed:
    """What the gauge shows."""

    travel: Float = found("mm", note="travel")


def pressed(spring: Spring) -> Pressed:
    """Ten newtons per millimetre and four coils, twice as much for the hard one."""
    rate = 1e4 * (2 if spring.kind == "hard" else 1) * 4 / spring.coils
    return Pressed(travel=spring.force / rate)


def creep(spring: Spring, *, slope: Float, peak: Float) -> Spring:
    """A spring that has been loaded is longer."""
    return replace(spring, force=spring.force + slope * peak)


SPRING = Model(
    name="spring",
    title="Spring",
    function=pressed,
    errors=[Effect("creep", on_inputs=creep, needs=[PEAK], unknowns=[Unknown("slope", -1, 1)], looks_like="a rest")],
)


@inputs
class Probe:
    """A probe pushed into something soft."""

    force: Float = given((1.0, 1.0), "N", note="force while it is pushed", along="depth")


@results
class Course:
    """Work over depth."""

    depth: Float = axis("mm", note="place")
    work: Float = found("J", note="work so far", along="depth")


def course(probe: Probe) -> Course:
    """A point every ten millimetres."""
    force = np.asarray(probe.force)
    return Course(depth=0.01 * np.arange(force.shape[-1]), work=np.cumsum(force, axis=-1) * 0.01)


PROBE = Model(name="probe", title="Probe", function=course)


def offer_of(model: Model) -> Offer:
    return Offer(model.name, model, Origin(model.name, "", "", "", f"module:{model.name}"))


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Read one text, or several as several files, for a model and an inputs file."""

    def records(model: Model, *texts: str | bytes, given_: str = "[inputs]\n") -> Records:
        paths = [tmp_path / f"{name}.csv" for name, _ in zip("abcdef", texts, strict=False)]
        for path, text in zip(paths, texts, strict=True):
            path.write_bytes(text.encode() if isinstance(text, str) else text)
        offer = offer_of(model)
        return read_records(paths, offer, setup_from_text(given_, offer, file="given.toml", folder=tmp_path))

    return records


@pytest.fixture
def refused(read: Read) -> Refused:
    """Return what is said against files as "FILE:LINE: sentence"."""

    def sentences(model: Model, *texts: str, given_: str = "[inputs]\n") -> list[str]:
        with pytest.raises(InputError) as caught:
            read(model, *texts, given_=given_)
        assert caught.value.exit_code == 2
        return [str(replace(fault, file=Path(fault.file).name)) for fault in caught.value.faults]

    return sentences


def said(records: Records, word: str) -> list[str]:
    return [note for note in records.notes if word in note]


# What the columns become

FULL = """crank_angle [deg],slider_position [mm],sigma_slider_position [um],forming_force [kN],link_temperature [degC]
180,2700,3,0,20
90,3000,3,100,30
-90,3000,4,200,40
"""


def test_every_column_in_si_in_its_part(read: Read) -> None:
    records = read(PRESS, FULL)
    assert len(records) == 3
    np.testing.assert_allclose(records.rows.columns["crank_angle"], [np.pi, np.pi / 2, -np.pi / 2])
    np.testing.assert_allclose(records.rows.columns["forming_force"], [0, 1e5, 2e5])
    np.testing.assert_allclose(records.rows.columns["link_temperature"], [293.15, 303.15, 313.15])
    assert list(records.measured) == ["slider_position"]
    np.testing.assert_allclose(records.measured["slider_position"], [2.7, 3, 3])
    np.testing.assert_allclose(records.sigma["slider_position"], [3e-6, 3e-6, 4e-6])
    assert records.lines.tolist() == [2, 3, 4]
    assert records.file_of.tolist() == records.run_of.tolist() == [0, 0, 0]
    assert records.absent == {"time", "strokes", "speed", "direction"}
    assert not records.held_out.any()
    assert records.unit_errors == ()


def test_choices_counts_and_switches_split_the_rows(read: Read) -> None:
    text = "kind,coils,is_wet,force [N],travel [mm]\nsoft,4,no,10,1\nhard,4,yes,10,0.5\nsoft,8,no,10,2\n"
    records = read(SPRING, text)
    assert records.rows.columns["kind"] == ["soft", "hard", "soft"]
    assert records.rows.columns["coils"] == [4, 4, 8]
    assert records.rows.columns["is_wet"] == [False, True, False]
    assert list(records.covariates) == ["force", "coils", "order"]
    np.testing.assert_array_equal(records.covariates["coils"].values, [4, 4, 8])


def test_an_input_that_may_be_left_open_may_be_empty(read: Read) -> None:
    records = read(SPRING, "cover [mm],travel [mm]\n1,1\n,1.1\n2,1.2\n")
    np.testing.assert_allclose(records.rows.columns["cover"], [1e-3, np.nan, 2e-3])
    assert len(records) == 3


def test_a_record_is_a_run_with_its_series_and_places(read: Read) -> None:
    text = "run,depth [mm],force [N],work [J]\na,0,1,0.01\na,10,2,0.03\nb,0,5,0.05\nb,10,5,\nb,20,5,0.15\n"
    records = read(PROBE, text)
    np.testing.assert_array_equal(records.rows.series["force"], [1, 2, 5, 5, 5])
    np.testing.assert_allclose(records.rows.axes["depth"], [0, 0.01, 0, 0.01, 0.02])
    assert records.run_of.tolist() == [0, 0, 1, 1, 1]
    np.testing.assert_allclose(records.measured["work"], [0.01, 0.03, 0.05, np.nan, 0.15])
    assert said(records, "missing") == ["'work' is missing in 1 of 5 rows"]
    assert records.covariates["depth"].role == "other"


def test_rows_beyond_the_axis_measure_nothing_there(read: Read) -> None:
    records = read(PROBE, "depth [mm],force [N],work [J]\n0,1,0.01\n10,2,0.03\n20,2,0.05\n75,2,0.05\n")
    np.testing.assert_allclose(records.measured["work"], [0.01, 0.03, 0.05, np.nan])
    assert said(records, "axis") == ["'work' is not used in 1 row that its axis does not reach"]


def test_a_standard_deviation_of_nothing_is_none(read: Read) -> None:
    records = read(PIN_WEAR, "depth [um],sigma_depth [um],sigma_pressure [MPa]\n1,0,1\n2,0.5,1\n3,,1\n")
    assert list(records.sigma) == ["depth"]
    np.testing.assert_allclose(records.sigma["depth"], [np.nan, 5e-7, np.nan])
    assert said(records, "sigma") == [
        "column 'sigma_pressure' is of a result that is not measured and is not used",
        "'sigma_depth' is 0 in 1 row, which no gauge is; it counts as not given there",
    ]


# What is refused

ANGLES = "crank_angle [deg],slider_position [mm]\n1,2700\n2,2700\n3,2700\n"
NEEDED = "a diagnosis needs 3 rows at the very least, better fifty"
PIN_RESULTS = "pressure [MPa], distance [km], depth [um]"


@pytest.mark.parametrize(
    ("model", "text", "expected"),
    [
        (
            PIN_WEAR,
            "time [h],load [N]\n1,2\n2,3\n3,4\n",
            [f"a.csv:1: no column is a result of pin_wear, so nothing is measured; it could be {PIN_RESULTS}."],
        ),
        (
            PIN_WEAR,
            "time [h],dpeth [um]\n1,2\n2,3\n3,4\n",
            [
                f"a.csv:1: no column is a result of pin_wear, so nothing is measured; it could be {PIN_RESULTS}."
                " Did you mean 'depth'?"
            ],
        ),
        (
            PIN_WEAR,
            "time [h],depth [ym]\n1,2\n2,3\n3,4\n",
            ["a.csv:1: column 'depth [ym]': unknown unit 'ym'; did you mean 'm'?"],
        ),
        (
            PIN_WEAR,
            "time [h],depth [um],hum [foo]\n1,2,1\n2,3,1\n3,4,1\n",
            ["a.csv:1: column 'hum': unknown unit 'foo'; leave the brackets out where a number has no unit"],
        ),
        (
            PIN_WEAR,
            "time,depth [N]\n1,2\n2,3\n3,4\n",
            [
                "a.csv:1: column 'time' has no unit; it is a time: write 'time [h]'",
                "a.csv:1: column 'depth [N]': 'N' is a force (N), expected a length (µm)",
            ],
        ),
        (PIN_WEAR, "depth [um]\n1\n2\n", [f"a.csv:3: holds two rows; {NEEDED}"]),
        (PIN_WEAR, "depth [um]\n1\n", [f"a.csv:2: holds one row; {NEEDED}"]),
        (PIN_WEAR, "depth [um]\n", ["a.csv:1: holds a header but no rows"]),
        (
            PIN_WEAR,
            "load [N],depth [um]\n,1\nNaN,2\n,3\n",
            ["a.csv:1: column 'load' holds no value in any row; fill it or leave it out"],
        ),
        (
            PIN_WEAR,
            "load [N],depth [um],pressure [MPa]\n1,1,nan\n2,2,\n3,3,n/a\n",
            ["a.csv:1: column 'pressure' holds no value in any row; fill it or leave it out"],
        ),
        (
            PIN_WEAR,
            "load [N],depth [um],hardness [foo]\nx,1,1\n-2,2,1\n3,inf,1\n",
            [
                "a.csv:1: column 'hardness [foo]': unknown unit 'foo'",
                "a.csv:2: load: 'x' is no number",
                "a.csv:3: load is -2 N; it must be above 0 N",
                "a.csv:4: depth: 'inf' is not a finite number",
            ],
        ),
        (SPRING, "kind,travel [mm]\nsoft,1\nsfot,2\nhard,3\n", [
            "a.csv:3: kind = 'sfot' is not offered; choose 'soft' or 'hard'. Did you mean 'soft'?",
        ]),
        (PROBE, "force [N],work [J]\n1,1\n2,2\n3,3\n", [
            "a.csv:1: work runs along 'depth'; give the place of each row in a column 'depth [mm]'",
        ]),
        (SPRING, "load [kg],travel [mm]\n1,1\n2,2\n3,3\n", [
            "a.csv:1: column 'load [kg]': 'kg' is a mass (kg), expected a force (kN)",
        ]),
        (PIN_WEAR, "sigma_depth [um],depth [um]\n-1,1\n1,2\n1,3\n", [
            "a.csv:2: sigma_depth: a standard deviation is 0 or more",
        ]),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused(refused: Refused, model: Model, text: str, expected: list[str]) -> None:
    assert refused(model, text) == expected


def test_too_few_rows_say_where_the_others_are(refused: Refused) -> None:
    rows = "load [N],depth [um]\n1,1\n2,2\n,3\n"
    (sentence,) = refused(PIN_WEAR, rows)
    assert sentence.startswith("a.csv: two rows can be used; a diagnosis needs 3 rows")
    assert "1 row is left out where 'load' is empty" in sentence
    assert refused(PIN_WEAR, "depth [um]\n1\n", "depth [um]\n2\n") == [f"the files hold two rows together; {NEEDED}"]


def test_a_result_without_values_in_the_rows_that_are_left(read: Read, refused: Refused) -> None:
    text = "load [N],depth [um],pressure [MPa]\n1,1,\n2,2,\n3,3,1\n,4,4\n,4,5\n,4,6\n"
    records = read(PIN_WEAR, text)
    assert list(records.measured) == ["depth"]
    assert said(records, "too few") == ["'pressure' is not used: 1 value is too few"]
    (sentence,) = refused(PROBE, "depth [mm],force [N],work [J]\n0,1,0.01\n10,2,\n20,2,0.05\n75,2,0.05\n")
    assert sentence.startswith("a.csv: two rows can be used; ")
    assert "'work' is not used in 1 row that its axis does not reach" in sentence


@pytest.mark.parametrize(("count", "used"), [(5, False), (6, True)])
def test_a_result_measured_a_few_times_beside_another_is_left_out(read: Read, count: int, used: bool) -> None:
    """From five values nobody tells noise from cause: some cause among many fits them exactly."""
    rows = [f"{load},{load + load % 3},{load if load <= count else ''}" for load in range(1, 21)]
    records = read(PIN_WEAR, "\n".join(["load [N],depth [um],pressure [MPa]", *rows, ""]))
    assert list(records.measured) == (["depth", "pressure"] if used else ["depth"])
    few = "'pressure' is not used: 5 values are too few to tell its noise; measure it 6 times or more"
    assert said(records, "too few") == ([] if used else [few])


def test_rows_that_all_fail_hint_at_the_unit(refused: Refused) -> None:
    """The contact flows above 58.8 kN: loads in newtons under a header in kilonewtons."""
    (sentence,) = refused(PIN_WEAR, "load [kN],depth [um]\n100,1\n110,2\n120,3\n")
    assert "3 rows are left out where the model fails" in sentence
    assert "a.csv:2: the contact flows: load exceeds hardness times area" in sentence
    assert "the model works where column 'load [kN]' is multiplied by 0.001: is its unit right?" in sentence


# What is tidied, counted and said


def test_rows_that_are_alike_are_real_repeats(read: Read) -> None:
    """A gauge that shows whole micrometres repeats itself: three of eight rows stand there twice, and all count."""
    text = "load [N],depth [um],who\n100,1,me\n100,1.0,me\n100,1,you\n100,,me\n100,,me\n1e2,1,me\n100,-0,me\n100,0,me\n"
    records = read(PIN_WEAR, text)
    assert said(records, "nothing was measured") == ["2 rows are left out where nothing was measured"]
    assert records.lines.tolist() == [2, 3, 4, 7, 8, 9]


@pytest.mark.parametrize(
    ("times", "left_out"),
    [
        ("1 2 3 4 2 3 4 5", [6, 7, 8]),  # a logger wrote its last three rows again
        ("1 2 3 4 1 2 3 4", [6, 7, 8, 9]),  # a file pasted behind itself
        ("1 2 3 3 1 2 3 3", [6, 7, 8, 9]),  # with two rows alike inside
        ("1 2 3 4 3 4 5 6", []),  # two rows may be chance
        ("1 1 1 2 2 2 3 3", []),  # a coarse clock and a coarse gauge
        ("2 2 2 1 2 2 2 3", []),  # no block: its clock stands still
        ("1 2 3 9 1 2 4 3", []),  # in another order
    ],
)
def test_a_block_of_rows_that_was_written_twice_is_left_out(read: Read, times: str, left_out: list[int]) -> None:
    """The depth is that of the time; another run behind show that nothing else is touched."""
    rows = [f"a,{time},{int(time) // 2},x" for time in times.split()]
    more = [f"b,{time},{time % 4},y" for time in range(30)]
    records = read(PIN_WEAR, "\n".join(["run,time [h],depth [um],who", *rows, *more, ""]))
    assert sorted({*range(2, 40)} - {*records.lines.tolist()}) == left_out
    words = f"{len(left_out)} rows are left out: in a block that repeats an earlier one in every cell, times included"
    assert said(records, "repeat") == ([words] if left_out else [])


def test_rows_are_sorted_by_time_inside_each_run(read: Read) -> None:
    text = "run,time [h],depth [um]\nb,7,1\na,1,2\nb,5,3\na,3,4\na,2,5\nb,6,6\n"
    records = read(PIN_WEAR, text)
    assert records.lines.tolist() == [3, 6, 5, 4, 7, 2]
    assert records.run_of.tolist() == [0, 0, 0, 1, 1, 1]
    assert said(records, "order") == ["3 rows were out of order and sorted by time inside the run"]


def test_time_and_strokes_count_from_the_first_row_of_each_file(read: Read) -> None:
    text = "run,time [h],strokes,slider_position [mm]\nx,{0},{1},2700\nx,{2},{3},2700\ny,{4},{5},2700\n"
    records = read(PRESS, text.format(5, 1000, 5.5, 1100, 7, 1600), text.format(2, 10, 1, 4, 3, 20))
    np.testing.assert_allclose(records.rows.columns["time"], 3600 * np.array([0, 0.5, 2, 0, 1, 2]))
    np.testing.assert_allclose(records.rows.columns["strokes"], [0, 100, 600, 0, 6, 16])
    assert records.covariates["time"].role == "time"
    assert records.run_of.tolist() == [0, 0, 1, 2, 2, 3]
    assert records.file_of.tolist() == [0, 0, 0, 1, 1, 1]
    assert len(set(records.rows.runs)) == 4


def test_a_history_is_made_before_rows_are_left_out(read: Read) -> None:
    """The second row, whose force is missing, had the highest load."""
    text = "load [kN],force [N],travel [mm]\n1,10,1\n9,,1\n3,10,1\n4,10,1\n"
    records = read(SPRING, text)
    np.testing.assert_allclose(records.rows.columns["peak"], [1e3, 9e3, 9e3])
    assert records.lines.tolist() == [2, 4, 5]
    assert "peak" not in records.absent


@pytest.mark.parametrize(
    ("turns", "expected"),
    [
        ("350 355 0 5 10", [350, 355, 360, 365, 370]),
        ("170 175 -180 -175 -170", [170, 175, 180, 185, 190]),
        ("-170 -175 180 175 170", [-170, -175, -180, -185, -190]),
        ("0 60 120 180 240 300 0 60 120", [0, 60, 120, 180, 240, 300, 360, 420, 480]),
        ("10 20 30 40 50", None),
        ("0 100 200 300 40", None),
        ("10 300 20 250 5", None),
        ("350 20 340 30 10 355 15", None),
    ],
)
def test_sweeps_are_joined_at_a_turn(read: Read, turns: str, expected: Sequence[float] | None) -> None:
    angles = turns.split()
    text = "turn [deg],travel [mm]\n" + "".join(f"{angle},{place}\n" for place, angle in enumerate(angles))
    records = read(SPRING, text)
    wanted = [float(angle) for angle in angles] if expected is None else expected
    np.testing.assert_allclose(np.degrees(records.rows.columns["turn"]), wanted, atol=1e-9)
    assert len(said(records, "jumps by a turn at 1 place of a sweep")) == (expected is not None)


def test_each_run_is_joined_alone(read: Read) -> None:
    text = "run,turn [deg],travel [mm]\na,355,1\nb,0,1\na,5,1\nb,5,1\na,15,1\na,25,1\na,35,1\nb,10,1\n"
    records = read(SPRING, text)
    np.testing.assert_allclose(np.degrees(records.rows.columns["turn"]), [355, 365, 375, 385, 395, 0, 5, 10])


def test_missing_cells(read: Read) -> None:
    text = "crank_angle [deg],forming_force [kN],speed [rpm],slider_position [mm],slider_tilt [urad]\n"
    rows = [
        "1,100,,2700,5",
        "2,,20,2700,5",
        ",100,,2700,",
        "4,100,,2700,nan",
        "5,100,,2700,5",
        "6,100,30,,",
        "7,100,,2700,5",
    ]
    records = read(PRESS, text + "\n".join(rows) + "\n")
    assert records.lines.tolist() == [2, 5, 6, 8]
    np.testing.assert_allclose(records.measured["slider_tilt"], [5e-6, np.nan, 5e-6, 5e-6])
    assert "speed" in records.absent
    assert "speed" not in records.rows.columns
    assert "speed" not in records.covariates
    assert said(records, "empty") == [
        "'speed' is empty in 5 of 7 rows, so it counts as not measured",
        "1 row is left out where 'crank_angle' is empty",
        "1 row is left out where 'forming_force' is empty",
    ]
    assert said(records, "missing") == ["'slider_tilt' is missing in 1 of 4 rows"]


def test_rows_where_the_model_fails_are_left_out(read: Read) -> None:
    records = read(PIN_WEAR, "load [kN],depth [um]\n0.1,1\n100,2\n0.2,3\n0.3,4\n90,5\n")
    assert records.lines.tolist() == [2, 4, 5]
    (note,) = said(records, "fails")
    assert note.startswith("2 rows are left out where the model fails; the first is ")
    assert note.endswith("a.csv:3: the contact flows: load exceeds hardness times area")


def test_a_condition_that_is_not_measured(read: Read) -> None:
    records = read(PRESS, ANGLES)
    assert records.absent == {"time", "strokes", "speed", "direction", "forming_force", "link_temperature"}
    (note,) = said(records, "not measured")
    assert "'forming_force'" in note
    stated = read(PRESS, ANGLES, given_='[conditions]\nforming_force = "300 kN"\nspeed = "0 rpm"\n')
    assert stated.absent == records.absent - {"forming_force"}
    np.testing.assert_allclose(stated.rows.columns["forming_force"], [3e5] * 3)
    assert stated.covariates["forming_force"].is_constant


def test_what_one_file_does_not_measure(read: Read) -> None:
    """An input is as the inputs file says; a condition counts as not measured; another column is missing there."""
    records = read(
        PRESS,
        "crank_angle [deg],forming_force [kN],oil [degC],slider_position [mm]\n1,1,40,2700\n2,2,40,2700\n",
        "slider_position [mm],slider_tilt [urad]\n2700,1\n2700,2\n2700,3\n",
        given_='[inputs]\ncrank_angle = "30 deg"\n',
    )
    np.testing.assert_allclose(np.degrees(records.rows.columns["crank_angle"]), [1, 2, 30, 30, 30])
    assert "forming_force" in records.absent
    np.testing.assert_allclose(records.covariates["oil"].values, [313.15, 313.15] + [np.nan] * 3)
    np.testing.assert_allclose(records.measured["slider_tilt"], [np.nan, np.nan, 1e-6, 2e-6, 3e-6])
    (note,) = said(records, "is not in")
    assert note.startswith("'forming_force' is not in ")
    assert note.endswith("b.csv, so it counts as not measured")


def test_a_file_that_is_given_twice_is_read_once(tmp_path: Path) -> None:
    path, offer = tmp_path / "a.csv", offer_of(PRESS)
    path.write_text(ANGLES)
    setup = setup_from_text("[inputs]\n", offer, file="given.toml", folder=tmp_path)
    records = read_records([path, tmp_path / ".." / tmp_path.name / "a.csv"], offer, setup)
    assert len(records) == 3
    assert records.files == (str(path),)
    assert records.notes[0] == "1 file is given twice and read once"


def test_columns_of_one_name_and_another_kind(refused: Refused) -> None:
    first, second = "depth [um],hum [m]\n1,2\n2,3\n", "depth [um],hum [kg]\n3,2\n4,3\n"
    (sentence,) = refused(PIN_WEAR, first, second)
    assert sentence.startswith("b.csv: column 'hum' is in [kg], but in [m] in ")


# What an error may depend on


def test_covariates(read: Read) -> None:
    text = (
        "record,turn,crank_angle [rad],time [min],oil temperature [degF],direction,slider_position [mm]\n"
        "a,1,0.1,0,68,1,2700\na,2,0.2,30,86,1,2700\nb,3,0.3,60,104,1,2700\n"
    )
    records = read(PRESS, text)
    kinds = {name: (item.unit, item.role, item.is_angle) for name, item in records.covariates.items()}
    assert kinds == {
        "crank_angle": ("deg", "input", True),
        "time": ("h", "time", False),
        "direction": ("", "condition", False),
        "turn": ("", "other", False),
        "oil temperature": ("degF", "other", False),
    }
    np.testing.assert_allclose(records.covariates["oil temperature"].values, [293.15, 303.15, 313.15])
    assert said(records, "never changes") == [
        "1 column never changes, so nothing can be seen of what depends on it: 'direction'"
    ]
    assert said(records, "'turn'") == [
        "column 'turn' is neither input, result nor condition; it is kept as something an error may depend on"
    ]
    assert "'record'" in said(records, "kept as words")[0]


def test_without_time_the_place_in_the_record_stands_for_it(read: Read) -> None:
    records = read(PRESS, ANGLES)
    assert records.covariates["order"].role == "order"
    np.testing.assert_array_equal(records.covariates["order"].values, [0, 1, 2])
    named = read(PRESS, "order,slider_position [mm]\n5,2700\n6,2700\n7,2700\n")
    assert named.covariates["order"].role == "other"
    assert named.covariates["row order"].role == "order"


def test_the_time_of_a_model_is_time(read: Read) -> None:
    records = read(PIN_WEAR, "time [h],depth [um]\n3,1\n5,2\n4,2\n")
    assert records.covariates["time"].role == "time"
    np.testing.assert_allclose(records.covariates["time"].values, [10800, 14400, 18000])
    assert "order" not in records.covariates


def test_a_misspelt_column_is_kept_with_a_hint(read: Read) -> None:
    records = read(PRESS, "crank_angel [deg],slider_position [mm]\n1,2700\n2,2700\n3,2700\n")
    assert said(records, "crank_angel")[0].endswith("Did you mean 'crank_angle'?")


# Rows that only judge


def test_rows_held_out(read: Read) -> None:
    text = "record,batch,depth [um]\nfit,1,1\nvalidation,1,2\nfit,1,3\nfit,2,4\nvalidation,2,5\n"
    given_ = '[studies.diagnose]\nhold_out = "{}"\n'
    records = read(PIN_WEAR, text, given_=given_.format("record = validation"))
    assert records.held_out.tolist() == [False, True, False, False, True]
    assert said(records, "judge") == ["2 rows only judge: record = validation"]
    by_number = read(PIN_WEAR, text, given_=given_.format("batch = 2"))
    assert by_number.held_out.tolist() == [False, False, False, True, True]


@pytest.mark.parametrize(
    ("hold_out", "expected"),
    [
        ("record = valid", "given.toml:2: hold_out: no row has 'valid' in the column 'record'"),
        ("recrod = x", "given.toml:2: hold_out: no file has a column 'recrod'. Did you mean 'record'?"),
        ("record = fit", "a.csv: two rows can be used; "),
    ],
)
def test_rows_that_cannot_be_held_out(refused: Refused, hold_out: str, expected: str) -> None:
    text = "record,depth [um]\nfit,1\nvalidation,2\nfit,3\nfit,4\nvalidation,5\n"
    (sentence,) = refused(PIN_WEAR, text, given_=f'[studies.diagnose]\nhold_out = "{hold_out}"\n')
    assert sentence.startswith(expected)


def test_columns_that_cannot_change_are_refused(refused: Refused) -> None:
    assert refused(SPRING, "coils [mm],sizes,travel [mm]\n1,1,1\n2,2,2\n3,3,3\n") == [
        "a.csv:1: column 'coils' has the unit [mm], but it is no quantity; write 'coils'",
        "a.csv:1: sizes cannot change from row to row; state it in the inputs file",
    ]


# Units written wrong in a header: found with the factor that sets them right, and never where nothing is wrong.

ROWS = 60
Columns = Mapping[str, NDArray[np.float64]]
HEATED = '[effects.link_heating]\nexpansion = "11 um/(m*K)"\n'


def read_columns(folder: Path, model: Model[Any, Any], columns: Columns, text: str = "[inputs]\n") -> Records:
    path, offer = folder / "a.csv", offer_of(model)
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return read_records([path], offer, setup_from_text(text, offer, file="given.toml", folder=folder))


def strokes_of_a_press() -> tuple[Setup, NDArray[np.float64], NDArray[np.float64]]:
    """Crank angles in degrees, and slider positions in millimetres with a noise of 50 um."""
    rng = np.random.default_rng(11)
    setup = default_setup(PRESS)
    angles = rng.uniform(-150, 150, ROWS)
    found = evaluate_rows(setup, {"crank_angle": np.radians(angles)}, ROWS, wanted=["slider_position"])
    return setup, angles, found.results["slider_position"] * 1e3 + rng.normal(0, 0.05, ROWS)


def unit_errors(records: Records) -> list[tuple[str, float]]:
    return [(unit_error.column, unit_error.factor) for unit_error in records.unit_errors]


ANGLE, HEIGHT, TILT = "crank_angle [deg]", "slider_position [mm]", "slider_tilt [urad]"
WARMTH = "link_temperature [degC]"


FORCE = np.linspace(5, 900, ROWS)
WILD = 1e7 * (np.arange(ROWS) % 11 == 0)
FAR_OFF = 9e9 * (np.arange(ROWS) % 15 == 0)


@pytest.mark.parametrize(
    ("made", "expected", "words"),
    [
        (lambda angle, height: {ANGLE: angle, HEIGHT: height}, {}, ""),
        (lambda angle, height: {ANGLE: angle, "slider_position [m]": height}, {"slider_position": 1e-3}, ""),
        (lambda angle, height: {ANGLE: angle, "slider_position [um]": height}, {"slider_position": 1e3}, ""),
        (lambda angle, height: {ANGLE: angle, HEIGHT: height * 1e-6}, {"slider_position": 1e6}, ""),
        (lambda angle, height: {ANGLE: angle, HEIGHT: height * 1e6}, {"slider_position": 1e-6}, ""),
        (lambda angle, height: {ANGLE: angle, HEIGHT: height / 25.4}, {"slider_position": 25.4}, ""),
        (lambda angle, height: {ANGLE: angle, "slider_position [in]": height}, {"slider_position": 1 / 25.4}, ""),
        (
            lambda angle, height: {"crank_angle [rad]": angle, HEIGHT: height}, {"crank_angle": math.pi / 180},
            "'crank_angle [rad]' is probably wrong: multiply it by pi/180 (degrees, not radians)",
        ),
        (lambda angle, height: {ANGLE: np.radians(angle), HEIGHT: height}, {"crank_angle": 180 / math.pi}, ""),
        (
            lambda angle, height: {ANGLE: angle * 1e-3, HEIGHT: height}, {"crank_angle": 1e3},
            "mm off 'slider_position' instead of",
        ),
        # a gauge that was set to zero somewhere
        (lambda angle, height: {ANGLE: angle, HEIGHT: height - height.mean()}, {}, ""),
        (
            lambda angle, height: {ANGLE: angle, "slider_position [um]": height - height.mean()},
            {"slider_position": 1e3}, "about its middle",
        ),
        # what is merely wrong: an offset, a tilt where the drawing has none, wild readings
        (lambda angle, height: {ANGLE: angle, HEIGHT: height + WILD + 5, TILT: 3000 + 0.1 * angle}, {}, ""),
        (lambda angle, height: {ANGLE: angle, HEIGHT: height + WILD + 300, TILT: 3000 + 0.1 * angle}, {}, ""),
        (lambda angle, height: {ANGLE: angle, "slider_position [m]": height + FAR_OFF}, {"slider_position": 1e-3}, ""),
        # the forming force can be set from -200 to 2000 kN; newtons under kilonewtons lie far outside
        (lambda angle, height: {ANGLE: angle, HEIGHT: height, "forming_force [kN]": FORCE}, {}, ""),
        (
            lambda angle, height: {ANGLE: angle, HEIGHT: height, "forming_force [kN]": FORCE * 1e3},
            {"forming_force": 1e-3}, "it can be set from -200 to 2000 kN",
        ),
        # beyond its range and with an effect on, yet a thousand times 20 degrees is no other unit of the same
        (lambda angle, height: {ANGLE: angle, HEIGHT: height, WARMTH: np.full(ROWS, 2e4)}, {}, ""),
    ],
)  # fmt: skip
def test_slips_of_a_press(
    tmp_path: Path, made: Callable[..., Columns], expected: Mapping[str, float], words: str
) -> None:
    """They are named in words, and nothing is changed."""
    columns = made(*strokes_of_a_press()[1:])
    records = read_columns(tmp_path, PRESS, columns, HEATED if WARMTH in columns else "[inputs]\n")
    assert dict(unit_errors(records)) == pytest.approx(expected, rel=1e-12)
    assert all(words in unit_error.text for unit_error in records.unit_errors)
    if ANGLE in columns:
        np.testing.assert_allclose(records.rows.columns["crank_angle"], np.radians(columns[ANGLE]), rtol=1e-12)


def test_a_sweep_in_degrees_under_radians_is_not_joined(tmp_path: Path) -> None:
    """Steps of 5 rad look like jumps by a turn."""
    setup, _, _ = strokes_of_a_press()
    angles = np.arange(-150.0, 150.0, 5.0)
    found = evaluate_rows(setup, {"crank_angle": np.radians(angles)}, ROWS, wanted=["slider_position"])
    heights = found.results["slider_position"] * 1e3
    records = read_columns(tmp_path, PRESS, {"crank_angle [rad]": angles, HEIGHT: heights})
    np.testing.assert_allclose(records.rows.columns["crank_angle"], angles)
    assert unit_errors(records) == [("crank_angle", pytest.approx(math.pi / 180))]


def pins() -> dict[str, NDArray[np.float64]]:
    """Pressure and depth by hand: load over 28 mm^2; 3e-8 * p * 0.5 m/s * t / 2.1 GPa."""
    rng = np.random.default_rng(8)
    load, time = rng.uniform(50, 200, ROWS), rng.uniform(100, 500, ROWS)
    pressure = load / 28
    depth = 3e-8 * pressure * 0.5 * time * 3600 / 2100 * 1e6
    return {"load [N]": load, "time [h]": time, "pressure [MPa]": pressure, "depth [um]": depth}


def renamed(columns: Columns, old: str, new: str) -> dict[str, NDArray[np.float64]]:
    return {new if name == old else name: values for name, values in columns.items()}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("load [N]", "load [N]", []),
        ("pressure [MPa]", "pressure [kPa]", [("pressure", 1e3)]),
        ("depth [um]", "depth [mm]", [("depth", 1e-3)]),
        ("load [N]", "load [mN]", [("load", 1e3)]),
    ],
)
def test_one_slip_that_explains_two_results_is_that_of_the_input(
    tmp_path: Path, old: str, new: str, expected: list[tuple[str, float]]
) -> None:
    assert unit_errors(read_columns(tmp_path, PIN_WEAR, renamed(pins(), old, new))) == expected
