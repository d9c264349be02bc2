"""D and G from lines: what leaves them as they are, what is refused, and which lags the fit uses."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from harmonic_fractal.estimate import (
    Estimate,
    Estimation,
    block_weights,
    estimate_of,
    noise_fit,
)
from harmonic_fractal.generators import brownian_profiles, brownian_surface
from harmonic_fractal.surface import Lines
from harmonic_fractal.windows import roughness_length_of

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


@pytest.mark.parametrize(("higher", "longer"), [(0.1, 1.0), (7.0, 1.0), (1.0, 0.25), (1.0, 3.0)])
def test_higher_heights_and_longer_lines_change_the_roughness_by_a_power(higher: float, longer: float) -> None:
    """Heights times c: the same D_s, G times c^(1/(D_s - 1)). Points further apart by c: c^(-(2 - D_s)/(D_s - 1))."""
    heights = rough()
    one, other = estimated(heights), estimated(higher * heights, spacing=longer * SPACING)
    power = 1 / (one.dimension - 1)
    assert other.dimension == pytest.approx(one.dimension, rel=1e-12)
    expected = one.roughness * higher**power * longer ** (-(2 - one.dimension) * power)
    assert other.roughness == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    "changed",
    [
        lambda heights: heights[::-1], lambda heights: -heights, lambda heights: heights + 3e-6,
        lambda heights: level(heights + 1e-9 * np.arange(500.0)), lambda heights: heights[:, ::-1],
    ],
    ids=["order of lines", "sign", "constant", "tilt, removed", "sense of the lines"],
)  # fmt: skip
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
    low, high = found.local_dimensions.min(), found.local_dimensions.max()
    assert f"from {low:.2f} to {high:.2f} over lags of 0.4 um to 50 um" in found.reason
    assert np.isnan(found.range).all()
    assert found.resampled.shape == (0, 2)
    assert found.local_dimensions.size == found.local_lags.size == 8
    assert np.isfinite(found.dimension)
    assert found.lags.size > 8


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_true_fractals_of_many_lines_are_accepted(dimension: float) -> None:
    """All of four surfaces of a hundred lines, over the whole lag range."""
    for seed in range(4):
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


def test_lags_that_are_stated() -> None:
    """A shortest one moves all, of the fit and of the local slopes; a list is that of the fit, in whole points."""
    found = estimated(rough(), Estimation(resamples=0, shortest_lag=3.9 * SPACING))
    assert (found.lags[0], found.all_lags[0]) == pytest.approx((4 * SPACING, 4 * SPACING))
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


def test_each_line_fitted_alone() -> None:
    """The mean of D_s and of ln G of straight lines through each line's own ln S; and their scatter."""
    heights = rough(lines=30)
    found = estimated(heights, replace(PLAIN, method="per_line"))
    singles = [estimated(line[None], replace(PLAIN, fit="all")) for line in heights]
    dimensions = [single.dimension for single in singles]
    assert found.dimension == pytest.approx(np.mean(dimensions), rel=1e-12)
    assert np.log(found.roughness) == pytest.approx(np.mean([np.log(single.roughness) for single in singles]), rel=1e-9)
    assert found.line_scatter == pytest.approx(np.std(dimensions, ddof=1), rel=1e-9)


# The fit of a power law with the noise of the instrument, against scipy's, and on surfaces with known noise.

LAGS = SPACING * np.unique(np.round(np.geomspace(1, 50, 16)))


def law(amplitude: float, slope: float, noise: float) -> np.ndarray:
    """A lag^s + 2 sigma^2."""
    return np.asarray(amplitude * (LAGS / LAGS[0]) ** slope + 2.0 * noise**2)


@pytest.mark.parametrize("slope", [0.1, 1.0, 1.9])
@pytest.mark.parametrize("noise", [0.0, 0.3, 3.0])
def test_an_exact_law_is_found_exactly(slope: float, noise: float) -> None:
    """Exponent, level and noise."""
    found = noise_fit(LAGS, law(1e-16, slope, noise * 1e-8))
    assert float(found.slope) == pytest.approx(slope, abs=2e-4)
    assert float(found.noise) == pytest.approx(noise * 1e-8, abs=2e-11)
    assert float(found.intercept + found.slope * np.log(LAGS[0])) == pytest.approx(np.log(1e-16), abs=2e-3)
    assert float(found.r_squared) == pytest.approx(1.0, abs=1e-6)


def reference(values: np.ndarray) -> float:
    """The least sum of squares that scipy finds, from many starts, with the same bounds."""
    x, y = np.log(LAGS / LAGS[0]), np.log(values)

    def left(p: np.ndarray) -> np.ndarray:
        return np.asarray(p[0] + np.log(np.exp(p[1] * x) + p[2]) - y)

    bounds = ([-np.inf, 0.02, 0.0], [np.inf, 1.98, np.inf])
    starts = [(y[0], slope, share) for slope in (0.2, 0.8, 1.4) for share in (1e-3, 1.0, 10.0)]
    return min(2.0 * least_squares(left, start, bounds=bounds, xtol=1e-15, ftol=1e-15).cost for start in starts)


