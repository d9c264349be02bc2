"""The sheet, in the order in which an engineer rates a stage."""

from itertools import chain

from rv_gearing import drawn
from rv_gearing.search import Listed
from truing import Section


def both(*names: str) -> tuple[str, ...]:
    """The results of sun and planet by name."""
    return tuple(chain.from_iterable((f"{name}_sun", f"{name}_planet") for name in names))


SECTIONS = [
    Section(
        "Ratio, efficiency and torque",
        *both("teeth"), "pins", "ratio", "pin_ratio", "mesh_efficiency", "efficiency", "sun_speed", "mesh_speed",
        "asked_torque", "sun_torque", "output_torque",
        text="A sun drives planets, each planet turns a crank, and the cranks drive cycloid discs in a ring of pins "
        "that stands still; the output is the carrier of the cranks. The mesh of sun and planet turns with it, so its "
        "speed is that of the sun relative to the carrier.",
    ),
    Section(
        "Search for tooth numbers",
        "group_count", "exact_count",
        text="Five conditions: the ratio within its tolerance; a sun that is not undercut; a planet large enough to "
        "spare the second stage; an even number of pins, one more than teeth of a disc; a centre distance between "
        "shares of the radius of the pin circle, which follows the cube root of the output torque (in N mm).",
        blocks=drawn.search,
    ),
    Section(
        "The list as results",
        *(name for name in Listed.__dataclass_fields__ if name not in ("group_count", "exact_count")),
        level="full",
    ),
    Section(
        "Geometry of the pair",
        "tooth_ratio", "transverse_angle", "base_helix_angle", *both("reference_diameter", "base_diameter",
        "tip_diameter", "root_diameter"), "tight_angle", "tight_centre_distance", "centre_distance", "working_angle",
        "base_pitch", "curvature", *both("tip_angle"), "contact_ratio", "overlap_ratio", "total_contact_ratio",
        "tooth_height", *both("tip_thickness", "start_curvature", "form_diameter"), "backlash",
        blocks=drawn.geometry,
    ),
    Section(
        "Load of one mesh",
        "tangential_force", "pitch_line_velocity", "carrying_width", "line_load", "planet_factor",
        "planet_factor_bending",
        text="The torque of the sun, not that of the output, shared by the planets. A factor says by how much "
        "the worst of them carries more than its share.",
    ),
    Section(
        "Deviations of the teeth",
        *both("pitch_deviation", "profile_deviation", "helix_deviation", "pitch_running_in", "profile_running_in"),
        "pitch_error", "profile_error", "running_in", "pitch_left", "profile_left",
    ),
    Section(
        "Stiffness of the mesh",
        "tooth_compliance", "theoretical_stiffness", "rack_factor", "modulus_factor", "low_load_factor",
        "tooth_stiffness", "mesh_stiffness", "mesh_stiffness_face",
    ),
    Section(
        "Dynamic factor",
        "inertia_sun", "inertia_planet", "reduced_mass", "resonance_speed", "resonance_ratio", "resonance_limit",
        "pitch_influence", "profile_influence", "relief_influence", "profile_coefficient", "stiffness_coefficient",
        "resonance_coefficient", "fast_coefficient", "fast_constant", "dynamic_slow", "dynamic_resonant",
        "dynamic_fast", "dynamic_factor",
        text="Method B of ISO 6336-1. A first stage runs far below the resonance of its mesh; what resonates in a "
        "reducer is its structure, which is not in this factor.",
    ),
    Section(
        "Face load factors",
        "mean_line_load", "bending_weight", "making_weight", "deflection", "making_deviation", "least_misalignment",
        "initial_misalignment", "face_running_in", "settled_misalignment", "settled_ratio",
        "face_factor_alone", "misalignment", "misalignment_ratio", "face_factor",
        "face_exponent", "face_factor_bending",
        text="Method C of ISO 6336-1. In small gears under a small load the deviations count for more than the load, "
        "and the factor becomes large. Where it was measured or calculated otherwise, state it: 1.1 to 1.3 is usual "
        "for crowned suns that align themselves.",
    ),
    Section(
        "Transverse load factors",
        "transverse_line_load", "transverse_base", "transverse_factor", "transverse_factor_bending",
    ),
    Section(
        "Contact stress",
        "zone_factor", "elasticity_factor", "contact_ratio_factor", "helix_power", "helix_factor",
        "single_contact_counts", "single_contact_factor_sun", "single_contact_factor_planet",
        "nominal_contact_stress", *both("contact_stress"), "contact_stress",
        text="At the inner point of single contact of each gear, by the factors of single contact; the paper leaves "
        "these out and has the stress at the pitch point (single_contact = false).",
    ),
    Section(
        "Root stress, load at the tip",
        *both("virtual_teeth"), "virtual_contact_ratio", *both("root_offset", "root_angle", "root_chord",
        "root_fillet", "notch_parameter", "virtual_tip_diameter", "virtual_base_diameter", "virtual_tip_angle",
        "tip_load_angle", "tip_arm", "form_factor", "stress_correction"), "contact_ratio_factor_bending",
        "helix_factor_bending", "tip_load_factor", *both("nominal_root_stress", "root_stress"),
        text="The convention of the paper, with the form factor, stress correction and contact ratio factor that "
        "belong to it.",
        blocks=drawn.bending,
    ),
    Section(
        "Root stress, load at the outer single contact",
        *both("outer_diameter", "outer_angle", "outer_load_angle", "outer_arm", "form_factor_outer",
               "stress_correction_outer"),
        "deep_tooth_factor", *both("nominal_root_stress_outer", "root_stress_outer", "root_safety_outer"),
        "root_safety_outer",
        text="Method B of ISO 6336-3, with a form factor and stress correction of its own and without a contact ratio "
        "factor, for comparison.",
        blocks=drawn.method_b,
    ),
    Section(
        "Constants of the material",
        "contact_life_most", "contact_life_knee", "contact_life_slope", "contact_life_tail", "bending_life_most",
        "bending_life_slope", "slip_layer", "surface_smooth", "surface_constant", "surface_slope",
        "surface_exponent", "size_constant", "size_slope", "size_least",
        level="full",
    ),
    Section(
        "Permissible contact stress",
        "load_cycles_sun", "load_cycles_planet", *both("contact_life_factor"), "lubricant_constant",
        "lubricant_factor", "velocity_factor", "relative_roughness", "roughness_exponent", "roughness_factor",
        *both("permitted_contact_stress"),
    ),
    Section(
        "Permissible root stress",
        *both("bending_life_factor", "notch_sensitivity", "root_surface", "bending_size", "permitted_root_stress"),
        text="Planets of this stage mesh with the sun alone: their roots are not bent to both sides in every turn. "
        "But robots reverse; then the endurance limit is to be lowered by a mean stress factor, about 0.7.",
    ),
    Section(
        "Safeties",
        *both("contact_safety", "root_safety"), "contact_safety", "root_safety", "torque_capacity",
        "power_capacity",
        blocks=drawn.courses,
    ),
    Section(
        "Strength of all groups",
        text="Every group of the search under the same duty.",
        blocks=drawn.comparison,
    ),
    Section(
        "What effects act on",
        "transmission_error", "flank_temperature",
        text="Nothing by itself; what the calculation leaves out appears here once an effect is on.",
    ),
]  # fmt: skip
