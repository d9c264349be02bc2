"""What the drive must do: ratio, efficiency, torque, and the sizes of pin circle and centre distance they ask for.

Equations 1 to 8 of the paper. Everything takes numbers or arrays that broadcast, SI, and returns the same. Torques of
the search are those at the output.
"""

import numpy as np

from rv_gearing.quantities import Gearing
from truing import Float

POWER_TO_TORQUE = 9550.0 / 60000.0  # N m of a watt at one turn per second, as rounded by the paper; 1/(2 pi) to 7e-5


def torque_of(power: Float, speed: Float) -> Float:
    """Return the torque, N m, of a power (W) at a speed (turns per second), with the paper's 9550."""
    return POWER_TO_TORQUE * power / speed


def ratio_of(sun: Float, planet: Float, pins: Float) -> Float:
    """Return input turns over output turns, equation 1: output by the carrier, one tooth fewer on the disc than pins.

    The product of planet and pins comes first, so that a ratio that is a whole number is one exactly.
    """
    return 1.0 + planet * pins / sun


def mesh_efficiency(stage: Gearing, tooth_ratio: Float, pins: Float) -> Float:
    """Return the efficiency of both meshes, eta_16 of equation 8, for planet teeth over sun teeth and a pin number.

    It is the ratio with a lossy mesh over the ratio without, i~/i; with both mesh efficiencies at 1 it is 1.
    """
    k = pins / (pins - 1.0)
    sharing = tooth_ratio * k
    lossy = k - stage.cycloid_efficiency
    return (k - 1.0) * (lossy + sharing * stage.involute_efficiency) / (lossy * (k - 1.0 + sharing))


def efficiency_of(stage: Gearing, sun: Float, planet: Float, pins: Float) -> Float:
    """Return the efficiency from input to output, equations 6 and 7: both meshes and three bearings."""
    return mesh_efficiency(stage, planet / sun, pins) * stage.bearing_efficiency**3


def output_torque(stage: Gearing, efficiency: Float) -> Float:
    """Return the torque at the output, N m, that the power gives at the output speed."""
    return torque_of(stage.power, stage.output_speed) * efficiency


def pin_circle_factors(stage: Gearing) -> tuple[Float, Float]:
    """Return the least and the largest factor of the pin circle in force: one and the same for one pin circle."""
    high = stage.pin_circle_low if stage.window == "one_pin_circle" else stage.pin_circle_high
    return stage.pin_circle_low, high


def centre_distance_of(stage: Gearing, sun: Float, planet: Float) -> Float:
    """Return the centre distance of the reference circles, m; profile shifts come on top of it."""
    return 0.5 * stage.module * (sun + planet) / np.cos(stage.helix_angle)


def centre_distance_window(stage: Gearing, torque: Float) -> tuple[Float, Float]:
    """Return the least and the largest centre distance, m, that pin circles for this output torque admit."""
    low, high = pin_circle_factors(stage)
    size = np.cbrt(torque)
    return stage.centre_share_low * low * size, stage.centre_share_high * high * size


def pin_circle_window(stage: Gearing, torque: Float, centre_distance: Float) -> tuple[Float, Float]:
    """Return the least and the largest radius of the pin circle, m, for this torque and this centre distance.

    The first exceeds the second where there is none.
    """
    low, high = pin_circle_factors(stage)
    size = np.cbrt(torque)
    return (
        np.maximum(centre_distance / stage.centre_share_high, low * size),
        np.minimum(centre_distance / stage.centre_share_low, high * size),
    )
