"""Which tolerance do I buy? Grades by the rule of the paper and by least cost; widths with a price at least cost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.evaluate import acting_inputs
from truing.fits import GRADES
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.bench import Bench
from truing.studies.chances import straightened
from truing.studies.checks import Check, Proposal, chance_check, plain_checks
from truing.studies.demands import Demand, as_number, demands, nominal_inputs, wilson
from truing.studies.differences import slopes
from truing.studies.drawings import lines
from truing.studies.grades import (
    AllocationProblem,
    ToleranceVariable,
    open_problem,
    priced_widths,
    with_grades,
    with_widths,
)
from truing.studies.reading import printed_step, spoken
from truing.studies.sampling import Machines, SampleBudget, Tally, sample
from truing.studies.scatter import scatter_of
from truing.studies.synthesis import (
    AllocationPlan,
    Step,
    as_it_stands,
    bettered,
    bought,
    by_rule,
    coefficients,
    least_cost,
)
from truing.units import from_si, unit_text

BALANCED_TO = 1e-4


@dataclass(frozen=True, kw_only=True)
class Allocation:
    """Buy tolerances until every Require with a reliability is met: ISO 286 grades, and widths that have a price.

    ``balanced`` is the rule of precision balance: the coarsest grades first, among them the part whose coefficient of
    sensitivity and cost is smallest, never finer than ``finest``. ``of`` names the result whose sensitivities order the
    parts (empty: that of the first goal). ``weights`` are those of sensitivity and cost. ``loosen`` lets the least-cost
    solution take coarser grades than those of the start. A tolerance that is no grade but has a price is a width
    between ``tightest`` and ``widest`` times the one in force; with the grades of a design chosen, its widths are those
    of least cost. All designs are verified by ``draws`` machines on the exact model.
    """

    rule: Literal["balanced"] = "balanced"
    of: str = ""
    finest: str = "IT5"
    weights: tuple[float, float] = (1.0, 1.0)
    loosen: bool = False
    tightest: float = 0.25
    widest: float = 4.0
    draws: int = 100_000
    batch: int = 2**14
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
        if self.draws < 1 or self.batch < 1:
            raise UsageError("draws and batch are at least 1")

    def run(self, bench: Bench) -> Allotted:
        """Allocate by the rule and by least cost, and verify both. Raises UsageError without a grade or a goal."""
        setup = bench.setup
        wanted = _goals(setup, bench.answers, self.name)
        machines = Machines(setup, scatter_of(setup))
        straight, found = straightened(machines, wanted, nominal_inputs(setup, wanted))
        problem = open_problem(
            setup, wanted, straight, self.finest, loosen=self.loosen, span=(self.tightest, self.widest)
        )
        order = coefficients(problem, self._slopes(machines, wanted, problem), self.weights) if problem.parts else {}
        steps, ruled = by_rule(problem, order, self.finest) if problem.parts else ([], as_it_stands(problem))
        rule = bought(problem, ruled)
        least = _least(problem, ruled, rule)
        designs = {"start": as_it_stands(problem), "rule": rule, "least": least}
        return Allotted(
            name=self.name,
            finest=self.finest,
            problem=problem,
            steps=tuple(steps),
            rule=rule,
            least=least,
            coefficients=order,
            sampled=self._verified(bench, wanted, designs),
            texts={key: _texts(setup, problem, plan) for key, plan in designs.items()},
            priced={key: _price_checks(setup, plan) for key, plan in designs.items()},
            remarks=(*found.warnings, *_left_alone(setup, problem)),
            inputs=acting_inputs(setup),
        )

    def _slopes(self, machines: Machines, wanted: Sequence[Demand], problem: AllocationProblem) -> dict[str, float]:
        """Return by part the sum of the absolute derivatives of the ordering result."""
        of = self.of or wanted[0].result
        known = machines.setup.model.own_result_fields
        if of not in known:
            raise UsageError(f"study '{self.name}': there is no result '{of}'.{near_miss(of, known)}")
        tolerances = machines.setup.model.tolerances
        columns = tuple(dict.fromkeys(column for name in problem.parts for column in tolerances[name].on))
        found = slopes(machines.setup, (of,), columns, machines.scatter).of[of]
        return {name: sum(abs(float(found[column])) for column in tolerances[name].on) for name in problem.parts}

    def _verified(
        self, bench: Bench, wanted: Sequence[Demand], designs: Mapping[str, AllocationPlan]
    ) -> dict[str, Tally]:
        """Draw the same machines for every design; equal designs are drawn once."""
        found: dict[str, Tally] = {}
        for stage, (key, plan) in enumerate(designs.items()):
            twin = next((other for other in found if designs[other].same_as(plan)), None)
            if twin is not None:
                found[key] = found[twin]
                continue
            setup = with_plan(bench.setup, plan)

            def done(draws: int, total: int, stage: int = stage) -> None:
                bench.progress(self.name, stage * total + draws, len(designs) * total)

            budget = SampleBudget(self.draws, self.batch, bench.executor, done)
            found[key] = sample(Machines(setup, scatter_of(setup)), wanted, bench.answers, budget)
        return found


def with_plan(setup: Setup, plan: AllocationPlan) -> Setup:
    """Return the setup with the grades and widths of a plan."""
    return with_widths(with_grades(setup, plan.grades), plan.widths)


def _least(problem: AllocationProblem, ruled: AllocationPlan, rule: AllocationPlan) -> AllocationPlan:
    """Return the cheapest design. With widths too it is sought by steps of one grade from three choices of grades."""
    if not problem.parts:
        return rule
    if not problem.variables:
        return least_cost(problem)
    found = [bought(problem, least_cost(problem)), rule]
    if ruled.grades != problem.start:
        found.append(bought(problem, as_it_stands(problem)))
    return min((bettered(problem, plan) for plan in found), key=lambda plan: (not plan.reached, plan.cost))


def _texts(setup: Setup, problem: AllocationProblem, plan: AllocationPlan) -> dict[str, str]:
    """Return by tolerance what an inputs file would say of this design."""
    chosen = with_plan(setup, plan)
    return {name: chosen.spread_of(name).text for name in (*problem.parts, *problem.variables)}


def _price_checks(setup: Setup, plan: AllocationPlan) -> tuple[Check, ...]:
    """Return the limits on the price of all tolerances, with those of a plan."""
    chosen = with_plan(setup, plan)
    return tuple(plain_checks(chosen, price_answers(chosen)))


def _left_alone(setup: Setup, problem: AllocationProblem) -> list[str]:
    """Say which widths with a price were not chosen, since the grades beside them have none."""
    names = [f"'{item.name}'" for item in priced_widths(setup) if item.name not in problem.variables]
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
    sampled: Mapping[str, Tally] = field(default_factory=dict)
    texts: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    priced: Mapping[str, tuple[Check, ...]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    inputs: Any = None

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
        return self.problem.chances(self.problem.start)

    @property
    def final(self) -> Mapping[str, float]:
        """The first-order probabilities after the last step."""
        return self.rule.chances

    @property
    def tolerances(self) -> Mapping[str, str]:
        """The grades that the rule ends with, and the widths bought, as an inputs file states them."""
        return self.texts.get("rule", self.rule.grades)

    @property
    def cost(self) -> float:
        """The cost of these tolerances, in ``shop.unit``."""
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
        return {
            key: {name: float(hits / tally.draws) for name, hits in tally.hits.items()}
            for key, tally in self.sampled.items()
        }

    @property
    def spoken(self) -> dict[str, tuple[str, AllocationPlan]]:
        """The designs that were adjusted, by key: what they are called, and the plan. Without grades there is one."""
        if not self.problem.parts:
            return {"least": ("the widths of least cost", self.least)}
        what = "tolerances" if self.problem.variables else "grades"
        return {"rule": (f"the rule's {what}", self.rule), "least": (f"the least-cost {what}", self.least)}

    def as_json(self) -> dict[str, Any]:
        """Return steps, tolerances, cost and whether the goals are reached, of the rule and of the least cost."""
        return allotted_json(self)

    def blocks(self) -> Sequence[Block]:
        """Return the steps, rule against least cost, and the probabilities along the synthesis."""
        return allotted_blocks(self)

    def checks(self) -> Sequence[Check]:
        """Compare the probability of the tolerances in force with each goal."""
        return self._kept("start", self.start)

    def proposals(self) -> Sequence[Proposal]:
        """Propose the rule's tolerances and those of least cost, where they are others than those in force."""
        stated = self.texts["start"]
        found = []
        for key, (what, plan) in self.spoken.items():
            texts = self.texts[key]
            changes = tuple((name, stated[name], text) for name, text in texts.items() if text != stated[name])
            if changes:
                found.append(Proposal(self.name, what, changes, (*self._kept(key, plan.chances), *self.priced[key])))
        return found

    def _kept(self, key: str, first_order: Mapping[str, float]) -> tuple[Check, ...]:
        """Return the check of every goal for one design: on the exact model where its machines were drawn."""
        tally = self.sampled.get(key)
        drawn = self.monte_carlo.get(key, first_order)
        method = "first order" if tally is None else f"Monte Carlo, {tally.draws} machines"
        return tuple(
            chance_check(demand.name, drawn[demand.name], demand.goal, method=method)
            for demand in self.problem.demands
            if demand.goal is not None
        )

    def warnings(self) -> Sequence[str]:
        """Say what cannot be reached, and where the exact model contradicts first order."""
        words = [f"study '{self.name}': {remark}" for remark in self.remarks]
        if not self.reached:
            missed = [demand for demand in self.problem.demands if self.final[demand.name] < (demand.goal or 0.0)]
            far = ", ".join(f"'{item.name}' comes to {self.final[item.name]:.4f} of {item.goal:g}" for item in missed)
            words.append(f"study '{self.name}': the goal is {self.rule.status}; {far}")
        for key, (what, plan) in self.spoken.items():
            if plan.residual is not None and plan.residual > BALANCED_TO:
                words.append(f"study '{self.name}': {_not_a_minimum(what, plan)}")
            tally = self.sampled.get(key)
            if tally is not None and tally.failed:
                words.append(f"study '{self.name}': {_without_answer(tally, what)}")
            if tally is not None and plan.reached:
                words += [f"study '{self.name}': {text}" for text in _contradicted(tally, self.problem.demands, what)]
        return words


