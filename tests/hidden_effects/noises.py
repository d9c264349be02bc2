"""The kinds of noise that readings carry, how a case is called, and which of its rows are held out."""

from collections.abc import Callable, Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Kind: TypeAlias = Literal["gaussian", "heavy", "autocorrelated", "growing"]
KINDS: tuple[Kind, ...] = ("gaussian", "heavy", "autocorrelated", "growing")
MEMORY = 0.5


def noise_of(kind: Kind, spread: Array, size: float, rng: np.random.Generator) -> Array:
    """Noise of this root mean square: independent and normal, heavy in its tails, with a memory, or growing.

    ``spread`` says, row by row, how the growing one compares.
    """
    count = len(spread)
    if kind == "heavy":
        return np.asarray(size * rng.standard_t(4, count) / np.sqrt(2))
    draws = rng.standard_normal(count)
    if kind == "autocorrelated":
        noise = np.empty(count)
        noise[0] = draws[0]
        for place in range(1, count):
            noise[place] = MEMORY * noise[place - 1] + np.sqrt(1 - MEMORY**2) * draws[place]
        return size * noise
    if kind == "growing":
        return np.asarray(size * draws * spread / np.sqrt(np.mean(spread**2)))
    return size * draws


def title_of(hidden: Mapping[str, Any], strange: Callable[..., Any] | None, *words: str) -> str:
    """What a case is called in the list of tests."""
    return "-".join(("+".join(hidden) or (strange.__name__ if strange else "nothing"), *words))


def held_out(count: int, held: int, rng: np.random.Generator) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The places of the rows that are fitted and of those that are not; the first row, where a clock begins, is."""
    is_held = np.zeros(count, dtype=bool)
    is_held[rng.permutation(np.arange(1, count))[:held]] = True
    return np.flatnonzero(~is_held), np.flatnonzero(is_held)
