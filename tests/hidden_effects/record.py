"""One record as the generator knows it, and how visible and how separable in it is what was hidden.

Noncentralities with the true noise and the tolerances as prior: with V the covariance of the readings of machines of
this design (noise and tolerances together) and d what was hidden, ``lambda_det = d' V^-1 d`` and the separation from
columns M is ``min_c (d - M c)' V^-1 (d - M c)``: what the deviance is expected to lose where the rival is fitted
instead. Amplitudes keep to their bounds; shapes are tried on fine grids.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, product

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import lsq_linear

from hidden_effects.candidates import Candidate, columns, registered, tolerance_columns
from hidden_effects.designs import Noise, covariance
from hidden_effects.press_machine import Array, Rows
from hidden_effects.shapes import groups

TINY = 1e-10
SAME = 1e-6  # part of a curve that another does not explain, below which both are one curve


@dataclass(frozen=True)
class Variant:
    """A candidate with its shapes chosen: its place among the candidates, and its columns in the matrix."""

    owner: int
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Curves:
    """The columns of all variants, (rows * results, columns), with the bounds of their amplitudes."""

    variants: tuple[Variant, ...]
    matrix: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class Record:
    """What is measured, how, and with what noise."""

    rows: Rows
    results: tuple[str, ...]
    noise: Noise

    @cached_property
    def candidates(self) -> list[Candidate]:
        """Everything registered."""
        return registered(self.results, float(self.rows.time[-1]))

    @cached_property
    def tolerances(self) -> Array:
        """Columns of the tolerances, per standard deviation."""
        return tolerance_columns(self.rows, self.results)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the noise of all results."""
        return covariance(self.noise, self.rows, self.results)

    @cached_property
    def factor(self) -> Array:
        """Lower Cholesky factor of the covariance of readings over all machines of this design, noise included."""
        return np.asarray(cholesky(self.covariance + self.tolerances @ self.tolerances.T, lower=True))

    @cached_property
    def weight(self) -> Array:
        """One over the standard deviation of the noise of every row."""
        return np.asarray(1 / np.sqrt(np.diag(self.covariance)))

    @cached_property
    def curves(self) -> Curves:
        """Every candidate with every choice of its shapes."""
        variants, made = [], []
        bounds: list[tuple[float, float]] = []
        for owner, candidate in enumerate(self.candidates):
            for shapes in candidate.variants():
                first = len(bounds)
                made.append(columns(self.rows, self.results, candidate, shapes))
                bounds.extend(candidate.amplitudes.values())
                variants.append(Variant(owner, tuple(range(first, len(bounds)))))
        low, high = np.array(bounds).T
        return Curves(tuple(variants), np.hstack(made), low, high)

    def imitated(self, hidden: Array) -> tuple[Array, Array]:
        """What no machine within its tolerances imitates, and the machine of the best imitation in its sds.

        Hidden less its best imitation, prior included; rows count by their own noise, as if it were independent.
        """
        count = self.tolerances.shape[1]
        design = np.vstack([self.tolerances * self.weight[:, None], np.eye(count)])
        found = np.linalg.lstsq(design, np.concatenate([hidden * self.weight, np.zeros(count)]), rcond=None)[0]
        return np.asarray(hidden - self.tolerances @ found), np.asarray(found)

    def rest_of(self, change: Array) -> float:
        """Root mean square over the noise of what is left of a change by its best imitation."""
        return self.size_of(self.imitated(change)[0])

    def strangeness_of(self, change: Array) -> float:
        """The same, with how far the imitating machine lies outside its tolerances counted in."""
        rest, machine = self.imitated(change)
        return float(np.sqrt((np.sum((rest * self.weight) ** 2) + machine @ machine) / len(self.rows)))

    def size_of(self, change: Array) -> float:
        """Root mean square of a change over the noise, of the result where that is largest."""
        parts = zip(np.split(change, len(self.results)), self.results, strict=True)
        return max(float(np.sqrt(np.mean(part**2))) / self.noise.sd[result] for part, result in parts)

    @cached_property
    def contained(self) -> Array:
        """Whether candidate [i] is, on these readings, one of the curves of candidate [j]; (count, count)."""
        found = np.zeros((len(self.candidates),) * 2, dtype=bool)
        spans = [(variant.owner, self._span(variant)) for variant in self.curves.variants]
        first = dict(reversed(spans))
        for owner, span in spans:
            for other, curve in first.items():
                left = curve - span @ (span.T @ curve)
                found[other, owner] |= bool(curve.shape[1] and np.max(np.sum(left**2, axis=0)) < SAME)
        return found

    def _span(self, variant: Variant) -> Array:
        """Orthonormal curves of a variant, rows weighted by their noise; none where nothing of it shows."""
        made = self.curves.matrix[:, list(variant.columns)] * self.weight[:, None]
        lengths = np.linalg.norm(made, axis=0)
        if not np.any(lengths > 0):
            return made[:, :0]
        made = made[:, lengths > 0] / lengths[lengths > 0]
        left, sizes, _ = np.linalg.svd(made, full_matrices=False)
        return np.asarray(left[:, sizes > 1e-3 * sizes.max()])

    def same_as(self, name: str) -> frozenset[str]:
        """Every candidate that is the same curve as this one on these readings, itself included."""
        place = self.place(name)
        both = self.contained[place] & self.contained[:, place]
        return frozenset(self.candidates[other].name for other in np.flatnonzero(both)) | {name}

    def effects_of(self, name: str) -> set[str]:
        """Every effect that is the same curve as a candidate."""
        return {self.candidates[self.place(other)].effect for other in self.same_as(name)}

    def place(self, name: str) -> int:
        """Where a candidate stands."""
        return next(place for place, candidate in enumerate(self.candidates) if candidate.name == name)

    def covers(self, rival: Collection[int], truth: Collection[int]) -> bool:
        """Whether a set of candidates can make every curve of another, so that it is no rival but contains it."""
        return all(any(self.contained[one, other] for other in rival) for one in truth)

    def of(self, owner: int) -> Sequence[Variant]:
        """The variants of one candidate."""
        return [variant for variant in self.curves.variants if variant.owner == owner]


# What a record can show

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
