"""How much faster is the structure function of a whole map than the loop over its points, and than a library?

Run it: ``python -m pytest tests/benchmarks/bench_surfaces.py -s``. A map of 1024 x 1024 points, 3 % of them missing, 16
lags from one point to a tenth of a line. Two baselines, both of the same map: the plain loop over pairs of points
(floats in lists, which is how such a loop is quick; measured on 8 of the 1024 lines and multiplied by 128), and
``autocorrelation_from_profile`` of SurfaceTopography, half the structure function at all lags by Fourier transforms. It
leaves missing points out too; both are compared at the first lag before they are timed. All in time of the processor,
alternately; the least of each counts.
"""

from typing import Any

import numpy as np
import pytest
from timed import least

from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.structure import fit_steps, structure_sums

POINTS, LOOPED, HOLES = 1024, 8, 0.03
STEPS = fit_steps(POINTS, float("nan"), float("nan"), 18)  # 16 of them are different whole numbers


def measured_map() -> np.ndarray:
    """Rough lines along x, in m, with missing points."""
    rng = np.random.default_rng(0)
    heights = brownian_profiles(1.5, 1e-16, (POINTS, POINTS), rng)
    heights[rng.random(heights.shape) < HOLES] = np.nan
    return heights


def loop(heights: np.ndarray, steps: list[int]) -> list[list[float]]:
    """S of every line, pair by pair."""
    found = []
    for line in heights.tolist():
        values = []
        for step in steps:
            total, count = 0.0, 0
            for first in range(len(line) - step):
                difference = line[first + step] - line[first]
                if difference == difference:
                    total += difference * difference
                    count += 1
            values.append(total / count)
        found.append(values)
    return found


def topography(heights: np.ndarray) -> Any:
    """The same map for the library, whose profiles run along its first axis."""
    from SurfaceTopography import Topography

    return Topography(np.ma.masked_invalid(heights.T), (float(POINTS), float(POINTS)))


def agrees(heights: np.ndarray) -> None:
    """All three say the same: the loop on its lines at all lags, the library on the map at one spacing."""
    sums, counts = structure_sums(heights, STEPS)
    np.testing.assert_allclose(sums[:LOOPED] / counts[:LOOPED], loop(heights[:LOOPED], STEPS.tolist()), rtol=1e-9)
    half = topography(heights).autocorrelation_from_profile()[1][0]
    assert 2.0 * half == pytest.approx(sums[:, 0].sum() / counts[:, 0].sum(), rel=1e-6)


def ratios() -> tuple[float, float, float]:
    """Seconds of ours, and how many times as long the loop and the library take."""
    heights = measured_map()
    agrees(heights)
    other, few = topography(heights), heights[:LOOPED]
    ours, looped, library = least(
        lambda: structure_sums(heights, STEPS),
        lambda: loop(few, STEPS.tolist()),
        lambda: other.autocorrelation_from_profile(),
        rounds=5,
    )
    return ours, looped * POINTS / LOOPED / ours, library / ours


def test_a_map_is_fifty_times_faster_than_the_loop_and_faster_than_the_library() -> None:
    pytest.importorskip("SurfaceTopography")
    ours, loops, libraries = ratios()
    print(f"\n{STEPS.size} lags in {ours * 1e3:.1f} ms; the loop takes {loops:.0f} times that (at least 50), ", end="")
    print(f"SurfaceTopography {libraries:.1f} times (at least 1)")
    assert STEPS.size == 16
    assert loops >= 50.0
    assert libraries > 1.0
