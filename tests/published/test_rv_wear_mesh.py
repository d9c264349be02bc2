"""Mesh of the cycloid disc: geometry, clearance, forces. Limits, identities and independent solutions.

Numbers without another source were computed from the same equations by an independent program; the digits that it
printed are demanded. Everything else is an identity, or solved here a second time from the equations of the paper.
"""

from dataclasses import replace
from math import acos, degrees, log, pi, radians, sqrt
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import lambertw

from rv_wear import discs, geometry, wear
from rv_wear.calculation import rv_wear
from rv_wear.forces import Loads, shared, start_scale
from rv_wear.geometry import Choices, Mesh, Teeth, mesh_of, teeth_of
from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer
from rv_wear.wear import states, worn
from shared import ROUNDING
from truing.errors import InfeasibleError

PAPER: Reducer = RV_WEAR.inputs()
MESH = mesh_of(PAPER)
K_1 = 2.2 * 40 / 114.5
Q = sqrt(1 - K_1**2)
PSI_0 = acos(K_1)
ANGLES = np.radians(np.linspace(0.5, 179.5, 360))
SOME = [radians(10), radians(20), radians(38), radians(58), radians(80), radians(120), radians(160)]


def unworn(mesh: Mesh) -> tuple[Teeth, Loads]:
    teeth = teeth_of(mesh)
    return teeth, shared(teeth, teeth.slack, start_scale(teeth))


def lever(angle: Any) -> Any:
    """Arm of the contact force of the paper's reducer, written out (m)."""
    return 0.0022 * 39 * np.sin(angle) / np.sqrt(1 + K_1**2 - 2 * K_1 * np.cos(angle))


# Geometry


def path(turn: Any) -> NDArray[np.complex128]:
    """The centre of a pin in the disc, from the motion itself: pin circle minus crank."""
    return np.asarray(0.1145 * np.exp(1j * turn) - 0.0022 * np.exp(40j * turn))


def flank(turn: Any) -> NDArray[np.complex128]:
    x, y = geometry.profile(replace(MESH, equidistant=0.0, shift=0.0), turn)
    return np.asarray(x) + 1j * np.asarray(y)


def slope(function: Any, at: float, step: float = 1e-5) -> complex:
    """Derivative by five points."""
    near, far = function(at + step) - function(at - step), function(at + 2 * step) - function(at - 2 * step)
    return complex((8 * near - far) / (12 * step))


@pytest.mark.parametrize("psi", SOME)
def test_flank_speeds_and_radius_are_those_of_the_moving_profile(psi: float) -> None:
    """The flank is a pin radius from the path and parallel to it, inwards: the disc lies inside of its pins.

    A point of the pin that is in contact is fixed in the housing, which turns around the disc.
    """
    turn = psi / 39
    away, along = complex(flank(turn) - path(turn)), slope(path, turn)
    assert abs(away) == pytest.approx(0.005, rel=1e-14)
    assert (away * along.conjugate()).real == pytest.approx(0, abs=1e-9 * abs(along) * 0.005)
    assert (away * along.conjugate()).imag > 0
    assert abs((slope(flank, turn) * along.conjugate()).imag) < 1e-8 * abs(along) ** 2
    pin = abs(slope(lambda at: path(at) + away * np.exp(1j * (at - turn)), turn))
    assert geometry.sliding_speed(MESH, psi) == pytest.approx(pin, rel=1e-8)
    assert geometry.rolling_speed(MESH, psi) == pytest.approx(abs(slope(flank, turn)), rel=1e-7)
    assert abs(along) == pytest.approx(0.1145 * geometry.pin_distance(MESH, psi), rel=1e-9)
    first = slope(flank, turn, 2e-4)
    second = slope(lambda place: slope(flank, place, 2e-4), turn, 2e-4)
    curvature = float((first.conjugate() * second).imag / abs(first) ** 3)
    assert geometry.profile_radius(MESH, psi) == pytest.approx(-1 / curvature, rel=1e-4)


