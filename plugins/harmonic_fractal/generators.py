"""Made lines and patches of known truth: Weierstrass-Mandelbrot sums of waves, and fractional Brownian motion.

All randomness comes from the generator that is handed in. Heights and places are in m; S is the structure function.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
YAN = "Yan, Komvopoulos, Journal of Applied Physics 84 (1998), p. 3617"
MAJUMDAR = "Majumdar, Tien, Wear 136 (1990), p. 313"
DAVIES = "Davies, Harte, Biometrika 74 (1987), p. 95"


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
