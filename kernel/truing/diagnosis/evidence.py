"""What the rows say, reduced to inner products: one matrix per measured result and noise filter.

Every column is one of: the residual, a direction of the tolerated inputs (unit prior), a column of the registry or of
the library of shapes. Rows are taken in blocks of whole pieces of runs, so memory does not grow with their number.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from typing import TYPE_CHECKING

from truing.diagnosis.columns import Column, Design
from truing.diagnosis.filtered import grams_of, mixture, parts_of
from truing.diagnosis.noise import SETTINGS, Setting, colour

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

LONGEST = 4096
ROUNDING = 1e-13
"""What is left of a sum of squares below this share is rounding: no explanation is better than another by it."""


@dataclass(frozen=True)
class Channel:
    """One measured result on the rows where it was measured, in units of its noise.

    ``rows`` are places among the records; ``starts`` marks where the noise filter starts anew; ``weights`` is one over
    the relative standard deviation of the noise. ``residual`` has shape (n,). ``slopes`` are those of the tolerated
    inputs on all rows of the records, ``moves`` (inputs, K) how the directions move them.
    """

    name: str
    scale: float
    rows: NDArray[np.intp]
    starts: NDArray[np.bool_]
    weights: Matrix
    residual: Matrix
    slopes: Matrix
    moves: Matrix
    design: Design

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def columns(self) -> Sequence[Column]:
        """All columns of the search."""
        return self.design.columns

    @property
    def directions(self) -> Matrix:
        """What the directions of the tolerated inputs change, (n, K), in units of the noise."""
        return self.directions_at(slice(None))

    def directions_at(self, rows: slice) -> Matrix:
        """Return the directions at some rows, not weighted, shape (rows, K)."""
        import numpy as np

        return np.asarray(self.slopes[self.rows[rows]] @ (self.moves / self.scale))

    def moved(self, rows: slice) -> Matrix:
        """Return the weighted directions at some rows, shape (K, rows)."""
        return self.directions_at(rows).T * self.weights[rows]

    def block(self, rows: slice) -> Matrix:
        """Return the columns that act on this result at some rows, weighted, shape (active, rows)."""
        made = self.design.block(self.rows[rows])
        made *= self.weights[rows] / self.scale
        return made

    @cached_property
    def blocks(self) -> list[slice]:
        """Rows in blocks of whole pieces of runs."""
        import numpy as np

        firsts = np.flatnonzero(self.starts)
        ends = [*firsts[1:], len(self)]
        found: list[slice] = []
        begin = 0
        for end in ends:
            if end - begin >= LONGEST:
                found.append(slice(begin, int(end)))
                begin = int(end)
        if begin < len(self):
            found.append(slice(begin, len(self)))
        return found


def starts_of(run_of: NDArray[np.intp], rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Mark the first row of every run, and of every piece of a run that is longer than a block."""
    import numpy as np

    runs = run_of[rows]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = runs[1:] != runs[:-1]
    first = np.flatnonzero(starts)
    since = np.arange(len(rows)) - np.repeat(first, np.diff([*first, len(rows)]))
    starts |= (since % LONGEST) == 0
    return starts


@dataclass(frozen=True)
class Products:
    """Inner products of one channel under one noise filter: matrix (1 + K + m) squared, and the filter's constant.

    ``least`` is the smallest sum of squares that is more than rounding.
    """

    matrix: Matrix
    constant: float
    least: float = 0.0


