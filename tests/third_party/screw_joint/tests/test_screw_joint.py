"""The tests a stranger's project needs: the kit, one number of its own, and every effect found where it is hidden."""

from typing import Any

import pytest
from screw_joint import SCREW_JOINT
from screw_joint.physics import joint

from truing.testing import assert_finds, conformance, hide

test_screw_joint = conformance(SCREW_JOINT)


def test_the_joint_of_the_standard() -> None:
    assert joint(SCREW_JOINT.inputs(tightening_torque="84 N*m")).preload == pytest.approx(43.0e3, rel=0.02)


HIDDEN: list[tuple[str, Any, str, str, dict[str, str]]] = [
    ("settling", {"depth": "6 um", "life": "2e4"}, "clamp_left", "0.1 kN",
     {"load_cycles": "0..1e5", "axial_force": "2..12 kN"}),
    ("bending", "0.3", "alternating_stress", "1 MPa", {"axial_force": "2..20 kN"}),
    ("gauge_drift", "20 N/K", "preload", "0.2 kN",
     {"gauge_temperature": "10..50 degC", "tightening_torque": "40..84 N*m"}),
]  # fmt: skip


@pytest.mark.parametrize(("effect", "size", "measure", "noise", "over"), HIDDEN, ids=[case[0] for case in HIDDEN])
def test_what_is_hidden_is_found(effect: str, size: Any, measure: str, noise: str, over: dict[str, str]) -> None:
    assert_finds(hide(effect, size, noise, model=SCREW_JOINT, measure=measure, over=over, seed=1))


def test_every_effect_is_hidden_once() -> None:
    assert {case[0] for case in HIDDEN} == set(SCREW_JOINT.effects)
