"""D and G from lines: what leaves them as they are, what is refused, and which lags the fit uses."""

from dataclasses import replace

import numpy as np
import pytest

from harmonic_fractal.estimate import Estimate, Estimation, estimate_of
from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.surface import Lines

SPACING = 0.4e-6
STEP = 1e-16  # S at one spacing: 10 nm
PLAIN = Estimation(resamples=0)


def rough(dimension: float = 1.5, lines: int = 100, points: int = 500, seed: int = 3) -> np.ndarray:
    """Fractional Brownian lines, their own straight lines removed."""
    rng = np.random.default_rng(seed)
    return level(brownian_profiles(dimension, STEP, (lines, points), rng))


def level(heights: np.ndarray) -> np.ndarray:
    """Remove each line's own straight line."""
    x = np.linspace(-1.0, 1.0, heights.shape[1])
    centred = heights - heights.mean(axis=1, keepdims=True)
    return np.asarray(centred - np.outer(centred @ x / (x @ x), x))


def estimated(heights: np.ndarray, settings: Estimation = PLAIN, spacing: float = SPACING) -> Estimate:
    """The estimate along x."""
    return estimate_of(Lines(heights, spacing), "x", settings)


# What leaves D and G as they are, or changes them in a known way


@pytest.mark.parametrize("factor", [0.1, 7.0])
def test_higher_heights_change_the_roughness_by_a_power(factor: float) -> None:
    """Heights times c: the same D_s, G times c^(1/(D_s - 1))."""
    heights = rough()
    one, other = estimated(heights), estimated(factor * heights)
    assert other.dimension == pytest.approx(one.dimension, rel=1e-12)
    assert other.roughness == pytest.approx(one.roughness * factor ** (1 / (one.dimension - 1)), rel=1e-9)


@pytest.mark.parametrize("factor", [0.25, 3.0])
def test_longer_lines_change_the_roughness_by_a_power(factor: float) -> None:
    """The same heights further apart by c: the same D_s, G times c^(-(2 - D_s)/(D_s - 1))."""
    heights = rough()
    one, other = estimated(heights), estimated(heights, spacing=factor * SPACING)
    exponent = -(2 - one.dimension) / (one.dimension - 1)
    assert other.dimension == pytest.approx(one.dimension, rel=1e-12)
    assert other.roughness == pytest.approx(one.roughness * factor**exponent, rel=1e-9)


@pytest.mark.parametrize(
    "changed",
    [
        pytest.param(lambda heights: heights[::-1], id="order of lines"),
        pytest.param(lambda heights: -heights, id="sign"),
        pytest.param(lambda heights: heights + 3e-6, id="constant"),
        pytest.param(lambda heights: level(heights + 1e-9 * np.arange(500.0)), id="tilt, removed"),
        pytest.param(lambda heights: heights[:, ::-1], id="sense of the lines"),
    ],
)
def test_what_does_not_belong_to_roughness_changes_nothing(changed) -> None:  # type: ignore[no-untyped-def]
    """D_s and G are those before."""
    heights = rough()
    one, other = estimated(heights), estimated(changed(heights))
    assert other.dimension == pytest.approx(one.dimension, abs=1e-7)
    assert other.roughness == pytest.approx(one.roughness, rel=1e-5)


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_holes_of_three_percent_change_little(dimension: float) -> None:
    """Single points and whole patches that were not measured: D_s moves by less than 0.01."""
    heights = rough(dimension)
    holed = heights.copy()
    rng = np.random.default_rng(8)
    holed[rng.random(heights.shape) < 0.02] = np.nan
    holed[40:52, 200:242] = np.nan
    assert 0.028 < np.isnan(holed).mean() < 0.032
    assert abs(estimated(holed).dimension - estimated(heights).dimension) < 0.01


# What is refused


def white_noise(lines: int) -> np.ndarray:
    """Heights that know nothing of each other: D_s = 2 at every lag."""
    return level(1e-8 * np.random.default_rng(5).standard_normal((lines, 500)))


def parabola(lines: int) -> np.ndarray:
    """Form that was not removed: D_s = 1 at every lag."""
    return level(1e-6 * np.linspace(-1.0, 1.0, 500) ** 2 * np.ones((lines, 1)))


def sine(lines: int) -> np.ndarray:
    """A wave of 0.8 of the length, of any phase: D_s = 1 at short lags."""
    phases = np.random.default_rng(6).uniform(0.0, 2.0 * np.pi, (lines, 1))
    return level(1e-6 * np.sin(2 * np.pi * np.arange(500) / 400 + phases))


def smoothed(lines: int) -> np.ndarray:
    """Noise that a filter has smoothed: D_s = 1 within the width of the filter, 2 beyond."""
    noise = np.random.default_rng(7).standard_normal((lines, 512))
    kernel = np.exp(-0.5 * (np.arange(-12, 13) / 3.0) ** 2)
    return 1e-8 * np.stack([np.convolve(line, kernel, mode="same")[6:506] for line in noise])


@pytest.mark.parametrize("lines", [1, 20, 100])
@pytest.mark.parametrize("made", [white_noise, parabola, sine, smoothed])
def test_a_surface_without_a_self_affine_range_is_refused(made, lines: int) -> None:  # type: ignore[no-untyped-def]
    """With its local slopes and a reason, and with the fit for comparison."""
    found = estimated(made(lines))
    assert not found.is_accepted
    assert found.reason.startswith("no self-affine range")
    assert np.isnan(found.range).all()
    assert found.resampled.shape == (0, 2)
    assert found.local_dimensions.size == found.local_lags.size == 8
    assert np.isfinite(found.dimension)
    assert found.lags.size > 8


