"""Stresses of the first stage after ISO 6336:2006, method B (face load method C), and what raises them.

Nothing of the plugin is imported. Lengths are mm, forces N, stresses MPa, deviations um, speeds r/min. What an effect
does is not the formula of the effect: load is spread over a face strip by strip, a vibration is solved as a complex
amplitude, and two planets share a force as springs of which one touches first.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np

from hidden_effects.gearing_stage import APPLICATION, MODULE, PITCH, SHARING, SUN, Stage, root_factor, slopes, standard
from hidden_effects.rows import Array, halved

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


def swinging(speed: Array, resonance: float, damping: float) -> Array:
    """What a spring gives way, over the error that works it: spring and damper carry a mass as a road a car."""
    ratio = speed / resonance
    carried = (1 + 2j * damping * ratio) / (1 - ratio**2 + 2j * damping * ratio)
    return np.asarray(np.abs(carried - 1))


def spread(tilted: Array, stiffness: Array, line_load: Array) -> Array:
    """Largest over mean load of a face, one end of which lags by ``tilted`` um: strips of springs that only push."""
    gaps = np.abs(tilted)[:, None] * (np.arange(STRIPS) + 0.5) / STRIPS

    def carries_more(way: Array) -> Array:
        return np.asarray(stiffness * np.mean(np.maximum(way[:, None] - gaps, 0.0), axis=1) > line_load)

    way = halved(carries_more, np.zeros(len(tilted)), np.abs(tilted) + 2 * line_load / stiffness)
    return np.asarray(stiffness * way / line_load)


def touched(share: Array) -> Array:
    """Over which share of its width a crowned face touches, at a share of the load that makes its ends touch.

    Strips of springs that only push, behind a parabola that stands back by 1 at both ends.
    """
    gaps = ((np.arange(STRIPS) + 0.5) / STRIPS) ** 2

    def carries_more(way: Array) -> Array:
        return np.asarray(np.mean(np.maximum(way[:, None] - gaps, 0.0), axis=1) / np.mean(1 - gaps) > share)

    return np.asarray(np.minimum(np.sqrt(halved(carries_more, np.zeros(len(share)), 1 + share)), 1.0))


def of_first_planet(lead: float, stiffness: Array, force: Array) -> Array:
    """Force on the planet that touches first over the mean of two, which lead and lag by ``lead`` um: two springs."""

    def carry_more(way: Array) -> Array:
        return np.asarray(stiffness * (np.maximum(way + lead, 0.0) + np.maximum(way - lead, 0.0)) > 2 * force)

    way = halved(carry_more, np.full(len(force), -abs(lead)), abs(lead) + 2 * force / stiffness)
    return np.asarray(stiffness * (way + lead) / force)


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
    at = standard(stage, load, loaded.speed, loaded.apart)
    dynamic = at.dynamic + wrong.shaken
    sharing = np.minimum(SHARING - 1 + of_first_planet(wrong.lead, at.mesh * width, loaded.force), 2.0)
    mean = load * dynamic * sharing
    bent = 0.023 * (stage.width / (MODULE * SUN)) ** 2 * mean
    first = 1.33 * bent + 0.5 * hypot(*slopes(stage))
    uneven = spread(0.85 * first + wrong.misaligned, 0.85 * at.mesh, mean)
    across = np.maximum(at.overlap / 2 * (0.9 + 0.4 * at.mesh * 0.925 * PITCH / (mean * uneven)), 1.0)
    slender = 2.25 * MODULE / stage.width
    root = load * dynamic * (1 + 1.5 * (sharing - 1)) / MODULE * uneven ** (1 / (1 + slender + slender**2))
    root = root * np.minimum(across, at.overlap / (0.25 * at.overlap + 0.75)) * (0.25 + 0.75 / at.overlap)
    root = root * (1 + at.tooth * wrong.relief / load)
    return {
        "root_stress_sun": root * root_factor(stage, 0),
        "root_stress_planet": root * root_factor(stage, 1),
        "contact_stress": at.pressure * np.sqrt(mean * uneven * np.minimum(across, 3 / (4 - at.overlap))),
    }
