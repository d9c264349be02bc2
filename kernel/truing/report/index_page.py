"""One page over a folder of runs and diagnoses: a table that sorts and filters in the browser, offline."""

from __future__ import annotations

import base64
import hashlib
import os
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

from truing.atomic import write_files
from truing.errors import OutputError
from truing.numbers import ABSENT, counted, format_number, pretty, with_unit
from truing.report.document import unit_as_said
from truing.report.html_printer import page
from truing.runs.index import FolderEntry, ListedNumber, Listing
from truing.templating import template_folder

MARK = '<meta name="generator" content="calc index">'
"""What an index of ours holds, and no other page."""
SHOWN = 3


def index_html(listing: Listing, target: Path) -> str:
    """Write the page that will stand at ``target``; its links lead to the sheets from there."""
    script = (template_folder() / "index.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    folder = Path(listing.folder)
    title = f"Runs and diagnoses in {folder.name or folder.absolute().name}"
    return page(
        "index.html.j2", title, styles=("sheet.css", "index.css"), title=title, summary=summary_of(listing),
        listing=listing, most=SHOWN, link=partial(_link, folder.absolute(), target), margin=margin_words,
        number=_number, script=script, digest=digest,
    )  # fmt: skip


def summary_of(listing: Listing) -> str:
    """Say how many runs and diagnoses there are, how many fail, and how much else."""
    runs = [entry for entry in listing.entries if entry.kind == "run"]
    words = {"fails": ("fails", "fail"), "undecided": ("undecided",) * 2, "proposed": ("not as stated",) * 2}
    counts = {state: sum(entry.state == state for entry in runs) for state in words}
    told = ", ".join(counted(count, *words[state]) for state, count in counts.items() if count)
    parts = [counted(len(runs), "run", "runs") + (f" ({told})" if told else "")]
    parts.append(counted(len(listing.entries) - len(runs), "diagnosis", "diagnoses"))
    if listing.others:
        parts.append(counted(len(listing.others), "other folder", "other folders"))
    return ", ".join(parts)


def _link(folder: Path, target: Path, sheet: str) -> str:
    """Return the address of a sheet as seen from the page; from another drive the whole of it."""
    try:
        return quote(os.path.relpath(folder / sheet, target.absolute().parent).replace(os.sep, "/"))
    except ValueError:
        return (folder / sheet).as_uri()


def margin_words(entry: FolderEntry) -> str:
    """Say the smallest margin of a run in per cent of its limit, or as a number where the limit is 0."""
    if entry.margin is None:
        return ABSENT
    least = next(one for one in entry.findings if one.margin is not None)
    share = 100 * entry.margin if least.limit else entry.margin
    return f"{pretty(format_number(share, 3))}{chr(0x202F) + '%' if least.limit else ''}"


def _number(one: ListedNumber, value: float | None) -> str:
    return with_unit(pretty(format_number(value, 4)), unit_as_said(one.unit))


def listing_document(listing: Listing) -> dict[str, Any]:
    """Return the listing as JSON-ready data."""
    entries = [{**asdict(entry), "margin": entry.margin} for entry in listing.entries]
    return {"folder": listing.folder, "entries": entries, "others": [asdict(other) for other in listing.others]}


def write_index(target: Path, listing: Listing) -> None:
    """Write the page, whole or not at all; one of ours is replaced. Raises OutputError where another file is there."""
    _demand_ours(target)
    write_files({target: index_html(listing, target)})


def _demand_ours(target: Path) -> None:
    try:
        if target.is_dir():
            raise OutputError(f"{target}: is a folder; name a file, such as {target / 'index.html'}")
        if target.exists() and MARK not in target.read_text(encoding="utf-8", errors="replace")[:4000]:
            raise OutputError(f"{target}: is a file that calc index has not written, so it is left alone; name another")
    except OSError as error:
        raise OutputError(f"{target}: cannot be read: {error.strerror or error}") from error
