"""What the roller screw calculation is told and what it answers: every quantity with unit, symbol, bounds and source.

Index E is the roller (an external gear), index I the ring (an internal one). A margin above 0 is safe.
"""

from typing import Any, Literal

from truing import Float, found, given, inputs, results

# The roller (external end gear) and the ring (internal gear) are named; no index is used, because those of the paper
# contradict one another. A shift of the ring is positive outward.

PAPER = "the paper"
SET = "Table 1 of the paper is lost; one self-consistent set"
STUB = "Table 1 of the paper is lost; the tip of the roller must not exceed the crest of its thread"
CALIBRATED_SHIFTS = "Table 1 of the paper is lost; chosen so that both printed shifts mesh without backlash"
CALIBRATED_LOAD = "chosen so that the largest difference of the root stresses is the printed 33.2 MPa"
LOST_LIMIT = "the limit in equation 8 is lost; 1.2 is the common alternative"
LARGEST = 10000.0  # mm: a size above it was meant in another unit


def size(value: float, symbol: str, note: str, source: str = SET) -> Any:
    """Declare a length, above zero."""
    return given(value, "mm", symbol=symbol, note=note, source=source, above=0, below=LARGEST)


@inputs
class Pair:
    """Roller and ring, the load of their mesh, and what is asked of the pair."""

    # The screw
    screw_diameter: Float = size(30.0, "d_s", "pitch diameter of the thread of the screw")
    roller_diameter: Float = size(10.0, "d_r", "pitch diameter of the thread of a roller")
    lead: Float = size(10.0, "l", "lead of the screw; acts with effects only")
    rollers: int = given(10, symbol="n_r", note="rollers that share the load", source=SET, at_least=1, at_most=100)
    # The pair
    pressure_angle: Float = given(20.0, "deg", "alpha", "of the rack", PAPER, above=10, below=30)
    roller_teeth: Float = given(20.0, "", "z_E", "teeth of the roller", SET, at_least=8, at_most=1000, whole=True)
    ring_teeth: Float = given(100.0, "", "z_I", "teeth of the ring", SET, at_least=16, at_most=5000, whole=True)
    module: Float = size(0.5, "m", "module")
    addendum: Float = given(0.8, "", "h_a*", "addendum, in modules", STUB, above=0, at_most=2)
    clearance: Float = given(0.3, "", "c*", "tip clearance, in modules", STUB, at_least=0, at_most=1)
    roller_fillet: Float = given(0.30, "", "rho_E*", "fillet radius of the rack of the roller, in modules", SET,
                                 at_least=0, at_most=1)  # fmt: skip
    ring_fillet: Float = given(0.15, "", "rho_I*", "fillet radius of the substitute rack of the ring", "GB/T 3480-1997",
                               at_least=0, at_most=1)  # fmt: skip
    cutter_teeth: Float = given(None, "", "z_0",
                                "teeth of the shaper cutter that makes the ring; without them the ring is a substitute "
                                "rack", at_least=8, at_most=1000, whole=True)  # fmt: skip
    cutter_shift: Float = given(0.0, "", "x_0", "profile shift of the cutter: worn ones have less", at_least=-1,
                                at_most=1)  # fmt: skip
    cutter_addendum: Float = given(None, "", "h_a0*",
                                   "addendum of the cutter, in modules; else that of the ring and its clearance",
                                   above=0, at_most=3)  # fmt: skip
    cutter_fillet: Float = given(0.15, "", "rho_a0*", "radius at the tip of the cutter, in modules",
                                 "as that of the substitute rack", above=0, at_most=1)  # fmt: skip
    centre_distance: Float = size(19.80778, "a_w", "working centre distance, fixed by the threads", CALIBRATED_SHIFTS)
    face_width: Float = size(4.0, "b", "face width")
    roller_shift: Float = given(
        0.21, "", "x_E", "profile shift of the roller, in modules: the design variable; that of the ring follows",
        "the printed optimum, with 1 read as the roller", at_least=-2, at_most=3,
    )  # fmt: skip
    # The load
    axial_load: Float = given(10.0, "kN", "F_a", "on the screw; a negative one loads the other flanks",
                              "a load of this size of screw")  # fmt: skip
    tangential_share: Float = given(5.1943e-3, "", "kappa_t", "tangential load of a mesh over the axial load",
                                    CALIBRATED_LOAD, at_least=0, at_most=1)  # fmt: skip
    mesh_stiffness: Float = given(14.0, "N/(mm*um)", "c_gamma", "mesh stiffness per face width; acts with effects only",
                                  "ISO 6336-1: about 14 for steel", above=0)  # fmt: skip
    # What is asked, and how it is weighed
    least_contact_ratio: Float = given(1.4, "", "epsilon_min", "least contact ratio", LOST_LIMIT, at_least=1, at_most=3)
    interference_margin: Float = given(0.05, "rad", "G_min", "least margin against interference of the tips",
                                       "equation 9", at_least=0, at_most=3)  # fmt: skip
    least_clearance: Float = given(0.1, "", "c_min*", "least clearance between tip and root, in modules",
                                   "equations 10 and 11", at_least=0, at_most=1)  # fmt: skip
    least_tip_land: Float = given(0.25, "", "s_a,min*", "least tip land of the roller, in modules", "common rule",
                                  at_least=0, at_most=1)  # fmt: skip
    most_sliding_difference: Float = given(3.08, "", "f_3,max", "largest difference of specific sliding",
                                           "printed upper limit, taken as bound of the search", above=0)  # fmt: skip
    sliding_reading: Literal["path", "roots"] = given("path",
                                                      note="third objective: of the largest sliding of each gear on "
                                                           "the path of contact, or of that at the roots, which folds "
                                                           "where the path begins near the pitch point")  # fmt: skip
    weights: Literal["own_ranges", "printed_ranges", "printed"] = given(
        "own_ranges",
        note="weights of the objectives: by the paper's rule from the ranges found here, by its rule from the ranges "
             "that it prints, or as it prints them",
    )  # fmt: skip
    # Neutral inputs: effects reach the calculation through them
    face_load_factor: Float = given(1.0, "", "K_Hbeta", "neutral 1: uneven load along the face", above=0)
    dynamic_factor: Float = given(1.0, "", "K_V", "neutral 1: load in motion over load at rest", above=0)
    sharing_factor: Float = given(1.0, "", "K_gamma", "neutral 1: load of this roller over the mean", above=0)
    carrying_share: Float = given(1.0, "", "f_b", "neutral 1: share of the face width that carries", above=0, at_most=1)
    rim_factor: Float = given(1.0, "", "Y_B", "neutral 1: raises the root stress of the ring", above=0)
    centre_distance_deviation: Float = given(0.0, "um", "Delta a",
                                             "neutral 0: centres farther apart than without backlash; above 0 the "
                                             "teeth of an internal pair jam, below 0 they have backlash",
                                             at_least=-1000, at_most=1000)  # fmt: skip


