"""Is there anything, and is there more than one? The search is paid for: the maximum over it is simulated.

Residuals are simulated under the simpler explanation, with the tolerated inputs drawn from their tolerances (not taken
from the fit, which has absorbed part of any effect like them) and innovations resampled from the cleaned ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest, best_terms
from truing.diagnosis.evidence import Channel, Reduced, Replicates, Simulation, reduced, replicates_of
from truing.diagnosis.hypotheses import NOTHING, Hypothesis, batches_of, mixed, pairs, shapes, singles
from truing.diagnosis.noise import SETTINGS, Setting
from truing.diagnosis.problem import terms_for_pairs
from truing.diagnosis.scoring import scores_of
from truing.diagnosis.search import Solution

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

DRAWS = 299
FIRST_DRAWS = 99
HOPELESS = 12
"""So many simulated maxima above the measured one, of the first draws, settle that it is nothing."""
LARGEST_RHO = 0.985


@dataclass(frozen=True)
class Null:
    """Simulated maxima over a search, in score above the simpler explanation; and the p-value of the measured one."""

    maxima: Matrix
    p_value: float

    def p_of(self, excess: float) -> float:
        """Return the p-value of any other excess, paid for by the same search."""
        return float((1 + (self.maxima >= excess).sum()) / (1 + len(self.maxima)))


def carried(rho: float, rows: int) -> float:
    """Return the autocorrelation to simulate with: the fitted one, its bias and half a standard error more."""
    rows = max(rows, 2)
    return min(LARGEST_RHO, rho + (1 + 3 * rho) / rows + 0.5 * sqrt(max(1 - rho**2, 0.0) / rows))


def simulation_of(contest: Contest, channel: int, null: Solution, cleaned: Solution) -> Simulation:
    """Return how one channel is simulated: filter of the null, innovations that the best explanation leaves."""
    import numpy as np

    evidence = contest.evidence
    setting = SETTINGS[null.setting[channel]]
    left = cleaned.innovations[channel]
    free = len(cleaned.coefficients) / len(evidence.channels) + np.sqrt(evidence.directions.shape[1])
    pool = (left - left.mean()) * np.sqrt(len(left) / max(len(left) - free, 1.0))
    mean = _mean_of(evidence.channels[channel], null)
    return Simulation(pool, Setting(carried(setting.rho, len(left)), setting.theta), mean)


def _mean_of(channel: Channel, null: Solution) -> Matrix:
    """Return what the causes of the null add to a channel, weighted; the inputs are drawn anew."""
    import numpy as np

    made = np.zeros(len(channel))
    for column, value in zip(null.hypothesis.columns, null.coefficients, strict=True):
        item = channel.columns[column]
        if channel.name in item.parts:
            made += item.parts[channel.name][channel.rows] * (item.per / channel.scale * value)
    return made * channel.weights


def null_of(
    contest: Contest,
    null: Solution,
    cleaned: Solution,
    *,
    simple: Sequence[Hypothesis],
    rich: Sequence[Hypothesis],
    excess: float,
    seed: int,
) -> Null:
    """Simulate how far the best of ``rich`` exceeds the best of ``simple`` when the null is true.

    Stops early where the answer is plain. ``excess`` is the measured difference of the two.
    """
    import numpy as np

    generator = np.random.Generator(np.random.SFC64(seed))
    simulations = [simulation_of(contest, place, null, cleaned) for place in range(len(contest.evidence.channels))]
    maxima: list[Matrix] = []
    while (done := sum(len(each) for each in maxima)) < DRAWS:
        goal = FIRST_DRAWS if done < FIRST_DRAWS else DRAWS
        count = goal - done
        maxima.append(_maxima(contest, simulations, simple, rich, count=count, generator=generator))
        above = sum(int((each >= excess).sum()) for each in maxima)
        if done + count >= FIRST_DRAWS and above >= HOPELESS:
            break
    together = np.concatenate(maxima)
    return Null(together, float((1 + (together >= excess).sum()) / (1 + len(together))))


def _maxima(
    contest: Contest,
    simulations: Sequence[Simulation],
    simple: Sequence[Hypothesis],
    rich: Sequence[Hypothesis],
    *,
    count: int,
    generator: np.random.Generator,
) -> Matrix:
    """Simulate ``count`` residuals and return the best score of rich above the best of simple."""
    import numpy as np

    evidence = contest.evidence
    k = evidence.directions.shape[1]
    drawn = generator.standard_normal((k, count))
    filters = [sorted({setting[place] for setting in contest.settings}) for place in range(len(evidence.channels))]
    replicates: list[dict[int, Replicates]] = []
    for channel, simulation, places in zip(evidence.channels, simulations, filters, strict=True):
        chosen = [SETTINGS[place] for place in places]
        made = replicates_of(channel, simulation, drawn, generator=generator, settings=chosen)
        replicates.append(dict(zip(places, made, strict=True)))
    best = [np.full(count, -np.inf), np.full(count, -np.inf)]
    batches = [batches_of(each) for each in (simple, rich)]
    for setting in contest.settings:
        case = _case(contest, setting, replicates)
        for place, each in enumerate(batches):
            best[place] = np.maximum(best[place], scores_of([case], each, evidence.rows).score[0].max(axis=0))
    return np.asarray(best[1] - best[0])


def _case(contest: Contest, setting: tuple[int, ...], replicates: Sequence[dict[int, Replicates]]) -> Reduced:
    evidence = contest.evidence
    chosen = [products[place] for products, place in zip(evidence.products, setting, strict=True)]
    own = [each[place] for each, place in zip(replicates, setting, strict=True)]
    return reduced(chosen, [len(channel) for channel in evidence.channels], evidence.directions.shape[1], own)


def first_stage(contest: Contest, best: int, *, seed: int) -> Null:
    """Simulate the search for anything at all, when nothing is wrong."""
    problem, found = contest.problem, contest.found
    nothing = contest.solution(0)
    rich = [
        *singles(problem.term_pieces),
        *pairs(terms_for_pairs(problem, sparse=True), problem.beside),
        *shapes(problem.shape_pieces),
    ]
    excess = float(found.score[best] - found.score[0])
    cleaned = contest.solution(best)
    return null_of(contest, nothing, cleaned, simple=[NOTHING], rich=rich, excess=excess, seed=seed)


def second_stage(contest: Contest, one: int, two: int, *, with_shapes: bool, seed: int) -> Null:
    """Simulate the search for a second cause, when the best single explanation ``one`` is all there is."""
    problem, found = contest.problem, contest.found
    hypothesis = found.hypotheses[one]
    simple = [*singles(problem.term_pieces), *(shapes(problem.shape_pieces) if with_shapes else [])]
    beside = list(hypothesis.pieces) if hypothesis.kind == "one" else best_terms(found)
    groups = list(problem.shape_pieces) if hypothesis.kind == "one" else list(hypothesis.pieces)
    rich = [
        *pairs(terms_for_pairs(problem, sparse=True), problem.beside),
        *mixed([piece for piece in beside if piece.kind == "term"], groups, problem.like),
    ]
    excess = float(found.score[two] - found.score[one])
    return null_of(
        contest, contest.solution(one), contest.solution(two), simple=simple, rich=rich, excess=excess, seed=seed
    )
