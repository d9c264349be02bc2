"""Which grades? The paper's rule, one grade at a time, and the least cost there is, by mixed-integer programming.

The rule balances precision: among the parts at the coarsest grade, the one with the smallest coefficient is tightened.
The least cost is exact: with a part's grade as a choice of one among several, the first-order variance is a sum, so a
goal on the probability is a bound on that sum.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, inf
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, brentq, milp, minimize, nnls
from scipy.special import ndtr, ndtri

from truing.arrays import Matrix
from truing.fits import GRADES
from truing.studies.demands import Demand, normal_chance
from truing.studies.grades import AllocationProblem, prices_at
from truing.studies.threads import one_thread


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
class AllocationPlan:
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

    def same_as(self, other: AllocationPlan) -> bool:
        """Say whether two plans are one design."""
        return self.grades == other.grades and self.widths == other.widths


def coefficients(
    problem: AllocationProblem, slopes: Mapping[str, float], weights: tuple[float, float]
) -> dict[str, float]:
    """Return the adjustment coefficient of every part: small is tightened first.

    r = (P1 x + P2 c)/(P1 + P2), with x the sensitivity of the most sensitive part over that of this one and c the cost
    of this part's tolerance over that of the most sensitive one's. ``slopes`` are the summed absolute derivatives.
    """
    reference = max(problem.parts, key=lambda name: slopes[name])
    first, second = weights
    found: dict[str, float] = {}
    for name, part in problem.parts.items():
        ratio = slopes[reference] / slopes[name] if slopes[name] else float("inf")
        cost = part.first.cost / problem.parts[reference].first.cost
        found[name] = (first * ratio + second * cost) / (first + second) if first else cost
    return found


def by_rule(problem: AllocationProblem, order: Mapping[str, float], finest: str) -> tuple[list[Step], AllocationPlan]:
    """Tighten one part by one grade at a time until every goal is met or every part is at the finest grade."""
    grades = problem.start
    steps: list[Step] = []
    while not problem.reached(grades):
        open_parts = [name for name in problem.parts if GRADES.index(grades[name]) > GRADES.index(finest)]
        if not open_parts:
            break
        coarsest = max(GRADES.index(grades[name]) for name in open_parts)
        name = min(
            (name for name in open_parts if GRADES.index(grades[name]) == coarsest), key=lambda name: order[name]
        )
        before, after = grades[name], GRADES[coarsest - 1]
        grades = {**grades, name: after}
        widths = (problem.parts[name].choices[before].width, problem.parts[name].choices[after].width)
        steps.append(Step(len(steps) + 1, name, before, after, *widths, problem.chances(grades)))
    return steps, _plan(problem, grades, f"every tolerance is at {finest}")


def as_it_stands(problem: AllocationProblem) -> AllocationPlan:
    """Return the design before anything is adjusted."""
    return _plan(problem, problem.start, "nothing is adjusted")


def _plan(problem: AllocationProblem, grades: Mapping[str, str], shortfall: str) -> AllocationPlan:
    chances = problem.chances(grades)
    reached = problem.reached(grades)
    return AllocationPlan(
        grades, problem.cost(grades), chances, reached, "reached" if reached else f"not reachable: {shortfall}"
    )


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


def least_cost(problem: AllocationProblem) -> AllocationPlan:
    """Choose one grade for every part so that all goals are met to first order at the least cost there is."""
    bounds: dict[str, float] = {}
    for demand in problem.demands:
        if demand.goal is None:
            continue
        bound = largest_variance(demand, problem.means[demand.name])
        if bound is None:
            return _finest(problem, f"'{demand.name}' misses {demand.goal:g} however small the scatter")
        if bound < float("inf"):
            bounds[demand.name] = bound
    margin = 0.0
    for _ in range(6):  # the solver keeps a bound to 1e-7 only: hold it a little off until the goals are met exactly
        grades = _solve(problem, bounds, margin)
        if grades is None or problem.reached(grades):
            break
        margin = margin * 4 or 1e-7
    if grades is None or not problem.reached(grades):
        return _finest(problem, "every tolerance is at its finest grade")
    return _plan(problem, grades, "")


def _finest(problem: AllocationProblem, reason: str) -> AllocationPlan:
    grades = {name: min(part.choices, key=GRADES.index) for name, part in problem.parts.items()}
    return _plan(problem, grades, reason)


def _solve(problem: AllocationProblem, bounds: Mapping[str, float], margin: float) -> dict[str, str] | None:
    """Solve the choice of grades as a mixed-integer linear program; None where no choice meets the bounds."""
    choices = [(name, choice) for name, part in problem.parts.items() for choice in part.choices.values()]
    costs = np.array([choice.cost for _, choice in choices])
    one_each = np.array([[float(name == part) for name, _ in choices] for part in problem.parts])
    constraints: list[Any] = [LinearConstraint(one_each, 1.0, 1.0)]
    for demand, bound in bounds.items():
        room = bound * (1 - margin) - problem.fixed[demand]
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


# Which widths? The least cost under all goals, where tolerances are no grades but widths with a price


MARGINS = (0.0, 1e-10, 1e-8, 1e-6)
ROUNDING = 1e-13
STARTS = 4
FEASIBLE = 1e-9
AT_END = 1e-7
CHEAPER = 1e-9


@dataclass(frozen=True, eq=False)
class AllocationSearch:
    """The widths to choose, as logarithms over those in force, with these grades; goals in standard deviations."""

    problem: AllocationProblem
    grades: Mapping[str, str]

    def widths(self, x: Matrix) -> dict[str, float]:
        """Return the full widths (SI)."""
        return {
            variable.name: float(variable.start * np.exp(value))
            for variable, value in zip(self.problem.variables.values(), x, strict=True)
        }

    def ends(self) -> tuple[Matrix, Matrix]:
        """Return the smallest and the largest logarithms."""
        variables = self.problem.variables.values()
        low = np.log([variable.low / variable.start for variable in variables])
        return low, np.log([variable.high / variable.start for variable in variables])

    def cost(self, x: Matrix) -> tuple[float, Matrix]:
        """Return the price of the widths and its gradient, both over the price of those in force."""
        variables = tuple(self.problem.variables.values())
        widths = np.array(list(self.widths(x).values()))
        prices, slopes = prices_at(variables, widths)
        return float(prices.sum()) / self._whole, slopes * widths / self._whole

    @cached_property
    def _whole(self) -> float:
        """The price of the widths in force."""
        return sum(abs(variable.cost(variable.start)) for variable in self.problem.variables.values()) or 1.0

    def slack(self, x: Matrix) -> tuple[Matrix, Matrix]:
        """Return by goal how far it is kept (goals,), in standard deviations of the start, and the gradients."""
        found = [self._slack(demand, x) for demand in self.problem.goals]
        return np.array([value for value, _ in found]), np.array([gradient for _, gradient in found])

    def _slack(self, demand: Demand, x: Matrix) -> tuple[float, Matrix]:
        problem, name = self.problem, demand.name
        widths = self.widths(x)
        sd = max(problem.variance(name, self.grades, widths), 1e-300) ** 0.5
        by_mean = np.array([variable.pulls[name] * widths[key] for key, variable in problem.variables.items()])
        by_sd = np.array([variable.variance(name, widths[key]) / sd for key, variable in problem.variables.items()])
        room, of_mean, of_sd = _room(demand, problem.mean(name, widths), sd)
        scale = problem.variance(name, problem.start) ** 0.5 or 1.0
        return room / scale, (of_mean * by_mean + of_sd * by_sd) / scale


def _room(demand: Demand, mean: float, sd: float) -> tuple[float, float, float]:
    """Return how far a goal is kept in the unit of the result, with its derivatives by mean and standard deviation."""
    assert demand.goal is not None  # goals only
    times = float(ndtri(demand.goal))
    if demand.low == -inf:
        return demand.high - mean - times * sd, -1.0, -times
    if demand.high == inf:
        return mean - demand.low - times * sd, 1.0, -times
    if not demand.low < mean < demand.high:
        beyond = mean - demand.high if mean >= demand.high else demand.low - mean
        return -beyond - sd, -1.0 if mean >= demand.high else 1.0, -1.0
    largest, slope = _largest_sd(demand, mean)
    return largest - sd, slope, -1.0


def _largest_sd(demand: Demand, mean: float) -> tuple[float, float]:
    """Return the standard deviation up to which a goal between two limits is met, and its derivative by the mean."""
    goal = demand.goal or 0.0
    reach = min(demand.high - mean, mean - demand.low)
    if goal <= 0.5:
        sd = (largest_variance(demand, mean) or 0.0) ** 0.5
    else:  # both limits as near as the nearer one, or that one alone: the truth lies between
        ends = (reach / float(ndtri(0.5 + goal / 2)), reach / float(ndtri(goal)))
        sd = brentq(
            lambda sd: float(ndtr((demand.high - mean) / sd) - ndtr((demand.low - mean) / sd)) - goal,
            0.999 * ends[0],
            1.001 * ends[1],
            xtol=1e-16 * ends[0],
            rtol=1e-14,
        )
    above, below = (demand.high - mean) / sd, (demand.low - mean) / sd
    at_high, at_low = exp(-(above**2) / 2), exp(-(below**2) / 2)
    return sd, -(at_high - at_low) / (above * at_high - below * at_low)


def bought(problem: AllocationProblem, plan: AllocationPlan) -> AllocationPlan:
    """Return the plan with the widths that meet all goals at the least cost; where none do, those that come nearest."""
    if not problem.variables or any(demand.goal is not None and demand.goal >= 1.0 for demand in problem.demands):
        return plan
    search = AllocationSearch(problem, plan.grades)
    starts = list(_starts(search))
    with one_thread():
        found = _cheapest(search, starts)
        if found is None:
            nearest = _nearest(search, starts)
            found = _cheapest(search, [nearest])
    if found is None:
        return _with(problem, plan, search.widths(nearest), residual=None)
    return _with(problem, plan, search.widths(found), residual=_residual(search, found))


def bettered(problem: AllocationProblem, plan: AllocationPlan) -> AllocationPlan:
    """Change one grade by one step, buy the widths anew, and take what is cheapest, until no such step is cheaper."""
    with one_thread():
        while plan.reached and problem.variables:
            best = min(_steps_from(problem, plan), key=lambda other: other.cost, default=plan)
            if best.cost >= plan.cost * (1 - CHEAPER):
                break
            plan = best
    return plan


def _steps_from(problem: AllocationProblem, plan: AllocationPlan) -> Iterator[AllocationPlan]:
    """Yield the designs with one grade a step finer or coarser that meet all goals; widths start where they are."""
    for name, part in problem.parts.items():
        offered = list(part.choices)
        place = offered.index(plan.grades[name])
        for grade in offered[max(place - 1, 0) : place] + offered[place + 1 : place + 2]:
            other = replace(plan, grades={**plan.grades, name: grade})
            search = AllocationSearch(problem, other.grades)
            held = [np.log(plan.widths[key] / variable.start) for key, variable in problem.variables.items()]
            low, high = search.ends()
            found = _cheapest(search, [np.clip(held, low, high), low])
            if found is not None:
                yield _with(problem, other, search.widths(found), residual=_residual(search, found))


def _with(
    problem: AllocationProblem, plan: AllocationPlan, widths: Mapping[str, float], *, residual: float | None
) -> AllocationPlan:
    reached = problem.reached(plan.grades, widths)
    status = "reached"
    if not reached:
        status = (
            f"not reachable: no widths from {problem.span[0]:g} to {problem.span[1]:g} times those in force meet it"
        )
        status += ", and every grade is at its finest" if plan.grades else ""
    chances = problem.chances(plan.grades, widths)
    cost = problem.cost(plan.grades, widths)
    return replace(plan, cost=cost, chances=chances, reached=reached, status=status, widths=widths, residual=residual)


def _starts(search: AllocationSearch) -> Iterator[Matrix]:
    """Yield the widths in force, the narrowest, the widest, those between, and some by chance, always the same."""
    low, high = search.ends()
    yield np.clip(np.zeros(len(low)), low, high)
    yield from (low, high, (low + high) / 2)
    rng = np.random.default_rng(0)
    for _ in range(STARTS):
        yield rng.uniform(low, high)


def _cheapest(search: AllocationSearch, starts: Sequence[Matrix]) -> Matrix | None:
    """Return the least cost that was found; goals are held a little off until they are met exactly."""
    for margin in MARGINS:
        ends = [end for start in starts if (end := _descended(search, start, margin)) is not None]
        if not ends:
            return None
        best = _exact(search, min(ends, key=lambda x: search.cost(x)[0]))
        if search.problem.reached(search.grades, search.widths(best)):
            return best
    return None


def _exact(search: AllocationSearch, x: Matrix) -> Matrix:
    """Take the last rounding out of the goals that are just missed, by the shortest way."""
    for _ in range(4):
        if search.problem.reached(search.grades, search.widths(x)):
            break
        slack, rows = search.slack(x)
        short = slack < ROUNDING
        x = np.clip(x + np.linalg.lstsq(rows[short], ROUNDING - slack[short], rcond=None)[0], *search.ends())
    return x


def _descended(search: AllocationSearch, start: Matrix, margin: float) -> Matrix | None:
    """Follow one start to its minimum; None where it ends outside the goals."""
    x = _solved(
        search.cost,
        start,
        search.ends(),
        {"fun": lambda x: search.slack(x)[0] - margin, "jac": lambda x: search.slack(x)[1]},
    )
    return x if x is not None and search.slack(x)[0].min() >= margin - FEASIBLE else None


def _nearest(search: AllocationSearch, starts: Sequence[Matrix]) -> Matrix:
    """Return the widths whose worst goal is nearest to being met: the largest slack that all goals can have."""
    low, high = search.ends()
    upward = np.append(np.zeros(len(low)), -1.0)
    rising = -np.ones(len(search.problem.goals))
    found = list(starts)
    for start in starts:
        ends = (np.append(low, -np.inf), np.append(high, np.inf))
        y = _solved(
            lambda y: (-y[-1], upward),
            np.append(start, search.slack(start)[0].min()),
            ends,
            {
                "fun": lambda y: search.slack(y[:-1])[0] - y[-1],
                "jac": lambda y: np.column_stack([search.slack(y[:-1])[1], rising]),
            },
        )
        found += [] if y is None else [y[:-1]]
    return max(found, key=lambda x: float(search.slack(x)[0].min()))


def _solved(objective: Any, start: Matrix, ends: tuple[Matrix, Matrix], constraint: Any) -> Matrix | None:
    """Return where SLSQP ends, inside the bounds; None where it loses itself."""
    held: Any = {"type": "ineq", **constraint}
    options: Any = {"ftol": 1e-13, "maxiter": 300}
    answer = minimize(
        objective, start, jac=True, method="SLSQP", bounds=Bounds(*ends), constraints=held, options=options
    )
    x = np.clip(np.asarray(answer.x, dtype=float), *ends)
    return x if np.isfinite(x).all() else None


def _residual(search: AllocationSearch, x: Matrix) -> float:
    """Return how far the end of a search is from a minimum: what no active goal or bound balances of the gradient.

    0 is a minimum of Karush, Kuhn and Tucker; 1 is no balance at all.
    """
    low, high = search.ends()
    slack, rows = search.slack(x)
    forces = [row for row, room in zip(rows, slack, strict=True) if room <= AT_END]
    unit = np.eye(len(x))
    forces += [unit[place] for place in np.flatnonzero(x <= low + AT_END)]
    forces += [-unit[place] for place in np.flatnonzero(x >= high - AT_END)]
    gradient = search.cost(x)[1]
    size = float(np.linalg.norm(gradient))
    if not size:
        return 0.0
    left = float(nnls(np.array(forces).T, gradient)[1]) if forces else size
    return left / size
