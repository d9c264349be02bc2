"""What the calculation is for: what may be chosen, what should be small or large, what must hold, what it costs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal, TypeAlias

from truing.errors import DeclarationError
from truing.formulas import evaluate, parse
from truing.units import from_si

LimitKind = Literal["at_most", "at_least", "within"]
YES = "yes"
"""What ``at_least`` asks of a result that is 1 for yes and 0 for no."""


@dataclass(frozen=True)
class Price:
    """What a tolerance costs: a formula in ``width`` (the full band as a number in the unit ``width``)."""

    formula: str
    width: str
    unit: str

    def at(self, width: float) -> float:
        """Return what a full width in SI costs, in the unit of the price."""
        return float(self.evaluated(float(width)))

    def evaluated(self, widths: Any) -> Any:
        """Return the formula at a full width in SI, or at widths (n,), in the unit of the price."""
        return evaluate(parse(self.formula), {"width": from_si(widths, self.width)})


@dataclass(frozen=True)
class PriceByChoice:
    """Another price for each value of an input that offers choices; all of them in one currency."""

    chooser: str
    prices: Mapping[str, Price]

    @property
    def unit(self) -> str:
        """The unit of the prices."""
        return next(price.unit for price in self.prices.values())

    def chosen(self, value: str) -> Price:
        """Return the price for this value of the choosing input."""
        if value not in self.prices:
            raise DeclarationError(f"no price is declared for {self.chooser} = '{value}'")
        return self.prices[value]


def prices_in(price: Price | PriceByChoice | None) -> tuple[Price, ...]:
    """Return every price that a tolerance may have: one, one per choice, or none."""
    if price is None:
        return ()
    return (price,) if isinstance(price, Price) else tuple(price.prices.values())


@dataclass(frozen=True)
class Vary:
    """An input that may be chosen between ``low`` and ``high`` (texts with units), or that a formula makes follow.

    With ``step``, a text with a unit, only whole multiples of it are chosen: what can be ordered or set.
    """

    input: str
    low: str = ""
    high: str = ""
    by: str = ""
    step: str = ""

    def __post_init__(self) -> None:
        bounds = [self.low, self.high]
        if any([*bounds, self.step]) if self.by else not all(bounds):
            raise DeclarationError(f"Vary('{self.input}') takes either low and high or by=\"formula\"")


@dataclass(frozen=True)
class Minimise:
    """A result that should be small."""

    result: str


@dataclass(frozen=True)
class Maximise:
    """A result that should be large."""

    result: str


@dataclass(frozen=True)
class Require:
    """A limit on a result; with ``reliability`` a limit on the chance of meeting it.

    A limit is a quantity ("80 MPa") or the name of an input or result; ``at_least="yes"`` asks of a
    result that is 1 for yes and 0 for no (``is_flag``) that it is 1. ``within`` is the distance from the nominal
    result, that of the design without any scatter. ``reliability`` is a probability or the name of an input.
    """

    result: str
    _: KW_ONLY
    at_most: str = ""
    at_least: str = ""
    within: str = ""
    reliability: float | str | None = None

    def __post_init__(self) -> None:
        if sum(map(bool, (self.at_most, self.at_least, self.within))) != 1:
            raise DeclarationError(f"Require('{self.result}') takes one of at_most, at_least and within")
        if isinstance(self.reliability, (int, float)) and not 0 < self.reliability < 1:
            raise DeclarationError(
                f"Require('{self.result}'): the reliability {self.reliability} must lie between 0 and 1"
            )

    @property
    def kind(self) -> LimitKind:
        """Which limit it is."""
        return "at_most" if self.at_most else "at_least" if self.at_least else "within"

    @property
    def is_flag(self) -> bool:
        """Whether it asks a result that is 1 for yes and 0 for no to be 1."""
        return self.at_least == YES

    @property
    def limit(self) -> str:
        """The limit as a quantity or a name."""
        return "1" if self.is_flag else self.at_most or self.at_least or self.within


Objective: TypeAlias = Vary | Minimise | Maximise | Require
