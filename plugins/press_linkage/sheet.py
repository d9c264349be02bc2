"""The sheet, in the order an engineer reads it."""

from collections.abc import Sequence
from dataclasses import fields
from functools import partial
from math import degrees, isfinite
from typing import TypeGuard

from press_linkage.answers import EVERY, LINKS, sources_of
from press_linkage.errors import POLAR_ANGLES, SOURCES
from press_linkage.figures import PressRun, along_the_synthesis, mechanism, over_the_turn, salience_bars, way
from press_linkage.kinematics import top_crank_angle
from press_linkage.published import WHERE
from press_linkage.quantities import ErrorInfluence
from truing import Block, Drawing, Section, Sensitivities, Table, Words

DECLARED = tuple(field.name for field in fields(ErrorInfluence))
INFLUENCES = tuple(name for name in DECLARED if name.startswith("influence_"))
CHAIN = DECLARED[: DECLARED.index(INFLUENCES[0])]
MICROMETRE_2 = 1e-12
MICRORADIAN_2 = 1e-12


def travel(record: "PressRun") -> Sequence[Block]:
    """The way of the slider over one turn, with the effects that are on."""
    swept = record.studies.get("sweep")
    up = -degrees(top_crank_angle(record.inputs))
    caption = f"The crank turns {up:.0f}° one way and {360 - up:.0f}° the other." if isfinite(up) else "It only swings."
    press = record.inputs if swept is None else swept.inputs
    return [Drawing("Slider over one turn of the crank", partial(way, press), caption)]


def knows_every_error(found: "Sensitivities | None") -> "TypeGuard[Sensitivities]":
    """Whether the sensitivity study ran as declared, for both results and all errors."""
    return found is not None and all(
        set(SOURCES) <= set(found.derivatives.get(result, ())) for result in ("slider_position", "slider_tilt")
    )


def saliences(record: "PressRun") -> Sequence[Block]:
    """The paper's Figs. 2 and 3, and the same over the turn."""
    caption = "Nominal mechanism. Away from the bottom dead centre the driven chain takes over."
    turn = Drawing("Influence and salience over one turn", partial(over_the_turn, record), caption)
    found = record.studies.get("sensitivity")
    if not knows_every_error(found):
        return [turn]
    caption = "As Figs. 2 and 3 of the paper; lengths in metres, angles in radians. Blue: the key errors."
    return [Drawing("Salience of the errors", partial(salience_bars, found), caption), turn]


def variances(record: "PressRun") -> Sequence[Block]:
    """What each kind of error contributes to both variances."""
    found = record.studies.get("sensitivity")
    if not knows_every_error(found):
        return []
    rows: list[tuple[str | float, ...]] = []
    for kind in EVERY:
        parts = [
            found.sd[result] ** 2 * sum(found.share[result].get(name, 0.0) for name in sources_of((kind,))) / square
            for result, square in (("slider_position", MICROMETRE_2), ("slider_tilt", MICRORADIAN_2))
        ]
        place = "link" if kind in LINKS else "joint, across" if kind in POLAR_ANGLES else "joint, along"
        place = "drive" if kind == "crank_angle" else place
        still = found.still >= set(sources_of((kind,)))
        rows.append((kind.replace("_", " "), f"{place} (off)" if still else place, *parts))
    rows.sort(key=lambda row: -float(row[2]))
    rows.append(("all together", "", *(sum(float(row[column]) for row in rows) for column in (2, 3))))
    table = Table(
        "Where the scatter comes from",
        ("error, both sides together", "kind", "variance of position", "variance of tilt"),
        rows,
        ("", "", "µm²", "µrad²"),
        "Tightening links changes the rows 'link' only. Off: this kind has no tolerance in this run.",
    )
    return [table]


