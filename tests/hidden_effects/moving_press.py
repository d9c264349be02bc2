"""A press in motion by a program of its own: all bodies of a side in one linear system, friction inside it.

Nothing of the plugin is imported. Joints come from the angles of triangles; speeds by complex steps, accelerations by
differences of eighth order; forces from three equations of Newton and Euler for every link, two for platform, slider
and knee pin. Pins rub under the forces that they carry with friction, found round by round. SI throughout; one side, of
which platform and slider are half; y outward, z downward.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from hidden_effects.rows import Array
from published.press_by_hand import PAPER

GRAVITY, STEP, TINY = 9.80665, 0.01, 1e-30
NEAR = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
LINKS = {"crank": "AB", "rod": "BE", "drive": "CG", "upper": "MG", "lower": "GH"}
"""First and last joint of each link; C is the end of the platform arm."""
FORCES = ("crank_pivot", "crank_pin", "rod_joint", "arm_joint", "knee_of_drive", "knee_of_upper", "knee_of_lower",
          "ground_joint", "slider_joint")  # fmt: skip
"""Unknown forces, each on the link of ``ON``; then the torque and what guides platform and slider along y."""
ON = ("crank", "rod", "rod", "drive", "drive", "upper", "lower", "upper", "lower")
AT = "ABECGGGMH"
AGAINST = ("frame", "crank", "frame", "frame", "upper", "", "upper", "frame", "frame")
"""What each link turns against there; platform and slider do not turn, and the knee pin is fixed in the upper link."""


def bars(each: float = 157.0) -> dict[str, float]:
    """Masses of steel bars of so many kilograms per metre."""
    names = ("crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length")
    return {link: each * PAPER[name] for link, name in zip(LINKS, names, strict=True)}


@dataclass(frozen=True, kw_only=True)
class MovingMachine:
    """Sizes, masses and friction of a press; links are bars unless a centre or an inertia is named."""

    press: Mapping[str, float] = field(default_factory=lambda: PAPER)
    mass: Mapping[str, float] = field(default_factory=lambda: {
        "crank": 56.5, "rod": 205.0, "drive": 136.0, "upper": 267.0, "lower": 251.0,
    })  # fmt: skip
    centre: Mapping[str, float] = field(default_factory=dict)
    inertia: Mapping[str, float] = field(default_factory=dict)
    rotor: float = 200.0
    platform: float = 2000.0
    slider: float = 20000.0
    lift: float = 196e3
    guide: float = 0.0
    pins: float = 0.0
    drag: float = 0.0


def joints(angle: Array, press: Mapping[str, float]) -> dict[str, Array]:
    """Every joint (2, k) at crank angles from the bottom dead centre; complex angles give complex joints."""
    p = press
    theta = angle + np.arccos(
        (p["platform_half_width"] - p["crank_pivot_radius"]) / (p["crank_radius"] + p["rod_length"])
    )
    zero = 0.0 * theta
    pivot = np.array([p["crank_pivot_radius"] + zero, zero])
    pin = pivot + p["crank_radius"] * np.array([np.cos(theta), np.sin(theta)])
    beta = np.arcsin((pin[0] - p["platform_half_width"]) / p["rod_length"])
    rod_end = pin + p["rod_length"] * np.array([-np.sin(beta), np.cos(beta)])
    arm = np.array([zero, rod_end[1] + p["platform_arm"]])
    ground = p["ground_pivot_radius"] * np.array(
        [np.cos(p["ground_pivot_angle"]) + zero, np.sin(p["ground_pivot_angle"]) + zero]
    )
    apart = ground - arm
    distance = np.sqrt(apart[0] ** 2 + apart[1] ** 2)
    drive, upper = p["knee_drive_length"], p["upper_knee_length"]
    inner = np.arccos((drive**2 + distance**2 - upper**2) / (2 * drive * distance))
    at = np.arctan(apart[1] / apart[0]) + inner
    knee = arm + drive * np.array([np.cos(at), np.sin(at)])
    gamma = np.arcsin((p["slider_half_width"] - knee[0]) / p["lower_knee_length"])
    slider = knee + p["lower_knee_length"] * np.array([np.sin(gamma), np.cos(gamma)])
    return {"A": pivot, "B": pin, "E": rod_end, "C": arm, "G": knee, "M": ground, "H": slider}


def slope(of: Callable[[Array], Array], angle: Array) -> Array:
    """First derivative by a complex step."""
    return np.asarray(np.imag(of(angle + 1j * TINY)) / TINY)


def curvature(of: Callable[[Array], Array], angle: Array) -> Array:
    """Second derivative: differences of eighth order of the first."""
    return np.asarray(sum(w * slope(of, angle + (i - 4) * STEP) for i, w in enumerate(NEAR)) / STEP)


@dataclass(frozen=True)
class Going:
    """How one link goes: places of its joints and its centre (2, k), and the derivatives of centre and angle."""

    ends: tuple[Array, Array]
    centre: Array
    velocity: Array
    bend: Array
    turn: Array
    turn_bend: Array


def going(machine: MovingMachine, link: str, angle: Array) -> Going:
    """One link at these crank angles."""
    first, last = LINKS[link]
    share = machine.centre.get(link, 0.5)

    def centre(at: Array) -> Array:
        places = joints(at, machine.press)
        return np.asarray(places[first] + share * (places[last] - places[first]))

    def turn(at: Array) -> Array:
        line = joints(at, machine.press)
        y, z = line[last] - line[first]
        way = slope(lambda x: np.subtract(*(joints(x, machine.press)[end] for end in (last, first))), at)
        return np.asarray((y * way[1] - z * way[0]) / (y * y + z * z))

    places = joints(angle, machine.press)
    turn_bend = sum(w * turn(angle + (i - 4) * STEP) for i, w in enumerate(NEAR)) / STEP
    return Going((places[first], places[last]), centre(angle), slope(centre, angle), curvature(centre, angle),
                 turn(angle), np.asarray(turn_bend))  # fmt: skip


@dataclass(frozen=True)
class Needed:
    """Torque of one crank (k,), and the forces by name (2, k)."""

    torque: Array
    forces: Mapping[str, Array]


def needed(machine: MovingMachine, angle: Array, speed: Array, acceleration: Array, force: Array) -> Needed:
    """What the drive must give and the joints carry: one linear system per crank angle, pins rubbing in it."""
    links = {link: going(machine, link, angle) for link in LINKS}
    matrix, fixed = system(machine, links, angle, (speed, acceleration, force))
    carried = np.zeros((len(FORCES), len(angle)))
    for _ in range(60):
        right = fixed.copy()
        for number, (on, against) in enumerate(zip(ON, AGAINST, strict=True)):
            other = links[against].turn if against in links else 0.0
            moment = machine.pins * carried[number] * np.sign((links[on].turn - other) * speed) * bool(against)
            right[:, 3 * list(LINKS).index(on) + 2] += moment
            if against in links:
                right[:, 3 * list(LINKS).index(against) + 2] -= moment
        solved = np.linalg.solve(matrix, right[..., None])[..., 0]
        before, carried = carried, np.hypot(solved[:, 0:18:2], solved[:, 1:18:2]).T
        if np.allclose(before, carried, rtol=1e-13, atol=1e-9):
            break
    forces = {name: solved[:, 2 * number : 2 * number + 2].T for number, name in enumerate(FORCES)}
    return Needed(solved[:, 18] + machine.drag * speed, forces)


def system(
    machine: MovingMachine, links: Mapping[str, Going], angle: Array, moved: tuple[Array, Array, Array]
) -> tuple[Array, Array]:
    """Matrix (k, 21, 21) and right side (k, 21) of all equations of one side, without the friction of pins."""
    speed, acceleration, force = moved
    matrix, right = np.zeros((len(angle), 21, 21)), np.zeros((len(angle), 21))
    ends = joints(angle, machine.press)
    for row, (link, own) in enumerate(links.items()):
        mass, length = machine.mass[link], np.hypot(*(own.ends[1] - own.ends[0]))
        inertia = machine.inertia.get(link, mass * length**2 / 12)
        pull = mass * (own.bend * speed**2 + own.velocity * acceleration)
        right[:, 3 * row : 3 * row + 2] = (pull - np.array([[0.0], [mass * GRAVITY]])).T
        right[:, 3 * row + 2] = inertia * (own.turn_bend * speed**2 + own.turn * acceleration)
        for number, name in enumerate(FORCES):
            sign = 1.0 if ON[number] == link else -1.0 if (link, name) == ("crank", "crank_pin") else 0.0
            if sign:
                y, z = ends[AT[number]] - own.centre
                matrix[:, 3 * row, 2 * number] = matrix[:, 3 * row + 1, 2 * number + 1] = sign
                matrix[:, 3 * row + 2, 2 * number] = -sign * z
                matrix[:, 3 * row + 2, 2 * number + 1] = sign * y
    matrix[:, 2, 18] = 1.0
    right[:, 2] += machine.rotor * acceleration
    for row, number in ((15, 4), (15, 5), (15, 6)):  # the pin of the knee has no mass
        matrix[:, row, 2 * number] = matrix[:, row + 1, 2 * number + 1] = 1.0
    guided = ((17, machine.platform, "E", (2, 3), 19, 0.0 * force), (19, machine.slider, "H", (8,), 20, force))
    for row, mass, joint, numbers, guide, pushed in guided:
        for number in numbers:
            matrix[:, row, 2 * number] = matrix[:, row + 1, 2 * number + 1] = -1.0
        matrix[:, row, guide] = 1.0

        def height(at: Array, joint: str = joint) -> Array:
            return np.asarray(joints(at, machine.press)[joint][1])

        down = slope(height, angle)
        moving = curvature(height, angle) * speed**2 + down * acceleration
        is_slider = float(joint == "H")
        held = pushed + is_slider * (machine.lift + machine.guide * np.sign(down * speed))
        right[:, row + 1] = 0.5 * (mass * (moving - GRAVITY) + held)
    return matrix, right
