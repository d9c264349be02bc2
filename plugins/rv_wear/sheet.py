"""The sheet, in the order an engineer reads it; a figure or table is there where its study ran."""

from collections.abc import Sequence
from functools import partial

from rv_wear import figures
from rv_wear.costs import Bill
from rv_wear.discs import Ground
from rv_wear.exact_play import ExactAnswers, Played
from rv_wear.machines import FACTORS, Chances, Newborn, SobolIndices
from rv_wear.optimum import Bought, FreeEnds, Front, FrontEnds, Fronts, Learnt
from rv_wear.paper_route import RouteAnswers
from rv_wear.spectrum import Lived, Spectrum
from truing import Block, Drawing, Odds, Optimum, Section, Sensitivities, Swept, Words

# The figures by section of the sheet: each is there where its study ran, and drawn when the sheet is written


def geometry(record: figures.ReducerRun) -> "Sequence[Block]":
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
        Drawing("Disc, pins and crank", partial(figures.mesh_figure, reducer), mesh),
        Drawing("Clearance along the flank", partial(figures.clearance_figure, reducer), gaps),
    ]


def forces(record: figures.ReducerRun) -> "Sequence[Block]":
    """Forces along the flank by both ways of sharing, and how far these are apart."""
    reducer = record.acting
    largest, one = figures.difference_of_sharing(reducer)
    words = (
        f"With Hertz at every pin the largest force of the new disc is {100 * abs(largest):.1f} % "
        f"{'larger' if largest > 0 else 'smaller'} than in proportion to the approach; a single pin differs by up to "
        f"{100 * one:.0f} % of the largest force. The input load_sharing chooses."
    )
    caption = (
        "Every pin on the loaded side passes through all phase angles. The dip of the Hertz curve is where the flank "
        "turns from hollow to convex and is nearly straight."
    )
    return [Drawing("Force on a pin", partial(figures.sharing_figure, reducer), caption), Words(words)]


def wear(record: figures.ReducerRun) -> "Sequence[Block]":
    """Wear along the flank, and over the working time."""
    reducer = record.acting
    blocks: list[Block] = []
    if float(reducer.working_time) > 0.0:
        caption = "By the law of wear alone. Where the disc wears, the neighbours take over load: the worn part widens."
        blocks.append(Drawing("Wear along the flank", partial(figures.wear_figure, reducer), caption))
    swept = record.outcome(Swept)
    if swept is not None and swept.over == "working_time" and {"max_wear", "backlash"} <= set(swept.results):
        caption = "Backlash of the reducer whose errors lie at the middle of their zones."
        blocks.append(Drawing("Wear and backlash over the years", partial(figures.history_figure, swept), caption))
    return blocks


def other_discs(record: figures.ReducerRun) -> "Sequence[Block]":
    """The paper's Figs. 1 and 2."""
    ground = record.outcome(Ground)
    if ground is None:
        return []
    caption = "As Figs. 1 and 2 of the paper: new discs of one radial clearance, and their wear early in life."
    draw = partial(figures.modifications_figure, ground, record.acting)
    return [Drawing("Forces and wear of discs ground in other ways", draw, caption)]


def influence(record: figures.ReducerRun) -> "Sequence[Block]":
    """The sixteen indices beside those of the paper's Table 2."""
    if record.outcome(Sensitivities) is None:
        return []
    found = {number: float(record.answers[f"index_{number}"]) for number in FACTORS}
    if not all(value == value for value in found.values()):
        return []
    caption = (
        "Diamonds: what the paper prints. Its indices gave the lost sizes of the gearing; see the comparison below."
    )
    return [Drawing("How much backlash each error gives", partial(figures.indices_figure, found), caption)]


