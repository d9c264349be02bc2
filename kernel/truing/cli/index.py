"""calc index: one page over a folder of runs and diagnoses."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from truing.cli.console import one_line, out, out_json, settings_of, verb
from truing.cli.words import AsJson
from truing.report.index_page import listing_document, summary_of, write_index
from truing.runs.index import list_folder


@verb
def index(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(help="The folder that holds runs and diagnoses, however deep.")] = Path(
        "runs"
    ),
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The page to write (index.html in the folder without it).")
    ] = None,
    as_json: AsJson = False,
) -> int:
    """Write one page that lists the runs and diagnoses of a folder, to sort and to filter, offline."""
    settings = settings_of(context)
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
