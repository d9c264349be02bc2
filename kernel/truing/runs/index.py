"""What lies in a folder of runs and diagnoses: one entry for each, read from its documents, and a word on the rest."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pydantic.dataclasses import dataclass as validated

from truing.errors import UnknownPluginError
from truing.runs.folder import DOCUMENTS, FolderKind
from truing.runs.partial import HEADER
from truing.studies.checks import HEADLINES, State
from truing.studies.verdicts import worst

DEEPEST = 20
LARGEST = 100_000_000
"""A larger document is not read."""
HEAD = ("project", "drawing", "revision")
VERDICTS = {
    "none": "nothing found", "undecided": "undecided", "unknown": "cause unknown", "named": "cause named",
    "one_of": "one of several causes",
}  # fmt: skip


@validated(frozen=True, kw_only=True, config={"strict": True})
class ListedNumber:
    """One number of an entry: a check with its limit and margin, a result, or the size of a cause."""

    name: str
    value: float | None
    unit: str = ""
    limit: float | None = None
    margin: float | None = None
    relation: str = ""
    state: State | None = None


@dataclass(frozen=True, kw_only=True)
class FolderEntry:
    """A run or a diagnosis; ``name`` is its path below the folder, ``sheet`` that of its sheet, or nothing.

    ``date`` is when it was made, as in run.json, ``stamp`` the same as seconds since 1970. ``findings`` hold the checks
    of a run, least margin first (without checks its first results), or the sizes of the causes of a diagnosis.
    """

    name: str
    kind: FolderKind
    model: str
    plugin: str
    version: str
    date: str = ""
    stamp: float | None = None
    head: Mapping[str, str]
    verdict: str
    state: State | None = None
    checks: int = 0
    failed: int = 0
    cases: int = 0
    findings: tuple[ListedNumber, ...] = ()
    warnings: int = 0
    sheet: str = ""

    @property
    def margin(self) -> float | None:
        """The smallest margin of all checks, as a share of the limit."""
        return next((one.margin for one in self.findings if one.margin is not None), None)


@dataclass(frozen=True)
class Other:
    """A folder that is neither run nor diagnosis, or cannot be read: its path below the folder, and a sentence."""

    name: str
    sentence: str


@dataclass(frozen=True)
class Listing:
    """Everything that was found, newest first, and what was left out."""

    folder: str
    entries: tuple[FolderEntry, ...]
    others: tuple[Other, ...]


class _DamagedError(Exception):
    """A document that is not as it was written."""


def list_folder(folder: Path) -> Listing:
    """Read every run and diagnosis in a folder, however deep; links are not followed, hidden folders not opened.

    Raises UnknownPluginError where there is no such folder.
    """
    if not folder.is_dir():
        what = "is a file; name the folder that holds the runs" if folder.exists() else "no such folder"
        raise UnknownPluginError(f"{folder}: {what}")
    listed = sorted(_walk(folder, folder, 0), key=lambda entry: entry.name)
    entries = [entry for entry in listed if isinstance(entry, FolderEntry)]
    others = [entry for entry in listed if isinstance(entry, Other)]
    return Listing(str(folder), tuple(sorted(entries, key=lambda entry: -(entry.stamp or 0.0))), tuple(others))


def _walk(root: Path, path: Path, depth: int) -> Iterator[FolderEntry | Other]:
    """Yield what a folder is or holds; one with neither run nor diagnosis in it is said to be foreign."""
    name = path.relative_to(root).as_posix()
    made = entry_at(path, name if name != "." else root.absolute().name)
    if made is not None:
        yield made
        return
    try:
        inside = sorted(os.scandir(path), key=lambda child: child.name)
    except OSError as error:
        yield Other(name, f"cannot be read: {error.strerror or error}")
        return
    if (path / HEADER).exists():
        yield Other(name, "finished batches of an interrupted run; calc run --resume takes them up")
        return
    folders = [child for child in inside if child.is_dir() and not child.name.startswith(".")]
    if depth >= DEEPEST and folders:
        yield Other(name, f"lies {DEEPEST} folders deep; what is below it was not looked at")
        return
    for child in folders:
        if child.is_symlink():
            yield Other((path / child.name).relative_to(root).as_posix(), "is a link and was not followed")
        else:
            yield from _walk(root, path / child.name, depth + 1)
    if depth and not folders:
        yield Other(name, "holds no run and no diagnosis" if inside else "is empty")


def entry_at(path: Path, name: str) -> FolderEntry | Other | None:
    """Read the run or diagnosis that a folder is; None where it is neither, Other where it cannot be read."""
    kind = next((kind for kind, (document, _) in DOCUMENTS.items() if (path / document).exists()), None)
    if kind is None:
        return None
    try:
        return _entry(path, name, kind)
    except (_DamagedError, RecursionError) as fault:
        return Other(name, str(fault) or "its documents are nested too deeply")


def _entry(path: Path, name: str, kind: FolderKind) -> FolderEntry:
    document_name, schema = DOCUMENTS[kind]
    document = _json(path / document_name)
    if document.get("schema") != schema:
        raise _DamagedError(f"its {document_name} is no {schema} document")
    try:
        entry = _of_run(document, name) if kind == "run" else _of_diagnosis(document, name)
    except (KeyError, TypeError, ValueError, AttributeError):
        verb = "run" if kind == "run" else "diagnose"
        raise _DamagedError(f"its {document_name} is not as calc {verb} writes it") from None
    date, stamp = _date(path / "run.json")
    sheet = f"{name}/sheet.html" if (path / "sheet.html").is_file() else ""
    return replace(entry, date=date, stamp=stamp, head=_head(path / "inputs.toml"), sheet=sheet)


def _json(path: Path) -> dict[str, Any]:
    try:
        if not path.is_file() or path.stat().st_size > LARGEST:
            raise _DamagedError(f"its {path.name} is {'too large' if path.is_file() else 'no ordinary file'}")
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise _DamagedError(f"its {path.name} cannot be read: {error.strerror or error}") from None
    except ValueError:
        raise _DamagedError(f"its {path.name} is damaged: no JSON") from None
    if not isinstance(document, dict):
        raise _DamagedError(f"its {path.name} is damaged: no JSON object")
    return document


def _of_run(document: Mapping[str, Any], name: str) -> FolderEntry:
    cases = list(document.get("cases") or [])
    stated = [check for each in (cases or [document]) for check in each["checks"]]
    checks = [  # an older run has no state
        ListedNumber(**{"state": "passes" if check["passed"] else "fails", **check}) for check in stated
    ]
    impossible = any(case.get("failed") is not None for case in cases)
    states = {check.name: check.state for check in checks if check.state not in {None, "passes"}}
    verdict = worst(check.state for check in checks if check.state is not None) if not impossible else "fails"
    state: State | None = document.get("verdict", verdict) if checks or impossible else None
    concerned = ", ".join(name for name, of_one in states.items() if of_one == state)
    words = "no limits" if state is None else HEADLINES[state].lower()
    words += f": {concerned or 'a case'}" if state not in {None, "passes"} else ""
    failed = [check for check in checks if check.state != "passes"]
    ranked = sorted(checks, key=lambda one: float("-inf") if one.margin is None else one.margin)
    first_results = (
        ListedNumber(name=str(name), value=float(result["value"]), unit=str(result["unit"]))
        for name, result in document["results"].items()
        if isinstance(result["value"], (int, float)) and not isinstance(result["value"], bool)
    )
    return FolderEntry(
        **_made_by(document, name, "run"), verdict=words, state=state, checks=len(checks), failed=len(failed),
        cases=len(cases), findings=tuple(ranked or first_results),
    )  # fmt: skip


def _made_by(document: Mapping[str, Any], name: str, kind: FolderKind) -> dict[str, Any]:
    plugin = document["plugin"]
    named = {"model": plugin["model"], "plugin": plugin["name"], "version": plugin["version"]}
    warnings = len(document.get("warnings") or [])
    return {"name": name, "kind": kind, "warnings": warnings, "head": {}} | {key: str(v) for key, v in named.items()}


def _of_diagnosis(document: Mapping[str, Any], name: str) -> FolderEntry:
    causes = document["causes"]
    words = VERDICTS[document["verdict"]]
    if document["verdict"] == "one_of":
        words = f"{words}: {' or '.join(' and '.join(names) for names in document['explanations'])}"
    elif causes:
        words = f"{words}: {' and '.join(str(cause['effect']) for cause in causes)}"
        words += " in doubt" if document["verdict"] == "undecided" else ""
    if document.get("remainder") and document["verdict"] == "named":
        words += "; a remainder left"
    sizes = [
        ListedNumber(name=f"{cause['effect']} {unknown}", value=size["value"], unit=size["unit"])
        for cause in causes
        for unknown, size in cause["unknowns"].items()
    ]
    return FolderEntry(**_made_by(document, name, "diagnosis"), verdict=words, findings=tuple(sizes))


def _date(path: Path) -> tuple[str, float | None]:
    """Return when it was made, in words and in seconds since 1970; nothing where run.json does not say."""
    try:
        made = datetime.fromisoformat(str(_json(path).get("date")))
        stamp = (made if made.tzinfo else made.replace(tzinfo=UTC)).timestamp()
    except (_DamagedError, ValueError, OverflowError, OSError):
        return "", None
    return made.strftime("%Y-%m-%d %H:%M"), stamp


_SHEET = re.compile(r"^\[sheet\][^\n]*\n(?:(?!\[)[^\n]*\n?)*", re.MULTILINE)
"""The lines of the section of the sheet, in a text without quotations over several lines."""


def _head(path: Path) -> dict[str, str]:
    """Return project, drawing and revision of the inputs file beside the documents."""
    try:
        text = path.read_text(encoding="utf-8")
        stated = _sheet_of(text)
    except (OSError, ValueError, RecursionError):
        return {}
    if not isinstance(stated, Mapping):
        return {}
    return {name: str(stated[name]) for name in HEAD if str(stated.get(name) or "").strip()}


def _sheet_of(text: str) -> Any:
    """Return the section of the sheet. It is read alone where that can be done: a long file takes twenty times as long.

    Raises ValueError for what is no TOML.
    """
    lines = _SHEET.search(text) if '"""' not in text and "'''" not in text else None
    if lines is not None:
        with suppress(ValueError):
            return tomllib.loads(lines[0]).get("sheet")
    return tomllib.loads(text).get("sheet")
