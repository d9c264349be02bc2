"""Gears traced point by point: what the formulas of gear geometry must give, found without them.

Lengths are in modules. A flank is the involute of its base circle, a fillet is swept by the rounding of a rack that
rolls on the gear, contact and overlap are looked for among points. Nothing here is imported from the plugins.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ALPHA = float(np.radians(20.0))


def turned(point: Array, angle: float | Array) -> Array:
    """A point (2, ...) turned about the origin."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]])


def unwound(base: float, radius: float | Array) -> float | Array:
    """Polar angle of an involute from where it leaves its base circle to a radius: unwound thread less turned angle."""
    thread = np.sqrt(np.maximum(np.square(radius) - base**2, 0.0))
    return thread / base - np.arctan2(thread, base)


@dataclass(frozen=True)
class Flanks:
    """Teeth of an external gear, or gaps of an internal one: both are bounded by the same pair of involutes."""

    teeth: float
    shift: float
    alpha: float = ALPHA

    @property
    def base(self) -> float:
        """Radius of the base circle."""
        return 0.5 * self.teeth * float(np.cos(self.alpha))

    def half(self, radius: float | Array) -> Array:
        """Half the angle of tooth or gap at a radius: at the reference circle it is that of the rack."""
        at_reference = (0.5 * np.pi + 2.0 * self.shift * np.tan(self.alpha)) / self.teeth
        return np.asarray(at_reference + unwound(self.base, 0.5 * self.teeth) - unwound(self.base, radius))


@dataclass(frozen=True)
class Couple:
    """A roller inside a ring: flanks and tip radii of both, and the distance of their centres."""

    roller: Flanks
    ring: Flanks
    roller_tip: float
    ring_tip: float
    distance: float


def swept_root(dedendum: float, rounding: float, gear: Flanks) -> tuple[float, float, float]:
    """Chord, radius of curvature and depth where the swept rounding of a rack leans 30 degrees to the tooth.

    The rack rolls on the reference circle, its rounding touches bottom and flank; the tooth stands along the first
    axis. NaN where the fillet never leans so much.
    """
    below = dedendum - rounding
    across = 0.5 * np.pi - (0.25 * np.pi - below * np.tan(gear.alpha) - rounding / np.cos(gear.alpha))
    height, radius = gear.shift - below, 0.5 * gear.teeth
    roll = np.linspace(-3.0, 3.0, 60_001) * np.pi / gear.teeth
    there = np.array([radius + height + 0.0 * roll, across - radius * roll])
    path = turned(there, roll)
    steps = np.gradient(path, roll, axis=1, edge_order=2)
    normal = np.array([-steps[1], steps[0]]) / np.hypot(*steps)
    lowest = int(np.argmin(np.hypot(*path)))
    normal *= -np.sign((normal * path).sum(axis=0)[lowest])  # there it points to the centre of the gear
    fillet = path + rounding * normal
    lean = np.arctan2(-normal[1], -normal[0]) - np.pi / 3.0  # of the normal to the axis; the tangent stands across it
    places = np.flatnonzero(lean[:-1] * lean[1:] < 0)
    if not len(places):
        return float("nan"), float("nan"), float("nan")
    place = int(places[np.argmin(np.abs(places - lowest))])
    share = -lean[place] / (lean[place + 1] - lean[place])
    point = fillet[:, place] + share * (fillet[:, place + 1] - fillet[:, place])
    bend = np.hypot(*(fillet[:, place + 1] - fillet[:, place])) / abs(lean[place + 1] - lean[place])
    return 2.0 * float(abs(point[1])), float(bend), float(point[0])


def line_of_action_meets(flanks: Flanks, tip: float, across: float) -> float:
    """Where the line of a force at the tip, normal to the flank, meets the axis of the tooth; ``across`` is +1 or -1.

    The tooth stands along the first axis; the normal is that of two neighbouring points of the flank.
    """
    radii = tip - np.array([2e-6, 1e-6, 0.0])
    points = radii * np.array([np.cos(flanks.half(radii)), across * np.sin(flanks.half(radii))])
    tangent = points @ np.array([1.0, -4.0, 3.0])
    normal = np.array([-tangent[1], tangent[0]])
    return float(points[0, -1] - points[1, -1] * normal[0] / normal[1])


