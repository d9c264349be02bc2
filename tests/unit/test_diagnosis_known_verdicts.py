"""Known answers of whole diagnoses: records of a screw drive in which the error is known, read from files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    HEADER,
    UM,
    Array,
    Asked,
    Bench,
    assert_sized,
    drive_model,
    ends,
    fit_of,
    name_sets,
    wide,
)
from numpy.testing import assert_allclose
from scipy.optimize import least_squares
from scipy.stats import t

from truing.diagnosis.engine import laid_out
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.noise import SMALLEST_SHARE
from truing.diagnosis.result import DiagnosisResult
from truing.setup import DiagnoseOptions

PROPER = Asked(drive_model())
WARM_AND_WORN = replace(wide(90, seed=15), travel=np.full(90, 100.0))
GROWTH, WORN = 0.2 * (WARM_AND_WORN.temperature - 20), 0.3 * WARM_AND_WORN.time * np.sign(WARM_AND_WORN.load)


def test_a_linear_effect_is_named_and_sized_without_any_noise(tmp_path: Path) -> None:
    bench = wide(150, seed=3)
    found = Asked(drive_model(["lead_error", "wear"])).diagnosed(tmp_path, bench.shown(0.05 * bench.travel))
    assert (found.verdict, name_sets(found), found.unique) == ("named", [{"lead_error"}], True)
    (size,) = found.causes[0].unknowns
    true = 0.05e-3
    assert_allclose(size.value, true, rtol=1e-8)
    low, high = ends(size)
    rounding = 1e-12 * true
    assert low - rounding <= true <= high + rounding
    assert high - low < 8 * SMALLEST_SHARE * true / np.sqrt(len(bench))


def assert_same(one: DiagnosisResult, other: DiagnosisResult) -> None:
    """The same verdict with the same probabilities and, in SI, the same sizes."""
    assert (one.verdict, one.unique, name_sets(one)) == (other.verdict, other.unique, name_sets(other))
    assert (one.p_any, one.p_second) == (other.p_any, other.p_second)
    assert [rival.causes for rival in one.alternatives] == [rival.causes for rival in other.alternatives]
    for cause, same in zip(one.causes, other.causes, strict=True):
        for unknown, twin in zip(cause.unknowns, same.unknowns, strict=True):
            assert unknown.name == twin.name
            assert_allclose([twin.value, twin.low, twin.high], [unknown.value, unknown.low, unknown.high], rtol=1e-5)
    assert_allclose([gain.p_value for gain in other.gain], [gain.p_value for gain in one.gain])


TWO = Asked(drive_model(["thermal_growth", "wear"], {}))
SCALED = {"load": ("N", 1e3), "travel": ("m", 1e-3), "time": ("s", 3600.0), "deflection": ("m", 1e-6)}


def test_units_and_the_order_of_the_rows_inside_a_run_change_nothing_and_the_larger_cause_comes_first(
    tmp_path: Path,
) -> None:
    columns = WARM_AND_WORN.shown(GROWTH + WORN + np.random.default_rng(15).normal(0, 1, 90))
    labels = [f"run {row // 30}" for row in range(90)]
    plain = TWO.diagnosed(tmp_path, columns, labels)
    assert [cause.effect for cause in plain.causes] == ["thermal_drift", "wear"]  # found the other way round
    squares = np.array([GROWTH @ GROWTH, WORN @ WORN])
    assert [cause.share for cause in plain.causes] == pytest.approx(squares / squares.sum(), abs=0.04)
    order = np.concatenate([np.random.default_rng(16).permutation(30) + begin for begin in (0, 30, 60)])
    scaled = {name: values[order] * SCALED.get(name, ("", 1.0))[1] for name, values in columns.items()}
    units = {**HEADER, **{name: unit for name, (unit, _) in SCALED.items()}}
    again = replace(TWO, units=units).diagnosed(tmp_path, scaled, [labels[row] for row in order])
    assert_same(plain, again)
    assert any("out of order" in note for note in again.records.notes)


def test_order_seven_is_unknown_and_said_to_be_order_seven(tmp_path: Path) -> None:
    bench = wide(100, seed=19, turning=True)
    wave = 2 * np.sin(np.radians(7 * bench.rotation + 40))
    noise = np.random.default_rng(19).normal(0, 1, len(bench))
    found = Asked(drive_model(["lead_error"])).diagnosed(tmp_path, bench.shown(wave + noise))
    assert found.verdict == "unknown"
    assert not found.causes
    assert found.remainder is not None
    assert found.remainder.depends_on == ("rotation",)
    assert "order 7 of rotation" in found.remainder.shape
    (terms,) = found.remainder.terms.values()
    at = {name: columns for name, columns in bench.columns(wave).items() if name == "rotation"}
    made = sum(
        term.coefficient * eval(term.expression, {"np": np, "rotation": np.radians(at["rotation"])}) for term in terms
    )
    assert_allclose(np.sqrt(np.mean((made / UM - wave) ** 2)), 0, atol=0.3)


# What keeps a diagnosis from inventing causes: shapes between their points, doubtful second causes, calibration.

BENCH = wide(150, seed=31)


def read(error: Array | float = 0.0, bench: Bench = BENCH) -> dict[str, Array]:
    """A record of BENCH with noise of 1 um and an error (um)."""
    return bench.shown(error + noise())


def noise() -> Array:
    return np.random.default_rng(31).normal(0, 1, len(BENCH))


# Shapes between the points at which curves are asked for


def test_a_large_effect_between_two_points_of_its_curves_is_named_alone(tmp_path: Path) -> None:
    rise, time_constant = 500.0, 0.23
    error = rise * (1 - np.exp(-BENCH.time / time_constant))
    found = Asked(drive_model(["warm_up", "wear"], {})).diagnosed(tmp_path, read(error))
    assert name_sets(found) == [{"warm_up"}]
    for unknown, true in zip(found.causes[0].unknowns, (rise * UM, time_constant * 3600), strict=True):
        low, high = ends(unknown)
        assert low <= true <= high
    assert found.wrong[0].noise.autocorrelation == 0
    assert_allclose(found.wrong[0].noise_floor.value / UM, 1, atol=4 / np.sqrt(2 * 150))


@pytest.mark.parametrize("time_constant", [0.14, 1.7, 6.2, 12.0])
def test_a_shape_is_fitted_wherever_it_lies(tmp_path: Path, time_constant: float) -> None:
    """By the least squares of scipy, from the truth."""
    one = Asked(drive_model(["warm_up"], {}))
    error = 100 * (1 - np.exp(-BENCH.time / time_constant))
    made = one.competing(tmp_path, read(error))

    def left(values: Array) -> Array:
        return np.asarray(values[0] * (1 - np.exp(-BENCH.time / np.exp(values[1]))) - error - noise())

    best = least_squares(left, [100, np.log(time_constant)], xtol=1e-14, ftol=1e-14, gtol=1e-14)
    rise, hours = fit_of(made, "warm_up").values[0] / [UM, 3600]
    assert_allclose([rise, hours], [best.x[0], np.exp(best.x[1])], rtol=1e-4)
    starts = np.geomspace(0.1, 20, 9)
    assert np.abs(starts / hours - 1).min() > 0.05  # no curve that was asked for is as near


# A second cause that may be zero


def test_a_second_cause_whose_interval_contains_zero_is_not_named(tmp_path: Path) -> None:
    """Growth per K with 1 um of noise over 150 rows and 15..45 degC: a standard error of about 0.005 um/K."""
    error = 0.05 * BENCH.travel
    design = np.column_stack([BENCH.travel, BENCH.temperature - 20])
    size = np.linalg.lstsq(design, error + noise())[0][1]
    assert abs(size) < t.ppf(0.975, 148) * np.sqrt(np.linalg.inv(design.T @ design)[1, 1])  # with noise of 1 um
    found = Asked(drive_model(["lead_error", "thermal_growth"], {})).diagnosed(tmp_path, read(error))
    assert name_sets(found) == [{"lead_error"}]
    low, high = ends(found.causes[0].unknowns[0])
    assert low < 0.05e-3 < high


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


# Only some causes compete, as [studies.diagnose] causes says: a suspicion is tried, or others are switched off.


def asked_only(tmp_path: Path, *causes: str) -> DiagnosisResult:
    """The diagnosis of a lead error of 0.05 um/mm under a scatter of 0.2 um, where only these causes compete."""
    bench = wide(90, seed=5)
    error = 0.05 * bench.travel + np.random.default_rng(5).normal(0, 0.2, len(bench))
    asked = Asked(drive_model(), diagnose=DiagnoseOptions(causes=causes))
    return asked.diagnosed(tmp_path, bench.shown(error))


def test_a_right_suspicion_is_sized_and_in_doubt_because_nothing_else_was_compared(tmp_path: Path) -> None:
    found = asked_only(tmp_path, "lead_error")
    assert [rival.causes for rival in found.ranking] == [("lead_error",), ()]
    assert_sized(found.causes[0].unknowns[0], 0.05e-3, within=0.2)
    assert (found.verdict, name_sets(found)) == ("undecided", [{"lead_error"}])
    assert any(text.startswith("only lead_error competed") for text in found.warnings)
    assert found.gain[0].rmse_after.value < 0.1 * found.gain[0].rmse_before.value


def test_a_wrong_suspicion_is_worth_nothing(tmp_path: Path) -> None:
    found = asked_only(tmp_path, "thermal_growth")
    assert (found.verdict, found.causes) == ("undecided", ())
    assert {rival.causes for rival in found.ranking} == {("thermal_growth",), ()}


def test_a_curve_that_nobody_registered_shows_that_the_right_cause_was_switched_off(tmp_path: Path) -> None:
    found = asked_only(tmp_path, "thermal_growth", "input:shaft", "unknown")
    assert (found.verdict, found.remainder is not None) == ("unknown", True)
    assert any(text.startswith("only thermal_growth, input:shaft, unknown competed") for text in found.records.notes)
    assert not any(text.startswith("only ") for text in found.warnings)