def _not_a_minimum(what: str, plan: AllocationPlan) -> str:
    return f"{what} are no proven minimum of the cost: {plan.residual:.2g} of its gradient is not balanced"


def _without_answer(tally: Tally, what: str) -> str:
    """Say how many machines of a design failed."""
    reason = next(iter(tally.reasons), "no reason was given")
    return f"with {what} {tally.failed} of {tally.draws} machines have no answer and count as missed ({reason})"


def _contradicted(tally: Tally, wanted: Sequence[Demand], what: str) -> list[str]:
    """Name the goals that first order reaches and the exact model misses beyond its sampling error."""
    words = []
    for demand in wanted:
        low, high = wilson(tally.hits[demand.name], tally.draws)
        if demand.goal is not None and high < demand.goal:
            words.append(
                f"with {what} the exact model gives '{demand.name}' only {low:.4f} to {high:.4f} of {demand.goal:g}"
            )
    return words


# How the outcome of an allocation is written: results.json and the sheet


def allotted_json(allotted: Allotted) -> dict[str, Any]:
    """Return what results.json holds; widths in mm."""
    return {
        "steps": [
            {
                "number": step.number,
                "tolerance": step.tolerance,
                "from": step.before,
                "to": step.after,
                "width": {"from": _mm(step.width_before), "to": _mm(step.width_after), "unit": "mm"},
                "probabilities": dict(step.chances),
            }
            for step in allotted.steps
        ],
        **_design(allotted, allotted.rule, "rule"),
        "adjustments": allotted.adjustments,
        "start": _start(allotted),
        "coefficients": {name: as_number(value) for name, value in allotted.coefficients.items()},
        "finest": allotted.finest,
        "least_cost": {"steps": allotted.least_steps, **_design(allotted, allotted.least, "least")},
    }


