"""Tables to files: numbers that read back exactly, a file that is complete or absent."""

from __future__ import annotations

import csv
import math
import os
import re
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any, TextIO

from truing.errors import OutputError
from truing.measurements.cell_text import MARK, guarded


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
    they are, line ends in them become blanks. A path is written atomically. Raises OutputError where it cannot be
    written.
    """
    if not isinstance(target, Path):
        _write(target, headers, columns, form)
        return
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    with written_whole(target, newline="") as stream:
        _write(stream, headers, columns, form)


@contextmanager
def written_whole(target: Path, *, newline: str) -> Iterator[TextIO]:
    """Give a stream whose text becomes a file when all of it is written, and none before. Raises OutputError."""
    try:
        handle, name = tempfile.mkstemp(dir=target.absolute().parent, prefix=f".{target.name[:40]}.", suffix=".part")
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    part = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline=newline) as stream:
            yield stream
        part.chmod(0o666 & ~umask())
        part.replace(target)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    finally:
        part.unlink(missing_ok=True)


def umask() -> int:
    """Return what this process takes from the permissions of new files; temporary ones are made without them."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


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
        return text if form.decimal == "." else text.replace(".", form.decimal)
    text = " ".join(re.split(r"[\r\n]+", str(value)))  # a cell ends in the line in which it begins
    return guarded(text) if form.is_guarded and isinstance(value, str) else text
