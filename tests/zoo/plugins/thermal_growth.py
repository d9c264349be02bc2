"""A spindle warms up and grows: by how much, after a programme of speeds? One thermal mass, heat as the speed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from truing import Float, Model, Tolerance, Unknown, axis, column, found, given, inputs, normal, results
from zoo.zoo import acting

TIMES = tuple(2.0 * step for step in range(61))
SPEEDS = tuple(3000.0 if step < 30 else 1500.0 for step in range(61))
HALL = tuple(0.02 * step for step in range(61))
REFERENCE_SPEED = 50.0
"""Speed at which the rise is stated, 1/s: 3000 rpm."""


@inputs
class Spindle:
    """A spindle, and the record of its speed and of the hall; a speed holds until the next time."""

    times: Float = given(TIMES, "min", along="time", note="times of the readings")
    speeds: Float = given(SPEEDS, "rpm", along="time", note="speed from each time on")
    hall_rise: Float = given(HALL, "K", along="time", note="temperature of the hall above that at the start")
    full_rise: Float = given(18.0, "K", symbol="theta_0", note="rise that it nears at 3000 rpm", above=0)
    time_constant: Float = given(25.0, "min", symbol="tau", note="of the spindle", above=0)
    length: Float = given(300.0, "mm", symbol="L", note="from its fixed bearing to the nose", above=0)
    expansion: Float = given(11.5e-6, "1/K", symbol="alpha", note="thermal expansion of steel", above=0)
    exponent: Float = given(1.0, "", symbol="e", note="of the heat over the speed", above=0)
    cooling: Float = given(0.0, "", symbol="c", note="by how much more it cools at 3000 rpm")
    pull: Float = given(0.0, "um", symbol="p", note="by which it shortens at 3000 rpm")
    housing_share: Float = given(0.0, "", symbol="h", note="growth of the housing over that of the spindle")
    housing_constant: Float = given(90.0, "min", symbol="tau_2", note="by which the housing follows", above=0)
    hall_growth: Float = given(0.0, "um/K", symbol="g", note="growth of column and bed with the hall")


@results
class Growth:
    """What the probe at the nose sees."""

    time: Float = axis("min", symbol="t", follows="times")
    rise: Float = found("K", symbol="theta", along="time", note="rise of the spindle", method="exact from step to step")
    housing: Float = found("K", note="rise of the housing", along="time", method="exact from step to step")
    growth: Float = found("um", symbol="s", along="time", note="growth at the nose", method="sum of all parts")


def thermal_growth(spindle: Spindle) -> Growth:
    """A thermal mass after a heat that holds between two times."""
    fast = np.asarray(spindle.speeds) / REFERENCE_SPEED
    exchange = np.asarray(1 + column(spindle.cooling) * fast)
    target = np.asarray(column(spindle.full_rise) * fast ** column(spindle.exponent) / exchange)
    rise = follow(target[..., :-1], np.diff(spindle.times) * exchange[..., :-1] / column(spindle.time_constant))
    between = (rise[..., :-1] + rise[..., 1:]) / 2
    housing = follow(between, np.diff(spindle.times) / column(spindle.housing_constant) + 0 * between)
    per_kelvin = column(spindle.expansion * spindle.length)
    grown = per_kelvin * (rise - column(spindle.housing_share) * housing)
    grown = grown + column(spindle.hall_growth) * spindle.hall_rise - column(spindle.pull) * fast**2
    return Growth(time=spindle.times, rise=rise, housing=housing, growth=grown)


def follow(target: NDArray[np.float64], steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Follow targets (..., m) from zero, each for a step (..., m) in units of the time constant: (..., m + 1)."""
    kept = np.exp(-steps)
    now = np.zeros(np.broadcast_shapes(target.shape, steps.shape)[:-1])
    found = [now]
    for place in range(target.shape[-1]):
        now = target[..., place] + (now - target[..., place]) * kept[..., place]
        found.append(now)
    return np.stack(found, axis=-1)


def housing_growth(spindle: Spindle, *, share: Float, constant: Float) -> Spindle:
    """The housing warms later and carries the probe along: growth is taken back, slowly."""
    slow = np.where(share > 0, constant, spindle.housing_constant)
    return replace(spindle, housing_share=spindle.housing_share + share, housing_constant=slow)


def churning(spindle: Spindle, *, more: Float) -> Spindle:
    """Heat grows with more than the first power of the speed."""
    return replace(spindle, exponent=spindle.exponent + more)


def blown_cool(spindle: Spindle, *, cooling: Float) -> Spindle:
    """A fast spindle stirs the air, and cools better."""
    return replace(spindle, cooling=spindle.cooling + cooling)


def drawn_thin(spindle: Spindle, *, pull: Float) -> Spindle:
    """Centrifugal force widens the spindle and makes it shorter."""
    return replace(spindle, pull=spindle.pull + pull)


def warm_hall(spindle: Spindle, *, growth: Float) -> Spindle:
    """Column and bed grow with the hall."""
    return replace(spindle, hall_growth=spindle.hall_growth + growth)


THERMAL_GROWTH = Model(
    name="thermal_growth",
    title="Thermal growth of a spindle",
    function=thermal_growth,
    errors=[
        Tolerance("full_rise", normal(sd="8 %"), why="preload of the bearings scatters"),
        Tolerance("time_constant", normal(sd="6 %"), why="from another spindle of the series"),
        acting(housing_growth, Unknown("share", 0, 1), Unknown("constant", 30, 400, "min")),
        acting(churning, Unknown("more", -0.6, 1, "")),
        acting(blown_cool, Unknown("cooling", 0, 1)),
        acting(drawn_thin, Unknown("pull", 0, 30, "um")),
        acting(warm_hall, Unknown("growth", -5, 5, "um/K")),
    ],
)
