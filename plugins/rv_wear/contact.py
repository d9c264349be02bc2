"""Line contact of disc and pin: half width, approach, and the force that an approach needs; SI, arrays welcome.

Roark's formulas for two cylinders of equal elastic constants; the pins lie in half-round grooves and do not bend.
"""

import numpy as np

from rv_wear.mesh import Mesh
from truing import Float

NEWTON = 4  # steps from the start below; they leave rounding only
LEAST = 2.0 - np.log(2.0)  # of u - ln u; the formula is not followed to where it ends


def compliance(mesh: Mesh) -> Float:
    """2 (1 - nu^2) / (pi E B): approach per force before the logarithm, m/N."""
    return 2.0 / (np.pi * mesh.equivalent_modulus * mesh.width)


def half_width(mesh: Mesh, force: Float, relative_radius: Float) -> Float:
    """Half width b of the contact, sqrt(8 F R' (1 - nu^2) / (pi E B))."""
    return np.sqrt(4.0 * compliance(mesh) * force * relative_radius)


def depth_number(mesh: Mesh, profile_radius: Float, relative_radius: Float) -> Float:
    """What equation 1b is without the force: 2/3 + ln(16 r_rp |rho| F / c^2) with the full width c = 2 b."""
    radius = np.minimum(np.abs(profile_radius), mesh.pin_circle_radius)  # no body is deeper than the disc
    return 2.0 / 3.0 + np.log(mesh.pin_radius * radius / (compliance(mesh) * relative_radius))


def approach(mesh: Mesh, force: Float, number: Float) -> Float:
    """Approach of disc and pin under a force, equation 1b; ``number`` is that of ``depth_number``."""
    return compliance(mesh) * force * (number - np.log(force))


def force_of(mesh: Mesh, approached: Float, number: Float) -> Float:
    """Force that an approach needs: equation 1b solved by Newton's rule; 0 where nothing is approached.

    With u = number - ln F equation 1b reads u - ln u = number - ln(approach / compliance), and F is the ratio over u.
    Valid while the force stays below exp(number - 2); the formula ends at exp(number - 1), about 1e9 N for steel of
    this size.
    """
    wanted = np.maximum(approached, 1e-30) / compliance(mesh)
    sought = np.maximum(number - np.log(wanted), LEAST)
    left = sought + np.log(sought)
    for _ in range(NEWTON):
        left = left - (left - np.log(left) - sought) * left / (left - 1.0)
    return np.where(approached > 0.0, wanted / left, 0.0)


def mean_pressure(mesh: Mesh, force: Float, relative_radius: Float) -> Float:
    """Force over the area of the contact, equation 5; 0 without force."""
    return np.sqrt(np.maximum(force, 0.0) / (16.0 * compliance(mesh) * relative_radius)) / mesh.width
