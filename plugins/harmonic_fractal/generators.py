"""Made lines and patches of known truth, and what levelling makes of them."""

from dataclasses import dataclass

import numpy as np
import scipy

from truing import Array

# Made lines and patches of known truth: Weierstrass-Mandelbrot sums of waves, and fractional Brownian motion
#
# All randomness comes from the generator that is handed in. Heights and places are in m; S is the structure function.

# Yan, Komvopoulos, Journal of Applied Physics 84 (1998), p. 3617
# Majumdar, Tien, Wear 136 (1990), p. 313
# Davies, Harte, Biometrika 74 (1987), p. 95


@dataclass(frozen=True, kw_only=True)
class Waves:
    """What a Weierstrass-Mandelbrot surface is made of.

    ``dimension`` D_s is that of a profile (1 to 2), ``roughness`` G in m belongs to the form that is made. The waves
    have frequencies ``lowest``, ``lowest * density``, ... up to ``highest``, in 1/m (cycles). S follows its power law
    at lags well between 1/highest and 1/lowest: to try an estimator, let the band reach from 1/100 over the length of
    the line to 50 over the spacing. Waves shorter than two spacings are part of the truth, not a fault.
    ``directions`` M is the number of ridge directions of a patch.
    """

    dimension: float
    roughness: float
    lowest: float
    highest: float
    density: float = 1.5
    directions: int = 40

    @property
    def frequencies(self) -> Array:
        """Frequencies of the waves (n,), 1/m."""
        count = np.floor(np.log(self.highest / self.lowest) / np.log(self.density) + 1e-9)
        return np.asarray(self.lowest * self.density ** np.arange(count + 1.0), dtype=np.float64)

    @property
    def amplitudes(self) -> Array:
        """Amplitudes (n,) of the waves of a profile, G^(D_s-1) f^(D_s-2), in m."""
        scale = self.roughness ** (self.dimension - 1.0)
        return np.asarray(scale * self.frequencies ** (self.dimension - 2.0), dtype=np.float64)


def weierstrass_profile(waves: Waves, places: Array, lines: int, rng: np.random.Generator) -> Array:
    """Make lines of a Weierstrass-Mandelbrot profile, each with phases of its own: heights (lines, points).

    G is in the profile convention: z = sum of G^(D_s-1) f^(D_s-2) (cos phi - cos(2 pi f x + phi)), so z(0) = 0.
    Its amplitudes are fixed, so lines scatter less than those of a real surface. Source: Majumdar, Tien 1990.
    """
    amplitudes, turns = waves.amplitudes, 2.0 * np.pi * waves.frequencies
    phases = rng.uniform(0.0, 2.0 * np.pi, (lines, len(turns)))
    left = np.concatenate([amplitudes * np.cos(phases), -amplitudes * np.sin(phases)], axis=1)
    angles = np.outer(turns, places)
    heights = left @ np.concatenate([np.cos(angles), np.sin(angles)])
    return np.asarray((amplitudes * np.cos(phases)).sum(axis=1, keepdims=True) - heights, dtype=np.float64)


def profile_sum(waves: Waves, lags: Array) -> Array:
    """Return S (k,), m^2, of :func:`weierstrass_profile` at these lags: exact for any band, mean over the phases."""
    turns = 2.0 * np.pi * waves.frequencies
    return _mean_squares(waves.amplitudes, turns, lags)


def weierstrass_surface(waves: Waves, x: Array, y: Array, rng: np.random.Generator) -> Array:
    """Make a Weierstrass-Mandelbrot patch: heights (len(y), len(x)), 0 at x = y = 0.

    G is in the areal convention of Yan and Komvopoulos: M ridge directions at angles pi m/M, every direction with all
    frequencies, amplitudes G^(D_s-1) f^(D_s-2) sqrt(ln density / M). Each wave is plane, a product of one function of x
    and one of y, so the patch is one product of two thin matrices: real and imaginary parts are their columns.
    """
    amplitudes, along_x, along_y = _plane_waves(waves)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(amplitudes))
    down = np.outer(y, along_y) + phases
    across = np.outer(along_x, x)
    left = np.concatenate([amplitudes * np.cos(down), -amplitudes * np.sin(down)], axis=1)
    heights = left @ np.concatenate([np.cos(across), np.sin(across)])
    return np.asarray(amplitudes @ np.cos(phases) - heights, dtype=np.float64)


def surface_sum(waves: Waves, lags: Array, angle: float = 0.0) -> Array:
    """Return S (k,), m^2, of :func:`weierstrass_surface` along a trace at an angle to x, rad; mean over the phases."""
    amplitudes, along_x, along_y = _plane_waves(waves)
    turns = along_x * np.cos(angle) + along_y * np.sin(angle)
    return _mean_squares(amplitudes, turns, lags)


