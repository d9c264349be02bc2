"""A mass on a spring that a force pushes: peak, settling and frequency have closed forms."""

import numpy as np

from truing import (
    Dynamics,
    Event,
    Float,
    Frequency,
    Maximise,
    Minimise,
    Model,
    Motion,
    Require,
    Tolerance,
    Vary,
    axis,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    results,
    state,
    states,
)

BAND = 0.02
"""It has settled where it stays within so much of where it comes to rest."""
SECONDS = tuple(0.1 * step for step in range(61))


@inputs
class Oscillator:
    """A mass between spring, damper and a force."""

    times: Float = given(SECONDS, "s", along="time", note="when it is read")
    force: Float = given((1.0,), "N", along="time", between="hold", symbol="F", note="on the mass")
    mass: Float = given(1.0, "kg", symbol="m", note="that moves", above=0)
    damping: Float = given(1.2, "N*s/m", symbol="d", note="force per speed", above=0)
    stiffness: Float = given(9.0, "N/m", symbol="c", note="of the spring", above=0)
    start: Float = given(0.0, "m", symbol="x_0", note="where it begins")


@states
class Moved:
    """Where it is and how fast; the largest value so far, and when it last came into the band."""

    position: Float = state("m", start="start", symbol="x", note="from where the spring is slack", rate="speed")
    speed: Float = state(
        "m/s", start=0, symbol="v", note="of the mass", rate="(force - damping * speed - stiffness * position) / mass"
    )
    peak: Float = state("m", start="start", symbol="x_p", note="largest so far", rate="0")
    came: Float = state("s", start=0, symbol="t_b", note="when it last came into the band", rate="0")


@results
class Settled:
    """The record and what is read from it."""

    time: Float = axis("s", symbol="t", follows="times")
    position: Float = found("m", symbol="x", along="time", note="of the mass")
    speed: Float = found("m/s", symbol="v", along="time", note="of the mass")
    overshoot: Float = found("%", symbol="o", note="of the first peak over the rest", method="located event")
    settling: Float = found("s", symbol="t_s", note="until it stays within 2 % of the rest", method="located event")
    frequency: Float = found("Hz", symbol="f", note="of the swing", method="half a swing is the time to the peak")


def pushed(moved: Moved, oscillator: Oscillator, time: Float) -> Moved:
    """What position and speed gain per second."""
    pull = oscillator.force - oscillator.damping * moved.speed - oscillator.stiffness * moved.position
    still = np.zeros_like(moved.position)
    return Moved(position=moved.speed, speed=pull / oscillator.mass, peak=still, came=still)


def speed_of(moved: Moved, oscillator: Oscillator, time: Float) -> Float:
    """Speed, which falls through 0 at a peak."""
    return moved.speed


def topped(moved: Moved, oscillator: Oscillator, time: Float) -> Moved:
    """The largest value so far."""
    peak = np.maximum(moved.peak, moved.position)
    return Moved(position=moved.position, speed=moved.speed, peak=peak, came=moved.came)


def outside(moved: Moved, oscillator: Oscillator, time: Float) -> Float:
    """How far it is outside the band; below 0 within."""
    rest = oscillator.force / oscillator.stiffness
    return np.abs(moved.position - rest) - BAND * np.abs(rest)


def came(moved: Moved, oscillator: Oscillator, time: Float) -> Moved:
    """The time at which it comes into the band."""
    return Moved(position=moved.position, speed=moved.speed, peak=moved.peak, came=time + 0 * moved.came)


def settled(oscillator: Oscillator, motion: Motion[Moved]) -> Settled:
    """The record as it is read."""
    swing = motion.states
    feasible(np.isfinite(motion.first["peak"]), "there is no peak in the record", only=["overshoot", "frequency"])
    rest = np.asarray(oscillator.force)[..., -1] / oscillator.stiffness
    return Settled(
        time=motion.time,
        position=swing.position,
        speed=swing.speed,
        overshoot=np.asarray(swing.peak)[..., -1] / rest - 1,
        settling=np.asarray(swing.came)[..., -1],
        frequency=0.5 / motion.first["peak"],
    )


OSCILLATOR = Model(
    name="oscillator",
    title="A mass on a spring",
    function=Dynamics(
        rate=pushed,
        gives=settled,
        events=[
            Event("peak", speed_of, when="falls", then=topped),
            Event("band", outside, when="falls", then=came),
        ],
    ),
    errors=[
        Tolerance("damping", normal(sd="0.12 N*s/m"), why="oil of unknown warmth"),
    ],
    objectives=[
        Vary("damping", "0.2 N*s/m", "5 N*s/m"),
        Minimise("settling"),
        Maximise("frequency"),
        Require("overshoot", at_most="60 %", reliability=0.9),
    ],
    studies=[Frequency(input="force", output="position")],
)


@hookimpl
def truing_models() -> list[Model[Oscillator, Settled]]:
    """Offer one calculation: oscillator."""
    return [OSCILLATOR]
