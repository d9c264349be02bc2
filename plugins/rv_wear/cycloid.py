"""Geometry of the cycloid disc: arm and curvature at every contact, clearance after grinding, profile.

The phase angle psi of a pin is measured from the crank line; contacts lie at 0 < psi < pi. All lengths in m. Sources:
Li, and Malhotra and Parameswaran, Mechanism and Machine Theory 18(6), 1983, for arm and curvature; equations G1 to G3
in the plugin's theory page.
"""

import numpy as np
from numpy.typing import NDArray

from rv_wear.mesh import Array, Mesh
from truing import Float


def pin_distance(mesh: Mesh, angle: Float) -> Float:
    """S(psi): distance of the pin from the pitch point over the radius of the pin circle."""
    short_width = mesh.short_width
    return np.sqrt(1.0 + short_width**2 - 2.0 * short_width * np.cos(angle))


def arm(mesh: Mesh, angle: Float) -> Float:
    """Arm of the contact force about the centre of the disc; longest at ``longest_arm_angle``."""
    return mesh.longest_arm * relative_arm(mesh, angle)


def relative_arm(mesh: Mesh, angle: Float) -> Float:
    """The arm over the longest one, 0 to 1."""
    return np.sin(angle) / pin_distance(mesh, angle)


def longest_arm_angle(mesh: Mesh) -> Float:
    """Phase angle of the longest arm, arccos K_1."""
    return np.arccos(mesh.short_width)


def centre_path_curvature(mesh: Mesh, angle: Float) -> Float:
    """Curvature 1/rho_0 of the path of the pin centre in the disc, 1/m; below 0 where the tooth is convex."""
    short_width, pins = mesh.short_width, mesh.choices.pin_count
    bend = short_width * (pins + 1) * np.cos(angle) - (1.0 + pins * short_width**2)
    return bend / (mesh.pin_circle_radius * pin_distance(mesh, angle) ** 3)


def profile_radius(mesh: Mesh, angle: Float) -> Float:
    """Radius of curvature rho of the flank; below 0 where it is convex, infinite where it is straight."""
    return 1.0 / centre_path_curvature(mesh, angle) + mesh.pin_radius


def relative_radius(mesh: Mesh, angle: Float) -> Float:
    """Radius R' of the equivalent cylinder on a plane: |rho r_rp / (rho - r_rp)|, finite throughout."""
    return mesh.pin_radius * np.abs(1.0 + mesh.pin_radius * centre_path_curvature(mesh, angle))


def smallest_convex_radius(mesh: Mesh) -> Float:
    """Least radius of the path of the pin centre where the tooth is convex; a larger pin undercuts the disc.

    In u = S^2 the radius is 2 r_p u^1.5 / ((z_p + 1) u - (z_p - 1) q^2), least at u = 3 q^2 (z_p - 1) / (z_p + 1) or
    at the end of the flank.
    """
    pins, square = mesh.choices.pin_count, 1.0 - mesh.short_width**2
    lowest, highest = (1.0 - mesh.short_width) ** 2, (1.0 + mesh.short_width) ** 2
    at = np.clip(3.0 * square * (pins - 1) / (pins + 1), lowest, highest)
    return mesh.pin_circle_radius * 2.0 * at**1.5 / ((pins + 1) * at - (pins - 1) * square)


def clearance(mesh: Mesh, angle: Float) -> Float:
    """Normal clearance of the unworn disc, turned until the pin at the longest arm touches; below 0: interference.

    Written with the factor (cos psi - K_1)^2 that all its terms share, so it is exactly 0 at the longest arm. It is
    Delta r_rp (1 - sin psi / S) - Delta r_p (1 - K_1 cos psi - q sin psi) / S.
    """
    short_width, sine, cosine = mesh.short_width, np.sin(angle), np.cos(angle)
    distance = pin_distance(mesh, angle)
    by_equidistant = 1.0 / (distance + sine)
    by_shift = 1.0 / (1.0 - short_width * cosine + mesh.root * sine)
    bracket = mesh.equidistant * by_equidistant - mesh.shift * by_shift
    return (cosine - short_width) ** 2 / distance * bracket


def highest_equidistant(mesh: Mesh) -> Float:
    """Largest equidistant modification of equation 17: above it disc and pins interfere, Delta r / (1 - q)."""
    return mesh.radial_clearance / (1.0 - mesh.root)


def lowest_equidistant(mesh: Mesh, largest: Float | None = None, points: int = 121) -> Float:
    """Smallest equidistant modification of equation 17 at this radial clearance: a number or (m,).

    Below it the clearance somewhere exceeds *largest*: twice the radial clearance where nothing is given, or for
    example the approach under load. Found at *points* phase angles, refined by a parabola through the best three.
    """
    limit = 2.0 * mesh.radial_clearance if largest is None else largest
    axes = max(np.ndim(mesh.short_width), np.ndim(limit))
    angle = np.linspace(0.0, np.pi, points)[1:-1].reshape(-1, *([1] * axes))
    sine, cosine, distance = np.sin(angle), np.cos(angle), pin_distance(mesh, angle)
    by_equidistant = 1.0 - sine / distance
    by_shift = (1.0 - mesh.short_width * cosine - mesh.root * sine) / distance
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = (limit - mesh.radial_clearance * by_shift) / (by_equidistant - by_shift)
    bound = np.where(by_equidistant - by_shift < -1e-9, bound, -np.inf)
    return _refined_maximum(bound)


def _refined_maximum(values: Array) -> Float:
    """The maximum along the first axis of equidistant samples, with the parabola through it and its neighbours."""
    place = np.clip(values.argmax(axis=0), 1, len(values) - 2)
    before, at, after = (np.take_along_axis(values, (place + step)[None], axis=0)[0] for step in (-1, 0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        top = at - (after - before) ** 2 / (8.0 * (after - 2.0 * at + before))
    refined: Float = np.where(np.isfinite(top), top, values.max(axis=0))
    return refined


def profile(mesh: Mesh, turn: Float) -> tuple[Float, Float]:
    """Points (x, y) of the ground disc in its own frame, over the disc's turn t = psi / z_c relative to the pins.

    Without modifications the theoretical profile; with them the disc as ground with pins of r_rp + Delta r_rp on the
    circle r_p + Delta r_p, the eccentricity as it is.
    """
    pins, throw = mesh.choices.pin_count, mesh.eccentricity
    circle, pin = mesh.pin_circle_radius + mesh.shift, mesh.pin_radius + mesh.equidistant
    x = circle * np.cos(turn) - throw * np.cos(pins * turn)
    y = circle * np.sin(turn) - throw * np.sin(pins * turn)
    x_speed = -circle * np.sin(turn) + throw * pins * np.sin(pins * turn)
    y_speed = circle * np.cos(turn) - throw * pins * np.cos(pins * turn)
    speed = np.hypot(x_speed, y_speed)
    return x - pin * y_speed / speed, y + pin * x_speed / speed


def contact_angles(pin_count: int, phases: int) -> NDArray[np.float64]:
    """Phase angles (pins, phases) at which the disc is looked at: one side of the disc, so many positions per pitch."""
    pins = np.arange((pin_count + 1) // 2)[:, None]
    return 2.0 * np.pi * (pins + (np.arange(phases) + 0.5) / phases) / pin_count
