"""The press whose drive gets hot: its records by a program of its own, and what a diagnosis says of them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from shown_in_docs import EXAMPLES
from simulated import module_of

from truing import load

HOME = EXAMPLES / "press_motion"


@pytest.fixture(scope="module")
def simulation() -> ModuleType:
    """The program that makes the records."""
    return module_of(HOME / "simulate.py")


def test_the_records_are_those_that_the_program_writes(
    simulation: ModuleType, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    simulation.write("slow.csv", 3.0, np.radians(-150), 0.0, seed=1)
    simulation.write("fast.csv", 12.0, np.radians(-150), 1.2e6, seed=2)
    for name in ("slow.csv", "fast.csv"):
        assert (tmp_path / name).read_bytes() == (HOME / name).read_bytes()


@pytest.mark.parametrize(("is_even", "apart"), [(True, 0.6e-3), (False, 5e-3)], ids=["even", "as in the records"])
def test_both_programs_need_the_same_torque(
    simulation: ModuleType, tmp_path: Path, monkeypatch: Any, is_even: bool, apart: float
) -> None:
    """Without noise, kN m; torque is written to 1 N m, force to 10 N, and speed, whose slope is taken, to 1e-4 rpm."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(simulation, "NOISE", 0.0)
    if is_even:
        monkeypatch.setattr(simulation, "turned", lambda time, rpm, start: start + np.pi / 30 * rpm * time)
    simulation.write("turn.csv", 12.0, np.radians(-150), 1.2e6, rows=50, seed=1)
    shown = np.genfromtxt("turn.csv", delimiter=",", skip_header=1)
    links = zip(("crank", "rod", "knee_drive", "upper_knee", "lower_knee"), simulation.BARS.values(), strict=True)
    run = load("press_linkage.motion").run(
        times=shown[:, 0], start_angle="-150 deg", crank_speed=shown[:, 2], forming_force=shown[:, 3],
        slider_mass=f"{simulation.SLIDER} kg", platform_mass=f"{simulation.PLATFORM} kg",
        counterbalance=f"{simulation.LIFT} N", rotor_inertia=f"{simulation.ROTOR} kg*m^2",
        **{f"mass_{link}": f"{mass} kg" for link, mass in links},
    )  # fmt: skip
    assert run.si["crank_torque"] / 1e3 == pytest.approx(shown[:, 4], abs=apart)


def test_the_air_is_named_with_its_size(shown_runs: Callable[[str], Path]) -> None:
    """The diagnosis that the page shows; a third of a kilonewton and one tonne are what it says of it."""
    document = json.loads((shown_runs("press_motion") / "slow" / "diagnosis.json").read_text(encoding="utf-8"))
    (cause,) = document["causes"]
    assert (document["verdict"], cause["effect"]) == ("named", "counterbalance_loss")
    low, high = cause["unknowns"]["loss"]["interval95"]
    assert low < 13 < high
    visible = {name: document["smallest_visible"][name]["value"] for name in ("guide_friction", "heavier_slider")}
    assert visible == {"guide_friction": pytest.approx(1 / 3, abs=0.05), "heavier_slider": pytest.approx(1, abs=0.1)}
