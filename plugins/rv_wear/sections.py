"""The sheet, in the order an engineer reads it."""

from rv_wear import drawn
from truing import Section

SECTIONS = [
    Section(
        "Disc and pins",
        "short_width", "root", "radial_clearance", "equidistant_high", "equidistant_low",
        text="The disc rolls inside a ring of pins and carries with about half of those on one side. It is ground a "
        "little thinner than its theoretical profile, by another pin radius (equidistant) and on another circle "
        "(shift); their difference is the clearance that remains all around.",
        blocks=drawn.geometry,
    ),
    Section(
        "Forces of the new mesh",
        "disc_torque", "start_force", "max_force", "approach", "largest_force", "loaded_pins", "max_pressure",
        "phase_angle", "normal_force", "worn_force",
        text="A pin carries where the approach of disc and pin under load exceeds the clearance that grinding has "
        "left. The force at the longest arm follows from the balance of torques over all positions of the disc.",
        blocks=drawn.forces,
    ),
    Section(
        "Wear of the disc",
        "mesh_period", "coefficient", "max_wear", "wear_angle", "wear_place", "wear_depth", "history_time",
        "wear_history",
        text="Every meshing takes off the wear coefficient times force per width times sliding. Each time "
        "another reconstruction_depth is gone the profile is formed anew and the forces are found again. They move "
        "to where less is worn; therefore the wear slows down.",
        blocks=drawn.wear,
    ),
    Section(
        "Grinding the disc in other ways",
        "force_falls", "mesh_widens", "wear_falls",
        text="At the same radial clearance, over the whole range of the equidistant modification: the larger it is, "
        "the smaller are the gaps, the more pins carry, and the less the disc wears.",
        blocks=drawn.other_discs,
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
        blocks=drawn.influence,
    ),
    Section(
        "The sixteen indices",
        *(f"index_{number}" for number in range(1, 17)),
        level="full",
    ),
    Section(
        "Reliability of the backlash",
        "accuracy_reliability", "normal_reliability", "backlash_mean", "backlash_sd", "sampled_mean", "sampled_sd",
        "largest_backlash", "reliability_time", "reliability_history",
        text="Machines are drawn from the zones, and those within the permitted backlash are counted. Equation 21 is "
        "a sum, so the normal distribution stands beside the count as a check.",
        blocks=drawn.reliability,
    ),
    Section(
        "Cost of the tolerances",
        "tolerance_price", "manufacturing_cost",
        text="Six zones are priced by their width, in the form of the cost functions that the inputs state. The "
        "errors of both modifications share one width and one price.",
        blocks=drawn.costs,
    ),
    Section(
        "Surrogate of the wear",
        "band_share", "surrogate_coverage", "surrogate_error", "surrogate_worst",
        text="The paper learns the wear from some simulated cases, because each of them takes long there. What that "
        "is worth here, and whether it is faster than the calculation itself, stands in the study below.",
    ),
    Section(
        "Better tolerances",
        "least_cost", "least_wear_1", "corner_cost_1", "corner_wear_1", "least_wear_2", "corner_cost_2",
        "corner_wear_2",
        text="Which modification and which widths of the zones are worth their money? The cost of the zones and the "
        "deepest wear are to be small, while the required share of machines stays within the permitted backlash.",
        blocks=drawn.better_tolerances,
    ),
    Section(
        "Better tolerances by search",
        "knee_cost", "knee_wear", "knee_equidistant", "smallest_wear", "front_cost", "front_wear",
        "front_equidistant",
        text="As the paper does it: a genetic algorithm chooses modification and widths together, for the reliability "
        "that the inputs ask for. The study 'optimise' below tells start, knee and front.",
    ),
]  # fmt: skip
