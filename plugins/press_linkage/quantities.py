"""What the press linkage is told and what it answers: every quantity with unit, symbol, bounds and source."""

from typing import Any, Literal

from truing import Float, found, given, inputs, part, results

GIVEN = "section 2.2 of the paper"
MISPRINT = (
    "chosen so that the paper's printed results follow; the printed 0.117 rad does not describe the mechanism that the "
    "paper computed"
)
ORDER = "Table 4; the formula is reconstructed from its numbers"
LARGEST = 30.0  # m: no press is larger, so a length above it was meant in another unit
FARTHEST = 10.0  # mm and mrad: beyond it a part is not off its size, it is another part


def size(value: float, symbol: str, note: str, source: str = GIVEN) -> Any:
    """Declare a nominal length of the mechanism."""
    return given(value, "m", symbol=symbol, note=note, source=source, above=0, below=LARGEST)


def off(unit: Literal["mm", "mrad"], symbol: str, note: str) -> Any:
    """Declare a deviation of one side."""
    note = f"deviation: {note}"
    return given(0.0, unit, symbol=f"delta {symbol}", note=note, at_least=-FARTHEST, at_most=FARTHEST)


@inputs
class PressSide:
    """How far one side is off: lengths grow; joint angles are polar angles of the frame on both sides."""

    crank_radius_deviation: Float = off("mm", "a", "crank, A to B")
    rod_length_deviation: Float = off("mm", "k_R", "connecting rod, B to E")
    knee_drive_length_deviation: Float = off("mm", "l_g", "knee drive, B5 to G")
    upper_knee_length_deviation: Float = off("mm", "l_m", "upper knee link, M to G")
    lower_knee_length_deviation: Float = off("mm", "l_h", "lower knee link, G to H")
    slider_half_width_deviation: Float = off("mm", "l", "joint H along the slider")
    slider_joint_angle_deviation: Float = off("mrad", "beta_2", "joint H across, as an angle seen from O2")
    crank_pivot_radius_deviation: Float = off("mm", "r_A", "crank pivot A away from O")
    crank_pivot_angle_deviation: Float = off("mrad", "alpha_1", "crank pivot A across, as an angle seen from O")
    platform_half_width_deviation: Float = off("mm", "e", "rod joint E along the platform")
    platform_joint_angle_deviation: Float = off("mrad", "beta_1", "rod joint E across, as an angle seen from O1")
    ground_pivot_radius_deviation: Float = off("mm", "r_M", "ground joint M away from O")
    ground_pivot_angle_deviation: Float = off("mrad", "alpha_2", "ground joint M across, as an angle seen from O")
    crank_angle_deviation: Float = off("mrad", "theta_1", "crank ahead of its commanded angle")


@inputs
class Press:
    """The nominal mechanism, its deviations, and what is asked of the slider."""

    crank_radius: Float = size(0.36, "a", "crank, A to B")
    rod_length: Float = size(1.304, "k_R", "connecting rod, B to E")
    platform_arm: Float = size(0.6, "k", "arm of the moving platform, O1 down to B5")
    knee_drive_length: Float = size(0.868, "l_g", "knee drive, B5 to G")
    upper_knee_length: Float = size(1.7, "l_m", "upper knee link, M to G")
    lower_knee_length: Float = size(1.6, "l_h", "lower knee link, G to H")
    slider_half_width: Float = size(1.6, "l", "half the distance between the slider joints, O2 to H")
    crank_pivot_radius: Float = size(1.2, "r_A", "crank pivot, O to A")
    platform_half_width: Float = size(0.3, "e", "rod joint on the platform, O1 to E")
    ground_pivot_radius: Float = size(1.393, "r_M", "ground joint of the knee, O to M")
    ground_pivot_angle: Float = given(0.367, "rad", "alpha_2", "direction of M, from horizontal downward", MISPRINT,
                                      above=-1.57, below=1.57)  # fmt: skip
    crank_angle: Float = given(0.0, "deg", "phi", "crank from the bottom dead centre, growing with theta_11",
                               "the paper works at the bottom dead centre")  # fmt: skip
    position_limit: Float = given(0.02, "mm", "L_S", "permitted error of the slider position",
                                  "the paper, text after Table 3", above=0)  # fmt: skip
    tilt_limit: Float = given(None, "deg", "L_theta", "permitted tilt of the slider; without it the reading decides",
                              "the paper prints 0.0013 rad and computes with 0.0013 degree", above=0)  # fmt: skip
    position_goal: Float = given(0.88, "", "G_S", "probability that the position error stays within its limit",
                                 "the paper, text after Table 3", above=0, below=1)  # fmt: skip
    tilt_goal: Float = given(0.95, "", "G_theta", "probability that the tilt stays within its limit",
                             "the paper, text after Table 3", above=0, below=1)  # fmt: skip
    slider_mass: Float = given(0.0, "t", "m_S",
                               "of the slider with what hangs on it; 0 beside a counterbalance of 0: balanced; acts "
                               "with effects only", "not in the paper", at_least=0, below=10000)  # fmt: skip
    counterbalance: Float = given(0.0, "kN", "F_C",
                                  "force that lifts the slider, of air cylinders or springs; acts with effects only",
                                  "not in the paper", at_least=0, below=100000)  # fmt: skip
    reading: Literal["complete", "printed"] = given("complete",
                                                    note="complete: every installation error in force; printed: what "
                                                         "the paper's printed reliabilities contain")  # fmt: skip
    platform_arm_deviation: Float = off("mm", "k", "arm of the moving platform, common to both sides")
    side_1: PressSide = part(PressSide, index="1", suffix="1")
    side_2: PressSide = part(PressSide, index="2", suffix="2")


