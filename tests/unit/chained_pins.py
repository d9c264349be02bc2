"""A plugin whose calculations call one another: a motor drives a shaft, the shaft twists, and a pin on it wears."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Dynamics,
    Effect,
    Float,
    Minimise,
    Model,
    Motion,
    Reliability,
    Require,
    Section,
    Sensitivity,
    Tolerance,
    Unknown,
    axis,
    feasible,
    found,
    from_model,
    given,
    hookimpl,
    inputs,
    normal,
    part,
    results,
    state,
    states,
)


@inputs
class Winding:
    """A part, so that names of parts are tried too."""

    resistance: Float = given(0.5, "ohm", above=0)
    current: Float = given(10.0, "A", above=0)


@inputs
class Motor:
    """What turns."""

    power: Float = given(2.0, "kW", symbol="P", above=0, note="power at the plug")
    speed: Float = given(1200.0, "rpm", symbol="n", above=0)
    loss: Float = given(0.0, "W", note="neutral 0: lost on the way")
    winding: Winding = part(Winding, index="w")


@results
class Turning:
    """What the motor gives."""

    shaft_power: Float = found("W", formula="power - loss")
    torque: Float = found("N*m", symbol="T", formula="shaft_power / (2 * pi * speed)", note="torque of the motor")
    heat_winding: Float = found("W", formula="resistance_winding * current_winding**2")
    hum: Float = found("W", formula="0.01 * power")


def motor(given_motor: Motor) -> Turning:
    """Turn power into torque; a motor that loses all of it stands still."""
    power = given_motor.power - given_motor.loss
    feasible(power > 0, "the motor loses all its power")
    return Turning(
        shaft_power=power, torque=power / (2 * np.pi * given_motor.speed),
        heat_winding=given_motor.winding.resistance * given_motor.winding.current**2, hum=0.01 * given_motor.power,
    )  # fmt: skip


def friction(given_motor: Motor, *, drag: Float, oil: Float) -> Motor:
    """Bearings take a torque of their own, less in warm oil."""
    return replace(
        given_motor, loss=given_motor.loss + drag * np.exp(-0.02 * (oil - OIL.zero)) * 2 * np.pi * given_motor.speed
    )


def rumble(_: Motor, base: Turning, *, size: Float) -> Turning:
    """A last term on a last result."""
    return replace(base, hum=base.hum + size)


def slipping(_: Motor, base: Turning, *, share: Float) -> Turning:
    """A coupling at the end of the motor slips: what comes out is less, and nothing of the motor itself changes."""
    return replace(base, torque=base.torque * (1 - share))


OIL = Condition("oil", "degC", reference=20)
MOTOR = Model(
    name="motor", title="A motor", function=motor,
    errors=[
        Tolerance("power", normal(sd="2 %")),
        Effect("friction", on_inputs=friction, unknowns=[Unknown("drag", 0, 10, "N*m")], needs=[OIL],
               acts_at_reference=True),
        Effect("rumble", on_results=rumble, unknowns=[Unknown("size", -50, 50, "W")]),
        Effect("slipping", on_results=slipping, unknowns=[Unknown("share", 0, 0.5, "")]),
    ],
    objectives=[Require("torque", at_most="40 N*m")],
    sheet=[Section("Torque", "shaft_power", "torque")],
)  # fmt: skip


@inputs
class Shaft:
    """What is twisted."""

    torque: Float = given(from_model("motor", speed="600 rpm").torque, "N*m", symbol="T_s", above=0)
    stiffness: Float = given(5.0, "kN*m", symbol="c", above=0, note="torque per angle")


@results
class Twist:
    """How far it is twisted."""

    angle: Float = found("rad", formula="torque / stiffness")
    torque_out: Float = found("N*m", formula="torque")


def shaft(given_shaft: Shaft) -> Twist:
    """Hooke's law."""
    return Twist(angle=given_shaft.torque / given_shaft.stiffness, torque_out=given_shaft.torque)


SHAFT = Model(name="shaft", title="A shaft", function=shaft, errors=[Tolerance("stiffness", normal(sd="1 %"))])


@inputs
class Peg:
    """What wears."""

    force: Float = given(100.0, "N", symbol="F", above=0)
    torque: Float = given(10.0, "N*m", above=0)
    radius: Float = given(50.0, "mm", above=0)
    angle: Float = given(0.001, "rad", note="by which it is turned")
    softness: Float = given(1.0, "nm/N", above=0)
    teeth: int = given(4)
    noise: Float = given(0.0, "W", note="heard, and nothing else")


@results
class Worn:
    """How far it wears."""

    load: Float = found("N", formula="force + torque / radius * (1 + angle)")
    depth: Float = found("um", formula="load * softness")


def peg(given_peg: Peg) -> Worn:
    """Wear grows with the load."""
    load = given_peg.force + given_peg.torque / given_peg.radius * (1 + given_peg.angle)
    return Worn(load=load, depth=load * given_peg.softness)


def bent(given_peg: Peg, *, force: Float) -> Peg:
    """It is pressed from the side, in proportion to the torque."""
    return replace(given_peg, force=given_peg.force + force * given_peg.torque / 10.0)


PEG = Model(
    name="peg", title="A peg", function=peg,
    errors=[
        Tolerance("radius", normal(sd="0.1 mm")),
        Tolerance("torque", normal(sd="5 %")),
        Effect("bent", on_inputs=bent, unknowns=[Unknown("force", -50, 50, "N")]),
    ],
    objectives=[Minimise("depth"), Require("load", at_most="1 kN", reliability=0.9)],
    studies=[Sensitivity(of="depth"), Reliability(draws=2000)],
    sheet=[Section("Wear", "load", "depth")],
)  # fmt: skip


@inputs
class Falling:
    """A flywheel that runs down."""

    times: Float = given((0.0, 1.0, 2.0), "s", along="times")
    speed: Float = given(10.0, "rad/s", above=0)
    brake: Float = given(1.0, "N*m", above=0)
    inertia: Float = given(2.0, "kg*m^2", above=0)


@results
class Fallen:
    """Its speed over time."""

    time: Float = axis("s", follows="times")
    speed_left: Float = found("rad/s", along="time")


@states
class Wheel:
    """What moves."""

    turning: Float = state("rad/s", start="speed")


def slowed(_: Wheel, given_wheel: Falling, time: Float) -> Wheel:
    """It slows down evenly."""
    return Wheel(turning=-given_wheel.brake / given_wheel.inertia + 0 * time)


def fallen(_: Falling, motion: Motion[Wheel]) -> Fallen:
    """Its speed as it is."""
    return Fallen(time=motion.time, speed_left=motion.states.turning)


WHEEL = Model(name="wheel", title="A flywheel", function=Dynamics(rate=slowed, gives=fallen))


@hookimpl
def truing_models() -> list[Model]:
    """Offer all of them; the shaft declares that its torque is that of the motor."""
    return [MOTOR, SHAFT, PEG, WHEEL]
