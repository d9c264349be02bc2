"""A tyre on a drum: what side force does it give at a slip angle? Brushes on a stiff carcass."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting

RATED_LOAD = 4000.0
"""Load at which friction is stated, N."""
RATED_SPEED = 60 / 3.6
"""Speed at which friction is stated, m/s."""


@inputs
class Tyre:
    """The tyre, and one reading of the drum."""

    slip_angle: Float = given(3.0, "deg", symbol="alpha", note="angle between wheel and drum")
    load: Float = given(4.0, "kN", symbol="F_z", note="load of the wheel", above=0)
    speed: Float = given(60.0, "km/h", symbol="v", note="speed of the drum", above=0)
    stiffness: Float = given(15.0, "1/rad", symbol="c", note="cornering stiffness over the load", above=0)
    friction: Float = given(1.0, "", symbol="mu", note="friction of the tread at 4 kN, 60 km/h", above=0)
    late: Float = given(0.0, "deg", symbol="d_a", note="angle by which the tread is behind the wheel")
    steer: Float = given(0.0, "deg", symbol="a_0", note="angle at which a cylinder of plies runs straight")
    load_exponent: Float = given(0.0, "", symbol="k", note="fall of the friction with the load")
    fading: Float = given(0.0, "", symbol="f", note="share of its friction that the tread has lost", below=1)
    thrust: Float = given(0.0, "", symbol="t", note="side force over load that the tyre has running straight")


@results
class Side:
    """What the hub feels."""

    tread_angle: Float = found(
        "deg", symbol="alpha_t", note="slip angle of the tread", formula="slip_angle - late - steer"
    )
    sliding: Float = found("", symbol="theta", note="share of the contact that slides", method="parabolic pressure")
    side_force: Float = found("kN", symbol="F_y", note="side force", method="brushes that stick, then slide")


def tyre_curve(tyre: Tyre) -> Side:
    """Brush model with parabolic pressure (Pacejka, Tire and vehicle dynamics, ch. 3), in the steady state."""
    tread_angle = tyre.slip_angle - tyre.late - tyre.steer
    most = tyre.friction * (1 - tyre.fading) * (tyre.load / RATED_LOAD) ** -tyre.load_exponent * tyre.load
    pulled = np.minimum(tyre.stiffness * tyre.load * np.abs(np.tan(tread_angle)) / (3 * most), 1.0)
    share = pulled * (3 - 3 * pulled + pulled**2)
    force = most * np.sign(tread_angle) * share + tyre.thrust * tyre.load
    return Side(tread_angle=tread_angle, sliding=pulled, side_force=force)


RATE = Condition("slip_rate", "deg/s", note="speed of the steering of the wheel")
TIME = Condition("time", "s", derived="since_start", note="since the run began")
TREAD = Condition("tread_temperature", "degC", reference=50, note="infrared thermometer on the tread")


def relaxation(tyre: Tyre, *, length: Float, slip_rate: Float) -> Tyre:
    """The carcass must roll some way before the tread follows the wheel: late by that way over the speed."""
    return replace(tyre, late=tyre.late + length * slip_rate / tyre.speed)


def load_sensitivity(tyre: Tyre, *, exponent: Float) -> Tyre:
    """Rubber grips less under more pressure: the friction falls as a power of the load."""
    return replace(tyre, load_exponent=tyre.load_exponent + exponent)


def ply_steer(tyre: Tyre, *, angle: Float) -> Tyre:
    """The plies of the belt steer the tyre: all angles are off by the same."""
    return replace(tyre, steer=tyre.steer + angle)


def conicity(tyre: Tyre, *, thrust: Float) -> Tyre:
    """The tyre is a cone: it pushes to one side in proportion to its load."""
    return replace(tyre, thrust=tyre.thrust + thrust)


def hot_tread(tyre: Tyre, *, loss: Float, tread_temperature: Float) -> Tyre:
    """The tread grips less as it becomes hot."""
    return replace(tyre, fading=tyre.fading + loss * (tread_temperature - TREAD.zero))


def polished_drum(tyre: Tyre, *, loss: Float, time_constant: Float, time: Float) -> Tyre:
    """Rubber smears the drum: friction falls in the first minutes, and settles."""
    return replace(tyre, fading=tyre.fading + loss * (1 - np.exp(-time / time_constant)))


def fast_sliding(tyre: Tyre, *, loss: Float) -> Tyre:
    """Friction falls with the speed of sliding; the unknown is the loss at 60 km/h and 10°."""
    sliding = np.abs(np.tan(tyre.slip_angle)) / 0.17632698 * tyre.speed / RATED_SPEED
    return replace(tyre, fading=tyre.fading + loss * sliding)


def cross_talk(tyre: Tyre, base: Side, *, share: Float) -> Side:
    """The hub is not square: it shows a share of the load, as far as it differs from 4 kN, as side force."""
    return replace(base, side_force=base.side_force + share * (tyre.load - RATED_LOAD))


TYRE_CURVE = Model(
    name="tyre_curve",
    title="Side force of a tyre",
    function=tyre_curve,
    cites=["H. B. Pacejka, Tire and vehicle dynamics, 3rd ed., Butterworth-Heinemann 2012"],
    errors=[
        Tolerance("stiffness", normal(sd="4 %"), why="inflation and age"),
        Tolerance("friction", normal(sd="3 %"), why="drum and tread of the day"),
        acting(relaxation, Unknown("length", 0, 2, "m"), needs=[RATE]),
        acting(load_sensitivity, Unknown("exponent", -0.3, 0.6)),
        acting(ply_steer, Unknown("angle", -2, 2, "deg")),
        acting(conicity, Unknown("thrust", -0.1, 0.1)),
        acting(hot_tread, Unknown("loss", -0.005, 0.01, "1/K"), needs=[TREAD]),
        acting(polished_drum, Unknown("loss", 0, 0.4), Unknown("time_constant", 5, 300, "s"), needs=[TIME]),
        acting(fast_sliding, Unknown("loss", 0, 0.4, "", note="at 60 km/h and 10°")),
        acting(cross_talk, Unknown("share", -0.1, 0.1), on="reading"),
    ],
)
