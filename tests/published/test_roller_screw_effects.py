"""What the paper leaves out of roller and ring: other pairs than the machine's, and the ends of what can be.

What each effect does is compared with a machine of its own in ``test_effects_of_machines.py``.
"""

from functools import partial
from math import acos, cos, sin, sqrt, tan
from typing import Any

import numpy as np
import pytest
from switched import change, shown

from roller_screw_shift.calculation import roller_screw_shift
from roller_screw_shift.effects import viscosity
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.quantities import Pair

UM, RPM, ALPHA = 1e-6, 1 / 60, np.radians(20)
with_effect: Any = partial(shown, ROLLER_SCREW_SHIFT)
added: Any = partial(change, ROLLER_SCREW_SHIFT)


def pair_at(**settings: Any) -> Pair:
    found: Pair = ROLLER_SCREW_SHIFT.inputs(**settings)
    return found


@pytest.mark.parametrize(
    ("name", "values", "result"),
    [
        ("face_misalignment", {"misalignment": UM, "per_load": 0.0}, "root_stress_roller"),
        ("roller_load_sharing", {"lead": UM}, "root_stress_roller"),
        ("mesh_friction", {"factor": 1.5, "temperature": 313.15, "screw_speed": 10.0}, "friction_torque"),
    ],
)
def test_an_idle_mesh_stays_without_stress_and_friction(name: str, values: dict[str, float], result: str) -> None:
    assert with_effect(name, pair_at(axial_load=0.0), **values)[result] == 0


def test_a_screw_at_rest_has_no_friction() -> None:
    assert added("friction_torque", "mesh_friction", factor=1.5, temperature=313.15, screw_speed=0.0) == 0


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (0.0, 0.0), (1.0, 0.05 / (2 * 0.08)), (-1.0, 0.05 / (2 * 0.08)), (0.1, 0.05 * 0.01 / abs(1 - 0.01 + 0.016j)),
        (sqrt(0.5), 0.05 * 0.5 / abs(0.5 + 2j * 0.08 * sqrt(0.5))), (1e4, 0.05),
    ],
)  # fmt: skip
def test_a_resonance_shakes_the_load(ratio: float, expected: float) -> None:
    """Nothing at rest, A/(2 zeta) at the resonance, A far above it; between them |A N^2 / (1 - N^2 + 2 i zeta N)|."""
    values = {"excitation": 0.05, "resonance_speed": 1800 * RPM, "damping": 0.08, "screw_speed": ratio * 1800 * RPM}
    bare = with_effect()["root_stress_ring"]
    found = with_effect("mesh_resonance", **values)["root_stress_ring"] / bare - 1
    assert found == pytest.approx(expected, rel=1e-7, abs=1e-12)


def test_a_groove_takes_its_share_of_the_face_where_it_is_in_the_mesh() -> None:
    """At its phase, and half a turn of the roller on, of which the screw makes 8/15."""
    bare = with_effect()["root_stress_ring"]
    for turns, expected in ((0.0, 1 / 0.7), (0.5, 1.0), (0.25, 1 / 0.85)):
        angle = (np.radians(300) + turns * 2 * np.pi) / 1.875
        found = with_effect("interrupted_tooth", lost=0.3, phase=np.radians(300), screw_angle=angle)
        assert found["root_stress_ring"] / bare == pytest.approx(expected, rel=1e-9)


def test_one_roller_alone_has_nobody_to_share_with() -> None:
    assert added("root_stress_roller", "roller_load_sharing", pair_at(rollers=1), lead=5 * UM) == 0


def test_orders_follow_the_diameters_and_the_teeth() -> None:
    """A screw twice as thick as its rollers: the carrier makes 1/3 of a turn; 90 teeth on 18 make 5/3 of the roller."""
    other = pair_at(screw_diameter=20e-3, ring_teeth=90.0, roller_teeth=18.0, centre_distance=17.827e-3)
    for name, order in (("carrier_runout", 1 / 3), ("roller_runout", 5 / 3)):
        found = added("transmission_error", name, other, cosine=0.0, sine=UM, screw_angle=0.7)
        assert found == pytest.approx(UM * sin(0.7 * order), rel=1e-12)


@pytest.mark.parametrize(("rollers", "shift"), [(4, 0.21), (7, 1.0)])
def test_both_flanks_wear_by_what_they_slide_mesh_by_mesh(rollers: int, shift: float) -> None:
    """A strip of contact, 1 long, passes both flanks along the path in steps; every carrier turn counts its meshes."""
    pair = pair_at(rollers=rollers, roller_shift=shift)
    meshing = roller_screw_shift(pair)
    base, working = 0.25e-3 * cos(ALPHA), acos(20 * cos(ALPHA) / 19.80778)
    apart = 19.80778e-3 * sin(working)
    begin = 100 * base * tan(float(meshing.tip_angle_ring)) - apart
    at = np.linspace(begin, 20 * base * tan(float(meshing.tip_angle_roller)), 2001)  # radius of the roller
    speeds = at * 5, at + apart  # of both flanks while the carrier makes one turn per second
    slid = [np.abs(speeds[0] - speeds[1]) / speed for speed in speeds]  # while the strip is over a place
    of_roller, of_ring = 100 / 20, rollers  # meshes of one tooth in a turn of the carrier
    turns = 1e6 / of_roller
    worn = [2e-12 * turns * count * way for count, way in zip((of_roller, of_ring), slid, strict=True)]
    values = {"rate": 2 * UM, "cycles": 1e6}
    assert added("wear_depth", "flank_wear", pair, **values) == pytest.approx(worn[0].max(), rel=1e-9)
    felt = (worn[0] + worn[1]).max() / cos(working)
    assert added("backlash", "flank_wear", pair, **values) == pytest.approx(felt, rel=1e-9)


@pytest.mark.parametrize(("celsius", "expected"), [(40.0, 100.0), (100.0, 11.1)])
def test_the_oil_is_that_of_its_class(celsius: float, expected: float) -> None:
    """ISO VG 100 with viscosity index 95: 100 mm²/s at 40 degC and 11.1 mm²/s at 100 degC."""
    assert float(viscosity(celsius + 273.15)) == pytest.approx(expected, rel=3e-3)
