"""Shapes that nobody registered, on long records: curves that are passed through, too many to keep what each leaves.

What a shape adds to a result is the same for every result, and whatever stands beside it: its terms are kept once, in
single precision. Each result is passed through block by block, and what is needed of it is small; shapes of several
results are put together from what their results gave.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Indices, Matrix
from truing.diagnosis.machine import Predicted, in_blocks
from truing.diagnosis.sample import Sample

BLOCK = 500_000
"""So many values are passed through at once."""
DEPENDS = 1e-6
"""Share of a column that is left beside others when it depends on them."""


@dataclass(frozen=True)
class Conditional:
    """What an explanation leaves, weighted (rows + K,), once its numbers and the inputs have taken their part.

    ``taken`` (rows + K, t) is an orthonormal basis of what they can draw; ``roots`` weigh the rows of the sample, and
    ``at`` is what the explanation predicts.
    """

    sample: Sample
    roots: Matrix
    left: Matrix
    taken: Matrix
    at: Predicted

    def drawn(self, curves: Matrix) -> Matrix:
        """Return curves (M, q, readings), SI, as weighted rows of the sample, (M, q, rows)."""
        by_result = np.split(curves.T, len(self.sample.machine.records.measured))
        added = dict(zip(self.sample.machine.records.measured, by_result, strict=True))
        return self.sample.curve(added, self.at).T * self.roots

    def beyond(self, rows: Matrix) -> Matrix:
        """Return what only these curves (M, q, rows) can draw, (M, q, rows + K)."""
        made = -(rows @ self.taken[: rows.shape[-1]]) @ self.taken.T
        made[..., : rows.shape[-1]] += rows
        return np.asarray(made)


@dataclass(frozen=True, eq=False)
class TermTable:
    """Terms of a shape at many points, on all rows of the records, (M, c, n)."""

    terms: NDArray[np.float32]


class Pass:
    """A table passed through one result of a sample beside an explanation, every row in units of its noise.

    ``right`` (M, c) is what it shares with what is left, ``taken`` (M, c, t) with what the explanation draws itself,
    ``normal`` (M, c, c) with itself and ``next`` (M - 1, c, c) with the next point. ``part`` is where the rows of the
    result stand among all rows of the sample.
    """

    def __init__(self, table: TermTable, conditional: Conditional, index: int) -> None:
        self.table, self.conditional = table, conditional
        self.channel, self.part = conditional.sample.channels[index], conditional.sample.parts[index]
        against = np.column_stack([conditional.left[self.part], conditional.taken[self.part]])
        shared, normal, following = [], [], []
        last = np.zeros((0, table.terms.shape[1], len(self.channel)))
        for block in blocks_of(table.terms):
            rows = self.rows(block)
            shared.append(rows @ against)
            normal.append(rows @ rows.swapaxes(1, 2))
            whole = np.concatenate([last, rows])
            following.append(whole[1:] @ whole[:-1].swapaxes(1, 2))
            last = rows[-1:]
        every = np.concatenate(shared)
        self.right, self.taken = every[..., 0], every[..., 1:]
        self.normal, self.next = np.concatenate(normal), np.concatenate(following)

    def rows(self, block: slice) -> Matrix:
        """Return the terms at some points in units of the noise, (m, c, rows of the result)."""
        terms = np.asarray(self.table.terms[block], dtype=float)
        flat = self.channel.curve(terms.reshape(-1, terms.shape[-1]).T, self.conditional.at[self.channel.name]).T
        return np.asarray(flat.reshape(*terms.shape[:2], -1) * self.conditional.roots[self.part])

    def inner(self, drawn: Matrix) -> Matrix:
        """Return what the terms share with draws (rows + K, draws), (M, c, draws)."""
        own, (count, c, _) = drawn[self.part].astype(np.float32), self.table.terms.shape
        rows = (self.rows(block).astype(np.float32).reshape(-1, len(own)) for block in blocks_of(self.table.terms))
        return np.concatenate([each @ own for each in rows]).reshape(count, c, -1)


@dataclass(frozen=True, eq=False)
class ProjectedCurves:
    """The curves of a shape over some results, once the explanation and the inputs have taken their part.

    ``units`` (M, q, q) make them orthonormal within a point, ``points`` (m,) are those that draw anything.
    """

    passes: tuple[Pass, ...]
    units: Matrix
    points: Indices

    def inner(self, drawn: Matrix, known: dict[Pass, Matrix]) -> Matrix:
        """Return what they share with draws that the explanation has no part in, (m, q, draws); each pass made once."""
        for each in self.passes:
            if each not in known:
                known[each] = each.inner(drawn)
        raw = np.concatenate([known[each][self.points] for each in self.passes], axis=1)
        return np.asarray(self.units[self.points] @ raw)

    def vectors(self, index: int) -> Matrix:
        """Return the orthonormal curves at one of the points, (q, rows + K)."""
        conditional, at = self.passes[0].conditional, int(self.points[index])
        rows = np.zeros((len(self.passes), self.units.shape[1] // len(self.passes), conditional.sample.rows))
        for each, kept in zip(self.passes, rows, strict=True):
            kept[:, each.part] = each.rows(slice(at, at + 1))[0]
        return np.asarray(self.units[at] @ conditional.beyond(rows.reshape(-1, conditional.sample.rows)))


def blocks_of(several: NDArray[Any]) -> Iterator[slice]:
    """Give the points of some curves (M, c, n), so many at once as memory has room for; at least one block."""
    return in_blocks(max(len(several), 1), max(1, BLOCK // max(prod(several.shape[1:]), 1)))


def side_by_side(blocks: list[Matrix]) -> Matrix:
    """Return square blocks (M, c, c) as the diagonal of larger ones."""
    ends = np.cumsum([0, *(each.shape[-1] for each in blocks)])
    made = np.zeros((len(blocks[0]), int(ends[-1]), int(ends[-1])))
    for begin, end, each in zip(ends, ends[1:], blocks, strict=False):
        made[:, begin:end, begin:end] = each
    return made


def without_taken(passes: tuple[Pass, ...]) -> tuple[Matrix, Matrix, Matrix]:
    """Return squares within every point with and without what is taken, and those with the next point without it."""
    taken = np.concatenate([each.taken for each in passes], axis=1)
    raw = side_by_side([each.normal for each in passes])
    following = side_by_side([each.next for each in passes]) - taken[1:] @ taken[:-1].swapaxes(1, 2)
    return raw, raw - taken @ taken.swapaxes(1, 2), following


def units_of(normal: Matrix) -> Matrix:
    """Return what makes columns with these squares (M, q, q) orthonormal, turned as little as can be.

    Those that depend on one another share what they draw (P.-O. Löwdin, J. Chem. Phys. 18, 1950, 365).
    """
    size = np.sqrt(np.maximum(np.einsum("mqq->mq", normal), 1e-300))
    squares, axes = np.linalg.eigh(np.nan_to_num(normal / (size[:, :, None] * size[:, None, :])))
    lengths = np.where(squares > DEPENDS**2, np.sqrt(np.maximum(squares, DEPENDS**2)), np.inf)
    return np.asarray((axes / lengths[:, None]) @ axes.swapaxes(1, 2) / size[:, None])
