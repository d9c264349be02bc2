"""The play between discs and pins, point by point: every pin against the ground profile of every disc.

Nothing of the plugin is imported. A disc that was ground with pins of one radius on a circle of another is the inside
parallel curve of the path of their centres; so the gap at a pin is the distance of its centre from that path, beyond
it, and the difference of both radii. Lengths are mm, angles rad.
"""

from dataclasses import dataclass

import numpy as np

from hidden_effects.rows import Array

SHORT_ARM = 0.5  # of the longest; the gap of a pin with less is wide, and the path there is too sharp for a first guess


@dataclass(frozen=True)
class Mesh:
    """Pins as they stand in the housing, and discs as they were ground; numbers or arrays (n, 1, 1)."""

    circle: float | Array
    pin: float | Array
    ground_circle: float | Array
    ground_pin: float | Array
    ground_throw: float | Array
    throw: float | Array
    pins: int = 40


def ends_of_play(
    mesh: Mesh,
    crank_angle: Array,
    offset: tuple[float, float] = (0.0, 0.0),
    discs: int = 2,
    *,
    toothing: Array | None = None,
    ahead: float = 0.0,
) -> Array:
    """How far the output can be turned forward and back, (2, n), at crank angles (n,): to the first pin of any disc.

    The circle of the pins is off by ``offset`` (x, y); the cranks of the discs are evenly spread. The toothing of each
    disc is off its bores by a row of ``toothing`` (discs, 2), in the frame of the output, which stands at minus the
    crank angle over the teeth: there the angles of the crank go on over its turns. The last crank leads by ``ahead``.
    """
    crank = (crank_angle[:, None] + 2 * np.pi * np.arange(discs) / discs)[:, :, None]
    on_circle = (2 * np.pi * np.arange(mesh.pins) / mesh.pins)[None, None, :]
    turned = np.broadcast_to(-crank / (mesh.pins - 1), np.broadcast_shapes(crank.shape, on_circle.shape))
    throw = crank + ahead * (np.arange(discs) == discs - 1)[None, :, None]
    x = mesh.circle * np.cos(on_circle) + offset[0] - mesh.throw * np.cos(throw)
    y = mesh.circle * np.sin(on_circle) + offset[1] - mesh.throw * np.sin(throw)
    if toothing is not None:
        output = (-crank_angle / (mesh.pins - 1))[:, None, None]
        bore_x, bore_y = toothing[None, :, 0, None], toothing[None, :, 1, None]
        x = x - (np.cos(output) * bore_x - np.sin(output) * bore_y)
        y = y - (np.sin(output) * bore_x + np.cos(output) * bore_y)
    step = 1e-6
    here, there = _gap(mesh, x, y, on_circle, turned), _gap(mesh, x, y, on_circle, turned + step)
    slope = (there - here) / step
    angle = np.zeros_like(turned)
    for _ in range(3):
        angle = angle - _gap(mesh, x, y, on_circle, turned + angle) / slope
    arm = SHORT_ARM * np.max(np.abs(slope))
    forward = np.where(slope < -arm, angle, np.inf).min(axis=(1, 2))
    back = np.where(slope > arm, -angle, np.inf).min(axis=(1, 2))
    return np.stack([forward, back])


def _gap(mesh: Mesh, x: Array, y: Array, on_circle: Array, turned: Array) -> Array:
    """Distance of the pins from the profile of a disc that is turned by an angle about its centre."""
    p = np.cos(turned) * x + np.sin(turned) * y, np.cos(turned) * y - np.sin(turned) * x
    circle, throw, pins = mesh.ground_circle, mesh.ground_throw, mesh.pins
    t = on_circle - turned
    for _ in range(5):
        c = circle * np.cos(t) - throw * np.cos(pins * t), circle * np.sin(t) - throw * np.sin(pins * t)
        d = -circle * np.sin(t) + throw * pins * np.sin(pins * t), circle * np.cos(t) - throw * pins * np.cos(pins * t)
        b = (
            -circle * np.cos(t) + throw * pins**2 * np.cos(pins * t),
            -circle * np.sin(t) + throw * pins**2 * np.sin(pins * t),
        )
        off = p[0] - c[0], p[1] - c[1]
        along = off[0] * d[0] + off[1] * d[1]
        t = t + along / (d[0] ** 2 + d[1] ** 2 - off[0] * b[0] - off[1] * b[1])
    beyond = (off[0] * d[1] - off[1] * d[0]) / np.hypot(*d)
    return np.asarray(beyond + mesh.ground_pin - mesh.pin)
