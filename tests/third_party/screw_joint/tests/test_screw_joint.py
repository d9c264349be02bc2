"""The tests a stranger's project needs: the kit, and one number of its own."""

import pytest
from screw_joint import SCREW_JOINT
from screw_joint.physics import joint

from truing.testing import conformance

test_screw_joint = conformance(SCREW_JOINT)


def test_the_joint_of_the_standard() -> None:
    assert joint(SCREW_JOINT.inputs(tightening_torque="84 N*m")).preload == pytest.approx(43.0e3, rel=0.02)
