"""The search: explanations of up to five causes, each fitted exactly, compete for what the readings say.

Forward, with what is on so far on: the best single causes; all pairs of the best of them, because two can mask one
another; every other cause beside the best singles, with its curves as they are there; then one more and one more beside
the best so far, and what is no longer needed goes. At the end every cause of the best is exchanged for every other, the
others held where they are and refitted: one of the two alone may end in another basin.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from truing.diagnosis.causes import Candidate
from truing.diagnosis.competition import MARGIN, MOST_CAUSES, RENEWED, TO_THE_END, Competition, Start, beside
from truing.diagnosis.exact import CLOSELY
from truing.diagnosis.fitted import Fit, differ
from truing.studies.bench import StepProgress, unheard

SINGLES = 12
"""So many of the most promising causes are fitted alone, and all registered ones that promise anything."""
BEAM = 8
"""Of so many of the best singles all pairs are fitted."""
FIRSTS = 4
"""Beside so many of the best singles all other causes are looked at."""
JOINED = 6
"""So many of the most promising causes are fitted beside an explanation."""
STARTS = 2
"""So many of the best explanations of one size get one more cause."""


def search(competition: Competition, done: StepProgress = unheard) -> None:
    """Fit everything that may explain the record; ``done`` hears of the stages."""
    stages = (
        (_singles, 0.6, "causes alone"),
        (_pairs, 0.7, "pairs of the best causes"),
        (_beside_firsts, 0.75, "looks beside one of the best causes"),
        (_more, 0.8, "looks for one cause more"),
        (_exchanged, 0.85, "exchanges"),
        (_exactly, 0.95, TO_THE_END),
    )  # of the budget of calls every stage may spend so much, all before it included
    for count, (stage, share, competition.stage) in enumerate(stages):
        done(count, len(stages))
        competition.extended.budget.share = share
        stage(competition)
        if count < len(stages) - 1:
            competition.renew()
            competition.refresh()
    competition.stage, competition.extended.budget.share = "trials of the decision", 1.0


def _singles(competition: Competition) -> None:
    seen = competition.look(competition.null)
    order = competition.promising(seen)
    chosen = [*order[:SINGLES], *(cause for cause in order[SINGLES:] if cause.is_registered)]
    competition.fit_each(
        [start for cause in chosen for start in beside(competition.null, cause, seen[cause.tag].starts)]
    )


def _distinct(
    competition: Competition, size: int, count: int, accept: Callable[[Fit], bool] = lambda _: True
) -> list[Fit]:
    """Return the best accepted explanations of one size that do not draw the same."""
    kept: list[Fit] = []
    for fit in competition.ranked(lambda each: len(each.causes) == size and accept(each)):
        if all(differ(fit, other) > 1.0 for other in kept):
            kept.append(fit)
        if len(kept) == count:
            break
    return kept


def _pairs(competition: Competition) -> None:
    several = {fit.key: fit for fit in (*_distinct(competition, 1, BEAM), *_registered(competition, BEAM))}
    placed = {cause for fit in several.values() for cause in fit.causes if cause.kept}
    for at in list(several.values())[:BEAM]:
        competition.forward(at, JOINED, placed.__contains__)
    pairs = sorted(combinations(several.values(), 2), key=lambda pair: sum(map(competition.score, pair)))
    competition.fit_each(
        [
            Start(one.causes + other.causes, one.values + other.values, one)
            for one, other in pairs
            if one.causes[0].is_registered or other.causes[0].is_registered  # two shapes: no second name is needed
        ]
    )


def _registered(competition: Competition, count: int) -> list[Fit]:
    """Return the best single causes that somebody registered and that do not draw the same."""
    return _distinct(competition, 1, count, accept=lambda fit: fit.causes[0].is_registered)


def _beside_firsts(competition: Competition) -> None:
    firsts = {fit.key: fit for fit in (*_distinct(competition, 1, FIRSTS), *_registered(competition, FIRSTS // 2))}
    for at in firsts.values():
        competition.forward(at, JOINED, _is_quick)


def _is_quick(cause: Candidate) -> bool:
    """Whether a cause has few curves: waves of any period are looked for beside the best explanation only."""
    return all(number.name != "frequency" for number in cause.numbers)


def _more(competition: Competition) -> None:
    now = competition.ranked()[0]
    while 1 <= len(now.causes) < MOST_CAUSES:
        for at in _distinct(competition, len(now.causes), STARTS):
            competition.forward(at, JOINED)
        best = competition.best(len(now.causes) + 1)
        if best is None or competition.score(best) >= competition.score(now):
            return
        competition.backward(best)
        competition.renew()
        competition.refresh()
        now = competition.ranked()[0]


def _exchanged(competition: Competition) -> None:
    for _ in range(2):
        now = competition.ranked()[0]
        for index in range(len(now.causes)):
            exchange(competition, now, index)
        if competition.ranked()[0].key == now.key:
            return


def exchange(competition: Competition, now: Fit, index: int) -> None:
    """Fit an explanation with one of its causes exchanged for others, the rest refitted without it and held; once."""
    if (now.key, now.causes[index].tag) in competition.exchanged:
        return
    competition.exchanged.add((now.key, now.causes[index].tag))
    rest = competition.without(now, index)
    if rest is not None:
        competition.forward(rest, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)
    if len(now.causes) > 1:
        causes = now.causes[:index] + now.causes[index + 1 :]
        values = now.values[:index] + now.values[index + 1 :]
        (predicted,) = competition.extended.at(causes, [(values, now.moved)])
        left = competition.sample.left(predicted)
        if np.isfinite(left).all():
            cost = competition.sample.cost(left, now.inputs)
            held = Fit(causes, values, now.inputs, predicted, left, cost, competition.sample)
            competition.forward(held, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)


def _exactly(competition: Competition) -> None:
    """Fit to the end what lies near, the best of every size, and single causes: a rough fit may stop far from it."""
    top = competition.score(competition.ranked()[0])
    near = [fit for fit in competition.ranked()[:RENEWED] if competition.score(fit) < top + 4 * MARGIN]
    sized = [best for size in range(1, MOST_CAUSES) if (best := competition.best(size)) is not None]
    competition.again([competition.null, *near, *sized, *_registered(competition, BEAM)], CLOSELY)
