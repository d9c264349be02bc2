"""One rough pair by its definitions alone: single contacts, their number, and quadrature over their areas.

Nothing of the plugin is used: the critical area and the domain factor are roots found by bisection, load, stiffness and
area are integrals over the distribution of areas.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq


@dataclass(frozen=True)
class RoughPair:
    """A surface of dimension D and roughness G against a smooth one; ``pressure`` makes contacts elastic."""

    dimension: float
    roughness: float
    modulus: float = 1.0 / (2.0 * (1.0 - 0.3**2) / 206e9)
    hardness: float = 3e9
    pressure: float = 3e9
    density: float = 1.5

    def interference(self, area: float) -> float:
        """From the highest to the lowest point of a wave as long as two radii."""
        radius = np.sqrt(area / np.pi)
        waves = self.roughness ** (self.dimension - 2.0) * np.sqrt(np.log(self.density))
        return float(2.0 * waves * (2.0 * radius) ** (3.0 - self.dimension))

    def elastic_load(self, area: float) -> float:
        """Hertz, with the tip radius that a truncated area and its interference have."""
        depth = self.interference(area)
        tip = area / (2.0 * np.pi * depth)
        return float(4.0 / 3.0 * self.modulus * np.sqrt(tip) * depth**1.5)

    def contact_stiffness(self, area: float) -> float:
        """d load/d interference of Hertz, with a tip radius that stays."""
        depth = self.interference(area)
        return float(2.0 * self.modulus * np.sqrt(area / (2.0 * np.pi * depth)) * np.sqrt(depth))

    def following_stiffness(self, area: float) -> float:
        """The same with a tip radius that follows the area: both change with it."""
        step = 1e-5
        load = self.elastic_load(area * (1 + step)) - self.elastic_load(area * (1 - step))
        return load / (self.interference(area * (1 + step)) - self.interference(area * (1 - step)))

    @cached_property
    def critical_area(self) -> float:
        """Where elastic load over area is the critical pressure."""
        return float(np.exp(brentq(lambda x: np.log(self.elastic_load(np.exp(x)) / np.exp(x) / self.pressure), -150, 0,
                                   xtol=1e-14, rtol=1e-14)))  # fmt: skip

    @cached_property
    def domain_factor(self) -> float:
        """The root of its equation, by bisection between 1 and 50."""
        profile = self.dimension - 1.0

        def off(psi: float) -> float:
            share = (2.0 - profile) / profile
            return float((psi ** ((2.0 - profile) / 2.0) - (1.0 + psi ** (-profile / 2.0)) ** -share) / share - 1.0)

        return float(brentq(off, 1.0001, 50.0, xtol=1e-14))

    def number(self, area: float, largest: float) -> float:
        """Contacts per area."""
        many = (self.dimension - 1.0) / 2.0 * self.domain_factor ** ((3.0 - self.dimension) / 2.0)
        return float(many * largest ** ((self.dimension - 1.0) / 2.0) * area ** (-(self.dimension + 1.0) / 2.0))

    def _small(self, largest: float) -> float:
        """Truncated area of the contacts up to the critical area: the integrand has a power at 0."""
        high, power = min(self.critical_area, largest), (1.0 - self.dimension) / 2.0

        def smooth(part: float) -> float:
            some = max(part, 1e-90)
            return some * high * self.number(some * high, largest) / some**power

        return float(high * quad(smooth, 0.0, 1.0, weight="alg", wvar=(power, 0.0), epsabs=0.0)[0])

    def _large(self, of_one: object, largest: float) -> float:
        """What all elastic contacts give together."""
        if largest <= self.critical_area:
            return 0.0
        return float(quad(
            lambda x: of_one(np.exp(x)) * self.number(np.exp(x), largest) * np.exp(x),  # type: ignore[operator]
            np.log(self.critical_area), np.log(largest), epsabs=0.0, epsrel=1e-12, limit=200,
        )[0])  # fmt: skip

    def load(self, largest: float) -> float:
        """Normal load, N, with this largest truncated area."""
        return self.hardness * self._small(largest) + self._large(self.elastic_load, largest)

    def stiffness(self, largest: float, *, following: bool = False) -> float:
        """Normal stiffness, N/m, of the elastic contacts."""
        return self._large(self.following_stiffness if following else self.contact_stiffness, largest)

    def areas(self, largest: float) -> tuple[float, float]:
        """Truncated area, and the real one: of an elastic contact the half."""
        plastic, elastic = self._small(largest), self._large(lambda area: area, largest)
        return plastic + elastic, plastic + elastic / 2.0
