"""A proportional spool valve: how much oil does it let through at a command and a loss of pressure?"""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from zoo.zoo import acting

FULL = 10.0
"""Command at which the spool stands at its full stroke, V."""
RATED_LOSS = 7e6
"""Loss of pressure at which losses of stroke are stated, Pa."""


@inputs
class Valve:
    """The valve, the oil, and how it is driven; a positive command opens from the pump to port A."""

    command: Float = given(5.0, "V", symbol="u", note="command", at_least=-10, at_most=10)
    pressure_loss: Float = given(70.0, "bar", symbol="dp", note="over the edge that is open", above=0)
    discharge: Float = given(0.65, "", symbol="C_d", note="discharge coefficient of a sharp edge", above=0)
    edge: Float = given(20.0, "mm", symbol="w", note="length of the edge", above=0)
    stroke: Float = given(1.0, "mm", symbol="x_m", note="full stroke of the spool", above=0)
    density: Float = given(860.0, "kg/m^3", symbol="rho", note="density of the oil", above=0)
    null_bias: Float = given(0.0, "V", symbol="u_0", note="command at which the spool stands in the middle")
    held_back: Float = given(0.0, "V", symbol="u_R", note="part of the command that friction keeps from the spool")
    overlap: Float = given(0.0, "V", symbol="u_D", note="command either way that opens nothing", at_least=0)
    leak: Float = given(0.0, "l/(min*bar)", symbol="k_L", note="leak from pump to A per loss of pressure")
    pushed: Float = given(0.0, "", symbol="s", note="share of the stroke that the jet takes at 70 bar", below=1)
    exponent: Float = given(0.5, "", symbol="e", note="of the flow over the loss of pressure; sharp edge 1/2")


@results
class Flow:
    """Where the spool stands, and what flows."""

    opening: Float = found("mm", symbol="x", note="opening of the edge", method="command less what is kept")
    flow: Float = found("l/min", symbol="Q", note="flow to port A", method="turbulent jet of a sharp edge, and leak")


def hydraulic_valve(valve: Valve) -> Flow:
    """A spool that follows its command at once, and edges that meet."""
    feasible(valve.pressure_loss > 0, "without a loss of pressure nothing flows")
    moved = valve.command - valve.null_bias - valve.held_back
    open_ = np.sign(moved) * np.maximum(np.abs(moved) - valve.overlap, 0.0) / FULL
    ratio = valve.pressure_loss / RATED_LOSS
    opening = valve.stroke * open_ * (1 - valve.pushed * ratio * np.abs(open_))
    speed = np.sqrt(2 * RATED_LOSS / valve.density) * ratio**valve.exponent
    return Flow(opening=opening, flow=valve.discharge * valve.edge * opening * speed + valve.leak * valve.pressure_loss)


RISING = Condition("rising", "", derived="direction of command", note="+1 while the command rises, -1 falling")
TURNED_AT = Condition("turned_at", "V", derived="last_reversal of command", note="command where it last turned")
TIME = Condition("time", "s", derived="since_start", note="since the record began")


def spool_friction(valve: Valve, *, width: Float, rising: Float, turned_at: Float) -> Valve:
    """Dirt and seals hold the spool: after a turn it waits until the command has come back by twice the width."""
    before = np.minimum(width, np.abs(turned_at))
    kept = rising * np.clip(rising * (valve.command - turned_at) - before, -before, width)
    return replace(valve, held_back=valve.held_back + kept)


def worn_land(valve: Valve, *, leak: Float) -> Valve:
    """Particles have worn the land between pump and A: oil leaks in proportion to the loss of pressure."""
    return replace(valve, leak=valve.leak + leak)


def overlapped(valve: Valve, *, dead: Float) -> Valve:
    """The lands are wider than the ports: around the middle nothing opens."""
    return replace(valve, overlap=valve.overlap + dead)


def flow_force(valve: Valve, *, share: Float) -> Valve:
    """The jet pushes the spool back, with its opening and the loss of pressure."""
    return replace(valve, pushed=valve.pushed + share)


def round_edges(valve: Valve, *, more: Float) -> Valve:
    """Worn edges are round: the jet is in part laminar, and the exponent above one half."""
    return replace(valve, exponent=valve.exponent + more)


def warming_coil(valve: Valve, *, loss: Float, time_constant: Float, time: Float) -> Valve:
    """The coil warms up: the amplifier drives less current through it, and the spool falls short by a share."""
    short = loss * (1 - np.exp(-time / time_constant))
    return replace(valve, discharge=valve.discharge * (1 - short))


def sensor_gain(valve: Valve, base: Flow, *, flow: Float) -> Flow:
    """The turbine was calibrated with another oil."""
    return replace(base, flow=base.flow * (1 + flow))


HYDRAULIC_VALVE = Model(
    name="hydraulic_valve",
    title="Flow of a proportional spool valve",
    function=hydraulic_valve,
    errors=[
        Tolerance("discharge", normal(sd="2 %"), why="edges are not equally sharp"),
        Tolerance("null_bias", normal(sd="0.05 V"), why="adjusted by hand"),
        acting(
            spool_friction, Unknown("width", 0, 3, "V", note="half the width of the loop"), needs=[RISING, TURNED_AT]
        ),
        acting(worn_land, Unknown("leak", 0, 1, "l/(min*bar)")),
        acting(overlapped, Unknown("dead", 0, 2, "V")),
        acting(flow_force, Unknown("share", 0, 0.4, "", note="of the full stroke at 70 bar")),
        acting(round_edges, Unknown("more", 0, 0.5)),
        acting(warming_coil, Unknown("loss", 0, 0.3), Unknown("time_constant", 10, 600, "s"), needs=[TIME]),
        acting(sensor_gain, Unknown("flow", -0.2, 0.2), on="reading"),
    ],
)