def path_of_contact(couple: Couple) -> tuple[Array, Array]:
    """The points (2,) where the tips of roller and ring meet the line of action; the ring's centre is the origin.

    The line touches both base circles on one side; points of contact lie beyond the touching point of the roller.
    """
    lean = np.arccos((couple.ring.base - couple.roller.base) / couple.distance)
    outward = np.array([np.cos(lean), np.sin(lean)])  # from either centre to where the line touches
    along = np.array([outward[1], -outward[0]])
    touch = couple.ring.base * outward
    ends = []
    for centre, tip in ((np.array([couple.distance, 0.0]), couple.roller_tip), (np.zeros(2), couple.ring_tip)):
        start = touch - centre
        half = start @ along
        ends.append(touch + (-half + np.sqrt(half**2 - start @ start + tip**2)) * along)
    return ends[0], ends[1]


def sliding_of_surfaces(couple: Couple, point: Array) -> tuple[float, float]:
    """Specific sliding 1 - v_other/v_own of (roller, ring) at a point of contact, from the speeds of both surfaces."""
    lean = np.arccos((couple.ring.base - couple.roller.base) / couple.distance)
    flank = np.array([np.cos(lean), np.sin(lean)])  # tangent of both flanks: across the line of action
    arm_roller, arm_ring = point - np.array([couple.distance, 0.0]), point
    roller = np.array([-arm_roller[1], arm_roller[0]]) / couple.roller.teeth @ flank
    ring = np.array([-arm_ring[1], arm_ring[0]]) / couple.ring.teeth @ flank
    return float(1.0 - ring / roller), float(1.0 - roller / ring)


def deepest_overlap(couple: Couple) -> float:
    """How deep a corner of a tip comes into a tooth of the other gear while the pair turns; 2 pi is a tooth.

    Both turn by the same number of teeth from where a tooth of the roller stands in the middle of a gap.
    """
    turn = np.linspace(0.0, 2.0 * couple.roller.teeth, 20_001)
    deepest = -np.inf
    for side in (1.0, -1.0):
        angle = turn / couple.roller.teeth + side * couple.roller.half(couple.roller_tip)
        radius, lag = _seen_from(couple.distance, couple.roller_tip, angle, turn, couple.ring.teeth)
        room = couple.ring.half(radius) - np.abs(lag)
        deepest = max(deepest, float(np.max(np.where(radius > couple.ring_tip, -room * couple.ring.teeth, -np.inf))))
        angle = turn / couple.ring.teeth + side * couple.ring.half(couple.ring_tip)
        radius, lag = _seen_from(-couple.distance, couple.ring_tip, angle, turn, couple.roller.teeth)
        room = np.abs(lag) - couple.roller.half(radius)
        inside = (radius < couple.roller_tip) & (radius > couple.roller.base)
        deepest = max(deepest, float(np.max(np.where(inside, -room * couple.roller.teeth, -np.inf))))
    return deepest


def _seen_from(offset: float, radius: float, angle: Array, turn: Array, teeth: float) -> tuple[Array, Array]:
    """A point of one gear as the other sees it: radius, and angle from the middle of the nearest tooth or gap."""
    across, along = offset + radius * np.cos(angle), radius * np.sin(angle)
    pitch = 2.0 * np.pi / teeth
    lag = np.arctan2(along, across) - turn / teeth
    return np.hypot(across, along), (lag + 0.5 * pitch) % pitch - 0.5 * pitch


def free_turn(couple: Couple) -> float:
    """Angle by which the roller can be turned while the ring stands: from flank to flank; below 0 it jams."""
    radii = np.linspace(couple.roller.base * 1.001, couple.roller_tip, 4_001)
    pitch = 2.0 * np.pi / couple.roller.teeth
    tooth = np.arange(-3, 4)[:, None] * pitch + couple.roller.half(radii)

    def room(angle: float) -> float:
        across, along = couple.distance + radii * np.cos(tooth + angle), radii * np.sin(tooth + angle)
        radius, seen = np.hypot(across, along), np.arctan2(along, across)
        nearest = np.round(seen / (2.0 * np.pi / couple.ring.teeth)) * 2.0 * np.pi / couple.ring.teeth
        left = couple.ring.half(radius) - (seen - nearest)
        return float(np.min(np.where(radius > couple.ring_tip, left, np.inf)))

    low, high = -0.2 * pitch, 0.2 * pitch
    for _ in range(45):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if room(middle) > 0.0 else (low, middle)
    return 2.0 * low
