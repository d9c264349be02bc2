"""What competes: everything that was fitted so far, its score, the noise that the fairest of it leaves; and the search.

Explanations of up to five causes, each fitted exactly, compete for what the readings say. The search goes forward, with
what is on so far on: the best single causes; all pairs of the best of them, because two can mask one another; every
other cause beside the best singles, with its curves as they are there; then one more and one more beside the best so
far, and what is no longer needed goes. At the end every cause of the best is exchanged for every other, the others held
where they are and refitted: one of the two alone may end in another basin.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain, combinations, compress
from math import lgamma, log, log1p
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, are_exclusive
from truing.diagnosis.conditional import ConditionalGain, look
from truing.diagnosis.curves import ResponseCurves
from truing.diagnosis.exact import CLOSELY, EXACTLY, ROUGHLY, fitting, held_without, nothing, refitting, together
from truing.diagnosis.extended import Extended, shape_added
from truing.diagnosis.fitted import Fit, differ, signs_of_wrong
from truing.diagnosis.learning import as_noise, learnt
from truing.diagnosis.ranking import SAME, lowest_first
from truing.diagnosis.sample import Sample, sample_of
from truing.studies.bench import StepProgress, unheard

MOST_CAUSES = 5
"""So many causes are named at most; what another one would explain stays in the remainder."""
MARGIN = 6.0
"""What every sign of a wrong explanation costs, in score: a Bayes factor of about 20."""
UNREGISTERED = 4.0
"""What a shape that nobody registered costs beside its numbers."""
LEAST_PROMISE = 4.0
"""A cause whose curves promise less, unpaid, is not fitted."""
WITHIN, RENEWED = 60.0, 40
"""Explanations within so much of the best are fitted again when the noise was learnt anew, and so many at most."""
FINER = 0.5
"""Directions of the inputs are looked for anew when the noise turns out so much finer."""
NOISE_SETTLED, MOST_RENEWALS = 0.02, 4
"""The noise is learnt anew until its scale changes by a smaller share, and so often at most."""
ROWS_PER_NUMBER = 4
"""Fewer rows for every number are followed by any curve, noise or not."""
AT_ONCE, ROWS_AT_ONCE = 8, 20_000
"""So many fits ask the model together, of records of no more than so many rows among all."""
MOVING_AT_ONCE = 64
"""So many fits of a model that moves ask it together: many machines take hardly longer than one."""
AGAIN, TO_THE_END = "fits in the noise that was learnt", "fits to the end"
"""What a budget that has ended leaves out, in words."""
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


def _any(_: Candidate) -> bool:
    return True


class Start(NamedTuple):
    """Where a fit begins: causes, their numbers in SI, and a fit that is near; see ``exact.fitting``."""

    causes: Sequence[Candidate]
    values: Sequence[Matrix]
    near: Fit | None


@dataclass
class Competition:
    """Everything that was fitted so far, by its causes, and the noise in which it was."""

    extended: Extended
    causes: tuple[Candidate, ...]
    sample: Sample
    curves: ResponseCurves
    known: dict[frozenset[str], Fit] = field(default_factory=dict)
    tries: dict[str, float] = field(default_factory=dict)
    stage: str = "causes alone"
    owned: dict[Fit, float] = field(default_factory=dict)
    paid: dict[Fit, float] = field(default_factory=dict)
    gains_seen: dict[frozenset[str], tuple[Matrix, dict[str, ConditionalGain | None]]] = field(default_factory=dict)
    exchanged: set[tuple[frozenset[str], str]] = field(default_factory=set)
    fresh: set[frozenset[str]] = field(default_factory=set)
    """What was fitted in the present noise."""
    begun: set[tuple[frozenset[str], tuple[float, ...]]] = field(default_factory=set)
    """What was fitted in any noise, with the whole numbers and places that it kept."""

    # ---- scores

    def price(self, fit: Fit) -> float:
        """Return what an explanation pays for its numbers, for the choice of causes and curves, and for its signs."""
        many, most = len(fit.causes), max(len(self.causes), len(fit.causes))
        choice = 2 * (lgamma(most + 1) - lgamma(many + 1) - lgamma(most - many + 1))
        if fit not in self.paid:
            self.paid[fit] = self.price_of_size(fit) + MARGIN * signs_of_wrong(fit)
        return choice + sum(self.price_of(cause) for cause in fit.causes) + self.paid[fit]

    def price_of(self, cause: Candidate) -> float:
        """Return what a cause pays for its numbers and for the choice among its independent curves."""
        own = cause.size * log(max(self.sample.rows, 2)) + 2 * log(max(self.tries.get(cause.tag, 1.0), 1.0))
        return own + (UNREGISTERED if cause.shape is not None else MARGIN if cause.tolerated >= 0 else 0.0)

    def price_of_size(self, fit: Fit) -> float:
        """Return what shapes that nobody registered pay for how much they draw: a large remainder is less likely.

        With a scale of its own every amplitude costs the logarithm of what it draws over the noise. A constant is free:
        two shapes may each have one, and only their sum is drawn.
        """
        sample, total, roots = fit.sample, 0.0, fit.sample.roots(fit.left)
        for cause, values in zip(fit.causes, fit.values, strict=True):
            added, square = shape_added(sample.machine, cause, values), 0.0
            for channel, part in zip(sample.channels, sample.parts, strict=True):
                if (curve := added.get(channel.name)) is not None:
                    one, other = (roots[part] * channel.curve(each) for each in (curve, np.ones_like(curve)))
                    square += float(np.sum((one - other * float(other @ one) / max(float(other @ other), 1e-300)) ** 2))
            total += len(cause.amplitudes) * log1p(square / sample.rows)
        return total

    def score(self, fit: Fit) -> float:
        """Return how unlikely an explanation is: its cost, and its price."""
        return fit.cost + self.price(fit)

    def own_score(self, fit: Fit) -> float:
        """Return the same where what is left counts as noise with the memory that suits it best."""
        if fit not in self.owned:
            self.owned[fit] = as_noise(self.sample, fit.predicted)
        return self.owned[fit] + float(fit.inputs @ fit.inputs) + self.price(fit)

    def best_first(self, several: Iterable[Fit], score: Callable[[Fit], float] | None = None) -> list[Fit]:
        """Return explanations, the best first; of one score those under the weakest names."""
        return lowest_first(several, score or self.score, attrgetter("weakest_first"))

    def ranked(self, accept: Callable[[Fit], bool] = lambda _: True) -> list[Fit]:
        """Return what was fitted and is accepted, the best first."""
        return self.best_first(fit for fit in self.known.values() if accept(fit))

    def best(self, size: int) -> Fit | None:
        """Return the best explanation of so many causes."""
        return next(iter(self.ranked(lambda fit: len(fit.causes) == size)), None)

    @property
    def null(self) -> Fit:
        """The model as it is."""
        return self.known[frozenset()]

    @property
    def fairest(self) -> Fit:
        """What is best where every explanation has the noise that it leaves: the noise is learnt from it."""
        return self.best_first(self.known.values(), self.own_score)[0]

    # ---- fits

    def keep(self, fit: Fit | None) -> Fit | None:
        """Keep a fit where it is better than what is known of its causes; of one score the first stays."""
        if fit is None:
            return None
        before = self.known.get(fit.key)
        allowed = -SAME if fit.key in self.fresh else MARGIN  # what was rough may have promised too much
        if before is None or fit.cost < before.cost + allowed:
            self.known[fit.key] = fit
        self.fresh.add(fit.key)
        return self.known[fit.key]

    @property
    def at_once(self) -> int:
        """So many fits ask the model together; where calls are counted, one after another."""
        if self.extended.is_moving:
            return MOVING_AT_ONCE
        rows = len(self.sample.machine.records)
        return 1 if self.extended.budget.is_dear else max(1, min(AT_ONCE, ROWS_AT_ONCE // rows))

    def fit_each(self, starts: Sequence[Start]) -> list[Fit | None]:
        """Fit explanations from their starts and keep them; what is known of one that is not fitted."""
        made: list[Fit | None] = []
        for begin in range(0, len(starts), self.at_once):
            several = starts[begin : begin + self.at_once]
            begins = [self._may_begin(start) for start in several]
            begun = compress(several, begins)
            asking = [fitting(self.sample, self.extended, *start, until=ROUGHLY) for start in begun]
            fits = iter(together(self.extended, asking))
            for start, is_fitted in zip(several, begins, strict=True):
                made.append(self.keep(next(fits)) if is_fitted else self.known.get(key_of(start.causes)))
        return made

    def _may_begin(self, start: Start) -> bool:
        """Whether an explanation can be fitted to so many rows, and the budget of calls lasts for it."""
        size = sum(cause.size for cause in start.causes)
        if size * ROWS_PER_NUMBER > self.sample.known or are_exclusive(start.causes):
            return False
        if not self.extended.allows(self.stage):
            return False
        self.begun.add(_begins(start.causes, start.values))
        return True

    def look(self, at: Fit, causes: Sequence[Candidate] | None = None) -> Mapping[str, ConditionalGain]:
        """Compare the curves of causes with what an explanation leaves, and count their independent curves."""
        wanted = [cause for cause in (self.causes if causes is None else causes) if cause.tag not in at.key]
        left, known = self.gains_seen.get(at.key, (None, {}))
        if left is not at.left:
            known = {}
        new = [cause for cause in wanted if cause.tag not in known]
        known = {**known, **dict.fromkeys((cause.tag for cause in new), None), **look(self.curves, at, new)}
        self.gains_seen = {at.key: (at.left, known)}  # the last one only: waves have many curves
        made = {cause.tag: each for cause in wanted if (each := known[cause.tag]) is not None}
        for tag, each in made.items():
            self.tries[tag] = max(self.tries.get(tag, 1.0), each.tries)
        return made

    def forward(self, at: Fit, count: int, accept: Callable[[Candidate], bool] = _any) -> None:
        """Fit the most promising causes beside an explanation; half as many beside several."""
        if len(at.causes) >= MOST_CAUSES or not self.extended.allows(self.stage):
            return
        seen, wanted = self.look(at, [cause for cause in self.causes if accept(cause)]), []
        for cause in self.promising(seen)[: count if len(at.causes) < 2 else count // 2]:
            starts, fit = seen[cause.tag].starts, self.known.get(at.key | {cause.tag})
            if fit is None or fit.key not in self.fresh:
                wanted += beside(at, cause, starts)
            elif at.cost - starts[0][0] < fit.cost - MARGIN:  # it begins elsewhere
                wanted += beside(at, cause, starts[:1])
        self.fit_each(wanted)

    def forward_each(self, several: Sequence[Fit], count: int, accept: Callable[[Candidate], bool] = _any) -> None:
        """Fit the most promising causes beside several explanations."""
        self.extended.side_by_side([partial(self.forward, at, count, accept) for at in several])

    def promising(self, seen: Mapping[str, ConditionalGain]) -> list[Candidate]:
        """Return causes by what their curves promise once they are paid for, of those of one curve the weakest."""
        worth = {
            cause: seen[cause.tag].starts[0][0] - self.price_of(cause)
            for cause in self.causes
            if cause.tag in seen and seen[cause.tag].starts and seen[cause.tag].starts[0][0] > LEAST_PROMISE
        }
        return lowest_first(worth, lambda cause: -worth[cause], attrgetter("weakest_first"))

    def without(self, fit: Fit, index: int) -> Fit | None:
        """Fit an explanation without one of its causes."""
        causes, values = fit.less(index)
        begin = _begins(causes, values)
        if begin[0] in self.fresh and (not begin[1] or begin in self.begun):
            return self.known[begin[0]]
        return self.fit_each([Start(causes, values, fit)])[0]

    def backward(self, fit: Fit) -> Fit:
        """Leave out what is no longer needed."""
        tried = self.extended.side_by_side([partial(self.without, fit, index) for index in range(len(fit.causes))])
        best = next(iter(self.best_first(each for each in tried if each is not None)), fit)
        return self.backward(best) if len(fit.causes) > 1 and self.score(best) < self.score(fit) else fit

    # ---- noise

    def renew(self) -> None:
        """Learn the noise from the fairest explanation, and judge everything in it."""
        for _ in range(MOST_RENEWALS):
            fair = self.fairest
            noise = learnt(self.sample, fair.predicted, fair.size + len(fair.inputs) ** 0.5)
            finer = any(noise[name].scale < FINER * own.scale for name, own in self.sample.noise.items())
            directions = None if finer else self.sample.directions
            sample = sample_of(self.sample.machine, noise, self.sample.mask, directions)
            scale = max(abs(log(noise[name].scale / own.scale)) for name, own in self.sample.noise.items())
            laws = [[(own.memory, own.tails) for own in each.values()] for each in (noise, self.sample.noise)]
            if laws[0] == laws[1] and scale < NOISE_SETTLED:
                break
            self.sample, self.fresh, self.exchanged, self.owned, self.paid = sample, set(), set(), {}, {}
            self.known = {key: fit.in_sample(sample) for key, fit in self.known.items()}
            self.again(self.ranked()[:3])

    def exact(self, fit: Fit) -> Fit:
        """Return an explanation fitted to the end; where the budget has ended, of several the best alone."""
        if self.extended.lasts or self.known[fit.key] is self.ranked()[0]:
            self._again([fit], EXACTLY)
        return self.known[fit.key]

    def again(self, several: Iterable[Fit], until: float = ROUGHLY) -> None:
        """Fit explanations again from where they are, in the present noise."""
        due = list({fit.key: fit for fit in several if fit.key not in self.fresh or until < ROUGHLY}.values())
        what = AGAIN if until >= ROUGHLY else TO_THE_END
        for begin in range(0, len(due), self.at_once):
            some = due[begin : begin + self.at_once]
            self._again([fit for fit in some if not fit.causes or self.extended.allows(what)], until)

    def _again(self, several: Sequence[Fit], until: float) -> None:
        asking = [refitting(fit, self.sample, self.extended, until=until) for fit in several]
        for fit, made in zip(several, together(self.extended, asking), strict=True):
            self.fresh.discard(fit.key)
            if made is not None and until < ROUGHLY and not self.extended.grain:  # what was rough may promise too much
                del self.known[fit.key]
            self.keep(made)

    def refresh(self) -> None:
        """Fit again what lies near the best, since the noise was learnt anew; and the model as it is."""
        top = self.score(self.ranked()[0])
        near = [fit for fit in self.ranked()[:RENEWED] if self.score(fit) < top + WITHIN]
        self.again([self.null, *near])


def key_of(causes: Sequence[Candidate]) -> frozenset[str]:
    """Return what tells an explanation by these causes from others."""
    return frozenset(cause.tag for cause in causes)


def beside(at: Fit, cause: Candidate, starts: Iterable[tuple[float, Matrix]]) -> list[Start]:
    """Return where fits of an explanation with one more cause begin."""
    return [Start((*at.causes, cause), (*at.values, values), at) for _, values in starts]


def _begins(causes: Sequence[Candidate], values: Sequence[Matrix]) -> tuple[frozenset[str], tuple[float, ...]]:
    """Return the tags of causes, and their whole numbers and places, which a fit leaves where they begin."""
    kept = sorted((cause.tag, each[cause.kept].tolist()) for cause, each in zip(causes, values, strict=True))
    return frozenset(tag for tag, _ in kept), tuple(chain.from_iterable(each for _, each in kept))


def competition_of(extended: Extended, causes: Sequence[Candidate], sample: Sample) -> Competition:
    """Begin a competition with the model as it is."""
    made = Competition(extended, tuple(causes), sample, ResponseCurves(extended))
    made.keep(nothing(sample, extended))
    return made


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

    def in_places() -> None:
        competition.forward_each(list(several.values())[:BEAM], JOINED, placed.__contains__)

    def as_alone() -> None:
        pairs = lowest_first(combinations(several.values(), 2), lambda pair: sum(map(competition.score, pair)))
        competition.fit_each(
            [
                Start(one.causes + other.causes, one.values + other.values, one)
                for one, other in pairs
                if one.causes[0].is_registered or other.causes[0].is_registered  # two shapes: no second name is needed
            ]
        )

    competition.extended.side_by_side([in_places, as_alone])


def _registered(competition: Competition, count: int) -> list[Fit]:
    """Return the best single causes that somebody registered and that do not draw the same."""
    return _distinct(competition, 1, count, accept=lambda fit: fit.causes[0].is_registered)


def _beside_firsts(competition: Competition) -> None:
    firsts = {fit.key: fit for fit in (*_distinct(competition, 1, FIRSTS), *_registered(competition, FIRSTS // 2))}
    competition.forward_each([*firsts.values()], JOINED, _is_quick)


def _is_quick(cause: Candidate) -> bool:
    """Whether a cause has few curves: waves of any period are looked for beside the best explanation only."""
    return all(number.name != "frequency" for number in cause.numbers)


def _more(competition: Competition) -> None:
    now = competition.ranked()[0]
    while 1 <= len(now.causes) < MOST_CAUSES:
        competition.forward_each(_distinct(competition, len(now.causes), STARTS), JOINED)
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
        exchange_each(competition, now)
        if competition.ranked()[0].key == now.key:
            return


def exchange_each(competition: Competition, now: Fit) -> None:
    """Exchange every cause of an explanation for others."""
    tasks = [partial(exchange, competition, now, index) for index in range(len(now.causes))]
    competition.extended.side_by_side(tasks)


def exchange(competition: Competition, now: Fit, index: int) -> None:
    """Fit an explanation with one of its causes exchanged for others, the rest refitted without it and held; once."""
    if (now.key, now.causes[index].tag) in competition.exchanged:
        return
    competition.exchanged.add((now.key, now.causes[index].tag))
    rest = competition.without(now, index)
    if rest is not None:
        competition.forward(rest, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)
    if len(now.causes) > 1:
        held = held_without(now, index, competition.sample, competition.extended)
        if np.isfinite(held.left).all():
            competition.forward(held, JOINED, lambda cause: _is_quick(cause) and cause.tag not in now.key)


def _exactly(competition: Competition) -> None:
    """Fit to the end what lies near, the best of every size, and single causes: a rough fit may stop far from it."""
    top = competition.score(competition.ranked()[0])
    near = [fit for fit in competition.ranked()[:RENEWED] if competition.score(fit) < top + 4 * MARGIN]
    sized = [best for size in range(1, MOST_CAUSES) if (best := competition.best(size)) is not None]
    competition.again([competition.null, *near, *sized, *_registered(competition, BEAM)], CLOSELY)
