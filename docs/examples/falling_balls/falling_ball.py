"""A ball falls from a bridge: how high is it after each frame of a video? In vacuum, unless told otherwise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
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
)

PI = 3.141592653589793
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


@inputs
class Drop:
    """One drop of one ball: what was weighed and measured, when it was let go, and what a vacuum leaves out."""

    mass: Float = given(28.35, "g", symbol="m", note="mass of the ball", above=0)
    diameter: Float = given(72.6, "mm", symbol="d", note="diameter of the ball", above=0)
    release_height: Float = given(47.0, "m", symbol="h_0", note="height at which it is let go")
    release_time: Float = given(0.1, "s", symbol="t_0", note="time at which it is let go; the video starts at 0")
    clock_rate: Float = given(1.0, "", symbol="c", note="seconds that pass per second of the video", above=0)
    gravity: Float = given(9.81, "m/s^2", symbol="g", note="acceleration of fall", source="Vancouver", above=0)
    air_density: Float = given(1.2, "kg/m^3", symbol="rho", note="density of air", at_least=0)
    drag_coefficient: Float = given(0.0, "", symbol="c_d", note="drag coefficient of the ball; 0 is a vacuum")
    viscosity: Float = given(0.0, "Pa*s", symbol="eta", note="viscosity of the air; 0 is a vacuum")
    lift_of_air: Float = given(0.0, "", symbol="b", note="share of the buoyancy that acts; 0 is a vacuum")
    frames: Float = given((0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0), "s", symbol="t_i", note="times of frames", along="time")


@results
class Fall:
    """Where the ball is."""

    time: Float = axis("s", symbol="t", follows="frames")
    height: Float = found("m", symbol="h", along="time", note="height on the video", method="integral of the speed")
    speed: Float = found("m/s", symbol="v", along="time", note="speed of fall", method="exact")
    lightness: Float = found(
        "1/m",
        symbol="k",
        note="how light the ball is for the air",
        formula="air_density * pi * diameter**2 / (8 * mass)",
    )


def falling_ball(drop: Drop) -> Fall:
    """Straight down from rest: weight, buoyancy, drag in proportion to speed and to its square."""
    lightness = drop.air_density * PI * drop.diameter**2 / (8 * drop.mass)
    displaced = drop.air_density * PI * drop.diameter**3 / 6
    pull = drop.gravity * (1 - drop.lift_of_air * displaced / drop.mass)
    feasible(pull >= 0, "the ball is lighter than the air: it rises")
    linear = 3 * PI * drop.viscosity * drop.diameter / drop.mass
    square = lightness * drop.drag_coefficient
    falling = np.maximum(column(drop.clock_rate) * drop.frames - column(drop.release_time), 0.0)
    speed, way = fall_from_rest(falling, column(pull), column(linear), column(square))
    return Fall(time=drop.frames, height=column(drop.release_height) - way, speed=speed, lightness=lightness)


def fall_from_rest(time: Float, pull: Float, linear: Float, square: Float) -> tuple[Float, Float]:
    """Return speed and way after a time of ``dv/dt = pull - linear*v - square*v**2``, to 1e-9."""
    root = np.sqrt(linear**2 / 4 + pull * square)

    def speed(after: Float, root: Float, pull: Float, linear: Float) -> Float:
        slow = root * after < 1e-6
        grown = np.where(slow, after, np.tanh(root * after) / np.where(slow, 1.0, root))
        return pull * grown / (1 + linear / 2 * grown)

    within = np.expand_dims(time, -1) * (NODES + 1) / 2
    inner = speed(within, *(np.expand_dims(one, -1) for one in (root, pull, linear)))
    return speed(time, root, pull, linear), time * np.sum(inner * WEIGHTS, axis=-1) / 2


def air_drag(drop: Drop, *, drag_coefficient: Float) -> Drop:
    """The ball pushes air out of its way: a force as the square of speed."""
    return replace(drop, drag_coefficient=drop.drag_coefficient + drag_coefficient)


def stokes_drag(drop: Drop, *, viscosity: Float) -> Drop:
    """The air is tough: a force in proportion to speed. Air has 1.8e-5 Pa s."""
    return replace(drop, viscosity=drop.viscosity + viscosity)


def buoyancy(drop: Drop, *, share: Float) -> Drop:
    """The air that the ball displaces carries a part of it; a share of 1 is the rule of Archimedes."""
    return replace(drop, lift_of_air=drop.lift_of_air + share)


def slow_clock(drop: Drop, *, slow: Float) -> Drop:
    """The camera takes its frames further apart than it says, by up to 2 %."""
    return replace(drop, clock_rate=drop.clock_rate * (1 + slow))


def sensor_gain(drop: Drop, base: Fall, *, height: Float) -> Fall:
    """A metre on the video is longer or shorter than a metre, by up to 5 %."""
    return replace(base, height=base.height * column(1 + height))


def effect(function: Callable[..., Drop], *unknowns: Unknown, looks_like: str) -> Effect[Drop, Fall]:
    """Declare an effect on the inputs under the name of its function."""
    why = str(function.__doc__).splitlines()[0].rstrip(".")
    return Effect(function.__name__, on_inputs=function, unknowns=list(unknowns), looks_like=looks_like, why=why)


FALLING_BALL = Model(
    name="falling_ball",
    title="A ball falls from a bridge",
    function=falling_ball,
    cites=[
        "B. M. de Silva, D. M. Higdon, S. L. Brunton, J. N. Kutz, Discovery of physics from data: universal laws and "
        "discrepancies, Front. Artif. Intell. 3 (2020) 25",
    ],
    errors=[
        Tolerance("release_height", normal(sd="2 m"), why="held over a rail"),
        Tolerance("release_time", normal(sd="0.1 s"), why="the first frame was chosen by eye"),
        effect(
            air_drag,
            Unknown("drag_coefficient", 0, 2, "", note="a smooth sphere 0.1 to 0.5, a ball with holes up to 0.9"),
            looks_like="lags behind, most at the end; light and large balls most",
        ),
        effect(stokes_drag, Unknown("viscosity", 0, 1e-3, "Pa*s"), looks_like="lags behind; the small and light most"),
        effect(buoyancy, Unknown("share", 0, 3), looks_like="falls less fast from the very first frame"),
        Effect(
            "sensor_gain",
            on_reading=sensor_gain,
            unknowns=[Unknown("height", -0.05, 0.05)],
            looks_like="all heights are too large or too small in proportion",
            why="the scale of the video was taken from what could be seen of the bridge",
        ),
        effect(slow_clock, Unknown("slow", -0.02, 0.02), looks_like="all balls alike fall too fast or too slowly"),
    ],
    sheet=[Section("Ball", "lightness"), Section("Fall", "height", "speed")],
)


@hookimpl
def truing_models() -> list[Model[Drop, Fall]]:
    """Offer one calculation: falling_ball."""
    return [FALLING_BALL]
