"""Which tolerance do I buy? Grades by the rule of the paper and by least cost; widths with a price at least cost."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import islice
from math import exp, inf
from typing import Any, Literal

import numpy as np
from scipy.special import ndtri

from truing.arrays import Matrix, one_thread
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.goals import Price
from truing.declare.near_miss import near_miss
from truing.declare.sources import Tolerance
from truing.declare.spreads import Band, Grade, Zone, shift_per_width
from truing.errors import TruingError, UsageError
from truing.evaluate import acting_inputs
from truing.fits import GRADES
from truing.heavy import optimize
from truing.prices import price_answers, price_of
from truing.setup import Setup
from truing.studies.bench import Bench
from truing.studies.checks import Check, Demand, Proposal, as_number, demands, normal_chance, plain_checks
from truing.studies.drawings import lines
from truing.studies.first_order import Straight, slopes, straightened
from truing.studies.reading import printed, printed_step, spoken
from truing.studies.sampling import BATCH, Scatter, Tally, goal_checks, sample, scatter_of, with_tolerances
from truing.units import unit_text

BALANCED_TO = 1e-4
STARTS = 8  # four that are known and four by chance: in a smooth problem of widths all end alike


@dataclass(frozen=True, kw_only=True)
class Allocation:
    """Buy tolerances until every Require with a reliability is met: ISO 286 grades, and widths that have a price.

    ``balanced`` is the rule of precision balance: the coarsest grades first, among them the part whose coefficient of
    sensitivity and cost is smallest, never finer than ``finest``. ``of`` names the result whose sensitivities order the
    parts (empty: that of the first goal). ``weights`` are those of sensitivity and cost. ``loosen`` lets the least-cost
    solution take coarser grades than those of the start. A tolerance that is no grade but has a price is a width
    between ``tightest`` and ``widest`` times the one in force; with the grades of a design chosen, its widths are those
    of least cost, the best of ``starts`` searches, of which the first begins with what is in force. All designs are
    verified by ``draws`` machines on the exact model.
    """

    rule: Literal["balanced"] = "balanced"
    of: str = ""
    finest: str = "IT5"
    weights: tuple[float, float] = (1.0, 1.0)
    loosen: bool = False
    tightest: float = 0.25
    widest: float = 4.0
    starts: int = STARTS
    draws: int = 100_000
    batch: int = BATCH
    name: str = "allocation"
    gives: Callable[[Allotted], Any] | None = None

    def __post_init__(self) -> None:
        if self.rule != "balanced":
            raise UsageError(f"the rule '{self.rule}' is unknown; there is balanced")
        if self.finest not in GRADES:
            raise UsageError(f"'{self.finest}' is no tolerance grade; write IT1 to IT18")
        if len(self.weights) != 2 or min(self.weights) < 0 or not sum(self.weights) > 0:
            raise UsageError("weights are two numbers, not negative and not both 0")
        if not 0 < self.tightest < self.widest < float("inf"):
            raise UsageError(
                f"tightest = {self.tightest:g} and widest = {self.widest:g}, but widths need a range above 0 that rises"
            )
        if min(self.starts, self.draws, self.batch) < 1:
            raise UsageError("starts, draws and batch are at least 1")

    def run(self, bench: Bench) -> Allotted:
        """Allocate by the rule and by least cost, and verify both. Raises UsageError without a grade or a goal."""
        setup = bench.setup
        wanted = _goals(setup, bench.answers, self.name)
        scatter = scatter_of(setup)
        straight, derivatives = straightened(scatter, wanted)
        problem = open_problem(scatter, wanted, straight, self)
        order = coefficients(problem, self._slopes(scatter, wanted, problem), self.weights) if problem.parts else {}
        steps, ruled = by_rule(problem, order, self.finest) if problem.parts else ([], as_it_stands(problem))
        rule = bought(problem, ruled)
        least = _least(problem, ruled, rule)
        plans = {"start": as_it_stands(problem), "rule": rule, "least": least}
        setups = {key: with_tolerances(setup, plan.chosen) for key, plan in plans.items()}
        return Allotted(
            name=self.name,
            finest=self.finest,
            problem=problem,
            steps=tuple(steps),
            rule=rule,
            least=least,
            coefficients=order,
            sampled=self._verified(bench, wanted, plans),
            texts={key: {name: own.spread_of(name).text for name in problem.tolerances} for key, own in setups.items()},
            priced={key: tuple(plain_checks(own, price_answers(own))) for key, own in setups.items()},
            remarks=(*derivatives.warnings, *_left_alone(setup, problem)),
            inputs=acting_inputs(setup),
        )

    def _slopes(self, scatter: Scatter, wanted: Sequence[Demand], problem: AllocationProblem) -> dict[str, float]:
        """Return by part the sum of the absolute derivatives of the ordering result."""
        of = self.of or wanted[0].result
        known = scatter.setup.model.own_result_fields
        if of not in known:
            raise UsageError(f"study '{self.name}': there is no result '{of}'.{near_miss(of, known)}")
        tolerances = scatter.setup.model.tolerances
        columns = tuple(dict.fromkeys(column for name in problem.parts for column in tolerances[name].on))
        derivatives = slopes(scatter.setup, (of,), columns, scatter).of[of]
        return {name: sum(abs(float(derivatives[column])) for column in tolerances[name].on) for name in problem.parts}

    def _verified(
        self, bench: Bench, wanted: Sequence[Demand], plans: Mapping[str, AllocationPlan]
    ) -> dict[str, Tally]:
        """Draw the same machines for every design; equal designs are drawn once."""
        tallies: dict[str, Tally] = {}
        for stage, (key, plan) in enumerate(plans.items()):
            twin = next((other for other in tallies if plans[other].chosen == plan.chosen), None)
            if twin is not None:
                tallies[key] = tallies[twin]
                continue
            setup = with_tolerances(bench.setup, plan.chosen)
            done = bench.part(self.name, stage / len(plans), (stage + 1) / len(plans))
            tallies[key] = sample(
                scatter_of(setup), wanted, bench.answers,
                draws=self.draws, batch=self.batch, executor=bench.executor, done=done,
            )  # fmt: skip
        return tallies


def _least(problem: AllocationProblem, ruled: AllocationPlan, rule: AllocationPlan) -> AllocationPlan:
    """Return the cheapest design. With widths too it is sought by steps of one grade from three choices of grades."""
    if not problem.parts:
        return rule
    if not problem.variables:
        return least_cost(problem)
    plans = [bought(problem, least_cost(problem)), rule]
    if ruled.grades != problem.start:
        plans.append(bought(problem, as_it_stands(problem)))
    return min((bettered(problem, plan) for plan in plans), key=lambda plan: (not plan.reached, plan.cost))


def _left_alone(setup: Setup, problem: AllocationProblem) -> list[str]:
    """Say which widths with a price were not chosen, since the grades beside them have none."""
    names = [f"'{target.name}'" for target in priced_widths(setup) if target.name not in problem.variables]
    if not names:
        return []
    return [f"the widths of {' and '.join(names)} stay: not every grade has a price, so costs cannot be compared"]


def _goals(setup: Setup, answers: Mapping[str, Any], study: str) -> list[Demand]:
    wanted = demands(setup, answers, with_goal=True)
    if not wanted:
        raise UsageError(
            f"study '{study}': {setup.model.name} has no Require with a reliability: there is no goal to reach"
        )
    curved = [demand.name for demand in wanted if np.ndim(answers[demand.result])]
    if curved:
        raise UsageError(f"study '{study}': the goal '{curved[0]}' runs along an axis; allocation needs one number")
    return wanted


@dataclass(frozen=True, kw_only=True)
class Allotted:
    """What the rule chose, step by step, and the least cost beside it; without grades both are the widths bought.

    ``start`` and ``final`` are first-order probabilities by check; ``tolerances`` what the rule ends with, grades and
    widths as an inputs file states them, ``texts[design]`` that of each;
    ``monte_carlo["start" | "rule" | "least"][check]`` the probabilities on the exact model.
    ``priced[design]`` are its limits on the price; ``inputs`` those of the run, as effects leave them.
    """

    name: str = "allocation"
    finest: str
    problem: AllocationProblem
    steps: tuple[Step, ...]
    rule: AllocationPlan
    least: AllocationPlan
    coefficients: Mapping[str, float]
    sampled: Mapping[str, Tally]
    texts: Mapping[str, Mapping[str, str]]
    priced: Mapping[str, tuple[Check, ...]]
    remarks: tuple[str, ...]
    inputs: Any
    widths: Mapping[str, str] = field(default_factory=dict)
    """The units in which widths are printed, where these are not those of their prices."""

    def printed_in(self, unit_of: Callable[[str, str], str]) -> Allotted:
        """Return the same, printed in other units."""
        own = {variable.name: variable.price.width for variable in self.problem.variables.values()}
        return replace(self, widths={name: unit_of(name, unit) for name, unit in own.items()})

    @property
    def reached(self) -> bool:
        """Whether the rule meets every goal, to first order."""
        return self.rule.reached

    @property
    def adjustments(self) -> int:
        """How many steps the rule took."""
        return len(self.steps)

    @property
    def start(self) -> dict[str, float]:
        """The first-order probabilities before the first step."""
        return self.problem.chances({})

    @property
    def final(self) -> Mapping[str, float]:
        """The first-order probabilities after the last step."""
        return self.rule.chances

    @property
    def tolerances(self) -> Mapping[str, str]:
        """The grades that the rule ends with, and the widths bought, as an inputs file states them."""
        return self.texts["rule"]

    @property
    def cost(self) -> float:
        """The cost of these tolerances, in ``problem.unit``."""
        return self.rule.cost

    @property
    def least_cost(self) -> AllocationPlan:
        """The least-cost choice among the same grades and widths."""
        return self.least

    @property
    def least_steps(self) -> int:
        """How many grades the least-cost choice lies away from the start."""
        start = self.problem.start
        return sum(abs(GRADES.index(grade) - GRADES.index(start[name])) for name, grade in self.least.grades.items())

    @property
    def monte_carlo(self) -> dict[str, dict[str, float]]:
        """The probabilities on the exact model, by design and check."""
        return {key: tally.shares for key, tally in self.sampled.items()}

    @property
    def spoken(self) -> dict[str, tuple[str, AllocationPlan]]:
        """The designs that were adjusted, by key: what they are called, and the plan. Without grades there is one."""
        if not self.problem.parts:
            return {"least": ("the widths of least cost", self.least)}
        what = "tolerances" if self.problem.variables else "grades"
        return {"rule": (f"the rule's {what}", self.rule), "least": (f"the least-cost {what}", self.least)}

    def as_json(self) -> dict[str, Any]:
        """Return steps, tolerances, cost and whether the goals are reached, of the rule and of the least cost."""
        return {
            "steps": [
                {
                    "number": step.number,
                    "tolerance": step.tolerance,
                    "from": step.before,
                    "to": step.after,
                    "width": {
                        "from": printed(step.width_before, "mm"),
                        "to": printed(step.width_after, "mm"),
                        "unit": "mm",
                    },
                    "probabilities": dict(step.chances),
                }
                for step in self.steps
            ],
            **_design(self, self.rule, "rule"),
            "adjustments": self.adjustments,
            "start": _design(self, replace(as_it_stands(self.problem), status=""), "start"),
            "coefficients": {name: as_number(value) for name, value in self.coefficients.items()},
            "finest": self.finest,
            "least_cost": {"steps": self.least_steps, **_design(self, self.least, "least")},
        }

    def blocks(self) -> Sequence[Block]:
        """Return the steps, rule against least cost, and the probabilities along the synthesis."""
        blocks: list[Block] = []
        if not self.reached:
            far = " and ".join(f"{spoken(name)} {100 * value:.2f} %" for name, value in self.final.items())
            blocks.append(Words(f"The goal is {self.rule.status}. It comes to {far}.", "finding"))
        if self.problem.parts:
            blocks.append(_steps(self))
        blocks.append(_comparison(self))
        if self.problem.parts:
            blocks.append(_grades(self))
        if self.problem.variables:
            blocks += [_widths(self, what, plan) for what, plan in self.spoken.values()]
        if self.steps:
            blocks.append(Drawing("Probability along the synthesis", _drawn(self)))
        return blocks

    def checks(self) -> Sequence[Check]:
        """Compare the probability of the tolerances in force with each goal."""
        return goal_checks(self.problem.demands, self.monte_carlo["start"], self.sampled["start"])

    def proposals(self) -> Sequence[Proposal]:
        """Propose the rule's tolerances and those of least cost, where they are others than those in force."""
        stated = self.texts["start"]
        proposals = []
        for key, (what, _) in self.spoken.items():
            texts = self.texts[key]
            changes = tuple((name, stated[name], text) for name, text in texts.items() if text != stated[name])
            if changes:
                kept = goal_checks(self.problem.demands, self.monte_carlo[key], self.sampled[key])
                proposals.append(Proposal(self.name, what, changes, (*kept, *self.priced[key])))
        return proposals

    def warnings(self) -> Sequence[str]:
        """Say what cannot be reached, and where the exact model contradicts first order."""
        return [f"study '{self.name}': {text}" for text in (*self.remarks, *self._doubts())]

    def _doubts(self) -> Iterator[str]:
        if not self.reached:
            far = ", ".join(
                f"'{demand.name}' comes to {self.final[demand.name]:.4f} of {demand.goal:g}"
                for demand in self.problem.goals
                if self.final[demand.name] < (demand.goal or 0.0)
            )
            yield f"the goal is {self.rule.status}; {far}"
        for key, (what, plan) in self.spoken.items():
            if plan.residual is not None and plan.residual > BALANCED_TO:
                yield f"{what} are no proven minimum of the cost: {plan.residual:.2g} of its gradient is not balanced"
            tally = self.sampled.get(key)
            if tally is None:
                continue
            if tally.failed:
                yield f"with {what} {tally.lost}"
            for demand in self.problem.goals if plan.reached else ():
                low, high = tally.intervals[demand.name]
                if demand.goal is not None and high < demand.goal:
                    yield (
                        f"with {what} the exact model gives '{demand.name}' only {low:.4f} to {high:.4f} of "
                        f"{demand.goal:g}"
                    )


