"""Tooth roots of internal gears as a shaper cutter really makes them: the exact envelope of its rounded tip.

All lengths are in modules. ISO 6336-3 takes the section of an internal gear where the tangent at the fillet makes 60
degrees with the axis of the tooth; the substitute rack of ``roots`` takes 30 degrees, as GB/T 3480-1997 does.
"""

from dataclasses import dataclass

import numpy as np

from gear_geometry.involute import involute
from gear_geometry.pairs import working_angle
from gear_geometry.roots import Arm, Root
from truing import Float

NORMAL = np.pi / 6.0  # rad; between the normal of the fillet and the axis of the tooth, for a tangent of 60 degrees
STEPS = 30
CLOSE = 1e-11  # rad
FARTHEST = 0.5 * np.pi  # rad


@dataclass(frozen=True, kw_only=True)
class Cutter:
    """A pinion cutter: teeth, profile shift, addendum above its shifted reference circle, radius of its rounding."""

    teeth: Float
    shift: Float
    addendum: Float
    fillet: Float


def cut_ring_root(cutter: Cutter, teeth: Float, shift: Float, pressure_angle: Float) -> Root:
    """Return the critical section of a ring (teeth > 0, shift positive outward) that this cutter makes.

    The rounding of the cutter's tip has its centre on an involute of the same base circle; while the pitch circles roll
    on one another the normal of the fillet goes through the pitch point, and Euler and Savary give its curvature. NaN
    where the tip is pointed before it is round, where cutter and ring do not mesh, or have their pitch points at the
    very centre of the rounding.
    """
    working = working_angle((shift - cutter.shift) / (teeth - cutter.teeth), pressure_angle)
    base, place = 0.5 * cutter.teeth * np.cos(pressure_angle), 0.5 * cutter.teeth + cutter.shift + cutter.addendum
    centre, pitch = place - cutter.fillet, base / np.cos(working)
    half = _half_angle(cutter, centre, base, pressure_angle)
    tooth = np.pi / teeth
    turned = _turned(centre / pitch, half * cutter.teeth / teeth - tooth - NORMAL, cutter.teeth / teeth)
    rolled = (half - turned) * cutter.teeth / teeth - tooth
    distance = pitch * (teeth - cutter.teeth) / cutter.teeth
    along = distance * np.cos(rolled) + centre * np.cos(rolled + turned) + cutter.fillet * np.cos(NORMAL)
    across = distance * np.sin(rolled) + centre * np.sin(rolled + turned) + cutter.fillet * np.sin(NORMAL)
    return Root(chord=-2.0 * across, fillet=cutter.fillet + _trochoid(centre, pitch, turned, distance), depth=along)


def _half_angle(cutter: Cutter, radius: Float, base: Float, pressure_angle: Float) -> Float:
    """Return the angle of the centre of the tip rounding from the axis of the cutter's tooth, rad; NaN below 0."""
    with np.errstate(invalid="ignore"):
        there = involute(np.arccos(base / radius))
    at_reference = (0.5 * np.pi + 2.0 * cutter.shift * np.tan(pressure_angle)) / cutter.teeth
    found = np.asarray(at_reference + involute(pressure_angle) - there - cutter.fillet / base)
    return np.where(found >= 0.0, found, np.nan)


def _turned(ratio: Float, constant: Float, slope: Float) -> Float:
    """Solve nu(t) - slope t + constant = 0 by Newton; nu is the direction of the rounding seen from the pitch point.

    ``ratio`` is the radius of the rounding's centre over the pitch radius of the cutter; below 1 the centre lies on the
    near side of the pitch point, and nu is where the line through both goes outward. NaN where nothing is found.
    """
    angle = (NORMAL - 0.0 * constant) * (ratio - 1.0) / ratio
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            away = 1.0 + ratio**2 - 2.0 * ratio * np.cos(angle)
            missed = _direction(ratio, angle) - slope * angle + constant
            angle = angle - missed / (ratio * (ratio - np.cos(angle)) / away - slope)
        missed = _direction(ratio, angle) - slope * angle + constant
    return np.where((np.abs(missed) <= CLOSE) & (np.abs(angle) < FARTHEST), angle, np.nan)


def _direction(ratio: Float, angle: Float) -> Float:
    direction: Float = np.arctan(ratio * np.sin(angle) / (ratio * np.cos(angle) - 1.0))
    return direction


def _trochoid(centre: Float, pitch: Float, turned: Float, distance: Float) -> Float:
    """Return the radius of curvature of the path of the rounding's centre (Euler and Savary).

    Lengths are counted from the pitch point outward: below 0 where the centre lies on the near side.
    """
    outward = centre * np.cos(turned) - pitch
    away = np.copysign(np.hypot(centre * np.sin(turned), outward), outward)
    rolling = pitch * (pitch + distance) / distance  # 1 / (1/pitch of the cutter - 1/pitch of the ring)
    return away**2 / (away + rolling * outward / away)


def cut_ring_arm(root: Root, teeth: Float, shift: Float, tip_radius: Float, pressure_angle: Float) -> Arm:
    """Return the arm of a force at the tip of a ring, along its line of action; ``tip_radius`` in modules."""
    base = 0.5 * teeth * np.cos(pressure_angle)
    with np.errstate(invalid="ignore"):
        there = np.arccos(base / tip_radius)
    half = (0.5 * np.pi - 2.0 * shift * np.tan(pressure_angle)) / teeth + involute(there) - involute(pressure_angle)
    return Arm(height=root.depth - base / np.cos(there + half), angle=there + half)
