"""The sheet, in the order an engineer reads it; a figure or table is there where its study ran."""

from collections.abc import Sequence
from functools import partial

from roller_screw_shift import figures, optimum
from roller_screw_shift.calculation import MARGINS
from roller_screw_shift.quantities import Meshing
from truing import Block, Drawing, Optimum, Section, Words

# The figures and tables by section of the sheet: each is there where its study ran

DECLARED = tuple(Meshing.__dataclass_fields__)

CONVENTION = (
    "Signs: E is the roller (an external gear), I the ring (an internal one, its number of teeth counted positive). A "
    "shift above 0 moves the profile of either gear away from its own axis: tip and root circles of both grow with "
    "their shifts. Of an internal pair the centre distance fixes the difference of the shifts, ring less roller. ISO "
    "21771 counts the teeth of a ring negative, and its shift with the other sign: there the same pair has the sum of "
    "the shifts over the sum of the teeth. Whoever adds up shifts by that rule must turn the sign of the ring's."
)
PATH = (
    "To scale, both without backlash. Green: the part of the line of action on which teeth touch, from the tip of the "
    "ring to the tip of the roller; circle: the pitch point. The fillet of the roller is what its rack leaves, that of "
    "the ring a round one of the radius stated."
)
SLIDING = (
    "Specific sliding: 1 less the speed of the other gear along its flank over one's own. The curves belong to the "
    "centre distance; the shift moves the ends of the path along them. Marks: root of the roller (left) and of "
    "the ring (right), each where the tip of the other gear meets it; the objective compares their magnitudes."
)
RATIOS = (
    "Above: the optimal shift over the least contact ratio, by every reading of the weights; dashed: the best one that "
    "as many screws keep as asked. Below: the largest sliding on the path at these shifts. Where the lines meet, "
    "the limit decides; where they part, the weights do."
)
SHARES = (
    "Load of each thread of a roller over the mean, from the end at which the screw is loaded. Dashed: with the nut "
    "held at the other end."
)
PLANES = (
    "With one variable the front of the three objectives is a line. Where the stresses differ least (left) the sum is "
    "small and sliding is uneven; weights choose a place on the line."
)
CORNERS = (
    "Every point is one set of weights, by their shares; the colour is the shift that they choose. Marks: the paper's "
    "rule with the ranges found here, its rule with the ranges it prints, and the weights it prints."
)


def signs(record: figures.PairRun) -> "Sequence[Block]":
    """The sign convention in words, and the pair to scale."""
    pair = record.acting
    chosen = record.outcome(optimum.ChosenShift)
    draw = partial(figures.teeth_figure, pair, places(record, chosen))
    return [Words(CONVENTION), Drawing("Roller and ring", draw, PATH)]


def places(record: figures.PairRun, chosen: optimum.ChosenShift | None) -> list[tuple[str, float]]:
    """The shifts that are drawn: before and after the optimisation, or what is stated where there was none."""
    if chosen is None or chosen.field is None:
        return [("as stated", float(record.acting.roller_shift))]
    first = optimum.before(chosen.field)
    words = "before, no shift of the roller" if first == 0.0 else "before, nearest to no shift"
    return [(words, first), ("optimum", chosen.shift)]


def sliding(record: figures.PairRun) -> "Sequence[Block]":
    """Specific sliding along the path of contact."""
    pair, chosen = record.acting, record.outcome(optimum.ChosenShift)
    shown = places(record, chosen)
    if chosen is not None and chosen.field is not None:
        shown = [("before", shown[0][1]), ("as stated", float(pair.roller_shift)), ("optimum", chosen.shift)]
    return [Drawing("Sliding along the path of contact", partial(figures.sliding_figure, pair, shown), SLIDING)]


def threads(record: figures.PairRun) -> "Sequence[Block]":
    """How the threads share the load."""
    return [Drawing("Load of the threads", partial(figures.threads_figure, record.acting), SHARES)]


def limits(record: figures.PairRun) -> "Sequence[Block]":
    """Which shifts keep every limit."""
    chosen = record.outcome(optimum.ChosenShift)
    if chosen is None:
        return []
    caption = (
        "Above: where each limit is kept. Below: the margins that change sign in the picture. Shaded: all limits are "
        "kept."
    )
    figure = Drawing("Limits over the shift", partial(figures.limits_figure, chosen), caption)
    if chosen.field is None:
        return [Words(f"{chosen.status[:1].upper()}{chosen.status[1:]}.", "finding"), figure]
    return [optimum.intervals_words(chosen.field), figure]


def choice(record: figures.PairRun) -> "Sequence[Block]":
    """Ranges, weights, objectives, optimum."""
    chosen = record.outcome(optimum.ChosenShift)
    if chosen is None or chosen.field is None:
        return []
    caption = "The first objective is to be large, the others are to be small."
    return [
        optimum.weights_table(chosen, chosen.field),
        optimum.printed_table(),
        Drawing("Objectives over the shift", partial(figures.objectives_figure, chosen), caption),
        *optimum.optimum_words(chosen, chosen.field),
        optimum.compared_table(chosen, chosen.field),
        Drawing("The optimum by the contact ratio asked for", partial(figures.ratios_figure, chosen), RATIOS),
    ]


