"""The scatter of D and G: resampled lines and pieces against many surfaces made independently."""

import numpy as np
import pytest

from harmonic_fractal.estimate import Estimate, Estimation, block_weights, estimate_of
from harmonic_fractal.generators import brownian_profiles, brownian_surface
from harmonic_fractal.surface import Lines

STEP, SPACING = 1e-16, 0.4e-6


def estimated(heights: np.ndarray, **settings: object) -> Estimate:
    """The estimate along x, over all lags whatever their local slopes."""
    return estimate_of(Lines(heights, SPACING), "x", Estimation(fit="all", **settings))  # type: ignore[arg-type]


def pair(found: Estimate) -> tuple[float, float]:
    """D of the surface and ln G."""
    return found.dimension + 1.0, float(np.log(found.roughness))


def test_the_same_seed_draws_the_same() -> None:
    """So a sheet is the same sheet when it is made again; another seed draws another sample."""
    heights = brownian_profiles(1.5, STEP, (40, 300), np.random.default_rng(1))
    first, again, other = (estimated(heights, seed=seed).resampled for seed in (1, 1, 2))
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


def test_errors_of_dimension_and_roughness_go_together() -> None:
    """That is why they are kept as pairs: their correlation is above 0.99 where a lag is far above G."""
    heights = brownian_profiles(1.5, STEP, (100, 500), np.random.default_rng(1))
    found = estimated(heights)
    assert np.corrcoef(found.resampled.T)[0, 1] > 0.99
    np.testing.assert_allclose(found.resampled.mean(axis=0), pair(found), atol=0.2 * found.resampled.std(axis=0).max())


@pytest.mark.parametrize("method", ["pooled", "per_line"])
def test_independent_lines_scatter_as_independent_surfaces_do(method: str) -> None:
    """120 surfaces of 20 lines: each standard deviation is known to 6.5 %, and three times that is allowed."""
    rng = np.random.default_rng(20221210)
    surfaces = [
        estimated(brownian_profiles(1.5, STEP, (20, 300), rng), resamples=100, method=method) for _ in range(120)
    ]
    true = np.std([pair(found) for found in surfaces], axis=0, ddof=1)
    told = np.sqrt(np.mean([found.resampled.var(axis=0, ddof=1) for found in surfaces if found.is_accepted], axis=0))
    np.testing.assert_allclose(told / true, 1.0, atol=0.2)


@pytest.mark.parametrize("shape", [(5, 500), (100, 100)])
def test_pieces_see_most_of_the_scatter(shape: tuple[int, int]) -> None:
    """Five lines, a patch that is alike in both directions: 0.65 to 1.1 of the true standard deviation."""
    rng = np.random.default_rng(20221210)
    made = brownian_surface if shape[0] == 100 else brownian_profiles
    surfaces = [estimated(made(1.6, STEP, shape, rng), resamples=100) for _ in range(80)]
    true = np.std([pair(found) for found in surfaces], axis=0, ddof=1)
    told = np.sqrt(np.mean([found.resampled.var(axis=0, ddof=1) for found in surfaces if found.is_accepted], axis=0))
    assert (told / true > 0.65).all()
    assert (told / true < 1.1).all()


def test_lines_that_repeat_their_neighbours_say_nothing_more() -> None:
    """Each line ten times over: ten times as many lines, but no smaller scatter."""
    heights = brownian_profiles(1.5, STEP, (30, 500), np.random.default_rng(9))
    single, repeated = estimated(heights), estimated(np.repeat(heights, 10, axis=0))
    ratio = repeated.resampled.std(axis=0) / single.resampled.std(axis=0)
    assert (ratio > 0.6).all()
    assert (ratio < 1.7).all()


def test_the_size_of_the_blocks_can_be_stated() -> None:
    """Blocks of lines even where pieces would be drawn."""
    heights = brownian_surface(1.5, STEP, (100, 200), np.random.default_rng(3))
    narrow, chosen = estimated(heights, block=1).resampled, estimated(heights).resampled
    assert chosen[:, 0].std() > 2.0 * narrow[:, 0].std()


@pytest.mark.parametrize("method", ["pooled", "per_line"])
def test_many_lines_are_taken_together_by_neighbours(method: str) -> None:
    """6000 lines scatter as 1500 do, but half as far: within 20 %, three times the error of both."""
    heights = brownian_profiles(1.5, STEP, (6000, 120), np.random.default_rng(6))
    many, few = (estimated(part, method=method).resampled.std(axis=0) for part in (heights, heights[:1500]))
    np.testing.assert_allclose(2.0 * many / few, 1.0, atol=0.2)
