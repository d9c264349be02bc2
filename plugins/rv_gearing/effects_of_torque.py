"""What torque and time bring into the transmission error and the backlash: twist, play, deflection of teeth, wear."""

from dataclasses import replace

import numpy as np

from rv_gearing.answers import Strength
from rv_gearing.effects_of_rotation import with_error
from rv_gearing.loads import load_of
from rv_gearing.quantities import Gearing
from truing import Float


def wind_up(stage: Gearing, strength: Strength, *, compliance: Float) -> Strength:
    """The shaft of the sun twists in proportion to its torque, to the side to which it turns."""
    load = load_of(stage)
    return with_error(strength, compliance * load.sun_torque * load.direction)


def lost_motion(stage: Gearing, strength: Strength, *, play: Float, torque_scale: Float) -> Strength:
    """The torque takes up the play to one side or the other; about zero torque it does so gradually.

    At ``torque_scale`` of the output 76 % (tanh 1) of half the play is taken up.
    """
    load = load_of(stage)
    torque = load.direction * load.sun_torque * load.ratio * load.efficiency
    moved = with_error(strength, 0.5 * play * np.tanh(torque / torque_scale))
    return replace(moved, backlash=strength.backlash + play)


def wear_drift(stage: Gearing, strength: Strength, *, rate: Float, time: Float) -> Strength:
    """Every loaded flank loses a depth in proportion to the time; torque lays the teeth on one flank or the other."""
    depth = rate * time
    moved = with_error(strength, load_of(stage).direction * depth)
    return replace(moved, backlash=strength.backlash + 2.0 * depth)


def mesh_stiffening(stage: Gearing, strength: Strength, *, share: Float) -> Strength:
    """Teeth give way under their line load; below 100 N/mm they are softer, so the first newtons move them most.

    At a share of 1 by the line load with the application factor over the mesh stiffness of the rating.
    """
    load = load_of(stage)
    deflection = strength.duty.line_load / strength.stiffness.mesh_stiffness
    return with_error(strength, share * load.direction * deflection)
