"""The gearing through the command line: the example, groups and teeth, stated factors, and the numbers of others."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from measured import calc_here

from shared import Calc
from truing import Kernel
from truing.calculation import Calculation, calculate
from truing.inputs_file import setup_from_settings

Table = Callable[..., list[dict[str, float]]]
GROUP_5 = {"root_stress_sun": 230.83, "root_stress_planet": 214.75, "contact_stress_sun": 977.37,
           "contact_stress_planet": 924.18}  # fmt: skip


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Write the example file and run it as it stands, once, with fewer draws."""
    folder = tmp_path_factory.mktemp("gearing")
    assert calc_here(folder, "init", "rv_gearing", "-o", "gearing.toml", "-q").code == 0
    few = ["--set", "studies.reliability.draws=2000"]
    told = calc_here(folder, "run", "rv_gearing", "--inputs", "gearing.toml", "-o", "run", "--json", *few)
    assert told.code == 0, told.err
    return folder / "run", json.loads(told.out)


def value(found: dict[str, Any], name: str) -> Any:
    return found["results"][name]["value"]


@pytest.fixture
def table(tabled: Table) -> Table:
    """Print results of the plugin row by row for a CSV of inputs."""
    return partial(tabled, "rv_gearing")


def test_the_example_has_the_published_set_up_and_its_reference_stresses(example: tuple[Path, dict[str, Any]]) -> None:
    """Sizes, factors and stresses of 20/55 under 2.26 kW, calculated independently beforehand."""
    folder, found = example
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
    assert {path.name for path in folder.iterdir()} >= {"inputs.toml", "results.json", "run.json", "sheet.html"}


def test_checks_and_studies_of_the_example(example: tuple[Path, dict[str, Any]]) -> None:
    _, found = example
    assert all(check["passed"] for check in found["checks"])
    assert {"contact_stress_sun", "contact_stress_planet", "root_stress_sun", "root_stress_planet"} <= {
        check["name"] for check in found["checks"]
    }
    assert {"search", "sensitivity", "reliability"} <= set(found["studies"])


def test_the_list_of_groups_is_a_result(example: tuple[Path, dict[str, Any]]) -> None:
    folder, found = example
    groups = found["studies"]["search"]["groups"]
    assert value(found, "group_count") == 25
    assert value(found, "group_sun_teeth") == groups["sun"]["values"]
    assert (groups["sun"]["values"][4], groups["planet"]["values"][4]) == (23, 63)
    assert groups["sun"]["values"] == sorted(groups["sun"]["values"])
    assert groups["centre_distance"]["unit"] == "mm"
    assert groups["centre_distance"]["values"][0] == pytest.approx(46.875, rel=1e-12)
    assert groups["root_stress_sun"]["values"][4] == pytest.approx(GROUP_5["root_stress_sun"], rel=1e-4)
    sheet = (folder / "sheet.md").read_text(encoding="utf-8")
    assert "| 25 | 36 | 99 | 40 | 111 |" in sheet


@pytest.mark.parametrize(
    ("settings", "count"), [(("ratio_tolerance=0.04",), 102), (("fewest_pins=30", "most_pins=60"), 422)]
)
def test_wider_readings_of_the_search(calc: Calc, settings: tuple[str, ...], count: int) -> None:
    short = ("sheet.detail=short", 'studies.run=["search"]')
    words = [word for setting in (*settings, *short) for word in ("--set", setting)]
    found = json.loads(calc("run", "rv_gearing", "-o", "run", "--json", *words).out)
    assert value(found, "group_count") == found["studies"]["search"]["count"] == count


def searched(*settings: str) -> Calculation:
    """Calculate with settings as of ``--set``, and only the search; no sheet."""
    offer = Kernel.installed().offers["rv_gearing"]
    pairs = dict(text.split("=", 1) for text in settings)
    return calculate(setup_from_settings(offer, {**pairs, "studies.run": '["search"]'}))


def test_one_pin_circle_leaves_few_groups() -> None:
    assert searched("window=one_pin_circle").outcomes["search"].as_json()["count"] == 5


def test_a_search_that_finds_nothing_is_an_answer_where_the_teeth_are_stated() -> None:
    found = searched("target_ratio=3000", "sun_teeth=20", "planet_teeth=55")
    assert found.outcomes["search"].as_json()["count"] == 0
    assert any("no group of tooth numbers" in text for text in found.warnings)
    assert found.answers["ratio"] == pytest.approx(111)


def test_stated_teeth_that_are_no_group_are_said() -> None:
    found = searched("sun_teeth=15", "planet_teeth=60", "shift_sun=0.15")
    assert found.answers["ratio"] == pytest.approx(161)
    assert any("none of the 25 groups" in text for text in found.warnings)


