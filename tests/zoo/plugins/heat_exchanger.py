"""A plate heat exchanger, water to water, in counterflow: how cold does the hot side leave?"""

from dataclasses import replace

import numpy as np

from truing import Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from zoo.zoo import acting

ROOM = 293.15
"""Temperature of the test hall, K."""
RATED_FLOW = 2.0
"""Flow at which the film conductances are stated, kg/s."""
RATED_HOT, RATED_COLD = 333.15, 308.15
"""Mean temperatures of the two sides at which they are stated, K."""
PASSES = 4
"""How often the mean temperatures are calculated anew."""


@inputs
class Exchanger:
    """What is on the data sheet, and one operating point."""

    hot_flow: Float = given(2.0, "kg/s", symbol="m_h", note="flow of the hot side", above=0)
    cold_flow: Float = given(2.0, "kg/s", symbol="m_c", note="flow of the cold side", above=0)
    hot_inlet: Float = given(75.0, "degC", symbol="T_h1", note="temperature of the hot side where it enters")
    cold_inlet: Float = given(20.0, "degC", symbol="T_c1", note="temperature of the cold side where it enters")
    hot_film: Float = given(60.0, "kW/K", symbol="G_h", note="film of the hot side at 2 kg/s", above=0)
    cold_film: Float = given(50.0, "kW/K", symbol="G_c", note="film of the cold side at 2 kg/s", above=0)
    wall: Float = given(180.0, "kW/K", symbol="G_w", note="conductance of the plates", source="0.5 mm steel", above=0)
    heat_capacity: Float = given(4.18, "kJ/(kg*K)", symbol="c", note="heat capacity of water", above=0)
    hot_exponent: Float = given(0.7, "", symbol="e_h", note="of the hot film over the flow", source="chevron plates")
    cold_exponent: Float = given(0.7, "", symbol="e_c", note="of the cold film over the flow", source="chevron plates")
    warmth: Float = given(5e-3, "1/K", symbol="w", note="growth of a film per kelvin", source="properties of water")
    bypass: Float = given(0.0, "", symbol="b", note="share of the hot flow that misses the plates", below=1)
    fouling: Float = given(0.0, "K/kW", symbol="R_f", note="resistance of deposits", at_least=0)
    loss: Float = given(0.0, "kW/K", symbol="G_l", note="conductance from the hot side to the hall", at_least=0)
    blanked: Float = given(0.0, "", symbol="a", note="share of the plates that air keeps dry", below=1)


@results
class Outlet:
    """What leaves the exchanger."""

    through: Float = found("kg/s", symbol="m_p", note="hot flow between the plates", formula="hot_flow * (1 - bypass)")
    conductance: Float = found("kW/K", symbol="G", note="from water to water", method="films in series with the plates")
    effectiveness: Float = found("", symbol="epsilon", note="of the flow between the plates", method="counterflow")
    hot_outlet: Float = found("degC", symbol="T_h2", note="temperature of the hot side where it leaves", method="mixed")


def heat_exchanger(exchanger: Exchanger) -> Outlet:
    """Effectiveness and number of transfer units, films at the mean temperatures (VDI heat atlas, C1)."""
    through = exchanger.hot_flow * (1 - exchanger.bypass)
    feasible(through > 0, "no hot water flows between the plates")
    span = exchanger.hot_inlet - exchanger.cold_inlet
    capacity, other = through * exchanger.heat_capacity, exchanger.cold_flow * exchanger.heat_capacity
    conductance: Float = exchanger.wall
    effectiveness: Float = 0.5
    for _ in range(PASSES):
        conductance = between(exchanger, through, effectiveness * span, effectiveness * span * capacity / other)
        effectiveness = counterflow(conductance / capacity, capacity / other)
    cooled = exchanger.hot_inlet - effectiveness * span
    mixed = exchanger.bypass * exchanger.hot_inlet + (1 - exchanger.bypass) * cooled
    lost = exchanger.loss * (exchanger.hot_inlet - ROOM) / (exchanger.hot_flow * exchanger.heat_capacity)
    return Outlet(through=through, conductance=conductance, effectiveness=effectiveness, hot_outlet=mixed - lost)