def tightening(record: "PressRun") -> Sequence[Block]:
    """The reliabilities along the synthesis, with the paper's where it is the paper's reading."""
    allotted = record.studies.get("allocation")
    if allotted is None or set(allotted.start) != {"slider_position", "slider_tilt"}:
        return []
    printed = {}
    if record.inputs.reading == "printed":
        names = {"slider_position": "position_reliability", "slider_tilt": "tilt_reliability"}
        printed = {check: (WHERE[name][1], WHERE[f"{name}_final"][1]) for check, name in names.items()}
    caption = "Dashed: the goals. Diamonds: what the paper prints." if printed else "Dashed: the goals."
    return [Drawing("Reliability along the synthesis", partial(along_the_synthesis, allotted, printed), caption)]


def other_reading(record: "PressRun") -> Sequence[Block]:
    """The other reading beside this one, so that nobody takes the printed reliabilities for the whole."""
    compared = record.studies.get("readings")
    if compared is None:
        return []
    words = Words(
        "The printed reliabilities leave out the installation errors across the radius of a joint, which the paper's "
        "Table 3 tolerates as well. The reading 'complete' has every error in force.",
        "finding",
    )
    return [words, compared.table()]


def bands_over_the_stroke(record: "PressRun") -> Sequence[Block]:
    """The bands of all sources for the dead centre and for the stroke."""
    found = record.studies.get("over_the_stroke")
    return [] if found is None else found.shown()


SECTIONS = [
    Section(
        "Mechanism and slider",
        "slider_position", "slider_tilt", "face_height_1", "face_height_2", "permitted_tilt",
        text="Two cranks AB lower the platform O1 through the rods BE. Its arm ends at B5; from there the knee drives "
        "push the knees MGH outward, and the slider O2 goes down. z counts downward from O; side 1 is that of "
        "positive y.",
        figure=mechanism,
        caption="To scale. Orange: crank and rod. Blue: knee drive and knee. Dotted: the ways of crank pin and knee.",
    ),
    Section(
        "Dead centres and stroke",
        "bdc_direction", "bdc_platform_height", "bdc_position", "tdc_crank_angle", "tdc_position", "stroke",
        "smallest_sine",
        text="At the bottom dead centre crank and rod are stretched, at the top one they are folded. Both are those of "
        "the nominal mechanism; deviations never move them.",
        blocks=travel,
    ),
    Section(
        "Position of the nominal mechanism",
        *CHAIN,
        text="One side, link by link; the other is its mirror image.",
    ),
    Section(
        "Influence of the errors",
        *INFLUENCES,
        text="Change of the slider face over one joint by each error of its side, from the loop increments. In the "
        "slider position each counts half (the platform arm, common to both sides, fully); in the tilt an error behind "
        "the platform counts by its share in 2 l, one of the driven chain not at all, because the platform is guided.",
    ),
    Section(
        "Salience",
        "salience_position_key", "salience_tilt_key",
        text="The paper ranks errors by their share in the sum of all sensitivities. This adds metres per metre to "
        "metres per radian and so depends on the units; the share of the variance below does not.",
        blocks=saliences,
    ),
    Section(
        "Reliability",
        "variance_links", "variance_joints_along", "variance_joints_across", "variance_other", "position_sd", "tilt_sd",
        "position_offset", "tilt_offset", "position_reliability", "tilt_reliability",
        text="First order, as in the paper; the study 'reliability' below draws machines on the exact kinematics. The "
        "limits are measured from the nominal mechanism: a deviation that the inputs state and an effect that is on "
        "move the press out of their middle.",
        blocks=variances,
    ),
    Section(
        "Accuracy synthesis",
        *(f"coefficient_{link}" for link in LINKS),
        "adjustments", "position_reliability_final", "tilt_reliability_final",
        text="The coefficient of a link is half of (influence of the most influential link / its own) plus half of "
        "(tolerance of that link / its own). Among the links at the coarsest grade, the one with the smallest "
        "coefficient is made one grade finer, until both goals are met or every link is at the finest grade.",
        blocks=tightening,
    ),
    Section("Both readings of the paper", blocks=other_reading),
    Section(
        "Tolerances over the working stroke",
        text="All 29 sources may be bought here, joints, slider and crank angle too, in the reading 'complete' and at "
        "the price of the paper, one over the band. The design for the dead centre keeps its limits there; that for "
        "the stroke keeps them at all its angles together.",
        blocks=bands_over_the_stroke,
    ),
]  # fmt: skip
