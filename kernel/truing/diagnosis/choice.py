"""The decision between exact fits: how many causes, which, and what this record does not exclude beside them.

One more cause is believed where its gain is larger than noise alone would give the search, where noise with a memory
is no better word for it, and where it carries over to rows left out. Near the winner is what lies within ``CLOSE``
score units, or within ``SURE`` standard errors of the difference row by row (Q. H. Vuong, Likelihood ratio tests for
model selection and non-nested hypotheses, Econometrica 57, 1989, 307).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.alarms import OUTSIDE
from truing.diagnosis.causes import Cause
from truing.diagnosis.chance import law_of
from truing.diagnosis.chosen import Chosen, Law, Rival
from truing.diagnosis.competition import MOST_CAUSES, Competition, differ, exchange
from truing.diagnosis.exact import EXACTLY, Fit, fit
from truing.diagnosis.folds import Folds, carries_over, ends_of, folds_of
from truing.diagnosis.records import FEWEST_READINGS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

ANY_LEVEL = 0.015
FURTHER_LEVEL = 0.01
CLOSE = 6.0
"""Explanations less far behind in score are not excluded (a Bayes factor of about 20)."""
SURE = sqrt(CLOSE) / 2
"""Standard errors of the difference of two scores within which it does not decide.

Where what is left is noise, a difference d has the standard error 2 sqrt(d), so that this is ``CLOSE`` once more. Where
the rows contradict one another, because something else is wrong, the standard error is larger and more stays open.
"""
NEARLY = 4.0
"""An addition to the winner that is less far behind in score may well be a further cause."""
LEAST_GAIN = 3.0
"""What a step must be better by in any case: below it, that there is nothing more is hardly less likely."""
WANDER = 6.0
"""What a cause must be better by, in score, than noise with a memory of its own."""
CERTAIN = 60.0
"""A gain that needs no simulation."""
CARRIED = 1.0
"""Standard errors by which the error of rows left out must fall."""
MANY_CURVES = 20
"""A cause with more independent curves is a wave of any period."""
ROUGH, MENDED = 0.25, 45.0
"""A registered cause beside a shape must gain such a share of what the shape gains, or so much: a shape is rough, and
what mends it a little is no cause."""
NEARLY_ALL = 0.97
"""Share of the sum of squares that a shape takes away from which on what is registered stands in its place."""
ALIKE = 1.0
"""Sum of squares, in units of the noise, by which two explanations differ that are one on this record."""
TWIN = 0.98
"""Share of a curve that a shape must draw to be a vaguer word for it."""
RIVALS = 24


@dataclass(frozen=True)
class _Step:
    """One step of the decision: the law of its gains, and whether it was believed."""

    law: Law
    is_believed: bool


def choose(made: Competition, *, seed: int) -> Chosen:
    """Decide how many causes there are and which, and gather what is near."""
    best, law, p_further = _steps(made, seed)
    if best.causes:
        best = _named_weakest(made, _registered(made, _exchanged(made, best)))
    made.again([best], EXACTLY)
    best = made.known[best.key]
    rivals = _rivals(made, best)
    same = _same(made, best)
    return Chosen(made, polished(made, best), tuple(_polished_rivals(made, best, rivals)), same, law, p_further)


def _steps(made: Competition, seed: int) -> tuple[Fit, Law, float | None]:
    """Go from nothing to more and more causes, as long as a step is believed; a step may be of two causes at once."""
    at, first, p_further = made.null, Law(np.zeros(0), 1.0), None
    is_short = min(made.sample.rows, made.sample.machine.records.readings) < FEWEST_READINGS
    folds = folds_of(made.sample)
    while len(at.causes) < MOST_CAUSES:
        taken = None
        for steps in (1, 2):
            for more in _candidates(made, at, len(at.causes) + steps):
                step = _step(made, at, more, folds, seed=seed + 10 * len(at.causes) + steps)
                if not at.causes and steps == 1:
                    first = step.law
                if step.is_believed and not is_short:
                    taken = more, step.law
                    break
            if taken is not None:
                break
        if taken is None:
            break
        if at.causes:
            p_further = taken[1].p_value
        elif len(taken[0].causes) == 2:
            first = taken[1]
        at = taken[0]
    return at, first, p_further


def _candidates(made: Competition, at: Fit, size: int) -> Iterator[Fit]:
    """Give what may follow an explanation: the best of so many causes; before a shape, what is registered and near it.

    A polynomial draws anything. What is registered and draws nearly all of it is the better word, and a shape is then
    what is left beside it.
    """
    best = _best(made, size)
    if best is None or not any(_draws_anything(cause) and cause.tag not in at.key for cause in best.causes):
        yield from [] if best is None else [best]
        return
    null = made.null
    drawn = NEARLY_ALL * (_squares(best, null) - _squares(best, best))
    named = made.ranked(
        lambda found: (
            len(at.causes) < len(found.causes) <= size + 1
            and all(cause.effect is not None for cause in found.causes)
            and _squares(best, null) - _squares(best, found) >= drawn
        )
    )
    yield from named[:1]
    if at.causes and all(cause.effect is not None for cause in at.causes) and _is_nearly(best, at, null, drawn):
        yield from made.ranked(lambda found: len(found.causes) == size and found.key > at.key)[:1]
        return
    yield best


def _draws_anything(cause: Cause) -> bool:
    """Whether a cause is a polynomial of covariates that nobody registered."""
    return cause.shape is not None and cause.shape.kind in {"trend", "product"}


def _is_nearly(best: Fit, at: Fit, null: Fit, drawn: float) -> bool:
    """Whether what is registered draws nearly all that the best explanation draws, so that it stays."""
    return _squares(best, null) - _squares(best, at) >= drawn


def _squares(judge: Fit, found: Fit) -> float:
    """Return the sum of squares that an explanation leaves, in the noise that another one leaves."""
    return float(np.sum((judge.sample.roots(judge.left) * found.left) ** 2))


def _best(made: Competition, size: int) -> Fit | None:
    """Return the best explanation of so many causes in which every input is needed outside of its band."""
    sized = made.ranked(lambda found: len(found.causes) == size and _is_sensible(found))
    if not sized:
        return None
    named = next((found for found in sized if not _shifts_inputs(found)), None)
    if _shifts_inputs(sized[0]) and named is not None and made.score(named) < made.score(sized[0]) + CLOSE:
        return named
    return sized[0]


def _shifts_inputs(found: Fit) -> bool:
    return any(cause.tolerated >= 0 for cause in found.causes)


def _is_sensible(found: Fit) -> bool:
    """Whether inputs that are named lie outside of their bands: what lies inside is calibrated, not named."""
    pairs = zip(found.causes, found.values, strict=True)
    return all(abs(float(values[0])) > OUTSIDE for cause, values in pairs if cause.tolerated >= 0)


def _step(made: Competition, at: Fit, more: Fit, folds: Folds, *, seed: int) -> _Step:
    """Judge one step: chance, memory, rows left out; a registered cause that mends a rough shape is none."""
    gain = made.score(at) - made.score(more)
    if gain <= 0:
        return _Step(law_of(made, at, more, seed=seed) if not at.causes else Law(np.zeros(0), 1.0), False)
    is_certain = bool(at.causes) and gain > CERTAIN
    law = Law(np.zeros(0), 1 / 300) if is_certain else law_of(made, at, more, seed=seed)
    level = FURTHER_LEVEL if at.causes else ANY_LEVEL
    is_believed = (
        law.p_value <= level
        and gain >= LEAST_GAIN
        and made.own_score(at) - made.own_score(more) >= (WANDER if at.causes else 0.0)
        and not _mends(made, at, more, gain)
        and carries_over(at, more, made.extended, folds) >= CARRIED
        and not _beats(made, at, more)
    )
    return _Step(law, is_believed)


def _beats(made: Competition, at: Fit, more: Fit) -> bool:
    """Whether a further wave only beats with one that is there: then it does not carry over to the ends."""
    before, after = (sum(made.tries.get(cause.tag, 1.0) > MANY_CURVES for cause in each.causes) for each in (at, more))
    return after > before > 0 and carries_over(at, more, made.extended, ends_of(made.sample)) < 2 * CARRIED


def _mends(made: Competition, at: Fit, more: Fit, gain: float) -> bool:
    """Whether what is added only mends what a shape that nobody registered leaves."""
    shapes = [place for place, cause in enumerate(more.causes) if cause.shape is not None]
    if not shapes or not at.key < more.key or not at.causes:
        return False
    rest = [made.without(more, place) for place in shapes]
    worth = max((made.score(each) - made.score(more) for each in rest if each is not None), default=0.0)
    return gain < min(ROUGH * worth, MENDED)


def _exchanged(made: Competition, best: Fit) -> Fit:
    """Exchange every cause of the winner for every other one, and take what is better."""
    for _ in range(2):
        for place in range(len(best.causes)):
            exchange(made, best, place)
        kinds = _kinds(best)
        alike = [found for found in made.ranked(_is_sensible) if _kinds(found) == kinds]
        top = alike[0] if alike else best
        made.again([top], EXACTLY)
        if top.key == best.key:
            break
        best = made.known[top.key]
    return best


def _kinds(found: Fit) -> tuple[int, int, int]:
    """Return how many effects, inputs and shapes an explanation has."""
    shapes = sum(cause.shape is not None for cause in found.causes)
    inputs = sum(cause.tolerated >= 0 for cause in found.causes)
    return len(found.causes) - shapes - inputs, inputs, shapes


def _registered(made: Competition, best: Fit) -> Fit:
    """Return the fewest registered causes that are about as good as a shape that nobody registered."""
    if all(cause.is_registered for cause in best.causes):
        return best
    near = made.ranked(
        lambda found: (
            0 < len(found.causes) <= len(best.causes) + 1
            and all(cause.effect is not None for cause in found.causes)
            and made.score(found) < made.score(best) + CLOSE
        )
    )
    return min(near, key=lambda found: (len(found.causes), made.score(found)), default=best)


def _named_weakest(made: Competition, best: Fit) -> Fit:
    """Return the explanation under the weakest of its names, where several causes draw one curve."""
    alike = [found for found in _like(made, best) if made.score(found) < made.score(best) + 1.0]
    return min([best, *alike], key=lambda found: sorted(cause.weakest_first for cause in found.causes))


def _like(made: Competition, best: Fit) -> Iterator[Fit]:
    """Give explanations that exchange one cause for another one and draw the same on this record."""
    for found in made.known.values():
        own = found.key - best.key
        is_other = len(found.causes) == len(best.causes) and len(own) == 1
        if is_other and all(cause.effect is not None for cause in found.causes) and differ(best, found) < ALIKE:
            yield found


def _same(made: Competition, best: Fit) -> dict[str, tuple[str, ...]]:
    """Return by cause of the winner the names of others that draw its curve as it was fitted."""
    names: dict[str, list[str]] = {}
    for found in _like(made, best):
        (gone,) = (cause for cause in best.causes if cause.tag not in found.key)
        (other,) = (cause for cause in found.causes if cause.tag not in best.key)
        if other.name != gone.name:
            names.setdefault(gone.tag, []).append(other.name)
    return {tag: tuple(dict.fromkeys(every)) for tag, every in names.items()}


def unsure(one: Fit, other: Fit) -> float:
    """Return the standard error of the difference of two scores, from how it differs from row to row."""
    squares = [(each.sample.roots(each.left) * each.left) ** 2 for each in (one, other)]
    share = one.sample.total / one.sample.rows
    return sqrt(one.sample.rows) * float(np.std(squares[0] - squares[1])) / sqrt(max(share, 1e-300))


def _rivals(made: Competition, best: Fit) -> list[Rival]:
    """Return what lies near the winner, is no larger, and is neither another name for it nor a vaguer word."""
    if not best.causes:
        return []
    alike = {found.key for found in _like(made, best)}
    top = made.score(best)
    near: list[Rival] = []
    for found in made.ranked(lambda each: bool(each.causes) and each.key != best.key and _is_sensible(each)):
        if made.score(found) - top > 10 * CLOSE or len(near) >= RIVALS:
            break
        if found.key in alike or not _is_near(made, best, found):
            continue
        near.append(Rival(found, max(0.0, made.score(found) - top)))
    return near


def _is_near(made: Competition, best: Fit, found: Fit) -> bool:
    """Whether an explanation is a rival of the winner."""
    behind = made.score(found) - made.score(best)
    if best.key < found.key:
        added = [cause for cause in found.causes if cause.tag not in best.key]
        return behind < NEARLY and len(added) == 1 and added[0].effect is not None
    if len(found.causes) > len(best.causes) or (found.key < best.key and behind >= CLOSE):
        return False
    if _shifts_inputs(found) and not _shifts_inputs(best):
        return False
    if behind >= max(CLOSE, SURE * unsure(best, found)):
        return False
    return not _is_vaguer(made, best, found) and not _acts_beside(made, best, found)


def _is_vaguer(made: Competition, best: Fit, found: Fit) -> bool:
    """Whether a shape that nobody registered draws what the winner has in its place."""
    shapes = [cause for cause in found.causes if cause.shape is not None and cause.tag not in best.key]
    gone = [place for place, cause in enumerate(best.causes) if cause.tag not in found.key]
    if not shapes or any(best.causes[place].shape is not None for place in gone):
        return False
    wanted = _curve_of(made, best, gone)
    columns = [column for cause in shapes for column in _columns_of(made, found, cause)]
    basis = np.linalg.qr(np.column_stack([*columns, made.sample.drawn]))[0]
    drawn = basis.T @ wanted
    return float(drawn @ drawn) >= TWIN * float(wanted @ wanted)


def _curve_of(made: Competition, found: Fit, places: list[int]) -> Matrix:
    """Return what some causes of an explanation add to it, in units of the noise."""
    kept = [place for place in range(len(found.causes)) if place not in places]
    causes, values = [found.causes[place] for place in kept], [found.values[place] for place in kept]
    (without,) = made.extended.at(causes, [(values, found.moved)])
    (whole,) = made.extended.at(found.causes, [(found.values, found.moved)])
    return np.nan_to_num(made.sample.left(without) - made.sample.left(whole))


def _columns_of(made: Competition, found: Fit, cause: Cause) -> Iterator[Matrix]:
    """Give the terms of a shape as it was fitted, in units of the noise."""
    shape = cause.shape
    if shape is None:
        return
    values = found.of(cause)
    records = made.sample.machine.records
    terms = shape.terms([float(values[place]) for place in cause.shapes], records.covariates)
    for name in shape.results:
        for term in terms:
            added = {each: np.zeros(len(records)) for each in records.measured}
            added[name] = term.values
            yield made.sample.curve(added)


def _acts_beside(made: Competition, best: Fit, found: Fit) -> bool:
    """Whether a rival draws something else than the winner does: both together are far better than the winner."""
    union = made.known.get(best.key | found.key)
    return union is not None and made.score(union) < made.score(best) - CLOSE


def polished(made: Competition, found: Fit) -> Fit:
    """Fit an explanation with the memory of the noise taken out: better estimates, and intervals that hold."""
    white = made.sample.white()
    again = fit(white, made.extended, found.causes, found.values, found.inputs)
    return again if again is not None else replace(found.in_sample(white))


def _polished_rivals(made: Competition, best: Fit, rivals: list[Rival]) -> Iterator[Rival]:
    for rival in rivals:
        yield Rival(polished(made, rival.fit), rival.behind)
