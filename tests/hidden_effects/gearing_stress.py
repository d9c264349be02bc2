"""Stresses of the first stage after ISO 6336:2006, method B (face load method C), and what raises them.

Nothing of the plugin is imported. Lengths are mm, forces N, stresses MPa, deviations um, speeds r/min. What an effect
does is not the formula of the effect: load is spread over a face strip by strip, a vibration is solved for its two
phases, and two planets share a force as springs of which one touches first.
"""

from dataclasses import dataclass
from math import cos, hypot, pi, sqrt

import numpy as np

from hidden_effects.gearing_stage import ANGLE, BASE, MODULE, PLANET, SUN, TEETH, Array, Stage, pair_of, root_factors

APPLICATION, SHARING = 1.25, 1.10
YOUNG, POISSON, DENSITY = 206e3, 0.3, 7.85e-6
GRADE = 2**0.5  # 6 of ISO 1328
STRIPS = 200  # of the face


@dataclass(frozen=True)
class Loaded:
    """What a mesh carries, arrays (n,): force, speed against the carrier, share of the face; how far it is apart."""

    force: Array
    speed: Array
    carrying: Array
    apart: Array

    def line_load(self, stage: Stage) -> Array:
        """With the application factor, N/mm."""
        return np.asarray(self.force * APPLICATION / (stage.width * self.carrying))


def tooth_stiffness(stage: Stage, line_load: Array) -> Array:
    """Of one pair of teeth, N/(mm um)."""
    one, two = stage.shifts
    soft = 0.04723 + 0.15551 / SUN + 0.25791 / PLANET - 0.00635 * one - 0.11654 * one / SUN - 0.00193 * two
    soft += -0.24188 * two / PLANET + 0.00529 * one**2 + 0.00182 * two**2
    return np.asarray(0.8 * (1 + 0.5 * (1.2 - 1.25)) / soft * np.minimum(line_load / 100, 1.0) ** 0.25)


def mesh_stiffness(stage: Stage, line_load: Array, overlap: Array) -> Array:
    """Of the mesh, N/(mm um)."""
    return tooth_stiffness(stage, line_load) * (0.75 * overlap + 0.25)


def deviations(stage: Stage, teeth: int) -> tuple[float, float, float]:
    """Pitch, profile and helix deviation, um."""
    root = sqrt(MODULE * teeth)
    pitch, profile = 0.3 * (MODULE + 0.4 * root) + 4, 2.5 * sqrt(MODULE) + 0.17 * root + 0.5
    return GRADE * pitch, GRADE * profile, GRADE * (0.07 * root + 0.45 * sqrt(stage.width) + 3)


PITCH, PROFILE = (deviations(Stage(), PLANET)[place] * factor for place, factor in ((0, cos(ANGLE)), (1, 1.0)))


def own_speed(stage: Stage, stiffness: Array) -> Array:
    """Resonance of the mesh, r/min: a sun between two planets."""
    means = [MODULE * (z + 1 - 1.25 + 2 * x) for z, x in zip(TEETH, stage.shifts, strict=True)]
    sun, planet = (pi / 32 * DENSITY * mean**4 for mean in means)
    mass = 1 / (2 * BASE[0] ** 2 / sun + BASE[1] ** 2 / planet)
    return np.asarray(30000 / (pi * SUN) * np.sqrt(stiffness / mass))


def dynamic_factor(stage: Stage, loaded: Loaded, stiffness: Array) -> Array:
    """K_V below the resonance of the mesh."""
    load = loaded.line_load(stage)
    specific = tooth_stiffness(stage, load) / load
    growth = 0.32 * specific * 0.925 * PITCH + 0.34 * specific * 0.925 * PROFILE + 0.23
    return np.asarray(1 + loaded.speed / own_speed(stage, stiffness) * growth)


def swinging(speed: Array, resonance: float, damping: float) -> Array:
    """What a spring gives way, over the error that works it: both phases of the mass behind it, solved, less the error.

    Spring and damper carry the mass along with the error, as a road carries a car.
    """
    found = []
    for ratio in speed / resonance:
        matrix = np.array([[1 - ratio**2, 2 * damping * ratio], [-2 * damping * ratio, 1 - ratio**2]])
        carried = np.linalg.solve(matrix, [1.0, -2 * damping * ratio])
        found.append(float(np.hypot(carried[0] - 1.0, carried[1])))
    return np.array(found)


