"""The search: NSGA-II over places in the unit cube; a population is one array, and only the seed decides chance.

Source: K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182. Whole variables sit at
their steps; beside polynomial mutation they jump to any other step now and then.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.heavy import (
    pymoo_config,
    pymoo_evaluator,
    pymoo_hypervolume,
    pymoo_mutation,
    pymoo_nsga2,
    pymoo_problem,
    pymoo_repair,
    pymoo_static,
)
from truing.studies.optimise_problem import Answers, Problem, joined

FAILED = 1e6
"""How far a design without an answer is counted beyond every limit: finite, and worse than any that has one."""

ROOM = 4
"""How many times its population a search remembers of what it has found on the way."""

LED = 2
"""Every second offspring is a differential step."""
REACH, MOVED = (0.2, 1.0), 0.9
"""How long these steps are, and in what share of the variables."""

TRIFLE, DEAR = 1e-3, 2e-2

DesignEvaluator = Callable[["NDArray[np.float64]"], Answers]


@dataclass(frozen=True)
class SearchPlan:
    """How much is searched: designs per generation, generations, and the seed."""

    population: int
    generations: int
    seed: int


@dataclass(frozen=True)
class Trail:
    """What the search left: the designs (m, v) it ended with, their answers, and every generation's best objectives.

    ``fronts`` hold what should be small (objectives, those to be large negated), of feasible designs no other beats.
    """

    designs: NDArray[np.float64]
    answers: Answers
    fronts: tuple[NDArray[np.float64], ...]
    evaluations: int
    failed: int


def search(problem: Problem, plan: SearchPlan, answer: DesignEvaluator, done: Callable[[int, int], None]) -> Trail:
    """Look for the designs that no other beats. ``answer(designs)`` is called once per generation."""
    algorithm, shell = _algorithm(problem, plan)
    rng = np.random.default_rng([plan.seed, LED])
    kept: tuple[NDArray[np.float64], Answers] | None = None
    fronts: list[NDArray[np.float64]] = []
    evaluations = failed = 0
    for generation in range(plan.generations):
        asked = algorithm.ask()
        if asked is None or not len(asked):
            break
        if kept is not None:
            asked.set("X", _led(problem, (asked.get("X"), algorithm.pop.get("X")), kept[0], rng))
        designs = problem.space.designs(asked.get("X"))
        generation_answers = answer(designs)
        evaluations, failed = evaluations + len(designs), failed + int(generation_answers.failed.sum())
        _tell(algorithm, shell, asked, problem, generation_answers)
        kept = _best(problem, kept, (designs, generation_answers), ROOM * plan.population)
        fronts.append(small(problem, kept[1]))
        done(generation + 1, plan.generations)
    assert kept is not None  # the first generation is never empty
    designs, answers = _best(problem, None, kept, plan.population)
    return Trail(designs, answers, tuple(fronts), evaluations, failed)


def _led(
    problem: Problem,
    places: tuple[NDArray[np.float64], NDArray[np.float64]],
    best: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Put differential steps in the place of every second offspring, and return all offspring as places.

    A step is a part of the way between two designs of the population, away from one of the best: so it follows the
    front whatever its direction (R. Storn, K. Price, J. Glob. Optim. 11 (1997) 341). ``places`` are those of the
    offspring and of the population.
    """
    offspring, population = places
    changed = offspring.copy()
    count = len(changed[1::LED])
    start = problem.space.units(best[rng.integers(len(best), size=count)])
    ahead, behind = (population[rng.integers(len(population), size=count)] for _ in range(2))
    reach = rng.uniform(*REACH, (count, 1))
    moved = rng.random(start.shape) < MOVED
    led = start + np.where(moved, reach * (ahead - behind), 0.0)
    changed[1::LED] = problem.space.units(problem.space.designs(np.clip(led, 0.0, 1.0)))
    return changed


def small(problem: Problem, answers: Answers) -> NDArray[np.float64]:
    """Return the objectives of feasible designs as numbers that should be small."""
    return np.asarray(answers.objectives[answers.feasible] * np.array([aim.sign for aim in problem.aims]))


def _best(
    problem: Problem,
    kept: tuple[NDArray[np.float64], Answers] | None,
    new: tuple[NDArray[np.float64], Answers],
    most: int,
) -> tuple[NDArray[np.float64], Answers]:
    """Keep the feasible designs that no other beats, or while there is none the one that misses least.

    At most ``most`` of them, chosen so that they spread along the front; the ends always stay.
    """
    designs, answers = new if kept is None else (np.vstack([kept[0], new[0]]), joined([kept[1], new[1]]))
    if not answers.feasible.any():
        least = int(np.argmin(violation(answers)))
        return designs[[least]], answers[[least]]
    rows = np.flatnonzero(answers.feasible)
    values = small(problem, answers)
    front = non_dominated(values)
    chosen = rows[spread_out(values, front[worth_it(values[front])], most)]
    return designs[chosen], answers[chosen]


