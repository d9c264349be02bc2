"""How far disc and pin slide on each other: equations 6 to 8, housing and pins fixed."""

import numpy as np

from rv_wear import cycloid
from rv_wear.mesh import Mesh
from truing import Float


def sliding_speed(mesh: Mesh, angle: Float) -> Float:
    """Sliding speed v_r over the turning speed of the disc against the pins, m: r_p S - r_rp, equation 6."""
    return mesh.pin_circle_radius * cycloid.pin_distance(mesh, angle) - mesh.pin_radius


def rolling_speed(mesh: Mesh, angle: Float) -> Float:
    """Speed v_t of the contact along the flank over the same turning speed, m: r_p S |rho / rho_0|, equation 7."""
    bend = 1.0 + mesh.pin_radius * cycloid.centre_path_curvature(mesh, angle)
    return mesh.pin_circle_radius * cycloid.pin_distance(mesh, angle) * np.abs(bend)


def sliding_ratio(mesh: Mesh, angle: Float) -> Float:
    """Sliding per length of flank, lambda = v_r / v_t; exactly 1 at the longest arm. Times 2 b: path of a point."""
    return sliding_speed(mesh, angle) / rolling_speed(mesh, angle)
