"""The decision between exact fits: how many causes, which, and what this record does not exclude beside them.

One cause more is believed where its gain is larger than noise alone would give the search, where noise with a memory is
no better word for it, and where it carries over to rows left out. How much noise alone gives is simulated: the law of
the largest gain over all curves. Noise has the memory and the innovations that the better explanation leaves, and the
inputs are drawn from their tolerances, never taken from the fit, which has absorbed part of any effect like them. Every
draw goes through the curves of all causes beside the simpler explanation, and pays what an explanation pays.

Near the winner is what lies within ``CLOSE`` score units, or within ``SURE`` standard errors of the difference row by
row (Q. H. Vuong, Likelihood ratio tests for model selection and non-nested hypotheses, Econometrica 57, 1989, 307).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import comb, log, sqrt

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate
from truing.diagnosis.competition import MARGIN, MOST_CAUSES, Competition, exchange_each
from truing.diagnosis.conditional import ConditionalGain, Pass, conditional_on
from truing.diagnosis.fitted import Fit, differ
from truing.diagnosis.folds import Folds, carries_over, ends_of, folds_of
from truing.diagnosis.intervals import certainty_of, may_be_zero, places_of
from truing.diagnosis.noise import Autocorrelation, colour, shares, whiten
from truing.diagnosis.records import FEWEST_READINGS
from truing.diagnosis.result import OUTSIDE

DRAWS, FIRST_DRAWS = 299, 99
"""So many records of noise are searched for the law of the largest gain, and so many before it is looked whether
the outcome is clear: 299 tell a chance of 0.01 with a standard error of 0.006."""
HOPELESS = 12
"""So many simulated gains above the measured one, of the first draws, settle that it is nothing."""
LARGEST_RHO = 0.985
"""Noise that remembers more is a random walk: of it no number of rows tells anything."""
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
class Law:
    """Largest gains that a search makes of noise alone, simulated (draws,), and the chance of the measured one."""

    gains: Matrix
    p_value: float

    def p_of(self, gain: float) -> float:
        """Return the chance of any other gain of the same search."""
        return float((1 + (self.gains >= gain).sum()) / (1 + len(self.gains)))


def carried(rho: float, rows: int) -> float:
    """Return the autocorrelation to simulate with: the fitted one, its bias and half a standard error more."""
    rows = max(rows, 2)
    return min(LARGEST_RHO, rho + (1 + 3 * rho) / rows + 0.5 * sqrt(max(1 - rho**2, 0.0) / rows)) if rho else 0.0


def law_of(competition: Competition, at: Fit, more: Fit, *, seed: int) -> Law:
    """Simulate how much the best explanation with as many causes as ``more`` gains where ``at`` is all there is.

    Stops early where the answer is plain.
    """
    generator = np.random.Generator(np.random.SFC64(seed))
    seen, conditional = competition.look(at), conditional_on(at, competition.extended)
    gain, steps = competition.score(at) - competition.score(more), len(more.causes) - len(at.causes)
    many, on = len(competition.causes), len(at.causes)
    choice = 2 * (log(comb(many, on + steps)) - log(comb(many, on)))
    gains = np.zeros(0)
    while len(gains) < DRAWS and (gains >= gain).sum() < HOPELESS:
        drawn = _drawn(at, more, DRAWS - len(gains) if len(gains) else FIRST_DRAWS, generator)
        drawn -= conditional.taken @ (conditional.taken.T @ drawn)
        gains = np.concatenate([gains, _largest(competition, seen, drawn, competition.sample.known, steps) - choice])
    return Law(gains, float((1 + (gains >= gain).sum()) / (1 + len(gains))))


def _drawn(at: Fit, more: Fit, count: int, generator: np.random.Generator) -> Matrix:
    """Draw noise as the better explanation leaves it, and inputs within their tolerances, (rows + K, draws)."""
    sample = at.sample
    weighted = sample.roots(more.left) * more.left
    parts = []
    for part, channel in zip(sample.parts, sample.channels, strict=True):
        memory = channel.memory
        pool = weighted[part][channel.read]
        pool = pool - pool.mean()
        drawn = generator.choice(pool, size=(len(channel), count))
        if memory.rho:  # the memory is known but for its error
            filtered = Autocorrelation(carried(memory.rho, len(pool)), memory.theta)
            drawn = whiten(colour(drawn, channel.starts, filtered), channel.starts, memory)
        if channel.sides is not None:  # a censored row says as much as it follows the prediction
            drawn = drawn * shares(channel.off(at.predicted[channel.name]), channel.sides)[:, None]
        parts.append(drawn / sqrt(max(float(np.mean(pool**2)), 1e-300)))
    return np.concatenate([*parts, generator.standard_normal((len(at.inputs), count))])


def _largest(
    competition: Competition, seen: Mapping[str, ConditionalGain], drawn: Matrix, known: float, steps: int
) -> Matrix:
    """Return by draw the largest gain of so many causes, one after another, each paid for, (draws,)."""
    summed, drawn = np.zeros(drawn.shape[1]), np.array(drawn)
    prices = {cause.tag: competition.price_of(cause) for cause in competition.causes}
    for _ in range(steps):
        whole = np.sum(drawn**2, axis=0)
        best = np.full(drawn.shape[1], -np.inf)
        chosen: dict[int, tuple[ConditionalGain, int, Matrix]] = {}
        passed: dict[Pass, Matrix] = {}
        for tag, gains in seen.items():
            inner = gains.span.inner(drawn, passed)
            squares = np.sum(inner**2, axis=1)
            index = squares.argmax(axis=0)
            lowered = np.take_along_axis(squares, index[None], 0)[0]
            gain = -known * np.log(np.maximum(1 - lowered / np.maximum(whole, 1e-300), 1e-9)) - prices[tag]
            better = np.flatnonzero(gain > best)
            best[better] = gain[better]
            for draw in better.tolist() if steps > 1 else ():
                chosen[draw] = gains, int(index[draw]), inner[index[draw], :, draw]
        summed += best
        for draw, (each, point, size) in chosen.items():
            drawn[:, draw] -= each.span.vectors(point).T @ size
    return summed


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
    named = next((fit for fit in sized if not shifts_inputs(fit)), sized[0])
    return named if competition.score(named) < competition.score(sized[0]) + MARGIN else sized[0]


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
    rivals = _rivals(competition, best, seed)
    ends = competition.extended.side_by_side([partial(competition.exact, rival.fit) for rival in rivals])
    near = rivals_of(competition, best, [fit for fit in ends if not _adds_nothing(competition, best, fit)])
    return Chosen(competition, best, near, _same(competition, best), decision.law, decision.p_further)


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
        exchange_each(competition, best)
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
    return min(near, key=lambda fit: len(fit.causes), default=best)


def _taking_least(competition: Competition, best: Fit) -> Fit:
    """Return, of shapes over the same covariates that are about as good beside names, the one that leaves them most."""
    if shapes_in(best) in (0, len(best.causes)):
        return best
    near = [fit for fit in competition.known.values() if competition.score(fit) < competition.score(best) + CLOSE]
    alike = [fit for fit in near if len(fit.causes) == len(best.causes) and _says_the_same(best, fit)]
    return competition.best_first(alike, lambda fit: -_worth_of_names(competition, fit))[0]


def _worth_of_names(competition: Competition, fit: Fit) -> float:
    """Return what the score loses at least without one of the causes that have a name."""
    named = (index for index, cause in enumerate(fit.causes) if cause.shape is None)
    less = (competition.without(fit, index) for index in named)
    return min((competition.score(each) - competition.score(fit) for each in less if each is not None), default=0.0)


def _named_weakest(competition: Competition, best: Fit) -> Fit:
    """Return the explanation under the weakest of its names, where several causes draw one curve."""
    alike = [fit for fit in _like(competition, best) if competition.score(fit) < competition.score(best) + 1.0]
    return min([best, *alike], key=lambda fit: fit.weakest_first)


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


def rivals_of(competition: Competition, best: Fit, near: Iterable[Fit]) -> tuple[Rival, ...]:
    """Return what lies near the winner, the nearest first, and how far it lies behind."""
    top = competition.score(best)
    return tuple(Rival(fit, max(0.0, competition.score(fit) - top)) for fit in competition.best_first(near))


def unsure(one: Fit, other: Fit) -> float:
    """Return the standard error of the difference of two scores, from how it differs from row to row."""
    losses = [each.sample.losses(each.left, each.left) for each in (one, other)]
    return sqrt(one.sample.rows) * float(np.std(losses[0] - losses[1]))


def _rivals(competition: Competition, best: Fit, seed: int) -> tuple[Rival, ...]:
    """Return what lies near the winner and is neither another name for it nor a vaguer word.

    What may be there as well is not told where it, in the place of a cause of the winner, explains as much; a shape
    not beside a registered one.
    """
    if not best.causes:
        return ()
    alike = {fit.key for fit in _like(competition, best)}
    top = competition.score(best)
    near: list[Fit] = []
    for fit in competition.ranked(lambda fit: bool(fit.causes) and not best.key <= fit.key and is_sensible(fit)):
        if competition.score(fit) - top > 10 * CLOSE or len(near) >= MOST_RIVALS:
            break
        if fit.key not in alike and _is_near(competition, best, fit):
            near.append(fit)
    more = [fit for fit in _with_more(competition, best, seed) if not any(fit.key > other.key for other in near)]
    return rivals_of(competition, best, (*near, *more))


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