def violation(answers: Answers) -> NDArray[np.float64]:
    """Return how far every design misses its limits together; finite where it has no answer."""
    missed = np.where(np.isfinite(answers.margins), np.maximum(-answers.margins, 0.0), FAILED).sum(axis=1)
    return np.asarray(np.where(answers.failed, FAILED * (1 + answers.margins.shape[1]), missed))


def non_dominated(values: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the rows (of values that should be small) that no other row beats; of equal rows the first."""
    order = np.lexsort(values.T[::-1])
    if values.shape[1] <= 2:  # sorted by the first, a row stays where the last falls below all before it
        last = values[order, -1]
        lowest = np.minimum.accumulate(np.concatenate([[np.inf], last[:-1]]))
        return np.asarray(order[last < lowest])
    front = []
    while len(order):
        first, rest = order[0], order[1:]
        front.append(first)
        order = rest[(values[rest] < values[first]).any(axis=1)]
    return np.array(front, dtype=np.intp)


def worth_it(front: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Say which designs of a front buy something for their price.

    One that is better than another by less than ``TRIFLE`` of the front's extent, in what it is better in, and worse
    by more than ``DEAR`` in anything, is no trade: the ends of a front would hang on to such designs for ever.
    """
    span = np.ptp(front, axis=0)
    scaled = front / np.where(span > 0, span, 1.0)
    apart: NDArray[np.float64] = scaled[:, None, :] - scaled[None, :, :]  # how much worse the first is than the second
    beaten = (apart.min(axis=2) > -TRIFLE) & (apart.max(axis=2) > DEAR)
    return np.asarray(~beaten.any(axis=1))


def spread_out(values: NDArray[np.float64], front: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Thin a front to ``most`` rows by leaving out, one by one, the most crowded; ends have no neighbour and stay."""
    while len(front) > most:
        objectives = values[front]
        span = np.ptp(objectives, axis=0)
        scaled = (objectives - objectives.min(axis=0)) / np.where(span > 0, span, 1.0)
        room = np.zeros(len(front))
        for column in scaled.T:
            order = np.argsort(column, kind="stable")
            room[order[1:-1]] += column[order[2:]] - column[order[:-2]]
            room[order[[0, -1]]] = np.inf
        front = np.delete(front, int(np.argmin(room)))
    return front


def _tell(algorithm: Any, shell: Any, asked: Any, problem: Problem, answers: Answers) -> None:
    """Hand the answers back; a design without one is finite and worse than any other."""
    signs = np.array([aim.sign for aim in problem.aims])
    objectives = np.where(answers.failed[:, None], FAILED, answers.objectives * signs)
    missing = np.where(answers.failed, FAILED, -1.0)
    limits = np.where(answers.failed[:, None], FAILED, -answers.margins)
    pymoo_evaluator.Evaluator().eval(
        pymoo_static.StaticProblem(shell, F=objectives, G=np.column_stack([limits, missing])), asked
    )
    algorithm.tell(infills=asked)


def _algorithm(problem: Problem, plan: SearchPlan) -> tuple[Any, Any]:
    """Set up the algorithm of the literature with the first population."""
    pymoo_config.Config.warnings["not_compiled"] = False
    count = len(problem.space.variables)
    shell = pymoo_problem.Problem(
        n_var=count,
        n_obj=len(problem.aims),
        n_ieq_constr=len(problem.bounds) + 1,
        xl=np.zeros(count),
        xu=np.ones(count),
    )
    mutation, repair = _operators(problem)
    algorithm = pymoo_nsga2.NSGA2(
        pop_size=plan.population, sampling=_first(problem, plan), mutation=mutation, repair=repair
    )
    algorithm.setup(shell, termination=("n_gen", plan.generations), seed=plan.seed, verbose=False)
    return algorithm, shell


def _first(problem: Problem, plan: SearchPlan) -> NDArray[np.float64]:
    """Return the first population: the stated design, it with every width at its ends, and a Latin hypercube."""
    space = problem.space
    start = space.units(space.start[None, :])[0]
    widths = np.array([not variable.is_input for variable in space.variables])
    ends = [start, np.where(widths, 0.0, start), np.where(widths, 1.0, start)] if widths.any() else [start]
    ends = ends[: plan.population]
    rest = plan.population - len(ends)
    rng = np.random.default_rng([plan.seed, rest])
    strata = np.array([rng.permutation(rest) for _ in space.variables]).reshape(len(start), rest).T
    return np.vstack([*ends, (strata + rng.random((rest, len(start)))) / max(rest, 1)])


def _operators(problem: Problem) -> tuple[Any, Any]:
    """Return the mutation and the repair that know whole variables."""
    space = problem.space
    discrete = np.flatnonzero([variable.discrete for variable in space.variables])

    class Mutation(pymoo_mutation.PM):  # type: ignore[misc]  # pymoo has no types
        def _do(self, shell: Any, places: Any, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
            changed = super()._do(shell, places, *args, random_state=random_state, **kwargs)
            if len(discrete):
                jumps = random_state.random((len(changed), len(discrete))) < 1 / len(space.variables)
                anywhere = random_state.random(jumps.shape)
                changed[:, discrete] = np.where(jumps, anywhere, changed[:, discrete])
            return changed

    class ToSteps(pymoo_repair.Repair):  # type: ignore[misc]
        def _do(self, shell: Any, places: Any, **kwargs: Any) -> Any:
            return space.units(space.designs(np.asarray(places, dtype=float)))

    return Mutation(eta=20), ToSteps()


# What a front is worth: its knee, its hypervolume, and whether the search has settled


REFERENCE = 1.1
"""The reference point of the hypervolume, in every objective: the box of the final front is 0 to 1."""
SETTLED = 1e-3
LAST = 0.1


@dataclass(frozen=True)
class Volume:
    """The hypervolume of every generation's front in one box: ``ideal`` is 0, ``nadir`` 1 in each objective."""

    ideal: tuple[float, ...]
    nadir: tuple[float, ...]
    history: tuple[float, ...]
    exhausted: bool = False
    """Whether the search ended because it found no design that it had not tried."""

    @property
    def last(self) -> int:
        """How many generations at the end are looked at."""
        return max(1, round(LAST * len(self.history)))

    @property
    def gain(self) -> float:
        """By what share it grew in these last generations."""
        before = self.history[max(0, len(self.history) - 1 - self.last)]
        return (self.history[-1] - before) / self.history[-1] if self.history[-1] > 0 else 0.0

    @property
    def settled(self) -> bool:
        """Whether it grew by no more than one part in a thousand, or nothing was left to try."""
        return self.exhausted or (len(self.history) > self.last and self.gain <= SETTLED)


def volume_of(fronts: Sequence[NDArray[np.float64]], *, exhausted: bool = False) -> Volume:
    """Measure every generation's front (values that should be small) in the box of the last one.

    In one objective it is the way from the reference to the best. An objective in which the last front has no extent
    takes that of all fronts. Source: E. Zitzler, L. Thiele, IEEE Trans. Evol. Comput. 3 (1999) 257.
    """
    filled = [front for front in fronts if len(front)]
    last, whole = filled[-1], np.vstack(filled)
    ideal, nadir = last.min(axis=0), last.max(axis=0)
    nadir = np.where(nadir > ideal, nadir, whole.max(axis=0))
    span = np.where(nadir > ideal, nadir - ideal, 1.0)
    history = tuple(_hypervolume((front - ideal) / span) if len(front) else 0.0 for front in fronts)
    return Volume(tuple(ideal.tolist()), tuple((ideal + span).tolist()), history, exhausted)


def _hypervolume(values: NDArray[np.float64]) -> float:
    inside = values[(values < REFERENCE).all(axis=1)]
    if not len(inside):
        return 0.0
    if values.shape[1] == 1:
        return float(REFERENCE - inside.min())
    if values.shape[1] > 2:
        return float(pymoo_hypervolume.HV(ref_point=np.full(values.shape[1], REFERENCE))(inside))
    order = inside[np.lexsort(inside.T[::-1])]
    below = np.minimum.accumulate(np.concatenate([[REFERENCE], order[:, 1]]))
    return float(((REFERENCE - order[:, 0]) * (below[:-1] - below[1:])).sum())


def knee_of(front: NDArray[np.float64]) -> tuple[int, float]:
    """Return the design farthest from the chord of the normalised front, towards small values, and how far it is.

    The chord (with more objectives the plane) goes through the ends of the front, each objective from 0 to 1. With one
    objective it is the best design. Source: I. Das, Structural Optimization 18 (1999) 107.
    """
    if front.shape[1] == 1:
        return int(np.argmin(front[:, 0])), 0.0
    span = np.ptp(front, axis=0)
    scaled = (front - front.min(axis=0)) / np.where(span > 0, span, 1.0)
    distance = (1.0 - scaled.sum(axis=1)) / np.sqrt(front.shape[1])
    knee = int(np.argmax(distance))
    return knee, float(distance[knee]) if (span > 0).all() else 0.0
