"""The second stage against pins summed one by one, a flank drawn point by point, and published lives."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from gear_geometry import cycloid
from rv_gearing.model import RV_GEARING
from rv_gearing.rating import rv_gearing
from rv_gearing.second_stage import mean_load
from truing.errors import InfeasibleError
from truing.units import from_si

K, PINS, CIRCLE, PIN = 0.75, 40, 0.1, 0.004


def rated(**stated: Any) -> dict[str, float]:
    fields = RV_GEARING.own_result_fields
    answers = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(**stated)))
    return {name: float(np.asarray(from_si(value, fields[name].unit))) for name, value in answers.items()}


def pin_by_pin(torque: float, turn: float, pins: int = PINS, short: float = K) -> tuple[float, float, float]:
    """Equal springs at all pins: force by arm about the disc's centre; sum across and along, and the largest force.

    Coordinates: pin circle at the origin, disc centre at (e, 0), pitch point at (e z_p, 0); pins at ``turn`` and on.
    """
    throw = short * CIRCLE / pins
    angle = (np.arange(pins) + turn) * 2 * np.pi / pins
    towards = np.stack([CIRCLE * np.cos(angle) - throw * pins, CIRCLE * np.sin(angle)])
    towards /= np.hypot(*towards)  # a contact force points from the pitch point to the pin
    arm = towards[1] * (throw * pins - throw)  # about the disc's centre
    arm = np.maximum(arm, 0.0)
    force = torque * arm / np.sum(arm**2)
    along, across = towards @ force
    return across, along, force.max()


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.7])
def test_the_resultant_of_all_pins_is_that_of_a_sum_over_pins(turn: float) -> None:
    across, along, largest = pin_by_pin(500.0, turn)
    closed = cycloid.resultant(500.0, K, PINS, CIRCLE)
    assert closed[0] == pytest.approx(across, rel=1e-12)
    assert closed[1] == pytest.approx(along, rel=0.02)  # the sum changes by 1 % over a pitch
    assert cycloid.largest_force(500.0, K, PINS, CIRCLE) == pytest.approx(largest, rel=0.01)
    whole = quad(lambda x: np.sin(x) * (np.cos(x) - K) / (1 + K * K - 2 * K * np.cos(x)), 0, np.pi)[0]
    exact = cycloid.largest_force(500.0, K, PINS, CIRCLE) * PINS / 2 / np.pi * whole
    assert closed[1] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(("pins", "short", "off"), [(20, 0.85, 1e-3), (40, 0.75, 1e-5), (10, 0.85, 7e-3)])
def test_the_integrals_are_the_mean_of_the_sums_over_a_pitch(pins: int, short: float, off: float) -> None:
    sums = np.mean([pin_by_pin(500.0, turn, pins, short) for turn in (np.arange(100) + 0.5) / 100], axis=0)
    across, along = cycloid.resultant(500.0, short, pins, CIRCLE)
    assert sums[0] == pytest.approx(float(across), rel=1e-12)
    assert sums[1] == pytest.approx(float(along), rel=off)


def test_flank_and_pin_touch_as_the_drawn_profile_does() -> None:
    """Curvature of the path of the pin centre by finite differences: the disc rolls on the pitch circle of the pins."""
    turn = np.linspace(0.0, 2 * np.pi / 39, 2001)
    throw, psi = K * CIRCLE / PINS, PINS * turn
    path = CIRCLE * np.exp(1j * turn) - throw * np.exp(1j * PINS * turn)
    first, second = np.gradient(path, turn), np.gradient(np.gradient(path, turn), turn)
    bend = (np.conj(first) * second).imag / np.abs(first) ** 3
    own = cycloid.path_curvature(K, PINS, CIRCLE, psi - turn)
    inner = slice(20, -20)
    assert np.allclose(np.abs(bend[inner]), np.abs(own[inner]), rtol=1e-3, atol=0.01)
    middle = np.linspace(0.01, np.pi - 0.01, 4001)
    convex = -1 / np.minimum(cycloid.path_curvature(K, PINS, CIRCLE, middle), -1e-9)
    assert cycloid.least_convex_radius(K, PINS, CIRCLE) == pytest.approx(convex.min(), rel=1e-6)


def test_the_gap_between_flank_and_pin_opens_as_between_a_plane_and_the_cylinder_in_its_place() -> None:
    """The flank drawn point by point, a pin radius inside the path of the pin: the gap to the pin beside the contact.

    A cylinder of radius R on a plane has a gap of s²/(2 R) at a distance s.
    """
    turn = np.linspace(0.0, 2 * np.pi / 39, 400_001)
    throw = K * CIRCLE / PINS
    path = CIRCLE * np.exp(1j * turn) - throw * np.exp(1j * PINS * turn)
    along = CIRCLE * np.exp(1j * turn) - throw * PINS * np.exp(1j * PINS * turn)
    flank = path - PIN * along / np.abs(along)
    for place in (20_000, 60_000, 150_000):  # concave, convex, convex
        to_contact = (flank[place] - path[place]) / PIN
        seen = (flank[place - 1000 : place + 1001] - path[place]) / to_contact
        gap, aside = np.abs(seen) - PIN, np.abs(seen.imag)
        measured = np.polyfit(aside**2, gap, 1)[0]
        own = cycloid.relative_radius(K, PINS, (CIRCLE, PIN), (PINS - 1) * turn[place])
        assert 1 / (2 * abs(measured)) == pytest.approx(float(own), rel=5e-3)


def test_torque_of_the_discs_is_what_power_says() -> None:
    """Without losses both discs turn the cranks with R_y e each, and the planets bring T_1 z_2/z_1 to them."""
    lossless = dict.fromkeys(("involute_efficiency", "cycloid_efficiency", "bearing_efficiency"), 1.0)
    found = rated(disc_load_factor=1.0, sun_teeth=23, planet_teeth=63, **lossless)
    brought = found["sun_torque"] * 63 / 23
    assert 2 * found["force_across"] * found["crank_throw"] / 1e3 == pytest.approx(brought, rel=1e-12)


def test_pressure_is_that_of_the_worst_pin() -> None:
    found = rated(pin_circle_radius="100 mm", pin_radius="4 mm", disc_width="12 mm", short_width=K)
    angle = np.linspace(1e-3, np.pi - 1e-3, 20001)
    distance = np.sqrt(1 + K * K - 2 * K * np.cos(angle))
    bend = (K * 41 * np.cos(angle) - (1 + 40 * K * K)) / (100 * distance**3)
    radius = 4 * np.abs(1 + 4 * bend)
    force = found["pin_force"] * np.sin(angle) / distance
    pressure = np.sqrt(force * 206e3 / (2 * np.pi * 0.91 * 12 * radius))
    assert found["pin_pressure"] == pytest.approx(pressure.max(), rel=2e-3)


def test_friction_of_pins_gives_the_efficiency_that_the_paper_takes() -> None:
    """0.998 of the paper is a friction of 0.05; the loss summed pin by pin, with speeds from the turning disc."""
    found = rated(pin_circle_radius="100 mm", pin_radius="4 mm", short_width=K)
    assert found["pin_loss_efficiency"] == pytest.approx(0.998, abs=2e-4)
    angle = (np.arange(20) + 0.5) * np.pi / 20
    distance = np.sqrt(1 + K * K - 2 * K * np.cos(angle))
    slip = 100 * distance - 4  # mm per radian of the disc against the pins
    lost = 0.05 * np.sum(np.sin(angle) / distance * slip)
    passed = np.sum((np.sin(angle) / distance) ** 2) * K * 100 / 40 * 39  # torque of a largest force of 1, mm
    assert 1 - found["pin_loss_efficiency"] == pytest.approx(lost / passed / 40, rel=2e-3)


def test_a_load_that_turns_and_one_that_stands_wear_out_a_bearing_as_their_mean_power() -> None:
    for p in (3.0, 10 / 3):
        exact = quad(lambda x: (9 + 4 + 12 * np.cos(x)) ** (p / 2), 0, 2 * np.pi, epsabs=1e-10)[0] / (2 * np.pi)  # noqa: B023
        assert float(mean_load(3.0, 2.0, p)) == pytest.approx(exact ** (1 / p), rel=1e-9)
    assert float(mean_load(3.0, 0.0, 10 / 3)) == pytest.approx(3.0, rel=1e-12)


def test_published_lives_of_bearings() -> None:
    """C = 16 kN under 2 kN, balls: 512 million turns (textbook); 30 kN under 3 kN at 1500 r/min: 11,111 h."""
    ball = rated(bearing_exponent=3, bearing_rating="16 kN", stated_crank_load="2 kN")
    assert ball["million_turns"] == pytest.approx(512, rel=1e-12)
    hours = rated(bearing_exponent=3, bearing_rating="30 kN", stated_crank_load="3 kN",
                  stated_mesh_speed=f"{1500 * 55 / 20} rpm")  # fmt: skip
    assert hours["bearing_life"] == pytest.approx(1e6 / (60 * 1500) * 1000, rel=1e-9)
    default = rated()
    assert default["bearing_life"] == pytest.approx(6000, rel=1e-9)
    halved = rated(bearing_rating=f"{default['needed_rating'] / 2} kN")
    assert halved["bearing_life"] == pytest.approx(6000 / 2 ** (10 / 3), rel=1e-9)


def test_a_disc_that_would_cross_itself_is_refused() -> None:
    with pytest.raises(InfeasibleError, match="eccentricity \\* pins exceeds pin_circle_radius"):
        rated(eccentricity="3 mm", pin_circle_radius="100 mm")
