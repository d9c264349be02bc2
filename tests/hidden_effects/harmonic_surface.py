"""Made lines of a fractal surface, and what an instrument reads of them: the structure function of real heights.

Nothing of the plugin is imported. Lines are drawn as a sum of all waves with the spectrum of a power law, far beyond
what is looked at on either side; a wave, a blunt instrument and its noise act on the heights. Lengths um.
"""

from dataclasses import dataclass
from functools import cache, partial
from math import gamma, pi, sin

import numpy as np

from hidden_effects.harmonic_contact import Array
from hidden_effects.rigs import Rig, RigCase, Wish
from hidden_effects.rows import of

STRUCTURE = "structure_function"
DIMENSION, ROUGHNESS = 2.4, 1e-5  # um, of a surface with ridges in all directions: the defaults
EXPONENT = 6 - 2 * DIMENSION
STEP, POINTS, LINES = 0.2, 2**13, 4
FOLDS = 30  # of the spectrum about the sampling frequency: a point is no mean over a step
FIRST, LAST = 2, 300  # lags in steps


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


def spectrum(frequency: Array, width: float) -> Array:
    """Power of the heights per frequency, um^3, of points that a spot of this width has read.

    S = 2 int P (1 - cos) df with P = k f^-(1 + a): k is what gives S = c lag^a.
    """
    level = pi / (2 * gamma(1 + EXPONENT) * sin(pi * EXPONENT / 2))
    scale = power() / (2 * (2 * pi) ** EXPONENT * level)
    folded = [np.abs(frequency + fold / STEP) for fold in range(-FOLDS, FOLDS + 1)]
    return np.asarray(sum(scale * f ** -(1 + EXPONENT) * np.exp(-((2 * pi * f * width) ** 2)) for f in folded))


def lines(rng: np.random.Generator, wish: Wish, count: int) -> Array:
    """Heights of so many lines, um, as the instrument shows them."""
    period = POINTS * 2
    frequency = np.fft.rfftfreq(period, STEP)[1:]
    size = np.sqrt(spectrum(frequency, of(wish.hidden, "lateral_filter", "width")) * frequency[0]) / 2
    draws = rng.standard_normal((count, len(size))) + 1j * rng.standard_normal((count, len(size)))
    waves = np.concatenate([np.zeros((count, 1)), draws * size], axis=1)
    heights = np.fft.irfft(waves, period, axis=1)[:, :POINTS] * period
    at = STEP * np.arange(POINTS)
    amplitude = of(wish.hidden, "waviness", "square") ** 0.5
    phases = rng.uniform(0, 2 * pi, (count, 1))
    heights = heights + amplitude * np.cos(2 * pi * at / of(wish.hidden, "waviness", "wavelength", 1.0) + phases)
    if wish.strange is not None:
        heights = heights + wish.strange(at)
    noise = of(wish.hidden, "instrument_noise", "variance") ** 0.5 * 1e-3
    return np.asarray(heights + noise * rng.standard_t(6, heights.shape) / np.sqrt(1.5))


def structure(heights: Array, step: int) -> Array:
    """Mean square of the difference of heights over a lag, um^2, of every line."""
    return np.asarray(((heights[:, step:] - heights[:, :-step]) ** 2).mean(axis=1))


@cache
def relative_error(step: int) -> float:
    """Standard error of the structure function over itself, from many lines of a plain surface."""
    each = structure(_plain(), step)
    return float(each.std(ddof=1) / each.mean() / LINES**0.5)


@cache
def _plain() -> Array:
    return lines(np.random.default_rng(63), surface(seed=0), 200)


def true_structure(wish: Wish, lag: Array) -> Array:
    """What endless lines would show, um^2, the spot as a sum over places."""
    width = of(wish.hidden, "lateral_filter", "width")
    places = np.linspace(-8, 8, 4001)
    weight = np.exp(-(places**2) / 2) / np.sum(np.exp(-(places**2) / 2))
    apart = 2**0.5 * width * places
    plain = [np.sum(weight * (np.abs(one + apart) ** EXPONENT - np.abs(apart) ** EXPONENT)) for one in lag]
    wave = 1 - np.cos(2 * pi * lag / of(wish.hidden, "waviness", "wavelength", 1.0))
    noise = 2e-6 * of(wish.hidden, "instrument_noise", "variance")
    return np.asarray(power() * np.array(plain) + of(wish.hidden, "waviness", "square") * wave + noise)


def make_surface(wish: Wish) -> RigCase:
    """Read a surface, each lag on lines of its own and in any order, so that its errors are its own.

    Every other lag is held out.
    """
    rng = np.random.default_rng([wish.seed, 62])
    steps = np.unique(np.round(np.geomspace(FIRST, LAST, 2 * wish.count))).astype(int)
    heights = lines(rng, wish, LINES * len(steps)).reshape(len(steps), LINES, POINTS)
    read = np.array([structure(each, int(step)).mean() for each, step in zip(heights, steps, strict=True)])
    sigma = power() * (STEP * steps) ** EXPONENT * [relative_error(int(step)) for step in steps]
    parts = [rng.permutation(np.arange(first, len(steps), 2)) for first in (0, 1)]
    lags = [Lags(STEP * steps[part], sigma[part]) for part in parts]
    found = [{STRUCTURE: read[part]} for part in parts]
    return RigCase(
        rows=lags[0],
        held=lags[1],
        readings=found[0],
        held_readings=found[1],
        held_true={STRUCTURE: true_structure(wish, lags[1].lag)},
        held_error=lags[1].sigma_structure_function,
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
