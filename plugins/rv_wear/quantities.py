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


def own_error(value: float, symbol: str, note: str, source: str) -> Any:
    """Declare how single parts differ, as a standard deviation; below 50 um the exact play is exact."""
    return given(value, "um", symbol=symbol, note=note, source=source, at_least=0, at_most=50)


def off_centre(symbol: str, note: str) -> Any:
    """Declare one part of an offset that the exact play reads; equation 21 has ``runout_gap`` for it."""
    return given(0.0, "um", symbol=symbol, note=f"neutral 0: {note}", at_least=-50, at_most=50)


@inputs
class Reducer:
    """Gearing, load and lubricant, the sixteen error factors, and what is asked of the backlash."""

    # The gearing
    pin_count: int = given(40, symbol="z_p", note="pins; the disc has one tooth less", source=INDICES, at_least=4)
    pin_circle_radius: Float = length(114.5, "mm", "r_p", "radius of the circle of the pin centres", INDICES)
    pin_radius: Float = length(5.0, "mm", "r_rp", "radius of the pins", CATALOGUE)
    eccentricity: Float = length(2.2, "mm", "e", "throw of the crank", INDICES)
    disc_width: Float = length(20.0, "mm", "B", "loaded width of one disc", CATALOGUE)
    equidistant_modification: Float = given(-26.0, "um", symbol="Delta r_rp",
                                            note="grinding with another pin radius; above 0 the tooth becomes thinner",
                                            source=PAPER, at_least=-LARGEST, at_most=LARGEST)  # fmt: skip
    shift_modification: Float = given(-30.0, "um", symbol="Delta r_p",
                                      note="grinding on another pin circle; below 0 the tooth becomes thinner",
                                      source=PAPER, at_least=-LARGEST, at_most=LARGEST)  # fmt: skip
    sun_radius: Float = length(18.0, "mm", "r_1", "pitch circle of the sun gear", INDICES)
    centre_distance: Float = length(63.0, "mm", "a", "sun to planet, and circle of the cranks", INDICES)
    total_ratio: Float = given(101.0, "", symbol="i_H", note="input turns per output turn", source=INDICES, above=1)
    pressure_angle: Float = given(20.0, "deg", symbol="alpha_n", note="pressure angle of the involute gears",
                                  source=INDICES, above=0, below=45)  # fmt: skip
    # Load and material
    output_torque: Float = given(3136.0, "N*m", symbol="T_z", note="torque at the output", source=PAPER, above=0)
    output_speed: Float = given(15.0, "r/min", symbol="n", note="speed of the output", source=PAPER, above=0)
    working_time: Float = given(6000.0, "h", symbol="T", source=PAPER, at_least=0, role="goes_on",
                                note="working time of this set of discs; rated life 6000 h")  # fmt: skip
    reversing: Float = given(
        None, "", symbol="f_r", at_least=0, at_most=1,
        note="0: the load is always on the same flank, 1: both flanks share the working time evenly; without it each "
        "flank is loaded in all of it, as the paper counts",
    )  # fmt: skip
    torque_share: Float = given(0.55, "", symbol="kappa_T", note="share of the output torque on the worse of two discs",
                                source="Chinese practice for cycloid drives", above=0, at_most=1)  # fmt: skip
    young_modulus: Float = given(2.06e5, "MPa", symbol="E", note="modulus of steel", source="literature", above=0)
    poisson_ratio: Float = given(0.3, "", symbol="nu", note="Poisson ratio of steel", source="literature", at_least=0,
                                 below=0.5)  # fmt: skip
    pressure_viscosity: Float = given(2.2e-8, "1/Pa", symbol="alpha", note="pressure viscosity of the base oil",
                                      source="mineral oil 1.5e-8 to 2.4e-8", above=0)  # fmt: skip
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
    reconstruction_depth: Float = given(
        0.05, "um", symbol="epsilon", note="new wear after which forces are found again",
        source="0.4 % from convergence", above=0, below=LARGEST, halving=HALVING, halving_but=SAMPLED,
    )  # fmt: skip
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
    runout_gap: Float = given(0.0, "um", symbol="delta_R", at_least=-LARGEST, at_most=LARGEST,
                              note="neutral 0: gap of both flanks that runout takes where it is read")  # fmt: skip
    # What is each part's own: read by the study of the exact play
    pin_position_spread: Float = own_error(0.6, "sigma_t", "scatter of the place of a single pin, both ways",
                                           "one worst error is printed")  # fmt: skip
    pin_radius_spread: Float = own_error(
        0.17, "sigma_rrp", "scatter of the radius of a single pin", "a sixth of zone 7"
    )
    tooth_pitch_spread: Float = own_error(0.33, "sigma_pc", "scatter of the place of a single tooth, at the pin circle",
                                          "a sixth of zone 11")  # fmt: skip
    disc_phase_error: Float = given(0.0, "arcmin", symbol="delta_phi", at_least=-600, at_most=600,
                                    note="crank of the second disc ahead of half a turn")  # fmt: skip
    pin_circle_x: Float = off_centre("x_p", "circle of the pins off the axis of the output, along crank angle 0")
    pin_circle_y: Float = off_centre("y_p", "circle of the pins off the axis of the output, along crank angle 90 deg")
    toothing_x: Float = off_centre("x_c", "toothing off the centre of its disc, mean of both, along output angle 0")
    toothing_y: Float = off_centre("y_c", "toothing off the centre of its disc, mean of both, 90 deg from there")
    # What is asked
    permitted_backlash: Float = given(1.0, "arcmin", symbol="Delta phi_per", note="permitted backlash", source=PAPER,
                                      above=0)  # fmt: skip
    required_reliability: Float = given(0.95, "", symbol="R_per",
                                        note="share of machines within it; the paper's 100 % is read as 0.999",
                                        source=PAPER, above=0, at_most=1)  # fmt: skip
    permitted_pressure: Float = given(2000.0, "MPa", symbol="p_per", note="mean contact pressure up to which it holds",
                                      source="elastic contact of hardened steel", above=0)  # fmt: skip
    design_clearance: Float = given(
        4.0, "um", symbol="Delta r_0", note="radial clearance that an optimisation of the modifications keeps",
        source="difference of the paper's two modifications", at_least=0, at_most=LARGEST,
    )  # fmt: skip
    cost_form: Literal["power", "exponential", "process"] = given(
        "power", note="reading of the paper's lost cost functions; only power gives its total of 1402 yuan"
    )
    # Neutral inputs: effects reach the calculation through them
    wear_rate_factor: Float = given(1.0, "", symbol="f_k", note="neutral 1: multiplies the wear coefficient", above=0)
    sliding_factor: Float = given(1.0, "", symbol="f_s", note="neutral 1: share of the sliding that is left",
                                  at_least=0)  # fmt: skip
    ageing_rate: Float = given(0.0, "1/h", symbol="a_L", note="neutral 0: growth of the wear coefficient with time",
                               at_least=0)  # fmt: skip
    film_factor: Float = given(0.0, "", symbol="f_Lambda", note="neutral 0: film thickness over that of Dowson",
                               at_least=0)  # fmt: skip
    oil_viscosity: Float = given(0.2, "Pa*s", symbol="eta", note="of the base oil at work; acts only with a film",
                                 above=0)  # fmt: skip
    depth_factor: Float = given(1.0, "", symbol="f_h", note="neutral 1: multiplies the wear depth", at_least=0)
    extra_wear: Float = given(0.0, "um", symbol="h_0", note="neutral 0: depth lost beside the law of wear",
                              at_least=-LARGEST, at_most=LARGEST)  # fmt: skip
    loaded_share: Float = given(
        1.0, "", symbol="f_T", at_least=0, at_most=1,
        note="neutral 1: share of the working time in which either flank is loaded; acts without reversing",
    )  # fmt: skip
    lost_motion_share: Float = given(1.0, "", symbol="kappa_w",
                                     note="neutral 1: share of the largest wear that is felt", at_least=0)  # fmt: skip
    pin_wear_ratio: Float = given(0.0, "", symbol="kappa_p", note="neutral 0: wear of the pins over that of the disc",
                                  at_least=0)  # fmt: skip


