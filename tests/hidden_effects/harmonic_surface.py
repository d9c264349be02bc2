"""Structure functions of a fractal surface that is waved, noisy or read by a blunt instrument, lag by lag.

Nothing of the plugin is imported: the mean over directions and the spot of the instrument are sums over places, a wave
is a cosine of the lag. What some lines show scatters about that like a variance. Lengths um.
"""

from dataclasses import dataclass
from functools import cache, partial
from math import gamma, pi, sin

import numpy as np

from hidden_effects.rigs import Rig, RigCase, Wish
from hidden_effects.rows import Array, of

STRUCTURE = "structure_function"
DIMENSION, ROUGHNESS = 2.4, 1e-5  # um, of a surface with ridges in all directions: the defaults
EXPONENT = 6 - 2 * DIMENSION
STEP, READ = 0.2, 4 * 2**13  # um between points, and points of all lines
FIRST, LAST = 2, 300  # lags in steps
SHARED = 1.5  # differences over one lag that are as good as one alone, over the points in a lag


@dataclass(frozen=True)
class Lags:
    """Where the structure function was taken, um, and its standard error, um^2."""

    lag: Array
    sigma_structure_function: Array

    def __len__(self) -> int:
        return len(self.lag)


@cache
def power() -> float:
    """S at a lag of 1 um, um^2, by the convention of areal roughness; the mean over directions as a sum."""
    level = pi / (2 * gamma(1 + EXPONENT) * sin(pi * EXPONENT / 2))
    directions = np.mean(np.abs(np.cos(np.pi * (np.arange(20000) + 0.5) / 20000)) ** EXPONENT)
    return float((2 * pi) ** EXPONENT * level * directions * ROUGHNESS ** (2 - EXPONENT))


def true_structure(wish: Wish, lag: Array) -> Array:
    """What endless lines would show, um^2, the spot as a sum over places."""
    width = of(wish.hidden, "lateral_filter", "width")
    places = np.linspace(-8, 8, 4001)
    weight = np.exp(-(places**2) / 2) / np.sum(np.exp(-(places**2) / 2))
    apart = 2**0.5 * width * places
    plain = [np.sum(weight * (np.abs(one + apart) ** EXPONENT - np.abs(apart) ** EXPONENT)) for one in lag]
    wave = 1 - np.cos(2 * pi * lag / of(wish.hidden, "waviness", "wavelength", 1.0))
    noise = 2e-6 * of(wish.hidden, "instrument_noise", "variance")
    strange = [_of_line(wish, one) for one in lag]
    return np.asarray(power() * np.array(plain) + of(wish.hidden, "waviness", "square") * wave + noise + strange)


def _of_line(wish: Wish, lag: float) -> float:
    """Mean square of the difference over a lag of what nobody registered."""
    at = STEP * np.arange(READ)
    return 0.0 if wish.strange is None else float(np.mean((wish.strange(at + lag) - wish.strange(at)) ** 2))


def make_surface(wish: Wish) -> RigCase:
    """Read a surface, each lag on lines of its own and in any order, so that its errors are its own.

    Every other lag is held out.
    """
    rng = np.random.default_rng([wish.seed, 62])
    steps = np.unique(np.round(np.geomspace(FIRST, LAST, 2 * wish.count))).astype(int)
    freedom = 2 * READ / (SHARED * steps)
    true = true_structure(wish, STEP * steps)
    read = true * rng.chisquare(freedom) / freedom
    sigma = power() * (STEP * steps) ** EXPONENT * np.sqrt(2 / freedom)
    fitted, held = (rng.permutation(np.arange(first, len(steps), 2)) for first in (0, 1))
    return RigCase(
        rows=Lags(STEP * steps[fitted], sigma[fitted]),
        held=Lags(STEP * steps[held], sigma[held]),
        readings={STRUCTURE: read[fitted]},
        held_readings={STRUCTURE: read[held]},
        held_true={STRUCTURE: true[held]},
        held_error=sigma[held],
    )


FLANK = Rig(
    plugin="harmonic_fractal",
    inputs='plugin = "harmonic_fractal"\n',
    written={"lag": "um", "sigma_structure_function": "um^2"},
    measured={STRUCTURE: "um^2"},
    make=make_surface,
)
surface = partial(Wish, rig=FLANK, design="surface", results=(STRUCTURE,), count=40)
"""What a surface is to be like; what nobody registered is added to the heights along a line."""
