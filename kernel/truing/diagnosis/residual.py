"""What an explanation leaves of the readings when it is calculated with the model itself."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.contest import Contest
from truing.diagnosis.noise import SETTINGS, whiten

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from truing.diagnosis.fit import Fitter

    Matrix = NDArray[np.float64]


class Residual:
    """What is left of the pseudo-observations, whitened, in units of the noise; the prior of the inputs below."""

    def __init__(self, contest: Contest, fitter: Fitter, setting: tuple[int, ...]) -> None:
        self.contest, self.fitter, self.setting, self.p = contest, fitter, setting, len(fitter.parameters)

    def __call__(self, x: Matrix) -> Matrix:
        """Return what is left at a point: parameters, then directions of the inputs."""
        return self.at([x])[0]

    def at(self, points: Sequence[Matrix]) -> list[Matrix]:
        """Return what is left at several points, with few calls of the model."""
        ends = [(x[: self.p], x[self.p :]) for x in points]
        left = white_residuals(self.contest, self.fitter, self.setting, ends)
        return [np.concatenate([each, u]) for each, (_, u) in zip(left, ends, strict=True)]


def white_residuals(
    contest: Contest, fitter: Fitter, setting: tuple[int, ...], points: Sequence[tuple[Matrix, Matrix]]
) -> list[Matrix]:
    """Return what is left of the pseudo-observations at each point, whitened, in units of the noise."""
    machine, raw = fitter.machine, contest.noise.residuals
    targets = {name: raw[name] + machine.base[name] + machine.shifts[name] for name in raw}
    found = []
    for made in fitter.predicted_at(points):
        parts = []
        for channel, place in zip(contest.evidence.channels, setting, strict=True):
            left = (targets[channel.name] - made[channel.name])[channel.rows] / channel.scale
            parts.append(whiten(left * channel.weights, channel.starts, SETTINGS[place]))
        found.append(np.concatenate(parts))
    return found
