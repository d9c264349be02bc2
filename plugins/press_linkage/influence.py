"""How errors reach the slider: the nominal position link by link, the influence of each error, and what scatters."""

from truing import Float, found, results

CLOSED_FORM = "closed form of the loop increments"
KEPT = "first-order variances of the sources, by the sensitivity study"


@results
class Influence:
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
    knee_across: Float = found(
        "", symbol="q", note="knee G beside the line from B5 to M, as a share of d",
        formula="sqrt((knee_drive_length / ground_distance)**2 - knee_along**2)",
    )  # fmt: skip
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
    drive_direction: Float = found(
        "deg", symbol="theta_17", note="knee drive, B5 to G",
        formula="atan2(knee_z - platform_height - platform_arm, knee_y)",
    )  # fmt: skip
    upper_direction: Float = found(
        "deg", symbol="theta_19", note="upper knee link, M to G",
        formula="atan2(knee_z - ground_pivot_radius * sin(ground_pivot_angle), "
        "knee_y - ground_pivot_radius * cos(ground_pivot_angle))",
    )  # fmt: skip
    lower_direction: Float = found(
        "deg", symbol="theta_18", note="lower knee link, G to H",
        formula="acos((slider_half_width - knee_y) / lower_knee_length)",
    )  # fmt: skip
    nominal_position: Float = found(
        "mm", digits=7, symbol="z_2,0", note="slider of the nominal mechanism",
        formula="knee_z + lower_knee_length * sin(lower_direction)",
    )  # fmt: skip
    slider_shift: Float = found(
        "um", symbol="Delta S", note="slider moved by the deviations and effects in force",
        formula="slider_position - nominal_position",
    )  # fmt: skip
    influence_lower_knee_length: Float = found(
        "", symbol="xi_lh", note="lower knee link", formula="1 / sin(lower_direction)", source=CLOSED_FORM
    )
    influence_upper_knee_length: Float = found(
        "", symbol="xi_lm", note="upper knee link", source=CLOSED_FORM,
        formula="sin(lower_direction - drive_direction) / "
        "(sin(lower_direction) * sin(upper_direction - drive_direction))",
    )  # fmt: skip
    influence_knee_drive_length: Float = found(
        "", symbol="xi_lg", note="knee drive", source=CLOSED_FORM,
        formula="sin(upper_direction - lower_direction) / "
        "(sin(lower_direction) * sin(upper_direction - drive_direction))",
    )  # fmt: skip
    influence_slider_half_width: Float = found(
        "", symbol="xi_l", note="slider joint, along", formula="-cot(lower_direction)", source=CLOSED_FORM
    )
    influence_slider_joint_angle: Float = found(
        "m/rad", symbol="xi_beta 2", note="slider joint, across", formula="-slider_half_width", source=CLOSED_FORM
    )
    influence_ground_pivot_radius: Float = found(
        "", symbol="xi_rM", note="ground joint, along", source=CLOSED_FORM,
        formula="influence_upper_knee_length * cos(ground_pivot_angle - upper_direction)",
    )  # fmt: skip
    influence_ground_pivot_angle: Float = found(
        "m/rad", symbol="xi_alpha 2", note="ground joint, across", source=CLOSED_FORM,
        formula="-influence_upper_knee_length * ground_pivot_radius * sin(ground_pivot_angle - upper_direction)",
    )  # fmt: skip
    influence_platform_arm: Float = found(
        "", symbol="xi_k", note="platform arm; also the slider's travel per travel of the platform", source=CLOSED_FORM,
        formula="influence_knee_drive_length * sin(drive_direction)",
    )  # fmt: skip
    influence_rod_length: Float = found(
        "", symbol="xi_kR", note="connecting rod", source=CLOSED_FORM,
        formula="influence_platform_arm / sin(rod_direction)",
    )  # fmt: skip
    influence_crank_radius: Float = found(
        "", symbol="xi_a", note="crank", source=CLOSED_FORM,
        formula="influence_rod_length * cos(crank_direction - rod_direction)",
    )  # fmt: skip
    influence_crank_angle: Float = found(
        "m/rad", symbol="xi_theta 1", note="crank angle", source=CLOSED_FORM,
        formula="-influence_rod_length * crank_radius * sin(crank_direction - rod_direction)",
    )  # fmt: skip
    influence_crank_pivot_radius: Float = found(
        "", symbol="xi_rA", note="crank pivot, along", source=CLOSED_FORM,
        formula="influence_rod_length * cos(rod_direction)",
    )  # fmt: skip
    influence_crank_pivot_angle: Float = found(
        "m/rad", symbol="xi_alpha 1", note="crank pivot, across", source=CLOSED_FORM,
        formula="influence_rod_length * crank_pivot_radius * sin(rod_direction)",
    )  # fmt: skip
    influence_platform_half_width: Float = found(
        "", symbol="xi_e", note="rod joint on the platform, along", source=CLOSED_FORM,
        formula="-influence_rod_length * cos(rod_direction)",
    )  # fmt: skip
    influence_platform_joint_angle: Float = found(
        "m/rad", symbol="xi_beta 1", note="rod joint on the platform, across", source=CLOSED_FORM,
        formula="-influence_rod_length * platform_half_width * sin(rod_direction)",
    )  # fmt: skip
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
        formula="sqrt(variance_links + variance_joints_along + variance_joints_across + variance_other)",
    )  # fmt: skip
    tilt_sd: Float = found(
        "urad", symbol="sigma_theta", note="standard deviation of the slider tilt", source="Eq. (12), reconstructed",
        method="root of the sum of (derivative times standard deviation) squared over all sources",
    )  # fmt: skip
