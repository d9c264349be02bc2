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
USUAL = "usual of roller screws"
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
    lead: Float = size(10.0, "l", "lead of screw and nut")
    rollers: int = given(10, symbol="n_r", note="rollers that share the load", source=SET, at_least=1, at_most=100)
    # The threads
    starts: int = given(5, symbol="N", note="starts of the threads of screw and nut; the roller has one", source=SET,
                        at_least=1, at_most=50)  # fmt: skip
    thread_turns: int = given(20, symbol="n_t", note="threads of a roller that touch screw and nut", source=SET,
                              at_least=2, at_most=500)  # fmt: skip
    nut_diameter: Float = given(None, "mm", symbol="d_n", note="pitch diameter of the thread of the nut; else the one "
                                "that fits screw and rollers", above=0, below=LARGEST)  # fmt: skip
    contact_angle: Float = given(45.0, "deg", symbol="beta", note="of the flanks, from the plane across the axis to "
                                 "their normal", source=USUAL, above=15, below=80)  # fmt: skip
    profile_radius: Float = given(None, "mm", symbol="R", note="of the flank of the roller; else that of a ball about "
                                  "its axis", above=0, below=LARGEST)  # fmt: skip
    screw_bore: Float = given(0.0, "mm", symbol="d_b", note="bore of the screw", at_least=0, below=LARGEST)
    nut_outside: Float = size(72.0, "D_n", "outer diameter of the nut")
    support: Literal["same_side", "far_side"] = given(
        "same_side", note="where the nut is held: at the end at which the screw is loaded, or at the other one",
    )  # fmt: skip
    elastic_modulus: Float = given(208.0, "GPa", symbol="E_m", note="of screw, rollers and nut", source="bearing steel",
                                   above=0)  # fmt: skip
    poisson: Float = given(0.3, "", symbol="nu", note="of screw, rollers and nut", source="steel", at_least=0,
                           below=0.5)  # fmt: skip
    # The pair
    pressure_angle: Float = given(20.0, "deg", symbol="alpha", note="of the rack", source=PAPER, above=10, below=30)
    roller_teeth: Float = given(20.0, "", symbol="z_E", note="teeth of the roller", source=SET, at_least=8,
                                at_most=1000, whole=True)  # fmt: skip
    ring_teeth: Float = given(100.0, "", symbol="z_I", note="teeth of the ring", source=SET, at_least=16, at_most=5000,
                              whole=True)  # fmt: skip
    module: Float = size(0.5, "m", "module")
    addendum: Float = given(0.8, "", symbol="h_a*", note="addendum, in modules", source=STUB, above=0, at_most=2)
    clearance: Float = given(0.3, "", symbol="c*", note="tip clearance, in modules", source=STUB, at_least=0, at_most=1)
    roller_fillet: Float = given(0.30, "", symbol="rho_E*", note="fillet radius of the rack of the roller, in modules",
                                 source=SET, at_least=0, at_most=1)  # fmt: skip
    ring_fillet: Float = given(0.15, "", symbol="rho_I*", note="fillet radius of the substitute rack of the ring",
                               source="GB/T 3480-1997", at_least=0, at_most=1)  # fmt: skip
    cutter_teeth: Float = given(None, "", symbol="z_0", note="teeth of the shaper cutter that makes the ring; without "
                                "them the ring is a substitute rack", at_least=8, at_most=1000, whole=True)  # fmt: skip
    cutter_shift: Float = given(0.0, "", symbol="x_0", note="profile shift of the cutter: worn ones have less",
                                at_least=-1, at_most=1)  # fmt: skip
    cutter_addendum: Float = given(None, "", symbol="h_a0*", note="addendum of the cutter, in modules; else that of "
                                   "the ring and its clearance", above=0, at_most=3)  # fmt: skip
    cutter_fillet: Float = given(0.15, "", symbol="rho_a0*", note="radius at the tip of the cutter, in modules",
                                 source="as that of the substitute rack", above=0, at_most=1)  # fmt: skip
    centre_distance: Float = size(19.80778, "a_w", "working centre distance, fixed by the threads", CALIBRATED_SHIFTS)
    face_width: Float = size(4.0, "b", "face width")
    roller_shift: Float = given(
        0.21, "", symbol="x_E", note="profile shift of the roller, in modules: the design variable; that of the ring "
        "follows", source="the printed optimum, with 1 read as the roller", at_least=-2, at_most=3,
    )  # fmt: skip
    # The load
    axial_load: Float = given(10.0, "kN", symbol="F_a", note="on the screw; a negative one loads the other flanks",
                              source="a load of this size of screw", role="set")  # fmt: skip
    tangential_share: Float = given(5.1943e-3, "", symbol="kappa_t", note="tangential load of a mesh over the axial "
                                    "load", source=CALIBRATED_LOAD, at_least=0, at_most=1)  # fmt: skip
    mesh_stiffness: Float = given(14.0, "N/(mm*um)", symbol="c_gamma", note="mesh stiffness per face width; acts with "
                                  "effects only", source="ISO 6336-1: about 14 for steel", above=0)  # fmt: skip
    # What is asked, and how it is weighed
    most_pressure: Float = given(
        4000.0, "MPa", symbol="p_max", note="largest pressure of the threads, of static load: dents of about 1e-4 of a "
        "rolling body; the least of 4000 for rollers, 4200 for balls and 4600 for balls in spheres, in ISO 76",
        source="ISO 76, by analogy; no standard states it for threads", above=0,
    )  # fmt: skip
    least_contact_ratio: Float = given(1.4, "", symbol="epsilon_min", note="least contact ratio", source=LOST_LIMIT,
                                       at_least=1, at_most=3)  # fmt: skip
    interference_margin: Float = given(0.05, "rad", symbol="G_min", note="least margin against interference of the "
                                       "tips", source="equation 9", at_least=0, at_most=3)  # fmt: skip
    least_clearance: Float = given(0.1, "", symbol="c_min*", note="least clearance between tip and root, in modules",
                                   source="equations 10 and 11", at_least=0, at_most=1)  # fmt: skip
    least_tip_land: Float = given(0.25, "", symbol="s_a,min*", note="least tip land of the roller, in modules",
                                  source="common rule", at_least=0, at_most=1)  # fmt: skip
    most_sliding_difference: Float = given(3.08, "", symbol="f_3,max", note="largest difference of specific sliding",
                                           source="printed upper limit, taken as bound of the search",
                                           above=0)  # fmt: skip
    sliding_reading: Literal["path", "roots"] = given(
        "path",
        note="third objective: of the largest sliding of each gear on the path of contact, or of that at the roots, "
        "which folds where the path begins near the pitch point",
    )
    weights: Literal["own_ranges", "printed_ranges", "printed"] = given(
        "own_ranges",
        note="weights of the objectives: by the paper's rule from the ranges found here, by its rule "
        "from the ranges that it prints, or as it prints them",
    )
    # Neutral inputs: effects reach the calculation through them
    thread_compliance: Float = given(0.0, "um/kN", symbol="c_t", note="neutral 0: what a thread gives way beside its "
                                     "contact, screw and roller or roller and nut", at_least=0)  # fmt: skip
    roller_pitch_deviation: Float = given(0.0, "um", symbol="Delta p", note="neutral 0: pitch of the rollers over that "
                                          "of screw and nut", at_least=-100, at_most=100)  # fmt: skip
    face_load_factor: Float = given(1.0, "", symbol="K_Hbeta", note="neutral 1: uneven load along the face", above=0)
    dynamic_factor: Float = given(1.0, "", symbol="K_V", note="neutral 1: load in motion over load at rest", above=0)
    sharing_factor: Float = given(1.0, "", symbol="K_gamma", note="neutral 1: load of this roller over the mean",
                                  above=0)  # fmt: skip
    carrying_share: Float = given(1.0, "", symbol="f_b", note="neutral 1: share of the face width that carries",
                                  above=0, at_most=1)  # fmt: skip
    rim_factor: Float = given(1.0, "", symbol="Y_B", note="neutral 1: raises the root stress of the ring", above=0)
    centre_distance_deviation: Float = given(
        0.0, "um", symbol="Delta a", note="neutral 0: centres farther apart than without backlash; "
        "above 0 the teeth of an internal pair jam, below 0 they have backlash", at_least=-1000, at_most=1000,
    )  # fmt: skip


