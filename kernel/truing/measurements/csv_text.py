"""A CSV file taken apart: header cells with their units, rows with the line each stands in, cells still as text.

Every line is a row of its own: a cell never runs over a line end. So no row can be swallowed by another, and each line
behind the header is used, a fault, or in ``left_out`` with its reason.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from hashlib import sha256
from io import StringIO
from itertools import chain, islice
from pathlib import Path
from typing import Any, Protocol, TextIO

import numpy as np
from numpy.typing import NDArray

from truing.declare.near_miss import near_miss
from truing.errors import Fault, InputError
from truing.inputs_file.files import refuse_file
from truing.numbers import counted
from truing.setup import NamedColumn
from truing.units.grammar import number, shown

LARGEST_TABLE = 512_000_000
LONGEST_LINE = 1_000_000
MOST_FAULTS = 200
ROWS_AT_ONCE = 8192
INSTEAD = "the first line of a table holds the names, with units such as 'load [N]'"
COMMENT, NOTHING = "begins with '#'", "holds nothing"
"""Why lines behind the header are left out: a remark, or cells that are all empty."""
_OPEN = re.compile(r' *"[^"]*(?:""[^"]*)*')


_NOT_CLOSED = "opens a quotation mark that this line does not close; a cell ends in the line in which it begins"
_GOES_ON = "goes on behind its closing quotation mark; write a quotation mark inside of a quoted cell twice"


@dataclass(frozen=True)
class Header:
    """One cell of the header: a name, its unit (None where none is stated), and the text of both as written.

    ``key`` is what [columns] calls the column: where its name stands there, or its header cannot be edited.
    """

    name: str
    unit: str | None
    text: str
    key: str = ""


@dataclass
class ColumnNames:
    """What [columns] of the inputs file says of the columns of one file: ``stated`` by what the file calls them.

    ``notes`` collects what was done to the columns, one sentence each.
    """

    stated: Mapping[str, NamedColumn]
    notes: list[str] = field(default_factory=list)

    def header(self, name: str, unit: str | None, text: str, *called: str) -> Header:
        """Return the header of a column with the name that is stated for it; ``called`` is what it may be called.

        A unit that is stated counts, and one of the file that says otherwise is named.
        """
        key = next((each for each in (text, name, *called) if each in self.stated), "")
        if not key:
            return Header(name, unit, text, *called[:1])
        column = self.stated[key]
        if column.unit is not None and unit is not None and column.unit != unit:
            self.notes.append(
                f"column {shown(key)} is read in [{column.unit}] as [columns] says; the file says [{unit}]"
            )
        return Header(column.name, unit if column.unit is None else column.unit, text, key)

    def unused(self, headers: Sequence[Header]) -> Iterator[str]:
        """Say which of the stated columns the file does not have, under this name or another."""
        names = {header.name for header in headers}
        known = [header.key or header.text.partition(" [")[0] for header in headers]
        for key, column in self.stated.items():
            if column.name not in names:
                yield f"[columns] names {shown(key)}, which is no column here.{near_miss(key[:80], known)}".rstrip(".")


@dataclass
class Faults:
    """The faults of one file; beyond two hundred they are only counted."""

    file: str
    addressed: Callable[[int, str | int], str] | None = None
    """What a workbook calls a cell, by its row and the name or the place of its column."""
    found: list[Fault] = field(default_factory=list)
    more: int = 0

    def add(self, sentence: str, line: int | None = None, column: str | int = 0) -> None:
        """Note one fault of a line, in the column of that name or place where it matters."""
        cell = self.addressed(line, column) if self.addressed is not None and line is not None else ""
        if len(self.found) < MOST_FAULTS:
            self.found.append(Fault(sentence, self.file, line, cell))
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
class DecimalMarks:
    """Which decimal marks the numbers of a file have: the first cell with each, and cells that may be either."""

    may_be_comma: bool
    first: dict[str, tuple[str, int]] = field(default_factory=dict)
    unclear: list[tuple[str, str, int]] = field(default_factory=list)

    def take(self, name: str, cell: str, line: int) -> None:
        """Note the mark of a number that was read in the column *name*."""
        if "," not in cell and "." not in cell:
            return
        if EITHER.fullmatch(cell):
            self.unclear.append((name, cell, line))
        else:
            self.first.setdefault("," if "," in cell else ".", (cell, line))

    def judge(self, faults: Faults) -> None:
        """Refuse a file in which the marks are mixed, and cells whose comma nothing decides."""
        point, comma = self.first.get("."), self.first.get(",")
        comma = comma or ((self.unclear[0][1], self.unclear[0][2]) if self.unclear else None)
        if point and comma:
            first, second = sorted([point, comma], key=lambda mark: mark[1])
            mixed = f"{shown(second[0])} and {shown(first[0])} in line {first[1]} have different decimal marks"
            faults.add(f"{mixed}; write one mark in the whole file, and none between the thousands", second[1])
        elif "," not in self.first:
            for name, cell, line in self.unclear:
                either = f"may be {cell.replace(',', '.')} or {cell.replace(',', '')}, and no other number decides"
                faults.add(f"{name}: {shown(cell)} {either}; write '{cell}0' or '{cell.replace(',', '')}'", line)


class OpenTable(Protocol):
    """An open table: what stands in its header, and its rows in chunks of text; its faults go to ``faults``."""

    faults: Faults
    headers: tuple[Header, ...]
    marks: DecimalMarks

    @property
    def header_line(self) -> int | None:
        """The line of the header, where there is one."""

    @property
    def decimal_comma(self) -> bool:
        """Whether a comma in a number is read as a decimal mark."""

    def count(self) -> RowCount:
        """Return how many rows the file holds as far as it is read, with those that are no rows left out."""

    def chunks(self) -> Iterator[tuple[list[tuple[str, ...]], tuple[int, ...]]]:
        """Give columns of text with the line of each row, thousands at a time."""


@dataclass
class CsvFile:
    """An open CSV file: its header is read, its rows come in chunks; faults of its form go to ``faults``.

    ``left_out`` holds the lines behind the header that are no rows, by reason, as far as the file is read.
    """

    faults: Faults
    headers: tuple[Header, ...]
    header_line: int
    delimiter: str
    marks: DecimalMarks
    _lines: Iterator[tuple[str, int]]
    is_guarded: bool = False
    rows: int = 0
    left_out: dict[str, list[int]] = field(default_factory=dict)

    @property
    def decimal_comma(self) -> bool:
        """Whether a comma in a number is read as a decimal mark: where cells are not parted by commas."""
        return self.marks.may_be_comma

    def count(self) -> RowCount:
        """Return how many rows the file holds as far as it is read, with those that are no rows left out."""
        count = RowCount(self.faults.file, self.rows + sum(map(len, self.left_out.values())))
        return count.without_all(self.left_out)

    def chunks(self) -> Iterator[tuple[list[tuple[str, ...]], tuple[int, ...]]]:
        """Give columns of text with the line of each row, thousands at a time; lines that are no rows are faults."""
        behind = 0
        while part := list(islice(self._lines, ROWS_AT_ONCE)):
            behind += len(part)
            texts, lines = zip(*part, strict=True)
            columns = self._plain_columns(texts)
            if columns is None:
                numbered = [(row, line) for text, line in part if (row := self._row(text, line)) is not None]
                rows, lines = zip(*numbered, strict=True) if numbered else ((), ())
                columns = list(zip(*rows, strict=True))
            self.rows += len(lines)
            if lines:
                yield columns, lines
        if behind == sum(map(len, self.left_out.values())):
            self.faults.add("holds a header but no rows", self.header_line)

    def _plain_columns(self, texts: Sequence[str]) -> list[tuple[str, ...]] | None:
        """Return the columns of lines that are all rows of plain cells, taken apart at once; None for any others."""
        between, together = len(self.headers) - 1, self.delimiter.join(texts)
        if '"' in together or "#" in together or self.is_guarded:
            return None
        if any(text.count(self.delimiter) != between for text in texts):
            return None
        cells = together.split(self.delimiter)
        if " " in together:
            cells = [cell.lstrip(" ") for cell in cells]
        columns = [tuple(cells[place :: between + 1]) for place in range(between + 1)]
        return columns if all(map(str.strip, columns[0])) else None  # a row may be empty

    def _row(self, text: str, line: int) -> list[str] | None:
        """Return the cells of a line, as many as the header has; None where it is a fault or left out."""
        width = len(self.headers)
        is_comment = text.lstrip().startswith("#")
        try:
            row = _cells(text, self.delimiter)
        except ValueError as error:
            if not is_comment:
                self.faults.add(str(error), line)
                return None
            row = []
        if is_comment:
            if len(row) == width > 1:
                what = f"this line begins with '#' and holds {width} cells as a row does"
                first = shown(row[0].strip().replace('"', ""))
                way = f"put {first} in quotation marks where it is one, and a remark above the header"
                self.faults.add(f"{what}; {way}", line)
            self.left_out.setdefault(COMMENT, []).append(line)
            return None
        if not any(cell.strip() for cell in row):
            self.left_out.setdefault(NOTHING, []).append(line)
            return None
        if len(row) != width and not self._fits(row, line):
            return None
        return unguarded(row[:width]) if self.is_guarded else row[:width]

    def _fits(self, row: list[str], line: int) -> bool:
        """Say that a row is ragged, unless what is too much is empty cells at its end."""
        width = len(self.headers)
        if len(row) > width and not any(cell.strip() for cell in row[width:]):
            return True
        hint = "; with decimal commas, put semicolons between the cells" if len(row) > width else ""
        hint = "" if self.decimal_comma else hint
        self.faults.add(f"this row has {counted(len(row), 'cell')}, expected {width} as in the header{hint}", line)
        return False


@dataclass(frozen=True)
class TableText:
    """A table that stands in no file, and what sentences call it."""

    name: str
    text: str

    def __str__(self) -> str:
        return self.name

    @property
    def digest(self) -> str:
        """The SHA-256 of the text."""
        return sha256(self.text.encode()).hexdigest()


TableSource = Path | TableText


@contextmanager
def opened_csv(path: TableSource, names: ColumnNames) -> Iterator[CsvFile]:
    """Open a CSV file. Raises InputError where it cannot be one, or has no header."""
    if isinstance(path, TableText):
        yield _table(path, StringIO(path.text, newline=""), names)
        return
    refuse_file(path, largest=LARGEST_TABLE, instead=INSTEAD, is_table=True)
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            yield _table(path, stream, names)
    except UnicodeDecodeError:
        raise InputError([Fault("is not UTF-8 text; save it as CSV UTF-8", str(path), _foreign_line(path))]) from None
    except OSError as error:
        raise InputError([Fault(f"cannot be read: {error.strerror or error}", str(path), 1)]) from error


def _foreign_line(path: Path) -> int:
    with path.open("rb") as stream:
        for count, line in enumerate(stream, start=1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError:
                return count
    return 1


def _table(path: TableSource, stream: TextIO, names: ColumnNames) -> CsvFile:
    faults = Faults(str(path))
    beginning = stream.readline()
    lines = _lines(chain([beginning.removeprefix(MARK)], stream), faults)
    header, line = next(((text, line) for text, line in lines if not text.lstrip().startswith("#")), ("", 1))
    if not header:
        faults.raise_any()
        raise InputError([Fault(f"is empty; {INSTEAD}", str(path), 1)])
    outside = re.sub(r'"[^"]*"|\[[^\[\]]*\]', "", header)
    delimiter = next((mark for mark in (";", "\t") if mark in outside), ",")
    is_guarded = delimiter == ";" and beginning.startswith(MARK)
    try:
        cells = _cells(header, delimiter)
    except ValueError as error:
        raise InputError([Fault(str(error), str(path), line)]) from None
    headers = headers_of(unguarded(cells) if is_guarded else cells, line, faults, names)
    return CsvFile(faults, headers, line, delimiter, DecimalMarks(delimiter != ","), lines, is_guarded)


def _lines(stream: Iterable[str], faults: Faults) -> Iterator[tuple[str, int]]:
    """Give every line that holds anything, without its end, and its number."""
    for line, text in enumerate(stream, start=1):
        if len(text) > LONGEST_LINE:
            faults.add(f"this line has {len(text)} characters; at most {LONGEST_LINE} are read", line)
        elif not text.isspace():
            yield text.rstrip("\r\n"), line


def _cells(text: str, delimiter: str) -> list[str]:
    """Take a line apart. Raises ValueError where a quotation mark is not closed, or a cell goes on behind its own."""
    if '"' not in text:
        return [cell.lstrip(" ") for cell in text.split(delimiter)] if " " in text else text.split(delimiter)
    pattern = _cell_pattern(delimiter)
    cells: list[str] = []
    position = 0
    while True:
        cell = pattern.match(text, position)
        if cell is None:
            is_open = _OPEN.fullmatch(text, position)
            raise ValueError(f"cell {len(cells) + 1} {_NOT_CLOSED if is_open else _GOES_ON}")
        cells.append(cell["plain"] if cell["quoted"] is None else cell["quoted"].replace('""', '"'))
        position = cell.end()
        if not cell["more"]:
            return cells


@lru_cache(maxsize=4)
def _cell_pattern(delimiter: str) -> re.Pattern[str]:
    quoted = r'"(?P<quoted>[^"]*(?:""[^"]*)*+)" *'
    return re.compile(rf' *(?:{quoted}|(?P<plain>(?! *")[^{delimiter}]*))(?P<more>{delimiter}|$)')


def headers_of(cells: list[str], line: int, faults: Faults, names: ColumnNames) -> tuple[Header, ...]:
    """Take the cells of a header apart, without empty ones at its end, and name those that [columns] names."""
    while cells and not cells[-1].strip():
        cells = cells[:-1]
    headers: list[Header] = []
    seen: set[str] = set()
    for index, text in enumerate(cell.strip() for cell in cells):
        name, unit = name_and_unit(text)
        header = names.header(name or "", unit, text)
        name = header.name if header.key else name
        if name is None:
            faults.add(f"the header {shown(text)} cannot be read; write it like 'load [N]'", line, index)
        elif not name:
            faults.add(f"column {index + 1} has no name", line, index)
        elif name in seen:
            faults.add(f"the column {shown(name)} occurs twice", line, index)
        seen.add(name or "")
        headers.append(header)
    return tuple(headers)


def name_and_unit(text: str) -> tuple[str | None, str | None]:
    """Take "load [N]" apart; the unit is None where none is written, and the name where the text cannot be read."""
    name, bracket, rest = text.partition("[")
    unit = rest.removesuffix("]")
    if "]" in name or (bracket and (unit == rest or "[" in unit or "]" in unit)):
        return None, None
    return name.strip(), unit.strip() if bracket else None


# What the text of a cell may be: a number, a word for none, or words that a spreadsheet would take for a formula


MARK = "\ufeff"
"""The byte order mark: by it a spreadsheet knows UTF-8, and we a table that was written for one."""

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
"""A comma that may be the decimal mark or part thousands: read where another number decides, written nowhere."""
MISSING_WORDS = {"nan", "na", "n/a", "#n/a", "null", "none", "-"}
_FORMULA = re.compile(r"'*(?P<words>\s*[=+\-@＝＋－＠].+)", re.DOTALL)
_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?|(?=[eE]|$))(?:[eE][+-]?\d+)?", re.ASCII)
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}(?:[ T]\d{2}:\d{2}.*)?", re.ASCII)
_INFINITE = re.compile(r"[+-]?(?:inf|infinity|∞)", re.IGNORECASE)


def read_cell(text: str, *, decimal_comma: bool, may_be_missing_word: bool = False) -> float:
    """Return the number in a cell, NaN for an empty one. Raises ValueError with one sentence."""
    cell = text.strip()
    if not cell:
        return math.nan
    if decimal_comma and "," in cell and _COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    value = number(cell)
    if value is not None:
        return value
    if cell.lower() in MISSING_WORDS:
        if may_be_missing_word:
            return math.nan
        raise ValueError(f"{shown(text)} is no number; leave the cell empty where a value is missing")
    raise ValueError(_wrong(cell))


def _wrong(cell: str) -> str:
    if _DATE.fullmatch(cell):
        return (
            f"{shown(cell)} is a date and no number; a spreadsheet makes dates of numbers: format the column as numbers"
        )
    if cell[0] in "<>≤≥":
        words = "write the number, and mark the row in a column of its own (at_least or at_most in [studies.diagnose])"
        return f"{shown(cell)} is no number; {words}"
    if _INFINITE.fullmatch(cell):
        return f"{shown(cell)} is not a finite number"
    if not cell.isascii() and any(character.isdigit() and not character.isascii() for character in cell):
        return f"{shown(cell)} is no number; digits are 0 to 9"
    if re.fullmatch(r"[+-]?\d+,\d+", cell):
        return f"{shown(cell)} has a decimal comma; put semicolons between the columns, or write a point"
    if re.fullmatch(r"[+-]?\d{1,3}(?:[.,' ]\d{3})+(?:[.,]\d+)?", cell):
        return f"{shown(cell)} has marks between the thousands; write the digits alone"
    if re.fullmatch(NUMBER.pattern + r"\s*[^\d\s,;.]+.*", cell):
        return f"{shown(cell)} holds more than a number; the unit stands in the header, as in 'load [N]'"
    return f"{shown(cell)} is no number"


def plain_numbers(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Return a column at once where every cell is a number that Python reads as we do; else None."""
    try:
        fast = np.array(list(map(float, cells)))
    except ValueError:
        return None
    together = "".join(cells)
    if not np.isfinite(fast).all() or "_" in together or not together.isascii():
        return None
    zeros = [cells[row] for row in np.flatnonzero(fast == 0).tolist()] if "e" in together or "E" in together else []
    return None if any(cell.strip(" +-0.") for cell in zeros) else fast


