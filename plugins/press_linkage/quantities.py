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
class Mechanism:
    """The nominal sizes of one side; the other is its mirror image."""

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
    ground_pivot_angle: Float = given(0.367, "rad", symbol="alpha_2", note="direction of M, from horizontal downward",
                                      source=MISPRINT, above=-1.57, below=1.57)  # fmt: skip


@inputs
class Press(Mechanism):
    """The nominal mechanism, its deviations, and what is asked of the slider."""

    crank_angle: Float = given(0.0, "deg", symbol="phi", role="set",
                               note="crank from the bottom dead centre, growing with theta_11",
                               source="the paper works at the bottom dead centre")  # fmt: skip
    position_limit: Float = given(0.02, "mm", symbol="L_S", note="permitted error of the slider position",
                                  source="the paper, text after Table 3", above=0)  # fmt: skip
    tilt_limit: Float = given(
        None, "deg", symbol="L_theta", note="permitted tilt of the slider; without it the reading decides",
        source="the paper prints 0.0013 rad and computes with 0.0013 degree", above=0,
    )  # fmt: skip
    position_goal: Float = given(0.88, "", symbol="G_S",
                                 note="probability that the position error stays within its limit",
                                 source="the paper, text after Table 3", above=0, below=1)  # fmt: skip
    tilt_goal: Float = given(0.95, "", symbol="G_theta", note="probability that the tilt stays within its limit",
                             source="the paper, text after Table 3", above=0, below=1)  # fmt: skip
    slider_mass: Float = given(
        0.0, "t", symbol="m_S", note="of the slider with what hangs on it; 0 beside a counterbalance of 0: balanced; "
        "acts with effects only", source="not in the paper", at_least=0, below=10000,
    )  # fmt: skip
    counterbalance: Float = given(0.0, "kN", symbol="F_C",
                                  note="force that lifts the slider, of air cylinders or springs; acts with effects "
                                       "only", source="not in the paper", at_least=0, below=100000)  # fmt: skip
    reading: Literal["complete", "printed"] = given(
        "complete",
        note="complete: every installation error in force; printed: what the paper's printed reliabilities contain",
    )
    platform_arm_deviation: Float = off("mm", "k", "arm of the moving platform, common to both sides")
    side_1: PressSide = part(PressSide, index="1", suffix="1")
    side_2: PressSide = part(PressSide, index="2", suffix="2")


@results
class Slider:
    """Where the slider is, exactly, with every deviation present."""

    face_height_1: Float = found("mm", digits=7, symbol="z_F1", note="slider face over joint H1",
                                 method="exact position, loops I to III")  # fmt: skip
    face_height_2: Float = found("mm", digits=7, symbol="z_F2", note="slider face over joint H2",
                                 method="exact position, loops IV to VI")  # fmt: skip
    slider_position: Float = found(
        "mm", digits=7, symbol="z_2", note="slider height, downward from O",
        formula="(face_height_1 + face_height_2) / 2",
        source="Eq. (7), reconstructed", key=True,
    )  # fmt: skip
    slider_tilt: Float = found("urad", symbol="theta", note="slider tilt, positive with side 1 lower",
                               formula="(face_height_1 - face_height_2) / (2 * slider_half_width)",
                               source="Eq. (8), reconstructed", key=True)  # fmt: skip
    permitted_tilt: Float = found(
        "deg", symbol="L_theta", note="permitted tilt in force",
        method="tilt_limit where it is given; otherwise 0.0013 degree (complete) or 0.001324 degree (printed)",
    )  # fmt: skip


