"""What the gauge would show: one machine, its calibration in place, readings acting, records along an axis."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from pin_wear import PIN_WEAR

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Tolerance,
    Unknown,
    axis,
    column,
    drawn,
    found,
    given,
    inputs,
    loaded,
    results,
)
from truing.errors import DeclarationError, InputError, UsageError
from truing.gauge import Shown, one_machine, read_by_gauge, read_trials, shown_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.measurements import RowsFile, read_rows
from truing.measurements.derived import derive
from truing.setup import Setup, SwitchedOn, effect_column
from truing.studies.sampling import scatter_of


@inputs
class Wall:
    """A wall of two layers that is heated from one side; the probe is pushed into it."""

    flux: Float = given(10.0, "W/m^2", symbol="q", note="heat flux")
    outside: Float = given(20.0, "degC", symbol="T_0", note="outside temperature")
    pressing: Float = given((1.0, 1.0), "N", symbol="F", note="force while it is pushed", along="depth")
    note: str = given("dry", note="what the wall is")


@results
class Course:
    """Temperature over depth."""

    depth: Float = axis("mm", note="place in the wall")
    temperature: Float = found("degC", symbol="T", note="temperature there", along="depth")
    work: Float = found("N", symbol="W", note="force there", along="depth")
    inside: Float = found("degC", symbol="T_1", note="temperature at the far side")


def wall(given_: Wall) -> Course:
    """Conductivity is 1 W/(m K), thickness 100 mm, as many points as the record has."""
    points = np.linspace(0.0, 0.1, np.shape(given_.pressing)[-1])
    temperature = column(given_.outside) + column(given_.flux) * points
    return Course(
        depth=points,
        temperature=temperature,
        work=given_.pressing * np.ones_like(temperature),
        inside=given_.outside + given_.flux * 0.1,
    )


def dirt(given_: Wall, base: Course, *, offset: Float) -> Course:
    """The probe reads warmer by a constant."""
    return replace(base, inside=base.inside + offset)


WALL = Model(
    name="wall",
    title="Heated wall",
    function=wall,
    errors=[Effect("dirt", on_reading=dirt, unknowns=[Unknown("offset", -5, 5, "K")], looks_like="a constant")],
)


def offer_of(model: Model[Any, Any]) -> Offer:
    return Offer(model.name, model, Origin(model.name, "1.0", "", "", f"module:{model.name}"))


def rows_for(model: Model[Any, Any], folder: Path, text: str, stated: str = "[inputs]\n") -> tuple[Setup, RowsFile]:
    """Read rows for a model."""
    (folder / "rows.csv").write_text(text)
    setup = setup_from_text(stated, offer_of(model), file="given.toml", folder=folder)
    return setup, read_rows(folder / "rows.csv", offer_of(model), setup)


Gauge = Callable[..., Shown]


@pytest.fixture
def gauge(tmp_path: Path) -> Gauge:
    """Read rows for a model and return what its gauge shows."""

    def show(model: Model[Any, Any], rows: str, stated: str = "[inputs]\n") -> Shown:
        return shown_by_gauge(*rows_for(model, tmp_path, rows, stated))

    return show


def test_rows_replace_inputs_and_come_back_in_printed_units(gauge: Gauge) -> None:
    """Pressure is load over area: 240 N and 120 N on 28 mm^2."""
    shown = gauge(PIN_WEAR, "load [kN]\n0.24\n\n", '[units]\npressure = "kPa"\n')
    np.testing.assert_allclose(shown.values["pressure"], [240e3 / 28])
    assert shown.units["pressure"] == "kPa"
    assert set(shown.values) == {"pressure", "distance", "depth"}


def test_results_along_an_axis_are_read_at_the_place_of_the_row(gauge: Gauge) -> None:
    rows = "depth [mm],flux [W/m^2]\n0,10\n50,10\n50,30\n100,10\n101,10\n,10\n"
    shown = gauge(WALL, rows, '[inputs]\npressing = ["1 N", "1 N", "1 N"]\n')
    np.testing.assert_allclose(shown.values["temperature"], [20, 20.5, 21.5, 21, np.nan, np.nan])
    np.testing.assert_allclose(shown.values["inside"], [21, 21, 23, 21, 21, 21])
    assert "depth" not in shown.values
    assert shown.reasons == {
        4: "'temperature' cannot be read at this row: it lies beyond the axis 'depth'",
        5: "'temperature' cannot be read at this row: 'depth' is not given",
    }


def test_without_a_place_results_along_an_axis_are_left_out(gauge: Gauge) -> None:
    shown = gauge(WALL, "flux [W/m^2]\n10\n", '[effects.dirt]\noffset = "2 K"\n')
    assert set(shown.values) == {"inside"}
    np.testing.assert_allclose(shown.values["inside"], [23])


def test_the_rows_of_a_run_are_one_record(gauge: Gauge) -> None:
    """Two runs of three and two rows: the force comes back at its own place, mixed as the rows are."""
    rows = "run,depth [mm],pressing [N],flux [W/m^2]\na,0,1,10\nb,0,7,20\na,50,2,10\nb,100,8,20\na,100,3,10\n"
    shown = gauge(WALL, rows)
    np.testing.assert_allclose(shown.values["work"], [1, 7, 2, 8, 3])
    np.testing.assert_allclose(shown.values["temperature"], [20, 20, 20.5, 22, 21])
    np.testing.assert_allclose(shown.values["inside"], [21, 22, 21, 22, 21])


def test_a_record_has_one_value_of_everything_else(gauge: Gauge) -> None:
    with pytest.raises(UsageError, match=r"rows\.csv:3: flux changes within a run, but a record is one calculation"):
        gauge(WALL, "depth [mm],pressing [N],flux [W/m^2]\n0,1,10\n50,1,11\n")


# As the engine asks: one machine, chosen results, SI


def warm(given_: Wall, base: Course, *, slope: Float, room: Float) -> Course:
    """The probe reads warmer with the room."""
    return replace(base, inside=base.inside + slope * (room - 293.15), temperature=base.temperature + slope)


def test_a_condition_may_change_within_a_record(tmp_path: Path) -> None:
    """The wall is at 21 degC inside; half a kelvin per kelvin of the room is read on top."""
    effect = Effect(
        "warm",
        on_reading=warm,
        needs=[Condition("room", "degC", reference=20)],
        unknowns=[Unknown("slope", -5, 5)],
        looks_like="the room",
    )
    model = replace(WALL, errors=[effect])
    text = "depth [mm],pressing [N],room [degC]\n0,1,20\n50,2,22\n100,3,24\n"
    setup, rows = rows_for(model, tmp_path, text)
    on = replace(setup, effects=(SwitchedOn(effect, {"slope": 0.5}),))
    found = read_by_gauge(on, rows)
    np.testing.assert_allclose(found.results["inside"] - 273.15, [21, 22, 23])
    np.testing.assert_allclose(found.results["work"], [1, 2, 3])


# Many changes of inputs and unknowns, asked of the model in one call: as one by one, with NaN where it fails.

LOADS = "load [N],time [h]\n28,1\n56,2\n84,3\n"


def test_each_trial_is_the_machine_with_that_input(tmp_path: Path) -> None:
    """Pressure is load over 28 mm^2; a measured column is replaced row by row, another input for all rows."""
    setup, rows = rows_for(PIN_WEAR, tmp_path, LOADS)
    changes = [{}, {"load": np.array([28.0, 28.0, 280.0])}, {"rate": 2e-8}, {"load": 14.0}]
    answers = [dict(each) for each in read_trials(setup, rows, changes, ["pressure", "depth"])]
    expected = [[1e6, 2e6, 3e6], [1e6, 1e6, 1e7], [1e6, 2e6, 3e6], [0.5e6] * 3]
    np.testing.assert_allclose([each["pressure"] for each in answers], expected)
    for change, answer in zip(changes, answers, strict=True):
        columns = {name: np.broadcast_to(value, (3,)) for name, value in change.items()}
        alone = read_by_gauge(setup, replace(rows, columns={**rows.columns, **columns}), ["pressure", "depth"])
        np.testing.assert_allclose(answer["depth"], alone.results["depth"], rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2])
def test_a_model_may_change_its_columns_in_place(tmp_path: Path, count: int) -> None:
    """A trial of one value for all rows may hold it once, as numpy repeats it: the model has a column of its own."""

    def colder(given_: Wall) -> Course:
        given_.flux[...] -= 1.0
        return wall(given_)

    setup, rows = rows_for(replace(WALL, function=colder), tmp_path, "flux [W/m^2]\n10\n20\n30\n")
    value = np.broadcast_to(11.0, (3,))
    for answer in read_trials(setup, rows, [{"flux": value}] * count, ["inside"]):
        np.testing.assert_allclose(answer["inside"] - 293.15, [1, 1, 1])
    assert value[0] == 11.0


PLAIN = "flux [W/m^2]\n10\n20\n30\n"
ALIKE = "depth [mm],flux [W/m^2]\n0,10\n50,20\n100,10\n100,20\n"
RECORD = "run,depth [mm],pressing [N]\na,0,1\na,50,2\na,100,3\n"
DIRT = effect_column("dirt", "offset")
WARMER = [273.15 + place for place in range(5)]
RISES = [[place + rise for rise in (1, 2, 3)] for place in range(-20, -15)]


@pytest.mark.parametrize(
    ("text", "column", "values", "wanted", "answers", "calls"),
    [
        (PLAIN, "outside", WARMER, "inside", RISES, [15]),
        (PLAIN, "outside", WARMER, "inside", RISES, [6, 6, 3]),
        ("depth [mm]\n0\n50\n100\n", "flux", [10.0, 20.0], "temperature", [[0, 0.5, 1], [0, 1, 2]], [2]),
        (RECORD, "flux", [10.0, 20.0], "temperature", [[0, 0.5, 1], [0, 1, 2]], [2]),
        (PLAIN, "flux", [10.0, 20.0], "inside", [[1] * 3, [2] * 3], [2]),
        (ALIKE, "outside", [293.15, 303.15], "temperature", [[0, 1, 1, 2], [10, 11, 11, 12]], [4]),
        (
            RECORD,
            DIRT,
            [np.full(3, float(size)) for size in range(40)],
            "inside",
            [[1 + k] * 3 for k in range(40)],
            [1],
        ),
    ],
    ids=["one call", "not too many rows", "a curve", "a record", "no column changes", "alike", "on the reading"],
)
def test_trials_are_few_calls(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, column: str, values: list[Any], wanted: str,
    answers: list[list[float]], calls: list[int],
) -> None:  # fmt: skip
    """10 W/m^2 through 100 mm of 1 W/(m K) are one kelvin, half of it in the middle; beyond 20 degC."""
    seen: list[int] = []

    def counted(given_: Wall) -> Course:
        seen.append(np.size(given_.flux))
        return wall(given_)

    if len(calls) > 1:
        monkeypatch.setattr("truing.gauge.AT_ONCE", 7)
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path, text)
    others = {name: own for name, own in rows.columns.items() if name != column}
    rows = replace(rows, columns={**others, "of_another_effect": np.arange(float(len(rows)))})
    on = [SwitchedOn(WALL.known_effects["dirt"], {"offset": 0.0})] if column == DIRT else []
    setup = (setup.changed({"pressing": np.ones(3)}) if "depth" in text else setup).with_effects(on)
    told = [each[wanted] - 293.15 for each in read_trials(setup, rows, [{column: each} for each in values], [wanted])]
    np.testing.assert_allclose(told, answers, atol=1e-9)
    assert seen == calls


def test_a_trial_in_which_the_model_fails_leaves_the_others(tmp_path: Path) -> None:
    def failing(given_: Wall) -> Course:
        return replace(wall(given_), inside=given_.outside + given_.flux / (given_.flux - 20.0))

    setup, rows = rows_for(replace(WALL, function=failing), tmp_path, "flux [W/m^2]\n10\n20\n30\n")
    plain, scaled = read_trials(setup, rows, [{}, {"flux": np.array([10.0, 40.0, 60.0])}], ["inside"])
    np.testing.assert_allclose(plain["inside"] - 293.15, [-1, np.nan, 3])
    np.testing.assert_allclose(scaled["inside"] - 293.15, [-1, 2, 1.5])


# Conditions that are history: made once from the rows of a file, in time order; and the table that shows them.

NAN = math.nan


def history(derived: str, values: list[float], runs: list[int] | None = None, time: list[float] | None = None,
            unit: str = "mm") -> list[float]:  # fmt: skip
    """What an effect sees of these rows."""
    condition = Condition("it", unit, derived=derived)
    column = {condition.made_from: np.array(values)}
    clock = None if time is None else np.array(time)
    return derive(condition, column, None if runs is None else np.array(runs), clock).tolist()


KINDS: list[tuple[str, list[float], list[float]]] = [
    ("since_start", [5, 7, 4, 9], [0, 2, -1, 4]),
    ("running_maximum of x", [3, 1, 4, 1, 5], [3, 3, 4, 4, 5]),
    ("running_maximum of x", [-3, -1, -4], [-3, -1, -1]),
    ("cumulative of x", [0, 2, -1, -1, 4], [0, 2, 5, 5, 10]),
    ("direction of x", [0, 1, 2, 1, 1, 3], [1, 1, 1, -1, -1, 1]),
    ("direction of x", [2, 2, 2, 1], [-1, -1, -1, -1]),
    ("direction of x", [2, 2, 2], [0, 0, 0]),
    ("direction of x", [2], [0]),
    ("last_reversal of x", [0, 1, 2, 1, 0, 3], [0, 0, 0, 2, 2, 0]),
    ("last_reversal of x", [0, 1, 2, 2, 1], [0, 0, 0, 0, 2]),
    ("last_reversal of x", [7, 7, 7], [7, 7, 7]),
    ("last_reversal of x", [7], [7]),
]


@pytest.mark.parametrize(("derived", "values", "seen"), KINDS)
def test_what_has_been_whatever_the_order_of_the_rows(derived: str, values: list[float], seen: list[float]) -> None:
    assert history(derived, values) == seen
    order = np.random.default_rng(0).permutation(len(values))
    shuffled = history(derived, [values[row] for row in order], time=[60.0 * row for row in order])
    assert shuffled == [seen[row] for row in order]


RUNS = ([10.0, 1.0, 12.0, 3.0, 11.0, 2.0], [7, 3, 7, 3, 7, 3], None)
GAPS = ([NAN, 1, NAN, 4, 0], None, None)
NEVER = ([NAN, NAN, 1.0], [1, 1, 2], None)


@pytest.mark.parametrize(
    ("derived", "rows", "seen"),
    [
        # history begins anew with every run, but the start is that of the file
        ("running_maximum of x", RUNS, [10, 1, 12, 3, 12, 3]),
        ("cumulative of x", RUNS, [0, 0, 2, 2, 3, 3]),
        ("direction of x", RUNS, [1, 1, 1, 1, -1, -1]),
        ("last_reversal of x", RUNS, [10, 1, 10, 1, 12, 3]),
        ("since_start", RUNS, [0, -9, 2, -7, 1, -8]),
        # the earliest row of the file is the start, and rows without a time come last
        ("since_start", ([30, 10, 20], [1, 2, 2], [8.0, 6.0, 7.0]), [20, 0, 10]),
        ("since_start", ([30, NAN, 20], None, [8.0, 6.0, 7.0]), [10, NAN, 0]),
        ("since_start", ([6.0, 8.0], None, [NAN, NAN]), [0, 2]),
        ("cumulative of x", ([1, 9, 2], None, [0.0, NAN, 1.0]), [0, 8, 1]),
        # what is missing is passed over; where nothing is measured nothing is known
        ("since_start", GAPS, [NAN, 0, NAN, 3, -1]),
        ("running_maximum of x", GAPS, [NAN, 1, 1, 4, 4]),
        ("cumulative of x", GAPS, [NAN, 0, 0, 3, 7]),
        ("direction of x", GAPS, [1, 1, 1, 1, -1]),
        ("last_reversal of x", GAPS, [NAN, 1, 1, 1, 4]),
        ("since_start", ([NAN, NAN], None, None), [NAN, NAN]),
        ("running_maximum of x", NEVER, [NAN, NAN, 1]),
        ("cumulative of x", NEVER, [NAN, NAN, 0]),
        ("direction of x", NEVER, [NAN, NAN, 0]),
        ("last_reversal of x", NEVER, [NAN, NAN, 1]),
    ],
)
def test_runs_times_and_gaps(derived: str, rows: tuple[Any, ...], seen: list[float]) -> None:
    np.testing.assert_array_equal(history(derived, *rows), seen)


def test_a_column_that_is_not_there() -> None:
    with pytest.raises(UsageError, match="condition 'way' is derived from 'travel', which is no column"):
        derive(Condition("way", "", derived="direction of travel"), {}, None, None)


def test_many_rows_are_quick() -> None:
    travel = np.sin(np.linspace(0, 300, 200_000))
    begin = time.perf_counter()
    way = derive(Condition("way", "", derived="direction of travel"), {"travel": travel}, None, None)
    assert time.perf_counter() - begin < 2
    assert np.count_nonzero(np.diff(way)) == 95  # extrema at pi/2 + k pi, k = 0 to 94, below 300


UNKNOWN = ["since start", "maximum of x", "direction", "direction of", "direction of x y", "since_start of x", "of x"]
LEVEL = "is in degC, a temperature level, but what is gained is a difference"


@pytest.mark.parametrize(
    ("stated", "sentence"),
    [
        *(({"derived": word}, f"condition 'load' is derived by '{word}'; write 'since_start', ") for word in UNKNOWN),
        ({"derived": "running_maximum of load"}, "each of another column"),
        ({"unit": "degC", "derived": "since_start"}, LEVEL),
        ({"unit": "degC", "derived": "cumulative of oil"}, LEVEL),
        ({"low": 5, "high": 2}, "condition 'load': its range goes from 5 to 2; lower first"),
    ],
)
def test_conditions_that_cannot_be_are_refused(stated: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence):
        Condition("load", **{"unit": "N", **stated})


def test_a_temperature_may_be_gained_as_a_difference_and_be_the_highest_as_a_level() -> None:
    assert Condition("warming", "K", derived="cumulative of oil").made_from == "oil"
    assert Condition("hottest", "degC", derived="running_maximum of oil").history == "running_maximum"


# Rows of a file


@inputs
class Stage:
    """A stage that is pushed to a place."""

    place: Float = given(0.0, "mm", symbol="x")


@results
class Position:
    """Where it is."""

    position: Float = found("um", symbol="x_1")


def stage(given_: Stage) -> Position:
    """Just there."""
    return Position(position=given_.place)


def lost(given_: Stage, *, play: Float, way: Float) -> Stage:
    """Half the play is lost against the way."""
    return replace(given_, place=given_.place - play / 2 * way)


def worn(given_: Stage, base: Position, *, wear: Float, strokes: Float) -> Position:
    """So much per stroke."""
    return replace(base, position=base.position + wear * strokes)


def kneaded(given_: Stage, base: Position, *, yielding: Float, peak: Float) -> Position:
    """So much per newton of the highest load so far."""
    return replace(base, position=base.position + yielding * peak)


STAGE = Model(
    name="stage",
    title="Stage",
    function=stage,
    errors=[
        Effect("lost", on_inputs=lost, unknowns=[Unknown("play", -1, 1, "mm")],
               needs=[Condition("way", "", derived="direction of place")]),
        Effect("worn", on_results=worn, unknowns=[Unknown("wear", -9, 9, "um")],
               needs=[Condition("strokes", "", derived="since_start")]),
        Effect("kneaded", on_results=kneaded, unknowns=[Unknown("yielding", -9, 9, "um/N")],
               needs=[Condition("peak", "N", derived="running_maximum of load")]),
    ],
)  # fmt: skip
ALL = '[effects.lost]\nplay = "1 mm"\n[effects.worn]\nwear = "3 um"\n[effects.kneaded]\nyielding = "2 um/N"\n'
Read = Callable[..., RowsFile]


@pytest.fixture
def rows(tmp_path: Path) -> Read:
    """Read rows for the stage."""
    return lambda text, stated=ALL: rows_for(STAGE, tmp_path, text, stated)[1]


def test_the_rows_of_a_file_make_the_conditions(tmp_path: Path) -> None:
    text = "place [mm],strokes,load [kN]\n0,100,0.001\n1,101,0.004\n0.5,103,0.002\n"
    setup, read = rows_for(STAGE, tmp_path, text, ALL)
    np.testing.assert_allclose(read.columns["way"], [1, 1, -1])
    np.testing.assert_allclose(read.columns["strokes"], [0, 1, 3])
    np.testing.assert_allclose(read.columns["peak"], [1, 4, 4])
    assert read.others == ()
    shown = shown_by_gauge(setup, read).values["position"]
    np.testing.assert_allclose(shown, [0 - 500 + 0 + 2, 1000 - 500 + 3 + 8, 500 + 500 + 9 + 8])


STATED = ALL + '[conditions]\nway = -1\nstrokes = 50\npeak = "2 N"\n'


@pytest.mark.parametrize(
    ("text", "stated", "made"),
    [
        ("time,run,place [mm]\n3,a,0.5\n1,b,7\n2,a,0.7\n2,b,9\n1,a,0.1\n", ALL, {"way": [-1, 1, 1, 1, 1]}),
        ("place [mm],way,peak [N]\n0,-1,7\n1,-1,3\n", ALL, {"way": [-1, -1], "peak": [7, 3]}),
        ("strokes,note\n5,a\n,b\n9,c\n", STATED, {"strokes": [0, 50, 4]}),
        ("time,place [mm]\nnoon,0\nevening,1\n", ALL, {"way": [1, 1]}),
    ],
    ids=["time and runs", "columns of their own", "as the inputs file says", "no clock"],
)
def test_what_came_before_is_known_from_what_the_file_holds(
    rows: Read, text: str, stated: str, made: dict[str, list[float]]
) -> None:
    read = rows(text, stated)
    for name in ("way", "strokes", "peak"):
        assert (name in read.columns) is (name in made)
        np.testing.assert_allclose(read.columns.get(name, []), made.get(name, []))
    assert read.others == (("note",) if "note" in text else ())


def test_the_column_it_is_made_from_is_checked(rows: Read) -> None:
    with pytest.raises(
        InputError, match=r"column 'load' has no unit; it is a force: write 'load \[N\]' \('peak' is made"
    ):
        rows("load\n5\n")
    with pytest.raises(InputError, match=r"rows.csv:3: load: 'much' is no number"):
        rows("load [N]\n5\nmuch\n")


def test_the_time_of_the_kernel_counts_from_the_first_row_where_an_effect_needs_it(tmp_path: Path, rows: Read) -> None:
    """2 um/h of drift; the file begins at 8 h. Without such an effect a column "time" may hold anything."""
    drift = '[effects.sensor_drift]\nposition = "2 um/h"\n'
    setup, read = rows_for(STAGE, tmp_path, "time [h]\n8\n9\n8.5\n", drift)
    np.testing.assert_allclose(read.columns["time"], [0, 3600, 1800])
    np.testing.assert_allclose(shown_by_gauge(setup, read).values["position"], [0, 2, 1], atol=1e-12)
    assert rows("time\n12:30\n12:31\n", "[inputs]\n").others == ("time",)
    with pytest.raises(InputError, match="column 'time' has no unit"):
        rows("time\n8\n", drift)


# Inputs that mean something only together: a convention, the places of an axis, a draw that knows a record.


def weight_in(path: Path) -> float:
    """A file that holds one number."""
    return float(path.read_text())


@inputs
class Beam:
    """A beam that is measured at some places; its load was measured too, with a known scatter."""

    load: Float = given(10.0, "N", symbol="F", stated_with="load_case")
    load_case: Literal["middle", "end"] = given("middle")
    slack: Float = given(0.0, "N", symbol="s")
    places: Float = given((0.0, 1.0, 2.0), "m", along="place")
    weighed: str = given("well", note="how the load was weighed")
    record: float | None = loaded(weight_in, default=None, note="of the balance")


@results
class Bending:
    """The moment along the beam."""

    place: Float = axis("m", follows="places")
    moment: Float = found("N*m", along="place")


def beam(given_: Beam) -> Bending:
    """Load times the square of the place: a straight line between far points would be wrong."""
    return Bending(place=given_.places, moment=column(given_.load + given_.slack) * np.square(given_.places))


def scale(rng: Any, count: int, *, weighed: str) -> dict[str, Any]:
    """A bad balance scatters, a good one does not."""
    return {"slack": rng.normal(0.0, 0.5, count)} if weighed == "badly" else {}


BEAM = Model(
    name="beam",
    title="Beam",
    function=beam,
    errors=[Tolerance("balance", drawn(scale, of=["weighed"]), on=["slack"])],
)


def beam_setup(text: str, model: Model[Any, Any] = BEAM, folder: Path = Path()) -> Setup:
    return setup_from_text(text, offer_of(model), file="beam.toml", folder=folder)


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ('load = "3 N"\nslack = "1 kg"\n', [
            "beam.toml:2: load means nothing without load_case; state load_case (middle, end) beside it",
            "beam.toml:3: slack",
        ]),
        ('load = "3 N"\nload_case = "ende"\n', ["beam.toml:3: load_case"]),
    ],
)  # fmt: skip
def test_an_input_whose_meaning_is_missing_or_wrong_is_one_fault_with_its_line(text: str, faults: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        beam_setup("[inputs]\n" + text)
    for said, expected in zip(str(caught.value).splitlines(), faults, strict=True):
        assert said.startswith(expected)
    for fine in ("", 'load_case = "end"\n', 'load = "3 N"\nload_case = "end"\n'):
        assert beam_setup("[inputs]\n" + fine).inputs.load_case in {"end", "middle"}


@results
class Lost:
    """An axis of what is no series."""

    place: Float = axis("m", follows="load")


@pytest.mark.parametrize(
    ("other", "sentence"),
    [
        ("loadcase", "'load' is stated with 'loadcase', which is no other input"),
        ("load", "'load' is stated with 'load', which is no other input"),
        ("", "the axis 'place' follows 'load', which is no input series"),
    ],
)
def test_what_goes_together_must_be_there(other: str, sentence: str) -> None:
    fields = {"__annotations__": {"load": Float}, "load": given(10.0, "N", stated_with=other)}

    def of_one(given_: Any) -> Lost:
        return Lost(place=np.zeros(1))

    of_one.__annotations__["given_"] = inputs(type("One", (), fields))
    with pytest.raises(DeclarationError, match=sentence):
        Model(name="lost", title="Lost", function=of_one)


def test_a_model_of_curves_only_asks_for_the_axis(gauge: Gauge) -> None:
    with pytest.raises(UsageError, match="every result of beam runs along place: give that column"):
        gauge(BEAM, "load [N]\n10\n")


def test_a_result_is_calculated_where_it_was_measured(tmp_path: Path) -> None:
    setup, read = rows_for(BEAM, tmp_path, "place [m],load [N]\n0.3,10\n7.5,10\n0.3,20\n,10\n")
    shown = read_by_gauge(one_machine(setup), read).results["moment"]
    np.testing.assert_allclose(shown, [0.9, 562.5, 1.8, np.nan], rtol=1e-12)


def test_a_draw_sees_the_inputs_it_asks_for() -> None:
    assert scatter_of(beam_setup("")).causes == ()
    badly = beam_setup('[inputs]\nweighed = "badly"\n')
    assert badly.distributions()["balance"]["slack"].sd == pytest.approx(0.5, rel=0.02)
    drawn_ = scatter_of(badly).draw(1, 0, 4000)["slack"]
    assert np.std(drawn_) == pytest.approx(0.5, rel=0.05)
    changed = replace(badly, inputs=replace(badly.inputs, weighed="well"))
    assert scatter_of(changed).causes == ()


def by_record(rng: Any, count: int, *, record: float | None) -> dict[str, Any]:
    """A balance that wrote down how much it scatters."""
    return {} if record is None else {"slack": rng.normal(0.0, record, count)}


def test_a_draw_sees_a_file_and_that_there_is_none(tmp_path: Path) -> None:
    (tmp_path / "balance.txt").write_text("0.25")
    errors = [Tolerance("balance", drawn(by_record, of=["record"]), on=["slack"])]
    model = replace(BEAM, errors=errors)
    assert beam_setup("", model, tmp_path).distributions() == {}
    with_file = beam_setup('[inputs]\nrecord = { file = "balance.txt" }\n', model, tmp_path)
    assert with_file.distributions()["balance"]["slack"].sd == pytest.approx(0.25, rel=0.02)


def test_a_draw_asks_for_inputs_that_exist() -> None:
    with pytest.raises(DeclarationError, match="tolerance 'balance' names 'weight', which is no input"):
        Model(
            name="odd", title="Odd", function=beam,
            errors=[Tolerance("balance", drawn(scale, of=["weight"]), on=["slack"])],
        )  # fmt: skip
