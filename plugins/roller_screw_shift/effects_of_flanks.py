"""What the flanks do to one another, and heat to their distance: wear, friction, a centre distance that grows."""

from dataclasses import replace

import numpy as np

from roller_screw_shift.answers import Meshing
from roller_screw_shift.conditions import TEMPERATURE
from roller_screw_shift.loads import load_of
from roller_screw_shift.quantities import Pair
from truing import Float

MILLION = 1e6
RATED_FORCE = 51.943  # N, of a mesh under 10 kN of axial load
LEAST_SPEED = 1.0 / 60.0  # turns per second: below it friction is that at one turn per minute
TURN = 2.0 * np.pi
ROUGHNESS = 0.8  # um, Ra of the flanks
DENSITY = 0.88  # g/cm³ of the oil
VISCOSITY_AT_FORTY = 100.0  # mm²/s, ISO VG 100
FORTY = 313.15  # K
SLOPE = 3.567  # of its viscosity over temperature: 11.1 mm²/s at 100 degC
ADDED = 0.7  # mm²/s, in the law of the viscosity


def thermal_centre_distance(pair: Pair, *, expansion: Float, temperature: Float) -> Pair:
    """The threads that hold the rollers at their distance expand, and the ring does not, or by less."""
    growth = expansion * pair.centre_distance * (temperature - TEMPERATURE.zero)
    return replace(pair, centre_distance_deviation=pair.centre_distance_deviation + growth)


def flank_wear(pair: Pair, meshing: Meshing, *, rate: Float, cycles: Float) -> Meshing:
    """Flanks wear with load, sliding and meshes: the roller by its cycles, the ring by those of all rollers.

    ``rate`` is the depth after a million cycles with 51.943 N on the mesh and a specific sliding of 1. While a flank
    passes the contact of width 2b it slides by 2b times its specific sliding. The depth is the roller's deepest; the
    backlash grows by what both flanks lose where they touch, at the worse end of the path, as an arc.
    """
    worn = rate * load_of(pair).tangential_force / RATED_FORCE * cycles / MILLION
    deepest = np.maximum(meshing.root_sliding_roller, meshing.tip_sliding_roller)
    at_ring_tip = meshing.root_sliding_roller + meshing.ring_meshes * meshing.tip_sliding_ring
    at_roller_tip = meshing.tip_sliding_roller + meshing.ring_meshes * meshing.root_sliding_ring
    gap = worn * np.maximum(at_ring_tip, at_roller_tip) / np.cos(meshing.mounted_angle)
    return replace(meshing, wear_depth=meshing.wear_depth + worn * deepest, backlash=meshing.backlash + gap)


def mesh_friction(pair: Pair, meshing: Meshing, *, factor: Float, screw_speed: Float, temperature: Float) -> Meshing:
    """The flanks rub: the torque that it takes to turn the screw against it has the sign of the speed.

    ``factor`` is the friction over that of the formula.
    """
    torque = factor * np.sign(screw_speed) * friction_torque(pair, meshing, np.abs(screw_speed), temperature)
    return replace(meshing, friction_torque=meshing.friction_torque + torque)


def friction_torque(pair: Pair, meshing: Meshing, speed: Float, temperature: Float) -> Float:
    """Return the torque at the screw, N m, by which the meshes of all rollers with one ring rub; speed in turns/s.

    Loss of power: tangential force times speed of the pitch circles times mu times the loss factor of the mesh.
    """
    load = load_of(pair)
    pitch_speed = (
        load.carrier_order * meshing.base_radius_ring / np.cos(meshing.mounted_angle)
    )  # per rad/s of the screw
    friction = mean_friction(pair, meshing, pitch_speed * TURN * np.maximum(speed, LEAST_SPEED), temperature)
    return pair.rollers * load.tangential_force * pitch_speed * friction * loss_factor(pair, meshing)


def loss_factor(pair: Pair, meshing: Meshing) -> Float:
    """Return the loss of power of a mesh over its power and mu: sliding, with the load shared evenly by the pairs.

    pi (1/z_E - 1/z_I) (1 - eps + eps_E² + eps_I²) of a spur pair with 1 <= eps <= 2. Reference: Ohlendorf 1958.
    """
    working = np.tan(meshing.mounted_angle)
    at_roller_tip = pair.roller_teeth * (np.tan(meshing.tip_angle_roller) - working) / TURN
    at_ring_tip = pair.ring_teeth * (working - np.tan(meshing.tip_angle_ring)) / TURN
    both = 1.0 - at_roller_tip - at_ring_tip + at_roller_tip**2 + at_ring_tip**2
    return np.pi * (1.0 / pair.roller_teeth - 1.0 / pair.ring_teeth) * both


def mean_friction(pair: Pair, meshing: Meshing, pitch_speed: Float, temperature: Float) -> Float:
    """Return the mean coefficient of friction of the flanks, from the pitch point; speed in m/s, temperature in K.

    0.048 (F_bt/b / (v_S rho))^0.2 eta^-0.05 Ra^0.25 with N/mm, m/s, mm, mPa s and um. Fitted to gear drives with
    larger line loads than a roller has; the factor of the effect takes up what that does.
    Reference: ISO/TR 14179-2.
    """
    sine = np.sin(meshing.mounted_angle)
    roller = meshing.base_radius_roller * np.tan(meshing.mounted_angle)
    ring = meshing.base_radius_ring * np.tan(meshing.mounted_angle)
    radius_mm = 1e3 * roller * ring / (ring - roller)
    line_load = 1e-3 * load_of(pair).tangential_force / (np.cos(pair.pressure_angle) * pair.face_width)  # N/mm
    together = 2.0 * pitch_speed * sine
    oil = (DENSITY * viscosity(temperature)) ** -0.05
    mean: Float = 0.048 * (line_load / (together * radius_mm)) ** 0.2 * oil * ROUGHNESS**0.25
    return mean


def viscosity(temperature: Float) -> Float:
    """Return the kinematic viscosity of the oil, mm²/s: log log (nu + 0.7) falls with log T. Reference: ASTM D341."""
    found: Float = 10.0 ** (np.log10(VISCOSITY_AT_FORTY + ADDED) * (temperature / FORTY) ** -SLOPE) - ADDED
    return found