@results
class Cycle:
    """What one turn of the crank shows."""

    bdc_direction: Float = found(
        "deg", symbol="theta_11,B", note="crank and rod stretched in line",
        formula="acos((platform_half_width - crank_pivot_radius) / (crank_radius + rod_length))",
    )  # fmt: skip
    bdc_platform_height: Float = found(
        "m", digits=7, symbol="z_1,B", note="platform at the bottom dead centre",
        formula="sqrt((crank_radius + rod_length)**2 - (crank_pivot_radius - platform_half_width)**2)",
    )  # fmt: skip
    tdc_crank_angle: Float = found(
        "deg", symbol="phi_T", note="crank angle of the top dead centre, crank and rod folded",
        formula="-acos((crank_pivot_radius - platform_half_width) / (rod_length - crank_radius)) - bdc_direction",
    )  # fmt: skip
    bdc_position: Float = found("mm", digits=7, symbol="z_2,B", note="slider at the bottom dead centre",
                                method="exact position at crank angle 0")  # fmt: skip
    tdc_position: Float = found("mm", digits=7, symbol="z_2,T", note="slider at the top dead centre",
                                method="exact position at the angle above")  # fmt: skip
    stroke: Float = found("mm", digits=7, symbol="H", note="stroke of the slider",
                          formula="bdc_position - tdc_position", key=True)  # fmt: skip
    smallest_sine: Float = found(
        "", symbol="s_min", note="closest approach to a singular position over the turn (0 is singular)",
        method="least of the sines of theta_21, theta_18 and theta_19 - theta_17, both sides",
    )  # fmt: skip


@results
class PressChances:
    """Both reliabilities with the tolerances as they are, first order as in the paper."""

    position_offset: Float = found(
        "um", symbol="c_S", note="slider out of the middle of its limits",
        method="position of this press less that of the nominal mechanism; by stated deviations and effects",
    )  # fmt: skip
    tilt_offset: Float = found("urad", symbol="c_theta", note="tilt out of the middle of its limits",
                               method="tilt of this press; by stated deviations and effects")  # fmt: skip
    position_reliability: Float = found("", symbol="R_S", note="chance that the position error stays within its limit",
                                        formula="Phi((position_limit - position_offset) / position_sd) - "
                                                "Phi((-position_limit - position_offset) / position_sd)",
                                                key=True)  # fmt: skip
    tilt_reliability: Float = found(
        "", symbol="R_theta", note="chance that the tilt stays within its limit",
        formula="Phi((permitted_tilt - tilt_offset) / tilt_sd) - Phi((-permitted_tilt - tilt_offset) / tilt_sd)",
        key=True,
    )  # fmt: skip


@results
class Synthesis:
    """What tightening grade by grade reaches."""

    adjustments: Float = found("", symbol="n", note="adjustments made, each one grade of one link", method="the rule")
    position_reliability_final: Float = found("", symbol="R_S'", note="position reliability with the tightened links",
                                              method="first order, as above", key=True)  # fmt: skip
    tilt_reliability_final: Float = found("", symbol="R_theta'", note="tilt reliability with the tightened links",
                                          method="first order, as above", key=True)  # fmt: skip
    coefficient_lower_knee_length: Float = found("", symbol="r_lh", note="lower knee link", source=ORDER)
    coefficient_upper_knee_length: Float = found("", symbol="r_lm", note="upper knee link", source=ORDER)
    coefficient_knee_drive_length: Float = found("", symbol="r_lg", note="knee drive", source=ORDER)
    coefficient_rod_length: Float = found("", symbol="r_kR", note="connecting rod", source=ORDER)
    coefficient_crank_radius: Float = found("", symbol="r_a", note="crank", source=ORDER)
    coefficient_platform_arm: Float = found("", symbol="r_k", note="platform arm", source=ORDER)


# How errors reach the slider: the nominal position link by link, the influence of each error, and what scatters

CLOSED_FORM = "closed form of the loop increments"
KEPT = "first-order variances of the sources, by the sensitivity study"


def influence_of(symbol: str, note: str, formula: str, unit: Literal["", "m/rad"] = "") -> Any:
    """Declare the change of a slider face by one error of its side."""
    return found(unit, symbol=f"xi_{symbol}", note=note, formula=formula, source=CLOSED_FORM)


