"""What is in the structure function of a flank beside its fractal roughness: a wave, noise, a blunt instrument."""

from dataclasses import replace

import numpy as np

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.quantities import Drive
from truing import Float, column


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


def lateral_filter(drive: Drive, *, width: Float) -> Drive:
    """The instrument averages over a spot along the line: the finest roughness is lost, waves and noise are not.

    A Gaussian weight of standard deviation ``width``; two spots in a row are one whose variance is their sum.
    """
    return replace(drive, spot_width=np.hypot(drive.spot_width, width))
