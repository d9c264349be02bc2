"""The sheet of the press under load, its figures, and the calculation as truing knows it."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_geometry.drawing import BLUE, GREEN, GREY, INK, ORANGE, panels, quiet
from press_linkage.loaded import press_under_load
from press_linkage.loaded_effects import EFFECTS, TOLERANCES
from press_linkage.loaded_quantities import LoadedAnswers, LoadedPress
from truing import Block, Drawing, Model, Record, Reliability, Require, Section, Sensitivity, Sweep, Swept

LoadedRun = Record[LoadedPress, LoadedAnswers]

KILO, MILLION = 1e-3, 1e6
LIMITS = {
    "parallelism": "permitted_parallelism", "squareness": "permitted_squareness",
    "total_clearance": "permitted_clearance", "rated_deflection": "permitted_deflection",
    "rated_slope": "permitted_slope", "largest_guide_force": "permitted_guide_force",
}  # fmt: skip
"""What must stay below which input."""


def _over_angle(panel: Any, answers: LoadedAnswers, curves: Sequence[tuple[Any, str, str]], label: str) -> None:
    angle = np.degrees(np.asarray(answers.crank_angle))
    for values, name, colour in curves:
        panel.plot(angle, np.broadcast_to(np.asarray(values), angle.shape), label=name, color=colour)
    quiet(panel, "", label)
    panel.axhline(0.0, color=GREY, linewidth=0.7, zorder=1)
    if len(curves) > 1:
        panel.legend(loc="best")


def stroke_figure(answers: LoadedAnswers) -> Figure:
    """Draw deflection and tilt of the slider over the crank angle, with the force."""
    figure, rows = panels(3, 5.4, sharex=True)
    _over_angle(rows[0], answers, [(KILO * answers.press_force, "", ORANGE)], "force, kN")
    _over_angle(rows[1], answers, [(MILLION * answers.deflection, "", BLUE)], "deflection, µm")
    tilts = [(MILLION * answers.slider_tilt, "slider", BLUE), (MILLION * answers.platform_tilt, "platform", GREEN)]
    _over_angle(rows[2], answers, tilts, "tilt, µrad")
    rows[2].set_xlabel("crank angle from the bottom dead centre, °")
    return figure


def forces_figure(answers: LoadedAnswers) -> Figure:
    """Draw the forces of the guides, and of the lower links of both sides."""
    figure, (upper, lower) = panels(2, 4.4, sharex=True)
    guides = [
        (KILO * answers.upper_guide_force, "slider, upper", BLUE),
        (KILO * answers.lower_guide_force, "slider, lower", ORANGE),
        (KILO * answers.platform_guide_upper, "platform, upper", GREEN),
        (KILO * answers.platform_guide_lower, "platform, lower", INK),
    ]
    _over_angle(upper, answers, guides, "guides, kN")
    links = [
        (KILO * answers.lower_link_1, "side 1", BLUE), (KILO * answers.lower_link_2, "side 2", ORANGE),
    ]  # fmt: skip
    _over_angle(lower, answers, links, "lower links, kN")
    lower.set_xlabel("crank angle from the bottom dead centre, °")
    return figure


def offset_figure(swept: Swept) -> Figure:
    """Draw the largest tilt and guide force over the offset of the force."""
    figure, (upper, lower) = panels(2, 3.8, sharex=True)
    upper.plot(1e3 * swept.axis, MILLION * np.asarray(swept.results["largest_tilt"]), color=BLUE)
    quiet(upper, "", "largest tilt, µrad")
    lower.plot(1e3 * swept.axis, KILO * np.asarray(swept.results["largest_guide_force"]), color=ORANGE)
    quiet(lower, "offset of the force, mm", "guide force, kN")
    return figure


def giving_way(record: LoadedRun) -> Sequence[Block]:
    """Deflection and tilt over the stroke."""
    return [Drawing("Slider under load over the stroke", partial(stroke_figure, record.results))]


def guiding(record: LoadedRun) -> Sequence[Block]:
    """Guide and link forces over the stroke, and over the offset where it was swept."""
    drawn: list[Block] = [Drawing("Guides and lower links over the stroke", partial(forces_figure, record.results))]
    swept = record.studies.get("sweep")
    if swept is not None and swept.over == "load_offset":
        caption = "The steps of the curves are play and clearance that the load takes up."
        drawn.append(Drawing("Tilt and guide force over the offset", partial(offset_figure, swept), caption))
    return drawn


SECTIONS = [
    Section(
        "Acceptance without force",
        "parallelism", "squareness", "total_clearance",
        text="At the crank angles of the test, with weights and counterbalance alone, as dial gauges on the bolster "
        "would show it; the total clearance is that of the joints alone, at the bottom dead centre. JIS B 6402 and "
        "ISO 6899 name these tests; their permitted values are bought with the standard and depend on class and size. "
        "Those in the inputs say where they come from: state the ones that were ordered.",
    ),
    Section(
        "Acceptance under load",
        "rated_deflection", "press_stiffness", "rated_slope", "tilt_stiffness",
        text="At the bottom dead centre, from no force to the rated one in the middle, and from there to its offset: "
        "links, joints, crank drive, frame at the ground joints and columns in series, play included.",
    ),
    Section(
        "Over the stroke",
        "time", "crank_angle", "press_force", "slider_position", "deflection", "slider_tilt", "slider_shift",
        "platform_tilt", "ground_rise_1", "ground_rise_2", "largest_tilt",
        text="Force, weights, counterbalance and inertia act on the press with its play, its errors and its "
        "temperature; the potential energy is least. Deflection and tilt are those against the bolster.",
        blocks=giving_way,
    ),
    Section(
        "Guides and links",
        "upper_guide_force", "lower_guide_force", "largest_guide_force", "platform_guide_upper", "platform_guide_lower",
        "lower_link_1", "lower_link_2", "upper_link_1", "upper_link_2", "rod_1", "rod_2",
        text="A guide carries once its clearance is used up. Positive guide forces push towards side 1; positive link "
        "forces press the link.",
        blocks=guiding,
    ),
]  # fmt: skip

LITERATURE = [
    "The mechanism and the tolerances of its parts: Qian Huanan, Tao Jing, Yu Suiran (騫華楠, 陶璟, 于隨然). It gives "
    "no sections, stiffness, clearance or masses.",
    "R. D. Cook, D. S. Malkus, M. E. Plesha, R. J. Witt, Concepts and applications of finite element analysis: bars in "
    "a plane by displacements and least potential energy.",
    "JIS B 6402:2020, Mechanical presses, accuracy classes and tests; ISO 6899, Acceptance conditions of open front "
    "mechanical power presses: what is tested.",
    "GOST 7766-88, Closed single-action crank presses, 2.7: 0.06 mm per 1000 mm for the bolster plate.",
]

LOADED = Model(
    name="loaded",
    title="Servo press under load: deflection, tilt, guides and acceptance",
    function=press_under_load,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[Require(result, at_most=limit, reliability="acceptance_goal") for result, limit in LIMITS.items()],
    studies=[
        Sweep(over="load_offset", at="-400..400 mm", points=41),
        Sensitivity(of=("rated_deflection", "rated_slope")),
        Reliability(draws=2000, method=("monte_carlo",)),
    ],
    sheet=SECTIONS,
    cites=LITERATURE,
    example=Path(__file__).with_name("loaded.toml"),
    summary="How far does a servo press give way under a force beside its middle, what do its guides carry, and does "
    "it pass its acceptance test?",
)
