"""What the tests of the press linkage share: two mechanisms, nine crank angles, and ways to be off."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from press_linkage import errors, kinematics
from press_linkage.errors import KINDS, POLAR_ANGLES
from press_linkage.kinematics import Position
from press_linkage.quantities import Press, PressSide
from truing import Float

PAPER = Press()
SIZES = {
    "crank_radius": 0.25, "rod_length": 1.1, "platform_arm": 0.45, "knee_drive_length": 0.95, "upper_knee_length": 1.5,
    "lower_knee_length": 1.35, "slider_half_width": 1.25, "crank_pivot_radius": 0.8, "platform_half_width": 0.35,
    "ground_pivot_radius": 1.2, "ground_pivot_angle": 0.3,
}  # fmt: skip
OTHER = Press(**SIZES)
MECHANISMS = pytest.mark.parametrize("geometry", [PAPER, OTHER], ids=["paper", "other"])
AROUND = np.radians([-140.3, -90.0, -40.0, -10.0, 0.0, 10.0, 40.0, 90.0, 150.0])


def off_by(**kinds: Float) -> PressSide:
    """One side that is off by these deviations, named without ``_deviation``."""
    return PressSide(**{f"{kind}_deviation": value for kind, value in kinds.items()})


def solve(
    press: Press,
    angle: Float,
    *,
    side_1: PressSide | None = None,
    side_2: PressSide | None = None,
    platform_arm: Float = 0.0,
) -> Position:
    """The exact position of a mechanism with these deviations."""
    off = replace(
        press, side_1=side_1 or PressSide(), side_2=side_2 or PressSide(), platform_arm_deviation=platform_arm
    )
    return kinematics.solve(off, angle)


def scattered(size: float, seed: int, shape: tuple[int, ...] = ()) -> PressSide:
    """One side with every error present."""
    rng = np.random.default_rng(seed)
    return off_by(**{kind: size * rng.standard_normal(shape) for kind in KINDS})


def sensitivities(geometry: Press, angle: float | NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """The paper's xi of side 1, as arrays."""
    found = errors.side_sensitivities(solve(geometry, angle).side_1)
    return {kind: np.asarray(value) for kind, value in found.items()}


def mirrored(off: PressSide) -> PressSide:
    """The same errors on the other side: polar angles of the frame change their sign."""
    return replace(off, **{f"{kind}_deviation": -getattr(off, f"{kind}_deviation") for kind in POLAR_ANGLES})
