"""What the extension is worth on rows it has not seen: in every fold what competes is fitted and chosen anew.

The comparison is with the model calibrated in the same fold, never with the nominal one: calibration is not the merit
of a cause.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.special import gammaln

from truing.arrays import Indices, Mask, Matrix
from truing.diagnosis.choice import CLOSE, Chosen
from truing.diagnosis.extended import shape_added
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import Folds, folds_of, refitted
from truing.diagnosis.machine import Calibration
from truing.diagnosis.noise import beyond, difference
from truing.diagnosis.result import Amount, Gain
from truing.diagnosis.sample import Channel, NoiseModel, errors_of

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
    for fold in range(folds.count):
        done(fold, folds.count)
        test = folds.test(fold)
        base, *again = refitted([chosen.null, *several], competition.extended, test)
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
    top = min(again, key=competition.score)
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