@pytest.mark.parametrize("seed", range(4))
def test_the_least_squares_are_those_of_scipy(seed: int) -> None:
    """On scattered values: no other start finds a better fit."""
    rng = np.random.default_rng(seed)
    values = law(1e-16, rng.uniform(0.2, 1.8), rng.uniform(0.0, 2e-8)) * np.exp(0.1 * rng.standard_normal(LAGS.size))
    found = noise_fit(LAGS, values)
    model = np.exp(found.intercept) * LAGS**found.slope + 2.0 * found.noise**2
    ours = float(np.sum(np.log(values / model) ** 2))
    assert ours <= reference(values) * (1 + 1e-4) + 1e-12


NOISY: list[tuple[float, float]] = [(0.0, 0.0), (0.5e-8, 1 / 3), (1e-8, 2 / 3)]
"""Noise, m, and its share of S at one spacing, 2 sigma^2 over S + 2 sigma^2 with 10 nm of S."""


@pytest.mark.parametrize(("noise", "share"), NOISY)
def test_noise_is_told_beside_a_plain_fit_and_taken_off_by_the_other(noise: float, share: float) -> None:
    """The local slopes are those of S less the noise; the short lags, which tell the noise, stay in the fit."""
    rng = np.random.default_rng(4)
    heights = brownian_profiles(1.4, STEP, (200, 1000), rng) + noise * rng.standard_normal((200, 1000))
    over_all = estimated(heights, replace(PLAIN, fit="all"))
    assert over_all.noise_share == pytest.approx(share, abs=0.05)
    assert over_all.noise_dimension == pytest.approx(1.4, abs=0.03)
    aware = estimated(heights, Estimation(resamples=50, noise_aware=True))
    assert aware.is_accepted
    assert aware.warnings == ()
    assert aware.dimension == pytest.approx(1.4, abs=0.05)
    assert aware.lags[0] == pytest.approx(SPACING)
    np.testing.assert_allclose(aware.local_dimensions[:3], 1.4, atol=0.08)  # half of the noise left: 1.6 and more
    assert aware.resampled.shape == (50, 2)


def test_a_plain_fit_of_a_noisy_surface_warns() -> None:
    """With both dimensions; a surface without noise has nothing to say."""
    clean = brownian_profiles(1.5, STEP, (100, 1000), np.random.default_rng(4))
    noisy = clean + 1e-8 * np.random.default_rng(5).standard_normal(clean.shape)
    quiet, plain = estimated(clean), estimated(noisy)
    assert quiet.warnings == ()
    assert plain.is_accepted
    (words,) = plain.warnings
    assert f"dimension {plain.noise_dimension:.3f}, not {plain.dimension:.3f}" in words


def test_white_noise_alone_is_refused_by_the_fit_with_noise_too() -> None:
    """Nothing is left when the noise is taken off."""
    assert not estimated(white_noise(100), replace(PLAIN, noise_aware=True)).is_accepted


def test_smooth_short_lags_are_no_noise() -> None:
    """A filtered surface without noise: the fit with noise leaves its smooth lags out as the plain fit does."""
    kernel = np.array([0.25, 0.5, 0.25])
    heights = np.stack([np.convolve(line, kernel, mode="valid") for line in rough(points=1502, seed=5)])
    plain, aware = (estimated(heights, replace(PLAIN, noise_aware=aware)) for aware in (False, True))
    assert aware.lags[0] == plain.lags[0] > SPACING
    assert aware.dimension == pytest.approx(plain.dimension, abs=0.01)


# The roughness-length method: windows and the roughness in them, and the dimension of lines of known truth.


