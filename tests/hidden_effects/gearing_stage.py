"""Sun and planet of a reducer as they come from the workshop, and the standards' answer to them row by row.

Nothing of the plugin is imported: geometry and factors are those of ``published/rv_gearing_by_hand.py``, plain floats
after the standards. Lengths are mm, deviations along the line of action um.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, radians, sqrt

import numpy as np

from hidden_effects.rows import Array
from published import rv_gearing_by_hand as standards

SUN, PLANET, PINS = 20, 55, 40
MODULE, ANGLE = 1.25, radians(20)
APPLICATION, SHARING = 1.25, 1.10
YOUNG, POISSON = 206e3, 0.3
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
