"""A cycloid disc among its pins without clearance: contact geometry, forces, resultant and sliding in closed form.

The phase angle psi of a pin is measured from the line of the eccentricity at the centre of the pin circle; pins at
0 < psi < pi carry. The pitch point P lies on that line at K_1 r_p, and every contact force passes through it. With
rigid bodies and equal springs at the pins a pin carries in proportion to its arm, F = F_max sin(psi)/S. Sums over the
pins are taken as integrals. From 20 pins on and up to K_1 = 0.85 they differ by less than a tenth of a percent from the
mean over a pitch (10 pins: 0.6 %); within a pitch a sum along the eccentricity changes by 2 %, and the pin that carries
most by 1 %. SI throughout, numbers or arrays. References: Malhotra and Parameswaran, Mechanism and Machine Theory 18
(1983); the integrals are derived on the theory page of gear geometry.
"""

import numpy as np

from truing import Float


def pin_distance(short_width: Float, angle: Float) -> Float:
    """Return S: distance of the pin from the pitch point over the radius of the pin circle."""
    return np.sqrt(1.0 + np.square(short_width) - 2.0 * short_width * np.cos(angle))


def path_curvature(short_width: Float, pins: Float, pin_circle: Float, angle: Float) -> Float:
    """Return the curvature of the path of the pin centre in the disc, 1/m; below 0 where the tooth is convex."""
    bend = short_width * (pins + 1.0) * np.cos(angle) - (1.0 + pins * np.square(short_width))
    return bend / (pin_circle * pin_distance(short_width, angle) ** 3)


def relative_radius(short_width: Float, pins: Float, sizes: tuple[Float, Float], angle: Float) -> Float:
    """Return the radius of the cylinder that touches a plane as flank and pin touch, m; ``sizes``: pin circle, pin."""
    return sizes[1] * np.abs(1.0 + sizes[1] * path_curvature(short_width, pins, sizes[0], angle))


def least_convex_radius(short_width: Float, pins: Float, pin_circle: Float) -> Float:
    """Return the least radius of the path of the pin centre where the tooth is convex, m; a larger pin undercuts.

    In u = S^2 the radius is 2 r_p u^1.5 / ((z_p + 1) u - (z_p - 1) q^2) with q^2 = 1 - K^2, least at
    u = 3 q^2 (z_p - 1) / (z_p + 1) or at the end of the flank.
    """
    square = 1.0 - np.square(short_width)
    at = np.clip(3.0 * square * (pins - 1.0) / (pins + 1.0), (1.0 - short_width) ** 2, (1.0 + short_width) ** 2)
    return pin_circle * 2.0 * at**1.5 / ((pins + 1.0) * at - (pins - 1.0) * square)


def largest_force(torque: Float, short_width: Float, pins: Float, pin_circle: Float) -> Float:
    """Return F_max, N: the force of the pin with the longest arm, of a torque about the centre of the disc, N m."""
    return 4.0 * torque / (short_width * (pins - 1.0) * pin_circle)


def resultant(torque: Float, short_width: Float, pins: Float, pin_circle: Float) -> tuple[Float, Float]:
    """Return the sum of all contact forces across the line of the eccentricity and along it, N.

    Across it is the torque over the radius of the disc's pitch circle whatever the sharing, since all forces pass
    through P. Along it, below 0, is towards the centre of the pin circle:
    F_max z_p / (2 pi) ((1 - K²) ln((1 + K)/(1 - K)) - 2 K)/(2 K²).
    """
    k = short_width
    across = torque * pins / (k * pin_circle * (pins - 1.0))
    spread = ((1.0 - k**2) * np.log((1.0 + k) / (1.0 - k)) - 2.0 * k) / (2.0 * k**2)
    return across, largest_force(torque, k, pins, pin_circle) * pins / (2.0 * np.pi) * spread


def sliding_share(short_width: Float, pins: Float, sizes: tuple[Float, Float]) -> Float:
    """Return lost over passed power per coefficient of friction, of pins that do not turn, with the cranks at rest.

    A contact slides with r_p S - r_rp times the turning of the disc against the pins, which is the 1/z_p part of that
    of the disc: 4 (1 - r_rp/r_p)/(pi K_1 z_c). ``sizes``: pin circle, pin.
    """
    return 4.0 * (1.0 - sizes[1] / sizes[0]) / (np.pi * short_width * (pins - 1.0))
