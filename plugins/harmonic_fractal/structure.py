"""The structure function of many parallel lines: mean square of the height difference of two points a lag apart."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Steps = NDArray[np.int64]
CACHED = 65536  # points of a block of lines; its differences stay in the cache of the processor


@dataclass(frozen=True, eq=False)
class StructureFunction:
    """S of every line: lags (k,) in m, sums of squared differences (lines, k) in m^2, and numbers of pairs (lines, k).

    Lines, or blocks of them, are put together by adding their sums and their pairs, not by averaging their S: so a
    line with holes weighs as much as it was measured.
    """

    lags: Array
    sums: Array
    counts: Array

    @property
    def pooled(self) -> Array:
        """S (k,) of all lines together, m^2; NaN where no pair was measured."""
        return mean_squares(self.sums.sum(axis=0), self.counts.sum(axis=0))

    @property
    def pairs(self) -> Array:
        """Numbers of pairs (k,) of all lines together."""
        counted: Array = self.counts.sum(axis=0)
        return counted

    def at(self, chosen: NDArray[np.bool_]) -> "StructureFunction":
        """Return the same for a choice (k,) of its lags."""
        return StructureFunction(self.lags[chosen], self.sums[:, chosen], self.counts[:, chosen])


def structure_function_of(heights: Array, spacing: float, steps: Steps) -> StructureFunction:
    """Return the structure function of lines (lines, points), m, at whole multiples ``steps`` (k,) of the spacing."""
    sums, counts = structure_sums(heights, steps)
    return StructureFunction(np.multiply(steps, spacing, dtype=float), sums, counts)


def structure_sums(heights: Array, steps: Steps) -> tuple[Array, Array]:
    """Return the sums of squared height differences (lines, k), m^2, and how many pairs of points each is of.

    ``heights`` (lines, points) in m, NaN where not measured: a pair counts where both of its points were measured.
    ``steps`` (k,) are lags in points, 1 to points - 1. The lines pass in blocks that fit the cache, so that a map of
    any size needs no more memory than itself; of each block all pairs of one lag are taken at once.
    """
    lines, points = heights.shape
    sums, counts = np.empty((lines, steps.size)), np.empty((lines, steps.size))
    rows = max(1, CACHED // points)
    for first in range(0, lines, rows):
        part = slice(first, first + rows)
        sums[part], counts[part] = _of_block(np.ascontiguousarray(heights[part], dtype=float), steps)
    return sums, counts


def _of_block(heights: Array, steps: Steps) -> tuple[Array, Array]:
    """Return the sums of a block of lines, which are taken as one: what crosses from line to line is cut off.

    A hole is a height of 0 whose two differences are set to 0. That costs as much as there are holes, while a mask
    would cost as much as there are points.
    """
    lines, points = heights.shape
    known = np.isfinite(heights)
    one_line, weights = np.where(known, heights, 0.0).ravel(), known.astype(np.float32)  # exact up to 2^24 points
    longest = int(steps.max(initial=0))
    room = np.zeros(longest + one_line.size)  # so that a hole at the very beginning has a place for both differences
    holes = longest + np.flatnonzero(~known)
    differences = room[longest:].reshape(lines, points)
    sums, counts = np.empty((lines, steps.size)), np.empty((lines, steps.size))
    for column, step in enumerate(steps.tolist()):
        np.subtract(one_line[step:], one_line[:-step], out=room[longest : room.size - step])
        room[holes] = 0.0
        room[holes - step] = 0.0
        inside = differences[:, : points - step]
        sums[:, column] = np.einsum("ij,ij->i", inside, inside)
        counts[:, column] = np.einsum("ij,ij->i", weights[:, step:], weights[:, :-step])
    return sums, counts


def piece_sums(heights: Array, steps: Steps, pieces: int) -> tuple[Array, Array]:
    """Return the same of pieces (pieces, k) along the lines, what lies at the same place of all lines together.

    A pair belongs to the piece in which it begins, so the pieces add up to the whole. There are as many pieces as are
    asked for, or as pairs of the longest lag begin on a line.
    """
    points = heights.shape[1]
    pieces = min(pieces, points - int(steps.max()))
    sums, counts = np.zeros((pieces, steps.size)), np.zeros((pieces, steps.size))
    rows = max(1, CACHED // points)
    for first in range(0, heights.shape[0], rows):
        block = np.ascontiguousarray(heights[first : first + rows], dtype=float)
        known = np.isfinite(block)
        filled, weight = np.where(known, block, 0.0), known.astype(float)
        for column, step in enumerate(steps):
            starts = np.linspace(0, points - step, pieces, endpoint=False).astype(int)
            both = weight[:, step:] * weight[:, :-step]
            squares = np.square(filled[:, step:] - filled[:, :-step]) * both
            sums[:, column] += np.add.reduceat(squares.sum(axis=0), starts)
            counts[:, column] += np.add.reduceat(both.sum(axis=0), starts)
    return sums, counts


def mean_squares(sums: Array, counts: Array) -> Array:
    """Return sums over counts, NaN where nothing was counted."""
    quotient: Array = np.divide(sums, counts, out=np.full(np.shape(sums), np.nan), where=counts > 0)
    return quotient