def test_roughness_in_a_window_is_that_about_its_own_line() -> None:
    """Window by window with numpy.polyfit, from 8 points to a tenth of a line; those that hold a hole are left out."""
    heights = brownian_profiles(1.5, 1.0, (3, 200), np.random.default_rng(1))
    heights[1, 77] = np.nan
    sizes = range(8, 21)
    means = []
    for size in sizes:
        values = []
        for line in heights:
            for first in range(0, 200 - size + 1, size // 2):
                piece, x = line[first : first + size], np.arange(size)
                if np.isfinite(piece).all():
                    left = piece - np.polyval(np.polyfit(x, piece, 1), x)
                    values.append(np.sqrt(np.sum(left**2) / (size - 2)))
        means.append(np.mean(values))
    taken = [round(size) - 8 for size in np.unique(np.round(np.geomspace(8, 20, 12)))]
    slope = np.polyfit(np.log(np.array(sizes))[taken], np.log(means)[taken], 1)[0]
    assert roughness_length_of(heights, 0.5) == pytest.approx(2.0 - slope, rel=1e-9)


@pytest.mark.parametrize("dimension", [1.3, 1.5, 1.7])
def test_dimension_of_long_lines(dimension: float) -> None:
    """Within 0.04: windows of few points see too little of the long waves, so it comes out a little high."""
    heights = brownian_profiles(dimension, 1.0, (50, 4000), np.random.default_rng(2))
    assert roughness_length_of(heights, 1.0) == pytest.approx(dimension, abs=0.04)


def test_straight_lines_are_not_rough() -> None:
    """Nothing is left in any window, and no dimension is told."""
    assert np.isnan(roughness_length_of(np.zeros((2, 200)), 1.0))


# The scatter of D and G: resampled lines and pieces against many surfaces made independently.


def resampled_of(heights: np.ndarray, **settings: object) -> Estimate:
    """The estimate along x, over all lags whatever their local slopes."""
    return estimate_of(Lines(heights, SPACING), "x", Estimation(fit="all", **settings))  # type: ignore[arg-type]


def pair(found: Estimate) -> tuple[float, float]:
    """D of the surface and ln G."""
    return found.dimension + 1.0, float(np.log(found.roughness))


def test_the_same_seed_draws_the_same() -> None:
    """So a sheet is the same sheet when it is made again; another seed draws another sample."""
    heights = brownian_profiles(1.5, STEP, (40, 300), np.random.default_rng(1))
    first, again, other = (resampled_of(heights, seed=seed).resampled for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert first.shape == (400, 2)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize(("units", "block"), [(40, 1), (40, 10), (47, 10)])
def test_blocks_hold_neighbours_and_every_line_alike(units: int, block: int) -> None:
    """Every sample holds one block fewer than there are; every unit stands in as many samples as any other."""
    weights = block_weights(units, block, 4000, 1)
    assert set(weights.sum(axis=1)) == {float(block * (round(units / block) - 1))}
    np.testing.assert_allclose(weights.mean(axis=0), weights.mean(), rtol=0.25)
    joined = np.mean(weights[:, :-1] * weights[:, 1:]) - weights.mean() ** 2
    assert joined / weights.var() == pytest.approx((block - 1) / block, abs=0.1)


@pytest.mark.parametrize("method", ["pooled", "per_line"])
def test_independent_lines_scatter_as_independent_surfaces_do(method: str) -> None:
    """120 surfaces of 20 lines: each standard deviation is known to 6.5 %, and three times that is allowed."""
    rng = np.random.default_rng(20221210)
    surfaces = [
        resampled_of(brownian_profiles(1.5, STEP, (20, 300), rng), resamples=100, method=method) for _ in range(120)
    ]
    true = np.std([pair(found) for found in surfaces], axis=0, ddof=1)
    told = np.sqrt(np.mean([found.resampled.var(axis=0, ddof=1) for found in surfaces if found.is_accepted], axis=0))
    np.testing.assert_allclose(told / true, 1.0, atol=0.2)


@pytest.mark.parametrize("shape", [(5, 500), (100, 100)])
def test_pieces_see_most_of_the_scatter(shape: tuple[int, int]) -> None:
    """Five lines, a patch that is alike in both directions: 0.65 to 1.1 of the true standard deviation."""
    rng = np.random.default_rng(20221210)
    made = brownian_surface if shape[0] == 100 else brownian_profiles
    surfaces = [resampled_of(made(1.6, STEP, shape, rng), resamples=100) for _ in range(80)]
    true = np.std([pair(found) for found in surfaces], axis=0, ddof=1)
    told = np.sqrt(np.mean([found.resampled.var(axis=0, ddof=1) for found in surfaces if found.is_accepted], axis=0))
    assert (told / true > 0.65).all()
    assert (told / true < 1.1).all()


def test_the_size_of_the_blocks_can_be_stated() -> None:
    """Blocks of lines even where pieces would be drawn."""
    heights = brownian_surface(1.5, STEP, (100, 200), np.random.default_rng(3))
    narrow, chosen = resampled_of(heights, block=1).resampled, resampled_of(heights).resampled
    assert chosen[:, 0].std() > 2.0 * narrow[:, 0].std()


@pytest.mark.parametrize("method", ["pooled", "per_line"])
def test_many_lines_are_taken_together_by_neighbours(method: str) -> None:
    """6000 lines scatter as 1500 do, but half as far: within 20 %, three times the error of both."""
    heights = brownian_profiles(1.5, STEP, (6000, 120), np.random.default_rng(6))
    many, few = (resampled_of(part, method=method).resampled.std(axis=0) for part in (heights, heights[:1500]))
    np.testing.assert_allclose(2.0 * many / few, 1.0, atol=0.2)
