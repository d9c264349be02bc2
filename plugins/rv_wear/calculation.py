"""Backlash at the output, and the whole way from the reducer to forces, wear and backlash."""

from dataclasses import dataclass

import numpy as np

from rv_wear.quantities import Reducer, Wear
from rv_wear.wear import Worn, worn
from truing import Float

# Backlash at the output: equation 21 with the sixteen factors of Table 2, all to first order

ECCENTRICITY_SHARE = 1.6e-4  # of factor 14: the normal stands across the crank, so only the printed index is left


@dataclass(frozen=True)
class Shares:
    """Gaps between disc and pins by what opens them, m, and backlash by where it comes from, rad."""

    ground: Float
    pins: Float
    disc: Float
    involute: Float
    gearing: Float
    wear: Float
    bearing: Float


def backlash_of(reducer: Reducer, felt_wear: Float) -> Shares:
    """The four shares of the backlash; ``felt_wear`` (m) acts like an equidistant modification on both flanks."""
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    root = np.sqrt(1.0 - short_width**2)
    arm = reducer.eccentricity * (reducer.pin_count - 1)
    involute = 2.0 * np.sin(reducer.pressure_angle) * (reducer.gear_runout + reducer.centre_distance_error)
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
    return Shares(
        ground=ground,
        pins=pins,
        disc=disc,
        involute=(involute - reducer.base_tangent_error) / (reducer.sun_radius * reducer.total_ratio),
        gearing=(ground + pins + disc) / arm,
        wear=2.0 * felt_wear / arm,
        bearing=reducer.bearing_clearance / reducer.centre_distance,
    )


# From the reducer to forces, wear and backlash; one call answers for thousands of designs and machines


def rv_wear(reducer: Reducer) -> Wear:
    """Forces, wear and backlash of one reducer or of a batch; every Float is a number or an array (n,), SI."""
    found: Worn = worn(reducer)
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    root = np.sqrt(1.0 - short_width**2)
    radial_clearance = reducer.equidistant_modification - reducer.shift_modification
    shares = backlash_of(reducer, found.felt)
    return Wear(
        short_width=short_width,
        root=root,
        radial_clearance=radial_clearance,
        equidistant_high=radial_clearance / (1.0 - root),
        equidistant_low=found.equidistant_low,
        disc_torque=found.disc_torque,
        start_force=found.start_force,
        max_force=found.max_force,
        approach=found.approach,
        largest_force=found.largest_force,
        loaded_pins=found.loaded_pins,
        max_pressure=found.max_pressure,
        mesh_period=found.mesh_period,
        coefficient=found.coefficient,
        max_wear=found.depth,
        wear_angle=found.angle,
        backlash_wear=found.felt,
        backlash_involute=shares.involute,
        gap_ground=shares.ground,
        gap_pins=shares.pins,
        gap_disc=shares.disc,
        backlash_gearing=shares.gearing,
        backlash_of_wear=shares.wear,
        backlash_bearing=shares.bearing,
        backlash=shares.involute + shares.gearing + shares.wear + shares.bearing,
    )
