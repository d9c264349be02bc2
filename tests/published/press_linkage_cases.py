"""What the tests of the press linkage share: two mechanisms, nine crank angles, and ways to be off."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from press_linkage import errors
from press_linkage.errors import ARM, KINDS, POLAR_ANGLES
from press_linkage.kinematics import Deviations, Geometry, Position, solve

PAPER = Geometry()
OTHER = Geometry(
    crank_radius=0.25,
    rod_length=1.1,
    platform_arm=0.45,
    knee_drive_length=0.95,
    upper_knee_length=1.5,
    lower_knee_length=1.35,
    slider_half_width=1.25,
    crank_pivot_radius=0.8,
    platform_half_width=0.35,
    ground_pivot_radius=1.2,
    ground_pivot_angle=0.3,
)
MECHANISMS = pytest.mark.parametrize("geometry", [PAPER, OTHER], ids=["paper", "other"])
AROUND = np.radians([-140.3, -90.0, -40.0, -10.0, 0.0, 10.0, 40.0, 90.0, 150.0])


def scattered(size: float, seed: int, shape: tuple[int, ...] = ()) -> Deviations:
    """One side with every error present."""
    rng = np.random.default_rng(seed)
    return Deviations(**{kind: size * rng.standard_normal(shape) for kind in KINDS})


def moved(geometry: Geometry, angle: NDArray[np.float64], name: str, by: float) -> Position:
    """The exact position with one of the 29 sources off by a given amount."""
    if name == ARM:
        return solve(geometry, angle, platform_arm=by)
    kind, side = name.rsplit("_deviation_", 1)
    return solve(geometry, angle, **{f"side_{side}": Deviations(**{kind: by})})


def sensitivities(geometry: Geometry, angle: float | NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """The paper's xi of side 1, as arrays."""
    found = errors.side_sensitivities(solve(geometry, angle).side_1)
    return {kind: np.asarray(value) for kind, value in found.items()}


def mirrored(off: Deviations) -> Deviations:
    """The same errors on the other side: polar angles of the frame change their sign."""
    return replace(off, **{kind: -getattr(off, kind) for kind in POLAR_ANGLES})
