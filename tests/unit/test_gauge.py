"""What the gauge would show: one machine, its calibration in place, readings acting, records along an axis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pin_wear import PIN_WEAR

from truing import Condition, Effect, Float, Model, Unknown, axis, column, found, given, inputs, results, trials
from truing.errors import UsageError
from truing.gauge import Shown, read_by_gauge, shown_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.measurements import RowsFile, read_rows
from truing.setup import Setup, SwitchedOn, effect_column
from truing.trials import read_trials


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


@results
class Curve:
    """A curve alone."""

    depth: Float = axis("mm", note="place")
    warmth: Float = found("degC", note="temperature", along="depth")


def curve(given_: Wall) -> Curve:
    """Return a straight line."""
    points = np.linspace(0.0, 0.1, 3)
    return Curve(depth=points, warmth=column(given_.outside) + 0 * points)


CURVE = Model(name="curve", title="Curve", function=curve)
Gauge = Callable[..., Shown]


@pytest.fixture
def gauge(tmp_path: Path) -> Gauge:
    """Read rows for a model and return what its gauge shows."""

    def show(model: Model, rows: str, inputs_text: str = "[inputs]\n") -> Shown:
        offer = Offer(model.name, model, Origin(model.name, "", "", "", f"module:{model.name}"))
        path = tmp_path / "rows.csv"
        path.write_text(rows)
        setup = setup_from_text(inputs_text, offer, file="given.toml", folder=tmp_path)
        return shown_by_gauge(setup, read_rows(path, offer, setup))

    return show


def test_rows_replace_inputs_and_come_back_in_printed_units(gauge: Gauge) -> None:
    """Pressure is load over area: 240 N and 120 N on 28 mm^2."""
    shown = gauge(PIN_WEAR, "load [kN]\n0.24\n\n", '[units]\npressure = "kPa"\n')
    np.testing.assert_allclose(shown.values["pressure"], [240e3 / 28])
    assert shown.units["pressure"] == "kPa"
    assert set(shown.values) == {"pressure", "distance", "depth"}


def test_results_along_an_axis_are_read_at_the_place_of_the_row(gauge: Gauge) -> None:
    rows = "depth [mm],flux [W/m^2]\n0,10\n50,10\n50,30\n100,10\n101,10\n"
    shown = gauge(WALL, rows, '[inputs]\npressing = ["1 N", "1 N", "1 N"]\n')
    np.testing.assert_allclose(shown.values["temperature"], [20, 20.5, 21.5, 21, np.nan])
    np.testing.assert_allclose(shown.values["inside"], [21, 21, 23, 21, 21])
    assert "depth" not in shown.values
    assert shown.reasons == {4: "'temperature' cannot be read at this row: it lies beyond the axis 'depth'"}


def test_a_row_without_its_place_says_so(gauge: Gauge) -> None:
    shown = gauge(WALL, "depth [mm],flux [W/m^2]\n,10\n50,10\n", '[inputs]\npressing = ["1 N", "1 N", "1 N"]\n')
    np.testing.assert_allclose(shown.values["temperature"], [np.nan, 20.5])
    assert shown.reasons == {0: "'temperature' cannot be read at this row: 'depth' is not given"}


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


def test_a_model_of_curves_only_asks_for_the_axis(gauge: Gauge) -> None:
    with pytest.raises(UsageError, match="every result of curve runs along depth: give that column"):
        gauge(CURVE, "flux [W/m^2]\n10\n")


# As the engine asks: one machine, chosen results, SI


def rows_for(model: Model, path: Path, text: str) -> tuple[Setup, RowsFile]:
    offer = Offer(model.name, model, Origin(model.name, "", "", "", f"module:{model.name}"))
    path.write_text(text)
    setup = setup_from_text("[inputs]\n", offer, file="given.toml", folder=path.parent)
    return setup, read_rows(path, offer, setup)


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
    setup, rows = rows_for(model, tmp_path / "rows.csv", text)
    on = replace(setup, effects=(SwitchedOn(effect, {"slope": 0.5}),))
    found = read_by_gauge(on, rows)
    np.testing.assert_allclose(found.results["inside"] - 273.15, [21, 22, 23])
    np.testing.assert_allclose(found.results["work"], [1, 2, 3])


# Many changes of inputs and unknowns, asked of the model in one call: as one by one, with NaN where it fails.

LOADS = "load [N],time [h]\n28,1\n56,2\n84,3\n"


def counting() -> tuple[Callable[[Wall], Course], list[int]]:
    """The calculation of the wall, and how many rows each call of it has had so far."""
    calls: list[int] = []

    def counted(given_: Wall) -> Course:
        calls.append(np.size(given_.flux))
        return wall(given_)

    return counted, calls


def test_each_trial_is_the_machine_with_that_input(tmp_path: Path) -> None:
    """Pressure is load over 28 mm^2; a measured column is replaced row by row, another input for all rows."""
    setup, rows = rows_for(PIN_WEAR, tmp_path / "rows.csv", LOADS)
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

    setup, rows = rows_for(replace(WALL, function=colder), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    value = np.broadcast_to(11.0, (3,))
    for answer in read_trials(setup, rows, [{"flux": value}] * count, ["inside"]):
        np.testing.assert_allclose(answer["inside"] - 293.15, [1, 1, 1])
    assert value[0] == 11.0


def test_trials_are_one_call_and_not_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counted, calls = counting()
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    changes = [{"outside": 273.15 + place} for place in range(5)]
    answers = list(read_trials(setup, rows, changes, ["inside"]))
    assert calls == [15]
    monkeypatch.setattr(trials, "AT_ONCE", 7)
    in_parts = list(read_trials(setup, rows, changes, ["inside"]))
    assert calls[1:] == [6, 6, 3]
    for place, (at_once, part) in enumerate(zip(answers, in_parts, strict=True)):
        np.testing.assert_allclose(at_once["inside"] - 273.15, place + np.array([1, 2, 3]))
        np.testing.assert_allclose(part["inside"], at_once["inside"])


@pytest.mark.parametrize("text", ["depth [mm]\n0\n50\n100\n", "depth [mm],pressing [N]\n0,1\n50,2\n100,3\n"])
def test_a_curve_is_calculated_once_for_all_rows_of_a_trial(tmp_path: Path, text: str) -> None:
    """10 W/m^2 through 100 mm of 1 W/(m K) are one kelvin: half of it in the middle. The trials are one call."""
    counted, calls = counting()
    model = replace(WALL, function=counted)
    setup, rows = rows_for(model, tmp_path / "rows.csv", text)
    setup = setup.changed({"pressing": np.ones(3)})
    answers = list(read_trials(setup, rows, [{"flux": 10.0}, {"flux": 20.0}], ["temperature"]))
    np.testing.assert_allclose([each["temperature"] - 293.15 for each in answers], [[0, 0.5, 1], [0, 1, 2]], atol=1e-9)
    assert calls == [2]


def test_what_no_column_changes_is_calculated_once_a_trial(tmp_path: Path) -> None:
    counted, calls = counting()
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    rows = replace(rows, columns={"of_another_effect": np.arange(3.0)})
    answers = list(read_trials(setup, rows, [{"flux": 10.0}, {"flux": 20.0}], ["inside"]))
    np.testing.assert_allclose([each["inside"] - 293.15 for each in answers], [[1] * 3, [2] * 3])
    assert calls == [2]


def test_rows_that_are_alike_are_one_calculation_along_an_axis(tmp_path: Path) -> None:
    """Of 10 and 20 W/m^2 two kelvins are one third: four rows are two calculations, each read at its own places."""
    counted, calls = counting()
    text = "depth [mm],flux [W/m^2]\n0,10\n50,20\n100,10\n100,20\n"
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", text)
    setup = setup.changed({"pressing": np.ones(3)})
    plain, warm = read_trials(setup, rows, [{"outside": 293.15}, {"outside": 303.15}], ["temperature"])
    np.testing.assert_allclose(plain["temperature"] - 293.15, [0, 1, 1, 2], atol=1e-9)
    np.testing.assert_allclose(warm["temperature"] - 293.15, [10, 11, 11, 12], atol=1e-9)
    assert calls == [4]


def test_an_effect_on_the_reading_asks_for_no_record_again(tmp_path: Path) -> None:
    """What dirt adds at 40 sizes is added to one record."""
    counted, calls = counting()
    text = "run,depth [mm],pressing [N]\na,0,1\na,50,2\na,100,3\n"
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", text)
    on = setup.with_effects([SwitchedOn(WALL.known_effects["dirt"], {"offset": 0.0})])
    changes = [{effect_column("dirt", "offset"): np.full(3, float(size))} for size in range(40)]
    found = [each["inside"] for each in read_trials(on, rows, changes, ["inside"])]
    np.testing.assert_allclose([each - found[0] for each in found], np.repeat(np.arange(40.0)[:, None], 3, axis=1))
    assert calls == [1]


def test_a_trial_in_which_the_model_fails_leaves_the_others(tmp_path: Path) -> None:
    def failing(given_: Wall) -> Course:
        return replace(wall(given_), inside=given_.outside + given_.flux / (given_.flux - 20.0))

    setup, rows = rows_for(replace(WALL, function=failing), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    plain, scaled = read_trials(setup, rows, [{}, {"flux": np.array([10.0, 40.0, 60.0])}], ["inside"])
    np.testing.assert_allclose(plain["inside"] - 293.15, [-1, np.nan, 3])
    np.testing.assert_allclose(scaled["inside"] - 293.15, [-1, 2, 1.5])
