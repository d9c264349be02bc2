"""What scatters: the estimate of D and G from a measured flank, the materials, and the compliance around the mesh."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.flank import Flank
from harmonic_fractal.interface import Rough, flanks_of, together
from harmonic_fractal.quantities import Drive
from truing import Tolerance, drawn, lognormal, normal

Pairs = NDArray[np.float64]
FLANKS = (
    "surface", "mating_surface", "fractal_dimension", "fractal_roughness", "mating_dimension", "mating_roughness",
    "convention", "density", "sampling", "longest_lag",
)  # fmt: skip
"""The inputs that make up the interface of both flanks."""


def flank_samples(rng: np.random.Generator, rows: int, **flanks: Any) -> Mapping[str, Any]:
    """Draw pairs of D and ln G of both flanks together, each from the bootstrap pairs of its measured lines.

    Returns deviations (rows,) from the estimate by name of their input; nothing where no flank was measured. Errors of
    D and ln G hang together closely, so they are never drawn apart. The mean of the pairs counts as the estimate.
    """
    pairs = [_centred(flanks["surface"]), _centred(flanks["mating_surface"])]
    if not any(len(found) for found in pairs):
        return {}
    drive = replace(Drive(), **flanks)
    first, second = flanks_of(drive)
    sampled = _shifted(first, _some(pairs[0], rng, rows)), _shifted(second, _some(pairs[1], rng, rows))
    middle, both = together(first, second, drive), together(sampled[0] or first, sampled[1], drive)
    return {
        "dimension_deviation": both.dimension - middle.dimension,
        "roughness_deviation": np.log(both.roughness / middle.roughness),
    }


def _centred(flank: "Flank | None") -> Pairs:
    """Return the pairs (B, 2) of a flank less their mean."""
    pairs = np.empty((0, 2)) if flank is None else flank.resampled
    return pairs - pairs.mean(axis=0) if len(pairs) else pairs


def _some(pairs: Pairs, rng: np.random.Generator, rows: int) -> Pairs:
    """Draw so many pairs; none if there are none."""
    return pairs[rng.integers(len(pairs), size=rows)] if len(pairs) else pairs


def _shifted(rough: Rough | None, pairs: Pairs) -> Rough | None:
    """Return a flank with these deviations of D and ln G (rows, 2); as it is without any."""
    if rough is None or not len(pairs):
        return rough
    return Rough(dimension=rough.dimension + pairs[:, 0], roughness=rough.roughness * np.exp(pairs[:, 1]))


def share_of_compliance(rng: np.random.Generator, rows: int, *, drive_compliance: float) -> Mapping[str, Any]:
    """Draw a hundredth of the compliance around the mesh; nothing where that is 0."""
    if not drive_compliance:
        return {}
    return {"drive_compliance": 0.01 * drive_compliance * rng.standard_normal(rows)}


TOLERANCES = [
    Tolerance(
        "estimate", drawn(flank_samples, of=FLANKS), on=["dimension_deviation", "roughness_deviation"],
        why="D and ln G come from a finite number of lines: pairs from resampled blocks of them, where a flank was "
        "measured", source="bootstrap of the measured lines",
    ),
    Tolerance("hardness", lognormal(sd="6 %"), why="batch scatter on the certificate", source="typical"),
    Tolerance(
        "youngs_modulus", normal(sd="1 %"), on=["youngs_modulus_flexspline", "youngs_modulus_circular"],
        why="from melt to melt of one steel", source="typical",
    ),
    Tolerance(
        "drive_compliance", drawn(share_of_compliance, of=["drive_compliance"]),
        why="a standard deviation of 1 % of what is stated", source="typical of a bench",
    ),
]  # fmt: skip
