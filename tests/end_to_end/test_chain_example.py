"""The shipped examples of chains, two inputs files and one sheet each: gears load discs, flanks make a mesh stiff."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import truing
from truing.cli import main
from truing.evaluate import evaluate, evaluate_rows, taken_values
from truing.setup import Setup

ARC_MINUTE = math.pi / 180 / 60
EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "reducer_chain"
HARMONIC = EXAMPLE.parent / "harmonic_chain"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], str]:
    """Run it with the sensitivity alone; the sheet as Markdown beside the numbers."""
    folder = tmp_path_factory.mktemp("chain")
    shutil.copytree(EXAMPLE, folder / "example")
    words = ["run", "rv_wear", "--inputs", str(folder / "example" / "inputs.toml"), "--output", str(folder / "run")]
    assert main([*words, "--set", 'studies.run=["sensitivity"]', "-q"]) == 1  # undecided without its reliability
    document = json.loads((folder / "run" / "results.json").read_text(encoding="utf-8"))
    return document, (folder / "run" / "sheet.md").read_text(encoding="utf-8")


def test_torque_speed_and_ratio_are_those_of_the_first_stage(run: tuple[dict[str, Any], str]) -> None:
    """Group 5 of 5.5 kW: 30/82 teeth and 40 pins, so the ratio is 1 + 82 * 40 / 30."""
    document, _ = run
    inputs, results = document["inputs"], document["results"]
    assert inputs["total_ratio"]["value"] == pytest.approx(1 + 82 * 40 / 30, rel=1e-12)
    assert inputs["output_torque"]["value"] == results["rv_gearing_output_torque"]["value"]
    efficiency = results["rv_gearing_efficiency"]["value"]
    torque = 9550 * 5.5 / 15 * efficiency  # N m of kW and rpm, as equation 5 of the paper of the gearing has it
    assert inputs["output_torque"]["value"] == pytest.approx(torque, rel=1e-9)
    assert inputs["output_speed"]["from"] == {"calculation": "rv_gearing", "result": "output_speed"}


def test_the_scatter_of_the_bearings_reaches_the_backlash(run: tuple[dict[str, Any], str]) -> None:
    """Its slope is that through the torque: three bearings in series, so the torque goes with their third power."""
    document, _ = run
    inputs = {name: said["value"] for name, said in document["inputs"].items()}
    wear, torque, step = truing.load("rv_wear"), inputs["output_torque"], 1e-3
    stated = {"total_ratio": inputs["total_ratio"], "working_time": "6000 h"}
    low, high = (
        evaluate(wear.setup(output_torque=f"{torque * (1 + sign * step)!r} N*m", **stated)).backlash for sign in (-1, 1)
    )
    by_hand = (high - low) / (2 * step) * 3 / inputs["rv_gearing_bearing_efficiency"] / ARC_MINUTE
    slope = document["studies"]["sensitivity"]["backlash"]["rv_gearing_bearing_efficiency"]
    assert slope["unit"] == "arcmin"
    assert slope["derivative"] == pytest.approx(by_hand, rel=1e-3)
    assert document["tolerances"]["rv_gearing_bearing_efficiency"]["spread"] == "sd 0.002"


def test_the_sheet_has_a_chapter_for_each(run: tuple[dict[str, Any], str]) -> None:
    """The graph first, then the stage, then the discs; sections are numbered inside."""
    page = run[1].replace("\\_", "_")
    heads = [line.removeprefix("## ") for line in page.splitlines() if line.startswith("## ")]
    numbered = [head for head in heads if head[:1].isdigit()]
    titles = [head.partition(" ")[2] for head in numbered if "." not in head.partition(" ")[0]]
    at = titles.index("Chain of calculations")
    assert titles[at + 1].endswith("(rv_gearing)")
    assert titles[at + 2].endswith("(rv_wear)")
    assert any(head.endswith(" Ratio, efficiency and torque") and ".1 " in head for head in numbered)


# The flanks of a harmonic drive give its mesh a stiffness, and the mesh vibrates


@pytest.fixture(scope="module")
def mesh() -> Setup:
    """The vibration of the shipped example, with what it takes from the drive."""
    return truing.load("harmonic_fractal.vibration").setup(HARMONIC / "inputs.toml")


def test_the_stiffness_of_the_drive_is_that_of_the_mesh_which_vibrates(mesh: Setup) -> None:
    """The drive alone gives the stiffness; one inertia on a spring gives the frequency. Torque and radius are one."""
    drive = truing.load("harmonic_fractal").setup(HARMONIC / "drive.toml")
    stiffness = evaluate(drive).normal_stiffness
    answers = mesh.model.read_results(evaluate(mesh))
    assert answers["mesh_stiffness"] == pytest.approx(stiffness, rel=1e-12)
    lever = 25.4e-3 * math.cos(math.radians(20))
    frequency = math.sqrt(stiffness * lever**2 / 5e-5) / (2 * math.pi)
    assert answers["natural_frequency"] == pytest.approx(frequency, rel=1e-12)
    taken = taken_values(mesh)
    assert (taken["torque"], taken["pitch_radius"]) == pytest.approx((5.0, 25.4e-3))
    alone = truing.load("harmonic_fractal.vibration").setup(torque="5 N*m")  # one rough flank on a smooth one
    assert evaluate(alone).mesh_stiffness > 1.005 * stiffness


def test_what_scatters_and_acts_in_the_drive_moves_the_frequency(mesh: Setup) -> None:
    """The frequency goes with the root of the drive's stiffness, for a hardness that scatters and for an effect on."""
    model = truing.load("harmonic_fractal")
    factors = np.array([0.95, 1.05])
    rows = evaluate_rows(mesh, {"harmonic_fractal_hardness": 3e9 * factors}, 2, wanted=["natural_frequency"])
    stiffness = [
        evaluate(model.setup(HARMONIC / "drive.toml", hardness=f"{3 * factor!r} GPa")).normal_stiffness
        for factor in factors.tolist()
    ]
    first, second = rows.results["natural_frequency"]
    assert second / first == pytest.approx(math.sqrt(stiffness[1] / stiffness[0]), rel=1e-9)
    assert second / first > 1.0005
    assert "harmonic_fractal_oil_film" in mesh.model.effects
