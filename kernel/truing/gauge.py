"""What the gauge would show: the results of one machine at every row of a file, readings included."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Axis
from truing.errors import UsageError
from truing.evaluate import Rows, evaluate_rows
from truing.measurements import RowsFile
from truing.setup import Setup
from truing.units import from_si

TOGETHER = 16
"""So many calculations that each answer for many rows are one call of the model: more no longer fit the cache."""


@dataclass(frozen=True)
class Shown:
    """Results by name in the unit they are printed in, shape (rows,), NaN where there is none; why, by row."""

    values: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str]
    reasons: Mapping[int, str]


def one_machine(setup: Setup) -> Setup:
    """Return the setup of this one machine: its calibrated inputs in place, nothing drawn."""
    return setup.changed(setup.calibrated)


def shown_by_gauge(setup: Setup, rows: RowsFile) -> Shown:
    """Evaluate every row of a file and return the results in the units they are printed in.

    The machine is calibrated; its readings act. What lies nowhere on the axis of a result keeps the reason.
    """
    machine = one_machine(setup)
    evaluated = read_by_gauge(machine, rows)
    if not evaluated.results:
        axes = sorted({result.along for result in machine.model.own_result_fields.values() if result.along})
        raise UsageError(f"every result of {machine.model.name} runs along {' or '.join(axes)}: give that column")
    units = {name: machine.print_unit(name) for name in evaluated.results}
    values = {name: from_si(value, units[name]) for name, value in evaluated.results.items()}
    reasons = {**without_place(evaluated, machine, rows), **_lacking(evaluated), **evaluated.reasons}
    return Shown(values, units, dict(sorted(reasons.items())))


def _lacking(evaluated: Rows) -> dict[int, str]:
    said: dict[int, dict[str, list[str]]] = {}
    for name, lacking in evaluated.absent.items():
        for row, reason in lacking.items():
            said.setdefault(row, {}).setdefault(reason, []).append(name)
    return {row: "; ".join(f"no {', '.join(names)}: {why}" for why, names in of.items()) for row, of in said.items()}


def read_by_gauge(machine: Setup, rows: RowsFile, wanted: Collection[str] | None = None, repeats: int = 0) -> Rows:
    """Evaluate every row: its columns replace inputs and conditions, readings act; one value (n,) per result, SI.

    A result along an axis is read at the row's place on it (linear between points, NaN beyond its ends); without such a
    column it is left out. An axis that follows an input series is calculated just at the places of the rows. Where
    inputs run along an axis, the rows of one run are one record and one evaluation; where results do, so are rows that
    are alike; else all rows are. Only ``wanted`` results are returned (all by default), and a row that lacks one of
    them fails. Conditions that no effect needs are not looked at. ``machine`` is taken as it is: see ``one_machine``.
    ``repeats``: see ``evaluate_rows``.
    """
    if answers_many(machine, rows, wanted):
        (answer,) = read_each(machine, rows, [{}], wanted)
        return answer
    names, columns = set(_readable(machine, rows, wanted)), seen_columns(machine, rows.columns)
    machine = _at_places(machine, rows)
    answer = evaluate_rows(machine, columns, len(rows), reading=True, wanted=names, repeats=repeats)
    return answer if wanted is None else answer.complete()


def answers_many(machine: Setup, rows: RowsFile, wanted: Collection[str] | None = None) -> bool:
    """Whether one calculation answers for many rows: for a record, along an axis, or where no column is looked at."""
    along = any(machine.model.axes[name] for name in _readable(machine, rows, wanted))
    return bool(rows.series) or along or not seen_columns(machine, rows.columns)


def seen_columns(machine: Setup, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return the columns that the model or an effect that is on looks at."""
    return {name: values for name, values in columns.items() if name in machine.columns_looked_at}


