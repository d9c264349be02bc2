"""What the angle of the sun brings into the transmission error: runouts, teeth, the output, and a miscount.

The orders of the gears count the turns of the sun against the carrier, those of the output the turns of the housing's
frame. Angles in rad, errors in m along the line of action.
"""

from dataclasses import replace

import numpy as np

from rv_gearing.answers import Strength
from rv_gearing.loads import Load, load_of
from rv_gearing.quantities import Gearing
from truing import Float


def wave(angle: Float, cosine: Float, sine: Float) -> Float:
    """Return one harmonic of an angle."""
    return cosine * np.cos(angle) + sine * np.sin(angle)


def relative_angle(load: Load, input_angle: Float) -> Float:
    """Return the angle of the sun against the carrier, which turns with the output."""
    return input_angle * (1.0 - 1.0 / load.ratio)


def with_error(strength: Strength, error: Float) -> Strength:
    """Return the results with so much more transmission error."""
    return replace(strength, transmission_error=strength.transmission_error + error)


def sun_runout(stage: Gearing, strength: Strength, *, cosine: Float, sine: Float, input_angle: Float) -> Strength:
    """The teeth of the sun are off its axis: one wave per turn against the carrier."""
    return with_error(strength, wave(relative_angle(load_of(stage), input_angle), cosine, sine))


def planet_runout(stage: Gearing, strength: Strength, *, cosine: Float, sine: Float, input_angle: Float) -> Strength:
    """The teeth of a planet are off its axis: one wave per turn of the planet, z1/z2 of the sun's."""
    load = load_of(stage)
    return with_error(strength, wave(relative_angle(load, input_angle) * load.sun / load.planet, cosine, sine))


def mesh_ripple(
    stage: Gearing,
    strength: Strength,
    *,
    cosine: Float,
    sine: Float,
    second_cosine: Float,
    second_sine: Float,
    input_angle: Float,
) -> Strength:
    """Every tooth of the sun passes once per turn and brings the error of its flank, and that of half its pitch."""
    load = load_of(stage)
    teeth = load.sun * relative_angle(load, input_angle)
    return with_error(strength, wave(teeth, cosine, sine) + wave(2.0 * teeth, second_cosine, second_sine))


def output_eccentricity(
    stage: Gearing,
    strength: Strength,
    *,
    cosine: Float,
    sine: Float,
    tooth_cosine: Float,
    tooth_sine: Float,
    input_angle: Float,
) -> Strength:
    """The output, or what it is measured on, is off its axis; and the teeth of the discs pass once per turn of it."""
    load = load_of(stage)
    output = input_angle / load.ratio
    of_teeth = wave((load.pins - 1.0) * output, tooth_cosine, tooth_sine)
    return with_error(strength, wave(output, cosine, sine) + of_teeth)


def ratio_drift(stage: Gearing, strength: Strength, *, miscount: Float, input_angle: Float) -> Strength:
    """The angles of input and output are counted in another ratio than that of the teeth: an error that adds up."""
    return with_error(strength, miscount * input_angle * load_of(stage).base_radii[0])