def reliability(record: figures.ReducerRun) -> "Sequence[Block]":
    """The paper's Figs. 4 and 5."""
    blocks: list[Block] = []
    born = record.outcome(Newborn)
    if born is not None:
        caption = f"As Fig. 4 of the paper: {len(born.new)} machines, the first ones of the study 'reliability'."
        found = born.as_json()["new"]
        if "mean" in found:
            caption += f" New: mean {found['mean']:.3f}′, standard deviation {found['sd']:.3f}′, largest "
            caption += f"{found['largest']:.3f}′. The paper: about 0.7′, and all below 1′."
        blocks.append(Drawing("Backlash of new machines", partial(figures.machines_figure, born), caption))
    odds = record.outcome(Odds)
    if odds is not None and odds.curve is not None and odds.curve.over == "working_time":
        caption = "As Fig. 5 of the paper. It says that the reliability begins to fall after 4000 h."
        blocks.append(Drawing("Reliability over the working time", partial(figures.reliability_figure, odds), caption))
    return blocks


def exact_play(record: figures.ReducerRun) -> "Sequence[Block]":
    """The exact backlash over the turn beside equation 21, and how the discs share the load."""
    played = record.outcome(Played)
    if played is None:
        return []
    caption = (
        "Left: backlash over the angle of the crank; shaded: nine of ten machines. Above right: the same machine over "
        "a turn of the output. Below right: how the two discs share the torque in all machines and positions; "
        "dashed: torque_share."
    )
    return [Drawing("The exact backlash over the turn", partial(figures.play_figure, played), caption)]


def load_spectrum(record: figures.ReducerRun) -> "Sequence[Block]":
    """Wear of both flanks over the hours, and the share of machines within the permitted backlash."""
    spectrum = record.outcome(Spectrum)
    if spectrum is None:
        return []
    caption = "Every torque wears the flank on which it presses, on the profile that all loads of that sense have left."
    return [Drawing("Wear of both flanks and life", partial(figures.life_figure, spectrum), caption)]


def costs(record: figures.ReducerRun) -> "Sequence[Block]":
    """What each zone costs, and what another width would."""
    bill = record.outcome(Bill)
    if bill is None or not bill.widths:
        return []
    form = str(record.inputs.cost_form)
    caption = (
        f"By the cost functions in the form '{form}'. Right: one zone of each function, from half to twice as wide."
    )
    return [Drawing("Price of the zones", partial(figures.costs_figure, bill, form), caption)]


def better_tolerances(record: figures.ReducerRun) -> "Sequence[Block]":
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
    draw = partial(figures.fronts_figure, fronts, optimum, start)
    blocks: list[Block] = [Drawing("Cost and wear", draw, caption), Words(_beside_the_paper(fronts))]
    odds = record.outcome(Odds)
    if odds is not None and odds.curve is not None and odds.curve.over == "working_time" and figures.better(fronts):
        caption = (
            "As Fig. 7 of the paper: the reducer as stated, and to first order the knees of the fronts with their cost "
            "and equidistant modification."
        )
        draw = partial(figures.reliability_figure, odds, figures.better(fronts))
        blocks.append(Drawing("Reliability before and after", draw, caption))
    return blocks


def _beside_the_paper(fronts: Fronts) -> str:
    """Our least cost at the wear of the paper's optima."""
    said = []
    for front in fronts.fronts:
        ours = figures.at_printed_wear(front)
        if ours is not None:
            cost, wear = figures.PRINTED_OPTIMA[front.goal]
            said.append(
                f"At {wear:g} µm the paper pays {cost:.0f} yuan, here it is {ours:.0f} for {100 * front.goal:g} %."
            )
    said.append(
        "A more negative equidistant modification at the same radial clearance closes the backlash and wears a little "
        "faster; what it gains is spent on wider zones. Where a front ends depends on how wide the zones may become, "
        "and so does its knee; the paper's bounds are lost."
    )
    return " ".join(said)


