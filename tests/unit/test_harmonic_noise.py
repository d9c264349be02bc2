"""The fit of a power law with the noise of the instrument, against scipy's, and on surfaces with known noise."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from harmonic_fractal.estimate import Estimation, estimate_of, noise_fit, straight_fit
from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.surface import Lines

LAGS = 0.4e-6 * np.unique(np.round(np.geomspace(1, 50, 16)))


def law(amplitude: float, slope: float, noise: float) -> np.ndarray:
    """A lag^s + 2 sigma^2."""
    return np.asarray(amplitude * (LAGS / LAGS[0]) ** slope + 2.0 * noise**2)


@pytest.mark.parametrize("slope", [0.1, 0.6, 1.0, 1.4, 1.9])
@pytest.mark.parametrize("noise", [0.0, 0.3, 1.0, 3.0])
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


@pytest.mark.parametrize("seed", range(12))
def test_the_least_squares_are_those_of_scipy(seed: int) -> None:
    """On scattered values: no other start finds a better fit."""
    rng = np.random.default_rng(seed)
    values = law(1e-16, rng.uniform(0.2, 1.8), rng.uniform(0.0, 2e-8)) * np.exp(0.1 * rng.standard_normal(LAGS.size))
    found = noise_fit(LAGS, values)
    model = np.exp(found.intercept) * LAGS**found.slope + 2.0 * found.noise**2
    ours = float(np.sum(np.log(values / model) ** 2))
    assert ours <= reference(values) * (1 + 1e-4) + 1e-12


def test_many_curves_are_fitted_as_each_alone() -> None:
    """Batch and single, with noise and without."""
    rng = np.random.default_rng(2)
    curves = np.stack([law(1e-16, slope, 1e-8) for slope in (0.4, 1.0, 1.6)])
    curves = curves * np.exp(0.05 * rng.standard_normal(curves.shape))
    for fit in (straight_fit, noise_fit):
        together = fit(LAGS, curves)
        for row, curve in enumerate(curves):
            alone = fit(LAGS, curve)
            assert together.slope[row] == pytest.approx(float(alone.slope), rel=1e-6)
            assert together.intercept[row] == pytest.approx(float(alone.intercept), rel=1e-6)
            assert together.noise[row] == pytest.approx(float(alone.noise), rel=1e-4, abs=1e-12)


def test_a_straight_fit_is_that_of_a_polynomial_of_first_degree() -> None:
    """numpy.polyfit, and R^2 by the correlation of both logarithms."""
    values = law(1e-16, 0.9, 5e-9)
    found, x, y = straight_fit(LAGS, values), np.log(LAGS), np.log(values)
    np.testing.assert_allclose([found.slope, found.intercept], np.polyfit(x, y, 1), rtol=1e-9)
    assert float(found.r_squared) == pytest.approx(np.corrcoef(x, y)[0, 1] ** 2, rel=1e-9)


def test_a_noisy_fractal_is_accepted_with_its_noise_taken_off() -> None:
    """The local slopes are those of S less the noise; the short lags, which tell the noise, stay in the fit."""
    rng = np.random.default_rng(4)
    heights = brownian_profiles(1.4, 1e-16, (100, 1000), rng) + 1.5e-8 * rng.standard_normal((100, 1000))
    found = estimate_of(Lines(heights, 0.4e-6), "x", Estimation(resamples=50, noise_aware=True))
    assert found.is_accepted
    assert found.dimension == pytest.approx(1.4, abs=0.05)
    assert found.lags[0] == pytest.approx(0.4e-6)
    np.testing.assert_allclose(found.local_dimensions[:3], 1.4, atol=0.08)  # half of the noise left: 1.6 and more
    assert found.resampled.shape == (50, 2)


def test_white_noise_alone_is_refused_by_the_fit_with_noise_too() -> None:
    """Nothing is left when the noise is taken off."""
    heights = 1e-8 * np.random.default_rng(4).standard_normal((100, 500))
    assert not estimate_of(Lines(heights, 0.4e-6), "x", Estimation(resamples=0, noise_aware=True)).is_accepted


def test_the_share_of_noise_stands_beside_a_fit_without_it() -> None:
    """Noise of a third of S at one spacing: 2 sigma^2 = S/2 makes the share 1/3; no noise, no share."""
    rng = np.random.default_rng(4)
    clean = brownian_profiles(1.4, 1e-16, (200, 1000), rng)
    noisy = clean + 0.5e-8 * rng.standard_normal(clean.shape)
    for heights, share in ((clean, 0.0), (noisy, 1.0 / 3.0)):
        found = estimate_of(Lines(heights, 0.4e-6), "x", Estimation(resamples=0, fit="all"))
        assert found.noise_share == pytest.approx(share, abs=0.05)
        assert found.noise_dimension == pytest.approx(1.4, abs=0.03)


def test_smooth_short_lags_are_no_noise() -> None:
    """A filtered surface without noise: the fit with noise leaves its smooth lags out as the plain fit does."""
    rng = np.random.default_rng(5)
    kernel = np.array([0.25, 0.5, 0.25])
    lines = brownian_profiles(1.5, 1e-16, (100, 1502), rng)
    heights = np.stack([np.convolve(line, kernel, mode="valid") for line in lines])
    plain, aware = (
        estimate_of(Lines(heights, 0.4e-6), "x", Estimation(resamples=0, noise_aware=aware)) for aware in (False, True)
    )
    assert aware.lags[0] == plain.lags[0] > 0.4e-6
    assert aware.dimension == pytest.approx(plain.dimension, abs=0.01)


def test_a_plain_fit_of_a_noisy_surface_warns() -> None:
    """With both dimensions; a fit with noise, and a surface without, have nothing to say."""
    rng = np.random.default_rng(4)
    clean = brownian_profiles(1.5, 1e-16, (100, 1000), rng)
    noisy = clean + 1e-8 * rng.standard_normal(clean.shape)
    plain, aware, quiet = (
        estimate_of(Lines(heights, 0.4e-6), "x", Estimation(resamples=0, noise_aware=aware))
        for heights, aware in ((noisy, False), (noisy, True), (clean, False))
    )
    assert plain.is_accepted
    assert len(plain.warnings) == 1
    assert f"dimension {plain.noise_dimension:.3f}, not {plain.dimension:.3f}" in plain.warnings[0]
    assert aware.warnings == quiet.warnings == ()