def spread(tilted: Array, stiffness: Array, line_load: Array) -> Array:
    """Largest over mean load of a face, one end of which lags by ``tilted`` um: strips of springs that only push."""
    gaps = np.abs(tilted)[:, None] * (np.arange(STRIPS) + 0.5) / STRIPS
    low, high = np.zeros(len(tilted)), np.abs(tilted) + 2 * line_load / stiffness
    for _ in range(60):
        middle = (low + high) / 2
        carried = stiffness * np.mean(np.maximum(middle[:, None] - gaps, 0.0), axis=1)
        low, high = np.where(carried < line_load, middle, low), np.where(carried < line_load, high, middle)
    return np.asarray(stiffness * high / line_load)


def touched(share: Array) -> Array:
    """Over which share of its width a crowned face touches, at a share of the load that makes its ends touch.

    Strips of springs that only push, behind a parabola that stands back by 1 at both ends.
    """
    gaps = ((np.arange(STRIPS) + 0.5) / STRIPS) ** 2
    low, high = np.zeros(len(share)), 1 + share
    for _ in range(60):
        middle = (low + high) / 2
        pushed = np.mean(np.maximum(middle[:, None] - gaps, 0.0), axis=1) / np.mean(1 - gaps)
        low, high = np.where(pushed < share, middle, low), np.where(pushed < share, high, middle)
    return np.asarray(np.minimum(np.sqrt(high), 1.0))


def of_first_planet(lead: float, stiffness: Array, force: Array) -> Array:
    """Force on the planet that touches first over the mean of two, which lead and lag by ``lead`` um: two springs."""
    low, high = np.full(len(force), -abs(lead)), abs(lead) + 2 * force / stiffness
    for _ in range(60):
        middle = (low + high) / 2
        both = np.maximum(middle + lead, 0.0) + np.maximum(middle - lead, 0.0)
        low, high = (
            np.where(stiffness * both < 2 * force, middle, low),
            np.where(stiffness * both < 2 * force, high, middle),
        )
    return np.asarray(stiffness * (high + lead) / force)


@dataclass(frozen=True)
class Wrong:
    """What raises the load: misalignment (um) and dynamics, arrays (n,), lead of a planet and missing relief, um."""

    misaligned: Array
    shaken: Array
    lead: float
    relief: float


def stresses(stage: Stage, loaded: Loaded, wrong: Wrong) -> dict[str, Array]:
    """Root stress of sun and planet and contact stress of the sun."""
    width, load = stage.width * loaded.carrying, loaded.line_load(stage)
    overlap = pair_of(stage, loaded.apart).overlap
    stiffness = mesh_stiffness(stage, load, overlap)
    dynamic = dynamic_factor(stage, loaded, stiffness) + wrong.shaken
    sharing = np.minimum(SHARING - 1 + of_first_planet(wrong.lead, stiffness * width, loaded.force), 2.0)
    mean = load * dynamic * sharing
    bent = 0.023 * (stage.width / (MODULE * SUN)) ** 2 * mean
    first = 1.33 * bent + 0.5 * hypot(*(deviations(stage, teeth)[2] for teeth in TEETH))
    uneven = spread(0.85 * first + wrong.misaligned, 0.85 * stiffness, mean)
    across = overlap / 2 * (0.9 + 0.4 * stiffness * 0.925 * PITCH / (mean * uneven))
    across = np.clip(across, 1.0, None)
    slender = 2.25 * MODULE / stage.width
    root = load * dynamic * (1 + 1.5 * (sharing - 1)) / MODULE * uneven ** (1 / (1 + slender + slender**2))
    root = root * np.minimum(across, overlap / (0.25 * overlap + 0.75)) * (0.25 + 0.75 / overlap)
    root = root * (1 + tooth_stiffness(stage, load) * wrong.relief / load)
    contact = pressure(stage, loaded, mean * uneven * np.minimum(across, 3 / (4 - overlap)))
    forms = [float(np.prod(root_factors(z, x))) for z, x in zip(TEETH, stage.shifts, strict=True)]
    return {"root_stress_sun": root * forms[0], "root_stress_planet": root * forms[1], "contact_stress": contact}


def pressure(stage: Stage, loaded: Loaded, line_load: Array) -> Array:
    """Hertzian pressure of both flanks where the sun begins to carry alone, after Z_epsilon of the contact ratio."""
    pair = pair_of(stage, loaded.apart)
    inner = pair.outer[0] - pi * MODULE * cos(ANGLE)  # radius of curvature of the sun
    middle = BASE[0] * np.tan(pair.angle)
    there = np.minimum(inner * (pair.path - inner), middle * (pair.path - middle)) / pair.path
    normal = line_load / cos(ANGLE) * (4 - pair.overlap) / 3
    return np.asarray(np.sqrt(normal / there * YOUNG / (2 * pi * (1 - POISSON**2))))