# How the outcome of an allocation is written: results.json and the sheet


def _design(allotted: Allotted, plan: AllocationPlan, key: str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "tolerances": dict(allotted.texts[key]),
        "cost": {"value": plan.cost, "unit": allotted.problem.unit},
        "reached": plan.reached,
        "probabilities": dict(plan.chances),
    }
    if plan.status:
        entry["status"] = plan.status
    if allotted.problem.variables:
        entry["widths"] = {variable.name: _width(variable, plan) for variable in allotted.problem.variables.values()}
    tally = allotted.sampled[key]
    counted = {"draws": tally.draws, "failed": tally.failed}
    entry["monte_carlo"] = {
        name: {"probability": share, "interval95": list(tally.intervals[name]), **counted}
        for name, share in tally.shares.items()
    }
    return entry


def _width(variable: ToleranceVariable, plan: AllocationPlan) -> dict[str, Any]:
    start, width, unit = variable.start, plan.widths.get(variable.name, variable.start), variable.price.width
    price = {"from": variable.cost(start), "to": variable.cost(width), "unit": variable.price.unit}
    return {"from": printed_step(start, unit), "to": printed_step(width, unit), "unit": unit, "price": price}


def _steps(allotted: Allotted) -> Table:
    names = list(allotted.start)
    rows: list[list[Any]] = [[0, "start", None, None, None, *(100 * value for value in allotted.start.values())]]
    for step in allotted.steps:
        grades = f"{step.before} to {step.after}"
        widths = (printed(step.width_before, "mm"), printed(step.width_after, "mm"))
        rows.append([step.number, step.tolerance, grades, *widths, *(100 * step.chances[name] for name in names)])
    columns = ("step", "tolerance", "grade", "width before", "width after", *names)
    units = ("", "", "", "mm", "mm", *("%" for _ in names))
    return Table("Synthesis grade by grade", columns, rows, units, "First-order probabilities after each step.")


