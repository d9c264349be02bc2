"""How a reading is held against a prediction: as it is, as a logarithm, or as an end beyond which the true value lies.

A censored reading (a run-out, a gauge at its end) leaves ``sqrt(-2 ln Phi(z))``, z by how many standard deviations of
the noise the prediction lies beyond the end: its square is what the likelihood asks for (J. Tobin, Econometrica 26,
1958, 24). A prediction far beyond leaves nothing, one that falls far short leaves what any reading would.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import erfcx, log_ndtr

from truing.diagnosis.arrays import Matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Sides = NDArray[np.int8]
    """By row: 1 where the true value lies above the reading, -1 where it lies below, 0 where it was read."""

MOST_ROUNDS, SETTLED = 500, 1e-12


def difference(values: Matrix, predicted: Matrix, typical: float) -> Matrix:
    """Return readings less predictions, SI; with a typical reading their logarithms, times that reading.

    What is small is then the difference of a reading of that size. A prediction that has no logarithm leaves NaN.
    """
    if not typical:
        return np.asarray(values - predicted)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(typical * (np.log(values) - np.log(predicted)))


def beyond(left: Matrix, sides: Sides) -> Matrix:
    """Return what is left (..., n), in units of the noise, with what censored rows leave."""
    cut, made = np.flatnonzero(sides), np.array(left)
    made[..., cut] = sides[cut] * np.sqrt(-2 * log_ndtr(-sides[cut] * left[..., cut]))
    return made


def shares(left: Matrix, sides: Sides) -> Matrix:
    """Return by row how fast what ``beyond`` makes of it follows the prediction: 1 where it was read, (n,)."""
    cut, made = np.flatnonzero(sides), np.ones(len(sides))
    z = -sides[cut] * left[cut]
    made[cut] = _hazard(z) / np.maximum(np.sqrt(-2 * log_ndtr(z)), 1e-150)
    return made


def worth(left: Matrix, sides: Sides) -> float:
    """Return how many rows (n,) are worth about a prediction: those that were read, and censored ones as they differ.

    Where the noise has its likeliest size, all that is left has this sum of squares: one that is far beyond its end
    is worth nothing.
    """
    cut = np.flatnonzero(sides)
    short = sides[cut] * left[cut]
    return float(len(left) - len(cut) + np.sum(-2 * log_ndtr(-short) - short * _hazard(-short)))


def expected(left: Matrix, sides: Sides) -> Matrix:
    """Return errors (n,), in units of the noise, those of censored rows as the root mean square beyond their ends."""
    cut, made = np.flatnonzero(sides), np.array(left)
    made[cut] = sides[cut] * np.sqrt(_square_beyond(sides[cut] * left[cut]))
    return made


def scale_of(left: Matrix, short: Matrix, free: float) -> float:
    """Return the likeliest standard deviation of noise that leaves so much, ``free`` numbers having been fitted.

    ``short`` is by how much predictions fall short of the ends of censored rows, negative where they are beyond. Every
    round gives these the mean square that they have beyond their ends (A. P. Dempster, N. M. Laird, D. B. Rubin, J. R.
    Stat. Soc. B 39, 1977, 1).
    """
    known = float(np.sum(left**2))
    square = known / max(len(left) - free, 1.0)
    for _ in range(MOST_ROUNDS if len(short) and square > 0 else 0):
        hidden = square * float(np.sum(_square_beyond(short / square**0.5)))
        before, square = square, (known + hidden) / max(len(left) + len(short) - free, 1.0)
        if abs(square - before) <= SETTLED * square:
            break
    return float(square**0.5)


def _square_beyond(z: Matrix) -> Matrix:
    """Return the mean square of what is normal and above z."""
    return np.asarray(1 + z * _hazard(-z))


def _hazard(z: Matrix) -> Matrix:
    """Return the normal density over its integral up to z."""
    return np.asarray(np.sqrt(2 / np.pi) / erfcx(-z / np.sqrt(2)))
