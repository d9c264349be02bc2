"""How visible and how separable is what was hidden? Noncentralities with the true noise and the tolerances as prior.

With V the covariance of the readings of machines of this design (noise and tolerances together) and d what was hidden,
``lambda_det = d' V^-1 d`` and the separation from columns M is ``min_c (d - M c)' V^-1 (d - M c)``: what the deviance
is expected to lose where the rival is fitted instead. Amplitudes keep to their bounds; shapes are tried on fine grids.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, product

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import lsq_linear

from hidden_effects.press_machine import Array
from hidden_effects.record import Record, Variant
from hidden_effects.shapes import groups

TINY = 1e-10
Set = tuple[Variant, ...]


@dataclass(frozen=True)
class Rival:
    """Another explanation and its separation from what was hidden."""

    names: tuple[str, ...]
    separation: float


@dataclass(frozen=True)
class Lens:
    """A record seen through its noise and tolerances; ``free`` columns are fitted beside every explanation."""

    record: Record
    free: Array | None = None

    @cached_property
    def _free_span(self) -> Array:
        """Orthonormal columns of what is fitted freely."""
        assert self.free is not None
        white = solve_triangular(self.record.factor, self.free, lower=True)
        lengths = np.linalg.norm(white, axis=0)
        left, sizes, _ = np.linalg.svd(white[:, lengths > 0] / lengths[lengths > 0], full_matrices=False)
        return np.asarray(left[:, sizes > 1e-6 * sizes.max()])

    def whitened(self, values: Array) -> Array:
        """Values or columns in units in which readings of this design scatter like pure noise, less what is free."""
        white = np.asarray(solve_triangular(self.record.factor, values, lower=True))
        return white if self.free is None else white - self._free_span @ (self._free_span.T @ white)

    @cached_property
    def scaled(self) -> tuple[Array, Array]:
        """Whitened columns of unit length, and the lengths they had (1 where there is nothing)."""
        white = self.whitened(self.record.curves.matrix)
        lengths = np.linalg.norm(white, axis=0)
        lengths = np.where(lengths > 1e-9, lengths, 1.0)
        return white / lengths, lengths

    @cached_property
    def gram(self) -> Array:
        """Inner products of all whitened columns."""
        return np.asarray(self.scaled[0].T @ self.scaled[0])

    def visibility(self, hidden: Array) -> float:
        """The noncentrality of what was hidden."""
        white = self.whitened(hidden)
        return float(white @ white)

    def nearest(self, hidden: Array, sets: Sequence[Set]) -> Rival:
        """The set from which what was hidden is separated least, amplitudes within their bounds."""
        white = self.whitened(hidden)
        total, along = float(white @ white), self.scaled[0].T @ white
        places = [tuple(column for variant in one for column in variant.columns) for one in sets]
        free, best, which = self._free(places, along, total), np.inf, -1
        for at in np.argsort(free).tolist():
            if free[at] >= best:
                break
            bounded = self._bounded(places[at], along, total)
            if bounded < best:
                best, which = bounded, at
        names = tuple(self.record.candidates[variant.owner].name for variant in sets[which]) if which >= 0 else ()
        return Rival(names, max(best, 0.0))

    def _free(self, places: Sequence[tuple[int, ...]], along: Array, total: float) -> Array:
        """Separation from every set with amplitudes of any size, all sets with as many columns at once."""
        found = np.full(len(places), total)
        sizes = np.array([len(one) for one in places], dtype=int)
        for size in set(sizes.tolist()) - {0}:
            which = np.flatnonzero(sizes == size)
            index = np.array([places[at] for at in which.tolist()])
            matrix = self.gram[index[:, :, None], index[:, None, :]] + TINY * np.eye(size)
            solved = np.linalg.solve(matrix, along[index][:, :, None])[:, :, 0]
            found[which] = total - np.sum(solved * along[index], axis=1)
        return found

    def _bounded(self, places: tuple[int, ...], along: Array, total: float) -> float:
        """Separation with the amplitudes of one set within their bounds."""
        index = list(places)
        if not index:
            return total
        root = np.asarray(cholesky(self.gram[np.ix_(index, index)] + TINY * np.eye(len(index))))
        target = solve_triangular(root, along[index], trans="T")
        lengths, curves = self.scaled[1][index], self.record.curves
        bounds = (curves.low[index] * lengths, curves.high[index] * lengths)
        found = solve_triangular(root, target)
        if np.any(found < bounds[0]) or np.any(found > bounds[1]):
            found = lsq_linear(root, target, bounds=bounds, tol=1e-13).x
        return total - float(target @ target) + float(np.sum((root @ found - target) ** 2))

    def separation(self, hidden: Array, names: Collection[str]) -> float:
        """Separation of what was hidden from these candidates together.

        The name of an effect with parts stands for all of its parts.
        """
        return self.nearest(hidden, self.sets_of(owners_of(self.record, names))).separation

    def sets_of(self, owners: Sequence[int]) -> list[Set]:
        """Every choice of shapes of these candidates together."""
        return list(product(*(self.record.of(owner) for owner in owners)))


def owners_of(record: Record, names: Collection[str]) -> list[int]:
    """Places of the candidates with these names; an effect's own name means every part of it."""
    return [at for at, one in enumerate(record.candidates) if {one.name, one.effect} & set(names)]


def rivals(lens: Lens, truth: Sequence[int], size: int) -> list[Set]:
    """Every set of up to ``size`` candidates that does not contain what is true."""
    record = lens.record
    count = range(len(record.candidates))
    chosen: Iterable[tuple[int, ...]] = chain.from_iterable(combinations(count, many) for many in range(1, size + 1))
    kept = [owners for owners in chosen if not (truth and record.covers(owners, truth))]
    return [one for owners in kept for one in lens.sets_of(owners)]


def beside_groups(lens: Lens, hidden: Array, kept: Iterable[tuple[frozenset[str], Array]]) -> Rival:
    """The smooth family from which what was hidden is separated least."""
    best = Rival((), np.inf)
    for depends_on, family in kept:
        left = Lens(lens.record, over_results(family, lens.record)).visibility(hidden)
        if left < best.separation:
            best = Rival(tuple(sorted(depends_on)), left)
    return best


def over_results(family: Array, record: Record) -> Array:
    """A family of every result by itself, (rows * results, columns * results)."""
    return np.asarray(np.kron(np.eye(len(record.results)), family), dtype=float)


def other_groups(record: Record, depends_on: Collection[str]) -> list[tuple[frozenset[str], Array]]:
    """Smooth families of at most as many covariates that do not have all the true ones."""
    true = frozenset(depends_on)
    return [(names, one) for names, one in groups(record.rows) if len(names) <= len(true) and not true <= names]
