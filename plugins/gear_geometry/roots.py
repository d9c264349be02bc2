"""Tooth roots: of gears made by a rack, of internal gears by the substitute rack, and as a shaper cutter makes them."""

from dataclasses import dataclass

import numpy as np

from gear_geometry.pairs import involute, working_angle
from truing import Float

# Tooth roots of gears made by a rack, and of internal gears by the substitute rack: chord, fillet, arm, form factors
#
# All lengths are in modules. Reference: ISO 6336-3, 30 degree tangent at the root; GB/T 3480-1997 (as DIN 3990-3) for
# the substitute rack. The same formulas serve a load at the tip (Y_Fa, Y_Sa) and one at the outer point of single
# contact (Y_F, Y_S): they differ in the diameter at which the force acts, and are not to be mixed.

TANGENT = np.pi / 3.0  # rad; 60 degrees between the tangent of 30 degrees and the normal of the tooth axis
STEPS = 12


@dataclass(frozen=True, kw_only=True)
class Rack:
    """The basic rack: dedendum and fillet radius in modules, pressure angle in radians."""

    dedendum: Float
    fillet: Float
    pressure_angle: Float


@dataclass(frozen=True, kw_only=True)
class Fillet:
    """How the rounding of a rack lies to its gear: E and G of the standard in modules, H and theta in radians."""

    offset: Float  # E, from the middle of the gap of the rack to the centre of the rounding
    height: Float  # G, of that centre over the pitch line
    constant: Float  # H
    angle: Float  # theta, where the tangent of 30 degrees touches


@dataclass(frozen=True, kw_only=True)
class Root:
    """The critical section of a tooth, in modules: chord, radius of the fillet there, and where it lies."""

    chord: Float
    fillet: Float
    depth: Float  # distance of the section from the gear centre


@dataclass(frozen=True, kw_only=True)
class Arm:
    """Where the force acts on the tooth: bending arm in modules, angle of the force to the normal of its axis, rad."""

    height: Float
    angle: Float


def gap_offset(rack: Rack) -> Float:
    """Return E, from the middle of the gap of the rack to the centre of its rounding; below 0 there is no rounding."""
    alpha = rack.pressure_angle
    return 0.25 * np.pi - rack.dedendum * np.tan(alpha) - (1.0 - np.sin(alpha)) * rack.fillet / np.cos(alpha)


def fillet_of(rack: Rack, teeth: Float, shift: Float) -> Fillet:
    """Return how the rounding of the rack lies to an external gear, with the angle of the 30 degree tangent.

    The angle is NaN where the rack has no such rounding (those of its two flanks would meet before they are round), and
    where the fillet that it makes has no tangent of 30 degrees (few teeth with a large shift).
    """
    offset, height = gap_offset(rack), rack.fillet - rack.dedendum + shift
    constant = (2.0 / teeth) * (0.5 * np.pi - offset) - TANGENT
    angle = np.where(np.asarray(offset) >= 0.0, _tangent_angle(2.0 * height / teeth, constant), np.nan)
    return Fillet(offset=offset, height=height, constant=constant, angle=angle)


def external_root(rack: Rack, teeth: Float, shift: Float, fillet: Fillet | None = None) -> Root:
    """Return the critical section of an external gear; ``teeth`` is the virtual number for a helical one.

    NaN where there is no such section, see ``fillet_of``, whose answer may be handed in.
    """
    rho, fillet = rack.fillet, fillet or fillet_of(rack, teeth, shift)
    g, theta = fillet.height, fillet.angle
    offset = g / np.cos(theta) - rho
    return Root(
        chord=teeth * np.sin(TANGENT - theta) + np.sqrt(3.0) * offset,
        fillet=rho + 2.0 * g**2 / (np.cos(theta) * (teeth * np.cos(theta) ** 2 - 2.0 * g)),
        depth=0.5 * (teeth * np.cos(TANGENT - theta) + offset),
    )


