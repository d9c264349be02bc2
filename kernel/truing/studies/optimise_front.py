"""What a front is worth: its knee, its hypervolume, and whether the search has settled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from truing.heavy import pymoo_hypervolume

REFERENCE = 1.1
"""The reference point of the hypervolume, in every objective: the box of the final front is 0 to 1."""
SETTLED = 1e-3
LAST = 0.1


@dataclass(frozen=True)
class Volume:
    """The hypervolume of every generation's front in one box: ``ideal`` is 0, ``nadir`` 1 in each objective."""

    ideal: tuple[float, ...]
    nadir: tuple[float, ...]
    history: tuple[float, ...]
    exhausted: bool = False
    """Whether the search ended because it found no design that it had not tried."""

    @property
    def last(self) -> int:
        """How many generations at the end are looked at."""
        return max(1, round(LAST * len(self.history)))

    @property
    def gain(self) -> float:
        """By what share it grew in these last generations."""
        before = self.history[max(0, len(self.history) - 1 - self.last)]
        return (self.history[-1] - before) / self.history[-1] if self.history[-1] > 0 else 0.0

    @property
    def settled(self) -> bool:
        """Whether it grew by no more than one part in a thousand, or nothing was left to try."""
        return self.exhausted or (len(self.history) > self.last and self.gain <= SETTLED)


def volume_of(fronts: Sequence[NDArray[np.float64]], *, exhausted: bool = False) -> Volume:
    """Measure every generation's front (values that should be small) in the box of the last one.

    In one objective it is the way from the reference to the best. An objective in which the last front has no extent
    takes that of all fronts. Source: E. Zitzler, L. Thiele, IEEE Trans. Evol. Comput. 3 (1999) 257.
    """
    found = [front for front in fronts if len(front)]
    last, whole = found[-1], np.vstack(found)
    ideal, nadir = last.min(axis=0), last.max(axis=0)
    nadir = np.where(nadir > ideal, nadir, whole.max(axis=0))
    span = np.where(nadir > ideal, nadir - ideal, 1.0)
    history = tuple(_hypervolume((front - ideal) / span) if len(front) else 0.0 for front in fronts)
    return Volume(tuple(ideal.tolist()), tuple((ideal + span).tolist()), history, exhausted)


def _hypervolume(values: NDArray[np.float64]) -> float:
    inside = values[(values < REFERENCE).all(axis=1)]
    if not len(inside):
        return 0.0
    if values.shape[1] == 1:
        return float(REFERENCE - inside.min())
    if values.shape[1] > 2:
        return float(pymoo_hypervolume.HV(ref_point=np.full(values.shape[1], REFERENCE))(inside))
    order = inside[np.lexsort(inside.T[::-1])]
    below = np.minimum.accumulate(np.concatenate([[REFERENCE], order[:, 1]]))
    return float(((REFERENCE - order[:, 0]) * (below[:-1] - below[1:])).sum())


def knee_of(front: NDArray[np.float64]) -> tuple[int, float]:
    """Return the design farthest from the chord of the normalised front, towards small values, and how far it is.

    The chord (with more objectives the plane) goes through the ends of the front, each objective from 0 to 1. With one
    objective it is the best design. Source: I. Das, Structural Optimization 18 (1999) 107.
    """
    if front.shape[1] == 1:
        return int(np.argmin(front[:, 0])), 0.0
    span = np.ptp(front, axis=0)
    scaled = (front - front.min(axis=0)) / np.where(span > 0, span, 1.0)
    distance = (1.0 - scaled.sum(axis=1)) / np.sqrt(front.shape[1])
    place = int(np.argmax(distance))
    return place, float(distance[place]) if (span > 0).all() else 0.0
