"""The score of many hypotheses on many residuals at once: likelihood, parameters paid for, prior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from truing.diagnosis.evidence import Reduced
from truing.diagnosis.hypotheses import Batch

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

RIDGE = 1e-10
FLOOR = 1e-12
BOUND_SLACK = 2.0
FEW = 3
"""So few coefficients are solved for faster by elimination over all hypotheses than by a library call for each."""


@dataclass(frozen=True)
class Scores:
    """Twice the profiled log-likelihood and the score of every hypothesis and residual, shape (n, B)."""

    likelihood: Matrix
    score: Matrix


def base_likelihood(case: Reduced) -> Matrix:
    """Return twice the profiled log-likelihood without any column, shape (B,)."""
    import numpy as np

    total = np.full(len(case.own[0]), case.constant)
    for rows, own in zip(case.rows, case.own, strict=False):
        total -= rows * np.log(np.maximum(own, FLOOR) / rows)
    return total - case.own[-1]


def coefficients(case: Reduced, batch: Batch) -> Matrix:
    """Solve every hypothesis of a batch, shape (n, k, B)."""
    return _solved(case, batch)[0]


def _solved(case: Reduced, batch: Batch) -> tuple[Matrix, Matrix]:
    """Return the coefficients (n, k, B), and by how much they lower the sum of all squares (n, B)."""
    import numpy as np

    normal = np.take(case.total_h, batch.square(len(case.total_h)), mode="clip")
    diagonal = np.einsum("nii->ni", normal)
    ridge = RIDGE * np.maximum(diagonal, 1e-300) + 1e-300
    diagonal += ridge
    right = case.total_g[batch.index]
    solved = _eliminated(normal, right) if normal.shape[1] <= FEW else np.asarray(np.linalg.solve(normal, right))
    return solved, np.einsum("nkb,nkb->nb", solved, right + ridge[:, :, None] * solved)


def _eliminated(normal: Matrix, right: Matrix) -> Matrix:
    """Solve small positive definite systems (n, k, k) for right-hand sides (n, k, B), all at once step by step."""
    import numpy as np

    size, left = normal.shape[1], normal.copy()
    solved = right.copy()
    for pivot in range(size):
        for row in range(pivot + 1, size):
            factor = left[:, row, pivot] / left[:, pivot, pivot]
            left[:, row, pivot:] -= factor[:, None] * left[:, pivot, pivot:]
            solved[:, row] -= factor[:, None] * solved[:, pivot]
    for row in reversed(range(size)):
        above = np.einsum("nj,njb->nb", left[:, row, row + 1 :], solved[:, row + 1 :])
        solved[:, row] = (solved[:, row] - above) / left[:, row, row, None]
    return solved


def batch_likelihood(case: Reduced, batch: Batch) -> Matrix:
    """Return twice the profiled log-likelihood of every hypothesis of a batch, shape (n, B).

    The noise of every result is estimated anew under every hypothesis. Solutions that leave the bounds of an unknown
    by more than two standard errors count as impossible.
    """
    import numpy as np

    solved, lowered = _solved(case, batch)
    total = np.full((len(batch.index), solved.shape[2]), case.constant)
    variance = np.zeros_like(total)
    prior = case.own[-1] - lowered
    for place, (h, g, own) in enumerate(zip(case.forms, case.g, case.own, strict=False)):
        part = np.take(h, batch.square(len(h)), mode="clip")
        change = np.einsum("nkb,nkb->nb", solved, part @ solved - 2 * g[batch.index])
        rows = case.rows[place]
        left = np.maximum(own + change, max(FLOOR, case.least[place]))
        total -= rows * np.log(left / rows)
        variance += left
        prior -= change
    total -= np.maximum(prior, 0.0)
    variance /= sum(case.rows)
    return np.where(_is_possible(case, batch, solved, variance), total, -np.inf)


def _is_possible(case: Reduced, batch: Batch, solved: Matrix, variance: Matrix) -> NDArray[np.bool_]:
    """Tell which solutions lie inside the bounds; a bound at zero is a sign and is kept strictly."""
    import numpy as np

    possible = np.ones((solved.shape[0], solved.shape[2]), dtype=bool)
    bounds = batch.bounds
    if not len(bounds.places):
        return possible
    low, high, value = bounds.low, bounds.high, solved[bounds.places, bounds.within]
    slack = np.sqrt(variance)[bounds.places] * (BOUND_SLACK / np.sqrt(case.curvature[bounds.columns]))[:, None]
    inside = (value >= low - slack * (low != 0)) & (value <= high + slack * (high != 0))
    possible[bounds.places[bounds.first]] = np.logical_and.reduceat(inside, bounds.first, axis=0)
    return possible


def scores_of(case: Reduced, batches: Sequence[Batch], rows: int) -> Scores:
    """Score the hypotheses of all batches on so many rows; one without columns says that nothing is wrong."""
    import numpy as np

    residuals, count = len(case.own[0]), sum(len(batch.places) for batch in batches)
    likelihood = np.full((count, residuals), -np.inf)
    score = np.full((count, residuals), -np.inf)
    for batch in batches:
        has_columns = batch.index.shape[1] > 0
        value = batch_likelihood(case, batch) if has_columns else base_likelihood(case)[None, :]
        likelihood[batch.places] = value
        score[batch.places] = value - batch.penalty(rows)[:, None]
    return Scores(likelihood, score)
