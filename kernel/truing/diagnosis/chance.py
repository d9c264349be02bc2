"""How much the search gains from noise alone: the law of the largest gain over all curves, simulated.

Noise has the memory and the innovations that the better explanation leaves, and the inputs are drawn from their
tolerances, never taken from the fit, which has absorbed part of any effect like them. Every draw goes through the
curves of all causes beside the simpler explanation, and pays what an explanation pays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import comb, log, sqrt

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import ConditionalGain, conditional_on
from truing.diagnosis.fitted import Fit
from truing.diagnosis.noise import Autocorrelation, colour, shares, whiten
from truing.diagnosis.sweeps import Pass

DRAWS, FIRST_DRAWS = 299, 99
"""So many records of noise are searched for the law of the largest gain, and so many before it is looked whether
the outcome is clear: 299 tell a chance of 0.01 with a standard error of 0.006."""
HOPELESS = 12
"""So many simulated gains above the measured one, of the first draws, settle that it is nothing."""
LARGEST_RHO = 0.985
"""Noise that remembers more is a random walk: of it no number of rows tells anything."""


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
