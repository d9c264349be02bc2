"""Rough flanks and the mesh of a harmonic drive from the equations of a single contact, added up in numbers.

Nothing of the plugin is imported: the integrals over the contacts are sums on a fine grid, loads and areas are read
off tables, the torsion is the area below the compliance. Lengths m, forces N, angles rad.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import brentq

from hidden_effects.rows import Array

DENSITY, HARDNESS, MODULUS, POISSON = 1.5, 3e9, 206e9, 0.3
RADIUS = 25.4e-3 * np.cos(np.radians(20))  # lever of the normal forces
PAIRS, FIRST_TORQUE = 60, 2e-2
AREA = 10e-3 * 0.4e-3  # of a flank
GRID = 1500


@dataclass(frozen=True)
class Table:
    """Normal load, stiffness and real area of one pair at rising largest contacts."""

    load: Array
    stiffness: Array
    area: Array

    def at(self, load: Array) -> tuple[Array, Array]:
        """Stiffness, N/m, and area, m^2, under loads."""
        place = np.log(np.maximum(load, self.load[0]))
        return (
            np.exp(np.interp(place, np.log(self.load), np.log(self.stiffness))),
            np.exp(np.interp(place, np.log(self.load), np.log(self.area))),
        )


def domain_factor(profile: float) -> float:
    """The factor of the area distribution that keeps the area of all contacts, by halving."""

    def left(psi: float) -> float:
        rest = (2 - profile) / profile
        return float((psi ** ((2 - profile) / 2) - (1 + psi ** (-profile / 2)) ** -rest) / rest - 1)

    return float(brentq(left, 1.0, 50.0, xtol=1e-12))


@cache
def table(dimension: float, roughness: float, modulus: float) -> Table:
    """Add up all contacts of a pair, from those too small to be elastic to the largest."""

    def force(area: Array) -> tuple[Array, Array]:
        depth = (
            2 * roughness ** (dimension - 2) * np.sqrt(np.log(DENSITY)) * (2 * np.sqrt(area / np.pi)) ** (3 - dimension)
        )
        tip = area / (2 * np.pi * depth)
        return 4 / 3 * modulus * np.sqrt(tip) * depth**1.5, 2 * modulus * np.sqrt(tip * depth)

    def excess(logarithm: float) -> float:
        area = np.exp(np.array(logarithm))
        return float(np.log(force(area)[0] / (HARDNESS * area)))

    critical = float(np.exp(brentq(excess, np.log(1e-30), np.log(1e-4))))
    areas = np.geomspace(critical * (1 + 1e-9), 1e-5, GRID)
    elastic, spring = force(areas)
    many = 0.5 * (dimension - 1) * domain_factor(dimension - 1) ** ((3 - dimension) / 2)
    number = many * areas ** (-(dimension + 1) / 2)  # times the largest area to a power
    small = np.geomspace(critical * 1e-30, critical, 4 * GRID)
    plastic = np.trapezoid(HARDNESS * many * small ** ((3 - dimension) / 2), np.log(small))
    all_of_it = np.trapezoid(many * small ** ((3 - dimension) / 2), np.log(small))
    logs, scale = np.log(areas), areas ** ((dimension - 1) / 2)

    def added(what: Array) -> Array:
        return np.asarray(cumulative_trapezoid(what * number * areas, logs, initial=0.0))

    load = scale * (plastic + added(elastic))
    stiffness, area = scale * added(spring), scale * (all_of_it + added(areas))
    return Table(load[1:], stiffness[1:], area[1:])


def shares() -> Array:
    """What each pair carries of the whole: the square of a cosine over two arcs, pairs in the middle of equal parts."""
    half = PAIRS // 2
    places = (2 * np.arange(half) + 1) / half - 1
    weights = np.cos(np.pi * places / 2) ** 2
    return np.asarray(np.concatenate([weights, weights]) / (2 * weights.sum()))


@dataclass(frozen=True)
class Flanks:
    """Roughness and elasticity of both flanks, and what stands beside or behind a pair of them."""

    dimension: float = 2.5
    roughness: float = 1e-9
    modulus: float = MODULUS
    pairs: float = 1.0
    """Pairs over those of the design."""
    film: float = 0.0
    """Modulus of the film times flank over its thickness, N/m, of a mean pair under 25 N m."""
    tooth: float = np.inf

    def stiffness(self, torque: Array) -> Array:
        """Of the mesh, N m/rad."""
        equivalent = self.modulus / (2 * (1 - POISSON**2))
        loads = np.abs(np.atleast_1d(torque))[:, None] * shares() / (RADIUS * self.pairs)
        spring, area = table(self.dimension, self.roughness, equivalent).at(loads)
        thinner = (loads / RADIUS + 1e-12) ** 0.07 / np.mean((25 * shares() / RADIUS**2) ** 0.07)
        spring = spring + self.film * thinner * (1 - area / 2 / AREA)
        return np.asarray(RADIUS**2 * self.pairs * (1 / (1 / spring + 1 / self.tooth)).sum(axis=1))


def torsion_of(compliance: Array, torques: Array) -> Array:
    """Integral of the compliance over a rising torque."""
    return np.asarray(cumulative_trapezoid(compliance, torques, initial=0.0))


@cache
def torques() -> Array:
    """Torques at which the mesh is looked at, from the first one on."""
    return np.geomspace(FIRST_TORQUE, 80.0, 600)
