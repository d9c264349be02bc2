"""Derivatives for the exact fit: of unknowns by differences, of inputs from their columns while these will do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest
from truing.diagnosis.noise import SETTINGS, whiten
from truing.diagnosis.residual import Residual

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from truing.diagnosis.fit import Parameter

    Matrix = NDArray[np.float64]

STEP = 1e-4
MOVED = 0.02
"""Step of a direction of the inputs, in standard deviations."""
OFF = 1.0
"""Sum of squares, in units of the noise, that linear columns of the inputs may miss."""


class Jacobian:
    """Derivatives of the residual: of the unknowns by differences, of the inputs from their linear columns.

    Where the model is not linear in the inputs as far as they have moved, ``is_exact`` takes differences there, too.
    """

    def __init__(self, unknowns: Sequence[Parameter], residual: Residual, inputs: Matrix) -> None:
        self.unknowns, self.residual, self.inputs = unknowns, residual, inputs
        self.is_exact = False

    def is_off(self, x: Matrix) -> bool:
        """Whether the linear columns of the inputs miss more than chance of what the inputs do at a solution."""
        import numpy as np

        p, rows = len(self.unknowns), len(self.inputs)
        if len(x) == p:
            return False
        nominal = np.concatenate([x[:p], np.zeros(len(x) - p)])
        here, there = self.residual.at([x, nominal])
        missed = (here - there)[:rows] + self.inputs @ x[p:]
        return bool(missed @ missed > OFF)

    def __call__(self, x: Matrix) -> Matrix:
        """Return the derivatives of the residual by unknowns and directions, (residuals, parameters)."""
        import numpy as np

        p = len(self.unknowns)
        made = np.zeros((len(self.inputs) + len(x) - p, len(x)))
        made[: len(self.inputs), p:] = -self.inputs
        made[len(self.inputs) :, p:] = np.eye(len(x) - p)
        ends = dict(self._ends(x))
        left = iter(self.residual.at([point for pair in ends.values() for point in pair]))
        for place, (down, up) in ends.items():
            made[:, place] = self._slope(x, place, (down, next(left)), (up, next(left)))
        return made

    def _ends(self, x: Matrix) -> Iterator[tuple[int, tuple[Matrix, Matrix]]]:
        """Give the parameters of which differences are taken, each with the points below and above."""
        p = len(self.unknowns)
        for place in range(p, len(x)) if self.is_exact else ():
            down, up = x.copy(), x.copy()
            down[place], up[place] = x[place] - MOVED, x[place] + MOVED
            yield place, (down, up)
        for place, item in enumerate(self.unknowns):
            step = STEP * max(abs(float(x[place])), 1.0 if item.is_log else 1e-2)
            down, up = x.copy(), x.copy()
            down[place] = max(x[place] - step, item.low)
            up[place] = min(x[place] + step, item.high)
            yield place, (down, up)

    def _slope(self, x: Matrix, place: int, *sides: tuple[Matrix, Matrix]) -> Matrix:
        """Return the derivative by one parameter: one-sided where the model fails on a side, 0 where on both."""
        import numpy as np

        ends = [(point, left) for point, left in sides if np.isfinite(left).all()]
        if len(ends) < 2:
            ends.append((x, self.residual(x)))
        (first, one), (second, other) = ends[0], ends[-1]
        moved = second[place] - first[place]
        return (other - one) / moved if moved else np.zeros(len(one))


def white_directions(contest: Contest, setting: tuple[int, ...]) -> Matrix:
    """Return the directions of the tolerated inputs, whitened, channel below channel."""
    import numpy as np

    parts = [
        whiten(channel.directions * channel.weights[:, None], channel.starts, SETTINGS[place])
        for channel, place in zip(contest.evidence.channels, setting, strict=True)
    ]
    return np.concatenate(parts)
