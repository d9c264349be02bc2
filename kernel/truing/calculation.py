"""A whole run: the calculation, its studies in order, and the checks."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from truing.arrays import one_thread
from truing.declare.fields import read
from truing.declare.model import Record
from truing.errors import InfeasibleError
from truing.evaluate import acting_inputs, answered, evaluate
from truing.executors import open_executor
from truing.prices import price_answers
from truing.setup import Setup, SwitchedOn
from truing.studies.bench import Bench, Outcome, Progress, silent
from truing.studies.checks import Check, State
from truing.studies.verdicts import Decided, decide


@dataclass(frozen=True)
class Calculation:
    """What a run found; everything in SI, by flat name. ``absent`` says why a result does not exist; it is NaN."""

    setup: Setup
    results: Any
    answers: Mapping[str, Any]
    outcomes: Mapping[str, Outcome]
    decided: Decided
    warnings: tuple[str, ...]
    failed: tuple[tuple[int, str], ...] = field(default=())
    absent: Mapping[str, str] = field(default_factory=dict)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every limit with its state."""
        return self.decided.checks

    @property
    def verdict(self) -> State:
        """The worst state of all checks."""
        return self.decided.verdict

    @cached_property
    def record(self) -> Record[Any, Any]:
        """The run as sections of the sheet see it."""
        return Record(
            self.setup.inputs, self.results, self.answers, self.outcomes, self.setup.model.function,
            acting_inputs(self.setup),
        )  # fmt: skip


@one_thread()
def calculate(setup: Setup, *, executor: Executor | None = None, progress: Progress = silent) -> Calculation:
    """Run the calculation and the studies of the setup, in order.

    Raises InfeasibleError where the inputs describe something impossible, PluginError where the plugin's code fails.
    """
    first = answered(setup)
    results = first.results
    answers = {**setup.model.read_results(results), **price_answers(setup)}
    outcomes: dict[str, Outcome] = {}
    given_by = setup.model.study_result_fields
    own = executor is None
    executor = executor or open_executor("serial")
    try:
        for study in setup.studies:
            bench = Bench(setup, results, executor, dict(answers), dict(outcomes), progress, first.absent)
            outcomes[study.name] = outcome = study.run(bench)
            if study.gives is not None:
                given = study.gives(outcome)
                fields = given_by[study.name]
                answers.update({name: read(given, field.path) for name, field in fields.items()})
    finally:
        if own:
            executor.shutdown()
    return Calculation(
        setup=setup,
        results=results,
        answers=answers,
        outcomes=outcomes,
        decided=decide(setup, answers, outcomes),
        warnings=tuple(_warnings(setup, outcomes)),
        absent=first.absent,
    )


def _warnings(setup: Setup, outcomes: Mapping[str, Outcome]) -> list[str]:
    of_studies = [text for outcome in outcomes.values() for text in outcome.warnings()]
    return [*setup.source.warnings, *_idle_effects(setup), *of_studies]


def _idle_effects(setup: Setup) -> list[str]:
    """Name effects that are on while every condition they need stays at its reference and does not scatter about it."""
    scattering = {name for inner in setup.distributions().values() for name in inner} if setup.effects else set()
    idle = []
    for active in setup.effects:
        needs = active.effect.needs
        still = all(setup.nominal(need.name) == need.zero and need.name not in scattering for need in needs)
        if needs and still and not _acts(setup, active):
            names = " and ".join(f"'{need.name}'" for need in needs)
            idle.append(f"effect '{active.effect.name}' is on, but {names} stays at its reference: it does nothing")
    return idle


def _acts(setup: Setup, active: SwitchedOn) -> bool:
    """Whether an effect changes what is shown all the same: as the sign of a load, or the cosine of an angle, may."""
    others = tuple(other for other in setup.effects if other is not active)
    try:
        with_it, without = (
            setup.model.read_results(evaluate(replace(setup, effects=effects), reading=True))
            for effects in (setup.effects, others)
        )
    except InfeasibleError:
        return True
    return any(not np.array_equal(value, without[name], equal_nan=True) for name, value in with_it.items())
