"""One pair of rough flanks: what its contacts carry and how stiff they are, in closed form, and the way to close.

A contact of truncated area a' has the interference of a Weierstrass-Mandelbrot surface, a multiple of a'^((3-D)/2), and
the tip radius that belongs to it; those smaller than the critical area are plastic. Sources: Yan and Komvopoulos 1998;
Wang and Komvopoulos 1994 for the number of contacts; Jiang, Zheng and Zhu 2010 for the stiffness.
"""

from dataclasses import dataclass

import numpy as np

from harmonic_fractal import micro
from harmonic_fractal.interface import Rough
from harmonic_fractal.quantities import Drive
from truing import Float


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The rough surface, its materials, and what follows from them before there is a load; SI."""

    law: micro.Law
    roughness: Float
    modulus: Float
    hardness: Float
    domain_factor: Float
    critical_area: Float
    plastic_limit: Float
    stiffness_scale: Float
    tip_factor: Float

    @property
    def dimension(self) -> Float:
        """D of the surface."""
        return self.law.dimension


@dataclass(frozen=True, kw_only=True)
class Pressed:
    """One pair under its load: areas in m^2, stiffness in N/m; ``size`` is u = ln(a_L/a_c)."""

    size: Float
    largest_area: Float
    contact_area: Float
    real_area: Float
    stiffness: Float
    load_exponent: Float


def equivalent_modulus(drive: Drive) -> Float:
    """Return E of both bodies together, Pa, as Hertz has it."""
    first, second = drive.flexspline, drive.circular
    both = (1.0 - first.poisson_ratio**2) / first.youngs_modulus
    both = both + (1.0 - second.poisson_ratio**2) / second.youngs_modulus
    return drive.modulus_factor / both


def critical_pressure(drive: Drive) -> Float:
    """Return elastic load over truncated area, Pa, at which a contact turns elastic.

    By ``hardness`` its elastic load equals hardness times area; by ``yield_onset`` it begins to yield below its
    surface (Chang, Etsion and Bogy 1987), with Poisson's ratio of the circular spline, which is the softer body.
    """
    if drive.critical_rule == "hardness":
        return drive.hardness
    return (0.454 + 0.41 * drive.circular.poisson_ratio) / 3.0 * drive.hardness


def tip_factor(drive: Drive, dimension: Float) -> Float:
    """Return what the stiffness is multiplied by: 1 for a tip radius that stays, more for one that follows the area."""
    if drive.tip_rule == "fixed":
        return 1.0 + 0.0 * dimension
    return 2.0 / 3.0 * (4.0 - dimension) / (3.0 - dimension)


def contact_of(drive: Drive, rough: Rough) -> Contact:
    """Return what follows from roughness and materials."""
    dimension, modulus, pressure = rough.dimension, equivalent_modulus(drive), critical_pressure(drive)
    psi = micro.domain_factor(dimension)
    many = (dimension - 1.0) * psi ** ((3.0 - dimension) / 2.0)
    waves = 2.0 ** (11.0 - 2.0 * dimension) / (9.0 * np.pi ** (4.0 - dimension)) * np.log(drive.density)
    critical = rough.roughness**2 * (waves * (modulus / pressure) ** 2) ** (1.0 / (dimension - 2.0))
    tip = tip_factor(drive, dimension)
    return Contact(
        law=micro.Law(dimension, pressure / drive.hardness),
        roughness=rough.roughness,
        modulus=modulus,
        hardness=drive.hardness,
        domain_factor=psi,
        critical_area=critical,
        plastic_limit=many * drive.hardness * critical / (3.0 - dimension),
        stiffness_scale=tip * modulus * np.sqrt(2.0 / np.pi) * many / (dimension - 2.0) * np.sqrt(critical),
        tip_factor=tip,
    )


def load_logarithm(load: Float, contact: Contact) -> Float:
    """Return ln(F/F_c) of a load of 0 or more, N."""
    return np.log(np.maximum(load, 1e-300) / contact.plastic_limit)


def pressed(load: Float, contact: Contact) -> Pressed:
    """Return areas and stiffness of one pair under a normal load above 0, N."""
    size = micro.size_of(load_logarithm(load, contact), contact.law)
    ratio, real = micro.area_shares(size, contact.law)
    many = (contact.dimension - 1.0) / (3.0 - contact.dimension)
    truncated = many * contact.domain_factor ** ((3.0 - contact.dimension) / 2.0) * contact.critical_area * ratio
    return Pressed(
        size=size,
        largest_area=contact.critical_area * ratio,
        contact_area=truncated,
        real_area=truncated * real,
        stiffness=contact.stiffness_scale * micro.stiffness_share(size, contact.law),
        load_exponent=micro.load_exponent(size, contact.law),
    )
