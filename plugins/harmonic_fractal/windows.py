"""The roughness-length method: how the roughness of a piece of a line grows with its length (Malinverno 1990).

It is the method that the patent names. It gives D_s and no G. Its windows of few points see less roughness than the
power law says, by an amount that is known for a Gaussian line: ``calibrated`` takes that out.
"""

from functools import lru_cache

import numpy as np
import scipy
from scipy.special import gammaln

from harmonic_fractal.structure import CACHED, Steps, mean_squares
from truing import Array

SHORTEST = 8  # points of a window
WINDOW_SHARE = 0.1  # of a line: the longest window
COUNT = 12


def roughness_length_of(heights: Array, spacing: float) -> float:
    """Read the profile dimension from lines (lines, points), m, by the roughness-length method.

    Of every window of w points the straight line is removed, rho = sqrt(sum r^2/(w-2)); its mean over all windows
    grows as w^(2-D_s). Windows of 8 points to a tenth of a line, evenly in their logarithm; those that hold a point
    that was not measured are left out, and windows that overlap by half count too. It gives no G: that comes from
    the structure function. NaN where a line is too short for two lengths of windows.
    """
    sizes = window_sizes(heights.shape[1])
    sums, counts = sums_of(heights, sizes, 1, 0)
    roughness = mean_squares(sums[0], counts[0])
    known = np.isfinite(roughness) & (roughness > 0)
    if known.sum() < 2:
        return float("nan")
    return 2.0 - float(
        np.polyfit(np.log(np.asarray(sizes[known] * spacing, dtype=float)), np.log(roughness[known]), 1)[0]
    )


def window_sizes(points: int) -> Steps:
    """Return the lengths of windows, in points, for a line of so many points."""
    return sizes_within(points, 1, int(WINDOW_SHARE * points * (1 + 1e-9)))


def sizes_within(points: int, shortest: int, longest: int) -> Steps:
    """Return lengths of windows, in points, that show lags of so many spacings: from twice the shortest, 8 at least."""
    first, last = max(SHORTEST, 2 * shortest if shortest > 1 else 1), min(longest, points)
    if last < first:
        return np.empty(0, dtype=np.int64)
    return np.unique(np.round(np.geomspace(first, last, COUNT))).astype(np.int64)


def sums_of(heights: Array, sizes: Steps, units: int, lines: int) -> tuple[Array, Array]:
    """Return sums and numbers (units, sizes) of the roughness of windows, m.

    A unit is so many neighbouring lines; or, where that is 0, one of so many pieces across all lines, to which a
    window belongs by its begin.
    """
    sums, counts = np.zeros((units, len(sizes))), np.zeros((units, len(sizes)))
    for column, size in enumerate(sizes.tolist()):
        rough = _roughness(heights, size)
        known = np.isfinite(rough)
        whole, many = np.where(known, rough, 0.0), known.astype(float)
        if lines:
            whole, many = whole.sum(axis=1), many.sum(axis=1)
            unit = np.arange(len(whole)) // lines
        else:
            whole, many = whole.sum(axis=0), many.sum(axis=0)
            unit = np.arange(len(whole)) * units // len(whole)
        sums[:, column], counts[:, column] = np.bincount(unit, whole, units), np.bincount(unit, many, units)
    return sums, counts


def _roughness(heights: Array, size: int) -> Array:
    """Return the standard deviation about each window's own straight line, m, (lines, windows)."""
    views = np.lib.stride_tricks.sliding_window_view(heights, size, axis=1)[:, :: max(size // 2, 1)]
    x = np.arange(size) - (size - 1) / 2.0
    found = np.empty(views.shape[:2])
    rows = max(1, CACHED // (views.shape[1] * size))
    for first in range(0, len(views), rows):
        window = views[first : first + rows]
        left = window - window.mean(axis=2, keepdims=True)
        left = left - ((left @ x) / (x @ x))[:, :, None] * x
        found[first : first + rows] = np.sqrt(np.einsum("ijk,ijk->ij", left, left) / (size - 2))
    return found


def slopes(sizes: Steps, roughness: Array) -> Array:
    """Return the slopes (...) of ln roughness (..., sizes) over ln size, least squares; NaN where one is missing."""
    if len(sizes) < 3:
        return np.full(np.shape(roughness)[:-1], np.nan)
    x = np.log(sizes)
    x = x - x.mean()
    return np.asarray(np.log(np.where(roughness > 0, roughness, np.nan)) @ x / (x @ x))


def calibrated(sizes: Steps, roughness: Array) -> float:
    """Return the profile dimension of the Gaussian lines that show this roughness (sizes,), within 1.02 and 1.98.

    NaN where a window is missing.
    """
    found = float(slopes(sizes, roughness))
    ends = 1.02, 1.98

    def off(dimension: float) -> float:
        return found - float(slopes(sizes, expected(dimension, tuple(sizes.tolist()))))

    if not np.isfinite(found):
        return float("nan")
    if off(ends[0]) * off(ends[1]) >= 0.0:
        return ends[0] if abs(off(ends[0])) < abs(off(ends[1])) else ends[1]
    return float(scipy.optimize.brentq(off, *ends, xtol=1e-5))


@lru_cache(maxsize=256)
def expected(dimension: float, sizes: tuple[int, ...]) -> Array:
    """Return the mean roughness (sizes,) of windows of Gaussian lines with S = lag^(4 - 2 D_s), lag in points.

    The mean square is exact, a trace; the mean of its root is taken as that of a gamma distribution of
    the same mean and variance.
    """
    return np.array([_expected(4.0 - 2.0 * dimension, size) for size in sizes])


def _expected(exponent: float, size: int) -> float:
    coarse = max(1, size // 64)  # a longer window is as rough as one of fewer points, further apart
    points = size // coarse
    place: Array = np.arange(points, dtype=float)
    kernel = -0.5 * np.abs(place[:, None] - place[None, :]) ** exponent
    straight, _ = np.linalg.qr(np.stack([np.ones(points), place], axis=1))
    level = kernel - straight @ (straight.T @ kernel)
    level = level - (level @ straight) @ straight.T
    mean = float(np.trace(level))
    half = mean**2 / (2.0 * float(np.sum(level * level)))
    share = float(np.exp(gammaln(half + 0.5) - gammaln(half))) / np.sqrt(half)
    return float(share * np.sqrt(mean / (points - 2)) * (size / points) ** (0.5 * exponent))
