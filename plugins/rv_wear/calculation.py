"""Backlash at the output, and the whole way from the reducer to forces, wear and backlash."""

import numpy as np

from rv_wear.quantities import Reducer, Wear
from rv_wear.wear import worn
from truing import Float

# Backlash at the output: equation 21 with the sixteen factors of Table 2, all to first order

ECCENTRICITY_SHARE = 1.6e-4  # of factor 14: the normal stands across the crank, so only the printed index is left


def backlash_of(reducer: Reducer, felt_wear: Float) -> dict[str, Float]:
    """The backlash by its results: gaps between disc and pins by what opens them, m, its four shares and the sum, rad.

    ``felt_wear`` (m) acts like an equidistant modification on both flanks.
    """
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    root = np.sqrt(1.0 - short_width**2)
    arm = reducer.eccentricity * (reducer.pin_count - 1)
    involute = 2.0 * np.sin(reducer.pressure_angle) * (reducer.gear_runout + reducer.centre_distance_error)
    involute = (involute - reducer.base_tangent_error) / (reducer.sun_radius * reducer.total_ratio)
    ground = 2.0 * (reducer.equidistant_modification + reducer.equidistant_error) - 2.0 * root * (
        reducer.shift_modification + reducer.shift_error
    )
    pins = (
        2.0 * root * reducer.pin_circle_error
        - 2.0 * reducer.pin_radius_error
        + reducer.pin_fit_clearance
        + 2.0 * short_width * reducer.pin_position_error
        - reducer.runout_gap
    )
    disc = (
        0.5 * reducer.disc_runout
        - short_width * reducer.disc_pitch_error
        + 2.0 * root * ECCENTRICITY_SHARE * reducer.eccentricity_error
    )
    gearing, wear = (ground + pins + disc) / arm, 2.0 * felt_wear / arm
    bearing = reducer.bearing_clearance / reducer.centre_distance
    return {
        "backlash_involute": involute, "gap_ground": ground, "gap_pins": pins, "gap_disc": disc,
        "backlash_gearing": gearing, "backlash_of_wear": wear, "backlash_bearing": bearing,
        "backlash": involute + gearing + wear + bearing,
    }  # fmt: skip


def rv_wear(reducer: Reducer) -> Wear:
    """Forces, wear and backlash of one reducer or of a batch; every Float is a number or an array (n,), SI."""
    found = worn(reducer)
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    root = np.sqrt(1.0 - short_width**2)
    radial_clearance = reducer.equidistant_modification - reducer.shift_modification
    return Wear(
        short_width=short_width,
        root=root,
        radial_clearance=radial_clearance,
        equidistant_high=radial_clearance / (1.0 - root),
        **found,
        **backlash_of(reducer, found["backlash_wear"]),
    )