def _at_places(machine: Setup, rows: RowsFile) -> Setup:
    """Put the places of the rows into the input series that an axis follows, unless a column holds that series."""
    changes: dict[str, Any] = {}
    for name, result in machine.model.own_result_fields.items():
        series = result.spec.follows if isinstance(result.spec, Axis) else ""
        if series and series not in rows.series and name in rows.axes:
            places = np.unique(rows.axes[name][np.isfinite(rows.axes[name])])
            changes |= {series: places} if len(places) else {}
    return machine.changed(changes) if changes else machine


def without_place(evaluated: Rows, machine: Setup, rows: RowsFile) -> dict[int, str]:
    """Say which rows lie nowhere on the axis of a result, so that nothing can be read there."""
    reasons: dict[int, str] = {}
    for name, values in evaluated.results.items():
        axis = machine.model.axes[name]
        for row in np.flatnonzero(np.isnan(values)) if axis else ():
            is_empty = np.isnan(rows.axes[axis][row])
            words = f"'{axis}' is not given" if is_empty else f"it lies beyond the axis '{axis}'"
            reasons.setdefault(int(row), f"'{name}' cannot be read at this row: {words}")
    return reasons


@dataclass(frozen=True)
class _Alike:
    """Rows that one calculation answers for, the one value that each column has there, and the trial."""

    places: NDArray[np.intp]
    values: Mapping[str, Any]
    trial: int


@dataclass(frozen=True)
class _Answer:
    """What is known so far of the rows of one trial."""

    values: dict[str, NDArray[np.float64]]
    reasons: dict[int, str] = field(default_factory=dict)
    absent: dict[str, dict[int, str]] = field(default_factory=dict)

    def take(
        self, computed: Rows, number: int, places: NDArray[np.intp], *, along: Mapping[str, str], rows: RowsFile
    ) -> None:
        """Take one calculation of several for the rows that it answers for, read at their places on the axes."""
        for name, values in self.values.items():
            value, axis = computed.results[name][number], along[name]
            values[places] = _read_at(rows.axes[axis][places], computed.results[axis][number], value) if axis else value
        if computed.failed[number]:
            self.reasons.update(dict.fromkeys(places.tolist(), computed.reasons[number]))
        for name, lacking in computed.absent.items():
            if number in lacking:
                self.absent.setdefault(name, {}).update(dict.fromkeys(places.tolist(), lacking[number]))

    def rows(self, count: int) -> Rows:
        """Return it as a batch answers."""
        failed = np.zeros(count, dtype=bool)
        failed[list(self.reasons)] = True
        return Rows(self.values, failed, dict(sorted(self.reasons.items())), self.absent)


def read_each(
    machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str] | None = None
) -> list[Rows]:
    """Return what ``read_by_gauge`` does, in several trials of the same rows where one calculation answers for many.

    A trial changes columns, to one value or to (n,). Calculations of several trials are one call of the model.
    """
    along = {name: machine.model.axes[name] for name in _readable(machine, rows, wanted)}
    asked, machine = {*along, *filter(None, along.values())}, _at_places(machine, rows)
    answers = [_Answer({name: np.full(len(rows), np.nan) for name in along}) for _ in trials]
    for record in _records(rows):
        series = {name: column[record] for name, column in rows.series.items()}
        for several, repeats in _calls(record, machine, rows, trials):
            columns = {name: _one_or_each([alike.values[name] for alike in several]) for name in several[0].values}
            changed, size = columns | series, len(several)
            computed = evaluate_rows(machine, changed, size, reading=True, wanted=asked, repeats=repeats)
            for number, alike in enumerate(several):
                answers[alike.trial].take(computed, number, alike.places, along=along, rows=rows)
    done = [answer.rows(len(rows)) for answer in answers]
    return done if wanted is None else [answer.complete() for answer in done]


def _calls(
    record: NDArray[np.intp], machine: Setup, rows: RowsFile, trials: Sequence[Trial]
) -> Iterator[tuple[list[_Alike], int]]:
    """Give the calculations of some trials of a record that are one call, and how many copies of one trial they are."""
    waiting: list[_Alike] = []
    count = 0
    for number, trial in enumerate(trials):
        own = [_Alike(*each, number) for each in _alike(record, machine, {**rows.columns, **trial}, rows)]
        if waiting and (len(waiting) + len(own) > TOGETHER or own[0].values.keys() != waiting[0].values.keys()):
            yield waiting, count
            waiting, count = [], 0
        waiting, count = waiting + own, count + 1 if len(waiting) == count * len(own) else 0
    yield waiting, count


