"""Whether parts of a record say the same: the chosen explanation, and what is nearest to it, are fitted to each.

A cause that is there is as large in the first half of rows that have an order as in the second, and the best on every
second row. Rows without an order are parted at random.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, sqrt

import numpy as np

from truing.arrays import Indices
from truing.diagnosis.choice import CLOSE, Chosen
from truing.diagnosis.exact import alone, refitting
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import refitted
from truing.diagnosis.gain import contenders
from truing.diagnosis.intervals import certainty_of, places_of, value_of
from truing.diagnosis.noise import Autocorrelation
from truing.diagnosis.result import Amount, Contradiction, Thinned
from truing.diagnosis.sample import Sample, has_order

CONTRADICTING = 4.0
"""Standard errors by which an amplitude differs between halves that contradict one another: by chance 1 in 16,000."""
FEWEST_PER_NUMBER = 10
"""Rows for every number that a half must have: of fewer its own standard errors are not known."""
RIVALS_THINNED = 4
"""So many of the nearest explanations that name something else are fitted to every second row."""
ORDERED = ("every second row, from the first", "every second row, from the second")
UNORDERED = ("one half of the rows, taken at random", "the other half of the rows, taken at random")


def contradictions_of(chosen: Chosen) -> tuple[Contradiction, ...]:
    """Return the amplitudes of named causes that are not the same in both halves of the record."""
    best = chosen.best
    if _are_few(best):
        return ()
    extended = chosen.competition.extended
    turn = _in_turn(best.sample)
    rows = np.arange(len(best.sample.mask))
    left_out = [np.isin(rows, half) for half in (turn[len(turn) // 2 :], turn[: len(turn) // 2])]
    fitted = [fit for test in left_out for fit in refitted([best], extended, test) if fit is not None]
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
        ahead = {fit: _score(chosen, fit, sample) for fit in (best, *others)}
        top = min(ahead, key=ahead.__getitem__)
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
