"""How the three objectives of the paper become one, and how they and the limits run over the shift."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from roller_screw_shift import geometry as geo
from roller_screw_shift.calculation import MARGINS, meshing_of
from roller_screw_shift.quantities import Pair
from truing import Array, Float, TruingError

# Three objectives made one: each brought to 0 to 1 over its range, weighed, and added
#
# The objectives are, in this order, the sum of the shifts (to be large), the difference of the root stresses in MPa and
# that of the specific sliding (both to be small). Sources: the paper, its equation 5; Sun Jingmin, Mechanical Optimum
# Design, for the curve, of which the paper prints y = x/2 pi - sin x, where a factor 1/(2 pi) is missing.

Range = tuple[float, float]
Three = tuple[float, float, float]
Ranges = tuple[Range, Range, Range]

PRINTED_RANGES: Ranges = ((2.68, 5.38), (0.0, 33.2), (0.0, 3.08))
PRINTED_WEIGHTS: Three = (0.35, 0.01, 0.81)
SENSES: Three = (-1.0, 1.0, 1.0)  # the first is to be large


def normalised(value: Float, reach: Range) -> Float:
    """Return f_r: 0 at the lower end of ``reach``, 1 at the upper, level at both, and clipped beyond.

    f_r = (X - sin X)/(2 pi) with X = 2 pi (value - low)/(high - low). Raises TruingError where the range has no width.
    """
    turn = 2.0 * np.pi * np.clip((value - reach[0]) / _width(reach), 0.0, 1.0)
    return (turn - np.sin(turn)) / (2.0 * np.pi)


def weight(reach: Range) -> float:
    """Return the paper's weight of an objective: one over the square of half its range.

    It has a unit, one over that of the objective squared: stresses in other units would weigh otherwise.
    """
    return (0.5 * _width(reach)) ** -2


def _width(reach: Range) -> float:
    low, high = reach
    if not (low < high and np.isfinite(high - low)):
        raise TruingError(f"an objective from {low:g} to {high:g} cannot be weighed: its range has no width")
    return high - low


def rule_weights(ranges: Ranges) -> Three:
    """Return the weights of the three objectives by the paper's rule."""
    first, second, third = (weight(reach) for reach in ranges)
    return first, second, third


def lower_limit(given: float, high: float) -> float:
    """Return from which lower limit a weight would follow by the rule, with this upper one."""
    return high - 2.0 / sqrt(given)


def total(objectives: NDArray[np.float64], ranges: Ranges, weights: Three) -> NDArray[np.float64]:
    """Return what is minimised: -w1 fr1 + w2 fr2 + w3 fr3 of objectives (3, n) in the units of the paper.

    An objective of weight 0 is left out, and may be without a range.
    """
    added = np.zeros(objectives.shape[1:])
    for value, reach, share, sense in zip(objectives, ranges, weights, SENSES, strict=True):
        if share:
            added = added + sense * share * normalised(value, reach)
    return added


def weights_of(reading: str, ranges: Ranges) -> Three:
    """Return the weights in one of the readings of the input ``weights``; 0 where an objective has no range.

    Such an objective is the same for every shift: it has nothing to say.
    """
    if reading == "own_ranges":
        found = [weight(reach) if reach[1] > reach[0] else 0.0 for reach in ranges]
    else:
        stated = PRINTED_WEIGHTS if reading == "printed" else rule_weights(PRINTED_RANGES)
        found = [share if high > low else 0.0 for share, (low, high) in zip(stated, ranges, strict=True)]
    return found[0], found[1], found[2]


# Objectives and margins over the shift: where every limit is kept, which one ends it, and where sliding is equal

MEGA = 1e6
HALVINGS = 60
PARTS, DIVISIONS = 4096, 5  # 4096 parts at once, five times: as many halvings, in a twelfth of the calls
NO_OBJECTIVES = "objectives"


@dataclass(frozen=True, eq=False)
class ShiftCourse:
    """Shifts of the roller (n,), objectives (3, n) in the units of the paper (1, MPa, 1), margins by name (n,)."""

    shifts: Array
    objectives: Array
    margins: Mapping[str, Array]

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


def course_of(pair: Pair, shifts: Array) -> ShiftCourse:
    """Return objectives and margins of these shifts (n,) in one call; NaN where one does not exist."""
    shifts = np.asarray(shifts, dtype=float)
    found = meshing_of(replace(pair, roller_shift=shifts))
    names = ("shift_sum", "stress_difference", "sliding_difference", *MARGINS)
    total, stress, sliding, *margins = (np.broadcast_to(getattr(found, name), shifts.shape) for name in names)
    return ShiftCourse(shifts, np.array([total, stress / MEGA, sliding]), dict(zip(MARGINS, margins, strict=True)))


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


def _end(pair: Pair, shifts: Array, inside: int, way: int) -> tuple[float, tuple[str, ...]]:
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


def dense(pair: Pair, intervals: Sequence[Interval], points: int) -> ShiftCourse:
    """Return the course over shifts that keep every limit, with so many points in each interval, ends among them."""
    shifts = np.concatenate([np.linspace(part.low, part.high, points) for part in intervals])
    course = course_of(pair, np.unique(shifts))
    kept = course.kept
    return ShiftCourse(
        course.shifts[kept], course.objectives[:, kept], {name: margin[kept] for name, margin in course.margins.items()}
    )


def equal_sliding(pair: Pair, span: tuple[float, float], points: int) -> float:
    """Return the shift at which both roots slide alike, whatever the limits; NaN where there is none."""

    def excess(shifts: Array) -> Array:
        with np.errstate(all="ignore"):
            roller, ring = geo.sliding_at_roots(geo.geometry_of(replace(pair, roller_shift=shifts)))
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
