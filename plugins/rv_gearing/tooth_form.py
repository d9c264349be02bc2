"""The outline of a tooth as its rack generates it: root circle, trochoid of the rounded tip, involute, tip circle.

Lengths are in modules, the centre of the gear is the origin and the axis of the tooth points along +y. For drawings.
"""

import numpy as np
from numpy.typing import NDArray

from gear_geometry.involute import involute
from gear_geometry.roots import Rack

Values = NDArray[np.float64]

FINE = 60


def half_space(rack: Rack, teeth: float, shift: float, radii: "Values") -> "Values":
    """Return half the angle of the tooth space, rad, at these radii between root and tip: what the rack leaves open."""
    reference, alpha = 0.5 * teeth, rack.pressure_angle
    at_reference = (0.25 * np.pi - shift * np.tan(alpha)) / reference
    base = float(reference * np.cos(alpha))
    cut_radius, cut_angle = trochoid(rack, teeth, shift)
    flank = at_reference - involute(alpha) + involute(np.arccos(np.minimum(base / radii, 1.0)))
    fillet = np.interp(radii, cut_radius, cut_angle)
    if undercut(rack, teeth, shift):
        return np.where(radii < base, fillet, np.maximum(flank, np.where(radii > cut_radius[-1], -np.inf, fillet)))
    return np.where(radii < cut_radius[-1], fillet, flank)


def undercut(rack: Rack, teeth: float, shift: float) -> bool:
    """Tell whether the tip of the rack cuts into the involute: its straight flank ends below the line of action."""
    alpha = rack.pressure_angle
    depth = rack.dedendum - shift - rack.fillet * (1.0 - np.sin(alpha))
    return bool(depth > 0.5 * teeth * np.sin(alpha) ** 2)


def trochoid(rack: Rack, teeth: float, shift: float, points: int = FINE) -> "tuple[Values, Values]":
    """Return radius and half angle of the space along the fillet, from the root circle outward."""
    alpha, rho, reference = rack.pressure_angle, rack.fillet, 0.5 * teeth
    across = 0.25 * np.pi - rack.dedendum * np.tan(alpha) - (1.0 - np.sin(alpha)) * rho / np.cos(alpha)
    inward = rho - rack.dedendum + shift  # centre of the rounded tip from the rolling line, outward above 0
    roll = np.linspace(across / reference, (across + inward / np.tan(alpha)) / reference, points)
    to_tip = np.array([across - reference * roll, np.full_like(roll, inward)])
    length = np.hypot(*to_tip)
    unit = np.where(length > 0.0, to_tip / np.maximum(length, 1e-300), np.array([[0.0], [-1.0]]))
    along, outward = to_tip + rho * unit
    radius = np.hypot(reference + outward, along)
    angle = roll + np.arctan2(along, reference + outward)
    outermost = int(np.argmax(radius)) + 1  # an undercut fillet comes back inward: only its way out is a flank
    return np.maximum.accumulate(radius[:outermost]), angle[:outermost]


def tooth(rack: Rack, teeth: float, shift: float, tip_radius: float, points: int = 2 * FINE) -> "Values":
    """Return the outline of one tooth (2, k) from the middle of one space over the tip to that of the next.

    ``points`` stand on each flank with its fillet; further ones, a tenth of them, on half the root and half the tip.
    """
    root = 0.5 * teeth - rack.dedendum + shift
    spread = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, points))
    radii = root + (tip_radius - root) * spread
    half_tooth = np.maximum(np.pi / teeth - half_space(rack, teeth, shift, radii), 0.0)
    few = max(points // 10, 2)
    floor = np.linspace(np.pi / teeth, half_tooth[0], few, endpoint=False)
    top = np.linspace(half_tooth[-1], 0.0, few)[1:]
    angle = np.concatenate([floor, half_tooth, top])
    radius = np.concatenate([np.full(few, root), radii, np.full(few - 1, tip_radius)])
    right = np.array([radius * np.sin(angle), radius * np.cos(angle)])
    left = right[:, ::-1] * np.array([[-1.0], [1.0]])
    return np.concatenate([right, left[:, 1:]], axis=1)[:, ::-1]


def turned(points: "Values", angle: float) -> "Values":
    """Return points turned about the origin, against the clock for a positive angle."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]]) @ points


def gear(one: "Values", teeth: float, around: int | None = None) -> "Values":
    """Return the outline of a gear (2, points) from that of one of its teeth; a tooth points along +y.

    Closed, or with ``around`` so many teeth to either side of that tooth, and the centre of the gear.
    """
    pitch = 2.0 * np.pi / teeth
    if around is None or 2 * around + 1 >= round(teeth):
        return np.concatenate([turned(one, -place * pitch) for place in range(round(teeth))], axis=1)
    some = [turned(one, -place * pitch) for place in range(-around, around + 1)]
    return np.concatenate([*some, np.zeros((2, 1))], axis=1)
