"""The contacts of a rough surface in reduced variables: all is a function of u = ln(a_L/a_c), of D, and of p_c/H.

a_L is the largest truncated area, a_c the critical one: smaller contacts are plastic, larger ones elastic. u < 0: all
contacts are plastic. Loads are in parts of that at u = 0, where the first contact turns elastic.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from truing import Float

LEAST_DIMENSION, MOST_DIMENSION = 2.05, 2.95  # exponents 2/(D-2) and 1/(3-D) run away beyond
STEPS = 12  # of Halley's iteration at most; two or three do
FINE = 3e-5  # a step as small leaves about its cube


@dataclass(frozen=True)
class ContactLaw:
    """Which law the contacts follow: dimension D of the surface, and the critical pressure in parts of the hardness.

    Both are numbers or arrays that meet the loads asked for.
    """

    dimension: Float
    pressure_ratio: Float

    @cached_property
    def bend(self) -> Float:
        """(5 - 2 D)/2, and never 0: the exponent by which the elastic load grows beside the plastic one."""
        exponent = 2.5 - np.asarray(self.dimension, dtype=float)
        return np.where(np.abs(exponent) < 1e-300, 1e-300, exponent)

    @cached_property
    def growth(self) -> Float:
        """(D - 1)/2, the exponent of the number of contacts."""
        return 0.5 * (np.asarray(self.dimension) - 1.0)

    @cached_property
    def elastic(self) -> Float:
        """(3 - D)/2 p_c/H, by which the elastic load begins."""
        return 0.5 * (3.0 - np.asarray(self.dimension)) * self.pressure_ratio

    @cached_property
    def decay(self) -> Float:
        """(D - 2)/2, the exponent of stiffness that is lost to plastic contacts."""
        return 0.5 * (np.asarray(self.dimension) - 2.0)


def domain_factor(dimension: Float) -> Float:
    """Return psi of the area distribution of contacts for a surface of dimension D, 2 < D < 3.

    It falls from ((1 + sqrt 5)/2)^2 at 2 to e - 1 at 3. Source: Wang and Komvopoulos 1994, equation solved by Newton.
    """
    profile = np.asarray(dimension, dtype=float) - 1.0
    rest = 2.0 - profile
    logarithm = np.log(2.618 - 1.235 * (profile - 1.0) + 0.335 * (profile - 1.0) ** 2)
    for _ in range(6):
        inverse = np.exp(-0.5 * profile * logarithm)
        grown, held = np.expm1(0.5 * rest * logarithm), np.expm1(-rest / profile * np.log1p(inverse))
        off = (grown - held) * profile - rest
        slope = 0.5 * rest * (profile * (grown + 1.0) - (held + 1.0) * profile * inverse / (1.0 + inverse))
        logarithm = logarithm - off / slope
    return np.exp(logarithm)


def elastic_sum(size: Float, law: ContactLaw) -> Float:
    """Return (x^((5-2D)/2) - 1)/(5 - 2D) at x = a_L/a_c, (ln x)/2 at D = 2.5; 0 where all contacts are plastic."""
    return 0.5 * np.expm1(law.bend * np.maximum(size, 0.0)) / law.bend


def load_logarithm(size: Float, law: ContactLaw) -> Float:
    """Return ln(F/F_c) at u."""
    above = np.maximum(size, 0.0)
    grown = np.log1p(law.elastic * np.expm1(law.bend * above) / law.bend)
    return np.where(np.asarray(size) > 0.0, law.growth * above + grown, size)


def load_slope(size: Float, law: ContactLaw) -> Float:
    """Return d ln F/d u."""
    above = np.maximum(size, 0.0)
    grown = np.expm1(law.bend * above)
    elastic = law.growth + law.elastic * (grown + 1.0) / (1.0 + law.elastic * grown / law.bend)
    return np.where(np.asarray(size) > 0.0, elastic, 1.0)


def size_of(load: Float, law: ContactLaw) -> Float:
    """Return u at ln(F/F_c); to about 1e-13.

    The logarithm of the load is a convex or a concave curve over u and rises everywhere, so the iteration, which is
    Newton's with the curvature known, closes in from one side.
    """
    wanted = np.asarray(load, dtype=float)
    sought = np.maximum(wanted, 0.0)
    size = np.array(sought / (law.growth + law.elastic / (1.0 + 0.25 * law.elastic * sought)))
    grown, part, step, other = (np.empty_like(size) for _ in range(4))  # every step writes into the same memory
    ratio = law.elastic / law.bend
    for _ in range(STEPS):
        np.expm1(np.multiply(law.bend, size, out=grown), out=grown)
        np.multiply(ratio, grown, out=part)
        added = np.multiply(law.elastic, np.add(grown, 1.0, out=grown), out=grown)
        added /= np.add(1.0, part, out=other)
        np.multiply(law.growth, size, out=step)
        step += np.log1p(part, out=part)
        step -= sought
        slope = np.add(law.growth, added, out=other)
        step /= slope
        np.multiply(0.5, step, out=part)
        part *= added
        part *= np.subtract(law.bend, added, out=added)
        part /= slope
        step /= np.subtract(1.0, part, out=part)
        np.maximum(np.subtract(size, step, out=size), 0.0, out=size)
        if not (np.abs(step, out=step) > FINE * (1.0 + size)).any():
            break
    return np.where(wanted > 0.0, size, wanted)


def stiffness_share(size: Float, law: ContactLaw) -> NDArray[np.float64]:
    """Return K/K_s at u, with K_s the stiffness that the contacts of a_L = a_c would have; 0 where all are plastic."""
    above = np.maximum(size, 0.0)
    return -np.exp(law.growth * above) * np.expm1(-law.decay * above)


def load_exponent(size: Float, law: ContactLaw) -> Float:
    """Return m = d ln K/d ln F at u; 0 where all contacts are plastic and there is no stiffness."""
    above = np.where(np.asarray(size) > 0.0, size, 1.0)
    stiffness = law.growth + law.decay / np.expm1(law.decay * above)
    return np.where(np.asarray(size) > 0.0, stiffness / load_slope(above, law), 0.0)


def area_shares(size: Float, law: ContactLaw) -> tuple[Float, NDArray[np.float64]]:
    """Return a_L/a_c, and the real area in parts of the truncated one.

    A plastic contact touches with its truncated area, an elastic one with half of it.
    """
    above = np.maximum(size, 0.0)
    real = 0.5 * (1.0 + np.exp(-0.5 * (3.0 - np.asarray(law.dimension)) * above))
    return np.exp(size), real


def touched_area(size: Float, law: ContactLaw) -> NDArray[np.float64]:
    """Return the real area at u in parts of the truncated one at a_L = a_c."""
    ratio, real = area_shares(size, law)
    return ratio * real
