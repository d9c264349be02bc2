"""The power law of the structure function of a Weierstrass-Mandelbrot surface, and the conventions of its constant.

**Profile** (Majumdar and Tien 1990, Majumdar and Bhushan 1990). With f_n = gamma^n in cycles per metre

    z(x) = G^(D_s-1) sum_n gamma^((D_s-2) n) [cos phi_n - cos(2 pi gamma^n x + phi_n)]

The mean over the random phases of [z(x + lag) - z(x)]^2 is exactly, for any band,

    S(lag) = G^(2(D_s-1)) sum_n gamma^((2 D_s-4) n) [1 - cos(2 pi gamma^n lag)]

Where the band is wide the sum over n is an integral over d ln(f)/ln(gamma), and with the integral of
(1 - cos u) u^(-1-a) over u from 0 to infinity, Gamma(1-a) cos(pi a/2)/a, a = 4 - 2 D_s,

    S(lag) = C G^(2(D_s-1)) lag^(4-2 D_s),    C = (2 pi)^(4-2 D_s) Lambda(D_s) / ln(gamma),

    Lambda(D_s) = Gamma(2 D_s-3) sin[(2 D_s-3) pi/2] / (4-2 D_s)

Many papers print C without (2 pi)^(4-2 D_s): that belongs to a sum in radians per metre, not to the one above. G from
it is too large by (2 pi)^((2-D_s)/(D_s-1)): 6.3 times at D_s = 1.5, 15.7 times at 1.4.

**Surface** (Yan and Komvopoulos 1998). Its plane waves carry the factor (ln(gamma)/M)^(1/2) in M directions, so that
ln(gamma) cancels and G does not depend on gamma. A trace at the angle beta to a wave sees it lengthened by
1/|cos beta|; many directions give the mean of |cos beta|^(4-2 D_s), Gamma((5-2 D_s)/2)/[pi^(1/2) Gamma(3-D_s)],
which is 2/pi at D_s = 1.5. The dimension of the surface is D = D_s + 1.

The sum with a ratio gamma is scale-invariant in steps of gamma only: S has a ripple about the power law, at gamma = 1.5
of relative half-amplitude 0.4 % at D_s = 1.2, 3.3 % at 1.5 and 17 % at 1.8.
"""

from typing import Literal

import numpy as np
from scipy.special import gamma

from truing import Float

Convention = Literal["areal", "one_direction", "profile"]


def spectral_constant(dimension: Float) -> Float:
    """Return Lambda of a profile dimension D_s, a pure number; finite for 1 < D_s < 2, pi/2 at 1.5.

    Written by the reflection formula as pi / [2 sin(pi a/2) Gamma(1 + a)] with a = 4 - 2 D_s: the same number, but
    without 0 times infinity at D_s = 1.5.
    """
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    value: Float = np.pi / (2.0 * np.sin(np.pi * exponent / 2.0) * gamma(1.0 + exponent))
    return value


def constant(dimension: Float, density: Float, convention: Convention) -> Float:
    """Return C of S = C G^(2(D_s-1)) lag^(4-2 D_s), a pure number, of this convention of G.

    ``dimension`` is D_s of the profile, 1 to 2; ``density`` is gamma, which only the convention "profile" contains.
    ``areal``: a surface of waves in many directions, any trace; ``one_direction``: parallel waves, trace across them.
    """
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    one_direction: Float = (2.0 * np.pi) ** exponent * spectral_constant(dimension)
    if convention == "profile":
        return one_direction / np.log(density)
    if convention == "one_direction":
        return one_direction
    mean_of_directions: Float = gamma((1.0 + exponent) / 2.0) / (np.sqrt(np.pi) * gamma(1.0 + exponent / 2.0))
    return one_direction * mean_of_directions


def converted(roughness: Float, dimension: Float, density: Float, *, source: Convention, target: Convention) -> Float:
    """Return G, m, of one convention in another one: the surface, its S, stays the same.

    G_B = G_A (C_A/C_B)^(1/(2(D_s-1))); ``dimension`` is D_s of the profile, 1 to 2.
    """
    ratio = constant(dimension, density, source) / constant(dimension, density, target)
    changed: Float = roughness * ratio ** (1.0 / (2.0 * (np.asarray(dimension) - 1.0)))
    return changed


def log_roughness_of(
    intercept: Float, dimension: Float, density: float = 1.5, convention: Convention = "areal"
) -> Float:
    """Return ln G, G in m, from the power law of a fit: its ln S (S in m^2) at a lag of 1 m, and D_s.

    ln G = (intercept - ln C)/(2(D_s-1)); NaN unless 1 < D_s < 2: a power law of another exponent has no G.
    """
    inside = (np.asarray(dimension) > 1.0) & (np.asarray(dimension) < 2.0)
    safe = np.where(inside, dimension, 1.5)
    logarithm = (intercept - np.log(constant(safe, density, convention))) / (2.0 * (safe - 1.0))
    roughness: Float = np.where(inside, logarithm, np.nan)[()]
    return roughness


def structure_function(lag: Float, dimension: Float, roughness: Float) -> Float:
    """Return S, m^2, at a lag in m, of a profile dimension D_s (1 to 2) and G in m in the areal convention."""
    exponent = 4.0 - 2.0 * np.asarray(dimension)
    return constant(dimension, 1.5, "areal") * roughness ** (2.0 - exponent) * lag**exponent
