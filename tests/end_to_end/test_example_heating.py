"""The heating curve: its balance of heat, closed forms, and a program that shares nothing with it."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shown_in_docs import EXAMPLES
from simulated import differing, module_of

from truing.kernel.loading import load_file

EXAMPLE = EXAMPLES / "heating_curve"
STORY = (EXAMPLE / "README.md").read_text(encoding="utf-8")
Array = NDArray[np.float64]
ICE = 273.15
STARTS = {"DAY_1": (20.5, 20.5), "DAY_2": (46.0, 43.0)}
"""Temperatures of oil and housing with which the records begin, degC."""


@pytest.fixture(scope="module")
def unit() -> Any:
    return load_file(EXAMPLE / "heating_curve.py")


@pytest.fixture(scope="module")
def simulation() -> ModuleType:
    return module_of(EXAMPLE / "simulate.py")


def run(unit: Any, times: Any, torque: Any, rpm: Any, air: Any, **numbers: Any) -> Any:
    """Follow a unit; all in SI but the speed in rpm and the air in degC."""
    series = [np.broadcast_to(np.asarray(each, dtype=float), np.shape(times)) for each in (times, torque, rpm, air)]
    names = {"times": series[0], "torque": series[1], "speed": series[2] / 60, "air": series[3] + ICE}
    return unit.HEATING_CURVE.function(replace(unit.HEATING_CURVE.inputs(**numbers), **names))


def test_all_heat_that_is_lost_is_stored_or_given_off(unit: Any) -> None:
    """By the trapezoidal rule over readings 20 s apart; heat capacities after the default inputs."""
    times = np.arange(0.0, 3601.0, 20.0)
    heated = run(unit, times, 100, 1450, np.linspace(22, 25, len(times)))
    stored = 8.3e3 * (heated.oil[-1] - heated.oil[0]) + 28e3 * (heated.housing[-1] - heated.housing[0])
    assert np.trapezoid(heated.loss - heated.given_off, dx=20.0) == pytest.approx(stored, rel=1e-4)


def test_at_rest_oil_and_housing_cool_by_two_exponentials(unit: Any) -> None:
    """Two bodies that pass heat on in proportion to their difference: eigenvalues of a matrix of two rows."""
    times = np.linspace(0, 7200, 7)
    cooled = run(unit, times, 0, 0, 22, oil_start="60 degC", housing_lag="7 K")
    change = np.array([[-60 / 8.3e3, 60 / 8.3e3], [60 / 28e3, -65 / 28e3]])
    values, vectors = np.linalg.eig(change)
    expected = (vectors * np.linalg.solve(vectors, [38.0, 31.0])) @ np.exp(np.outer(values, times))
    assert np.array([cooled.oil, cooled.housing]) - ICE - 22 == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(("day", "apart"), [("DAY_1", 720), ("DAY_2", 900)])
def test_a_day_is_that_of_a_program_of_its_own(unit: Any, simulation: ModuleType, day: str, apart: int) -> None:
    """Heun's steps of a second; what is left is that the air is taken to run straight between the readings."""
    times = [apart * row for row in range(19)]
    shift, (oil, housing) = getattr(simulation, day), STARTS[day]
    torque, speed = np.array([simulation.setting(shift, time) for time in times], dtype=float).T
    heated = run(
        unit, times, torque, speed, [simulation.air(time) for time in times],
        oil_start=f"{oil} degC", housing_lag=f"{oil - housing} K", thinning=simulation.THINNING,
        load_loss=simulation.LOAD_LOSS + simulation.ROUGH, drag=simulation.DRAG, oil_capacity=simulation.OIL,
        housing_capacity=simulation.HOUSING, contact=simulation.CONTACT, still_transfer=simulation.STILL,
        fan_transfer=f"{simulation.FAN} W/K/rpm", cleanness=1 - simulation.FOULED,
    )  # fmt: skip
    expected = [warm for warm, _ in simulation.day(shift, oil, housing, times)]
    assert heated.oil - ICE == pytest.approx(expected, abs=1e-2)


@pytest.mark.parametrize(("day", "apart", "seed"), [("DAY_1", 720, 1), ("DAY_2", 900, 2)])
def test_the_records_are_those_that_the_program_writes(
    simulation: ModuleType, tmp_path: Path, day: str, apart: int, seed: int
) -> None:
    """The first rows, so that nobody has to wait for all of them."""
    times = [apart * row for row in range(5)]
    write = partial(simulation.write, shift=getattr(simulation, day), start=STARTS[day], times=times, seed=seed)
    assert differing(EXAMPLE / f"{day.lower()}.csv", write, tmp_path) == []


def test_the_page_names_what_was_hidden(simulation: ModuleType) -> None:
    """The page is run; here its numbers are held against those of the program."""
    named = re.search(r"^Cause named\. What the model misses in oil: (.*)$", STORY, re.MULTILINE)
    assert named is not None
    for effect, hidden in {"rough mesh, extra": 100 * simulation.ROUGH, "fouling, share": simulation.FOULED}.items():
        size = re.search(rf"{effect} [\d.]+(?: %)? \(95 %: ([\d.]+) … ([\d.]+)\)", named.group(1))
        assert size is not None
        low, high = map(float, size.groups())
        assert low < hidden < high
