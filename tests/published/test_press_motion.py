"""The press in motion: laws of the drive, exact motion, forces and torque, against mechanics written apart from it.

References: the slider-crank of textbooks in closed form; a press by a program of its own, all bodies in one linear
system (``hidden_effects/moving_press.py``); the power balance, with energies of that program; complex steps; scipy.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import press_by_hand as by_hand
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline, PchipInterpolator

from hidden_effects.moving_press import FORCES, LINKS, MovingMachine, curvature, going, joints, needed, slope
from hidden_effects.rows import Array
from press_linkage.motion import GRAVITY, press_motion, turn_table
from press_linkage.motion_quantities import Link, MovingPress
from truing.errors import InfeasibleError

TURN = 2 * np.pi
LAW = {"speed_angle": np.radians([-150.0, -60.0, -20.0, 30.0]), "speed_share": np.array([1.0, 0.9, 0.3, 0.7])}
"""A servo that slows down for the work."""
CENTRES = {"crank": 0.3, "rod": 0.45, "drive": 0.6, "upper": 0.4, "lower": 0.7}
INERTIAS = {"crank": 4.0, "rod": 25.0, "drive": 9.0, "upper": 80.0, "lower": 40.0}


def moving(machine: MovingMachine, **law: Any) -> MovingPress:
    """The same press for the plugin."""
    links = {
        link: Link(mass=mass, centre=machine.centre.get(link, 0.5), inertia=machine.inertia.get(link, np.nan))
        for link, mass in machine.mass.items()
    }
    return MovingPress(
        **machine.press, **links, rotor_inertia=machine.rotor, platform_mass=machine.platform,
        slider_mass=machine.slider, counterbalance=machine.lift, guide_friction=machine.guide,
        bearing_friction=machine.pins, drive_drag=machine.drag, **law,
    )  # fmt: skip


BARS = MovingMachine()
OTHER = MovingMachine(press=by_hand.CHANGED, centre=CENTRES, inertia=INERTIAS, guide=2e4, pins=4e-3, drag=800.0)
MACHINES = pytest.mark.parametrize("machine", [BARS, OTHER], ids=["paper", "other"])
TIMES = np.linspace(0.013, 4.9, 90)


# Motion


@MACHINES
def test_motion_is_that_of_complex_steps(machine: MovingMachine) -> None:
    answer = press_motion(moving(machine, times=TIMES, **LAW))
    angle, speed = np.asarray(answer.crank_angle), np.asarray(answer.drive_speed)

    def height(at: Array) -> Array:
        return np.asarray(joints(at, machine.press)["H"][1])

    assert answer.slider_position == pytest.approx(height(angle), abs=1e-14)
    assert answer.slope == pytest.approx(slope(height, angle), abs=1e-13)
    assert answer.curvature == pytest.approx(curvature(height, angle), abs=1e-10)
    turning = {link: going(machine, link, angle).turn * speed for link in LINKS}
    for name, link in {"rod": "rod", "knee_drive": "drive", "upper_knee": "upper", "lower_knee": "lower"}.items():
        assert getattr(answer, f"{name}_speed") == pytest.approx(turning[link], abs=1e-13)


# The law of the drive


def test_a_constant_speed_turns_the_crank_evenly() -> None:
    answer = press_motion(MovingPress(times=TIMES, speed=0.25, start_angle=-5.0))
    assert answer.crank_angle == pytest.approx(-5.0 + TURN * 0.25 * (TIMES - TIMES[0]), abs=1e-13)
    assert np.ptp(answer.drive_speed) == 0
    assert not np.any(answer.drive_acceleration)


def test_a_law_over_the_angle_is_a_differential_equation_of_the_angle() -> None:
    """Solved by scipy from step to step, over four turns; half a turn takes the integral of 1/speed."""
    times = np.linspace(0.0, 30.0, 200)
    answer = press_motion(MovingPress(times=times, start_angle=-2.0, **LAW))
    knots = np.concatenate([LAW["speed_angle"] + turn * TURN for turn in range(-2, 7)])
    law = PchipInterpolator(knots, np.tile(LAW["speed_share"], 9))
    solved = solve_ivp(
        lambda t, y: TURN * 0.2 * law(y), (0, 30), [-2.0], "DOP853", times, rtol=1e-12, atol=1e-12, max_step=0.05
    )
    assert answer.crank_angle == pytest.approx(solved.y[0], abs=1e-8)
    last = float(np.asarray(answer.crank_angle)[100])
    took = quad(lambda at: 1 / law(at), -2.0, last, points=[k for k in knots if -2 < k < last], limit=200, epsabs=1e-12)
    assert took[0] / (TURN * 0.2) == pytest.approx(times[100], abs=1e-11)


def test_acceleration_is_the_derivative_of_the_speed() -> None:
    near = 1e-5
    for law in (LAW, {"crank_speed": np.array([0.1, 0.2, 0.25, 0.05, -0.1])}):
        stamps = (
            np.linspace(0.0, 4.0, 5)
            if "crank_speed" in law
            else np.sort(np.add.outer(TIMES[::9], [-near, 0, near]).ravel())
        )
        answer = press_motion(MovingPress(times=stamps, **law))
        speed, acceleration = np.asarray(answer.drive_speed), np.asarray(answer.drive_acceleration)
        if "crank_speed" in law:
            curve = CubicSpline(stamps, TURN * law["crank_speed"])
            assert speed == pytest.approx(TURN * law["crank_speed"])
            assert acceleration == pytest.approx(curve(stamps, 1))
            turned = [quad(curve, 0, t, epsabs=1e-13, points=[1, 2, 3])[0] for t in stamps]
            assert answer.crank_angle == pytest.approx(-np.pi + np.array(turned), abs=1e-12)
        else:
            assert acceleration[1::3] == pytest.approx((speed[2::3] - speed[::3]) / (2 * near), rel=1e-6, abs=1e-6)


def test_forces_over_the_angle_hold_in_every_turn() -> None:
    table = {"force_angle": np.radians([-40.0, -30.0, 0.0, 3.0]), "force": np.array([0.0, 5e5, 8e5, 0.0])}
    answer = press_motion(MovingPress(times=TIMES, speed=0.9, **table))
    degrees = (np.degrees(answer.crank_angle) + 180) % 360 - 180
    assert answer.press_force == pytest.approx(np.interp(degrees, [-40, -30, 0, 3], [0, 5e5, 8e5, 0]), abs=1e-6)
    assert np.max(answer.press_force) > 6e5


# Forces and torque


@MACHINES
def test_every_body_is_in_equilibrium(machine: MovingMachine) -> None:
    """Nine forces and the torque, from all equations at once; friction of guide, pins and oil in the other press."""
    answer = press_motion(moving(machine, times=TIMES, **LAW))
    angle, speed, acceleration, force = (
        np.asarray(value)
        for value in (answer.crank_angle, answer.drive_speed, answer.drive_acceleration, answer.press_force)
    )
    solved = needed(machine, angle, speed, acceleration, force)
    assert answer.crank_torque == pytest.approx(solved.torque, abs=1e-9 * answer.largest_torque)
    for name in FORCES:
        joint = getattr(answer, name)
        both = np.array([joint.outward, joint.downward])
        assert both == pytest.approx(solved.forces[name], abs=1e-9 * joint.largest), name


@MACHINES
def test_power_of_the_cranks_is_what_energy_gains_and_force_takes(machine: MovingMachine) -> None:
    """To 1e-9 of the largest power: energies by the other program, differenced in time at eighth order.

    Friction is taken out here: what it takes is no energy that comes back, and the test above has it.
    """
    machine, step = replace(machine, guide=0.0, pins=0.0, drag=0.0), 1e-3
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / step
    starts = np.radians(np.arange(-175.0, 180.0, 11.0))
    press = moving(machine, times=step * np.arange(9), start_angle=starts, **LAW)
    answer = press_motion(press)
    angle, speed = np.asarray(answer.crank_angle), np.asarray(answer.drive_speed)
    energy = stored(machine, angle.ravel(), speed.ravel()).reshape(angle.shape)
    spent = energy @ weights + np.asarray(answer.press_force * answer.slider_speed)[:, 4]
    power = np.asarray(answer.drive_power)[:, 4]
    assert np.max(np.abs(power)) > 1e4
    assert power == pytest.approx(spent, abs=1e-9 * np.max(np.abs(power)))


def stored(machine: MovingMachine, angle: Array, speed: Array) -> Array:
    """Kinetic and potential energy of both sides, counterbalance included, at crank angles and speeds."""
    places = joints(angle, machine.press)
    energy = machine.rotor * speed**2
    for link in LINKS:
        own, mass = going(machine, link, angle), machine.mass[link]
        length = np.hypot(*(own.ends[1] - own.ends[0]))
        inertia = machine.inertia.get(link, mass * length**2 / 12)
        energy = energy + (mass * np.sum(own.velocity**2, axis=0) + inertia * own.turn**2) * speed**2
        energy = energy - 2 * mass * GRAVITY * own.centre[1]
    for mass, joint, lift in ((machine.platform, "E", 0.0), (machine.slider, "H", machine.lift)):
        way = slope(lambda at, joint=joint: joints(at, machine.press)[joint][1], angle)
        energy = energy + 0.5 * mass * (way * speed) ** 2 + (lift - mass * GRAVITY) * places[joint][1]
    return np.asarray(energy)


WEIGHTLESS = Link(mass=0.0, centre=0.5, inertia=0.0)


def slider_crank(offset: float, rod: Mapping[str, float] | None = None) -> MovingPress:
    """A press of which only crank, rod and platform have mass: a slider-crank with its pivot beside the way."""
    return MovingPress(
        times=TIMES, crank_pivot_radius=0.3 + offset, crank=WEIGHTLESS, drive=WEIGHTLESS, upper=WEIGHTLESS,
        lower=WEIGHTLESS, rod=Link(**rod) if rod else WEIGHTLESS, rotor_inertia=0.0, platform_mass=4000.0,
        slider_mass=0.0, counterbalance=0.0, force=np.zeros(4), ground_pivot_radius=1.3, **LAW,
    )  # fmt: skip


@pytest.mark.parametrize("offset", [0.9, 0.4, 1e-9])
def test_the_limit_of_a_slider_crank_in_closed_form(offset: float) -> None:
    """The rod is off the way of the piston by beta, sin beta = (a cos psi + offset)/l."""
    press = slider_crank(offset)
    answer = press_motion(press)
    a, rod = 0.36, 1.304
    psi = np.asarray(answer.crank_angle) + np.arccos(-offset / (a + rod))
    speed, acceleration = np.asarray(answer.drive_speed), np.asarray(answer.drive_acceleration)
    sine = (offset + a * np.cos(psi)) / rod
    cosine = np.sqrt(1 - sine**2)
    turn = -a * np.sin(psi) / (rod * cosine)  # beta by the crank angle
    turn_2 = (-a * np.cos(psi) / rod + sine * turn**2) / cosine
    way = a * np.cos(psi) - rod * sine * turn
    way_2 = -a * np.sin(psi) - rod * (cosine * turn**2 + sine * turn_2)
    load = 2000.0 * (way_2 * speed**2 + way * acceleration - GRAVITY)
    torque = load * a * (np.cos(psi) + np.sin(psi) * sine / cosine)
    assert answer.crank_torque == pytest.approx(torque, abs=1e-10 * answer.largest_torque)
    for name in ("crank_pivot", "crank_pin", "rod_joint"):
        assert getattr(answer, name).size == pytest.approx(np.abs(load / cosine), abs=1e-10 * np.max(np.abs(load)))
    assert np.max(answer.slider_joint.size) < 1e-9


def test_a_rod_is_two_masses_at_its_ends() -> None:
    """Dynamically equal: m (1 - s) on the crank pin, m s on the platform, J = m s (1 - s) l^2."""
    share, mass, length = 0.35, 300.0, 1.304
    whole = press_motion(
        slider_crank(0.9, {"mass": mass, "centre": share, "inertia": mass * share * (1 - share) * length**2})
    )
    parted = slider_crank(0.9)
    parted = replace(
        parted, platform_mass=4000.0 + 2 * mass * share, crank=Link(mass=mass * (1 - share), centre=1.0, inertia=0.0)
    )
    assert whole.crank_torque == pytest.approx(press_motion(parted).crank_torque, abs=1e-10 * whole.largest_torque)


def test_a_press_that_stands_still_is_held_by_virtual_work() -> None:
    """At hardly any speed the torque is force times travel, and friction of the guide comes on top."""
    still = MovingPress(times=TIMES, speed=1e-9 / 60, start_angle=np.radians([-40.0, -30.0, -10.0]), guide_friction=1e4)
    answer = press_motion(replace(still, force_angle=np.zeros(1), force=np.full(1, 5e5)))
    sinking = sum(
        getattr(still, link).mass * going(BARS, link, np.asarray(answer.crank_angle)[:, 0]).velocity[1]
        for link in LINKS
    )
    ways = [slope(lambda at, j=j: joints(at, by_hand.PAPER)[j][1], np.asarray(answer.crank_angle)[:, 0]) for j in "EH"]
    held = 0.5 * (5e5 + 196e3 + 1e4 - 20e3 * GRAVITY) * ways[1] - GRAVITY * (1e3 * ways[0] + sinking)
    assert np.asarray(answer.crank_torque)[:, 0] == pytest.approx(held, rel=1e-9)


def test_pins_that_rub_too_much_lock_the_press() -> None:
    with pytest.raises(InfeasibleError, match="the press locks"):
        press_motion(MovingPress(bearing_friction=0.3))


def test_machines_are_vectorised_over_times() -> None:
    """A thousand machines in one call are a thousand calls, friction of pins included."""
    rng = np.random.default_rng(4)
    masses = rng.uniform(1e4, 3e4, 1000)
    friction = rng.uniform(0.0, 8e-3, 1000)
    many = press_motion(MovingPress(slider_mass=masses, bearing_friction=friction, times=TIMES[::6]))
    assert np.shape(many.crank_torque) == (1000, 15)
    for row in (0, 511, 999):
        one = press_motion(MovingPress(slider_mass=masses[row], bearing_friction=friction[row], times=TIMES[::6]))
        assert np.asarray(many.crank_torque)[row] == pytest.approx(one.crank_torque, rel=1e-12)


def test_the_best_counterbalance_is_that_of_least_squares() -> None:
    """The torque is linear in the counterbalance, so its mean square is a parabola."""
    lifts = np.array([0.0, 1e5, 4e5])
    squares = np.asarray(press_motion(MovingPress(counterbalance=lifts)).rms_torque) ** 2
    parabola = np.polyfit(lifts, squares, 2)
    best = -parabola[1] / (2 * parabola[0])
    at = MovingPress(counterbalance=np.array([best - 1e3, best, best + 1e3]))
    low, least, high = np.asarray(press_motion(at).rms_torque)
    assert least < min(low, high)
    assert (low + high - 2 * least) / least < 1e-3


# What cannot be


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"times": np.array([0.0])}, "times: two or more"),
    ({"times": np.array([0.0, 1.0, 1.0])}, "each later than the one before"),
    ({"crank_speed": np.array([0.2, 0.2])}, "crank_speed has 2 values at 121 times"),
    ({"crank_speed": np.where(np.arange(121) == 7, np.nan, 0.2)}, "crank_speed is missing at some of the times"),
    ({"forming_force": np.array([1e3])}, "forming_force has 1 values at 121 times"),
    ({"force_angle": np.zeros(0), "force": np.zeros(0)}, "force has 0 values at 0 of force_angle"),
    ({"speed_angle": np.zeros(2)}, "speed_share has 1 values at 2 of speed_angle"),
    ({"speed_angle": np.array([0.0, -1.0]), "speed_share": np.ones(2)}, "speed_angle: angles rise within one turn"),
    ({"force_angle": np.array([0.0, 7.0]), "force": np.ones(2)}, "force_angle: angles rise within one turn"),
    ({"force_angle": np.array([-np.pi, np.pi]), "force": np.arange(2.0)}, "ends with its first value"),
    ({"speed_angle": np.array([0.0, 1.0]), "speed_share": np.array([1.0, 0.0])}, "stands still does not go on"),
    ({"rod_length": 1.1}, "loop I, side 1 does not close"),
]


@pytest.mark.parametrize(("changed", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_cannot_be_is_refused_by_name(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(InfeasibleError, match=words.replace("(", r"\(")):
        press_motion(replace(MovingPress(), **changed))


def test_a_table_over_a_whole_turn_may_name_its_end_twice() -> None:
    angle, value = turn_table(np.radians([-180.0, 0.0, 180.0]), np.array([1.0, 2.0, 1.0]), "force_angle", "force")
    assert (np.degrees(angle).tolist(), value.tolist()) == ([-180.0, 0.0], [1.0, 2.0])


def test_the_acceleration_of_a_log_is_that_of_the_crank() -> None:
    """Eighty readings of a turn that swells by a third: an acceleration that is right to 1e-5 of the largest."""
    times, whole = np.linspace(0.0, 5.0, 81), TURN / 5
    answer = press_motion(MovingPress(times=times, crank_speed=0.2 * (1 + 0.3 * np.sin(whole * times))))
    assert answer.drive_acceleration == pytest.approx(0.3 * whole**2 * np.cos(whole * times), abs=2e-5 * 0.3 * whole**2)
