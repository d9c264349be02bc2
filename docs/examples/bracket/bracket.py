"""A flat bar, clamped at one end and loaded at the other: the workbook as a calculation."""

from dataclasses import replace

from truing import (
    Effect,
    Float,
    Model,
    Reliability,
    Require,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    plus_minus,
    results,
)


@inputs
class Bracket:
    """The cells with a number in them: C5 to C11."""

    force: Float = given(450, "N", symbol="F", note="force at the end", source="largest force of the actuator")
    length: Float = given(120, "mm", symbol="l", note="from the clamp to the force", source="LG-0815", above=0)
    width: Float = given(30, "mm", symbol="b", note="width", source="flat bar 30 x 6", above=0)
    thickness: Float = given(6, "mm", symbol="t", note="thickness", source="flat bar 30 x 6", above=0)
    modulus: Float = given(210, "GPa", symbol="E", note="modulus of elasticity", source="steel", above=0)
    permitted_stress: Float = given(320, "MPa", symbol="sigma_p", note="permitted stress", source="works standard 12")
    permitted_deflection: Float = given(2.5, "mm", symbol="w_p", note="permitted deflection", source="clearance")


@results
class Answer:
    """The cells with a formula in them: C13 to C17."""

    section: Float = found("mm^3", symbol="W", note="section modulus", formula="width * thickness**2 / 6")
    inertia: Float = found("mm^4", symbol="I", note="second moment of area", formula="width * thickness**3 / 12")
    moment: Float = found("N*m", symbol="M", note="bending moment", formula="force * length")
    stress: Float = found("MPa", symbol="sigma", note="bending stress", formula="moment / section")
    deflection: Float = found(
        "mm", symbol="w", note="deflection at the force", formula="force * length**3 / (3 * modulus * inertia)"
    )


def bracket(cells: Bracket) -> Answer:
    """The same formulas, for the computer: cells.width instead of C7."""
    section = cells.width * cells.thickness**2 / 6
    inertia = cells.width * cells.thickness**3 / 12
    moment = cells.force * cells.length
    stress = moment / section
    deflection = cells.force * cells.length**3 / (3 * cells.modulus * inertia)
    return Answer(section=section, inertia=inertia, moment=moment, stress=stress, deflection=deflection)


def soft_clamp(cells: Bracket, answer: Answer, *, turn: Float) -> Answer:
    """The clamp turns with the moment, and the end of the bar goes down with it."""
    return replace(answer, deflection=answer.deflection + turn * cells.force * cells.length**2)


BRACKET = Model(
    name="bracket",
    title="Bracket",
    function=bracket,
    errors=[
        Tolerance("thickness", plus_minus("0.3 mm"), why="flat bar, as delivered"),
        Effect(
            "soft_clamp",
            on_results=soft_clamp,
            looks_like="more deflection, with the square of the length",
            unknowns=[Unknown("turn", 0, 5e-4, "rad/(N*m)", note="turn of the clamp for a moment")],
        ),
    ],
    objectives=[
        Require("stress", at_most="permitted_stress", reliability=0.99),
        Require("deflection", at_most="permitted_deflection"),
    ],
    studies=[Reliability()],
)


@hookimpl
def truing_models() -> list[Model[Bracket, Answer]]:
    """Offer the calculation."""
    return [BRACKET]
