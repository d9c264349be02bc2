"""What the reducer calculation is told and what it answers: every quantity with unit, symbol, bounds and source."""

from typing import Any, Literal

from truing import Float, found, given, inputs, results

PAPER = "section 1.5 of the paper"
INDICES = "follows from the indices of Table 2; Table 1 is lost"
CATALOGUE = "known of reducers of this size; Table 1 is lost"
CALIBRATED = "chosen so that 3.127 um after 6000 h follow"
LARGEST = 1000.0  # mm or um: no reducer has a metre, no deviation or wear a millimetre
HALVING = 0.05  # 3.7 % is the most that was seen; a fifth of a percent of the wear of the paper's reducer
SAMPLED = {"loaded_pins": "1", "wear_angle": "20 deg"}  # a count, and the place of a flat maximum
ZONE = "middle of its zone; the zones were chosen to fit"


def length(value: float, unit: Literal["mm", "um"], symbol: str, note: str, source: str) -> Any:
    """Declare a size, above zero; a thousand of its unit was meant in another one."""
    return given(value, unit, symbol=symbol, note=note, source=source, above=0, below=LARGEST)


def deviation(value: float, symbol: str, note: str) -> Any:
    """Declare an error factor of the backlash at the middle of its zone; no part is off by a millimetre."""
    return given(value, "um", symbol=symbol, note=note, source=ZONE, at_least=-LARGEST, at_most=LARGEST)