@pytest.mark.parametrize("eccentricity", [0.5e-3, 1.2e-3, 2.2e-3, 2.7e-3])
def test_smallest_convex_radius_is_that_of_a_fine_grid(eccentricity: float) -> None:
    mesh = replace(MESH, eccentricity=eccentricity)
    with np.errstate(divide="ignore"):
        radius = 1 / geometry.centre_path_curvature(mesh, np.linspace(0, pi, 400_001))
    assert geometry.smallest_convex_radius(mesh) == pytest.approx(-radius[radius < 0].max(), rel=1e-8)


# Clearance


def plain_clearance(equidistant: float, shift: float, psi: Any) -> Any:
    """Equation G3 as it is printed."""
    s = np.sqrt(1 + K_1**2 - 2 * K_1 * np.cos(psi))
    return equidistant * (1 - np.sin(psi) / s) - shift * (1 - K_1 * np.cos(psi) - Q * np.sin(psi)) / s


def test_clearance_is_linear_in_both_modifications_and_the_printed_one() -> None:
    def of(equidistant: float, shift: float) -> Any:
        return geometry.clearance(replace(MESH, equidistant=equidistant, shift=shift), ANGLES)

    assert of(3e-6, -5e-6) == pytest.approx(3 * of(1e-6, 0.0) + 5 * of(0.0, -1e-6), rel=1e-12)
    assert of(-26e-6, -30e-6) == pytest.approx(plain_clearance(-26e-6, -30e-6, ANGLES), abs=1e-19)
    assert np.all(of(1e-6, 0.0) > 0)
    assert np.all(of(0.0, -1e-6) > 0)


def test_bounds_of_the_equidistant_modification() -> None:
    found = rv_wear(PAPER)
    low, high = float(found.equidistant_low), float(found.equidistant_high)
    assert high * 1e3 == pytest.approx(0.0111, abs=5.01e-5)  # printed 0.011
    assert low * 1e3 == pytest.approx(-0.05375, abs=5.01e-6)  # printed -0.053
    at_high, above = (plain_clearance(x, x - 4e-6, ANGLES).min() for x in (high, high + 1e-7))
    assert at_high > -1e-18
    assert above < -5e-11
    at_low, below = (plain_clearance(x, x - 4e-6, ANGLES).max() for x in (low, low - 1e-7))
    assert at_low == pytest.approx(8e-6, rel=1e-5)
    assert below > 8e-6


def test_lower_bound_by_the_approach_is_its_own_approach() -> None:
    (low,) = discs.lowest_by_approach(PAPER)
    there = worn(replace(PAPER, equidistant_modification=low, shift_modification=low - 4e-6))
    assert plain_clearance(low, low - 4e-6, ANGLES).max() == pytest.approx(there["approach"], rel=1e-5)
    (narrow,) = discs.lowest_by_approach(replace(PAPER, disc_width=0.016))
    assert narrow * 1e3 == pytest.approx(-0.0537, abs=0.002)  # both readings agree for a width of about 16 mm


# Contact


def test_line_contact() -> None:
    """Equation 1b with the full width of the contact, 2 b, and equation 5."""
    number = float(np.asarray(geometry.depth_number(MESH, -0.068, 0.0047)))
    compliance = 2 * (1 - 0.3**2) / (pi * 2.06e11 * 0.02)
    for force in (10.0, 3390.0):
        width = sqrt(8 * force * 0.0047 * (1 - 0.3**2) / (pi * 0.02 * 2.06e11))
        approach = compliance * force * (2 / 3 + log(16 * 0.005 * 0.068 / (2 * width) ** 2))
        assert geometry.force_of(MESH, approach, number) == pytest.approx(force, rel=1e-13)
        assert geometry.mean_pressure(MESH, force, 0.0047) == pytest.approx(force / (2 * width * 0.02), rel=1e-14)
    assert geometry.force_of(MESH, -1e-6, number) == 0


def test_force_of_an_approach_is_lamberts_function() -> None:
    """F (n - ln F) = w has the solution w / -W(-w exp(-n)), on the lower branch; exp(-n) is as exact as n eps."""
    approach, number = np.meshgrid(np.geomspace(1e-12, 1e-4, 200), np.linspace(17, 26, 25))
    wanted = approach / geometry.compliance(MESH)
    force = wanted / -lambertw(-wanted * np.exp(-number), -1).real
    np.testing.assert_allclose(geometry.force_of(MESH, approach, number), force, rtol=ROUNDING)