def _one_or_each(values: list[Any]) -> Any:
    """Return what is one value for all as that, floats that differ as an array, other things as a list."""
    if all(value == values[0] for value in values):
        return values[0]
    return np.array(values) if isinstance(values[0], float) else values


def _records(rows: RowsFile) -> Sequence[NDArray[np.intp]]:
    """Return the rows of each run; without input series, or a column "run", the file is one."""
    return _places_by_run(rows.runs) if rows.series and rows.runs else (np.arange(len(rows)),)


@lru_cache(maxsize=8)
def _places_by_run(runs: tuple[str, ...]) -> tuple[NDArray[np.intp], ...]:
    """Return the places of the rows of each run; a fit asks for the same ones again and again."""
    rows_by_run: dict[str, list[int]] = {}
    for index, name in enumerate(runs):
        rows_by_run.setdefault(name, []).append(index)
    return tuple(np.array(places) for places in rows_by_run.values())


def _alike(
    record: NDArray[np.intp], machine: Setup, given: Mapping[str, Any], rows: RowsFile
) -> Iterator[tuple[NDArray[np.intp], dict[str, Any]]]:
    """Give the rows of a record that share their values, and these. Raises UsageError for an input that changes."""
    columns = seen_columns(machine, given)
    varying = [name for name, column in columns.items() if _varies(column, record)]
    for name in varying if rows.series else ():
        if name in machine.model.input_fields:
            column = columns[name]
            line = next(rows.lines[row] for row in record if column[row] != column[record[0]])
            raise UsageError(f"{rows.file}:{line}: {name} changes within a run, but a record is one calculation")
    for places in _grouped(record, [columns[name] for name in varying]):
        yield places, {name: _value_at(column, places[0]) for name, column in columns.items()}


def _grouped(record: NDArray[np.intp], columns: Sequence[Any]) -> Iterator[NDArray[np.intp]]:
    groups: dict[tuple[Any, ...], list[int]] = {}
    for row in record.tolist() if columns else ():
        groups.setdefault(tuple(column[row] for column in columns), []).append(row)
    yield from (np.array(places) for places in groups.values()) if columns else (record,)


def _is_column(column: Any) -> bool:
    return isinstance(column, list) or getattr(column, "ndim", 0) > 0


def _varies(column: Any, places: NDArray[np.intp]) -> bool:
    """Whether a column has more than one value at these places; NaN is a value of its own."""
    if isinstance(column, list):
        return any(column[row] != column[places[0]] for row in places)
    few = places[:1] if getattr(column, "strides", ()) == (0,) else places
    return _is_column(column) and bool((column[few] != column[places[0]]).any())


def _value_at(column: Any, row: int) -> Any:
    value = column[row] if _is_column(column) else column
    return value if isinstance(value, (str, bool, int)) else float(value)


def _readable(machine: Setup, rows: RowsFile, wanted: Collection[str] | None) -> Iterator[str]:
    """Give the wanted results that have one value per row, or are read at the row's place on their axis."""
    for name, axis in machine.model.axes.items():
        if (wanted is None or name in wanted) and (not axis or (axis in rows.axes and axis != name)):
            yield name


def _read_at(places: Any, axis: NDArray[np.float64], curve: NDArray[np.float64]) -> NDArray[np.float64]:
    """Read a curve at places of its axis, NaN beyond its ends; these may be missed by rounding."""
    order = np.argsort(axis)
    low, high = axis[order[0]], axis[order[-1]]
    rounding = 1e-9 * max(abs(low), abs(high))
    is_inside = (places >= low - rounding) & (places <= high + rounding)
    return np.where(is_inside, np.interp(places, axis[order], curve[order]), np.nan)


# Rows read again and again with something changed: a call costs much whatever its rows, so one asks many changes


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
