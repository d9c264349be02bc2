"""From the profile shift to geometry, objectives and constraints; one call answers for thousands of shifts."""

import numpy as np

from gear_geometry.pairs import shift_per_tooth, working_angle_at
from gear_geometry.roots import (
    Rack,
    external_arm,
    external_root,
    form_factor,
    ring_arm,
    ring_root,
    stress_correction,
)
from roller_screw_shift.answers import Meshing
from roller_screw_shift.quantities import Pair


def roller_screw_shift(pair: Pair) -> Meshing:
    """The pair at one shift or at a batch of them; every Float is a number or an array (n,), SI."""
    difference = pair.ring_teeth - pair.roller_teeth
    alpha, dedendum = pair.pressure_angle, pair.addendum + pair.clearance
    working = working_angle_at(pair.centre_distance, 0.5 * pair.module * difference * np.cos(alpha))
    ring_shift = pair.roller_shift + difference * shift_per_tooth(working, alpha)
    rack = Rack(dedendum=dedendum, fillet=pair.roller_fillet, pressure_angle=alpha)
    root = external_root(rack, pair.roller_teeth, pair.roller_shift)
    tip = pair.roller_teeth + 2.0 * (pair.addendum + pair.roller_shift)
    arm = external_arm(rack, pair.roller_teeth, pair.roller_shift, root, tip)
    substitute = Rack(dedendum=dedendum, fillet=pair.ring_fillet, pressure_angle=alpha)
    ring = ring_root(substitute)
    ring_lever = ring_arm(substitute, ring, pair.addendum)
    load = pair.tangential_share * np.abs(pair.axial_load) / (pair.carrying_share * pair.face_width * pair.module)
    load = load * pair.face_load_factor * pair.dynamic_factor * pair.sharing_factor
    zero = 0.0 * load
    return Meshing(
        working_angle=working + zero,
        ring_shift=ring_shift + zero,
        root_stress_roller=load * form_factor(root, arm, alpha) * stress_correction(root, arm),
        root_stress_ring=load
        * form_factor(ring, ring_lever, alpha)
        * stress_correction(ring, ring_lever)
        * pair.rim_factor,
        transmission_error=zero,
        wear_depth=zero,
        axial_shift=zero,
        friction_torque=zero,
        backlash=zero,
    )
