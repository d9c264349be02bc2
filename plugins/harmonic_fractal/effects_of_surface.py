"""What is in the structure function of a flank beside its fractal roughness: a wave, noise, a blunt instrument."""

from dataclasses import replace

import numpy as np
from scipy.special import gamma, hyp1f1

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.interface import interface_of
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.quantities import Drive
from truing import Float, column

FAR = 30.0  # from here on the series of the hypergeometric function in 1/x is exact to 1e-12
TERMS = 16  # of that series


def raised(results: Stiffness, by: Float) -> Stiffness:
    """Return the results with an amount, m², on the structure function."""
    return replace(results, structure_function=results.structure_function + by)


def waviness(drive: Drive, results: Stiffness, *, square: Float, wavelength: Float) -> Stiffness:
    """A wave lies across the flank: A² (1 - cos(2 pi lag/wavelength)), with ``square`` the square of its amplitude."""
    phase = 2.0 * np.pi * np.asarray(drive.lags) / column(wavelength)
    return raised(results, column(square) * (1.0 - np.cos(phase)))


def instrument_noise(drive: Drive, results: Stiffness, *, variance: Float) -> Stiffness:
    """Every height is read with an error of its own: twice its variance at any lag."""
    return raised(results, 2.0 * column(variance))


def lateral_filter(drive: Drive, results: Stiffness, *, width: Float) -> Stiffness:
    """The instrument averages over a spot: a Gaussian weight of standard deviation ``width`` along the line.

    For heights with S = c lag^a the filtered ones have c (E|lag + sqrt(2) w Z|^a - E|sqrt(2) w Z|^a), Z standard
    normal: both ends are averaged on their own. Waves and noise are left as they are.
    """
    rough = interface_of(drive)
    lags = np.asarray(drive.lags)
    dimension, spot = column(rough.dimension) - 1.0, column(width)
    plain = structure_function(lags, dimension, column(rough.roughness))
    return raised(results, plain * (kept_share(lags, spot, 4.0 - 2.0 * dimension) - 1.0))


def kept_share(lag: Float, width: Float, exponent: Float) -> Float:
    """Return the structure function of a filtered power law over that of the power law, 0 to 1; 1 without a width.

    With x = lag²/(4 w²): (2 w/lag)^a Gamma((1+a)/2)/sqrt(pi) (1F1(-a/2; 1/2; -x) - 1).
    Reference: absolute moments of the normal distribution, Abramowitz and Stegun 13.6, 22.5.
    """
    spot = np.maximum(width, 1e-6 * np.min(lag))
    x = np.square(lag / (2.0 * spot))
    scale = gamma((1.0 + exponent) / 2.0) / np.sqrt(np.pi)
    near = np.minimum(x, FAR)
    found = scale * near ** (-exponent / 2.0) * hyp1f1(-exponent / 2.0, 0.5, -near)
    whole = np.where(x > FAR, _far(np.maximum(x, FAR), exponent / 2.0), found)
    share: Float = np.where(np.asarray(width) > 0.0, whole - scale * x ** (-exponent / 2.0), 1.0)
    return share


def _far(x: Float, half: Float) -> Float:
    """Return Gamma(1/2 + p)/Gamma(1/2) x^-p 1F1(-p; 1/2; -x) for a large x: sum of (-p)_k (1/2 - p)_k / (k! x^k)."""
    term = total = np.ones(np.broadcast(x, half).shape)
    for k in range(TERMS):
        term = term * (k - half) * (k + 0.5 - half) / ((k + 1.0) * x)
        total = total + term
    return total
