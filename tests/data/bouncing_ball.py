"""A ball that bounces ever faster: it comes to no end (Zeno)."""

import numpy as np

from truing import Dynamics, Event, Float, Model, Motion, axis, found, given, hookimpl, inputs, results, state, states


@inputs
class Drop:
    """A ball let fall."""

    times: Float = given((0.0, 0.5, 1.0), "s", along="time")
    drop_height: Float = given(1.0, "m", above=0)
    restitution: Float = given(0.5, "", at_least=0, at_most=1)


@states
class Ball:
    """Where it is."""

    height: Float = state("m", start="drop_height", rate="speed")
    speed: Float = state("m/s", start=0)


@results
class Bounced:
    """The record."""

    time: Float = axis("s", follows="times")
    height: Float = found("m", along="time")
    bounces: Float = found("", method="counted events")


def falling(ball: Ball, drop: Drop, time: Float) -> Ball:
    """It falls."""
    return Ball(height=ball.speed, speed=np.full_like(ball.speed, -9.80665))


def ground(ball: Ball, drop: Drop, time: Float) -> Float:
    """How high it is."""
    return ball.height


def thrown(ball: Ball, drop: Drop, time: Float) -> Ball:
    """It goes up again, slower."""
    return Ball(height=np.zeros_like(ball.height), speed=-drop.restitution * ball.speed)


def bounced(drop: Drop, motion: Motion[Ball]) -> Bounced:
    """The record as it is read."""
    return Bounced(time=motion.time, height=motion.states.height, bounces=motion.counts["bounces"])


BALL = Model(
    name="bouncing_ball", title="A bouncing ball",
    function=Dynamics(rate=falling, gives=bounced, events=[Event("bounces", ground, when="falls", then=thrown)]),
)  # fmt: skip


@hookimpl
def truing_models() -> list[Model[Drop, Bounced]]:
    """Offer one calculation."""
    return [BALL]