def _comparison(allotted: Allotted) -> Table:
    names = list(allotted.start)
    problem = allotted.problem
    designs = [
        ("start", "start", as_it_stands(problem), 0),
        ("rule", "rule", allotted.rule, allotted.adjustments),
        ("least", "least cost", allotted.least, allotted.least_steps),
    ]
    rows: list[list[Any]] = []
    for key, title, plan, steps in designs:
        sampled = allotted.monte_carlo[key]
        chances = [100 * chance for name in names for chance in (plan.chances[name], sampled[name])]
        if problem.parts:
            rows.append([title, steps, plan.cost, *chances, plan.reached])
        elif key != "rule":
            rows.append([title, plan.cost, *chances, plan.reached])
    pairs = [column for name in names for column in (name, "Monte Carlo")]
    unit = problem.unit
    note = (
        "Cost: the sum of the prices of the tolerances, each paid once however many inputs it is on."
        if problem.priced
        else "Cost: the sum of 1/width over the tolerances, the reciprocal law; not every one has a price."
    )
    tallies = allotted.sampled.values()
    half = max((high - low) / 2 for tally in tallies for low, high in tally.intervals.values())
    note += (
        f" First order beside {max(tally.draws for tally in tallies)} machines of each design on the exact model, 95 % "
        f"intervals within ±{100 * half:.2g} percentage points."
    )
    counted = ("grades",) if problem.parts else ()
    columns = ("design", *counted, "cost", *pairs, "reached")
    units = ("", *("" for _ in counted), unit, *("%" for _ in pairs), "")
    title = "Rule against least cost" if problem.parts else "In force and at least cost"
    return Table(title, columns, rows, units, note)


