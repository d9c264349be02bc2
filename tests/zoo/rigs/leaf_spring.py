"""A leaf spring on a bench, step by step: a bundle of springs behind sliders, and buffers that come to lie on.

Friction between leaves: elements of a spring and a slider in parallel, which stick and slip one after another (W. D.
Iwan, A distributed-element model for hysteresis and its steady-state dynamic response, J. Appl. Mech. 33 (1966) 893).
"""

import numpy as np
from scipy.optimize import brentq

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(friction="interleaf_friction", helper="helper_leaf")
NOISE = 15.0
"""Standard deviation of the load cell, N."""
DEEPEST = 78.0
"""Largest way of the ram, mm."""
SLIDERS, PARTS = 40, 20
"""Sliders in the bundle; steps of the ram between two readings."""
CYCLES = 3
PAD = 3000.0
"""Rate of the rubber between the stages, N/mm."""


def ways(generator: np.random.Generator, rows: int) -> tuple[Array, Array]:
    """Way of the ram, mm, at every step of its motion, and the time of each reading, min.

    The ram goes up and down like a crank, between turns that differ from cycle to cycle.
    """
    turns = [5.0]
    while len(turns) < 2 * CYCLES + 1:
        turns += [DEEPEST * generator.uniform(0.75, 1.0), generator.uniform(3.0, 15.0)]
    turns[1] = DEEPEST
    phase = np.linspace(0, 2 * CYCLES * np.pi, (rows - 1) * PARTS + 1) * 0.999
    half = np.minimum((phase // np.pi).astype(int), len(turns) - 2)
    within = (1 - np.cos(phase - half * np.pi)) / 2
    before, after = np.array(turns)[half], np.array(turns)[half + 1]
    return np.asarray(before + (after - before) * within), np.linspace(0, 10, rows)


def friction(way: Array, force: float, reach: float) -> Array:
    """Force of the sliders, N, at every step; they slip after ways that are spread exponentially about half the reach.

    The spring has been worked before: all sliders stand as after a long way upward.
    """
    levels = (np.arange(SLIDERS) + 0.5) / SLIDERS
    slips_after = -np.log(1 - levels) * reach / 2 + 1e-6
    weights = slips_after / np.sum(slips_after)
    stretched, shown = -slips_after, np.empty(len(way))
    for place, step in enumerate(np.diff(way, prepend=way[0]).tolist()):
        stretched = np.clip(stretched + step, -slips_after, slips_after)
        shown[place] = force * np.sum(weights * stretched / slips_after)
    return shown


def helper(way: float, rate: float, gap: float) -> float:
    """Force of the second stage, N: three buffers, not equally high, behind one pad of rubber."""

    def too_much(pressed: float) -> float:
        free = way - pressed / PAD
        return pressed - sum(rate / 3 * max(free - gap - off, 0.0) for off in (-0.8, 0.0, 0.8))

    return float(brentq(too_much, 0.0, 1e5, xtol=1e-6))


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Slow cycles with readings at even times."""
    rate, zero = 90.0 * (1 + 0.03 * generator.standard_normal()), 0.7 * generator.standard_normal()
    way, time = ways(generator, rows)
    force = rate * (way - zero) * (1 + 2e-9 * (way - zero) ** 2)
    if hidden in ("friction", "friction_and_helper"):
        force += friction(way, drawn_size(generator) * NOISE, generator.uniform(3.0, 10.0))
    if hidden in ("helper", "friction_and_helper"):
        gap = generator.uniform(30.0, 60.0)
        second = drawn_size(generator) * NOISE / (DEEPEST - gap)
        force += np.array([helper(one, second, gap) for one in (way - zero).tolist()])
    speed = np.gradient(way, 10 * 60 / (len(way) - 1))
    return {
        "time [min]": time,
        "deflection [mm]": way[::PARTS],
        "ram_speed [mm/s]": speed[::PARTS],
        "force [N]": force[::PARTS],
    }
