"""What makes the drive softer or stiffer than its flanks: springs in series, pairs, film, smoothing, heat."""

from dataclasses import replace

import numpy as np

from harmonic_fractal.conditions import TEMPERATURE
from harmonic_fractal.effects_of_friction import RATED_SPEED, rated_torque
from harmonic_fractal.quantities import Drive
from truing import Float

FILM_EXPONENT = 0.67  # of viscosity times speed in the thickness of the film
LOAD_EXPONENT = -0.07  # of the load in it
FILM_THINNING = 0.035  # 1/K, of the viscosity
LEAST_TORQUE = 1e-3  # N*m, from which it is counted
LEAST_GAP = 0.1  # over the film at 1000 rpm and 20 degC: without oil the asperities hold the flanks so far apart
YIELDING = 0.02  # likewise: by which the gap grows while the load of the asperities falls by e (Persson 2007)
STEPS = 8  # of Newton's iteration for the gap; six do, from any speed


def series_compliance(drive: Drive, *, compliance: Float) -> Drive:
    """Cup, wave generator, its bearing and the rig twist in proportion to the torque, beside the mesh."""
    return replace(drive, drive_compliance=drive.drive_compliance + compliance)


def engaged_pairs(drive: Drive, *, gain: Float, torque_scale: Float) -> Drive:
    """The flexspline gives way until more pairs touch: the share ``gain`` more of them at a large torque.

    The torsion is added up with the pairs that there are on the way. Beside a gain that is stated, both are one gain
    of their sum, under their mean torque.
    """
    both = drive.engaged_gain + gain
    share = np.where(both > 0.0, gain / np.where(both > 0.0, both, 1.0), 0.0)
    scale = drive.engaged_torque + share * (torque_scale * rated_torque(drive) - drive.engaged_torque)
    return replace(drive, engaged_gain=both, engaged_torque=scale)


def oil_film(drive: Drive, *, stiffness: Float, speed: Float, temperature: Float) -> Drive:
    """The oil between the flanks carries beside their asperities, the stiffer the thinner it is; at rest it is gone.

    ``stiffness`` is that of a film which fills the flank of a pair at 1000 rpm, 20 degC and T_2 of the catalogue, 25 N
    m for size 20: modulus of compression times flank over thickness. Alone it would be as thick as (viscosity
    speed)^0.67 torque^-0.07 says; the asperities hold the flanks apart at a tenth of that, and the film shares the load
    with them. The asperities' own stiffness is that under the whole load, which is too much by what the film carries.
    """
    flow = np.exp(-FILM_THINNING * (temperature - TEMPERATURE.zero)) * np.abs(speed) / RATED_SPEED
    load = np.maximum(np.abs(drive.torque), LEAST_TORQUE) / rated_torque(drive)
    gap, share = shared(flow**FILM_EXPONENT * load**LOAD_EXPONENT)
    return replace(drive, film_stiffness=drive.film_stiffness + stiffness * share / gap)


def shared(alone: Float) -> tuple[Float, Float]:
    """Return the gap between flanks, over the film at 1000 rpm, and the share of the load that the film carries.

    ``alone`` is how thick the film would be without asperities. At a fixed gap h it carries in proportion to viscosity
    times speed (Reynolds), so (alone/h)^(1/0.67), and the asperities exp(-(h - h_r)/gamma); together that is all of it.
    The sum is convex and falls over h, so Newton's iteration closes in from below.
    """
    gap = np.maximum(alone, LEAST_GAP)
    for _ in range(STEPS):
        asperities, film = np.exp((LEAST_GAP - gap) / YIELDING), (alone / gap) ** (1.0 / FILM_EXPONENT)
        gap = gap + (asperities + film - 1.0) / (asperities / YIELDING + film / (FILM_EXPONENT * gap))
    return gap, (alone / gap) ** (1.0 / FILM_EXPONENT)


def asperity_smoothing(drive: Drive, *, dimension: Float, roughness: Float, cycle_scale: Float, cycles: Float) -> Drive:
    """The finest asperities go first: the dimension rises and G falls, until the flanks have run in.

    ``roughness`` is by how much ln G falls.
    """
    run_in = -np.expm1(-cycles / cycle_scale)
    return replace(
        drive,
        dimension_deviation=drive.dimension_deviation + dimension * run_in,
        roughness_deviation=drive.roughness_deviation - roughness * run_in,
    )


def modulus_temperature(drive: Drive, *, softening: Float, temperature: Float) -> Drive:
    """Warm steel is softer, by the share ``softening`` per kelvin: flanks, teeth and all that twists."""
    left = 1.0 - softening * (temperature - TEMPERATURE.zero)
    return replace(drive, modulus_factor=drive.modulus_factor * left)
