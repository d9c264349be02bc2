"""A platform scale under standard weights: a beam that creeps in time, above a cushion of dirt that may carry along.

The strain is a mean over the grid of the gauges, where the lever changes. The dirt is a few hundred grains, each of a
height of its own; platform and grains find their balance by bisection. The late part of the strain is that of three
elements of spring and damper, integrated in small steps from the first weight on.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(creep="creep", stop="touching_stop")
NOISE = 0.015
"""Standard deviation of the display, kg."""
GRAVITY, MODULUS, WIDTH, THICKNESS, ARM = 9.81, 71e9, 0.030, 0.012, 0.040
GRID, POINTS = 0.006, 61
"""Length of a gauge along the beam, m, and points of the mean over it."""
SINKING = 4e-6
"""How far the platform sinks under 1 kg, m."""
SHORTER = 2e-4
"""Share of the lever that is lost as the beam bends under 100 kg."""
GRAINS, UNEVEN = 300, 2e-5
"""Grains of dirt, and the standard deviation of their heights, m."""
ELEMENTS = np.array([0.75, 1.0, 1.3])
"""Time constants of the elements of the beam over their mean; each bears a third of the creep."""
LONGEST_STEP = 0.1
"""Longest step of the integration over the smallest time constant."""


@dataclass(frozen=True)
class Weights:
    """What stands on the platform: changes at times in s to loads in kg; readings at times in s."""

    changes: Array
    loads: Array
    time: Array

    @property
    def step(self) -> NDArray[np.intp]:
        """The step in which each reading falls."""
        return np.searchsorted(self.changes, self.time, side="right") - 1


@dataclass(frozen=True)
class Dirt:
    """Heights of the gaps under all grains in m, and the force of one grain per metre in kg/m."""

    gaps: Array
    stiffness: float


def carried(load: Array, dirt: Dirt) -> Array:
    """Load of the beam in kg: the platform sinks until beam and grains bear what stands on it; bisected."""
    if dirt.stiffness == 0:
        return load.copy()
    low, high = np.zeros(len(load)), load * SINKING
    for _ in range(50):
        sunk = (low + high) / 2
        grains = dirt.stiffness * np.sum(np.maximum(sunk[:, None] - dirt.gaps, 0.0), axis=1)
        too_low = sunk / SINKING + grains < load
        low, high = np.where(too_low, sunk, low), np.where(too_low, high, sunk)
    return np.asarray((low + high) / 2 / SINKING)


def crept(weights: Weights, borne: Array, share: float, time_constant: float) -> Array:
    """What the gauges feel, in kg, at each reading: a share of the load comes late; begun without load."""
    if share == 0:
        return np.asarray(borne[weights.step])
    constants = time_constant * ELEMENTS
    late, now, felt = np.zeros(len(ELEMENTS)), float(weights.changes[0]), []
    events = sorted(
        [(time, -1) for time in weights.changes.tolist()] + [(t, k) for k, t in enumerate(weights.time.tolist())]
    )
    load = 0.0
    for time, row in events:
        steps = max(1, int(np.ceil((time - now) / (LONGEST_STEP * constants[0]))))
        for _ in range(steps):
            pace = (time - now) / steps / constants
            late = late + pace * (1 - pace / 2) * (load - late)
        now, load = time, float(borne[np.searchsorted(weights.changes, time, side="right") - 1])
        if row >= 0:
            felt.append(load * (1 - share) + share * float(np.mean(late)))
    return np.array(felt)


def display(weights: Weights, scale: tuple[float, float], dirt: Dirt, creep: tuple[float, float]) -> Array:
    """What the display shows in kg, for a scale (gauge factor, zero in kg)."""
    felt = crept(weights, carried(weights.loads, dirt), *creep)
    lever = ARM + np.linspace(-GRID / 2, GRID / 2, POINTS)
    bent = lever * (1 - SHORTER * felt[:, None] / 100)
    strain = np.mean(6 * GRAVITY * bent / (MODULUS * WIDTH * THICKNESS**2), axis=1) * felt
    return np.asarray(1e3 * scale[0] * strain * 63.5516 + scale[1])


def programme(generator: np.random.Generator, rows: int) -> Weights:
    """Some five readings after each change, the first at once; weights of 5 kg, put on and taken off in any order."""
    count = rows // 5 + 1
    loads = 5.0 * generator.integers(0, 21, count)
    same = np.append(False, np.diff(loads) == 0)
    loads[same] = np.where(loads[same] < 50, loads[same] + 25, loads[same] - 25)
    same = np.append(False, np.diff(loads) == 0)
    loads[same] = (loads[same] + 10) % 105
    changes = np.append(0.0, np.cumsum(generator.uniform(110, 160, count - 1)))
    after = np.array([2.0, 8.0, 20.0, 45.0, 95.0])
    time = (changes[:, None] + after * generator.uniform(0.8, 1.1, (count, 5))).ravel()[:rows]
    return Weights(changes, np.asarray(loads, dtype=np.float64), np.asarray(time))


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """An hour or so of weights put on and taken off: what the display would show without noise."""
    scale = (2.05 * generator.normal(1, 0.003), generator.normal(0, 0.03))
    weights = programme(generator, rows)
    place = generator.uniform(-80, 80, len(weights.loads))
    warm = 20 + 4 * np.sin(weights.time / generator.uniform(600, 1500)) + generator.normal(0, 0.2, rows)
    heights = generator.normal(0, UNEVEN, GRAINS)
    clean, elastic = Dirt(heights, 0.0), (0.0, 30.0)
    plain = display(weights, scale, clean, elastic)
    dirt, creep = clean, elastic
    if hidden in ("creep", "creep_and_stop"):
        size, time_constant = drawn_size(generator) * NOISE, generator.uniform(10, 35)

        def late(part: float) -> Array:
            return display(weights, scale, clean, (part, time_constant))

        creep = (sized(late, plain, size, 0.05, rtol=1e-2), time_constant)
    if hidden in ("stop", "creep_and_stop"):
        size, gaps = drawn_size(generator) * NOISE, SINKING * generator.uniform(35, 70) + heights

        def touching(stiff: float) -> Array:
            return display(weights, scale, Dirt(gaps, stiff), elastic)

        dirt = Dirt(gaps, sized(touching, plain, size, 1e3, rtol=1e-2))
    return {
        "time [s]": weights.time,
        "load [kg]": weights.loads[weights.step],
        "previous_load [kg]": np.append(0.0, weights.loads[:-1])[weights.step],
        "held [s]": weights.time - weights.changes[weights.step],
        "off_centre [mm]": place[weights.step],
        "platform_temperature [degC]": warm,
        "reading [kg]": display(weights, scale, dirt, creep),
    }
