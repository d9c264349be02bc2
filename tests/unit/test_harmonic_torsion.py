"""Torsion over torque: beside a dense trapezoid, odd, from its reference on, and with what is in series."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from harmonic_drives import drive_of, mesh

from harmonic_fractal import mesh as torsion_module
from harmonic_fractal.calculation import around_of, harmonic_fractal
from harmonic_fractal.mesh import mesh_torsion, normal_stiffness
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive
from truing.evaluate import evaluate_rows
from truing.setup import default_setup

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


def test_finer_panels_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_cases() -> list[float]:
        return [float(mesh_torsion(torque, drive.reference_torque, mesh(drive))[0]) for drive, torque in made]

    made = [(drive_of(**changed), torque) for changed, torque in CASES]
    once = all_cases()
    monkeypatch.setattr(torsion_module, "RULE", np.polynomial.legendre.leggauss(20))
    monkeypatch.setattr(torsion_module, "WIDEST", 0.3)
    monkeypatch.setattr(torsion_module, "KINKS", 1000)
    np.testing.assert_allclose(once, all_cases(), rtol=1e-9)


def test_rows_are_single_drives_however_they_are_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(3)
    torque, dimension = rng.uniform(-40.0, 40.0, 60), rng.uniform(2.38, 2.55, 60)
    factor = rng.uniform(0.5, 2.0, 60)
    ours = mesh(drive_of(fractal_dimension=dimension, engaged_factor=factor))
    whole, rough = mesh_torsion(torque, 1e-3, ours)
    monkeypatch.setattr(torsion_module, "CHUNK", 500)
    in_pieces, _ = mesh_torsion(torque, 1e-3, ours)
    np.testing.assert_allclose(whole, in_pieces, rtol=1e-13)
    for row in range(0, 60, 7):
        single = mesh(drive_of(fractal_dimension=dimension[row], engaged_factor=factor[row]))
        for all_rows, one in zip((whole, rough), mesh_torsion(torque[row], 1e-3, single), strict=True):
            assert all_rows[row] == pytest.approx(one, rel=1e-12)  # type: ignore[index]


def test_the_pair_is_always_answered_and_the_torsion_where_it_is_finite() -> None:
    """Of 500 designs many are plastic at the reference; those lack the torsion, and none of them lacks its pair."""
    rng = np.random.default_rng(30)
    columns = {
        "fractal_dimension": rng.uniform(2.2, 2.8, 500), "fractal_roughness": 10 ** rng.uniform(-12, -8.5, 500),
        "torque": 10 ** rng.uniform(-4, 1, 500),
    }  # fmt: skip
    setup = default_setup(HARMONIC_FRACTAL, hardness="3 GPa", pair_load="5 N")
    found = evaluate_rows(setup, columns, 500)
    torsion, least = found.results["torsion"], found.results["plastic_torque"]
    assert all("exceeds the flank" in reason for reason in found.reasons.values())
    alive = ~found.failed
    assert alive.sum() > 400
    for name in ("stiffness", "clearance", "normal_stiffness"):
        assert np.isfinite(found.results[name][alive]).all()
    endless = (least >= 1e-3) & (columns["torque"] > 1e-3)
    assert endless.sum() > 50
    np.testing.assert_array_equal(np.isnan(torsion[alive]), endless[alive])


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


def test_torsion_is_the_sum_of_its_pieces() -> None:
    drive = drive_of()
    first, _ = mesh_torsion(3.0, 1e-3, mesh(drive))
    second, _ = mesh_torsion(25.0, 3.0, mesh(drive))
    whole, _ = mesh_torsion(25.0, 1e-3, mesh(drive))
    assert first + second == pytest.approx(whole, rel=1e-10)


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