@inputs
class Reducer:
    """Gearing, load and lubricant, the sixteen error factors, and what is asked of the backlash."""

    # The gearing
    pin_count: int = given(40, symbol="z_p", note="pins; the disc has one tooth less", source=INDICES, at_least=4)
    pin_circle_radius: Float = length(114.5, "mm", "r_p", "radius of the circle of the pin centres", INDICES)
    pin_radius: Float = length(5.0, "mm", "r_rp", "radius of the pins", CATALOGUE)
    eccentricity: Float = length(2.2, "mm", "e", "throw of the crank", INDICES)
    disc_width: Float = length(20.0, "mm", "B", "loaded width of one disc", CATALOGUE)
    equidistant_modification: Float = given(-26.0, "um", "Delta r_rp",
                                            "grinding with another pin radius; above 0 the tooth becomes thinner",
                                            PAPER, at_least=-LARGEST, at_most=LARGEST)  # fmt: skip
    shift_modification: Float = given(-30.0, "um", "Delta r_p",
                                      "grinding on another pin circle; below 0 the tooth becomes thinner", PAPER,
                                      at_least=-LARGEST, at_most=LARGEST)  # fmt: skip
    sun_radius: Float = length(18.0, "mm", "r_1", "pitch circle of the sun gear", INDICES)
    centre_distance: Float = length(63.0, "mm", "a", "sun to planet, and circle of the cranks", INDICES)
    total_ratio: Float = given(101.0, "", "i_H", "input turns per output turn", INDICES, above=1)
    pressure_angle: Float = given(20.0, "deg", "alpha_n", "pressure angle of the involute gears", INDICES, above=0,
                                  below=45)  # fmt: skip
    # Load and material
    output_torque: Float = given(3136.0, "N*m", "T_z", "torque at the output", PAPER, above=0)
    output_speed: Float = given(15.0, "r/min", "n", "speed of the output", PAPER, above=0)
    working_time: Float = given(6000.0, "h", "T", "working time of this set of discs; rated life 6000 h", PAPER,
                                at_least=0)  # fmt: skip
    reversing: Float = given(None, "", "f_r",
                             "0: the load is always on the same flank, 1: both flanks share the working time evenly; "
                             "without it each flank is loaded in all of it, as the paper counts", at_least=0,
                             at_most=1)  # fmt: skip
    torque_share: Float = given(0.55, "", "kappa_T", "share of the output torque on the worse of two discs",
                                "Chinese practice for cycloid drives", above=0, at_most=1)  # fmt: skip
    young_modulus: Float = given(2.06e5, "MPa", "E", "modulus of steel", "literature", above=0)
    poisson_ratio: Float = given(0.3, "", "nu", "Poisson ratio of steel", "literature", at_least=0, below=0.5)
    pressure_viscosity: Float = given(2.2e-8, "1/Pa", "alpha", "pressure viscosity of the base oil",
                                      "mineral oil 1.5e-8 to 2.4e-8", above=0)  # fmt: skip
    composite_roughness: Float = length(
        0.694, "um", "R_q", "roughness of both surfaces together, root mean square", CALIBRATED
    )
    # How it is calculated
    load_sharing: Literal["linear", "hertz"] = given(
        "linear", note="forces in proportion to the approach as in the paper, or by Hertz at every pin"
    )
    wear_coefficient: Literal["pointwise", "pitch_point"] = given(
        "pointwise", note="regression with the force of every point, or once with that at the pitch point"
    )
    reconstruction_depth: Float = given(0.05, "um", "epsilon", "new wear after which forces are found again",
                                        "0.4 % from convergence", above=0, below=LARGEST, halving=HALVING,
                                        halving_but=SAMPLED)  # fmt: skip
    phases: int = given(8, note="positions of the disc within one pin pitch", at_least=4, at_most=256, halving=HALVING,
                        halving_but=SAMPLED)  # fmt: skip
    # The error factors of the backlash, by their number in the paper's Table 2
    base_tangent_error: Float = deviation(-15.0, "Delta E_bn", "1: mean base tangent length of the involute gears")
    gear_runout: Float = deviation(5.0, "F_r", "2: radial runout of the involute gears")
    centre_distance_error: Float = deviation(0.0, "f_a", "3: distance of sun and planet")
    pin_circle_error: Float = deviation(0.0, "delta r_p", "6: radius of the pin circle")
    pin_radius_error: Float = deviation(-2.0, "delta r_rp", "7: radius of the pins")
    pin_fit_clearance: Float = deviation(8.5, "delta_J", "8: fit of the pins in their holes")
    disc_runout: Float = deviation(3.275, "F_rc", "9: radial runout of the cycloid toothing")
    pin_position_error: Float = deviation(0.6, "delta_t", "10: pin holes along the circumference")
    disc_pitch_error: Float = deviation(0.0, "F_pc", "11: cumulative pitch of the cycloid disc")
    equidistant_error: Float = deviation(0.0, "delta Delta r_rp", "12: equidistant modification as ground")
    shift_error: Float = deviation(0.0, "delta Delta r_p", "13: shift modification as ground")
    eccentricity_error: Float = deviation(0.0, "delta e", "14: throw of the crank")
    bearing_clearance: Float = deviation(11.1, "delta_b", "16: clearance of the crank bearings")
    runout_gap: Float = given(0.0, "um", "delta_R", "neutral 0: gap of both flanks that runout of the pin circle takes",
                              at_least=0, at_most=LARGEST)  # fmt: skip
    # What is asked
    permitted_backlash: Float = given(1.0, "arcmin", "Delta phi_per", "permitted backlash", PAPER, above=0)
    required_reliability: Float = given(
        0.95, "", "R_per", "share of machines within it; the paper's 100 % is read as 0.999", PAPER, above=0, at_most=1
    )
    permitted_pressure: Float = given(2000.0, "MPa", "p_per", "mean contact pressure up to which it holds",
                                      "elastic contact of hardened steel", above=0)  # fmt: skip
    design_clearance: Float = given(
        4.0, "um", "Delta r_0", "radial clearance that an optimisation of the modifications keeps",
        "difference of the paper's two modifications", at_least=0, at_most=LARGEST,
    )  # fmt: skip
    cost_form: Literal["power", "exponential", "process"] = given(
        "power", note="reading of the paper's lost cost functions; only power gives its total of 1402 yuan"
    )
    # Neutral inputs: effects reach the calculation through them
    wear_rate_factor: Float = given(1.0, "", "f_k", "neutral 1: multiplies the wear coefficient", above=0)
    sliding_factor: Float = given(1.0, "", "f_s", "neutral 1: share of the sliding that is left", at_least=0)
    ageing_rate: Float = given(0.0, "1/h", "a_L", "neutral 0: growth of the wear coefficient with time", at_least=0)
    film_factor: Float = given(0.0, "", "f_Lambda", "neutral 0: film thickness over that of Dowson", at_least=0)
    oil_viscosity: Float = given(0.2, "Pa*s", "eta", "of the base oil at work; acts only with a film", above=0)
    depth_factor: Float = given(1.0, "", "f_h", "neutral 1: multiplies the wear depth", at_least=0)
    extra_wear: Float = given(0.0, "um", "h_0", "neutral 0: depth lost beside the law of wear", at_least=-LARGEST,
                              at_most=LARGEST)  # fmt: skip
    loaded_share: Float = given(1.0, "", "f_T",
                                "neutral 1: share of the working time in which either flank is loaded; acts without "
                                "reversing", at_least=0, at_most=1)  # fmt: skip
    lost_motion_share: Float = given(1.0, "", "kappa_w", "neutral 1: share of the largest wear that is felt",
                                     at_least=0)  # fmt: skip
    pin_wear_ratio: Float = given(0.0, "", "kappa_p", "neutral 0: wear of the pins over that of the disc", at_least=0)


# What the reducer calculation answers for every machine; what is known once per run comes from studies

EQUATION_21 = "equation 21 and Table 2 of the paper"


