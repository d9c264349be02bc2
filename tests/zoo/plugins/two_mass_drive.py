"""A motor turns a mass through a stiff gear: by which angle does the mass lag? Stiffness and inertia, nothing else."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Axis:
    """The axis as its controller and the torque flange see it."""

    motor_angle: Float = given(0.0, "rad", symbol="phi", note="angle of the motor behind the gear")
    speed: Float = given(0.0, "rad/s", symbol="omega", note="speed of the motor behind the gear")
    acceleration: Float = given(0.0, "rad/s^2", symbol="alpha", note="acceleration of the motor behind the gear")
    load_torque: Float = given(5.0, "N*m", symbol="T_L", note="torque of the process on the mass")
    inertia: Float = given(0.02, "kg*m^2", symbol="J", note="inertia of the mass", above=0)
    stiffness: Float = given(8.0, "kN*m/rad", symbol="k", note="torsional stiffness", above=0)
    other_torque: Float = given(0.0, "N*m", symbol="T_R", note="torque of whatever else holds the mass back")
    hardening: Float = given(0.0, "1/(N*m)", symbol="h", note="growth of the stiffness with the torque", at_least=0)
    play: Float = given(0.0, "mrad", symbol="b", note="play of the gear from flank to flank", at_least=0)
    play_torque: Float = given(0.2, "N*m", symbol="T_0", note="torque that takes up most of the play", above=0)
    wave: Float = given(0.0, "mrad", symbol="e", note="error of the gear at this angle")


@results
class Lag:
    """How far the mass is behind."""

    torque: Float = found(
        "N*m", symbol="T", note="torque in the gear", formula="inertia * acceleration + load_torque + other_torque"
    )
    twist: Float = found(
        "mrad",
        formula="torque / (stiffness * (1 + hardening * abs(torque))) + play / 2 * tanh(torque / play_torque) + wave",
    )


def two_mass_drive(axis: Axis) -> Lag:
    """The mass moves with the motor, as long as the gear is stiff."""
    torque = axis.inertia * axis.acceleration + axis.load_torque + axis.other_torque
    elastic = torque / (axis.stiffness * (1 + axis.hardening * np.abs(torque)))
    taken_up = axis.play / 2 * np.tanh(torque / axis.play_torque)
    return Lag(torque=torque, twist=elastic + taken_up + axis.wave)


TIME = Condition("time", "s", note="time since the start")


def backlash(axis: Axis, *, play: Float, play_torque: Float) -> Axis:
    """The flanks change sides where the torque changes its sign."""
    return replace(axis, play=axis.play + play, play_torque=np.where(play > 0, play_torque, axis.play_torque))


def gear_wave(axis: Axis, *, sine: Float, cosine: Float, order: Float) -> Axis:
    """The teeth are not even: a wave that comes back so many times in a turn."""
    wave = sine * np.sin(order * axis.motor_angle) + cosine * np.cos(order * axis.motor_angle)
    return replace(axis, wave=axis.wave + wave)


def dry_friction(axis: Axis, *, torque: Float) -> Axis:
    """The bearing of the mass rubs, with the same torque at any speed."""
    return replace(axis, other_torque=axis.other_torque + torque * np.sign(axis.speed))


def viscous_friction(axis: Axis, *, damping: Float) -> Axis:
    """The bearing of the mass rubs in proportion to its speed."""
    return replace(axis, other_torque=axis.other_torque + damping * axis.speed)


def stiffening(axis: Axis, *, hardening: Float) -> Axis:
    """More teeth carry at more torque."""
    return replace(axis, hardening=axis.hardening + hardening)


def unbalance(axis: Axis, *, sine: Float, cosine: Float) -> Axis:
    """The mass hangs out of the middle: gravity pulls once in a turn."""
    pull = sine * np.sin(axis.motor_angle) + cosine * np.cos(axis.motor_angle)
    return replace(axis, other_torque=axis.other_torque + pull)


def warming(axis: Axis, *, rate: Float, time: Float) -> Axis:
    """The zero of the encoder moves while the axis warms up."""
    return replace(axis, wave=axis.wave + rate * time)


TWO_MASS_DRIVE = Model(
    name="two_mass_drive",
    title="Lag of a mass behind its drive",
    function=two_mass_drive,
    errors=[
        Tolerance("inertia", normal(sd="3 %"), why="from the drawing, without screws"),
        Tolerance("stiffness", normal(sd="6 %"), why="from the catalogue of the gear"),
        acting(backlash, Unknown("play", 0, 3, "mrad"), Unknown("play_torque", 0.05, 5, "N*m")),
        acting(
            gear_wave,
            Unknown("sine", -1, 1, "mrad"),
            Unknown("cosine", -1, 1, "mrad"),
            Unknown("order", 4, 24, note="waves in a turn", whole=True),
        ),
        acting(dry_friction, Unknown("torque", 0, 10, "N*m")),
        acting(viscous_friction, Unknown("damping", 0, 3, "N*m*s/rad")),
        acting(stiffening, Unknown("hardening", 0, 0.2, "1/(N*m)")),
        acting(unbalance, Unknown("sine", -5, 5, "N*m"), Unknown("cosine", -5, 5, "N*m")),
        acting(warming, Unknown("rate", -0.5, 0.5, "mrad/s"), needs=[TIME]),
    ],
)
