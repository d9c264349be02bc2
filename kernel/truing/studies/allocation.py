"""Which tolerance do I buy? The grade-by-grade rule of the paper, and beside it the least cost there is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from truing.declare.blocks import Block
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.evaluate import acting_inputs
from truing.fits import GRADES
from truing.setup import Setup
from truing.studies.bench import Bench, Check
from truing.studies.chances import straightened
from truing.studies.checks import chance_check
from truing.studies.demands import Demand, demands, nominal_inputs, wilson
from truing.studies.differences import slopes
from truing.studies.grades import Shop, open_shop, with_grades
from truing.studies.sampling import Budget, Machines, Tally, sample
from truing.studies.scatter import scatter_of
from truing.studies.synthesis import Plan, Step, by_rule, coefficients, least_cost

ALLOTTED = "with the grades after the allocation"
GOAL_REACHED = "probability after the allocation over its goal, the smallest of all"


@dataclass(frozen=True, kw_only=True)
class Allocation:
    """Tighten ISO 286 grades until every Require with a reliability is met.

    ``balanced`` is the rule of precision balance: the coarsest grades first, among them the part whose coefficient of
    sensitivity and cost is smallest, never finer than ``finest``. ``of`` names the result whose sensitivities order the
    parts (empty: that of the first goal). ``weights`` are those of sensitivity and cost. ``loosen`` lets the least-cost
    solution take coarser grades than those of the start. Both are verified by ``draws`` machines on the exact model.
    """

    rule: Literal["balanced"] = "balanced"
    of: str = ""
    finest: str = "IT5"
    weights: tuple[float, float] = (1.0, 1.0)
    loosen: bool = False
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
        if self.draws < 1 or self.batch < 1:
            raise UsageError("draws and batch are at least 1")

    def run(self, bench: Bench) -> Allotted:
        """Allocate by the rule and by least cost, and verify both. Raises UsageError without a grade or a goal."""
        setup = bench.setup
        wanted = _goals(setup, bench.answers, self.name)
        machines = Machines(setup, scatter_of(setup))
        straight, found = straightened(machines, wanted, nominal_inputs(setup, wanted))
        shop = open_shop(setup, wanted, straight, self.finest, loosen=self.loosen)
        order = coefficients(shop, self._slopes(machines, wanted, shop), self.weights)
        steps, rule = by_rule(shop, order, self.finest)
        least = least_cost(shop)
        return Allotted(
            name=self.name,
            finest=self.finest,
            shop=shop,
            steps=tuple(steps),
            rule=rule,
            least=least,
            coefficients=order,
            sampled=self._verified(bench, wanted, {"start": shop.start, "rule": rule.grades, "least": least.grades}),
            remarks=found.warnings,
            inputs=acting_inputs(setup),
        )

    def _slopes(self, machines: Machines, wanted: Sequence[Demand], shop: Shop) -> dict[str, float]:
        """Return by part the sum of the absolute derivatives of the ordering result."""
        of = self.of or wanted[0].result
        known = machines.setup.model.own_result_fields
        if of not in known:
            raise UsageError(f"study '{self.name}': there is no result '{of}'.{near_miss(of, known)}")
        tolerances = machines.setup.model.tolerances
        columns = tuple(dict.fromkeys(column for name in shop.parts for column in tolerances[name].on))
        found = slopes(machines.setup, (of,), columns, machines.scatter).of[of]
        return {name: sum(abs(float(found[column])) for column in tolerances[name].on) for name in shop.parts}

    def _verified(
        self, bench: Bench, wanted: Sequence[Demand], designs: Mapping[str, Mapping[str, str]]
    ) -> dict[str, Tally]:
        """Draw the same machines for every design; equal designs are drawn once."""
        found: dict[str, Tally] = {}
        for stage, (key, grades) in enumerate(designs.items()):
            twin = next((other for other in found if designs[other] == grades), None)
            if twin is not None:
                found[key] = found[twin]
                continue
            setup = with_grades(bench.setup, grades)

            def done(draws: int, total: int, stage: int = stage) -> None:
                bench.progress(self.name, stage * total + draws, len(designs) * total)

            budget = Budget(self.draws, self.batch, bench.executor, done)
            found[key] = sample(Machines(setup, scatter_of(setup)), wanted, bench.answers, budget)
        return found


def _goals(setup: Setup, answers: Mapping[str, Any], study: str) -> list[Demand]:
    import numpy as np

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
    """What the rule chose, step by step, and the least cost beside it.

    ``start`` and ``final`` are first-order probabilities by check; ``tolerances`` the grades that the rule ends with;
    ``monte_carlo["start" | "rule" | "least"][check]`` the probabilities on the exact model.
    ``inputs`` are those of the run, as effects leave them.
    """

    name: str = "allocation"
    finest: str
    shop: Shop
    steps: tuple[Step, ...]
    rule: Plan
    least: Plan
    coefficients: Mapping[str, float]
    sampled: Mapping[str, Tally] = field(default_factory=dict)
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
        return self.shop.chances(self.shop.start)

    @property
    def final(self) -> Mapping[str, float]:
        """The first-order probabilities after the last step."""
        return self.rule.chances

    @property
    def tolerances(self) -> Mapping[str, str]:
        """The grades that the rule ends with."""
        return self.rule.grades

    @property
    def cost(self) -> float:
        """The cost of these grades, in ``shop.unit``."""
        return self.rule.cost

    @property
    def least_cost(self) -> Plan:
        """The least-cost choice among the same grades."""
        return self.least

    @property
    def least_steps(self) -> int:
        """How many grades the least-cost choice lies away from the start."""
        start = self.shop.start
        return sum(abs(GRADES.index(grade) - GRADES.index(start[name])) for name, grade in self.least.grades.items())

    @property
    def monte_carlo(self) -> dict[str, dict[str, float]]:
        """The probabilities on the exact model, by design and check."""
        return {
            key: {name: float(hits / tally.draws) for name, hits in tally.hits.items()}
            for key, tally in self.sampled.items()
        }

    def as_json(self) -> dict[str, Any]:
        """Return steps, grades, cost and whether the goals are reached, of the rule and of the least cost."""
        from truing.studies.allotted_printed import allotted_json

        return allotted_json(self)

    def blocks(self) -> Sequence[Block]:
        """Return the steps, rule against least cost, and the probabilities along the synthesis."""
        from truing.studies.allotted_printed import allotted_blocks

        return allotted_blocks(self)

    def checks(self) -> Sequence[Check]:
        """Compare the probability after the synthesis, first order, with each goal; and say whether all are reached."""
        goals = {demand.name: demand.goal for demand in self.shop.demands if demand.goal is not None}
        each = [
            chance_check(name, self.final[name], goal, method="first order", note=ALLOTTED)
            for name, goal in goals.items()
        ]
        worst = min(self.final[name] / goal if goal else 1.0 for name, goal in goals.items())
        return [*each, chance_check("goal reached", worst, 1.0, method="first order", note=GOAL_REACHED)]

    def warnings(self) -> Sequence[str]:
        """Say what cannot be reached, and where the exact model contradicts first order."""
        words = [f"study '{self.name}': {remark}" for remark in self.remarks]
        if not self.reached:
            missed = [demand for demand in self.shop.demands if self.final[demand.name] < (demand.goal or 0.0)]
            far = ", ".join(f"'{item.name}' comes to {self.final[item.name]:.4f} of {item.goal:g}" for item in missed)
            words.append(f"study '{self.name}': the goal is {self.rule.status}; {far}")
        for key, plan in (("rule", self.rule), ("least", self.least)):
            tally = self.sampled.get(key)
            if tally is not None and tally.failed:
                words.append(f"study '{self.name}': {_without_answer(tally, key)}")
            if tally is not None and plan.reached:
                words += [f"study '{self.name}': {text}" for text in _contradicted(tally, self.shop.demands, key)]
        return words


SPOKEN = {"rule": "the rule's grades", "least": "the least-cost grades"}


def _without_answer(tally: Tally, design: str) -> str:
    """Say how many machines of a design failed."""
    reason = next(iter(tally.reasons), "no reason was given")
    return (
        f"with {SPOKEN[design]} {tally.failed} of {tally.draws} machines have no answer and count as missed ({reason})"
    )


def _contradicted(tally: Tally, wanted: Sequence[Demand], design: str) -> list[str]:
    """Name the goals that first order reaches and the exact model misses beyond its sampling error."""
    words = []
    for demand in wanted:
        low, high = wilson(tally.hits[demand.name], tally.draws)
        if demand.goal is not None and high < demand.goal:
            words.append(
                f"with {SPOKEN[design]} the exact model gives '{demand.name}' only {low:.4f} to {high:.4f} "
                f"of {demand.goal:g}"
            )
    return words
