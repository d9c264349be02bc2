"""calc run --cases: every row is a case, one governs, all of them stand on the sheet and in results.json."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from shared import Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
QUICK = ("--set", "studies.reliability.draws=2000")


def test_a_case_that_fails_is_said_with_its_line(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("load [kN]\n0.14\n\n500\n")
    answer = calc("run", PIN, "--cases", "cases.csv", "-q", *QUICK)
    assert answer.code == 1
    assert answer.err == "cases.csv:4: the contact flows: load exceeds hardness times area\n"
    found = json.loads((tmp_path / "runs/pin_wear/results.json").read_text(encoding="utf-8"))
    assert found["failed"] == [{"row": 2, "reason": "the contact flows: load exceeds hardness times area"}]
    assert " failed" in answer.out


def test_no_case_is_possible(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("load [kN]\n500\n600\n")
    answer = calc("run", PIN, "--cases", "cases.csv", "-q", *QUICK)
    assert (answer.code, answer.out) == (2, "")
    sentence = "the contact flows: load exceeds hardness times area"
    assert answer.err == f"cases.csv:2: {sentence}\ncases.csv:3: {sentence}\n"
    assert not (tmp_path / "runs").exists()


@pytest.fixture
def shared_out(calc: Calc, tmp_path: Path, runs_share_processes: None) -> Callable[..., Any]:
    """Run with two workers and return the document of the run."""

    def run(*words: str) -> Any:
        answer = calc("run", PIN, "--cases", "cases.csv", "-q", *words, "--workers", "2", "-o", "2")
        assert answer.code in {0, 1}, answer.err
        assert json.loads((tmp_path / "2/run.json").read_text(encoding="utf-8"))["workers"]["count"] == 2
        return json.loads((tmp_path / "2/results.json").read_text(encoding="utf-8"))

    return run


def test_cases_with_studies_are_shared_out(calc: Calc, shared_out: Callable[..., Any], tmp_path: Path) -> None:
    """Six cases for two workers, one of them impossible; one limit is on a chance, so each case runs its studies."""
    (tmp_path / "cases.csv").write_text("load [N]\n140\n2200\n500000\n2230\n180\n190\n")
    found = shared_out(*QUICK)
    assert calc("run", PIN, "--cases", "cases.csv", "-q", *QUICK, "-o", "1").code == 1
    assert (tmp_path / "1/results.json").read_bytes() == (tmp_path / "2/results.json").read_bytes()
    assert [case["governing"] for case in found["cases"]] == [False, False, False, True, False, False]
    assert [item["row"] for item in found["failed"]] == [3]


def test_cases_in_blocks_are_shared_out(shared_out: Callable[..., Any], tmp_path: Path) -> None:
    """2500 cases are three array calls; their loads run from 100 N to 2599 N on 28 mm²."""
    rows = "\n".join(str(100 + row) for row in range(2500))
    (tmp_path / "cases.csv").write_text(f"load [N]\n{rows}\n")
    found = shared_out("--set", "studies.run=[]")
    pressures = [case["results"]["pressure"]["value"] for case in found["cases"]]
    assert pressures == pytest.approx([(100 + row) / 28 for row in range(2500)])
