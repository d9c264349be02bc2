"""Tables: read with what is known of their columns by name, every fault at once; written to read back exactly."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import cache, partial
from io import StringIO
from itertools import chain, groupby
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import InputField
from truing.errors import UnitError
from truing.inputs_file.assemble import toml_key, toml_value
from truing.inputs_file.values import SIGMA, InputsRead, broken_bound, read_input
from truing.measurements.csv_text import (
    EITHER,
    MARK,
    UNCOUNTED,
    ColumnNames,
    Faults,
    Header,
    OpenTable,
    RowCount,
    TableSource,
    guarded,
    opened_csv,
    plain_numbers,
    read_cell,
)
from truing.measurements.recorded_rows import Parts, opened_recording
from truing.measurements.workbook_rows import opened_workbook
from truing.recordings import is_recording
from truing.setup import NamedColumn
from truing.units import demand_dimension, difference_unit, human_dimension, si_fault, to_si
from truing.units.grammar import shown
from truing.units.names import PURE
from truing.workbooks.reading import is_workbook

RUN = "run"
NUMBERS = frozenset({"float", "whole", "series"})
"""The kinds of inputs that are quantities."""
NOT_NAMED: Mapping[str, NamedColumn] = MappingProxyType({})
WORDS = frozenset({"switch", "integer", "choice", "text"})
"""The kinds of inputs that are no quantities: their cells are read one by one."""
SWITCHES = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}


@dataclass(frozen=True)
class Source:
    """What is known of a column from which something is made: its unit (None for any), and what is made."""

    unit: str | None
    made: str


Known = InputField | Source | str
"""What is known of a column by its name: the input that it holds, what is made from it, or its declared unit."""


@dataclass(frozen=True)
class DataTable:
    """A table by the names of its columns, n rows.

    Numbers are in SI, (n,), NaN where a cell is empty; words of an input are an array of objects, None where a cell is
    empty; other words are tuples. ``units`` holds what the header says ("" for pure numbers), ``lines`` the line of
    the file each row begins in, ``header_line`` that of the header. ``cells`` are the columns as written, by the header
    as written (in a column of numbers a decimal comma becomes a point). ``count`` says how many rows the file holds,
    with those left out, and ``notes`` what was done to them, one sentence each. A recording has no line of
    a header, and its rows the lines that they have in the same table as CSV.
    """

    file: str
    columns: Mapping[str, NDArray[Any] | tuple[str, ...]]
    units: Mapping[str, str]
    lines: tuple[int, ...]
    header_line: int | None = 1
    count: RowCount = UNCOUNTED
    cells: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.lines)


def read_table(
    path: TableSource,
    known: Mapping[str, Known],
    *,
    is_measured: bool = True,
    words: Collection[str] = (),
    unknown: Callable[[Header], str] = lambda header: "",
    named: Mapping[str, NamedColumn] = NOT_NAMED,
    results: Collection[str] = (),
) -> tuple[DataTable, Faults]:
    """Read a table, and return it with its faults for a caller who looks for more of them.

    Columns that are ``known`` must have a unit of the declared dimension, keep the bounds of their input, and come in
    SI. Other columns are kept, in SI where their unit is known; those named by ``words``, the column ``run`` and
    columns that hold words stay words. Of what is measured, "NaN" is a missing value as an empty cell is, and
    ``sigma_NAME`` is a standard deviation of NAME; elsewhere cells are kept as written, and a word for a missing value
    is a fault. ``unknown`` says what is wrong with a column that is not known, or nothing. ``named`` says what columns
    are, by what the file calls them; readings of ``results`` keep their own times where a recording has several clocks.
    A column whose header is a fault is left out of ``columns``. Raises InputError where the file cannot be read at all.
    """
    names = ColumnNames(named)
    with opened_table(path, names, known, results) as file:
        columns = [_column(header, known, is_measured, words, unknown) for header in file.headers]
        lines, texts = _taken(columns, file, keep_texts=not is_measured)
    usable = [column for column in columns if column.header.name and not column.fault]
    made = {column.header.name: column.made(lines, file) for column in usable}
    file.marks.judge(file.faults)
    units = {header.name: header.unit or "" for header in file.headers}
    written = {text: _with_points(cells, file) for text, cells in texts.items()}
    notes = (*names.notes, *names.unused(file.headers))
    table = DataTable(str(path), made, units, tuple(lines), file.header_line, file.count(), written, notes)
    return table, file.faults


def _taken(columns: Sequence[_Column], file: OpenTable, *, keep_texts: bool) -> tuple[list[int], dict[str, list[str]]]:
    """Let every column take its cells; return the lines of the rows, and the columns as written where they are kept."""
    for index, column in enumerate(columns):
        if column.fault:
            file.faults.add(column.fault, file.header_line, index)
    lines: list[int] = []
    texts: dict[str, list[str]] = {header.text: [] for header in file.headers}
    for cells_of, lines_of in file.chunks():
        lines.extend(lines_of)
        for column, cells in zip(columns, cells_of, strict=True):
            column.take(cells, lines_of, file)
            texts[column.header.text].extend(cells if keep_texts else ())
    return lines, texts


def opened_table(
    path: TableSource, names: ColumnNames, known: Mapping[str, Known], results: Collection[str]
) -> AbstractContextManager[OpenTable]:
    """Open a file of any kind that is read, its cells still as text. Raises InputError where it cannot be one."""
    if isinstance(path, Path) and is_workbook(path):
        return opened_workbook(path, names)
    if isinstance(path, Path) and is_recording(path):
        words = {name for name, what in known.items() if isinstance(what, InputField) and what.kind in WORDS}
        return opened_recording(path, names, Parts(frozenset(known), frozenset(results), frozenset(words)))
    return opened_csv(path, names)


def _with_points(cells: Sequence[str], file: OpenTable) -> tuple[str, ...]:
    """Return cells as written, those of a column of numbers with a decimal point."""
    if file.decimal_comma and _numbers(cells, file) is not None:
        return tuple(cell.replace(",", ".") for cell in cells)
    return tuple(cells)


def _numbers(cells: Sequence[str], file: OpenTable) -> NDArray[np.float64] | None:
    """Return cells as numbers where each is a number, empty, or a word for a missing value."""
    comma = file.decimal_comma
    try:
        return np.array([read_cell(cell, decimal_comma=comma, may_be_missing_word=True) for cell in cells])
    except ValueError:
        return None


def _column(
    header: Header,
    known: Mapping[str, Known],
    is_measured: bool,
    words: Collection[str],
    unknown: Callable[[Header], str],
) -> _Column:
    """Return what takes the cells of a column, with what is wrong with its header."""
    name, what = header.name, known.get(header.name)
    field_of = what if isinstance(what, InputField) else None
    if field_of is not None and (field_of.kind == "file" or (field_of.kind == "series" and not field_of.spec.along)):
        return _Column(header, f"{name} cannot change from row to row; state it in the inputs file")
    if field_of is not None and field_of.kind in WORDS:
        return _Words(header, word_header_fault(name, header.unit), field_of)
    if what is not None:
        unit = _unit(what)
        fault = header_fault(header, unit) if unit is not None else ""
        fault += f" ('{what.made}' is made from it)" if fault and isinstance(what, Source) else ""
        return _Numbers(header, fault, unit, field_of, is_strict=not is_measured)
    measured = known.get(name.removeprefix(SIGMA)) if is_measured and name.startswith(SIGMA) else None
    if not (isinstance(measured, InputField) and measured.kind not in NUMBERS) and _unit(measured) is not None:
        unit = difference_unit(_unit(measured) or "")
        return _Numbers(header, header_fault(header, unit), unit, is_sigma=True)
    return _Texts(header, unknown(header), is_words=name in words or name == RUN)


def _unit(what: Known | None) -> str | None:
    return what.unit if isinstance(what, (InputField, Source)) else what


@dataclass
class _Column:
    """A column of a table; this one is no use, and its cells are not looked at."""

    header: Header
    fault: str

    def take(self, cells: Sequence[str], lines: Sequence[int], file: OpenTable) -> None:
        """Take the cells of the next rows; what is wrong with one is a fault with its line."""

    def made(self, lines: Sequence[int], file: OpenTable) -> NDArray[Any] | tuple[str, ...]:
        """Return the whole column."""
        return ()


@dataclass
class _Numbers(_Column):
    """A column of numbers that is known: cells become numbers as they come; ``declared`` is None for any unit."""

    declared: str | None
    item: InputField | None = None
    is_strict: bool = False
    is_sigma: bool = False
    parts: list[NDArray[np.float64]] = field(default_factory=list)

    def take(self, cells: Sequence[str], lines: Sequence[int], file: OpenTable) -> None:
        """Take cells: numbers, empty, or where that is allowed a word for a missing value."""
        values = self._read(cells, lines, file)
        if self.is_sigma and (values < 0).any():
            line = lines[int((values < 0).argmax())]
            file.faults.add(f"{self.header.name}: a standard deviation is 0 or more", line, self.header.name)
        if self.fault:
            return
        self.parts.append(self._in_si(values, cells, lines, file.faults))
        if self.item is not None:
            _keep_bounds(self.item, self.parts[-1], lines, file.faults)

    def _read(self, cells: Sequence[str], lines: Sequence[int], file: OpenTable) -> NDArray[np.float64]:
        """Return numbers as they stand; what is none is a fault with its line."""
        fast = plain_numbers(cells)
        if fast is not None and not (file.decimal_comma and any("." in cell for cell in cells)):
            return fast
        values = np.full(len(cells), math.nan)
        for row, cell in enumerate(cells):
            try:
                values[row] = read_cell(cell, decimal_comma=file.decimal_comma, may_be_missing_word=not self.is_strict)
                file.marks.take(self.header.name, cell.strip(), lines[row])
            except ValueError as error:
                file.faults.add(f"{self.header.name}: {error}", lines[row], self.header.name)
        return values

    def _in_si(
        self, values: NDArray[np.float64], cells: Sequence[str], lines: Sequence[int], faults: Faults
    ) -> NDArray[np.float64]:
        """Bring numbers to SI; one that cannot be one of the declared unit there is a fault."""
        unit = self.header.unit or ""
        if unit in PURE:
            return values
        with np.errstate(over="ignore"):
            converted = in_si(values, unit)
        odd = np.isfinite(values) & (~np.isfinite(converted) | (converted < 0) | ((converted == 0) & (values != 0)))
        for row in np.flatnonzero(odd).tolist():
            if fault := si_fault(float(values[row]), float(converted[row]), self.declared or ""):
                written = f"{cells[row].strip()} {unit}"
                faults.add(f"{self.header.name}: {shown(written)} {fault}", lines[row], self.header.name)
        return converted

    def made(self, lines: Sequence[int], file: OpenTable) -> NDArray[np.float64]:
        """Return the column in SI, NaN where a cell is empty."""
        return np.concatenate([np.empty(0), *self.parts])


def _keep_bounds(input_field: InputField, values: NDArray[np.float64], lines: Sequence[int], faults: Faults) -> None:
    distinct = np.unique(values[np.isfinite(values)]).tolist()
    tried = distinct if getattr(input_field.spec, "whole", False) else [*distinct[:1], *distinct[-1:]]
    if any(broken_bound(input_field, value) for value in tried):
        broken = {value: broken_bound(input_field, value) for value in distinct}
        for line, value in zip(lines, values.tolist(), strict=True):
            if said := broken.get(value):
                faults.add(said, line, input_field.name)


@dataclass
class _Words(_Column):
    """A column of an input that is a choice, a text, a switch or a whole number."""

    item: InputField
    values: list[Any] = field(default_factory=list)
    read: dict[str, Any] = field(default_factory=lambda: {"": None})

    def take(self, cells: Sequence[str], lines: Sequence[int], file: OpenTable) -> None:
        """Take cells: each is one of the values that the input may have, or empty."""
        if self.fault:
            return
        for cell, line in zip(map(str.strip, cells), lines, strict=True):
            try:
                if cell not in self.read:
                    self.read[cell] = read_word(self.item, cell, decimal_comma=file.decimal_comma)
                self.values.append(self.read[cell])
                if self.item.kind == "integer":
                    file.marks.take(self.header.name, cell, line)
            except ValueError as error:
                is_named = str(error).startswith(self.header.name)
                said = str(error) if is_named else f"{self.header.name}: {error}"
                file.faults.add(said, line, self.header.name)
                self.values.append(None)

    def made(self, lines: Sequence[int], file: OpenTable) -> NDArray[Any]:
        """Return the values as objects, None where a cell is empty."""
        return np.fromiter(self.values, dtype=object)


@dataclass
class _Texts(_Column):
    """A column that nobody knows: numbers if every cell is one, in SI where the unit is known, else words."""

    is_words: bool
    cells: list[str] = field(default_factory=list)

    def take(self, cells: Sequence[str], lines: Sequence[int], file: OpenTable) -> None:
        """Take cells, whatever they hold."""
        self.cells.extend(cells)

    def made(self, lines: Sequence[int], file: OpenTable) -> NDArray[np.float64] | tuple[str, ...]:
        """Return numbers or words; the decimal marks of numbers must be those of the file."""
        is_number = not self.is_words and any(cell.strip() for cell in self.cells)
        values = _numbers(self.cells, file) if is_number else None
        if values is None:
            return tuple(cell.strip() for cell in self.cells)
        if file.decimal_comma:
            for cell, line in zip(self.cells, lines, strict=True):
                file.marks.take(self.header.name, cell.strip(), line)
        return in_si(values, self.header.unit or "")


# Cells, units and words


def is_number(column: Any) -> TypeGuard[NDArray[np.float64]]:
    """Whether a column holds numbers."""
    return isinstance(column, np.ndarray) and column.dtype != object


def in_si(values: NDArray[np.float64], unit: str) -> NDArray[np.float64]:
    """Bring numbers from the unit of a header to SI; where nobody knows the unit they stay as they stand."""
    try:
        return values if unit in PURE else to_si(values, unit)
    except UnitError:
        return values


def header_fault(header: Header, declared: str) -> str:
    """Return what is wrong with the unit in a header where ``declared`` is expected, or nothing."""
    if header.unit is None:
        if declared in PURE:
            return ""
        like = f"'{header.name} [{declared}]'"
        if header.key:
            like = f"{toml_key(header.key)} = {toml_value({'name': header.name, 'unit': declared})} under [columns]"
        what = shown(header.key) if header.key else f"'{header.name}'"
        return f"column {what} has no unit; it is {human_dimension(declared)}: write {like}"
    try:
        demand_dimension(header.unit, declared)
    except UnitError as error:
        stated = "; state its unit under [columns]" if header.key else ""
        return f"column {shown(header.text)}: {error}{stated}"
    return ""


def word_header_fault(name: str, unit: str | None) -> str:
    """Return what is wrong with a unit in the header of an input that is no quantity, or nothing."""
    if unit is None or unit in PURE:
        return ""
    return f"column '{name}' has the unit [{unit}], but it is no quantity; write '{name}'"


def read_word(input_field: InputField, cell: str, *, decimal_comma: bool) -> Any:
    """Return the value of an input that is a choice, a text, a switch or a whole number. Raises ValueError."""
    raw: Any = cell.strip()
    if input_field.kind == "switch":
        raw = SWITCHES.get(raw.lower(), raw)
    elif input_field.kind == "integer":
        raw = read_cell(raw, decimal_comma=decimal_comma)
    return read_input(input_field, raw, InputsRead(Path()))


# Tables to text: numbers that read back exactly


@dataclass(frozen=True)
class TableStyle:
    """How a table is written: the mark before it, what parts cells and lines, and the decimal mark."""

    mark: str = ""
    delimiter: str = ","
    decimal: str = "."
    line_end: str = "\n"
    is_guarded: bool = False


PLAIN = TableStyle()
INERT = TableStyle(is_guarded=True)
"""What programs read, and no spreadsheet takes a word of for a formula."""
EXCEL = TableStyle(MARK, ";", ",", "\r\n", is_guarded=True)
"""What a spreadsheet with a decimal comma opens by a double click."""


LINE_ENDS = re.compile(r"[\r\n]+")


def table_text(headers: Sequence[str], columns: Sequence[Iterable[Any]], *, form: TableStyle = PLAIN) -> str:
    """Return columns under headers such as "depth [um]" as the text of a file; the numbers are in these units already.

    Numbers are written so that they read back exactly (at most 17 digits), NaN and None as empty cells; words stay as
    they are, line ends in them become blanks.
    """
    if len(headers) != len(columns):
        raise ValueError(f"{len(headers)} headers for {len(columns)} columns")
    stream = StringIO(newline="")
    stream.write(form.mark)
    minimal, everything = (
        csv.writer(stream, delimiter=form.delimiter, lineterminator=form.line_end, quoting=quoting)
        for quoting in (csv.QUOTE_MINIMAL, csv.QUOTE_ALL)
    )
    alone = [""] if form.delimiter != "," and len(headers) == 1 else []
    cells = [_cells(headers, form)], zip(*(_cells(each, form) for each in columns), strict=True)
    for like_a_comment, rows in groupby(chain(*cells), lambda row: bool(row) and row[0].lstrip()[:1] == "#"):
        # a line that begins with # would be a comment; a column alone must show what parts the cells
        (everything if like_a_comment else minimal).writerows([*row, *alone] if alone else row for row in rows)
    return stream.getvalue()


def _cells(column: Iterable[Any], form: TableStyle) -> list[str]:
    """Return the cells of a column; a word that comes again is made once, and plain values instead of numpy's."""
    words: Callable[[str], str] = cache(partial(_cell, form=form))
    values = column.tolist() if hasattr(column, "tolist") else column
    return ["" if value is None else words(value) if type(value) is str else _cell(value, form) for value in values]


def _cell(value: Any, form: TableStyle) -> str:
    if isinstance(value, float):
        text = repr(value) if math.isfinite(value) else "" if math.isnan(value) else str(value)
        if form.decimal == ".":
            return text
        text = text.replace(".", form.decimal)
        return f"{text}0" if EITHER.fullmatch(text) else text
    if isinstance(value, bool):
        return str(value).lower()
    text = LINE_ENDS.sub(" ", str(value))  # a cell ends in the line in which it begins
    return guarded(text) if form.is_guarded and isinstance(value, str) else text
