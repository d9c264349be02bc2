"""What torque does it take to turn a cycloid reducer without load, at every speed?"""

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
    """The reducer seen from its output; what a viscous drag leaves out is neutral as declared."""

    speed: Float = given(6.0, "rad/s", symbol="omega", note="speed of the output, signed")
    viscosity: Float = given(0.4, "N*m*s/rad", symbol="b", note="drag of the grease per speed", above=0)
    thinning_speed: Float = given(6.0, "rad/s", symbol="omega_0", note="speed at which b holds", above=0)
    thinning: Float = given(0.0, "", symbol="p", note="by how much the grease thins in shear; 0: it does not")
    dry: Float = given(0.0, "N*m", symbol="T_C", note="dry friction at any speed")
    breakaway: Float = given(0.0, "N*m", symbol="T_S", note="further friction while the surfaces still touch")
    film_speed: Float = given(1.0, "rad/s", symbol="omega_S", note="speed at which a film parts the surfaces", above=0)
    windage: Float = given(0.0, "N*m*s^2/rad^2", symbol="c", note="drag per square of the speed")
    one_way: Float = given(0.0, "N*m", symbol="T_1", note="torque that is there one way and missing the other")
    inertial: Float = given(0.0, "N*m", symbol="T_J", note="torque that speeds the parts up")


@results
class Drag:
    """What the motor has to give."""

    pace: Float = found("rad/s", symbol="n", note="speed without its sign", formula="abs(speed)")
    grease: Float = found(
        "N*m", symbol="T_b", note="drag of the grease",
        formula="viscosity * thinning_speed * (pace / thinning_speed)**(1 - thinning)",
    )  # fmt: skip
    friction: Float = found(
        "N*m", symbol="T_F", note="all that holds back, without its sign",
        formula="grease + dry + breakaway * exp(-pace / film_speed) + windage * pace**2",
    )  # fmt: skip
    torque: Float = found(
        "N*m", symbol="T", note="torque of the motor times the ratio",
        formula="sign(speed) * friction + one_way + inertial",
    )  # fmt: skip


def cycloid_drag(reducer: Reducer) -> Drag:
    """Viscous drag; all that makes it another one is 0 until an effect says otherwise. Shapes (n,) or numbers."""
    pace = np.abs(reducer.speed)
    grease = reducer.viscosity * reducer.thinning_speed * (pace / reducer.thinning_speed) ** (1 - reducer.thinning)
    touching = reducer.breakaway * np.exp(-pace / reducer.film_speed)
    friction = grease + reducer.dry + touching + reducer.windage * pace**2
    torque = np.sign(reducer.speed) * friction + reducer.one_way + reducer.inertial
    return Drag(pace=pace, grease=grease, friction=friction, torque=torque)


ACCELERATION = Condition("acceleration", "rad/s^2", note="of the output")


def dry_friction(reducer: Reducer, *, torque: Float) -> Reducer:
    """Lobes, pins and seals rub with the same force at any speed."""
    return replace(reducer, dry=reducer.dry + torque)


def mixed_friction(reducer: Reducer, *, torque: Float, film: Float) -> Reducer:
    """Surfaces touch until a film of grease parts them: friction falls with speed (Stribeck)."""
    at = np.where(np.equal(torque, 0), reducer.film_speed, film)
    return replace(reducer, breakaway=reducer.breakaway + torque, film_speed=at)


def shear_thinning(reducer: Reducer, *, exponent: Float) -> Reducer:
    """Grease flows the easier the faster it is sheared: drag grows slower than speed."""
    return replace(reducer, thinning=reducer.thinning + exponent)


def churning(reducer: Reducer, *, per_square: Float) -> Reducer:
    """Grease and air are thrown about: drag grows as the square of speed."""
    return replace(reducer, windage=reducer.windage + per_square)


def one_way_drag(reducer: Reducer, *, torque: Float) -> Reducer:
    """The disc runs harder one way round than the other."""
    return replace(reducer, one_way=reducer.one_way + torque)


def inertia(reducer: Reducer, *, moment: Float, acceleration: Float) -> Reducer:
    """Part of the torque speeds up the rotor."""
    return replace(reducer, inertial=reducer.inertial + moment * acceleration)


CYCLOID_DRAG = Model(
    name="cycloid_drag",
    title="Drag of a cycloid reducer",
    function=cycloid_drag,
    errors=[
        Tolerance("viscosity", lognormal(sd="100 %"), why="a greased print; nobody has measured this one"),
        Effect(
            "dry_friction",
            on_inputs=dry_friction,
            looks_like="a jump where the speed changes its sign",
            unknowns=[Unknown("torque", 0, 15, "N*m", note="at the output")],
        ),
        Effect(
            "mixed_friction",
            on_inputs=mixed_friction,
            looks_like="a jump at standstill that is gone at speed",
            unknowns=[
                Unknown("torque", 0, 15, "N*m", note="at standstill, beyond what is left at speed"),
                Unknown("film", 0.1, 5, "rad/s", note="speed at which a third of it is left"),
            ],
        ),
        Effect(
            "shear_thinning",
            on_inputs=shear_thinning,
            looks_like="a curve that is steep at standstill and flat at speed",
            unknowns=[Unknown("exponent", 0, 0.8, "", note="greases 0.3 to 0.7")],
        ),
        Effect(
            "churning",
            on_inputs=churning,
            looks_like="a curve that gets steeper with speed",
            unknowns=[Unknown("per_square", 0, 0.2, "N*m*s^2/rad^2")],
        ),
        Effect(
            "one_way_drag",
            on_inputs=one_way_drag,
            looks_like="both branches are shifted to one side",
            unknowns=[Unknown("torque", -5, 5, "N*m")],
        ),
        Effect(
            "inertia",
            on_inputs=inertia,
            needs=[ACCELERATION],
            looks_like="a step where the ramp turns",
            unknowns=[Unknown("moment", 0, 2, "kg*m^2", note="seen from the output")],
        ),
    ],
    sheet=[Section("Drag", "pace", "grease", "friction", "torque")],
)


@hookimpl
def truing_models() -> list[Model[Reducer, Drag]]:
    """Offer one calculation: cycloid_drag."""
    return [CYCLOID_DRAG]
