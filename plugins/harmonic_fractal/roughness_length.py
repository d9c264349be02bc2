"""The roughness-length method: how the roughness of a piece of a line grows with its length (Malinverno 1990)."""

from dataclasses import dataclass

import numpy as np

from harmonic_fractal.lags import Steps
from harmonic_fractal.structure import CACHED, Array, mean_squares

SHORTEST = 8  # points of a window
SHARE = 0.1  # of a line: the longest window
COUNT = 12


@dataclass(frozen=True, eq=False, kw_only=True)
class RoughnessLength:
    """Windows (k,) in m, mean roughness in them (k,) in m, and the profile dimension that their power law says."""

    windows: Array
    roughness: Array
    dimension: float


def roughness_length_of(heights: Array, spacing: float) -> RoughnessLength:
    """Read the profile dimension from lines (lines, points), m, by the roughness-length method.

    Of every window of w points the straight line is removed, rho = sqrt(sum r^2/(w-2)); its mean over all windows
    grows as w^(2-D_s). Windows of 8 points to a tenth of a line, evenly in their logarithm; those that hold a point
    that was not measured are left out, and windows that overlap by half count too. It gives no G: that comes from
    the structure function. NaN where a line is too short for two lengths of windows.
    """
    sizes = window_sizes(heights.shape[1])
    roughness = np.array([_mean_roughness(heights, int(size)) for size in sizes])
    known = np.isfinite(roughness) & (roughness > 0)
    windows = sizes[known] * spacing
    dimension = float("nan")
    if known.sum() > 1:
        dimension = 2.0 - float(np.polyfit(np.log(windows), np.log(roughness[known]), 1)[0])
    return RoughnessLength(windows=windows, roughness=roughness[known], dimension=dimension)


def window_sizes(points: int) -> Steps:
    """Return the lengths of windows, in points, for a line of so many points."""
    longest = int(SHARE * points * (1 + 1e-9))
    if longest < SHORTEST:
        return np.empty(0, dtype=np.int64)
    return np.unique(np.round(np.geomspace(SHORTEST, longest, COUNT))).astype(np.int64)


def _mean_roughness(heights: Array, size: int) -> float:
    """Return the mean over all windows of the standard deviation about each window's own straight line, m."""
    views = np.lib.stride_tricks.sliding_window_view(heights, size, axis=1)[:, :: size // 2]
    x = np.arange(size) - (size - 1) / 2.0
    total, count = 0.0, 0
    rows = max(1, CACHED // (views.shape[1] * size))
    for first in range(0, len(views), rows):
        window = views[first : first + rows].reshape(-1, size)
        left = window - window.mean(axis=1, keepdims=True)
        left -= ((left @ x) / (x @ x))[:, None] * x
        rough = np.sqrt(np.einsum("ij,ij->i", left, left) / (size - 2))
        known = np.isfinite(rough)
        total += float(rough[known].sum())
        count += int(known.sum())
    return float(mean_squares(np.array(total), np.array(count)))
