"""A press that gives way under load, by the least potential energy of its exact geometry. Nothing of the plugin.

Two cranks, two knees, platform and slider have 14 coordinates, and stay where links, guides, weights and forces
have the least energy together. Lengths and angles are exact, so nothing is linear but the springs. The gradient is by
complex steps, the curvature by differences of it; the energy is differenced again in the tests. SI; y + jz with z down,
side 2 with its own directions; a mass hangs at its centre of gravity. The press stands.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import acos
from typing import Any

import numpy as np

from hidden_effects.moving_press import joints
from hidden_effects.rows import Array
from published.press_by_hand import PAPER

GRAVITY, TINY, STEP = 9.80665, 1e-30, 1e-7
FILMS = (1.0, 0.1, 0.01, 1e-3, 1e-4)
"""Share of its stiffness that a spring has within its play: the last is that of the press, the others lead to it."""
SIDES = ((0, 1.0), (1, -1.0))


@dataclass(frozen=True, kw_only=True)
class LoadedMachine:
    """Sizes, stiffness, play, heat and masses of a press, and the place of the force on its slider."""

    press: Mapping[str, float] = field(default_factory=lambda: PAPER)
    offset: float = 0.1
    bar: float = 206e9 * 0.02
    joint: float = 10e9
    pivot: float = 5e9
    drive: float = 20e6
    ground: tuple[float, float] = (2e9, 5e9)
    columns: tuple[float, float] = (8e9, 2.0)
    play: float = 15e-6
    guide: float = 1e9
    clearance: float = 50e-6
    shoes: tuple[float, float] = (-0.4, 0.8)
    lean: float = 0.0
    platform_guide: float = 1e9
    platform_clearance: float = 50e-6
    platform_span: float = 0.6
    warm: float = 0.0
    frame: float = 0.0
    bolster: float = 4.3
    longer: Mapping[str, float] = field(default_factory=dict)
    mass: Mapping[str, float] = field(default_factory=lambda: {
        "crank": 56.5, "rod": 205.0, "drive": 136.0, "upper": 267.0, "lower": 251.0,
    })  # fmt: skip
    platform: float = 2000.0
    slider: float = 20000.0
    lift: float = 196e3


def gap(longer: Any, play: float, film: float) -> Any:
    """Twice the energy of a spring of stiffness 1 with a gap, for complex extensions too."""
    beyond = np.where(longer.real > play, longer - play, np.where(longer.real < -play, longer + play, 0.0))
    return film * longer**2 + (1.0 - film) * beyond**2


def energy(machine: LoadedMachine, angle: float, moved: Any, force: float, film: float = FILMS[-1]) -> Any:
    """Potential energy with these coordinates (..., 14) off the nominal position: pins, knees, platform, slider."""
    p, k = machine.press, {name: value.copy() for name, value in joints(np.array([angle]), machine.press).items()}
    at = {name: value[:, 0] for name, value in k.items()}
    grown, frame = 1.0 + machine.warm, 1.0 + machine.frame
    bent = machine.bar
    two = 2.0 / machine.joint
    total = 0.0
    platform_z, slider_z = at["E"][1] + moved[..., 9], at["H"][1] + moved[..., 12]
    sway, gamma, shift, theta = moved[..., 8], moved[..., 10], moved[..., 11], moved[..., 13]

    def body(y: Any, z: Any, angle_: Any, dy: float, dz: float) -> Any:
        return y + dy * np.cos(angle_) - dz * np.sin(angle_) + 1j * 0, z + dy * np.sin(angle_) + dz * np.cos(angle_)

    arm = body(sway, platform_z, gamma, 0.0, p["platform_arm"] * grown + machine.longer.get("arm", 0.0))
    theta_11 = angle + acos(
        (p["platform_half_width"] - p["crank_pivot_radius"]) / (p["crank_radius"] + p["rod_length"])
    )
    for side, sign in SIDES:
        own = {
            name: machine.longer.get(f"{name}_{side + 1}", 0.0) for name in ("rod", "drive", "upper", "lower", "crank")
        }
        pin = sign * at["B"][0] + moved[..., 2 * side], at["B"][1] + moved[..., 2 * side + 1]
        knee = sign * at["G"][0] + moved[..., 4 + 2 * side], at["G"][1] + moved[..., 5 + 2 * side]
        end = body(sway, platform_z, gamma, sign * p["platform_half_width"] * grown, 0.0)
        joint = body(shift, slider_z, theta, sign * p["slider_half_width"] * grown, 0.0)
        ground = sign * at["M"][0] * frame, at["M"][1] * frame
        pivot = sign * at["A"][0] * frame, 0.0
        line = np.array([at["G"][0] - at["M"][0], at["G"][1] - at["M"][1]]) / p["upper_knee_length"]
        yields = line[0] ** 2 / machine.ground[0] + line[1] ** 2 / machine.ground[1]
        for name, first, last, size, extra in (
            ("rod", pin, end, "rod_length", 0.0), ("drive", arm, knee, "knee_drive_length", 0.0),
            ("upper", ground, knee, "upper_knee_length", yields), ("lower", knee, joint, "lower_knee_length", 0.0),
        ):  # fmt: skip
            length = np.sqrt((last[0] - first[0]) ** 2 + (last[1] - first[1]) ** 2)
            stiffness = 1.0 / (p[size] / bent + two + extra)
            total = total + 0.5 * stiffness * gap(length - p[size] * grown - own[name], 2.0 * machine.play, film)
            total = total - machine.mass[name] * GRAVITY * 0.5 * (first[1] + last[1])
        out = sign * (pin[0] - pivot[0]), pin[1] - pivot[1]
        radius = np.sqrt(out[0] ** 2 + out[1] ** 2)
        turned = (np.cos(theta_11) * out[1] - np.sin(theta_11) * out[0]) / radius  # sine of the angle behind or ahead
        along = 1.0 / (p["crank_radius"] / bent + 1.0 / machine.pivot)
        across = 1.0 / (p["crank_radius"] ** 2 / machine.drive + 1.0 / machine.pivot)
        total = total + 0.5 * along * (radius - p["crank_radius"] * grown - own["crank"]) ** 2
        total = total + 0.5 * across * (p["crank_radius"] * np.arcsin(turned)) ** 2
        total = total - machine.mass["crank"] * GRAVITY * 0.5 * pin[1]
    for depth in (-0.5 * machine.platform_span, 0.5 * machine.platform_span):
        beside = sway - depth * np.sin(gamma)
        total = total + 0.5 * machine.platform_guide * gap(beside, machine.platform_clearance, film)
    for depth in machine.shoes:
        beside = shift - depth * np.sin(theta) - machine.lean * (at["H"][1] + depth - machine.bolster)
        total = total + 0.5 * machine.guide * gap(beside, machine.clearance, film)
    total = total - machine.platform * GRAVITY * platform_z - (machine.slider * GRAVITY - machine.lift) * slider_z
    return total + force * (slider_z + machine.offset * np.sin(theta))


def slope(machine: LoadedMachine, angle: float, moved: Array, force: float, film: float = FILMS[-1]) -> Array:
    """Derivative of the energy (..., 14) by complex steps."""
    steps = moved[..., np.newaxis, :] + 1j * TINY * np.eye(14)
    return np.asarray(np.imag(energy(machine, angle, steps, force, film)) / TINY)


def settled(machine: LoadedMachine, angle: float, force: float) -> Array:
    """Where the press stays: Newton's method on the energy, of its steps that with least energy."""
    moved, each = np.zeros(14), STEP * np.eye(14)
    for film in FILMS:
        for _ in range(60):
            around = np.concatenate([moved[np.newaxis], moved + each, moved - each])
            slopes = slope(machine, angle, around, force, film)
            here, curvature = slopes[0], (slopes[1:15] - slopes[15:]) / (2 * STEP)
            step = np.linalg.solve(0.5 * (curvature + curvature.T), -here)
            tried = moved + (0.5 ** np.arange(20))[:, np.newaxis] * step
            moved = tried[int(np.argmin(np.real(energy(machine, angle, tried + 0j, force, film))))]
            if np.max(np.abs(step)) < (1e-10 if film == FILMS[-1] else 1e-7):
                break
    return moved


