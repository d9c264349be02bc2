"""What the press in motion is told and what it answers: every quantity with unit, symbol, bounds and source."""

from typing import Any

from press_linkage.quantities import Mechanism
from truing import Float, axis, found, given, inputs, part, results

BAR = "assumed: a steel bar of 200 cm² section"
ASSUMED = "assumed; the paper gives no masses"
ONE_TURN = tuple(step / 24 for step in range(121))
"""Times of one turn at 12 rpm, s."""
NEUTRAL = "neutral at 0"


@inputs
class Link:
    """What one link weighs, and how its mass lies along the line between its joints."""

    mass: Float = given(250.0, "kg", symbol="m", note="mass of the link", source=BAR, at_least=0, at_most=1e6)
    centre: Float = given(0.5, "", symbol="s", note="its centre of gravity, from its first joint, over its length",
                          source=BAR, at_least=-2, at_most=3)  # fmt: skip
    inertia: Float = given(None, "kg*m^2", symbol="J", note="moment of inertia about its centre of gravity; else that "
                           "of a uniform bar", at_least=0, at_most=1e7)  # fmt: skip


@inputs
class DrivenPress(Mechanism):
    """The mechanism with its masses, the law of its drive, and the force on its slider. Both sides are alike."""

    times: Float = given(ONE_TURN, "s", symbol="t", along="time", note="when the motion is looked at")
    # The drive
    start_angle: Float = given(-180.0, "deg", symbol="phi_0", note="crank angle at the first time; 0 at the bottom "
                               "dead centre", at_least=-3600, at_most=3600)  # fmt: skip
    speed: Float = given(12.0, "rpm", symbol="n", note="full speed of the cranks", source="assumed", above=0,
                         at_most=1000)  # fmt: skip
    speed_angle: Float = given((0.0,), "deg", along="speed_angle", note="crank angles of the speed law, rising within "
                               "a turn; one alone: constant speed")  # fmt: skip
    speed_share: Float = given((100.0,), "%", along="speed_angle", note="share of full speed there; smooth between",
                               above=0, at_most=1000)  # fmt: skip
    crank_speed: Float = given((), "rpm", along="time", note="speed of the cranks at the times, smooth between; "
                               "stated, it replaces the speed law")  # fmt: skip
    # The force on the slider
    force_angle: Float = given((-40.0, -30.0, 0.0, 3.0), "deg", along="force_angle", note="crank angles of the force, "
                               "rising within a turn", source="assumed: drawing")  # fmt: skip
    force: Float = given((0.0, 1000.0, 2000.0, 0.0), "kN", along="force_angle", note="central force on the slider, "
                         "straight between the angles; positive pushes it up", source="assumed: drawing")  # fmt: skip
    forming_force: Float = given((), "kN", along="time", note="the same force at the times; stated, it replaces force "
                                 "over angle")  # fmt: skip
    # Masses
    crank: Link = part(Link, index="a", mass=56.5)
    rod: Link = part(Link, index="R", mass=205.0)
    drive: Link = part(Link, index="g", suffix="knee_drive", mass=136.0)
    upper: Link = part(Link, index="m", suffix="upper_knee", mass=267.0)
    lower: Link = part(Link, index="h", suffix="lower_knee", mass=251.0)
    platform_mass: Float = given(2.0, "t", symbol="m_P", note="of the platform with its arm", source=ASSUMED,
                                 at_least=0, at_most=1e4)  # fmt: skip
    slider_mass: Float = given(20.0, "t", symbol="m_S", note="of the slider with what hangs on it", source=ASSUMED,
                               at_least=0, at_most=1e4)  # fmt: skip
    counterbalance: Float = given(196.0, "kN", symbol="F_C", note="force that lifts the slider, of air cylinders",
                                  source="assumed: carries 20 t", at_least=0, at_most=1e5)  # fmt: skip


@inputs
class MovingPress(DrivenPress):
    """What the drive needs beside that: inertia of motor and gears, and friction."""

    rotor_inertia: Float = given(200.0, "kg*m^2", symbol="J_D", note="of motor and gears, as it is felt at one crank",
                                 source=ASSUMED, at_least=0, at_most=1e7)  # fmt: skip
    # Friction
    guide_friction: Float = given(0.0, "kN", symbol="F_G", note=f"dry friction in the guides of the slider, {NEUTRAL}",
                                  at_least=0, at_most=1e4)  # fmt: skip
    bearing_friction: Float = given(0.0, "mm", symbol="rho", note="friction coefficient times radius of the pins, "
                                    f"alike at all joints, {NEUTRAL}", at_least=0, at_most=1000)  # fmt: skip
    drive_drag: Float = given(0.0, "N*m*s", symbol="d", note="torque per angular speed of one crank, by oil in "
                              f"bearings and gears, {NEUTRAL}", at_least=0, at_most=1e7)  # fmt: skip
    # What is asked
    permitted_torque: Float = given(60.0, "kN*m", symbol="M_perm", note="torque that one crank may need",
                                    source="assumed", above=0, at_most=1e6)  # fmt: skip


NEWTON = "Newton and Euler, link by link from the slider to the crank"


def over_time(unit: str, symbol: str, note: str, formula: str = "", method: str = "") -> Any:
    """Declare a result along the times."""
    return found(unit, symbol=symbol, note=note, formula=formula, method=method, along="time")