@results
class ErrorInfluence:
    """One nominal side, angle by angle, with the influence of its errors; then salience and scatter of both sides."""

    crank_direction: Float = found(
        "deg", symbol="theta_11", note="crank, A to B",
        formula="acos((platform_half_width - crank_pivot_radius) / (crank_radius + rod_length)) + crank_angle",
    )  # fmt: skip
    platform_height: Float = found(
        "m", digits=7, symbol="z_1", note="platform centre O1",
        formula="crank_radius * sin(crank_direction) + sqrt(rod_length**2 - "
        "(platform_half_width - crank_pivot_radius - crank_radius * cos(crank_direction))**2)",
    )  # fmt: skip
    rod_direction: Float = found(
        "deg", symbol="theta_21", note="connecting rod, B to E",
        formula="atan2(platform_height - crank_radius * sin(crank_direction), "
        "platform_half_width - crank_pivot_radius - crank_radius * cos(crank_direction))",
    )  # fmt: skip
    ground_distance: Float = found(
        "m", digits=7, symbol="d", note="end of the platform arm B5 to ground joint M",
        formula="hypot(ground_pivot_radius * cos(ground_pivot_angle), "
        "ground_pivot_radius * sin(ground_pivot_angle) - platform_height - platform_arm)",
    )  # fmt: skip
    knee_along: Float = found(
        "", symbol="t", note="knee G from B5 toward M, as a share of d",
        formula="1 / 2 + (knee_drive_length**2 - upper_knee_length**2) / (2 * ground_distance**2)",
    )  # fmt: skip
    knee_across: Float = found("", symbol="q", note="knee G beside the line from B5 to M, as a share of d",
                               formula="sqrt((knee_drive_length / ground_distance)**2 - knee_along**2)")  # fmt: skip
    knee_y: Float = found(
        "m", digits=7, symbol="y_G", note="knee G, outward",
        formula="ground_pivot_radius * cos(ground_pivot_angle) * knee_along - "
        "(ground_pivot_radius * sin(ground_pivot_angle) - platform_height - platform_arm) * knee_across",
    )  # fmt: skip
    knee_z: Float = found(
        "m", digits=7, symbol="z_G", note="knee G, downward",
        formula="platform_height + platform_arm + "
        "(ground_pivot_radius * sin(ground_pivot_angle) - platform_height - platform_arm) * knee_along + "
        "ground_pivot_radius * cos(ground_pivot_angle) * knee_across",
    )  # fmt: skip
    drive_direction: Float = found("deg", symbol="theta_17", note="knee drive, B5 to G",
                                   formula="atan2(knee_z - platform_height - platform_arm, knee_y)")  # fmt: skip
    upper_direction: Float = found("deg", symbol="theta_19", note="upper knee link, M to G",
                                   formula="atan2(knee_z - ground_pivot_radius * sin(ground_pivot_angle), "
                                           "knee_y - ground_pivot_radius * cos(ground_pivot_angle))")  # fmt: skip
    lower_direction: Float = found("deg", symbol="theta_18", note="lower knee link, G to H",
                                   formula="acos((slider_half_width - knee_y) / lower_knee_length)")  # fmt: skip
    nominal_position: Float = found("mm", digits=7, symbol="z_2,0", note="slider of the nominal mechanism",
                                    formula="knee_z + lower_knee_length * sin(lower_direction)")  # fmt: skip
    slider_shift: Float = found("um", symbol="Delta S", note="slider moved by the deviations and effects in force",
                                formula="slider_position - nominal_position")  # fmt: skip
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
        "", symbol="D_S", note="salience of the twelve key errors of position",
        method="their share in the sum of all sensitivities, lengths in m and angles in rad", source="Eq. (10), Fig. 2",
    )  # fmt: skip
    salience_tilt_key: Float = found(
        "", symbol="D_theta", note="salience of the ten key errors of tilt",
        method="their share in the sum of the passive sensitivities, lengths in m and angles in rad",
        source="Eq. (10), Fig. 3",
    )  # fmt: skip
    variance_links: Float = found("um^2", symbol="V_L", note="variance of position from link lengths", method=KEPT)
    variance_joints_along: Float = found(
        "um^2", symbol="V_R", note="variance of position from joints misplaced along their radius", method=KEPT
    )
    variance_joints_across: Float = found(
        "um^2", symbol="V_T", note="variance of position from joints misplaced across their radius", method=KEPT
    )
    variance_other: Float = found(
        "um^2", symbol="V_O", note="variance of position from the crank drive and from effects", method=KEPT
    )
    position_sd: Float = found(
        "um", symbol="sigma_S", note="standard deviation of the slider position", source="Eq. (11), reconstructed",
        formula="sqrt(variance_links + variance_joints_along + variance_joints_across + variance_other)", key=True,
    )  # fmt: skip
    tilt_sd: Float = found(
        "urad", symbol="sigma_theta", note="standard deviation of the slider tilt", source="Eq. (12), reconstructed",
        method="root of the sum of (derivative times standard deviation) squared over all sources", key=True,
    )  # fmt: skip
