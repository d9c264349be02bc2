"""What the gauge would show: the results of one machine at every row of a file, readings included."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Axis
from truing.declare.following import NotedError, following_together, is_noting
from truing.errors import Fault, InputError, UsageError
from truing.evaluate import Rows, evaluate_rows, put_together, rows_alike
from truing.measurements import RowsFile
from truing.setup import Setup
from truing.units import from_si

Trial = Mapping[str, Any]
"""What is changed where rows are read again and again: columns by name, in SI."""
AT_ONCE = 65_536
"""So many rows are one call of the model."""
TOGETHER = 16
"""So many calculations that each answer for many rows are one call of the model: more no longer fit the cache."""
MOVING_TOGETHER = 1024
"""The same of a model that moves: every step of it costs much whatever the number of machines."""

DRIVEN = "a motion is driven by one value at each time"


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
    demand_times(machine, rows)
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


def read_by_gauge(machine: Setup, rows: RowsFile, wanted: Collection[str] | None = None) -> Rows:
    """Evaluate every row: its columns replace inputs and conditions, readings act; one value (n,) per result, SI.

    A result along an axis is read at the row's place on it (linear between points, NaN beyond its ends); without such a
    column it is left out. An axis that follows an input series is calculated just at the places of the rows. Where
    inputs run along an axis, the rows of one run are one record and one evaluation; where results do, so are rows that
    are alike; else all rows are. Only ``wanted`` results are returned (all by default), and a row that lacks one of
    them fails. Conditions that no effect needs are not looked at. ``machine`` is taken as it is: see ``one_machine``.
    """
    if _answers_many(machine, rows, wanted):
        (answer,) = _read_each(machine, rows, [{}], wanted)
        return answer
    return _row_by_row(machine, rows, [{}], wanted)


def _answers_many(machine: Setup, rows: RowsFile, wanted: Collection[str] | None) -> bool:
    """Whether one calculation answers for many rows: for a record, along an axis, or where no column is looked at."""
    along = any(machine.model.axes[name] for name in _readable(machine, rows, wanted))
    return bool(rows.series) or along or not _seen_columns(machine, rows.columns)


def _seen_columns(machine: Setup, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return the columns that the model or an effect that is on looks at."""
    return {name: values for name, values in columns.items() if name in machine.columns_looked_at}


def _at_places(machine: Setup, rows: RowsFile, record: NDArray[np.intp] | slice = slice(None)) -> Setup:
    """Put the places of a record's rows into the input series that an axis follows, unless a column holds it."""
    changes: dict[str, Any] = {}
    for name, result in machine.model.own_result_fields.items():
        series = result.spec.follows if isinstance(result.spec, Axis) else ""
        if series and series not in rows.series and name in rows.axes:
            places = rows.axes[name][record]
            places = np.unique(places[np.isfinite(places)])
            changes |= {series: places} if len(places) else {}
    return machine.changed(changes) if changes else machine


def _clock(machine: Setup, rows: RowsFile) -> NDArray[np.float64] | None:
    """Return the times of rows that are readings of a motion, NaN where one is empty; nothing where they have none."""
    dynamics, fields = machine.model.dynamics, machine.model.own_result_fields
    if dynamics is None:
        return None
    axes = [
        name for name, each in fields.items() if isinstance(each.spec, Axis) and each.spec.follows == dynamics.times
    ]
    known = {**{name: rows.axes[name] for name in axes if name in rows.axes}, **rows.series}
    return next((known[name] for name in (dynamics.times, *axes) if name in known), None)


