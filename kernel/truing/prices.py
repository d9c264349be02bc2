"""What tolerances cost: the price of one at its width, and the sum over all that are in force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from truing.declare.goals import Price, PriceByChoice
from truing.declare.model import TOTAL_PRICE
from truing.declare.sources import Tolerance
from truing.setup import Setup
from truing.units import to_si


def price_of(setup: Setup, tolerance: Tolerance) -> Price | None:
    """Return the price of a tolerance, settled where it follows a choice; None where it has none."""
    price = tolerance.price
    return price.chosen(str(setup.nominal(price.chooser))) if isinstance(price, PriceByChoice) else price


def prices_at(price: Price, widths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what full widths (n,) in SI cost, in the unit of the price."""
    return np.broadcast_to(np.asarray(price.evaluated(widths), dtype=float), widths.shape)


def total_price(setup: Setup) -> float | None:
    """Return the sum of the prices in SI, each at the full width its tolerance has; None where none has a price.

    A tolerance on several inputs is one band and is paid once; one that is off is not paid.
    """
    if TOTAL_PRICE not in setup.model.result_fields:
        return None
    prices = {name: price_of(setup, tolerance) for name, tolerance in setup.model.tolerances.items()}
    paid = [
        price.at(next(iter(inner.values())).width)
        for name, inner in setup.distributions().items()
        if (price := prices.get(name)) is not None
    ]
    return to_si(sum(paid, 0.0), setup.model.result_fields[TOTAL_PRICE].unit)


def price_answers(setup: Setup) -> dict[str, float]:
    """Return the sum of the prices as an answer of a run by its name; nothing where no tolerance has a price."""
    price = total_price(setup)
    return {} if price is None else {TOTAL_PRICE: price}
