"""What the press under load is told and what it answers: every quantity with unit, symbol, bounds and source."""

from typing import Any

from press_linkage.motion_quantities import DrivenPress
from press_linkage.quantities import PressSide, off
from truing import Float, axis, found, given, inputs, part, results

DRAWING = "assumed; the paper gives no sections, stiffness or clearance"
CLASS = "assumed; state the value of the class that was ordered"
PRACTICE = (
    "trade practice for servo presses, 0.02 to 0.05 mm per 1000 mm (servopress.club, four-point measurement of slide "
    "parallelism), here 0.05 mm/m over the face; JIS B 6402 and ISO 6899 name the test, their values are not public"
)
BEDS = (
    "by analogy: GOST 7766-88, 2.7, permits 0.06 mm per 1000 mm for flatness and parallelism of the bolster plate; the "
    "same slope over the travel of the test"
)
STROKE = tuple(step / 24 for step in range(25))
"""Times of the working stroke at 12 rpm, s: from 60 degrees before the bottom dead centre to 12 after it."""


def size(value: float, unit: str, symbol: str, note: str, *, source: str = DRAWING, most: float = 1e5) -> Any:
    """Declare a number above 0."""
    return given(value, unit, symbol=symbol, note=note, source=source, above=0, at_most=most)


def slack(value: float, unit: str, symbol: str, note: str, *, most: float = 1e4) -> Any:
    """Declare a number that may be 0."""
    return given(value, unit, symbol=symbol, note=note, source=DRAWING, at_least=0, at_most=most)