def test_a_sorted_list_of_the_groups_with_just_the_ratio(calc: Calc) -> None:
    found = searched("studies.search.sort_by=contact_safety_sun", "studies.search.descending=true",
                     "studies.search.exact_only=true")  # fmt: skip
    groups = found.outcomes["search"].as_json()["groups"]
    assert groups["group"]["values"] == [25, 18, 11, 6, 1]
    assert groups["deviation"]["values"] == [0] * 5
    wrong = calc("run", "rv_gearing", "-o", "wrong", "--set", "studies.search.sort_by=colour")
    assert wrong.code == 2
    assert "colour" in wrong.err


def test_a_group_is_its_teeth(table: Table) -> None:
    (by_number,) = table("group\n5\n")
    by_teeth, others = table("sun_teeth,planet_teeth\n23,63\n24,63\n")
    for name, number in GROUP_5.items():
        assert by_number[name] == pytest.approx(number, rel=1e-4), name
        assert by_teeth[name] == pytest.approx(by_number[name], rel=1e-12), name
    assert others["ratio"] == pytest.approx(106)


def test_the_strength_of_all_groups_as_cases(calc: Calc, tmp_path: Path) -> None:
    """Larger gears carry more; a number beyond the list fails alone, and the others go on."""
    (tmp_path / "groups.csv").write_text("group\n" + "".join(f"{number}\n" for number in range(1, 27)))
    short = ("--set", "sheet.detail=short", "--set", "studies.run=[]", "--json")
    answer = calc("run", "rv_gearing", "-o", "run", "--cases", "groups.csv", *short)
    assert answer.code == 1
    found = json.loads(answer.out)
    safeties = [case["results"]["contact_safety"]["value"] for case in found["cases"][:25]]
    assert safeties == sorted(safeties)
    assert safeties[0] == pytest.approx(1.1 * 1093.4 / 1087.34, rel=1e-4)
    assert found["cases"][4]["results"]["root_stress_sun"]["value"] == pytest.approx(230.83, rel=1e-4)
    (failed,) = found["failed"]
    assert failed["row"] == 26
    assert "the search finds 25 groups" in failed["reason"]


def test_a_stated_factor_is_used_as_it_stands_and_what_is_behind_it_follows(table: Table) -> None:
    (plain,) = table("group\n1\n")
    (stated,) = table("group\n1\n", "stated_face_factor=1.2", "stated_form_factor_sun=3")
    assert (stated["face_factor"], stated["form_factor_sun"]) == (1.2, 3)
    assert stated["form_factor_planet"] == plain["form_factor_planet"]
    assert stated["face_factor_bending"] == pytest.approx(1.2 ** plain["face_exponent"], rel=1e-12)
    assert stated["root_stress_planet"] < plain["root_stress_planet"]


def test_the_paper_leaves_out_the_single_contact_factor(table: Table) -> None:
    ((with_factor,), (without,)) = (table("group\n1\n", f"single_contact={word}") for word in ("true", "false"))
    factor = with_factor["single_contact_factor_sun"]
    assert factor > 1
    assert without["single_contact_factor_sun"] == 1
    assert with_factor["contact_stress_sun"] == pytest.approx(factor * without["contact_stress_sun"])


def test_the_two_readings_of_the_helix_factor_are_reciprocal(table: Table) -> None:
    helix = "helix_angle [deg]\n15.8\n"
    ((iso,), (older,)) = (table(helix, f"helix_reading={word}") for word in ("iso", "gb_1997"))
    assert iso["helix_factor"] == pytest.approx(1.01944, rel=1e-5)  # ISO/TR 6336-30, example 1
    assert iso["helix_factor"] * older["helix_factor"] == pytest.approx(1, rel=1e-12)


def test_a_table_over_torques_of_both_signs(table: Table) -> None:
    """Stresses are even in the torque, and none where there is none."""
    back, idle, forth = table("load_torque [N*m],input_speed [rpm]\n-800,1000\n0,1000\n800,1000\n")
    for name in ("root_stress_sun", "root_stress_planet", "contact_stress"):
        assert idle[name] == 0, name
        assert back[name] == forth[name] > 100, name
    for row in (back, idle, forth):
        assert row["transmission_error"] == 0
        assert row["flank_temperature"] == pytest.approx(40)


def test_verify_prints_every_row_with_its_verdict(calc: Calc) -> None:
    answer = calc("verify", "rv_gearing", "--json")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert len(found["rows"]) > 20
    assert all(row["as_stated"] for row in found["rows"])
    assert all(row["why"] for row in found["rows"] if row["verdict"] == "differs")
    assert found["findings"]
    of_iso = [row for row in found["rows"] if "6336-30" in row["where"]]
    assert len(of_iso) >= 15
    for row in of_iso:
        assert row["ratio"] == pytest.approx(1, abs=1e-3), row["name"]
