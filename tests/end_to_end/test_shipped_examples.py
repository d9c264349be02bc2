"""The examples of the gearing and of the roller screw as ``calc init`` writes them, and their cases.

What the plugins calculate is tested in tests/published, on the model.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import truing


def example(plugin: str, folder: Path, **studies: Any) -> dict[str, Any]:
    """Run the example as it stands, with smaller studies, and return its document."""
    model, file = truing.load(plugin), folder / "example.toml"
    file.write_text(model.example(), encoding="utf-8")
    run = model.run(file, set={f"studies.{name.replace('__', '.')}": value for name, value in studies.items()})
    assert run.passed
    return dict(run.document)


def cases(plugin: str, file: Path, text: str) -> dict[str, Any]:
    file.write_text(text, encoding="utf-8")
    return dict(truing.load(plugin).run(cases=file, set={"studies.run": []}).document)


def test_the_example_of_the_gearing_lists_its_groups(tmp_path: Path) -> None:
    """Stress of 20/55 under 2.26 kW and the list, calculated independently beforehand."""
    found = example("rv_gearing", tmp_path, reliability__draws=2000)
    results, groups = found["results"], found["studies"]["search"]["groups"]
    assert results["contact_stress"]["value"] == pytest.approx(1087.34, rel=1e-4)
    names = {f"{stress}_stress_{gear}" for stress in ("contact", "root") for gear in ("sun", "planet")}
    assert names <= {check["name"] for check in found["checks"]}
    assert {"search", "sensitivity", "reliability"} <= set(found["studies"])
    assert results["group_count"]["value"] == len(groups["sun"]["values"]) == 25
    assert results["group_sun_teeth"]["value"] == groups["sun"]["values"] == sorted(groups["sun"]["values"])
    assert (groups["sun"]["values"][4], groups["planet"]["values"][4]) == (23, 63)
    assert (groups["centre_distance"]["unit"], groups["centre_distance"]["values"][0]) == ("mm", pytest.approx(46.875))
    assert groups["root_stress_sun"]["values"][4] == pytest.approx(230.83, rel=1e-4)


def test_the_strength_of_all_groups_as_cases(tmp_path: Path) -> None:
    """Larger gears carry more; a number beyond the list fails alone, and the others go on."""
    found = cases("rv_gearing", tmp_path / "groups.csv", "group\n" + "".join(f"{number}\n" for number in range(1, 27)))
    assert found["verdict"] == "fails"
    safeties = [case["results"]["contact_safety"]["value"] for case in found["cases"][:25]]
    assert safeties == sorted(safeties)
    assert safeties[0] == pytest.approx(1.1 * 1093.4 / 1087.34, rel=1e-4)
    assert found["cases"][4]["results"]["root_stress_sun"]["value"] == pytest.approx(230.83, rel=1e-4)
    (failed,) = found["failed"]
    assert failed["row"] == 26
    assert "the search finds 25 groups" in failed["reason"]


def test_no_design_of_the_front_of_the_roller_screw_beats_another(tmp_path: Path) -> None:
    """A large sum is bought with a difference of the stresses."""
    found = example("roller_screw_shift", tmp_path, optimise__population=16, optimise__generations=6)
    assert len(found["checks"]) == 12
    assert found["results"]["optimal_shift_roller"]["value"] == pytest.approx(0.2525, abs=2e-3)
    assert found["studies"]["shift"]["limits"] == ["margin_contact_ratio"]
    front = found["studies"]["optimise"]["front"]
    assert len(front) > 3
    assert all(design["feasible"] for design in front)
    signs = {"shift_sum": -1, "stress_difference": 1, "sliding_difference": 1}
    goals = [tuple(sign * design["objectives"][name] for name, sign in signs.items()) for design in front]
    for one in goals:
        assert not any(other != one and all(a <= b for a, b in zip(other, one, strict=True)) for other in goals)


def test_cases_over_shifts_name_the_one_that_is_too_large(tmp_path: Path) -> None:
    found = cases("roller_screw_shift", tmp_path / "shifts.csv", "roller_shift\n0\n0.21\n0.4\n-0.5\n")
    assert found["verdict"] == "fails"
    checks = [{check["name"]: check["passed"] for check in case["checks"]} for case in found["cases"][:3]]
    assert [each["margin_contact_ratio"] for each in checks] == [True, True, False]
    (failed,) = found["failed"]
    assert failed["row"] == 4
    assert "involute interference" in failed["reason"]
