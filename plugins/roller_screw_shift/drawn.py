"""The figures and tables by section of the sheet: each is there where its study ran."""

from collections.abc import Sequence
from functools import partial

from roller_screw_shift.drawn_course import limits_figure, objectives_figure
from roller_screw_shift.drawn_look import Run
from roller_screw_shift.drawn_teeth import sliding_figure, teeth_figure
from roller_screw_shift.drawn_weights import front_figure, triangle_figure
from roller_screw_shift.shifts import (
    Chosen,
    before,
    compared_table,
    intervals_words,
    optimum_words,
    printed_table,
    variants_table,
    weights_table,
)
from truing import Block, Drawing, Optimum, Words

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
PLANES = (
    "With one variable the front of the three objectives is a line. Where the stresses differ least (left) the sum is "
    "small and sliding is uneven; weights choose a place on the line."
)
CORNERS = (
    "Every point is one set of weights, by their shares; the colour is the shift that they choose. Marks: the paper's "
    "rule with the ranges found here, its rule with the ranges it prints, and the weights it prints."
)


def signs(record: "Run") -> "Sequence[Block]":
    """The sign convention in words, and the pair to scale."""
    pair = record.acting
    chosen = record.outcome(Chosen)
    draw = partial(teeth_figure, pair, places(record, chosen))
    return [Words(CONVENTION), Drawing("Roller and ring", draw, PATH)]


def places(record: "Run", chosen: "Chosen | None") -> list[tuple[str, float]]:
    """The shifts that are drawn: before and after the optimisation, or what is stated where there was none."""
    if chosen is None or chosen.field is None:
        return [("as stated", float(record.acting.roller_shift))]
    first = before(chosen.field)
    words = "before, no shift of the roller" if first == 0.0 else "before, nearest to no shift"
    return [(words, first), ("optimum", chosen.shift)]


def sliding(record: "Run") -> "Sequence[Block]":
    """Specific sliding along the path of contact."""
    pair, chosen = record.acting, record.outcome(Chosen)
    shown = places(record, chosen)
    if chosen is not None and chosen.field is not None:
        shown = [("before", shown[0][1]), ("as stated", float(pair.roller_shift)), ("optimum", chosen.shift)]
    return [Drawing("Sliding along the path of contact", partial(sliding_figure, pair, shown), SLIDING)]


def limits(record: "Run") -> "Sequence[Block]":
    """Which shifts keep every limit."""
    chosen = record.outcome(Chosen)
    if chosen is None:
        return []
    caption = (
        "Above: where each limit is kept. Below: the margins that change sign in the picture. Shaded: all limits are "
        "kept."
    )
    figure = Drawing("Limits over the shift", partial(limits_figure, chosen), caption)
    if chosen.field is None:
        return [Words(f"{chosen.status[:1].upper()}{chosen.status[1:]}.", "finding"), figure]
    return [intervals_words(chosen.field), figure]


def choice(record: "Run") -> "Sequence[Block]":
    """Ranges, weights, objectives, optimum."""
    chosen = record.outcome(Chosen)
    if chosen is None or chosen.field is None:
        return []
    caption = "The first objective is to be large, the others are to be small."
    return [
        weights_table(chosen, chosen.field),
        printed_table(),
        Drawing("Objectives over the shift", partial(objectives_figure, chosen), caption),
        *optimum_words(chosen, chosen.field),
        compared_table(chosen, chosen.field),
    ]


def weights(record: "Run") -> "Sequence[Block]":
    """What the weights choose."""
    chosen = record.outcome(Chosen)
    if chosen is None or chosen.field is None:
        return []
    field = chosen.field
    blocks: list[Block] = [
        Drawing(
            "The front, and what the weights choose",
            partial(front_figure, chosen, field, record.outcome(Optimum)),
            PLANES,
        )
    ]
    if any(high > low for low, high in field.ranges):
        blocks.append(Drawing("The shift by weights", partial(triangle_figure, chosen, field), CORNERS))
    return [*blocks, variants_table(chosen, field)]
