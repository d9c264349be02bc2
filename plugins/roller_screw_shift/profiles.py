"""The outlines of the teeth: involutes, the root fillet that a rack leaves on the roller, and a round one on the ring.

All lengths are in metres, every outline is one half of a tooth from its tip to its root, beside an axis through its
middle: complex numbers, the axis of the tooth upward from the centre of the gear, the flank to the right.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_geometry.involute import involute
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.quantities import Pair
from roller_screw_shift.strength import roller_fillet

Outline = NDArray[np.complex128]
POINTS = 60
HALVINGS = 60


def roller_half(pair: Pair) -> Outline:
    """Return half a tooth of the roller: tip, involute, and the envelope of the rounded edge of its rack."""
    roller = geometry_of(pair).roller
    fillet = _rack_fillet(pair)
    radius = np.linspace(float(roller.tip_radius), abs(fillet[0]), POINTS)
    half = (0.5 * np.pi + 2.0 * float(pair.roller_shift) * np.tan(pair.pressure_angle)) / float(pair.roller_teeth)
    angle = half + involute(pair.pressure_angle) - involute(_angle(float(roller.base_radius), radius))
    flank = radius * np.exp(1j * (0.5 * np.pi - angle))
    tip = _arc(float(roller.tip_radius), 0.0, float(angle[0]))
    foot = _arc(float(abs(fillet[-1])), _across(fillet[-1]), np.pi / float(pair.roller_teeth))
    return np.concatenate([tip, flank, fillet, foot])


def _rack_fillet(pair: Pair) -> Outline:
    """Return the fillet of the roller from its flank to its root, m.

    The edge of the rack is a circle; while the rack rolls on the reference circle, its normal through the pitch point
    marks the point that stays. The axis of the tooth is half a pitch beside the gap that the rack cuts.
    """
    teeth, rho, fillet = float(pair.roller_teeth), float(pair.roller_fillet), roller_fillet(pair)
    height = float(np.asarray(fillet.height))  # of the centre of the circle over the rolling line, below 0
    along = np.linspace(-height / np.tan(pair.pressure_angle), 0.0, POINTS)
    centre = along + 1j * height
    point = centre + rho * centre / np.abs(centre) + 0.5j * teeth
    turned = 2.0 * (along - _offset(pair)) / teeth
    gap = point * np.exp(1j * turned)  # beside the axis of the gap, its flank to the right
    return np.asarray(float(pair.module) * _mirrored(gap * np.exp(1j * np.pi / teeth)))


def _offset(pair: Pair) -> float:
    """The centre of the rounding beside the middle of the tooth of the rack, in modules."""
    alpha, rho = pair.pressure_angle, pair.roller_fillet
    depth = pair.addendum + pair.clearance
    return float(0.25 * np.pi - depth * np.tan(alpha) - (1.0 - np.sin(alpha)) * rho / np.cos(alpha))


def _mirrored(points: Outline) -> Outline:
    """The same on the other side of the axis."""
    return np.asarray(-points.conjugate())


def ring_half(pair: Pair) -> Outline:
    """Return half a tooth of the ring: tip, involute, and a round fillet that touches flank and root circle."""
    ring, rho = geometry_of(pair).ring, float(pair.ring_fillet) * float(pair.module)
    root, base, tip = float(ring.root_radius), float(ring.base_radius), float(ring.tip_radius)
    low, high = tip, root
    for _ in range(HALVINGS):  # the circle of the fillet touches the flank where its centre is rho below the root
        middle = 0.5 * (low + high)
        low, high = (middle, high) if abs(_fillet_centre(pair, middle, base, rho)) < root - rho else (low, middle)
    radius = np.linspace(tip, low, POINTS)
    flank = radius * np.exp(1j * (0.5 * np.pi - _ring_angle(pair, radius, base)))
    centre = _fillet_centre(pair, low, base, rho)
    first, last = np.angle((flank[-1] - centre) / 1j), np.angle(centre / 1j)
    fillet = centre + 1j * rho * np.exp(1j * np.linspace(first, last, POINTS))
    foot = _arc(root, _across(fillet[-1]), np.pi / float(pair.ring_teeth))
    return np.concatenate([_arc(tip, 0.0, _across(flank[0])), flank, fillet, foot])


def _ring_angle(pair: Pair, radius: Any, base: float) -> Any:
    """Half the angle of the tooth of the ring at a radius: half a pitch less half a gap, which is as a tooth."""
    shift = float(np.asarray(geometry_of(pair).ring_shift))
    gap = (0.5 * np.pi + 2.0 * shift * np.tan(pair.pressure_angle)) / pair.ring_teeth
    return np.pi / pair.ring_teeth - (gap + involute(pair.pressure_angle) - involute(_angle(base, radius)))


def _fillet_centre(pair: Pair, radius: float, base: float, rho: float) -> complex:
    """The centre of a circle that touches the flank of the ring at this radius from within the gap."""
    pressure = float(_angle(base, radius))
    place = 0.5 * np.pi - float(_ring_angle(pair, radius, base))
    return complex((radius - 1j * rho * np.exp(-1j * pressure)) * np.exp(1j * place))


def _angle(base: float, radius: Any) -> Any:
    return np.arccos(np.clip(base / radius, -1.0, 1.0))


def _across(point: complex) -> float:
    """The angle of a point to the right of the axis."""
    return float(0.5 * np.pi - np.angle(point))


def _arc(radius: float, first: float, last: float) -> Outline:
    return np.asarray(radius * np.exp(1j * (0.5 * np.pi - np.linspace(first, last, 12))))


def toothing(half: Outline, teeth: float, numbers: range, middle: float = 0.0) -> Outline:
    """Return the outline of these teeth from left to right; ``middle`` is the place of number 0, in pitches."""
    tooth = np.concatenate([_mirrored(half)[::-1], half])
    return np.concatenate([tooth * np.exp(-2j * np.pi * (number + middle) / teeth) for number in numbers])
