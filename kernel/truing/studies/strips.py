"""Tolerances that are widths, not grades: what any width of each does to scatter and mean, and what it costs.

To first order a width acts through two numbers per demand: the variance grows with its square, and where one end of the
zone stays the mean moves with the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from truing.declare.goals import Price
from truing.declare.sources import Tolerance
from truing.declare.spreads import Band, Zone
from truing.declare.widths import shift_per_width, with_width
from truing.prices import price_of
from truing.setup import Setup
from truing.studies.chances import Straight

COMPLEX_STEP = 1e-30
Values: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Strip:
    """A priced tolerance with a full width in SI that may be chosen from ``low`` to ``high``; ``start`` is in force.

    By demand: ``variances`` at the start, and ``pulls``, by how much the mean moves with the width.
    """

    name: str
    start: float
    low: float
    high: float
    price: Price
    variances: Mapping[str, float]
    pulls: Mapping[str, float]

    @property
    def unit(self) -> str:
        """The unit in which its width is printed."""
        return self.price.width

    def cost(self, width: float) -> float:
        """Return what a full width costs."""
        return self.price.at(width)

    def variance(self, demand: str, width: float) -> float:
        """Return the first-order variance that a width gives to a demand's response."""
        return self.variances[demand] * (width / self.start) ** 2

    def shift(self, demand: str, width: float) -> float:
        """Return by how much the mean of a demand's response lies from that of the start."""
        return self.pulls[demand] * (width - self.start)


def prices_at(strips: Sequence[Strip], widths: Values) -> tuple[Values, Values]:
    """Return what these full widths (n,) in SI cost, and the exact derivatives: the formulas with an imaginary step.

    Every formula is computed once, for all widths that it prices.
    Source: W. Squire, G. Trapp, Using complex variables to estimate derivatives, SIAM Rev. 40 (1998) 110.
    """
    paid = np.empty(len(strips), dtype=complex)
    prices = [strip.price for strip in strips]
    for price in set(prices):
        own = [place for place, other in enumerate(prices) if other == price]
        paid[own] = price.evaluated(widths[own] * (1 + 1j * COMPLEX_STEP))
    return paid.real, paid.imag / (COMPLEX_STEP * widths)


def strips_of(setup: Setup, straight: Mapping[str, Straight], span: tuple[float, float]) -> dict[str, Strip]:
    """Collect the priced tolerances in force that have a width of their own; ``span`` is of the present width."""
    return {tolerance.name: _strip(setup, tolerance, straight, span) for tolerance in priced_widths(setup)}


def priced_widths(setup: Setup) -> Iterator[Tolerance]:
    """Yield the tolerances in force with a price that are no grades and whose width can be chosen."""
    in_force = setup.distributions()
    for tolerance in setup.model.tolerances.values():
        chosen = isinstance(setup.spread_of(tolerance.name), (Band, Zone)) and price_of(setup, tolerance) is not None
        if (
            chosen
            and all(item.sd > 0 for item in in_force.get(tolerance.name, {}).values())
            and tolerance.name in in_force
        ):
            yield tolerance


def _strip(setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], span: tuple[float, float]) -> Strip:
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance)
    inner = setup.distributions()[tolerance.name]
    width = next(iter(inner.values())).width
    pull = shift_per_width(spread)
    assert price is not None  # priced_widths has chosen these
    return Strip(
        name=tolerance.name,
        start=width,
        low=span[0] * width,
        high=span[1] * width,
        price=price,
        variances={
            name: sum((float(line.slopes[column]) * item.sd) ** 2 for column, item in inner.items())
            for name, line in straight.items()
        },
        pulls={name: pull * sum(float(line.slopes[column]) for column in inner) for name, line in straight.items()},
    )


def with_widths(setup: Setup, widths: Mapping[str, float]) -> Setup:
    """Return the setup with these tolerances at these full widths (SI)."""
    changed: dict[str, Any] = {}
    for name, width in widths.items():
        target = setup.target(first_in_force(setup, name))
        changed[name] = with_width(setup.spread_of(name), target, width)
    return replace(setup, spreads={**setup.spreads, **changed})


def first_in_force(setup: Setup, tolerance: str) -> str:
    """Return the input whose full width is paid for."""
    names: Sequence[str] = list(setup.distributions()[tolerance])
    return names[0]
