"""Monte Carlo on the exact model: batches of machines, counted and summed in the order of the batches.

One batch is one array call of the model. Only counts and moments leave it, so memory stays flat however many machines
are drawn, and the sums are made in the order of the batches, so the answer does not depend on who computed which.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.evaluate import Rows, evaluate_rows
from truing.executors import SerialExecutor, in_order, keepable
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.demands import Demand, nominal_inputs, results_needed
from truing.studies.scatter import Scatter, scatter_of

KEPT_REASONS = 8


@dataclass(frozen=True)
class Machines:
    """Machines of one design: the setup, and what scatters in it."""

    setup: Setup
    scatter: Scatter


@dataclass(frozen=True)
class SamplingPlan:
    """What every batch is asked: which demands, about which centres the moments are summed."""

    demands: tuple[Demand, ...]
    wanted: tuple[str, ...]
    centres: Mapping[str, Any]
    nominal: Mapping[str, float]


@dataclass(frozen=True)
class SampleBatch:
    """One batch, as it goes to a worker: plain data, except in this process."""

    machines: Machines | Packed
    plan: SamplingPlan
    seed: int
    batch: int
    rows: int


@keepable
@dataclass(frozen=True)
class Moments:
    """Count, mean, sum of squared deviations, smallest and largest; numbers or arrays along the result's axis."""

    count: int
    mean: Any
    squares: Any
    smallest: Any
    largest: Any

    @property
    def sd(self) -> Any:
        """Standard deviation (n - 1)."""
        return np.sqrt(self.squares / (self.count - 1)) if self.count > 1 else self.squares * float("nan")


@keepable
@dataclass(frozen=True)
class Tally:
    """What some batches found: hits by demand, moments by result, failed rows and the first reasons for them."""

    draws: int
    hits: Mapping[str, Any]
    moments: Mapping[str, Moments]
    failed: int
    reasons: Mapping[str, int]


def sample(
    machines: Machines,
    wanted: Sequence[Demand],
    answers: Mapping[str, Any],
    budget: SampleBudget,
) -> Tally:
    """Draw the machines that the budget allows and count which of them meet each demand."""
    plan = plan_of(machines.setup, wanted, answers)
    total: Tally | None = None
    for tally in in_order(budget.executor, run_batch, _jobs(machines, plan, budget)):
        total = tally if total is None else merged(total, tally)
        budget.done(total.draws, budget.draws)
    assert total is not None  # a budget has at least one draw
    return total


@dataclass(frozen=True)
class SampleBudget:
    """How many machines are drawn, in which batches, where, and who hears of it."""

    draws: int
    batch: int
    executor: Executor
    done: Callable[[int, int], None]


def plan_of(setup: Setup, wanted: Sequence[Demand], answers: Mapping[str, Any]) -> SamplingPlan:
    """Say what every batch is asked; ``answers`` holds the nominal results in SI."""
    needed = results_needed(setup, wanted)
    centres = {name: answers[name] for name in needed}
    return SamplingPlan(tuple(wanted), needed, centres, nominal_inputs(setup, wanted))


def _jobs(machines: Machines, plan: SamplingPlan, budget: SampleBudget) -> Iterator[SampleBatch]:
    carried: Machines | Packed = machines if isinstance(budget.executor, SerialExecutor) else pack(machines.setup)
    for batch, start in enumerate(range(0, budget.draws, budget.batch)):
        yield SampleBatch(carried, plan, machines.setup.seed, batch, min(budget.batch, budget.draws - start))


@lru_cache(maxsize=4)
def _unpacked(packed: Packed) -> Machines:
    setup = unpack(packed)
    return Machines(setup, scatter_of(setup))


@lru_cache(maxsize=1)
def _keep_freed_memory() -> None:
    """Let the C library keep freed arrays for the next batch instead of handing them back to the system.

    Freeing one large array, never touched, raises glibc's thresholds for doing so. Without it the page faults of the
    temporaries cost as much as the arithmetic of the model. Other C libraries do not care.
    """
    np.empty(31 * 2**20, dtype=np.uint8)


def run_batch(job: SampleBatch) -> Tally:
    """Draw one batch, run the model on it, and return counts and moments."""
    _keep_freed_memory()
    machines = _unpacked(job.machines) if isinstance(job.machines, Packed) else job.machines
    columns = machines.scatter.draw(job.seed, job.batch, job.rows)
    rows = evaluate_rows(machines.setup, columns, job.rows, wanted=job.plan.wanted).complete()
    return Tally(
        draws=job.rows,
        hits={demand.name: _hits(demand, rows, columns, job.plan) for demand in job.plan.demands},
        moments={name: _moments(rows, name, job.plan.centres[name]) for name in job.plan.wanted},
        failed=int(rows.failed.sum()),
        reasons=_counted(rows),
    )


def _hits(demand: Demand, rows: Rows, columns: Mapping[str, Any], plan: SamplingPlan) -> Any:
    """Count the rows within the limits; NaN, as in failed rows, lies in none."""
    response = demand.response(rows.results, columns, plan.nominal)
    inside = response <= demand.high
    if np.any(demand.low > -np.inf):
        inside &= response >= demand.low
    return inside.sum(axis=0)


def _moments(rows: Rows, name: str, centre: Any) -> Moments:
    values = rows.results[name]
    if rows.failed.any():
        values = values[~rows.failed]
    count = len(values)
    if not count:
        nothing = np.zeros(values.shape[1:])
        return Moments(0, nothing, nothing, nothing + np.inf, nothing - np.inf)
    deviations = values - centre
    mean = deviations.mean(axis=0)
    smallest, largest = deviations.min(axis=0), deviations.max(axis=0)
    deviations -= mean
    deviations *= deviations
    return Moments(count, centre + mean, deviations.sum(axis=0), centre + smallest, centre + largest)


def _counted(rows: Rows) -> dict[str, int]:
    found: dict[str, int] = {}
    for reason in rows.reasons.values():
        found[reason] = found.get(reason, 0) + 1
    return found


def merged(first: Tally, second: Tally) -> Tally:
    """Join what two runs of batches found."""
    reasons = dict(first.reasons)
    for reason, count in second.reasons.items():
        if reason in reasons or len(reasons) < KEPT_REASONS:
            reasons[reason] = reasons.get(reason, 0) + count
    return Tally(
        draws=first.draws + second.draws,
        hits={name: hits + second.hits[name] for name, hits in first.hits.items()},
        moments={name: joined(moments, second.moments[name]) for name, moments in first.moments.items()},
        failed=first.failed + second.failed,
        reasons=reasons,
    )


def joined(first: Moments, second: Moments) -> Moments:
    """Join moments (T. F. Chan, G. H. Golub, R. J. LeVeque, Am. Stat. 37 (1983) 242)."""
    if not first.count or not second.count:
        return first if first.count else second
    count = first.count + second.count
    apart = second.mean - first.mean
    mean = first.mean + apart * (second.count / count)
    squares = first.squares + second.squares + apart * apart * (first.count * second.count / count)
    smallest = np.minimum(first.smallest, second.smallest)
    return Moments(count, mean, squares, smallest, np.maximum(first.largest, second.largest))


def standard_rows(
    machines: Machines, standard: NDArray[np.float64], wanted: Sequence[str]
) -> tuple[Rows, dict[str, Any]]:
    """Run machines given by standard normal values (dimension, n); return rows and their columns."""
    columns: dict[str, Any] = dict(machines.scatter.from_standard(standard))
    return evaluate_rows(machines.setup, columns, standard.shape[1], wanted=wanted).complete(), columns
