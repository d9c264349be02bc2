"""The rows of a sheet: the header with its units found below titles and group heads, cells as text with addresses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime, time, timedelta
from itertools import chain, islice
from pathlib import Path
from typing import Any

from truing.errors import Fault, InputError, UnitError
from truing.inputs_file.files import opened_book
from truing.measurements.csv_text import (
    COMMENT,
    INSTEAD,
    LARGEST_TABLE,
    MOST_FAULTS,
    ROWS_AT_ONCE,
    ColumnNames,
    DecimalMarks,
    Faults,
    Header,
    RowCount,
    headers_of,
    name_and_unit,
)
from truing.units import check_unit, from_si, same_dimension
from truing.units.names import PURE
from truing.workbooks.reading import BookSheet, CellRange, cell_text, in_per_cent

SheetRow = tuple[int, tuple[Any, ...]]
_NO_UNIT = {"-", "–", "—", "1"}


@dataclass
class WorkbookTable:
    """An open sheet: its header is read, its rows come in chunks.

    ``columns`` holds the place in the range of every header. ``_starts`` holds the first date of a column of times.
    """

    file: str
    faults: Faults
    headers: tuple[Header, ...]
    header_line: int
    columns: Sequence[int]
    _sheet: BookSheet
    _rows: Iterator[SheetRow]
    marks: DecimalMarks = field(default_factory=lambda: DecimalMarks(may_be_comma=False))
    rows: int = 0
    left_out: dict[str, list[int]] = field(default_factory=dict)
    _starts: dict[int, datetime] = field(default_factory=dict)
    _nameless: set[int] = field(default_factory=set)

    @property
    def decimal_comma(self) -> bool:
        """Never: numbers are no texts here."""
        return False

    def count(self) -> RowCount:
        """Return how many rows the sheet holds as far as it is read, with those that are no rows left out."""
        count = RowCount(self.file, self.rows + sum(map(len, self.left_out.values())))
        return count.without_all(self.left_out)

    def chunks(self) -> Iterator[tuple[list[tuple[str, ...]], tuple[int, ...]]]:
        """Give columns of text with the row of each, thousands at a time; what cannot be read is a fault."""
        while part := list(islice(self._rows, ROWS_AT_ONCE)):
            numbered = [(self._texts(cells, line), line) for line, cells in part if self._is_row(cells, line)]
            self.rows += len(numbered)
            if numbered:
                rows, lines = zip(*numbered, strict=True)
                yield list(zip(*rows, strict=True)), lines
        first, used = self._sheet.area.first_column, set(self.columns)
        for line, column in self._sheet.never_calculated():
            if column - first in used:
                name = self.headers[self.columns.index(column - first)].name
                calculate = "open the workbook in Excel or LibreOffice, let it calculate, and save it"
                self.faults.add(f"{name}: holds a formula whose value was never stored; {calculate}", line, name)
        if not self.rows and not self.faults.found:
            self.faults.add("holds a header but no rows", self.header_line)

    def _is_row(self, cells: tuple[Any, ...], line: int) -> bool:
        """Leave out remarks, and say what stands in columns that have no name."""
        filled = [place for place, cell in enumerate(cells) if cell.value is not None]
        if (
            len(filled) == 1
            and str(cells[filled[0]].value).lstrip().startswith("#")
            and not _is_error(cells[filled[0]])
        ):
            self.left_out.setdefault(COMMENT, []).append(line)
            return False
        for place in sorted(set(filled).difference(self.columns, self._nameless)):
            self._nameless.add(place)
            if len(self._nameless) > MOST_FAULTS:
                break
            where = "stands in a column whose header is empty"
            cell = self._sheet.address(line, self._sheet.area.first_column + place)
            self.faults.found.append(
                Fault(f"{where}; name the column, or the range of the table", self.faults.file, line, cell)
            )
        return True

    def _texts(self, cells: tuple[Any, ...], line: int) -> list[str]:
        """Return the cells of a row, as many as the header has."""
        texts = []
        for header, place in zip(self.headers, self.columns, strict=True):
            cell = cells[place] if place < len(cells) else None
            try:
                texts.append("" if cell is None else self._text(cell, header.unit, place))
            except ValueError as error:
                self.faults.add(f"{header.name}: {error}", line, header.name)
                texts.append("")
        return texts

    def _text(self, cell: Any, unit: str | None, place: int) -> str:
        value = cell.value
        if isinstance(value, (int, float)):
            return repr(in_per_cent(cell)) if unit == "%" and not isinstance(value, bool) else cell_text(cell)
        if isinstance(value, (datetime, time, timedelta)) and unit is not None and _is_time(unit):
            return repr(float(from_si(self._seconds(value, place), unit)))
        return cell_text(cell)

    def _seconds(self, value: datetime | time | timedelta, place: int) -> float:
        """Return a duration, the time of a day, or the time since the first date of the column."""
        if isinstance(value, datetime):
            return (value - self._starts.setdefault(place, value)).total_seconds()
        if isinstance(value, time):
            value = datetime.combine(datetime.min, value) - datetime.min
        return value.total_seconds()


def _is_time(unit: str) -> bool:
    try:
        return same_dimension(unit, "s")
    except UnitError:
        return False


def _is_error(cell: Any) -> bool:
    return bool(cell.data_type == "e")


@contextmanager
def opened_workbook(path: Path, names: ColumnNames) -> Iterator[WorkbookTable]:
    """Open a table in a workbook. Raises InputError where it cannot be one, or has no header."""
    with opened_book(path, largest=LARGEST_TABLE) as sheet:
        rows = sheet.rows()
        head = _head(sheet, rows)
        if head is None:
            raise InputError([Fault(f"is empty; {INSTEAD}", str(path), 1, sheet.address(sheet.area.first_row, 1))])
        line, texts, ahead = head
        columns = [place for place, text in enumerate(texts) if text.strip()]
        places = {(name_and_unit(texts[place])[0] or ""): place for place in reversed(columns)}

        def addressed(row: int, column: str | int) -> str:
            place = columns[column] if isinstance(column, int) else places.get(column, columns[0])
            return sheet.address(row, sheet.area.first_column + place)

        faults = Faults(str(sheet.file), addressed)
        headers = headers_of([texts[place] for place in columns], line, faults, names)
        places |= {header.name: place for header, place in zip(headers, columns, strict=True) if header.key}
        yield WorkbookTable(str(path), faults, headers, line, columns, sheet, chain(ahead, rows))


# Where the header stands


def _head(sheet: BookSheet, rows: Iterator[SheetRow]) -> tuple[int, list[str], list[SheetRow]] | None:
    """Return the row of the header, its cells with their units, and the rows behind it that were looked at."""
    ahead = list(islice((row for row in rows if not _is_remark(row[1])), 1))
    if not ahead:
        return None
    merged = [area for area in sheet.merged() if area.first_row >= sheet.area.first_row]
    ahead += islice(rows, 2)
    while len(ahead) > 1 and _is_group(sheet, ahead[0], ahead[1], merged):
        above = ahead.pop(0)
        ahead[0] = (ahead[0][0], _carried(sheet, above, ahead[0], merged))
        ahead += islice(rows, 1)
    (line, cells), *behind = ahead
    texts = ["" if cell is None or cell.value is None else " ".join(str(cell.value).split()) for cell in cells]
    if len(behind) > 1 and (units := _units(texts, behind[0][1], behind[1][1])):
        texts = [f"{text} [{unit}]" if unit is not None else text for text, unit in zip(texts, units, strict=True)]
        behind = behind[1:]
    return line, texts, behind


def _is_remark(cells: tuple[Any, ...]) -> bool:
    first = next(cell.value for cell in cells if cell.value is not None)
    return isinstance(first, str) and first.lstrip().startswith("#")


def _is_group(sheet: BookSheet, row: SheetRow, below: SheetRow, merged: Sequence[CellRange]) -> bool:
    """Whether a row is a title or a group head: one of its cells is merged over several that are texts below it."""
    for area in merged:
        first = area.first_column - sheet.area.first_column
        end = (area.last_column or area.first_column) - sheet.area.first_column + 1
        if area.first_row <= row[0] <= (area.last_row or row[0]) < below[0] and end - first > 1:
            texts = [cell.value for cell in below[1][max(first, 0) : end] if isinstance(cell.value, str)]
            if len(texts) > 1:
                return True
    return False


def _carried(sheet: BookSheet, above: SheetRow, row: SheetRow, merged: Sequence[CellRange]) -> tuple[Any, ...]:
    """Return the cells of a row, those that are merged with the row above it as they stand there."""
    cells = list(row[1]) + [None] * max(len(above[1]) - len(row[1]), 0)
    for area in merged:
        place = area.first_column - sheet.area.first_column
        if area.first_row == above[0] and (area.last_row or 0) >= row[0] and 0 <= place < len(above[1]):
            cells[place] = above[1][place]
    return tuple(cells)


def _units(texts: Sequence[str], row: tuple[Any, ...], below: tuple[Any, ...]) -> list[str | None] | None:
    """Return the unit of each header where a row below it holds nothing but units, and numbers follow; else None."""
    values = [row[place].value if place < len(row) else None for place in range(len(texts))]
    if len(row) > len(texts) and any(cell.value is not None for cell in row[len(texts) :]):
        return None
    units: list[str | None] = []
    for text, value in zip(texts, values, strict=True):
        unit = unit_in_cell(value)
        if (unit is None and value is not None) or (unit is not None and "[" in text):
            return None
        units.append(unit)
    numbers = [
        place for place, unit in enumerate(units)
        if unit is not None and place < len(below) and isinstance(below[place].value, (int, float, timedelta, datetime))
    ]  # fmt: skip
    return units if numbers else None


def unit_in_cell(value: Any) -> str | None:
    """Return the unit that a cell holds, None where it holds anything else."""
    if not isinstance(value, str):
        return None
    unit = value.strip().removeprefix("[").removesuffix("]").strip()
    if unit in _NO_UNIT or unit in PURE:
        return ""
    try:
        check_unit(unit)
    except UnitError:
        return None
    return unit
