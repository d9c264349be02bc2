"""The figures by section of the sheet: each is there where its study ran, and drawn when the sheet is written."""

from collections.abc import Sequence
from functools import partial

from rv_wear.bill import Bill
from rv_wear.chances import FACTORS
from rv_wear.drawn_chances import costs_figure, indices_figure, machines_figure, reliability_figure
from rv_wear.drawn_flank import (
    clearance_figure,
    difference_of_sharing,
    history_figure,
    modifications_figure,
    sharing_figure,
    wear_figure,
)
from rv_wear.drawn_fronts import PRINTED_OPTIMA, at_printed_wear, better, fronts_figure
from rv_wear.drawn_look import Run
from rv_wear.drawn_mesh import mesh_figure
from rv_wear.least_costs import Fronts
from rv_wear.modifications import Ground
from rv_wear.new_machines import Newborn
from truing import Block, Drawing, Odds, Optimum, Sensitivities, Swept, Words


def geometry(record: "Run") -> "Sequence[Block]":
    """The mesh to scale, and the clearance along the flank."""
    reducer = record.acting
    mesh = (
        "To scale, the crank to the right. Filled pins carry; each arrow is the force of a pin on the new disc, along "
        "its line of action through the pitch point. ψ: phase angle of a pin. l: arm of its force about the centre of "
        "the disc, longest where the line stands across the crank. Dotted: the circle of the longest arm."
    )
    gaps = (
        "Normal clearance of the disc, turned until the first pin touches. A pin carries where the approach under load "
        "exceeds the clearance (shaded); wear opens it most where force and sliding are large together."
    )
    return [
        Drawing("Disc, pins and crank", partial(mesh_figure, reducer), mesh),
        Drawing("Clearance along the flank", partial(clearance_figure, reducer), gaps),
    ]


def forces(record: "Run") -> "Sequence[Block]":
    """Forces along the flank by both ways of sharing, and how far these are apart."""
    reducer = record.acting
    largest, one = difference_of_sharing(reducer)
    words = (
        f"With Hertz at every pin the largest force of the new disc is {100 * abs(largest):.1f} % "
        f"{'larger' if largest > 0 else 'smaller'} than in proportion to the approach; a single pin differs by up to "
        f"{100 * one:.0f} % of the largest force. The input load_sharing chooses."
    )
    caption = (
        "Every pin on the loaded side passes through all phase angles. The dip of the Hertz curve is where the flank "
        "turns from hollow to convex and is nearly straight."
    )
    return [Drawing("Force on a pin", partial(sharing_figure, reducer), caption), Words(words)]


def wear(record: "Run") -> "Sequence[Block]":
    """Wear along the flank, and over the working time."""
    reducer = record.acting
    blocks: list[Block] = []
    if float(reducer.working_time) > 0.0:
        caption = "By the law of wear alone. Where the disc wears, the neighbours take over load: the worn part widens."
        blocks.append(Drawing("Wear along the flank", partial(wear_figure, reducer), caption))
    swept = record.outcome(Swept)
    if swept is not None and swept.over == "working_time" and {"max_wear", "backlash"} <= set(swept.results):
        caption = "Backlash of the reducer whose errors lie at the middle of their zones."
        blocks.append(Drawing("Wear and backlash over the years", partial(history_figure, swept), caption))
    return blocks


def other_discs(record: "Run") -> "Sequence[Block]":
    """The paper's Figs. 1 and 2."""
    ground = record.outcome(Ground)
    if ground is None:
        return []
    caption = "As Figs. 1 and 2 of the paper: new discs of one radial clearance, and their wear early in life."
    draw = partial(modifications_figure, ground, record.acting)
    return [Drawing("Forces and wear of discs ground in other ways", draw, caption)]


def influence(record: "Run") -> "Sequence[Block]":
    """The sixteen indices beside those of the paper's Table 2."""
    if record.outcome(Sensitivities) is None:
        return []
    found = {number: float(record.answers[f"index_{number}"]) for number in FACTORS}
    if not all(value == value for value in found.values()):
        return []
    caption = (
        "Diamonds: what the paper prints. Its indices gave the lost sizes of the gearing; see the comparison below."
    )
    return [Drawing("How much backlash each error gives", partial(indices_figure, found), caption)]


def reliability(record: "Run") -> "Sequence[Block]":
    """The paper's Figs. 4 and 5."""
    blocks: list[Block] = []
    born = record.outcome(Newborn)
    if born is not None:
        caption = f"As Fig. 4 of the paper: {len(born.new)} machines, the first ones of the study 'reliability'."
        found = born.as_json()["new"]
        if "mean" in found:
            caption += f" New: mean {found['mean']:.3f}′, standard deviation {found['sd']:.3f}′, largest "
            caption += f"{found['largest']:.3f}′. The paper: about 0.7′, and all below 1′."
        blocks.append(Drawing("Backlash of new machines", partial(machines_figure, born), caption))
    odds = record.outcome(Odds)
    if odds is not None and odds.curve is not None and odds.curve.over == "working_time":
        caption = "As Fig. 5 of the paper. It says that the reliability begins to fall after 4000 h."
        blocks.append(Drawing("Reliability over the working time", partial(reliability_figure, odds), caption))
    return blocks


def costs(record: "Run") -> "Sequence[Block]":
    """What each zone costs, and what another width would."""
    bill = record.outcome(Bill)
    if bill is None or not bill.widths:
        return []
    form = str(record.inputs.cost_form)
    caption = (
        f"By the cost functions in the form '{form}'. Right: one zone of each function, from half to twice as wide."
    )
    return [Drawing("Price of the zones", partial(costs_figure, bill, form), caption)]


def better_tolerances(record: "Run") -> "Sequence[Block]":
    """The paper's Figs. 6 and 7."""
    fronts = record.outcome(Fronts)
    if fronts is None or not any(front.designs for front in fronts.fronts):
        return []
    start = (float(record.answers["tolerance_price"]), float(record.answers["max_wear"]))
    optimum = record.outcome(Optimum)
    caption = (
        "As Fig. 6 of the paper. For every equidistant modification (written beside the points) the widths of least "
        "cost, from those in force to twice as wide, that reach the required reliability; large marks: the knees."
    )
    if optimum is not None and optimum.front:
        caption += " Points: the front that the search of the study 'optimise' came to, a check of it."
    draw = partial(fronts_figure, fronts, optimum, start)
    blocks: list[Block] = [Drawing("Cost and wear", draw, caption), Words(_beside_the_paper(fronts))]
    odds = record.outcome(Odds)
    if odds is not None and odds.curve is not None and odds.curve.over == "working_time" and better(fronts):
        caption = (
            "As Fig. 7 of the paper: the reducer as stated, and to first order the knees of the fronts with their cost "
            "and equidistant modification."
        )
        draw = partial(reliability_figure, odds, better(fronts))
        blocks.append(Drawing("Reliability before and after", draw, caption))
    return blocks


def _beside_the_paper(fronts: Fronts) -> str:
    """Our least cost at the wear of the paper's optima."""
    said = []
    for front in fronts.fronts:
        ours = at_printed_wear(front)
        if ours is not None:
            cost, wear = PRINTED_OPTIMA[front.goal]
            said.append(
                f"At {wear:g} µm the paper pays {cost:.0f} yuan, here it is {ours:.0f} for {100 * front.goal:g} %."
            )
    said.append(
        "A more negative equidistant modification at the same radial clearance closes the backlash and wears a little "
        "faster; what it gains is spent on wider zones. Where a front ends depends on how wide the zones may become, "
        "and so does its knee; the paper's bounds are lost."
    )
    return " ".join(said)