@results
class Wear:
    """Forces between disc and pins, wear of the disc, and the backlash at the output with its four shares."""

    short_width: Float = found("", "K_1", "short-width coefficient of the cycloid",
                               "eccentricity * pin_count / pin_circle_radius")  # fmt: skip
    root: Float = found("", "q", "sine of the phase angle of the longest arm", "sqrt(1 - short_width**2)")
    radial_clearance: Float = found("um", "Delta r", "gap between disc and pins all around",
                                    "equidistant_modification - shift_modification")  # fmt: skip
    equidistant_high: Float = found("um", "Delta r_rp,max", "above it disc and pins interfere",
                                    "radial_clearance / (1 - root)", "equation 17")  # fmt: skip
    equidistant_low: Float = found("um", "Delta r_rp,min",
                                   "below it the disc has more than twice the radial clearance somewhere",
                                   source="equation 17", method="largest clearance over the phase angle")  # fmt: skip
    disc_torque: Float = found("N*m", "T_c", "torque on the worse of the two discs", "torque_share * output_torque")
    start_force: Float = found("N", "F_max,0", "largest force without any clearance",
                               "4 * disc_torque / (short_width * (pin_count - 1) * pin_circle_radius)",
                               "equation 1")  # fmt: skip
    max_force: Float = found("N", "F_max", "force at the longest arm, unworn, the worst position",
                             method="torque balance of all loaded pins, equations 1b to 4")  # fmt: skip
    approach: Float = found("um", "delta_max", "approach of disc and pin under that force",
                            method="line contact, equation 1b")  # fmt: skip
    largest_force: Float = found("N", "F_i", "largest force on a pin, unworn", method="equation 2")
    loaded_pins: Float = found("", "N_p", "most pins loaded at once, unworn", method="equation 2", digits=3)
    max_pressure: Float = found("MPa", "p_i", "largest mean contact pressure, unworn",
                                method="equation 5: force over the area of the contact")  # fmt: skip
    mesh_period: Float = found("s", "t", "time in which every tooth meshes once", "1 / (output_speed * pin_count)",
                               "equation 14")  # fmt: skip
    coefficient: Float = found("1/Pa", "k", "wear coefficient at the longest arm, unworn",
                               method="regression of Janakiraman, Li and Kahraman, equations 9 and 10")  # fmt: skip
    max_wear: Float = found("um", "h_max", "deepest wear, of the flank that is loaded longer",
                            method="equations 13 to 16: wear, new profile, new forces, step by step")  # fmt: skip
    wear_angle: Float = found("deg", "psi_h", "phase angle of the deepest wear", method="as the wear")
    backlash_wear: Float = found("um", "h_phi", "wear that is felt at a flank as lost motion",
                                 method="deepest wear, mean of both flanks, with the shares of the inputs")  # fmt: skip
    backlash_involute: Float = found("arcmin", "Delta phi_1", "backlash of the involute stage, factors 1 to 3",
                                     "(2 * sin(pressure_angle) * (gear_runout + centre_distance_error)"
                                     " - base_tangent_error) / (sun_radius * total_ratio)", EQUATION_21)  # fmt: skip
    gap_ground: Float = found("um", "Delta beta_g", "gap of both flanks by grinding, factors 4, 5, 12 and 13",
                              "2 * (equidistant_modification + equidistant_error) - 2 * root"
                              " * (shift_modification + shift_error)", EQUATION_21)  # fmt: skip
    gap_pins: Float = found("um", "Delta beta_p", "gap by pins and holes, factors 6, 7, 8 and 10",
                            "2 * root * pin_circle_error - 2 * pin_radius_error + pin_fit_clearance + 2 * short_width"
                            " * pin_position_error - runout_gap", EQUATION_21)  # fmt: skip
    gap_disc: Float = found("um", "Delta beta_d", "gap by toothing and crank, factors 9, 11 and 14",
                            "disc_runout / 2 - short_width * disc_pitch_error + 2 * root * 1.6e-4 * eccentricity_error",
                            EQUATION_21)  # fmt: skip
    backlash_gearing: Float = found("arcmin", "Delta phi_2", "backlash of disc and pins as made",
                                    "(gap_ground + gap_pins + gap_disc) / (eccentricity * (pin_count - 1))",
                                    EQUATION_21)  # fmt: skip
    backlash_of_wear: Float = found("arcmin", "Delta phi_3", "backlash of wear, factor 15",
                                    "2 * backlash_wear / (eccentricity * (pin_count - 1))", EQUATION_21)  # fmt: skip
    backlash_bearing: Float = found("arcmin", "Delta phi_4", "backlash of the crank bearings, factor 16",
                                    "bearing_clearance / centre_distance", EQUATION_21)  # fmt: skip
    backlash: Float = found("arcmin", "Delta phi", "backlash at the output",
                            "backlash_involute + backlash_gearing + backlash_of_wear + backlash_bearing",
                            EQUATION_21)  # fmt: skip
