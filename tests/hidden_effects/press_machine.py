"""A press that is warm, loaded, loose, worn and read by an imperfect gauge: exact geometry, row by row.

Written from the vector loops and from virtual work alone; nothing of the plugin is imported. Complex numbers y + jz,
z downward, side 2 with its own angles. Everything is SI: m, rad, N, s, K, revolutions per second.

Heated links really get longer, loaded ones shorter by N L / (E A) with the link force N from virtual work on the exact
position; joints with clearance are pushed to the loaded end. A positive force pushes the slider up.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import acos, pi
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hidden_effects.rows import Array, Hidden, MeasuredRows
from published import press_by_hand as by_hand

Complex: TypeAlias = NDArray[np.complex128]
Sizes: TypeAlias = "dict[str, float | Array]"

POSITION, TILT = "slider_position", "slider_tilt"
REFERENCE_TEMPERATURE = 20.0  # degC
JOINTS = by_hand.KINDS[5:13]
NOMINAL = {kind: by_hand.PAPER.get(kind, 0.0) for kind in by_hand.KINDS}
ARM = by_hand.PAPER["platform_arm"]
SIDES = (1, 2)
LINKS = by_hand.KINDS[:5]
LOADED = ("rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length")
BOTTOM = acos((0.3 - 1.2) / (0.36 + 1.304))  # direction of the crank with the slider lowest
STATED = by_hand.deviations("complete", dict.fromkeys(by_hand.LINKS, "IT7"))
PARTS = (f"{kind}_deviation_{side}" for kinds in (LINKS, JOINTS) for side in SIDES for kind in kinds)
SCATTER = {name: STATED[name] for name in (*PARTS, "platform_arm_deviation")}
"""Standard deviations of the parts in m and rad: links of grade IT7, joints as mounted."""


@dataclass(frozen=True)
class Rows(MeasuredRows):
    """What was set and measured beside the slider: SI arrays (n,); temperature in degC, speed in turns per second.

    Time and strokes count from the first row of the file.
    """

    crank_angle: Array
    forming_force: Array
    link_temperature: Array
    strokes: Array
    speed: Array
    direction: Array


def built(off: Mapping[str, float]) -> Sizes:
    """The sizes of a machine whose parts are off by this much."""
    sizes: Sizes = {
        f"{kind}_{side}": size + off.get(f"{kind}_deviation_{side}", 0.0)
        for side in SIDES
        for kind, size in NOMINAL.items()
        if not kind.endswith("angle")
    }
    angles = [kind for kind in NOMINAL if kind.endswith("angle")]
    sizes |= {f"{kind}_{side}": off.get(f"{kind}_deviation_{side}", 0.0) for side in SIDES for kind in angles}
    return sizes | {"platform_arm": ARM + off.get("platform_arm_deviation", 0.0)}


def direction_of(kind: str, side: int, sizes: Sizes, more: float | Array = 0.0) -> Complex:
    """Unit vector of a polar angle that counts from outward; on side 2 the nominal part turns the other way.

    What a joint is off is an angle of the frame on both sides; what a crank is off turns with its own side.
    """
    outward, turn = (0.0, 1.0) if side == 1 else (pi, -1.0)
    own = sizes[f"{kind}_{side}"] * (turn if kind == "crank_angle" else 1.0)
    return np.asarray(np.exp(1j * (outward + turn * (NOMINAL[kind] + more) + own)))


def carried(above: Complex, across: float | Array, length: float | Array) -> Array:
    """Height of the lower end of a link of this length that hangs at ``above``, its lower end at y = across."""
    return np.asarray(above.imag + np.sqrt(length**2 - (across - above.real) ** 2))


def meeting(first: Complex, second: Complex, reach_1: float | Array, reach_2: float | Array, hand: float) -> Complex:
    """Where two links from two points meet; ``hand`` +1 to the left of the way from first to second seen along +j."""
    way = second - first
    distance = np.abs(way)
    along = (reach_1**2 - reach_2**2 + distance**2) / (2 * distance)
    return np.asarray(first + way / distance * (along + 1j * hand * np.sqrt(reach_1**2 - along**2)))


def platform_height(crank_angle: Array, sizes: Sizes, side: int) -> Array:
    """The platform height that one side alone would set."""
    pin = sizes[f"crank_pivot_radius_{side}"] * direction_of("crank_pivot_angle", side, sizes)
    pin = pin + sizes[f"crank_radius_{side}"] * direction_of("crank_angle", side, sizes, BOTTOM + crank_angle)
    joint = sizes[f"platform_half_width_{side}"] * direction_of("platform_joint_angle", side, sizes)
    return np.asarray(carried(pin, joint.real, sizes[f"rod_length_{side}"]) - joint.imag)


def face(arm_end: Array, sizes: Sizes, side: int) -> Array:
    """Height of the slider face over the joint of one side."""
    ground = sizes[f"ground_pivot_radius_{side}"] * direction_of("ground_pivot_angle", side, sizes)
    drive, upper = sizes[f"knee_drive_length_{side}"], sizes[f"upper_knee_length_{side}"]
    knee = meeting(np.asarray(1j * arm_end, dtype=complex), ground, drive, upper, 1.0 if side == 1 else -1.0)
    joint = sizes[f"slider_half_width_{side}"] * direction_of("slider_joint_angle", side, sizes)
    return np.asarray(carried(knee, joint.real, sizes[f"lower_knee_length_{side}"]) - joint.imag)


def slider(crank_angle: Array, sizes: Sizes) -> dict[str, Array]:
    """Position and tilt of the slider with these sizes."""
    heights = [platform_height(crank_angle, sizes, side) for side in SIDES]
    arm_end = (heights[0] + heights[1]) / 2 + sizes["platform_arm"]
    first, second = face(arm_end, sizes, 1), face(arm_end, sizes, 2)
    return {POSITION: (first + second) / 2, TILT: (first - second) / (2 * NOMINAL["slider_half_width"])}


def lowering(crank_angle: Array, sizes: Sizes) -> dict[str, Array]:
    """How far the slider sinks per metre that each loaded link is longer; a force on it loads the links likewise."""
    step = 1e-5
    slopes = {}
    for name in (f"{kind}_{side}" for side in SIDES for kind in LOADED):
        longer = slider(crank_angle, {**sizes, name: sizes[name] + step})[POSITION]
        shorter = slider(crank_angle, {**sizes, name: sizes[name] - step})[POSITION]
        slopes[name] = (longer - shorter) / (2 * step)
    return slopes


def curvature(crank_angle: Array, sizes: Sizes) -> Array:
    """Second derivative of the slider position by the crank angle, m/rad^2."""
    step = 2e-3
    below, here, above = (slider(crank_angle + way * step, sizes)[POSITION] for way in (-1, 0, 1))
    return np.asarray((below - 2 * here + above) / step**2)


def strains(rows: Rows, hidden: Hidden) -> dict[int, Array]:
    """Thermal strain of the links of each side; the arm between them takes the mean."""
    warmth = rows.link_temperature - REFERENCE_TEMPERATURE
    both = hidden.get("link_heating", {}).get("expansion", 0.0) * warmth
    if "warm_up" in hidden:
        rise, constant = hidden["warm_up"]["rise"], hidden["warm_up"]["time_constant"]
        both = both + rise * -np.expm1(-rows.time / constant)
    own = hidden.get("side_heating", {})
    return {side: both + own.get(f"expansion_{side}", 0.0) * warmth for side in SIDES}


def heated(sizes: Sizes, strain: Mapping[int, Array]) -> Sizes:
    """The sizes with every link longer by the strain of its side."""
    longer = {f"{kind}_{side}": sizes[f"{kind}_{side}"] * (1 + strain[side]) for side in SIDES for kind in LINKS}
    return {**sizes, **longer, "platform_arm": sizes["platform_arm"] * (1 + (strain[1] + strain[2]) / 2)}


def crank_error(rows: Rows, hidden: Hidden) -> Array:
    """How far both cranks are ahead of the angle that is commanded, rad."""
    angle = rows.crank_angle
    ahead = np.full(len(rows), hidden.get("crank_phase", {}).get("phase", 0.0))
    runout = hidden.get("encoder_eccentricity", {})
    ahead += runout.get("sine", 0.0) * np.sin(angle) + runout.get("cosine", 0.0) * np.cos(angle)
    play = hidden.get("drive_backlash", {})
    is_before = np.remainder(angle + pi, 2 * pi) < pi
    turning = np.where(is_before, rows.direction, -rows.direction)
    return ahead - turning / 2 * np.where(is_before, play.get("play_before", 0.0), play.get("play_after", 0.0))


def gap(rows: Rows, hidden: Hidden) -> Array:
    """Radial clearance of every joint, m."""
    worn = hidden.get("joint_wear", {}).get("wear", 0.0) * rows.strokes / 1e6
    return np.asarray(hidden.get("joint_clearance", {}).get("clearance", 0.0) + worn)


def pushed_up(rows: Rows, hidden: Hidden) -> Array:
    """What the links carry, N: the forming force and what lifts the slider, less what hangs on it (``hanging``)."""
    slider = hidden.get("hanging", {})
    return np.asarray(rows.forming_force + slider.get("lift", 0.0) - 9.80665 * slider.get("mass", 0.0))


def yielded(rows: Rows, angle: Array, sizes: Sizes, hidden: Hidden) -> Sizes:
    """The sizes with the links of the knee and the rods shortened by their load and pushed through their clearance."""
    compliance = hidden.get("elastic_deflection", {}).get("compliance", 0.0)
    inertia = hidden.get("slider_inertia", {}).get("mass_compliance", 0.0)
    loose = gap(rows, hidden)
    if not (compliance or inertia or np.any(loose)):
        return sizes
    slopes = lowering(angle, sizes)
    load = compliance * pushed_up(rows, hidden)
    if inertia:
        load = load + inertia * curvature(angle, sizes) * (2 * pi * rows.speed) ** 2
    pushed = np.where(pushed_up(rows, hidden) >= 0, 1.0, -1.0)
    return sizes | {
        name: sizes[name] * (1 - slope * load) - 2 * loose * np.sign(slope) * pushed for name, slope in slopes.items()
    }


def moved(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> dict[str, Array]:
    """Where the slider truly is at every row."""
    angle = rows.crank_angle + crank_error(rows, hidden)
    sizes = yielded(rows, angle, heated(built(off), strains(rows, hidden)), hidden)
    found = slider(angle, sizes)
    die = hidden.get("die_inclination", {})
    return {
        POSITION: found[POSITION] + die.get("height", 0.0),
        TILT: found[TILT] + die.get("inclination", 0.0),
    }


def _order(rows: Rows, unknowns: Mapping[str, float], result: str) -> Array:
    angle = unknowns.get(f"{result}_order", 0.0) * rows.crank_angle
    sine, cosine = unknowns.get(f"{result}_sine", 0.0), unknowns.get(f"{result}_cosine", 0.0)
    return np.asarray(sine * np.sin(angle) + cosine * np.cos(angle))


def _step(rows: Rows, unknowns: Mapping[str, float], result: str) -> Array:
    late = rows.time >= unknowns.get(f"{result}_after", 0.0)
    return np.asarray(unknowns.get(result, 0.0) * late)


GAUGE: dict[str, Callable[[Rows, Mapping[str, float], str], Array]] = {
    "sensor_offset": lambda rows, unknowns, result: np.full(len(rows), unknowns.get(result, 0.0)),
    "sensor_drift": lambda rows, unknowns, result: unknowns.get(result, 0.0) * rows.time,
    "thermal_drift": lambda rows, unknowns, result: (
        unknowns.get(result, 0.0) * (rows.link_temperature - REFERENCE_TEMPERATURE)
    ),
    "periodic_order": _order,
    "step": _step,
}


def shown(rows: Rows, off: Mapping[str, float], hidden: Hidden) -> dict[str, Array]:
    """What the gauges would show without noise: the true place, then gain, then everything they add."""
    true = moved(rows, off, hidden)
    read = {}
    for result, values in true.items():
        read[result] = values * (1 + hidden.get("sensor_gain", {}).get(result, 0.0))
        for effect, added in GAUGE.items():
            if effect in hidden:
                read[result] = read[result] + added(rows, hidden[effect], result)
    return read
