"""Made surfaces of harmonic_fractal: exact sums, sums over random phases, and Brownian motion by its formula."""

import numpy as np
import pytest
from scipy.special import gamma

from harmonic_fractal.generators import (
    Array,
    Instrument,
    Waves,
    as_measured,
    brownian_profiles,
    brownian_surface,
    levelled_structure,
    profile_sum,
    surface_sum,
    weierstrass_profile,
    weierstrass_surface,
)
from harmonic_fractal.structure import structure_function

SPACING = 0.4e-6
LENGTH = 200e-6


def waves(dimension: float, roughness: float = 1e-11, **other: float) -> Waves:
    """A band wide enough to try an estimator on 501 points of 0.4 um."""
    band = {"lowest": 1.0 / (100.0 * LENGTH), "highest": 50.0 / SPACING, **other}
    return Waves(dimension=dimension, roughness=roughness, **band)  # type: ignore[arg-type]


def squares(heights: Array, step: int) -> Array:
    """Mean square of the difference of height over so many points, line by line."""
    return np.asarray(np.mean((heights[:, step:] - heights[:, :-step]) ** 2, axis=1))


def integral(exponent: complex) -> complex:
    """Of (1 - cos u) u^(-1-a) du over u > 0: Gamma(1-a) cos(pi a/2)/a, tables; not at a = 1."""
    return complex(gamma(1.0 - exponent) * np.cos(np.pi * exponent / 2.0) / exponent)


@pytest.mark.parametrize("dimension", [1.3, 1.4, 1.55, 1.7])
def test_lines_of_random_phases_have_the_exact_structure_function(dimension: float) -> None:
    made = waves(dimension)
    lines = weierstrass_profile(made, SPACING * np.arange(501), 200, np.random.default_rng(4))
    assert lines.shape == (200, 501)
    np.testing.assert_allclose(lines[:, 0], 0.0, atol=1e-15)
    for step in (1, 3, 10, 30, 50):
        each = squares(lines, step)
        exact = profile_sum(made, np.array([step * SPACING]))[0]
        assert abs(each.mean() - exact) < 3.0 * each.std(ddof=1) / np.sqrt(200)


@pytest.mark.parametrize("dimension", [1.2, 1.4, 1.5 + 1e-9, 1.6, 1.8])
def test_the_exact_sum_of_a_profile_is_the_power_law_with_its_ripple(dimension: float) -> None:
    made = Waves(dimension=dimension, roughness=1e-10, lowest=1e-8, highest=1e20)  # a band without ends
    lags = 1e-6 * 1.5 ** np.linspace(0.0, 1.0, 4000, endpoint=False)  # one period of the ripple
    exponent, turns = 4.0 - 2.0 * dimension, 2.0 * np.pi / np.log(1.5)
    constant = (2.0 * np.pi) ** exponent * integral(exponent).real / np.log(1.5)
    ratio = profile_sum(made, lags) / (constant * 1e-10 ** (2.0 - exponent) * lags**exponent)
    assert ratio.mean() == pytest.approx(1.0, abs=1e-3)
    ripple = 2.0 * abs(np.mean(ratio * np.exp(-1j * turns * np.log(lags))))  # its first harmonic
    expected = 2.0 * abs(integral(exponent + 1j * turns)) / abs(integral(exponent))
    assert ripple == pytest.approx(expected, rel=2e-3)


def test_the_sum_over_many_directions_is_the_areal_law_along_any_trace() -> None:
    made = Waves(dimension=1.4, roughness=1e-11, lowest=1e-3, highest=1e11, density=1.1, directions=200)  # no ripple
    lags = np.geomspace(1e-6, 1e-5, 20)
    for angle in (0.0, 0.3, np.pi / 2):
        ratio = surface_sum(made, lags, angle) / structure_function(lags, 1.4, 1e-11)
        np.testing.assert_allclose(ratio, 1.0, atol=0.003)


def test_one_direction_is_the_profile_but_for_the_logarithm_of_the_density() -> None:
    made = waves(1.45, directions=1)
    lags = np.geomspace(1e-7, 1e-4, 30)
    np.testing.assert_allclose(surface_sum(made, lags), np.log(1.5) * profile_sum(made, lags), rtol=1e-13)
    np.testing.assert_allclose(surface_sum(made, lags, np.pi / 2), 0.0, atol=1e-30)  # along the ridges


def test_a_patch_is_the_sum_over_its_waves_one_by_one() -> None:
    made = Waves(dimension=1.4, roughness=1e-10, lowest=2e3, highest=3e5, density=1.7, directions=5)
    x, y = 1.3e-6 * np.arange(7) - 2e-6, 0.7e-6 * np.arange(5)
    patch = weierstrass_surface(made, x, y, np.random.default_rng(7))
    phases = np.random.default_rng(7).uniform(0.0, 2.0 * np.pi, (5, len(made.frequencies)))
    heights = np.zeros((5, 7))
    scale = 1e-10**0.4 * np.sqrt(np.log(1.7) / 5)
    for m in range(1, 6):
        n, frequency = 0, 2e3
        while frequency <= 3e5:
            phase = phases[m - 1, n]
            way = np.add.outer(y * np.sin(np.pi * m / 5), x * np.cos(np.pi * m / 5))
            wave = np.cos(phase) - np.cos(2.0 * np.pi * frequency * way + phase)
            heights += scale * frequency**-0.6 * wave
            n, frequency = n + 1, frequency * 1.7
    assert np.abs(patch - heights).max() < 1e-12 * np.abs(heights).max()