def products_of(channel: Channel, settings: Sequence[Setting] = SETTINGS) -> list[Products]:
    """Return the inner products of all columns of a channel, one matrix per noise filter."""
    import numpy as np

    every, mixed = len(channel.columns), mixture(settings)
    first = 1 + channel.moves.shape[1]
    own = np.zeros((mixed.shape[1], first, first))
    cross = np.zeros((mixed.shape[1], len(channel.design.active), first))
    for rows in channel.blocks:
        few = np.concatenate([(channel.residual[rows] * channel.weights[rows])[None], channel.moved(rows)])
        block = channel.block(rows)
        for place, part in enumerate(parts_of(few, channel.starts[rows], settings)):
            own[place] += few @ part.T
            cross[place] += block @ part.T
    at = first + channel.design.active
    found = np.zeros((len(settings), first + every, first + every))
    found[:, :first, :first] = np.tensordot(mixed, own, 1)
    found[:, at, :first] = np.tensordot(mixed, cross, 1)
    found[:, :first, at] = np.swapaxes(found[:, at, :first], 1, 2)
    found[:, at[:, None], at] = _core(channel, settings) / channel.scale**2
    base = 2 * float(np.log(channel.weights).sum())
    runs = int(channel.starts.sum())
    paid = float(np.log(max(len(channel), 2)))
    constants = [base - runs * float(np.log(each.variance_ratio)) - paid * each.size for each in settings]
    least = ROUNDING * float(own[0, 0, 0])
    return [Products(matrix, constant, least) for matrix, constant in zip(found, constants, strict=True)]


def _core(channel: Channel, settings: Sequence[Setting]) -> Matrix:
    """Return the inner products of the columns among themselves, SI, (filters, active, active).

    They change with rows and weights alone, so they are kept for the next rounds of learning the noise.
    """
    import numpy as np

    known = channel.design.known
    used = (channel.rows, channel.starts, channel.weights, np.array([[each.rho, each.theta] for each in settings]))
    key = b"".join(blake2b(np.ascontiguousarray(each).data).digest() for each in used)
    if key not in known:
        known.clear()
        mixed = mixture(settings)
        parts = np.zeros((mixed.shape[1], len(channel.design.active), len(channel.design.active)))
        for rows in channel.blocks:
            block = channel.block(rows) * channel.scale
            for place, gram in enumerate(grams_of(block, channel.starts[rows], settings)):
                parts[place] += gram
        known[key] = np.tensordot(mixed, parts, 1)
    return known[key]


@dataclass(frozen=True)
class Replicates:
    """Inner products of simulated residuals of one channel under one noise filter.

    ``with_all`` has shape (K + m, B): with every direction and column; ``own`` (B,): with themselves.
    """

    with_all: Matrix
    own: Matrix


@dataclass(frozen=True)
class Simulation:
    """How residuals are simulated: innovations to draw from, the filter, and a fitted part to add (weighted, (n,))."""

    innovations: Matrix
    setting: Setting
    mean: Matrix


def replicates_of(
    channel: Channel,
    simulation: Simulation,
    inputs: Matrix,
    generator: np.random.Generator,
    settings: Sequence[Setting],
) -> list[Replicates]:
    """Simulate residuals, with inputs drawn from their tolerances (K, B), and reduce them to inner products."""
    import numpy as np

    count, k, mixed = inputs.shape[1], inputs.shape[0], mixture(settings)
    together = np.zeros((mixed.shape[1], k + len(channel.design.active), count))
    own = np.zeros((mixed.shape[1], count))
    for rows in channel.blocks:
        starts, moved = channel.starts[rows], channel.moved(rows)
        drawn = generator.choice(simulation.innovations, size=(len(starts), count))
        made = colour(drawn, starts, simulation.setting).T + simulation.mean[rows] + inputs.T @ moved
        block = np.concatenate([moved, channel.block(rows)])
        for place, part in enumerate(parts_of(made, starts, settings)):
            together[place] += block @ part.T
            own[place] += np.einsum("ij,ij->i", made, part)
    with_all = np.zeros((len(settings), k + len(channel.columns), count))
    with_all[:, [*range(k), *(k + channel.design.active)]] = np.tensordot(mixed, together, 1)
    return [Replicates(first, second) for first, second in zip(with_all, mixed @ own, strict=True)]