@inputs
class LoadedPress(DrivenPress):
    """The press in motion with what gives way in it, its play, its temperature, and the errors of its parts."""

    times: Float = given(STROKE, "s", symbol="t", along="time", note="when the press is looked at")
    start_angle: Float = given(-60.0, "deg", symbol="phi_0", note="crank angle at the first time; 0 at the bottom "
                               "dead centre", at_least=-3600, at_most=3600)  # fmt: skip
    load_offset: Float = given(100.0, "mm", symbol="y_F", note="force on the slider beside the middle, towards side 1",
                               source="assumed", at_least=-5000, at_most=5000)  # fmt: skip
    # What gives way
    modulus: Float = size(206.0, "GPa", "E", "Young's modulus of the links", source="steel")
    section_crank: Float = size(200.0, "cm^2", "A_a", "section of the crank as a bar")
    section_rod: Float = size(200.0, "cm^2", "A_R", "section of the rod")
    section_knee_drive: Float = size(200.0, "cm^2", "A_g", "section of the knee drive")
    section_upper_knee: Float = size(200.0, "cm^2", "A_m", "section of the upper knee link")
    section_lower_knee: Float = size(200.0, "cm^2", "A_h", "section of the lower knee link")
    joint_stiffness: Float = size(10.0, "kN/um", "k_j", "of one joint of a rod or knee link, pin in its bush")
    pivot_stiffness: Float = size(5.0, "kN/um", "k_A", "of one crank pivot with its part of the frame")
    drive_stiffness: Float = size(20.0, "kN*m/mrad", "k_D", "of one drive against a turn of its crank")
    ground_stiffness_vertical: Float = size(5.0, "kN/um", "k_Mz", "of the frame at one ground joint M, vertical")
    ground_stiffness_sideways: Float = size(2.0, "kN/um", "k_My", "of the frame at one ground joint M, sideways")
    column_stiffness: Float = size(8.0, "kN/um", "k_C", "of bed and both columns, between crown and bolster")
    column_half_distance: Float = size(2.0, "m", "w_C", "half the distance of the columns", most=30)
    # Guides and play
    joint_play: Float = slack(15.0, "um", "c", "radial clearance of every joint of rods and knee links")
    guide_stiffness: Float = size(1.0, "kN/um", "k_G", "of one pair of guides of the slider, upper or lower")
    guide_clearance: Float = slack(50.0, "um", "c_G", "of the slider in its guides, to each side")
    guide_above: Float = given(0.4, "m", symbol="h_o", note="upper guides over the slider joints", source=DRAWING,
                               at_least=-10, at_most=10)  # fmt: skip
    guide_below: Float = given(0.8, "m", symbol="h_u", note="lower guides below the slider joints", source=DRAWING,
                               at_least=-10, at_most=10)  # fmt: skip
    guide_inclination: Float = given(0.0, "mrad", symbol="iota", note="guides out of the vertical, their lower end "
                                     "towards side 1", at_least=-10, at_most=10)  # fmt: skip
    platform_guide_stiffness: Float = size(1.0, "kN/um", "k_P", "of one pair of guides of the platform")
    platform_guide_clearance: Float = slack(50.0, "um", "c_P", "of the platform in its guides, to each side")
    platform_guide_span: Float = slack(0.6, "m", "b_P", "upper to lower guides of the platform; at 0 it is held in "
                                       "one point and free to tilt", most=10)  # fmt: skip
    # Temperature
    expansion: Float = size(11.5, "um/(m*K)", "alpha_T", "linear expansion of links and frame", source="steel", most=50)
    link_rise: Float = given(0.0, "K", symbol="T_L", note="links warmer than when the press was set, platform and "
                             "slider too", at_least=-60, at_most=100)  # fmt: skip
    frame_rise: Float = given(0.0, "K", symbol="T_F", note="frame warmer than when the press was set", at_least=-60,
                              at_most=100)  # fmt: skip
    bolster_depth: Float = size(4.3, "m", "z_B", "bolster below O", most=30)
    # Acceptance
    acceptance_angle: Float = given((-100.0, -75.0, -50.0, -25.0, 0.0), "deg", along="acceptance_angle",
                                    note="crank angles of the test without force")  # fmt: skip
    rated_force: Float = size(2000.0, "kN", "F_N", "force of the test under load, at the bottom dead centre",
                              source="assumed")  # fmt: skip
    rated_offset: Float = given(100.0, "mm", symbol="y_N", note="offset of the test for tilt", source="assumed",
                                above=0, at_most=5000)  # fmt: skip
    face_width: Float = size(3.2, "m", "B", "of the slider face, over which it is measured", most=30)
    face_depth: Float = given(0.5, "m", symbol="h_S", note="slider face below its joints", source=DRAWING,
                              at_least=-10, at_most=10)  # fmt: skip
    permitted_parallelism: Float = size(0.16, "mm", "P_perm", "of slider face to bolster, over its width",
                                        source=PRACTICE)  # fmt: skip
    permitted_squareness: Float = size(0.06, "mm/m", "R_perm", "sideways travel of the slider face per travel down",
                                       source=BEDS)  # fmt: skip
    permitted_clearance: Float = size(0.3, "mm", "C_perm", "travel of the slider when its load reverses", source=CLASS)
    permitted_deflection: Float = size(2.5, "mm", "f_perm", "under the rated force in the middle", source=CLASS)
    permitted_slope: Float = size(0.3, "mm/m", "s_perm", "tilt under the rated force at its offset", source=CLASS)
    permitted_guide_force: Float = size(100.0, "kN", "G_perm", "that a pair of guides may carry", source=CLASS)
    acceptance_goal: Float = given(0.95, "", symbol="R_perm,0", note="share of presses that must keep each limit",
                                   source="assumed", above=0, below=1)  # fmt: skip
    # The errors of the parts
    platform_arm_deviation: Float = off("mm", "k", "arm of the moving platform, common to both sides")
    side_1: PressSide = part(PressSide, index="1", suffix="1")
    side_2: PressSide = part(PressSide, index="2", suffix="2")


ENERGY = "least potential energy of bars, joints, guides and loads"


def over_stroke(unit: str, symbol: str, note: str, method: str = ENERGY) -> Any:
    """Declare a result along the times."""
    return found(unit, symbol=symbol, note=note, method=method, along="time")