SECTIONS = [
    Section(
        "Disc and pins",
        "short_width", "root", "radial_clearance", "equidistant_high", "equidistant_low",
        text="The disc rolls inside a ring of pins and carries with about half of those on one side. It is ground a "
        "little thinner than its theoretical profile, by another pin radius (equidistant) and on another circle "
        "(shift); their difference is the clearance that remains all around.",
        blocks=geometry,
    ),
    Section(
        "Forces of the new mesh",
        "disc_torque", "start_force", "max_force", "approach", "largest_force", "loaded_pins", "max_pressure",
        "phase_angle", "normal_force", "worn_force",
        text="A pin carries where the approach of disc and pin under load exceeds the clearance that grinding has "
        "left. The force at the longest arm follows from the balance of torques over all positions of the disc.",
        blocks=forces,
    ),
    Section(
        "Wear of the disc",
        "mesh_period", "coefficient", "max_wear", "wear_angle", "wear_place", "wear_depth", "history_time",
        "wear_history",
        text="Every meshing takes off the wear coefficient times force per width times sliding. Each time "
        "another reconstruction_depth is gone the profile is formed anew and the forces are found again. They move "
        "to where less is worn; therefore the wear slows down.",
        blocks=wear,
    ),
    Section(
        "Grinding the disc in other ways",
        "force_falls", "mesh_widens", "wear_falls",
        text="At the same radial clearance, over the whole range of the equidistant modification: the larger it is, "
        "the smaller are the gaps, the more pins carry, and the less the disc wears.",
        blocks=other_discs,
    ),
    Section(
        "Backlash",
        "backlash_wear", "backlash_involute", "gap_ground", "gap_pins", "gap_disc", "backlash_gearing",
        "backlash_of_wear", "backlash_bearing", "backlash", "backlash_history",
        text="Clearance at the contacts, turned into an angle at the output: sixteen errors of the parts, each at the "
        "middle of its zone, and the wear.",
    ),
    Section(
        "Influence of the errors",
        text="How much backlash each error gives per micrometre, against that of the pin circle radius. Both "
        "modifications are taken at the same wear; that they also change the wear is not in these indices.",
        blocks=influence,
    ),
    Section(
        "The sixteen indices",
        *SobolIndices.__dataclass_fields__,
        level="full",
    ),
    Section(
        "Reliability of the backlash",
        *Chances.__dataclass_fields__,
        text="Machines are drawn from the zones, and those within the permitted backlash are counted. Equation 21 is "
        "a sum, so the normal distribution stands beside the count as a check.",
        blocks=reliability,
    ),
    Section(
        "Life under a load spectrum",
        *Lived.__dataclass_fields__,
        text="Loads with their sense: each wears one flank only, and the backlash feels both. The machines are those "
        "of the reliability; each reaches the permitted backlash after hours of its own.",
        blocks=load_spectrum,
    ),
    Section(
        "Exact play of both discs",
        *ExactAnswers.__dataclass_fields__,
        text="Equation 21 adds one worst error of each kind at the longest arm. Here every pin and every tooth of both "
        "discs has its own error, and the output turns until the first of them touches. Errors of many pins then "
        "average, runout of the discs takes play instead of giving it, and how the discs share the load comes out.",
        blocks=exact_play,
    ),
    Section(
        "Cost of the tolerances",
        "tolerance_price", "manufacturing_cost",
        text="Six zones are priced by their width, in the form of the cost functions that the inputs state. The "
        "errors of both modifications share one width and one price.",
        blocks=costs,
    ),
    Section(
        "Surrogate of the wear",
        *Learnt.__dataclass_fields__,
        text="The paper learns the wear from some simulated cases, because each of them takes long there. What that "
        "is worth here, and whether it is faster than the calculation itself, stands in the study below.",
    ),
    Section(
        "Better tolerances",
        *Bought.__dataclass_fields__, *FrontEnds.__dataclass_fields__, *FreeEnds.__dataclass_fields__,
        text="Which modification and which widths of the zones are worth their money? The cost of the zones and the "
        "deepest wear are to be small, while the required share of machines stays within the permitted backlash.",
        blocks=better_tolerances,
    ),
    Section(
        "The paper's own route",
        *RouteAnswers.__dataclass_fields__,
        text="The paper counts machines and searches on the Gaussian process alone. Done so here, with the same "
        "machines and designs by full physics beside it.",
    ),
    Section(
        "Better tolerances by search",
        *Front.__dataclass_fields__,
        text="As the paper does it: a genetic algorithm chooses modification and widths together, for the reliability "
        "that the inputs ask for. The study 'optimise' below tells start, knee and front.",
    ),
]  # fmt: skip
