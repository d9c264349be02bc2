"""What the turning screw brings along: runout of roller and carrier, a roller that creeps along the screw."""

from dataclasses import replace

import numpy as np

from roller_screw_shift.answers import Meshing
from roller_screw_shift.loads import load_of
from roller_screw_shift.quantities import Pair
from truing import Float

TURN = 2.0 * np.pi


def with_wave(meshing: Meshing, angle: Float, cosine: Float, sine: Float) -> Meshing:
    """Return the results with one harmonic of an angle on the transmission error."""
    wave = cosine * np.cos(angle) + sine * np.sin(angle)
    return replace(meshing, transmission_error=meshing.transmission_error + wave)


def roller_runout(pair: Pair, meshing: Meshing, *, cosine: Float, sine: Float, screw_angle: Float) -> Meshing:
    """The teeth of the roller are off its axis: one wave per turn of the roller against the carrier."""
    return with_wave(meshing, load_of(pair).roller_order * screw_angle, cosine, sine)


def carrier_runout(pair: Pair, meshing: Meshing, *, cosine: Float, sine: Float, screw_angle: Float) -> Meshing:
    """The carrier is off the axis of the ring: one wave per turn of the carrier."""
    return with_wave(meshing, load_of(pair).carrier_order * screw_angle, cosine, sine)


def axial_migration(pair: Pair, meshing: Meshing, *, mismatch: Float, screw_angle: Float) -> Meshing:
    """Teeth and threads do not keep the same ratio: the roller creeps by a share of the lead with every turn."""
    creep = mismatch * pair.lead * screw_angle / TURN
    return replace(meshing, axial_shift=meshing.axial_shift + creep)