def _grades(allotted: Allotted) -> Table:
    start, rule, least = allotted.problem.start, allotted.rule.grades, allotted.least.grades
    rows = [
        [name, as_number(coefficient), start[name], rule[name], least[name]]
        for name, coefficient in sorted(allotted.coefficients.items(), key=lambda pair: pair[1])
    ]
    return Table("Grades", ("tolerance", "coefficient", "start", "rule", "least cost"), rows)


def _widths(allotted: Allotted, what: str, plan: AllocationPlan) -> Table:
    """Say what became of every width that has a price."""
    rows: list[list[Any]] = []
    for variable in allotted.problem.variables.values():
        width = plan.widths.get(variable.name, variable.start)
        ends = {variable.low: "tightest", variable.high: "widest"}
        at_end = next((word for end, word in ends.items() if abs(width / end - 1) < 1e-6), "")
        printed = allotted.widths.get(variable.name, variable.price.width)
        pair = [printed_step(size, printed) for size in (variable.start, width)]
        prices = [variable.cost(variable.start), variable.cost(width)]
        rows.append([variable.name, unit_text(printed), *pair, width / variable.start, *prices, at_end])
    unit = allotted.problem.unit
    columns = ("tolerance", "unit", "in force", "bought", "times", "price in force", "price", "at the end")
    note = "Full widths. Those at an end would go further if tightest and widest allowed it."
    return Table(what[:1].upper() + what[1:], columns, rows, ("", "", "", "", "", unit, unit, ""), note)


def _drawn(allotted: Allotted) -> Any:
    names = list(allotted.start)
    series = {name: [allotted.start[name], *(step.chances[name] for step in allotted.steps)] for name in names}
    goals = {demand.name: demand.goal for demand in allotted.problem.demands if demand.goal is not None}
    return lines(range(len(allotted.steps) + 1), series, ("step", "probability"), goals)


# What may be chosen: what each grade, or any width, of each tolerance does to scatter and mean, and what it costs


RECIPROCAL = "1/mm"
COMPLEX_STEP = 1e-30
GradesAndWidths = Mapping[str, str | float]
"""Tolerances by name: a grade, or a full width in SI. What is not named is as in force."""


@dataclass(frozen=True)
class GradedTolerance:
    """A tolerance that is a grade: the grade it starts at, and what every grade does that it may take, finest first.

    By grade: full widths (m), costs, first-order variances by demand (SI), and standard deviations by input (SI).
    """

    start: str
    widths: Mapping[str, float]
    costs: Mapping[str, float]
    variances: Mapping[str, Mapping[str, float]]
    sds: Mapping[str, Mapping[str, float]]

    def cost(self, grade: str) -> float:
        """Return what a grade costs."""
        return self.costs[grade]

    def added(self, demand: str, grade: str) -> float:
        """Return what a grade adds to the fixed variance of a demand's response."""
        return self.variances[grade][demand]

    def factor(self, column: str, grade: str) -> float:
        """Return the standard deviation of an input with a grade over that with the grade of the start."""
        return self.sds[grade][column] / self.sds[self.start][column]


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

    def cost(self, width: float) -> float:
        """Return what a full width costs."""
        return self.price.at(width)

    def variance(self, demand: str, width: float) -> float:
        """Return the first-order variance that a width gives to a demand's response."""
        return self.variances[demand] * (width / self.start) ** 2

    def added(self, demand: str, width: float) -> float:
        """Return what a width adds to the variance with the width in force."""
        return self.variance(demand, width) - self.variances[demand]

    def factor(self, column: str, width: float) -> float:
        """Return the standard deviation of an input with a width over that with the width in force."""
        return width / self.start


@dataclass(frozen=True)
class SharedVariance:
    """What two correlated inputs, each of one tolerance, add together to the variance by demand, as in force (SI).

    It goes with the product of their standard deviations.
    """

    columns: tuple[str, str]
    owners: tuple[str, str]
    variances: Mapping[str, float]


