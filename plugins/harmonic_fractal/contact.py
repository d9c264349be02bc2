"""A pair of rough flanks: both as one surface, what its contacts carry, how stiff they are, and their clearance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import micro
from harmonic_fractal.estimate import Estimate, straight_fit
from harmonic_fractal.flank import Flank
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import converted, log_roughness_of, structure_function
from truing import Float, either

# Both flanks as one rough surface against a smooth one: dimension and roughness, from surfaces or as stated

POINTS = 16  # lags, evenly in their logarithm, over which the sum of two power laws is fitted by one


@dataclass(frozen=True, kw_only=True)
class Rough:
    """A rough surface: dimension of the surface D, roughness G in m in the areal convention."""

    dimension: Float
    roughness: Float


def flanks_of(drive: Drive) -> tuple[Rough, Rough | None]:
    """Return both flanks, each from its surface where that is accepted, else as stated; None where one is smooth."""
    first = _measured(drive.surface) or _stated(drive, drive.fractal_dimension, drive.fractal_roughness)
    second = _measured(drive.mating_surface)
    if second is None and not (np.isnan(drive.mating_dimension).all() or np.isnan(drive.mating_roughness).all()):
        second = _stated(drive, drive.mating_dimension, drive.mating_roughness)
    return first, second


def is_half_stated(drive: Drive) -> "bool | NDArray[np.bool_]":
    """Return where one of dimension and roughness of the mating flank is stated without the other."""
    unknown = drive.mating_surface is None or drive.mating_surface.used is None
    half: NDArray[np.bool_] = np.isnan(drive.mating_dimension) != np.isnan(drive.mating_roughness)
    return unknown & half


def interface_of(drive: Drive) -> Rough:
    """Return one rough surface for both: independent flanks add their structure functions.

    Two flanks are fitted by one power law over the range that both share (``range_of``); with equal dimensions that is
    exact. The deviations of both inputs are added at the end.
    """
    both = together(*flanks_of(drive), drive)
    return Rough(
        dimension=both.dimension + drive.dimension_deviation,
        roughness=both.roughness * np.exp(drive.roughness_deviation),
    )


def together(first: Rough, second: Rough | None, drive: Drive) -> Rough:
    """Return one rough surface for both flanks, without any deviation; the second may be smooth, in some rows."""
    if second is None:
        return first
    both, smooth = _sum(first, second, drive), np.isnan(second.dimension)
    return Rough(
        dimension=np.where(smooth, first.dimension, both.dimension),
        roughness=np.where(smooth, first.roughness, both.roughness),
    )


def is_accepted(drive: Drive) -> float:
    """Return 1, or 0 where a measured flank has no self-affine range."""
    measured = (flank for flank in (drive.surface, drive.mating_surface) if flank is not None)
    return float(all(flank.used is not None for flank in measured))


def spacing_of(drive: Drive) -> Float:
    """Return the sampling interval behind D and G, m: the coarser one of what was measured, else as stated."""
    spacings = [item.spacing for item in _used(drive)]
    return max(spacings) if spacings else drive.sampling


def range_of(drive: Drive) -> tuple[Float, Float]:
    """Return the lags between which two flanks are added, m: those that both estimates share, else as stated."""
    ranges = [item.range for item in _used(drive) if np.isfinite(item.range).all()]
    if not ranges:
        return drive.sampling, drive.longest_lag
    return max(low for low, _ in ranges), min(high for _, high in ranges)


def _used(drive: Drive) -> list[Estimate]:
    flanks = (drive.surface, drive.mating_surface)
    return [flank.used for flank in flanks if flank is not None and flank.used is not None]


def _measured(flank: Flank | None) -> Rough | None:
    found = None if flank is None else flank.used
    return None if found is None else Rough(dimension=found.dimension + 1.0, roughness=found.roughness)


def _stated(drive: Drive, dimension: Float, roughness: Float) -> Rough:
    areal = converted(roughness, dimension - 1.0, drive.density, source=drive.convention, target="areal")
    return Rough(dimension=dimension, roughness=areal)


def _sum(first: Rough, second: Rough, drive: Drive) -> Rough:
    """Return the power law through the sum of two; it is fitted over the place within the range of lags, 0 to 1."""
    place = np.linspace(0.0, 1.0, POINTS)
    low, high = (np.log(np.asarray(end)) for end in range_of(drive))
    lags = np.exp(low[..., None] + (high - low)[..., None] * place)
    heights = sum(structure_function(lags, np.asarray(one.dimension)[..., None] - 1.0,
                                     np.asarray(one.roughness)[..., None]) for one in (first, second))  # fmt: skip
    law = straight_fit(np.exp(place), np.asarray(heights))
    slope = law.slope / (high - low)
    dimension = 2.0 - slope / 2.0
    return Rough(dimension=dimension + 1.0, roughness=np.exp(log_roughness_of(law.intercept - slope * low, dimension)))


# One pair of rough flanks: what its contacts carry and how stiff they are, in closed form, and the way to close
#
# A contact of truncated area a' has the interference of a Weierstrass-Mandelbrot surface, a multiple of a'^((3-D)/2),
# and the tip radius that belongs to it; those smaller than the critical area are plastic. Sources: Yan and Komvopoulos
# 1998; Wang and Komvopoulos 1994 for the number of contacts; Jiang, Zheng and Zhu 2010 for the stiffness.


@dataclass(frozen=True, kw_only=True)
class Contact:
    """The rough surface, its materials, and what follows from them before there is a load; SI."""

    law: micro.ContactLaw
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
        law=micro.ContactLaw(dimension, pressure / drive.hardness),
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


# Clearance of a rough pair of flanks: equation 7 in three readings, and what is left of it under load
#
# Equation 7 as printed grows with the load, for it is the amplitude of the largest contact. What a dynamic model needs
# closes: from the height of the unloaded surfaces the approach is taken off, the integral of dF/K.

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
