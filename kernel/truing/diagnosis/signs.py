"""What a wrong explanation looks like once it is fitted: unknowns at their bounds, inputs far off their tolerances."""

from __future__ import annotations

from math import inf

from truing.diagnosis.alarms import AT_BOUND, OUTSIDE
from truing.diagnosis.causes import Number
from truing.diagnosis.fitted import Fit
from truing.diagnosis.intervals import input_value


def signs_of_wrong(found: Fit) -> int:
    """Count what a wrong explanation looks like: unknowns at their bounds, inputs far outside of their tolerances."""
    at_bound = sum(
        is_at_bound(number, float(value))
        for cause, values in zip(found.causes, found.values, strict=True)
        if cause.effect is not None
        for number, value in zip(cause.numbers, values, strict=True)
    )
    return at_bound + len(far_inputs(found))


def is_at_bound(number: Number, value: float) -> bool:
    """Whether a fitted number lies at an end of its declared range, other than at zero."""
    if not number.is_free:
        return False
    reach = AT_BOUND * (number.high - number.low)
    return any(end and abs(end) < inf and abs(value - end) <= reach for end in (number.low, number.high))


def far_inputs(found: Fit) -> list[int]:
    """Return the places of inputs that no cause shifts and that were moved far beyond their tolerances."""
    shifted = {cause.tolerated for cause in found.causes}
    free = [(place, item) for place, item in enumerate(found.sample.machine.inputs) if place not in shifted]
    return [place for place, item in free if abs((input_value(found, place) - item.design) / item.sd) > OUTSIDE]