# What the reducer calculation answers for every machine; what is known once per run comes from studies

EQUATION_21 = "equation 21 and Table 2 of the paper"


@results
class Wear:
    """Forces between disc and pins, wear of the disc, and the backlash at the output with its four shares."""

    short_width: Float = found("", symbol="K_1", note="short-width coefficient of the cycloid",
                               formula="eccentricity * pin_count / pin_circle_radius")  # fmt: skip
    root: Float = found("", symbol="q", note="sine of the phase angle of the longest arm",
                        formula="sqrt(1 - short_width**2)")  # fmt: skip
    radial_clearance: Float = found("um", symbol="Delta r", note="gap between disc and pins all around",
                                    formula="equidistant_modification - shift_modification")  # fmt: skip
    equidistant_high: Float = found("um", symbol="Delta r_rp,max", note="above it disc and pins interfere",
                                    formula="radial_clearance / (1 - root)", source="equation 17")  # fmt: skip
    equidistant_low: Float = found("um", symbol="Delta r_rp,min", source="equation 17",
                                   note="below it the disc has more than twice the radial clearance somewhere",
                                   method="largest clearance over the phase angle")  # fmt: skip
    disc_torque: Float = found("N*m", symbol="T_c", note="torque on the worse of the two discs",
                               formula="torque_share * output_torque")  # fmt: skip
    start_force: Float = found("N", symbol="F_max,0", note="largest force without any clearance",
                               formula="4 * disc_torque / (short_width * (pin_count - 1) * pin_circle_radius)",
                               source="equation 1")  # fmt: skip
    max_force: Float = found("N", symbol="F_max", note="force at the longest arm, unworn, the worst position",
                             method="torque balance of all loaded pins, equations 1b to 4", key=True)  # fmt: skip
    approach: Float = found("um", symbol="delta_max", note="approach of disc and pin under that force",
                            method="line contact, equation 1b")  # fmt: skip
    largest_force: Float = found("N", symbol="F_i", note="largest force on a pin, unworn", method="equation 2")
    loaded_pins: Float = found("", symbol="N_p", note="most pins loaded at once, unworn", method="equation 2", digits=3)
    max_pressure: Float = found("MPa", symbol="p_i", note="largest mean contact pressure, unworn",
                                method="equation 5: force over the area of the contact")  # fmt: skip
    mesh_period: Float = found("s", symbol="t", note="time in which every tooth meshes once",
                               formula="1 / (output_speed * pin_count)", source="equation 14")  # fmt: skip
    coefficient: Float = found("1/Pa", symbol="k", note="wear coefficient at the longest arm, unworn",
                               method="regression of Janakiraman, Li and Kahraman, equations 9 and 10")  # fmt: skip
    max_wear: Float = found("um", symbol="h_max", note="deepest wear, of the flank that is loaded longer",
                            method="equations 13 to 16: wear, new profile, new forces, step by step",
                            key=True)  # fmt: skip
    wear_angle: Float = found("deg", symbol="psi_h", note="phase angle of the deepest wear", method="as the wear")
    backlash_wear: Float = found("um", symbol="h_phi", note="wear that is felt at a flank as lost motion",
                                 method="deepest wear, mean of both flanks, with the shares of the inputs")  # fmt: skip
    backlash_involute: Float = found(
        "arcmin", symbol="Delta phi_1", note="backlash of the involute stage, factors 1 to 3", source=EQUATION_21,
        formula="(2 * sin(pressure_angle) * (gear_runout + centre_distance_error) - base_tangent_error)"
        " / (sun_radius * total_ratio)",
    )  # fmt: skip
    gap_ground: Float = found(
        "um", symbol="Delta beta_g", note="gap of both flanks by grinding, factors 4, 5, 12 and 13", source=EQUATION_21,
        formula="2 * (equidistant_modification + equidistant_error) - 2 * root * (shift_modification + shift_error)",
    )  # fmt: skip
    gap_pins: Float = found("um", symbol="Delta beta_p", note="gap by pins and holes, factors 6, 7, 8 and 10",
                            source=EQUATION_21,
                            formula="2 * root * pin_circle_error - 2 * pin_radius_error + pin_fit_clearance"
                                    " + 2 * short_width * pin_position_error - runout_gap")  # fmt: skip
    gap_disc: Float = found(
        "um", symbol="Delta beta_d", note="gap by toothing and crank, factors 9, 11 and 14", source=EQUATION_21,
        formula="disc_runout / 2 - short_width * disc_pitch_error + 2 * root * 1.6e-4 * eccentricity_error",
    )  # fmt: skip
    backlash_gearing: Float = found(
        "arcmin", symbol="Delta phi_2", note="backlash of disc and pins as made", source=EQUATION_21,
        formula="(gap_ground + gap_pins + gap_disc) / (eccentricity * (pin_count - 1))",
    )  # fmt: skip
    backlash_of_wear: Float = found(
        "arcmin", symbol="Delta phi_3", note="backlash of wear, factor 15", source=EQUATION_21,
        formula="2 * backlash_wear / (eccentricity * (pin_count - 1))",
    )  # fmt: skip
    backlash_bearing: Float = found("arcmin", symbol="Delta phi_4", note="backlash of the crank bearings, factor 16",
                                    source=EQUATION_21, formula="bearing_clearance / centre_distance")  # fmt: skip
    backlash: Float = found(
        "arcmin", symbol="Delta phi", note="backlash at the output", source=EQUATION_21,
        formula="backlash_involute + backlash_gearing + backlash_of_wear + backlash_bearing", key=True,
    )  # fmt: skip
