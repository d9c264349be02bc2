"""Engaged pairs together: shares, sums, and what stands around the rough contact of each."""

from typing import Any

import numpy as np
import pytest
from harmonic_drives import drive_of, mesh

from harmonic_fractal.contact import contact_of, interface_of, pressed
from harmonic_fractal.mesh import arcs_of, engagement_of, load_of_largest, normal_stiffness

RADIUS = 25.4e-3 * np.cos(np.radians(20.0))


def shares_one_by_one(pairs: int) -> "np.typing.NDArray[np.float64]":
    """Every pair on its own: the middle of equal parts of its arc, by the square of the cosine."""
    weights = []
    for count in ((pairs + 1) // 2, pairs // 2):
        ends = np.linspace(-1.0, 1.0, count + 1)
        weights.extend(np.cos(0.5 * np.pi * 0.5 * (ends[1:] + ends[:-1])) ** 2)
    return np.array(weights) / np.sum(weights)


@pytest.mark.parametrize("pairs", [1, 2, 3, 4, 7, 60, 61, 320])
def test_shares_make_the_whole_torque(pairs: int) -> None:
    arcs = arcs_of(pairs)
    assert arcs.counts.sum() == pairs
    assert np.dot(arcs.shares, arcs.counts) == pytest.approx(1.0, rel=1e-14)
    drawn_out = np.repeat(arcs.shares, arcs.counts.astype(int))
    np.testing.assert_allclose(drawn_out, np.sort(shares_one_by_one(pairs))[::-1], rtol=1e-12)
    loads = 25.0 / RADIUS * drawn_out
    assert np.sum(loads) * RADIUS == pytest.approx(25.0, rel=1e-14)


@pytest.mark.parametrize("pairs", [2, 7, 60])
@pytest.mark.parametrize("around", [
    {}, {"tooth_stiffness": 2e7}, {"line_contact": True}, {"film_stiffness": 3e9},
    {"tooth_stiffness": 2e7, "line_contact": True, "film_stiffness": 3e9, "modulus_factor": 0.9},
])  # fmt: skip
def test_the_sum_over_every_pair(pairs: int, around: dict[str, Any]) -> None:
    drive = drive_of(engaged_pairs=pairs, **around)
    found = pressed(25.0 / RADIUS * shares_one_by_one(pairs), contact_of(drive, interface_of(drive)))
    stiffness = found.stiffness + drive.film_stiffness * (1.0 - found.real_area / (10e-3 * 0.4e-3))
    compliance = 1.0 / stiffness
    if drive.line_contact:  # pi E l/2, with E of steel on steel
        compliance = compliance + 1.0 / (np.pi * drive.modulus_factor * 206e9 / (2 * (1 - 0.09)) * 10e-3 / 2)
    if "tooth_stiffness" in around:
        compliance = compliance + 1.0 / (2e7 * drive.modulus_factor)
    assert normal_stiffness(25.0, mesh(drive)) == pytest.approx(np.sum(1.0 / compliance), rel=1e-11)


def test_soft_teeth_make_a_soft_mesh() -> None:
    """Towards teeth without stiffness only their own remains: that of one tooth times the pairs."""
    for tooth in (1e3, 1.0, 1e-3):
        found = normal_stiffness(25.0, mesh(drive_of(tooth_stiffness=tooth)))
        assert found == pytest.approx(60 * tooth, rel=2e-5)


@pytest.mark.parametrize("factor", [0.5, 1.37, 2.0])
def test_more_pairs_each_carry_less(factor: float) -> None:
    """As many times the pairs, each with its part of the load: at this torque that of a part of it, so many times."""
    more, plain = mesh(drive_of(engaged_factor=factor)), mesh(drive_of())
    assert normal_stiffness(25.0, more) == pytest.approx(factor * normal_stiffness(25.0 / factor, plain), rel=1e-12)
    assert load_of_largest(25.0, more) == pytest.approx(load_of_largest(25.0, plain) / factor, rel=1e-12)


def test_pairs_come_to_bear_under_torque() -> None:
    """63 % of the gain at its torque, all of it far beyond; in each sense."""
    more = engagement_of(drive_of(engaged_factor=0.8, engaged_gain=1.5, engaged_torque=10.0))
    assert more.factor(0.0) == 0.8
    assert more.factor(-10.0) == pytest.approx(0.8 * (1.0 + 1.5 * (1.0 - np.exp(-1.0))), rel=1e-14)
    assert more.factor(1e4) == pytest.approx(0.8 * 2.5, rel=1e-14)


@pytest.mark.parametrize("gain", [0.0, 0.3, 5.0, 100.0])
def test_from_the_share_of_the_pairs_back_to_the_torque(gain: float) -> None:
    more = engagement_of(drive_of(engaged_factor=0.8, engaged_gain=gain, engaged_torque=10.0))
    torque = np.geomspace(1e-7, 1e4, 200)
    np.testing.assert_allclose(more.torque_of(torque / more.factor(torque)), torque, rtol=1e-12)


def test_no_torque_no_stiffness_but_that_of_a_film() -> None:
    assert normal_stiffness(0.0, mesh(drive_of())) == 0.0
    assert normal_stiffness(0.0, mesh(drive_of(film_stiffness=1e8))) == pytest.approx(60 * 1e8, rel=1e-12)


def test_both_senses_are_alike_and_rows_are_single_drives() -> None:
    torque = np.array([-25.0, -1.0, 0.0, 3e-6, 1.0, 25.0, 400.0])
    dimension = np.array([2.4, 2.3, 2.4, 2.45, 2.3, 2.4, 2.55])
    rows = normal_stiffness(torque, mesh(drive_of(fractal_dimension=dimension)))
    for row, (one, value) in enumerate(zip(torque, dimension, strict=True)):
        single = normal_stiffness(-one, mesh(drive_of(fractal_dimension=value)))
        assert rows[row] == pytest.approx(single, rel=1e-12)  # type: ignore[index]
