"""How a mesh spreads its load over the face, and how a resonance raises it: what effects of gear models share."""

import numpy as np

from truing import Float


def face_factor(ratio: Float) -> Float:
    """Return K_Hbeta of a misaligned pair, from r = F_beta c_gamma b / (2 F): 1 + r, and 2 sqrt(r) beyond 1.

    Above r = 1 the teeth carry over a part of their width only. Reference: ISO 6336-1, method C. Below 0 r counts as 0.
    """
    held = np.maximum(ratio, 0.0)
    return np.where(held <= 1.0, 1.0 + held, 2.0 * np.sqrt(held))


def shaken_by_error(speed_ratio: Float, damping: Float) -> Float:
    """Return N^2/sqrt((1 - N^2)^2 + (2 zeta N)^2): force of a spring that an error of position works, over k times it.

    One degree of freedom at N times its own frequency: m y'' + c y' + k y = -m e'' of the deflection y, with an error e
    of one harmonic. Nothing at rest, in proportion to N^2 below the resonance, 1/(2 zeta) at it, 1 far above it, where
    the mass stands still and the error alone works the spring.
    Reference: Den Hartog, Mechanical vibrations, chapter 2, relative motion of a seismic instrument.
    """
    square = np.square(speed_ratio)
    return square / np.sqrt((1.0 - square) ** 2 + 4.0 * np.square(damping) * square)
