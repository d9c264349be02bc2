"""The decision between exact fits: how many causes, which, and what this record does not exclude beside them.

Near the winner is what lies within ``CLOSE`` score units, or within ``SURE`` standard errors of the difference row by
row (Q. H. Vuong, Likelihood ratio tests for model selection and non-nested hypotheses, Econometrica 57, 1989, 307).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate
from truing.diagnosis.chance import Law, law_of
from truing.diagnosis.competition import Competition
from truing.diagnosis.fitted import Fit, differ
from truing.diagnosis.folds import carries_over, folds_of
from truing.diagnosis.intervals import certainty_of, may_be_zero, places_of
from truing.diagnosis.search import exchange
from truing.diagnosis.steps import CARRIED, Decision, draws_anything, is_sensible, shapes_in, shifts_inputs, steps_from

CLOSE = 6.0
"""Explanations less far behind in score are not excluded (a Bayes factor of about 20)."""
SURE = sqrt(CLOSE) / 2
"""Standard errors of the difference of two scores within which it does not decide.

Where what is left is noise, a difference d has the standard error 2 sqrt(d), so that this is ``CLOSE`` once more. Where
the rows contradict one another, because something else is wrong, the standard error is larger and more stays open.
"""
MAYBE = 0.1
"""Chance that noise alone gives the search as much, up to which one more cause may be there as well."""
ALIKE = 1.0
"""Sum of squares, in units of the noise, by which two explanations differ that are one on this record."""
TWIN = 0.98
"""Share of a curve that a shape must draw to be a vaguer word for it, unless it fits better by ``CLOSE``."""
MOST_RIVALS, MOST_CHOICES = 24, 2
"""So many rivals are kept, and so often it is decided anew after causes were exchanged."""
SURELY = 30.0
"""What a cause must be worth, in score, that is named although its interval holds zero."""


@dataclass(frozen=True)
class Rival:
    """An explanation that is not excluded, and how far it lies behind in score."""

    fit: Fit
    behind: float


@dataclass(frozen=True)
class Chosen:
    """The answer of the competition: ``best`` as fitted with the memory of the noise taken out, and its rivals.

    ``same`` holds, by the tag of a cause of ``best``, the names of other causes that draw its curve as it was fitted.
    ``law`` is that of the first step; ``p_second`` is the chance of the last further cause, None where there is none.
    ``of_some_rows`` is the same decision on the rows of a long record that were searched.
    """

    competition: Competition
    best: Fit
    rivals: tuple[Rival, ...]
    same: Mapping[str, tuple[str, ...]]
    law: Law
    p_second: float | None
    of_some_rows: Chosen | None = None

    @property
    def searched(self) -> Chosen:
        """The decision on the rows that were searched: this one, but for a long record."""
        return self.of_some_rows or self

    @property
    def rows_searched(self) -> float:
        """How many rows there are for each one that was searched."""
        return self.competition.sample.rows / self.searched.competition.sample.rows

    @property
    def p_any(self) -> float:
        """The chance that noise alone gives the search as much as the best explanation."""
        return self.law.p_value

    @property
    def null(self) -> Fit:
        """The model as it is, calibrated within its tolerances."""
        return self.competition.null


def choose(competition: Competition, *, seed: int) -> Chosen:
    """Decide how many causes there are and which, and gather what is near."""
    decision = steps_from(competition, Decision(competition.null, Law(np.zeros(0), 1.0)), seed=seed)
    for _ in range(MOST_CHOICES if decision.at.causes else 0):
        before = len(competition.known)
        best = _exchanged(competition, decision.at)
        if best.key == decision.at.key and len(competition.known) == before:
            break
        again = steps_from(competition, replace(decision, at=best), seed=seed + 1)
        if again.at.key == decision.at.key:
            break
        decision = again
    best = _certain(competition, competition.backward(decision.at))
    if best.causes:
        named = _registered(competition, best)
        best = _taking_least(
            competition, _named_weakest(competition, best if named.key == best.key else _exchanged(competition, named))
        )
    best = competition.exact(best)
    near = [Rival(competition.exact(rival.fit), rival.behind) for rival in _rivals(competition, best, seed)]
    near = [rival for rival in near if not _adds_nothing(competition, best, rival.fit)]
    return Chosen(competition, best, tuple(near), _same(competition, best), decision.law, decision.p_further)


def _certain(competition: Competition, best: Fit) -> Fit:
    """Leave out effects whose every amplitude may as well be zero, unless without them much is lost.

    The interval of an amplitude that saturates may hold zero although nothing else will do.
    """
    while best.causes:
        best = competition.exact(best)
        certainty = certainty_of(best, competition.extended)
        for index, cause in enumerate(best.causes):
            less = competition.without(best, index) if cause.effect is not None else None
            if less is None or competition.score(less) - competition.score(best) >= SURELY:
                continue
            if may_be_zero(best, certainty, cause):
                best = less
                break
        else:
            return best
    return best


def _adds_nothing(competition: Competition, best: Fit, fit: Fit) -> bool:
    """Whether an explanation is the winner and a cause whose every amplitude may as well be zero."""
    added = [cause for cause in fit.causes if cause.tag not in best.key] if best.key < fit.key else []
    return any(may_be_zero(fit, certainty_of(fit, competition.extended), cause) for cause in added)


def _exchanged(competition: Competition, best: Fit) -> Fit:
    """Exchange every cause of the winner for every other one, and take what is better."""
    kinds = _kinds(best)
    for _ in range(2):
        for index in range(len(best.causes)):
            exchange(competition, best, index)
        top = next(iter(competition.ranked(lambda fit: is_sensible(fit) and _kinds(fit) == kinds)), best)
        if top.key == best.key:
            break
        best = competition.exact(top)
    return competition.exact(best)


def _kinds(fit: Fit) -> tuple[int, int, int]:
    """Return how many effects, inputs and shapes an explanation has."""
    shapes = sum(cause.shape is not None for cause in fit.causes)
    inputs = sum(cause.tolerated >= 0 for cause in fit.causes)
    return len(fit.causes) - shapes - inputs, inputs, shapes


def _registered(competition: Competition, best: Fit) -> Fit:
    """Return the fewest registered causes that are about as good as a shape that nobody registered."""
    if all(cause.is_registered for cause in best.causes):
        return best
    near = competition.ranked(
        lambda fit: (
            0 < len(fit.causes) <= len(best.causes) + 1
            and all(cause.effect is not None for cause in fit.causes)
            and competition.score(fit) < competition.score(best) + CLOSE
        )
    )
    return min(near, key=lambda fit: (len(fit.causes), competition.score(fit)), default=best)


def _taking_least(competition: Competition, best: Fit) -> Fit:
    """Return, of shapes over the same covariates that are about as good beside names, the one that leaves them most."""
    if shapes_in(best) in (0, len(best.causes)):
        return best
    near = [fit for fit in competition.known.values() if competition.score(fit) < competition.score(best) + CLOSE]
    alike = [fit for fit in near if len(fit.causes) == len(best.causes) and _says_the_same(best, fit)]
    return max(alike, key=lambda fit: _worth_of_names(competition, fit))


def _worth_of_names(competition: Competition, fit: Fit) -> float:
    """Return what the score loses at least without one of the causes that have a name."""
    named = (index for index, cause in enumerate(fit.causes) if cause.shape is None)
    less = (competition.without(fit, index) for index in named)
    return min((competition.score(each) - competition.score(fit) for each in less if each is not None), default=0.0)


def _named_weakest(competition: Competition, best: Fit) -> Fit:
    """Return the explanation under the weakest of its names, where several causes draw one curve."""
    alike = [fit for fit in _like(competition, best) if competition.score(fit) < competition.score(best) + 1.0]
    return min([best, *alike], key=lambda fit: sorted(cause.weakest_first for cause in fit.causes))


def _like(competition: Competition, best: Fit) -> Iterator[Fit]:
    """Give explanations that exchange one cause for another one and draw the same, the inputs no farther off."""
    for fit in competition.known.values():
        own = fit.key - best.key
        is_other = len(fit.causes) == len(best.causes) and len(own) == 1 and fit.cost < best.cost + CLOSE
        if is_other and all(cause.effect is not None for cause in fit.causes) and differ(best, fit) < ALIKE:
            yield fit


def _same(competition: Competition, best: Fit) -> dict[str, tuple[str, ...]]:
    """Return by cause of the winner the names of others that draw its curve as it was fitted.

    One with more amplitudes that the record tells apart holds the winner as a special case: that is no other name.
    """
    names: dict[str, list[str]] = {}
    for fit in _like(competition, best):
        (gone,) = (cause for cause in best.causes if cause.tag not in fit.key)
        (other,) = (cause for cause in fit.causes if cause.tag not in best.key)
        if other.name != gone.name and _felt(fit, other) <= _felt(best, gone):
            names.setdefault(gone.tag, []).append(other.name)
    return {tag: tuple(dict.fromkeys(every)) for tag, every in names.items()}


def _felt(fit: Fit, cause: Candidate) -> int:
    """Return how many directions among the amplitudes of a cause this record feels, each moved by as much as it is."""
    places = [places_of(fit, cause)[amplitude] for amplitude in cause.amplitudes]
    drawn = fit.sample.curve(fit.slopes, fit.predicted)[:, places] * np.concatenate(fit.values)[places]
    drawn *= fit.sample.roots(fit.left)[:, None]
    return int((np.linalg.svd(drawn, compute_uv=False) > ALIKE).sum())


def unsure(one: Fit, other: Fit) -> float:
    """Return the standard error of the difference of two scores, from how it differs from row to row."""
    losses = [each.sample.losses(each.left, each.left) for each in (one, other)]
    return sqrt(one.sample.rows) * float(np.std(losses[0] - losses[1]))


def _rivals(competition: Competition, best: Fit, seed: int) -> list[Rival]:
    """Return what lies near the winner and is neither another name for it nor a vaguer word.

    What may be there as well is not told where it, in the place of a cause of the winner, explains as much; a shape
    not beside a registered one.
    """
    if not best.causes:
        return []
    alike = {fit.key for fit in _like(competition, best)}
    top = competition.score(best)
    near: list[Fit] = []
    for fit in competition.ranked(lambda fit: bool(fit.causes) and not best.key <= fit.key and is_sensible(fit)):
        if competition.score(fit) - top > 10 * CLOSE or len(near) >= MOST_RIVALS:
            break
        if fit.key not in alike and _is_near(competition, best, fit):
            near.append(fit)
    more = [fit for fit in _with_more(competition, best, seed) if not any(fit.key > other.key for other in near)]
    return [Rival(fit, max(0.0, competition.score(fit) - top)) for fit in sorted((*near, *more), key=competition.score)]


def _with_more(competition: Competition, best: Fit, seed: int) -> list[Fit]:
    """Return the winner with one cause more that may be there as well; with a shape where it is with no effect."""
    wider = [
        fit
        for fit in competition.ranked(lambda fit: best.key < fit.key and len(fit.causes) == len(best.causes) + 1)
        if all(cause.tolerated < 0 or cause.tag in best.key for cause in fit.causes)
    ]
    if not wider:
        return []
    law, folds = law_of(competition, best, wider[0], seed=seed), folds_of(competition.sample)
    near = [
        fit
        for fit in wider
        if (not shapes_in(best) or shapes_in(fit) == shapes_in(best))
        and law.p_of(_gained(competition, best, fit)) <= MAYBE
        and carries_over(best, fit, competition.extended, folds) >= CARRIED
    ]
    return [fit for fit in near if shapes_in(fit) == shapes_in(best)] or near


def _gained(competition: Competition, best: Fit, fit: Fit) -> float:
    """Return by how much the winner is better with one cause more, in noise with a memory in its own noise as well."""
    gain = competition.score(best) - competition.score(fit)
    return (
        max(gain, competition.own_score(best) - competition.own_score(fit)) if competition.sample.has_memory else gain
    )


def _is_near(competition: Competition, best: Fit, fit: Fit) -> bool:
    """Whether an explanation is a rival of the winner."""
    behind = competition.score(fit) - competition.score(best)
    if len(fit.causes) > len(best.causes) or (fit.key < best.key and behind >= CLOSE):
        return False
    if (shifts_inputs(fit) and not shifts_inputs(best)) or shapes_in(fit) > max(shapes_in(best), 1):
        return False
    if behind >= max(CLOSE, SURE * unsure(best, fit)):
        return False
    return not _is_vaguer(competition, best, fit) and not _acts_beside(competition, best, fit)


def _is_vaguer(competition: Competition, best: Fit, fit: Fit) -> bool:
    """Whether a shape that nobody registered draws what the winner has in its place, and fits no better.

    A polynomial always fits a little better: it draws anything.
    """
    shapes = [cause for cause in fit.causes if cause.shape is not None and cause.tag not in best.key]
    gone = [index for index, cause in enumerate(best.causes) if cause.tag not in fit.key]
    if not shapes or all(best.causes[index].shape is not None for index in gone):
        return _says_the_same(best, fit)
    if fit.cost < best.cost - CLOSE and not any(draws_anything(cause) for cause in shapes):
        return False
    wanted = _curve_of(competition, best, gone)
    columns = [column for cause in shapes for column in _columns_of(competition, fit, cause)]
    basis = np.linalg.qr(np.column_stack([*columns, competition.sample.drawn]))[0]
    drawn = basis.T @ wanted
    return float(drawn @ drawn) >= TWIN * float(wanted @ wanted)


def _says_the_same(best: Fit, fit: Fit) -> bool:
    """Whether two explanations have the same registered causes, and shapes over the same covariates."""
    said = [
        {cause.name if cause.shape is None else cause.shape.depends_on for cause in each.causes} for each in (best, fit)
    ]
    return said[0] == said[1] and shapes_in(best) > 0


def _curve_of(competition: Competition, fit: Fit, places: list[int]) -> Matrix:
    """Return what some causes of an explanation add to it, in units of the noise."""
    kept = [index for index in range(len(fit.causes)) if index not in places]
    causes, values = [fit.causes[index] for index in kept], [fit.values[index] for index in kept]
    (without,) = competition.extended.at(causes, [(values, fit.moved)])
    (whole,) = competition.extended.at(fit.causes, [(fit.values, fit.moved)])
    return np.nan_to_num(competition.sample.left(without) - competition.sample.left(whole))


def _columns_of(competition: Competition, fit: Fit, cause: Candidate) -> Iterator[Matrix]:
    """Give the terms of a shape as it was fitted, in units of the noise."""
    shape = cause.shape
    if shape is None:
        return
    values = fit.of(cause)
    records = competition.sample.machine.records
    terms = shape.terms([float(values[index]) for index in cause.shapes], records.covariates)
    for name in shape.results:
        for term in terms:
            added = {each: np.zeros(len(records)) for each in records.measured}
            added[name] = term.values
            yield competition.sample.curve(added)


def _acts_beside(competition: Competition, best: Fit, fit: Fit) -> bool:
    """Whether a rival draws something else than the winner does: both together are far better than the winner."""
    union = competition.known.get(best.key | fit.key)
    return union is not None and competition.score(union) < competition.score(best) - CLOSE
