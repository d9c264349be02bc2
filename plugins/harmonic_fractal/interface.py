"""Both flanks as one rough surface against a smooth one: dimension and roughness, from surfaces or as stated."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.estimate import Estimate
from harmonic_fractal.fitting import straight_fit
from harmonic_fractal.flank import Flank
from harmonic_fractal.power_law import converted, log_roughness_of, structure_function
from harmonic_fractal.quantities import Drive
from truing import Float

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
    """Return one rough surface for both flanks, without any deviation; the second one may be smooth."""
    return first if second is None else _sum_or_first(first, second, drive)


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


def _sum_or_first(first: Rough, second: Rough, drive: Drive) -> Rough:
    """Return the sum of both, and in rows where the second one is smooth the first."""
    both, smooth = _sum(first, second, drive), np.isnan(second.dimension)
    return Rough(
        dimension=np.where(smooth, first.dimension, both.dimension),
        roughness=np.where(smooth, first.roughness, both.roughness),
    )


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
