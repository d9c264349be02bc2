"""A platform scale: what does it show when standard weights are put on? A beam that bends, and gauges on it."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting

CAPACITY = 100.0
"""Largest load, kg."""


@inputs
class Scale:
    """The beam, its gauges, and what stands on the platform."""

    load: Float = given(50.0, "kg", symbol="m", note="standard weights on the platform", at_least=0)
    gravity: Float = given(9.81, "m/s^2", symbol="g", note="acceleration of fall", above=0)
    arm: Float = given(40.0, "mm", symbol="a", note="lever of the load at the gauges", above=0)
    width: Float = given(30.0, "mm", symbol="b", note="width of the beam", above=0)
    thickness: Float = given(12.0, "mm", symbol="t", note="thickness of the beam at the gauges", above=0)
    modulus: Float = given(71.0, "GPa", symbol="E", note="Young's modulus", source="aluminium 2024", above=0)
    gauge_factor: Float = given(2.05, "", symbol="k", note="of the strain gauges, full bridge", above=0)
    span: Float = given(63.5516, "kg", symbol="S", note="load that is shown for 1 mV/V", above=0)
    zero: Float = given(0.0, "kg", symbol="m_0", note="what is shown without load")
    lagging: Float = given(0.0, "kg", symbol="m_C", note="part of the load that the beam does not feel yet")
    shunted: Float = given(0.0, "kg", symbol="m_S", note="part of the load that runs past the beam")
    rubbed: Float = given(0.0, "kg", symbol="m_R", note="part of the load that friction keeps")
    cornered: Float = given(0.0, "", symbol="e", note="share that is shown more because the load is off the centre")
    bend: Float = given(0.0, "", symbol="n", note="share of the capacity that is shown more at half of it")


@results
class Shown:
    """What the beam and the display show."""

    carried: Float = found("kg", symbol="m_B", note="load of the beam", formula="load - lagging - shunted - rubbed")
    strain: Float = found("um/m", formula="6 * carried * gravity * arm / (modulus * width * thickness**2)")
    signal: Float = found("mV/V", symbol="U", note="signal of the bridge", formula="gauge_factor * strain")
    reading: Float = found("kg", symbol="m_A", note="what the display shows", method="span, zero, and what is off")


def weighing_scale(scale: Scale) -> Shown:
    """A bending beam with a full bridge; load and signal are in proportion."""
    carried = scale.load - scale.lagging - scale.shunted - scale.rubbed
    strain = 6 * carried * scale.gravity * scale.arm / (scale.modulus * scale.width * scale.thickness**2)
    signal = scale.gauge_factor * strain
    straight = 1e3 * signal * scale.span
    used = scale.load / CAPACITY
    bent = 4 * scale.bend * CAPACITY * used * (1 - used)
    return Shown(
        carried=carried,
        strain=strain,
        signal=signal,
        reading=straight * (1 + scale.cornered) + bent + scale.zero,
    )


HELD = Condition("held", "s", note="time since the load was last changed")
PREVIOUS = Condition("previous_load", "kg", note="load before it was last changed")
OFF_CENTRE = Condition("off_centre", "mm", note="place of the load along the platform, from its centre")
RISING = Condition("rising", "", derived="direction of load", note="+1 after weights were put on, -1 after taken off")
PLACE = Condition("platform_temperature", "degC", reference=20, note="thermometer at the beam")


def creep(scale: Scale, *, share: Float, time_constant: Float, held: Float, previous_load: Float) -> Scale:
    """Beam, glue and gauges give way slowly: a share of each change of load is felt late."""
    late = share * (scale.load - previous_load) * np.exp(-held / time_constant)
    return replace(scale, lagging=scale.lagging + late)


def touching_stop(scale: Scale, *, share: Float, touch: Float) -> Scale:
    """Dirt under the platform touches above some load, and carries a share of what is beyond."""
    return replace(scale, shunted=scale.shunted + share * np.maximum(scale.load - touch, 0.0))


def rubbing_guide(scale: Scale, *, mass: Float, rising: Float) -> Scale:
    """The platform rubs at its frame: it shows less after a rise of the load, and more after a fall."""
    return replace(scale, rubbed=scale.rubbed + mass * rising)


def corner_load(scale: Scale, *, per_length: Float, off_centre: Float) -> Scale:
    """The beam is not cut to parallel: it feels a load more on one side of the platform."""
    return replace(scale, cornered=scale.cornered + per_length * off_centre)


def curved_span(scale: Scale, *, share: Float) -> Scale:
    """The beam becomes stiffer, or softer, as it bends: the display is off in the middle of the range."""
    return replace(scale, bend=scale.bend + share)


def warm_span(scale: Scale, *, per_kelvin: Float, platform_temperature: Float) -> Scale:
    """The modulus falls as the beam warms up, and the span resistor does not follow."""
    return replace(scale, modulus=scale.modulus / (1 + per_kelvin * (platform_temperature - PLACE.zero)))


def sensor_offset(scale: Scale, base: Shown, *, reading: Float) -> Shown:
    """The display was set to zero with something on the platform."""
    return replace(base, reading=base.reading + reading)


WEIGHING_SCALE = Model(
    name="weighing_scale",
    title="Platform scale",
    function=weighing_scale,
    errors=[
        Tolerance("gauge_factor", normal(sd="0.3 %"), why="batch of gauges"),
        Tolerance("zero", normal(sd="0.03 kg"), why="set before each test"),
        acting(
            creep,
            Unknown("share", -0.03, 0.03),
            Unknown("time_constant", 3, 300, "s"),
            needs=[HELD, PREVIOUS],
            acts_at_reference=True,
        ),
        acting(touching_stop, Unknown("share", 0, 0.2), Unknown("touch", 10, 95, "kg")),
        acting(rubbing_guide, Unknown("mass", 0, 1, "kg"), needs=[RISING]),
        acting(corner_load, Unknown("per_length", -2e-4, 2e-4, "1/mm"), needs=[OFF_CENTRE]),
        acting(curved_span, Unknown("share", -0.02, 0.02)),
        acting(warm_span, Unknown("per_kelvin", -2e-3, 2e-3, "1/K"), needs=[PLACE]),
        acting(sensor_offset, Unknown("reading", -2, 2, "kg"), on="reading"),
    ],
)
