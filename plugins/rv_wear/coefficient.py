"""The wear coefficient of lubricated steel rollers, and what stretches the time of wear; strictly SI.

Source: Janakiraman, Li and Kahraman, Journal of Tribology 136(3), 031602, 2014: k E' / 3.981e29 = L^1.219 G^-7.377
S_q^1.589 with L = W' / (E' R'), G = alpha E', S_q = R_q / R'. As load, oil and roughness stand in it as powers, oil,
roughness, speed and time only stretch the time of a history: depth = H(exposure).
"""

import numpy as np

from rv_wear.mesh import Mesh
from truing import Float

CONSTANT = 3.981e29
LOAD, VISCOSITY, ROUGHNESS = 1.219, -7.377, 1.589


def lubricant_part(modulus: Float, pressure_viscosity: Float, roughness: Float) -> Float:
    """What oil and surfaces do to the coefficient: 3.981e29 / E' G^-7.377 R_q^1.589, in m^1.589/Pa."""
    return CONSTANT / modulus * (pressure_viscosity * modulus) ** VISCOSITY * roughness**ROUGHNESS


def contact_part(modulus: Float, line_load: Float, relative_radius: Float) -> Float:
    """What force and radius do to the coefficient: L^1.219 R'^-1.589, in m^-1.589."""
    return (line_load / (modulus * relative_radius)) ** LOAD * relative_radius**-ROUGHNESS


def wear_coefficient(modulus: Float, line_load: Float, relative_radius: Float, oil: Float, roughness: Float) -> Float:
    """Coefficient k, 1/Pa, for E' (Pa), W' (N/m), R' (m), pressure-viscosity coefficient (1/Pa) and R_q (m)."""
    return lubricant_part(modulus, oil, roughness) * contact_part(modulus, line_load, relative_radius)


def unworn_share(film_ratio: Float) -> Float:
    """Share of the wear that a film leaves: 1 below Lambda 0.5, 0 above 3."""
    return np.clip((3.0 - film_ratio) / 2.5, 0.0, 1.0)


def film_number(mesh: Mesh, speed: Float, relative_radius: Float) -> Float:
    """Film ratio Lambda but for its load: Lambda = number W^-0.13 with W = F / (B E' R').

    Dowson and Higginson's least film 2.65 R' U^0.7 G^0.54 W^-0.13 over the roughness; *speed* is the mean speed of the
    two surfaces against the contact, m/s.
    """
    film, modulus = mesh.film, mesh.equivalent_modulus
    assert film is not None
    drive = (film.viscosity * speed / (modulus * relative_radius)) ** 0.7
    oil = (film.pressure_viscosity * modulus) ** 0.54
    return film.factor * 2.65 * relative_radius * drive * oil / film.roughness
