"""What the data can see of every curve once the tolerances have taken their part: which curves are one and the same.

With D the directions of the tolerated inputs, in units of the noise, two columns have the inner product
``a' (1 + D D')^-1 b``. Everything follows from these numbers, so no matrix has as many rows as the data.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import Term
from truing.diagnosis.columns import Column, Design, acting, in_blocks
from truing.diagnosis.machine import Machine, gram_of
from truing.diagnosis.shapes import Library

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

SAME_CURVE = 1e-4
REPRODUCED = 0.98
FAINTEST = 1e-10
"""Share of the largest eigenvalue below which a combination of curves is rounding."""


class Sight:
    """Inner products of the visible parts of all curves of causes, and of the library's shapes on every result."""

    def __init__(
        self, machine: Machine, scales: Mapping[str, float], variants: Sequence[Sequence[Term]], library: Library
    ) -> None:
        import numpy as np

        curves = [curve for terms in variants for term in terms for curve in term.curves]
        sizes = [[len(term.curves) for term in terms] for terms in variants]
        ends = np.cumsum([0, *(size for each in sizes for size in each)])
        numbers: Iterator[int] = iter(range(len(ends)))
        self.terms = [[_places(ends, next(numbers)) for _ in each] for each in sizes]
        columns = [Column(acting(curve)) for curve in curves]
        self.shapes = library.shapes
        self.bases = {name: len(columns) + place * len(library.bases) for place, name in enumerate(scales)}
        columns += [Column({name: base.values}, scale) for name, scale in scales.items() for base in library.bases]
        self.products = _products(machine, scales, columns)

    def is_same(self, a: NDArray[np.intp], candidate: int) -> bool:
        """Tell whether a variant draws the curves of a candidate (sine squared of the largest angle below 1e-4)."""
        import numpy as np

        b = self.terms[candidate][0]
        if len(a) != len(b):
            return False
        cosines = self._basis(a).T @ self.products[np.ix_(a, b)] @ self._basis(b)
        return bool(1 - np.linalg.svd(cosines, compute_uv=False).min() ** 2 < SAME_CURVE)

    def reproduced(
        self, kept: Sequence[int], groups: Sequence[tuple[int, tuple[str, ...]]]
    ) -> frozenset[tuple[int, int]]:
        """Return the pairs of a cause and a shape that reproduces it: the split between the two would be arbitrary.

        ``groups`` holds, for every shape on its results, the place of the shape and the results.
        """
        import numpy as np

        owners = [(place, term) for place in kept for term in self.terms[place]]
        if not owners:
            return frozenset()
        every = np.concatenate([term for _, term in owners])
        begins = np.cumsum([0, *(len(term) for _, term in owners)])[:-1]
        size = np.maximum(np.diag(self.products)[every], 1e-300)
        found: set[tuple[int, int]] = set()
        for group, (place, results) in enumerate(groups):
            own = np.array([self.bases[name] + column for name in results for column in self.shapes[place].columns])
            covered = np.sum((self._basis(own).T @ self.products[np.ix_(own, every)]) ** 2, axis=0) / size
            least = np.minimum.reduceat(covered, begins)
            found |= {(owners[number][0], group) for number in np.flatnonzero(least > REPRODUCED)}
        return frozenset(found)

    def _basis(self, places: NDArray[np.intp]) -> Matrix:
        """Return combinations of columns that are orthonormal, shape (columns, rank)."""
        import numpy as np

        gram = self.products[np.ix_(places, places)]
        unit = 1 / np.sqrt(np.maximum(np.diag(gram), 1e-300))
        values, vectors = np.linalg.eigh(gram * np.outer(unit, unit))
        is_kept = values > FAINTEST * values[-1]
        return np.asarray(unit[:, None] * vectors[:, is_kept] / np.sqrt(values[is_kept]))


def _places(ends: NDArray[np.intp], number: int) -> NDArray[np.intp]:
    import numpy as np

    return np.arange(ends[number], ends[number + 1])


def _products(machine: Machine, scales: Mapping[str, float], columns: Sequence[Column]) -> Matrix:
    """Return the inner products of the visible parts of columns, in units of the noise, (m, m)."""
    import numpy as np

    rows = len(machine.records)
    moves = machine.directions(
        np.asarray(sum(gram_of(machine.slopes[name]) / scale**2 for name, scale in scales.items())),
        rows * len(scales),
    )
    k = moves.shape[1]
    total = np.zeros((k + len(columns), k + len(columns)))
    for name, scale in scales.items():
        design = Design(name, columns, rows)
        at = np.concatenate([np.arange(k), k + design.active])
        gram = np.zeros((len(at), len(at)))
        for block in in_blocks(rows):
            made = design.block(np.arange(block.start, block.stop))
            both = np.concatenate([(machine.slopes[name][block] @ moves).T, made]) / scale
            gram += both @ both.T
        total[np.ix_(at, at)] += gram
    return visible(total, k)


def visible(gram: Matrix, k: int) -> Matrix:
    """Return the inner products that are left of columns when ``k`` directions with unit prior have taken their part.

    ``gram`` holds the inner products of directions and columns, in this order, in units of the noise.
    """
    import numpy as np

    taken = np.linalg.solve(gram[:k, :k] + np.eye(k), gram[:k, k:])
    return np.asarray(gram[k:, k:] - gram[k:, :k] @ taken)
