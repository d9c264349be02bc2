"""Two tanks, one above the other: a pump fills the upper one, which empties into the lower one, which drains."""

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dtbtrs

from truing import (
    Effect,
    Float,
    Model,
    Record,
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

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
FULL = 10.0
"""Level of a full tank on the scale of the gauge, V; the gauge reads no more."""
CREST = 0.2
"""How far below its rim a tank begins to spill, V: the water is not still. At the rim all that is to run over does."""
FILM = 0.1
"""Level below which an outlet draws air and runs in proportion to the level, V: so an empty tank stays empty."""
LONGEST_STEP = 2.0
"""Longest step of the calculation, s."""
RAMP = (*(0.12 * step for step in range(51)), *(6.0 - 0.12 * step for step in range(51)))
"""A pump that is turned up to 6 V and down again, V."""
RAMP_TIMES = tuple(8.0 * step for step in range(len(RAMP)))
MOST_ROUNDS = 60
COARSE, LONG_RECORD = 8, 1000
"""Steps that are taken as one for levels to begin with, in records of so many steps."""
SETTLED = 1e-6
"""V; the error is then about its square."""


@inputs
class Tanks:
    """Two tanks, pump and record; levels are measured in volts of the gauge, flows in volts per second.

    With the outflow k sqrt(x) of Torricelli, ``upper_outflow`` is k1 sqrt(10 V) of the literature, ``lower_outflow`` is
    k3 sqrt(10 V), ``section_ratio`` is k2 / k1 and ``pump_rate`` is k4.
    """

    times: Float = given(RAMP_TIMES, "s", along="time", note="when the voltage is set")
    pump_voltage: Float = given(RAMP, "V", symbol="u", along="time", note="held until the next time")
    pump_rate: Float = given(0.04, "1/s", symbol="k_4", note="rise of the upper level, per volt of the pump", above=0)
    upper_outflow: Float = given(0.16, "V/s", symbol="q_1", note="outflow of a full upper tank", above=0)
    lower_outflow: Float = given(0.16, "V/s", symbol="q_3", note="outflow of a full lower tank", above=0)
    section_ratio: Float = given(1.0, "", symbol="a", note="section of the upper tank over that of the lower", above=0)
    upper_start: Float = given(5.2, "V", symbol="x_10", note="level of the upper tank at the start", at_least=0)
    lower_start: Float = given(5.2, "V", symbol="x_20", note="level of the lower tank at the start", at_least=0)
    upper_exponent: Float = given(0.5, "", symbol="e_1", note="of the upper outlet; 1/2 after Torricelli", above=0)
    lower_exponent: Float = given(0.5, "", symbol="e_3", note="of the lower outlet; 1/2 after Torricelli", above=0)
    upper_rim: Float = given(FULL, "V", symbol="r_1", note="level that a full upper tank does not pass", above=0)
    upper_spill: Float = given(
        0.0, "", symbol="s_1", note="share of the surplus that runs over it", at_least=0, at_most=1
    )
    caught_share: Float = given(
        0.5, "", symbol="c", note="share of the spilt water that the lower tank catches", at_least=0, at_most=1
    )
    lower_spill: Float = given(
        0.0, "", symbol="s_2", note="share that runs over a full lower tank", at_least=0, at_most=1
    )
    upper_leak: Float = given(0.0, "1/s", symbol="l_1", note="seepage of the upper tank, per volt", at_least=0)
    lower_leak: Float = given(0.0, "1/s", symbol="l_2", note="seepage of the lower tank, per volt", at_least=0)
    dead_voltage: Float = given(0.0, "V", symbol="u_0", note="below it the pump does not turn", at_least=0)
    pump_bend: Float = given(0.0, "1/V", symbol="b", note="what the pump delivers more, per volt and volt")


NUMBERS = tuple(item.name for item in fields(Tanks) if item.name not in {"times", "pump_voltage"})
"""Every input that is one number per row."""


@results
class Levels:
    """The record, and where it would end."""

    time: Float = axis("s", symbol="t", follows="times")
    upper_level: Float = found(
        "V", symbol="x_1", along="time", note="level of the upper tank", method="trapezoidal rule, all steps at once"
    )
    level: Float = found(
        "V", symbol="x_2", along="time", note="level of the lower tank", method="trapezoidal rule, all steps at once"
    )
    highest: Float = found("V", symbol="x_2max", note="highest level of the lower tank", formula="max(level)")
    pumped: Float = found("V", note="water pumped, in volts of the upper tank", method="sum over the steps")
    drained: Float = found("V", note="water through the lower outlet, in the same unit", method="sum over the steps")
    lost: Float = found("V", note="water spilt and leaked, in the same unit", method="sum over the steps")


@dataclass(frozen=True)
class Tank:
    """What leaves one tank; every field is a number or an array (n, 1)."""

    outflow: Float
    exponent: Float
    rim: Float
    spill: Float
    leak: Float

    def outlet(self, level: Array) -> tuple[Array, Array]:
        """What leaves through the outlet at a level, V/s, and how much more it is per volt of level, 1/s."""
        deep = np.maximum(level, FILM)
        per_volt = self.outflow * (deep / FULL) ** self.exponent / deep
        return np.asarray(per_volt * np.minimum(level, deep)), np.asarray(
            per_volt * np.where(level > FILM, self.exponent, 1)
        )

    def over(self, level: Array, inflow: Array, outflow: Array, slope: Array) -> tuple[Array, Array]:
        """What leaves over the rim, V/s, and how much more it is per volt of level, 1/s; all (n, m).

        It is a share of the surplus: of what ``outflow``, with its ``slope``, leaves of the inflow. Most levels are far
        below the rim and are left out.
        """
        over, more = np.zeros((2, *inflow.shape))
        high = (level > self.rim - CREST) & (inflow > outflow)
        rim, share = (np.broadcast_to(value, inflow.shape)[high] for value in (self.rim, self.spill))
        height, surplus = 1 + (level[high] - rim) / CREST, inflow[high] - outflow[high]
        over[high] = share * np.minimum(height, 1) * surplus
        more[high] = share * (surplus / CREST * (height < 1) - np.minimum(height, 1) * slope[high])
        return over, more


@dataclass(frozen=True)
class Flows:
    """What leaves a tank: at each level, (n, m + 1), and over the rim in each step, (n, m), in V/s; slopes in 1/s."""

    out: Array
    seeped: Array
    spilt: Array
    begin_slope: Array
    end_slope: Array

    @property
    def leaving(self) -> Array:
        """All that leaves, the mean of each step."""
        return np.asarray(mean(self.out + self.seeped) + self.spilt)


def flows(tank: Tank, level: Array, inflow: Array) -> Flows:
    """What leaves a tank that stands at these levels while so much comes in."""
    out, slope = tank.outlet(level)
    seeped = np.asarray(tank.leak * level)
    both, slopes, spilt = out + seeped, slope + tank.leak, np.zeros(inflow.shape)
    begin, end = slopes[:, :-1], slopes[:, 1:]
    if np.any(tank.spill):
        first, more = tank.over(level[:, :-1], inflow, both[:, :-1], begin)
        last, rise = tank.over(level[:, 1:], inflow, both[:, 1:], end)
        spilt, begin, end = (first + last) / 2, begin + more, end + rise
    return Flows(out=out, seeped=seeped, spilt=spilt, begin_slope=begin, end_slope=end)


def mean(values: Array) -> Array:
    """Mean of each step, (n, m), of values at its two ends, (n, m + 1)."""
    return np.asarray((values[:, :-1] + values[:, 1:]) / 2)


def roughly(tank: Tank, start: Array, inflow: Array, step: Array) -> Array:
    """Levels to begin with, (n, m + 1): those of longer steps, with straight lines between; nothing passes the rim."""
    level = np.repeat(start[:, None], len(step) + 1, axis=1)
    if len(step) < LONG_RECORD:
        return level
    ends = np.arange(0, len(step), COARSE)
    length = np.add.reduceat(step, ends)
    coarse, _ = filled(replace(tank, spill=0.0), start, np.add.reduceat(inflow * step, ends, axis=1) / length, length)
    rise = np.repeat(np.diff(coarse) / length, COARSE, axis=1)[:, : len(step)]
    level[:, 1:] += np.cumsum(rise * step, axis=1)
    return np.where(np.isfinite(level), np.where(tank.spill > 0, np.minimum(level, tank.rim), level), start[:, None])


def filled(tank: Tank, start: Array, inflow: Array, step: Array) -> tuple[Array, Flows]:
    """Follow the level of a tank from its start (n,): levels (n, m + 1) in V, NaN in a row that comes to no end.

    ``inflow`` (n, m) is the mean over each of the m steps, ``step`` (m,) their lengths in s. The trapezoidal rule: all
    steps of all rows are one bidiagonal system of equations, solved by Newton's method.
    """
    level = roughly(tank, start, inflow, step)
    now, change = flows(tank, level, inflow), np.zeros(level.shape)
    table, left = np.zeros((*level.shape, 2)), np.zeros(level.shape)
    table[:, 0, 0] = 1
    for _ in range(MOST_ROUNDS):
        left[:, 1:] = np.diff(level) + step * (now.leaving - inflow)
        table[:, 1:, 0] = 1 + step / 2 * now.end_slope
        table[:, :-1, 1] = step / 2 * now.begin_slope - 1
        change = dtbtrs(table.reshape(-1, 2).T, left.reshape(-1, 1), uplo="L")[0].reshape(level.shape)
        level = level - change
        now = flows(tank, level, inflow)
        if not np.max(np.abs(change)) > SETTLED:
            break
    settled = np.max(np.abs(change), axis=-1, keepdims=True) <= SETTLED
    return np.where(settled, level, np.nan), now


def delivered(tanks: Tanks, voltage: Array) -> Array:
    """What the pump delivers at a voltage (k,), (n, k) in V/s."""
    turning = np.maximum(voltage - column(tanks.dead_voltage), 0)
    return np.asarray(column(tanks.pump_rate) * turning * (1 + column(tanks.pump_bend) * turning))


def cascaded_tanks(tanks: Tanks) -> Levels:
    """Torricelli's law for two tanks; numbers or arrays (n,), series (k,).

    The upper level follows x1' = k4 u - k1 sqrt(x1), the lower one x2' = k2 sqrt(x1) - k3 sqrt(x2). The voltage is held
    from each time to the next.
    """
    times, voltage = np.asarray(tanks.times, dtype=float), np.asarray(tanks.pump_voltage, dtype=float)
    feasible(len(times) == len(voltage) and len(times) > 1, "times and pump_voltage are not equally long series")
    feasible(np.all(np.diff(times) > 0), "the times of the record do not rise from row to row")
    parts = int(np.ceil(np.max(np.diff(times)) / LONGEST_STEP - 1e-9))
    step = np.repeat(np.diff(times) / parts, parts)
    size = np.broadcast(*(getattr(tanks, name) for name in NUMBERS)).shape
    rows, ratio = size or (1,), column(tanks.section_ratio)
    pumped = np.broadcast_to(delivered(tanks, voltage), (*rows, len(times)))[:, :-1].repeat(parts, axis=1)
    above, upper = filled(uppermost(tanks), np.broadcast_to(tanks.upper_start, rows), pumped, step)
    caught = column(tanks.caught_share) * upper.spilt
    below, lower = filled(
        lowermost(tanks), np.broadcast_to(tanks.lower_start, rows), ratio * (mean(upper.out) + caught), step
    )
    feasible(np.isfinite(below[:, -1]).reshape(size), "the levels cannot be calculated: a step comes to no end")
    lost = upper.spilt - caught + mean(upper.seeped) + (lower.spilt + mean(lower.seeped)) / ratio
    return Levels(
        time=times,
        upper_level=above[:, ::parts].reshape(*size, len(times)),
        level=below[:, ::parts].reshape(*size, len(times)),
        highest=np.max(below[:, ::parts], axis=-1).reshape(size),
        pumped=(pumped @ step).reshape(size),
        drained=(mean(lower.out) / ratio @ step).reshape(size),
        lost=(lost @ step).reshape(size),
    )


def uppermost(tanks: Tanks) -> Tank:
    """The upper tank."""
    own = (tanks.upper_outflow, tanks.upper_exponent, tanks.upper_rim, tanks.upper_spill, tanks.upper_leak)
    return Tank(*map(column, own))


def lowermost(tanks: Tanks) -> Tank:
    """The lower tank, whose rim is where the gauge ends."""
    own = (tanks.lower_outflow, tanks.lower_exponent, FULL, tanks.lower_spill, tanks.lower_leak)
    return Tank(*map(column, own))


def overflow(tanks: Tanks, *, spill: Float, rim: Float, caught: Float) -> Tanks:
    """A full upper tank runs over: it spills what comes in and does not drain; the lower tank catches a share."""
    return replace(tanks, upper_spill=tanks.upper_spill + spill, upper_rim=rim, caught_share=caught)


def lower_overflow(tanks: Tanks, *, spill: Float) -> Tanks:
    """Water runs over the rim of the lower tank."""
    return replace(tanks, lower_spill=tanks.lower_spill + spill)


def outlet_losses(tanks: Tanks, *, upper: Float = 0.0, lower: Float = 0.0) -> Tanks:
    """Losses that grow with the flow: the outflow follows another power of the level than 1/2."""
    return replace(tanks, upper_exponent=tanks.upper_exponent + upper, lower_exponent=tanks.lower_exponent + lower)


def leak(tanks: Tanks, *, upper: Float = 0.0, lower: Float = 0.0) -> Tanks:
    """Water seeps away in proportion to the level."""
    return replace(tanks, upper_leak=tanks.upper_leak + upper, lower_leak=tanks.lower_leak + lower)


def dead_zone(tanks: Tanks, *, below: Float) -> Tanks:
    """The pump does not turn below a voltage, and above it delivers in proportion to the rest."""
    return replace(tanks, dead_voltage=tanks.dead_voltage + below)


def pump_curve(tanks: Tanks, *, bend: Float) -> Tanks:
    """The pump delivers more, or less, than in proportion to its voltage."""
    return replace(tanks, pump_bend=tanks.pump_bend + bend)


def sensor_ceiling(tanks: Tanks, base: Levels, *, missed: Float) -> Levels:
    """The gauge ends at 10 V: a share of what is above is not shown; 1 is a gauge that is at its stop."""
    return replace(base, level=base.level - column(missed) * np.maximum(base.level - FULL, 0))


EFFECTS = [
    Effect(
        "overflow", on_inputs=overflow,
        looks_like="while the pump runs fast the lower level leaps ahead, and lacks the water afterwards",
        unknowns=[
            Unknown("spill", 0, 1, note="share of the surplus that runs over"),
            Unknown("rim", 4, 16, "V", note="level of the rim"),
            Unknown("caught", 0.05, 1, note="share that falls into the lower tank"),
        ],
    ),
    Effect(
        "lower_overflow", on_inputs=lower_overflow, looks_like="the level cannot rise above 10 V, and falls at once",
        unknowns=[Unknown("spill", 0, 1, note="share of the surplus that runs over")],
    ),
    Effect(
        "outlet_losses", on_inputs=outlet_losses, parts=[["upper"], ["lower"]],
        looks_like="high and low levels err to opposite sides",
        unknowns=[
            Unknown("upper", -0.3, 0.5, note="change of the exponent of the upper outlet"),
            Unknown("lower", -0.3, 0.5, note="change of the exponent of the lower outlet"),
        ],
    ),
    Effect(
        "leak", on_inputs=leak, parts=[["upper"], ["lower"]], looks_like="all levels too low, high ones more",
        unknowns=[
            Unknown("upper", 0, 0.01, "1/s", note="seepage of the upper tank, per volt"),
            Unknown("lower", 0, 0.01, "1/s", note="seepage of the lower tank, per volt"),
        ],
    ),
    Effect(
        "dead_zone", on_inputs=dead_zone, looks_like="low voltages fill less than high ones",
        unknowns=[Unknown("below", 0, 1, "V", note="voltage at which the pump begins to turn")],
    ),
    Effect(
        "pump_curve", on_inputs=pump_curve, looks_like="high voltages fill more, or less, than low ones",
        unknowns=[Unknown("bend", -0.1, 0.2, "1/V", note="what is delivered more, per volt and volt")],
    ),
    Effect(
        "sensor_ceiling", on_reading=sensor_ceiling, looks_like="the gauge stands at 10 V",
        unknowns=[Unknown("missed", 0, 1, note="share of what is above 10 V that is not shown")],
    ),
]  # fmt: skip

TOLERANCES = [
    Tolerance("pump_rate", normal(sd="10 %"), why="pump and hose are not calibrated"),
    Tolerance("outflows", normal(sd="10 %"), on=["upper_outflow", "lower_outflow"], why="bores and edges of outlets"),
    Tolerance("section_ratio", normal(sd="3 %"), why="two tubes of one kind"),
    Tolerance("upper_start", normal(sd="1 V"), why="nobody measured it; the record begins near a balance"),
    Tolerance("lower_start", normal(sd="0.1 V"), why="from the first readings"),
]


def draw_levels(record: Record[Tanks, Levels]) -> "Figure":
    """Both levels over time, and the voltage of the pump."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 3.6), layout="constrained")
    above, below = figure.subplots(2, sharex=True, height_ratios=(2, 1))
    above.plot(record.results.time, record.results.upper_level, label="upper tank")
    above.plot(record.results.time, record.results.level, label="lower tank")
    above.axhline(FULL, color="0.6", linewidth=0.8)
    above.set_ylabel("level, V")
    above.legend(frameon=False)
    below.step(record.inputs.times, np.asarray(record.inputs.pump_voltage), where="post", color="0.3")
    below.set_ylabel("pump, V")
    below.set_xlabel("time, s")
    return figure


CITES = [
    "M. Schoukens, P. Mattsson, T. Wigren, J.-P. Noel, Cascaded tanks benchmark combining soft and hard "
    "nonlinearities, Workshop on Nonlinear System Identification Benchmarks, Brussels 2016",
]

CASCADED_TANKS = Model(
    name="cascaded_tanks",
    title="Two tanks in cascade",
    summary="Torricelli's law, without losses and with tanks that have no rim.",
    function=cascaded_tanks,
    cites=CITES,
    errors=[*TOLERANCES, *EFFECTS],
    sheet=[
        Section("Levels", "upper_level", "level", "highest", figure=draw_levels, caption="The line is a full tank."),
        Section("Balance of the water", "pumped", "drained", "lost"),
    ],
)


@hookimpl
def truing_models() -> list[Model[Tanks, Levels]]:
    """Offer one calculation: cascaded_tanks."""
    return [CASCADED_TANKS]
