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
from truing.diagnosis.competition import MARGIN, MOST_CAUSES, RENEWED, TO_THE_END, Competition
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


def search(made: Competition, done: StepProgress = unheard) -> None:
    """Fit everything that may explain the record; ``done`` hears of the stages."""
    stages = (
        (_singles, 0.6, "causes alone"),
        (_pairs, 0.7, "pairs of the best causes"),
        (_beside_firsts, 0.75, "looks beside one of the best causes"),
        (_more, 0.8, "looks for one cause more"),
        (_exchanged, 0.85, "exchanges"),
        (_exactly, 0.95, TO_THE_END),
    )  # of the budget of calls every stage may spend so much, all before it included
    for count, (stage, share, made.stage) in enumerate(stages):
        done(count, len(stages))
        made.extended.budget.share = share
        stage(made)
        if count < len(stages) - 1:
            made.renew()
            made.refresh()
    made.stage, made.extended.budget.share = "trials of the decision", 1.0


def _singles(made: Competition) -> None:
    seen = made.look(made.null)
    order = made.promising(seen)
    chosen = [*order[:SINGLES], *(cause for cause in order[SINGLES:] if cause.is_registered)]
    for cause in chosen:
        made.joined(made.null, cause, seen[cause.tag].starts)


def _distinct(made: Competition, size: int, count: int, accept: Callable[[Fit], bool] = lambda _: True) -> list[Fit]:
    """Return the best accepted explanations of one size that do not draw the same."""
    kept: list[Fit] = []
    for fit in made.ranked(lambda each: len(each.causes) == size and accept(each)):
        if all(differ(fit, other) > 1.0 for other in kept):
            kept.append(fit)
        if len(kept) == count:
            break
    return kept


def _pairs(made: Competition) -> None:
    several = {fit.key: fit for fit in (*_distinct(made, 1, BEAM), *_registered(made, BEAM))}
    placed = {cause for fit in several.values() for cause in fit.causes if cause.kept}
    for at in list(several.values())[:BEAM]:
        made.forward(at, JOINED, placed.__contains__)
    for one, other in sorted(combinations(several.values(), 2), key=lambda pair: sum(map(made.score, pair))):
        if one.causes[0].is_registered or other.causes[0].is_registered:  # two shapes: no second name is needed
            made.fitted(one.causes + other.causes, one.values + other.values, one)


def _registered(made: Competition, count: int) -> list[Fit]:
    """Return the best single causes that somebody registered and that do not draw the same."""
    return _distinct(made, 1, count, accept=lambda fit: fit.causes[0].is_registered)


def _beside_firsts(made: Competition) -> None:
    firsts = {fit.key: fit for fit in (*_distinct(made, 1, FIRSTS), *_registered(made, FIRSTS // 2))}
    for at in firsts.values():
        made.forward(at, JOINED, _is_quick)


def _is_quick(cause: Candidate) -> bool:
    """Whether a cause has few curves: waves of any period are looked for beside the best explanation only."""
    return all(number.name != "frequency" for number in cause.numbers)


def _more(made: Competition) -> None:
    now = made.ranked()[0]
    while 1 <= len(now.causes) < MOST_CAUSES:
        for at in _distinct(made, len(now.causes), STARTS):
            made.forward(at, JOINED)
        best = made.best(len(now.causes) + 1)
        if best is None or made.score(best) >= made.score(now):
            return
        made.backward(best)
        made.renew()
        made.refresh()
        now = made.ranked()[0]


def _exchanged(made: Competition) -> None:
    for _ in range(2):
        now = made.ranked()[0]
        for index in range(len(now.causes)):
            exchange(made, now, index)
        if made.ranked()[0].key == now.key:
            return


def exchange(made: Competition, now: Fit, index: int) -> None:
    """Fit an explanation with one of its causes exchanged for others, the rest refitted without it and held; once."""
    if (now.key, now.causes[index].tag) in made.exchanged:
        return
    made.exchanged.add((now.key, now.causes[index].tag))
    rest = made.without(now, index)
    if rest is not None:
        made.forward(rest, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)
    if len(now.causes) > 1:
        causes = now.causes[:index] + now.causes[index + 1 :]
        values = now.values[:index] + now.values[index + 1 :]
        (predicted,) = made.extended.at(causes, [(values, now.moved)])
        left = made.sample.left(predicted)
        if np.isfinite(left).all():
            held = Fit(causes, values, now.inputs, predicted, left, made.sample.cost(left, now.inputs), made.sample)
            made.forward(held, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)


def _exactly(made: Competition) -> None:
    """Fit to the end what lies near, the best of every size, and single causes: a rough fit may stop far from it."""
    top = made.score(made.ranked()[0])
    near = [fit for fit in made.ranked()[:RENEWED] if made.score(fit) < top + 4 * MARGIN]
    sized = [best for size in range(1, MOST_CAUSES) if (best := made.best(size)) is not None]
    made.again([made.null, *near, *sized, *_registered(made, BEAM)], CLOSELY)
