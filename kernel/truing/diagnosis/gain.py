"""What the extension is worth on rows it has not seen, and whether parts of the record say the same.

In every fold what competes is fitted and chosen anew. The comparison is with the model calibrated in the same fold,
never with the nominal one: calibration is not the merit of a cause. A cause that is there is as large in the first half
of rows that have an order as in the second, and the best on every second row; rows without an order are parted at
random.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import hypot, log, pi, sqrt

import numpy as np
from scipy.special import gammaln

from truing.arrays import Indices, Mask, Matrix
from truing.diagnosis.choice import CLOSE, Chosen
from truing.diagnosis.exact import alone, refitting
from truing.diagnosis.extended import shape_added
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import Folds, folds_of, refitted
from truing.diagnosis.intervals import certainty_of, places_of, value_of
from truing.diagnosis.machine import Calibration
from truing.diagnosis.noise import Autocorrelation, beyond, difference
from truing.diagnosis.result import Amount, Contradiction, Gain, Thinned
from truing.diagnosis.sample import Channel, NoiseModel, Sample, errors_of, has_order

FLIPS = 999
"""So many signs of the blocks are drawn where there are too many to try all: a significance down to 0.001."""
MOST_EXACT = 12
"""Of so many blocks all signs are tried, of more some that are drawn."""
TIED_SUMS = 1e-9
"""Share by which two sums of the same blocks differ by rounding alone."""
COVERED = 0.9
"""Share of new readings that the stated band is to hold; what it did hold is counted on rows left out."""
SMALLEST_GAIN = 1e-6
"""Less than this per row is rounding, not gain."""
CONTENDERS = 6
"""So many explanations beside the chosen one are fitted in every fold."""
LEAST_REDUCIBLE = 0.03
"""Less than this share of the noise is not told from it, so there is nothing to remove."""
CONTRADICTING = 4.0
"""Standard errors by which an amplitude differs between halves that contradict one another: by chance 1 in 16,000."""
FEWEST_PER_NUMBER = 10
"""Rows for every number that a half must have: of fewer its own standard errors are not known."""
RIVALS_THINNED = 4
"""So many of the nearest explanations that name something else are fitted to every second row."""
ORDERED = ("every second row, from the first", "every second row, from the second")
UNORDERED = ("one half of the rows, taken at random", "the other half of the rows, taken at random")


@dataclass(frozen=True)
class HeldOutAnswers:
    """Held-out answers of one result, shape (n,) over all rows of the records, NaN where none.

    ``before`` and ``after`` are errors (SI) of base and extended model, ``gain`` the difference of log densities,
    ``inside`` whether the 90 % interval of the extended model covered the value.
    """

    before: Matrix
    after: Matrix
    gain: Matrix
    inside: Matrix


@dataclass(frozen=True)
class Nested:
    """The cross-validation: answers by result, the folds, and the share of folds in which the same was chosen."""

    judged: dict[str, HeldOutAnswers]
    folds: Folds
    stability: float


def nested(chosen: Chosen, done: Callable[[int, int], None] = lambda count, of: None) -> Nested:
    """Fit and choose anew in every fold, and judge on the rows left out."""
    competition = chosen.competition
    folds = folds_of(competition.sample)
    size = len(competition.sample.machine.records)
    judged = {name: HeldOutAnswers(*(np.full(size, np.nan) for _ in range(4))) for name in competition.sample.noise}
    several, same = contenders(chosen), 0
    tests = [folds.test(fold) for fold in range(folds.count)]

    def without(fold: int) -> list[Fit | None]:
        done(fold, folds.count)
        return refitted([chosen.null, *several], competition.extended, tests[fold])

    tasks = [partial(without, fold) for fold in range(folds.count)]
    for test, (base, *again) in zip(tests, competition.extended.side_by_side(tasks), strict=True):
        if base is None:
            continue
        best = _chosen_again(chosen, base, [fit for fit in again if fit is not None])
        same += best.key == chosen.best.key
        for index, channel in enumerate(base.sample.channels):
            _judge(judged[channel.name], index, (base, best), test)
    return Nested(judged, folds, same / max(folds.count, 1))


def contenders(chosen: Chosen) -> list[Fit]:
    """Return what competes with the chosen explanation in a fold: named explanations where it is one itself."""
    competition, best = chosen.competition, chosen.best
    if not best.causes:
        return []
    plain = all(cause.effect is not None for cause in best.causes)
    near = competition.ranked(
        lambda fit: (
            0 < len(fit.causes) <= len(best.causes)
            and fit.key != best.key
            and (not plain or all(cause.effect is not None for cause in fit.causes))
        )
    )
    return [competition.known[best.key], *near[:CONTENDERS]]


def _chosen_again(chosen: Chosen, base: Fit, again: list[Fit]) -> Fit:
    """Return what is chosen without the rows of a fold: the choice, unless another one is better by ``CLOSE``."""
    competition = chosen.competition
    if not again:
        return base
    own = next((fit for fit in again if fit.key == chosen.best.key), None)
    top = competition.best_first(again)[0]
    best = own if own is not None and competition.score(own) < competition.score(top) + CLOSE else top
    return best if competition.score(best) < competition.score(base) else base


def _judge(judged: HeldOutAnswers, index: int, fits: tuple[Fit, Fit], test: Mask) -> None:
    """Fill in the rows of one fold for one result, from the fits of base and extension without them."""
    sample, channel, machine = fits[0].sample, fits[0].sample.channels[index], fits[0].sample.machine
    name, noise = channel.name, sample.noise[channel.name]
    known, weights = machine.records.known(name), noise.weights[test] / channel.scale
    logs = []
    for fit, errors in zip(fits, (judged.before, judged.after), strict=True):
        off = errors_of(machine, name, noise, fit.predicted[name])
        errors[test] = off[test]
        left = fit.left[sample.parts[index]]
        sd = sqrt(max(float(np.sum(left**2)) / channel.known, channel.least))
        density = _log_density(errors[test] * weights / sd, noise.tails.freedom) + np.log(weights / sd)
        logs.append(np.where(known[test], density, _log_chance(machine, name, noise, fit)[test]))
    judged.gain[test] = logs[1] - logs[0]
    rows = channel.rows[channel.read]
    left = off[rows] * (channel.weights[channel.read] / channel.scale)
    limit = float(np.quantile(np.abs(left), COVERED))
    limit *= sqrt(len(left) / max(len(left) - fits[1].size - len(fits[1].inputs), 1))
    outside = np.abs(judged.after[test] * weights) > limit
    judged.inside[test] = np.where(np.isfinite(judged.after[test]) & known[test], ~outside, np.nan)


def _log_chance(machine: Calibration, name: str, noise: NoiseModel, fit: Fit) -> Matrix:
    """Return the log probability that the true value lies beyond what was read, (n,); 0 where it was read."""
    sides = machine.records.sides.get(name, np.zeros(len(machine.records), dtype=np.int8))
    off = difference(machine.records.measured[name], fit.predicted[name], noise.typical) * noise.weights / noise.scale
    return np.where(sides == 0, 0.0, -0.5 * beyond(off, sides) ** 2)


def _log_density(z: Matrix, freedom: float) -> Matrix:
    """Return the log density of Student's t with unit variance, the normal law for many degrees of freedom."""
    if freedom >= 30:
        return np.asarray(-0.5 * (z**2 + log(2 * pi)))
    height = gammaln((freedom + 1) / 2) - gammaln(freedom / 2) - 0.5 * log(pi * (freedom - 2))
    return np.asarray(height - (freedom + 1) / 2 * np.log1p(z**2 / (freedom - 2)))


