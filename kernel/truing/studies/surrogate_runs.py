"""The runs behind a surrogate: designed samples, and how long the model and its stand-in take for the same work."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.evaluate import Rows, evaluate_rows
from truing.executors import SerialExecutor, in_order, keepable
from truing.heavy import stats
from truing.packed import Packed, pack, unpack
from truing.setup import Setup
from truing.studies.bench import Done
from truing.studies.scatter import generator
from truing.studies.surrogate_box import Box

LONGEST = 3.0
"""Seconds after which the model is stopped and its time for the rest is taken from what was run."""


keepable(Rows)


@dataclass(frozen=True)
class Job:
    """Some points, as they go to a worker: plain data, except in this process."""

    setup: Setup | Packed
    columns: Mapping[str, Any]
    rows: int
    wanted: tuple[str, ...]


@dataclass(frozen=True)
class Ran:
    """Designed points (n,) by input, what the model answered, and the seconds it worked."""

    columns: Mapping[str, Any]
    rows: Rows
    seconds: float


def latin(box: Box, points: int, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a Latin hypercube: every side of the box in as many layers as there are points."""
    return box.sampled(stats.qmc.LatinHypercube(len(box.features), seed=rng).random(points))


def designed(setup: Setup, box: Box, stage: int, points: int, study: str) -> dict[str, NDArray[np.float64]]:
    """Return the columns of one stage of a study: 0 is learnt from, 1 is held out, 2 is for the clock."""
    return latin(box, points, generator(setup.seed, stage, study))


def run_points(job: Job) -> tuple[Rows, float]:
    """Run the model at some points, all in one call; return the seconds too."""
    setup = _unpacked(job.setup) if isinstance(job.setup, Packed) else job.setup
    start = perf_counter()
    rows = evaluate_rows(setup, job.columns, job.rows, wanted=job.wanted).complete()
    return rows, perf_counter() - start


@lru_cache(maxsize=4)
def _unpacked(packed: Packed) -> Setup:
    return unpack(packed)


@dataclass(frozen=True)
class Work:
    """How points are run: so many in one call, where, and who hears how far it has come."""

    batch: int
    executor: Executor
    done: Done


def ran(setup: Setup, columns: Mapping[str, Any], wanted: tuple[str, ...], work: Work) -> Ran:
    """Run the model at all points."""
    carried: Setup | Packed = setup if isinstance(work.executor, SerialExecutor) else pack(setup)
    points = len(next(iter(columns.values())))
    jobs = (Job(carried, part, rows, wanted) for part, rows in _parts(columns, points, work.batch))
    answers = []
    for answer in in_order(work.executor, run_points, jobs):
        answers.append(answer)
        work.done(min(len(answers) * work.batch, points), points)
    parts = [rows for rows, _ in answers]
    reasons = {place * work.batch + row: text for place, rows in enumerate(parts) for row, text in rows.reasons.items()}
    results = {name: np.concatenate([rows.results[name] for rows in parts]) for name in wanted}
    joined = Rows(results, np.concatenate([rows.failed for rows in parts]), reasons)
    return Ran(columns, joined, sum(seconds for _, seconds in answers))


def _parts(columns: Mapping[str, Any], points: int, batch: int) -> Iterator[tuple[dict[str, Any], int]]:
    for start in range(0, points, batch):
        rows = min(batch, points - start)
        yield {name: values[start : start + rows] for name, values in columns.items()}, rows


@dataclass(frozen=True)
class Speed:
    """Seconds on this machine, in one process: for the designed sample, for learning from it, and for ``rows`` answers.

    ``measured`` of the model's ``rows`` were really run; its time for the rest is in proportion.
    """

    rows: int
    sample: float
    fit: float
    predictions: float
    model: float
    measured: int

    @property
    def making(self) -> float:
        """Seconds until the surrogate can answer at all."""
        return self.sample + self.fit

    @property
    def break_even(self) -> float:
        """The number of answers from which on the surrogate is the faster way; infinite where it never is."""
        gain = (self.model - self.predictions) / self.rows
        return self.making / gain if gain > 0 else float("inf")

    @property
    def pays(self) -> bool:
        """Whether making the surrogate and asking it was faster than asking the model."""
        return self.making + self.predictions < self.model


def clocked(
    setup: Setup,
    columns: Mapping[str, Any],
    predict: Callable[[Mapping[str, Any]], Any],
    wanted: tuple[str, ...],
    *,
    batch: int,
    done: Done = lambda step, steps: None,
) -> tuple[float, float, int]:
    """Return the seconds for all predictions, those for all runs of the model, and how many were really run."""
    points = len(next(iter(columns.values())))
    start = perf_counter()
    for part, _ in _parts(columns, points, batch):
        predict(part)
    predictions = perf_counter() - start
    spent, run = 0.0, 0
    for part, rows in _parts(columns, points, batch):
        spent += run_points(Job(setup, part, rows, wanted))[1]
        run += rows
        done(max(run, round(points * spent / LONGEST)), points)
        if spent > LONGEST:
            break
    return predictions, spent * points / run, run
