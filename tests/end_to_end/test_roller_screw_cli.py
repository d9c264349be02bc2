"""The roller screw through the command line: the example, its optimum, cases, and the numbers of the paper."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from measured import calc_here

from shared import ROUNDING, Calc
from truing import Kernel
from truing.calculation import Calculation, calculate
from truing.inputs_file import setup_from_settings

Table = Callable[..., list[dict[str, float]]]


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Write the example file and run it, once, with a small search for the front."""
    folder = tmp_path_factory.mktemp("screw")
    assert calc_here(folder, "init", "roller_screw_shift", "-o", "screw.toml", "-q").code == 0
    few = [word for size in ("population=16", "generations=6") for word in ("--set", f"studies.optimise.{size}")]
    told = calc_here(folder, "run", "roller_screw_shift", "--inputs", "screw.toml", "-o", "run", "--json", *few)
    assert told.code == 0, told.err
    return folder / "run", json.loads(told.out)


@pytest.fixture
def table(tabled: Table) -> Table:
    """Print results of the plugin row by row for a CSV of inputs."""
    return partial(tabled, "roller_screw_shift")


def shifted(*settings: str) -> Calculation:
    """Calculate with settings as of ``--set``, and only the choice of the shift; no sheet."""
    offer = Kernel.installed().offers["roller_screw_shift"]
    pairs = dict(text.split("=", 1) for text in settings)
    quick = {"studies.run": '["shift"]', "studies.shift.points": "501"}
    return calculate(setup_from_settings(offer, {**pairs, **quick}))


def value(found: dict[str, Any], name: str) -> Any:
    return found["results"][name]["value"]


def test_the_example_is_the_printed_pair(example: tuple[Path, dict[str, Any]]) -> None:
    """Geometry, sliding and form factors at a shift of 0.21, calculated independently beforehand."""
    folder, found = example
    degree = 180 / 3.141592653589793
    expected = {
        "ring_shift": -0.16, "working_angle": 0.321344 * degree, "contact_ratio": 1.423027,
        "tip_angle_roller": 0.548150 * degree, "tip_angle_ring": 0.290545 * degree,
        "crossing_angle_roller": 0.611395 * degree, "crossing_angle_ring": 0.129231 * degree,
        "tip_land": 0.5 * 0.85162, "sliding_roller": 0.828725, "sliding_ring": 0.5719, "form_factor_roller": 2.12002,
        "stress_correction_roller": 1.86315, "form_factor_ring": 1.83107, "stress_correction_ring": 2.84399,
        "tangential_force": 51.943, "shift_sum": 0.05,
    }  # fmt: skip
    for name, number in expected.items():
        assert value(found, name) == pytest.approx(number, rel=2e-4), name
    for name in ("transmission_error", "wear_depth", "axial_shift", "friction_torque", "backlash"):
        assert value(found, name) == 0, name
    assert all(check["passed"] and check["margin"] > 0 for check in found["checks"])
    assert len(found["checks"]) == 11
    assert {path.name for path in folder.iterdir()} >= {"inputs.toml", "results.json", "run.json", "sheet.html"}


def test_the_optimum_stands_at_the_contact_ratio_by_box_and_by_grid(example: tuple[Path, dict[str, Any]]) -> None:
    _, found = example
    assert value(found, "optimal_shift_roller") == pytest.approx(0.2525, abs=2e-3)
    assert value(found, "optimal_shift_ring") == pytest.approx(-0.1175, abs=2e-3)
    assert value(found, "optimal_contact_ratio") == pytest.approx(1.4, abs=1e-5)
    assert value(found, "grid_shift") == pytest.approx(value(found, "optimal_shift_roller"), abs=1e-5)
    assert value(found, "most_stress_difference") == pytest.approx(33.2, abs=0.05)
    assert found["studies"]["shift"]["limits"] == ["margin_contact_ratio"]


def test_no_design_of_the_front_beats_another(example: tuple[Path, dict[str, Any]]) -> None:
    """A large sum is bought with a difference of the stresses."""
    _, found = example
    front = found["studies"]["optimise"]["front"]
    assert len(front) > 3
    assert all(design["feasible"] for design in front)
    goals = [
        (-design["objectives"]["shift_sum"], design["objectives"]["stress_difference"],
         design["objectives"]["sliding_difference"]) for design in front
    ]  # fmt: skip
    for one in goals:
        assert not any(other != one and all(a <= b for a, b in zip(other, one, strict=True)) for other in goals)


def test_where_no_shift_keeps_every_limit_the_sentence_says_what_is_missed() -> None:
    found = shifted("least_contact_ratio=2.5")
    assert any("keeps every limit" in text and "margin_contact_ratio" in text for text in found.warnings)


