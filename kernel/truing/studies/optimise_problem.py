"""Many designs answered at once: objectives, margins and chances; here, or by a worker that makes the problem again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from truing.declare.checks import TOTAL_PRICE
from truing.evaluate import evaluate_rows
from truing.executors import SerialExecutor, in_order, keepable
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.optimise_chances import Cloud, Designs, by_draws, by_first_order, cloud_of
from truing.studies.optimise_goals import Aim, Bound, World, aims_of, bounds_of, margins, results_needed
from truing.studies.optimise_space import Brief, Space, open_space
from truing.studies.optimise_spreads import scattered, total_prices
from truing.studies.scatter import Scatter, scatter_of

ROWS = 2**16  # of one call of the model, so that memory stays flat


@runtime_checkable
class StandIn(Protocol):
    """What may answer in place of the model: the outcome of a surrogate study."""

    @property
    def of(self) -> tuple[str, ...]:
        """The results it knows."""

    def predict(self, columns: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return these results (n,) in SI from columns (n,) or numbers in SI."""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is chosen, what for, and the machines by which every design is judged."""

    space: Space
    brief: Brief
    aims: tuple[Aim, ...]
    bounds: tuple[Bound, ...]
    scatter: Scatter
    cloud: Cloud | None
    stand_in: StandIn | None = None

    @property
    def setup(self) -> Setup:
        """The setup of the design that the inputs file states."""
        return self.space.setup

    @property
    def by_chance(self) -> tuple[Bound, ...]:
        """The limits with a probability; they are the last ones."""
        return tuple(bound for bound in self.bounds if bound.by_chance)

    def answer(self, columns: Mapping[str, Any], rows: int, wanted: Sequence[str]) -> dict[str, Any]:
        """Run a batch: the surrogate for what it knows, the model for the rest; NaN where a row failed."""
        own = [name for name in self.setup.model.own_result_fields if name in wanted]
        covered = [name for name in own if self.stand_in is not None and name in self.stand_in.of]
        found: dict[str, Any] = {}
        if self.stand_in is not None and covered:
            predicted = self.stand_in.predict(columns)
            found = {name: _of_rows(predicted[name], rows) for name in covered}
        rest = [name for name in own if name not in covered]
        if rest or not own:
            found.update(evaluate_rows(self.setup, columns, rows, wanted=rest).results)
        return {name: found[name] for name in own}


def _of_rows(values: Any, rows: int) -> NDArray[np.float64]:
    return np.broadcast_to(np.asarray(values, dtype=float), (rows,))


@keepable
@dataclass(frozen=True)
class Answers:
    """What m designs are worth: objectives (m, a) in SI, margins of every limit (m, b), chances (m, c) and their goals.

    ``failed`` designs have no answer: NaN everywhere.
    """

    objectives: NDArray[np.float64]
    margins: NDArray[np.float64]
    chances: NDArray[np.float64]
    goals: NDArray[np.float64]
    failed: NDArray[np.bool_]

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Whether a design has an answer and keeps every limit."""
        return ~self.failed & (self.margins >= 0).all(axis=1)

    def __getitem__(self, rows: Any) -> Answers:
        """Return some of the designs."""
        return Answers(**{item.name: getattr(self, item.name)[rows] for item in fields(self)})


def joined(parts: Sequence[Answers]) -> Answers:
    """Put the answers of several batches together, in their order."""
    return Answers(
        **{item.name: np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Answers)}
    )


def make_problem(setup: Setup, brief: Brief) -> Problem:
    """Collect variables, objectives and limits, and draw the machines. Raises UsageError where one is missing."""
    aims, space, bounds = aims_of(setup, brief.study), open_space(setup, brief), bounds_of(setup)
    scatter = scatter_of(setup)
    drawn = brief.chance == "draws" and any(bound.by_chance for bound in bounds)
    cloud = cloud_of(scatter, setup.seed, brief.study, brief.draws) if drawn else None
    return Problem(space, brief, aims, bounds, scatter, cloud)


