"""What this data does not exclude beside the winner: explanations that are near in the search, or near as exact fits.

The search ranks by columns, which stand for a cause at a few sizes. So the best causes and pairs of the ranking are
fitted with the model itself, and what is then near is no less an explanation than the winner. Near is within ``CLOSE``
score units, or within ``SURE`` standard errors of the difference as the single rows give it (Q. H. Vuong, Likelihood
ratio tests for model selection and non-nested hypotheses, Econometrica 57, 1989, 307). What is near and yet draws
something else, which the winner leaves, is a further cause and no rival.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from math import log, sqrt

import numpy as np

from truing.diagnosis.contest import Contest
from truing.diagnosis.decide import CLOSE, alternatives, is_vaguer
from truing.diagnosis.fit import Fit, fit, may_be_zero
from truing.diagnosis.hypotheses import Hypothesis, Kind
from truing.diagnosis.search import Solution, solve
from truing.errors import ConvergenceError

RANKED = 8
FITTED: Mapping[Kind, int] = {"one": 12, "two": 24}
"""So many of the best causes, and of the best pairs, are fitted exactly."""
WITHIN = 100.0
"""Score units behind the winner in the search beyond which nothing is fitted: exact fits differ from it by tens."""
SURE = sqrt(CLOSE) / 2
"""Standard errors of the difference of two scores within which it does not decide.

Where what is left is noise, a difference d has the standard error 2 sqrt(d), so that this is ``CLOSE`` once more. Where
the rows contradict one another, because something else is wrong, the standard error is larger and more stays open.
"""


@dataclass(frozen=True)
class Rival:
    """An explanation that is not excluded: its place in the contest, its exact fit if made, score units behind."""

    place: int
    own: Fit | None
    behind: float


def rivals_of(full: Contest, winner: int, best: Fit) -> list[Rival]:
    """Return the explanations that this data does not exclude beside the winner, ``best`` as fitted, the best first."""
    chosen, score = full.found.hypotheses[winner], full.found.score
    if chosen.kind == "none":
        return []
    found: list[Rival] = []
    for rank, place in enumerate(alternatives(full, winner)):
        has_more = set(chosen.key) < set(full.found.hypotheses[place].key)
        own = fit(full, place) if has_more or rank < RANKED else None
        if not (has_more and own is not None and _adds_nothing(own, chosen)):
            found.append(Rival(place, own, max(0.0, float(score[winner] - score[place]))))
    known = {rival.place for rival in found}
    found += _near_as_fitted(full, winner, best, known)
    return sorted(found, key=lambda rival: rival.behind)


def _adds_nothing(rival: Fit, chosen: Hypothesis) -> bool:
    """Whether what a rival has beside the chosen explanation may as well be zero."""
    pieces = enumerate(rival.hypothesis.pieces)
    more = [place for place, piece in pieces if piece.tag not in chosen.key and piece.kind == "term"]
    return bool(more) and all(may_be_zero(rival, place) for place in more)


def _near_as_fitted(full: Contest, winner: int, best: Fit, known: set[int]) -> Iterator[Rival]:
    """Give the causes and pairs that the search excludes and exact fits do not."""
    chosen, top = full.found.hypotheses[winner], exact_score(full, winner, best)
    for place in (place for place in _worth_a_fit(full, winner) if place not in known):
        try:
            own = fit(full, place)
        except ConvergenceError:
            continue
        behind = top - exact_score(full, place, own)
        if behind >= max(CLOSE, SURE * unsure(best, own)) or is_vaguer(full, own.hypothesis, chosen):
            continue
        has_all = not any(may_be_zero(own, number) for number in range(len(own.hypothesis.pieces)))
        if has_all and not _acts_beside(full, winner, own.hypothesis):
            yield Rival(place, own, max(0.0, behind))


def _acts_beside(full: Contest, winner: int, rival: Hypothesis) -> bool:
    """Whether a rival draws something else than the winner does: beside it, it is still worth its parameters.

    Then both act, and neither is another name for the other.
    """
    chosen = full.found.hypotheses[winner]
    more = tuple(piece for piece in rival.pieces if piece.tag not in chosen.key)
    both = solve(full.evidence, Hypothesis("two", (*chosen.pieces, *more), 0.0), full.found.setting[winner])
    gain = _likelihood(full, both) - _likelihood(full, full.solution(winner))
    return gain - sum(piece.size for piece in more) * log(full.evidence.rows) > CLOSE


def _worth_a_fit(full: Contest, winner: int) -> Iterator[int]:
    """Give the best single causes and pairs that are no larger than the winner; neither contains the other."""
    found, chosen = full.found, full.found.hypotheses[winner]
    for kind, most in FITTED.items():
        for place in islice(found.ranked(kind), most):
            rival = found.hypotheses[place]
            own, more = set(chosen.key) - set(rival.key), set(rival.key) - set(chosen.key)
            if (
                own
                and more
                and len(rival.pieces) <= len(chosen.pieces)
                and found.score[winner] - found.score[place] < WITHIN
            ):
                yield place


def exact_score(full: Contest, place: int, own: Fit) -> float:
    """Return the score of an explanation as fitted with the model itself, comparable to those of the search."""
    return float(full.found.score[place]) + _likelihood(full, own) - _likelihood(full, full.solution(place))


def _likelihood(full: Contest, fitted: Fit | Solution) -> float:
    """Return twice the logarithm of the likelihood and of the prior of the inputs, without what the filter decides."""
    evidence, total = full.evidence, -float(fitted.directions @ fitted.directions)
    for place, (left, rows) in enumerate(zip(fitted.innovations, evidence.counts, strict=True)):
        least = evidence.products[place][fitted.setting[place]].least
        total -= rows * log(max(float(left @ left), least, 1e-300) / rows)
    return total


def unsure(one: Fit, other: Fit) -> float:
    """Return the standard error of the difference of two scores, from how it differs from row to row."""
    squares = [np.concatenate(fitted.innovations) ** 2 for fitted in (one, other)]
    first, second = (each / max(float(each.mean()), 1e-300) for each in squares)
    return sqrt(len(first)) * float(np.std(first - second))