def _once(machine: Setup, rows: RowsFile, record: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the rows of a record by rising time, each time once: those at which a motion is driven."""
    clock = _clock(machine, rows)
    return record if clock is None else record[np.unique(clock[record], return_index=True)[1]]


def demand_times(machine: Setup, rows: RowsFile, where: Callable[[int], Fault] | None = None) -> None:
    """Raise InputError with every row that keeps a motion from being followed along its record.

    Times fall within a run; or one is missing, or comes again with another value, where a series drives the motion.
    ``where`` gives file and line of a row, by default those of ``rows``.
    """
    clock = _clock(machine, rows)
    if clock is None:
        return
    said: dict[int, str] = {}
    for record in _records(machine, rows):
        said |= dict(_untimely(clock, record, {name: each for name, each in rows.series.items() if each is not clock}))
    if said:
        faults = ((where or (lambda row: Fault("", rows.file, rows.lines[row])))(row) for row in sorted(said))
        raise InputError([replace(fault, message=said[row]) for row, fault in zip(sorted(said), faults, strict=True)])


def _untimely(
    clock: NDArray[np.float64], record: NDArray[np.intp], drives: Mapping[str, NDArray[np.float64]]
) -> Iterator[tuple[int, str]]:
    """Give the rows of a record that keep a motion from being followed, and why."""
    for name, values in {"time": clock, **drives}.items() if drives else ():
        for row in record[np.isnan(values[record])].tolist():
            yield row, f"{name} is empty, but {DRIVEN}: fill it in, or leave the row out"
    known = record[np.isfinite(clock[record])]
    before, after = known[:-1], known[1:]
    for row in after[clock[after] < clock[before]].tolist():
        last = clock[before[after == row]][0]
        fell = f"time falls from {last:.10g} s to {clock[row]:.10g} s within a record"
        yield row, f"{fell}: sort its rows, or tell records apart by a column 'run'"
    for name, values in drives.items():
        for row in after[(clock[after] == clock[before]) & (values[after] != values[before])].tolist():
            yield row, f"time is {clock[row]:.10g} s again with another {name}, but {DRIVEN}: leave one of them out"


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


def _row_by_row(machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str] | None) -> Rows:
    """Calculate every row in every trial, one trial behind another, in one call."""
    names, count = set(_readable(machine, rows, wanted)), len(trials)
    changed = (name for trial in trials for name in trial)
    columns: dict[str, Any] = {}
    for name in _seen_columns(machine, dict.fromkeys([*rows.columns, *changed])):
        values: Any = rows.columns.get(name)
        if isinstance(values, list):
            columns[name] = values * count
            continue
        if values is None and not all(name in trial for trial in trials):
            values = machine.nominal(name)
        columns[name] = np.concatenate([_in_each(trial.get(name, values), len(rows)) for trial in trials])
    machine = _at_places(machine, rows)
    answer = evaluate_rows(machine, columns, count * len(rows), reading=True, wanted=names, repeats=count)
    return answer if wanted is None else answer.complete()


def _in_each(value: Any, rows: int) -> Any:
    """Return a column as it is, and one value in each of so many rows."""
    return value if getattr(value, "shape", ()) == (rows,) else np.broadcast_to(value, rows)


@dataclass(frozen=True)
class _Alike:
    """Rows that one calculation answers for, the one value that each column has there, and the trial."""

    places: NDArray[np.intp]
    values: Mapping[str, Any]
    trial: int


def _read_each(machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str] | None) -> list[Rows]:
    """Return what ``read_by_gauge`` does, in several trials of the same rows where one calculation answers for many.

    A trial changes columns, to one value or to (n,). Calculations of several trials are one call of the model.
    """
    along = {name: machine.model.axes[name] for name in _readable(machine, rows, wanted)}
    asked = {*along, *filter(None, along.values())}
    parts: list[list[Rows]] = [[] for _ in trials]
    order: list[list[NDArray[np.intp]]] = [[] for _ in trials]
    noted: NotedError | None = None
    for record in _records(machine, rows):
        of_record = _at_places(machine, rows, record)
        driven = _once(machine, rows, record) if rows.series else record
        series = {name: column[driven] for name, column in rows.series.items()}
        for several, repeats in _calls(record, machine, rows, trials):
            columns = {name: _one_or_each([alike.values[name] for alike in several]) for name in several[0].values}
            changed, size = columns | series, len(several)
            try:
                computed = evaluate_rows(of_record, changed, size, reading=True, wanted=asked, repeats=repeats)
            except NotedError as error:
                noted = error
                continue
            for number, alike in enumerate(several):
                parts[alike.trial].append(_for_rows(computed, number, alike.places, along=along, rows=rows))
                order[alike.trial].append(alike.places)
    if noted is not None:
        raise noted
    done = [put_together(*each, list(along), len(rows)) for each in zip(parts, order, strict=True)]
    return done if wanted is None else [answer.complete() for answer in done]


def _for_rows(
    computed: Rows, number: int, places: NDArray[np.intp], *, along: Mapping[str, str], rows: RowsFile
) -> Rows:
    """Return one calculation of several as the rows that it answers for, read at their places on the axes."""
    results: dict[str, NDArray[np.float64]] = {}
    for name, axis in along.items():
        value = computed.results[name][number]
        at_places = _read_at(rows.axes[axis][places], computed.results[axis][number], value) if axis else value
        results[name] = _in_each(at_places, len(places))
    all_rows = range(len(places))
    reasons = dict.fromkeys(all_rows, computed.reasons[number]) if computed.failed[number] else {}
    lacking = {name: dict.fromkeys(all_rows, why[number]) for name, why in computed.absent.items() if number in why}
    return Rows(results, np.broadcast_to(computed.failed[number], places.shape), reasons, lacking)


def _calls(
    record: NDArray[np.intp], machine: Setup, rows: RowsFile, trials: Sequence[Trial]
) -> Iterator[tuple[list[_Alike], int]]:
    """Give the calculations of some trials of a record that are one call, and how many copies of one trial they are."""
    together = TOGETHER if machine.model.dynamics is None else MOVING_TOGETHER
    known = _at_record(machine, rows.columns, record)
    waiting: list[_Alike] = []
    count = 0
    for number, trial in enumerate(trials):
        columns = known | _at_record(machine, trial, record)
        own = [_Alike(*each, number) for each in _alike(record, machine, columns, rows)]
        if waiting and (len(waiting) + len(own) > together or own[0].values.keys() != waiting[0].values.keys()):
            yield waiting, count
            waiting, count = [], 0
        waiting, count = waiting + own, count + 1 if len(waiting) == count * len(own) else 0
    yield waiting, count


def _one_or_each(values: list[Any]) -> Any:
    """Return what is one value for all as that, floats that differ as an array, other things as a list."""
    if all(value == values[0] for value in values):
        return values[0]
    return np.array(values) if isinstance(values[0], float) else values


def _is_by_run(machine: Setup, rows: RowsFile) -> bool:
    """Whether one calculation is the record of one run: where series drive it, and where it moves."""
    return bool(rows.series) or machine.model.dynamics is not None


def _records(machine: Setup, rows: RowsFile) -> Sequence[NDArray[np.intp]]:
    """Return the rows of each run that is one calculation; else, and without a column "run", the file is one."""
    is_by_run = _is_by_run(machine, rows) and rows.runs
    return _places_alike((rows.runs,), len(rows)) if is_by_run else (np.arange(len(rows)),)


@lru_cache(maxsize=16)
def _places_alike(columns: tuple[tuple[Any, ...], ...], rows: int) -> list[NDArray[np.intp]]:
    """Return the places of rows that share their values; a fit asks for the same ones again and again."""
    if not columns:
        return rows_alike(columns, rows)
    places: dict[tuple[Any, ...], list[int]] = {}
    for row, values in enumerate(zip(*columns, strict=True)):  # all of them can be keys: those of the cache are
        places.setdefault(values, []).append(row)
    return [np.array(each) for each in places.values()]


def _at_record(machine: Setup, columns: Mapping[str, Any], record: NDArray[np.intp]) -> dict[str, Any]:
    """Return what the columns that are looked at say in the rows of a record: one value, or where it varies all."""
    return {name: _one_or_all(column, record) for name, column in _seen_columns(machine, columns).items()}


def _one_or_all(column: Any, places: NDArray[np.intp]) -> Any:
    """Return the one value that a column has at these places, else a tuple of all; NaN is a value of its own."""
    if isinstance(column, list):
        values: Any = [column[place] for place in places]
        is_one = all(value == values[0] for value in values)
    elif not getattr(column, "ndim", 0):
        return _plain(column)
    elif column.strides == (0,) and column[0] == column[0]:
        return float(column[0])
    else:
        own = column[places]
        is_one, values = bool((own == own[0]).all()), own.tolist()
    return _plain(values[0]) if is_one else tuple(_plain(value) for value in values)


def _plain(value: Any) -> Any:
    return value if isinstance(value, (str, bool, int)) else float(value)


def _alike(
    record: NDArray[np.intp], machine: Setup, columns: Mapping[str, Any], rows: RowsFile
) -> Iterator[tuple[NDArray[np.intp], dict[str, Any]]]:
    """Give the rows of a record that share their values, and these. Raises UsageError for an input that changes."""
    varying = {name: values for name, values in columns.items() if isinstance(values, tuple)}
    for name, values in varying.items() if _is_by_run(machine, rows) else ():
        if name in machine.model.input_fields:
            line = next(rows.lines[row] for row, value in zip(record, values, strict=True) if value != values[0])
            raise UsageError(f"{rows.file}:{line}: {name} changes within a run, but a record is one calculation")
    for places in _places_alike(tuple(varying.values()), len(record)):
        own = {name: values[places[0]] for name, values in varying.items()}
        yield record[places], {**columns, **own}


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


def read_trials(
    machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str]
) -> Iterator[Mapping[str, NDArray[np.float64]]]:
    """Give what the gauge shows of every row in each trial, SI (n,) by result, NaN where the model fails.

    A trial sets inputs and conditions to one value or to (n,), unknowns of effects that are on (``effect_column``) to
    (n,), in SI and in place of what machine and rows say.
    """
    if len(trials) > 1 and machine.model.dynamics is not None and not is_noting():
        with following_together(), suppress(NotedError):
            deque(_answers(machine, rows, trials, wanted), maxlen=0)
    yield from _answers(machine, rows, trials, wanted)


def _answers(
    machine: Setup, rows: RowsFile, trials: Sequence[Trial], wanted: Collection[str]
) -> Iterator[Mapping[str, NDArray[np.float64]]]:
    """Give what the gauge shows, in as few calls as there can be."""
    count = min(len(trials), AT_ONCE // max(len(rows), 1))
    if count < 2 or any(name in rows.series for trial in trials for name in trial):
        yield from (_read_alone(machine, rows, trial, wanted) for trial in trials)
        return
    is_many = _answers_many(machine, rows, wanted)
    for begin in range(0, len(trials), count):
        block = trials[begin : begin + count]
        if is_many:
            yield from (each.results for each in _read_each(machine, rows, block, wanted))
            continue
        values = _row_by_row(machine, rows, block, wanted).results
        parts = {name: np.split(value, len(block)) for name, value in values.items()}
        yield from ({name: part[index] for name, part in parts.items()} for index in range(len(block)))


def _read_alone(
    machine: Setup, rows: RowsFile, trial: Trial, wanted: Collection[str]
) -> Mapping[str, NDArray[np.float64]]:
    """Read rows in one trial, not too many of them in one call.

    What has one value for all rows is the machine's, the rest columns of its own.
    """
    columns = {name: np.array(value) for name, value in trial.items() if np.ndim(value) > 0}
    series = {name: columns.pop(name, values) for name, values in rows.series.items()}
    machine = machine.changed({name: value for name, value in trial.items() if np.ndim(value) == 0})
    rows = replace(rows, columns={**rows.columns, **columns}, series=series)
    size = len(rows) if rows.series else AT_ONCE
    blocks = [rows.taken(slice(begin, begin + size)) for begin in range(0, len(rows), size)]
    parts = [read_by_gauge(machine, block, wanted).results for block in blocks]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
