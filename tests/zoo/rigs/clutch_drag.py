"""An open wet clutch on a bench: gap by gap and ring by ring, each ring wetted as far as its oil reaches.

The gaps are not equally wide. The oil of a ring leaves it as fast as centrifugal force against viscous friction drives
it (lubrication theory, one plate at rest: the mean square of the speed across the gap is a third of that of the plate).
The housing warms up by a heat balance that is integrated in small steps.
"""

from dataclasses import dataclass

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(rupture="film_rupture", warming="gap_warming")
NOISE = 0.05
"""Standard deviation of the torque meter, N m."""
INNER, OUTER, GAPS, RINGS = 0.060, 0.080, 10, 40
EXCHANGE = 12.0
"""Heat that the housing gives to the oil, W/K, while it is 10 K warmer."""
LONGEST_STEP = 5.0
"""Longest step of the heat balance, s."""


@dataclass(frozen=True)
class Plates:
    """One clutch: its gaps in m, viscosity relative to the data sheet, share of the feed that reaches the gaps."""

    gaps: Array
    thicker: float
    reach: float


@dataclass(frozen=True)
class Run:
    """How it is run: time in s, speed in rpm, temperature of the oil in °C, feed in l/min; each of shape (rows,)."""

    time: Array
    speed: Array
    oil: Array
    feed: Array


def viscosity(plates: Plates, celsius: Array) -> Array:
    """Dynamic viscosity in Pa s: 30 mm²/s at 40 °C, 6 at 100 °C (Walther); 840 kg/m³ at 60 °C, 0.65 less per kelvin."""
    logs = np.log10(np.log10(np.array([30.0 * plates.thicker, 6.0]) + 0.7))
    slope = (logs[1] - logs[0]) / np.log10(373.15 / 313.15)
    kinematic = 10 ** (10 ** (logs[0] + slope * np.log10((celsius + 273.15) / 313.15))) - 0.7
    return np.asarray(1e-6 * kinematic * (840 - 0.65 * (celsius - 60)))


def warmed(run: Run, power: float, time_constant: float) -> Array:
    """By how much the housing is warmer than the oil, K, under a constant power in W; loss as the power 1.1."""
    capacity = EXCHANGE * time_constant
    rise, now, rises = 0.0, float(run.time[0]), []
    for time in run.time.tolist():
        steps = max(1, int(np.ceil((time - now) / LONGEST_STEP)))
        for _ in range(steps):
            loss = EXCHANGE * rise * (abs(rise) / 10) ** 0.1 if rise else 0.0
            rise += (time - now) / steps * (power - loss) / capacity
        now = time
        rises.append(rise)
    return np.array(rises)


def torque(plates: Plates, run: Run, rise: Array) -> Array:
    """Drag torque in N m: shear stress times lever, summed over gaps and rings; a reach of 0 means flooded."""
    edges = np.linspace(INNER, OUTER, RINGS + 1)
    radius = ((edges[:-1] + edges[1:]) / 2)[:, None]
    turning = 2 * np.pi * run.speed / 60
    thick = viscosity(plates, run.oil + rise)
    total = np.zeros(len(run.time))
    for gap in plates.gaps.tolist():
        outflow = np.pi * 840 / 3 * turning**2 * radius**2 * gap**3 / (6 * thick)
        fed = plates.reach * run.feed / 6e4 / GAPS if plates.reach else np.full(len(run.time), np.inf)
        wet = np.minimum(1.0, fed / np.maximum(outflow, 1e-12))
        total += np.sum(2 * np.pi * radius**2 * np.diff(edges)[:, None] * wet * thick * turning * radius / gap, axis=0)
    return total


def programme(generator: np.random.Generator, rows: int) -> Run:
    """Forty minutes of sweeps between 100 and 2000 rpm, with more or less oil, while the oil is held at some 60 °C."""
    time = np.linspace(0, 2400, rows)
    sweep = np.abs((time / generator.uniform(350, 550) + generator.uniform(0, 1)) % 1 * 2 - 1)
    held = generator.choice([3.5, 5.0, 7.0], 12)[(time / 201).astype(int)]
    oil = 60 + 5 * np.sin(2 * np.pi * time / generator.uniform(600, 1000) + generator.uniform(0, 6))
    return Run(time, 100 + 1900 * sweep, oil + generator.normal(0, 0.8, rows), held)


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """A test of forty minutes: what the torque meter would show without noise."""
    mean, thicker = generator.normal(1.0, [0.03, 0.02]).tolist()
    uneven = 1 + generator.normal(0, 0.015, GAPS)
    flooded = Plates(0.25e-3 * mean * uneven / np.mean(uneven), thicker, 0.0)
    run = programme(generator, rows)
    cold = np.zeros(rows)
    plain = torque(flooded, run, cold)
    plates, rise = flooded, cold
    if hidden in ("rupture", "rupture_and_warming"):
        size = drawn_size(generator) * NOISE

        def wetted(reach: float) -> Array:
            return torque(Plates(flooded.gaps, thicker, reach), run, cold)

        plates = Plates(flooded.gaps, thicker, sized(wetted, plain, size, 50.0, low=0.05, rtol=1e-4))
    if hidden in ("warming", "rupture_and_warming"):
        size, time_constant = drawn_size(generator) * NOISE, generator.uniform(200, 900)

        def heated(power: float) -> Array:
            return torque(flooded, run, warmed(run, power, time_constant))

        rise = warmed(run, sized(heated, plain, size, 3000.0, low=0.1, rtol=1e-3), time_constant)
    return {
        "time [s]": run.time,
        "speed [rpm]": run.speed,
        "oil_temperature [degC]": run.oil,
        "feed [l/min]": run.feed,
        "drag_torque [N*m]": torque(plates, run, rise),
    }
