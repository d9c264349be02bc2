"""A CSV file taken apart: header cells with their units, rows with the line each begins in, cells still as text."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TextIO

from truing.errors import Fault, InputError
from truing.inputs_file.files import refuse_file
from truing.measurements.cell_text import MARK, all_unguarded
from truing.units.grammar import shown

LARGEST_TABLE = 512_000_000
MOST_FAULTS = 200
ROWS_AT_ONCE = 8192
_HEADER = re.compile(r"(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*")


@dataclass(frozen=True)
class Header:
    """One cell of the header: a name, its unit (None where none is written) and its place in the row."""

    name: str
    unit: str | None
    place: int
    text: str


@dataclass(frozen=True)
class Chunk:
    """Some rows as columns of text, and the file line of each row."""

    cells: list[tuple[str, ...]]
    lines: tuple[int, ...]


@dataclass
class Faults:
    """The faults of one file; beyond two hundred they are only counted."""

    file: str
    found: list[Fault] = field(default_factory=list)
    more: int = 0

    def add(self, sentence: str, line: int | None = None) -> None:
        """Note one fault."""
        if len(self.found) < MOST_FAULTS:
            self.found.append(Fault(sentence, self.file, line))
        else:
            self.more += 1

    def raise_any(self) -> None:
        """Raise InputError with all faults in the order of their lines, if there are any."""
        if not self.found:
            return
        ordered = sorted(dict.fromkeys(self.found), key=lambda fault: fault.line or 0)
        if self.more:
            ordered.append(Fault(f"and {self.more} faults more", self.file))
        raise InputError(ordered)


@dataclass
class CsvFile:
    """An open table: its header is read, its rows come in chunks; faults of its form go to ``faults``."""

    faults: Faults
    headers: tuple[Header, ...]
    header_line: int
    decimal_comma: bool
    _rows: Iterator[tuple[list[str], int]]

    def chunks(self) -> Iterator[Chunk]:
        """Give the rows as columns of text, some thousands at a time; ragged rows are faults and left out."""
        width = len(self.headers)
        rows: list[list[str]] = []
        lines: list[int] = []
        any_row = False
        for row, line in self._rows:
            any_row = True
            if len(row) != width and not self._fits(row, line):
                continue
            rows.append(row[:width])
            lines.append(line)
            if len(rows) == ROWS_AT_ONCE:
                yield Chunk(list(zip(*rows, strict=True)), tuple(lines))
                rows, lines = [], []
        if rows:
            yield Chunk(list(zip(*rows, strict=True)), tuple(lines))
        if not any_row:
            self.faults.add("holds a header but no rows", self.header_line)

    def _fits(self, row: list[str], line: int) -> bool:
        """Say that a row is ragged, unless what is too much is empty cells at its end."""
        width = len(self.headers)
        if len(row) > width and not any(cell.strip() for cell in row[width:]):
            return True
        hint = "; with decimal commas, put semicolons between the cells" if len(row) > width else ""
        hint = "" if self.decimal_comma else hint
        cells = "1 cell" if len(row) == 1 else f"{len(row)} cells"
        self.faults.add(f"this row has {cells}, expected {width} as in the header{hint}", line)
        return False


@contextmanager
def opened(path: Path) -> Iterator[CsvFile]:
    """Open a table. Raises InputError where it cannot be one, or has no header."""
    instead = "the first line of a table holds the names, with units such as 'load [N]'"
    refuse_file(path, largest=LARGEST_TABLE, instead=instead, is_table=True)
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            yield _table(path, stream, instead)
    except UnicodeDecodeError:
        raise InputError([Fault("is not UTF-8 text; save it as CSV UTF-8", str(path), _foreign_line(path))]) from None
    except OSError as error:
        raise InputError([Fault(f"cannot be read: {error.strerror or error}", str(path), 1)]) from error


def _foreign_line(path: Path) -> int:
    """Return the first line that is no UTF-8."""
    with path.open("rb") as stream:
        for number, line in enumerate(stream, start=1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError:
                return number
    return 1


def _table(path: Path, stream: TextIO, instead: str) -> CsvFile:
    faults = Faults(str(path))
    beginning = stream.readline()
    lines = _without_comments(chain([beginning.removeprefix(MARK)], stream))
    position, first = 0, ""
    for first in lines:
        position += 1
        if first.strip():
            break
    if not first.strip():
        raise InputError([Fault(f"is empty; {instead}", str(path), 1)])
    delimiter = _delimiter(first)
    rows = _rows(first, lines, position, delimiter, faults)
    if delimiter == ";" and beginning.startswith(MARK):
        rows = ((all_unguarded(row), line) for row, line in rows)
    header, line = next(rows, ([], position))
    return CsvFile(faults, _headers(header, line, faults), line, delimiter != ",", rows)


def _without_comments(stream: Iterable[str]) -> Iterator[str]:
    for line in stream:
        yield "\n" if line.lstrip().startswith("#") else line


def _delimiter(header: str) -> str:
    outside = re.sub(r'"[^"]*"|\[[^\]]*\]', "", header)
    return next((mark for mark in (";", "\t") if mark in outside), ",")


def _rows(
    first: str, rest: Iterator[str], position: int, delimiter: str, faults: Faults
) -> Iterator[tuple[list[str], int]]:
    """Give every row that holds anything with the line it begins in."""

    def all_lines() -> Iterator[str]:
        yield first
        yield from rest

    reader = csv.reader(all_lines(), delimiter=delimiter, skipinitialspace=True, strict=False)
    before = 0
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                yield row, position + before
            before = reader.line_num
    except csv.Error as error:
        faults.add(f"this is no CSV: {error}", position + reader.line_num - 1)


def _headers(cells: list[str], line: int, faults: Faults) -> tuple[Header, ...]:
    while cells and not cells[-1].strip():
        cells = cells[:-1]
    headers: list[Header] = []
    seen: set[str] = set()
    for place, cell in enumerate(cells):
        found = _HEADER.fullmatch(cell.strip())
        name = found["name"].strip() if found else ""
        if not found:
            faults.add(f"the header {shown(cell)} cannot be read; write it like 'load [N]'", line)
        elif not name:
            faults.add(f"column {place + 1} has no name", line)
        elif name in seen:
            faults.add(f"the column {shown(name)} occurs twice", line)
        seen.add(name)
        unit = found["unit"] if found else None
        headers.append(Header(name, unit.strip() if unit is not None else None, place, cell.strip()))
    return tuple(headers)