def test_an_objective_without_a_range_is_left_out_and_said() -> None:
    found = shifted("axial_load=0 N")
    assert any("difference of the root stresses is the same for every shift" in text for text in found.warnings)
    assert found.answers["weight_stress"] == 0
    assert found.answers["optimal_contact_ratio"] >= 1.4 - 1e-6


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("span=[1.0, -1.0]", "span"),
        ("points=3", "points = 3"),
        ("ratios=[0.5]", "ratios"),
        ("vertices=2", "vertices = 2"),
        ("reflection=0.9", "reflection"),
        ("spread=0", "spread"),
    ],
)
def test_a_study_that_cannot_be(calc: Calc, tmp_path: Path, setting: str, words: str) -> None:
    name, text = setting.split("=")
    (tmp_path / "screw.toml").write_text(f'plugin = "roller_screw_shift"\n[studies.shift]\n{name} = {text}\n')
    answer = calc("run", "roller_screw_shift", "--inputs", "screw.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("screw.toml:")
    assert words in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["screw.toml"]


def test_cases_over_shifts_name_the_one_that_is_too_large(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "shifts.csv").write_text("roller_shift\n0\n0.21\n0.4\n-0.5\n")
    few = ("--set", "studies.run=[]", "--set", "sheet.detail=short", "--json", "-o", "run")
    answer = calc("run", "roller_screw_shift", "--cases", "shifts.csv", *few)
    assert answer.code == 1
    found = json.loads(answer.out)
    ratios = [case["checks"] for case in found["cases"][:3]]
    passed = [next(c["passed"] for c in checks if c["name"] == "margin_contact_ratio") for checks in ratios]
    assert passed == [True, True, False]
    (failed,) = found["failed"]
    assert failed["row"] == 4
    assert "involute interference" in failed["reason"]


def test_loads_of_both_signs_and_none(table: Table) -> None:
    """Stresses are in proportion to the load, of whatever sign."""
    back, idle, forth, double = table("axial_load [N]\n-10000\n0\n10000\n20000\n")
    for name in ("root_stress_roller", "root_stress_ring"):
        assert idle[name] == 0
        assert back[name] == pytest.approx(forth[name], rel=ROUNDING)
        assert forth[name] > 50
        assert double[name] == pytest.approx(2 * forth[name], rel=1e-12)


def test_centres_farther_apart_jam_a_pair_without_backlash(table: Table) -> None:
    """First order: -2 tan(alpha_w) of the change."""
    near, far = table("centre_distance_deviation [um]\n-10\n10\n")
    assert near["backlash"] == pytest.approx(2 * 0.33288 * 10, rel=0.01)
    assert far["backlash"] == pytest.approx(-2 * 0.33288 * 10, rel=0.01)


def test_a_neutral_factor_acts_on_its_stress_alone(table: Table) -> None:
    plain, soft, shared = table("rim_factor,sharing_factor\n1,1\n1.5,1\n1,1.25\n")
    assert soft["root_stress_ring"] == pytest.approx(1.5 * plain["root_stress_ring"])
    assert soft["root_stress_roller"] == pytest.approx(plain["root_stress_roller"], rel=ROUNDING)
    assert shared["root_stress_roller"] == pytest.approx(1.25 * plain["root_stress_roller"])
    for changed in (soft, shared):
        assert changed["stress_difference"] == pytest.approx(plain["stress_difference"], rel=ROUNDING)


def test_verify_prints_every_row_with_its_verdict(calc: Calc) -> None:
    answer = calc("verify", "roller_screw_shift", "--json")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert all(row["as_stated"] for row in found["rows"])
    assert all(row["why"] for row in found["rows"] if row["verdict"] == "differs")
    rows = {row["name"]: row for row in found["rows"]}
    for name in ("sum of the shifts", "stress difference", "sliding difference"):
        assert rows[f"weight of the {name}"]["verdict"] == "differs"
    assert rows["largest stress difference"]["ratio"] == pytest.approx(1, abs=2e-3)
    near = rows["optimal shift of the roller, contact ratio 1.42"]
    assert near["ratio"] == pytest.approx(1, abs=0.03)
    assert near["obtained"] == "calibrated"
    for name in ("", ", contact ratio 1.2", ", printed weights"):
        assert rows[f"optimal shift of the roller{name}"]["verdict"] == "differs"
    titles = " ".join(finding["title"] for finding in found["findings"])
    for words in ("Table 1", "Indices 1 and 2", "printed weights", "contact ratio"):
        assert words in titles
