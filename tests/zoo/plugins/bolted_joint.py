"""Bolts tightened by angle: what preload is left? An elastic bolt in an elastic joint, one row for each bolt."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Joint:
    """One bolt, the plates that it clamps, and how far it is turned from where everything lies on."""

    turned: Float = given(60.0, "deg", symbol="theta", note="angle of tightening from the snug point", at_least=0)
    clamp_length: Float = given(50.0, "mm", symbol="l_K", note="length clamped", above=0)
    pitch: Float = given(1.75, "mm", symbol="P", note="pitch of the thread", above=0)
    stress_area: Float = given(84.3, "mm^2", symbol="A_S", note="stress area of the bolt", above=0)
    elasticity: Float = given(205.0, "GPa", symbol="E", note="Young's modulus of the bolt", above=0)
    plate_share: Float = given(0.25, "", symbol="phi", note="compliance of the plates over that of the bolt", above=0)
    lost_length: Float = given(0.0, "um", symbol="f_Z", note="length lost between turning and measuring")


@results
class Preload:
    """What holds the joint together."""

    compliance: Float = found("um/kN", formula="clamp_length * (1 + plate_share) / (elasticity * stress_area)")
    preload: Float = found("kN", formula="(pitch * turned / (2 * pi) - lost_length) / compliance")


def bolted_joint(joint: Joint) -> Preload:
    """Hooke's law for bolt and plates in series."""
    compliance = joint.clamp_length * (1 + joint.plate_share) / (joint.elasticity * joint.stress_area)
    elastic = (joint.pitch * joint.turned / (2 * np.pi) - joint.lost_length) / compliance
    return Preload(compliance=compliance, preload=elastic)


INTERFACES = Condition("interfaces", "", note="rough surfaces between head and nut")
WARMER = Condition("bolt_warmer", "K", note="temperature of the bolt above that of the plates")


def embedding(joint: Joint, *, depth: Float, interfaces: Float) -> Joint:
    """Peaks of the rough surfaces are pressed flat, the same in every interface."""
    return replace(joint, lost_length=joint.lost_length + depth * interfaces)


def yielding(joint: Joint, base: Preload, *, inverse_limit: Float, sharpness: Float) -> Preload:
    """The bolt flows: its force nears a limit."""
    flowing = (1 + np.abs(base.preload * inverse_limit) ** sharpness) ** (1 / sharpness)
    return replace(base, preload=base.preload / flowing)


def lost_angle(joint: Joint, *, angle: Float) -> Joint:
    """The snug point was set too early, by the same angle every time."""
    return replace(joint, turned=joint.turned - angle)


def twisted_shank(joint: Joint, *, share: Float) -> Joint:
    """The shank twists: a share of the angle does not reach the thread."""
    return replace(joint, pitch=joint.pitch * (1 - share))


def warm_bolt(joint: Joint, *, expansion: Float, bolt_warmer: Float) -> Joint:
    """The bolt is warmer than the plates when the force is read, and grows."""
    return replace(joint, lost_length=joint.lost_length + expansion * bolt_warmer * joint.clamp_length)


def soft_washer(joint: Joint, *, compliance: Float) -> Joint:
    """A washer is softer than the joint; it matters most where little is clamped."""
    bolt = joint.clamp_length / (joint.elasticity * joint.stress_area)
    return replace(joint, plate_share=joint.plate_share + compliance / bolt)


BOLTED_JOINT = Model(
    name="bolted_joint",
    title="Preload of bolts tightened by angle",
    function=bolted_joint,
    errors=[
        Tolerance("elasticity", normal(sd="1 %"), why="scatter of steels"),
        Tolerance("plate_share", normal(sd="0.02"), why="the cone of pressure is a guess"),
        acting(embedding, Unknown("depth", 0, 20, "um", note="lost in each interface"), needs=[INTERFACES]),
        acting(yielding, Unknown("inverse_limit", 0, 0.04, "1/kN"), Unknown("sharpness", 2, 40), on="results"),
        acting(lost_angle, Unknown("angle", -10, 10, "deg")),
        acting(twisted_shank, Unknown("share", 0, 0.2)),
        acting(warm_bolt, Unknown("expansion", 0, 3e-5, "1/K"), needs=[WARMER]),
        acting(soft_washer, Unknown("compliance", 0, 2, "um/kN")),
    ],
)
