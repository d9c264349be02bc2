"""Profile intervals of shapes: a time constant is seldom symmetric, and often bounded on one side only."""

from __future__ import annotations

from math import exp
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest
from truing.diagnosis.fit import Fit, Fitter, white_directions, white_residual

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

LEVEL = 0.95
STEPS = 12


def shape_interval(full: Contest, best: Fit, number: int) -> tuple[float | None, float | None]:
    """Return the 95 % profile interval of a shape in SI; an end is None where the profile stays open to its bound."""
    from scipy.stats import f as ratio

    item = best.parameters[number]
    limit = float(ratio.ppf(LEVEL, 1, best.freedom))
    profile = _Profile(full, best, number)
    lowest = profile.cost(float(best.values[number]))
    clipped = max(full.noise.tails[channel.name].clipped for channel in full.evidence.channels)
    allowed = limit * lowest / max(best.freedom, 1.0) / (1 - clipped) ** 2 if best.freedom > 0 else limit
    allowed = max(allowed, limit * profile.variance / (1 - clipped) ** 2)
    ends = [_end(profile, float(best.values[number]), bound, lowest + allowed) for bound in (item.low, item.high)]
    low, high = (None if end is None else exp(end) if item.is_log else end for end in ends)
    return low, high


def _end(profile: _Profile, start: float, bound: float, level: float) -> float | None:
    """Return where the profile crosses a level on the way to a bound; None where it does not."""
    from scipy.optimize import brentq

    before = start
    for step in range(1, STEPS + 1):
        place = start + (bound - start) * (step / STEPS) ** 2
        if profile.cost(place) > level:
            return float(brentq(lambda at: profile.cost(at) - level, before, place, xtol=1e-4))
        before = place
    return None


class _Profile:
    """The least sum of squares with one shape held, everything else refitted linearly about the best fit."""

    def __init__(self, full: Contest, best: Fit, number: int) -> None:
        import numpy as np

        self.full, self.best, self.number = full, best, number
        self.fitter = Fitter(full, best.hypothesis)
        self.inputs = white_directions(full, best.setting)
        rows = len(self.inputs)
        left = np.concatenate(best.innovations)
        self.variance = float(left @ left) / max(rows - len(best.values) - len(best.directions), 1)
        self.known: dict[float, float] = {}

    def cost(self, value: float) -> float:
        """Return the least penalised sum of squares with the shape at ``value``."""
        import numpy as np

        if value in self.known:
            return self.known[value]
        x = np.array(self.best.values)
        x[self.number] = value
        u = self.best.directions
        left = white_residual(self.full, self.fitter, self.best.setting, x, u)
        columns = [-white_column(self, x, place) for place in range(len(x)) if place != self.number]
        k = len(u)
        design = np.column_stack([*columns, self.inputs]) if columns or k else np.zeros((len(left), 0))
        prior = np.concatenate([np.zeros((k, len(columns))), np.eye(k)], axis=1)
        full = np.concatenate([design, prior])
        target = np.concatenate([left, -u])
        moved = np.linalg.lstsq(full, target, rcond=None)[0]
        rest = target - full @ moved
        self.known[value] = float(rest @ rest)
        return self.known[value]


def white_column(profile: _Profile, x: Matrix, place: int) -> Matrix:
    """Return minus the derivative of the prediction by a coefficient, whitened: effects are linear in it."""
    import numpy as np

    step = 1e-3 * max(abs(float(x[place])), 1e-2)
    up = x.copy()
    up[place] += step
    u = profile.best.directions
    setting = profile.best.setting
    a = white_residual(profile.full, profile.fitter, setting, up, u)
    b = white_residual(profile.full, profile.fitter, setting, x, u)
    return np.asarray((a - b) / step)
