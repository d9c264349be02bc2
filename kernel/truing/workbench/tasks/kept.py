"""Runs and diagnoses that lie in the folder: listed, what changed since the one before, two of them side by side."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from truing.api.differences import differences_of_paths
from truing.api.model import LoadedModel
from truing.errors import TruingError, UsageError
from truing.numbers import pretty
from truing.report.comparison_page import comparison_page
from truing.report.html_printer import html_of
from truing.report.index_page import margin_words
from truing.report.word_printer import demand_word_library
from truing.runs.comparison import Change, compared, in_order, words_of
from truing.runs.folder import load_either
from truing.runs.index import FolderEntry, entry_at
from truing.runs.spreadsheet import run_workbook
from truing.studies.bench import Progress
from truing.templating import ENGLISH
from truing.workbench.tasks.loaded import loaded, stamp_of
from truing.workbooks.writing import demand_library

READ = ("results.json", "diagnosis.json", "run.json", "inputs.toml", "sheet.html")
"""What an entry of the list is read from: where one of them is another, the entry is read again."""
SHOWN = (
    "name", "kind", "model", "version", "date", "stamp", "head", "verdict", "state", "cases", "margin", "warnings",
    "sheet",
)  # fmt: skip
MOST_CHANGES = 3
"""So many changes are named in the list; the page that compares two names all."""
NOT_NAMED = {"results", "studies", "wrong", "gain", "data"}
"""What follows from the rest is not named in the list."""


def listed(root: str, folders: Sequence[str]) -> dict[str, Any]:
    """Return what the folders hold: runs and diagnoses, the newest first, and those that cannot be read."""
    rows, others = list[dict[str, Any]](), list[dict[str, str]]()
    for name in folders:
        path = Path(root, name)
        row = _row(str(path), name, _stamps(path))
        if row is not None:
            (rows if "kind" in row else others).append(row)
    return {"entries": sorted(rows, key=lambda row: -(row["stamp"] or 0.0)), "others": others}


def _stamps(path: Path) -> tuple[tuple[int, int], ...]:
    """Return time and size of what an entry is read from; two zeros for what is not there."""
    return tuple(map(stamp_of, (path / name for name in READ)))


@lru_cache(maxsize=5000)
def _row(path: str, name: str, stamps: tuple[tuple[int, int], ...]) -> dict[str, Any] | None:
    made = entry_at(Path(path), name)
    if made is None:
        return None
    if not isinstance(made, FolderEntry):
        return {"name": name, "sentence": made.sentence}
    row = {name: getattr(made, name) for name in SHOWN}
    return {**row, "margin_words": margin_words(made)}


def changed(root: str, pairs: Sequence[Sequence[str]]) -> dict[str, str]:
    """Say in a few words how each second folder differs from the first; by the name of the second."""
    said = {}
    for before, after in pairs:
        paths = Path(root, before), Path(root, after)
        said[after] = _changed(*map(str, paths), tuple(map(_stamps, paths)))
    return said


@lru_cache(maxsize=5000)
def _changed(before: str, after: str, stamps: tuple[tuple[tuple[int, int], ...], ...]) -> str:
    try:
        documents = [load_either(Path(folder)) for folder in (before, after)]
        return words_of_changes(in_order(compared(*documents)))
    except (TruingError, KeyError, TypeError, ValueError, AttributeError):
        return "cannot be compared"


def words_of_changes(changes: Sequence[Change]) -> str:
    """Say the first of the changes: what was stated otherwise, before which limit has another state."""
    if not changes:
        return "nothing"
    causes = [change for change in changes if change.kind not in {*NOT_NAMED, "checks"}]
    named = [*causes, *(change for change in changes if change.flipped)]
    words = [_said(change) for change in named[:MOST_CHANGES]]
    rest = len(named) - len(words)
    if not named:
        return "results only"
    return "; ".join(words) + (f"; {rest} more" if rest else "")


def _said(change: Change) -> str:
    kind, name, before, after, amount = words_of(change)
    if change.flipped:
        return f"{name} {amount.partition(',')[0]}"
    if kind == "settings" and name == "plugin":
        return "another version of the calculation"
    name = name if kind in {"inputs", "conditions", "settings", "verdict", "causes"} else f"{kind} {name}"
    if amount in {"new", "gone"}:
        return f"{name} {amount}"
    return f"{name} {pretty(before)} → {pretty(after)}"


def compared_page(before: str, after: str) -> str:
    """Return the page of ``calc compare`` of two folders. Raises UsageError for a run beside a diagnosis."""

    def refused(plugin: str, file: Path) -> Any:
        raise UsageError(f"{file.name} is no folder of a run; choose two of the list")

    return html_of(comparison_page(*differences_of_paths(before, after, refused).sides(ENGLISH)))


def workbook(folder: str) -> str:
    """Return the tables of a run as an .xlsx workbook, from its document; its bytes as base64."""
    document: Mapping[str, Any] = load_either(Path(folder))
    named = str((document.get("plugin") or {}).get("model", ""))
    if str(document.get("schema")).startswith("truing.diagnosis"):
        raise UsageError("the workbook of a diagnosis is written by calc diagnose --xlsx")
    if named.endswith(".py"):
        raise UsageError("the run names a file as its calculation")
    demand_library()
    return base64.b64encode(run_workbook(document, loaded(named).model)).decode()


def word(folder: str, plugin: str, progress: Progress) -> dict[str, str]:
    """Calculate a run again and put its sheet beside it as a Word document.

    Raises UsageError where the numbers are others than those of the run: the document would not be its sheet.
    """
    demand_word_library()
    path = Path(folder)
    made = LoadedModel(loaded(plugin)).run(path / "inputs.toml", progress=progress)
    if compared(load_either(path), json.loads(json.dumps(made.document))):
        raise UsageError("calculated again the run has other numbers, so it gets no Word document; run its file again")
    return {"written": made.sheet(path / "sheet.docx").name}
