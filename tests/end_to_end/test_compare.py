"""calc compare: what changed between two runs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from shared import Calc
from truing.runs.comparison import Change, changes, differing

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@pytest.fixture
def runs(calc: Calc) -> Calc:
    """Make three runs: two alike, and one with another load."""
    for name, more in (("first", ()), ("again", ()), ("heavy", ("--set", "load=2300 N"))):
        answer = calc("run", PIN, "-q", "-o", name, *more)
        assert answer.code in {0, 1}
    return calc


def test_equal_runs(runs: Calc) -> None:
    answer = runs("compare", "first", "again")
    assert (answer.code, answer.out, answer.err) == (0, "equal\n", "")
    assert json.loads(runs("compare", "first", "again", "--json").out) == {"equal": True, "changes": []}


def test_different_runs(runs: Calc) -> None:
    answer = runs("compare", "first", "heavy")
    assert (answer.code, answer.err) == (1, "")
    lines = [" ".join(line.split()) for line in answer.out.split("\n")]
    assert lines[0] == "what name first heavy"
    assert "inputs load 120 N 2300 N" in lines
    assert "results pressure 4.2857143 MPa 82.142857 MPa" in lines
    assert not any(line.startswith("results distance") for line in lines)
    assert any(line.startswith("checks pressure 1 ") and line.endswith("(fails)") for line in lines)


def test_different_runs_as_json(runs: Calc) -> None:
    answer = runs("compare", "first", "heavy", "--json")
    assert answer.code == 1
    found = json.loads(answer.out)
    assert found["equal"] is False
    first = found["changes"][0]
    assert first == {
        "kind": "inputs",
        "name": "load",
        "before": {"value": 120.0, "unit": "N"},
        "after": {"value": 2300.0, "unit": "N"},
    }


@pytest.mark.parametrize("content", [None, "{}", "{", '{"schema": "truing.results/9"}'])
def test_what_is_no_run_is_refused(runs: Calc, tmp_path: Path, content: str | None) -> None:
    (tmp_path / "other").mkdir()
    if content is not None:
        (tmp_path / "other/results.json").write_text(content)
    answer = runs("compare", "first", "other")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("calc: other")
    assert answer.err.count("\n") == 1


def test_a_name_that_one_run_lacks() -> None:
    before = {"results": {"a": {"value": 1.0, "unit": ""}}, "checks": [], "seed": 1}
    after = {"results": {"b": {"value": 1.0, "unit": ""}}, "checks": [{"name": "c", "passed": True}], "seed": 1}
    assert changes(before, after) == [
        Change("results", "a", {"value": 1.0, "unit": ""}, None),
        Change("results", "b", None, {"value": 1.0, "unit": ""}),
        Change("checks", "c", None, {"passed": True}),
    ]


def test_versions_and_seeds_are_settings() -> None:
    before, after = {"kernel": "0.1.0", "seed": 1}, {"kernel": "0.2.0", "seed": 2}
    assert [(item.kind, item.name) for item in changes(before, after)] == [("settings", "kernel"), ("settings", "seed")]
    assert changes(before, before) == []


def test_rounding_is_no_change_and_a_change_beyond_it_is() -> None:
    before = {"results": {"a": {"value": 1.0, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.0], "y": None}}}
    rounded = {"results": {"a": {"value": 1.0 + 4e-16, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.0], "y": None}}}
    assert changes(before, rounded) == []
    changed = {"results": {"a": {"value": 1.0 + 1e-11, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.1], "y": 3.0}}}
    assert [(item.kind, item.name) for item in changes(before, changed)] == [("results", "a"), ("studies", "s")]
    assert differing(before["studies"], changed["studies"]) == 2


def test_tolerances_effects_and_studies_in_words(calc: Calc, tmp_path: Path) -> None:
    warm = '[effects.warm_probe]\nslope = "1 um/K"\n[tolerances]\nload = "sd 1 %"\n'
    (tmp_path / "warm.toml").write_text(warm, encoding="utf-8")
    calc("run", PIN, "-q", "-o", "cold")
    calc("run", PIN, "-q", "-o", "warm", "--inputs", "warm.toml")
    lines = [" ".join(line.split()) for line in calc("compare", "cold", "warm").out.split("\n")]
    assert "tolerances load sd 3 % sd 1 %" in lines
    assert "effects warm_probe - slope = 1 um/K" in lines
    assert any(
        line.startswith("studies reliability ") and line.endswith("values differ (see results.json)") for line in lines
    )
