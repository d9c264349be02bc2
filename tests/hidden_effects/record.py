"""One record as the generator knows it: rows, noise, and the column of everything that could have been hidden."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky

from hidden_effects.candidates import Candidate, columns, registered, tolerance_columns
from hidden_effects.designs import Noise, covariance
from hidden_effects.press_machine import Array, Rows

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
