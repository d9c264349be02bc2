"""Engaged pairs together: shares, sums, and what stands around the rough contact of each."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from harmonic_drives import drive_of, mesh

from harmonic_fractal.calculation import around_of, harmonic_fractal
from harmonic_fractal.contact import contact_of, interface_of, pressed
from harmonic_fractal.mesh import arcs_of, engagement_of, load_of_largest, mesh_torsion, normal_stiffness
from harmonic_fractal.quantities import Drive

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


# Torsion over torque: beside a dense trapezoid, odd, from its reference on, and with what is in series.

# inputs and torque: all pairs elastic from the start, some of them not, nearly none of them; springs; a film; pairs
# that come to bear on the way
CASES: list[tuple[dict[str, Any], float]] = [
    ({}, 25.0),
    ({"engaged_pairs": 1}, 25.0),
    ({"fractal_dimension": 2.5, "fractal_roughness": 1e-9, "reference_torque": 0.1}, 25.0),
    ({"fractal_dimension": 2.3, "reference_torque": 2.24e-3}, 25.0),
    ({"fractal_dimension": 2.3, "reference_torque": 0.013, "tip_rule": "scaled"}, 100.0),
    ({"fractal_dimension": 2.6, "fractal_roughness": 1e-9, "reference_torque": 0.01}, 250.0),
    ({"fractal_dimension": 2.9, "fractal_roughness": 1e-9, "reference_torque": 1e-4}, 25.0),
    ({"fractal_dimension": 2.1, "fractal_roughness": 1e-22}, 25.0),
    ({"critical_rule": "yield_onset", "reference_torque": 0.05}, 25.0),
    ({"tooth_stiffness": 2e7}, 25.0),
    ({"tooth_stiffness": 1e9, "line_contact": True, "film_stiffness": 1e8, "engaged_pairs": 7,
      "reference_torque": 2e-6}, 25.0),
    ({"engaged_gain": 2.0, "engaged_torque": 1.0}, 25.0),
    ({"engaged_gain": 0.7, "engaged_torque": 20.0, "tooth_stiffness": 2e7}, 100.0),
    ({"engaged_gain": 2.0, "engaged_torque": 0.05, "fractal_dimension": 2.3, "reference_torque": 3e-3}, 25.0),
    ({"engaged_pairs": 201, "engaged_factor": 0.9, "flexspline_teeth": 400, "reference_torque": 2e-4}, 25.0),
]  # fmt: skip


def by_trapezoids(drive: Drive, torque: float) -> float:
    """The integral of dT/K_mesh by trapezoids in ln(T - T_c) and Richardson's step; K_mesh rises from T_c on."""
    ours = mesh(drive)
    start = float(ours.plastic_torque)
    found = []
    for count in (15_001, 30_001):
        way = np.linspace(np.log(drive.reference_torque - start), np.log(torque - start), count)
        beyond = np.exp(way)
        compliance = 1.0 / (normal_stiffness(start + beyond, ours) * ours.radius**2)
        found.append(np.trapezoid(beyond * compliance, way))
    return float(found[1] + (found[1] - found[0]) / 3.0)


@pytest.mark.parametrize(("changed", "torque"), CASES, ids=[str(index) for index in range(len(CASES))])
def test_torsion_is_the_integral_of_the_compliance(changed: dict[str, Any], torque: float) -> None:
    drive = drive_of(**changed)
    found, rough = mesh_torsion(torque, drive.reference_torque, mesh(drive))
    assert found == pytest.approx(by_trapezoids(drive, torque), rel=1e-8)
    bare = replace(drive, tooth_stiffness=np.nan, line_contact=False, film_stiffness=0.0)
    assert rough == pytest.approx(by_trapezoids(bare, torque), rel=1e-8)


def test_torsion_is_odd_and_counts_from_its_reference() -> None:
    torque = np.array([-30.0, -25.0, -1e-3, -5e-4, 0.0, 5e-4, 1e-3, 25.0, 30.0])
    for changed in ({}, {"drive_compliance": 4e-5, "cup_length": 28e-3, "tooth_stiffness": 2e7}):
        found = harmonic_fractal(drive_of(torque=torque, **changed))  # type: ignore[arg-type]
        for name in ("torsion", "mesh_torsion", "rough_torsion", "catalogue_torsion"):
            values = np.asarray(getattr(found, name))
            np.testing.assert_allclose(values, -values[::-1], rtol=1e-14, atol=0.0)
            if name != "catalogue_torsion":
                assert (values[2:7] == 0.0).all()
            assert (np.diff(values) >= 0.0).all()
        np.testing.assert_allclose(found.mesh_stiffness, np.asarray(found.mesh_stiffness)[::-1], rtol=1e-14)


def test_slope_of_the_torsion_is_the_compliance() -> None:
    drive = drive_of(
        drive_compliance=4e-5, cup_length=28e-3, tooth_stiffness=2e7, torque=np.array([24.99, 25.0, 25.01])
    )
    found = harmonic_fractal(drive)
    slope = (found.torsion[2] - found.torsion[0]) / 0.02  # type: ignore[index]
    assert found.torsional_stiffness[1] == pytest.approx(1.0 / slope, rel=1e-7)  # type: ignore[index]


def test_what_is_in_series() -> None:
    """The cup as a thin tube, G J/l; softer steel is softer everywhere."""
    around = around_of(drive_of(cup_length=28e-3, drive_compliance=4e-5))
    tube = 206e9 / 2.6 * 2 * np.pi * 24.5e-3**3 * 0.35e-3 / 28e-3
    assert around["series_compliance"] == pytest.approx(4e-5 + 1.0 / tube, rel=1e-12)
    softer = around_of(drive_of(cup_length=28e-3, drive_compliance=4e-5, modulus_factor=0.9))
    assert softer["series_compliance"] == pytest.approx(around["series_compliance"] / 0.9, rel=1e-12)
    assert around_of(drive_of())["series_compliance"] == 0.0


def test_roughness_alone_where_nothing_else_gives() -> None:
    found = harmonic_fractal(drive_of())
    assert found.torsion == found.mesh_torsion == found.rough_torsion
    assert found.rough_share == pytest.approx(float(found.rough_torsion) / 1.1575e-3, rel=1e-12)  # 7/16e3 + 18/25e3


def test_from_torque_to_torque_without_stiffness_there_is_no_end() -> None:
    ours = mesh(drive_of(fractal_dimension=2.3))
    assert mesh_torsion(25.0, 1e-3, ours) == (np.inf, np.inf)
    assert mesh_torsion(1e-3, 1e-3, ours) == (0.0, 0.0)
