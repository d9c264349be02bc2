"""The shift that the weighed sum of the objectives prefers: by Box's complex method, and on a dense grid as a check."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from roller_screw_shift.box import Found, Plan, complex_method
from roller_screw_shift.courses import Course, Interval, Values, course_of, dense, intervals_of
from roller_screw_shift.quantities import Pair
from roller_screw_shift.weighing import Ranges, Three, total, weights_of

OTHER: dict[str, Literal["path", "roots"]] = {"path": "roots", "roots": "path"}
READINGS = ("own_ranges", "printed_ranges", "printed")
NEAR = 1e-5  # of a shift: nearer to its end the optimum stands at the limit; the weighed sum is level there


@dataclass(frozen=True, eq=False)
class Field:
    """Where every limit is kept: intervals, a dense course over them, and the range of each objective there."""

    pair: Pair
    intervals: tuple[Interval, ...]
    course: Course
    ranges: Ranges

    def around(self, shift: float) -> Interval:
        """The interval that holds this shift, or the nearest one."""
        return min(self.intervals, key=lambda part: max(part.low - shift, shift - part.high, 0.0))


def field_of(pair: Pair, span: tuple[float, float], points: int) -> Field | None:
    """Return where between the ends of ``span`` every limit is kept; None where no shift of the grid does."""
    intervals = intervals_of(pair, span, points)
    if not intervals:
        return None
    course = dense(pair, intervals, points)
    return Field(pair, intervals, course, course.ranges)


def box_optimum(field: Field, weights: Three, span: tuple[float, float], rng: np.random.Generator, plan: Plan) -> Found:
    """Return what Box's method finds; it knows the limits by rejection only."""

    def cost(points: Values) -> Values:
        course = course_of(field.pair, points[:, 0])
        with np.errstate(invalid="ignore"):
            return np.where(course.kept, total(course.objectives, field.ranges, weights), np.inf)

    return complex_method(cost, (np.array([span[0]]), np.array([span[1]])), rng, plan)


def grid_optimum(field: Field, weights: Three) -> float:
    """Return the best shift of the dense course, then of as many points between its neighbours."""
    course = field.course
    place = int(np.argmin(total(course.objectives, field.ranges, weights)))
    part = field.around(float(course.shifts[place]))
    ends = course.shifts[max(place - 1, 0)], course.shifts[min(place + 1, len(course.shifts) - 1)]
    low, high = max(float(ends[0]), part.low), min(float(ends[1]), part.high)
    finer = course_of(field.pair, np.linspace(low, high, len(course.shifts)))
    costs = np.where(finer.kept, total(finer.objectives, field.ranges, weights), np.inf)
    return float(finer.shifts[int(np.argmin(costs))])


def limits_at(field: Field, shift: float) -> tuple[str, ...]:
    """Return the limits at which this shift stands; none where it lies within its interval."""
    part = field.around(shift)
    if shift >= part.high - NEAR:
        return part.high_limits
    return part.low_limits if shift <= part.low + NEAR else ()


@dataclass(frozen=True)
class Variant:
    """The optimum under another least contact ratio or with other weights."""

    least_contact_ratio: float
    reading: str
    weights: Three
    shift: float
    contact_ratio: float
    limits: tuple[str, ...]


def variants(pair: Pair, ratios: Sequence[float], span: tuple[float, float], points: int) -> Iterator[Variant | None]:
    """Give the optimum on the grid for every least contact ratio and every reading of the weights; None without one."""
    for ratio in ratios:
        field = field_of(replace(pair, least_contact_ratio=ratio), span, points)
        for reading in READINGS:
            if field is None:
                yield None
                continue
            weights = weights_of(reading, field.ranges)
            shift = grid_optimum(field, weights)
            margin = course_of(field.pair, np.array([shift])).margins["margin_contact_ratio"][0]
            yield Variant(ratio, reading, weights, shift, ratio + float(margin), limits_at(field, shift))


def other_optimum(pair: Pair, span: tuple[float, float], points: int) -> float:
    """Return the optimum on the grid by the other reading of the sliding; NaN where no shift keeps every limit then."""
    field = field_of(replace(pair, sliding_reading=OTHER[pair.sliding_reading]), span, points)
    return float("nan") if field is None else grid_optimum(field, weights_of(pair.weights, field.ranges))


def stress_factor(field: Field, weights: Three, shift: float) -> float | None:
    """Return how many times as heavy the stresses must be before the optimum leaves the end at which it stands.

    None where it stands at no end, or a weight is missing, or a million times is not enough.
    """
    if not limits_at(field, shift) or not weights[1]:
        return None
    low, high = 0.0, 6.0  # decimal logarithms

    def leaves(exponent: float) -> bool:
        heavier = (weights[0], weights[1] * 10.0**exponent, weights[2])
        place = int(np.argmin(total(field.course.objectives, field.ranges, heavier)))
        return bool(abs(field.course.shifts[place] - shift) > NEAR + np.diff(field.course.shifts).max())

    if leaves(low) or not leaves(high):
        return None
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if leaves(middle) else (middle, high)
    return float(10.0**high)
