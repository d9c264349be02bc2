"""Sun and planet of a reducer as they come from the workshop: their stresses after ISO 6336, and what raises them.

Nothing of the plugin is imported: geometry and factors are those of ``published/rv_gearing_by_hand.py``, plain floats
after the standards, method B (face load method C). Lengths are mm, forces N, stresses MPa, deviations um, speeds r/min.
What an effect does is not the formula of the effect: load is spread over a face strip by strip, a vibration is solved
as a complex amplitude, and two planets share a force as springs of which one touches first.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, hypot, radians, sqrt

import numpy as np

from hidden_effects.rows import Array, halved
from published import rv_gearing_by_hand as standards

SUN, PLANET, PINS = 20, 55, 40
MODULE, ANGLE = 1.25, radians(20)
APPLICATION, SHARING = 1.25, 1.10
YOUNG, POISSON = 206e3, 0.3
STRIPS = 200  # of the face
DRAWING: standards.Case = {
    "m": MODULE, "beta": 0.0, "alpha": 20.0, "z": (SUN, PLANET), "ha": 1.0, "hf": 1.25, "rho_f": 0.38, "q": (0.0, 0.0),
    "np": 2, "KA": APPLICATION, "KHp": SHARING, "Q": 6, "Ca": 0.0, "form": "crowned", "nu40": 100.0, "Rz": (3.0, 3.0),
    "E": (YOUNG, YOUNG), "nu": (POISSON, POISSON), "rho": 7850.0, "sH": (1500.0, 1500.0), "material": "case_hardened",
}  # fmt: skip


@dataclass(frozen=True)
class Stage:
    """One machine: its face width (mm), shifts in modules and bearing efficiency, as they came from the workshop."""

    width: float = 12.0
    shift_sun: float = 0.0
    shift_planet: float = 0.0
    bearing: float = 0.99

    def rated(self, apart: float = 0.0, speed: float = 0.0) -> standards.Case:
        """The pair as the standards take it, its centres so many mm farther apart than without play."""
        shifts = (self.shift_sun, self.shift_planet)
        return {**DRAWING, "b": self.width, "x": shifts, "apart": max(apart, 0.0), "n_rel": speed}


@lru_cache(maxsize=1024)
def pair_of(stage: Stage, apart: float = 0.0) -> standards.Case:
    """Geometry of the pair."""
    return standards.geometry(stage.rated(apart))


def play_between(stage: Stage, apart: Array) -> Array:
    """What the teeth leave of the pitch, along the line of action, um; ``apart`` in mm."""
    return np.array([1e3 * pair_of(stage, float(each))["backlash"] for each in apart])


@dataclass(frozen=True)
class Standard:
    """What the standards say of every row, arrays (n,), um, N/(mm um).

    Contact ratio, stiffness of a tooth and of the mesh, K_V, and the pressure in MPa per root of N/mm.
    """

    overlap: Array
    tooth: Array
    mesh: Array
    dynamic: Array
    pressure: Array


def standard(stage: Stage, line_load: Array, speed: Array, apart: Array) -> Standard:
    """Ask the standards row by row: line loads in N/mm with the application factor, speeds in r/min."""
    rows = []
    for load, turning, gap in zip(line_load.tolist(), speed.tolist(), apart.tolist(), strict=True):
        case, pair = stage.rated(gap, turning), pair_of(stage, gap)
        stiff = standards.stiffness(case, pair, load)
        dynamic = standards.dynamic(case, pair, load, stiff, (0.925 * PITCH, 0.925 * PROFILE))
        z_eps = sqrt((4 - pair["eps_a"]) / 3)
        z = standards.contact(case, pair, 1.0, z_eps)
        ratio = (pair["u"] + 1) / pair["u"] / pair["d"][0]
        rows.append((pair["eps_a"], *stiff, dynamic["K_V"], z["Z_B"] * z["Z_H"] * z["Z_E"] * z_eps * sqrt(ratio)))
    return Standard(*np.array(rows).T)


PITCH, PROFILE, _ = standards.deviations(Stage().rated(), MODULE * PLANET)
PITCH *= cos(ANGLE)


@lru_cache(maxsize=64)
def root_factor(stage: Stage, gear: int) -> float:
    """Y_Fa Y_Sa of the sun (0) or the planet (1), the load at the tip."""
    form, notch, _ = standards.root(stage.rated(), pair_of(stage), gear, tip=True)
    return form * notch


def slopes(stage: Stage) -> list[float]:
    """Helix deviations of both gears, um."""
    return [standards.deviations(stage.rated(), MODULE * teeth)[2] for teeth in (SUN, PLANET)]


# Stresses, and what raises them


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
