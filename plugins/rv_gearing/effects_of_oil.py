"""What follows the oil: how far its heat drives the gears apart, and what it holds back at any torque."""

from dataclasses import replace

import numpy as np

from rv_gearing.answers import Strength
from rv_gearing.duty import centre_distance_of
from rv_gearing.loads import load_of
from rv_gearing.quantities import Gearing
from truing import Float

ROOM = 293.15  # K: at 20 degC the gears are as far apart as on the drawing
FORTY = 313.15  # K, at which the viscosity of an oil is stated
SLOPE = 3.567  # of an ISO VG 100 oil with viscosity index 95: 100 mm²/s at 40 degC and 11.1 mm²/s at 100 degC
MM2_S = 1e-6
ADDED = 0.7  # mm²/s, in the law
REFERENCE = 100.0 * MM2_S * 1000.0 / 60.0  # m²/s times turns per second: 100 mm²/s at 1000 r/min
LEAST_TORQUE = 1e-9  # N m, of an idle sun


def centre_distance_growth(stage: Gearing, *, expansion: Float) -> Gearing:
    """Housing and carrier part sun and planet as they get warm; ``expansion`` is theirs less that of the gears."""
    load = load_of(stage)
    growth = expansion * centre_distance_of(stage, load.sun, load.planet) * (stage.oil_temperature - ROOM)
    return replace(stage, centre_distance_deviation=stage.centre_distance_deviation + growth)


def viscosity_at_work(stage: Gearing) -> Float:
    """Return the kinematic viscosity at the temperature of the oil, m²/s: log log (nu + 0.7) falls with log T.

    For mineral oils of viscosity index about 95, 0 to 150 degC; others have another slope. Reference: ASTM D341.
    """
    at_forty = np.log10(stage.viscosity / MM2_S + ADDED)
    return MM2_S * (10.0 ** (at_forty * (stage.oil_temperature / FORTY) ** -SLOPE) - ADDED)


def speed_dependent_loss(stage: Gearing, strength: Strength, *, constant: Float, viscous: Float) -> Strength:
    """Seals, bearings and oil hold the sun back at any torque: efficiency less M_0/T_1, not below 0.

    ``viscous`` is the part of M_0 that grows with viscosity times speed to the power 2/3, at 100 mm²/s and 1000 r/min.
    T_1 is the torque that was calculated without M_0, so the loss is meant to be small beside it.
    """
    load = load_of(stage)
    product = viscosity_at_work(stage) * load.input_speed
    held_back = constant + viscous * np.cbrt(product / REFERENCE) ** 2
    loss = held_back / np.maximum(load.sun_torque, LEAST_TORQUE)
    return replace(strength, efficiency=np.maximum(strength.efficiency - loss, 0.0))
