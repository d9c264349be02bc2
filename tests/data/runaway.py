"""A reaction that heats itself and runs away: no machine can be followed beyond that."""

import numpy as np

from truing import Dynamics, Float, Model, Motion, axis, found, given, hookimpl, inputs, results, state, states


@inputs
class Vessel:
    """A reaction that heats itself: y' = y^2 / a ends at a / y0."""

    times: Float = given((0.0, 1.0, 2.0), "s", along="time")
    start: Float = given(1.0, "", above=0, below=100)
    slowness: Float = given(10.0, "s", above=0)


@states
class Heat:
    """How far it is."""

    heat: Float = state("", start="start", rate="heat**2 / slowness")


@results
class Reacted:
    """The record."""

    time: Float = axis("s", follows="times")
    heat: Float = found("", along="time")
    last: Float = found("", method="last state")


def reacting(heat: Heat, vessel: Vessel, time: Float) -> Heat:
    """The more the faster."""
    return Heat(heat=heat.heat**2 / vessel.slowness)


def reacted(vessel: Vessel, motion: Motion[Heat]) -> Reacted:
    """The record as it is read."""
    return Reacted(time=motion.time, heat=motion.states.heat, last=np.asarray(motion.states.heat)[..., -1])


RUNAWAY = Model(name="runaway", title="A reaction", function=Dynamics(rate=reacting, gives=reacted))


@hookimpl
def truing_models() -> list[Model[Vessel, Reacted]]:
    """Offer one calculation."""
    return [RUNAWAY]