# What the roller screw calculation answers: geometry, strength, objectives, constraints and what effects act on

BASE = "0 in the calculation; effects act here"
INVOLUTE = "ISO 21771"
TOOTH = "ISO 6336-3: rack, tangent of 30°, load at the tip"
SUBSTITUTE = "GB/T 3480-1997: the tooth of a substitute rack, load at the tip"
ENVELOPE = "ISO 6336-3: envelope of the rounded tip of the cutter, tangent of 60°, load at the tip"
CUT = "0 without a cutter; else of the ring as cut: "
RULE = "common design rule"


@results
class Meshing:
    """The pair of roller and ring at one profile shift; objectives and margins, and the stress under the load."""

    # Geometry of the pair
    working_angle: Float = found("deg", "alpha_w", "working pressure angle without backlash",
                                 "acos(module * (ring_teeth - roller_teeth) * cos(pressure_angle)"
                                 " / (2 * centre_distance))", INVOLUTE)  # fmt: skip
    shift_difference: Float = found("", "D", "x_I - x_E, fixed by the centre distance because there is no backlash",
                                    "(ring_teeth - roller_teeth) * (inv(working_angle) - inv(pressure_angle))"
                                    " / (2 * tan(pressure_angle))", INVOLUTE)  # fmt: skip
    ring_shift: Float = found("", "x_I",
                              "profile shift of the ring; positive outward, larger tip and root circle (ISO 21771 "
                              "counts it the other way)", "roller_shift + shift_difference", INVOLUTE)  # fmt: skip
    mounted_distance: Float = found("mm", "a_m", "centre distance as mounted",
                                    "centre_distance + centre_distance_deviation")  # fmt: skip
    mounted_angle: Float = found("deg", "alpha_m", "working pressure angle as mounted",
                                 "acos(module * (ring_teeth - roller_teeth) * cos(pressure_angle)"
                                 " / (2 * mounted_distance))", INVOLUTE)  # fmt: skip
    base_radius_roller: Float = found("mm", "r_bE", "base circle of the roller",
                                      "module * roller_teeth * cos(pressure_angle) / 2")  # fmt: skip
    base_radius_ring: Float = found("mm", "r_bI", "base circle of the ring",
                                    "module * ring_teeth * cos(pressure_angle) / 2")  # fmt: skip
    tip_radius_roller: Float = found("mm", "r_aE", "tip circle of the roller, not truncated",
                                     "module * (roller_teeth / 2 + addendum + roller_shift)")  # fmt: skip
    tip_radius_ring: Float = found("mm", "r_aI", "tip circle of the ring, not truncated",
                                   "module * (ring_teeth / 2 - addendum + ring_shift)")  # fmt: skip
    root_radius_roller: Float = found("mm", "r_fE", "root circle of the roller",
                                      "module * (roller_teeth / 2 - addendum - clearance + roller_shift)")  # fmt: skip
    root_radius_ring: Float = found("mm", "r_fI", "root circle of the ring; a shaper leaves a slightly different one",
                                    "module * (ring_teeth / 2 + addendum + clearance + ring_shift)")  # fmt: skip
    tip_angle_roller: Float = found("deg", "alpha_aE", "pressure angle at the tip of the roller",
                                    "acos(base_radius_roller / tip_radius_roller)")  # fmt: skip
    tip_angle_ring: Float = found("deg", "alpha_aI", "pressure angle at the tip of the ring",
                                  "acos(base_radius_ring / tip_radius_ring)")  # fmt: skip
    contact_ratio: Float = found("", "epsilon", "contact ratio",
                                 "(roller_teeth * (tan(tip_angle_roller) - tan(mounted_angle)) - ring_teeth"
                                 " * (tan(tip_angle_ring) - tan(mounted_angle))) / (2 * pi)",
                                 "equation 8 of the paper, not legible; ISO 21771")  # fmt: skip
    half_angle_roller: Float = found("deg", "gamma", "half the angle of the tooth of the roller at its tip",
                                     "(pi / 2 + 2 * roller_shift * tan(pressure_angle)) / roller_teeth"
                                     " + inv(pressure_angle) - inv(tip_angle_roller)", INVOLUTE)  # fmt: skip
    tip_land: Float = found("mm", "s_a", "width of the tip of the roller's tooth",
                            "2 * tip_radius_roller * half_angle_roller", INVOLUTE)  # fmt: skip
    crossing_cosine_roller: Float = found("", "c_E", "cosine of the next angle; 1 where the tip circles do not cross",
                                          "min((tip_radius_ring**2 - tip_radius_roller**2 - mounted_distance**2)"
                                          " / (2 * mounted_distance * tip_radius_roller), 1)",
                                          "equation 9")  # fmt: skip
    crossing_angle_roller: Float = found("deg", "delta_E", "where the tip circles cross, seen from the roller",
                                         "acos(crossing_cosine_roller)", "equation 9")  # fmt: skip
    crossing_cosine_ring: Float = found("", "c_I", "cosine of the next angle; 1 where the tip circles do not cross",
                                        "min((tip_radius_ring**2 - tip_radius_roller**2 + mounted_distance**2)"
                                        " / (2 * mounted_distance * tip_radius_ring), 1)", "equation 9")  # fmt: skip
    crossing_angle_ring: Float = found("deg", "delta_I", "where the tip circles cross, seen from the ring",
                                       "acos(crossing_cosine_ring)", "equation 9")  # fmt: skip
    tip_clearance: Float = found(
        "rad", "G_s", "clearance of the tips where their circles cross, 2π to a tooth; 2π where they do not cross",
        "cases(roller_teeth * (crossing_angle_roller + inv(tip_angle_roller)) - ring_teeth"
        " * (crossing_angle_ring + inv(tip_angle_ring)) + (ring_teeth - roller_teeth) * inv(mounted_angle),"
        " mounted_distance + tip_radius_roller > tip_radius_ring, 2 * pi)",
        "equation 9, with its index 1 read as the roller",
    )  # fmt: skip
    root_sliding_roller: Float = found(
        "", "eta_E,f", "specific sliding at the root of the roller, where the tip of the ring meets it; magnitude",
        "abs((ring_teeth - roller_teeth) * (tan(mounted_angle) - tan(tip_angle_ring)) / margin_involute)",
        "1 - v_I/v_E of the speeds along the flanks",
    )  # fmt: skip
    tip_sliding_roller: Float = found("", "eta_E,a", "specific sliding at the tip of the roller; magnitude",
                                      "abs((ring_teeth - roller_teeth) * (tan(tip_angle_roller) - tan(mounted_angle))"
                                      " / (ring_teeth * tan(tip_angle_roller)))",
                                      "1 - v_I/v_E of the speeds along the flanks")  # fmt: skip
    tips_count: Float = found("", "i_a",
                              "1: sliding at the tips counts too, so the largest on the path of contact; 0: at the "
                              "roots alone", method="as sliding_reading has it")  # fmt: skip
    sliding_roller: Float = found(
        "", "eta_E", "specific sliding of the roller that counts, its largest on the path of contact",
        "max(root_sliding_roller, tips_count * tip_sliding_roller)", "sliding changes in one direction along the path",
    )  # fmt: skip
    root_sliding_ring: Float = found(
        "", "eta_I,f", "specific sliding at the root of the ring, where the tip of the roller meets it; magnitude",
        "abs((ring_teeth - roller_teeth) * (tan(tip_angle_roller) - tan(mounted_angle))"
        " / (ring_teeth * tan(mounted_angle) + roller_teeth * (tan(tip_angle_roller) - tan(mounted_angle))))",
        "1 - v_E/v_I of the speeds along the flanks",
    )  # fmt: skip
    tip_sliding_ring: Float = found("", "eta_I,a", "specific sliding at the tip of the ring; magnitude",
                                    "abs((ring_teeth - roller_teeth) * (tan(mounted_angle) - tan(tip_angle_ring))"
                                    " / (roller_teeth * tan(tip_angle_ring)))",
                                    "1 - v_E/v_I of the speeds along the flanks")  # fmt: skip
    sliding_ring: Float = found(
        "", "eta_I", "specific sliding of the ring that counts, its largest on the path of contact",
        "max(root_sliding_ring, tips_count * tip_sliding_ring)", "sliding changes in one direction along the path",
    )  # fmt: skip
    ring_meshes: Float = found("", "n_I/n_E",
                               "meshes of a tooth of the ring while one of a roller meshes once; decides how fast "
                               "either wears", "rollers * roller_teeth / ring_teeth", "counts of teeth")  # fmt: skip
    # Strength of the roots
    tangential_force: Float = found("N", "F_t", "load of one mesh", "tangential_share * abs(axial_load)")
    fillet_offset_roller: Float = found("", "E", "from the middle of the gap of the rack to the centre of its fillet",
                                        "pi / 4 - (addendum + clearance) * tan(pressure_angle)"
                                        " - (1 - sin(pressure_angle)) * roller_fillet / cos(pressure_angle)",
                                        TOOTH)  # fmt: skip
    fillet_height_roller: Float = found("", "G", "of the centre of the fillet over the pitch line",
                                        "roller_fillet - addendum - clearance + roller_shift", TOOTH)  # fmt: skip
    tangent_constant_roller: Float = found(
        "", "H", "constant of the next equation", "2 / roller_teeth * (pi / 2 - fillet_offset_roller) - pi / 3", TOOTH
    )
    tangent_angle_roller: Float = found("deg", "theta", "where the tangent of 30° touches the fillet",
                                        "tangent_angle_roller == 2 * fillet_height_roller / roller_teeth"
                                        " * tan(tangent_angle_roller) - tangent_constant_roller", TOOTH)  # fmt: skip
    root_chord_roller: Float = found("", "s_FE*", "critical section of the roller, in modules",
                                     "roller_teeth * sin(pi / 3 - tangent_angle_roller) + sqrt(3)"
                                     " * (fillet_height_roller / cos(tangent_angle_roller) - roller_fillet)",
                                     TOOTH)  # fmt: skip
    root_fillet_roller: Float = found("", "rho_FE*", "radius of its fillet there, in modules",
                                      "roller_fillet + 2 * fillet_height_roller**2 / (cos(tangent_angle_roller)"
                                      " * (roller_teeth * cos(tangent_angle_roller)**2 - 2 * fillet_height_roller))",
                                      TOOTH)  # fmt: skip
    load_angle_roller: Float = found("deg", "alpha_FE", "of the load at the tip of the roller",
                                     "tip_angle_roller - half_angle_roller", TOOTH)  # fmt: skip
    bending_arm_roller: Float = found("", "h_FE*", "bending arm of the roller, in modules",
                                      "((cos(half_angle_roller) - sin(half_angle_roller) * tan(load_angle_roller)) * 2"
                                      " * tip_radius_roller / module - roller_teeth"
                                      " * cos(pi / 3 - tangent_angle_roller) - fillet_height_roller"
                                      " / cos(tangent_angle_roller) + roller_fillet) / 2", TOOTH)  # fmt: skip
    form_factor_roller: Float = found("", "Y_Fa,E", "form factor of the roller",
                                      "6 * bending_arm_roller * cos(load_angle_roller)"
                                      " / (root_chord_roller**2 * cos(pressure_angle))", TOOTH)  # fmt: skip
    notch_roller: Float = found("", "q_s,E", "notch parameter of the roller; stated for 1 to 8",
                                "root_chord_roller / (2 * root_fillet_roller)", TOOTH)  # fmt: skip
    stress_correction_roller: Float = found("", "Y_Sa,E", "stress correction factor of the roller",
                                            "(1.2 + 0.13 * root_chord_roller / bending_arm_roller) * notch_roller**(1"
                                            " / (1.21 + 2.3 * bending_arm_roller / root_chord_roller))",
                                            TOOTH)  # fmt: skip
    cut_chord_ring: Float = found("", "s_FI,0*", CUT + "critical section, in modules", method=ENVELOPE)
    cut_fillet_ring: Float = found("", "rho_FI,0*", CUT + "radius of the fillet there", method=ENVELOPE)
    cut_arm_ring: Float = found("", "h_FI,0*", CUT + "bending arm, in modules", method=ENVELOPE)
    cut_angle_ring: Float = found("deg", "alpha_FI,0", CUT + "angle of the load at the tip", method=ENVELOPE)
    root_chord_ring: Float = found(
        "", "s_FI*", "critical section of the ring, in modules",
        "cases(cut_chord_ring, cutter_teeth > 0, 2 * (pi / 4 + (addendum + clearance - ring_fillet)"
        " * tan(pressure_angle) + ring_fillet / cos(pressure_angle) - ring_fillet * cos(pi / 6)))", SUBSTITUTE,
    )  # fmt: skip
    root_fillet_ring: Float = found("", "rho_FI*", "radius of its fillet there, in modules",
                                    "cases(cut_fillet_ring, cutter_teeth > 0, ring_fillet)", SUBSTITUTE)  # fmt: skip
    load_angle_ring: Float = found("deg", "alpha_FI", "of the load at the tip of the ring",
                                   "cases(cut_angle_ring, cutter_teeth > 0, pressure_angle)", SUBSTITUTE)  # fmt: skip
    bending_arm_ring: Float = found("", "h_FI*", "bending arm of the ring, in modules",
                                    "cases(cut_arm_ring, cutter_teeth > 0, 2 * addendum + clearance - (pi / 4"
                                    " - addendum * tan(pressure_angle)) * tan(pressure_angle) - ring_fillet / 2)",
                                    SUBSTITUTE)  # fmt: skip
    form_factor_ring: Float = found(
        "", "Y_Fa,I", "form factor of the ring; as a rack it depends on neither teeth nor shift",
        "6 * bending_arm_ring * cos(load_angle_ring) / (root_chord_ring**2 * cos(pressure_angle))", SUBSTITUTE,
    )  # fmt: skip
    notch_ring: Float = found("", "q_s,I", "notch parameter of the ring; stated for 1 to 8",
                              "root_chord_ring / (2 * root_fillet_ring)", SUBSTITUTE)  # fmt: skip
    stress_correction_ring: Float = found("", "Y_Sa,I", "stress correction factor of the ring",
                                          "(1.2 + 0.13 * root_chord_ring / bending_arm_ring)"
                                          " * notch_ring**(1 / (1.21 + 2.3 * bending_arm_ring / root_chord_ring))",
                                          SUBSTITUTE)  # fmt: skip
    nominal_stress_roller: Float = found("MPa", "sigma_F0,E", "nominal root stress of the roller",
                                         "tangential_force / (face_width * module) * form_factor_roller"
                                         " * stress_correction_roller", "equation 2, its textbook form")  # fmt: skip
    nominal_stress_ring: Float = found("MPa", "sigma_F0,I", "nominal root stress of the ring",
                                       "tangential_force / (face_width * module) * form_factor_ring"
                                       " * stress_correction_ring", "equation 2, its textbook form")  # fmt: skip
    root_stress_roller: Float = found("MPa", "sigma_FE", "root stress of the roller",
                                      "nominal_stress_roller * face_load_factor * dynamic_factor * sharing_factor"
                                      " / carrying_share")  # fmt: skip
    root_stress_ring: Float = found("MPa", "sigma_FI", "root stress of the ring",
                                    "nominal_stress_ring * face_load_factor * dynamic_factor * sharing_factor"
                                    " * rim_factor / carrying_share")  # fmt: skip
    # Objectives
    shift_sum: Float = found("", "f_1", "to be large: sum of the shifts; the difference is fixed",
                             "roller_shift + ring_shift", "equation 1 of the paper, not legible")  # fmt: skip
    stress_difference: Float = found(
        "MPa", "f_2", "to be small: difference of the nominal root stresses, without neutral factors",
        "abs(nominal_stress_roller - nominal_stress_ring)", "equation 2 of the paper",
    )  # fmt: skip
    sliding_difference: Float = found("", "f_3", "to be small: difference of the largest specific sliding",
                                      "abs(sliding_roller - sliding_ring)", "equation 3 of the paper")  # fmt: skip
    # Constraints: above 0 is safe
    margin_ring_base: Float = found("", "g_1", "tip circle of the ring outside its base circle",
                                    "tip_radius_ring / base_radius_ring - 1",
                                    "equation 6 of the paper, not legible")  # fmt: skip
    margin_roller_base: Float = found("", "g_2", "tip circle of the roller outside its base circle",
                                      "tip_radius_roller / base_radius_roller - 1",
                                      "equation 7 of the paper, not legible")  # fmt: skip
    margin_contact_ratio: Float = found("", "g_3", "contact ratio over the least",
                                        "contact_ratio - least_contact_ratio", "equation 8 of the paper")  # fmt: skip
    margin_interference: Float = found("rad", "g_4", "the tips pass one another", "tip_clearance - interference_margin",
                                       "equation 9 of the paper")  # fmt: skip
    margin_opposite_tips: Float = found("", "g_5", "clearance of the tips on the far side, in modules",
                                        "(tip_radius_ring - tip_radius_roller + mounted_distance) / module"
                                        " - least_clearance", "equation 10 of the paper")  # fmt: skip
    margin_roller_root: Float = found("", "g_6", "clearance of ring tip and roller root, in modules",
                                      "(tip_radius_ring - root_radius_roller - mounted_distance) / module"
                                      " - least_clearance", "equation 11 of the paper")  # fmt: skip
    margin_ring_root: Float = found("", "g_6b", "clearance of ring root and roller tip, in modules",
                                    "(root_radius_ring - tip_radius_roller - mounted_distance) / module"
                                    " - least_clearance", "mirror of equation 11")  # fmt: skip
    margin_involute: Float = found("", "g_7", "the tip of the ring meets the involute of the roller",
                                   "roller_teeth * tan(mounted_angle) - ring_teeth"
                                   " * (tan(mounted_angle) - tan(tip_angle_ring))",
                                   "involute interference")  # fmt: skip
    margin_undercut: Float = found("", "g_8", "shift of the roller over that of undercut by the rack",
                                   "roller_shift - (addendum + clearance - roller_fillet * (1 - sin(pressure_angle))"
                                   " - roller_teeth / 2 * sin(pressure_angle)**2)", INVOLUTE)  # fmt: skip
    margin_tip_land: Float = found("", "g_9", "tip land of the roller over the least, in modules",
                                   "tip_land / module - least_tip_land", RULE)  # fmt: skip
    margin_sliding: Float = found("", "g_10", "difference of sliding under the largest",
                                  "most_sliding_difference - sliding_difference",
                                  "keeps the range of the third objective finite")  # fmt: skip
    # What effects act on
    transmission_error: Float = found("um", "TE", "along the line of action", method=BASE)
    wear_depth: Float = found("um", "h", "wear of the roller where it is deepest", method=BASE)
    axial_shift: Float = found("um", "Delta z", "of a roller along the screw", method=BASE)
    friction_torque: Float = found("N*m", "M_R", "of the meshes, at the screw", method=BASE)
    backlash: Float = found("um", "j_t",
                            "arc between the free flanks at the pitch circle as mounted; below 0 the teeth jam. "
                            "Centres farther apart close an internal pair",
                            "2 * mounted_distance * (inv(working_angle) - inv(mounted_angle))", INVOLUTE)  # fmt: skip
