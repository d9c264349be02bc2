"""A pendulum on a geared drive: let go, how does it swing and where does it come to rest?"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from truing import (
    Dynamics,
    Effect,
    Event,
    Float,
    Model,
    Motion,
    Record,
    Section,
    Tolerance,
    Unknown,
    axis,
    column,
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

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GRAVITY = 9.80665
"""Standard acceleration of free fall, m/s2."""
RECORD = tuple(0.1 * step for step in range(17))
"""When the angle is asked for, s: one swing."""


@inputs
class Pendulum:
    """An arm with a tip mass on the shaft of a gear; the motor is off and turns with it."""

    times: Float = given(RECORD, "s", along="time", note="when the angle is read")
    tip_mass: Float = given(1.2, "kg", symbol="m", note="mass at the tip", above=0)
    length: Float = given(0.5, "m", symbol="l", note="from the shaft to the tip mass", above=0)
    inertia: Float = given(0.02, "kg*m^2", symbol="J_0", note="arm and rotor, seen from the shaft", above=0)
    release: Float = given(60.0, "deg", symbol="phi_0", note="angle at which it is let go")
    vertical: Float = given(0.0, "deg", symbol="phi_v", note="where the gauge shows the arm hanging straight down")
    viscous: Float = given(0.0, "N*m*s", symbol="d", note="friction in proportion to the speed", at_least=0)
    coulomb: Float = given(0.0, "N*m", symbol="M_c", note="dry friction of gear and bearings", at_least=0)
    drag: Float = given(0.0, "N*m*s^2", symbol="c", note="drag of the air", at_least=0)


@states
class Swing:
    """Where the arm is, how fast it moves, and to which side: 0 where it sticks."""

    angle: Float = state("rad", start="release", symbol="phi", note="from hanging straight down", rate="speed")
    speed: Float = state("rad/s", start=0, symbol="omega", note="angular speed", rate="torque / whole_inertia")
    sense: Float = state("", start=0, symbol="s", note="sense of the motion: 1, -1, or 0 at rest", rate="0")


@results
class Swung:
    """The record of the swing, and what an eye would read from it."""

    time: Float = axis("s", symbol="t", follows="times")
    angle: Float = found("deg", symbol="phi", along="time", note="angle of the arm as the gauge shows it")
    torque: Float = found(
        "N*m",
        symbol="M",
        along="time",
        note="torque on the shaft",
        method="weight, friction and drag; 0 at rest, where dry friction holds what pulls",
    )
    whole_inertia: Float = found(
        "kg*m^2", symbol="J", note="moment of inertia", formula="inertia + tip_mass * length**2"
    )
    period: Float = found("s", symbol="T", note="of the first swing", method="twice the time to the first turn")
    rest: Float = found("deg", symbol="phi_r", note="angle at the end of the record", method="last state")


def weight(pendulum: Pendulum, angle: Float) -> Float:
    """Torque of the weight on the shaft, N m."""
    return -pendulum.tip_mass * GRAVITY * pendulum.length * np.sin(angle)


def torque(swing: Swing, pendulum: Pendulum) -> Float:
    """Torque that turns the shaft, N m; at rest dry friction holds what pulls."""
    pulled = weight(pendulum, swing.angle) - pendulum.viscous * swing.speed
    pulled = pulled - pendulum.drag * np.abs(swing.speed) * swing.speed
    return np.where(swing.sense == 0, 0.0, pulled - pendulum.coulomb * swing.sense)


def whole_inertia(pendulum: Pendulum) -> Float:
    """Moment of inertia of all that swings, kg m2."""
    return pendulum.inertia + pendulum.tip_mass * pendulum.length**2


def law(swing: Swing, pendulum: Pendulum, time: Float) -> Swing:
    """What angle and speed gain per second."""
    faster = torque(swing, pendulum) / whole_inertia(pendulum)
    return Swing(angle=swing.speed, speed=faster, sense=np.zeros_like(swing.sense))


def at_rest(angle: Float, pendulum: Pendulum) -> Swing:
    """The arm standing still: it goes where the weight pulls, or stays where dry friction holds it."""
    pulled = weight(pendulum, angle)
    sense = np.where(np.abs(pulled) > pendulum.coulomb, np.sign(pulled), 0.0)
    return Swing(angle=angle, speed=0 * pulled, sense=sense)


def let_go(pendulum: Pendulum) -> Swing:
    """The arm at the moment when it is let go."""
    return at_rest(pendulum.release, pendulum)


def turned(swing: Swing, pendulum: Pendulum, time: Float) -> Swing:
    """The arm at the moment when it has stopped."""
    return at_rest(swing.angle, pendulum)


def speed_of(swing: Swing, pendulum: Pendulum, time: Float) -> Float:
    """Speed, whose sign changes where the arm turns."""
    return swing.speed


def swung(pendulum: Pendulum, motion: Motion[Swing]) -> Swung:
    """The record as the gauge shows it."""
    vertical, swing = pendulum.vertical, motion.states
    feasible(np.isfinite(motion.first["turns"]), "the arm does not turn within the record", only=["period"])
    angles = swing.angle + column(vertical)
    return Swung(
        time=motion.time,
        angle=angles,
        torque=torque(swing, in_columns(pendulum)),
        whole_inertia=whole_inertia(pendulum),
        period=2 * motion.first["turns"],
        rest=np.asarray(angles)[..., -1],
    )


def in_columns(pendulum: Pendulum) -> Pendulum:
    """The inputs as they meet the record: one row per pendulum."""
    names = ("tip_mass", "length", "viscous", "coulomb", "drag")
    return replace(pendulum, **{name: column(getattr(pendulum, name)) for name in names})


def dry_friction(pendulum: Pendulum, *, torque: Float) -> Pendulum:
    """Dry friction of gear and bearings: it stops the swing for good, off the vertical."""
    return replace(pendulum, coulomb=pendulum.coulomb + torque)


def oil(pendulum: Pendulum, *, damping: Float) -> Pendulum:
    """Friction of the oil: the swing dies away and ends hanging straight down."""
    return replace(pendulum, viscous=pendulum.viscous + damping)


def air(pendulum: Pendulum, *, drag: Float) -> Pendulum:
    """Drag of the air: large swings die away faster than small ones."""
    return replace(pendulum, drag=pendulum.drag + drag)


EFFECTS = [
    Effect(
        "dry_friction", on_inputs=dry_friction, looks_like="every swing is shorter by the same angle; it rests askew",
        remedy="Check seals, bearing preload and lubricant; with less friction the arm comes to rest nearer to the "
               "vertical.",
        unknowns=[Unknown("torque", 0, 1, "N*m", note="of gear and bearings, seen from the shaft")],
    ),
    Effect(
        "oil", on_inputs=oil, looks_like="every swing is shorter by the same share",
        remedy="Warm the oil up or use a thinner one; each swing is then shorter by a smaller share.",
        unknowns=[Unknown("damping", 0, 0.5, "N*m*s", note="torque per speed")],
    ),
    Effect(
        "air", on_inputs=air, looks_like="the first swings die away fastest",
        remedy="Keep the effect on in the inputs file, or make the arm slimmer; the first swings then die away more "
               "slowly.",
        unknowns=[Unknown("drag", 0, 0.1, "N*m*s^2", note="torque per square of the speed")],
    ),
]  # fmt: skip

TOLERANCES = [
    Tolerance("inertia", normal(sd="10 %"), why="the rotor's, seen through the gear, is from a catalogue"),
    Tolerance("length", normal(sd="2 mm"), why="measured to the middle of the mass by a rule"),
    Tolerance("release", normal(sd="1 deg"), why="let go by hand"),
    Tolerance("vertical", normal(sd="0.3 deg"), why="the gauge was set by a level"),
]


def draw_swing(record: Record[Pendulum, Swung]) -> "Figure":
    """The angle over time."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.plot(record.results.time, np.degrees(record.results.angle))
    axes.axhline(0, color="0.7", linewidth=0.8)
    axes.set_xlabel("time, s")
    axes.set_ylabel("angle, deg")
    return figure


GEARED_PENDULUM = Model(
    name="geared_pendulum",
    title="Pendulum on a geared drive",
    summary="Swing of an arm with a tip mass after it is let go; the motor is off and turns with it.",
    function=Dynamics(
        rate=law, start=let_go, gives=swung, events=[Event("turns", speed_of, then=turned, note="angular speed")],
    ),
    errors=[*TOLERANCES, *EFFECTS],
    sheet=[
        Section("Swing", "angle", "period", "rest", figure=draw_swing),
        Section("What turns the shaft", "torque", "whole_inertia"),
    ],
)  # fmt: skip


@hookimpl
def truing_models() -> list[Model[Pendulum, Swung]]:
    """Offer one calculation: geared_pendulum."""
    return [GEARED_PENDULUM]
