"""calc compare and calc index: what changed between two runs, or two diagnoses; one page over a folder of them."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import accumulate
from pathlib import Path
from types import SimpleNamespace

from rich.console import Console
from rich.text import Text

from truing.api.differences import differences_of_paths
from truing.api.run import Run
from truing.cli.console import GAP, Settings, aligned, harmless, out, out_json, put
from truing.cli.load import find_model
from truing.errors import UsageError
from truing.report.index_page import listing_document, summary_of, write_index
from truing.report.run import demand_ending
from truing.runs.comparison import Change, compared, words_of
from truing.runs.index import list_folder
from truing.studies.checks import EXIT_CODES
from truing.templating import demand_language
from truing.texts import one_line


def index(settings: Settings, asked: SimpleNamespace) -> int:
    """Write one page that lists the runs and diagnoses of a folder, to sort and to filter, offline."""
    folder: Path = asked.folder
    listing = list_folder(folder)
    page = asked.output or folder / "index.html"
    if asked.output is not None or not asked.as_json:
        write_index(page, listing)
    for other in listing.others:
        settings.say(f"note: {one_line(folder / other.name)}: {one_line(other.sentence)}")
    if asked.as_json:
        out_json(listing_document(listing))
    else:
        out(f"{summary_of(listing)}\nindex: {page}")
    return 0


def compare(settings: Settings, asked: SimpleNamespace) -> int:
    """Show inputs, results and checks that changed: exit 0 when equal, 1 when different."""
    if asked.output is not None:
        demand_ending(asked.output)
    elif asked.language:
        raise UsageError("--language is that of the page; name the page with -o, too")
    demand_language(asked.language)

    def run(plugin: str, file: Path) -> Run:
        return find_model(plugin, settings).run(file, progress=not settings.quiet)

    differences = differences_of_paths(asked.first, asked.second, run, plugin=asked.plugin)
    changes = differences.changes
    if asked.output is not None:
        differences.sheet(asked.output, language=asked.language)
    if asked.as_json:
        out_json({"equal": not changes, "changes": [asdict(change) for change in compared(*differences.documents)]})
    elif not changes:
        out("equal")
    else:
        head = ("what", "name", one_line(asked.first), one_line(asked.second), "change")
        out_table([head, *map(words_of, changes)], [("",) * 5, *map(styles_of, changes)])
    if asked.output is not None and not asked.as_json:
        out(f"\npage: {one_line(asked.output)}")
    return 1 if changes else 0


# The colours that repeat what changed between two runs


def styles_of(change: Change) -> tuple[str, str, str, str, str]:
    """Name the colours of one row: what a check gained or lost, and what is new."""
    if change.kind != "checks":
        return "", "", OLD, NEW, ""
    better = _is_better(change)
    colour = {True: GOOD, False: BAD, None: ""}[better]
    flip = f"bold {colour}" if change.flipped else colour
    return flip if change.flipped else "", flip if change.flipped else "", OLD, NEW, flip


def _is_better(change: Change) -> bool | None:
    """Tell whether a check has more left than before; None where that cannot be said."""
    if change.flipped:
        states = list(EXIT_CODES)
        return states.index(change.after["state"]) < states.index(change.before["state"])
    if not isinstance(change.before, Mapping) or not isinstance(change.after, Mapping):
        return None
    before, after = change.before.get("margin"), change.after.get("margin")
    return None if before is None or after is None or before == after else bool(after > before)


# Tables in colour where a terminal shows them; everywhere else, and with NO_COLOR, the same text without


GOOD, BAD, NEW, OLD = "green", "red", "bold", "dim"


def shows_colour() -> bool:
    """Tell whether what is printed goes to a terminal that is to show colours."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stdout.isatty() and not plain


def out_table(rows: Sequence[Sequence[str]], styles: Sequence[Sequence[str]]) -> None:
    """Print rows in aligned columns; ``styles`` names the colour of each cell, or nothing. Colour changes no text."""
    lines = aligned(rows)
    if not shows_colour():
        out("\n".join(lines))
        return
    console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
    widths = [max(map(len, column)) + len(GAP) for column in zip(*rows, strict=True)]
    with console.capture() as coloured:
        for line, of_cells in zip(lines, styles, strict=True):
            text = Text(harmless(line))
            for style, end, width in zip(of_cells, accumulate(widths), widths, strict=True):
                if style:
                    text.stylize(style, end - width, end if end < sum(widths) else None)
            console.print(text)
    put(coloured.get())