def between(exchanger: Exchanger, through: Float, cooling: Float, heating: Float) -> Float:
    """Conductance from water to water, W/K, of films at the mean temperatures of water cooled and heated so much."""
    hot_mean, cold_mean = exchanger.hot_inlet - cooling / 2, exchanger.cold_inlet + heating / 2
    hot = exchanger.hot_film * (through / RATED_FLOW) ** exchanger.hot_exponent
    cold = exchanger.cold_film * (exchanger.cold_flow / RATED_FLOW) ** exchanger.cold_exponent
    warm, cool = 1 + exchanger.warmth * (hot_mean - RATED_HOT), 1 + exchanger.warmth * (cold_mean - RATED_COLD)
    resistance = exchanger.fouling + 1 / exchanger.wall + 1 / (hot * warm) + 1 / (cold * cool)
    return (1 - exchanger.blanked) / resistance


def counterflow(units: Float, ratio: Float) -> Float:
    """Share of the largest possible cooling; units and ratio of capacities are of the cooled side."""
    even = np.abs(ratio - 1) < 1e-6
    uneven = np.where(even, 0.5, ratio)
    fallen = np.exp(-units * (1 - uneven))
    return np.where(even, units / (1 + units), (1 - fallen) / (1 - uneven * fallen))


def gasket_bypass(exchanger: Exchanger, *, share: Float) -> Exchanger:
    """A gasket has slipped: a share of the hot water runs past the plates and mixes in behind them."""
    return replace(exchanger, bypass=exchanger.bypass + share)


def hot_flow_exponent(exchanger: Exchanger, *, less: Float) -> Exchanger:
    """The hot film depends less on the flow than the rule says: the flow is not fully turbulent."""
    return replace(exchanger, hot_exponent=exchanger.hot_exponent - less)


def cold_flow_exponent(exchanger: Exchanger, *, less: Float) -> Exchanger:
    """The cold film depends less on the flow than the rule says."""
    return replace(exchanger, cold_exponent=exchanger.cold_exponent - less)


def deposits(exchanger: Exchanger, *, resistance: Float) -> Exchanger:
    """Scale on the plates adds a resistance that no flow washes away."""
    return replace(exchanger, fouling=exchanger.fouling + resistance)


def heat_to_the_hall(exchanger: Exchanger, *, conductance: Float) -> Exchanger:
    """The frame is not insulated: the hot side loses heat to the hall, felt most at small flow."""
    return replace(exchanger, loss=exchanger.loss + conductance)


def trapped_air(exchanger: Exchanger, *, share: Float, flow: Float) -> Exchanger:
    """Air stands between some plates until the cold flow carries it away."""
    return replace(exchanger, blanked=exchanger.blanked + share * np.exp(-exchanger.cold_flow / flow))


def short_pocket(exchanger: Exchanger, base: Outlet, *, share: Float) -> Outlet:
    """The pocket of the thermometer is short: it conducts to the hall, and reads a share of the way to it."""
    return replace(base, hot_outlet=base.hot_outlet - share * (base.hot_outlet - ROOM))


HEAT_EXCHANGER = Model(
    name="heat_exchanger",
    title="Plate heat exchanger",
    function=heat_exchanger,
    errors=[
        Tolerance("hot_film", normal(sd="4 %"), why="rating of the maker"),
        Tolerance("cold_film", normal(sd="4 %"), why="rating of the maker"),
        acting(gasket_bypass, Unknown("share", 0, 0.4)),
        acting(hot_flow_exponent, Unknown("less", -0.3, 0.6)),
        acting(cold_flow_exponent, Unknown("less", -0.3, 0.6)),
        acting(deposits, Unknown("resistance", 0, 0.05, "K/kW")),
        acting(heat_to_the_hall, Unknown("conductance", 0, 0.5, "kW/K")),
        acting(trapped_air, Unknown("share", 0, 0.8), Unknown("flow", 0.2, 5, "kg/s")),
        acting(short_pocket, Unknown("share", 0, 0.2), on="reading"),
    ],
)
