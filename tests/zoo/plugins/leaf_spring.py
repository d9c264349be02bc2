"""A leaf spring on a test bench: which force at which deflection? One stage, without friction."""

from dataclasses import replace

import numpy as np

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Spring:
    """A pack of leaves between its eyes, pressed down by a ram."""

    deflection: Float = given(30.0, "mm", symbol="s", note="way of the ram from the free height")
    ram_speed: Float = given(0.0, "mm/s", symbol="v", note="speed of the ram, positive downward")
    rate: Float = given(90.0, "N/mm", symbol="c", note="rate of the pack", above=0)
    free_height_error: Float = given(0.0, "mm", symbol="s_0", note="by which the spring is lower than drawn")
    hardening: Float = given(0.0, "1/mm^2", symbol="h", note="growth of the rate with the square of the way")
    friction: Float = given(0.0, "N", symbol="F_R", note="force of whatever rubs")
    helper_rate: Float = given(0.0, "N/mm", symbol="c_2", note="rate of the second stage", at_least=0)
    helper_gap: Float = given(50.0, "mm", symbol="s_2", note="way after which the second stage carries")
    damping: Float = given(0.0, "N*s/mm", symbol="d", note="force per speed")


@results
class Force:
    """What the ram feels."""

    way: Float = found("mm", symbol="x", note="deflection of the leaves", formula="deflection - free_height_error")
    force: Float = found(
        "N",
        formula="rate * way * (1 + hardening * way**2) + helper_rate * max(way - helper_gap, 0) + friction"
        " + damping * ram_speed",
    )


def leaf_spring(spring: Spring) -> Force:
    """A straight line, unless an effect bends it."""
    way = spring.deflection - spring.free_height_error
    first = spring.rate * way * (1 + spring.hardening * way**2)
    second = spring.helper_rate * np.maximum(way - spring.helper_gap, 0.0)
    return Force(way=way, force=first + second + spring.friction + spring.damping * spring.ram_speed)


LOADING = Condition("loading", "", derived="direction of deflection", note="+1 downward, -1 upward")
TURNED_AT = Condition("turned_at", "mm", derived="last_reversal of deflection", note="where the ram last turned")
TIME = Condition("time", "min", note="time on the bench")


def interleaf_friction(spring: Spring, *, force: Float, reach: Float, loading: Float, turned_at: Float) -> Spring:
    """The leaves rub on one another; after a turn the friction needs some way to change its side."""
    since = np.abs(spring.deflection - turned_at)
    return replace(spring, friction=spring.friction + force * loading * (1 - 2 * np.exp(-since / reach)))


def helper_leaf(spring: Spring, *, rate: Float, gap: Float) -> Spring:
    """Beyond some way a second stage carries as well."""
    return replace(spring, helper_rate=spring.helper_rate + rate, helper_gap=np.where(rate > 0, gap, spring.helper_gap))


def shackle_angle(spring: Spring, *, hardening: Float) -> Spring:
    """The shackle swings and makes the spring shorter: stiffer on either side."""
    return replace(spring, hardening=spring.hardening + hardening)


def settling(spring: Spring, *, speed: Float, time: Float) -> Spring:
    """The spring settles while it is tested."""
    return replace(spring, free_height_error=spring.free_height_error + speed * time)


def rubber_bushings(spring: Spring, *, damping: Float) -> Spring:
    """Bushings of rubber add a force in proportion to the speed."""
    return replace(spring, damping=spring.damping + damping)


def stuck_ram(spring: Spring, *, force: Float, loading: Float) -> Spring:
    """The seals of the ram rub: a force against its motion, at once and always the same."""
    return replace(spring, friction=spring.friction + force * loading)


LEAF_SPRING = Model(
    name="leaf_spring",
    title="Force of a leaf spring",
    function=leaf_spring,
    errors=[
        Tolerance("rate", normal(sd="3 %"), why="thickness of the leaves goes in with its third power"),
        Tolerance("free_height_error", normal(sd="0.7 mm"), why="the zero of the ram is set by hand"),
        acting(
            interleaf_friction,
            Unknown("force", 0, 1500, "N", note="half the height of the loop"),
            Unknown("reach", 0.5, 30, "mm", note="way in which it changes its side"),
            needs=[LOADING, TURNED_AT],
        ),
        acting(helper_leaf, Unknown("rate", 0, 200, "N/mm"), Unknown("gap", 10, 70, "mm")),
        acting(shackle_angle, Unknown("hardening", -1e-4, 1e-4, "1/mm^2")),
        acting(settling, Unknown("speed", 0, 2, "mm/min"), needs=[TIME]),
        acting(rubber_bushings, Unknown("damping", 0, 500, "N*s/mm")),
        acting(stuck_ram, Unknown("force", 0, 1500, "N"), needs=[LOADING]),
    ],
)