# Forces


@pytest.mark.parametrize("load_sharing", ["linear", "hertz"])
@pytest.mark.parametrize("torque", [30.0, 1724.8, 4000.0])
def test_without_clearance_all_pins_bear(torque: float, load_sharing: str) -> None:
    choices = Choices(load_sharing=load_sharing, phases=64)
    teeth, loads = unworn(replace(MESH, equidistant=0.0, shift=0.0, torque=torque, choices=choices))
    assert np.all(loads.force > 0)
    assert len(teeth.angle) == 20
    if load_sharing == "linear":
        assert 1 / np.mean(1 / loads.scale) == pytest.approx(4 * torque / (K_1 * 39 * 0.1145), rel=1e-6)
        assert MESH.start_force == pytest.approx(4 * 1724.8 / (K_1 * 39 * 0.1145), rel=1e-14)


@pytest.mark.parametrize("load_sharing", ["linear", "hertz"])
@pytest.mark.parametrize("pins", [40, 41, 25])
def test_torque_is_held_in_every_position_and_step(pins: int, load_sharing: str) -> None:
    torques, sharing = np.array([300.0, 3136.0, 5000.0]), {"load_sharing": load_sharing}
    reducer = replace(PAPER, pin_count=pins, eccentricity=K_1 * 0.1145 / pins, output_torque=torques, **sharing)
    teeth = teeth_of(mesh_of(reducer))
    arm = reducer.eccentricity * (pins - 1) / 0.0022 / 39 * lever(teeth.angle)
    wanted = 0.55 * torques
    for step, state in zip(range(40), states(teeth), strict=False):
        told = slice(state.pin, state.pin + len(state.loads.force))  # the others bear nothing
        held = (state.loads.force * arm[told]).sum(axis=0)
        assert held / wanted == pytest.approx(np.ones_like(held), rel=1e-9), step
        assert np.all(state.loads.force >= 0)
        assert np.all(state.loads.force[teeth.angle[told, :, 0] >= pi] == 0)


@pytest.mark.parametrize("hertz", [False, True])
@pytest.mark.parametrize("torque", [100.0, 1724.8, 3000.0])
def test_every_force_approaches_disc_and_pin_by_what_its_clearance_leaves(torque: float, hertz: bool) -> None:
    """Equations 1b and 2, pin by pin: by its own radii, or in proportion to the approach at the longest arm."""
    _, loads = unworn(replace(MESH, torque=torque, choices=Choices(load_sharing="hertz" if hertz else "linear")))
    soft = 2 * (1 - 0.3**2) / (pi * 2.06e11 * 0.02)

    def approach(force: Any, at: Any) -> Any:
        s = np.sqrt(1 + K_1**2 - 2 * K_1 * np.cos(at))
        rho = 0.1145 * s**3 / (K_1 * 41 * np.cos(at) - (1 + 40 * K_1**2)) + 0.005
        radius = np.abs(rho * 0.005 / (rho - 0.005))
        width = 2 * np.sqrt(8 * force * radius * (1 - 0.3**2) / (pi * 0.02 * 2.06e11))
        return soft * force * (2 / 3 + np.log(16 * 0.005 * np.minimum(np.abs(rho), 0.1145) / width**2))

    for position in (0, 3, 7):
        psi = 2 * pi * (np.arange(20) + (position + 0.5) / 8) / 40
        force, scale = loads.force[:, position, 0], loads.scale[position, 0]
        arm, most = lever(psi) / (0.0022 * 39), approach(scale, PSI_0)
        gap = plain_clearance(-26e-6, -30e-6, psi)
        left = arm * (most + np.min(gap / arm)) - gap
        bears = left > 0
        assert np.all(force[~bears] == 0)
        assert np.sum(force * lever(psi)) == pytest.approx(torque, rel=1e-10)
        expected = approach(force[bears], psi[bears]) if hertz else force[bears] / scale * most
        assert expected == pytest.approx(left[bears], rel=1e-9, abs=1e-15)


