"""What effects of gear models share: load over the face, a resonance, the viscosity of an oil, one wave per turn."""

import numpy as np

from truing import Float, Unknown

FORTY = 313.15  # K, at which the viscosity of an oil is stated
SLOPE = 3.567  # of an ISO VG 100 oil with viscosity index 95: 100 mm²/s at 40 degC and 11.1 mm²/s at 100 degC
ADDED = 0.7  # mm²/s, in the law of the viscosity


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


def viscosity_at(temperature: Float, at_forty: Float) -> Float:
    """Return the kinematic viscosity, mm²/s, from that at 40 degC, mm²/s: log log (nu + 0.7) falls with log T.

    The temperature in K. For mineral oils of viscosity index about 95, 0 to 150 degC; others have another slope.
    Reference: ASTM D341.
    """
    return 10.0 ** (np.log10(at_forty + ADDED) * (temperature / FORTY) ** -SLOPE) - ADDED


def wave(angle: Float, cosine: Float, sine: Float) -> Float:
    """Return one harmonic of an angle."""
    return cosine * np.cos(angle) + sine * np.sin(angle)


def wave_unknowns(limit: float, unit: str, of: str, cosine: str = "cosine", sine: str = "sine") -> list[Unknown]:
    """Declare both parts of one harmonic."""
    return [
        Unknown(cosine, -limit, limit, unit, f"in proportion to the cosine of {of}"),
        Unknown(sine, -limit, limit, unit, f"in proportion to the sine of {of}"),
    ]
