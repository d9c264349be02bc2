"""How far D and G scatter: blocks of neighbouring lines drawn anew, many times."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def block_weights(units: int, block: int, samples: int, seed: int) -> Array:
    """Return how often every unit (lines, say) stands in every sample (samples, units): blocks of neighbours.

    The blocks begin anywhere and the last is continued by the first (circular block bootstrap, Politis and Romano
    1992). One block fewer is drawn than the units hold, which makes the variance that of the units and not the
    (blocks - 1)/blocks of it (Rao and Wu 1988).
    """
    generator = np.random.default_rng(seed)
    drawn = max(1, round(units / block) - 1)
    starts = generator.multinomial(drawn, np.full(units, 1.0 / units), size=samples).astype(float)
    weights = np.zeros_like(starts)
    for shift in range(block):
        weights += np.roll(starts, shift, axis=1)
    return weights
