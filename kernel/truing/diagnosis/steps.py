"""One cause more: whether it is believed, and what may follow an explanation.

One more cause is believed where its gain is larger than noise alone would give the search, where noise with a memory is
no better word for it, and where it carries over to rows left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from truing.diagnosis.causes import Candidate
from truing.diagnosis.chance import Law, law_of
from truing.diagnosis.competition import MARGIN, MOST_CAUSES, Competition
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import Folds, carries_over, ends_of, folds_of
from truing.diagnosis.records import FEWEST_READINGS
from truing.diagnosis.result import OUTSIDE

ANY_LEVEL, FURTHER_LEVEL = 0.015, 0.01
"""Chance that noise alone gives as much, up to which a first cause is believed, and a further one."""
LEAST_IN_PLACE = 12.0
"""What a step must be better by that puts more numbers in the place of others: twice what counts as near."""
WANDER = 6.0
"""What a cause must be better by, in score, than noise with a memory of its own."""
CERTAIN = 60.0
"""A gain that needs no simulation."""
CARRIED = 1.0
"""Standard errors by which the error of rows left out must fall."""
NEARLY_ALL = 0.98
"""Share of the sum of squares that a shape takes away from which on what is registered stands in its place."""
FURTHER = 6
"""So many causes are fitted beside what stays."""
MANY_CURVES = 20
"""A cause with more independent curves is a wave of any period."""
MENDED_SHARE, MENDED = 0.25, 45.0
"""A registered cause beside a shape must gain such a share of what the shape gains, or so much: a shape is rough, and
what mends it a little is no cause."""


@dataclass(frozen=True)
class Decision:
    """How far the steps have come: the explanation, the law of the first step, the chance of the last further cause."""

    at: Fit
    law: Law
    p_further: float | None = None


@dataclass(frozen=True)
class _Step:
    """One step of the decision: where it leads, the law of its gains, and whether it was believed."""

    more: Fit
    law: Law
    is_believed: bool


def steps_from(competition: Competition, start: Decision, *, seed: int) -> Decision:
    """Go from an explanation to more and more causes, as long as a step is believed; a step may be of two at once."""
    now = start
    is_short = min(competition.sample.known, competition.sample.machine.records.readings) < FEWEST_READINGS
    folds = folds_of(competition.sample)
    while len(now.at.causes) < MOST_CAUSES:
        tried = list(_tried(competition, now.at, folds, seed))
        first = now.law if now.at.causes or not tried else tried[0].law
        taken = tried[-1] if tried and tried[-1].is_believed and not is_short else None
        if taken is None:
            return Decision(now.at, first, now.p_further)
        now = Decision(taken.more, now.law, taken.law.p_value) if now.at.causes else Decision(taken.more, taken.law)
    return now


def _tried(competition: Competition, at: Fit, folds: Folds, seed: int) -> Iterator[_Step]:
    """Give the steps that are judged, up to the first one that is believed."""
    for steps in (1, 2):
        for more in _candidates(competition, at, len(at.causes) + steps):
            step = _step(competition, at, more, folds, seed=seed + 10 * len(at.causes) + steps)
            yield step
            if step.is_believed:
                return


def _candidates(competition: Competition, at: Fit, size: int) -> Iterator[Fit]:
    """Give what may follow an explanation: the best of so many causes; before a shape, what is registered and near it.

    A polynomial draws anything. What the model itself declares and draws nearly all of it is the better word, and a
    shape is then what is left beside it.
    """
    if at.causes and competition.best(len(at.causes)) is not at:  # the search went on from another one
        competition.forward(at, FURTHER)
    best = _best(competition, at, size)
    if best is None or not any(draws_anything(cause) and cause.tag not in at.key for cause in best.causes):
        yield from [] if best is None else [best]
        return
    null = competition.null
    least = NEARLY_ALL * (_squares(best, null) - _squares(best, best))
    named = competition.ranked(
        lambda fit: len(fit.causes) == size and _is_own(fit) and _squares(best, null) - _squares(best, fit) >= least
    )
    yield from named[:1]
    if at.causes and _is_own(at) and _squares(best, null) - _squares(best, at) >= least:
        competition.forward(at, FURTHER)
        yield from competition.ranked(lambda fit: len(fit.causes) == size and fit.key > at.key)[:1]
        return
    yield best


def _is_own(fit: Fit) -> bool:
    """Whether an explanation is made of effects that the model itself declares."""
    return all(cause.effect is not None and not cause.is_kernel for cause in fit.causes)


def draws_anything(cause: Candidate) -> bool:
    """Whether a cause is a polynomial of covariates that nobody registered."""
    return cause.shape is not None and cause.shape.kind in {"trend", "product"}


def _squares(judge: Fit, fit: Fit) -> float:
    """Return the sum of squares that an explanation leaves, in the noise that another one leaves."""
    return float(np.sum((judge.sample.roots(judge.left) * fit.left) ** 2))


def _best(competition: Competition, at: Fit, size: int) -> Fit | None:
    """Return the best explanation of so many causes, with one new shape at most, no input named without need.

    Beside a cause with a name there is one shape in all: a second one takes from what the cause draws.
    """

    def allows(fit: Fit) -> bool:
        many = shapes_in(fit)
        return many <= (max(shapes_in(at), 1) if many < size else shapes_in(at) + 1)

    sized = competition.ranked(lambda fit: len(fit.causes) == size and is_sensible(fit) and allows(fit))
    if not sized:
        return None
    named = next((fit for fit in sized if not shifts_inputs(fit)), None)
    if (
        shifts_inputs(sized[0])
        and named is not None
        and competition.score(named) < competition.score(sized[0]) + MARGIN
    ):
        return named
    return sized[0]


def shapes_in(fit: Fit) -> int:
    """Return how many shapes that nobody registered an explanation has."""
    return sum(cause.shape is not None for cause in fit.causes)


def shifts_inputs(fit: Fit) -> bool:
    """Whether an explanation names an input that lies outside of its band."""
    return any(cause.tolerated >= 0 for cause in fit.causes)


def is_sensible(fit: Fit) -> bool:
    """Whether inputs that are named lie outside of their bands: what lies inside is calibrated, not named."""
    pairs = zip(fit.causes, fit.values, strict=True)
    return all(abs(float(values[0])) > OUTSIDE for cause, values in pairs if cause.tolerated >= 0)


def _step(competition: Competition, at: Fit, more: Fit, folds: Folds, *, seed: int) -> _Step:
    """Judge one step: chance, memory, rows left out; a registered cause that mends a rough shape is none."""
    gain = competition.score(at) - competition.score(more)
    if gain <= 0:
        law = Law(np.zeros(0), 1.0) if at.causes else law_of(competition, at, more, seed=seed)
        return _Step(more, law, False)
    is_certain = bool(at.causes) and gain > CERTAIN
    law = Law(np.zeros(0), 1 / 300) if is_certain else law_of(competition, at, more, seed=seed)
    level, is_more = FURTHER_LEVEL if at.causes else ANY_LEVEL, more.size > at.size
    added = len(more.causes) - len(at.causes) if is_more or at.key < more.key else 0
    is_believed = (
        law.p_value <= level
        and gain >= (LEAST_IN_PLACE if is_more and not at.key < more.key else 0.0)
        and competition.own_score(at) - competition.own_score(more) >= (WANDER if at.causes else 0.0)
        and not _mends(competition, at, more, gain)
        and carries_over(at, more, competition.extended, folds) >= CARRIED * added
        and not _beats(competition, at, more)
    )
    return _Step(more, law, is_believed)


def _beats(competition: Competition, at: Fit, more: Fit) -> bool:
    """Whether a further wave only beats with one that is there: then it does not carry over to the ends."""
    before, after = (
        sum(competition.tries.get(cause.tag, 1.0) > MANY_CURVES for cause in each.causes) for each in (at, more)
    )
    return (
        after > before > 0 and carries_over(at, more, competition.extended, ends_of(competition.sample)) < 2 * CARRIED
    )


def _mends(competition: Competition, at: Fit, more: Fit, gain: float) -> bool:
    """Whether what is added only mends what a shape that nobody registered leaves."""
    shapes = [index for index, cause in enumerate(more.causes) if cause.shape is not None]
    if not shapes or not at.key < more.key or not at.causes:
        return False
    rest = [competition.without(more, index) for index in shapes]
    worth = max((competition.score(each) - competition.score(more) for each in rest if each is not None), default=0.0)
    return gain < min(MENDED_SHARE * worth, MENDED)