def brownian_covariance(dimension: float, step: float, one: Array, two: Array) -> Array:
    """Of heights of fractional Brownian motion that is 0 at its start (Mandelbrot, van Ness 1968)."""
    exponent = 4.0 - 2.0 * dimension
    return np.asarray(0.5 * step * (one**exponent + two**exponent - np.abs(one - two) ** exponent))


@pytest.mark.parametrize("dimension", [1.2, 1.5, 1.75])
def test_brownian_lines_have_the_covariance_of_the_formula(dimension: float) -> None:
    count, step = 20_000, 4e-18
    lines = brownian_profiles(dimension, step, (count, 24), np.random.default_rng(11))
    np.testing.assert_array_equal(lines[:, 0], 0.0)
    places = np.array([1, 2, 7, 23])
    values = lines[:, places]
    one, two = np.meshgrid(places.astype(float), places.astype(float))
    exact = brownian_covariance(dimension, step, one, two)
    found = values.T @ values / count
    error = np.sqrt((np.outer(exact.diagonal(), exact.diagonal()) + exact**2) / count)  # of a Gaussian sample
    assert np.abs((found - exact) / error).max() < 3.5  # sixteen figures, ten of them different


def test_lines_made_together_know_nothing_of_one_another() -> None:
    lines = brownian_profiles(1.4, 1.0, (20_000, 3), np.random.default_rng(0))
    halves = np.corrcoef(lines[:10_000, 2], lines[10_000:, 2])[0, 1]  # real and imaginary parts of one transform
    assert abs(halves) < 3.0 / np.sqrt(10_000)
    assert brownian_profiles(1.4, 1.0, (3, 10), np.random.default_rng(0)).shape == (3, 10)


@pytest.mark.parametrize("dimension", [1.15, 1.6])
def test_brownian_patches_have_their_law_in_every_direction(dimension: float) -> None:
    exponent, count, step = 4.0 - 2.0 * dimension, 1500, 2.0
    pairs = (((0, 0), (0, 1)), ((0, 0), (1, 0)), ((3, 2), (9, 25)), ((0, 29), (19, 0)), ((19, 0), (0, 0)))
    differences = np.empty((count, len(pairs)))
    for row in range(count):
        patch = brownian_surface(dimension, step, (20, 30), np.random.default_rng([5, row]))
        differences[row] = [patch[one] - patch[two] for one, two in pairs]
    exact = np.array([step * np.hypot(one[0] - two[0], one[1] - two[1]) ** exponent for one, two in pairs])
    deviation = ((differences**2).mean(axis=0) - exact) / (exact * np.sqrt(2.0 / count))
    assert np.abs(deviation).max() < 3.0


@pytest.mark.parametrize("dimension", [1.2, 1.5, 1.8])
def test_levelled_lines_have_the_structure_function_of_their_covariance(dimension: float) -> None:
    """P C P of the covariance of Brownian motion, with P what is left beside a straight line, entry by entry."""
    places = np.arange(90.0)
    covariance = brownian_covariance(dimension, 1.0, *np.meshgrid(places, places))
    base, _ = np.linalg.qr(np.stack([np.ones(90), places], axis=1))
    left = np.eye(90) - base @ base.T
    levelled = left @ covariance @ left
    spread = levelled.diagonal()
    exact = [np.mean(spread[k:] + spread[: 90 - k] - 2.0 * levelled.diagonal(k)) for k in range(90)]
    every = places ** (4.0 - 2.0 * dimension)
    np.testing.assert_allclose(levelled_structure(every), exact, rtol=0.0, atol=1e-11 * every[-1])


def test_the_lateral_filter_halves_its_wave_and_spares_long_ones() -> None:
    x = 0.5e-6 * np.arange(4000)
    instrument = Instrument(cutoff=20e-6)
    for wave, passed in ((20e-6, 0.5), (10e-6, 2.0**-4), (40e-6, 2.0**-0.25)):  # 2^-(cutoff/wave)^2, ISO 16610-21
        line = np.sin(2.0 * np.pi * x / wave)[None, :]
        seen = as_measured(line, 0.5e-6, instrument, np.random.default_rng(0), across=False)
        margin = instrument.margin(0.5e-6)
        assert seen.shape == (1, 4000 - 2 * margin)
        expected = passed * line[:, margin:-margin]
        np.testing.assert_allclose(seen, expected, atol=2e-3)


def test_an_instrument_adds_what_it_says() -> None:
    flat, rng = np.zeros((200, 300)), np.random.default_rng(2)
    noisy = as_measured(flat, 1e-6, Instrument(noise=3e-9), rng)
    assert noisy.std() == pytest.approx(3e-9, rel=0.01)
    seen = as_measured(flat, 1e-6, Instrument(spikes=0.01, spike_height=1e-7, holes=0.03), rng)
    assert np.isnan(seen).sum() == 1800
    assert (np.abs(seen) == 1e-7).sum() == 600
    told = as_measured(noisy, 1e-6, Instrument(step=1e-9), rng) / 1e-9
    np.testing.assert_allclose(told, np.round(told), atol=1e-6)
    assert np.abs(told * 1e-9 - noisy).max() <= 0.5e-9 * (1 + 1e-6)
    np.testing.assert_array_equal(flat, 0.0)
