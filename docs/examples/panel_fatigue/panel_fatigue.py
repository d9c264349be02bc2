"""How many cycles does a notched composite panel last under a stress amplitude?"""

from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    normal,
    results,
)


@inputs
class Panel:
    """A specimen on the fatigue rig; what Basquin's line leaves out is neutral as declared."""

    stress: Float = given(300.0, "MPa", symbol="S", note="stress, as the rig reads it", above=0)
    usual_stress: Float = given(300.0, "MPa", symbol="S_0", note="stress in the middle of the test", above=0)
    usual_log_life: Float = given(6.2, "", symbol="a", note="logarithm of the cycles to failure at S_0")
    exponent: Float = given(13.0, "", symbol="m", note="exponent of the life", above=0)
    limit: Float = given(0.0, "MPa", symbol="S_L", note="stress below which no crack grows")
    misread: Float = given(0.0, "MPa", symbol="S_Z", note="by how much the stress is higher than was read")
    strength_inverse: Float = given(0.0, "1/MPa", symbol="u", note="inverse of the static strength")
    knee: Float = given(285.0, "MPa", symbol="S_K", note="stress of the knee", above=0)
    knee_exponent: Float = given(0.0, "", symbol="m_K", note="by how much the exponent is larger below the knee")


@results
class Life:
    """How long it lasts."""

    log_life: Float = found(
        "", symbol="L", note="logarithm (base 10) of the cycles to failure",
        formula="usual_log_life"
        " - exponent * log10((stress + misread - limit) / (usual_stress + misread - limit))"
        " + exponent * log10((1 - strength_inverse * stress) / (1 - strength_inverse * usual_stress))"
        " + knee_exponent * max(log10(knee / stress), 0)",
    )  # fmt: skip


def panel_fatigue(panel: Panel) -> Life:
    """Basquin's line in logarithms; the scatter of a specimen is that of its logarithm. Shapes (n,) or numbers."""
    above = np.minimum(panel.stress, panel.usual_stress) + panel.misread - panel.limit
    feasible(above > 0, "below the fatigue limit: no crack grows, and the life has no end")
    strongest = np.maximum(panel.stress, panel.usual_stress)
    feasible(panel.strength_inverse * strongest < 1, "the stress reaches the static strength: nothing lasts a cycle")
    driving = (panel.stress + panel.misread - panel.limit) / (panel.usual_stress + panel.misread - panel.limit)
    reserve = (1 - panel.strength_inverse * panel.stress) / (1 - panel.strength_inverse * panel.usual_stress)
    straight = panel.usual_log_life + panel.exponent * (np.log10(reserve) - np.log10(driving))
    return Life(log_life=straight + panel.knee_exponent * np.maximum(np.log10(panel.knee / panel.stress), 0))


def fatigue_limit(panel: Panel, *, stress: Float) -> Panel:
    """Below some stress no crack grows: life rises without end towards it."""
    return replace(panel, limit=panel.limit + stress)


def knee(panel: Panel, *, exponent: Float, stress: Float) -> Panel:
    """Below a knee another mechanism is at work, with a line of its own."""
    at = np.where(np.equal(exponent, 0), panel.knee, stress)
    return replace(panel, knee_exponent=panel.knee_exponent + exponent, knee=at)


def static_strength(panel: Panel, *, inverse: Float) -> Panel:
    """Close to the static strength a panel lasts less than the line says."""
    return replace(panel, strength_inverse=panel.strength_inverse + inverse)


def grip_bending(panel: Panel, *, stress: Float) -> Panel:
    """The grips bend every panel: a stress that the load cell does not read."""
    return replace(panel, misread=panel.misread + stress)


def load_cell_zero(panel: Panel, *, stress: Float) -> Panel:
    """The load cell is off by the same amount at every stress."""
    return replace(panel, misread=panel.misread + stress)


PANEL_FATIGUE = Model(
    name="panel_fatigue",
    title="Fatigue of a composite panel",
    function=panel_fatigue,
    cites=["O. H. Basquin, The exponential law of endurance tests, Proc. ASTM 10 (1910) 625"],
    errors=[
        Tolerance("usual_log_life", normal(sd="0.3"), why="read off a diagram of a like laminate"),
        Tolerance("exponent", lognormal(sd="50 %"), why="laminates have anything from 8 to 25"),
        Effect(
            "fatigue_limit",
            on_inputs=fatigue_limit,
            looks_like="lives rise ever faster towards low stress",
            unknowns=[Unknown("stress", 0, 260, "MPa")],
        ),
        Effect(
            "knee",
            on_inputs=knee,
            looks_like="a kink, and another straight line below it",
            unknowns=[Unknown("exponent", 0, 40), Unknown("stress", 275, 360, "MPa", note="where the line breaks")],
        ),
        Effect(
            "static_strength",
            on_inputs=static_strength,
            looks_like="lives fall ever faster towards high stress",
            unknowns=[Unknown("inverse", 0, 0.0025, "1/MPa", note="0.0025: a strength of 400 MPa")],
        ),
        Effect(
            "grip_bending",
            on_inputs=grip_bending,
            looks_like="as a fatigue limit, to the other side",
            unknowns=[Unknown("stress", 0, 100, "MPa")],
        ),
        Effect(
            "load_cell_zero",
            on_inputs=load_cell_zero,
            looks_like="as a small fatigue limit, to either side",
            unknowns=[Unknown("stress", -10, 10, "MPa")],
        ),
    ],
    sheet=[Section("Life", "log_life")],
)


@hookimpl
def truing_models() -> list[Model[Panel, Life]]:
    """Offer one calculation: panel_fatigue."""
    return [PANEL_FATIGUE]
