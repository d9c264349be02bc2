"""Tables whose columns override inputs and conditions: cases of a run, and the rows of a virtual measurement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Axis
from truing.declare.near_miss import near_miss
from truing.declare.sources import SINCE_START
from truing.kernel import Offer
from truing.measurements.csv_text import UNCOUNTED, Header, RowCount, TableSource
from truing.measurements.derived import TIME, histories
from truing.measurements.table import RUN, Known, Source, is_number, read_table
from truing.setup import Setup
from truing.units.grammar import shown

NAMES = ("case", "name")
REMARKS = ("note", "remark", "comment")


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
    """The cases of a file, how many rows it holds, and what was done to them, one sentence each."""

    cases: tuple[StatedCase, ...]
    count: RowCount
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class RowsFile:
    """Rows to calculate: ``columns`` that override inputs and conditions, in SI, and everything as it was written.

    Inputs that may vary and conditions are arrays (n,), every other input a list of n values. Where a cell is empty
    the value of the inputs file stands. ``series`` holds columns of inputs that run along an axis, ``axes`` where each
    row lies on an axis of the results. ``cells`` are all columns as written (a decimal comma becomes a point), by the
    header as written; ``others`` names the columns that override nothing. ``runs`` names the run of each row; nothing
    where there is no such column. ``count`` says how many rows the file holds, with those left out, and ``notes`` what
    was done to them, one sentence each.
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
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.lines)

    def taken(self, places: NDArray[np.intp] | slice) -> RowsFile:
        """Return some of the rows, in this order."""

        def of(column: Any) -> Any:
            if isinstance(places, slice) or isinstance(column, np.ndarray):
                return column[places]
            return [column[row] for row in places.tolist()]

        return replace(
            self,
            columns={name: of(column) for name, column in self.columns.items()},
            series={name: of(column) for name, column in self.series.items()},
            cells={name: tuple(of(column)) for name, column in self.cells.items()},
            lines=tuple(of(self.lines)),
            axes={name: of(column) for name, column in self.axes.items()},
            runs=tuple(of(self.runs)) if self.runs else (),
        )


def read_cases(path: TableSource, offer: Offer, setup: Setup) -> CasesFile:
    """Read cases: every row overrides inputs and conditions; an empty cell keeps what the inputs file says.

    A column ``case`` or ``name`` names the cases; ``note`` may hold remarks. Raises InputError with every fault.
    """
    known = _known(setup)

    def unknown(header: Header) -> str:
        return "" if header.name in (*NAMES, *REMARKS) else _no_input(header, setup, offer)

    table, faults = read_table(
        path, known, is_measured=False, words=(*NAMES, *REMARKS), unknown=unknown, named=setup.columns
    )
    faults.raise_any()
    values: list[dict[str, Any]] = [{} for _ in table.lines]
    names = [""] * len(table)
    for name, column in table.columns.items():
        if name in known:
            for row, value in enumerate(np.asarray(column).tolist()):
                if value is not None and value == value:
                    values[row][name] = value
        elif name in NAMES:
            names = [cell or name for cell, name in zip(column, names, strict=True)]
    cases = [
        StatedCase(row, line, name or f"{row}", changes, str(path))
        for row, (line, name, changes) in enumerate(zip(table.lines, names, values, strict=True), start=1)
    ]
    return CasesFile(tuple(cases), table.count, table.notes)


def _no_input(header: Header, setup: Setup, offer: Offer) -> str:
    meant = near_miss(header.name[:80], [*setup.model.input_fields, *setup.conditions])
    if header.name in setup.model.result_fields:
        meant = " It is a result; cases change inputs."
    return f"{setup.model.name} has no input {shown(header.name)}.{meant}"


def _known(setup: Setup) -> dict[str, Known]:
    return {**{name: setup.unit_of(name) for name in setup.conditions}, **setup.model.input_fields}


def read_rows(path: TableSource, offer: Offer, setup: Setup) -> RowsFile:
    """Read the rows of a virtual measurement; columns that are no input and no condition are kept as written.

    Conditions that are history are made from these rows (``derived``); those of the kernel are known where an effect
    that is on needs them, or the inputs file states them. Raises InputError with every fault.
    """
    known, axes = _known(setup), _axes(setup)
    past = [
        condition
        for condition in setup.model.known_conditions.values()
        if condition.derived and condition.name in known
    ]
    with_unit = [condition for condition in past if condition.history != "direction"]
    sources = {condition.made_from: Source(None, condition.name) for condition in past}  # any number has a direction
    sources |= {condition.made_from: Source(condition.unit, condition.name) for condition in with_unit}
    table, faults = read_table(path, {**sources, **axes, **known}, is_measured=False, named=setup.columns)
    faults.raise_any()
    numbers = {name: column for name, column in table.columns.items() if is_number(column)}
    places, series, columns = {}, {}, {}
    for name, column in table.columns.items():
        input_field = setup.model.input_fields.get(name)
        if name in axes:
            places[name] = numbers[name]
        elif input_field is not None and input_field.kind == "series":
            series[name] = numbers[name]
        elif name in known:
            columns[name] = _filled(name, column, setup)
    known_inputs = {name: column for name, column in columns.items() if name in setup.model.input_fields}
    raw = numbers | {name: column for name, column in known_inputs.items() if is_number(column)}
    run = table.columns.get(RUN)
    runs = run if isinstance(run, tuple) else ()
    made = histories(past, raw, np.array(runs) if runs else None, raw.get(TIME))
    columns |= {name: _filled(name, column, setup) for name, column in made.items()}
    used = {*columns, *series, *places, *([RUN] if series else [])}
    for condition in [condition for condition in past if condition.name in made]:
        used |= {condition.made_from, TIME, *([RUN] if condition.history != SINCE_START else [])}
    others = tuple(name for name in table.units if name not in used)
    return RowsFile(
        str(path), columns, series, table.cells, table.lines, others, places, runs, table.count, table.notes
    )


def _axes(setup: Setup) -> dict[str, Known]:
    fields = setup.model.own_result_fields.items()
    return {name: result.unit for name, result in fields if isinstance(result.spec, Axis) and not result.spec.is_table}


def _filled(name: str, column: Any, setup: Setup) -> NDArray[np.float64] | list[Any]:
    """Return a column in which the value of the inputs file stands where a cell is empty."""
    otherwise = setup.calibrated.get(name, setup.nominal(name))
    if is_number(column):
        return np.where(np.isnan(column), otherwise, column)
    return [otherwise if value is None else value for value in column.tolist()]
