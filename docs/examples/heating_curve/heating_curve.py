"""How warm does a gear unit run? Losses heat the oil, the oil heats the housing, the housing heats the air."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from truing import (
    Dynamics,
    Effect,
    Float,
    Model,
    Motion,
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
    state,
    states,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHIFT = tuple(1200.0 * step for step in range(13))
"""Four hours, of which two under load, s."""
RUNNING, AT_REST = 6, 7
"""How many of the readings are taken under load and at rest."""


@inputs
class Unit:
    """A gear unit, the air around it, and how it is run."""

    times: Float = given(SHIFT, "s", along="time", note="when the temperature is read")
    torque: Float = given(
        (100.0,) * RUNNING + (0.0,) * AT_REST,
        "N*m",
        symbol="M",
        along="time",
        between="hold",
        note="at the input shaft",
    )
    speed: Float = given(
        (1450.0,) * RUNNING + (0.0,) * AT_REST,
        "rpm",
        symbol="omega",
        along="time",
        between="hold",
        note="of that shaft",
    )
    air: Float = given(
        (22.0,) * len(SHIFT), "degC", symbol="T_a", along="time", note="temperature of the air around it"
    )
    oil_start: Float = given(22.0, "degC", symbol="T_10", note="temperature of the oil at first")
    housing_lag: Float = given(0.0, "K", symbol="T_12", note="by which the housing is colder than the oil at first")
    load_loss: Float = given(2.0, "%", symbol="v", note="share of the power that teeth and bearings lose", at_least=0)
    drag: Float = given(0.8, "N*m", symbol="M_0", note="drag torque of warm oil, at its stated temperature", at_least=0)
    drag_temperature: Float = given(40.0, "degC", symbol="T_0", note="temperature at which the drag is stated")
    thinning: Float = given(
        0.015, "1/K", symbol="b", note="share of its drag that the oil loses per kelvin", at_least=0
    )
    oil_capacity: Float = given(8.3, "kJ/K", symbol="C_1", note="heat capacity of the oil", above=0)
    housing_capacity: Float = given(28.0, "kJ/K", symbol="C_2", note="heat capacity of housing and gears", above=0)
    contact: Float = given(30.0, "W/K", symbol="k_1", note="heat transfer from the oil to the housing", above=0)
    still_transfer: Float = given(5.0, "W/K", symbol="k_2", note="heat transfer to still air", at_least=0)
    fan_transfer: Float = given(0.0028, "W/K/rpm", symbol="k_3", note="that of the fan, per speed", at_least=0)
    fill: Float = given(1.0, "", symbol="f", note="share of the oil that is there", above=0)
    cleanness: Float = given(1.0, "", symbol="r", note="share of its heat transfer that the surface has", at_least=0)


@states
class Warmth:
    """How warm oil and housing are."""

    oil: Float = state(
        "degC",
        start="oil_start",
        symbol="T_1",
        note="temperature of the oil",
        rate="(loss - passed_on) / (fill * oil_capacity)",
    )
    housing: Float = state(
        "degC", start="oil_start", symbol="T_2", note="temperature of the housing",
        rate="(passed_on - given_off) / housing_capacity",
    )  # fmt: skip


@results
class Heated:
    """The record, and the heat that flows meanwhile."""

    time: Float = axis("min", symbol="t", follows="times")
    oil: Float = found("degC", symbol="T_1", along="time", note="temperature of the oil")
    housing: Float = found("degC", symbol="T_2", along="time", note="temperature of the housing")
    loss: Float = found(
        "W",
        symbol="P",
        along="time",
        note="power that is lost",
        formula="2 * pi * speed * (load_loss * torque + fill * drag * exp(thinning * (drag_temperature - oil)))",
        source="ISO/TR 14179-2, losses with and without load",
    )
    passed_on: Float = found(
        "W",
        symbol="Q_1",
        along="time",
        note="heat from the oil to the housing",
        formula="fill * contact * (oil - housing)",
    )
    given_off: Float = found(
        "W",
        symbol="Q_2",
        along="time",
        note="heat from the housing to the air",
        formula="cleanness * (still_transfer + fan_transfer * speed) * (housing - air)",
        source="ISO/TR 14179-2, heat dissipation through the housing",
    )
    highest: Float = found("degC", symbol="T_max", note="highest temperature of the oil", formula="max(oil)")


def loss(warmth: Warmth, unit: Unit) -> Float:
    """Power that heats the oil, W."""
    drag = unit.fill * unit.drag * np.exp(unit.thinning * (unit.drag_temperature - warmth.oil))
    return 2 * np.pi * unit.speed * (unit.load_loss * unit.torque + drag)


def passed_on(warmth: Warmth, unit: Unit) -> Float:
    """Heat that the oil passes on to the housing, W."""
    return unit.fill * unit.contact * (warmth.oil - warmth.housing)


def given_off(warmth: Warmth, unit: Unit) -> Float:
    """Heat that the housing gives off to the air, W."""
    return unit.cleanness * (unit.still_transfer + unit.fan_transfer * unit.speed) * (warmth.housing - unit.air)


def begun(unit: Unit) -> Warmth:
    """Both temperatures at first."""
    return Warmth(oil=unit.oil_start, housing=unit.oil_start - unit.housing_lag)


def warming(warmth: Warmth, unit: Unit, time: Float) -> Warmth:
    """What both temperatures gain per second."""
    passed = passed_on(warmth, unit)
    return Warmth(
        oil=(loss(warmth, unit) - passed) / (unit.fill * unit.oil_capacity),
        housing=(passed - given_off(warmth, unit)) / unit.housing_capacity,
    )


def heated(unit: Unit, motion: Motion[Warmth]) -> Heated:
    """The record as it is read."""
    feasible(unit.contact > 0, "heat flows from the warmer to the colder: contact exceeds 0")  # a fit tries what it may
    warmth, along = motion.states, in_columns(unit)
    return Heated(
        time=motion.time,
        oil=warmth.oil,
        housing=warmth.housing,
        loss=loss(warmth, along),
        passed_on=passed_on(warmth, along),
        given_off=given_off(warmth, along),
        highest=np.max(warmth.oil, axis=-1),
    )


SOCKETS = ("load_loss", "drag", "drag_temperature", "thinning", "contact", "still_transfer", "fan_transfer", "fill")


def in_columns(unit: Unit) -> Unit:
    """The inputs as they meet the record: one row per unit."""
    return replace(unit, **{name: column(getattr(unit, name)) for name in (*SOCKETS, "cleanness")})


def low_oil(unit: Unit, *, missing: Float) -> Unit:
    """Oil has leaked out: less is to be warmed and churned, and less touches the housing."""
    return replace(unit, fill=unit.fill - missing)


def fouling(unit: Unit, *, share: Float) -> Unit:
    """Dust and oil cover the housing, so that it gives off less heat, running and standing."""
    return replace(unit, cleanness=unit.cleanness * (1 - share))


def blocked_fan(unit: Unit, *, share: Float) -> Unit:
    """The fan moves less air."""
    return replace(unit, fan_transfer=unit.fan_transfer * (1 - share))


def rough_mesh(unit: Unit, *, extra: Float) -> Unit:
    """Worn flanks or bearings rub more under load."""
    return replace(unit, load_loss=unit.load_loss + extra)


EFFECTS = [
    Effect(
        "low_oil", on_inputs=low_oil, looks_like="the oil warms and cools faster, further ahead of the housing",
        remedy="Find the leak and fill the oil up; it then warms and cools more slowly, and closer to the housing.",
        unknowns=[Unknown("missing", 0, 0.8, note="share of the oil that is not there")],
    ),
    Effect(
        "fouling", on_inputs=fouling, looks_like="warmer, and slower to cool at rest as well",
        remedy="Clean the housing; the unit then runs cooler, and cools faster at rest as well.",
        unknowns=[Unknown("share", 0, 0.8, note="share of the heat transfer that is lost")],
    ),
    Effect(
        "blocked_fan", on_inputs=blocked_fan, looks_like="warmer while it runs, and it cools at rest as it should",
        remedy="Clear the fan and its guard; the unit then runs cooler, and cools at rest as before.",
        unknowns=[Unknown("share", 0, 1, note="share of its heat transfer that the fan lacks")],
    ),
    Effect(
        "rough_mesh", on_inputs=rough_mesh, looks_like="warmer under load, in proportion to the power",
        remedy="Look at flanks and bearings, and replace what is worn; the unit then runs cooler under load.",
        unknowns=[Unknown("extra", 0, 5, "%", note="share of the power that is lost besides")],
    ),
]  # fmt: skip

TOLERANCES = [
    Tolerance("housing_capacity", normal(sd="2 %"), why="from weights"),
    Tolerance("housing_lag", normal(sd="2 K"), why="every record begins with its own"),
]


def draw_warmth(record: Record[Unit, Heated]) -> "Figure":
    """Temperatures over time, and the heat that comes and goes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.2), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    minutes, shown = np.asarray(record.results.time) / 60, record.results
    above.plot(minutes, np.asarray(shown.oil) - 273.15, label="oil")
    above.plot(minutes, np.asarray(shown.housing) - 273.15, label="housing")
    above.plot(minutes, np.asarray(record.acting.air) - 273.15, label="air", color="0.6")
    above.set_ylabel("temperature, °C")
    above.legend(frameon=False)
    below.step(minutes, shown.loss, where="post", label="lost")
    below.plot(minutes, shown.given_off, label="given off")
    below.set_ylabel("power, W")
    below.set_xlabel("time, min")
    below.legend(frameon=False)
    return figure


HEATING_CURVE = Model(
    name="heating_curve",
    title="Heating curve of a gear unit",
    summary="Temperatures of oil and housing while a gear unit runs under load and cools at rest.",
    function=Dynamics(rate=warming, start=begun, gives=heated, settled=1e-4),  # heat passed on is a small difference
    errors=[*TOLERANCES, *EFFECTS],
    cites=["ISO/TR 14179-2:2001, Gears - Thermal capacity - Part 2: Thermal load-carrying capacity"],
    sheet=[
        Section("Temperatures", "oil", "housing", "highest", figure=draw_warmth),
        Section("Heat", "loss", "passed_on", "given_off"),
    ],
)


@hookimpl
def truing_models() -> list[Model[Unit, Heated]]:
    """Offer one calculation: heating_curve."""
    return [HEATING_CURVE]
