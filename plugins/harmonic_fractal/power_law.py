"""The power law of the structure function of a Weierstrass-Mandelbrot surface, and the conventions of its constant."""

from typing import Literal

import numpy as np
from scipy.special import gamma

from truing import Float

Convention = Literal["areal", "one_direction", "profile"]


def spectral_constant(dimension: Float) -> Float:
    """Return Lambda of a profile dimension D_s (1 to 2), finite there: pi/2 at 1.5."""
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    # Gamma(1 - a) cos(pi a/2)/a by the reflection formula: pi / (2 sin(pi a/2) Gamma(1 + a)), without 0 times infinity
    value: Float = np.pi / (2.0 * np.sin(np.pi * exponent / 2.0) * gamma(1.0 + exponent))
    return value


def constant(dimension: Float, density: Float, convention: Convention) -> Float:
    """Return C of S = C G^(2(D_s-1)) lag^(4-2 D_s), a pure number, of this convention of G."""
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    one_direction: Float = (2.0 * np.pi) ** exponent * spectral_constant(dimension)
    if convention == "profile":
        return one_direction / np.log(density)
    if convention == "one_direction":
        return one_direction
    mean_of_directions: Float = gamma((1.0 + exponent) / 2.0) / (np.sqrt(np.pi) * gamma(1.0 + exponent / 2.0))
    return one_direction * mean_of_directions


def converted(roughness: Float, dimension: Float, density: Float, *, source: Convention, target: Convention) -> Float:
    """Return G, m, of one convention in another one."""
    ratio = constant(dimension, density, source) / constant(dimension, density, target)
    changed: Float = roughness * ratio ** (1.0 / (2.0 * (np.asarray(dimension) - 1.0)))
    return changed


def roughness_of(intercept: Float, dimension: Float, density: Float = 1.5, convention: Convention = "areal") -> Float:
    """Return G, m, of a straight line through ln S (m^2) over ln lag (m): its value at a lag of 1 m, and D_s.

    NaN where D_s is not within 1 and 2: a power law of another exponent has no G.
    """
    inside = (np.asarray(dimension) > 1.0) & (np.asarray(dimension) < 2.0)
    safe = np.where(inside, dimension, 1.5)
    logarithm = (intercept - np.log(constant(safe, density, convention))) / (2.0 * (safe - 1.0))
    roughness: Float = np.where(inside, np.exp(logarithm), np.nan)[()]
    return roughness


def structure_function(lag: Float, dimension: Float, roughness: Float) -> Float:
    """Return S, m^2, at a lag in m, of a profile dimension and G in the areal convention."""
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    return constant(dimension, 1.5, "areal") * roughness ** (2.0 - exponent) * lag**exponent
