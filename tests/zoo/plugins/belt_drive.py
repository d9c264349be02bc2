"""A flat belt drives a shaft: how fast does it turn? A belt that neither stretches nor slides."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Drive:
    """Two pulleys, and what the motor does."""

    motor_speed: Float = given(1500.0, "rpm", symbol="n_1", note="speed of the motor", above=0)
    torque: Float = given(30.0, "N*m", symbol="T", note="torque of the motor", at_least=0)
    driver_diameter: Float = given(125.0, "mm", symbol="d_1", note="driving pulley, to the neutral fibre", above=0)
    driven_diameter: Float = given(250.0, "mm", symbol="d_2", note="driven pulley, to the neutral fibre", above=0)
    speed_loss: Float = given(0.0, "", symbol="s", note="share of the speed that the belt loses")


@results
class Shaft:
    """What arrives at the driven shaft."""

    pull: Float = found("N", symbol="F_u", note="pull of the belt", formula="2 * torque / driver_diameter")
    driven_speed: Float = found("rpm", formula="motor_speed * driver_diameter / driven_diameter * (1 - speed_loss)")


def belt_drive(drive: Drive) -> Shaft:
    """Without a loss the circumferences have one speed."""
    ratio = drive.driver_diameter / drive.driven_diameter
    return Shaft(
        pull=2 * drive.torque / drive.driver_diameter,
        driven_speed=drive.motor_speed * ratio * (1 - drive.speed_loss),
    )


BELT = Condition("belt_temperature", "degC", reference=20, note="temperature of belt and pulleys")
TIME = Condition("time", "min", note="running time of the belt")


def creep(drive: Drive, *, compliance: Float) -> Drive:
    """The tight side is longer than the slack side: the belt creeps in proportion to its pull."""
    return replace(drive, speed_loss=drive.speed_loss + compliance * 2 * drive.torque / drive.driver_diameter)


def belt_slip(drive: Drive, *, softness: Float, grip: Float) -> Drive:
    """Beyond the pull that friction can carry the belt slides, the more the further beyond."""
    beyond = np.maximum(2 * drive.torque / drive.driver_diameter - grip, 0.0)
    return replace(drive, speed_loss=drive.speed_loss + softness * beyond)


def worn_groove(drive: Drive, *, rate: Float, time: Float) -> Drive:
    """The belt wears thinner and rides deeper on the small pulley."""
    return replace(drive, driver_diameter=drive.driver_diameter - rate * time)


def warm_pulley(drive: Drive, *, expansion: Float, belt_temperature: Float) -> Drive:
    """One of the pulleys grows more with temperature than the other, being of plastic."""
    grown = 1 + expansion * (belt_temperature - BELT.zero)
    return replace(drive, driven_diameter=drive.driven_diameter * grown)


def lift_off(drive: Drive, *, share: Float) -> Drive:
    """Centrifugal force lifts the belt: it loses as the square of the speed; the share is that at 3000 rpm."""
    return replace(drive, speed_loss=drive.speed_loss + share * (drive.motor_speed / 50.0) ** 2)


BELT_DRIVE = Model(
    name="belt_drive",
    title="Speed of a belt drive",
    function=belt_drive,
    errors=[
        Tolerance("driver_diameter", normal(sd="0.08 mm"), why="turned; and the belt is not equally thick"),
        Tolerance("driven_diameter", normal(sd="0.15 mm"), why="turned; and the belt is not equally thick"),
        acting(creep, Unknown("compliance", 0, 0.05, "1/kN", note="one over the stiffness EA of the belt")),
        acting(
            belt_slip,
            Unknown("softness", 0, 0.2, "1/kN", note="slip per pull beyond the grip"),
            Unknown("grip", 100, 1000, "N", note="pull that friction can carry"),
        ),
        acting(worn_groove, Unknown("rate", 0, 2, "mm/h"), needs=[TIME]),
        acting(warm_pulley, Unknown("expansion", -2e-4, 2e-4, "1/K"), needs=[BELT]),
        acting(lift_off, Unknown("share", 0, 0.05, "", note="loss at 3000 rpm")),
    ],
)
