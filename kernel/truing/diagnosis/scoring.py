"""The score of many hypotheses on many residuals at once: likelihood, parameters paid for, prior."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.evidence import Reduced
from truing.diagnosis.hypotheses import Batch

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

RIDGE = 1e-10
FLOOR = 1e-12
BOUND_SLACK = 2.0
FEW = 3
"""So few coefficients are solved for faster by elimination over all hypotheses than by a library call for each."""
IN_CACHE = 4000
"""So many columns of hypotheses are scored at a time, over the noise filters: more no longer stay in the cache."""


@dataclass(frozen=True)
class Scores:
    """Twice the profiled log-likelihood and the score by noise filter, hypothesis and residual, shape (S, n, B)."""

    likelihood: Matrix
    score: Matrix


def base_likelihood(cases: Sequence[Reduced]) -> Matrix:
    """Return twice the profiled log-likelihood without any column, shape (S, B)."""
    own, rows, _ = _squares(cases)
    total = np.array([case.constant for case in cases])[:, None] - np.stack([case.own[-1] for case in cases])
    for left, count in zip(own, rows, strict=True):
        total -= count[:, None] * np.log(np.maximum(left, FLOOR) / count[:, None])
    return total


def _squares(cases: Sequence[Reduced]) -> tuple[Matrix, Matrix, Matrix]:
    """Return by channel and filter the sums of squares (C, S, B), the rows and the least sum that counts (C, S)."""
    own = np.stack([np.stack(case.own[:-1]) for case in cases], axis=1)
    return own, np.array([case.rows for case in cases]).T, np.array([case.least for case in cases]).T


def coefficients(case: Reduced, batch: Batch) -> Matrix:
    """Solve every hypothesis of a batch, shape (n, k, B)."""
    found: Matrix = _solved([case], batch)[0][0]
    return found


def _taken(matrices: Iterable[Matrix], batch: Batch) -> Matrix:
    """Return of a square matrix of each filter the parts that the hypotheses of a batch are made of, (S, n, k, k)."""
    return np.stack([np.take(matrix, batch.square(len(matrix)), mode="clip") for matrix in matrices])


@np.errstate(divide="ignore", invalid="ignore")  # two columns that are one have no solution
def _solved(cases: Sequence[Reduced], batch: Batch) -> tuple[Matrix, Matrix]:
    """Return the coefficients (S, n, k, B), and by how much they lower the sum of all squares (S, n, B)."""
    normal = _taken((case.total_h for case in cases), batch)
    diagonal = np.einsum("snii->sni", normal)
    ridge = RIDGE * np.maximum(diagonal, 1e-300) + 1e-300
    diagonal += ridge
    right = np.stack([case.total_g[batch.index] for case in cases])
    solved = _eliminated(normal, right) if normal.shape[-1] <= FEW else np.asarray(np.linalg.solve(normal, right))
    return solved, np.einsum("snkb,snkb->snb", solved, right + ridge[..., None] * solved)


def _eliminated(normal: Matrix, right: Matrix) -> Matrix:
    """Solve small positive definite systems (..., k, k) for right-hand sides (..., k, B), all at once step by step."""
    size, left = normal.shape[-1], normal.copy()
    solved = right.copy()
    for pivot in range(size):
        for row in range(pivot + 1, size):
            factor = left[..., row, pivot] / left[..., pivot, pivot]
            left[..., row, pivot:] -= factor[..., None] * left[..., pivot, pivot:]
            solved[..., row, :] -= factor[..., None] * solved[..., pivot, :]
    for row in reversed(range(size)):
        above = np.einsum("...j,...jb->...b", left[..., row, row + 1 :], solved[..., row + 1 :, :])
        solved[..., row, :] = (solved[..., row, :] - above) / left[..., row, row, None]
    return solved


def batch_likelihood(cases: Sequence[Reduced], batch: Batch) -> Matrix:
    """Return twice the profiled log-likelihood of every hypothesis of a batch, shape (S, n, B).

    The noise of every result is estimated anew under every hypothesis. Solutions that leave the bounds of an unknown
    by more than two standard errors count as impossible, and so do columns that cannot be told apart at all.
    """
    solved, lowered = _solved(cases, batch)
    total = np.empty(lowered.shape)
    total[:] = np.array([case.constant for case in cases])[:, None, None]
    variance = np.zeros_like(total)
    prior = np.stack([case.own[-1] for case in cases])[:, None] - lowered
    for place, (own, rows, least) in enumerate(zip(*_squares(cases), strict=True)):
        part = _taken((case.forms[place] for case in cases), batch)
        g = np.stack([case.g[place][batch.index] for case in cases])
        change = np.einsum("snkb,snkb->snb", solved, part @ solved - 2 * g)
        left = np.maximum(own[:, None] + change, np.maximum(FLOOR, least)[:, None, None])
        total -= rows[:, None, None] * np.log(left / rows[:, None, None])
        variance += left
        prior -= change
    total -= np.maximum(prior, 0.0)
    variance /= np.array([sum(case.rows) for case in cases])[:, None, None]
    return np.where(np.isfinite(total) & _is_possible(cases, batch, solved, variance), total, -np.inf)


def _is_possible(cases: Sequence[Reduced], batch: Batch, solved: Matrix, variance: Matrix) -> NDArray[np.bool_]:
    """Tell which solutions lie inside the bounds; a bound at zero is a sign and is kept strictly."""
    possible = np.ones(variance.shape, dtype=bool)
    bounds = batch.bounds
    if not len(bounds.places):
        return possible
    low, high, value = bounds.low, bounds.high, solved[:, bounds.places, bounds.within]
    curvature = np.stack([case.curvature[bounds.columns] for case in cases])
    slack = np.sqrt(variance)[:, bounds.places] * (BOUND_SLACK / np.sqrt(curvature))[..., None]
    inside = (value >= low - slack * (low != 0)) & (value <= high + slack * (high != 0))
    possible[:, bounds.places[bounds.first]] = np.logical_and.reduceat(inside, bounds.first, axis=1)
    return possible


def scores_of(cases: Sequence[Reduced], batches: Sequence[Batch], rows: int) -> Scores:
    """Score the hypotheses of all batches on so many rows, under the noise filters of all cases at once.

    A hypothesis without columns says that nothing is wrong.
    """
    residuals, count = len(cases[0].own[0]), sum(len(batch.places) for batch in batches)
    likelihood = np.full((len(cases), count, residuals), -np.inf)
    score = np.full((len(cases), count, residuals), -np.inf)
    for batch in batches:
        likelihood[:, batch.places] = _in_parts(cases, batch)
        score[:, batch.places] = likelihood[:, batch.places] - batch.penalty(rows)[:, None]
    return Scores(likelihood, score)


def _in_parts(cases: Sequence[Reduced], batch: Batch) -> Matrix:
    """Return the likelihoods (S, n, B) of a batch, under as many filters at a time as a cache holds."""
    if not batch.index.size:
        return base_likelihood(cases)[:, None]
    width = max(1, IN_CACHE // batch.index.size)
    parts = [batch_likelihood(cases[begin : begin + width], batch) for begin in range(0, len(cases), width)]
    return np.concatenate(parts) if len(parts) > 1 else parts[0]
