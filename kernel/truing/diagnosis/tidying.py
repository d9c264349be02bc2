"""Rows of one file put in order: no block twice, sorted by time inside each run, angles in one piece, histories made.

Nothing is done in silence: every function notes what it did.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Indices, Matrix, first_alike
from truing.declare.model import Model
from truing.diagnosis.data_file import ColumnRole, DataRows, declared_units
from truing.inputs_file.values import broken_bound
from truing.measurements.derived import TIME, histories
from truing.measurements.table import is_number
from truing.numbers import counted
from truing.units import same_dimension
from truing.units.names import PURE

FEW_DEGREES, SWEEPING, MOST_JUMPS = 90.0, 0.95, 0.25
"""An angle sweeps where such a share of its steps is smaller than so many degrees, turns taken out, and where no
larger share of them jumps by a turn."""
FEWEST_IN_BLOCK = 3
"""Fewer rows that repeat earlier ones may be chance where the gauge is coarse."""
BLOCK_AGAIN = "in a block that repeats an earlier one in every cell, times included"


def tidy(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Return the rows of a file in order."""
    return with_histories(in_one_piece(in_time_order(each_block_once(data)), model), model)


def numbered(labels: NDArray[Any]) -> Indices:
    """Return the number of each label (n,), from 0 in the order they first appear."""
    known: dict[Any, int] = {}
    return np.array([known.setdefault(label, len(known)) for label in labels.tolist()], dtype=np.intp)


def each_block_once(data: DataRows) -> DataRows:
    """Leave out blocks of rows that were written twice: where the clock goes back and the rows that follow are there.

    A block has three rows or more over two times at the least, each equal in every cell, its time included, to the row
    that follows in the earlier block. Single rows that are alike are real repeats of a coarse gauge, and are kept.
    """
    time = _time(data)
    if time is None or not (np.diff(time) < 0).any():
        return data
    cells = (data.runs, *data.columns.values())
    like = first_alike([numbered(cell) if cell.dtype == object else cell for cell in cells])
    is_again = np.zeros(len(data), dtype=bool)
    for start in np.flatnonzero((np.diff(time) < 0) & (like[1:] <= np.arange(len(time) - 1))) + 1:
        first = like[start]
        rows = min(len(data) - start, start - first)
        differ = np.flatnonzero(like[start : start + rows] != like[first : first + rows])
        end = start + (int(differ[0]) if len(differ) else rows)
        if end - start >= FEWEST_IN_BLOCK and np.ptp(time[start:end]) > 0:
            is_again[start:end] = True
    if not is_again.any():
        return data
    again = counted(int(is_again.sum()), "row is", "rows are")
    return data.without(is_again, BLOCK_AGAIN).noted(f"{again} left out: {BLOCK_AGAIN}")


def in_time_order(data: DataRows) -> DataRows:
    """Put runs one after another, by their first time, and sort rows by time inside each; without a time as given."""
    run_of, time = numbered(data.runs), _time(data)
    by_run = np.argsort(run_of, kind="stable")
    if time is None:
        return data.taken(by_run)
    starts = np.full(run_of.max() + 1, np.inf)
    np.fmin.at(starts, run_of, time)
    late = 0  # rows that stand behind a later one of their run
    for part in np.split(time[by_run], np.cumsum(np.bincount(run_of))[:-1]):
        known = part[np.isfinite(part)]
        late += int((known < np.maximum.accumulate(known)).sum())
    sentence = f"{counted(late, 'row was', 'rows were')} out of order and sorted by time inside the run"
    return data.taken(np.lexsort((time, run_of, starts[run_of]))).noted(*[sentence] if late else ())


def _time(data: DataRows) -> Matrix | None:
    """Return the times of the rows where they are known; a result of that name is no clock."""
    if data.parts.get(TIME) in {None, "label", "word", "measured"}:
        return None
    time = data.columns[TIME]
    return time if np.isfinite(time).any() else None


def in_one_piece(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Join angles of inputs and conditions that jump by a turn inside a sweep.

    A run is a sweep if 95 % of its steps are below 90 degrees once it is joined and at most every fourth step jumps.
    An input whose bounds would not hold stays as it is.
    """
    columns, units, notes = dict(data.columns), declared_units(model), []
    runs = np.split(np.arange(len(data)), np.flatnonzero(np.diff(numbered(data.runs))) + 1)
    for name in data.named("input", "series", "condition"):
        if not is_angle(units[name]):
            continue
        joined, jumps = np.array(columns[name]), 0
        for rows in runs:
            joined[rows], more = _joined(joined[rows])
            jumps += more
        if jumps and keeps_bounds(name, joined, model):
            columns[name] = joined
            notes.append(f"'{name}' jumps by a turn at {counted(jumps, 'place')} of a sweep and was joined there")
    return replace(data, columns=columns).noted(*notes)


def _joined(angles: Matrix) -> tuple[Matrix, int]:
    """Return a sweep without its jumps by a turn and their number; anything else as it is."""
    known = np.flatnonzero(np.isfinite(angles))
    steps = np.diff(angles[known])
    jumps = int((np.abs(steps) > np.pi).sum())
    if not 0 < jumps <= MOST_JUMPS * len(steps):
        return angles, 0
    whole = np.array(angles)
    whole[known] = np.unwrap(angles[known])
    small = np.abs(np.diff(whole[known])) < np.radians(FEW_DEGREES)
    return (whole, jumps) if small.mean() >= SWEEPING else (angles, 0)


def keeps_bounds(name: str, values: Matrix, model: Model[Any, Any]) -> bool:
    """Whether values (n,), SI, lie within the bounds of an input; anything else has none."""
    field = model.input_fields.get(name)
    return field is None or not any(broken_bound(field, float(end)) for end in (np.nanmin(values), np.nanmax(values)))


def is_angle(unit: str) -> bool:
    """Whether a unit is one of plane angles."""
    return unit not in PURE and same_dimension(unit, "rad")


def with_histories(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Make the conditions that are derived from whole runs: what has been, since the first row of the file."""
    numbers = {name: values for name, values in data.columns.items() if is_number(values)}
    made = histories(model.known_conditions.values(), numbers, numbered(data.runs), _time(data))
    parts: dict[str, ColumnRole] = dict.fromkeys(made, "condition")
    return replace(data, columns={**data.columns, **made}, parts={**data.parts, **parts})
