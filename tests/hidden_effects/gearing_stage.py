"""Sun and planet of a reducer as they come from the workshop: geometry of the pair, its play, and the tooth roots.

Nothing of the plugin is imported. Lengths are mm, angles rad, deviations along the line of action um. The play is what
two teeth leave of a pitch, and the root is rolled by the rounding of the rack, point by point.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import acos, cos, pi, radians, sin, sqrt, tan

import numpy as np

from hidden_effects.rows import Array

SUN, PLANET, PINS = 20, 55, 40
MODULE, ANGLE, WIDTH = 1.25, radians(20), 12.0
DEDENDUM, FILLET, BEARING = 1.25, 0.38, 0.99


@dataclass(frozen=True)
class Stage:
    """One machine: its face width (mm), shifts in modules and bearing efficiency, as they came from the workshop."""

    width: float = WIDTH
    shift_sun: float = 0.0
    shift_planet: float = 0.0
    bearing: float = BEARING

    @property
    def shifts(self) -> tuple[float, float]:
        """Of sun and planet."""
        return self.shift_sun, self.shift_planet


TEETH = (SUN, PLANET)
BASE = (MODULE * SUN / 2 * cos(ANGLE), MODULE * PLANET / 2 * cos(ANGLE))


# Geometry


def bisected(wanted: float) -> float:
    """The angle of an involute."""
    low, high = 1e-3, 1.2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if tan(middle) - middle < wanted else (low, middle)
    return low


@lru_cache(maxsize=64)
def tight_angle(stage: Stage) -> float:
    """Where both gears touch on both flanks: their thicknesses fill the pitch of the working circles."""
    thick = [MODULE * (pi / 2 + 2 * x * tan(ANGLE)) for x in stage.shifts]
    filled = [s / (MODULE * z) + tan(ANGLE) - ANGLE for s, z in zip(thick, TEETH, strict=True)]  # at the base circle
    return bisected((filled[0] * SUN + filled[1] * PLANET - pi) / (SUN + PLANET))


@dataclass(frozen=True)
class Pair:
    """Sun and planet so far apart: working angle and contact ratio, arrays, and the radii of the tips."""

    angle: Array
    tips: tuple[float, float]
    overlap: Array

    @property
    def path(self) -> Array:
        """Between the points where the line of action leaves the base circles."""
        return np.asarray((BASE[0] + BASE[1]) * np.tan(self.angle))

    @property
    def outer(self) -> tuple[float, float]:
        """Radii of curvature of both tips."""
        one, two = (sqrt(tip**2 - base**2) for tip, base in zip(self.tips, BASE, strict=True))
        return one, two


def pair_of(stage: Stage, apart: Array | float = 0.0) -> Pair:
    """Sun and planet farther apart by so many mm than without play; never closer."""
    centres = (BASE[0] + BASE[1]) / cos(tight_angle(stage)) + np.asarray(apart)
    angle = np.arccos((BASE[0] + BASE[1]) / centres)
    one, two = (MODULE * (z / 2 + 1 + x) for z, x in zip(TEETH, stage.shifts, strict=True))
    inside = sqrt(one**2 - BASE[0] ** 2) + sqrt(two**2 - BASE[1] ** 2) - centres * np.sin(angle)
    return Pair(angle, (one, two), np.asarray(inside / (pi * MODULE * cos(ANGLE))))


def play_between(stage: Stage, apart: Array) -> Array:
    """What the teeth leave of the pitch on the working circles, along the line of action, um; ``apart`` in mm."""
    working = pair_of(stage, apart).angle
    left = 2 * pi * BASE[0] / np.cos(working) / SUN
    for base, z, x in zip(BASE, TEETH, stage.shifts, strict=True):
        half = (pi / 2 + 2 * x * tan(ANGLE)) / z + tan(ANGLE) - ANGLE - (np.tan(working) - working)
        left = left - 2 * base / np.cos(working) * half
    return np.asarray(np.maximum(left * np.cos(working) * 1e3, 0.0))


# Tooth roots


def rolled(teeth: int, shift: float) -> tuple[Array, Array]:
    """Fillet of a tooth from its bottom upward: half thickness, height above the middle of the gear, in modules."""
    turned = np.linspace(0.0, 0.3, 30001)
    deep = DEDENDUM - FILLET - shift
    across = pi / 4 - DEDENDUM * tan(ANGLE) - FILLET * (1 - sin(ANGLE)) / cos(ANGLE) + teeth / 2 * turned
    longer = 1 + FILLET / np.hypot(across, deep)
    across, height = across * longer, teeth / 2 - deep * longer
    beside = pi / teeth - np.arctan2(across, height) + turned  # from the middle of the tooth
    away = np.hypot(across, height)
    return np.asarray(away * np.sin(beside)), np.asarray(away * np.cos(beside))


@lru_cache(maxsize=64)
def root_factors(teeth: int, shift: float) -> tuple[float, float]:
    """Y_Fa and Y_Sa, the load at the tip: at the place where a line inclined by 30 degrees touches the fillet."""
    half, height = rolled(teeth, shift)
    steep, climb = np.gradient(half), np.gradient(height)
    at = int(np.argmin(np.abs(np.arctan2(-steep, climb) - pi / 6)))
    bend = np.gradient(steep)[at] * climb[at] - np.gradient(climb)[at] * steep[at]
    radius = float((steep[at] ** 2 + climb[at] ** 2) ** 1.5 / abs(bend))
    tip = teeth / 2 + 1 + shift
    at_tip = acos(teeth / 2 * cos(ANGLE) / tip)
    narrow = (pi / 2 + 2 * shift * tan(ANGLE)) / teeth + tan(ANGLE) - ANGLE - (tan(at_tip) - at_tip)
    leaning = at_tip - narrow
    arm = tip * (cos(narrow) - sin(narrow) * tan(leaning)) - float(height[at])
    thick = 2 * float(half[at])
    form = 6 * arm * cos(leaning) / (thick**2 * cos(ANGLE))
    notch = thick / (2 * radius)
    return form, (1.2 + 0.13 * thick / arm) * notch ** (1 / (1.21 + 2.3 * arm / thick))
