"""What changes the clearance between disc, pins and bearings, and no flank: heat, runout, wear of the bearings."""

from dataclasses import replace

import numpy as np

from rv_wear.quantities import Reducer
from truing import Float

RATED_TORQUE = 3136.0  # N*m, of the paper
MILLION = 1e6
NOTHING = 1e-15  # m


def thermal_clearance(
    reducer: Reducer, *, expansion: Float, housing_temperature: Float, disc_temperature: Float
) -> Reducer:
    """Pins and their circle grow with the housing, the whole profile with the disc: only their difference is felt.

    A disc that is larger by a share is ground on a circle and with pins that are both larger by that share.
    """
    strain = expansion * (housing_temperature - disc_temperature)
    return replace(
        reducer,
        pin_circle_error=reducer.pin_circle_error + strain * reducer.pin_circle_radius,
        pin_radius_error=reducer.pin_radius_error + strain * reducer.pin_radius,
    )


def runout(reducer: Reducer, *, offset: Float, direction: Float, crank_angle: Float) -> Reducer:
    """The circle of the pins is off the axis of the output: of two opposite discs each stops one end of the play.

    Across the crank the offset turns one disc forward and the other back. Along the crank it moves the first contact
    away from the longest arm, which takes less. Equation R2 of the theory page; two discs, their cranks opposite.
    """
    across, along = (np.abs(offset * part(direction - crank_angle)) for part in (np.sin, np.cos))
    curve = _curve(reducer)
    place = along / np.maximum(np.maximum(2.0 * curve, along), NOTHING)
    return replace(reducer, runout_gap=reducer.runout_gap + 2.0 * (across + along * place - curve * place**2))


def _curve(reducer: Reducer) -> Float:
    """How fast the gap grows on both sides of the longest arm, m: over the square of (cos psi - K_1) / sin psi."""
    root = np.sqrt(1.0 - (reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius) ** 2)
    thinner = reducer.equidistant_modification + reducer.equidistant_error + 0.5 * reducer.pin_fit_clearance
    outward = reducer.shift_modification + reducer.shift_error - reducer.pin_circle_error
    return np.maximum(root * (thinner - reducer.pin_radius_error) - outward, 0.0) / (2.0 * root)


def bearing_wear(reducer: Reducer, *, wear: Float) -> Reducer:
    """The crank bearings gain clearance in proportion to their load and to the turns made, as Archard has it."""
    load = reducer.output_torque / RATED_TORQUE
    turns = reducer.output_speed * reducer.working_time
    return replace(reducer, bearing_clearance=reducer.bearing_clearance + wear * load * turns / MILLION)
