"""Clearance of a rough pair of flanks: equation 7 in three readings, and what is left of it under load.

Equation 7 as printed grows with the load, for it is the amplitude of the largest contact. What a dynamic model needs
closes: from the height of the unloaded surfaces the approach is taken off, the integral of dF/K.
"""

import numpy as np

from harmonic_fractal import micro
from harmonic_fractal.contact import Contact, Rough, flanks_of, load_logarithm
from harmonic_fractal.flank import Flank
from harmonic_fractal.quantities import Drive
from truing import Float, either

RULE = np.polynomial.legendre.leggauss(12)  # of Gauss and Legendre on each of the panels
PANELS = 4


def read_radius(drive: Drive, largest_radius: Float) -> tuple[Float, Float]:
    """Return the radius r' that equation 7 gets, m, and by what its amplitude is multiplied."""
    if drive.clearance_rule == "patch":
        return drive.patch_length / 2.0, 1.0
    return largest_radius, 2.0 if drive.clearance_rule == "interference" else 1.0


def amplitude(radius: Float, contact: Contact, density: Float) -> Float:
    """Return equation 7, m: the amplitude of the wave that is as long as two radii."""
    waves = contact.roughness ** (contact.dimension - 2.0) * np.sqrt(np.log(density))
    return waves * (2.0 * radius) ** (3.0 - contact.dimension)


def patch_rms(rough: Rough, length: Float, density: Float) -> Float:
    """Return the rms height of a Weierstrass-Mandelbrot surface whose longest wave is the patch, m."""
    waves = 0.5 * np.log(density) / -np.expm1(2.0 * (rough.dimension - 3.0) * np.log(density))
    return length * (rough.roughness / length) ** (rough.dimension - 2.0) * np.sqrt(waves)


def patch_height(rough: Rough, length: Float, density: Float) -> Float:
    """Return the height from the lowest to the highest point of a patch of this length and half that width, m.

    Mean over random phases, with a standard deviation of an eighth; the multiple of the rms was fitted to patches of
    501 by 251 points, D from 2.1 to 2.9.
    """
    beside = rough.dimension - 2.5
    return (6.08 + 3.75 * beside + 2.2 * beside**2) * patch_rms(rough, length, density)


def heights(drive: Drive) -> tuple[Float, Float]:
    """Return S_z of both flanks, m: as stated, else of the measured surface, else of the fractal patch; 0 if smooth."""
    first, second = flanks_of(drive)
    return (
        either(drive.peak_height, _height(drive.surface, first, drive)),
        either(drive.mating_peak_height, _height(drive.mating_surface, second, drive)),
    )


def _height(flank: Flank | None, rough: Rough | None, drive: Drive) -> Float:
    if flank is not None:
        return flank.height
    if rough is None:
        return 0.0
    return np.where(np.isnan(rough.dimension), 0.0, patch_height(rough, drive.patch_length, drive.density))


def approach(load: Float, reference: Float, contact: Contact) -> Float:
    """Return how far a pair closes from a reference load to its load, m: the integral of dF/K.

    It is 0 below the reference, and infinite where all contacts are plastic there. Accuracy: about 1e-10 of the value.
    """
    law = contact.law
    high = np.asarray(load_logarithm(load, contact))
    low = np.minimum(load_logarithm(reference, contact), high)
    begins, ends = (np.log(np.expm1(law.decay * micro.size_of(np.maximum(item, 1e-12), law))) for item in (low, high))
    width = (ends - begins) / PANELS
    whole, panel = np.zeros(width.shape), np.arange(PANELS).reshape(-1, *(1,) * width.ndim)
    for node, weight in zip(*RULE, strict=True):
        grown = np.exp(begins + width * (panel + 0.5 * (node + 1.0)))
        size = np.log1p(grown) / law.decay
        rise = np.exp(micro.load_logarithm(size, law)) * micro.load_slope(size, law)
        step = grown / ((1.0 + grown) * law.decay)
        for part in 0.5 * weight * width * rise * step / micro.stiffness_share(size, law):
            whole = whole + part
    value = whole * contact.plastic_limit / contact.stiffness_scale
    return np.where((low <= 0.0) & (high > low), np.inf, value)