def _start(allotted: Allotted) -> dict[str, Any]:
    start = allotted.problem.start
    plan = AllocationPlan(start, allotted.problem.cost(start), allotted.start, allotted.problem.reached(start))
    return _design(allotted, plan, "start")


def _design(allotted: Allotted, plan: AllocationPlan, key: str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "tolerances": dict(allotted.texts.get(key, plan.grades)),
        "cost": {"value": plan.cost, "unit": allotted.problem.unit},
        "reached": plan.reached,
        "probabilities": dict(plan.chances),
    }
    if plan.status:
        entry["status"] = plan.status
    if allotted.problem.variables:
        entry["widths"] = {variable.name: _width(variable, plan) for variable in allotted.problem.variables.values()}
    if key in allotted.sampled:
        entry["monte_carlo"] = _sampled(allotted.sampled[key])
    return entry


def _width(variable: ToleranceVariable, plan: AllocationPlan) -> dict[str, Any]:
    width = plan.widths.get(variable.name, variable.start)
    return {
        "from": printed_step(variable.start, variable.unit),
        "to": printed_step(width, variable.unit),
        "unit": variable.unit,
        "price": {"from": variable.cost(variable.start), "to": variable.cost(width), "unit": variable.price.unit},
    }


def _sampled(tally: Tally) -> dict[str, Any]:
    return {
        name: {
            "probability": float(hits / tally.draws),
            "interval95": list(wilson(hits, tally.draws)),
            "draws": tally.draws,
            "failed": tally.failed,
        }
        for name, hits in tally.hits.items()
    }


