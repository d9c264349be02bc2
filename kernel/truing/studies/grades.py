"""Tolerance grades as design variables: what each grade of each part does to the scatter, and what it costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from truing.declare.goals import Price
from truing.declare.sources import Tolerance
from truing.declare.spreads import Grade
from truing.errors import TruingError, UsageError
from truing.fits import GRADES
from truing.prices import price_of
from truing.setup import Setup
from truing.studies.chances import Straight
from truing.studies.demands import Demand, normal_chance
from truing.studies.strips import Strip, strips_of

RECIPROCAL = "1/mm"


@dataclass(frozen=True)
class Choice:
    """One grade of one part: its full width (m), its cost, and its first-order variance by demand (SI)."""

    grade: str
    width: float
    cost: float
    variances: Mapping[str, float]


@dataclass(frozen=True)
class Part:
    """A tolerance that is a grade: the grade it starts at, and every grade it may take, finest first."""

    name: str
    start: str
    choices: Mapping[str, Choice]

    @property
    def first(self) -> Choice:
        """The grade it starts at."""
        return self.choices[self.start]


@dataclass(frozen=True)
class Shop:
    """All parts whose grade may be chosen, strips whose width may be, what stays as it is, and the goals to reach.

    ``fixed`` is the variance that no grade makes, with the widths in force. ``span`` is that of the widths over those.
    """

    parts: Mapping[str, Part]
    demands: tuple[Demand, ...]
    means: Mapping[str, float]
    fixed: Mapping[str, float]
    unit: str
    priced: bool
    strips: Mapping[str, Strip] = field(default_factory=dict)
    span: tuple[float, float] = (1.0, 1.0)

    def variance(self, name: str, grades: Mapping[str, str], widths: Mapping[str, float] | None = None) -> float:
        """Return the first-order variance of a demand's response with these grades and widths (those in force)."""
        graded = sum(part.choices[grades[key]].variances[name] for key, part in self.parts.items())
        moved = ((self.strips[key], width) for key, width in (widths or {}).items())
        return max(
            0.0,
            self.fixed[name]
            + graded
            + sum(strip.variance(name, width) - strip.variances[name] for strip, width in moved),
        )

    def mean(self, name: str, widths: Mapping[str, float] | None = None) -> float:
        """Return the first-order mean of a demand's response with these widths (those in force)."""
        return self.means[name] + sum(self.strips[key].shift(name, width) for key, width in (widths or {}).items())

    def chances(self, grades: Mapping[str, str], widths: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return the first-order probability of every demand with these grades and widths."""
        return {
            demand.name: normal_chance(
                self.mean(demand.name, widths),
                self.variance(demand.name, grades, widths) ** 0.5,
                demand.low,
                demand.high,
            )
            for demand in self.demands
        }

    def cost(self, grades: Mapping[str, str], widths: Mapping[str, float] | None = None) -> float:
        """Return the sum of what these grades and widths cost."""
        graded = sum(part.choices[grades[key]].cost for key, part in self.parts.items())
        chosen = {**self.widths, **(widths or {})}
        return graded + sum(strip.cost(chosen[key]) for key, strip in self.strips.items())

    def reached(self, grades: Mapping[str, str], widths: Mapping[str, float] | None = None) -> bool:
        """Say whether every goal is met to first order."""
        chances = self.chances(grades, widths)
        return all(chances[demand.name] >= demand.goal for demand in self.goals if demand.goal is not None)

    @property
    def goals(self) -> tuple[Demand, ...]:
        """The demands with a probability to reach."""
        return tuple(demand for demand in self.demands if demand.goal is not None)

    @property
    def widths(self) -> dict[str, float]:
        """The full widths (SI) before anything is adjusted."""
        return {name: strip.start for name, strip in self.strips.items()}

    @property
    def start(self) -> dict[str, str]:
        """The grades before anything is adjusted."""
        return {name: part.start for name, part in self.parts.items()}


def open_shop(
    setup: Setup,
    wanted: Sequence[Demand],
    straight: Mapping[str, Straight],
    finest: str,
    *,
    loosen: bool,
    span: tuple[float, float] = (1.0, 1.0),
) -> Shop:
    """Collect parts, grades, widths and costs. Raises UsageError where no tolerance in force is a grade or has a price.

    Widths can be bought only where every grade has a price too; otherwise they stay.
    """
    graded = [item for item in setup.model.tolerances.values() if isinstance(setup.spread_of(item.name), Grade)]
    price_unit = _price_unit(setup, graded)
    priced = price_unit is not None
    strips = strips_of(setup, straight, span) if priced or not graded else {}
    if not graded and not strips:
        raise UsageError(
            f'{setup.model.name} has no tolerance that is a grade, such as grade("IT7"), and none with a price whose '
            "width could be chosen: nothing to allocate"
        )
    parts = {tolerance.name: _part(setup, tolerance, straight, (finest, loosen), priced) for tolerance in graded}
    whole = {demand.name: float(straight[demand.name].variance) for demand in wanted}
    fixed = {
        name: max(0.0, variance - sum(part.first.variances[name] for part in parts.values()))
        for name, variance in whole.items()
    }
    means = {demand.name: float(straight[demand.name].mean) for demand in wanted}
    units = [price_unit] if price_unit is not None else [strip.price.unit for strip in strips.values()]
    unit = units[0] if units else RECIPROCAL
    return Shop(parts, tuple(wanted), means, fixed, unit, priced or bool(strips), strips, span)


def _part(
    setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], allowed: tuple[str, bool], priced: bool
) -> Part:
    spread = setup.spread_of(tolerance.name)
    assert isinstance(spread, Grade)  # open_shop has chosen these
    start = GRADES.index(spread.grade)
    finest, loosen = GRADES.index(allowed[0]), allowed[1]
    last = len(GRADES) if loosen else start + 1
    choices: dict[str, Choice] = {}
    for grade in GRADES[min(finest, start) : last]:
        choice = _choice(setup, tolerance, replace(spread, grade=grade), straight, priced=priced)
        if choice is not None:
            choices[grade] = choice
    return Part(tolerance.name, spread.grade, choices)


def _choice(
    setup: Setup, tolerance: Tolerance, spread: Grade, straight: Mapping[str, Straight], *, priced: bool
) -> Choice | None:
    """Return what one grade does, or None where ISO 286 has no such grade for the size."""
    try:
        width = spread.width(setup.target(tolerance.on[0]))
        sds = {column: spread.resolve(setup.target(column)).sd for column in tolerance.on}
    except TruingError:
        if spread == setup.spread_of(tolerance.name):
            raise
        return None
    variances = {
        name: sum((float(line.slopes[column]) * sd) ** 2 for column, sd in sds.items())
        for name, line in straight.items()
    }
    return Choice(spread.grade, width, cost_of(price_of(setup, tolerance) if priced else None, width), variances)


def cost_of(price: Price | None, width: float) -> float:
    """Return the cost of a full width (m): by its price, else by the reciprocal law, 1/width in 1/mm.

    Source of the law: K. W. Chase, A. R. Parkinson, survey of cost-tolerance models, Res. Eng. Des. 3 (1991) 23.
    """
    return 1e-3 / width if price is None else price.at(width)


def _price_unit(setup: Setup, graded: Sequence[Tolerance]) -> str | None:
    """Return the unit of the prices when every part has one (a model has them all in one); None: the reciprocal law."""
    units = [price.unit for tolerance in graded if (price := price_of(setup, tolerance)) is not None]
    return units[0] if units and len(units) == len(graded) else None


def with_grades(setup: Setup, grades: Mapping[str, str]) -> Setup:
    """Return the setup with these tolerances at these grades."""
    changed: dict[str, Any] = {}
    for name, grade in grades.items():
        spread = setup.spread_of(name)
        assert isinstance(spread, Grade)  # a part of the shop
        changed[name] = replace(spread, grade=grade)
    return replace(setup, spreads={**setup.spreads, **changed})