def answers_of(problem: Problem, designs: NDArray[np.float64], *, as_stated: bool = False) -> Answers:
    """Answer designs (m, v) in one go; ``as_stated`` leaves inputs that follow as the inputs file states them."""
    count = len(designs)
    world, spreads = _world(problem, designs, as_stated=as_stated)
    objectives = np.column_stack([np.broadcast_to(world.value(aim.name), (count,)) for aim in problem.aims])
    plain = [margins(bound, world, count) for bound in problem.bounds if not bound.by_chance]
    chances = _chances(problem, Designs(world, spreads, count))
    goals = np.array([np.broadcast_to(world.goal(bound), (count,)) for bound in problem.by_chance]).reshape(-1, count).T
    kept = (
        np.column_stack([*plain, (chances - goals) / np.where(goals > 0, goals, 1.0)])
        if problem.bounds
        else np.zeros((count, 0))
    )
    failed = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(kept).all(axis=1))
    failed |= _without_spread(spreads, count)
    for values in world.results.values():
        failed |= ~np.isfinite(values.reshape(count, -1)).all(axis=1)
    objectives, kept, chances = (np.where(failed[:, None], np.nan, part) for part in (objectives, kept, chances))
    return Answers(objectives, kept, chances, np.array(goals, dtype=float), failed)


def _without_spread(spreads: Mapping[str, Any], count: int) -> NDArray[np.bool_]:
    """Return the designs in which some tolerance has no width, as a grade that does not exist for their size."""
    missing = np.zeros(count, dtype=bool)
    for inner in spreads.values():
        for item in inner.values():
            missing |= ~np.isfinite(item.sd)
    return missing


def _world(
    problem: Problem, designs: NDArray[np.float64], *, as_stated: bool
) -> tuple[World, dict[str, dict[str, Any]]]:
    """Run the designs without scatter, and once more without effects where ``within`` is measured from there."""
    count, setup = len(designs), problem.setup
    columns = problem.space.columns(designs, as_stated=as_stated)
    spreads = scattered(problem.space, designs, columns)
    priced = TOTAL_PRICE in setup.model.result_fields
    prices = total_prices(setup, spreads, count) if priced else None
    wanted = results_needed(setup, problem.aims, problem.bounds)
    results = problem.answer(columns, count, wanted)
    own = _own_results(problem, columns, count)
    return World(setup, columns, results, own, prices, dict(problem.brief.known)), spreads


def _own_results(problem: Problem, columns: Mapping[str, Any], count: int) -> dict[str, NDArray[np.float64]]:
    """Return the results from which ``within`` is measured, where they are not the nominal ones: see ``of_design``."""
    setup = problem.setup
    wanted = [bound.result for bound in problem.bounds if bound.require.kind == "within"]
    names = {name for item in setup.model.tolerances.values() for name in item.on if name in setup.model.input_fields}
    sockets = [name for name in sorted(names) if getattr(setup.model.input_fields[name].spec, "default", None) == 0]
    acts = any(item.effect.place != "reading" for item in setup.effects)
    deviates = any(name in columns or setup.nominal(name) != 0 for name in sockets)
    if not wanted or not (acts or deviates):
        return {}
    neutral = {**columns, **{name: np.zeros(count) for name in sockets}}
    design = replace(setup, effects=())
    return dict(evaluate_rows(design, neutral, count, wanted=[name for name in wanted if name != TOTAL_PRICE]).results)


def _chances(problem: Problem, designs: Designs) -> NDArray[np.float64]:
    bounds = problem.by_chance
    if not bounds:
        return np.zeros((designs.rows, 0))
    if problem.cloud is None:
        return by_first_order(problem.scatter, designs, bounds, problem.answer)
    return by_draws(problem.cloud, designs, bounds, problem.answer)


# Jobs


@dataclass(frozen=True)
class Job:
    """Some designs, as they go to a worker: plain data, except in this process."""

    problem: Problem | tuple[Packed, Brief]
    designs: NDArray[np.float64]


def run_job(job: Job) -> Answers:
    """Answer the designs of one job."""
    problem = job.problem if isinstance(job.problem, Problem) else _unpacked(*job.problem)
    return answers_of(problem, job.designs)


@lru_cache(maxsize=4)
def _unpacked(packed: Packed, brief: Brief) -> Problem:
    return make_problem(unpack(packed), brief)


def answered(problem: Problem, designs: NDArray[np.float64], executor: Executor) -> Answers:
    """Answer designs (m, v), cut into jobs in a way that does not depend on who computes them."""
    if isinstance(executor, SerialExecutor) or problem.stand_in is not None:
        jobs = (Job(problem, part) for part in _parts(problem, designs))
        return joined([run_job(job) for job in jobs])
    carried = (pack(problem.setup), problem.brief)
    return joined(list(in_order(executor, run_job, (Job(carried, part) for part in _parts(problem, designs)))))


def _parts(problem: Problem, designs: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    rows = problem.brief.draws if problem.cloud is not None else 1
    if problem.cloud is None and problem.by_chance:
        rows = 1 + 2 * len(problem.scatter.columns)
    size = max(1, min(ROWS // rows, -(-len(designs) // problem.brief.parts)))
    for start in range(0, len(designs), size):
        yield designs[start : start + size]
