"""Tables in colour where a terminal shows them; everywhere else, and with NO_COLOR, the same text without."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from truing.cli.console import GAP, aligned, harmless, out, put

GOOD, BAD, NEW, OLD = "green", "red", "bold", "dim"


def shows_colour() -> bool:
    """Tell whether what is printed goes to a terminal that is to show colours."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return sys.stdout.isatty() and not plain


def out_table(rows: Sequence[Sequence[str]], styles: Sequence[Sequence[str]], *, right: Sequence[int] = ()) -> None:
    """Print rows in aligned columns; ``styles`` names the colour of each cell, or nothing. Colour changes no text."""
    lines = aligned(rows, right=right)
    if not shows_colour():
        out("\n".join(lines))
        return
    console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
    starts = _starts(rows)
    with console.capture() as coloured:
        for line, of_cells in zip(lines, styles, strict=True):
            text = Text(harmless(line))
            for index, style in enumerate(of_cells):
                if style:
                    end = starts[index + 1] if index + 1 < len(of_cells) else len(line)
                    text.stylize(style, starts[index], end)
            console.print(text)
    put(coloured.get())


def _starts(rows: Sequence[Sequence[str]]) -> list[int]:
    """Return where each column begins."""
    starts = [0]
    for column in zip(*rows, strict=True):
        starts.append(starts[-1] + max(map(len, column)) + len(GAP))
    return starts
