"""Objectives and margins over the shift: where every limit is kept, which one ends it, and where sliding is equal."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roller_screw_shift.constraints import margins_of
from roller_screw_shift.geometry import geometry_of, sliding_at_roots
from roller_screw_shift.objectives import objectives_of
from roller_screw_shift.quantities import Pair
from roller_screw_shift.weighing import Ranges

Values = NDArray[np.float64]
MEGA = 1e6
HALVINGS = 60
PARTS, DIVISIONS = 64, 10  # 64 parts at once, ten times: as many halvings, in a sixth of the calls
NO_OBJECTIVES = "objectives"


@dataclass(frozen=True, eq=False)
class Course:
    """Shifts of the roller (n,), objectives (3, n) in the units of the paper (1, MPa, 1), margins by name (n,)."""

    shifts: Values
    objectives: Values
    margins: Mapping[str, Values]

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Where every limit is kept and every objective exists, (n,)."""
        within = np.all([margin >= 0.0 for margin in self.margins.values()], axis=0)
        return np.asarray(within & np.isfinite(self.objectives).all(axis=0))

    @property
    def ranges(self) -> Ranges:
        """The smallest and the largest value of each objective; call it where every limit is kept."""
        first, second, third = ((float(values.min()), float(values.max())) for values in self.objectives)
        return first, second, third

    def missed(self, place: int) -> tuple[str, ...]:
        """The limits that this shift misses, or that it has no objectives."""
        names = tuple(name for name, margin in self.margins.items() if not margin[place] >= 0.0)
        return names or (() if np.isfinite(self.objectives[:, place]).all() else (NO_OBJECTIVES,))


@dataclass(frozen=True)
class Interval:
    """Shifts that keep every limit, and the limits that end them; none where the search ends them."""

    low: float
    high: float
    low_limits: tuple[str, ...]
    high_limits: tuple[str, ...]


def course_of(pair: Pair, shifts: Values) -> Course:
    """Return objectives and margins of these shifts (n,) in one call; NaN where one does not exist."""
    shifts = np.asarray(shifts, dtype=float)
    shifted = replace(pair, roller_shift=shifts)
    found = objectives_of(shifted)
    stress = np.asarray(found.stress_difference) / MEGA
    objectives = np.array([_each(values, shifts) for values in (found.shift_sum, stress, found.sliding_difference)])
    return Course(shifts, objectives, {name: _each(each, shifts) for name, each in vars(margins_of(shifted)).items()})


def _each(values: Any, shifts: Values) -> Values:
    return np.broadcast_to(np.asarray(values, dtype=float), shifts.shape)


def intervals_of(pair: Pair, span: tuple[float, float], points: int) -> tuple[Interval, ...]:
    """Return where every limit is kept, found on an even grid; ends are divided down to the last digits.

    What is narrower than a step of the grid and lies between two of its points is not seen.
    """
    course = course_of(pair, np.linspace(*span, points))
    kept = np.concatenate([[False], course.kept, [False]])
    turns = np.flatnonzero(kept[1:] != kept[:-1])
    found = []
    for first, beyond in zip(turns[::2], turns[1::2], strict=True):
        low, low_limits = _end(pair, course.shifts, int(first), -1)
        high, high_limits = _end(pair, course.shifts, int(beyond) - 1, 1)
        found.append(Interval(low, high, low_limits, high_limits))
    return tuple(found)


def _end(pair: Pair, shifts: Values, inside: int, way: int) -> tuple[float, tuple[str, ...]]:
    """Return the last shift on this side that keeps every limit, and what the next one misses."""
    if not 0 <= inside + way < len(shifts):
        return float(shifts[inside]), ()
    within, beyond = float(shifts[inside]), float(shifts[inside + way])
    for _ in range(DIVISIONS):
        between = np.linspace(within, beyond, PARTS + 1)
        kept = course_of(pair, between[1:-1]).kept
        missed = PARTS if kept.all() else int(np.argmin(kept)) + 1
        within, beyond = float(between[missed - 1]), float(between[missed])
    return within, course_of(pair, np.array([beyond])).missed(0)


def dense(pair: Pair, intervals: Sequence[Interval], points: int) -> Course:
    """Return the course over shifts that keep every limit, with so many points in each interval, ends among them."""
    shifts = np.concatenate([np.linspace(part.low, part.high, points) for part in intervals])
    course = course_of(pair, np.unique(shifts))
    kept = course.kept
    return Course(
        course.shifts[kept], course.objectives[:, kept], {name: margin[kept] for name, margin in course.margins.items()}
    )


def equal_sliding(pair: Pair, span: tuple[float, float], points: int) -> float:
    """Return the shift at which both roots slide alike, whatever the limits; NaN where there is none."""

    def excess(shifts: Values) -> Values:
        with np.errstate(all="ignore"):
            roller, ring = sliding_at_roots(geometry_of(replace(pair, roller_shift=shifts)))
        return np.asarray(np.asarray(roller) - np.asarray(ring))

    shifts = np.linspace(*span, points)
    values = excess(shifts)
    turns = np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0))
    if not len(turns):
        return float("nan")
    low, high = shifts[turns[0]], shifts[turns[0] + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(np.array([middle]))[0] > 0.0 else (low, middle)
    return float(high)
