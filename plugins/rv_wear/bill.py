"""A study of our own: what every priced tolerance costs, in each reading of the cost functions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rv_wear.costs import FORMS, price
from rv_wear.tolerances import PRICED
from truing import Bench, Block, Check, Float, Table, found, results


@results
class Cost:
    """What the zones cost together."""

    manufacturing_cost: Float = found("yuan", symbol="C", note="of all priced tolerances, as they are",
                                      formula="tolerance_price", source="sum of equations 25 to 27")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Costs:
    """Price every zone with each form of the cost functions: power, exponential and process."""

    name: str = "costs"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Bill":
        """Read the width of every priced zone that is in force and price it; one that is off is not paid."""
        widths = {
            name: next(iter(inner.values())).width
            for name, inner in bench.setup.distributions().items()
            if name in PRICED
        }
        prices = {name: {form: price(PRICED[name], form).at(width) for form in FORMS} for name, width in widths.items()}
        return Bill(float(bench.answers["tolerance_price"]), widths, prices)


@dataclass(frozen=True)
class Bill:
    """The sum in force (yuan), the width of every priced zone (m), and its price by form (yuan)."""

    total: float
    widths: Mapping[str, float]
    prices: Mapping[str, Mapping[str, float]]

    def as_json(self) -> dict[str, Any]:
        """Return width and prices by tolerance, and the sums by form."""
        return {
            "total": {"value": self.total, "unit": "yuan"},
            "by_form": {form: self.of_form(form) for form in FORMS},
            "tolerances": {
                name: {"width": {"value": width * 1e6, "unit": "um"}, "prices": dict(self.prices[name])}
                for name, width in self.widths.items()
            },
        }

    def of_form(self, form: str) -> float:
        """Return the sum of all prices in one form, yuan."""
        return sum((prices[form] for prices in self.prices.values()), 0.0)

    def blocks(self) -> Sequence[Block]:
        """Return the bill as a table."""
        rows: list[tuple[str | float, ...]] = [
            (name.replace("_", " "), PRICED[name], width * 1e6, *(self.prices[name][form] for form in FORMS))
            for name, width in self.widths.items()
        ]
        rows.append(("all together", "", "", *(self.of_form(form) for form in FORMS)))
        return [
            Table(
                "What the zones cost",
                ("zone", "cost function", "width", *FORMS),
                rows,
                ("", "", "µm", *("yuan" for _ in FORMS)),
                "The paper's coefficients in three forms of its lost equations 25 to 27. Its total is 1402 yuan.",
            )
        ]

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a cost decides no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()


def cost(bill: Bill) -> Cost:
    """The one number of the bill that the paper prints."""
    return Cost(manufacturing_cost=bill.total)
