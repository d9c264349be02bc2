"""calc verify: a row that does not come out as its plugin states ends with exit code 1."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from own_pins import write_pin

from shared import Calc
from truing import Kernel

RIGHT = 'published=[Published(name="way", result="distance", value=360.0, unit="km", where="p. 3")]'
STATED = RIGHT.replace('where="p. 3"', 'verdict="differs", why="a misprint"')
WRONG = f"{RIGHT[:-1].replace('360.0', '450.0')}, {RIGHT.removeprefix('published=[')}"


def test_a_difference_that_nobody_states(calc: Calc, tmp_path: Path) -> None:
    write_pin(tmp_path, more=WRONG)
    answer = calc("verify", "./own_pin.py")
    assert answer.code == 1
    assert "0.8000  differs, NOT AS STATED" in answer.out
    assert "NOT as stated: way" in answer.out
    assert "(exit code 1)" in answer.out
    found = json.loads(calc("verify", "./own_pin.py", "--json").out)
    assert [row["as_stated"] for row in found["rows"]] == [False, True]
    assert [row["ratio"] for row in found["rows"]] == [0.8, 1.0]


def test_a_match_where_a_difference_is_stated(calc: Calc, tmp_path: Path) -> None:
    write_pin(tmp_path, more=STATED)
    answer = calc("verify", "./own_pin.py")
    assert answer.code == 1
    assert "matches, NOT AS STATED" in answer.out


def test_a_plugin_without_printed_numbers(calc: Calc, tmp_path: Path) -> None:
    write_pin(tmp_path)
    answer = calc("verify", "./own_pin.py")
    assert (answer.code, answer.out) == (0, "own_pin states no published numbers\n")
    assert json.loads(calc("verify", "./own_pin.py", "--json").out) == {"rows": [], "rules": {}, "findings": []}


TITLES = {
    "press_linkage": ("Misprint: the ground pivot angle", "Misprint: the unit of the tilt limit"),
    "rv_gearing": ("",),
    "harmonic_fractal": ("clearance", "weakest", "missing", "straight line"),
}


@pytest.mark.parametrize("plugin", TITLES)
def test_a_shipped_plugin_is_verified_row_by_row(calc: Calc, plugin: str) -> None:
    """What our numbers in the rows are is tested in tests/published, on every model."""
    answer = calc("verify", plugin, "--json")
    assert (answer.code, answer.err) == (0, "")
    document = json.loads(answer.out)
    model = Kernel.installed().offers[plugin].model
    rows = {row["name"]: row for row in document["rows"]}
    stated = {row.name: [row.value, dict(row.settings), row.obtained] for row in model.published}
    assert {name: [row["paper"], row["settings"], row["obtained"]] for name, row in rows.items()} == stated
    assert len(rows) > 10
    assert all(row["as_stated"] for row in rows.values())
    assert all(row["why"] for row in rows.values() if row["verdict"] == "differs")
    titles = " ".join(finding["title"] for finding in document["findings"])
    assert titles == " ".join(finding.title for finding in model.findings)
    assert all(words in titles for words in TITLES[plugin])


def test_settings_ratio_verdict_and_reasons_are_printed(calc: Calc) -> None:
    answer = calc("verify", "press_linkage")
    assert answer.code == 0
    lines = answer.out.split("\n")
    assert " ".join(lines[0].split()) == "quantity where unit paper ours ratio verdict obtained kind why"
    assert {"with reading = printed", "with reading = complete"} <= set(lines)
    (row,) = [line for line in lines if line.startswith("order of adjustment, l_g  ")]
    assert row.split()[-7:-1] == ["1.426", "1.4263", "1.0002", "matches", "calibrated", "calibrated"]
    number = row.split()[-1]
    assert any(line.startswith(f"{number} with the ground pivot angle 0.367 rad") for line in lines)
    assert sum(line.startswith("Finding: Misprint") for line in lines) >= 2
    assert lines[-2].endswith("every verdict is as stated")