@results
class LoadedAnswers:
    """How the press gives way over its stroke, what its guides and links carry, and what an acceptance test shows."""

    time: Float = axis("s", symbol="t", note="time", follows="times")
    crank_angle: Float = over_stroke("deg", "phi", "crank from the bottom dead centre", "law of the drive")
    press_force: Float = over_stroke("kN", "F", "force on the slider, positive upward", "as stated")
    slider_position: Float = over_stroke("mm", "z_2", "slider of the rigid press", "exact position, loops I to III")
    deflection: Float = over_stroke("um", "s", "slider higher over the bolster than that of the rigid, cold press")
    slider_tilt: Float = over_stroke("urad", "theta", "slider to bolster, positive with side 1 lower")
    slider_shift: Float = over_stroke("um", "y_2", "slider sideways at its joints, towards side 1")
    platform_tilt: Float = over_stroke("urad", "gamma", "platform, positive with side 1 lower")
    upper_guide_force: Float = over_stroke("kN", "G_o", "slider on its upper guides, positive towards side 1")
    lower_guide_force: Float = over_stroke("kN", "G_u", "slider on its lower guides, positive towards side 1")
    platform_guide_upper: Float = over_stroke("kN", "P_o", "platform on its upper guides, positive towards side 1")
    platform_guide_lower: Float = over_stroke("kN", "P_u", "platform on its lower guides, positive towards side 1")
    ground_rise_1: Float = over_stroke("um", "w_1", "ground joint M of side 1 pushed up against the frame around it")
    ground_rise_2: Float = over_stroke("um", "w_2", "ground joint M of side 2 pushed up against the frame around it")
    lower_link_1: Float = over_stroke("kN", "N_h1", "lower knee link of side 1, positive pressed")
    lower_link_2: Float = over_stroke("kN", "N_h2", "lower knee link of side 2, positive pressed")
    upper_link_1: Float = over_stroke("kN", "N_m1", "upper knee link of side 1, positive pressed")
    upper_link_2: Float = over_stroke("kN", "N_m2", "upper knee link of side 2, positive pressed")
    rod_1: Float = over_stroke("kN", "N_R1", "rod of side 1, positive pressed")
    rod_2: Float = over_stroke("kN", "N_R2", "rod of side 2, positive pressed")
    largest_guide_force: Float = found(
        "kN", symbol="G_max", note="largest force of a pair of guides of the slider over the record", key=True,
        formula="max(max(abs(upper_guide_force)), max(abs(lower_guide_force)))",
    )  # fmt: skip
    largest_tilt: Float = found("urad", symbol="theta_max", note="largest tilt over the record",
                                formula="max(abs(slider_tilt))", key=True)  # fmt: skip
    # The test under load, at the bottom dead centre
    rated_deflection: Float = found("mm", symbol="f_N", note="slider rises over the bolster from no force to the rated "
                                    "one in the middle", method=ENERGY, key=True)  # fmt: skip
    press_stiffness: Float = found("kN/mm", symbol="k", note="of the whole press, play included",
                                   formula="rated_force / rated_deflection", key=True)  # fmt: skip
    rated_slope: Float = found("mm/m", symbol="s_N", note="tilt from the rated force in the middle to the same at its "
                               "offset", method=ENERGY, key=True)  # fmt: skip
    tilt_stiffness: Float = found("kN*m/mrad", symbol="k_theta", note="moment per tilt",
                                  formula="rated_force * rated_offset / rated_slope", key=True)  # fmt: skip
    # The test without force
    parallelism: Float = found("mm", symbol="P", note="slider face to bolster over its width, largest of the test",
                               method="largest tilt times face_width", key=True)  # fmt: skip
    squareness: Float = found("mm/m", symbol="R", note="sideways travel of the slider face per travel down",
                              method="range of the face sideways over that of the slider down", key=True)  # fmt: skip
    total_clearance: Float = found("mm", symbol="C", note="travel of the slider at the bottom dead centre when its "
                                   "load reverses", method="play of each link times its force per force on the slider",
                                   key=True)  # fmt: skip
