"""A folder of runs and diagnoses, written by hand as small as documents may be, with hostile names among them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

HOSTILE = "<img src=x onerror=alert(1)> {{7*7}} #?%20&'"
LONG = "wear_of_the_third_joint_of_the_left_knee_drive_in_micrometres_per_million_strokes"


def written(folder: Path, name: str, document: Any) -> None:
    """Write a document into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    text = document if isinstance(document, str) else json.dumps(document)
    (folder / name).write_text(text, encoding="utf-8")


def check(name: str, value: float, limit: float, margin: float, unit: str = "mm") -> dict[str, Any]:
    """One check of results.json."""
    state, relation = ("passes" if margin >= 0 else "fails"), "≤" if (limit - value) * margin >= 0 else "≥"
    numbers = {"name": name, "value": value, "limit": limit, "unit": unit, "margin": margin}
    return {**numbers, "compared": name, "relation": relation, "state": state, "passed": margin >= 0}


def run(folder: Path, *checks: dict[str, Any], date: str = "", head: str = "", **more: Any) -> None:
    """Write what the index reads of a run."""
    states = [one["state"] for one in checks]
    document = {
        "verdict": "fails" if "fails" in states else "passes",
        "schema": "truing.results/1", "plugin": {"name": "press", "version": "1.2", "model": "press"}, "kernel": "0.1",
        "results": {"stroke": {"value": 12.5, "unit": "mm"}}, "checks": list(checks), "warnings": [], **more,
    }  # fmt: skip
    _complete(folder, "results.json", document, date, head)


def diagnosis(folder: Path, *, date: str = "", head: str = "", **more: Any) -> None:
    """Write what the index reads of a diagnosis."""
    document = {
        "schema": "truing.diagnosis/1", "plugin": {"name": "press", "version": "1.2", "model": "press"},
        "verdict": "none", "causes": [], "unique": True, "remainder": None, "warnings": [], **more,
    }  # fmt: skip
    _complete(folder, "diagnosis.json", document, date, head)


def _complete(folder: Path, name: str, document: dict[str, Any], date: str, head: str) -> None:
    written(folder, name, document)
    if date:
        written(folder, "run.json", {"schema": "truing.run/1", "date": date})
    if head:
        written(folder, "inputs.toml", f"[sheet]\n{head}\n")
    written(folder, "sheet.html", "<!DOCTYPE html><title>a sheet</title>")


CLEARANCE = {"effect": "joint_clearance", "unknowns": {"clearance": {"value": 5.974, "unit": "um"}}}


def made_runs(root: Path) -> Path:
    """Write runs and diagnoses of every kind, nested, damaged and foreign folders among them."""
    tight = (check("tilt", 9.0, 10.0, 0.1), check("shift", 95.0, 100.0, 0.05, "um"))
    broken = check("stress", 120.0, 100.0, -0.2, "MPa")
    run(root / "first", *tight, date="2026-11-02T08:00:00+0100", head='project = "Werk Nord"\ndrawing = "D-9"')
    run(root / "later" / "deep", *tight, broken, date="2026-11-12T08:00:00+0100", warnings=["w1", "w2"])
    run(root / "no_limits", date="2026-01-30T08:00:00+0000")
    run(root / f"{HOSTILE} {LONG}", check(HOSTILE, 1.0, 2.0, 0.5), head=f"project = '''{HOSTILE[:-1]}'''")
    diagnosis(root / "calm", date="2026-11-12T03:30:00-0500", warnings=["w"])
    diagnosis(root / "found", date="2026-11-03T08:00:00+0100", verdict="named", causes=[CLEARANCE], unique=False)
    written(root / "broken", "results.json", "{")
    written(root / "strange", "results.json", {"schema": "truing.results/9"})
    written(root / "changed", "results.json", {"schema": "truing.results/1", "plugin": 7})
    written(root / "photos", "a.jpg", "no photo")
    written(root / "kept.partial", "partial.json", "{}")
    (root / "empty").mkdir()
    (root / ".first.x.part").mkdir()
    return root
