"""How much faster is a made patch as one matrix product than as a loop over its waves?

Run it: ``python -m pytest tests/benchmarks/bench_made_surfaces.py --benchmark-enable -s``, or as a script. The patch is
that of the shipped example: 501 x 251 points, 40 ridge directions, 1480 plane waves. The loop adds one wave after the
other to the whole patch, each with one cosine per point; it is numpy too, and a loop over the points would be slower by
far. Both must make the same patch.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

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


def seconds(call: Callable[[], Any], times: int) -> float:
    """The shortest of several calls."""
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        taken.append(time.perf_counter() - start)
    return min(taken)


def ratio() -> float:
    """Loop over product, both measured in this run."""
    return seconds(loop, 2) / seconds(product, 10)


def test_both_make_the_same_patch() -> None:
    one, other = product(), loop()
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()  # phases up to 2e5 rad lose five of sixteen digits


@pytest.mark.benchmark(group="a patch of 501 x 251 points")
def test_sum_of_waves(benchmark: BenchmarkFixture) -> None:
    benchmark(product)


@pytest.mark.benchmark(group="a patch of 501 x 251 points")
def test_brownian_patch(benchmark: BenchmarkFixture) -> None:
    benchmark(lambda: brownian_surface(1.4, 1e-16, (251, 501), np.random.default_rng(0)))


@pytest.mark.benchmark(group="251 lines of 501 points")
def test_brownian_lines(benchmark: BenchmarkFixture) -> None:
    benchmark(lambda: brownian_profiles(1.4, 1e-16, (251, 501), np.random.default_rng(0)))


def test_a_product_is_at_least_ten_times_as_fast_as_the_loop() -> None:
    found = ratio()
    print(f"\nloop over the waves over one matrix product: {found:.0f} (at least {AT_LEAST:.0f})")
    assert found >= AT_LEAST


if __name__ == "__main__":
    print(f"loop over the waves over one matrix product: {ratio():.0f} (at least {AT_LEAST:.0f})")
