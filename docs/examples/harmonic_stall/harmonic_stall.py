"""What torque does a harmonic drive hold against a stop, at constant current of its motor?"""

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
    normal,
    results,
)


@inputs
class Drive:
    """A motor under constant current, its gear, and a lever on a load cell."""

    motor_current: Float = given(0.7, "A", symbol="I", note="current of the motor", at_least=0)
    torque_constant: Float = given(0.313, "N*m/A", symbol="k_T", note="of the motor at 0.7 A", above=0)
    ratio: Float = given(20.0, "", symbol="i", note="ratio of the gear; 1 is the motor alone", at_least=1)
    faded: Float = given(0.0, "", symbol="f", note="share of its torque that the motor has lost", below=1)
    lost: Float = given(0.0, "", symbol="v", note="share that the gear takes away", below=1)
    relaxed: Float = given(0.0, "", symbol="r", note="share by which the loaded gear has given way", below=1)


@results
class Stall:
    """What the load cell shows."""

    motor_torque: Float = found(
        "N*m", symbol="T_M", note="torque of the motor", formula="torque_constant * motor_current * (1 - faded)"
    )
    passed_on: Float = found(
        "",
        symbol="eta",
        note="share that the gear passes on; without a gear all",
        formula="cases((1 - lost) * (1 - relaxed), ratio > 1, 1)",
    )
    lever_torque: Float = found(
        "N*m", symbol="T_L", note="torque of the lever", formula="ratio * motor_torque * passed_on"
    )


def harmonic_stall(drive: Drive) -> Stall:
    """An ideal, rigid gear: it loses nothing and gives no way until an effect says otherwise."""
    motor_torque = drive.torque_constant * drive.motor_current * (1 - drive.faded)
    passed_on = np.where(drive.ratio > 1, (1 - drive.lost) * (1 - drive.relaxed), 1.0)
    return Stall(motor_torque=motor_torque, passed_on=passed_on, lever_torque=drive.ratio * motor_torque * passed_on)


HELD = Condition("held", "s", reference=1, note="since the torque came on; levels are those after one second")


def decades(held: Float) -> Float:
    """Return how many decades a time lies behind the reference; the first 10 ms count as one time."""
    return np.log10(np.maximum(held, 0.01) / HELD.zero)


def loss(drive: Drive, *, share: Float) -> Drive:
    """Friction of the teeth and of the wave generator, as it is after one second."""
    return replace(drive, lost=drive.lost + share)


def relaxation(drive: Drive, *, per_decade: Float, held: Float) -> Drive:
    """A loaded polymer gives way with the logarithm of time: as much from 1 s to 10 s as from 10 s to 100 s."""
    return replace(drive, relaxed=drive.relaxed + per_decade * decades(held))


def creep(drive: Drive, *, share: Float, after: Float, held: Float) -> Drive:
    """A spring and a damper: the gear gives way towards an end."""
    gone = np.exp(-HELD.zero / after) - np.exp(-held / after)
    return replace(drive, relaxed=drive.relaxed + share * gone)


def motor_fades(drive: Drive, *, per_decade: Float, held: Float) -> Drive:
    """Windings and magnets warm up: the motor itself loses torque, with a gear or without."""
    return replace(drive, faded=drive.faded + per_decade * decades(held))


HARMONIC_STALL = Model(
    name="harmonic_stall",
    title="Stalled harmonic drive",
    function=harmonic_stall,
    errors=[
        Tolerance("torque_constant", normal(sd="1 %"), why="mean of the run without a gear"),
        Effect(
            "loss",
            on_inputs=loss,
            looks_like="less torque than motor times ratio, from the start",
            remedy="Check teeth, wave generator and lubricant; more torque then arrives from the start.",
            unknowns=[Unknown("share", 0, 0.95, "")],
        ),
        Effect(
            "relaxation",
            on_inputs=relaxation,
            needs=[HELD],
            looks_like="with a gear, torque that falls by the same step in every decade of time",
            remedy="Fit a gear of a material that creeps less; the torque then falls by less in every decade.",
            unknowns=[Unknown("per_decade", 0, 0.3, "", note="share of the torque in each decade of time")],
        ),
        Effect(
            "creep",
            on_inputs=creep,
            needs=[HELD],
            looks_like="with a gear, torque that falls towards an end",
            remedy="Fit a gear that creeps less, or wait for the end of its creep; the torque then stays.",
            unknowns=[Unknown("share", 0, 0.5, ""), Unknown("after", 0.2, 200, "s")],
        ),
        Effect(
            "motor_fades",
            on_inputs=motor_fades,
            needs=[HELD],
            looks_like="torque that falls with time, without a gear too",
            remedy="Cool the motor, or warm it up before the test; its torque without a gear then stays.",
            unknowns=[Unknown("per_decade", 0, 0.3, "", note="share of the torque in each decade of time")],
        ),
    ],
    sheet=[Section("Torque", "motor_torque", "passed_on", "lever_torque")],
)


@hookimpl
def truing_models() -> list[Model[Drive, Stall]]:
    """Offer one calculation: harmonic_stall."""
    return [HARMONIC_STALL]
