"""What is in the reading of the backlash and not in the play of the parts: torque, friction and where it is read."""

from dataclasses import replace

import numpy as np

from rv_wear.answers import Wear
from rv_wear.quantities import Reducer
from truing import Float


def pin_pass_ripple(
    reducer: Reducer,
    wear: Wear,
    *,
    disc_cosine: Float,
    disc_sine: Float,
    pin_cosine: Float,
    pin_sine: Float,
    output_angle: Float,
) -> Wear:
    """Every tooth of the disc, or every pin, passes once per turn of the output and leaves its own play."""
    teeth, pins = (reducer.pin_count - 1) * output_angle, reducer.pin_count * output_angle
    of_disc = disc_cosine * np.cos(teeth) + disc_sine * np.sin(teeth)
    of_pins = pin_cosine * np.cos(pins) + pin_sine * np.sin(pins)
    return replace(wear, backlash=wear.backlash + of_disc + of_pins)


def wind_up(reducer: Reducer, wear: Wear, *, compliance: Float, measuring_torque: Float) -> Wear:
    """The torque that turns the output to either side twists it, both ways, in proportion."""
    return replace(wear, backlash=wear.backlash + 2.0 * compliance * np.abs(measuring_torque))


def stiffening(reducer: Reducer, wear: Wear, *, twist: Float, torque_scale: Float, measuring_torque: Float) -> Wear:
    """Contacts that close under the measuring torque twist the output until all of them carry; no linear term."""
    return replace(wear, backlash=wear.backlash - twist * np.expm1(-np.abs(measuring_torque) / torque_scale))


def friction_hysteresis(reducer: Reducer, wear: Wear, *, lag: Float, direction: Float) -> Wear:
    """Friction holds the output back from where it would come to rest, to the side from which it came."""
    return replace(wear, backlash=wear.backlash + lag * direction)
