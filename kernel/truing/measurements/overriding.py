"""Tables whose columns override inputs and conditions: cases of a run, and the rows of a virtual measurement."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Axis, InputField
from truing.declare.near_miss import near_miss
from truing.declare.sources import SINCE_START, Condition
from truing.inputs_file.values import InputsRead, broken_bound, read_input
from truing.kernel import Offer
from truing.measurements.cells import column_in_si, header_fault, read_cell, read_cells
from truing.measurements.csv_text import CsvFile, Header, opened
from truing.measurements.derived import derive
from truing.measurements.row_count import UNCOUNTED, RowCount
from truing.setup import Setup
from truing.units import si_fault, to_si
from truing.units.grammar import shown
from truing.units.names import PURE

NAMES = ("case", "name")
REMARKS = ("note", "remark", "comment")
WORDS = frozenset({"switch", "integer", "choice", "text"})
"""The kinds of inputs whose cells are read one by one."""


@dataclass(frozen=True)
class StatedCase:
    """One case: its row (the first is 1), the line it stands in, its name, and what it changes, in SI."""

    row: int
    line: int
    name: str
    values: Mapping[str, Any]
    file: str = field(default="", compare=False)


@dataclass(frozen=True)
class CasesFile:
    """The cases of a file, and how many rows it holds."""

    cases: tuple[StatedCase, ...]
    count: RowCount


@dataclass(frozen=True)
class RowsFile:
    """Rows to calculate: ``columns`` that override inputs and conditions, in SI, and everything as it was written.

    Inputs that may vary and conditions are arrays (n,), every other input a list of n values. Where a cell is empty
    the value of the inputs file stands. ``series`` holds columns of inputs that run along an axis, ``axes`` where each
    row lies on an axis of the results. ``cells`` are all columns as written (a decimal comma becomes a point), by the
    header as written; ``others`` names the columns that override nothing. ``runs`` names the run of each row; nothing
    where there is no such column. ``count`` says how many rows the file holds, with those left out.
    """

    file: str
    columns: Mapping[str, NDArray[np.float64] | list[Any]]
    series: Mapping[str, NDArray[np.float64]]
    cells: Mapping[str, tuple[str, ...]]
    lines: tuple[int, ...]
    others: tuple[str, ...] = ()
    axes: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    runs: tuple[str, ...] = ()
    count: RowCount = UNCOUNTED

    @property
    def headers(self) -> tuple[str, ...]:
        """The header cells as written, in order."""
        return tuple(self.cells)

    def __len__(self) -> int:
        return len(self.lines)

    def placed(self, name: str) -> NDArray[np.float64] | None:
        """Return what each row says of an input, a condition or an axis, SI (n,); None where no column has it."""
        kinds: tuple[Mapping[str, Any], ...] = (self.columns, self.axes, self.series)
        return next((np.asarray(kind[name], dtype=float) for kind in kinds if name in kind), None)

    def taken(self, places: NDArray[np.intp] | slice) -> RowsFile:
        """Return some of the rows, in this order."""

        def of(column: Any) -> Any:
            if isinstance(places, slice) or isinstance(column, np.ndarray):
                return column[places]
            return [column[place] for place in places.tolist()]

        return replace(
            self,
            columns={name: of(column) for name, column in self.columns.items()},
            series={name: of(column) for name, column in self.series.items()},
            cells={name: tuple(of(column)) for name, column in self.cells.items()},
            lines=tuple(of(self.lines)),
            axes={name: of(column) for name, column in self.axes.items()},
            runs=tuple(of(self.runs)) if self.runs else (),
        )


@dataclass
class _Texts:
    """A whole table as text, column by column."""

    table: CsvFile
    cells: list[list[str]]
    lines: list[int] = field(default_factory=list)


def _read_texts(table: CsvFile) -> _Texts:
    texts = _Texts(table, [[] for _ in table.headers])
    for chunk in table.chunks():
        texts.lines.extend(chunk.lines)
        for kept, more in zip(texts.cells, chunk.cells, strict=False):
            kept.extend(more)
    return texts


def read_cases(path: Path, offer: Offer, setup: Setup) -> CasesFile:
    """Read cases: every row overrides inputs and conditions; an empty cell keeps what the inputs file says.

    A column ``case`` or ``name`` names the cases; ``note`` may hold remarks. Raises InputError with every fault.
    """
    with opened(path) as table:
        texts = _read_texts(table)
    values: list[dict[str, Any]] = [{} for _ in texts.lines]
    names = [""] * len(texts.lines)
    for header, cells in zip(table.headers, texts.cells, strict=True):
        if header.name in NAMES and header.name not in setup.model.input_fields:
            names = [cell.strip() or name for cell, name in zip(cells, names, strict=True)]
        elif _is_known(header.name, setup):
            for row, value in enumerate(_values(header, cells, texts, setup)):
                if value is not None:
                    values[row][header.name] = value
        elif header.name not in REMARKS:
            table.faults.add(_unknown(header, setup, offer), table.header_line)
    table.marks.judge(table.faults)
    table.faults.raise_any()
    cases = [
        StatedCase(row, line, name or f"{row}", found, str(path))
        for row, (line, name, found) in enumerate(zip(texts.lines, names, values, strict=True), start=1)
    ]
    return CasesFile(tuple(cases), table.count())


def read_rows(path: Path, offer: Offer, setup: Setup) -> RowsFile:
    """Read the rows of a virtual measurement; columns that are no input and no condition are kept as written.

    Conditions that are history are made from these rows (``derived``); those of the kernel are known where an effect
    that is on needs them, or the inputs file states them. Raises InputError with every fault.
    """
    with opened(path) as table:
        texts = _read_texts(table)
    read = _Columns()
    for header, cells in zip(table.headers, texts.cells, strict=True):
        _take(header, cells, texts, setup, read)
    made, used = _histories(texts, setup, read)
    read.columns.update(made)
    used |= {*read.columns, *read.series, *read.axes, *(["run"] if read.series else [])}
    others = tuple(header.name for header in table.headers if header.name not in used)
    _judge_marks(texts, others)
    table.faults.raise_any()
    written = {header.text: _written(cells, table) for header, cells in zip(table.headers, texts.cells, strict=True)}
    return RowsFile(
        str(path), read.columns, read.series, written, tuple(texts.lines), others, read.axes, read.runs, table.count()
    )


def _judge_marks(texts: _Texts, others: Sequence[str]) -> None:
    """Refuse mixed decimal marks, in columns of numbers that are only kept too."""
    table = texts.table
    for header, cells in zip(table.headers, texts.cells, strict=True):
        if table.decimal_comma and header.name in others and header.name != "run" and _are_numbers(cells):
            for cell, line in zip(cells, texts.lines, strict=True):
                table.marks.take(header.name, cell.strip(), line)
    table.marks.judge(table.faults)


@dataclass
class _Columns:
    """The columns of a file as far as they are read; ``raw`` holds numbers before history is made of them."""

    columns: dict[str, Any] = field(default_factory=dict)
    series: dict[str, Any] = field(default_factory=dict)
    axes: dict[str, Any] = field(default_factory=dict)
    raw: dict[str, Any] = field(default_factory=dict)
    runs: tuple[str, ...] = ()


def _take(header: Header, cells: list[str], texts: _Texts, setup: Setup, read: _Columns) -> None:
    """Read one column to its place; where a cell is empty the value of the inputs file stands."""
    name = header.name
    is_axis, is_known = _is_axis(name, setup), _is_known(name, setup)
    if name == "run" and not is_axis:
        read.runs = tuple(cell.strip() for cell in cells)
    if not is_axis and not is_known:
        return
    item = setup.model.input_fields.get(name)
    found = _values(header, cells, texts, setup)
    if is_axis or (item is not None and item.kind == "series"):
        read.raw[name] = numbers = np.array([math.nan if value is None else value for value in found], dtype=float)
        (read.axes if is_axis else read.series)[name] = numbers
        return
    otherwise = setup.calibrated.get(name, setup.nominal(name))
    filled = [otherwise if value is None else value for value in found]
    if item is not None and not item.varies:
        read.columns[name] = filled
        return
    read.columns[name] = np.array(filled, dtype=float)
    raw = filled if item is not None else [math.nan if value is None else value for value in found]
    read.raw[name] = np.array(raw, dtype=float)


def _histories(texts: _Texts, setup: Setup, read: _Columns) -> tuple[dict[str, NDArray[np.float64]], set[str]]:
    """Return the conditions in force that are made from whole runs of the file, SI, and the columns used for that.

    One with a column of its own is not made from another. Where nothing can be said the value of the inputs file
    stands.
    """
    wanted = [item for item in setup.model.known_conditions.values() if item.derived and _is_known(item.name, setup)]
    wanted = [item for item in wanted if item.made_from == item.name or item.name not in read.columns]
    made: dict[str, NDArray[np.float64]] = {}
    used: set[str] = set()
    for condition in wanted:
        source = read.raw.get(condition.made_from)
        source = _stranger(condition, texts) if source is None else source
        if source is None:
            continue
        runs, time = np.array(read.runs) if read.runs else None, read.raw.get("time")
        values = derive(condition, {condition.made_from: source}, runs, _clock(texts) if time is None else time)
        made[condition.name] = np.where(np.isnan(values), setup.nominal(condition.name), values)
        used |= {condition.made_from, *(["run", "time"] if condition.history != SINCE_START else ["time"])}
    return made, used


def _stranger(condition: Condition, texts: _Texts) -> NDArray[np.float64] | None:
    """Return the column from which a condition is made where it is neither input nor condition; None if not there."""
    found = [header for header in texts.table.headers if header.name == condition.made_from]
    if not found:
        return None
    header = found[0]
    fault = "" if condition.history == "direction" else header_fault(header, condition.unit)
    if fault:
        texts.table.faults.add(f"{fault} ('{condition.name}' is made from it)", texts.table.header_line)
        return None
    cells, table = texts.cells[header.place], texts.table
    numbers = read_cells(cells, texts.lines, header, table, strict=True)
    if condition.history == "direction":
        return numbers
    return column_in_si(numbers, texts.lines, header, condition.unit, table.faults)


def _clock(texts: _Texts) -> NDArray[np.float64] | None:
    """Return a column "time" that nothing but the order of the rows depends on; None where it is none of numbers."""
    for header in texts.table.headers:
        if header.name == "time":
            comma = texts.table.decimal_comma
            try:
                return np.array([read_cell(cell, decimal_comma=comma) for cell in texts.cells[header.place]])
            except ValueError:
                return None
    return None


def _written(cells: list[str], table: CsvFile) -> tuple[str, ...]:
    """Return the cells as written, those of a column of numbers with a decimal point: commas part what is written."""
    if not table.decimal_comma or not _are_numbers(cells):
        return tuple(cells)
    return tuple(cell.replace(",", ".") for cell in cells)


def _are_numbers(cells: Sequence[str]) -> bool:
    try:
        for cell in cells:
            read_cell(cell, decimal_comma=True, may_be_missing_word=True)
    except ValueError:
        return False
    return True


def _is_known(name: str, setup: Setup) -> bool:
    return name in setup.model.input_fields or name in setup.conditions


def _is_axis(name: str, setup: Setup) -> bool:
    item = setup.model.own_result_fields.get(name)
    return item is not None and isinstance(item.spec, Axis) and not item.spec.is_table


def _unknown(header: Header, setup: Setup, offer: Offer) -> str:
    known = [*setup.model.input_fields, *setup.conditions]
    meant = near_miss(header.name[:80], known)
    if header.name in setup.model.result_fields:
        meant = " It is a result; cases change inputs."
    return f"{offer.model.name} has no input {shown(header.name)}.{meant}"


def _values(header: Header, cells: list[str], texts: _Texts, setup: Setup) -> list[Any]:
    """Return the values of one column in SI, None where a cell is empty or a fault."""
    item = setup.model.input_fields.get(header.name)
    faults, table = texts.table.faults, texts.table
    if item is not None and (item.kind == "file" or (item.kind == "series" and not item.spec.along)):
        faults.add(f"{header.name} cannot change from row to row; state it in the inputs file", table.header_line)
        return [None] * len(cells)
    is_word = item is not None and item.kind in WORDS
    fault = (
        word_header_fault(header.name, header.unit) if is_word else header_fault(header, _unit_of(header.name, setup))
    )
    if fault:
        faults.add(fault, table.header_line)
        return [None] * len(cells)
    found: list[Any] = []
    for cell, line in zip(cells, texts.lines, strict=True):
        try:
            found.append(_value(cell, header, item, texts, setup) if cell.strip() else None)
            if not is_word or (item is not None and item.kind == "integer"):
                table.marks.take(header.name, cell.strip(), line)
        except ValueError as error:
            found.append(None)
            sentence = str(error)
            faults.add(sentence if sentence.startswith(header.name) else f"{header.name}: {sentence}", line)
    return found


def _unit_of(name: str, setup: Setup) -> str:
    item = setup.model.own_result_fields.get(name)
    return setup.unit_of(name) if item is None else item.unit


def word_header_fault(name: str, unit: str | None) -> str:
    """Return what is wrong with a unit in the header of an input that is no quantity, or nothing."""
    if unit is None or unit in PURE:
        return ""
    return f"column '{name}' has the unit [{unit}], but it is no quantity; write '{name}'"


def read_word(item: InputField, cell: str, *, decimal_comma: bool) -> Any:
    """Return the value of an input that is a choice, a text, a switch or a whole number. Raises ValueError."""
    raw: Any = cell.strip()
    if item.kind == "switch":
        raw = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}.get(raw.lower(), raw)
    elif item.kind == "integer":
        raw = read_cell(raw, decimal_comma=decimal_comma)
    return read_input(item, raw, InputsRead(Path()))


def _value(cell: str, header: Header, item: InputField | None, texts: _Texts, setup: Setup) -> Any:
    """Return one cell in SI, its bounds checked. Raises ValueError with one sentence."""
    if item is not None and item.kind in WORDS:
        return read_word(item, cell, decimal_comma=texts.table.decimal_comma)
    number, unit = read_cell(cell.strip(), decimal_comma=texts.table.decimal_comma), header.unit or ""
    value = number if unit in PURE else to_si(number, unit)
    fault = si_fault(number, value, _unit_of(header.name, setup))
    if fault:
        raise ValueError(f"{shown(f'{cell.strip()} {unit}')} {fault}")
    sentence = broken_bound(item, value) if item is not None else ""
    if sentence:
        raise ValueError(sentence)
    return value