def _mm(width: float) -> float:
    return float(from_si(width, "mm"))


def allotted_blocks(allotted: Allotted) -> Sequence[Block]:
    """Return the steps, rule against least cost, and the probabilities along the synthesis."""
    blocks: list[Block] = []
    if not allotted.reached:
        far = " and ".join(f"{spoken(name)} {100 * value:.2f} %" for name, value in allotted.final.items())
        blocks.append(Words(f"The goal is {allotted.rule.status}. It comes to {far}.", "finding"))
    if allotted.problem.parts:
        blocks.append(_steps(allotted))
    blocks.append(_comparison(allotted))
    if allotted.problem.parts:
        blocks.append(_grades(allotted))
    if allotted.problem.variables:
        blocks += [_widths(allotted, what, plan) for what, plan in allotted.spoken.values()]
    if allotted.steps:
        blocks.append(Drawing("Probability along the synthesis", _drawn(allotted)))
    return blocks


def _steps(allotted: Allotted) -> Table:
    names = list(allotted.start)
    rows: list[list[Any]] = [[0, "start", None, None, None, *(100 * value for value in allotted.start.values())]]
    for step in allotted.steps:
        grades = f"{step.before} to {step.after}"
        widths = (_mm(step.width_before), _mm(step.width_after))
        rows.append([step.number, step.tolerance, grades, *widths, *(100 * step.chances[name] for name in names)])
    columns = ("step", "tolerance", "grade", "width before", "width after", *names)
    units = ("", "", "", "mm", "mm", *("%" for _ in names))
    return Table("Synthesis grade by grade", columns, rows, units, "First-order probabilities after each step.")


