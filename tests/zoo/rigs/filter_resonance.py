"""A filter on a bench: a core of play elements driven through its loop, and a cable of many short sections.

The flux of the core is that of an ideal coil and of a row of elements that follow the current with a play of their own;
its fundamental wave over one period is the inductance that the source sees. The cable is a ladder of small coils and
capacitors with a mismatch at either end.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(hysteresis="core_hysteresis", echo="cable_echo")
Complex = NDArray[np.complex128]
NOISE = 0.01
"""Standard deviation of the analyser, of a gain of about 1."""
SOURCE, WINDING, LOAD, LINE = 50.0, 5.0, 1000.0, 50.0
"""Resistances of source, winding and load, and impedance of the cable, ohm."""
SECTIONS, SECONDS_PER_METRE = 256, 5e-9
CABLE_LOSS = 0.05
"""What the cable takes on one way, as a share of the amplitude."""
STRAY, SKIN = 4e-12, 1.5
"""Capacitance of the winding, F, and what skin effect adds to its resistance at 500 kHz, ohm: nobody minds them."""
PLAYS, POINTS = 60, 128
"""Elements of the core, and points of one period."""


@dataclass(frozen=True)
class Bench:
    """One filter: inductance in H, capacitance in F, gain; growth of the flux in 1/A; cable in m, reflections."""

    inductance: float
    capacitance: float
    level: float
    rayleigh: float = 0.0
    length: float = 300.0
    reflections: tuple[float, float] = (0.0, 0.0)


def loop_factor() -> complex:
    """What a loop adds to the inductance, per growth and amplitude: first wave of the flux of the elements.

    Elements of every play up to the amplitude bear alike; the flux of a half wave then grows as the square of the
    current. The current runs through one and a half periods, so that the loop is closed; its amplitude is 1.
    """
    phase = 2 * np.pi * np.arange(-POINTS // 2, POINTS) / POINTS
    plays = (np.arange(PLAYS) + 0.5) / PLAYS
    moved, flux = np.zeros(PLAYS), np.zeros(len(phase))
    for place, current in enumerate(np.sin(phase).tolist()):
        moved = np.clip(moved, current - plays, current + plays)
        flux[place] = 2 * np.mean(moved)
    one = np.exp(-1j * phase[-POINTS:])
    return complex(np.sum(flux[-POINTS:] * one) / np.sum(np.sin(phase[-POINTS:]) * one))


def current_of(bench: Bench, frequency: Array, drive: Array, loop: complex) -> tuple[Array, Complex]:
    """Amplitude of the current in A, damped iteration, and the impedance behind the coil in ohm."""
    turning = 2j * np.pi * frequency
    behind = 1 / (1 / LOAD + turning * bench.capacitance)
    resistance = WINDING + SKIN * np.sqrt(frequency / 5e5)
    current = np.zeros(len(frequency))
    for _ in range(60):
        wound = resistance + turning * bench.inductance * (1 + bench.rayleigh * current * loop)
        coil = 1 / (1 / wound + turning * STRAY)
        current = 0.5 * current + 0.5 * drive / np.abs(SOURCE + coil + behind)
    return current, np.asarray(behind, dtype=np.complex128)


def cable(bench: Bench, frequency: Array) -> Array:
    """What arrives at the receiver over what was meant, from the chain of all sections; 1 on average of the record."""
    if bench.reflections == (0.0, 0.0):
        return np.ones(len(frequency))
    near, far = (LINE * (1 + one) / (1 - one) for one in bench.reflections)
    turning = 2j * np.pi * frequency * bench.length * SECONDS_PER_METRE / SECTIONS
    series = LINE * (turning + CABLE_LOSS / SECTIONS)
    shunt = (turning + CABLE_LOSS / SECTIONS) / LINE
    voltage, current = np.ones(len(frequency), dtype=complex), np.full(len(frequency), 1 / far, dtype=complex)
    for _ in range(SECTIONS):
        current = current + shunt * voltage
        voltage = voltage + series * current
    passed = 1 / np.abs(voltage + near * current)
    return np.asarray(passed / np.mean(passed))


def gain(bench: Bench, frequency: Array, drive: Array, loop: complex) -> Array:
    """Amplitude at the receiver over that of the source."""
    current, behind = current_of(bench, frequency, drive, loop)
    return np.asarray(bench.level * current * np.abs(behind) / drive * cable(bench, frequency))


def programme(generator: np.random.Generator, rows: int) -> tuple[Array, Array, Array]:
    """Time in min, frequency in Hz, amplitude in V: sweeps up and down, each at a drive of its own."""
    time = 0.1 * np.arange(rows, dtype=np.float64)
    place = np.arange(rows) * 6 / rows + generator.uniform(0, 1)
    sweep = np.abs((place / 2) % 1 * 2 - 1)
    drive = np.array([0.3, 2.0, 1.0, 0.3, 2.0, 1.0, 0.3])[place.astype(int)]
    return time, np.asarray(1e3 * (80 + 1120 * sweep)), drive


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Six sweeps from 80 kHz to 1.2 MHz and back at three drives: what the analyser would show without noise."""
    inductance, capacitance, level = (np.array([1e-4, 1e-9, 1.0]) * generator.normal(1, [0.03, 0.02, 0.01])).tolist()
    time, frequency, drive = programme(generator, rows)
    loop = loop_factor()
    plain = gain(Bench(inductance, capacitance, level), frequency, drive, loop)
    rayleigh, reflection, length = 0.0, 0.0, 300.0
    if hidden in ("hysteresis", "hysteresis_and_echo"):

        def grown(growth: float) -> Array:
            return gain(Bench(inductance, capacitance, level, growth), frequency, drive, loop)

        rayleigh = sized(grown, plain, drawn_size(generator) * NOISE, 100.0, rtol=1e-3)
    if hidden in ("echo", "hysteresis_and_echo"):
        size, length = min(drawn_size(generator), 15.0), generator.uniform(150, 450)

        def waving(both: float) -> Array:
            bench = Bench(inductance, capacitance, level, 0.0, length, (np.sqrt(both), np.sqrt(both)))
            return gain(bench, frequency, drive, loop)

        reflection = float(np.sqrt(sized(waving, plain, size * NOISE, 0.5, rtol=1e-3)))
    bench = Bench(inductance, capacitance, level, rayleigh, length, (reflection, reflection))
    return {
        "time [min]": time,
        "frequency [kHz]": frequency / 1e3,
        "drive [V]": drive,
        "gain [-]": gain(bench, frequency, drive, loop),
    }
