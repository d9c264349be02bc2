"""What the torsion owes to friction, play and the first load: terms on the angle, in its own sense of the torque."""

from dataclasses import replace

import numpy as np

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.catalogue import TABLE
from harmonic_fractal.conditions import TEMPERATURE
from harmonic_fractal.quantities import Drive
from truing import Float

MILLION = 1e6
RATED_SPEED = 1000.0 / 60.0  # turns per second


def turned(results: Stiffness, by: Float) -> Stiffness:
    """Return the results with an angle, rad, on the torsion."""
    return replace(results, torsion=results.torsion + by)


def rated_torque(drive: Drive) -> float:
    """Return T_2 of the size in the catalogue, N m: 25 for size 20."""
    return TABLE[drive.catalogue_size][1]


def held_share(
    drive: Drive, torque_scale: Float, direction: Float, reversal_torque: Float, peak_torque: Float
) -> Float:
    """Return what friction holds back, in halves of its loop: 1 once it has slipped on a way up, -1 on a way down.

    +-(1 - 2 exp(-|T - T_rev|/T_c)) after a turn. The first load starts in the middle and slips through in half that
    torque, 1 - exp(-2 |T - T_rev|/T_c), as Masing's rule has it; a loop that closes at its peak meets it there.
    """
    sense = np.sign(direction)
    way = np.abs(drive.torque - reversal_torque) / (torque_scale * rated_torque(drive))
    is_first = (drive.torque >= peak_torque) & (sense > 0.0)
    share: Float = sense * np.where(is_first, -np.expm1(-2.0 * way), 1.0 - 2.0 * np.exp(-way))
    return share


def hysteresis(
    drive: Drive,
    results: Stiffness,
    *,
    loop: Float,
    torque_scale: Float,
    direction: Float,
    reversal_torque: Float,
    peak_torque: Float,
) -> Stiffness:
    """Dry friction holds the angle back by half of the loop: behind a torque that grows, and before one that falls.

    So the loop takes up energy, and is never negative. Range: every turn but that of the first load follows a branch on
    which the friction has slipped through, so several ``torque_scale`` (in parts of T_2) long. Of the direction only
    the sign counts.
    """
    return turned(results, -0.5 * loop * held_share(drive, torque_scale, direction, reversal_torque, peak_torque))


def viscous_hysteresis(
    drive: Drive,
    results: Stiffness,
    *,
    loop: Float,
    torque_scale: Float,
    thinning: Float,
    speed: Float,
    temperature: Float,
    direction: Float,
    reversal_torque: Float,
    peak_torque: Float,
) -> Stiffness:
    """The lubricant adds to the loop, in proportion to its viscosity and to the speed; at rest there is none of it.

    ``loop`` is the width at 1000 rpm and 20 degC; the viscosity falls by exp(-``thinning`` (temperature - 20 degC)).
    """
    viscosity = np.exp(-thinning * (temperature - TEMPERATURE.zero))
    width = loop * viscosity * np.abs(speed) / RATED_SPEED
    return turned(results, -0.5 * width * held_share(drive, torque_scale, direction, reversal_torque, peak_torque))


def crossed(drive: Drive, torque_scale: Float) -> Float:
    """Return the share of a play that is crossed, in the sense of the torque; the scale is in parts of T_2."""
    share: Float = np.tanh(drive.torque / (torque_scale * rated_torque(drive)))
    return share


def lost_motion(drive: Drive, results: Stiffness, *, play: Float, torque_scale: Float) -> Stiffness:
    """The teeth cross their play and come to bear one after another: ``play`` to either side of the middle."""
    return turned(results, play * crossed(drive, torque_scale))


def flank_wear(drive: Drive, results: Stiffness, *, rate: Float, torque_scale: Float, cycles: Float) -> Stiffness:
    """Both flanks of a pair wear in proportion to the cycles in service, and the drive gains so much play.

    Depth k_w p s n of Archard on either flank, with ``rate`` the depth per million cycles at the pressure and sliding
    of its service; 2 depths along the line of action are 2 depths/(r_p cos alpha) at the output. The gap is crossed
    as any other play is.
    """
    gap = 2.0 * rate * cycles / MILLION
    lever = drive.pitch_radius * np.cos(drive.pressure_angle)
    return turned(results, gap / lever * crossed(drive, torque_scale))


def thermal_preload(drive: Drive, results: Stiffness, *, expansion: Float, temperature: Float) -> Stiffness:
    """The circular spline grows more than the flexspline, which opens a gap: the teeth turn until they bear.

    A distance dr across the pitch circle opens r_p dtheta = dr tan(alpha) to either side, with
    dr = ``expansion`` r_p (temperature - 20 degC).
    """
    strain = expansion * (temperature - TEMPERATURE.zero)
    return turned(results, strain * np.tan(drive.pressure_angle) * np.sign(drive.torque))


def first_load_set(drive: Drive, results: Stiffness, *, peak_torque: Float, **unknowns: Float) -> Stiffness:
    """The first load leaves a set behind, and below its peak the flattened flanks are stiffer than they were.

    The set is ``set`` (peak/T_2)^``exponent``, with T_2 = 25 N m for size 20; the mesh is stiffer by the share
    ``stiffening`` wherever the torque is below the largest so far.
    """
    height = np.maximum(peak_torque, 0.0) / rated_torque(drive)
    left = unknowns.get("set", 0.0) * height ** unknowns.get("exponent", 1.0)
    again = np.abs(drive.torque) < peak_torque
    stiffer = 1.0 + np.where(again, unknowns.get("stiffening", 0.0), 0.0)
    return turned(replace(results, mesh_stiffness=results.mesh_stiffness * stiffer), left)