def ground_rise(machine: LoadedMachine, angle: float, moved: Array, side: int) -> float:
    """How far the upper link of side 0 or 1 pushes the frame at M up."""
    p, at = machine.press, {name: value[:, 0] for name, value in joints(np.array([angle]), machine.press).items()}
    sign, size = SIDES[side][1], p["upper_knee_length"]
    knee = np.array([sign * at["G"][0] + moved[4 + 2 * side], at["G"][1] + moved[5 + 2 * side]])
    ground = (1.0 + machine.frame) * np.array([sign * at["M"][0], at["M"][1]])
    line = np.array([at["G"][0] - at["M"][0], at["G"][1] - at["M"][1]]) / size
    soft = size / machine.bar + 2.0 / machine.joint + line**2 @ (1.0 / np.array(machine.ground))
    longer = np.hypot(*(knee - ground)) - size * (1.0 + machine.warm) - machine.longer.get(f"upper_{side + 1}", 0.0)
    play = 2.0 * machine.play
    pulls = FILMS[-1] * longer + (1.0 - FILMS[-1]) * (longer - np.clip(longer, -play, play))
    return float(-pulls / soft * line[1] / machine.ground[1])


def shown(machine: LoadedMachine, angle: Array, force: Array) -> dict[str, Array]:
    """What gauges between slider and bolster show over crank angles and forces."""
    places = np.array([settled(machine, at, load) for at, load in zip(angle, force, strict=True)])
    stiffness, apart = machine.columns
    lift = -places[:, 12] + force / stiffness + machine.frame * machine.bolster
    return {
        "deflection": lift,
        "slider_tilt": places[:, 13] - force * machine.offset / (stiffness * apart**2),
        "platform_tilt": places[:, 10],
        **{
            f"ground_rise_{side + 1}": np.array(
                [ground_rise(machine, at, place, side) for at, place in zip(angle, places, strict=True)]
            )
            for side, _ in SIDES
        },
    }
