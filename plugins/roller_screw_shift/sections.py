"""The sheet, in the order an engineer reads it."""

from roller_screw_shift import drawn
from truing import Section

SECTIONS = [
    Section(
        "Roller and ring",
        "working_angle", "shift_difference", "ring_shift", "mounted_distance", "mounted_angle", "base_radius_roller",
        "base_radius_ring", "tip_radius_roller", "tip_radius_ring", "root_radius_roller", "root_radius_ring",
        "tip_angle_roller", "tip_angle_ring", "contact_ratio", "half_angle_roller", "tip_land",
        "crossing_cosine_roller", "crossing_angle_roller", "crossing_cosine_ring", "crossing_angle_ring",
        "tip_clearance", "backlash",
        text="Each roller of the screw carries a gear at its ends that runs inside a ring in the nut and keeps the "
        "roller parallel to the screw. The threads fix the centre distance, so the difference of both shifts is fixed "
        "and one of them remains free.",
        blocks=drawn.signs,
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
        "tip_sliding_ring", "sliding_ring", "ring_meshes",
        text="At each end of the path of contact the root of one gear meets the tip of the other, and there the flanks "
        "slide most for the way they roll: usually at the roots, but at the tip where the path begins near the pitch "
        "point or beyond it. The largest of the path counts.",
        blocks=drawn.sliding,
    ),
    Section(
        "Limits of the shift",
        "margin_ring_base", "margin_roller_base", "margin_contact_ratio", "margin_interference",
        "margin_opposite_tips", "margin_roller_root", "margin_ring_root", "margin_involute", "margin_undercut",
        "margin_tip_land", "margin_sliding", "lowest_shift", "highest_shift",
        text="A margin above 0 is safe. The first six are the paper's; the others are needed beside them, because "
        "those alone leave a very wide range of shifts.",
        blocks=drawn.limits,
    ),
    Section(
        "The best shift",
        "shift_sum", "stress_difference", "sliding_difference", "optimal_shift_roller", "optimal_shift_ring",
        "optimal_contact_ratio", "limit_distance", "kept_as_stated", "kept_at_optimum",
        text="As in the paper: each objective is brought to 0 to 1 over its range, all are weighed and added, and "
        "Box's complex method with nine vertices looks for the least sum. A dense grid checks it.",
        blocks=drawn.choice,
    ),
    Section(
        "What the weights choose",
        text="The same problem without weights: the designs that no other beats in all three objectives. Weights "
        "choose one of them; the study 'optimise' below finds them by NSGA-II.",
        blocks=drawn.weights,
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
