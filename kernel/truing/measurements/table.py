"""Measured data: every column in SI, or as words where it holds words."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from io import StringIO
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from truing.atomic import write_files
from truing.errors import UnitError
from truing.measurements.cell_text import EITHER, MARK, guarded
from truing.measurements.cells import column_in_si, header_fault, read_cell, read_cells
from truing.measurements.csv_text import Chunk, CsvFile, Faults, Header, opened
from truing.measurements.row_count import UNCOUNTED, RowCount
from truing.units import difference_unit, to_si
from truing.units.names import PURE

SIGMA = "sigma_"
RUN = "run"


@dataclass(frozen=True)
class DataTable:
    """A table of measured data: numbers in SI, shape (n,), NaN where a cell is empty; text columns are labels.

    ``units`` holds what the header says ("" for pure numbers), ``lines`` the line of the file each row begins in and
    ``header_line`` that of the header. ``count`` says how many rows the file holds, with those left out.
    """

    file: str
    columns: Mapping[str, NDArray[np.float64] | tuple[str, ...]]
    units: Mapping[str, str]
    lines: tuple[int, ...]
    labels: frozenset[str]
    header_line: int = 1
    count: RowCount = UNCOUNTED

    def __len__(self) -> int:
        return len(self.lines)


def read_table(path: Path, units_of: Mapping[str, str], *, inputs: Collection[str] = ()) -> DataTable:
    """Read a table of measurements.

    ``units_of`` holds the declared units of the names that are known: their columns must have a unit of the same
    dimension and come in SI, and so does ``sigma_NAME``, a standard deviation of NAME. Other columns are kept, in SI
    where their unit is known; the column ``run`` and columns that hold words are labels. An empty cell is missing, and
    so is "NaN", except in columns named by ``inputs``. Raises InputError with every fault and its line.
    """
    table, faults = gather_table(path, units_of, inputs=inputs)
    faults.raise_any()
    return table


def gather_table(
    path: Path, units_of: Mapping[str, str], *, inputs: Collection[str] = (), words: Collection[str] = ()
) -> tuple[DataTable, Faults]:
    """Read a table as ``read_table`` does, and return it with its faults for a caller who looks for more of them.

    Columns named by ``words`` stay words, even where every cell is a number. A column whose header is a fault is left
    out of ``columns``. Raises InputError where the file cannot be read at all.
    """
    with opened(path) as table:
        columns = [_column(header, units_of, inputs, table) for header in table.headers]
        lines: list[int] = []
        for chunk in table.chunks():
            lines.extend(chunk.lines)
            for column in columns:
                column.take(chunk, table)
    usable = [column for column in columns if column.is_usable]
    made = {column.header.name: _made(column, words, table, lines) for column in usable}
    table.marks.judge(table.faults)
    found = DataTable(
        file=str(path),
        columns=made,
        units={column.header.name: column.header.unit or "" for column in columns},
        lines=tuple(lines),
        labels=frozenset(name for name, values in made.items() if isinstance(values, tuple)),
        header_line=table.header_line,
        count=table.count(),
    )
    return found, table.faults


def _made(
    column: _Known | _Other, words: Collection[str], table: CsvFile, lines: Sequence[int]
) -> NDArray[np.float64] | tuple[str, ...]:
    if isinstance(column, _Known):
        return column.made()
    return column.words() if column.header.name in words else column.made(table, lines)


def _column(header: Header, units_of: Mapping[str, str], inputs: Collection[str], table: CsvFile) -> _Known | _Other:
    of = header.name.removeprefix(SIGMA)
    is_sigma = header.name not in units_of and header.name.startswith(SIGMA) and of in units_of
    if header.name not in units_of and not is_sigma:
        return _Other(header, is_usable=bool(header.name))
    declared = units_of[of if is_sigma else header.name]
    fault = header_fault(header, declared, is_difference=is_sigma)
    if fault:
        table.faults.add(fault, table.header_line)
    return _Known(header, declared, is_sigma, strict=header.name in inputs, is_usable=not fault)


@dataclass
class _Known:
    """A column of numbers whose name is known: cells become numbers as they come."""

    header: Header
    declared: str
    is_sigma: bool
    strict: bool
    is_usable: bool
    parts: list[NDArray[np.float64]] = field(default_factory=list)

    def take(self, chunk: Chunk, table: CsvFile) -> None:
        """Take the next rows."""
        cells = chunk.cells[self.header.place]
        values = read_cells(cells, chunk.lines, self.header, table, strict=self.strict)
        if self.is_sigma and (values < 0).any():
            worst = int((values < 0).argmax())
            table.faults.add(f"{self.header.name}: a standard deviation is 0 or more", chunk.lines[worst])
        self.parts.append(self._in_si(values, chunk, table.faults) if self.is_usable else values)

    def _in_si(self, values: NDArray[np.float64], chunk: Chunk, faults: Faults) -> NDArray[np.float64]:
        if not self.is_sigma:
            return column_in_si(values, chunk.lines, self.header, self.declared, faults)
        header = replace(self.header, unit=difference_unit(self.header.unit or ""))
        return column_in_si(values, chunk.lines, header, difference_unit(self.declared), faults)

    def made(self) -> NDArray[np.float64]:
        """Return the column in SI."""
        return np.concatenate(self.parts) if self.parts else np.empty(0)


@dataclass
class _Other:
    """A column nobody declared: numbers if every cell is one, else labels."""

    header: Header
    is_usable: bool = True
    cells: list[str] = field(default_factory=list)

    def take(self, chunk: Chunk, table: CsvFile) -> None:
        """Take the next rows."""
        self.cells.extend(chunk.cells[self.header.place])

    def made(self, table: CsvFile, lines: Sequence[int]) -> NDArray[np.float64] | tuple[str, ...]:
        """Return numbers, in SI where the unit is known, or words."""
        if self.header.name == RUN or not any(cell.strip() for cell in self.cells):
            return self.words()
        try:
            values = np.array([
                read_cell(cell, decimal_comma=table.decimal_comma, may_be_missing_word=True) for cell in self.cells
            ])  # fmt: skip
        except ValueError:
            return self.words()
        if table.decimal_comma:
            for cell, line in zip(self.cells, lines, strict=True):
                table.marks.take(self.header.name, cell.strip(), line)
        try:
            return in_si(values, self.header.unit or "")
        except UnitError:
            return values

    def words(self) -> tuple[str, ...]:
        """Return the cells as words."""
        return tuple(cell.strip() for cell in self.cells)


def in_si(values: NDArray[np.float64], unit: str) -> NDArray[np.float64]:
    """Bring numbers from the unit of a header to SI."""
    if unit in PURE:
        return values
    return to_si(values, unit)


# Tables to files: numbers that read back exactly, a file that is complete or absent


@dataclass(frozen=True)
class TableStyle:
    """How a table is written: the mark before it, what parts cells and lines, and the decimal mark."""

    mark: str = ""
    delimiter: str = ","
    decimal: str = "."
    line_end: str = "\n"
    is_guarded: bool = False


PLAIN = TableStyle()
EXCEL = TableStyle(MARK, ";", ",", "\r\n", is_guarded=True)
"""What a spreadsheet with a decimal comma opens by a double click."""


def write_table(
    target: Path | TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]], *, form: TableStyle = PLAIN
) -> None:
    """Write columns under headers such as "depth [um]"; the numbers are in these units already.

    Numbers are written so that they read back exactly (at most 17 digits), NaN and None as empty cells; words stay as
    they are, line ends in them become blanks. A file is written whole or not at all. Raises OutputError.
    """
    if isinstance(target, Path):
        write_files({target: table_text(headers, columns, form=form)})
    else:
        _write(target, headers, columns, form)


def table_text(headers: Sequence[str], columns: Sequence[Iterable[Any]], *, form: TableStyle = PLAIN) -> str:
    """Return a table as the text of its file."""
    stream = StringIO(newline="")
    _write(stream, headers, columns, form)
    return stream.getvalue()


def _write(stream: TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]], form: TableStyle) -> None:
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


def _rows(headers: Sequence[str], columns: Sequence[Iterable[Any]], form: TableStyle) -> Iterator[list[str]]:
    yield [_cell(header, form) for header in headers]
    for row in zip(*(_plain(column) for column in columns), strict=True):
        yield [_cell(value, form) for value in row]


def _plain(column: Any) -> Iterable[Any]:
    """Return plain Python values, which are written much faster than numpy's."""
    plain: Iterable[Any] = column.tolist() if hasattr(column, "tolist") else column
    return plain


def _cell(value: Any, form: TableStyle) -> str:
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
