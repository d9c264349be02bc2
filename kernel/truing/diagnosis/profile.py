"""Profile intervals of shapes: a time constant is seldom symmetric, and often bounded on one side only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from truing.diagnosis.contest import Contest
from truing.diagnosis.fit import Fit, Fitter
from truing.diagnosis.residual import white_residuals
from truing.diagnosis.slopes import white_directions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

LEVEL = 0.95
STEPS = 12
MOST_STEPS = 2
SHORTER = (1.0, 0.4, 0.1)
CLOSE = 0.05
"""A step that keeps its promise to this share of the noise variance is the last one."""


def shape_interval(full: Contest, best: Fit, number: int) -> tuple[float | None, float | None]:
    """Return the 95 % profile interval of a shape in SI; an end is None where the profile stays open to its bound."""
    item = best.parameters[number]
    limit = float(stdtrit(best.freedom, (1 + LEVEL) / 2)) ** 2
    profile = _Profile(full, best, number)
    lowest = profile.cost(float(best.values[number]))
    clipped = max(full.noise.tails[channel.name].clipped for channel in full.evidence.channels)
    allowed = limit * profile.variance / (1 - clipped) ** 2
    ends = [_end(profile, float(best.values[number]), bound, lowest + allowed) for bound in (item.low, item.high)]
    low, high = (None if end is None else exp(end) if item.is_log else end for end in ends)
    return low, high


def _end(profile: _Profile, start: float, bound: float, level: float) -> float | None:
    """Return where the profile crosses a level on the way to a bound; None where it does not."""
    before = start
    for step in range(1, STEPS + 1):
        place = start + (bound - start) * (step / STEPS) ** 2
        if profile.cost(place) > level:
            return float(brentq(lambda at: profile.cost(at) - level, before, place, xtol=1e-4))
        before = place
    return None


@dataclass(frozen=True)
class _Point:
    """Parameters and directions with a shape held, what is left there (whitened), and its penalised sum of squares."""

    x: Matrix
    u: Matrix
    left: Matrix

    @property
    def cost(self) -> float:
        return float(self.left @ self.left + self.u @ self.u)


class _Profile:
    """The least sum of squares with one shape held, everything else refitted from the nearest point that is known."""

    def __init__(self, full: Contest, best: Fit, number: int) -> None:
        self.full, self.best, self.number = full, best, number
        self.fitter = Fitter(full, best.hypothesis)
        self.inputs = white_directions(full, best.setting)
        rows = len(self.inputs)
        left = np.concatenate(best.innovations)
        self.variance = float(left @ left) / max(rows - len(best.values) - len(best.directions), 1)
        start = float(best.values[number])
        self.known = {start: self._point(np.array(best.values), np.array(best.directions))}

    def cost(self, value: float) -> float:
        """Return the least penalised sum of squares with the shape at ``value``: linear steps on the exact model."""
        if value not in self.known:
            near = self.known[min(self.known, key=lambda other: abs(other - value))]
            x = near.x.copy()
            x[self.number] = value
            self.known[value] = self._refitted(self._point(x, near.u))
        return self.known[value].cost

    def _point(self, x: Matrix, u: Matrix) -> _Point:
        return self._points([x], u)[0]

    def _points(self, every: Sequence[Matrix], u: Matrix) -> list[_Point]:
        left = white_residuals(self.full, self.fitter, self.best.setting, [(x, u) for x in every])
        return [_Point(x, u, each) for x, each in zip(every, left, strict=True)]

    def _refitted(self, point: _Point) -> _Point:
        """Return the best point that a few linear steps lead to, each shortened where it leads up."""
        for _ in range(MOST_STEPS):
            moved, hoped = self._step(point)
            for share in SHORTER:
                x, u = self._within(point.x + share * moved[: len(point.x)]), point.u + share * moved[len(point.x) :]
                tried = self._point(x, u)
                if tried.cost < point.cost:
                    break
            if tried.cost >= point.cost:
                return point
            point = tried
            if point.cost - hoped < CLOSE * self.variance:
                return point
        return point

    def _within(self, x: Matrix) -> Matrix:
        items = self.fitter.parameters
        return np.clip(x, [item.low for item in items], [item.high for item in items])

    def _step(self, point: _Point) -> tuple[Matrix, float]:
        """Return where a linear step leads, parameters and directions one after the other, and the cost it promises."""
        k, free = len(point.u), [place for place in range(len(point.x)) if place != self.number]
        design = np.column_stack([*(-slope for slope in self._slopes(point, free)), self.inputs])
        prior = np.concatenate([np.zeros((k, len(free))), np.eye(k)], axis=1)
        full = np.concatenate([design, prior])
        target = np.concatenate([point.left, -point.u])
        found = np.linalg.lstsq(full, target, rcond=None)[0]
        rest = target - full @ found
        moved = np.zeros(len(point.x) + k)
        moved[[*free, *range(len(point.x), len(moved))]] = found
        return moved, float(rest @ rest)

    def _slopes(self, point: _Point, places: Sequence[int]) -> list[Matrix]:
        """Return the derivatives of what is left by some parameters."""
        ups = []
        for place in places:
            item = self.fitter.parameters[place]
            step = 1e-3 * max(abs(float(point.x[place])), 1e-2)
            ups.append(point.x.copy())
            ups[-1][place] += -step if point.x[place] + step > item.high else step
        steps = [up[place] - point.x[place] for place, up in zip(places, ups, strict=True)]
        return [(up.left - point.left) / step for up, step in zip(self._points(ups, point.u), steps, strict=True)]
