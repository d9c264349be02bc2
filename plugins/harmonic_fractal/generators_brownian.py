"""Made patches of fractional Brownian motion: alike in all directions, Gaussian, with an exact power law."""

import numpy as np
from scipy.fft import next_fast_len

from harmonic_fractal.generators import Array

STEIN = "Stein, Journal of Computational and Graphical Statistics 11 (2002), p. 587"


def brownian_surface(dimension: float, step: float, shape: tuple[int, int], rng: np.random.Generator) -> Array:
    """Make a patch of fractional Brownian motion on a square grid: heights ``shape`` (rows, points), 0 at its corner.

    ``dimension`` D_s (1 to 2) is that of its profiles, ``step`` the structure function at one spacing, m^2: at any
    distance of r spacings, in any direction, it is step r^(4-2 D_s), exactly. A stationary field whose covariance ends
    within a circle is made by circulant embedding, and an inclined plane of random slopes is added (Stein 2002).
    """
    rows, points = shape
    exponent = 4.0 - 2.0 * dimension
    unit = float(np.hypot(rows, points))  # the law holds up to this distance, in spacings
    side = field_side(dimension, shape)
    away = np.minimum(np.arange(side), side - np.arange(side)) / unit
    covariance, slope = _covariance(np.hypot(away[:, None], away[None, :]), exponent, _reach(dimension))
    spectrum = np.maximum(np.fft.rfft2(covariance).real, 0.0)
    field = np.fft.irfft2(np.sqrt(spectrum) * np.fft.rfft2(rng.standard_normal((side, side))), s=(side, side))
    heights = field[:rows, :points] - field[0, 0]
    tilts = rng.standard_normal(2) * np.sqrt(2.0 * slope) / unit
    heights = heights + tilts[0] * np.arange(rows)[:, None] + tilts[1] * np.arange(points)
    return np.asarray(heights * np.sqrt(0.5 * step * unit**exponent), dtype=np.float64)


def _covariance(distance: Array, exponent: float, reach: float) -> tuple[Array, float]:
    """Return the covariance of the stationary field at distances in units, and its share of the square of these."""
    tail = 0.0 if reach <= 1.0 else exponent * (2.0 - exponent) / (3.0 * reach * (reach**2 - 1.0))
    slope = 0.5 * (exponent - tail * (reach - 1.0) ** 2 * (reach + 2.0))
    level = tail * (reach - 1.0) ** 3 + 1.0 - slope
    inside = level - distance**exponent + slope * distance**2
    outside = tail * np.maximum(reach - distance, 0.0) ** 3 / np.maximum(distance, 1.0)
    return np.where(distance <= 1.0, inside, outside), slope


def field_side(dimension: float, shape: tuple[int, int]) -> int:
    """Return the side, in points, of the square field from which a patch of this shape is cut."""
    least = 2.0 * _reach(dimension) * float(np.hypot(*shape))
    return 2 * int(next_fast_len(int(np.ceil(least / 2.0)) + 1, real=True))


def _reach(dimension: float) -> float:
    """Return where the covariance of the field ends, in units; smooth surfaces need it to end later."""
    return 1.0 if dimension >= 1.25 else 2.0
