"""By how much does the air pressure of Easter Island exceed that of Darwin, month by month?"""

from dataclasses import replace

import numpy as np

from truing import (
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

YEAR = 365.25 * 86400.0  # s; a month is a twelfth of it


@inputs
class Ocean:
    """The south of the Pacific; what is no constant is neutral as declared."""

    time: Float = given(1.0, "month", symbol="t", note="time of the record")
    mean: Float = given(10.0, "", symbol="p_0", note="mean difference, in units of the source")
    added: Float = given(0.0, "", symbol="p_1", note="what cycles add to it")


@results
class Difference:
    """What drives the trade winds."""

    pressure: Float = found("", symbol="p", note="difference, in units of the source", formula="mean + added")


def pacific_pressure(ocean: Ocean) -> Difference:
    """A constant, until an effect says otherwise. Shapes (n,) or numbers."""
    return Difference(pressure=ocean.mean + ocean.added)


def with_wave(ocean: Ocean, sine: Float, cosine: Float, period: Float) -> Ocean:
    """Return the ocean with a wave over time; the period is in seconds."""
    angle = 2 * np.pi * ocean.time / period
    return replace(ocean, added=ocean.added + sine * np.sin(angle) + cosine * np.cos(angle))


def seasons(ocean: Ocean, *, sine: Float, cosine: Float) -> Ocean:
    """Summer and winter."""
    return with_wave(ocean, sine, cosine, YEAR)


def half_year(ocean: Ocean, *, sine: Float, cosine: Float) -> Ocean:
    """The sun crosses the equator twice a year."""
    return with_wave(ocean, sine, cosine, YEAR / 2)


def el_nino(ocean: Ocean, *, sine: Float, cosine: Float, period: Float) -> Ocean:
    """Warm water comes back every three to five years."""
    return with_wave(ocean, sine, cosine, period)


def southern_oscillation(ocean: Ocean, *, sine: Float, cosine: Float, period: Float) -> Ocean:
    """The air swings between west and east in about two years."""
    return with_wave(ocean, sine, cosine, period)


PACIFIC_PRESSURE = Model(
    name="pacific_pressure",
    title="Air pressure over the Pacific",
    function=pacific_pressure,
    errors=[
        Tolerance("mean", normal(sd="1"), why="of one decade against another"),
        Effect(
            "seasons",
            on_inputs=seasons,
            looks_like="a wave of twelve months",
            unknowns=[Unknown("sine", -10, 10), Unknown("cosine", -10, 10)],
        ),
        Effect(
            "half_year",
            on_inputs=half_year,
            looks_like="a wave of six months",
            unknowns=[Unknown("sine", -10, 10), Unknown("cosine", -10, 10)],
        ),
        Effect(
            "el_nino",
            on_inputs=el_nino,
            looks_like="a slow wave",
            unknowns=[Unknown("sine", -10, 10), Unknown("cosine", -10, 10), Unknown("period", 35, 60, "month")],
        ),
        Effect(
            "southern_oscillation",
            on_inputs=southern_oscillation,
            looks_like="a wave of about two years",
            unknowns=[Unknown("sine", -10, 10), Unknown("cosine", -10, 10), Unknown("period", 18, 35, "month")],
        ),
    ],
    sheet=[Section("Pressure", "pressure")],
)


@hookimpl
def truing_models() -> list[Model[Ocean, Difference]]:
    """Offer one calculation: pacific_pressure."""
    return [PACIFIC_PRESSURE]