def test_the_reason_names_the_span_of_the_local_slopes() -> None:
    """In numbers that can be checked against the table."""
    found = estimated(smoothed(100))
    low, high = found.local_dimensions.min(), found.local_dimensions.max()
    assert f"it runs from {low:.2f} to {high:.2f} over lags of 0.4 um to 50 um" in found.reason


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_true_fractals_of_many_lines_are_accepted(dimension: float) -> None:
    """All of twenty surfaces of a hundred lines, over the whole lag range."""
    for seed in range(20):
        found = estimated(rough(dimension, seed=seed))
        assert found.is_accepted, found.reason
        assert found.range[0] == pytest.approx(SPACING)
        assert found.range[1] > 50 * SPACING


def test_nearly_all_single_lines_of_true_fractals_are_accepted() -> None:
    """Their local slopes scatter: of 100 lines of 500 points at most three are refused."""
    lines = rough(1.5, lines=100, seed=12)
    assert sum(estimated(line[None]).is_accepted for line in lines) >= 97


def test_short_lines_are_refused() -> None:
    """Fewer than 64 points; 64 are enough."""
    assert estimated(rough(points=63)).reason == "too short: a line has 63 points, fewer than 64"
    assert estimated(rough(points=64)).is_accepted


@pytest.mark.parametrize("heights", [np.zeros((5, 500)), np.full((5, 500), np.nan), np.zeros((3, 1)), rough(points=8)])
def test_a_surface_that_says_nothing_is_refused_in_words(heights: np.ndarray) -> None:
    """Flat, not measured, a point, a few points: a reason and no exception."""
    found = estimated(heights)
    assert found.reason
    assert found.resampled.shape == (0, 2)


def test_few_lags_or_less_than_a_decade_are_refused() -> None:
    """The limits that the user sets leave too little."""
    seven = Estimation(resamples=0, lags=tuple(SPACING * k for k in (1, 2, 4, 8, 16, 32, 50)))
    assert "7 lags, fewer than 8" in estimated(rough(), seven).reason
    narrow = Estimation(resamples=0, shortest_lag=8 * SPACING, longest_lag=60 * SPACING)
    assert "may be used, 3.2 um to 24 um, are less than a decade" in estimated(rough(), narrow).reason


def test_lags_of_fewer_than_a_hundred_pairs_are_left_out() -> None:
    """One line of 130 points: lags up to 30 have a hundred pairs."""
    settings = Estimation(resamples=0, fit="all", longest_lag=60 * SPACING)
    found = estimated(rough(lines=1, points=130), settings)
    assert found.lags.max() <= 30 * SPACING
    assert found.all_lags.max() <= 30 * SPACING


# Which lags


def test_the_recipe_of_the_lags() -> None:
    """Sixteen, evenly in their logarithm, from one point to a tenth of the line, whole and each once."""
    found = estimated(rough())
    expected = np.unique(np.round(np.geomspace(1, 50, 16)))
    np.testing.assert_allclose(found.lags / SPACING, expected, rtol=1e-12)
    nodes = np.unique(np.round(np.geomspace(1, 125, 9)))
    np.testing.assert_allclose(found.local_lags / SPACING, np.sqrt(nodes[1:] * nodes[:-1]), rtol=1e-12)


def test_a_shortest_lag_moves_all_lags() -> None:
    """Those of the fit and those of the local slopes begin there: a filter of the instrument is not looked at."""
    found = estimated(rough(), Estimation(resamples=0, shortest_lag=3.9 * SPACING))
    assert found.lags[0] == pytest.approx(4 * SPACING)
    assert found.all_lags[0] == pytest.approx(4 * SPACING)


def test_stated_lags_are_those_of_the_fit() -> None:
    """Rounded to whole points."""
    lags = tuple(SPACING * k for k in (1, 2.1, 3, 5, 8, 13, 21, 34, 50))
    found = estimated(rough(), Estimation(resamples=0, lags=lags))
    np.testing.assert_allclose(found.lags / SPACING, [1, 2, 3, 5, 8, 13, 21, 34, 50], rtol=1e-12)


def test_the_fit_keeps_to_the_self_affine_range() -> None:
    """A fractal under a filter of three points: short lags are not fitted, unless all are asked for."""
    kernel = np.array([0.25, 0.5, 0.25])
    heights = np.stack([np.convolve(line, kernel, mode="valid") for line in rough(points=1502)])
    within, over_all = estimated(heights), estimated(heights, replace(PLAIN, fit="all"))
    assert within.range[0] > 2 * SPACING
    assert within.lags[0] == pytest.approx(within.range[0])
    assert over_all.lags[0] == pytest.approx(SPACING)
    assert within.dimension == pytest.approx(1.5, abs=0.03)
    assert over_all.dimension < within.dimension - 0.03


def test_values_are_the_structure_function_at_the_lags() -> None:
    """Of all lines together, by the definition."""
    heights = rough(lines=20)
    found = estimated(heights)
    for lag, value in zip(np.rint(found.lags / SPACING).astype(int), found.values, strict=True):
        assert value == pytest.approx(np.mean((heights[:, lag:] - heights[:, :-lag]) ** 2), rel=1e-12)


def test_each_line_fitted_alone() -> None:
    """The mean of D_s and of ln G of straight lines through each line's own ln S; and their scatter."""
    heights = rough(lines=30)
    found = estimated(heights, replace(PLAIN, method="per_line"))
    singles = [estimated(line[None], replace(PLAIN, fit="all")) for line in heights]
    dimensions = [single.dimension for single in singles]
    assert found.dimension == pytest.approx(np.mean(dimensions), rel=1e-12)
    assert np.log(found.roughness) == pytest.approx(np.mean([np.log(single.roughness) for single in singles]), rel=1e-9)
    assert found.line_scatter == pytest.approx(np.std(dimensions, ddof=1), rel=1e-9)