def weights(record: figures.PairRun) -> "Sequence[Block]":
    """What the weights choose."""
    chosen = record.outcome(optimum.ChosenShift)
    if chosen is None or chosen.field is None:
        return []
    field = chosen.field
    blocks: list[Block] = [
        Drawing(
            "The front, and what the weights choose",
            partial(figures.front_figure, chosen, field, record.outcome(Optimum)),
            PLANES,
        )
    ]
    if any(high > low for low, high in field.ranges):
        blocks.append(Drawing("The shift by weights", partial(figures.triangle_figure, chosen, field), CORNERS))
    return [*blocks, optimum.variants_table(chosen, field)]


SECTIONS = [
    Section(
        "Roller and ring",
        *DECLARED[: DECLARED.index("root_sliding_roller")], "backlash",
        text="Each roller of the screw carries a gear at its ends that runs inside a ring in the nut and keeps the "
        "roller parallel to the screw. The threads fix the centre distance, so the difference of both shifts is fixed "
        "and one of them remains free.",
        blocks=signs,
    ),
    Section(
        "Strength of the roots",
        "tangential_force", "fillet_offset_roller", "fillet_height_roller", "tangent_constant_roller",
        "tangent_angle_roller", "root_chord_roller", "root_fillet_roller", "load_angle_roller", "bending_arm_roller",
        "form_factor_roller", "notch_roller", "stress_correction_roller", "root_chord_ring", "bending_arm_ring",
        "load_angle_ring", "form_factor_ring", "root_fillet_ring", "notch_ring", "stress_correction_ring",
        "nominal_stress_roller", "nominal_stress_ring", "root_stress_roller", "root_stress_ring",
        text="The load acts at the tip of the tooth. The section of the roller is where a tangent of 30° touches its "
        "fillet. That of the ring is taken from a substitute rack, so that neither its teeth nor its shift matter, "
        "unless the teeth of a shaper cutter are stated: then it is the section that this cutter leaves.",
    ),
    Section(
        "The ring as cut",
        "cut_chord_ring", "cut_fillet_ring", "cut_arm_ring", "cut_angle_ring",
        level="full",
    ),
    Section(
        "Sliding of the flanks",
        "root_sliding_roller", "tip_sliding_roller", "tips_count", "sliding_roller", "root_sliding_ring",
        "tip_sliding_ring", "sliding_ring", "largest_sliding", "ring_meshes",
        text="At each end of the path of contact the root of one gear meets the tip of the other, and there the flanks "
        "slide most for the way they roll: usually at the roots, but at the tip where the path begins near the pitch "
        "point or beyond it. The largest of the path counts.",
        blocks=sliding,
    ),
    Section(
        "Threads under the load",
        *DECLARED[DECLARED.index("pitch") : DECLARED.index("nut_pitch_diameter")],
        text="Screw, rollers and nut are bars, every thread a Hertzian contact with the screw and one with the nut. "
        "The deflection is that of the engaged threads and bodies alone. There is no standard of roller screws: life "
        "is told by the rating of thrust ball bearings in ISO 281, with every thread of a roller as a ball about its "
        "axis and a row of balls of its own; what unequal sharing costs is told by the weakest link. Ball screws are "
        "rated higher for their turns, so the true rating may lie between both that are printed. The pressure that is "
        "permitted is the least that ISO 76 has for rolling bearings; by its 4200 MPa for balls a screw bears 16 % "
        "more, by its 4600 MPa for balls in spheres, which conform as little as threads do, 52 % more.",
        blocks=threads,
    ),
    Section(
        "Threads against teeth",
        *DECLARED[DECLARED.index("nut_pitch_diameter") : DECLARED.index("transmission_error")],
        text="The teeth hold a roller to their ratio. Where the pitch diameters of the threads have another, the "
        "roller slips around in the nut; where the starts have another, it creeps along.",
    ),
    Section(
        "Limits of the shift",
        *MARGINS, "lowest_shift", "highest_shift",
        text="A margin above 0 is safe. The first six are the paper's; the others are needed beside them, because "
        "those alone leave a very wide range of shifts.",
        blocks=limits,
    ),
    Section(
        "The best shift",
        "shift_sum", "stress_difference", "sliding_difference", "optimal_shift_roller", "optimal_shift_ring",
        "optimal_contact_ratio", "limit_distance", "kept_as_stated", "kept_at_optimum", "robust_shift_roller",
        "robust_shift_ring", "robust_contact_ratio", "kept_at_robust", "gentlest_shift", "gentlest_sliding",
        text="As in the paper: each objective is brought to 0 to 1 over its range, all are weighed and added, and "
        "Box's complex method with nine vertices looks for the least sum. A dense grid checks it.",
        blocks=choice,
    ),
    Section(
        "What the weights choose",
        text="The same problem without weights: the designs that no other beats in all three objectives. Weights "
        "choose one of them; the study 'optimise' below finds them by NSGA-II.",
        blocks=weights,
    ),
    Section(
        "The choice in numbers",
        "least_sum", "most_sum", "least_stress_difference", "most_stress_difference", "least_sliding", "most_sliding",
        "weight_sum", "weight_stress", "weight_sliding", "optimal_sum", "optimal_stress_difference",
        "optimal_sliding_difference", "optimal_margin", "grid_shift", "grid_distance", "evaluations",
        "equal_sliding_roller", "equal_sliding_ring",
        level="full",
    ),
    Section(
        "What effects act on",
        "transmission_error", "wear_depth", "axial_shift", "friction_torque",
        text="Measured of such a screw, and 0 as calculated: only effects that are on give them a value.",
        level="full",
    ),
]  # fmt: skip