@results
class Slider:
    """Where the slider is, exactly, with every deviation present."""

    face_height_1: Float = found("mm", "z_F1", "slider face over joint H1", digits=7,
                                 method="exact position, loops I to III")  # fmt: skip
    face_height_2: Float = found("mm", "z_F2", "slider face over joint H2", digits=7,
                                 method="exact position, loops IV to VI")  # fmt: skip
    slider_position: Float = found("mm", "z_2", "slider height, downward from O", "(face_height_1 + face_height_2) / 2",
                                   "Eq. (7), reconstructed", digits=7)  # fmt: skip
    slider_tilt: Float = found("urad", "theta", "slider tilt, positive with side 1 lower",
                               "(face_height_1 - face_height_2) / (2 * slider_half_width)",
                               "Eq. (8), reconstructed")  # fmt: skip
    permitted_tilt: Float = found("deg", "L_theta", "permitted tilt in force",
                                  method="tilt_limit where it is given; otherwise 0.0013 degree (complete) or 0.001324 "
                                         "degree (printed)")  # fmt: skip


@results
class Cycle:
    """What one turn of the crank shows."""

    bdc_direction: Float = found("deg", "theta_11,B", "crank and rod stretched in line",
                                 "acos((platform_half_width - crank_pivot_radius)"
                                 " / (crank_radius + rod_length))")  # fmt: skip
    bdc_platform_height: Float = found("m", "z_1,B", "platform at the bottom dead centre",
                                       "sqrt((crank_radius + rod_length)**2"
                                       " - (crank_pivot_radius - platform_half_width)**2)", digits=7)  # fmt: skip
    tdc_crank_angle: Float = found("deg", "phi_T", "crank angle of the top dead centre, crank and rod folded",
                                   "-acos((crank_pivot_radius - platform_half_width) / (rod_length - crank_radius))"
                                   " - bdc_direction")  # fmt: skip
    bdc_position: Float = found("mm", "z_2,B", "slider at the bottom dead centre", digits=7,
                                method="exact position at crank angle 0")  # fmt: skip
    tdc_position: Float = found("mm", "z_2,T", "slider at the top dead centre", digits=7,
                                method="exact position at the angle above")  # fmt: skip
    stroke: Float = found("mm", "H", "stroke of the slider", "bdc_position - tdc_position", digits=7)
    smallest_sine: Float = found("", "s_min", "closest approach to a singular position over the turn (0 is singular)",
                                 method="least of the sines of theta_21, theta_18 and theta_19 - theta_17, both "
                                        "sides")  # fmt: skip


@results
class PressChances:
    """Both reliabilities with the tolerances as they are, first order as in the paper."""

    position_offset: Float = found("um", "c_S", "slider out of the middle of its limits",
                                   method="position of this press less that of the nominal mechanism; by stated "
                                          "deviations and effects")  # fmt: skip
    tilt_offset: Float = found("urad", "c_theta", "tilt out of the middle of its limits",
                               method="tilt of this press; by stated deviations and effects")  # fmt: skip
    position_reliability: Float = found("", "R_S", "chance that the position error stays within its limit",
                                        "Phi((position_limit - position_offset) / position_sd)"
                                        " - Phi((-position_limit - position_offset) / position_sd)")  # fmt: skip
    tilt_reliability: Float = found("", "R_theta", "chance that the tilt stays within its limit",
                                    "Phi((permitted_tilt - tilt_offset) / tilt_sd)"
                                    " - Phi((-permitted_tilt - tilt_offset) / tilt_sd)")  # fmt: skip


