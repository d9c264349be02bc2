"""What the paper leaves out of roller and ring: each effect against its own arithmetic.

Numbers marked as reference follow by hand from the set of the model: 51.943 N on a mesh under 10 kN, 4 mm of face, a
mesh of 14 N/(mm um), a ring and a roller of 100 and 20 teeth of 0.5 mm at 19.80778 mm, working angle 0.321344 rad.
"""

from dataclasses import fields
from functools import cache
from math import acos, cos, log, pi, sin, sqrt, tan
from typing import Any

import numpy as np
import pytest

from roller_screw_shift.calculation import roller_screw_shift
from roller_screw_shift.effects import EFFECTS, friction_torque, loss_factor, mean_friction, viscosity
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.quantities import Pair
from truing import Effect

UM, MPA, DEGREE, RPM = 1e-6, 1e6, pi / 180, 1 / 60
ROOM = 293.15
FORCE, FACE, STIFF = 51.943, 4.0, 14.0  # N, mm, N/(mm um)
FACTORS = {"root_stress_roller": 2.12002 * 1.86315, "root_stress_ring": 1.83107 * 2.84399}
WORKING = 0.321344  # rad
BY_NAME: dict[str, Effect[Any, Any]] = {effect.name: effect for effect in EFFECTS}
BOTH = pytest.mark.parametrize("result", FACTORS)


def pair_at(kilonewtons: float = 10.0, **settings: float) -> Pair:
    """The pair of the model under an axial load."""
    pair: Pair = ROLLER_SCREW_SHIFT.inputs(axial_load=1e3 * kilonewtons, **settings)
    return pair


@cache
def _shown(name: str, pair: Pair, values: tuple[tuple[str, float], ...]) -> dict[str, float]:
    effect, stated = (BY_NAME[name], dict(values)) if name else (None, {})
    if effect is None:
        found = roller_screw_shift(pair)
    elif effect.place == "inputs":
        found = roller_screw_shift(effect.function(pair, **stated))
    else:
        found = effect.function(pair, roller_screw_shift(pair), **stated)
    return {item.name: float(getattr(found, item.name)) for item in fields(found)}


def shown(name: str = "", pair: Pair | None = None, **values: float) -> dict[str, float]:
    """The results in SI with one effect on; unknowns and conditions in SI."""
    return _shown(name, pair or pair_at(), tuple(values.items()))


def change(name: str, result: str, pair: Pair | None = None, **values: float) -> float:
    """What one effect adds to a result, SI."""
    return shown(name, pair, **values)[result] - shown("", pair)[result]


def factor(name: str, result: str, pair: Pair | None = None, **values: float) -> float:
    """By what an effect multiplies a result."""
    return shown(name, pair, **values)[result] / shown("", pair)[result]


# Load


@BOTH
@pytest.mark.parametrize(
    ("load", "gap", "expected"),
    [
        (10.0, 1.0, 1 + STIFF * FACE * 1.0 / (2 * FORCE)),  # 1.539: the whole face carries
        (20.0, 1.0, 1 + STIFF * FACE * 1.0 / (4 * FORCE)),
        (10.0, 2 * FORCE / (STIFF * FACE), 2.0),  # the far end just touches
        (10.0, 8.0, sqrt(2 * 8.0 * STIFF * FACE / FORCE)),  # 4.153: a part of the face carries
        (2.0, 1.5, sqrt(2 * 1.5 * STIFF * FACE / (0.2 * FORCE))),
    ],
)
def test_a_tilted_roller_crowds_the_load_to_one_end(load: float, gap: float, expected: float, result: str) -> None:
    """Triangle of line loads over the face, with a gap at one end: whole, and where a part of it lifts off."""
    assert factor("face_misalignment", result, pair_at(load), misalignment=gap * UM, per_load=0.0) == pytest.approx(
        expected, rel=1e-12
    )


@BOTH
def test_a_tilt_that_grows_with_the_load_is_a_gain(result: str) -> None:
    """Reference: 0.1 um/kN, 14 N/(mm um), 4 mm and 5.1943 N/kN make 1.539 at any load."""
    for load in (-5.0, 1.0, 10.0, 25.0):
        found = factor("face_misalignment", result, pair_at(load), misalignment=0.0, per_load=0.1 * UM / 1e3)
        assert found == pytest.approx(1 + 0.1 * STIFF * FACE / (2 * 5.1943), rel=1e-12)