@dataclass(frozen=True)
class AllocationProblem:
    """All parts whose grade may be chosen, tolerances whose width may be, what stays as it is, and the goals to reach.

    ``fixed`` is the variance that no grade makes alone, with what is in force. ``span`` is that of the widths over
    those in force. ``shared`` is what correlated inputs add together, where a tolerance of theirs may be chosen.
    """

    parts: Mapping[str, GradedTolerance]
    variables: Mapping[str, ToleranceVariable]
    demands: tuple[Demand, ...]
    means: Mapping[str, float]
    fixed: Mapping[str, float]
    unit: str
    priced: bool
    span: tuple[float, float]
    shared: tuple[SharedVariance, ...] = ()
    starts: int = STARTS

    @property
    def tolerances(self) -> dict[str, Any]:
        """All tolerances that may be chosen, grades first."""
        return {**self.parts, **self.variables}

    @property
    def goals(self) -> tuple[Demand, ...]:
        """The demands with a probability to reach."""
        return tuple(demand for demand in self.demands if demand.goal is not None)

    @property
    def start(self) -> dict[str, str]:
        """The grades before anything is adjusted."""
        return {name: part.start for name, part in self.parts.items()}

    def variance(self, name: str, chosen: GradesAndWidths) -> float:
        """Return the first-order variance of a demand's response with these tolerances."""
        added: float = sum(own.added(name, chosen.get(key, own.start)) for key, own in self.tolerances.items())
        together = sum(pair.variances[name] * (self.factor(pair, chosen) - 1) for pair in self.shared)
        return max(0.0, self.fixed[name] + added + together)

    def factor(self, pair: SharedVariance, chosen: GradesAndWidths) -> float:
        """Return what two inputs share with these tolerances over what they share as in force."""
        factor = 1.0
        for column, owner in zip(pair.columns, pair.owners, strict=True):
            own = self.tolerances.get(owner)
            factor *= 1.0 if own is None else own.factor(column, chosen.get(owner, own.start))
        return factor

    def half_slope(self, name: str, variable: str, chosen: GradesAndWidths) -> float:
        """Return half of the derivative of a demand's variance by the logarithm of a width."""
        own = self.variables[variable].variance(name, float(chosen[variable]))
        times = ((pair, pair.owners.count(variable) / 2) for pair in self.shared)
        return own + sum(count * pair.variances[name] * self.factor(pair, chosen) for pair, count in times)

    def mean(self, name: str, chosen: GradesAndWidths) -> float:
        """Return the first-order mean of a demand's response with these tolerances."""
        moved = ((own, chosen.get(key, own.start)) for key, own in self.variables.items())
        return self.means[name] + sum(own.pulls[name] * (float(width) - own.start) for own, width in moved)

    def chances(self, chosen: GradesAndWidths) -> dict[str, float]:
        """Return the first-order probability of every demand with these tolerances."""
        chances = {}
        for demand in self.demands:
            mean, variance = self.mean(demand.name, chosen), self.variance(demand.name, chosen)
            chances[demand.name] = normal_chance(mean, variance**0.5, demand.low, demand.high)
        return chances

    def cost(self, chosen: GradesAndWidths) -> float:
        """Return the sum of what these tolerances cost."""
        cost: float = sum(own.cost(chosen.get(key, own.start)) for key, own in self.tolerances.items())
        return cost

    def reached(self, chosen: GradesAndWidths) -> bool:
        """Say whether every goal is met to first order."""
        chances = self.chances(chosen)
        return all(chances[demand.name] >= demand.goal for demand in self.goals if demand.goal is not None)


def open_problem(
    scatter: Scatter, wanted: Sequence[Demand], straight: Mapping[str, Straight], study: Allocation
) -> AllocationProblem:
    """Collect parts, grades, widths and costs. Raises UsageError where no tolerance in force is a grade or has a price.

    Widths can be bought only where every grade has a price too; otherwise they stay.
    """
    setup = scatter.setup
    tolerances = setup.model.tolerances.values()
    graded = [tolerance for tolerance in tolerances if isinstance(setup.spread_of(tolerance.name), Grade)]
    prices = [price_of(setup, tolerance) for tolerance in graded]
    priced = bool(prices) and None not in prices
    span = (study.tightest, study.widest)
    buyable = priced_widths(setup) if priced or not graded else ()
    variables = {tolerance.name: _variable(setup, tolerance, straight, span) for tolerance in buyable}
    if not graded and not variables:
        raise UsageError(
            f'{setup.model.name} has no tolerance that is a grade, such as grade("IT7"), and none with a price whose '
            "width could be chosen: nothing to allocate"
        )
    parts = {tolerance.name: _graded(setup, tolerance, straight, study, priced=priced) for tolerance in graded}
    shared = tuple(_shared(scatter, straight, {**parts, **variables}))
    least = -inf if shared else 0.0  # correlated inputs may take from the variance
    fixed, means = {}, {}
    for name, line in straight.items():
        of_parts = sum(part.added(name, part.start) for part in parts.values())
        fixed[name], means[name] = max(least, float(line.variance) - of_parts), float(line.mean)
    units = [price.unit for price in (*prices, *(own.price for own in variables.values())) if price is not None]
    known = priced or bool(variables)
    unit = units[0] if known else RECIPROCAL
    return AllocationProblem(parts, variables, tuple(wanted), means, fixed, unit, known, span, shared, study.starts)


def _shared(scatter: Scatter, straight: Mapping[str, Straight], chosen: Collection[str]) -> Iterator[SharedVariance]:
    """Give what correlated inputs add together, of those of which a tolerance may be chosen."""
    owners = {column: cause.name for cause in scatter.causes for column in cause.columns}
    for pair in scatter.pairs:
        columns, own = (pair.first, pair.second), (owners[pair.first], owners[pair.second])
        if {*own} & {*chosen}:
            variances = {
                name: 2 * float(line.slopes[pair.first]) * float(line.slopes[pair.second]) * pair.covariance
                for name, line in straight.items()
            }
            yield SharedVariance(columns, own, variances)


