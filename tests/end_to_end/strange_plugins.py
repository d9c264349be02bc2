"""Calculations as strangers write them on their first day: one file, no effect, or not even a tolerance."""

BEAM = '''"""A beam clamped at one end, on a table that turns: how far does its tip sink?"""

import numpy as np

from truing import Float, Model, Tolerance, found, given, hookimpl, inputs, normal, results


@inputs
class Beam:
    """What must be known."""

    load: Float = given(200.0, "N", symbol="F", note="weight at the tip", at_least=0)
    turn: Float = given(0.0, "deg", symbol="alpha", note="angle of the table")
    length: Float = given(300.0, "mm", symbol="L", note="free length", above=0)
    modulus: Float = given(206.0, "GPa", symbol="E", note="Young's modulus", above=0)
    moment: Float = given(8000.0, "mm^4", symbol="I", note="second moment of area", above=0)


@results
class Tip:
    """What the gauge shows."""

    sag: Float = found("um", symbol="w", note="how far the tip sinks")


def beam(beam: Beam) -> Tip:
    """Return the deflection of a slender beam; the load acts across it as far as the table is level."""
    stiffness = 3 * beam.modulus * beam.moment / beam.length**3
    return Tip(sag=beam.load * np.cos(beam.turn) / stiffness)


ERRORS = [Tolerance("modulus", normal(sd="2 %"))]


@hookimpl
def truing_models() -> list[Model[Beam, Tip]]:
    """Offer it."""
    return [Model(name="beam", title="Clamped beam", function=beam, errors=ERRORS)]
'''
EXACT_BEAM = BEAM.replace('ERRORS = [Tolerance("modulus", normal(sd="2 %"))]', "ERRORS: list[Tolerance] = []")
