"""What the reducer calculation answers for every machine; what is known once per run comes from studies."""

from truing import Float, found, results

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
                             method="torque balance of all loaded pins, equations 1b to 4")  # fmt: skip
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
                            method="equations 13 to 16: wear, new profile, new forces, step by step")  # fmt: skip
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
    gap_pins: Float = found(
        "um", symbol="Delta beta_p", note="gap by pins and holes, factors 6, 7, 8 and 10", source=EQUATION_21,
        formula="2 * root * pin_circle_error - 2 * pin_radius_error + pin_fit_clearance"
        " + 2 * short_width * pin_position_error - runout_gap",
    )  # fmt: skip
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
    backlash_bearing: Float = found(
        "arcmin", symbol="Delta phi_4", note="backlash of the crank bearings, factor 16", source=EQUATION_21,
        formula="bearing_clearance / centre_distance",
    )  # fmt: skip
    backlash: Float = found(
        "arcmin", symbol="Delta phi", note="backlash at the output", source=EQUATION_21,
        formula="backlash_involute + backlash_gearing + backlash_of_wear + backlash_bearing",
    )  # fmt: skip
