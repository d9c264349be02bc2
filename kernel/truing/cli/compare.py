"""calc compare: what changed between two runs, or two diagnoses."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from itertools import accumulate
from pathlib import Path

from rich.console import Console
from rich.text import Text

from truing.cli.console import GAP, Settings, aligned, harmless, out, out_json, put
from truing.runs.comparison import Change, compared, in_order, words_of
from truing.runs.folder import load_either
from truing.studies.checks import EXIT_CODES
from truing.texts import one_line


def compare(settings: Settings, *, first: Path, second: Path, as_json: bool) -> int:
    """Show inputs, results and checks that changed: exit 0 when equal, 1 when different."""
    changes = compared(load_either(first), load_either(second))
    if as_json:
        out_json({"equal": not changes, "changes": [asdict(change) for change in changes]})
    elif not changes:
        out("equal")
    else:
        ordered = in_order(changes)
        rows = [("what", "name", one_line(first), one_line(second), "change"), *map(words_of, ordered)]
        out_table(rows, [("",) * 5, *map(styles_of, ordered)])
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
