"""A winch with a rope of elements: each leaves the drum where it was laid, and remembers the load that it has carried.

The rope is a row of elements of 0.1 m. The drum pays it out step by step; where the upper layer ends the rope climbs
down in half a turn. Each element beyond the drum stretches by the load, and beds in by the largest load that it has
felt.
"""

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(bedding="bedding", layer="second_layer")
NOISE = 3.0
"""Standard deviation of the laser below the hook, mm."""
FREE, ELEMENT = 60.0, 0.1
"""Rope between drum and hook at the top, and length of an element, m."""
FARTHEST, HEAVIEST = 75.0, 40.0
"""Largest angle of the drum, rad, and largest load, kN."""
STEP = 0.005
"""Step of the drum, rad."""


def unwound(radius: float, more: float, until: float) -> Array:
    """Rope that has left the drum, m, after every step of its angle."""
    angles = np.arange(0.0, FARTHEST + 2 * STEP, STEP)
    above = np.clip((until - angles) / np.pi + 0.5, 0.0, 1.0)
    return np.concatenate([[0.0], np.cumsum((radius + more * above) * STEP)])


def programme(generator: np.random.Generator, rows: int) -> tuple[Array, Array, Array]:
    """Angles in rad, loads in kN and temperatures in °C: lifts with loads that tend to grow."""
    phase = np.linspace(0, rows / 12, rows) + generator.uniform(0, 1)
    angles = FARTHEST * (0.5 - 0.48 * np.cos(2 * np.pi * phase)) + generator.uniform(0, 0.5, rows)
    lifts = phase.astype(int)
    growing = np.linspace(0.25, 1.0, int(lifts.max()) + 1) * generator.uniform(0.6, 1.0, int(lifts.max()) + 1)
    growing[-1] = 1.0
    loads = HEAVIEST * growing[lifts] * generator.uniform(0.95, 1.0, rows)
    temperature = 15 + 10 * np.sin(np.linspace(0, generator.uniform(2, 5), rows)) + generator.normal(0, 0.3, rows)
    return np.minimum(angles, FARTHEST), np.asarray(loads), np.asarray(temperature)


def drops(angles: Array, loads: Array, paid: Array, rope: dict[str, float]) -> Array:
    """Way of the hook at every reading, mm."""
    most = np.zeros(int((FREE + paid[-1]) / ELEMENT) + 1)
    starts = np.arange(len(most)) * ELEMENT
    shown = np.empty(len(angles))
    for place, (angle, load) in enumerate(zip(angles.tolist(), loads.tolist(), strict=True)):
        out = float(np.interp(angle / STEP, np.arange(len(paid)), paid))
        hanging = np.clip(FREE + out - starts, 0.0, ELEMENT)
        most = np.where(hanging > 0, np.maximum(most, load), most)
        strain = load / rope["stiffness"] + rope["bedded"] * (1 - np.exp(-most / rope["scale"]))
        shown[place] = 1e3 * (out + np.sum(hanging * strain))
    return shown


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Half a day of lifts, a reading every two minutes."""
    rope = {"stiffness": 8e3 * (1 + 0.05 * generator.standard_normal()), "bedded": 0.0, "scale": 1.0}
    radius = 0.2 + 1e-4 * generator.standard_normal()
    angles, loads, temperature = programme(generator, rows)
    more, until = 0.0, 0.0
    if hidden in ("bedding", "bedding_and_layer"):
        rope["scale"] = generator.uniform(8.0, 25.0)
        longest = 1e3 * (FREE + radius * FARTHEST) * (1 - np.exp(-HEAVIEST / rope["scale"]))
        rope["bedded"] = drawn_size(generator) * NOISE / longest
    if hidden in ("layer", "bedding_and_layer"):
        until = generator.uniform(0.25, 0.7) * FARTHEST
        more = 1e-3 * drawn_size(generator) * NOISE / until
    return {
        "time [min]": 2.0 * np.arange(rows, dtype=np.float64),
        "turned [rad]": angles,
        "load [kN]": loads,
        "rope_temperature [degC]": temperature,
        "drop [mm]": drops(angles, loads, unwound(radius, more, until), rope),
    }