def gains_of(chosen: Chosen, judged: Nested, units: Mapping[str, str]) -> tuple[Gain, ...]:
    """Say what the extension is worth for every result, on rows it has not seen."""
    made = []
    best, start = chosen.best, chosen.competition.sample.machine.start
    for index, channel in enumerate(best.sample.channels):
        name, unit, answers = channel.name, units[channel.name], judged.judged[channel.name]
        floor2 = floor_of(best, channel) ** 2
        before2, after2 = (float(np.nanmean(errors**2)) for errors in (answers.before, answers.after))
        reducible = before2 - floor2
        is_told = bool(best.causes) and reducible > LEAST_REDUCIBLE * floor2
        made.append(
            Gain(
                name,
                Amount(before2**0.5, unit),
                Amount(after2**0.5, unit),
                Amount(floor2**0.5, unit),
                min((before2 - after2) / reducible, 1.0) if is_told else 0.0,
                float(np.nanmean(answers.gain)),
                sign_flip_p(answers.gain, judged.folds.block_of, seed=start.seed + index),
                float(np.nanmean(answers.inside)),
                _held_out(chosen, name),
            )
        )
    return tuple(made)


def floor_of(fit: Fit, channel: Channel) -> float:
    """Return the root mean square that an explanation leaves of one result, SI, its numbers paid for."""
    sample = fit.sample
    errors = errors_of(sample.machine, channel.name, sample.noise[channel.name], fit.predicted[channel.name])
    used = (fit.size + len(fit.inputs)) / len(sample.channels)
    return float(np.sqrt(np.sum(errors[channel.rows] ** 2) / max(len(channel) - used, 1.0)))


