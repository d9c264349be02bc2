"""How much faster is a made patch as one matrix product than as a loop over its waves?

Run it: ``python -m pytest tests/benchmarks/bench_made_surfaces.py -s``. The patch is that of the shipped example: 501 x
251 points, 40 ridge directions, 1480 plane waves. The loop adds one wave after the other to the whole patch, each with
one cosine per point; it is numpy too, and a loop over the points would be slower by far. Both must make the same patch.
"""

import numpy as np
from timed import least

from harmonic_fractal.generators import Array, Waves, brownian_profiles, brownian_surface, weierstrass_surface

SPACING = 0.4e-6
X, Y = SPACING * np.arange(501.0), SPACING * np.arange(251.0)
WAVES = Waves(dimension=1.4, roughness=1e-11, lowest=1.0 / 20e-3, highest=1.0 / 8e-9)
AT_LEAST = 10.0


def product() -> Array:
    """One matrix product."""
    return weierstrass_surface(WAVES, X, Y, np.random.default_rng(0))


def loop() -> Array:
    """Wave by wave, over the whole patch."""
    frequencies, directions = WAVES.frequencies, WAVES.directions
    phases = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (directions, len(frequencies)))
    heights = np.zeros((len(Y), len(X)))
    scale = WAVES.roughness ** (WAVES.dimension - 1.0) * np.sqrt(np.log(WAVES.density) / directions)
    for m in range(1, directions + 1):
        way = np.add.outer(Y * np.sin(np.pi * m / directions), X * np.cos(np.pi * m / directions))
        for frequency, phase in zip(frequencies, phases[m - 1], strict=True):
            wave = np.cos(phase) - np.cos(2.0 * np.pi * frequency * way + phase)
            heights += scale * frequency ** (WAVES.dimension - 2.0) * wave
    return heights


def test_both_make_the_same_patch() -> None:
    one, other = product(), loop()
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()  # phases up to 2e5 rad lose five of sixteen digits


def test_a_product_is_at_least_ten_times_as_fast_as_the_loop() -> None:
    """And so are Brownian patches and lines of as many points."""
    brownian = (
        lambda: brownian_surface(1.4, 1e-16, (251, 501), np.random.default_rng(0)),
        lambda: brownian_profiles(1.4, 1e-16, (251, 501), np.random.default_rng(0)),
    )
    slow, *fast = least(loop, product, *brownian)
    print(
        "\nloop over the waves over one product, a Brownian patch, lines: "
        + ", ".join(f"{slow / one:.0f}" for one in fast)
    )
    assert slow / fast[0] >= AT_LEAST
