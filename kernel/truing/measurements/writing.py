"""Tables to files: numbers that read back exactly, a file that is complete or absent."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any, TextIO

from truing.atomic import write_files
from truing.measurements.cell_text import EITHER, MARK, guarded


@dataclass(frozen=True)
class Form:
    """How a table is written: the mark before it, what parts cells and lines, and the decimal mark."""

    mark: str = ""
    delimiter: str = ","
    decimal: str = "."
    line_end: str = "\n"
    is_guarded: bool = False


PLAIN = Form()
EXCEL = Form(MARK, ";", ",", "\r\n", is_guarded=True)
"""What a spreadsheet with a decimal comma opens by a double click."""


def write_table(
    target: Path | TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]], *, form: Form = PLAIN
) -> None:
    """Write columns under headers such as "depth [um]"; the numbers are in these units already.

    Numbers are written so that they read back exactly (at most 17 digits), NaN and None as empty cells; words stay as
    they are, line ends in them become blanks. A file is written whole or not at all. Raises OutputError.
    """
    if isinstance(target, Path):
        write_files({target: table_text(headers, columns, form=form)})
    else:
        _write(target, headers, columns, form)


def table_text(headers: Sequence[str], columns: Sequence[Iterable[Any]], *, form: Form = PLAIN) -> str:
    """Return a table as the text of its file."""
    stream = StringIO(newline="")
    _write(stream, headers, columns, form)
    return stream.getvalue()


def _write(stream: TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]], form: Form) -> None:
    if len(headers) != len(columns):
        raise ValueError(f"{len(headers)} headers for {len(columns)} columns")
    stream.write(form.mark)
    minimal, everything = (
        csv.writer(stream, delimiter=form.delimiter, lineterminator=form.line_end, quoting=quoting)
        for quoting in (csv.QUOTE_MINIMAL, csv.QUOTE_ALL)
    )
    alone = [""] if form.delimiter != "," and len(headers) == 1 else []
    for row in _rows(headers, columns, form):
        # a line that begins with # would be a comment; a column alone must show what parts the cells
        (everything if row and row[0].lstrip().startswith("#") else minimal).writerow(row + alone)


def _rows(headers: Sequence[str], columns: Sequence[Iterable[Any]], form: Form) -> Iterator[list[str]]:
    yield [_cell(header, form) for header in headers]
    for row in zip(*(_plain(column) for column in columns), strict=True):
        yield [_cell(value, form) for value in row]


def _plain(column: Any) -> Iterable[Any]:
    """Return plain Python values, which are written much faster than numpy's."""
    plain: Iterable[Any] = column.tolist() if hasattr(column, "tolist") else column
    return plain


def _cell(value: Any, form: Form) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        text = repr(value) if math.isfinite(value) else "" if math.isnan(value) else str(value)
        text = text.replace(".", form.decimal)
        return f"{text}0" if EITHER.fullmatch(text) else text
    text = " ".join(re.split(r"[\r\n]+", str(value)))  # a cell ends in the line in which it begins
    return guarded(text) if form.is_guarded and isinstance(value, str) else text
