"""Sums of squared height differences against the plain loop over points, with and without holes."""

import numpy as np
import pytest

from harmonic_fractal.structure import StructureFunction, mean_squares, piece_sums, structure_sums

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


@pytest.mark.parametrize("holes", [0.0, 0.03, 0.5])
@pytest.mark.parametrize("shape", [(7, 60), (1, 300), (90, 500)])  # the last is of more than one block of lines
def test_sums_are_those_of_the_loop(shape: tuple[int, int], holes: float) -> None:
    """Every line, every lag."""
    heights = rough(*shape, holes)
    for ours, theirs in zip(structure_sums(heights, STEPS), by_loop(heights, STEPS), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_lines_along_y_are_columns() -> None:
    """A transposed map, whose lines are not side by side in memory."""
    heights = rough(80, 60, 0.02)
    for ours, theirs in zip(structure_sums(heights.T, STEPS), by_loop(heights.T, STEPS), strict=True):
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
    curve = StructureFunction(STEPS * 1.0, sums, counts)
    others = structure_sums(heights[[0, 2]], STEPS)
    np.testing.assert_allclose(curve.pooled, others[0].sum(axis=0) / others[1].sum(axis=0), rtol=1e-12)
    np.testing.assert_array_equal(np.isnan(mean_squares(sums, counts)), [[False] * 4, [True] * 4, [False] * 4])


@pytest.mark.parametrize("holes", [0.0, 0.1])
def test_pieces_add_up_to_the_lines(holes: float) -> None:
    """Cut across into pieces, the pairs are the same ones."""
    heights = rough(90, 500, holes)
    whole, pieces = structure_sums(heights, STEPS), piece_sums(heights, STEPS, 50)
    for lines, parts in zip(whole, pieces, strict=True):
        assert parts.shape == (50, 4)
        np.testing.assert_allclose(parts.sum(axis=0), lines.sum(axis=0), rtol=1e-10)


def test_a_pair_belongs_to_the_piece_it_begins_in() -> None:
    """One step in the height, seen over one point: it is in the piece that holds the point before it."""
    heights = np.zeros((2, 101))
    heights[:, 37:] = 1.0
    sums, counts = piece_sums(heights, np.array([1]), 10)
    np.testing.assert_array_equal(sums[:, 0], [0, 0, 0, 2, 0, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(counts[:, 0], [20] * 10)


def test_there_are_no_more_pieces_than_pairs_to_share() -> None:
    """Of 20 points and a lag of 17 there are three pairs."""
    sums, counts = piece_sums(rough(2, 20, 0.0), STEPS, 50)
    assert sums.shape == counts.shape == (3, 4)
    assert (counts > 0).all()
