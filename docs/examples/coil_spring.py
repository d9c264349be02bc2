"""A helical compression spring: rate, force and stress, and how much they scatter."""

from dataclasses import replace
from typing import TYPE_CHECKING

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Odds,
    Published,
    Record,
    Reliability,
    Require,
    Section,
    Sensitivities,
    Sensitivity,
    Tolerance,
    Unknown,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    plus_minus,
    results,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@inputs
class Spring:
    """What is on the drawing, and how far the spring is compressed."""

    wire_diameter: Float = given(1.0, "mm", symbol="d", note="wire diameter", above=0)
    coil_diameter: Float = given(8.0, "mm", symbol="D", note="mean coil diameter", above=0)
    active_coils: Float = given(8.0, "", symbol="n", note="active coils", above=0)
    shear_modulus: Float = given(81.7, "GPa", symbol="G", note="shear modulus", source="music wire", above=0)
    compression: Float = given(10.0, "mm", symbol="s", note="compression", at_least=0)
    permitted_stress: Float = given(700.0, "MPa", symbol="tau_p", note="permitted shear stress", above=0)


@results
class Answer:
    """What the spring does."""

    index: Float = found("", symbol="C", note="spring index", formula="coil_diameter / wire_diameter")
    rate: Float = found(
        "N/mm",
        symbol="R",
        note="spring rate",
        formula="shear_modulus * wire_diameter**4 / (8 * coil_diameter**3 * active_coils)",
    )
    force: Float = found("N", symbol="F", note="force at this compression", formula="rate * compression")
    curvature: Float = found(
        "",
        symbol="K_B",
        note="correction for the curvature of the wire",
        formula="(4 * index + 2) / (4 * index - 3)",
        source="Bergstraesser",
    )
    stress: Float = found(
        "MPa",
        symbol="tau",
        note="largest shear stress in the wire",
        formula="curvature * 8 * force * coil_diameter / (pi * wire_diameter**3)",
    )


def coil_spring(spring: Spring) -> Answer:
    """Round wire, small pitch angle, spring index 4 to 12; every field is a number or an array (n,)."""
    index = spring.coil_diameter / spring.wire_diameter
    feasible(index > 1, "the coils overlap: the mean coil diameter must exceed the wire diameter")
    rate = spring.shear_modulus * spring.wire_diameter**4 / (8 * spring.coil_diameter**3 * spring.active_coils)
    force = rate * spring.compression
    curvature = (4 * index + 2) / (4 * index - 3)
    stress = curvature * 8 * force * spring.coil_diameter / (PI * spring.wire_diameter**3)
    return Answer(index=index, rate=rate, force=force, curvature=curvature, stress=stress)


PI = 3.141592653589793


@results
class Shares:
    """What the sensitivity study adds."""

    wire_share: Float = found("%", symbol="w_d", note="share of the wire diameter in the scatter of the force")


@results
class Chance:
    """What the reliability study adds."""

    strong_springs: Float = found("%", symbol="P_F", note="springs with enough force")


def shares(study: Sensitivities) -> Shares:
    """How much of the scatter of the force comes from the wire."""
    return Shares(wire_share=study.share["force"]["wire_diameter"])


def chance(odds: Odds) -> Chance:
    """The share of springs with enough force."""
    return Chance(strong_springs=odds.probability["force"])


TEMPERATURE = Condition("spring_temperature", "degC", reference=20, note="temperature of the spring")


def softening(spring: Spring, *, loss: Float, spring_temperature: Float) -> Spring:
    """The shear modulus falls with temperature, in a straight line up to some 200 degC."""
    warmer = spring_temperature - TEMPERATURE.zero
    return replace(spring, shear_modulus=spring.shear_modulus * (1 - loss * warmer))


BOOK = "Shigley, example 10-1"

CITES = ["R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, 10th ed., McGraw-Hill 2015, ch. 10"]

SPRING_OF_THE_BOOK = {
    "wire_diameter": "0.037 in",
    "coil_diameter": "0.4 in",
    "active_coils": "10.5",
    "shear_modulus": "11.85 Mpsi",
    "compression": "1.56 in",
}


def characteristic(record: Record[Spring, Answer]) -> "Figure":
    """Force over compression, with the point of this calculation."""
    import numpy as np
    from matplotlib.figure import Figure

    spring = record.inputs
    travel = np.linspace(0, 1.25 * spring.compression, 50)
    curve = record.function(replace(spring, compression=travel))
    figure = Figure(figsize=(5.5, 2.8), layout="constrained")
    panel = figure.subplots()
    panel.plot(1e3 * travel, curve.force)
    panel.plot(1e3 * spring.compression, record.results.force, "o")
    panel.set_xlabel("compression, mm")
    panel.set_ylabel("force, N")
    return figure


PUBLISHED = [
    Published(
        name="correction of curvature",
        result="curvature",
        value=1.124,
        where=BOOK,
        settings=SPRING_OF_THE_BOOK,
    ),
    Published(
        name="spring rate",
        result="rate",
        value=4.13,
        unit="lbf/in",
        where=BOOK,
        settings=SPRING_OF_THE_BOOK,
    ),
    Published(
        name="force at yield",
        result="force",
        value=6.46,
        unit="lbf",
        where=BOOK,
        settings=SPRING_OF_THE_BOOK,
        verdict="differs",
        why="the book prints the compression with three digits",
    ),
    Published(
        name="stress at yield",
        result="stress",
        value=146,
        unit="ksi",
        where=BOOK,
        settings=SPRING_OF_THE_BOOK,
    ),
]

COIL_SPRING = Model(
    name="coil_spring",
    title="Helical compression spring",
    function=coil_spring,
    published=PUBLISHED,
    cites=CITES,
    errors=[
        Tolerance("wire_diameter", plus_minus("0.015 mm"), why="drawn wire, EN 10270"),
        Tolerance("coil_diameter", plus_minus("0.15 mm"), why="coiling machine"),
        Tolerance("active_coils", plus_minus("0.1"), why="end coils"),
        Tolerance("shear_modulus", normal(sd="1 %"), why="between batches of wire"),
        Effect(
            "softening",
            on_inputs=softening,
            needs=[TEMPERATURE],
            looks_like="all forces fall with the temperature",
            unknowns=[Unknown("loss", 0, 1e-3, "1/K", note="loss of shear modulus; steel about 2.5e-4 1/K")],
        ),
    ],
    objectives=[
        Require("stress", at_most="permitted_stress"),
        Require("force", at_least="23 N", reliability=0.99),
    ],
    studies=[Sensitivity(of="force", gives=shares), Reliability(gives=chance)],
    sheet=[
        Section("Geometry", "index", text="Formulas hold for a spring index of 4 to 12."),
        Section("Force", "rate", "force", "strong_springs", "wire_share", figure=characteristic),
        Section("Stress", "curvature", "stress"),
    ],
)


@hookimpl
def truing_models() -> list[Model[Spring, Answer]]:
    """Offer one calculation: coil_spring."""
    return [COIL_SPRING]
