"""From the reducer to forces, wear and backlash; one call answers for thousands of designs and machines."""

import numpy as np

from rv_wear.answers import Wear
from rv_wear.backlash import backlash_of
from rv_wear.quantities import Reducer
from rv_wear.wear import Worn, worn


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
