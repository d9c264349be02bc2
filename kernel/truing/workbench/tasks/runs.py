"""Runs: made from a file, the last one beside the text that is being edited."""

from __future__ import annotations

import re
from dataclasses import asdict
from html import unescape
from pathlib import Path
from typing import Any

from truing.api.model import LoadedModel
from truing.errors import InputError, TruingError, UsageError
from truing.inputs_file import read_setup, setup_from_text
from truing.runs.folder import load_either
from truing.runs.index import list_folder
from truing.runs.inputs_written import input_hash, stated_differences
from truing.studies.bench import Progress
from truing.workbench.tasks.loaded import changed_since, loaded

CHAPTER = re.compile(
    r'<section id="([\w-]+)" class="chapter"[^>]*>\s*'
    r'<h2[^>]*>(?:<span class="place">.*?</span>)?(.*?)</h2>.*?</section>',
    re.DOTALL,
)
"""A chapter of a sheet that our printer wrote: its identifier and its title."""
MOST_DIFFERENCES = 12


def run(plugin: str, file: str, output: str, root: str, progress: Progress) -> dict[str, Any]:
    """Run a file with its studies and write its folder; return where it is and its verdict."""
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    made = LoadedModel(loaded(plugin)).run(Path(file), output=Path(output), progress=progress)
    name = Path(output).relative_to(root).as_posix()
    return {"folder": name, "verdict": made.verdict, "sheet": f"{name}/sheet.html"}


def last(plugin: str, file: str, folder: str, text: str, *, run: str, root: str) -> dict[str, Any]:
    """Return the run of a file beside its text: whether what the text states differs, and in what; its chapters.

    ``runs`` are all runs of the same calculation in the folder, the newest first.
    """
    offer = loaded(plugin)
    entries = list_folder(Path(root)).entries
    runs = [asdict(entry) for entry in entries if entry.kind == "run" and entry.model == offer.model.name]
    shown = ("name", "date", "verdict", "state", "sheet")
    answer: dict[str, Any] = {"runs": [{name: each[name] for name in shown} for each in runs], "run": None}
    name = Path(run).relative_to(root).as_posix()
    own = next((each for each in answer["runs"] if each["name"] == name), None)
    if own is None:
        return answer
    older, differences = _older(plugin, file, folder, text, Path(run))
    chapters = [{"ident": ident, "title": title} for ident, title, _ in _chapters(Path(run)) if ident[:8] == "chapter-"]
    return {**answer, "run": own, "older": older, "differences": differences, "chapters": chapters}


def _older(plugin: str, file: str, folder: str, text: str, run: Path) -> tuple[bool, list[str]]:
    """Tell whether a run is of other inputs than a text states, and say in what they differ."""
    offer = loaded(plugin)
    try:
        now = setup_from_text(text, offer, file=file, folder=Path(folder))
    except InputError:
        return True, ["the text cannot be read as it stands"]
    document = load_either(run)
    if document.get("input_hash") == input_hash(now):
        changed = changed_since(plugin, run, document)
        return bool(changed), [changed] if changed else []
    try:
        differing = stated_differences(read_setup(run / "inputs.toml", offer), now)
    except TruingError:
        return True, []
    said = [f"{name}: {before or 'not stated'} → {after or 'not stated'}" for name, before, after in differing]
    more = [f"and {len(said) - MOST_DIFFERENCES} more"] if len(said) > MOST_DIFFERENCES else []
    return True, [*said[:MOST_DIFFERENCES], *more]


def chapter(run: str, ident: str) -> str:
    """Return one chapter of the sheet of a run as a page with the style of the sheet. Raises UsageError without one."""
    found = next((markup for each, _, markup in _chapters(Path(run)) if each == ident), None)
    if found is None:
        raise UsageError(f"the sheet of {Path(run).name} has no chapter '{ident[:40]}'")
    head = _sheet(Path(run)).partition("<body>")[0]
    return f'{head}<body><main class="sheet part">{found}</main></body></html>'


def _sheet(run: Path) -> str:
    try:
        return (run / "sheet.html").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return ""


def _chapters(run: Path) -> list[tuple[str, str, str]]:
    """Return identifier, title and markup of every chapter of the sheet of a run; none where it has no sheet."""
    return [
        (found[1], unescape(re.sub(r"<[^>]*>", "", found[2])).strip(), found[0])
        for found in CHAPTER.finditer(_sheet(run))
    ]
