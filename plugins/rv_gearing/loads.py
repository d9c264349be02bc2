"""What the first stage carries: torque of the sun, speed relative to the carrier, and the force of one mesh.

The housing is fixed and the output turns with the carrier, so a mesh sees the sun turn by 1 - 1/i of its speed. Speeds
are in turns per second, everything else in SI; a value is a number or an array (n,).
"""

from dataclasses import dataclass

import numpy as np

from gear_geometry.pairs import transverse_angle
from rv_gearing.duty import efficiency_of, ratio_of, torque_of
from rv_gearing.groups import chosen_teeth
from rv_gearing.quantities import Gearing
from truing import Float, either

LEAST_LINE_LOAD = 1.0  # N/m; what an idle mesh counts as loaded with where something is divided by the load


@dataclass(frozen=True, kw_only=True)
class Load:
    """What one mesh of sun and planet carries; the force is nominal, without any load factor."""

    sun: Float
    planet: Float
    pins: Float
    ratio: Float
    efficiency: Float
    asked_torque: Float
    sun_torque: Float
    input_speed: Float
    mesh_speed: Float
    tangential_force: Float
    line_load: Float
    direction: Float
    base_radii: tuple[Float, Float]


def load_of(stage: Gearing) -> Load:
    """Return the load of a stage: by torque and speed where they are given, else by power and output speed.

    The line load is that of the width that carries, with the application factor, and never 0. The direction is the sign
    of the load torque, +1 where there is none.
    """
    teeth = chosen_teeth(stage)
    ratio = ratio_of(teeth.sun, teeth.planet, teeth.pins)
    efficiency = efficiency_of(stage, teeth.sun, teeth.planet, teeth.pins)
    speed = either(stage.input_speed, stage.output_speed * ratio)
    reduction = ratio * efficiency
    asked = np.abs(either(stage.load_torque, torque_of(stage.power, speed) * reduction))
    torque = either(stage.stated_sun_torque, asked / reduction)
    radii = reference_radii(stage, teeth.sun, teeth.planet)
    force = torque / (stage.planets * radii[0])
    inward = np.cos(transverse_angle(stage.pressure_angle, stage.helix_angle))
    return Load(
        sun=teeth.sun,
        planet=teeth.planet,
        pins=teeth.pins,
        ratio=ratio,
        efficiency=efficiency,
        asked_torque=asked,
        sun_torque=torque,
        input_speed=speed,
        mesh_speed=either(stage.stated_mesh_speed, speed * (1.0 - 1.0 / ratio)),
        tangential_force=force,
        line_load=np.maximum(
            force * stage.application_factor / (stage.carrying_share * stage.face_width), LEAST_LINE_LOAD
        ),
        direction=np.where(stage.load_torque < 0.0, -1.0, 1.0),
        base_radii=(radii[0] * inward, radii[1] * inward),
    )


def reference_radii(stage: Gearing, sun: Float, planet: Float) -> tuple[Float, Float]:
    """Return the reference radii of sun and planet, m."""
    half = 0.5 * stage.module / np.cos(stage.helix_angle)
    return half * sun, half * planet
