"""How warm the flanks get where they slide on one another."""

from dataclasses import replace

import numpy as np

from gear_geometry.pairs import transverse_angle, working_angle
from rv_gearing.answers import Strength
from rv_gearing.loads import load_of, reference_radii
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
    rise = friction * flash_of(stage)
    return replace(strength, flank_temperature=strength.flank_temperature + rise)


def flash_of(stage: Gearing) -> Float:
    """Return the flash temperature per coefficient of friction, K: 1.11 w |v_1^1/2 - v_2^1/2| / ((2 b_H)^1/2 B_M).

    Transverse section, both gears of steel; w is the line load along the normal with the application factor alone, v
    the speeds of the flanks along themselves. Reference: Blok 1937, ISO/TS 6336-20.
    """
    load = load_of(stage)
    speed = TURN * load.mesh_speed
    inward = np.cos(transverse_angle(stage.pressure_angle, stage.helix_angle))
    force = load.line_load / inward
    found = []
    for sun, planet in ends_of_path(stage):
        width = 2.0 * half_width(stage, force, sun * planet / (sun + planet))
        slip = np.abs(np.sqrt(speed * sun) - np.sqrt(speed * load.sun / load.planet * planet))
        found.append(BLOK * force * slip / (np.sqrt(width) * CONTACT_COEFFICIENT))
    return np.maximum(found[0], found[1])


def ends_of_path(stage: Gearing) -> tuple[tuple[Float, Float], tuple[Float, Float]]:
    """Return the radii of curvature of sun and planet, m, where contact begins and where it ends."""
    load = load_of(stage)
    start = transverse_angle(stage.pressure_angle, stage.helix_angle)
    shifts = (stage.sun.shift + stage.planet.shift) / (load.sun + load.planet)
    whole = (load.base_radii[0] + load.base_radii[1]) * np.tan(working_angle(shifts, stage.pressure_angle, start))
    outer = [
        np.sqrt((radius + stage.module * (stage.addendum + gear.shift)) ** 2 - base**2)
        for radius, base, gear in zip(
            reference_radii(stage, load.sun, load.planet), load.base_radii, (stage.sun, stage.planet), strict=True
        )
    ]
    return (np.maximum(whole - outer[1], 0.0), outer[1]), (outer[0], np.maximum(whole - outer[0], 0.0))


def half_width(stage: Gearing, force: Float, radius: Float) -> Float:
    """Return the Hertzian half width, m, under a line load (N/m), at this radius of both flanks together."""
    soft = sum((1.0 - gear.poisson_ratio**2) / gear.young_modulus for gear in (stage.sun, stage.planet))
    return np.sqrt(4.0 * force * radius * soft / np.pi)