def _graded(
    setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], study: Allocation, *, priced: bool
) -> GradedTolerance:
    """Return what every grade of a part does; ISO 286 does not have all of them for every size.

    Without prices a full width costs its reciprocal, in 1/mm. Source of the law: K. W. Chase, A. R. Parkinson, survey
    of cost-tolerance models, Res. Eng. Des. 3 (1991) 23.
    """
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance) if priced else None
    assert isinstance(spread, Grade)  # open_problem has chosen these
    start = GRADES.index(spread.grade)
    widths, costs, variances, deviations = {}, {}, {}, {}
    for grade in GRADES[min(GRADES.index(study.finest), start) : len(GRADES) if study.loosen else start + 1]:
        own = replace(spread, grade=grade)
        try:
            width = own.width(setup.target(tolerance.on[0]))
            sds = {column: own.resolve(setup.target(column)).sd for column in tolerance.on}
        except TruingError:
            if own == spread:
                raise
            continue
        widths[grade], variances[grade], deviations[grade] = width, _variances(straight, sds), sds
        costs[grade] = 1e-3 / width if price is None else price.at(width)
    return GradedTolerance(spread.grade, widths, costs, variances, deviations)


def _variances(straight: Mapping[str, Straight], sds: Mapping[str, float]) -> dict[str, float]:
    return {
        name: sum((float(line.slopes[column]) * sd) ** 2 for column, sd in sds.items())
        for name, line in straight.items()
    }


def priced_widths(setup: Setup) -> Iterator[Tolerance]:
    """Yield the tolerances in force with a price that are no grades and whose width can be chosen."""
    in_force = setup.distributions()
    for tolerance in setup.model.tolerances.values():
        inner = in_force.get(tolerance.name)
        chosen = isinstance(setup.spread_of(tolerance.name), (Band, Zone)) and price_of(setup, tolerance) is not None
        if chosen and inner is not None and all(target.sd > 0 for target in inner.values()):
            yield tolerance


def _variable(
    setup: Setup, tolerance: Tolerance, straight: Mapping[str, Straight], span: tuple[float, float]
) -> ToleranceVariable:
    price, inner = price_of(setup, tolerance), setup.distributions()[tolerance.name]
    width, pull = next(iter(inner.values())).width, shift_per_width(setup.spread_of(tolerance.name))
    assert price is not None  # priced_widths has chosen these
    variances = _variances(straight, {column: distribution.sd for column, distribution in inner.items()})
    pulls = {name: pull * sum(float(line.slopes[column]) for column in inner) for name, line in straight.items()}
    return ToleranceVariable(tolerance.name, width, span[0] * width, span[1] * width, price, variances, pulls)


# Which grades? The paper's rule, one grade at a time, and the least cost there is, by mixed-integer programming


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
    """A choice of tolerances, what they cost, first-order chances, and whether all goals are reached.

    ``chosen`` holds grades and the full widths (SI) that were bought, by tolerance. ``residual`` says how far the
    widths are from a minimum of the cost: 0 is one; None where none were found.
    """

    chosen: GradesAndWidths
    cost: float
    chances: Mapping[str, float]
    reached: bool
    status: str
    residual: float | None

    @property
    def grades(self) -> dict[str, str]:
        """The grades by tolerance."""
        return {name: choice for name, choice in self.chosen.items() if isinstance(choice, str)}

    @property
    def widths(self) -> dict[str, float]:
        """The full widths (SI) that were bought."""
        return {name: choice for name, choice in self.chosen.items() if not isinstance(choice, str)}


def coefficients(
    problem: AllocationProblem, slopes: Mapping[str, float], weights: tuple[float, float]
) -> dict[str, float]:
    """Return the adjustment coefficient of every part: small is tightened first.

    r = (P1 x + P2 c)/(P1 + P2), with x the sensitivity of the most sensitive part over that of this one and c the cost
    of this part's tolerance over that of the most sensitive one's. ``slopes`` are the summed absolute derivatives.
    """
    reference = max(problem.parts, key=lambda name: slopes[name])
    first, second = weights
    weighed: dict[str, float] = {}
    for name, part in problem.parts.items():
        ratio = slopes[reference] / slopes[name] if slopes[name] else float("inf")
        cost = part.cost(part.start) / problem.parts[reference].cost(problem.parts[reference].start)
        weighed[name] = (first * ratio + second * cost) / (first + second) if first else cost
    return weighed


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
        widths = (problem.parts[name].widths[before], problem.parts[name].widths[after])
        steps.append(Step(len(steps) + 1, name, before, after, *widths, problem.chances(grades)))
    return steps, _plan(problem, grades, f"every tolerance is at {finest}")


def as_it_stands(problem: AllocationProblem) -> AllocationPlan:
    """Return the design before anything is adjusted."""
    return _plan(problem, problem.start, "nothing is adjusted")


def _plan(
    problem: AllocationProblem, chosen: GradesAndWidths, shortfall: str, *, residual: float | None = 0.0
) -> AllocationPlan:
    reached = problem.reached(chosen)
    status = "reached" if reached else f"not reachable: {shortfall}"
    return AllocationPlan(chosen, problem.cost(chosen), problem.chances(chosen), reached, status, residual)


@lru_cache(maxsize=1024)
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
    log_sd: float = optimize.brentq(short, -1.5, 12.0, xtol=1e-15, rtol=1e-14)
    return float((reach * 10.0**log_sd) ** 2)


def least_cost(problem: AllocationProblem) -> AllocationPlan:
    """Choose one grade for every part so that all goals are met to first order at the least cost there is."""
    bounds: dict[str, float] = {}
    for demand in problem.goals:
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
    grades = {name: min(part.widths, key=GRADES.index) for name, part in problem.parts.items()}
    return _plan(problem, grades, reason)