def _tangent_angle(slope: Float, constant: Float) -> Float:
    """Solve theta = slope tan(theta) - constant by Newton from 0; NaN where nothing between 0 and 90 degrees does.

    From 0 the steps go up to the smaller solution where the slope is positive, and come down to the only one after the
    first step where it is negative.
    """
    theta, close = 0.0 * (slope + constant), 1e-12
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            theta = theta - (theta - slope * np.tan(theta) + constant) / (1.0 - slope / np.cos(theta) ** 2)
        solved = np.abs(theta - slope * np.tan(theta) + constant) <= close
    return np.where(solved & (theta >= 0.0) & (theta < 0.5 * np.pi), theta, np.nan)


def external_arm(rack: Rack, teeth: Float, shift: Float, root: Root, diameter: Float) -> Arm:
    """Return the arm of a force on an external gear that acts at ``diameter`` (modules) along the line of action."""
    alpha = rack.pressure_angle
    with np.errstate(invalid="ignore"):
        there = np.arccos(teeth * np.cos(alpha) / diameter)
    half = (0.5 * np.pi + 2.0 * shift * np.tan(alpha)) / teeth + involute(alpha) - involute(there)
    angle = there - half
    height = 0.5 * (np.cos(half) - np.sin(half) * np.tan(angle)) * diameter - root.depth
    return Arm(height=height, angle=angle)


def ring_root(rack: Rack) -> Root:
    """Return the critical section of an internal gear, taken as a rack with the fillet of ``rack``."""
    alpha, rho = rack.pressure_angle, rack.fillet
    chord = 2.0 * (
        0.25 * np.pi + (rack.dedendum - rho) * np.tan(alpha) + rho / np.cos(alpha) - rho * np.cos(np.pi / 6.0)
    )
    return Root(chord=chord, fillet=rho + 0.0 * chord, depth=0.5 * rho + 0.0 * chord)


def ring_arm(rack: Rack, root: Root, addendum: Float) -> Arm:
    """Return the arm of a force at the tip of an internal gear of this ``addendum`` (modules), as a rack."""
    alpha = rack.pressure_angle
    height = rack.dedendum + addendum
    half_thickness = 0.25 * np.pi + (rack.dedendum - height) * np.tan(alpha)
    return Arm(height=height - half_thickness * np.tan(alpha) - root.depth, angle=alpha)


def form_factor(root: Root, arm: Arm, pressure_angle: Float) -> Float:
    """Return Y_Fa or Y_F: nominal bending stress of a tooth of module 1 and width 1 under a tangential force of 1."""
    return 6.0 * arm.height * np.cos(arm.angle) / (root.chord**2 * np.cos(pressure_angle))


def stress_correction(root: Root, arm: Arm) -> Float:
    """Return Y_Sa or Y_S: local over nominal stress; stated for notches 1 <= q_s < 8."""
    slenderness = root.chord / arm.height
    with np.errstate(invalid="ignore"):
        return (1.2 + 0.13 * slenderness) * notch(root) ** (1.0 / (1.21 + 2.3 / slenderness))


def notch(root: Root) -> Float:
    """Return the notch parameter q_s: half the chord over the radius of the fillet."""
    return root.chord / (2.0 * root.fillet)


# Tooth roots of internal gears as a shaper cutter really makes them: the exact envelope of its rounded tip
#
# All lengths are in modules. ISO 6336-3 takes the section of an internal gear where the tangent at the fillet makes 60
# degrees with the axis of the tooth; the substitute rack of ``roots`` takes 30 degrees, as GB/T 3480-1997 does.

NORMAL = np.pi / 6.0  # rad; between the normal of the fillet and the axis of the tooth, for a tangent of 60 degrees
ENVELOPE_STEPS = 30
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
        for _ in range(ENVELOPE_STEPS):
            away = 1.0 + ratio**2 - 2.0 * ratio * np.cos(angle)
            missed = _direction(ratio, angle) - slope * angle + constant
            angle = angle - missed / (ratio * (ratio - np.cos(angle)) / away - slope)
        missed = _direction(ratio, angle) - slope * angle + constant
    return np.where((np.abs(missed) <= CLOSE) & (np.abs(angle) < FARTHEST), angle, np.nan)


def _direction(ratio: Float, angle: Float) -> Float:
    return np.arctan(ratio * np.sin(angle) / (ratio * np.cos(angle) - 1.0))


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
