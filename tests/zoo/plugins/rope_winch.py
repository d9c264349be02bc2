"""A rope winch lowers a hook: how far, after so many turns of the drum? One layer of rope, worked before."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Winch:
    """Drum, rope and what hangs on it."""

    turned: Float = given(10.0, "rad", symbol="phi", note="angle of the drum since the hook was at the top")
    load: Float = given(10.0, "kN", symbol="F", note="load on the rope", at_least=0)
    drum_radius: Float = given(200.0, "mm", symbol="r", note="radius of the drum to the middle of the rope", above=0)
    more_radius: Float = given(0.0, "mm", symbol="r_2", note="by which the upper layer lies further out")
    layer_ends: Float = given(60.0, "rad", symbol="phi_2", note="angle at which the upper layer is unwound")
    free_length: Float = given(60.0, "m", symbol="L", note="rope between drum and hook when the hook is at the top")
    stiffness: Float = given(8.0, "MN", symbol="S", note="stiffness EA of the rope", above=0)
    elongation: Float = given(0.0, "", symbol="epsilon", note="stretch of the rope beside that of the load")


@results
class Hook:
    """Where the hook is."""

    payout: Float = found("m", formula="drum_radius * turned + more_radius * min(turned, layer_ends)")
    drop: Float = found("mm", formula="payout + (free_length + payout) * (load / stiffness + elongation)")


def rope_winch(winch: Winch) -> Hook:
    """Rope from the drum, and the stretch of all that hangs."""
    payout = winch.drum_radius * winch.turned + winch.more_radius * np.minimum(winch.turned, winch.layer_ends)
    strain = winch.load / winch.stiffness + winch.elongation
    return Hook(payout=payout, drop=payout + (winch.free_length + payout) * strain)


LARGEST = Condition("largest_load", "kN", derived="running_maximum of load", note="largest load that it has carried")
LOWERING = Condition("lowering", "", derived="direction of turned", note="+1 while it lowers, -1 while it lifts")
ROPE = Condition("rope_temperature", "degC", reference=20)
TIME = Condition("time", "min", note="time in service")


def bedding(winch: Winch, *, elongation: Float, scale: Float, largest_load: Float) -> Winch:
    """The strands of a new rope bed in: it stays longer after a load, up to a limit."""
    bedded = elongation * (1 - np.exp(-largest_load / scale))
    return replace(winch, elongation=winch.elongation + bedded)


def second_layer(winch: Winch, *, radius: Float, until: Float) -> Winch:
    """The rope lies in two layers; the upper one leaves first, and faster."""
    return replace(
        winch, more_radius=winch.more_radius + radius, layer_ends=np.where(radius > 0, until, winch.layer_ends)
    )


def drum_wear(winch: Winch, *, rate: Float, time: Float) -> Winch:
    """The rope eats into the drum."""
    return replace(winch, drum_radius=winch.drum_radius - rate * time)


def warm_rope(winch: Winch, *, expansion: Float, rope_temperature: Float) -> Winch:
    """The rope grows with temperature."""
    return replace(winch, elongation=winch.elongation + expansion * (rope_temperature - ROPE.zero))


def rope_creep(winch: Winch, *, per_decade: Float, time: Float) -> Winch:
    """The core creeps with the logarithm of time, from the first minute on."""
    return replace(winch, elongation=winch.elongation + per_decade * np.log10(1 + np.maximum(time, 0.0) / 60))


def sheave_friction(winch: Winch, *, share: Float, lowering: Float) -> Winch:
    """Sheaves rub: while it lowers the rope at the drum carries less than the load."""
    return replace(winch, load=winch.load * (1 - share * lowering))


ROPE_WINCH = Model(
    name="rope_winch",
    title="Way of a hook on a rope winch",
    function=rope_winch,
    errors=[
        Tolerance("drum_radius", normal(sd="0.1 mm"), why="the diameter of the rope scatters"),
        Tolerance("stiffness", normal(sd="5 %"), why="from the catalogue of the rope"),
        acting(bedding, Unknown("elongation", 0, 5, "mm/m"), Unknown("scale", 2, 60, "kN"), needs=[LARGEST]),
        acting(second_layer, Unknown("radius", 0, 20, "mm"), Unknown("until", 5, 100, "rad")),
        acting(drum_wear, Unknown("rate", 0, 1, "mm/h"), needs=[TIME]),
        acting(warm_rope, Unknown("expansion", 0, 5e-5, "1/K"), needs=[ROPE]),
        acting(rope_creep, Unknown("per_decade", 0, 2, "mm/m"), needs=[TIME]),
        acting(sheave_friction, Unknown("share", 0, 0.3), needs=[LOWERING]),
    ],
)
