"""Which grades? The paper's rule, one grade at a time, and the least cost there is, by mixed-integer programming.

The rule balances precision: among the parts at the coarsest grade, the one with the smallest coefficient is tightened.
The least cost is exact: with a part's grade as a choice of one among several, the first-order variance is a sum, so a
goal on the probability is a bound on that sum.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, brentq, milp

from truing.fits import GRADES
from truing.studies.demands import Demand, normal_chance
from truing.studies.grades import Shop


@dataclass(frozen=True)
class Step:
    """One adjustment: which part, from which grade to which, its full widths (m), and the chances after it."""

    number: int
    tolerance: str
    before: str
    after: str
    width_before: float
    width_after: float
    chances: Mapping[str, float]


@dataclass(frozen=True)
class Plan:
    """Grades and full widths (SI) by tolerance, what they cost, first-order chances, and whether all goals are reached.

    ``residual`` says how far the widths are from a minimum of the cost: 0 is one; None where none were found.
    """

    grades: Mapping[str, str]
    cost: float
    chances: Mapping[str, float]
    reached: bool
    status: str = ""
    widths: Mapping[str, float] = field(default_factory=dict)
    residual: float | None = 0.0

    def same_as(self, other: Plan) -> bool:
        """Say whether two plans are one design."""
        return self.grades == other.grades and self.widths == other.widths


def coefficients(shop: Shop, slopes: Mapping[str, float], weights: tuple[float, float]) -> dict[str, float]:
    """Return the adjustment coefficient of every part: small is tightened first.

    r = (P1 x + P2 c)/(P1 + P2), with x the sensitivity of the most sensitive part over that of this one and c the cost
    of this part's tolerance over that of the most sensitive one's. ``slopes`` are the summed absolute derivatives.
    """
    reference = max(shop.parts, key=lambda name: slopes[name])
    first, second = weights
    found: dict[str, float] = {}
    for name, part in shop.parts.items():
        ratio = slopes[reference] / slopes[name] if slopes[name] else float("inf")
        cost = part.first.cost / shop.parts[reference].first.cost
        found[name] = (first * ratio + second * cost) / (first + second) if first else cost
    return found


def by_rule(shop: Shop, order: Mapping[str, float], finest: str) -> tuple[list[Step], Plan]:
    """Tighten one part by one grade at a time until every goal is met or every part is at the finest grade."""
    grades = shop.start
    steps: list[Step] = []
    while not shop.reached(grades):
        open_parts = [name for name in shop.parts if GRADES.index(grades[name]) > GRADES.index(finest)]
        if not open_parts:
            break
        coarsest = max(GRADES.index(grades[name]) for name in open_parts)
        name = min(
            (name for name in open_parts if GRADES.index(grades[name]) == coarsest), key=lambda name: order[name]
        )
        before, after = grades[name], GRADES[coarsest - 1]
        grades = {**grades, name: after}
        widths = (shop.parts[name].choices[before].width, shop.parts[name].choices[after].width)
        steps.append(Step(len(steps) + 1, name, before, after, *widths, shop.chances(grades)))
    return steps, _plan(shop, grades, f"every tolerance is at {finest}")


def as_it_stands(shop: Shop) -> Plan:
    """Return the design before anything is adjusted."""
    return _plan(shop, shop.start, "nothing is adjusted")


def _plan(shop: Shop, grades: Mapping[str, str], shortfall: str) -> Plan:
    chances = shop.chances(grades)
    reached = shop.reached(grades)
    return Plan(grades, shop.cost(grades), chances, reached, "reached" if reached else f"not reachable: {shortfall}")


def largest_variance(demand: Demand, mean: float) -> float | None:
    """Return the variance up to which a demand's goal is met; None where no variance, however small, meets it.

    Between its limits the probability falls as the variance grows, so the bound is exact. Goals of one half and more.
    """
    assert demand.goal is not None  # goals only
    goal = demand.goal
    if not demand.low < mean < demand.high:
        return None
    reach = min(demand.high - mean, mean - demand.low)

    def short(log_sd: float) -> float:
        return float(normal_chance(mean, reach * 10.0**log_sd, demand.low, demand.high)) - goal

    if goal >= 1.0 or short(-1.5) < 0:
        return None
    if short(12.0) >= 0:
        return float("inf")
    log_sd: float = brentq(short, -1.5, 12.0, xtol=1e-15, rtol=1e-14)
    return float((reach * 10.0**log_sd) ** 2)


def least_cost(shop: Shop) -> Plan:
    """Choose one grade for every part so that all goals are met to first order at the least cost there is."""
    bounds: dict[str, float] = {}
    for demand in shop.demands:
        if demand.goal is None:
            continue
        bound = largest_variance(demand, shop.means[demand.name])
        if bound is None:
            return _finest(shop, f"'{demand.name}' misses {demand.goal:g} however small the scatter")
        if bound < float("inf"):
            bounds[demand.name] = bound
    margin = 0.0
    for _ in range(6):  # the solver keeps a bound to 1e-7 only: hold it a little off until the goals are met exactly
        grades = _solve(shop, bounds, margin)
        if grades is None or shop.reached(grades):
            break
        margin = margin * 4 or 1e-7
    if grades is None or not shop.reached(grades):
        return _finest(shop, "every tolerance is at its finest grade")
    return _plan(shop, grades, "")


def _finest(shop: Shop, reason: str) -> Plan:
    grades = {name: min(part.choices, key=GRADES.index) for name, part in shop.parts.items()}
    return _plan(shop, grades, reason)


def _solve(shop: Shop, bounds: Mapping[str, float], margin: float) -> dict[str, str] | None:
    """Solve the choice of grades as a mixed-integer linear program; None where no choice meets the bounds."""
    choices = [(name, choice) for name, part in shop.parts.items() for choice in part.choices.values()]
    costs = np.array([choice.cost for _, choice in choices])
    one_each = np.array([[float(name == part) for name, _ in choices] for part in shop.parts])
    constraints: list[Any] = [LinearConstraint(one_each, 1.0, 1.0)]
    for demand, bound in bounds.items():
        room = bound * (1 - margin) - shop.fixed[demand]
        if room <= 0:
            return None
        shares = np.array([choice.variances[demand] / room for _, choice in choices])
        constraints.append(LinearConstraint(shares[None], -np.inf, 1.0))
    answer = milp(
        costs / np.abs(costs).max(),
        integrality=np.ones(len(choices), dtype=np.int64),
        bounds=Bounds(0, 1),
        constraints=constraints,
        options={"mip_rel_gap": 0.0},
    )
    if answer.x is None:
        return None
    return {name: choice.grade for (name, choice), taken in zip(choices, answer.x, strict=True) if taken > 0.5}