@results
class Synthesis:
    """What tightening grade by grade reaches."""

    adjustments: Float = found("", "n", "adjustments made, each one grade of one link", method="the rule")
    position_reliability_final: Float = found("", "R_S'", "position reliability with the tightened links",
                                              method="first order, as above")  # fmt: skip
    tilt_reliability_final: Float = found("", "R_theta'", "tilt reliability with the tightened links",
                                          method="first order, as above")  # fmt: skip
    coefficient_lower_knee_length: Float = found("", "r_lh", "lower knee link", source=ORDER)
    coefficient_upper_knee_length: Float = found("", "r_lm", "upper knee link", source=ORDER)
    coefficient_knee_drive_length: Float = found("", "r_lg", "knee drive", source=ORDER)
    coefficient_rod_length: Float = found("", "r_kR", "connecting rod", source=ORDER)
    coefficient_crank_radius: Float = found("", "r_a", "crank", source=ORDER)
    coefficient_platform_arm: Float = found("", "r_k", "platform arm", source=ORDER)


# How errors reach the slider: the nominal position link by link, the influence of each error, and what scatters

CLOSED_FORM = "closed form of the loop increments"
KEPT = "first-order variances of the sources, by the sensitivity study"


def influence_of(symbol: str, note: str, formula: str, unit: Literal["", "m/rad"] = "") -> Any:
    """Declare the change of a slider face by one error of its side."""
    return found(unit, symbol=f"xi_{symbol}", note=note, formula=formula, source=CLOSED_FORM)


