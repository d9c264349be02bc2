"""How far does a cycloid reducer twist under torque, with its output held fast?"""

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
    normal,
    results,
)


@inputs
class Reducer:
    """The reducer seen from its motor; every torque and angle is that of the output side."""

    torque: Float = given(10.0, "N*m", symbol="T", note="torque of the motor times the ratio")
    stiffness: Float = given(400.0, "N*m/rad", symbol="k", note="torsional stiffness", above=0)
    zero_angle: Float = given(0.0, "mrad", symbol="phi_0", note="angle that the encoder shows without torque")
    held_back: Float = given(0.0, "N*m", symbol="T_R", note="part of the torque that friction keeps from the spring")
    play: Float = given(0.0, "mrad", symbol="b", note="lost motion from flank to flank", at_least=0)
    play_torque: Float = given(1.0, "N*m", symbol="T_0", note="torque that takes up most of the play", above=0)
    hardening: Float = given(0.0, "1/(N*m)", symbol="c", note="growth of the stiffness with the torque", at_least=0)
    one_way: Float = given(0.0, "", symbol="a", note="share by which it is stiffer one way than on average")


@results
class Twist:
    """What the encoder of the motor shows, divided by the ratio."""

    spring_torque: Float = found(
        "N*m", symbol="T_k", note="torque that reaches the spring", formula="torque - held_back"
    )
    rigidity: Float = found(
        "N*m/rad",
        symbol="k_T",
        note="stiffness at this torque",
        formula="stiffness * (1 + hardening * abs(spring_torque) + one_way * sign(spring_torque))",
    )
    angle: Float = found(
        "mrad",
        symbol="phi",
        note="twist",
        formula="zero_angle + spring_torque / rigidity + play / 2 * tanh(spring_torque / play_torque)",
    )


def cycloid_torsion(reducer: Reducer) -> Twist:
    """A linear spring: all that makes it another one is 0 until an effect says otherwise."""
    spring_torque = reducer.torque - reducer.held_back
    rigidity = reducer.stiffness * (
        1 + reducer.hardening * np.abs(spring_torque) + reducer.one_way * np.sign(spring_torque)
    )
    taken_up = reducer.play / 2 * np.tanh(spring_torque / reducer.play_torque)
    angle = reducer.zero_angle + spring_torque / rigidity + taken_up
    return Twist(spring_torque=spring_torque, rigidity=rigidity, angle=angle)


LOADING = Condition("loading", "", derived="direction of torque_command", note="+1 while the torque rises, -1 falling")
TURNED_AT = Condition("turned_at", "N*m", derived="last_reversal of torque_command", note="torque where it last turned")
LIMIT = 25.0  # N*m, where the current of the motor is cut off


def friction(reducer: Reducer, *, torque: Float, doubled_at: Float, loading: Float, turned_at: Float) -> Reducer:
    """Dry friction of bearings and seals, and of lobes on pins in proportion to what they carry.

    In slip it keeps from the spring all it can. After a turn it lets go of what it kept before it pulls back.
    """
    turned = np.clip(turned_at, -LIMIT, LIMIT)
    before = np.minimum(torque * (1 + np.abs(turned) / doubled_at), np.abs(turned))
    now = torque * (1 + np.abs(reducer.torque) / doubled_at)
    kept = loading * np.clip(loading * (reducer.torque - turned) - before, -before, now)
    return replace(reducer, held_back=reducer.held_back + kept)


def lost_motion(reducer: Reducer, *, play: Float, play_torque: Float) -> Reducer:
    """Clearance between lobes, pins and ring: the angle jumps where the torque changes its sign."""
    return replace(reducer, play=reducer.play + play, play_torque=play_torque)


def stiffening(reducer: Reducer, *, hardening: Float) -> Reducer:
    """More teeth and larger contacts carry at more torque."""
    return replace(reducer, hardening=reducer.hardening + hardening)


def asymmetry(reducer: Reducer, *, one_way: Float) -> Reducer:
    """Stiffer one way round than the other."""
    return replace(reducer, one_way=reducer.one_way + one_way)


CYCLOID_TORSION = Model(
    name="cycloid_torsion",
    title="Torsion of a cycloid reducer",
    function=cycloid_torsion,
    errors=[
        Tolerance("stiffness", lognormal(sd="40 %"), why="printed parts; nobody has measured this one"),
        Tolerance("zero_angle", normal(sd="20 mrad"), why="the zero of the encoder is arbitrary"),
        Effect(
            "lost_motion",
            on_inputs=lost_motion,
            looks_like="a step in the angle where the torque changes its sign",
            unknowns=[
                Unknown("play", 0, 200, "mrad", note="from flank to flank"),
                Unknown("play_torque", 0.1, 20, "N*m", note="torque that takes up most of it"),
            ],
        ),
        Effect(
            "friction",
            on_inputs=friction,
            needs=[LOADING, TURNED_AT],
            looks_like="a loop; the angle stands still after a turn",
            unknowns=[
                Unknown("torque", 0, 15, "N*m", note="half the width of the loop without load"),
                Unknown("doubled_at", 0.5, 500, "N*m", note="torque at which the friction has doubled"),
            ],
        ),
        Effect(
            "stiffening",
            on_inputs=stiffening,
            looks_like="the curve bends towards the torque on both sides",
            unknowns=[Unknown("hardening", 0, 0.5, "1/(N*m)")],
        ),
        Effect(
            "asymmetry",
            on_inputs=asymmetry,
            looks_like="a kink at no torque",
            unknowns=[Unknown("one_way", -0.5, 0.5, "", note="positive: stiffer at positive torque")],
        ),
    ],
    sheet=[Section("Twist", "spring_torque", "rigidity", "angle")],
)


@hookimpl
def truing_models() -> list[Model[Reducer, Twist]]:
    """Offer one calculation: cycloid_torsion."""
    return [CYCLOID_TORSION]