def _mean_squares(amplitudes: Array, turns: Array, lags: Array) -> Array:
    """Return the sum of A^2 (1 - cos(k lag)) over the waves; written by the sine, so that long waves lose no digits."""
    return np.asarray(2.0 * amplitudes**2 @ np.sin(np.outer(0.5 * turns, lags)) ** 2, dtype=np.float64)


def _plane_waves(waves: Waves) -> tuple[Array, Array, Array]:
    """Return amplitude, and the wave numbers along x and y in rad/m, of each wave (M n,), directions first."""
    angles = np.pi * np.arange(1, waves.directions + 1) / waves.directions
    turns = 2.0 * np.pi * waves.frequencies
    amplitudes = waves.amplitudes * np.sqrt(np.log(waves.density) / waves.directions)
    return (
        np.tile(amplitudes, waves.directions),
        np.outer(np.cos(angles), turns).ravel(),
        np.outer(np.sin(angles), turns).ravel(),
    )


def brownian_profiles(dimension: float, step: float, shape: tuple[int, int], rng: np.random.Generator) -> Array:
    """Make lines of fractional Brownian motion: heights ``shape`` (lines, points), each 0 at its first point.

    ``dimension`` is D_s (1 to 2), ``step`` the structure function at one spacing, m^2: at k spacings it is
    step k^(4-2 D_s), exactly and without end. The increments are exact too (circulant embedding, Davies, Harte 1987).
    """
    lines, points = shape
    covariance = _increments(4.0 - 2.0 * dimension, step, points)
    circle = np.concatenate([covariance, covariance[-2:0:-1]])
    spectrum = np.maximum(np.fft.fft(circle).real, 0.0)
    pairs = (lines + 1) // 2
    noise = rng.standard_normal((2, pairs, len(circle)))
    both = np.fft.fft(np.sqrt(spectrum / len(circle)) * (noise[0] + 1j * noise[1]), axis=1)
    increments = np.concatenate([both.real, both.imag])[:lines, : points - 1]
    return np.concatenate([np.zeros((lines, 1)), np.cumsum(increments, axis=1)], axis=1)


def _increments(exponent: float, step: float, points: int) -> Array:
    """Return the covariance of two increments k spacings apart, k = 0 ... points - 1, m^2."""
    k = np.arange(points, dtype=np.float64)
    powers = (k + 1.0) ** exponent - 2.0 * k**exponent + np.abs(k - 1.0) ** exponent
    return np.asarray(0.5 * step * powers, dtype=np.float64)


# Made patches of fractional Brownian motion: alike in all directions, Gaussian, with an exact power law

# Stein, Journal of Computational and Graphical Statistics 11 (2002), p. 587


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
    return 2 * int(scipy.fft.next_fast_len(int(np.ceil(least / 2.0)) + 1, real=True))


def _reach(dimension: float) -> float:
    """Return where the covariance of the field ends, in units; smooth surfaces need it to end later."""
    return 1.0 if dimension >= 1.25 else 2.0


# What levelling does to a structure function: each line loses its own straight line, and S its long lags


def levelled_structure(every: Array) -> Array:
    """Return S (n,) to be expected of lines of n points once each has lost its least-squares straight line.

    ``every`` (n,) is the true S at 0, 1, ... n - 1 spacings, of a power law or of any other surface whose increments
    are alike everywhere. With the direction q of the straight line (of length 1) and m = K q, K the matrix of -S/2, a
    step of k changes q by the same c k everywhere, and S(k) loses 2 c k mean(m(i+k) - m(i)) - (c k)^2 q m: exact. The
    products with K are convolutions, so that long lines cost little. At a tenth of a line levelling takes a quarter of
    S where D_s is 1.3, and 3 % where it is 1.7: so it raises the dimension that is found.
    """
    points = every.size
    steps = np.arange(points, dtype=np.float64)
    slope = np.sqrt(12.0 / (points * (points**2 - 1.0)))  # of q over the number of the point
    direction = slope * (steps - 0.5 * (points - 1))
    kernel = -0.5 * np.concatenate([every[:0:-1], every])
    size = 3 * points
    product = np.fft.irfft(np.fft.rfft(kernel, size) * np.fft.rfft(direction, size), size)[points - 1 : 2 * points - 1]
    weight = float(direction @ product)
    sums = np.concatenate([[0.0], np.cumsum(product)])
    rise = ((sums[-1] - sums[:-1]) - sums[:0:-1]) / (points - steps)  # mean of m(i + k) - m(i) over all i
    step = slope * steps
    return np.asarray(every - 2.0 * step * rise + step**2 * weight, dtype=np.float64)
