"""Units written wrong in a header: found with the factor that sets them right, and never where nothing is wrong."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pin_wear import PIN_WEAR

from press_linkage import truing_models
from truing import Model
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.evaluate import evaluate_rows
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.setup import Setup, default_setup

PRESS = next(model for model in truing_models() if model.name == "press_linkage")
ROWS = 60
Columns = Mapping[str, NDArray[np.float64]]
HEATED = '[effects.link_heating]\nexpansion = "11 um/(m*K)"\n'


def offer_of(model: Model[Any, Any]) -> Offer:
    return Offer(model.name, model, Origin(model.name, "", "", "", f"module:{model.name}"))


def read(folder: Path, model: Model[Any, Any], columns: Columns, text: str = "[inputs]\n") -> Records:
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


ANGLE, HEIGHT = "crank_angle [deg]", "slider_position [mm]"


@pytest.mark.parametrize(
    ("angle", "height", "scale", "expected"),
    [
        (ANGLE, HEIGHT, (1, 1), []),
        (ANGLE, "slider_position [m]", (1, 1), [("slider_position", 1e-3)]),
        (ANGLE, "slider_position [um]", (1, 1), [("slider_position", 1e3)]),
        (ANGLE, HEIGHT, (1, 1e-6), [("slider_position", 1e6)]),
        (ANGLE, HEIGHT, (1, 1e6), [("slider_position", 1e-6)]),
        (ANGLE, HEIGHT, (1, 1 / 25.4), [("slider_position", 25.4)]),
        (ANGLE, "slider_position [in]", (1, 1), [("slider_position", 1 / 25.4)]),
        ("crank_angle [rad]", HEIGHT, (1, 1), [("crank_angle", math.pi / 180)]),
        (ANGLE, HEIGHT, (math.pi / 180, 1), [("crank_angle", 180 / math.pi)]),
        (ANGLE, HEIGHT, (1e-3, 1), [("crank_angle", 1e3)]),
    ],
)
def test_slips_of_a_press(
    tmp_path: Path, angle: str, height: str, scale: tuple[float, float], expected: list[tuple[str, float]]
) -> None:
    _, angles, heights = strokes_of_a_press()
    found = unit_errors(read(tmp_path, PRESS, {angle: angles * scale[0], height: heights * scale[1]}))
    assert [name for name, _ in found] == [name for name, _ in expected]
    np.testing.assert_allclose([factor for _, factor in found], [factor for _, factor in expected], rtol=1e-12)


def test_a_slip_is_named_in_words_and_nothing_is_changed(tmp_path: Path) -> None:
    _, angles, heights = strokes_of_a_press()
    records = read(tmp_path, PRESS, {"crank_angle [rad]": angles, HEIGHT: heights})
    np.testing.assert_allclose(records.rows.columns["crank_angle"], angles)
    (unit_error,) = records.unit_errors
    assert "'crank_angle [rad]' is probably wrong: multiply it by pi/180 (degrees, not radians)" in unit_error.text
    assert "mm off 'slider_position' instead of" in unit_error.text


def test_a_sweep_in_degrees_under_radians_is_not_joined(tmp_path: Path) -> None:
    """Steps of 5 rad look like jumps by a turn."""
    setup, _, _ = strokes_of_a_press()
    angles = np.arange(-150.0, 150.0, 5.0)
    found = evaluate_rows(setup, {"crank_angle": np.radians(angles)}, ROWS, wanted=["slider_position"])
    heights = found.results["slider_position"] * 1e3
    records = read(tmp_path, PRESS, {"crank_angle [rad]": angles, HEIGHT: heights})
    np.testing.assert_allclose(records.rows.columns["crank_angle"], angles)
    assert unit_errors(records) == [("crank_angle", pytest.approx(math.pi / 180))]


def test_a_gauge_that_was_set_to_zero_somewhere(tmp_path: Path) -> None:
    _, angles, heights = strokes_of_a_press()
    zeroed = heights - heights.mean()
    assert not read(tmp_path, PRESS, {ANGLE: angles, HEIGHT: zeroed}).unit_errors
    (unit_error,) = read(tmp_path, PRESS, {ANGLE: angles, "slider_position [um]": zeroed}).unit_errors
    assert (unit_error.column, unit_error.factor) == ("slider_position", 1e3)
    assert "about its middle" in unit_error.text


@pytest.mark.parametrize("off", [5.0, 300.0])
def test_what_is_merely_wrong_is_no_slip(tmp_path: Path, off: float) -> None:
    """A large offset, a tilt where the drawing has none, wild readings."""
    rng = np.random.default_rng(3)
    _, angles, heights = strokes_of_a_press()
    heights[::11] += 1e7
    columns = {ANGLE: angles, HEIGHT: heights + off, "slider_tilt [urad]": 3000 + rng.normal(0, 50, ROWS)}
    assert not read(tmp_path, PRESS, columns).unit_errors


def test_wild_readings_hide_no_slip(tmp_path: Path) -> None:
    _, angles, heights = strokes_of_a_press()
    heights[::15] = 9e9
    assert unit_errors(read(tmp_path, PRESS, {ANGLE: angles, "slider_position [m]": heights})) == [
        ("slider_position", 1e-3)
    ]


def test_a_condition_beyond_its_range(tmp_path: Path) -> None:
    """The forming force can be set from -200 to 2000 kN; newtons under kilonewtons lie far outside."""
    _, angles, heights = strokes_of_a_press()
    force = np.linspace(5, 900, ROWS)
    columns = {ANGLE: angles, HEIGHT: heights}
    assert not read(tmp_path, PRESS, {**columns, "forming_force [kN]": force}).unit_errors
    records = read(tmp_path, PRESS, {**columns, "forming_force [kN]": force * 1e3})
    assert unit_errors(records) == [("forming_force", 1e-3)]
    assert "it can be set from -200 to 2000 kN" in records.unit_errors[0].text


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
    assert unit_errors(read(tmp_path, PIN_WEAR, renamed(pins(), old, new))) == expected


def test_a_temperature_level_has_no_factor(tmp_path: Path) -> None:
    """Beyond its range and with an effect on, yet a thousand times 20 degrees is no other unit of the same."""
    _, angles, heights = strokes_of_a_press()
    columns = {ANGLE: angles, HEIGHT: heights, "link_temperature [degC]": np.full(ROWS, 2e4)}
    assert not read(tmp_path, PRESS, columns, HEATED).unit_errors