def _held_out(chosen: Chosen, name: str) -> tuple[float, float] | None:
    """Return root mean squares before and after on rows that were held out on request.

    An unregistered shape was fitted to its own record and says nothing of another one.
    """
    best, records = chosen.best, chosen.competition.sample.machine.records
    rows = records.held_out & np.isfinite(records.measured[name])
    if not rows.any():
        return None
    is_other = ~np.isin(records.run_of, np.unique(records.run_of[~records.held_out]))
    machine, noise = best.sample.machine, best.sample.noise[name]
    added = (shape_added(machine, cause, values) for cause, values in zip(best.causes, best.values, strict=True))
    shaped = sum((each[name] for each in added if name in each), np.zeros(len(records)))
    shown = chosen.null.predicted[name], best.predicted[name] - np.where(is_other, shaped, 0.0)
    before, after = (float(np.sqrt(np.mean(errors_of(machine, name, noise, each)[rows] ** 2))) for each in shown)
    return before, after


def sign_flip_p(gain: Matrix, block_of: Indices, *, seed: int) -> float:
    """Return the significance of a gain: how often random signs of the blocks give as much."""
    known = np.isfinite(gain) & (block_of >= 0)
    sums = np.bincount(block_of[known], weights=gain[known])
    sums = sums[np.bincount(block_of[known]) > 0]
    total = float(sums.sum())
    if total <= SMALLEST_GAIN * len(gain) or len(sums) < 2:
        return 1.0
    least = total * (1 - TIED_SUMS)
    if len(sums) <= MOST_EXACT:
        signs = 1.0 - 2.0 * (np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums)) & 1)
        return float((signs @ sums >= least).mean())
    generator = np.random.Generator(np.random.SFC64(seed))
    flipped = generator.choice([-1.0, 1.0], size=(FLIPS, len(sums))) @ sums
    return float((1 + (flipped >= least).sum()) / (1 + FLIPS))