# What the roller screw calculation answers: geometry, strength, objectives, constraints and what effects act on
#
# Index E is the roller (an external gear), index I the ring (an internal one). A margin above 0 is safe.

BASE = "0 in the calculation; effects act here"
INVOLUTE = "ISO 21771"
TOOTH = "ISO 6336-3: rack, tangent of 30°, load at the tip"
SUBSTITUTE = "GB/T 3480-1997: the tooth of a substitute rack, load at the tip"
ENVELOPE = "ISO 6336-3: envelope of the rounded tip of the cutter, tangent of 60°, load at the tip"
CUT = "0 without a cutter; else of the ring as cut: "
RULE = "common design rule"
NETWORK = "bars between springs, Newton's method"
HERTZ = "ellipse of Hertz under the thread that is loaded most"
WEAKEST_LINK = "lives of all threads by Weibull's weakest link, slope 10/9"
ANALOGY = "ISO 3408-5 and ISO 281 for balls, by analogy: every thread of a roller as a ball about its axis"
ROLLING = "kinematics of the screw with its nut at rest"


@results
class Meshing:
    """The pair of roller and ring at one profile shift; objectives and margins, and the stress under the load."""

    # Geometry of the pair
    working_angle: Float = found(
        "deg", symbol="alpha_w", note="working pressure angle without backlash", source=INVOLUTE,
        formula="acos(module * (ring_teeth - roller_teeth) * cos(pressure_angle) / (2 * centre_distance))",
    )  # fmt: skip
    shift_difference: Float = found(
        "", symbol="D", note="x_I - x_E, fixed by the centre distance because there is no backlash", source=INVOLUTE,
        formula="(ring_teeth - roller_teeth) * (inv(working_angle) - inv(pressure_angle)) / (2 * tan(pressure_angle))",
    )  # fmt: skip
    ring_shift: Float = found("", symbol="x_I", formula="roller_shift + shift_difference", source=INVOLUTE,
                              note="profile shift of the ring; positive outward, larger tip and root circle "
                              "(ISO 21771 counts it the other way)")  # fmt: skip
    mounted_distance: Float = found("mm", symbol="a_m", note="centre distance as mounted",
                                    formula="centre_distance + centre_distance_deviation")  # fmt: skip
    mounted_angle: Float = found(
        "deg", symbol="alpha_m", note="working pressure angle as mounted", source=INVOLUTE,
        formula="acos(module * (ring_teeth - roller_teeth) * cos(pressure_angle) / (2 * mounted_distance))",
    )  # fmt: skip
    base_radius_roller: Float = found("mm", symbol="r_bE", note="base circle of the roller",
                                      formula="module * roller_teeth * cos(pressure_angle) / 2")  # fmt: skip
    base_radius_ring: Float = found("mm", symbol="r_bI", note="base circle of the ring",
                                    formula="module * ring_teeth * cos(pressure_angle) / 2")  # fmt: skip
    tip_radius_roller: Float = found("mm", symbol="r_aE", note="tip circle of the roller, not truncated",
                                     formula="module * (roller_teeth / 2 + addendum + roller_shift)")  # fmt: skip
    tip_radius_ring: Float = found("mm", symbol="r_aI", note="tip circle of the ring, not truncated",
                                   formula="module * (ring_teeth / 2 - addendum + ring_shift)")  # fmt: skip
    root_radius_roller: Float = found(
        "mm", symbol="r_fE", note="root circle of the roller",
        formula="module * (roller_teeth / 2 - addendum - clearance + roller_shift)",
    )  # fmt: skip
    root_radius_ring: Float = found(
        "mm", symbol="r_fI", note="root circle of the ring; a shaper leaves a slightly different one",
        formula="module * (ring_teeth / 2 + addendum + clearance + ring_shift)",
    )  # fmt: skip
    tip_angle_roller: Float = found("deg", symbol="alpha_aE", note="pressure angle at the tip of the roller",
                                    formula="acos(base_radius_roller / tip_radius_roller)")  # fmt: skip
    tip_angle_ring: Float = found("deg", symbol="alpha_aI", note="pressure angle at the tip of the ring",
                                  formula="acos(base_radius_ring / tip_radius_ring)")  # fmt: skip
    contact_ratio: Float = found(
        "", symbol="epsilon", note="contact ratio", source="equation 8 of the paper, not legible; ISO 21771",
        formula="(roller_teeth * (tan(tip_angle_roller) - tan(mounted_angle))"
        " - ring_teeth * (tan(tip_angle_ring) - tan(mounted_angle))) / (2 * pi)", key=True,
    )  # fmt: skip
    half_angle_roller: Float = found(
        "deg", symbol="gamma", note="half the angle of the tooth of the roller at its tip", source=INVOLUTE,
        formula="(pi / 2 + 2 * roller_shift * tan(pressure_angle)) / roller_teeth + inv(pressure_angle)"
        " - inv(tip_angle_roller)",
    )  # fmt: skip
    tip_land: Float = found("mm", symbol="s_a", note="width of the tip of the roller's tooth", source=INVOLUTE,
                            formula="2 * tip_radius_roller * half_angle_roller")  # fmt: skip
    crossing_cosine_roller: Float = found(
        "", symbol="c_E", note="cosine of the next angle; 1 where the tip circles do not cross", source="equation 9",
        formula="min((tip_radius_ring**2 - tip_radius_roller**2 - mounted_distance**2)"
        " / (2 * mounted_distance * tip_radius_roller), 1)",
    )  # fmt: skip
    crossing_angle_roller: Float = found("deg", symbol="delta_E",
                                         note="where the tip circles cross, seen from the roller", source="equation 9",
                                         formula="acos(crossing_cosine_roller)")  # fmt: skip
    crossing_cosine_ring: Float = found(
        "", symbol="c_I", note="cosine of the next angle; 1 where the tip circles do not cross", source="equation 9",
        formula="min((tip_radius_ring**2 - tip_radius_roller**2 + mounted_distance**2)"
        " / (2 * mounted_distance * tip_radius_ring), 1)",
    )  # fmt: skip
    crossing_angle_ring: Float = found("deg", symbol="delta_I", note="where the tip circles cross, seen from the ring",
                                       source="equation 9", formula="acos(crossing_cosine_ring)")  # fmt: skip
    tip_clearance: Float = found(
        "rad", symbol="G_s", note="clearance of the tips where their circles cross, 2π to a tooth; 2π where they do "
        "not cross", source="equation 9, with its index 1 read as the roller",
        formula="cases(roller_teeth * (crossing_angle_roller + inv(tip_angle_roller))"
        " - ring_teeth * (crossing_angle_ring + inv(tip_angle_ring))"
        " + (ring_teeth - roller_teeth) * inv(mounted_angle),"
        " mounted_distance + tip_radius_roller > tip_radius_ring, 2 * pi)",
    )  # fmt: skip
    root_sliding_roller: Float = found(
        "", symbol="eta_E,f", note="specific sliding at the root of the roller, where the tip of the ring meets it; "
        "magnitude", source="1 - v_I/v_E of the speeds along the flanks",
        formula="abs((ring_teeth - roller_teeth) * (tan(mounted_angle) - tan(tip_angle_ring)) / margin_involute)",
    )  # fmt: skip
    tip_sliding_roller: Float = found(
        "", symbol="eta_E,a", note="specific sliding at the tip of the roller; magnitude",
        source="1 - v_I/v_E of the speeds along the flanks",
        formula="abs((ring_teeth - roller_teeth) * (tan(tip_angle_roller) - tan(mounted_angle))"
        " / (ring_teeth * tan(tip_angle_roller)))",
    )  # fmt: skip
    tips_count: Float = found("", symbol="i_a", note="1: sliding at the tips counts too, so the largest on the path of "
                              "contact; 0: at the roots alone", method="as sliding_reading has it")  # fmt: skip
    sliding_roller: Float = found("", symbol="eta_E",
                                  note="specific sliding of the roller that counts, its largest on the path of contact",
                                  formula="max(root_sliding_roller, tips_count * tip_sliding_roller)",
                                  source="sliding changes in one direction along the path", key=True)  # fmt: skip
    root_sliding_ring: Float = found(
        "", symbol="eta_I,f", note="specific sliding at the root of the ring, where the tip of the roller meets it; "
        "magnitude", source="1 - v_E/v_I of the speeds along the flanks",
        formula="abs((ring_teeth - roller_teeth) * (tan(tip_angle_roller) - tan(mounted_angle))"
        " / (ring_teeth * tan(mounted_angle) + roller_teeth * (tan(tip_angle_roller) - tan(mounted_angle))))",
    )  # fmt: skip
    tip_sliding_ring: Float = found(
        "", symbol="eta_I,a", note="specific sliding at the tip of the ring; magnitude",
        source="1 - v_E/v_I of the speeds along the flanks",
        formula="abs((ring_teeth - roller_teeth) * (tan(mounted_angle) - tan(tip_angle_ring))"
        " / (roller_teeth * tan(tip_angle_ring)))",
    )  # fmt: skip
    sliding_ring: Float = found("", symbol="eta_I",
                                note="specific sliding of the ring that counts, its largest on the path of contact",
                                formula="max(root_sliding_ring, tips_count * tip_sliding_ring)",
                                source="sliding changes in one direction along the path")  # fmt: skip
    largest_sliding: Float = found(
        "", symbol="eta_max", note="largest specific sliding of either gear on the path of contact, by any reading",
        formula="max(root_sliding_roller, tip_sliding_roller, root_sliding_ring, tip_sliding_ring)",
        source="sliding changes in one direction along the path", key=True,
    )  # fmt: skip
    ring_meshes: Float = found(
        "", symbol="n_I/n_E", note="meshes of a tooth of the ring while one of a roller meshes once; decides how fast "
        "either wears", formula="rollers * roller_teeth / ring_teeth", source="counts of teeth",
    )  # fmt: skip
    # Strength of the roots
    tangential_force: Float = found("N", symbol="F_t", note="load of one mesh", formula="tangential_share * "
                                    "abs(axial_load)")  # fmt: skip
    fillet_offset_roller: Float = found(
        "", symbol="E", note="from the middle of the gap of the rack to the centre of its fillet", source=TOOTH,
        formula="pi / 4 - (addendum + clearance) * tan(pressure_angle)"
        " - (1 - sin(pressure_angle)) * roller_fillet / cos(pressure_angle)",
    )  # fmt: skip
    fillet_height_roller: Float = found(
        "", symbol="G", note="of the centre of the fillet over the pitch line", source=TOOTH,
        formula="roller_fillet - addendum - clearance + roller_shift",
    )  # fmt: skip
    tangent_constant_roller: Float = found("", symbol="H", note="constant of the next equation", source=TOOTH,
                                           formula="2 / roller_teeth * (pi / 2 - fillet_offset_roller) - pi / 3",
                                           )  # fmt: skip
    tangent_angle_roller: Float = found(
        "deg", symbol="theta", note="where the tangent of 30° touches the fillet", source=TOOTH,
        formula="tangent_angle_roller == 2 * fillet_height_roller / roller_teeth * tan(tangent_angle_roller)"
        " - tangent_constant_roller",
    )  # fmt: skip
    root_chord_roller: Float = found(
        "", symbol="s_FE*", note="critical section of the roller, in modules", source=TOOTH,
        formula="roller_teeth * sin(pi / 3 - tangent_angle_roller)"
        " + sqrt(3) * (fillet_height_roller / cos(tangent_angle_roller) - roller_fillet)",
    )  # fmt: skip
    root_fillet_roller: Float = found(
        "", symbol="rho_FE*", note="radius of its fillet there, in modules", source=TOOTH,
        formula="roller_fillet + 2 * fillet_height_roller**2 / (cos(tangent_angle_roller)"
        " * (roller_teeth * cos(tangent_angle_roller)**2 - 2 * fillet_height_roller))",
    )  # fmt: skip
    load_angle_roller: Float = found("deg", symbol="alpha_FE", note="of the load at the tip of the roller",
                                     formula="tip_angle_roller - half_angle_roller", source=TOOTH)  # fmt: skip
    bending_arm_roller: Float = found(
        "", symbol="h_FE*", note="bending arm of the roller, in modules", source=TOOTH,
        formula="((cos(half_angle_roller) - sin(half_angle_roller) * tan(load_angle_roller))"
        " * 2 * tip_radius_roller / module - roller_teeth * cos(pi / 3 - tangent_angle_roller)"
        " - fillet_height_roller / cos(tangent_angle_roller) + roller_fillet) / 2",
    )  # fmt: skip
    form_factor_roller: Float = found(
        "", symbol="Y_Fa,E", note="form factor of the roller", source=TOOTH,
        formula="6 * bending_arm_roller * cos(load_angle_roller) / (root_chord_roller**2 * cos(pressure_angle))",
    )  # fmt: skip
    notch_roller: Float = found("", symbol="q_s,E", note="notch parameter of the roller; stated for 1 to 8",
                                formula="root_chord_roller / (2 * root_fillet_roller)", source=TOOTH)  # fmt: skip
    stress_correction_roller: Float = found(
        "", symbol="Y_Sa,E", note="stress correction factor of the roller", source=TOOTH,
        formula="(1.2 + 0.13 * root_chord_roller / bending_arm_roller)"
        " * notch_roller**(1 / (1.21 + 2.3 * bending_arm_roller / root_chord_roller))",
    )  # fmt: skip
    cut_chord_ring: Float = found("", symbol="s_FI,0*", note=CUT + "critical section, in modules", method=ENVELOPE)
    cut_fillet_ring: Float = found("", symbol="rho_FI,0*", note=CUT + "radius of the fillet there", method=ENVELOPE)
    cut_arm_ring: Float = found("", symbol="h_FI,0*", note=CUT + "bending arm, in modules", method=ENVELOPE)
    cut_angle_ring: Float = found("deg", symbol="alpha_FI,0", note=CUT + "angle of the load at the tip",
                                  method=ENVELOPE)  # fmt: skip
    root_chord_ring: Float = found(
        "", symbol="s_FI*", note="critical section of the ring, in modules", source=SUBSTITUTE,
        formula="cases(cut_chord_ring, cutter_teeth > 0,"
        " 2 * (pi / 4 + (addendum + clearance - ring_fillet) * tan(pressure_angle)"
        " + ring_fillet / cos(pressure_angle) - ring_fillet * cos(pi / 6)))",
    )  # fmt: skip
    root_fillet_ring: Float = found("", symbol="rho_FI*", note="radius of its fillet there, in modules",
                                    formula="cases(cut_fillet_ring, cutter_teeth > 0, ring_fillet)",
                                    source=SUBSTITUTE)  # fmt: skip
    load_angle_ring: Float = found("deg", symbol="alpha_FI", note="of the load at the tip of the ring",
                                   formula="cases(cut_angle_ring, cutter_teeth > 0, pressure_angle)",
                                   source=SUBSTITUTE)  # fmt: skip
    bending_arm_ring: Float = found(
        "", symbol="h_FI*", note="bending arm of the ring, in modules", source=SUBSTITUTE,
        formula="cases(cut_arm_ring, cutter_teeth > 0, 2 * addendum + clearance"
        " - (pi / 4 - addendum * tan(pressure_angle)) * tan(pressure_angle) - ring_fillet / 2)",
    )  # fmt: skip
    form_factor_ring: Float = found(
        "", symbol="Y_Fa,I", note="form factor of the ring; as a rack it depends on neither teeth nor shift",
        source=SUBSTITUTE,
        formula="6 * bending_arm_ring * cos(load_angle_ring) / (root_chord_ring**2 * cos(pressure_angle))",
    )  # fmt: skip
    notch_ring: Float = found("", symbol="q_s,I", note="notch parameter of the ring; stated for 1 to 8",
                              formula="root_chord_ring / (2 * root_fillet_ring)", source=SUBSTITUTE)  # fmt: skip
    stress_correction_ring: Float = found(
        "", symbol="Y_Sa,I", note="stress correction factor of the ring", source=SUBSTITUTE,
        formula="(1.2 + 0.13 * root_chord_ring / bending_arm_ring)"
        " * notch_ring**(1 / (1.21 + 2.3 * bending_arm_ring / root_chord_ring))",
    )  # fmt: skip
    nominal_stress_roller: Float = found(
        "MPa", symbol="sigma_F0,E", note="nominal root stress of the roller", source="equation 2, its textbook form",
        formula="tangential_force / (face_width * module) * form_factor_roller * stress_correction_roller",
    )  # fmt: skip
    nominal_stress_ring: Float = found(
        "MPa", symbol="sigma_F0,I", note="nominal root stress of the ring", source="equation 2, its textbook form",
        formula="tangential_force / (face_width * module) * form_factor_ring * stress_correction_ring",
    )  # fmt: skip
    root_stress_roller: Float = found(
        "MPa", symbol="sigma_FE", note="root stress of the roller",
        formula="nominal_stress_roller * face_load_factor * dynamic_factor * sharing_factor / carrying_share", key=True,
    )  # fmt: skip
    root_stress_ring: Float = found(
        "MPa", symbol="sigma_FI", note="root stress of the ring",
        formula="nominal_stress_ring * face_load_factor * dynamic_factor * sharing_factor * rim_factor"
        " / carrying_share", key=True,
    )  # fmt: skip
    # Objectives
    shift_sum: Float = found("", symbol="f_1", note="to be large: sum of the shifts; the difference is fixed",
                             formula="roller_shift + ring_shift", source="equation 1 of the paper, not legible",
                             )  # fmt: skip
    stress_difference: Float = found(
        "MPa", symbol="f_2", note="to be small: difference of the nominal root stresses, without neutral factors",
        formula="abs(nominal_stress_roller - nominal_stress_ring)", source="equation 2 of the paper",
    )  # fmt: skip
    sliding_difference: Float = found("", symbol="f_3", note="to be small: difference of the largest specific sliding",
                                      formula="abs(sliding_roller - sliding_ring)", source="equation 3 of the paper",
                                      )  # fmt: skip
    # Constraints: above 0 is safe
    margin_ring_base: Float = found("", symbol="g_1", note="tip circle of the ring outside its base circle",
                                    formula="tip_radius_ring / base_radius_ring - 1",
                                    source="equation 6 of the paper, not legible")  # fmt: skip
    margin_roller_base: Float = found("", symbol="g_2", note="tip circle of the roller outside its base circle",
                                      formula="tip_radius_roller / base_radius_roller - 1",
                                      source="equation 7 of the paper, not legible")  # fmt: skip
    margin_contact_ratio: Float = found("", symbol="g_3", note="contact ratio over the least",
                                        formula="contact_ratio - least_contact_ratio", source="equation 8 of the paper",
                                        )  # fmt: skip
    margin_interference: Float = found("rad", symbol="g_4", note="the tips pass one another",
                                       formula="tip_clearance - interference_margin", source="equation 9 of the paper",
                                       )  # fmt: skip
    margin_opposite_tips: Float = found(
        "", symbol="g_5", note="clearance of the tips on the far side, in modules", source="equation 10 of the paper",
        formula="(tip_radius_ring - tip_radius_roller + mounted_distance) / module - least_clearance",
    )  # fmt: skip
    margin_roller_root: Float = found(
        "", symbol="g_6", note="clearance of ring tip and roller root, in modules", source="equation 11 of the paper",
        formula="(tip_radius_ring - root_radius_roller - mounted_distance) / module - least_clearance",
    )  # fmt: skip
    margin_ring_root: Float = found(
        "", symbol="g_6b", note="clearance of ring root and roller tip, in modules", source="mirror of equation 11",
        formula="(root_radius_ring - tip_radius_roller - mounted_distance) / module - least_clearance",
    )  # fmt: skip
    margin_involute: Float = found(
        "", symbol="g_7", note="the tip of the ring meets the involute of the roller", source="involute interference",
        formula="roller_teeth * tan(mounted_angle) - ring_teeth * (tan(mounted_angle) - tan(tip_angle_ring))",
    )  # fmt: skip
    margin_undercut: Float = found(
        "", symbol="g_8", note="shift of the roller over that of undercut by the rack", source=INVOLUTE,
        formula="roller_shift - (addendum + clearance - roller_fillet * (1 - sin(pressure_angle))"
        " - roller_teeth / 2 * sin(pressure_angle)**2)",
    )  # fmt: skip
    margin_tip_land: Float = found("", symbol="g_9", note="tip land of the roller over the least, in modules",
                                   formula="tip_land / module - least_tip_land", source=RULE)  # fmt: skip
    margin_sliding: Float = found("", symbol="g_10", note="difference of sliding under the largest",
                                  formula="most_sliding_difference - sliding_difference",
                                  source="keeps the range of the third objective finite")  # fmt: skip
    # Threads
    pitch: Float = found("mm", symbol="p", note="from thread to thread; the lead of the roller",
                         formula="lead / starts")  # fmt: skip
    helix_angle: Float = found("deg", symbol="lambda", note="lead angle of the screw",
                               formula="atan(lead / (pi * screw_diameter))")  # fmt: skip
    mean_thread_force: Float = found(
        "N", symbol="Q_m", note="normal force of a thread at the mean", source="balance along the axis",
        formula="abs(axial_load) / (rollers * thread_turns * sin(contact_angle) * cos(helix_angle))",
    )  # fmt: skip
    thread_share_screw: Float = found("", symbol="kappa_S", note="largest load of a thread over the mean, at the screw",
                                      method=NETWORK)  # fmt: skip
    thread_share_nut: Float = found("", symbol="kappa_N", note="largest load of a thread over the mean, at the nut",
                                    method=NETWORK)  # fmt: skip
    thread_pressure_screw: Float = found("MPa", symbol="p_S", note="largest pressure between screw and roller",
                                         method=HERTZ)  # fmt: skip
    thread_pressure_nut: Float = found("MPa", symbol="p_N", note="largest pressure between roller and nut",
                                       method=HERTZ)  # fmt: skip
    margin_pressure: Float = found(
        "", symbol="g_p", note="largest pressure under the one permitted, as a share",
        source="static limit of rolling bearings, ISO 76, by analogy",
        formula="1 - max(thread_pressure_screw, thread_pressure_nut) / most_pressure",
    )  # fmt: skip
    thread_deflection: Float = found("um", symbol="delta_a", note="way of the screw at its loaded end against the held "
                                     "end of the nut", method=NETWORK)  # fmt: skip
    axial_stiffness: Float = found("N/um", symbol="k_a", note="axial load over that way; of the engaged threads and "
                                   "bodies", method=NETWORK, key=True)  # fmt: skip
    life_factor_screw: Float = found("", symbol="K_S", note="load that tires threads that share alike as fast, over "
                                     "the load: in the screw", method=WEAKEST_LINK)  # fmt: skip
    life_factor_nut: Float = found("", symbol="K_N", note="the same in the nut", method=WEAKEST_LINK)
    curvature_ratio: Float = found("", symbol="gamma", note="ball of the roller over the circle of its centres, times "
                                   "the cosine", formula="roller_diameter / (screw_diameter + roller_diameter)",
                                   source=ANALOGY)  # fmt: skip
    ball_diameter: Float = found("mm", symbol="D", note="of the ball that a thread of the roller stands for",
                                 formula="roller_diameter / cos(contact_angle)", source=ANALOGY)  # fmt: skip
    screw_rating: Float = found(
        "kN", symbol="C_s", note="dynamic rating of one thread of all rollers on the screw", source=ANALOGY,
        numeric=True,
        formula="1e-3 * 88.2 * (1 - sin(contact_angle * pi / 180) / 3) * curvature_ratio**0.3"
        " * (1 - curvature_ratio)**1.39 / (1 + curvature_ratio)**(1 / 3) * cos(contact_angle * pi / 180)**0.7"
        " * rollers**(2 / 3) * cases(3.647 * ball_diameter**1.4, ball_diameter > 25.4, ball_diameter**1.8)"
        " * tan(contact_angle * pi / 180) * cos(helix_angle * pi / 180)",
    )  # fmt: skip
    nut_rating: Float = found(
        "kN", symbol="C_n", note="dynamic rating of one thread of all rollers in the nut", source=ANALOGY,
        formula="screw_rating * ((1 + curvature_ratio) / (1 - curvature_ratio))**1.72",
    )  # fmt: skip
    dynamic_rating: Float = found(
        "kN", symbol="C_a", note="dynamic axial load rating of threads that share alike", source=ANALOGY, key=True,
        formula="screw_rating * (1 + (screw_rating / nut_rating)**(10 / 3))**(-0.3) * thread_turns**0.7",
    )  # fmt: skip
    ball_screw_rating: Float = found(
        "kN", symbol="C_a,86", note="the same with the exponent 0.86 that ball screws are rated with for their turns: "
        "how far another reading reaches; the life as its cube", source="quoted of ISO 3408-5, not checked",
        formula="dynamic_rating * thread_turns**0.16",
    )  # fmt: skip
    acting_load: Float = found("kN", symbol="F", note="magnitude of the axial load, at least 1 mN",
                               method="keeps life and stiffness finite")  # fmt: skip
    thread_life: Float = found(
        "", symbol="L_10", note="turns of the screw that nine of ten outlive, with the threads sharing as they do",
        formula="1e6 * (thread_turns**0.7 / acting_load * ((life_factor_screw / screw_rating)**(10 / 3)"
        " + (life_factor_nut / nut_rating)**(10 / 3))**(-0.3))**3", source=ANALOGY, key=True,
    )  # fmt: skip
    # Ratio of threads and teeth
    nut_pitch_diameter: Float = found("mm", symbol="d_N", note="pitch diameter of the nut, as stated or as it fits",
                                      formula="cases(nut_diameter, nut_diameter > 0,"
                                      " screw_diameter + 2 * roller_diameter)")  # fmt: skip
    ratio_mismatch: Float = found(
        "", symbol="Delta_i", note="ratio of the threads over that of the teeth, less 1", source=ROLLING,
        formula="nut_pitch_diameter * roller_teeth / (roller_diameter * ring_teeth) - 1",
    )  # fmt: skip
    slip_per_turn: Float = found(
        "um", symbol="s_N", note="slip around of a roller in the nut per turn of the screw: the teeth lead, the "
        "thread of the screw rolls", source=ROLLING,
        formula="pi * (nut_pitch_diameter - roller_diameter * ring_teeth / roller_teeth) * screw_diameter"
        " / (screw_diameter + roller_diameter * ring_teeth / roller_teeth)",
    )  # fmt: skip
    migration_per_turn: Float = found(
        "um", symbol="s_z", note="creep of a roller along the nut per turn of the screw; 0 with as many starts as the "
        "ratio of the teeth", source=ROLLING,
        formula="(lead - pitch * ring_teeth / roller_teeth) * screw_diameter"
        " / (screw_diameter + roller_diameter * ring_teeth / roller_teeth)",
    )  # fmt: skip
    # What effects act on
    transmission_error: Float = found("um", symbol="TE", note="along the line of action", method=BASE)
    wear_depth: Float = found("um", symbol="h", note="wear of the roller where it is deepest", method=BASE)
    axial_shift: Float = found("um", symbol="Delta z", note="of a roller along the screw", method=BASE)
    friction_torque: Float = found("N*m", symbol="M_R", note="of the meshes, at the screw", method=BASE)
    backlash: Float = found("um", symbol="j_t",
                            note="arc between the free flanks at the pitch circle as mounted; below 0 the teeth jam. "
                                 "Centres farther apart close an internal pair", source=INVOLUTE,
                            formula="2 * mounted_distance * (inv(working_angle) - inv(mounted_angle))",
                            key=True)  # fmt: skip
