"""Conditions that are history: what an effect sees, made once from the raw rows of a file, in time order.

- "since_start": what the condition's own column has gained since the earliest row of the whole file.
- "running_maximum of X": the largest X of the run so far.
- "cumulative of X": the path that X has travelled in the run so far, the sum of its absolute changes; 0 at its start.
- "direction of X": +1 or -1, the sign of the last change of X in the run; rows before the first change take that one's,
  and 0 stands where X never changes.
- "last_reversal of X": X where it last turned in the run, known from the row after the turn on; before, X at its start.

X is taken as measured: nothing is smoothed, so noise on X makes path, turns and directions. Where X is missing, what
has been so far stands; before the first X of a run it is missing too (the direction is that of the first change).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.sources import SINCE_START, Condition
from truing.errors import UsageError

TIME = "time"
"""The column by which rows are sorted, whatever part it plays."""


def histories(
    conditions: Iterable[Condition],
    columns: Mapping[str, NDArray[Any]],
    runs: NDArray[Any] | None,
    time: NDArray[Any] | None,
) -> dict[str, NDArray[np.float64]]:
    """Return the conditions that can be made from columns of numbers; one that has a column of its own is not made.

    Shapes and order are those of ``derive``.
    """
    return {
        condition.name: derive(condition, columns, runs, time)
        for condition in conditions
        if condition.derived
        and condition.made_from in columns
        and (condition.made_from == condition.name or condition.name not in columns)
    }


def derive(
    condition: Condition, columns: Mapping[str, NDArray[Any]], runs: NDArray[Any] | None, time: NDArray[Any] | None
) -> NDArray[np.float64]:
    """Return what the effects of a derived condition see, shape (n,), from raw columns in SI.

    Rows follow one another by ``time`` inside each run, those without a time last, and as they stand where no time is
    given; without ``runs`` all rows are one. Raises UsageError where the column it is made from is not there.
    """
    if condition.made_from not in columns:
        what = f"'{condition.made_from}', which is no column"
        raise UsageError(f"condition '{condition.name}' is derived from {what}")
    values = np.asarray(columns[condition.made_from], dtype=float)
    if condition.history == SINCE_START:
        return values - _earliest(values, time)
    derived = np.full(len(values), np.nan)
    for rows in _records(len(values), runs, time):
        derived[rows] = _history(condition.history, values[rows])
    return derived


def _earliest(values: NDArray[np.float64], time: NDArray[Any] | None) -> float:
    """Return the value at the earliest row that has one; NaN where none has."""
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return float("nan")
    order = np.argsort(np.asarray(time, dtype=float)[known], kind="stable") if time is not None else [0]
    return float(values[known[order[0]]])


def _records(rows: int, runs: NDArray[Any] | None, time: NDArray[Any] | None) -> Iterator[NDArray[np.intp]]:
    """Give the rows of each run in the order in which they were measured."""
    run_of = np.zeros(rows, dtype=np.intp) if runs is None else np.unique(np.asarray(runs), return_inverse=True)[1]
    clock = np.zeros(rows) if time is None else np.asarray(time, dtype=float)
    order = np.lexsort((clock, run_of))
    yield from np.split(order, np.flatnonzero(np.diff(run_of[order])) + 1)


def _history(word: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the history of the values of one run, which follow one another; what is missing is passed over."""
    known = np.isfinite(values)
    filled = np.full(len(values), np.nan)
    if known.any():
        history = _HISTORIES[word](values[known])
        latest = np.cumsum(known) - 1
        filled[latest >= 0] = history[latest[latest >= 0]]
        if word == "direction":
            filled[latest < 0] = history[0]
    return filled


def _running_maximum(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.maximum.accumulate(values)


def _cumulative(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(values)))])


def _ways(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sign of every step; of one that does not move that of the step before, or of the first that moves."""
    ways = np.sign(np.diff(values))
    moves = np.flatnonzero(ways)
    if not len(moves):
        return ways
    latest = np.searchsorted(moves, np.arange(len(ways)), side="right") - 1
    return np.asarray(ways[moves[np.maximum(latest, 0)]])


def _direction(values: NDArray[np.float64]) -> NDArray[np.float64]:
    ways = _ways(values)
    return np.concatenate([ways[:1], ways]) if len(ways) else np.zeros(len(values))


def _last_reversal(values: NDArray[np.float64]) -> NDArray[np.float64]:
    ways = _ways(values)
    turns = np.flatnonzero(np.diff(ways)) + 1
    turned_at = np.zeros(len(values), dtype=np.intp)
    turned_at[turns + 1] = turns
    return values[np.maximum.accumulate(turned_at)]


_HISTORIES: Mapping[str, Callable[[NDArray[np.float64]], NDArray[np.float64]]] = {
    "running_maximum": _running_maximum,
    "cumulative": _cumulative,
    "direction": _direction,
    "last_reversal": _last_reversal,
}