def _comparison(allotted: Allotted) -> Table:
    names = list(allotted.start)
    problem = allotted.problem
    start = AllocationPlan(problem.start, problem.cost(problem.start), allotted.start, problem.reached(problem.start))
    designs: Mapping[str, tuple[AllocationPlan, str, int]] = {
        "start": (start, "start", 0),
        **({"rule": (allotted.rule, "rule", allotted.adjustments)} if problem.parts else {}),
        "least cost": (allotted.least, "least", allotted.least_steps),
    }
    rows: list[list[Any]] = []
    for title, (plan, key, steps) in designs.items():
        sampled = allotted.monte_carlo.get(key, {})
        chances = [value for name in names for value in (100 * plan.chances[name], _percent(sampled.get(name)))]
        rows.append([title, *([steps] if problem.parts else []), plan.cost, *chances, plan.reached])
    pairs = [column for name in names for column in (name, "Monte Carlo")]
    unit = problem.unit
    note = (
        "Cost: the sum of the prices of the tolerances, each paid once however many inputs it is on."
        if problem.priced
        else "Cost: the sum of 1/width over the tolerances, the reciprocal law; not every one has a price."
    )
    note += f" First order beside {_drawn_words(allotted)}" if allotted.sampled else ""
    counted = ("grades",) if problem.parts else ()
    columns = ("design", *counted, "cost", *pairs, "reached")
    units = ("", *("" for _ in counted), unit, *("%" for _ in pairs), "")
    title = "Rule against least cost" if problem.parts else "In force and at least cost"
    return Table(title, columns, rows, units, note)


def _drawn_words(allotted: Allotted) -> str:
    """Say how many machines of each design were drawn, and how far their shares may be off."""
    half = max(
        (high - low) / 2
        for tally in allotted.sampled.values()
        for low, high in (wilson(hits, tally.draws) for hits in tally.hits.values())
    )
    draws = max(tally.draws for tally in allotted.sampled.values())
    within = f"95 % intervals within ±{100 * half:.2g} percentage points"
    return f"{draws} machines of each design on the exact model, {within}."


def _percent(value: float | None) -> float | None:
    return None if value is None else 100 * value


def _grades(allotted: Allotted) -> Table:
    rows = [
        [
            name,
            as_number(allotted.coefficients[name]),
            part.start,
            allotted.rule.grades[name],
            allotted.least.grades[name],
        ]
        for name, part in sorted(allotted.problem.parts.items(), key=lambda item: allotted.coefficients[item[0]])
    ]
    return Table("Grades", ("tolerance", "coefficient", "start", "rule", "least cost"), rows)


def _widths(allotted: Allotted, what: str, plan: AllocationPlan) -> Table:
    """Say what became of every width that has a price."""
    rows: list[list[Any]] = []
    for variable in allotted.problem.variables.values():
        width = plan.widths.get(variable.name, variable.start)
        ends = {variable.low: "tightest", variable.high: "widest"}
        at_end = next((word for end, word in ends.items() if abs(width / end - 1) < 1e-6), "")
        pair = [printed_step(one, variable.unit) for one in (variable.start, width)]
        prices = [variable.cost(variable.start), variable.cost(width)]
        rows.append([variable.name, unit_text(variable.unit), *pair, width / variable.start, *prices, at_end])
    unit = allotted.problem.unit
    columns = ("tolerance", "unit", "in force", "bought", "times", "price in force", "price", "at the end")
    note = "Full widths. Those at an end would go further if tightest and widest allowed it."
    return Table(what[:1].upper() + what[1:], columns, rows, ("", "", "", "", "", unit, unit, ""), note)


def _drawn(allotted: Allotted) -> Any:
    names = list(allotted.start)
    series = {name: [allotted.start[name], *(step.chances[name] for step in allotted.steps)] for name in names}
    goals = {demand.name: demand.goal for demand in allotted.problem.demands if demand.goal is not None}
    return lines(range(len(allotted.steps) + 1), series, ("step", "probability"), goals)
