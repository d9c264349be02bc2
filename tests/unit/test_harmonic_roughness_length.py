"""The roughness-length method: windows and the roughness in them, and the dimension of lines of known truth."""

import numpy as np
import pytest
from scipy.special import gammaln

from harmonic_fractal.estimate import Estimation, estimate_of, roughness_length_of, window_sizes
from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.surface import Lines


def test_windows_run_from_eight_points_to_a_tenth_of_the_line() -> None:
    """None where a line is too short for one."""
    sizes = window_sizes(500)
    assert (sizes[0], sizes[-1], len(sizes)) == (8, 50, 12)
    assert window_sizes(79).size == 0


def test_roughness_in_a_window_is_that_about_its_own_line() -> None:
    """Window by window with numpy.polyfit; those that hold a hole are left out."""
    heights = brownian_profiles(1.5, 1.0, (3, 200), np.random.default_rng(1))
    heights[1, 77] = np.nan
    found = roughness_length_of(heights, 0.5)
    for window, roughness in zip(found.windows, found.roughness, strict=True):
        size = round(window / 0.5)
        values = []
        for line in heights:
            for first in range(0, 200 - size + 1, size // 2):
                piece, x = line[first : first + size], np.arange(size)
                if np.isfinite(piece).all():
                    left = piece - np.polyval(np.polyfit(x, piece, 1), x)
                    values.append(np.sqrt(np.sum(left**2) / (size - 2)))
        assert roughness == pytest.approx(np.mean(values), rel=1e-9)


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_dimension_of_long_lines(dimension: float) -> None:
    """Within 0.04: windows of few points see too little of the long waves, so it comes out a little high."""
    heights = brownian_profiles(dimension, 1.0, (50, 4000), np.random.default_rng(2))
    assert roughness_length_of(heights, 1.0).dimension == pytest.approx(dimension, abs=0.04)


def test_white_noise_is_nearly_as_rough_in_any_window() -> None:
    """The mean standard deviation of w - 2 free values: sqrt(2/(w-2)) Gamma((w-1)/2)/Gamma((w-2)/2) of theirs."""
    heights = np.random.default_rng(2).standard_normal((50, 4000))
    found = roughness_length_of(heights, 1.0)
    free = found.windows - 2.0
    expected = np.sqrt(2.0 / free) * np.exp(gammaln((free + 1.0) / 2.0) - gammaln(free / 2.0))
    np.testing.assert_allclose(found.roughness, expected, rtol=0.005)
    assert found.dimension == pytest.approx(2.0, abs=0.02)


def test_straight_lines_are_not_rough() -> None:
    """Nothing is left in any window, and no dimension is told."""
    found = roughness_length_of(np.zeros((2, 200)), 1.0)
    assert np.isnan(found.dimension)


def test_it_stands_beside_the_estimate() -> None:
    """For comparison, whatever the structure function says."""
    heights = brownian_profiles(1.6, 1e-16, (50, 1000), np.random.default_rng(2))
    found = estimate_of(Lines(heights, 1e-6), "x", Estimation(resamples=0))
    assert found.window_dimension == pytest.approx(found.dimension, abs=0.06)