def test_forces_of_the_paper() -> None:
    new = worn(PAPER)
    assert new["start_force"] == pytest.approx(2010, abs=0.501)
    assert new["max_force"] == pytest.approx(3390, abs=5.01)
    assert new["largest_force"] == pytest.approx(3390, abs=5.01)
    assert new["max_pressure"] * 1e-6 == pytest.approx(1133, abs=0.501)
    assert new["loaded_pins"] == 11
    _, loads = unworn(MESH)
    assert loads.approach.mean() * 1e6 == pytest.approx(5.97, abs=0.00501)
    assert set((loads.force > 0).sum(axis=0).ravel()) == {10, 11}
    profile = discs.flank(PAPER)
    assert degrees(profile.angle[profile.force[0].argmax()]) == pytest.approx(39, abs=0.501)
    loaded = np.degrees(profile.angle[profile.force[0] > 0])
    assert loaded[0] == pytest.approx(9, abs=4)
    assert loaded[-1] == pytest.approx(100, abs=5)


# What cannot be; geometry that cannot be built is refused in ``end_to_end/test_plugins_refuse.py``


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"output_torque": 1e13}, ["output_torque", "unit"]),
        ({"disc_width": float("nan")}, ["disc_width", "greater than zero"]),
        ({"reconstruction_depth": 1e-10}, ["reconstructions", "reconstruction_depth", "working_time"]),
        ({"reconstruction_depth": 5e-6}, ["reconstruction_depth", "3 %", "approach"]),  # deeper than the wear
        ({"reconstruction_depth": 0.2e-6}, ["reconstruction_depth"]),
        ({"output_torque": 500.0, "working_time": 6e4 * 3600, "reconstruction_depth": 0.06e-6}, ["approach"]),
        ({"output_torque": 0.1}, ["phases", "loaded_pins"]),
    ],
)
def test_what_would_decide_the_wear_is_refused_by_name(changes: dict[str, float], words: list[str]) -> None:
    with pytest.raises(InfeasibleError) as caught:
        worn(replace(PAPER, **changes))
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    "changes",
    [
        {"eccentricity": 2.5e-3}, {"pin_radius": 8.97e-3}, {"shift_modification": -26e-6}, {"output_torque": 20000.0},
        {"equidistant_modification": 11.1e-6, "shift_modification": 7.1e-6},
        {"equidistant_modification": -200e-6, "shift_modification": -204e-6}, {"output_torque": 0.1, "phases": 200},
    ],
)  # fmt: skip
def test_what_is_only_unusual_is_calculated(changes: dict[str, float]) -> None:
    found = worn(replace(PAPER, **changes))
    assert np.isfinite([found["max_wear"], found["max_force"], found["max_pressure"]]).all()


def test_a_step_is_not_too_deep_for_a_wear_that_never_reaches_it() -> None:
    """Within the first step wear grows evenly, whatever its size: new discs and short times are calculated."""
    short = replace(PAPER, working_time=np.array([0.0, 36.0]))
    deep = worn(replace(short, reconstruction_depth=5e-6))
    assert deep["max_wear"] == pytest.approx(worn(short)["max_wear"], rel=1e-12)


def test_meshes_that_two_threads_calculated_at_once_are_forgotten_one_group_after_the_other(monkeypatch) -> None:
    """A thread asks for A while another asks for A and B; then B is asked for again, and others drive out both."""
    monkeypatch.setattr(wear, "MOST_REMEMBERED", 3)
    loads = {"A": 1000.0, "B": 1100.0, "C": 1200.0, "D": 1300.0}

    def meshes(names: str) -> geometry.Mesh:
        return geometry.many(replace(MESH, torque=np.array([loads[name] for name in names])))

    calls: list[int] = []

    def calculated(mesh: geometry.Mesh) -> int:
        calls.append(len(np.atleast_1d(mesh.torque)))
        if len(calls) == 1:
            asked("AB")
        return len(calls)

    memory = wear.Remembered(calculated)

    def asked(names: str) -> None:
        assert sum(len(places) for places, _, _ in memory.of(meshes(names), np.arange(len(names)))) == len(names)

    for names in ("A", "B", "C", "D", "AB"):
        asked(names)
    assert calls == [1, 2, 1, 1, 2]  # both were forgotten and are calculated again