def contradictions_of(chosen: Chosen) -> tuple[Contradiction, ...]:
    """Return the amplitudes of named causes that are not the same in both halves of the record."""
    best = chosen.best
    if _are_few(best):
        return ()
    extended = chosen.competition.extended
    turn = _in_turn(best.sample)
    rows = np.arange(len(best.sample.mask))
    left_out = [np.isin(rows, half) for half in (turn[len(turn) // 2 :], turn[: len(turn) // 2])]
    halves = extended.side_by_side([partial(refitted, [best], extended, test) for test in left_out])
    fitted = [fit for half in halves for fit in half if fit is not None]
    if len(fitted) < 2:
        return ()
    certain = [certainty_of(fit, extended) for fit in fitted]
    contradictions = []
    for cause in best.causes:
        for index, number in zip(places_of(best, cause), cause.numbers, strict=True):
            if cause.effect is None or not number.is_amplitude or number.file >= 0:
                continue
            first, second = (value_of(fit, index) for fit in fitted)
            error = hypot(*(each.in_si([index])[0][0] ** 0.5 for each in certain))
            if error > 0 and abs(first - second) > CONTRADICTING * error:
                unit = next(unknown.unit for unknown in cause.effect.unknowns if unknown.name == number.name)
                contradictions.append(Contradiction(cause.name, number.name, Amount(first, unit), Amount(second, unit)))
    return tuple(contradictions)


def _are_few(best: Fit) -> bool:
    """Whether half of the rows is too little for an explanation, or there is none."""
    return not best.causes or best.sample.known < 2 * FEWEST_PER_NUMBER * (best.size + len(best.inputs) ** 0.5)


def _in_turn(sample: Sample) -> Indices:
    """Return the rows of a sample in their order; in a random one where they have none."""
    usable = np.flatnonzero(sample.mask)
    return usable if has_order(sample.machine) else np.random.Generator(np.random.SFC64(1)).permutation(usable)


def thinned_of(chosen: Chosen) -> tuple[Thinned, ...]:
    """Return what is better than the chosen explanation, by more than ``CLOSE``, on every second row; the best of each.

    Only what names something else is compared: that half of the rows does not suffice for all causes is no
    contradiction. A half pays half of the price, so that both together are as far ahead as all rows are: an explanation
    that is d ahead is d/2 ahead in either half, with a standard deviation of sqrt(d), and ``CLOSE`` behind in one with
    a chance below 1 in 2000 whatever d is.
    """
    best = chosen.best
    if _are_few(best):
        return ()
    several = [fit for fit in contenders(chosen) if not (fit.key < best.key or best.key < fit.key)]
    others = [fit for fit in several if set(fit.names) != set(best.names)][:RIVALS_THINNED]
    turn = _in_turn(best.sample)
    words, thinned = ORDERED if has_order(best.sample.machine) else UNORDERED, []
    for begin, said in enumerate(words):
        sample = _thinned(best.sample, turn[begin::2])
        if not all(len(channel) for channel in sample.channels):  # a result was read in the other rows alone
            continue
        judged = chosen.competition.extended.side_by_side(
            [partial(_score, chosen, fit, sample) for fit in (best, *others)]
        )
        ahead = dict(zip((best, *others), judged, strict=True))
        top = chosen.competition.best_first(ahead, ahead.__getitem__)[0]
        if ahead[top] < ahead[best] - CLOSE < np.inf:
            thinned.append(Thinned(said, top.names, ahead[best] - ahead[top]))
    return tuple(thinned)


def _score(chosen: Chosen, fit: Fit, sample: Sample) -> float:
    """Return the score of an explanation on half of the rows, where it pays half of its price."""
    competition = chosen.competition
    again = alone(competition.extended, refitting(fit, sample, competition.extended))
    whole = competition.known[fit.key]
    return np.inf if again is None else again.cost + (competition.score(whole) - whole.cost) / 2


def _thinned(sample: Sample, rows: Indices) -> Sample:
    """Return every second row, with the memory that the noise still has from one of them to the next."""
    mask = np.isin(np.arange(len(sample.mask)), rows)
    few, channels = sample.of_rows(mask), []
    for whole, own in zip(sample.channels, few.channels, strict=True):
        begun = np.cumsum(whole.starts)[mask[whole.rows]]  # so many times the noise has begun anew up to here
        channels.append(replace(own, starts=np.diff(begun, prepend=0) > 0, memory=every_second(own.memory)))
    return replace(few, channels=tuple(channels))


def every_second(memory: Autocorrelation) -> Autocorrelation:
    """Return the filter of every second value of noise: its autocorrelations are those of the even lags.

    With phi = rho^2 and r = rho times the autocorrelation of neighbours, theta solves
    ``(phi - r) theta^2 - (1 + phi^2 - 2 r phi) theta + (phi - r) = 0``.
    """
    carried = memory.rho**2
    white = carried - memory.rho * memory.neighbours
    middle = (1 - carried**2 + 2 * carried * white) / 2
    return Autocorrelation(carried, white / (middle + sqrt(max(middle**2 - white**2, 0.0))))
