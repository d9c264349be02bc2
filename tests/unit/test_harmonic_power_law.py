"""The power law of the structure function: its constant, the exact sum it stands for, and the conventions of G."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

from harmonic_fractal.structure import constant, converted, log_roughness_of, spectral_constant, structure_function

DENSITY = 1.5
DIMENSIONS = (1.2, 1.4, 1.5, 1.6, 1.8)


def exact_sum(lags: np.ndarray, dimension: float, roughness: float) -> np.ndarray:
    """S of the Weierstrass-Mandelbrot profile: its sum over the modes, mean over the random phases."""
    modes = np.arange(-40.0, 140.0)[:, None]
    waves = 1.0 - np.cos(2.0 * np.pi * DENSITY**modes * lags)
    return roughness ** (2 * (dimension - 1)) * (DENSITY ** ((2 * dimension - 4) * modes) * waves).sum(axis=0)


def lags_of_a_decade() -> np.ndarray:
    """Evenly in the logarithm, over six periods of the ripple: a little more than a decade."""
    return 0.4e-6 * DENSITY ** np.linspace(0.0, 6.0, 601)[:-1]


def test_lambda_is_half_pi_at_one_and_a_half() -> None:
    """The integral of (1 - cos u)/u^2 over u from 0 to infinity."""
    assert float(spectral_constant(1.5)) == pytest.approx(np.pi / 2, rel=1e-14)


def test_lambda_is_continuous_where_the_printed_form_is_zero_times_infinity() -> None:
    """From below and from above the value is that at 1.5."""
    for shift in (-1e-6, 1e-6):
        assert float(spectral_constant(1.5 + shift)) == pytest.approx(np.pi / 2, rel=1e-5)


@pytest.mark.parametrize("dimension", [1.05, 1.2, 1.4, 1.49, 1.6, 1.8, 1.95])
def test_lambda_is_the_printed_product_of_gamma_and_sine(dimension: float) -> None:
    """Gamma(2 D_s - 3) sin[(2 D_s - 3) pi/2] / (4 - 2 D_s), Majumdar and Tien 1990."""
    x = 2 * dimension - 3
    printed = gamma(x) * np.sin(x * np.pi / 2) / (4 - 2 * dimension)
    assert float(spectral_constant(dimension)) == pytest.approx(printed, rel=1e-9)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_the_power_law_is_the_mean_of_the_exact_sum(dimension: float) -> None:
    """Within 0.5 % over a decade, in the convention of the profile."""
    lags = lags_of_a_decade()
    law = constant(dimension, DENSITY, "profile") * 1e-9 ** (2 * (dimension - 1)) * lags ** (4 - 2 * dimension)
    assert float(np.mean(exact_sum(lags, dimension, 1e-9) / law)) == pytest.approx(1.0, abs=0.005)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_many_directions_weigh_by_the_mean_power_of_the_cosine(dimension: float) -> None:
    """The areal constant over that of one direction, by quadrature over the angle of the trace."""
    mean = quad(lambda angle: np.cos(angle) ** (4 - 2 * dimension), 0, np.pi / 2)[0] / (np.pi / 2)
    ratio = constant(dimension, DENSITY, "areal") / constant(dimension, DENSITY, "one_direction")
    assert float(ratio) == pytest.approx(mean, rel=1e-9)


def test_an_areal_roughness_is_four_times_that_of_the_profile() -> None:
    """At D_s = 1.5 and gamma = 1.5 by (pi/2)/ln 1.5, the square root of which is not taken: 2 (D_s - 1) = 1."""
    areal = converted(1e-9, 1.5, DENSITY, source="profile", target="areal")
    assert float(areal) == pytest.approx(1e-9 * np.pi / 2 / np.log(1.5), rel=1e-12)


def test_a_convention_is_undone_by_the_way_back() -> None:
    """There and back, for dimensions and densities as arrays."""
    dimension, density = np.array([1.1, 1.5, 1.9]), np.array([1.2, 1.5, 3.0])
    there = converted(1e-10, dimension, density, source="profile", target="one_direction")
    back = converted(there, dimension, density, source="one_direction", target="profile")
    np.testing.assert_allclose(back, 1e-10, rtol=1e-12)


def test_the_areal_convention_does_not_know_the_density() -> None:
    """Its factor ln(gamma) is in the surface itself (Yan and Komvopoulos 1998)."""
    assert constant(1.4, 1.5, "areal") == constant(1.4, 5.0, "areal")


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_roughness_of_its_own_structure_function(dimension: float) -> None:
    """The level at a lag of one metre gives back the roughness it was made with."""
    intercept = np.log(structure_function(1.0, dimension, 3e-11))
    assert float(np.exp(log_roughness_of(intercept, dimension))) == pytest.approx(3e-11, rel=1e-9)


def test_a_power_law_of_another_exponent_has_no_roughness() -> None:
    """A smooth surface (D_s = 1) and noise (2) and beyond."""
    found = log_roughness_of(np.zeros(5), np.array([0.9, 1.0, 1.5, 2.0, 2.1]))
    np.testing.assert_array_equal(np.isnan(found), [True, True, False, True, True])
