"""The involute function and its inverse."""

import numpy as np

from truing import Float

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
