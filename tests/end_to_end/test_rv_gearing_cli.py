"""The gearing: the example and its list of groups, as results and as cases.

What it calculates is tested in tests/published, on the model.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import truing
from truing.report.markdown_printer import markdown_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of

GROUP_5 = {"root_stress_sun": 230.83, "root_stress_planet": 214.75, "contact_stress_sun": 977.37,
           "contact_stress_planet": 924.18}  # fmt: skip


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> truing.Run:
    """Run what ``calc init`` writes as it stands, once, with fewer draws."""
    file = tmp_path_factory.mktemp("gearing") / "gearing.toml"
    gearing = truing.load("rv_gearing")
    file.write_text(gearing.example(), encoding="utf-8")
    run = gearing.run(file, set={"studies.reliability.draws": 2000})
    assert run.passed
    return run


@pytest.fixture
def found(example: truing.Run) -> dict[str, Any]:
    return dict(example.document)


def value(found: dict[str, Any], name: str) -> Any:
    return found["results"][name]["value"]


def test_the_example_has_the_published_set_up_and_its_reference_stresses(found: dict[str, Any]) -> None:
    """Sizes, factors and stresses of 20/55 under 2.26 kW, calculated independently beforehand."""
    expected = {
        "teeth_sun": 20, "teeth_planet": 55, "pins": 40, "ratio": 111, "sun_speed": 1665, "sun_torque": 12.963,
        "tangential_force": 518.51, "pitch_line_velocity": 2.160, "contact_ratio": 1.6638, "resonance_ratio": 0.0263,
        "dynamic_factor": 1.0290, "face_factor": 1.5410, "face_factor_bending": 1.3985, "transverse_factor": 1.1399,
        "transverse_factor_bending": 1.1399, "planet_factor_bending": 1.15, "form_factor_sun": 2.8000,
        "form_factor_planet": 2.3074, "stress_correction_sun": 1.5525, "stress_correction_planet": 1.7162,
        "root_stress_sun": 248.31, "root_stress_planet": 226.20, "permitted_root_stress_sun": 681.8,
        "permitted_root_stress_planet": 708.8, "contact_stress_sun": 1087.34, "contact_stress_planet": 1011.28,
        "permitted_contact_stress_sun": 1093.4, "permitted_contact_stress_planet": 1151.9,
        "form_factor_outer_sun": 1.5520, "stress_correction_outer_sun": 1.8312,
    }  # fmt: skip
    for name, number in expected.items():
        assert value(found, name) == pytest.approx(number, rel=2e-3 if name == "resonance_ratio" else 1e-4), name
    assert value(found, "contact_stress") == value(found, "contact_stress_sun")
    for name in ("transmission_error", "backlash"):
        assert value(found, name) == 0


def test_checks_and_studies_of_the_example(found: dict[str, Any]) -> None:
    assert all(check["passed"] for check in found["checks"])
    assert {"contact_stress_sun", "contact_stress_planet", "root_stress_sun", "root_stress_planet"} <= {
        check["name"] for check in found["checks"]
    }
    assert {"search", "sensitivity", "reliability"} <= set(found["studies"])


def test_the_list_of_groups_is_a_result(example: truing.Run, found: dict[str, Any]) -> None:
    groups = found["studies"]["search"]["groups"]
    assert value(found, "group_count") == 25
    assert value(found, "group_sun_teeth") == groups["sun"]["values"]
    assert (groups["sun"]["values"][4], groups["planet"]["values"][4]) == (23, 63)
    assert groups["sun"]["values"] == sorted(groups["sun"]["values"])
    assert groups["centre_distance"]["unit"] == "mm"
    assert groups["centre_distance"]["values"][0] == pytest.approx(46.875, rel=1e-12)
    assert groups["root_stress_sun"]["values"][4] == pytest.approx(GROUP_5["root_stress_sun"], rel=1e-4)
    sheet = markdown_of(make_sheet(example.calculation, provenance=provenance_of(example.calculation.setup)))
    assert "| 25 | 36 | 99 | 40 | 111 |" in sheet


def test_the_strength_of_all_groups_as_cases(tmp_path: Path) -> None:
    """Larger gears carry more; a number beyond the list fails alone, and the others go on."""
    (tmp_path / "groups.csv").write_text("group\n" + "".join(f"{number}\n" for number in range(1, 27)))
    found = truing.load("rv_gearing").run(cases=tmp_path / "groups.csv", set={"studies.run": []}).document
    assert found["verdict"] == "fails"
    safeties = [case["results"]["contact_safety"]["value"] for case in found["cases"][:25]]
    assert safeties == sorted(safeties)
    assert safeties[0] == pytest.approx(1.1 * 1093.4 / 1087.34, rel=1e-4)
    assert found["cases"][4]["results"]["root_stress_sun"]["value"] == pytest.approx(230.83, rel=1e-4)
    (failed,) = found["failed"]
    assert failed["row"] == 26
    assert "the search finds 25 groups" in failed["reason"]