def test_a_load_that_reverses_tilts_the_other_way() -> None:
    both: dict[str, Any] = {"misalignment": UM, "per_load": 0.1 * UM / 1e3}
    assert factor("face_misalignment", "root_stress_ring", pair_at(-10.0), **both) == pytest.approx(1.0, rel=1e-12)
    assert factor("face_misalignment", "root_stress_ring", pair_at(-4.0), **both) > 1.3


@pytest.mark.parametrize("name", ["face_misalignment", "roller_load_sharing"])
def test_an_idle_mesh_stays_without_stress(name: str) -> None:
    values = {"misalignment": UM, "per_load": 0.0} if name == "face_misalignment" else {"lead": UM}
    assert shown(name, pair_at(0.0), **values)["root_stress_roller"] == 0


@BOTH
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (0.0, 0.0),
        (1.0, 0.05 / (2 * 0.08)),
        (0.1, 0.05 * 0.01 / abs(1 - 0.01 + 0.016j)),
        (sqrt(0.5), 0.05 * 0.5 / abs(0.5 + 2j * 0.08 * sqrt(0.5))),
        (1e4, 0.05),
    ],
)
def test_a_resonance_shakes_the_load(ratio: float, expected: float, sense: int, result: str) -> None:
    """Nothing at rest, A/(2 zeta) at the resonance, A far above it; between them |A N^2 / (1 - N^2 + 2 i zeta N)|."""
    values = {"excitation": 0.05, "resonance_speed": 1800 * RPM, "damping": 0.08}
    for load in (3.0, 20.0):
        speed = sense * ratio * 1800 * RPM
        found = factor("mesh_resonance", result, pair_at(load), screw_speed=speed, **values)
        assert found - 1 == pytest.approx(expected, rel=1e-7, abs=1e-12)


def test_a_roller_that_leads_takes_load_from_the_others() -> None:
    """Reference: 14 * 4 * 0.9 = 50.4 N per micrometre at any load; together ten rollers carry what they did."""
    for load in (5.0, 20.0):
        found = factor("roller_load_sharing", "root_stress_roller", pair_at(load), lead=0.3 * UM) - 1
        assert found * FORCE * load / 10 == pytest.approx(0.3 * 50.4, rel=1e-12)
    stands = np.array([0.2, -0.1, 0.05, 0.0, 0.3, -0.25, 0.1, -0.15, 0.0, 0.4])  # um, of the flanks of all ten
    leads = [stand - (stands.sum() - stand) / 9 for stand in stands]  # before the mean of the nine others
    shares = [factor("roller_load_sharing", "root_stress_ring", lead=lead * UM) for lead in leads]
    assert sum(shares) == pytest.approx(10.0, rel=1e-12)


@BOTH
def test_a_roller_that_stays_behind_far_enough_carries_nothing(result: str) -> None:
    assert shown("roller_load_sharing", pair_at(5.0), lead=-0.52 * UM)[result] == 0
    assert shown("roller_load_sharing", pair_at(5.0), lead=-0.51 * UM)[result] > 0


def test_one_roller_alone_has_nobody_to_share_with() -> None:
    alone: Pair = ROLLER_SCREW_SHIFT.inputs(rollers=1)
    assert factor("roller_load_sharing", "root_stress_roller", alone, lead=5 * UM) == 1


@BOTH
def test_the_groove_of_the_thread_comes_by_once_per_turn_of_the_roller(result: str) -> None:
    """Where it is in the mesh 30 % of the face is gone, half a turn of the roller on nothing; 8 turns of the screw are
    15 of the roller."""
    values = {"lost": 0.3, "phase": 300 * DEGREE}
    there = 300 / 1.875
    for turns, expected in ((0.0, 1 / 0.7), (0.5, 1.0), (7.0, 1 / 0.7), (0.25, 1 / 0.85)):
        angle = (there + turns * 360 / 1.875) * DEGREE
        assert factor("interrupted_tooth", result, screw_angle=angle, **values) == pytest.approx(expected, rel=1e-9)
    over = np.linspace(0, 8 * 2 * pi, 240, endpoint=False)
    orders = np.abs(np.fft.rfft([1 / factor("interrupted_tooth", result, screw_angle=at, **values) for at in over]))
    assert list(np.flatnonzero(orders > 1e-9 * orders[0])) == [0, 15]
    assert orders[0] / 240 == pytest.approx(0.85, rel=1e-12)


def test_a_soft_rim_is_felt_by_the_ring_alone() -> None:
    """Reference: Y_B = 1.15 ln(8.324/2) = 1.640 of a rim of two modules."""
    rim = 1.15 * log(8.324 / 2)
    assert factor("rim_compliance", "root_stress_ring", softness=rim - 1) == pytest.approx(rim, rel=1e-12)
    left = shown("rim_compliance", softness=rim - 1)
    assert {name for name, value in shown().items() if left[name] != value} == {"root_stress_ring"}


