"""Tolerance grades as design variables: what each grade of each part does to the scatter, and what it costs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.goals import Price
from truing.declare.sources import Tolerance
from truing.declare.spreads import Band, Grade, Zone, shift_per_width, with_width
from truing.errors import TruingError, UsageError
from truing.fits import GRADES
from truing.prices import price_of
from truing.setup import Setup
from truing.studies.chances import Straight
from truing.studies.demands import Demand, normal_chance

RECIPROCAL = "1/mm"


@dataclass(frozen=True)
class GradeChoice:
    """One grade of one part: its full width (m), its cost, and its first-order variance by demand (SI)."""

    grade: str
    width: float
    cost: float
    variances: Mapping[str, float]


@dataclass(frozen=True)
class GradedTolerance:
    """A tolerance that is a grade: the grade it starts at, and every grade it may take, finest first."""

    name: str
    start: str
    choices: Mapping[str, GradeChoice]

    @property
    def first(self) -> GradeChoice:
        """The grade it starts at."""
        return self.choices[self.start]


@dataclass(frozen=True)
class AllocationProblem:
    """All parts whose grade may be chosen, strips whose width may be, what stays as it is, and the goals to reach.

    ``fixed`` is the variance that no grade makes, with the widths in force. ``span`` is that of the widths over those.
    """

    parts: Mapping[str, GradedTolerance]
    demands: tuple[Demand, ...]
    means: Mapping[str, float]
    fixed: Mapping[str, float]
    unit: str
    priced: bool
    variables: Mapping[str, ToleranceVariable] = field(default_factory=dict)
    span: tuple[float, float] = (1.0, 1.0)

    def variance(self, name: str, grades: Mapping[str, str], widths: Mapping[str, float] | None = None) -> float:
        """Return the first-order variance of a demand's response with these grades and widths (those in force)."""
        graded = sum(part.choices[grades[key]].variances[name] for key, part in self.parts.items())
        moved = ((self.variables[key], width) for key, width in (widths or {}).items())
        return max(
            0.0,
            self.fixed[name]
            + graded
            + sum(variable.variance(name, width) - variable.variances[name] for variable, width in moved),
        )

    def mean(self, name: str, widths: Mapping[str, float] | None = None) -> float:
        """Return the first-order mean of a demand's response with these widths (those in force)."""
        return self.means[name] + sum(self.variables[key].shift(name, width) for key, width in (widths or {}).items())

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
        return graded + sum(variable.cost(chosen[key]) for key, variable in self.variables.items())

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
        return {name: variable.start for name, variable in self.variables.items()}

    @property
    def start(self) -> dict[str, str]:
        """The grades before anything is adjusted."""
        return {name: part.start for name, part in self.parts.items()}


def open_problem(
    setup: Setup,
    wanted: Sequence[Demand],
    straight: Mapping[str, Straight],
    finest: str,
    *,
    loosen: bool,
    span: tuple[float, float] = (1.0, 1.0),
) -> AllocationProblem:
    """Collect parts, grades, widths and costs. Raises UsageError where no tolerance in force is a grade or has a price.

    Widths can be bought only where every grade has a price too; otherwise they stay.
    """
    graded = [
        tolerance for tolerance in setup.model.tolerances.values() if isinstance(setup.spread_of(tolerance.name), Grade)
    ]
    price_unit = _price_unit(setup, graded)
    priced = price_unit is not None
    variables = tolerance_variables(setup, straight, span) if priced or not graded else {}
    if not graded and not variables:
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
    units = [price_unit] if price_unit is not None else [variable.price.unit for variable in variables.values()]
    unit = units[0] if units else RECIPROCAL
    return AllocationProblem(parts, tuple(wanted), means, fixed, unit, priced or bool(variables), variables, span)


def _part(
    setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], allowed: tuple[str, bool], priced: bool
) -> GradedTolerance:
    spread = setup.spread_of(tolerance.name)
    assert isinstance(spread, Grade)  # open_shop has chosen these
    start = GRADES.index(spread.grade)
    finest, loosen = GRADES.index(allowed[0]), allowed[1]
    last = len(GRADES) if loosen else start + 1
    choices: dict[str, GradeChoice] = {}
    for grade in GRADES[min(finest, start) : last]:
        choice = _choice(setup, tolerance, replace(spread, grade=grade), straight, priced=priced)
        if choice is not None:
            choices[grade] = choice
    return GradedTolerance(tolerance.name, spread.grade, choices)


def _choice(
    setup: Setup, tolerance: Tolerance, spread: Grade, straight: Mapping[str, Straight], *, priced: bool
) -> GradeChoice | None:
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
    return GradeChoice(spread.grade, width, cost_of(price_of(setup, tolerance) if priced else None, width), variances)


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


# Tolerances that are widths, not grades: what any width of each does to scatter and mean, and what it costs


COMPLEX_STEP = 1e-30


@dataclass(frozen=True)
class ToleranceVariable:
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


def prices_at(variables: Sequence[ToleranceVariable], widths: Matrix) -> tuple[Matrix, Matrix]:
    """Return what these full widths (n,) in SI cost, and the exact derivatives: the formulas with an imaginary step.

    Every formula is computed once, for all widths that it prices.
    Source: W. Squire, G. Trapp, Using complex variables to estimate derivatives, SIAM Rev. 40 (1998) 110.
    """
    paid = np.empty(len(variables), dtype=complex)
    prices = [variable.price for variable in variables]
    for price in set(prices):
        own = [index for index, other in enumerate(prices) if other == price]
        paid[own] = price.evaluated(widths[own] * (1 + 1j * COMPLEX_STEP))
    return paid.real, paid.imag / (COMPLEX_STEP * widths)


def tolerance_variables(
    setup: Setup, straight: Mapping[str, Straight], span: tuple[float, float]
) -> dict[str, ToleranceVariable]:
    """Collect the priced tolerances in force that have a width of their own; ``span`` is of the present width."""
    return {tolerance.name: _strip(setup, tolerance, straight, span) for tolerance in priced_widths(setup)}


def priced_widths(setup: Setup) -> Iterator[Tolerance]:
    """Yield the tolerances in force with a price that are no grades and whose width can be chosen."""
    in_force = setup.distributions()
    for tolerance in setup.model.tolerances.values():
        chosen = isinstance(setup.spread_of(tolerance.name), (Band, Zone)) and price_of(setup, tolerance) is not None
        if (
            chosen
            and all(target.sd > 0 for target in in_force.get(tolerance.name, {}).values())
            and tolerance.name in in_force
        ):
            yield tolerance


def _strip(
    setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], span: tuple[float, float]
) -> ToleranceVariable:
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance)
    inner = setup.distributions()[tolerance.name]
    width = next(iter(inner.values())).width
    pull = shift_per_width(spread)
    assert price is not None  # priced_widths has chosen these
    return ToleranceVariable(
        name=tolerance.name,
        start=width,
        low=span[0] * width,
        high=span[1] * width,
        price=price,
        variances={
            name: sum((float(line.slopes[column]) * distribution.sd) ** 2 for column, distribution in inner.items())
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
