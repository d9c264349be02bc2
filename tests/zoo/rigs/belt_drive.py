"""A belt drive on a bench: tensions of a belt of fixed length, and the sliding that friction needs, row by row.

Each row is solved by iteration: the tensions of both strands from the stretch law of the belt and its fixed length, the
slip ratio from a friction that rises with it (rubber), the speeds from the conservation of mass along the belt.
"""

import numpy as np
from scipy.optimize import brentq

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(slip="belt_slip", creep="creep")
NOISE = 0.5
"""Standard deviation of the tachometer, rpm."""
WRAP, MASS = 2.9, 0.12
"""Angle of wrap of the small pulley, rad; mass of the belt, kg/m."""
STEEL, HARDENING = 2e7, 4e-6
"""Stiffness EA of a belt with steel cords, N; growth of the stiffness of a soft belt with tension, 1/N."""
FAST, STRONG = 2700.0, 60.0
"""Highest speed of the motor, rpm, and its highest torque, N m."""


def strain(tension: float, stiffness: float) -> float:
    """Stretch of the belt under a tension, N; it stiffens a little."""
    return tension / (stiffness * (1 + HARDENING * tension))


def strands(pull: float, pretension: float, stiffness: float) -> tuple[float, float]:
    """Tensions of the tight and the slack side: they differ by the pull, and the belt keeps its length."""

    def too_long(slack: float) -> float:
        both = strain(slack + pull, stiffness) + strain(slack, stiffness)
        return both - 2 * strain(pretension, stiffness)

    slack = brentq(too_long, pretension - pull, pretension, xtol=1e-9)
    return slack + pull, slack


def sliding(pull: float, gripping: float, friction: float, rise: float) -> float:
    """Slip ratio at which the belt can carry the pull: Eytelwein's limit with a friction that rises with slip."""

    def lacking(slip: float) -> float:
        limit = 2 * gripping * np.tanh(friction * (1 + slip / rise) * WRAP / 2)
        return float(pull - limit)

    if lacking(0.0) <= 0:
        return 0.0
    return float(brentq(lacking, 0.0, 0.5, xtol=1e-12))


def driven(speed: float, torque: float, diameters: tuple[float, float], belt: dict[str, float]) -> float:
    """Speed of the driven shaft, rpm: the belt meets each pulley at the speed of the strand that runs on to it."""
    pull = 2 * torque / diameters[0]
    tight, slack = strands(pull, belt["pretension"], belt["stiffness"])
    surface = np.pi * diameters[0] * speed / 60
    gripping = belt["pretension"] - MASS * surface**2
    slip = sliding(pull, gripping, belt["friction"], belt["rise"])
    late = (1 + strain(slack, belt["stiffness"])) / (1 + strain(tight, belt["stiffness"]))
    return float(speed * diameters[0] / diameters[1] * late * (1 - slip))


def programme(generator: np.random.Generator, rows: int) -> tuple[Array, Array, Array, Array]:
    """Time in min, speed of the motor in rpm, its torque in N m, temperature in °C: steps of speed, waves of load."""
    time = 0.5 * np.arange(rows, dtype=np.float64)
    levels = generator.choice([900.0, 1500.0, 2100.0, FAST], rows // 8 + 1)
    speed = np.repeat(levels, 8)[:rows] * (1 + 0.002 * generator.standard_normal(rows))
    swing = np.sin(2 * np.pi * time / generator.uniform(9, 16) + generator.uniform(0, 6))
    torque = STRONG * (0.5 + 0.4 * swing + 0.1 * generator.uniform(-1, 1, rows))
    temperature = 20 + 25 * (1 - np.exp(-time / 30)) + generator.normal(0, 0.5, rows)
    return time, np.asarray(speed), np.asarray(torque), np.asarray(temperature)


def belt_with(hidden: str | None, generator: np.random.Generator, diameters: tuple[float, float]) -> dict[str, float]:
    """What the belt is like: N, pure numbers; sizes are those of the loss at the highest speed and torque."""
    belt = {"pretension": 1500.0, "stiffness": STEEL, "friction": 0.5, "rise": 0.05}
    most, full = 2 * STRONG / diameters[0], FAST * diameters[0] / diameters[1]
    if hidden in ("creep", "slip_and_creep"):
        belt["stiffness"] = most * full / (drawn_size(generator) * NOISE)
    if hidden in ("slip", "slip_and_creep"):
        loss, carried = drawn_size(generator) * NOISE / full, generator.uniform(0.4, 0.7) * most
        belt["pretension"] = 0.75 * most
        gripping = belt["pretension"] - MASS * (np.pi * diameters[0] * FAST / 60) ** 2
        belt["friction"] = 2 / WRAP * float(np.arctanh(carried / (2 * gripping)))
        needed = 2 / WRAP * float(np.arctanh(most / (2 * gripping)))
        belt["rise"] = loss / (needed / belt["friction"] - 1)
    return belt


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """A run of an hour or so with steps of speed under a changing load, one reading every half minute."""
    diameters = (generator.normal(0.125, 0.8e-4), generator.normal(0.250, 1.5e-4))
    belt = belt_with(hidden, generator, diameters)
    time, speed, torque, temperature = programme(generator, rows)
    shown = [driven(*row, diameters, belt) for row in zip(speed.tolist(), torque.tolist(), strict=True)]
    return {
        "time [min]": time,
        "motor_speed [rpm]": speed,
        "torque [N*m]": torque,
        "belt_temperature [degC]": temperature,
        "driven_speed [rpm]": np.array(shown),
    }
