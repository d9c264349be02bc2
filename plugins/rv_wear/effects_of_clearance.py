"""What changes the clearance between disc, pins and bearings, and no flank: heat, runout, wear of the bearings."""

from dataclasses import replace

import numpy as np

from rv_wear.quantities import Reducer
from truing import Float

RATED_TORQUE = 3136.0  # N*m, of the paper
MILLION = 1e6


def thermal_clearance(
    reducer: Reducer, *, expansion: Float, housing_temperature: Float, disc_temperature: Float
) -> Reducer:
    """The circle of the pins grows with the housing, the profile with the disc: only their difference is felt."""
    growth = expansion * reducer.pin_circle_radius * (housing_temperature - disc_temperature)
    return replace(reducer, pin_circle_error=reducer.pin_circle_error + growth)


def runout(reducer: Reducer, *, cosine: Float, sine: Float, output_angle: Float) -> Reducer:
    """The circle of the pins is out of its centre: it seems larger or smaller, once per turn of the output."""
    seems = cosine * np.cos(output_angle) + sine * np.sin(output_angle)
    return replace(reducer, pin_circle_error=reducer.pin_circle_error + seems)


def bearing_wear(reducer: Reducer, *, wear: Float) -> Reducer:
    """The crank bearings gain clearance in proportion to their load and to the turns made, as Archard has it."""
    load = reducer.output_torque / RATED_TORQUE
    turns = reducer.output_speed * reducer.working_time
    return replace(reducer, bearing_clearance=reducer.bearing_clearance + wear * load * turns / MILLION)
