"""calc index: one page over a folder of runs and diagnoses."""

from __future__ import annotations

from pathlib import Path

from truing.cli.console import Settings, out, out_json
from truing.report.index_page import listing_document, summary_of, write_index
from truing.runs.index import list_folder
from truing.texts import one_line


def index(settings: Settings, *, folder: Path, output: Path | None, as_json: bool) -> int:
    """Write one page that lists the runs and diagnoses of a folder, to sort and to filter, offline."""
    listing = list_folder(folder)
    page = output or folder / "index.html"
    if output is not None or not as_json:
        write_index(page, listing)
    for other in listing.others:
        settings.say(f"note: {one_line(folder / other.name)}: {one_line(other.sentence)}")
    if as_json:
        out_json(listing_document(listing))
    else:
        out(f"{summary_of(listing)}\nindex: {page}")
    return 0