def combined(counts: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Return every combination of one noise filter per channel."""
    from itertools import product

    return product(*(range(count) for count in counts))


@dataclass(frozen=True)
class Reduced:
    """The columns with the tolerated inputs eliminated, under one noise filter per channel.

    For coefficients b of some columns the sum of squares of channel o is ``own[o] - 2 b g[o] + b h[o] b``; the last
    entry of the three is the prior of the inputs, which move by ``start - gamma b``. ``total_h`` is the sum of h, the
    normal matrix (m, m). ``rows`` counts the independent rows by channel: those clipped say less. B residuals at once.
    """

    forms: tuple[Matrix, ...]
    total_h: Matrix
    gamma: Matrix
    g: tuple[Matrix, ...]
    own: tuple[Matrix, ...]
    constant: float
    rows: tuple[float, ...]
    least: tuple[float, ...]

    @property
    def h(self) -> tuple[Matrix, ...]:
        """The quadratic form of every channel, and that of the prior."""
        return (*self.forms, self.gamma.T @ self.gamma)

    @cached_property
    def curvature(self) -> Matrix:
        """Diagonal of the normal matrix, (m,)."""
        import numpy as np

        return np.maximum(np.diag(self.total_h), 1e-300)

    @cached_property
    def total_g(self) -> Matrix:
        """Right-hand sides, (m, B)."""
        return _sum(self.g)


def reduced(
    products: Sequence[Products], rows: Sequence[float], k: int, replicates: Sequence[Replicates] | None = None
) -> Reduced:
    """Eliminate the K directions, each with unit prior; the noise has unit scale here.

    Without ``replicates`` the right-hand side is the measured residual itself.
    """
    import numpy as np
    from scipy.linalg import cho_factor, cho_solve

    matrices = [item.matrix for item in products]
    uu = [matrix[1 : 1 + k, 1 : 1 + k] for matrix in matrices]
    uc = [matrix[1 : 1 + k, 1 + k :] for matrix in matrices]
    cc = [matrix[1 + k :, 1 + k :] for matrix in matrices]
    if replicates is None:
        replicates = [Replicates(matrix[1:, :1], matrix[:1, 0]) for matrix in matrices]
    ub = [item.with_all[:k] for item in replicates]
    cb = [item.with_all[k:] for item in replicates]
    own = [item.own for item in replicates]
    constant, least = sum(item.constant for item in products), tuple(item.least for item in products)
    factor = cho_factor(_sum(uu) + np.eye(k)) if k else (np.zeros((0, 0)), False)
    gamma, start = (cho_solve(factor, right) if k else right for right in (_sum(uc), _sum(ub)))
    total = _less(cc, gamma, _sum(uc))
    forms = []
    for c, a, u in zip(cc, uc, uu, strict=True):
        half = a - 0.5 * (u @ gamma)
        forms.append(_less([c], np.concatenate([gamma, half]), np.concatenate([half, gamma])))
    g = [b - gamma.T @ v - (a - u @ gamma).T @ start for b, v, a, u in zip(cb, ub, uc, uu, strict=True)]
    left = [
        r - 2 * np.einsum("ij,ij->j", start, v) + np.einsum("ij,ij->j", start, u @ start)
        for r, v, u in zip(own, ub, uu, strict=True)
    ]
    constant -= 2 * float(np.log(np.diag(factor[0])).sum())
    prior = gamma.T @ start, np.einsum("ij,ij->j", start, start)
    return Reduced(tuple(forms), total, gamma, (*g, prior[0]), (*left, prior[1]), constant, tuple(rows), least)


def _less(matrices: Sequence[Matrix], left: Matrix, right: Matrix) -> Matrix:
    """Return a sum of square matrices less ``left' right``, in as few passes as there can be."""
    import numpy as np
    from scipy.linalg.blas import dgemm

    made = np.array(matrices[0].T, order="F")  # they are symmetric
    for other in matrices[1:]:
        made += other.T
    if len(left):
        made = dgemm(-1.0, left, right, beta=1.0, c=made, trans_a=True, overwrite_c=True)
    return np.asarray(made.T)


def _sum(matrices: Sequence[Matrix]) -> Matrix:
    return sum(matrices[1:], matrices[0])
