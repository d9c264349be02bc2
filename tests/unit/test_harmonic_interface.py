"""Two rough flanks as one, and what must hold before a drive is calculated."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from harmonic_drives import drive_of

from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.contact import interface_of, range_of, spacing_of
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.structure import structure_function
from harmonic_fractal.surface import Surface
from truing.errors import InfeasibleError
from truing.evaluate import answered, evaluate_rows
from truing.setup import default_setup

LAGS = np.geomspace(0.4e-6, 20e-6, 16)


@pytest.mark.parametrize("dimension", [2.2, 2.4, 2.5, 2.8])
def test_flanks_of_one_dimension_add_powers_of_their_roughness(dimension: float) -> None:
    both = interface_of(drive_of(fractal_dimension=dimension, fractal_roughness=1e-11, mating_dimension=dimension,
                                 mating_roughness=3e-10))  # fmt: skip
    power = 2.0 * (dimension - 2.0)
    assert both.dimension == pytest.approx(dimension, rel=1e-12)
    assert both.roughness**power == pytest.approx(1e-11**power + 3e-10**power, rel=1e-10)


def test_unlike_flanks_are_one_power_law_near_their_sum() -> None:
    both = interface_of(drive_of(fractal_dimension=2.3, fractal_roughness=1e-11, mating_dimension=2.5,
                                 mating_roughness=1e-9))  # fmt: skip
    one, other = structure_function(LAGS, 1.3, 1e-11), structure_function(LAGS, 1.5, 1e-9)
    expected = np.polyfit(np.log(LAGS), np.log(np.asarray(one) + other), 1)
    assert both.dimension == pytest.approx(3.0 - expected[0] / 2.0, rel=1e-9)
    fitted = structure_function(LAGS, both.dimension - 1.0, both.roughness)
    np.testing.assert_allclose(np.log(fitted), np.polyval(expected, np.log(LAGS)), atol=1e-9)


def test_a_smooth_mate_changes_nothing_and_deviations_come_last() -> None:
    alone = interface_of(drive_of(dimension_deviation=0.03, roughness_deviation=-0.7))
    assert alone.dimension == pytest.approx(2.43, rel=1e-12)
    assert alone.roughness == pytest.approx(1e-11 * np.exp(-0.7), rel=1e-12)
    rows = interface_of(drive_of(mating_dimension=np.array([np.nan, 2.4]), mating_roughness=np.array([np.nan, 1e-11])))
    np.testing.assert_allclose(rows.roughness, 1e-11 * np.array([1.0, 2.0 ** (1 / 0.8)]), rtol=1e-10)


@pytest.mark.parametrize("convention", ["one_direction", "profile"])
def test_the_convention_is_that_of_the_stated_roughness(convention: str) -> None:
    """Isotropic ridges, D_s = 1.5: of one direction 2/pi of the squares are left; the profile divides by ln 1.5."""
    found = interface_of(drive_of(fractal_dimension=2.5, fractal_roughness=1e-9, convention=convention))
    factor = {"one_direction": np.pi / 2.0, "profile": np.pi / 2.0 / np.log(1.5)}[convention]
    assert found.roughness == pytest.approx(1e-9 * factor, rel=1e-10)


# Measured flanks


def measured(dimension: float, roughness: float, ends: tuple[float, float], spacing: float) -> Flank:
    """A flank of 2 by 2 points, 1 um high, that was found to have this profile dimension and roughness."""
    surface = Surface(np.array([[0.0, 1e-6], [0.0, 0.5e-6]]), spacing, spacing, "made by hand")
    nothing = np.empty(0)
    estimate = Estimate(
        direction="x", lags=nothing, values=nothing, local_lags=nothing, local_dimensions=nothing, dimension=dimension,
        roughness=roughness, r_squared=1.0, line_scatter=0.0, noise=0.0, range=ends, reason="",
        resampled=np.empty((0, 2)), spacing=spacing,
    )  # fmt: skip
    return Flank(raw=surface, surface=surface, estimates=(estimate,), chosen="x", reason="", warnings=())


def test_a_measured_flank_replaces_what_is_stated() -> None:
    drive = drive_of(surface=measured(1.5, 1e-9, (1e-6, 12e-6), 0.7e-6))
    both = interface_of(drive)
    assert (both.dimension, both.roughness) == (2.5, 1e-9)
    found = harmonic_fractal(replace(drive, reference_torque=0.1))
    assert found.spacing == 0.7e-6
    assert found.rough_height == 1e-6
    assert found.surface_accepted == 1.0
    assert found.resolved_share == pytest.approx(np.sqrt(5.43e-13 / np.pi) / 0.7e-6, rel=1e-3)


def test_a_refused_flank_leaves_what_is_stated_and_says_so() -> None:
    refused = replace(measured(1.5, 1e-9, (1e-6, 12e-6), 0.7e-6), chosen=None, reason="no self-affine range")
    found = harmonic_fractal(drive_of(surface=refused))
    assert (found.dimension, found.roughness) == (2.4, 1e-11)
    assert (found.surface_accepted, found.rough_height) == (0.0, 1e-6)
    assert found.spacing == pytest.approx(0.4e-6, rel=1e-14)


def test_two_measured_flanks_are_added_over_the_range_that_both_have() -> None:
    drive = drive_of(surface=measured(1.3, 1e-11, (1e-6, 12e-6), 0.7e-6),
                     mating_surface=measured(1.5, 1e-9, (2e-6, 30e-6), 0.5e-6))  # fmt: skip
    assert range_of(drive) == (2e-6, 12e-6)
    assert spacing_of(drive) == 0.7e-6
    lags = np.geomspace(2e-6, 12e-6, 16)
    heights = np.asarray(structure_function(lags, 1.3, 1e-11)) + structure_function(lags, 1.5, 1e-9)
    slope = np.polyfit(np.log(lags), np.log(heights), 1)[0]
    assert interface_of(drive).dimension == pytest.approx(3.0 - slope / 2.0, rel=1e-9)
    apart = replace(drive, mating_surface=measured(1.5, 1e-9, (20e-6, 30e-6), 0.5e-6))
    with np.errstate(all="ignore"), pytest.raises(InfeasibleError, match="measure both flanks alike"):
        harmonic_fractal(apart)


# What must hold


@pytest.mark.parametrize(
    ("changed", "result", "sentence"),
    [
        ({"fractal_dimension": 2.3}, "torsion", "raise reference_torque"),
        ({"reference_torque": 1e-6}, "torsion", "raise reference_torque"),
        ({"catalogue_size": "40", "flexspline_teeth": 60}, "catalogue_torsion", "no size 40 with a ratio below 40"),
    ],
    ids=["rough", "early", "size"],
)
def test_what_does_not_exist_has_its_reason(changed: dict[str, Any], result: str, sentence: str) -> None:
    found = answered(default_setup(HARMONIC_FRACTAL, **changed))
    assert sentence in found.absent[result]
    assert np.isnan(getattr(found.results, result))
    assert np.isfinite([found.results.stiffness, found.results.clearance]).all()


def test_a_smooth_mate_needs_no_range_of_lags() -> None:
    assert np.isfinite(harmonic_fractal(drive_of(longest_lag=0.4e-6)).stiffness)


def test_in_a_batch_the_other_rows_go_on() -> None:
    dimension = np.array([2.4, 2.03, 2.97, 2.3, 2.45, 1.99, 3.02])
    rows = evaluate_rows(default_setup(HARMONIC_FRACTAL), {"fractal_dimension": dimension}, len(dimension))
    np.testing.assert_array_equal(rows.failed, [False, True, True, False, False, True, True])
    assert np.isfinite(rows.results["torsion"][[0, 4]]).all()
    assert "below 2.05" in rows.reasons[1]
    assert "above 2.95" in rows.reasons[2]
    assert "reference_torque" in rows.absent["torsion"][3]
    assert np.isfinite(rows.results["stiffness"][3])


def test_an_all_plastic_pair_is_told_not_refused() -> None:
    found = harmonic_fractal(drive_of(pair_load=1e-5, torque=5e-6))
    assert (found.stiffness, found.mesh_stiffness, found.torsion, found.load_exponent) == (0.0, 0.0, 0.0, 0.0)
    assert found.plastic_share == 1.0
    assert harmonic_fractal(drive_of()).plastic_share < 0.1


def test_a_smooth_mate_beside_rough_ones_has_no_height() -> None:
    """In a batch, too: rows without a mating flank are those of the drive without one."""
    nothing = float("nan")
    columns = {"mating_dimension": np.array([2.4, nothing]), "mating_roughness": np.array([1e-11, nothing])}
    rows = evaluate_rows(default_setup(HARMONIC_FRACTAL), columns, 2)
    rough, smooth = rows.results["mating_rough_height"]
    assert not rows.failed.any()
    assert rough > 0
    assert smooth == 0
