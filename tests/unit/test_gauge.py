"""What the gauge would show: one machine, its calibration in place, readings acting, records along an axis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pin_wear import PIN_WEAR

from truing import Condition, Effect, Float, Model, Unknown, axis, column, found, given, inputs, results
from truing.errors import UsageError
from truing.gauge import Shown, read_by_gauge, shown_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.measurements import RowsFile, read_rows
from truing.setup import Setup, SwitchedOn


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
