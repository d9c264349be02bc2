"""Pairs that come to bear only under torque: how many times as many as stated there are at a torque."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.quantities import Drive
from truing import Float

STEPS = 60  # of Newton's iteration at most, kept within its bracket
FINE = 1e-15


@dataclass(frozen=True, kw_only=True)
class Engagement:
    """Pairs over those stated: without torque, and the gain at a large one; 63 % of it at ``scale``, N m."""

    start: Float
    gain: Float
    scale: Float

    def factor(self, torque: Float) -> Float:
        """Return how many times as many pairs as stated are engaged at a torque of either sense, N m."""
        found: Float = self.start * (1.0 - self.gain * np.expm1(-np.abs(torque) / self.scale))
        return found

    def torque_of(self, share: Float) -> Float:
        """Return the torque above 0 that is ``share`` for each of as many pairs as stated, N m.

        More torque is more for each, however many come to bear, so there is one.
        """
        wanted = np.log(share)
        low = wanted + np.log(self.start)
        high = low + np.log1p(self.gain)
        way = np.asarray(low, dtype=float)
        for _ in range(STEPS):
            torque = np.exp(way)
            off = way - np.log(self.factor(torque)) - wanted
            low, high = np.where(off < 0.0, way, low), np.where(off > 0.0, way, high)
            rise = self.start * self.gain * torque / self.scale * np.exp(-torque / self.scale) / self.factor(torque)
            tried = way - off / (1.0 - rise)
            after = np.where((tried > low) & (tried < high), tried, 0.5 * (low + high))
            moved, way = np.abs(after - way), after
            if not (moved > FINE * (1.0 + np.abs(way))).any():
                break
        found: Float = np.exp(way)
        return found

    def of_rows(self, index: NDArray[np.intp], rows: int, axes: int) -> "Engagement":
        """Return that of these rows out of so many, with axes behind."""
        numbers = (np.broadcast_to(np.asarray(value, dtype=float), (rows,))[index] for value in vars(self).values())
        start, gain, scale = (value[(..., *(np.newaxis,) * axes)] for value in numbers)
        return Engagement(start=start, gain=gain, scale=scale)


def engagement_of(drive: Drive) -> Engagement:
    """Return the engagement of a drive."""
    return Engagement(start=drive.engaged_factor, gain=drive.engaged_gain, scale=drive.engaged_torque)
