"""A centrifugal pump on a bench: Euler's head of its impeller less what friction and shock take; balances by iteration.

What leaks through the ring follows from the head that it leaks under, and that from the flow with the leak. Each vane
begins to cavitate at a suction head of its own.
"""

from dataclasses import dataclass, replace

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(leak="worn_ring", cavitation="cavitation")
NOISE = 0.2
"""Standard deviation of the two pressure gauges together, m."""
GRAVITY = 9.81
DIAMETER, WIDTH, OUTLET_ANGLE = 0.200, 0.014, np.radians(25.0)
SLIP = 0.62
"""Slip factor with the hydraulic efficiency of the vanes."""
RATED_FLOW, RATED_SPEED = 60.0 / 3600, 2900.0
SHOCK = 10.3
"""Head lost at shutoff, 2900 rpm, because the water does not meet the vanes at their angle, m."""
FRICTION, FRICTION_EXPONENT = 9.7, 1.95
"""Head lost in the passages at 60 m³/h, m; a little less than square."""
VANES = 6


@dataclass(frozen=True)
class Pump:
    """One pump: its vanes and passages relative to the drawing, its worn ring, and how it cavitates.

    ``ring`` is the flow through the ring under 1 m of head, m³/s; ``needs`` (VANES,) the suction head at which each
    vane begins to cavitate over that of the maker; ``steepness`` the head lost per metre that lacks.
    """

    vanes: float
    passages: float
    ring: float
    needs: Array
    steepness: float


@dataclass(frozen=True)
class Points:
    """Operating points: flow in m³/s, speed in rpm, suction head in m; each of shape (rows,)."""

    flow: Array
    speed: Array
    suction: Array


def vane_head(pump: Pump, flow: Array, speed: Array) -> Array:
    """Head in m that the impeller gives to a flow through it."""
    rim = np.pi * DIAMETER * speed / 60
    meridian = flow / (np.pi * DIAMETER * WIDTH)
    euler = rim * (SLIP * rim - meridian / np.tan(OUTLET_ANGLE)) / GRAVITY
    shock = SHOCK * (flow / RATED_FLOW - speed / RATED_SPEED) ** 2
    rubbed = FRICTION * np.abs(flow / RATED_FLOW) ** FRICTION_EXPONENT
    return np.asarray(euler + (pump.vanes - 1) * 48 * (speed / RATED_SPEED) ** 2 - shock - pump.passages * rubbed)


def head(pump: Pump, points: Points) -> Array:
    """Head from flange to flange, m: the leak is iterated until it fits the head; each vane loses what vapour takes."""
    given, leak = vane_head(pump, points.flow, points.speed), np.zeros(len(points.flow))
    for _ in range(60):
        leak = 0.5 * leak + 0.5 * pump.ring * np.sqrt(np.maximum(given, 0.0))
        given = vane_head(pump, points.flow + leak, points.speed)
    needed = 1.5 * (points.speed / RATED_SPEED) ** 2 + 2.0 * (points.flow / RATED_FLOW) ** 2
    lacking = np.maximum(pump.needs[:, None] * needed - points.suction, 0.0)
    return np.asarray(given - pump.steepness * np.mean(lacking, axis=0))


def programme(generator: np.random.Generator, rows: int) -> Points:
    """A table of operating points in no order: three speeds, any opening of the valve, any pressure at the inlet."""
    speed = generator.choice([2300.0, 2600.0, 2900.0], rows) * generator.normal(1, 0.002, rows)
    flow = generator.uniform(0.05, 1.25, rows) * RATED_FLOW
    return Points(flow, speed, generator.uniform(1.5, 9.0, rows))


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """A table of operating points: what the gauges would show without noise."""
    vanes, passages = generator.normal(1, [0.015, 0.08]).tolist()
    points = programme(generator, rows)
    spread = 1 + generator.normal(0, 0.04, VANES)
    sound = Pump(vanes, passages, 0.0, spread, 0.0)
    plain = head(sound, points)
    ring, steepness, needs = 0.0, 0.0, spread
    if hidden in ("leak", "leak_and_cavitation"):
        size = drawn_size(generator) * NOISE
        ring = sized(lambda flow: head(replace(sound, ring=flow), points), plain, size, 2e-3, rtol=1e-3)
    if hidden in ("cavitation", "leak_and_cavitation"):
        size, needs = drawn_size(generator) * NOISE, spread * generator.uniform(1.2, 1.9)
        hungry = replace(sound, needs=needs)
        steepness = sized(lambda lost: head(replace(hungry, steepness=lost), points), plain, size, 50.0, rtol=1e-3)
    return {
        "flow [m^3/h]": 3600 * points.flow,
        "speed [rpm]": points.speed,
        "suction_head [m]": points.suction,
        "head [m]": head(Pump(vanes, passages, ring, needs, steepness), points),
    }
