"""How warm the flanks get where they slide on one another."""

from dataclasses import replace

import numpy as np

from rv_gearing.answers import Strength
from rv_gearing.quantities import Gearing
from truing import Float

BLOK = 1.11  # for the heat of a Hertzian contact over its full width
CONTACT_COEFFICIENT = 13784.0  # N/(m s^0.5 K) of steel: root of 50 W/(m K) times 3.8 MJ/(m³ K)
TURN = 2.0 * np.pi


def flash_temperature(stage: Gearing, strength: Strength, *, friction: Float) -> Strength:
    """The flanks are warmer than the oil by the flash of that end of the path of contact where it is the greater.

    Every tooth is taken to carry the whole line load at the ends of its path, so the friction that is found is that of
    a mesh in which the second pair of teeth does not help.
    """
    rise = friction * flash_of(stage, strength)
    return replace(strength, flank_temperature=strength.flank_temperature + rise)


def flash_of(stage: Gearing, strength: Strength) -> Float:
    """Return the flash temperature per coefficient of friction, K: 1.11 w |v_1^1/2 - v_2^1/2| / ((2 b_H)^1/2 B_M).

    Transverse section, both gears of steel; w is the line load along the normal with the application factor alone, v
    the speeds of the flanks along themselves. Reference: Blok 1937, ISO/TS 6336-20.
    """
    speed = TURN * strength.duty.mesh_speed
    force = strength.duty.line_load / np.cos(strength.mesh.transverse_angle)
    found: list[Float] = []
    for sun, planet in ends_of_path(strength):
        width = 2.0 * half_width(stage, force, sun * planet / (sun + planet))
        slip = np.abs(np.sqrt(speed * sun) - np.sqrt(speed * planet / strength.mesh.tooth_ratio))
        found.append(BLOK * force * slip / (np.sqrt(width) * CONTACT_COEFFICIENT))
    return np.maximum(found[0], found[1])


def ends_of_path(strength: Strength) -> tuple[tuple[Float, Float], tuple[Float, Float]]:
    """Return the radii of curvature of sun and planet, m, where contact begins and where it ends."""
    sun, planet = strength.sun, strength.planet
    tips = [0.5 * gear.size.base_diameter * np.tan(gear.size.tip_angle) for gear in (sun, planet)]
    return (np.maximum(sun.size.start_curvature, 0.0), tips[1]), (tips[0], np.maximum(planet.size.start_curvature, 0.0))


def half_width(stage: Gearing, force: Float, radius: Float) -> Float:
    """Return the Hertzian half width, m, under a line load (N/m), at this radius of both flanks together."""
    soft = sum((1.0 - gear.poisson_ratio**2) / gear.young_modulus for gear in (stage.sun, stage.planet))
    return np.sqrt(4.0 * force * radius * soft / np.pi)
