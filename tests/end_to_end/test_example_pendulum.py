"""The pendulum on a geared drive: its period in closed form, its record by a program that shares nothing with it."""

from __future__ import annotations

import csv
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk
from simulated import module_of

from shared import ROOT, Calc
from truing import load, read

HOME = ROOT / "docs" / "examples" / "geared_pendulum"
WEIGHT = 1.2 * 9.80665 * 0.5
"""Mass, gravity and length of the example, N m."""


@pytest.fixture(scope="module")
def pendulum() -> Any:
    return load(HOME / "geared_pendulum.py")


@pytest.fixture(scope="module")
def simulation() -> ModuleType:
    """The program that makes the records."""
    return module_of(HOME / "simulate.py")


@pytest.mark.parametrize("release", [1.0, 60.0, 175.0])
def test_the_period_is_a_complete_elliptic_integral(pendulum: Any, release: float) -> None:
    """T = 4 sqrt(J / (m g l)) K(sin^2(phi_0 / 2)), but for errors of 1e-8 rad in each step."""
    run = pendulum.run(release=f"{release} deg", times=np.linspace(0, 12, 13))
    inertia = 0.02 + 1.2 * 0.5**2
    expected = 4 * np.sqrt(inertia / WEIGHT) * ellipk(np.sin(np.radians(release) / 2) ** 2)
    assert run.si["period"] == pytest.approx(expected, rel=1e-6)


def test_dry_friction_takes_the_same_angle_from_every_small_swing(pendulum: Any) -> None:
    """From phi to -(phi - 2 M / (m g l)), after J. Den Hartog; and it rests where the weight is less than that."""
    run = pendulum.run(release="4 deg", coulomb="0.05 N*m", times=np.linspace(0, 30, 3001))
    angles, loss = run.si["angle"], 0.05 / WEIGHT
    turns = np.abs(angles[1:-1][(np.diff(angles)[:-1] * np.diff(angles)[1:]) < 0])
    assert turns[:3] == pytest.approx(np.radians(4) - 2 * loss * np.arange(1, 4), rel=2e-3)
    assert abs(run.si["rest"]) < loss
    assert np.ptp(angles[-500:]) == 0


def test_the_record_is_that_of_a_program_of_its_own(pendulum: Any, simulation: ModuleType) -> None:
    """Heun's steps of 0.1 ms, which turn up to one step late, against the located events of the calculation."""
    times = [0.17 * row for row in range(50)]
    shown = simulation.swing(0.6, 43.5, times)
    run = pendulum.run(
        times=np.array(times), tip_mass="0.6 kg", release="43.5 deg", length=f"{simulation.LENGTH} m",
        inertia=f"{simulation.INERTIA} kg*m^2", coulomb=f"{simulation.DRY} N*m", viscous=f"{simulation.OIL} N*m*s",
    )  # fmt: skip
    assert np.degrees(run.si["angle"]) == pytest.approx(shown, abs=0.02)


def test_the_records_are_those_that_the_program_writes(
    simulation: ModuleType, tmp_path: Path, monkeypatch: Any
) -> None:
    """The first rows, so that nobody has to wait for all of them."""
    monkeypatch.chdir(tmp_path)
    simulation.write("swing_1.csv", 1.2, 61.0, [0.2 * row for row in range(5)], 1)
    shipped = (HOME / "swing_1.csv").read_text(encoding="utf-8").splitlines()
    assert (tmp_path / "swing_1.csv").read_text(encoding="utf-8").splitlines() == shipped[:6]


def test_every_run_is_a_motion_on_its_own_times(pendulum: Any, calc: Calc, tmp_path: Path) -> None:
    """Two runs of one file with other times, masses and starts; each begins at its first row."""
    runs = {"a": ([5.0, 5.5, 6.1], 1.2, 60), "b": ([0.0, 0.3, 0.9, 2.0], 0.6, 40)}
    rows = [f"{run},{t},{mass},{release}" for run, (times, mass, release) in runs.items() for t in times]
    (tmp_path / "rows.csv").write_text("\n".join(["run,time [s],tip_mass [kg],release [deg]", *rows]), encoding="utf-8")
    words = ("-i", HOME / "inputs.toml", "--rows", "rows.csv", "-o", "shown.csv")
    assert calc("table", HOME / "geared_pendulum.py", *words).code == 0
    with (tmp_path / "shown.csv").open(encoding="utf-8") as lines:
        shown = [float(row["angle [deg]"]) for row in csv.DictReader(lines)]
    expected = [
        pendulum.run(times=np.array(times), tip_mass=f"{mass} kg", release=f"{release} deg").si["angle"]
        for times, mass, release in runs.values()
    ]
    assert shown == pytest.approx(np.degrees(np.concatenate(expected)), abs=1e-9)


def test_the_sheet_draws_what_changes(calc: Calc, tmp_path: Path) -> None:
    """Three states over time, and the second over the first; still, nothing is drawn."""
    assert calc("run", HOME / "geared_pendulum.py", "-i", HOME / "inputs.toml", "-o", "swings").code == 0
    sheet = (tmp_path / "swings" / "sheet.html").read_text(encoding="utf-8")
    assert all(words in sheet for words in ("States over time", "Phase: one state over the other"))
    still = ("--set", "release=0 deg", "-o", "still")
    assert calc("run", HOME / "geared_pendulum.py", "-i", HOME / "inputs.toml", *still).code == 0
    assert "States over time" not in (tmp_path / "still" / "sheet.html").read_text(encoding="utf-8")


def test_what_changes_within_a_run_is_refused_with_its_line(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("run,time [s],tip_mass [kg]\na,0,1.2\na,0.5,1.3\n", encoding="utf-8")
    answer = calc("table", HOME / "geared_pendulum.py", "-i", HOME / "inputs.toml", "--rows", "rows.csv")
    assert answer.code == 2
    assert "rows.csv:3: tip_mass changes within a run, but a record is one calculation" in answer.err


def test_two_records_with_other_times_starts_and_masses_are_one_diagnosis(
    pendulum: Any, simulation: ModuleType, tmp_path: Path, monkeypatch: Any
) -> None:
    """Dry friction alone is hidden; the second arm is let go where nobody wrote it down, and each start is fitted."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(simulation, "OIL", 0.0)
    simulation.write("one.csv", 1.2, 60.5, [0.2 * row for row in range(12)], 11)
    simulation.write("two.csv", 0.6, 58.0, [0.13 * row for row in range(14)], 12)
    record = read([tmp_path / "one.csv", tmp_path / "two.csv"], pendulum)
    found = pendulum.diagnose(record, per_file=["release"], progress=False).document
    assert [cause["effect"] for cause in found["causes"]] == ["dry_friction"]
    torque = found["causes"][0]["unknowns"]["torque"]["interval95"]
    assert torque[0] < simulation.DRY < torque[1]
    assert found["calibrated"]["release"]["value"] == pytest.approx(60.5, abs=0.3)
