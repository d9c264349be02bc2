"""Measured data: every column in SI, or as words where it holds words."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from truing.errors import UnitError
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