@results
class ErrorInfluence:
    """One nominal side, angle by angle, with the influence of its errors; then salience and scatter of both sides."""

    crank_direction: Float = found("deg", "theta_11", "crank, A to B",
                                   "acos((platform_half_width - crank_pivot_radius) / (crank_radius + rod_length))"
                                   " + crank_angle")  # fmt: skip
    platform_height: Float = found("m", "z_1", "platform centre O1",
                                   "crank_radius * sin(crank_direction) + sqrt(rod_length**2 - (platform_half_width"
                                   " - crank_pivot_radius - crank_radius * cos(crank_direction))**2)",
                                   digits=7)  # fmt: skip
    rod_direction: Float = found("deg", "theta_21", "connecting rod, B to E",
                                 "atan2(platform_height - crank_radius * sin(crank_direction), platform_half_width"
                                 " - crank_pivot_radius - crank_radius * cos(crank_direction))")  # fmt: skip
    ground_distance: Float = found("m", "d", "end of the platform arm B5 to ground joint M",
                                   "hypot(ground_pivot_radius * cos(ground_pivot_angle), ground_pivot_radius"
                                   " * sin(ground_pivot_angle) - platform_height - platform_arm)",
                                   digits=7)  # fmt: skip
    knee_along: Float = found("", "t", "knee G from B5 toward M, as a share of d",
                              "1 / 2 + (knee_drive_length**2 - upper_knee_length**2)"
                              " / (2 * ground_distance**2)")  # fmt: skip
    knee_across: Float = found("", "q", "knee G beside the line from B5 to M, as a share of d",
                               "sqrt((knee_drive_length / ground_distance)**2 - knee_along**2)")  # fmt: skip
    knee_y: Float = found("m", "y_G", "knee G, outward",
                          "ground_pivot_radius * cos(ground_pivot_angle) * knee_along - (ground_pivot_radius"
                          " * sin(ground_pivot_angle) - platform_height - platform_arm) * knee_across",
                          digits=7)  # fmt: skip
    knee_z: Float = found("m", "z_G", "knee G, downward",
                          "platform_height + platform_arm + (ground_pivot_radius * sin(ground_pivot_angle)"
                          " - platform_height - platform_arm) * knee_along + ground_pivot_radius"
                          " * cos(ground_pivot_angle) * knee_across", digits=7)  # fmt: skip
    drive_direction: Float = found("deg", "theta_17", "knee drive, B5 to G",
                                   "atan2(knee_z - platform_height - platform_arm, knee_y)")  # fmt: skip
    upper_direction: Float = found("deg", "theta_19", "upper knee link, M to G",
                                   "atan2(knee_z - ground_pivot_radius * sin(ground_pivot_angle), knee_y"
                                   " - ground_pivot_radius * cos(ground_pivot_angle))")  # fmt: skip
    lower_direction: Float = found("deg", "theta_18", "lower knee link, G to H",
                                   "acos((slider_half_width - knee_y) / lower_knee_length)")  # fmt: skip
    nominal_position: Float = found("mm", "z_2,0", "slider of the nominal mechanism",
                                    "knee_z + lower_knee_length * sin(lower_direction)", digits=7)  # fmt: skip
    slider_shift: Float = found("um", "Delta S", "slider moved by the deviations and effects in force",
                                "slider_position - nominal_position")  # fmt: skip
    influence_lower_knee_length: Float = influence_of("lh", "lower knee link", "1 / sin(lower_direction)")
    influence_upper_knee_length: Float = influence_of("lm", "upper knee link",
                                                      "sin(lower_direction - drive_direction) / (sin(lower_direction)"
                                                      " * sin(upper_direction - drive_direction))")  # fmt: skip
    influence_knee_drive_length: Float = influence_of("lg", "knee drive",
                                                      "sin(upper_direction - lower_direction) / (sin(lower_direction)"
                                                      " * sin(upper_direction - drive_direction))")  # fmt: skip
    influence_slider_half_width: Float = influence_of("l", "slider joint, along", "-cot(lower_direction)")
    influence_slider_joint_angle: Float = influence_of("beta 2", "slider joint, across", "-slider_half_width", "m/rad")
    influence_ground_pivot_radius: Float = influence_of(
        "rM", "ground joint, along", "influence_upper_knee_length * cos(ground_pivot_angle - upper_direction)"
    )
    influence_ground_pivot_angle: Float = influence_of(
        "alpha 2", "ground joint, across",
        "-influence_upper_knee_length * ground_pivot_radius * sin(ground_pivot_angle - upper_direction)", "m/rad",
    )  # fmt: skip
    influence_platform_arm: Float = influence_of(
        "k", "platform arm; also the slider's travel per travel of the platform",
        "influence_knee_drive_length * sin(drive_direction)",
    )  # fmt: skip
    influence_rod_length: Float = influence_of("kR", "connecting rod", "influence_platform_arm / sin(rod_direction)")
    influence_crank_radius: Float = influence_of(
        "a", "crank", "influence_rod_length * cos(crank_direction - rod_direction)"
    )
    influence_crank_angle: Float = influence_of(
        "theta 1", "crank angle", "-influence_rod_length * crank_radius * sin(crank_direction - rod_direction)", "m/rad"
    )
    influence_crank_pivot_radius: Float = influence_of(
        "rA", "crank pivot, along", "influence_rod_length * cos(rod_direction)"
    )
    influence_crank_pivot_angle: Float = influence_of(
        "alpha 1", "crank pivot, across", "influence_rod_length * crank_pivot_radius * sin(rod_direction)", "m/rad"
    )
    influence_platform_half_width: Float = influence_of(
        "e", "rod joint on the platform, along", "-influence_rod_length * cos(rod_direction)"
    )
    influence_platform_joint_angle: Float = influence_of("beta 1", "rod joint on the platform, across",
                                                         "-influence_rod_length * platform_half_width"
                                                         " * sin(rod_direction)", "m/rad")  # fmt: skip
    salience_position_key: Float = found(
        "", "D_S", "salience of the twelve key errors of position", source="Eq. (10), Fig. 2",
        method="their share in the sum of all sensitivities, lengths in m and angles in rad",
    )  # fmt: skip
    salience_tilt_key: Float = found("", "D_theta", "salience of the ten key errors of tilt", source="Eq. (10), Fig. 3",
                                     method="their share in the sum of the passive sensitivities, lengths in m and "
                                            "angles in rad")  # fmt: skip
    variance_links: Float = found("um^2", "V_L", "variance of position from link lengths", method=KEPT)
    variance_joints_along: Float = found("um^2", "V_R", "variance of position from joints misplaced along their radius",
                                         method=KEPT)  # fmt: skip
    variance_joints_across: Float = found(
        "um^2", "V_T", "variance of position from joints misplaced across their radius", method=KEPT
    )
    variance_other: Float = found("um^2", "V_O", "variance of position from the crank drive and from effects",
                                  method=KEPT)  # fmt: skip
    position_sd: Float = found("um", "sigma_S", "standard deviation of the slider position",
                               "sqrt(variance_links + variance_joints_along + variance_joints_across + variance_other)",
                               "Eq. (11), reconstructed")  # fmt: skip
    tilt_sd: Float = found(
        "urad", "sigma_theta", "standard deviation of the slider tilt", source="Eq. (12), reconstructed",
        method="root of the sum of (derivative times standard deviation) squared over all sources",
    )  # fmt: skip
