"""Spreads of another width: what a band becomes when it is tightened or widened, as a drawing would state it.

A width is the full band in SI: six standard deviations, or the whole of a uniform spread; that of
``Distribution.width``. Where the spread sits is kept: a zone that grows up keeps its lower end, a band its middle.
"""

from __future__ import annotations

import math
from dataclasses import replace

from truing.declare.spreads import SIGMAS_IN_BAND, Band, Grade, Spread, Target, Zone, difference, settled
from truing.errors import UsageError
from truing.units import difference_unit, from_si, split_quantity

GROWTH = {"up": 0.5, "down": -0.5, "both": 0.0}


def width_of(spread: Spread, target: Target) -> float:
    """Return the full band of a spread in SI. Raises UsageError where it has none of its own: off, or drawn."""
    spread = settled(spread, target.value_of)
    distribution = spread.resolve(target)
    if distribution is None or not isinstance(spread, (Band, Grade, Zone)):
        raise UsageError(_refusal(spread, target))
    return distribution.width


def with_width(spread: Spread, target: Target, width: float) -> Spread:
    """Return the spread with another full band (SI): the same words, units and shape; a grade becomes a band.

    A zone that grows up keeps its lower end, one that grows down its upper end, any other its middle. The new spread
    stands in its text in full: read again it is the same. Raises UsageError for a width that is not above zero, and
    for a spread that is off or drawn by a function.
    """
    if not (width > 0 and math.isfinite(width)):
        raise UsageError(f"the width of the tolerance of '{target.name}' must lie above zero; it is {width:g}")
    spread = settled(spread, target.value_of)
    spread.resolve(target)  # refuses what the present words cannot say of this input, such as a share of 0
    if isinstance(spread, Band):
        return replace(spread, amount=_amount(spread, target, width))
    if isinstance(spread, Zone):
        return _zone(spread, target, width)
    if isinstance(spread, Grade):
        return Band(_quantity(width, _unit(target)), "band")
    raise UsageError(_refusal(spread, target))


def shift_per_width(spread: Spread) -> float:
    """Return by how much the middle moves with the width: half of what is added where one end of a zone stays."""
    return GROWTH[spread.grows] if isinstance(spread, Zone) else 0.0


def _refusal(spread: Spread, target: Target) -> str:
    return f"the spread of '{target.name}' is {spread.text}: it has no width that could be chosen"


def _unit(target: Target) -> str:
    return difference_unit(target.unit)


def _amount(band: Band, target: Target, width: float) -> str:
    """Return what a band of this width states, in the unit that it states now."""
    whole = 12**0.5 if band.shape == "uniform" else SIGMAS_IN_BAND
    size = width / {"sd": whole, "band": 1.0, "±": 2.0}[band.says]
    unit = split_quantity(band.amount).unit
    if unit == "%" and target.unit != "%":
        return f"{float(size / abs(target.nominal) * 100)!r} %"
    if band.at_radius:
        size *= float(target.value_of(band.at_radius))
    return _quantity(size, unit)


def _zone(zone: Zone, target: Target, width: float) -> Zone:
    """Move the end or the ends that give way."""
    low, high = difference(zone.low, target.unit), difference(zone.high, target.unit)
    below, above = (split_quantity(end).unit for end in (zone.low, zone.high))
    if zone.grows == "up":
        return replace(zone, high=_quantity(low + width, above))
    if zone.grows == "down":
        return replace(zone, low=_quantity(high - width, below))
    middle = (low + high) / 2
    return replace(zone, low=_quantity(middle - width / 2, below), high=_quantity(middle + width / 2, above))


def _quantity(value: float, unit: str) -> str:
    """Write a difference in SI as a text in a unit; the number has all its digits."""
    return f"{float(from_si(value, difference_unit(unit)))!r} {unit}".strip()
