"""What tolerances cost: the price of one at its width, and the sum over all that are in force."""

from __future__ import annotations

from truing.declare.checks import TOTAL_PRICE
from truing.declare.goals import Price
from truing.setup import Setup


def price_at(price: Price, width: float) -> float:
    """Return what a full width in SI costs, in the unit of the price."""
    from truing.formulas import evaluate, parse
    from truing.units import from_si

    return float(evaluate(parse(price.formula), {"width": float(from_si(width, price.width))}))


def total_price(setup: Setup) -> float | None:
    """Return the sum of the prices in SI, each at the full width its tolerance has; None where none has a price.

    A tolerance on several inputs is one band and is paid once; one that is off is not paid.
    """
    from truing.units import to_si

    if TOTAL_PRICE not in setup.model.result_fields:
        return None
    prices = {name: item.price for name, item in setup.model.tolerances.items() if item.price is not None}
    paid = [
        price_at(price, next(iter(inner.values())).width)
        for name, inner in setup.distributions().items()
        if (price := prices.get(name)) is not None
    ]
    return to_si(sum(paid, 0.0), setup.model.result_fields[TOTAL_PRICE].unit)


def price_answers(setup: Setup) -> dict[str, float]:
    """Return the sum of the prices as an answer of a run by its name; nothing where no tolerance has a price."""
    price = total_price(setup)
    return {} if price is None else {TOTAL_PRICE: price}
