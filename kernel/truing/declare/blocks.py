"""What a study or a section puts on the sheet, in neutral form: words, tables, drawings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from matplotlib.figure import Figure

Cell: TypeAlias = str | float | int | bool | None


@dataclass(frozen=True)
class Words:
    """A paragraph of plain text."""

    text: str
    kind: str = "note"  # note | finding | warning


@dataclass(frozen=True)
class Table:
    """Rows of numbers and texts; ``units`` stand under the column titles and numbers are already in them."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    units: Sequence[str] = ()
    note: str = ""


@dataclass(frozen=True)
class Drawing:
    """A figure made when the sheet is written: ``draw()`` returns a matplotlib Figure."""

    title: str
    draw: Callable[[], Figure | Any]
    caption: str = ""


Block: TypeAlias = Words | Table | Drawing
