"""The roller screw: the example, its optimum, and cases.

What it calculates is tested in tests/published, on the model.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import truing


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Run what ``calc init`` writes, once, with a small search for the front."""
    file = tmp_path_factory.mktemp("screw") / "screw.toml"
    screw = truing.load("roller_screw_shift")
    file.write_text(screw.example(), encoding="utf-8")
    run = screw.run(file, set={"studies.optimise.population": 16, "studies.optimise.generations": 6})
    assert run.passed
    return dict(run.document)


def value(found: dict[str, Any], name: str) -> Any:
    return found["results"][name]["value"]


def test_the_example_is_the_printed_pair(found: dict[str, Any]) -> None:
    """Geometry, sliding and form factors at a shift of 0.21, calculated independently beforehand."""
    expected = {
        "ring_shift": -0.16, "working_angle": 18.41166, "contact_ratio": 1.423027, "tip_land": 0.5 * 0.85162,
        "sliding_roller": 0.828725, "tangential_force": 51.943, "shift_sum": 0.05,
    }  # fmt: skip
    for name, number in expected.items():
        assert value(found, name) == pytest.approx(number, rel=2e-4), name
    for name in ("transmission_error", "wear_depth", "axial_shift", "friction_torque", "backlash"):
        assert value(found, name) == 0, name
    assert all(check["passed"] and check["margin"] > 0 for check in found["checks"])
    assert len(found["checks"]) == 11


def test_the_optimum_stands_at_the_contact_ratio_by_box_and_by_grid(found: dict[str, Any]) -> None:
    assert value(found, "optimal_shift_roller") == pytest.approx(0.2525, abs=2e-3)
    assert value(found, "optimal_shift_ring") == pytest.approx(-0.1175, abs=2e-3)
    assert value(found, "optimal_contact_ratio") == pytest.approx(1.4, abs=1e-5)
    assert value(found, "grid_shift") == pytest.approx(value(found, "optimal_shift_roller"), abs=1e-5)
    assert value(found, "most_stress_difference") == pytest.approx(33.2, abs=0.05)
    assert found["studies"]["shift"]["limits"] == ["margin_contact_ratio"]


def test_no_design_of_the_front_beats_another(found: dict[str, Any]) -> None:
    """A large sum is bought with a difference of the stresses."""
    front = found["studies"]["optimise"]["front"]
    assert len(front) > 3
    assert all(design["feasible"] for design in front)
    goals = [
        (-design["objectives"]["shift_sum"], design["objectives"]["stress_difference"],
         design["objectives"]["sliding_difference"]) for design in front
    ]  # fmt: skip
    for one in goals:
        assert not any(other != one and all(a <= b for a, b in zip(other, one, strict=True)) for other in goals)


def test_cases_over_shifts_name_the_one_that_is_too_large(tmp_path: Path) -> None:
    (tmp_path / "shifts.csv").write_text("roller_shift\n0\n0.21\n0.4\n-0.5\n")
    found = truing.load("roller_screw_shift").run(cases=tmp_path / "shifts.csv", set={"studies.run": []}).document
    assert found["verdict"] == "fails"
    ratios = [case["checks"] for case in found["cases"][:3]]
    passed = [next(c["passed"] for c in checks if c["name"] == "margin_contact_ratio") for checks in ratios]
    assert passed == [True, True, False]
    (failed,) = found["failed"]
    assert failed["row"] == 4
    assert "involute interference" in failed["reason"]
