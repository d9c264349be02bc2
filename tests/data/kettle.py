"""A kettle: water that is heated and loses heat to the room, the smallest model that moves."""

import numpy as np

from truing import (
    Dynamics,
    Event,
    Float,
    Model,
    Motion,
    axis,
    feasible,
    found,
    given,
    inputs,
    results,
    state,
    states,
)


@inputs
class Kettle:
    """Water that is heated and loses heat to the room."""

    times: Float = given(tuple(float(t) for t in range(0, 601, 60)), "s", along="time", note="when it is read")
    power: Float = given((1000.0,) * 11, "W", along="time", between="hold", note="of the heater")
    room: Float = given(20.0, "degC", note="around it")
    start: Float = given(20.0, "degC", note="of the water at first")
    capacity: Float = given(4000.0, "J/K", symbol="C", note="of the water", above=0)
    loss: Float = given(10.0, "W/K", symbol="k", note="to the room", at_least=0)


@states
class Water:
    """How warm it is."""

    temperature: Float = state(
        "degC", start="start", symbol="T", note="of the water", rate="(power - loss * (temperature - room)) / capacity"
    )


@results
class Heated:
    """The record."""

    time: Float = axis("s", symbol="t", follows="times")
    warm: Float = found("degC", along="time", note="of the water")
    hot_at: Float = found("s", note="when it passes 60 degC", method="located event")


def heating(water: Water, kettle: Kettle, time: Float) -> Water:
    """What it gains per second."""
    return Water(temperature=(kettle.power - kettle.loss * (water.temperature - kettle.room)) / kettle.capacity)


def above_sixty(water: Water, kettle: Kettle, time: Float) -> Float:
    """How far it is above 60 degC."""
    return water.temperature - 333.15


def heated(kettle: Kettle, motion: Motion[Water]) -> Heated:
    """The record as it is read."""
    feasible(np.isfinite(motion.first["hot"]), "the water never passes 60 degC", only=["hot_at"])
    return Heated(time=motion.time, warm=motion.states.temperature, hot_at=motion.first["hot"])


HEATING = Dynamics(rate=heating, gives=heated, events=[Event("hot", above_sixty, when="rises")])
KETTLE = Model(name="kettle", title="A kettle", function=HEATING)