# Heat


@pytest.mark.parametrize("warmer", [-5.0, 0.0, 30.0, 60.0])
def test_heat_closes_the_backlash(warmer: float) -> None:
    """Reference: 19.80778 mm * 11.5e-6 / K * 30 K = 6.83 um of centre distance; twice that times the tangent of the
    working angle half way there, 18.41 degrees and a little."""
    further = 19807.78 * 11.5e-6 * warmer
    found = change("thermal_centre_distance", "backlash", expansion=11.5e-6, temperature=ROOM + warmer) / UM
    half_way = acos(20.0 * cos(20 * DEGREE) / (19.80778 + 0.5e-3 * further))
    assert found == pytest.approx(-2 * further * tan(half_way), rel=1e-3, abs=1e-9)
    if warmer == 30:
        assert found == pytest.approx(-4.55, abs=0.01)


# Rotation


@pytest.mark.parametrize(("name", "order"), [("roller_runout", 15), ("carrier_runout", 3)])
def test_every_runout_has_its_order(name: str, order: int) -> None:
    """Over 8 turns of the screw the carrier makes 3, and a roller 15 against it."""
    over = np.linspace(0, 8 * 2 * pi, 256, endpoint=False)
    read = [shown(name, cosine=3 * UM, sine=-2 * UM, screw_angle=at)["transmission_error"] for at in over]
    orders = np.fft.rfft(read) / 128
    assert orders[order] == pytest.approx((3 + 2j) * UM, abs=1e-14)
    assert np.max(np.abs(np.delete(orders, order))) < 1e-15


def test_orders_follow_the_diameters_and_the_teeth() -> None:
    """A screw twice as thick as its rollers: the carrier makes 1/3 of a turn; 90 teeth on 18 make 5/3 of the roller."""
    other = pair_at(screw_diameter=20e-3, ring_teeth=90.0, roller_teeth=18.0, centre_distance=17.827e-3)
    for name, order in (("carrier_runout", 1 / 3), ("roller_runout", 5 / 3)):
        found = change(name, "transmission_error", other, cosine=0.0, sine=UM, screw_angle=0.7)
        assert found == pytest.approx(UM * sin(0.7 * order), rel=1e-12)


@pytest.mark.parametrize(("turns", "micrometres"), [(1.0, 10.0), (-2.5, -25.0), (0.0, 0.0), (100.0, 1000.0)])
def test_a_roller_creeps_by_a_share_of_the_lead(turns: float, micrometres: float) -> None:
    found = change("axial_migration", "axial_shift", mismatch=1e-3, screw_angle=turns * 2 * pi)
    assert found == pytest.approx(micrometres * UM, rel=1e-12, abs=1e-18)


# Flanks


@pytest.mark.parametrize(
    ("load", "cycles", "depth"), [(10.0, 1e6, 2.0), (5.0, 1e6, 1.0), (-10.0, 3e6, 6.0), (10.0, 0.0, 0.0)]
)
def test_wear_follows_load_sliding_and_cycles(load: float, cycles: float, depth: float) -> None:
    """Reference: specific sliding 0.828725 at the root of the roller, and 0.453170 at the tip of the ring there,
    where ten rollers of 20 teeth mesh twice as often in a ring of 100; arc at a working angle of 18.4117 degrees.
    """
    found = change("flank_wear", "wear_depth", pair_at(load), rate=2 * UM, cycles=cycles)
    assert found == pytest.approx(depth * 0.828725 * UM, rel=1e-5, abs=1e-18)
    felt = change("flank_wear", "backlash", pair_at(load), rate=2 * UM, cycles=cycles)
    assert felt == pytest.approx(found * (1 + 2 * 0.453170 / 0.828725) / cos(WORKING), rel=1e-5)