def _solve(problem: AllocationProblem, bounds: Mapping[str, float], margin: float) -> dict[str, str] | None:
    """Solve the choice of grades as a mixed-integer linear program; None where no choice meets the bounds.

    Two parts whose inputs are correlated add a product of two choices to the variance. It is made linear by a variable
    for each two grades, 1 where both are chosen: over the grades of one part they sum up to the choice of the other.
    Source: W. P. Adams, H. D. Sherali, Manage. Sci. 32 (1986) 1274.
    """
    choices = [(name, part, grade) for name, part in problem.parts.items() for grade in part.widths]
    costs = np.array([part.cost(grade) for _, part, grade in choices])
    together = _Together.of(problem, [(name, grade) for name, _, grade in choices])
    one_each = np.array([[float(name == part) for name, *_ in choices] for part in problem.parts])
    constraints: list[Any] = [optimize.LinearConstraint(np.pad(one_each, ((0, 0), (0, together.size))), 1.0, 1.0)]
    if together.size:
        constraints.append(optimize.LinearConstraint(together.products(), 0.0, 0.0))
    for demand, bound in bounds.items():
        alone, pairs, rest = together.variances(demand)
        room = bound * (1 - margin) - problem.fixed[demand] - rest
        if room <= 0 and not problem.shared:
            return None
        scale = room if room > 0 else bound
        added = np.array([part.added(demand, grade) for _, part, grade in choices]) + alone
        constraints.append(optimize.LinearConstraint(np.append(added, pairs)[None] / scale, -np.inf, room / scale))
    answer = optimize.milp(
        np.append(costs, np.zeros(together.size)) / np.abs(costs).max(),
        integrality=np.append(np.ones(len(choices)), np.zeros(together.size)).astype(np.int64),
        bounds=optimize.Bounds(0, 1),
        constraints=constraints,
        options={"mip_rel_gap": 0.0},
    )
    if answer.x is None:
        return None
    return {name: grade for (name, _, grade), taken in zip(choices, answer.x, strict=False) if taken > 0.5}


@dataclass(frozen=True, eq=False)
class _Together:
    """The products of two choices of grades (name, grade) that a choice of grades needs, two parts at a time."""

    problem: AllocationProblem
    choices: Sequence[tuple[str, str]]
    places: Mapping[tuple[int, int], int]  # of two choices, the place of their product

    @classmethod
    def of(cls, problem: AllocationProblem, choices: Sequence[tuple[str, str]]) -> _Together:
        """Collect the parts that share a variance."""
        met = {frozenset(pair.owners) for pair in problem.shared if len({*pair.owners} & problem.parts.keys()) == 2}
        twos = [(one, other) for one, (name, _) in enumerate(choices) for other, (theirs, _) in enumerate(choices)
                if one < other and frozenset((name, theirs)) in met]  # fmt: skip
        return cls(problem, choices, {two: place for place, two in enumerate(twos)})

    @property
    def size(self) -> int:
        """How many products there are."""
        return len(self.places)

    def products(self) -> Matrix:
        """Return the equations of the products (rows, choices + products): their sum is one of the two choices."""
        rows: dict[tuple[int, str], Matrix] = {}
        for (one, other), place in self.places.items():
            for chosen, others in ((one, self.choices[other][0]), (other, self.choices[one][0])):
                row = rows.setdefault((chosen, others), np.zeros(len(self.choices) + self.size))
                row[chosen], row[len(self.choices) + place] = -1.0, 1.0
        return np.array(list(rows.values()))

    def variances(self, demand: str) -> tuple[Matrix, Matrix, float]:
        """Return what the inputs share by choice, by product, and what they do not share any more as in force (SI)."""
        problem, alone, pairs, rest = self.problem, np.zeros(len(self.choices)), np.zeros(self.size), 0.0
        for pair in problem.shared:
            variance, parts = pair.variances[demand], {*pair.owners} & problem.parts.keys()
            if not parts:
                continue
            rest -= variance
            if len(parts) == 2:
                for (one, other), place in self.places.items():
                    chosen = dict((self.choices[one], self.choices[other]))
                    if parts == chosen.keys():
                        pairs[place] += variance * problem.factor(pair, chosen)
                continue
            for place, (name, grade) in enumerate(self.choices):
                if name in parts:
                    alone[place] += variance * problem.factor(pair, {name: grade})
        return alone, pairs, rest


# Which widths? The least cost under all goals, where tolerances are no grades but widths with a price


MARGINS = (0.0, 1e-10, 1e-8, 1e-6)
ROUNDING = 1e-13
FEASIBLE = 1e-9
AT_END = 1e-7
CHEAPER = 1e-9


