"""Which groups are better: which teeth meet, how many kinds of planet a stage needs, and whether its planets share.

The paper calls some of its groups better "for accuracy of transmission and distribution of load", and gives no rule.
Read here: hunting teeth spread every error over every tooth, and planets that mesh in phase carry alike at any moment.
Derived on the theory page. A value is an array (groups,), numbers of teeth are whole.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rv_gearing.quantities import Gearing

Values = NDArray[np.float64]

HUNTING_IN_PHASE, HUNTING, IN_PHASE, NEITHER = 1.0, 2.0, 3.0, 4.0


@dataclass(frozen=True, kw_only=True)
class Preference:
    """Common factors of both meshes, kinds of planet, phases in which they mesh, and the preference: 1 is best."""

    common_first: "Values"
    common_second: "Values"
    planet_kinds: "Values"
    mesh_phases: "Values"
    preference: "Values"


def preference_of(stage: Gearing, sun: "Values", planet: "Values", pins: "Values") -> Preference:
    """Return what speaks for each group; the preference is NaN where neighbouring planets would touch."""
    planets = stage.planets
    first, second = np.gcd(_whole(sun), _whole(planet)), np.gcd(_whole(pins) - 1, _whole(pins))
    kinds = planets // np.gcd(_whole(sun + planet), planets)
    phases = planets // np.gcd(_whole(sun), planets)
    found = np.where(
        (first == 1) & (second == 1),
        np.where(phases == 1, HUNTING_IN_PHASE, HUNTING),
        np.where(phases == 1, IN_PHASE, NEITHER),
    )
    return Preference(
        common_first=first.astype(float), common_second=second.astype(float), planet_kinds=kinds.astype(float),
        mesh_phases=phases.astype(float), preference=np.where(_touching(stage, sun, planet), np.nan, found),
    )  # fmt: skip


def _whole(teeth: "Values") -> "NDArray[np.int64]":
    return np.rint(teeth).astype(np.int64)


def _touching(stage: Gearing, sun: "Values", planet: "Values") -> "NDArray[np.bool_]":
    """Where the tip circles of two neighbouring planets of one plane meet, without regard to backlash."""
    if stage.planets == 1:
        return np.zeros(len(sun), dtype=bool)
    apart = (sun + planet) / np.cos(stage.helix_angle) * np.sin(np.pi / stage.planets)  # in modules
    tip = planet / np.cos(stage.helix_angle) + 2.0 * (stage.addendum + stage.planet.shift)
    return np.asarray(apart <= tip)


def reason_of(common: float, phases: float, kinds: float, preference: float) -> str:
    """Say why a group has its preference."""
    teeth = "hunting teeth" if common == 1 else f"a tooth meets only one in {common:.0f} of the other gear"
    shares = "planets in phase" if phases == 1 else f"planets in {phases:.0f} phases"
    alike = "and alike" if kinds == 1 else f"and of {kinds:.0f} kinds"
    if np.isnan(preference):
        return "neighbouring planets would touch"
    return f"{'better: ' if preference == HUNTING_IN_PHASE else ''}{teeth}; {shares} {alike}"
