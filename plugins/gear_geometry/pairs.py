"""Involutes, and two involute gears in mesh: working pressure angle, contact ratio and specific sliding."""

import numpy as np

from truing import Float

# The involute function and its inverse

STEPS = 8


def involute(angle: Float) -> Float:
    """Return tan(angle) - angle, rad, of a pressure angle in radians within (-pi/2, pi/2)."""
    return np.tan(angle) - angle


def angle_of_involute(value: Float) -> Float:
    """Return the pressure angle, rad, whose involute is ``value``; NaN below 0.

    Newton from above: the cube root of three times the value and arctan(value + pi/2) both exceed the angle, and the
    smaller of them is close at either end of 0 <= value; eight steps reach the last digits of a float for all of it.
    """
    wanted = np.asarray(value, dtype=float)
    with np.errstate(invalid="ignore", divide="ignore"):
        known = np.where(wanted >= 0.0, wanted, np.nan)
        angle = np.minimum(np.cbrt(3.0 * known), np.arctan(known + 0.5 * np.pi))
        for _ in range(STEPS):
            tangent = np.tan(angle)
            step = (tangent - angle - known) / tangent**2
            angle = np.where(known > 0.0, angle - step, known)
    return angle if wanted.ndim else float(angle)


# Two involute gears in mesh: working pressure angle, contact ratio and specific sliding, external and internal
#
# Reference: ISO 21771. An internal pair has z_ring > 0 here, and a shift of the ring is positive outward; with the
# negative tooth number of the standard the shift of the ring changes its sign.


def transverse_angle(pressure_angle: Float, helix_angle: Float) -> Float:
    """Return the pressure angle of the transverse section, rad."""
    return np.arctan(np.tan(pressure_angle) / np.cos(helix_angle))


def base_helix_angle(pressure_angle: Float, helix_angle: Float) -> Float:
    """Return the helix angle at the base cylinder, rad."""
    value: Float = np.arcsin(np.sin(helix_angle) * np.cos(pressure_angle))
    return value


def working_angle(shift_per_tooth: Float, pressure_angle: Float, transverse: Float | None = None) -> Float:
    """Return the transverse working pressure angle without backlash, rad; NaN where no pair has these shifts.

    ``shift_per_tooth`` is (x1 + x2)/(z1 + z2) of an external pair and (x_ring - x_pinion)/(z_ring - z_pinion) of an
    internal one; ``pressure_angle`` is that of the rack, ``transverse`` that of the transverse section (default: spur).
    """
    start = pressure_angle if transverse is None else transverse
    return angle_of_involute(involute(start) + 2.0 * np.tan(pressure_angle) * shift_per_tooth)


def shift_per_tooth(working: Float, pressure_angle: Float, transverse: Float | None = None) -> Float:
    """Return the shift per tooth that gives this working angle without backlash: the inverse of ``working_angle``."""
    start = pressure_angle if transverse is None else transverse
    return (involute(working) - involute(start)) / (2.0 * np.tan(pressure_angle))


def working_angle_at(centre_distance: Float, base_distance: Float) -> Float:
    """Return the working pressure angle at a centre distance; ``base_distance`` is the sum (or difference) of the base
    radii. NaN where the base circles are farther apart than the centres.
    """
    with np.errstate(invalid="ignore"):
        return np.arccos(base_distance / centre_distance)


def external_contact_ratio(tip: tuple[Float, Float], base: tuple[Float, Float], working: Float, pitch: Float) -> Float:
    """Return the transverse contact ratio of two external gears.

    Tip and base radii of both, m; ``working`` pressure angle, rad; transverse base ``pitch``, m.
    """
    with np.errstate(invalid="ignore"):
        addendum = sum(np.sqrt(outer**2 - inner**2) for outer, inner in zip(tip, base, strict=True))
    return (addendum - (base[0] + base[1]) * np.tan(working)) / pitch


def internal_contact_ratio(teeth: tuple[Float, Float], tip_angle: tuple[Float, Float], working: Float) -> Float:
    """Return the contact ratio of a pinion in a ring: teeth and tip pressure angles of (pinion, ring)."""
    pinion = teeth[0] * (np.tan(tip_angle[0]) - np.tan(working))
    ring = teeth[1] * (np.tan(tip_angle[1]) - np.tan(working))
    return (pinion - ring) / (2.0 * np.pi)


def clear_of_base(teeth: tuple[Float, Float], ring_tip_angle: Float, working: Float) -> Float:
    """Return z_pinion tan(a_w) - z_ring (tan(a_w) - tan(a_tip)): above 0 the tip of the ring meets an involute."""
    return teeth[0] * np.tan(working) - teeth[1] * (np.tan(working) - np.tan(ring_tip_angle))


def internal_sliding(teeth: tuple[Float, Float], tip_angle: tuple[Float, Float], working: Float) -> tuple[Float, Float]:
    """Return the magnitudes of specific sliding of (pinion, ring), each at its root, where the other's tip meets it.

    Specific sliding is 1 - v_other/v_own, with the speeds along the flanks. NaN for the pinion where the tip of the
    ring meets it below its base circle.
    """
    difference = teeth[1] - teeth[0]
    room = clear_of_base(teeth, tip_angle[1], working)
    at_ring_tip = np.tan(working) - np.tan(tip_angle[1])
    at_pinion_tip = np.tan(tip_angle[0]) - np.tan(working)
    with np.errstate(divide="ignore", invalid="ignore"):
        pinion = np.where(np.asarray(room) > 0.0, difference * at_ring_tip / room, np.nan)
        ring = difference * at_pinion_tip / (teeth[1] * np.tan(working) + teeth[0] * at_pinion_tip)
    return np.abs(pinion), np.abs(ring)


def internal_tip_sliding(
    teeth: tuple[Float, Float], tip_angle: tuple[Float, Float], working: Float
) -> tuple[Float, Float]:
    """Return the magnitudes of specific sliding of (pinion, ring), each at its own tip, the other end of its flank.

    Sliding changes in one direction along the path of contact, so that the larger of root and tip is the largest on the
    path; it is the root's wherever the pitch point lies well within the path.
    """
    difference = teeth[1] - teeth[0]
    tips, middle = (np.tan(tip_angle[0]), np.tan(tip_angle[1])), np.tan(working)
    pinion = difference * (tips[0] - middle) / (teeth[1] * tips[0])
    ring = difference * (middle - tips[1]) / (teeth[0] * tips[1])
    return np.abs(pinion), np.abs(ring)
