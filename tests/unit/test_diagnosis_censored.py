"""Censored readings and lognormal noise: against the Tobit likelihood maximised by hand, and bad input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import (
    UM,
    Array,
    Asked,
    drive_model,
    ends,
    fit_of,
    gauge,
    names_in,
    offer_of,
    size_of,
    wide,
    write_csv,
)
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import minimize, minimize_scalar
from scipy.stats import norm

from truing.diagnosis.engine import laid_out
from truing.diagnosis.exact import EXACTLY
from truing.diagnosis.learning import learnt
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.noise import difference
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.sample import errors_of, sample_of
from truing.errors import InputError
from truing.setup import DiagnoseOptions

BENCH = wide(60, seed=41)
TRUE = gauge(BENCH.load, BENCH.travel) + 0.4 * (BENCH.temperature - 20) + np.random.default_rng(41).normal(0, 2, 60)
END = 8.0


# Fits


def clipped_record(folder: Path, **asked: Any) -> tuple[Asked, Records]:
    """60 readings of a gauge that ends at END um, of a drive without tolerances that grows with its temperature."""
    one = Asked(drive_model(("thermal_growth",), {}), diagnose=DiagnoseOptions(**asked))
    return one, one.records(folder, BENCH.columns(TRUE))


def tobit(lowest: float) -> tuple[float, float]:
    """Growth (um/K) and noise (um) that are likeliest, by hand."""
    drive, warm, above, below = gauge(BENCH.load, BENCH.travel), BENCH.temperature - 20, TRUE >= END, lowest >= TRUE

    def cost(x: Array) -> float:
        left = (np.clip(TRUE, lowest, END) - drive - x[0] * warm) / np.exp(x[1])
        read = norm.logpdf(left[~above & ~below]) - x[1]
        return -float(read.sum() + norm.logsf(left[above]).sum() + norm.logcdf(left[below]).sum())

    found = minimize(cost, [0.1, 0.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 9999})
    return float(found.x[0]), float(np.exp(found.x[1]))


@pytest.mark.parametrize("lowest", [-np.inf, -END])
def test_a_fit_and_its_noise_are_those_of_the_tobit_likelihood(tmp_path: Path, lowest: float) -> None:
    one, records = clipped_record(tmp_path, clipped={"deflection": (lowest * UM, END * UM)})
    made = laid_out(calibration_of(one.setup, records))
    found = fit_of(made, "thermal_growth")
    for _ in range(20):
        again = learnt(made.sample, found.predicted, 0)
        made.sample = sample_of(made.sample.machine, again, made.sample.mask)
        made.known = {key: each.in_sample(made.sample) for key, each in made.known.items()}
        made.again([made.known[found.key]], EXACTLY)
        found = made.known[found.key]
    growth, sd = tobit(lowest)
    assert_allclose(size_of(found, "growth"), growth * UM, rtol=2e-3)
    assert_allclose(made.sample.noise["deflection"].scale, sd * UM, rtol=2e-3)
    (square,) = made.sample.squares(found.left)
    assert_allclose(square, 1, rtol=1e-3)
    noise, predicted = made.sample.noise["deflection"], found.predicted["deflection"]
    errors = errors_of(made.sample.machine, "deflection", noise, predicted)
    assert_allclose(np.sqrt(np.mean(errors**2)), sd * UM, rtol=2e-3)  # the noise floor is the noise


def test_a_diagnosis_of_a_clipped_gauge_names_the_cause_with_its_size(tmp_path: Path) -> None:
    bench = wide(90, seed=43)
    true = gauge(bench.load, bench.travel) + 0.4 * (bench.temperature - 20)
    true += np.random.default_rng(43).normal(0, 1, 90)
    options = DiagnoseOptions(clipped={"deflection": (-10 * UM, 10 * UM)})
    one = Asked(drive_model(["thermal_growth"], {"contact": "3 %"}), diagnose=options)
    found = one.diagnosed(tmp_path, bench.columns(np.clip(true, -10, 10)))
    (cause,) = found.causes
    assert names_in(found) == {"thermal_growth", "thermal_drift"}  # of the gauge: one curve
    (unknown,) = cause.unknowns
    low, high = ends(unknown)
    assert low < 0.4 * UM < high
    (wrong,) = found.wrong
    assert wrong.noise_floor.value == pytest.approx(1 * UM, rel=0.2)
    cut = int((np.abs(true) >= 10).sum())
    words = f"{cut} of 90 readings of 'deflection' are censored: the true value lies beyond what was read"
    assert words in found.records.notes


# Rows


@pytest.mark.parametrize("lowest", [-np.inf, -END])
def test_a_censored_row_cuts_the_memory_of_the_noise_and_lies_at_the_end(tmp_path: Path, lowest: float) -> None:
    one, records = clipped_record(tmp_path, clipped={"deflection": (lowest * UM, END * UM)})
    (channel,) = laid_out(calibration_of(one.setup, records)).sample.channels
    sides = np.where(TRUE >= END, 1, np.where(lowest >= TRUE, -1, 0))
    assert_array_equal(records.sides["deflection"], sides)
    assert_array_equal(channel.starts, (sides != 0) | np.append(True, sides[:-1] != 0))
    assert records.readings == 60 - np.count_nonzero(sides)
    assert_allclose(records.measured["deflection"], np.clip(TRUE, lowest, END) * UM)


FLAGS: dict[str, tuple[str, Callable[[bool], str]]] = {
    "words": ("outcome = runout", lambda cut: "runout" if cut else "failed"),
    "numbers": ("outcome = 1", lambda cut: str(int(cut))),
}


def flagged(folder: Path, word: Callable[[bool], str], **asked: Any) -> Records:
    """The clipped record with a column that marks its readings at the end."""
    one = Asked(drive_model(), diagnose=DiagnoseOptions(**asked))
    file = write_csv(folder / "measured.csv", BENCH.columns(np.minimum(TRUE, END)))
    head, *rows = file.read_text(encoding="utf-8").splitlines()
    marked = [f"{row},{word(bool(cut))}" for row, cut in zip(rows, TRUE >= END, strict=True)]
    file.write_text("\n".join([head + ",outcome", *marked]) + "\n", encoding="utf-8")
    return read_records([file], offer_of(one.model), one.setup)


@pytest.mark.parametrize("kind", FLAGS)
@pytest.mark.parametrize(("option", "side"), [("at_least", 1), ("at_most", -1)])
def test_a_column_marks_censored_rows_and_nothing_depends_on_it(
    kind: str, option: str, side: int, tmp_path: Path
) -> None:
    text, word = FLAGS[kind]
    records = flagged(tmp_path, word, **{option: {"deflection": text}})
    assert_array_equal(records.sides["deflection"], side * (TRUE >= END))
    assert "outcome" not in records.covariates
    assert not any("outcome" in note for note in records.notes)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("outcom = runout", "at_least: no file has a column 'outcom'. Did you mean 'outcome'?"),
        ("outcome = run-out", "at_least: no row has 'run-out' in the column 'outcome'"),
        ("load = runout", "at_least: no row has 'runout' in the column 'load'"),
    ],
)
def test_a_mark_that_marks_nothing_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        flagged(tmp_path, FLAGS["words"][1], at_least={"deflection": text})
    assert [fault.message for fault in caught.value.faults] == [sentence]


def test_a_sign_in_a_cell_is_refused_with_what_to_write(tmp_path: Path) -> None:
    file = write_csv(tmp_path / "measured.csv", BENCH.columns(TRUE))
    head, first, *rows = file.read_text(encoding="utf-8").splitlines()
    cells = first.split(",")
    cells[-1] = ">" + cells[-1]
    file.write_text("\n".join([head, ",".join(cells), *rows]) + "\n", encoding="utf-8")
    one = Asked(drive_model())
    with pytest.raises(InputError, match=r"is no number; write the number, and mark the row in a column of its own"):
        read_records([file], offer_of(one.model), one.setup)


def test_readings_that_are_all_censored_explain_nothing(tmp_path: Path) -> None:
    one = Asked(drive_model(), diagnose=DiagnoseOptions(clipped={"deflection": (-np.inf, -1.0)}))
    with pytest.raises(InputError, match=r"no row can be used; .* 60 of 60 readings of 'deflection' are censored"):
        one.records(tmp_path, BENCH.columns(TRUE))


# Logarithms


def test_a_difference_of_logarithms_is_that_of_a_typical_reading() -> None:
    values, predicted = np.array([1.0, 2.0, 8.0]), np.array([1.001, 1.9, 4.0])
    off = difference(values, predicted, 2.0)
    assert_allclose(off, 2 * np.log(values / predicted))
    assert off[0] == pytest.approx(2 * (1 - 1.001), rel=1e-3)
    assert_allclose(difference(values, predicted, 0.0), values - predicted)
    assert not np.isfinite(difference(values, np.array([0.0, -1.0, np.nan]), 2.0)).any()


def factors(folder: Path, *options: str, bench_seed: int = 44) -> tuple[Asked, Records, Array, Array]:
    """A drive that is pulled only, read with errors of 10 %, its load 20 % larger than was read."""
    bench = wide(80, seed=bench_seed)
    bench = replace(bench, load=np.abs(bench.load) + 0.2)
    noise = np.random.default_rng(bench_seed).normal(0, 0.1, 80)
    read = gauge(1.2 * bench.load, bench.travel) * np.exp(noise)
    one = Asked(drive_model(("stiffness_loss",), {}), diagnose=DiagnoseOptions(lognormal=options))
    return one, one.records(folder, bench.columns(read)), np.asarray(bench.load), np.log(read)


def test_lognormal_noise_is_fitted_as_logarithms_by_hand(tmp_path: Path) -> None:
    one, records, load, logs = factors(tmp_path, "deflection")
    made = laid_out(calibration_of(one.setup, records))
    found = fit_of(made, "stiffness_loss")
    travel = records.covariates["travel"].values * 1e3

    def squares(loss: float) -> float:
        return float(np.sum((logs - np.log(gauge((1 + loss) * load, travel))) ** 2))

    by_hand = minimize_scalar(squares, bounds=(-0.4, 0.4), method="bounded", options={"xatol": 1e-10})
    assert size_of(found, "loss") == pytest.approx(by_hand.x, rel=1e-4)
    scale = learnt(made.sample, found.predicted, 1)["deflection"].scale
    typical = np.exp(logs.mean()) * UM
    assert scale / typical == pytest.approx(np.sqrt(by_hand.fun / 79), rel=1e-6)


def test_a_reading_without_a_logarithm_is_refused(tmp_path: Path) -> None:
    one = Asked(drive_model(), diagnose=DiagnoseOptions(lognormal=("deflection",)))
    with pytest.raises(InputError) as caught:
        one.records(tmp_path, BENCH.columns(TRUE))
    below = np.flatnonzero(TRUE <= 0)
    assert [fault.line for fault in caught.value.faults] == (below + 2).tolist()
    assert "deflection is not above 0, so it has no logarithm" in caught.value.faults[0].message


def test_rows_that_the_model_puts_below_zero_are_not_used(tmp_path: Path) -> None:
    one = Asked(drive_model(), diagnose=DiagnoseOptions(lognormal=("deflection",)))
    records = one.records(tmp_path, BENCH.columns(np.abs(TRUE)))
    below = gauge(BENCH.load, BENCH.travel) <= 0
    words = f"'deflection' is not used in {below.sum()} rows in which the model says 0 or less"
    assert words in " ".join(records.notes)