@dataclass(frozen=True, eq=False)
class AllocationSearch:
    """The widths to choose, as logarithms over those in force, with these grades; goals in standard deviations."""

    problem: AllocationProblem
    grades: Mapping[str, str]

    def chosen(self, x: Matrix) -> dict[str, Any]:
        """Return the grades and the full widths (SI)."""
        variables = zip(self.problem.variables.items(), x, strict=True)
        return {**self.grades, **{name: float(variable.start * np.exp(log)) for (name, variable), log in variables}}

    def plan(self, x: Matrix, residual: float | None) -> AllocationPlan:
        """Return the design of a point, with how far it is from a minimum."""
        low, high = self.problem.span
        shortfall = f"no widths from {low:g} to {high:g} times those in force meet it"
        shortfall += ", and every grade is at its finest" if self.grades else ""
        return _plan(self.problem, self.chosen(x), shortfall, residual=residual)

    def ends(self) -> tuple[Matrix, Matrix]:
        """Return the smallest and the largest logarithms."""
        variables = self.problem.variables.values()
        low = np.log([variable.low / variable.start for variable in variables])
        return low, np.log([variable.high / variable.start for variable in variables])

    def cost(self, x: Matrix) -> tuple[float, Matrix]:
        """Return the price of the widths and its gradient, both over the price of those in force.

        The derivatives are exact: the formulas with an imaginary step. Source: W. Squire, G. Trapp, Using complex
        variables to estimate derivatives, SIAM Rev. 40 (1998) 110.
        """
        chosen, variables = self.chosen(x), self.problem.variables
        widths = np.array([chosen[name] for name in variables])
        turned = widths * (1 + 1j * COMPLEX_STEP)
        paid = np.array([own.price.evaluated(width) for own, width in zip(variables.values(), turned, strict=True)])
        slopes = paid.imag / (COMPLEX_STEP * widths)
        return float(paid.real.sum()) / self._whole, slopes * widths / self._whole

    @cached_property
    def _whole(self) -> float:
        """The price of the widths in force."""
        return sum(abs(variable.cost(variable.start)) for variable in self.problem.variables.values()) or 1.0

    def slack(self, x: Matrix) -> tuple[Matrix, Matrix]:
        """Return by goal how far it is kept (goals,), in standard deviations of the start, and the gradients."""
        slacks = [self._slack(demand, x) for demand in self.problem.goals]
        return np.array([value for value, _ in slacks]), np.array([gradient for _, gradient in slacks])

    def _slack(self, demand: Demand, x: Matrix) -> tuple[float, Matrix]:
        problem, name = self.problem, demand.name
        chosen = self.chosen(x)
        sd = max(problem.variance(name, chosen), 1e-300) ** 0.5
        by_mean = np.array([variable.pulls[name] * chosen[key] for key, variable in problem.variables.items()])
        by_sd = np.array([problem.half_slope(name, key, chosen) / sd for key in problem.variables])
        room, of_mean, of_sd = _room(demand, problem.mean(name, chosen), sd)
        scale = problem.variance(name, {}) ** 0.5 or 1.0
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
    largest = (largest_variance(demand, mean) or 0.0) ** 0.5
    above, below = (demand.high - mean) / largest, (demand.low - mean) / largest
    at_high, at_low = exp(-(above**2) / 2), exp(-(below**2) / 2)
    return largest - sd, -(at_high - at_low) / (above * at_high - below * at_low), -1.0


def bought(problem: AllocationProblem, plan: AllocationPlan) -> AllocationPlan:
    """Return the plan with the widths that meet all goals at the least cost; where none do, those that come nearest."""
    if not problem.variables or any(demand.goal is not None and demand.goal >= 1.0 for demand in problem.demands):
        return plan
    search = AllocationSearch(problem, plan.grades)
    starts = list(islice(_starts(search), problem.starts))
    with one_thread():
        optimum = _cheapest(search, starts)
        if optimum is None:
            nearest = _nearest(search, starts)
            optimum = _cheapest(search, [nearest])
    return search.plan(nearest, None) if optimum is None else search.plan(optimum, _residual(search, optimum))


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
        offered = list(part.widths)
        index = offered.index(plan.grades[name])
        for grade in offered[max(index - 1, 0) : index] + offered[index + 1 : index + 2]:
            search = AllocationSearch(problem, {**plan.grades, name: grade})
            held = [np.log(plan.widths[key] / variable.start) for key, variable in problem.variables.items()]
            low, high = search.ends()
            optimum = _cheapest(search, [np.clip(held, low, high), low])
            if optimum is not None:
                yield search.plan(optimum, _residual(search, optimum))


def _starts(search: AllocationSearch) -> Iterator[Matrix]:
    """Yield the widths in force, the narrowest, the widest, those between, then some by chance, without end."""
    low, high = search.ends()
    yield np.clip(np.zeros(len(low)), low, high)
    yield from (low, high, (low + high) / 2)
    rng = np.random.default_rng(0)
    while True:
        yield rng.uniform(low, high)


def _cheapest(search: AllocationSearch, starts: Sequence[Matrix]) -> Matrix | None:
    """Return the least cost that was found; goals are held a little off until they are met exactly."""
    for margin in MARGINS:
        ends = [end for start in starts if (end := _descended(search, start, margin)) is not None]
        if not ends:
            return None
        best = _exact(search, min(ends, key=lambda x: search.cost(x)[0]))
        if search.problem.reached(search.chosen(best)):
            return best
    return None


def _exact(search: AllocationSearch, x: Matrix) -> Matrix:
    """Take the last rounding out of the goals that are just missed, by the shortest way."""
    for _ in range(4):
        if search.problem.reached(search.chosen(x)):
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
    points = list(starts)
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
        points += [] if y is None else [y[:-1]]
    return max(points, key=lambda x: float(search.slack(x)[0].min()))


def _solved(objective: Any, start: Matrix, ends: tuple[Matrix, Matrix], constraint: Any) -> Matrix | None:
    """Return where SLSQP ends, inside the bounds; None where it loses itself."""
    held: Any = {"type": "ineq", **constraint}
    options: Any = {"ftol": 1e-13, "maxiter": 300}
    answer = optimize.minimize(
        objective, start, jac=True, method="SLSQP", bounds=optimize.Bounds(*ends), constraints=held, options=options
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
    forces += [unit[index] for index in np.flatnonzero(x <= low + AT_END)]
    forces += [-unit[index] for index in np.flatnonzero(x >= high - AT_END)]
    gradient = search.cost(x)[1]
    size = float(np.linalg.norm(gradient))
    if not size:
        return 0.0
    left = float(optimize.nnls(np.array(forces).T, gradient)[1]) if forces else size
    return left / size
