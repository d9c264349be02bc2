"""A centrifugal pump: what head does it give at a flow and a speed?"""

from dataclasses import replace

import numpy as np

from truing import Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting

RATED_SPEED, RATED_FLOW = 2900.0 / 60, 60.0 / 3600
"""Speed in 1/s and flow in m³/s of the acceptance test."""


@inputs
class Pump:
    """The curve of the acceptance test at 2900 rpm, and one operating point."""

    flow: Float = given(60.0, "m^3/h", symbol="Q", note="flow at the outlet", at_least=0)
    speed: Float = given(2900.0, "rpm", symbol="n", note="speed of the impeller", above=0)
    suction_head: Float = given(3.6, "m", symbol="NPSH_A", note="net positive suction head at the inlet", at_least=0)
    shutoff_head: Float = given(48.0, "m", symbol="H_0", note="head without flow at 2900 rpm", above=0)
    rise: Float = given(8.0, "m", symbol="H_1", note="linear part of the curve at 60 m³/h")
    fall: Float = given(20.0, "m", symbol="H_2", note="square part of the curve at 60 m³/h", above=0)
    npsh_shutoff: Float = given(1.5, "m", symbol="NPSH_0", note="suction head needed without flow at 2900 rpm")
    npsh_growth: Float = given(2.0, "m", symbol="NPSH_2", note="how much more is needed at 60 m³/h")
    recirculation: Float = given(0.0, "m^3/h", symbol="Q_L", note="flow back to the inlet at the shutoff head")
    breakdown: Float = given(0.0, "", symbol="f", note="head lost per metre of suction head that lacks", at_least=0)
    need_factor: Float = given(1.0, "", symbol="k_N", note="suction head needed over that of the maker", above=0)
    prerotation: Float = given(0.0, "m", symbol="H_p", note="head lost at shutoff to water that turns at the inlet")
    aired: Float = given(0.0, "", symbol="a", note="share of the head that air in the impeller takes")
    speed_error: Float = given(0.0, "", symbol="s", note="share by which the impeller turns slower than was read")


@results
class Head:
    """What the pump gives."""

    impeller_flow: Float = found("m^3/h", symbol="Q_i", note="flow through the impeller", method="outlet and way back")
    needed_head: Float = found("m", symbol="NPSH_R", note="suction head needed", method="curve of the maker")
    head: Float = found("m", symbol="H", note="head from flange to flange", method="affinity and what is lost")


def pump_curve(pump: Pump) -> Head:
    """Affinity of the tested curve (ISO 9906); without a leak the impeller carries the flow of the outlet."""
    fast = pump.speed * (1 - pump.speed_error) / RATED_SPEED
    outside = pump.flow / RATED_FLOW
    back = pump.recirculation / RATED_FLOW * np.sqrt(np.maximum(curve(pump, outside, fast) / pump.shutoff_head, 0.0))
    through = outside + back
    needed = pump.npsh_shutoff * fast**2 + pump.npsh_growth * outside**2
    lost = pump.breakdown * np.maximum(pump.need_factor * needed - pump.suction_head, 0.0)
    turning = pump.prerotation * np.maximum(fast - outside, 0.0) ** 2
    head = curve(pump, through, fast) * (1 - pump.aired) - lost - turning
    return Head(impeller_flow=through * RATED_FLOW, needed_head=needed, head=head)


def curve(pump: Pump, flow: Float, fast: Float) -> Float:
    """Head in m at a flow and a speed, both in parts of the rated ones."""
    return pump.shutoff_head * fast**2 + pump.rise * fast * flow - pump.fall * flow**2


def worn_ring(pump: Pump, *, flow: Float) -> Pump:
    """A worn ring lets water back to the inlet: the impeller carries more than the outlet gives."""
    return replace(pump, recirculation=pump.recirculation + flow)


def cavitation(pump: Pump, *, steepness: Float, need: Float) -> Pump:
    """Vapour fills the vanes where the suction head is too small; this pump may need more than the maker says."""
    return replace(pump, breakdown=pump.breakdown + steepness, need_factor=need)


def inlet_swirl(pump: Pump, *, head: Float) -> Pump:
    """At part load water from the impeller turns the water at the inlet."""
    return replace(pump, prerotation=pump.prerotation + head)


def entrained_air(pump: Pump, *, share: Float, flow: Float) -> Pump:
    """Air that a small flow does not carry away gathers in the eye of the impeller."""
    return replace(pump, aired=pump.aired + share * np.exp(-pump.flow / flow))


def coupling_slip(pump: Pump, *, share: Float) -> Pump:
    """The coupling slips with the torque: the impeller turns slower than the motor, most at large flow."""
    return replace(pump, speed_error=pump.speed_error + share * pump.flow / RATED_FLOW)


def pipe_loss(pump: Pump, base: Head, *, head: Float) -> Head:
    """The taps are not at the flanges: the gauges miss the loss of the pipe between, as the square of the flow."""
    return replace(base, head=base.head - head * (pump.flow / RATED_FLOW) ** 2)


PUMP_CURVE = Model(
    name="pump_curve",
    title="Head of a centrifugal pump",
    function=pump_curve,
    cites=["ISO 9906:2012, Rotodynamic pumps, Hydraulic performance acceptance tests"],
    errors=[
        Tolerance("shutoff_head", normal(sd="1.5 %"), why="cast impellers differ"),
        Tolerance("fall", normal(sd="5 %"), why="cast casings differ"),
        acting(worn_ring, Unknown("flow", 0, 20, "m^3/h", note="at the shutoff head")),
        acting(
            cavitation,
            Unknown("steepness", 0, 10, "", note="head lost per metre that lacks"),
            Unknown("need", 0.4, 4, "", note="suction head needed over that of the maker"),
        ),
        acting(inlet_swirl, Unknown("head", -10, 10, "m", note="lost at shutoff")),
        acting(entrained_air, Unknown("share", 0, 0.5), Unknown("flow", 2, 60, "m^3/h")),
        acting(coupling_slip, Unknown("share", 0, 0.1, "", note="at 60 m³/h")),
        acting(pipe_loss, Unknown("head", 0, 10, "m", note="at 60 m³/h"), on="reading"),
    ],
)
