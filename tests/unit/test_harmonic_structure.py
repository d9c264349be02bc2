"""Sums of squared height differences against the plain loop over points, with and without holes."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

from harmonic_fractal import structure
from harmonic_fractal.structure import constant, structure_sums

STEPS = np.array([1, 2, 5, 17])


def by_loop(heights: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Add up pair by pair."""
    sums, counts = np.zeros((len(heights), len(steps))), np.zeros((len(heights), len(steps)))
    for row, line in enumerate(heights.tolist()):
        for column, step in enumerate(steps.tolist()):
            for left, right in zip(line, line[step:], strict=False):
                if left == left and right == right:
                    sums[row, column] += (right - left) ** 2
                    counts[row, column] += 1
    return sums, counts


def rough(lines: int, points: int, holes: float) -> np.ndarray:
    """Random walks with holes."""
    rng = np.random.default_rng(11)
    heights = np.cumsum(rng.standard_normal((lines, points)), axis=1)
    heights[rng.random(heights.shape) < holes] = np.nan
    return heights


@pytest.mark.parametrize("holes", [0.0, 0.3])
@pytest.mark.parametrize("shape", [(7, 60), (1, 300), (90, 300)])  # the last is of more than one block of lines
def test_sums_are_those_of_the_loop(shape: tuple[int, int], holes: float) -> None:
    """Every line, every lag; and along y, where the lines of a map are not side by side in memory."""
    heights = rough(*shape, holes)
    for lines in (heights, heights.T):
        for ours, theirs in zip(structure_sums(lines, STEPS), by_loop(lines, STEPS), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_a_ramp_has_the_square_of_its_rise() -> None:
    """S(k) = (slope k)^2 exactly; heights far from zero lose no digits that matter."""
    heights = 1.0 + 1e-9 * np.arange(200.0)[None].repeat(3, axis=0)
    sums, counts = structure_sums(heights, STEPS)
    np.testing.assert_allclose(sums / counts, np.broadcast_to((1e-9 * STEPS) ** 2, sums.shape), rtol=1e-6)


def test_a_line_without_a_point_counts_no_pair() -> None:
    """It neither adds nor spoils: the others are as without it."""
    heights = rough(3, 60, 0.0)
    heights[1] = np.nan
    sums, counts = structure_sums(heights, STEPS)
    assert not counts[1].any()
    assert not sums[1].any()
    curve = structure.StructureFunction(STEPS * 1.0, sums, counts)
    others = structure_sums(heights[[0, 2]], STEPS)
    np.testing.assert_allclose(curve.pooled, others[0].sum(axis=0) / others[1].sum(axis=0), rtol=1e-12)
    np.testing.assert_array_equal(
        np.isnan(structure.mean_squares(sums, counts)), [[False] * 4, [True] * 4, [False] * 4]
    )


@pytest.mark.parametrize("holes", [0.0, 0.1])
def test_pieces_add_up_to_the_lines(holes: float) -> None:
    """Cut across into pieces, the pairs are the same ones."""
    heights = rough(90, 500, holes)
    whole, pieces = structure_sums(heights, STEPS), structure.piece_sums(heights, STEPS, 50)
    for lines, parts in zip(whole, pieces, strict=True):
        assert parts.shape == (50, 4)
        np.testing.assert_allclose(parts.sum(axis=0), lines.sum(axis=0), rtol=1e-10)


def test_a_pair_belongs_to_the_piece_it_begins_in() -> None:
    """One step in the height, seen over one point: it is in the piece that holds the point before it."""
    heights = np.zeros((2, 101))
    heights[:, 37:] = 1.0
    sums, counts = structure.piece_sums(heights, np.array([1]), 10)
    np.testing.assert_array_equal(sums[:, 0], [0, 0, 0, 2, 0, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(counts[:, 0], [20] * 10)


def test_there_are_no_more_pieces_than_pairs_to_share() -> None:
    """Of 20 points and a lag of 17 there are three pairs."""
    sums, counts = structure.piece_sums(rough(2, 20, 0.0), STEPS, 50)
    assert sums.shape == counts.shape == (3, 4)
    assert (counts > 0).all()


# The power law of the structure function: its constant, the exact sum it stands for, and the conventions of G.

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


@pytest.mark.parametrize("dimension", [1.05, 1.2, 1.4, 1.49, 1.6, 1.8, 1.95])
def test_lambda_is_the_printed_product_of_gamma_and_sine(dimension: float) -> None:
    """Gamma(2 D_s - 3) sin[(2 D_s - 3) pi/2] / (4 - 2 D_s), Majumdar and Tien 1990."""
    x = 2 * dimension - 3
    printed = gamma(x) * np.sin(x * np.pi / 2) / (4 - 2 * dimension)
    assert float(structure.spectral_constant(dimension)) == pytest.approx(printed, rel=1e-9)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_the_power_law_of_the_profile_and_of_many_directions(dimension: float) -> None:
    """The mean of the exact sum within 0.5 % over a decade; directions weigh by the mean power of the cosine."""
    lags = lags_of_a_decade()
    law = constant(dimension, DENSITY, "profile") * 1e-9 ** (2 * (dimension - 1)) * lags ** (4 - 2 * dimension)
    assert float(np.mean(exact_sum(lags, dimension, 1e-9) / law)) == pytest.approx(1.0, abs=0.005)
    mean = quad(lambda angle: np.cos(angle) ** (4 - 2 * dimension), 0, np.pi / 2)[0] / (np.pi / 2)
    ratio = constant(dimension, DENSITY, "areal") / constant(dimension, DENSITY, "one_direction")
    assert float(ratio) == pytest.approx(mean, rel=1e-9)
    # the level at a lag of one metre gives back the roughness it was made with
    intercept = np.log(structure.structure_function(1.0, dimension, 3e-11))
    assert float(np.exp(structure.log_roughness_of(intercept, dimension))) == pytest.approx(3e-11, rel=1e-9)


def test_an_areal_roughness_is_four_times_that_of_the_profile() -> None:
    """At D_s = 1.5 and gamma = 1.5 by (pi/2)/ln 1.5, the square root of which is not taken: 2 (D_s - 1) = 1."""
    areal = structure.converted(1e-9, 1.5, DENSITY, source="profile", target="areal")
    assert float(areal) == pytest.approx(1e-9 * np.pi / 2 / np.log(1.5), rel=1e-12)


def test_a_power_law_of_another_exponent_has_no_roughness() -> None:
    """A smooth surface (D_s = 1) and noise (2) and beyond."""
    found = structure.log_roughness_of(np.zeros(5), np.array([0.9, 1.0, 1.5, 2.0, 2.1]))
    np.testing.assert_array_equal(np.isnan(found), [True, True, False, True, True])
