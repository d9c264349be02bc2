"""What keeps a diagnosis from inventing causes: shapes between their points, doubtful second causes, calibration."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    UM,
    Array,
    Asked,
    Bench,
    drive_model,
    ends,
    fit_of,
    gauge,
    name_sets,
    plain_competition,
    wide,
)
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import t

from truing.diagnosis.engine import laid_out
from truing.diagnosis.machine import calibration_of

BENCH = wide(150, seed=31)
PROPER = Asked(drive_model())


def read(error: Array | float = 0.0, bench: Bench = BENCH) -> dict[str, Array]:
    """A record of BENCH with noise of 1 um and an error (um)."""
    return bench.columns(gauge(bench.load, bench.travel) + error + noise())


def noise() -> Array:
    return np.random.default_rng(31).normal(0, 1, len(BENCH))


# Shapes between the points at which curves are asked for


@pytest.mark.parametrize(("time_constant", "rise"), [(0.14, 100.0), (0.23, 500.0), (12.0, 100.0)])
def test_a_large_effect_between_two_points_of_its_curves_is_named_alone(
    tmp_path: Path, time_constant: float, rise: float
) -> None:
    found = PROPER.diagnosed(tmp_path, read(rise * (1 - np.exp(-BENCH.time / time_constant))))
    assert name_sets(found) == [{"warm_up"}]
    size, hours = found.causes[0].unknowns
    for unknown, true in ((size, rise * UM), (hours, time_constant * 3600)):
        low, high = ends(unknown)
        assert low <= true <= high
    assert found.wrong[0].noise.autocorrelation == 0
    assert_allclose(found.wrong[0].noise_floor.value / UM, 1, atol=4 / np.sqrt(2 * 150))


@pytest.mark.parametrize("time_constant", [0.14, 1.7, 6.2, 12.0])
def test_a_shape_is_fitted_wherever_it_lies(tmp_path: Path, time_constant: float) -> None:
    """By the least squares of scipy, from the truth."""
    one = Asked(drive_model(["warm_up"], {}))
    error = 100 * (1 - np.exp(-BENCH.time / time_constant))
    made = plain_competition(one, one.records(tmp_path, read(error)), UM)

    def left(values: Array) -> Array:
        return np.asarray(values[0] * (1 - np.exp(-BENCH.time / np.exp(values[1]))) - error - noise())

    best = least_squares(left, [100, np.log(time_constant)], xtol=1e-14, ftol=1e-14, gtol=1e-14)
    rise, hours = fit_of(made, "warm_up").values[0] / [UM, 3600]
    assert_allclose([rise, hours], [best.x[0], np.exp(best.x[1])], rtol=1e-4)
    starts = np.geomspace(0.1, 20, 9)
    assert np.abs(starts / hours - 1).min() > 0.05  # no curve that was asked for is as near


# A second cause that may be zero


@pytest.mark.parametrize(("growth", "stays"), [(0.0, False), (0.3, True)])
def test_a_second_cause_whose_interval_contains_zero_is_not_named(tmp_path: Path, growth: float, stays: bool) -> None:
    """Growth per K with 1 um of noise over 150 rows and 15..45 degC: a standard error of about 0.005 um/K."""
    error = 0.05 * BENCH.travel + growth * (BENCH.temperature - 20)
    one = Asked(drive_model(tolerances={}))
    design = np.column_stack([BENCH.travel, BENCH.temperature - 20])
    size = np.linalg.lstsq(design, error + noise())[0][1]
    by_hand = t.ppf(0.975, 148) * np.sqrt(np.linalg.inv(design.T @ design)[1, 1])  # with noise of 1 um
    assert (abs(size) > by_hand) == stays
    found = one.diagnosed(tmp_path, read(error))
    second = [{"thermal_drift", "thermal_growth"}] if stays else []
    assert name_sets(found) == [{"lead_error"}, *second]
    for cause, value in zip(found.causes, (0.05e-3, growth * UM), strict=False):
        (unknown,) = cause.unknowns
        low, high = ends(unknown)
        assert low < value < high


# The machine as it is


def test_a_gauge_that_is_off_by_millimetres_does_not_drive_inputs_out_of_their_tolerances(tmp_path: Path) -> None:
    """A load of one sign makes an offset look like a soft contact: by least squares one off by dozens."""
    records = PROPER.records(tmp_path, read(5000, replace(BENCH, load=np.abs(BENCH.load) + 1)))
    made = laid_out(calibration_of(PROPER.setup, records))
    machine = made.extended.machine
    off = records.measured["deflection"] - machine.base["deflection"]
    freely = np.linalg.lstsq(machine.slopes["deflection"], off)[0]
    assert np.abs(freely).max() > 20
    assert np.abs(made.null.moved).max() < 1
    moved = made.null.predicted["deflection"] - machine.base["deflection"]
    assert np.abs(moved).max() / UM < 2  # one deviation of both inputs at 20 kN
