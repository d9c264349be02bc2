"""Rows read by the gauge again and again with something changed: inputs moved, unknowns of effects set.

A call of a model costs much whatever its rows, so that many changes are asked in one call.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.gauge import answers_many, read_by_gauge, read_each, seen_columns
from truing.measurements import RowsFile
from truing.setup import Setup

Trial = Mapping[str, Any]
AT_ONCE = 65_536
"""So many rows are one call of the model."""


def read_trials(
    machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str]
) -> Iterator[Mapping[str, NDArray[np.float64]]]:
    """Give what the gauge shows of every row in each trial, SI (n,) by result, NaN where the model fails.

    A trial sets inputs and conditions to one value or to (n,), unknowns of effects that are on (``effect_column``) to
    (n,), in SI and in place of what machine and rows say.
    """
    count = min(len(trials), AT_ONCE // max(len(rows), 1))
    if count < 2 or any(name in rows.series for trial in trials for name in trial):
        yield from (_read(*_changed(machine, rows, trial), wanted) for trial in trials)
        return
    is_many = answers_many(machine, rows, wanted)
    for begin in range(0, len(trials), count):
        block = trials[begin : begin + count]
        if is_many:
            yield from (each.results for each in read_each(machine, rows, block, wanted))
            continue
        values = _read(machine, _stacked(machine, rows, block), wanted, len(block))
        parts = {name: np.split(value, len(block)) for name, value in values.items()}
        yield from ({name: part[index] for name, part in parts.items()} for index in range(len(block)))


def _changed(machine: Setup, rows: RowsFile, trial: Trial) -> tuple[Setup, RowsFile]:
    """Return machine and rows of a trial: one value for all rows is the machine's, others are columns of its own."""
    columns = {name: np.array(value) for name, value in trial.items() if np.ndim(value) > 0}
    series = {name: columns.pop(name, values) for name, values in rows.series.items()}
    values = {name: value for name, value in trial.items() if np.ndim(value) == 0}
    moved = machine.changed(values) if values else machine
    return moved, replace(rows, columns={**rows.columns, **columns}, series=series)


def _stacked(machine: Setup, rows: RowsFile, trials: Sequence[Trial]) -> RowsFile:
    """Return the rows as each trial has them, one trial behind another; of the columns what somebody looks at."""
    names = seen_columns(machine, dict.fromkeys([*rows.columns, *(name for one in trials for name in one)]))
    return replace(
        rows,
        columns={name: _behind(name, machine, rows, trials) for name in names},
        axes={name: np.tile(values, len(trials)) for name, values in rows.axes.items()},
        lines=rows.lines * len(trials),
        runs=rows.runs * len(trials),
    )


def _behind(name: str, machine: Setup, rows: RowsFile, trials: Sequence[Trial]) -> Any:
    """Return a column as each trial has it, one behind another."""
    values: Any = rows.columns.get(name)
    if isinstance(values, list):
        return values * len(trials)
    if values is None and not all(name in trial for trial in trials):
        values = machine.nominal(name)
    if not any(name in trial for trial in trials):
        return np.tile(np.broadcast_to(values, (len(rows),)), len(trials))
    column = np.empty((len(trials), len(rows)))
    for index, trial in enumerate(trials):
        column[index] = trial.get(name, values)
    return column.ravel()


def _read(
    machine: Setup, rows: RowsFile, wanted: Collection[str], repeats: int = 1
) -> Mapping[str, NDArray[np.float64]]:
    """Read rows, not too many of them in one call."""
    if len(rows) <= AT_ONCE or rows.series:
        return read_by_gauge(machine, rows, wanted, repeats).results
    blocks = [slice(begin, begin + AT_ONCE) for begin in range(0, len(rows), AT_ONCE)]
    parts = [read_by_gauge(machine, rows.taken(block), wanted).results for block in blocks]
    return {name: np.concatenate([part[name] for part in parts]) for name in wanted}
