"""What torque does it take to turn a cycloid reducer that drives nothing?"""

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    results,
)


@inputs
class Reducer:
    """A reducer that is turned at constant speed without load; torque and angle are those of the output side."""

    drag: Float = given(7.0, "N*m", symbol="T_f", note="drag torque of this design at this speed", above=0)
    ripple: Float = given(0.0, "N*m", symbol="T_r", note="what goes to and fro with the angle")
    eased: Float = given(0.0, "", symbol="q", note="share of the drag that is gone since the start", below=1)


@results
class Drag:
    """What the motor shows: its current times torque constant and ratio."""

    torque: Float = found("N*m", symbol="T", note="torque of the motor", formula="drag * (1 - eased) + ripple")


def cycloid_ripple(reducer: Reducer) -> Drag:
    """Constant drag at constant speed: ripple and easing are 0 until an effect says otherwise."""
    return Drag(torque=reducer.drag * (1 - reducer.eased) + reducer.ripple)


LOBES = 13  # of the disc: the eccentric shaft turns 13 times in a turn of the output
PINS = 14  # of the ring
ANGLE = Condition("angle", "rad", derived="since_start", note="how far the output has turned")
TIME = Condition("time", "s", derived="since_start", note="since the record began")
CONTROLLER = Condition(
    "controller_temperature", "degC", reference=37, role="follows", note="of the electronics, not of the gear"
)


def waves(reducer: Reducer, order: int, angle: Float, amplitudes: dict[str, Float]) -> Reducer:
    """Add waves that come again 1, 2 and 3 times ``order`` in a turn of the output; what is not named is 0."""
    more: Float = np.zeros(np.shape(angle))
    for multiple in (1, 2, 3):
        turned = multiple * order * angle
        more = more + amplitudes.get(f"sine_{multiple}", 0.0) * np.sin(turned)
        more = more + amplitudes.get(f"cosine_{multiple}", 0.0) * np.cos(turned)
    return replace(reducer, ripple=reducer.ripple + more)


def eccentric_shaft(reducer: Reducer, *, angle: Float, **amplitudes: Float) -> Reducer:
    """Once per turn of the eccentric shaft, and its multiples: runout, bearings, a disc out of balance."""
    return waves(reducer, LOBES, angle, amplitudes)


def ring_pitch(reducer: Reducer, *, angle: Float, **amplitudes: Float) -> Reducer:
    """Once per pin of the ring, and its multiples: pitch and roundness of the ring."""
    return waves(reducer, PINS, angle, amplitudes)


def ring_runout(reducer: Reducer, *, angle: Float, sine_1: Float, cosine_1: Float) -> Reducer:
    """The ring is out of centre: its pins press harder once in a turn of the output, a side band of their order."""
    return waves(reducer, PINS + 1, angle, {"sine_1": sine_1, "cosine_1": cosine_1})


def running_in(reducer: Reducer, *, share: Float, turns: Float, angle: Float) -> Reducer:
    """Fresh asperities wear off: a share of the drag goes with the turns made."""
    return replace(reducer, eased=reducer.eased + share * (1 - np.exp(-angle / (2 * np.pi * turns))))


def warming_up(reducer: Reducer, *, share: Float, after: Float, time: Float) -> Reducer:
    """Grease gets thin as the gear warms up: a share of the drag goes with time."""
    return replace(reducer, eased=reducer.eased + share * (1 - np.exp(-time / after)))


def thin_grease(reducer: Reducer, *, slope: Float, controller_temperature: Float) -> Reducer:
    """Grease gets thin with the temperature, of which only that of the electronics is known."""
    return replace(reducer, eased=reducer.eased + slope * (controller_temperature - CONTROLLER.zero))


def pairs(*multiples: int) -> tuple[list[Unknown], list[list[str]]]:
    """Return sine and cosine of some multiples, and the parts that are looked for one by one."""
    parts = [[f"sine_{multiple}", f"cosine_{multiple}"] for multiple in multiples]
    return [Unknown(name, -5, 5, "N*m") for part in parts for name in part], parts


SHAFT, SHAFT_PARTS = pairs(1, 2, 3)
RING, RING_PARTS = pairs(1, 2, 3)

CYCLOID_RIPPLE = Model(
    name="cycloid_ripple",
    title="Drag torque of a cycloid reducer",
    function=cycloid_ripple,
    errors=[
        Tolerance("drag", lognormal(sd="30 %"), why="printed parts: their friction is not known beforehand"),
        Effect(
            "eccentric_shaft",
            on_inputs=eccentric_shaft,
            needs=[ANGLE],
            acts_at_reference=True,
            parts=SHAFT_PARTS,
            unknowns=SHAFT,
            looks_like="orders 13, 26 and 39 of the output",
        ),
        Effect(
            "ring_pitch",
            on_inputs=ring_pitch,
            needs=[ANGLE],
            acts_at_reference=True,
            parts=RING_PARTS,
            unknowns=RING,
            looks_like="orders 14, 28 and 42 of the output",
        ),
        Effect(
            "ring_runout",
            on_inputs=ring_runout,
            needs=[ANGLE],
            acts_at_reference=True,
            unknowns=[Unknown("sine_1", -5, 5, "N*m"), Unknown("cosine_1", -5, 5, "N*m")],
            looks_like="order 15 of the output",
        ),
        Effect(
            "running_in",
            on_inputs=running_in,
            needs=[ANGLE],
            looks_like="drag that falls, less and less",
            unknowns=[Unknown("share", 0, 0.8, ""), Unknown("turns", 1, 1000, "")],
        ),
        Effect(
            "warming_up",
            on_inputs=warming_up,
            needs=[TIME],
            looks_like="drag that falls, less and less",
            unknowns=[Unknown("share", 0, 0.8, ""), Unknown("after", 2, 2000, "s")],
        ),
        Effect(
            "thin_grease",
            on_inputs=thin_grease,
            needs=[CONTROLLER],
            looks_like="drag that falls with the temperature of the electronics",
            unknowns=[Unknown("slope", 0, 0.1, "1/K")],
        ),
    ],
    sheet=[Section("Drag", "torque")],
)


@hookimpl
def truing_models() -> list[Model[Reducer, Drag]]:
    """Offer one calculation: cycloid_ripple."""
    return [CYCLOID_RIPPLE]
