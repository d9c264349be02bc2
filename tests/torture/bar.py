"""A clamped bar: the smallest calculation that has a check, a study, an effect and a published number."""

from dataclasses import replace

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Published,
    Reliability,
    Require,
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
class Bar:
    """The bar and its load."""

    load: Float = given(10.0, "kN", symbol="F", note="load", above=0)
    area: Float = given(100.0, "mm^2", symbol="A", note="cross section", above=0)


@results
class Answer:
    """What the bar does."""

    stress: Float = found("MPa", symbol="sigma", note="stress", formula="load / area")


def bar(machine: Bar) -> Answer:
    """Uniform stress."""
    return Answer(stress=machine.load / machine.area)


def heating(machine: Bar, *, rise: Float, bar_temperature: Float) -> Bar:
    """The load grows with the temperature."""
    return replace(machine, load=machine.load * (1 + rise * (bar_temperature - TEMPERATURE.zero)))


TEMPERATURE = Condition("bar_temperature", "degC", reference=20, note="temperature of the bar")
BAR = Model(
    name="bar",
    title="Clamped bar",
    function=bar,
    errors=[
        Tolerance("area", normal(sd="1 %"), why="rolled"),
        Effect(
            "heating",
            on_inputs=heating,
            needs=[TEMPERATURE],
            looks_like="grows with the temperature",
            unknowns=[Unknown("rise", 0, 0.01, "1/K", note="growth of the load")],
        ),
    ],
    objectives=[Require("stress", at_most="120 MPa", reliability=0.9)],
    studies=[Reliability(draws=256, batch=64)],
    published=[Published(name="stress", result="stress", value=100.0, unit="MPa", where="by hand")],
    sheet=[Section("Stress", "stress")],
)


@hookimpl
def truing_models() -> list[Model[Bar, Answer]]:
    """Offer one calculation: bar."""
    return [BAR]