@results
class JointForce:
    """The force at a joint of one side, on the link that is named."""

    outward: Float = found("kN", symbol="Y", along="time", note="force at this joint, outward", method=NEWTON)
    downward: Float = found("kN", symbol="Z", along="time", note="force at this joint, downward", method=NEWTON)
    size: Float = found("kN", symbol="F", along="time", note="force at this joint", formula="hypot(outward, downward)")
    largest: Float = found("kN", symbol="F_max", note="largest force at this joint", formula="max(size)")


@results
class PressMotion:
    """How the press moves over a record, and what its drive and its joints must carry."""

    time: Float = axis("s", symbol="t", note="time", follows="times")
    # The drive
    crank_angle: Float = over_time("deg", "phi", "crank from the bottom dead centre", method="integral of its speed")
    drive_speed: Float = over_time("rad/s", "omega", "angular speed of the cranks", method="law over the angle: "
                                   "monotone cubic between its points; law over time: cubic spline")  # fmt: skip
    drive_acceleration: Float = over_time("rad/s^2", "alpha", "angular acceleration of the cranks",
                                          method="derivative of the speed law")  # fmt: skip
    # The slider
    slider_position: Float = over_time("mm", "z_2", "slider, downward from O", method="exact position, loops I to III")
    slope: Float = over_time("m/rad", "z_2'", "travel of the slider per crank angle", method="loops, differentiated")
    curvature: Float = over_time("m/rad^2", "z_2''", "second derivative by the crank angle",
                                 method="loops, differentiated twice")  # fmt: skip
    slider_speed: Float = over_time("m/s", "v", "speed of the slider, downward", "slope * drive_speed")
    slider_acceleration: Float = over_time("m/s^2", "b", "acceleration of the slider, downward",
                                           "curvature * drive_speed**2 + slope * drive_acceleration")  # fmt: skip
    press_force: Float = over_time("kN", "F", "force on the slider, positive upward", method="as stated over the crank "
                                   "angle or over time")  # fmt: skip
    # The links
    rod_speed: Float = over_time("rad/s", "omega_R", "angular speed of the rod", method="loop I")
    knee_drive_speed: Float = over_time("rad/s", "omega_g", "angular speed of the knee drive", method="loop II")
    upper_knee_speed: Float = over_time("rad/s", "omega_m", "angular speed of the upper knee link", method="loop II")
    lower_knee_speed: Float = over_time("rad/s", "omega_h", "angular speed of the lower knee link", method="loop III")
    # What one crank needs
    reduced_inertia: Float = over_time("kg*m^2", "J", "inertia of one side, as it is felt at its crank",
                                       method="sum of what each body has per square of the crank speed")  # fmt: skip
    inertia_slope: Float = over_time("kg*m^2/rad", "J'", "its derivative by the crank angle", method="analytical")
    weight_torque: Float = over_time("kN*m", "M_W", "torque of one crank against weights, less the counterbalance",
                                     method="virtual work")  # fmt: skip
    friction_torque: Float = over_time("kN*m", "M_F", "torque of one crank against guide, pins and oil",
                                       method="work of the friction over the crank angle")  # fmt: skip
    crank_torque: Float = over_time(
        "kN*m", "M", "torque of the drive on one crank, in the sense in which its angle grows",
        "reduced_inertia * drive_acceleration + inertia_slope * drive_speed**2 / 2 + weight_torque"
        " + press_force * slope / 2 + friction_torque",
        NEWTON,
    )  # fmt: skip
    drive_power: Float = over_time("kW", "P", "power of both cranks", "2 * crank_torque * drive_speed")
    kinetic_energy: Float = over_time("kJ", "E", "kinetic energy of both sides", "reduced_inertia * drive_speed**2")
    # The joints, of one side
    crank_pivot: JointForce = part(JointForce, index="A", suffix="crank_pivot")
    crank_pin: JointForce = part(JointForce, index="B", suffix="crank_pin")
    rod_joint: JointForce = part(JointForce, index="E", suffix="rod_joint")
    arm_joint: JointForce = part(JointForce, index="B5", suffix="arm_joint")
    knee_of_drive: JointForce = part(JointForce, index="Gg", suffix="knee_of_drive")
    knee_of_upper: JointForce = part(JointForce, index="Gm", suffix="knee_of_upper")
    knee_of_lower: JointForce = part(JointForce, index="Gh", suffix="knee_of_lower")
    ground_joint: JointForce = part(JointForce, index="M", suffix="ground_joint")
    slider_joint: JointForce = part(JointForce, index="H", suffix="slider_joint")
    # Over the record
    largest_torque: Float = found("kN*m", symbol="M_max", note="largest torque of one crank, either way",
                                  formula="max(abs(crank_torque))")  # fmt: skip
    rms_torque: Float = found("kN*m", symbol="M_rms", note="root mean square of the torque over the time",
                              method="trapezoidal rule over the times")  # fmt: skip
    drive_work: Float = found("kJ", symbol="W", note="work of both cranks", method="trapezoidal rule over the times")
    press_work: Float = found("kJ", symbol="W_F", note="work against the force on the slider",
                              method="trapezoidal rule over the times")  # fmt: skip
    turns: Float = found("", symbol="N", note="turns of the crank in the record", method="between its first "
                         "and its last angle")  # fmt: skip
