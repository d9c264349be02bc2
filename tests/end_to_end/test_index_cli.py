"""calc index: one page over a folder of runs; nothing that lies there can end it."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).parents[1] / "unit"))

from urllib.parse import unquote

from diagnosis_samples import SAMPLES
from made_runs import check, made_runs, run, written

from shared import Calc
from truing.runs.diagnosis_document import diagnosis_document

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@pytest.fixture
def listed(calc: Calc, tmp_path: Path) -> dict[str, Any]:
    """What is said of the folder of every kind, by name."""
    made_runs(tmp_path / "runs")
    answer = calc("index", "runs", "--json", "-q")
    assert (answer.code, answer.err) == (0, "")
    document = json.loads(answer.out)
    return {entry["name"]: entry for entry in document["entries"]} | {
        other["name"]: other["sentence"] for other in document["others"]
    }


def test_a_run_is_listed_with_what_matters_most(listed: dict[str, Any]) -> None:
    first = listed["first"]
    assert (first["kind"], first["model"], first["version"], first["date"]) == (
        "run", "press", "1.2", "2026-11-02 08:00",
    )  # fmt: skip
    assert first["head"] == {"project": "Werk Nord", "drawing": "D-9"}
    assert (first["verdict"], first["state"], first["checks"], first["failed"]) == ("passes", "passes", 2, 0)
    assert [one["name"] for one in first["findings"]] == ["shift", "tilt"]
    assert first["margin"] == 0.05
    deep = listed["later/deep"]
    assert (deep["verdict"], deep["failed"], deep["margin"], deep["warnings"]) == ("fails: stress", 1, -0.2, 2)
    assert deep["sheet"] == "later/deep/sheet.html"


def test_a_run_without_limits_shows_its_first_results(listed: dict[str, Any]) -> None:
    free = listed["no_limits"]
    assert (free["verdict"], free["state"], free["margin"]) == ("no limits", None, None)
    assert [(one["name"], one["value"], one["unit"]) for one in free["findings"]] == [("stroke", 12.5, "mm")]


def test_a_diagnosis_is_listed_with_its_verdict_and_causes(listed: dict[str, Any]) -> None:
    assert listed["calm"]["verdict"] == "nothing found"
    found = listed["found"]
    assert found["verdict"] == "cause named: joint_clearance"
    assert found["findings"][0]["value"] == 5.974


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("broken", "its results.json is damaged: no JSON"),
        ("strange", "its results.json is no truing.results/1 document"),
        ("changed", "its results.json is not as calc run writes it"),
        ("photos", "holds no run and no diagnosis"),
        ("kept.partial", "finished batches of an interrupted run; calc run --resume takes them up"),
        ("empty", "is empty"),
    ],
)
def test_what_is_foreign_or_damaged_is_said(listed: dict[str, Any], name: str, sentence: str) -> None:
    assert listed[name] == sentence


def test_the_page_is_written_beside_the_runs_and_its_links_arrive(calc: Calc, tmp_path: Path) -> None:
    made_runs(tmp_path / "runs")
    answer = calc("index", "runs")
    assert answer.code == 0
    assert answer.out == f"4 runs (1 fails), 2 diagnoses, 6 other folders\nindex: {Path('runs') / 'index.html'}\n"
    assert f"note: {Path('runs') / 'broken'}: its results.json is damaged: no JSON\n" in answer.err
    first = (tmp_path / "runs" / "index.html").read_text(encoding="utf-8")
    links = re.findall(r'href="([^"]+)"', first)
    assert len(links) == 6
    assert all((tmp_path / "runs" / unquote(link)).is_file() for link in links)
    assert calc("index", "runs", "-o", "all.html", "-q").code == 0
    links = re.findall(r'href="([^"]+)"', (tmp_path / "all.html").read_text(encoding="utf-8"))
    assert all((tmp_path / unquote(link)).is_file() for link in links)
    assert calc("index", "runs", "-q").code == 0
    assert (tmp_path / "runs" / "index.html").read_text(encoding="utf-8") == first


def test_a_hostile_name_is_a_name(calc: Calc, tmp_path: Path) -> None:
    made_runs(tmp_path / "runs")
    calc("index", "runs", "-q")
    text = (tmp_path / "runs" / "index.html").read_text(encoding="utf-8")
    assert "<img" not in text
    assert "&lt;img src=x onerror=alert(1)&gt; {{7*7}}" in text
    assert "49" not in re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL).partition("<tbody")[2]


def test_what_the_verbs_write_is_what_the_index_reads(calc: Calc, tmp_path: Path) -> None:
    calc("run", PIN, "-q", "--set", "studies.run=[]", "-o", "runs/pin")
    for name, sample in SAMPLES.items():
        written(tmp_path / "runs" / name, "diagnosis.json", json.loads(json.dumps(diagnosis_document(sample()))))
    entries = {entry["name"]: entry for entry in json.loads(calc("index", "runs", "--json", "-q").out)["entries"]}
    assert entries["pin"]["findings"][0]["name"] == "pressure"
    assert entries["pin"]["sheet"] == "pin/sheet.html"
    assert entries["none"]["verdict"] == "nothing found"
    assert entries["unknown"]["verdict"] == "cause unknown"
    assert entries["remainder"]["verdict"].endswith("; a remainder left")
    assert entries["ambiguous"]["verdict"] == "one of several causes: rod_heating or warm_up or sensor_drift"


def test_cases_count_each_and_the_least_margin_is_that_of_all(calc: Calc, tmp_path: Path) -> None:
    cases = [
        {"row": 1, "checks": [check("tilt", 9.0, 10.0, 0.1)], "failed": None},
        {"row": 2, "checks": [check("tilt", 9.8, 10.0, 0.02)], "failed": None},
        {"row": 3, "checks": [], "failed": "the rod cannot reach"},
    ]
    run(tmp_path / "runs" / "many", check("tilt", 9.8, 10.0, 0.02), cases=cases, verdict="fails")
    (entry,) = json.loads(calc("index", "--json", "-q").out)["entries"]
    assert (entry["cases"], entry["checks"], entry["margin"]) == (3, 2, 0.02)
    assert (entry["verdict"], entry["state"]) == ("fails: a case", "fails")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["nowhere"], "calc: nowhere: no such folder\n"),
        (["letter.txt"], "calc: letter.txt: is a file; name the folder that holds the runs\n"),
        (["runs", "-o", "letter.txt"], "calc: letter.txt: is a file that calc index has not written, so it is left "
         "alone; name another\n"),
        (["runs", "-o", "runs"], f"calc: runs: is a folder; name a file, such as {Path('runs') / 'index.html'}\n"),
        (["runs", "-o", "letter.txt/index.html"], f"calc: {Path('letter.txt') / 'index.html'}: cannot be written: "
         "letter.txt is a file and no folder\n"),
    ],
)  # fmt: skip
def test_bad_input_ends_in_one_sentence(calc: Calc, tmp_path: Path, words: list[str], sentence: str) -> None:
    written(tmp_path, "letter.txt", "mine")
    run(tmp_path / "runs" / "first")
    answer = calc("index", *words)
    assert (answer.code, answer.out, answer.err) == (2, "", sentence)
    assert (tmp_path / "letter.txt").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "symlink") or sys.platform == "win32", reason="links need rights there")
def test_links_are_named_and_not_followed(calc: Calc, tmp_path: Path) -> None:
    run(tmp_path / "runs" / "first")
    (tmp_path / "runs" / "around").symlink_to(tmp_path / "runs")
    document = json.loads(calc("index", "runs", "--json", "-q").out)
    assert [entry["name"] for entry in document["entries"]] == ["first"]
    assert document["others"] == [{"name": "around", "sentence": "is a link and was not followed"}]