def guarded(cell: str) -> str:
    """Return a cell with an apostrophe before what would be a formula; numbers and other words stay."""
    return f"'{cell}" if _may_be_formula(cell) else cell


def unguarded(row: Sequence[str]) -> list[str]:
    """Return the cells of a row as they were before they were guarded."""
    return [cell[1:] if cell.startswith("'") and _may_be_formula(cell[1:]) else cell for cell in row]


def _may_be_formula(cell: str) -> bool:
    match = _FORMULA.fullmatch(cell)
    return match is not None and not NUMBER.fullmatch(match["words"].strip().replace(",", ".", 1))


def with_comma(cells: Sequence[str]) -> Sequence[str]:
    """Return a column of numbers as written with decimal commas; one that holds any other word stays as it is."""
    plain = [cell.strip() for cell in cells]
    if all(not cell or NUMBER.fullmatch(cell) or cell.lower() in MISSING_WORDS for cell in plain):
        return [cell.replace(".", ",") for cell in cells]
    return cells


# What became of every row of a file: rows in the file = rows used + rows left out, each with its reason


MOST_LINES = 8
"""How many lines are named for one reason where people read; files of data hold all."""
MOST_REASONS = 12
"""How many reasons are named where people read."""


@dataclass(frozen=True)
class RowCount:
    """The rows of one file: how many it holds, and the lines of those that are left out, by reason.

    A reason is a clause: "begins with '#'".
    """

    file: str
    in_file: int
    left_out: Mapping[str, tuple[int, ...]] = field(default_factory=dict)

    @property
    def unused(self) -> int:
        """Rows that are left out."""
        return sum(map(len, self.left_out.values()))

    @property
    def used(self) -> int:
        """Rows that are not left out."""
        return self.in_file - self.unused

    def without(self, reason: str, lines: Iterable[int]) -> RowCount:
        """Return the count with further rows left out, joined to those that are left out for the same reason."""
        return self.without_all({reason: lines})

    def without_all(self, lines: Mapping[str, Iterable[int]]) -> RowCount:
        """Return the count with rows left out for several reasons."""
        left = dict(self.left_out)
        for reason, taken in lines.items():
            joined = (*left.get(reason, ()), *map(int, taken))
            left |= {reason: tuple(sorted(joined))} if joined else {}
        return replace(self, left_out=left)

    def sentence(self) -> str:
        """Say how many rows there are, and what became of those that are left out: "5 rows, 4 used; left out: ..."."""
        rows = counted(self.in_file)
        if not self.left_out:
            return f"{rows}, all used"
        named = [f"{_where(lines)} ({reason})" for reason, lines in self.left_out.items()][:MOST_REASONS]
        more = sum(map(len, [*self.left_out.values()][MOST_REASONS:]))
        named += [f"{more} more for other reasons"] if more else []
        return f"{rows}, {self.used} used; {self.unused} left out: {', '.join(named)}"

    def as_json(self) -> dict[str, Any]:
        """Return the count as data."""
        left = [{"reason": reason, "lines": list(lines)} for reason, lines in self.left_out.items()]
        return {"in_file": self.in_file, "used": self.used, "left_out": left}


def _where(lines: tuple[int, ...]) -> str:
    more = f" and {len(lines) - MOST_LINES} more" if len(lines) > MOST_LINES else ""
    return f"line{'' if len(lines) == 1 else 's'} {', '.join(map(str, lines[:MOST_LINES]))}{more}"


UNCOUNTED = RowCount("", 0)
"""The count of rows that come from no file."""
