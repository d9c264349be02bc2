"""What must hold for the press linkage to close: loop by loop, side by side, with the inequality that is violated.

Every demand is a condition (one truth value, or one per sample) with the sentence for the engineer. A condition that
meets NaN does not hold.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from press_linkage.kinematics import Float, Geometry, Half, Parts, Polar, Position, solve

SINGULAR = 1e-6  # sine of an angle between two links below which the position is undetermined
NEARLY_SINGULAR = 0.05  # below it the sensitivities exceed 20: worth a warning


class Demand(NamedTuple):
    """What must hold: a name, where it holds, and the sentence for the engineer where it does not."""

    name: str
    holds: "bool | NDArray[np.bool_]"
    sentence: str


def knee_sine(half: Half) -> Float:
    """Sine of the angle between knee drive and upper link, theta_19 - theta_17; NaN where loop II is open."""
    return np.sqrt(half.knee_fold) * half.knee_span / (half.parts.drive * half.parts.upper)


def smallest_sine(position: Position) -> Float:
    """How far the press is from a singular position: the least sine that a height is divided by, both sides.

    Zero is singular; below NEARLY_SINGULAR an error of a link reaches the slider more than twentyfold.
    """
    least: Float = np.inf
    with np.errstate(invalid="ignore"):
        for half in (position.side_1, position.side_2):
            least = np.minimum(least, half.rod_drop / half.parts.rod)
            least = np.minimum(least, half.lower_drop / half.parts.lower)
            least = np.minimum(least, knee_sine(half))
    return least


def nominal_demands(geometry: Geometry) -> Iterator[Demand]:
    """What the nominal sizes must satisfy for a bottom dead centre on this branch."""
    yield Demand(
        "branch",
        geometry.crank_pivot_radius > geometry.platform_half_width,
        "the crank pivots must lie farther out than the rod joints of the platform: "
        "crank_pivot_radius > platform_half_width",
    )
    yield Demand(
        "stretched",
        geometry.crank_pivot_radius - geometry.platform_half_width < geometry.crank_radius + geometry.rod_length,
        "loop I has no bottom dead centre: crank and rod in line do not reach the platform; it needs "
        "crank_pivot_radius - platform_half_width < crank_radius + rod_length",
    )


def rotation_demand(geometry: Geometry) -> Demand:
    """What a full turn of the crank needs, and with it the upper dead centre and the stroke."""
    offset = np.abs(geometry.crank_pivot_radius - geometry.platform_half_width)
    return Demand(
        "full rotation",
        offset + geometry.crank_radius < geometry.rod_length,
        "loop I does not close over a full turn of the crank: it needs "
        "crank_pivot_radius - platform_half_width + crank_radius < rod_length",
    )


def demands(geometry: Geometry, position: Position) -> Iterator[Demand]:
    """What must hold in this position with these deviations: nominal sizes, then loop by loop, side by side.

    They come in the order of the chain, so the first one that fails names the cause and not a consequence.
    """
    yield from nominal_demands(geometry)
    with np.errstate(invalid="ignore"):
        for side, half in ((1, position.side_1), (2, position.side_2)):
            yield _sizes(half, side)
        for side, half in ((1, position.side_1), (2, position.side_2)):
            yield from _rod_demands(half, side)
        yield Demand(
            "platform arm",
            position.side_1.arm_end > position.platform_height,
            "the platform arm with its deviation must be longer than zero",
        )
        for side, half in ((1, position.side_1), (2, position.side_2)):
            yield from _knee_demands(half, side)
            yield from _slider_demands(half, side)


def _sizes(half: Half, side: int) -> Demand:
    """Every length of one side is positive, its deviation included."""
    parts = half.parts
    holds = parts.rod > 0.0
    for length in (parts.drive, parts.upper, parts.lower, *(polar.length for polar in _polars(parts))):
        holds = holds & (length > 0.0)
    return Demand(f"sizes {side}", holds, f"side {side}: every length with its deviation must be greater than zero")


def _polars(parts: Parts) -> tuple[Polar, ...]:
    """The parts whose direction is known before the loops are solved."""
    return parts.pivot, parts.crank, parts.platform, parts.ground, parts.slider


def _rod_demands(half: Half, side: int) -> Iterator[Demand]:
    """Loop I (VI on side 2): the rod reaches the platform, and not in a horizontal position."""
    loop = "I" if side == 1 else "VI"
    yield Demand(
        f"loop {loop}",
        half.rod_drop >= 0.0,
        f"loop {loop}, side {side} does not close: the rod cannot reach the platform, it needs "
        "|e cos(beta_1) - y_B| < k_R (horizontal distance of its ends below rod_length)",
    )
    yield Demand(
        f"singular {loop}",
        half.rod_drop >= SINGULAR * half.parts.rod,
        f"loop {loop}, side {side} is singular: the rod is horizontal (|sin(theta_2{side})| < 1e-6), "
        "the platform height is undetermined",
    )


def _knee_demands(half: Half, side: int) -> Iterator[Demand]:
    """Loop II (V on side 2): knee drive and upper link meet, and not in line."""
    loop = "II" if side == 1 else "V"
    yield Demand(
        f"loop {loop}",
        half.knee_fold >= 0.0,
        f"loop {loop}, side {side} does not close: the knee drive is open, it needs "
        "|l_m - l_g| < |M - B_5| < l_m + l_g "
        "(distance from platform arm to ground pivot between difference and sum of "
        "upper_knee_length and knee_drive_length)",
    )
    links = half.parts.drive * half.parts.upper
    yield Demand(
        f"singular {loop}",
        half.knee_fold * (half.knee_span * half.knee_span) >= (SINGULAR * SINGULAR) * (links * links),
        f"loop {loop}, side {side} is singular: platform arm, knee and ground pivot lie in line "
        f"(|sin(theta_{side}9 - theta_{side}7)| < 1e-6)",
    )


def _slider_demands(half: Half, side: int) -> Iterator[Demand]:
    """Loop III (IV on side 2): the lower link reaches the slider, and not in a horizontal position."""
    loop = "III" if side == 1 else "IV"
    yield Demand(
        f"loop {loop}",
        half.lower_drop >= 0.0,
        f"loop {loop}, side {side} does not close: the lower link cannot reach the slider, it needs "
        "|l - y_G| < l_h (horizontal distance of its ends below lower_knee_length)",
    )
    yield Demand(
        f"singular {loop}",
        half.lower_drop >= SINGULAR * half.parts.lower,
        f"loop {loop}, side {side} is singular: the lower link is horizontal (|sin(theta_{side}8)| < 1e-6)",
    )


def cycle_demands(geometry: Geometry, samples: int = 721) -> Iterator[Demand]:
    """What a full turn of the crank demands of one nominal mechanism (plain numbers): every loop, at every angle.

    The loops are tried at *samples* equally spaced crank angles; none of the roots may vanish on the way, so the
    mechanism stays on its branch.
    """
    yield rotation_demand(geometry)
    turn = solve(geometry, np.linspace(-np.pi, np.pi, samples))
    for name, holds, sentence in demands(geometry, turn):
        yield Demand(name, bool(np.all(holds)), f"over the full turn: {sentence}")
