"""A document on the terminal: text in aligned columns, lines broken to its width."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Iterator

from truing.cli.console import NARROWEST, aligned
from truing.report.document import Chapter, Items, TableView, Text, plain_text
from truing.texts import one_line

PAGE = 80
WIDEST = 110
INDENT = "  "


def width_of_page() -> int:
    """Return how wide lines may be: that of the terminal, within reason; elsewhere eighty columns."""
    return min(max(shutil.get_terminal_size().columns, NARROWEST), WIDEST) if sys.stdout.isatty() else PAGE


def chapter_lines(chapter: Chapter, width: int) -> Iterator[str]:
    """Give the title of a chapter below an empty line, then its paragraphs, lists and tables, indented."""
    yield ""
    yield from wrapped(chapter.title, width)
    for block in chapter.blocks:
        if isinstance(block, TableView):
            yield from table_lines(block, width)
        elif isinstance(block, Items):
            for text in block.texts:
                yield from wrapped(text, width, INDENT, INDENT * 2)
        else:
            yield from wrapped(getattr(block, "text", ""), width, INDENT)


def wrapped(text: Text, width: int, first: str = "", later: str | None = None) -> Iterator[str]:
    """Break a text into lines; the first begins with ``first``, the others with ``later``."""
    words, later = one_line(plain_text(text)), first if later is None else later
    yield from textwrap.wrap(words, width, initial_indent=first, subsequent_indent=later, break_on_hyphens=False)


def table_lines(table: TableView, width: int) -> Iterator[str]:
    """Give a table without its headings, indented, without columns that hold nothing; then its note."""
    cells = [[INDENT + plain_text(row[0]), *(one_line(plain_text(cell)) for cell in row[1:])] for row in table.rows]
    kept = [index for index, column in enumerate(zip(*cells, strict=True)) if any(column)]
    right = [place for place, index in enumerate(kept) if table.columns[index].kind == "number"]
    rows = [[row[index] for index in kept] for row in cells]
    yield from aligned(rows, right=right, width=width)
    yield from wrapped(table.note, width, INDENT)
