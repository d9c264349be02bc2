"""How far is a beam of steel and concrete bent under a load that does not change? As far as at the first moment."""

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    results,
)


@inputs
class Beam:
    """A beam under load: what the gauge shows at rest, and what a constant leaves out (0 as declared)."""

    rest: Float = given(0.0, "um", symbol="w_0", note="deflection at rest, from the zero of the gauge")
    motion: Float = given(0.0, "um", symbol="w_m", note="what goes to and fro")
    settlement: Float = given(0.0, "um", symbol="w_s", note="what comes or goes once")


@results
class Deflection:
    """What the gauge at mid-span shows."""

    deflection: Float = found("um", symbol="w", note="deflection at mid-span", formula="rest + motion + settlement")


def beam_deflection(beam: Beam) -> Deflection:
    """A constant: motion and settlement are 0 until an effect says otherwise."""
    return Deflection(deflection=beam.rest + beam.motion + beam.settlement)


TIME = Condition("time", "s", derived="since_start", note="since the record began; one reading per second")
BETWEEN_READINGS = 1.0  # s, between one reading and the next
GAUGES = 3  # that a multiplexer would read in turn


def wave(beam: Beam, sine: Float, cosine: Float, period: Float, time: Float) -> Beam:
    """Add a wave that neither grows nor fades; amplitudes in m, period and time in s."""
    turned = 2 * np.pi * time / period
    return replace(beam, motion=beam.motion + sine * np.sin(turned) + cosine * np.cos(turned))


def forced_vibration(beam: Beam, *, sine: Float, cosine: Float, period: Float, time: Float) -> Beam:
    """Something drives the beam to and fro, with a period that nobody wrote down."""
    return wave(beam, sine, cosine, period, time)


def gauges_in_turn(beam: Beam, *, sine: Float, cosine: Float, time: Float) -> Beam:
    """Three gauges are read in turn, and their zeros differ: every third reading is alike."""
    return wave(beam, sine, cosine, GAUGES * BETWEEN_READINGS, time)


def every_other_reading(beam: Beam, *, difference: Float, time: Float) -> Beam:
    """A reading is taken upward and the next one downward: one is high, one is low."""
    return wave(beam, np.zeros(np.shape(difference)), difference, 2 * BETWEEN_READINGS, time)


def creep(beam: Beam, *, whole: Float, after: Float, time: Float) -> Beam:
    """Concrete creeps under load: the deflection grows, less and less."""
    return replace(beam, settlement=beam.settlement + whole * (1 - np.exp(-time / after)))


def seating(beam: Beam, *, first: Float, lasts: Float, time: Float) -> Beam:
    """The beam seats itself on its supports: the first readings are off, the later ones are not."""
    return replace(beam, settlement=beam.settlement + first * np.exp(-time / lasts))


BEAM_DEFLECTION = Model(
    name="beam_deflection",
    title="Deflection of a beam",
    function=beam_deflection,
    cites=[
        "NIST/SEMATECH e-Handbook of Statistical Methods, section 1.4.2.5, Beam Deflections; data: H. S. Lew, 1969",
    ],
    errors=[
        Tolerance("rest", normal(sd="500 um"), why="the zero of the gauge was not written down"),
        Effect(
            "forced_vibration",
            on_inputs=forced_vibration,
            needs=[TIME],
            acts_at_reference=True,
            unknowns=[
                Unknown("sine", -1000, 1000, "um"),
                Unknown("cosine", -1000, 1000, "um"),
                Unknown("period", 2.1, 60, "s", note="two readings are the shortest that can be seen"),
            ],
            looks_like="a wave of one period, from the first row to the last",
        ),
        Effect(
            "gauges_in_turn",
            on_inputs=gauges_in_turn,
            needs=[TIME],
            acts_at_reference=True,
            unknowns=[Unknown("sine", -1000, 1000, "um"), Unknown("cosine", -1000, 1000, "um")],
            looks_like="every third reading is alike",
        ),
        Effect(
            "every_other_reading",
            on_inputs=every_other_reading,
            needs=[TIME],
            acts_at_reference=True,
            unknowns=[Unknown("difference", -1000, 1000, "um")],
            looks_like="high and low by turns",
        ),
        Effect(
            "creep",
            on_inputs=creep,
            needs=[TIME],
            unknowns=[Unknown("whole", -1000, 1000, "um"), Unknown("after", 10, 500, "s")],
            looks_like="grows, less and less",
            why="concrete under a load that stays",
        ),
        Effect(
            "seating",
            on_inputs=seating,
            needs=[TIME],
            acts_at_reference=True,
            unknowns=[Unknown("first", -1000, 1000, "um"), Unknown("lasts", 1, 20, "s")],
            looks_like="the first readings alone",
        ),
    ],
    sheet=[Section("Deflection", "deflection")],
)


@hookimpl
def truing_models() -> list[Model[Beam, Deflection]]:
    """Offer one calculation: beam_deflection."""
    return [BEAM_DEFLECTION]
