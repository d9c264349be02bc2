"""A low-pass filter of a coil and a capacitor: what does it pass on at a frequency? Ideal parts, matched cables."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from truing import Condition, Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from zoo.zoo import acting

TWO_PI = 6.283185307179586
RATED = 5e5
"""Frequency at which losses are stated, Hz."""
ROUNDS = 8
"""How often the current of the coil and its inductance are made to fit each other."""
LOSS_OF_A_LOOP = 4 / (3 * 3.141592653589793)
"""Loss over the gain of inductance of a loop after Rayleigh."""


@inputs
class Filter:
    """The parts, and one frequency and amplitude of the source."""

    frequency: Float = given(500.0, "kHz", symbol="f", note="frequency of the source", above=0)
    drive: Float = given(1.0, "V", symbol="U_0", note="amplitude of the source, without load", above=0)
    inductance: Float = given(100.0, "uH", symbol="L", note="of the coil, at small current", above=0)
    capacitance: Float = given(1.0, "nF", symbol="C", note="of the capacitor", above=0)
    source_resistance: Float = given(50.0, "ohm", symbol="R_S", note="of the source", at_least=0)
    winding: Float = given(5.0, "ohm", symbol="R_W", note="of the winding", at_least=0)
    load: Float = given(1.0, "kohm", symbol="R_L", note="behind the filter", above=0)
    level: Float = given(1.0, "", symbol="k", note="gain of the amplifier behind the filter", above=0)
    rayleigh: Float = given(0.0, "1/A", symbol="r", note="growth of the inductance with the amplitude of its current")
    skin: Float = given(0.0, "ohm", symbol="R_F", note="resistance that skin effect adds at 500 kHz")
    stray: Float = given(0.0, "pF", symbol="C_W", note="capacitance of the winding", at_least=0)
    loss_factor: Float = given(0.0, "", symbol="tan_d", note="loss factor of the capacitor", at_least=0)
    warm: Float = given(0.0, "", symbol="c", note="share of its capacitance that the capacitor has lost", below=1)
    echo_sine: Float = given(0.0, "", symbol="e_s", note="echo of the cable, sine part")
    echo_cosine: Float = given(0.0, "", symbol="e_c", note="echo of the cable, cosine part")
    echo_delay: Float = given(2.0, "us", symbol="tau", note="time of the echo for both ways", above=0)


@results
class Passed:
    """What the filter passes on."""

    current: Float = found("mA", symbol="I", note="amplitude of the current in the coil", method="complex amplitudes")
    gain: Float = found("", symbol="G", note="amplitude behind the amplifier over that of the source", method="divider")


def filter_resonance(parts: Filter) -> Passed:
    """Complex amplitudes of a divider; coil and current are made to fit each other where the core is not linear."""
    turning = TWO_PI * parts.frequency
    admittance = 1 / parts.load + turning * parts.capacitance * (1 - parts.warm) * (1j + parts.loss_factor)
    current: Float = np.zeros_like(turning)
    for _ in range(ROUNDS):
        around = parts.source_resistance + coil(parts, turning, current) + 1 / admittance
        current = parts.drive / np.abs(around)
    feasible(np.isfinite(current), "the current of the coil cannot be calculated")
    phase = turning * parts.echo_delay
    echo = 1 + parts.echo_sine * np.sin(phase) + parts.echo_cosine * np.cos(phase)
    return Passed(current=current, gain=parts.level * current / np.abs(admittance) / parts.drive * echo)


def coil(parts: Filter, turning: Float, current: Float) -> NDArray[np.complex128]:
    """Impedance of the coil in ohm at an amplitude of its current in A; Rayleigh's law for the loops of its core."""
    grown = parts.rayleigh * current
    resistance = parts.winding + parts.skin * np.sqrt(parts.frequency / RATED)
    core = turning * parts.inductance * (1j * (1 + grown) + LOSS_OF_A_LOOP * grown)
    return np.asarray(1 / (1 / (resistance + core) + 1j * turning * parts.stray))


TIME = Condition("time", "min", derived="since_start", note="since the filter was switched on")


def core_hysteresis(parts: Filter, *, rayleigh: Float) -> Filter:
    """The core follows the current in loops: inductance and loss grow with the amplitude (Rayleigh)."""
    return replace(parts, rayleigh=parts.rayleigh + rayleigh)


def cable_echo(parts: Filter, *, sine: Float, cosine: Float, delay: Float) -> Filter:
    """The cable is not matched at its ends: what runs to and fro adds a wave over the frequency."""
    on = np.not_equal(sine, 0) | np.not_equal(cosine, 0)
    return replace(
        parts,
        echo_sine=parts.echo_sine + sine,
        echo_cosine=parts.echo_cosine + cosine,
        echo_delay=np.where(on, delay, parts.echo_delay),
    )


def skin_effect(parts: Filter, *, resistance: Float) -> Filter:
    """The current keeps to the skin of the wire: its resistance grows with the root of the frequency."""
    return replace(parts, skin=parts.skin + resistance)


def winding_capacitance(parts: Filter, *, capacitance: Float) -> Filter:
    """The turns of the coil are a capacitor: far above resonance the filter lets through."""
    return replace(parts, stray=parts.stray + capacitance)


def lossy_dielectric(parts: Filter, *, loss_factor: Float) -> Filter:
    """The dielectric of the capacitor warms up in the field."""
    return replace(parts, loss_factor=parts.loss_factor + loss_factor)


def warming_capacitor(parts: Filter, *, loss: Float, time_constant: Float, time: Float) -> Filter:
    """The ceramic of the capacitor warms up after switching on, and loses capacitance."""
    return replace(parts, warm=parts.warm + loss * (1 - np.exp(-time / time_constant)))


def compression(parts: Filter, base: Passed, *, per_square: Float) -> Passed:
    """The amplifier falls short at large amplitude, as the square."""
    return replace(base, gain=base.gain * (1 - per_square * (base.gain * parts.drive) ** 2))


FILTER_RESONANCE = Model(
    name="filter_resonance",
    title="Resonance of a low-pass filter",
    function=filter_resonance,
    errors=[
        Tolerance("inductance", normal(sd="3 %"), why="wound by hand"),
        Tolerance("capacitance", normal(sd="2 %"), why="class of the part"),
        Tolerance("level", normal(sd="1 %"), why="calibrated with a filter bridged"),
        acting(core_hysteresis, Unknown("rayleigh", 0, 60, "1/A")),
        acting(
            cable_echo,
            Unknown("sine", -0.3, 0.3),
            Unknown("cosine", -0.3, 0.3),
            Unknown("delay", 0.5, 10, "us", note="both ways; 10 ns per metre of cable"),
        ),
        acting(skin_effect, Unknown("resistance", 0, 60, "ohm", note="at 500 kHz")),
        acting(winding_capacitance, Unknown("capacitance", 0, 200, "pF")),
        acting(lossy_dielectric, Unknown("loss_factor", 0, 0.2)),
        acting(warming_capacitor, Unknown("loss", 0, 0.2), Unknown("time_constant", 0.5, 30, "min"), needs=[TIME]),
        acting(compression, Unknown("per_square", 0, 0.1, "1/V^2"), on="reading"),
    ],
)
