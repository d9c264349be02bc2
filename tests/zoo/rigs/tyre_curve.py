"""A tyre on a drum: rubber elements run through the contact, stick, and slide; the carcass is followed in time.

Each element is bent by the slip of the tread until it bends more than friction at its own pressure can hold. The
contact grows with the root of the load, so the pressure does as well; a rubber that grips less under pressure then
loses friction with the load. The tread follows the wheel by an equation of the way rolled, integrated in small steps.
"""

from dataclasses import dataclass

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(relaxation="relaxation", load="load_sensitivity")
NOISE = 0.03
"""Standard deviation of the hub, kN."""
ELEMENTS = 200
STIFFNESS = 15.0
"""Cornering stiffness over the load, 1/rad."""
HALF_LENGTH = 0.06
"""Half the length of the contact at 4 kN, m; it grows with the root of the load."""
AHEAD, BLOCK = 0.04, 0.85
"""By how much the pressure leans to the front; share of its own pressure that a block of the tread evens out."""
LONGEST_STEP = 0.06
"""Longest way that the wheel rolls in a step of the integration, over the relaxation length."""
LONGER = 0.15
"""Exponent of the relaxation length over the load."""


@dataclass(frozen=True)
class Tread:
    """One tyre: stiffness and friction over those of the drawing, exponent over the pressure, relaxation length, m."""

    stiffness: float
    friction: float
    exponent: float = 0.0
    length: float = 0.0


@dataclass(frozen=True)
class Run:
    """Time in s, angle of the wheel in rad and its rate in rad/s, load in kN, speed in m/s; each of shape (rows,)."""

    time: Array
    angle: Array
    rate: Array
    load: Array
    speed: Array


def steady(tread: Tread, angle: Array, load: Array) -> Array:
    """Side force in kN: what all elements bear, each as much as it is bent or as friction holds under its pressure."""
    half = HALF_LENGTH * np.sqrt(load / 4)
    place = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    parabola = 6 * place * (1 - place) * (1 + AHEAD * (1 - 2 * place))
    pressure = load[:, None] * parabola  # per share of the contact, kN; its integral is the load
    bristle = STIFFNESS * tread.stiffness * load / (2 * half**2)  # kN per metre of contact and metre of bend
    bent = (bristle * (2 * half) ** 2 * np.abs(np.tan(angle)))[:, None] * place
    felt = (1 - BLOCK) * parabola + BLOCK  # a block of the tread spreads its load
    grip = tread.friction * (np.sqrt(load / 4)[:, None] * felt) ** (-2 * tread.exponent)
    return np.asarray(np.sign(angle) * np.mean(np.minimum(bent, grip * pressure), axis=1))


def followed(tread: Tread, run: Run) -> Array:
    """Angle of the tread in rad: it comes up with the wheel by the way rolled over the relaxation length (midpoint)."""
    if tread.length == 0:
        return run.angle.copy()
    now, angles = float(run.angle[0] - tread.length / run.speed[0] * run.rate[0]), []
    before = (float(run.time[0]), float(run.angle[0]))
    for time, angle, load, speed in zip(
        *(one.tolist() for one in (run.time, run.angle, run.load, run.speed)), strict=True
    ):
        pace = speed / (tread.length * (load / 4) ** LONGER)
        steps = max(1, int(np.ceil((time - before[0]) * pace / LONGEST_STEP)))
        way = (time - before[0]) / steps * pace
        for target in np.linspace(before[1], angle, 2 * steps + 1)[1::2].tolist():
            now += way * (target - now - way / 2 * (target - now))
        before = (time, angle)
        angles.append(now)
    return np.array(angles)


def force(tread: Tread, run: Run) -> Array:
    """Side force in kN, row by row."""
    return steady(tread, followed(tread, run), run.load)


def programme(generator: np.random.Generator, rows: int) -> Run:
    """Sweeps of the angle to and fro, three loads at two speeds, one after another; steered as a rounded triangle."""
    time = np.linspace(0, 120, rows)
    period, start = generator.uniform(17, 23), generator.uniform(0, 6)
    phase = 2 * np.pi * time / period + start
    peak = np.radians(generator.uniform(9, 12))
    angle = peak * np.arcsin(0.97 * np.sin(phase)) / np.arcsin(0.97)
    rate = peak / np.arcsin(0.97) * 0.97 * np.cos(phase) / np.sqrt(1 - (0.97 * np.sin(phase)) ** 2) * 2 * np.pi / period
    place = (6 * np.arange(rows) // rows).astype(int)
    order = generator.permutation(6)
    load = np.array([2.0, 4.0, 6.0, 2.0, 4.0, 6.0])[order][place] + generator.normal(0, 0.05, rows)
    speed = np.array([15.0, 15.0, 15.0, 45.0, 45.0, 45.0])[order][place] / 3.6
    return Run(time, np.asarray(angle), np.asarray(rate), load, speed)


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Two minutes of sweeps: what the hub would show without noise."""
    stiff, grip = generator.normal(1, [0.04, 0.03]).tolist()
    run = programme(generator, rows)
    warm = 45 + 12 * (1 - np.exp(-run.time / 40)) + generator.normal(0, 0.5, rows)
    plain = force(Tread(stiff, grip), run)
    length = exponent = 0.0
    if hidden in ("relaxation", "relaxation_and_load"):
        size = drawn_size(generator) * NOISE
        length = sized(lambda way: force(Tread(stiff, grip, 0.0, way), run), plain, size, 3.0, low=0.01, rtol=1e-2)
    if hidden in ("load", "relaxation_and_load"):
        size = drawn_size(generator) * NOISE
        exponent = sized(lambda power: force(Tread(stiff, grip, power), run), plain, size, 1.0, rtol=1e-2)
    return {
        "time [s]": run.time,
        "slip_angle [deg]": np.degrees(run.angle),
        "slip_rate [deg/s]": np.degrees(run.rate),
        "load [kN]": run.load,
        "speed [km/h]": 3.6 * run.speed,
        "tread_temperature [degC]": warm,
        "side_force [kN]": force(Tread(stiff, grip, exponent, length), run),
    }