@pytest.mark.parametrize(("rollers", "shift"), [(10, 0.21), (4, 0.21), (7, 1.0)])
def test_both_flanks_wear_by_what_they_slide_mesh_by_mesh(rollers: int, shift: float) -> None:
    """A strip of contact, 1 long, passes both flanks along the path in steps; every carrier turn counts its meshes."""
    pair: Pair = ROLLER_SCREW_SHIFT.inputs(rollers=rollers, roller_shift=shift)
    meshing = roller_screw_shift(pair)
    base, working = 0.25e-3 * cos(20 * DEGREE), acos(20 * cos(20 * DEGREE) / 19.80778)
    apart = 19.80778e-3 * sin(working)
    begin = 100 * base * tan(float(meshing.tip_angle_ring)) - apart
    at = np.linspace(begin, 20 * base * tan(float(meshing.tip_angle_roller)), 2001)  # radius of the roller
    speeds = at * 5, at + apart  # of both flanks while the carrier makes one turn per second
    slid = [np.abs(speeds[0] - speeds[1]) / speed for speed in speeds]  # while the strip is over a place
    of_roller, of_ring = 100 / 20, rollers  # meshes of one tooth in a turn of the carrier
    turns = 1e6 / of_roller
    worn = [2e-12 * turns * count * way for count, way in zip((of_roller, of_ring), slid, strict=True)]
    found = change("flank_wear", "wear_depth", pair, rate=2 * UM, cycles=1e6)
    felt = change("flank_wear", "backlash", pair, rate=2 * UM, cycles=1e6)
    assert found == pytest.approx(worn[0].max(), rel=1e-9)
    assert felt == pytest.approx((worn[0] + worn[1]).max() / cos(working), rel=1e-9)


def test_the_loss_factor_is_the_sliding_along_the_path_of_contact() -> None:
    """The sum of |sliding| over a path whose pairs of teeth share the load evenly, piece by piece."""
    pair = pair_at()
    meshing = roller_screw_shift(pair)
    base, pitch_angle = 0.25e-3 * cos(20 * DEGREE), float(meshing.mounted_angle)
    radii = base * 20, base * 100
    begin = radii[1] * tan(float(meshing.tip_angle_ring)) - 19.80778e-3 * sin(pitch_angle)
    end = radii[0] * tan(float(meshing.tip_angle_roller))
    pitch = 2 * pi * base
    at = begin + (end - begin) * (np.arange(200_000) + 0.5) / 200_000
    pairs = 1 + (at - pitch > begin) + (at + pitch < end)
    sliding = np.abs(at - radii[0] * tan(pitch_angle)) * (1 / radii[0] - 1 / radii[1])  # over the speed at the base
    mean = np.mean(sliding / pairs) * (end - begin) / pitch
    assert float(loss_factor(pair, meshing)) == pytest.approx(mean, rel=1e-4)


def test_friction_is_that_of_the_formula() -> None:
    """By hand at 10 kN, 600 r/min and 40 degC: 13.82 N/mm, pitch speed 1.458 m/s, sum of speeds 0.921 m/s, radius
    2.061 mm, 88 mPa s, Ra 0.8 um."""
    pair = pair_at()
    meshing = roller_screw_shift(pair)
    speed = 0.375 * 2 * pi * 10 * 23.492e-3 / cos(WORKING)
    line, together = FORCE / cos(20 * DEGREE) / FACE, 2 * speed * sin(WORKING)
    radius = 4.6985 * tan(WORKING) * 5 / 4
    expected = 0.048 * (line / (together * radius)) ** 0.2 * 88**-0.05 * 0.8**0.25
    assert float(mean_friction(pair, meshing, speed, 313.15)) == pytest.approx(expected, rel=1e-4)
    assert 0.03 < expected < 0.12
    torque = 10 * FORCE * 0.375 * 23.492e-3 / cos(WORKING) * expected * float(loss_factor(pair, meshing))
    assert float(friction_torque(pair, meshing, 10.0, 313.15)) == pytest.approx(torque, rel=1e-4)


@pytest.mark.parametrize(("celsius", "expected"), [(40.0, 100.0), (100.0, 11.1)])
def test_the_oil_is_that_of_its_class(celsius: float, expected: float) -> None:
    """ISO VG 100 with viscosity index 95: 100 mm²/s at 40 degC and 11.1 mm²/s at 100 degC."""
    assert float(viscosity(celsius + 273.15)) == pytest.approx(expected, rel=3e-3)


@pytest.mark.parametrize(
    ("load", "speed", "expected"),
    [(20.0, 600.0, 2**1.2), (10.0, 1200.0, 2**-0.2), (10.0, -600.0, -1.0), (10.0, 0.0, 0.0), (-10.0, 600.0, 1.0)],
)
def test_friction_opposes_the_turning(load: float, speed: float, expected: float) -> None:
    """Power 1.2 of the load, -0.2 of the speed, the sign of the speed, nothing at rest."""
    here: dict[str, Any] = {"factor": 1.5, "temperature": 313.15}
    one = change("mesh_friction", "friction_torque", screw_speed=600 * RPM, **here)
    found = change("mesh_friction", "friction_torque", pair_at(load), screw_speed=speed * RPM, **here)
    assert found == pytest.approx(expected * one, rel=1e-9, abs=1e-15)
