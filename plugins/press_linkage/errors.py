"""How far does each of the 29 errors move the slider? The loop increments of the linkage in closed form.

They are exact first derivatives in any position, with any deviations already present; numbers or arrays (n,), SI. The
tests hold them equal to the loop equations solved numerically, and to differences of the exact kinematics.

Source of the method: the loop increments of the paper, a case of the direct linearisation of vector loops
(Chase, Magleby, Gao, ADCATS report 97-5).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import radians

import numpy as np

from press_linkage.kinematics import Half, Polar, Position, demands, solve
from press_linkage.quantities import Press, PressSide, Slider
from truing import Float, either, feasible

KINDS = tuple(field.name.removesuffix("_deviation") for field in fields(PressSide))
DRIVEN = (
    "crank_radius",
    "rod_length",
    "crank_pivot_radius",
    "crank_pivot_angle",
    "platform_half_width",
    "platform_joint_angle",
    "crank_angle",
)
PASSIVE = tuple(kind for kind in KINDS if kind not in DRIVEN)
POLAR_ANGLES = ("slider_joint_angle", "crank_pivot_angle", "platform_joint_angle", "ground_pivot_angle")
ARM = "platform_arm_deviation"


def source(kind: str, side: int) -> str:
    """Name of the input that carries this error: crank_radius on side 1 is crank_radius_deviation_1."""
    return f"{kind}_deviation_{side}"


SOURCES = (*(source(kind, side) for side in (1, 2) for kind in KINDS), ARM)


@dataclass(frozen=True)
class Derivatives:
    """Change of slider position (m) and tilt (rad) per metre or radian of each of the 29 sources, signed."""

    position: dict[str, Float]
    tilt: dict[str, Float]


def _cosine_between(first: Polar, second: Polar) -> Float:
    """Cosine of the angle from the second direction to the first."""
    return first.cosine * second.cosine + first.sine * second.sine


def _sine_between(first: Polar, second: Polar) -> Float:
    """Sine of the angle from the second direction to the first."""
    return first.sine * second.cosine - first.cosine * second.sine


def platform_sensitivities(half: Half) -> dict[str, Float]:
    """Loop I: change of the platform height that one side would set, per unit of each driven error of that side."""
    parts, rod = half.parts, half.rod
    return {
        "crank_radius": _cosine_between(parts.crank, rod) / rod.sine,
        "rod_length": 1.0 / rod.sine,
        "crank_pivot_radius": _cosine_between(parts.pivot, rod) / rod.sine,
        "crank_pivot_angle": -parts.pivot.length * _sine_between(parts.pivot, rod) / rod.sine,
        "platform_half_width": -_cosine_between(parts.platform, rod) / rod.sine,
        "platform_joint_angle": parts.platform.length * _sine_between(parts.platform, rod) / rod.sine,
        "crank_angle": -parts.crank.length * _sine_between(parts.crank, rod) / rod.sine,
    }


def face_sensitivities(half: Half) -> dict[str, Float]:
    """Loops II and III: change of one face height per unit of each passive error, and of the platform arm.

    ``platform_arm`` is also the transmission from platform to slider, d z_2 / d z_1.
    """
    drive, upper, lower = half.drive, half.upper, half.lower
    ground, slider = half.parts.ground, half.parts.slider
    divisor = lower.sine * _sine_between(upper, drive)
    along_upper = _sine_between(lower, drive) / divisor
    along_drive = _sine_between(upper, lower) / divisor
    cotangent = lower.cosine / lower.sine
    return {
        "knee_drive_length": along_drive,
        "upper_knee_length": along_upper,
        "lower_knee_length": 1.0 / lower.sine,
        "slider_half_width": -cotangent * slider.cosine - slider.sine,
        "slider_joint_angle": slider.length * (cotangent * slider.sine - slider.cosine),
        "ground_pivot_radius": along_upper * _cosine_between(ground, upper),
        "ground_pivot_angle": -along_upper * ground.length * _sine_between(ground, upper),
        "platform_arm": along_drive * drive.sine,
    }


def side_sensitivities(half: Half) -> dict[str, Float]:
    """The paper's xi of one side: change of its face height per unit of each error, as if the other side followed.

    Fifteen entries, the kinds of ``PressSide`` and ``platform_arm``; m/m for lengths, m/rad for angles, in the
    coordinates of this side (outward, downward). The slider joint angle has the sign of the face height,
    -l in nominal position; the paper writes the height of the joint with +l, which no variance can tell apart.
    """
    face = face_sensitivities(half)
    return face | {kind: face["platform_arm"] * value for kind, value in platform_sensitivities(half).items()}


def derivatives(press: Press, position: Position) -> Derivatives:
    """Exact derivatives of slider position and tilt by every source, in closed form, in this position."""
    halves = {1: position.side_1, 2: position.side_2}
    faces = {side: face_sensitivities(half) for side, half in halves.items()}
    distance = 2.0 * press.slider_half_width
    mean_drive = 0.5 * (faces[1]["platform_arm"] + faces[2]["platform_arm"])
    tilt_drive = (faces[1]["platform_arm"] - faces[2]["platform_arm"]) / distance
    by_position: dict[str, Float] = {ARM: mean_drive}
    by_tilt: dict[str, Float] = {ARM: tilt_drive}
    for side, half in halves.items():
        for kind, value in platform_sensitivities(half).items():
            share = 0.5 * frame_sign(kind, side) * value
            by_position[source(kind, side)] = mean_drive * share
            by_tilt[source(kind, side)] = tilt_drive * share
        for kind in PASSIVE:
            value = frame_sign(kind, side) * faces[side][kind]
            by_position[source(kind, side)] = 0.5 * value
            by_tilt[source(kind, side)] = (value if side == 1 else -value) / distance
    return Derivatives(
        position={name: by_position[name] for name in SOURCES}, tilt={name: by_tilt[name] for name in SOURCES}
    )


def frame_sign(kind: str, side: int) -> float:
    """-1 where a polar angle of side 2 runs against the mirrored coordinates its side is solved in."""
    return -1.0 if side == 2 and kind in POLAR_ANGLES else 1.0


def salience(sensitivity: Mapping[str, Float]) -> dict[str, Float]:
    """Share of each source in the sum of all sensitivities, signs dropped; the shares sum to 1.

    Metres and radians are added as in the paper, so the shares depend on the units chosen: a ranking for lengths
    measured in metres, nothing more. Shares of the variance do not have this weakness.
    """
    sizes = {name: np.abs(value) for name, value in sensitivity.items()}
    total = sum(sizes.values())
    return {name: size / total for name, size in sizes.items()}


# The calculation itself: from the flat inputs to the exact position of the slider, numbers or arrays alike

ROUNDING = 1e-15
TILT_LIMITS = {"complete": radians(0.0013), "printed": radians(0.001324)}


def permitted_tilt(press: Press) -> Float:
    """The tilt limit in force: the given one, otherwise that of the reading.

    Where a batch gives it for some rows only, the others take that of the reading.
    """
    return either(press.tilt_limit, TILT_LIMITS[press.reading])


def press_linkage(press: Press) -> Slider:
    """Height and tilt of the slider from the closed vector loops I to VI; every field is a number or an array (n,)."""
    position = solve(press)
    for holds, sentence in demands(press, position):
        feasible(holds, sentence)
    return Slider(
        face_height_1=position.side_1.face,
        face_height_2=position.side_2.face,
        slider_position=position.slider_position,
        slider_tilt=position.slider_tilt,
        permitted_tilt=permitted_tilt(press),
    )


def exact_derivatives(press: Press) -> Mapping[str, Mapping[str, Float]]:
    """Exact derivatives of position and tilt by all 29 sources, from the loop increments in closed form."""
    found = derivatives(press, solve(press))
    return {
        result: {name: without_rounding(value) for name, value in by_source.items()}
        for result, by_source in (("slider_position", found.position), ("slider_tilt", found.tilt))
    }


def without_rounding(value: Float) -> Float:
    """Sensitivities in m and rad, 0 where nothing but rounding is left (the crank angle at its dead centre)."""
    kept = np.where(np.abs(value) < ROUNDING, 0.0, value)
    return kept if kept.ndim else float(kept)
