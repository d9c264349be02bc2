"""The rows as a fit sees them: their noise, its memory and tails, how many count, and what the inputs draw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, log
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, drive_model, gauge, wander, white_noise, wide
from numpy.testing import assert_allclose
from scipy.linalg import block_diag, solve_triangular, toeplitz
from scipy.optimize import approx_fprime, minimize_scalar
from scipy.stats import multivariate_normal, norm, t

from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import Conditional
from truing.diagnosis.curves import ResponseCurves
from truing.diagnosis.exact import nothing
from truing.diagnosis.extended import Extended
from truing.diagnosis.learning import FEWEST_OF_MEMORY, learnt, memory_cost, memory_of
from truing.diagnosis.machine import Calibration, calibration_of, directions_of
from truing.diagnosis.noise import SETTINGS, Autocorrelation, Tails, robust_sd
from truing.diagnosis.sample import NoiseModel, Sample, has_order, resolution_of, sample_of, starts_of

TOLERANCES = {"contact": "3 %", "shaft": "3 %"}
BENCH = wide(150, seed=31)
AR = Autocorrelation(0.6)


def machine(
    folder: Path, error: Array, runs: Sequence[str] = (), *, tolerances: Mapping[str, str] = TOLERANCES
) -> Calibration:
    """A record of BENCH with an error in um."""
    one = Asked(drive_model((), tolerances))
    columns = BENCH.columns(gauge(BENCH.load, BENCH.travel) + error)
    return calibration_of(one.setup, one.records(folder, columns, runs))


def noise(seed: int = 31) -> Array:
    return np.random.default_rng(seed).normal(0, 1, 150)


def sample(there: Calibration, *, scale: float = UM, **known: object) -> Sample:
    """All rows, in noise of a known standard deviation and what else is known of it."""
    own = {name: replace(each, **known) for name, each in white_noise(there, scale).items()}  # type: ignore[arg-type]
    return sample_of(there, own, ~there.records.held_out)


def inverse_root(rho: float, lengths: Sequence[int]) -> Array:
    """What makes an autoregression of unit innovations independent, from its covariance run by run."""
    dense = block_diag(*(toeplitz(rho ** np.arange(float(n))) / (1 - rho**2) for n in lengths))
    return np.asarray(solve_triangular(np.linalg.cholesky(dense), np.eye(sum(lengths)), lower=True))


# Rows


def test_a_run_starts_anew_where_its_first_row_is_missing() -> None:
    assert starts_of(np.array([0, 0, 0, 1, 1, 2]), np.array([1, 2, 4, 5])).tolist() == [True, False, True, True]


def test_a_gap_starts_the_noise_anew(tmp_path: Path) -> None:
    there = machine(tmp_path, noise(), ["a"] * 60 + ["b"] * 90)
    (whole,) = sample(there).channels
    assert np.flatnonzero(whole.starts).tolist() == [0, 60]
    kept = ~np.isin(np.arange(150), [20, 21, 60])
    (part,) = sample(there).of_rows(kept).channels
    assert part.rows[part.starts].tolist() == [0, 22, 61]


def test_what_is_left_is_measured_minus_predicted_in_units_of_the_noise(tmp_path: Path) -> None:
    there = machine(tmp_path, noise())
    weights = np.linspace(0.5, 2, 150)
    made = sample(there, scale=0.4 * UM, weights=weights)
    assert_allclose(made.left(there.base), noise() * weights / 0.4, atol=1e-6)
    contact = 0.09 * np.sign(BENCH.load) * np.cbrt(BENCH.load) ** 2
    shaft = 0.015 * BENCH.load * BENCH.travel / 150
    slopes = np.column_stack([contact, shaft]) * (weights / 0.4)[:, None]
    assert_allclose(made.drawn @ made.drawn.T, slopes @ slopes.T, rtol=1e-6, atol=1e-6)  # whatever the directions
    assert_allclose(made.curve({"deflection": np.full(150, UM)}), weights / 0.4)


def test_the_cost_in_heavy_tails_is_the_likelihood_of_students_t_profiled_over_its_scale(tmp_path: Path) -> None:
    """Also where one reading lies far out; what makes squares count is the slope of that likelihood."""
    made = sample(machine(tmp_path, noise()), tails=Tails(4.0, 2.1))
    lefts = [noise(1), np.where(np.arange(150) == 7, 40.0, 2 * noise(2))]
    exact = [
        minimize_scalar(lambda log_scale, left=left: -2 * t(4, scale=np.exp(log_scale)).logpdf(left).sum(), (0, 1)).fun
        for left in lefts
    ]
    still = np.zeros(2)
    assert_allclose(made.cost(lefts[1], still) - made.cost(lefts[0], still), exact[1] - exact[0], rtol=1e-7)
    slopes = approx_fprime(lefts[1], lambda left: made.cost(left, still), 1e-6)
    assert_allclose(2 * made.roots(lefts[1]) ** 2 * lefts[1], slopes, rtol=1e-4, atol=1e-4)
    assert_allclose(
        np.diff([made.losses(left, lefts[0]).sum() for left in lefts]),
        np.diff([-2 * t(4, scale=made.squares(lefts[0])[0] ** 0.5).logpdf(left).sum() for left in lefts]),
        rtol=1e-9,
    )


@pytest.mark.parametrize("rho", [0.0, 0.6, 0.92])
def test_a_slow_curve_counts_for_the_few_independent_rows_that_it_has_and_a_jump_for_all(
    tmp_path: Path, rho: float
) -> None:
    """Information of an offset: 1' C^-1 1 = 1 - rho^2 + (n - 1)(1 - rho)^2; of what alternates (1 + rho)^2 a row.

    C is the covariance of an autoregression with unit innovations. All rows are counted, whatever their memory.
    """
    made = sample(machine(tmp_path, noise()), memory=Autocorrelation(rho))
    assert made.rows == 150
    slow, fast = (made.curve({"deflection": each * UM}) for each in (np.ones(150), (-1.0) ** np.arange(150)))
    assert_allclose(slow @ slow, 1 - rho**2 + 149 * (1 - rho) ** 2, rtol=1e-9)
    assert_allclose(fast @ fast, 1 - rho**2 + 149 * (1 + rho) ** 2, rtol=1e-9)


def test_the_cost_is_the_likelihood_profiled_over_the_noise_and_the_prior_of_the_inputs(tmp_path: Path) -> None:
    made = sample(machine(tmp_path, noise()))
    u = np.array([0.7, -1.2])
    lefts = [noise(1), 2 * noise(2) + 0.3]
    exact = [-2 * norm.logpdf(left, scale=np.sqrt(np.mean(left**2))).sum() + u @ u for left in lefts]
    ours = [made.cost(left, u) for left in lefts]
    assert_allclose(ours[1] - ours[0], exact[1] - exact[0], rtol=1e-9)
    assert_allclose(ours[0] - made.cost(lefts[0], 0 * u), u @ u, rtol=1e-9)
    weighted = made.roots(lefts[1]) * lefts[1]
    assert_allclose(weighted @ weighted, 150, rtol=1e-12)


def test_with_the_memory_taken_out_rows_are_independent(tmp_path: Path) -> None:
    there = machine(tmp_path, noise(), ["a"] * 60 + ["b"] * 90)
    made = sample(there, memory=AR)
    root = inverse_root(0.6, [60, 90])
    plain = sample(there)
    assert_allclose(made.left(there.base), root @ noise(), atol=1e-6)
    drawn = root @ plain.drawn
    assert_allclose(made.drawn @ made.drawn.T, drawn @ drawn.T, rtol=1e-9, atol=1e-9)
    added = {"deflection": BENCH.travel * UM}
    assert_allclose(made.curve(added), root @ BENCH.travel, rtol=1e-9, atol=1e-9)
    beside = Conditional(made, np.ones(150), np.zeros(150), np.zeros((150, 0)), there.base)
    assert_allclose(beside.drawn(np.array([[BENCH.travel], [BENCH.load]]) * UM)[1, 0], root @ BENCH.load, rtol=1e-9)
    assert made.rows == 150
    assert max(setting.rho for setting in SETTINGS) < 0.95  # or differences alone would be left


@pytest.mark.parametrize(
    ("values", "step"),
    [
        (np.repeat([0.0, 0.25, 1.0, 2.5], 5), 0.25),
        (np.repeat([0.0, 0.25, 0.9, 2.5], 5), 0.0),
        (np.arange(20.0), 0.0),
        (np.repeat([1.0, 3.0], 9), 0.0),
    ],
    ids=["multiples", "no multiples", "all differ", "two values"],
)
def test_the_step_of_a_gauge_is_what_all_readings_are_multiples_of(values: Array, step: float) -> None:
    assert resolution_of(values) == step


@pytest.mark.parametrize("step", [0.1, 0.25, 3.0])
def test_the_step_of_a_gauge_is_found_in_what_it_shows(step: float) -> None:
    """Noise of two steps, rounded; where one reading in three was rescaled all are multiples of nothing."""
    shown = np.round(2 * np.random.default_rng(4).normal(size=400)) * step
    assert_allclose(resolution_of(shown), step, rtol=1e-9)
    assert_allclose(resolution_of(shown + 17.3), step, rtol=1e-9)
    assert resolution_of(np.where(np.arange(400) % 3, shown, shown * 1.0371)) == 0


def test_noise_is_no_smaller_than_the_rounding_of_the_gauge(tmp_path: Path) -> None:
    """Even rounding to a step s has the variance s^2 / 12."""
    total = gauge(BENCH.load, BENCH.travel)
    rounded = machine(tmp_path, np.round(total / 5) * 5 - total)
    (channel,) = sample(rounded).channels
    assert_allclose(channel.least, 25 / 12, rtol=1e-6)
    made = sample(rounded)
    assert_allclose(made.squares(np.full(150, 1e-3)), [25 / 12], rtol=1e-6)


def test_a_stated_standard_deviation_is_a_weight(tmp_path: Path) -> None:
    there = machine(tmp_path, noise())
    stated = np.where(np.arange(150) < 50, 2.0, 1.0) * UM
    records = replace(there.records, sigma={"deflection": stated})
    weights = sample(replace(there, records=records)).noise["deflection"].given
    assert_allclose(weights, np.where(np.arange(150) < 50, 0.5, 1.0))


# Directions


def test_collinear_inputs_are_few_directions_with_the_same_prior() -> None:
    rng = np.random.default_rng(11)
    curves = rng.normal(size=(200, 2))
    slopes = curves @ np.array([[1.0, 2.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]) + 1e-4 * rng.normal(size=(200, 4))
    gram = slopes.T @ slopes
    found = directions_of(gram, 200)
    assert found.shape == (4, 2)
    assert_allclose(found.T @ found, np.eye(2), atol=1e-12)
    assert_allclose(slopes @ found @ found.T @ slopes.T, slopes @ slopes.T, atol=0.02)
    assert directions_of(np.zeros((0, 0)), 5).shape == (0, 0)
    assert directions_of(1e-6 * gram, 200).shape == (4, 0)  # a thousandth of the noise moves nothing


def test_directions_that_come_into_sight_are_taken_where_they_are(tmp_path: Path) -> None:
    """Of coarse noise no input is seen, of fine noise both are."""
    there = machine(tmp_path, noise())
    coarse, fine = sample(there, scale=1e5 * UM), sample(there)
    assert (coarse.directions.shape, fine.directions.shape) == ((2, 0), (2, 2))
    blind = nothing(coarse, Extended(there))
    seen = blind.in_sample(fine)
    assert_allclose(seen.inputs, [0, 0])
    assert seen.left.shape == (150,)
    assert_allclose(nothing(fine, Extended(there)).in_sample(coarse).moved, [0, 0])


# Noise


@pytest.mark.parametrize("setting", [Autocorrelation(), Autocorrelation(0.6), Autocorrelation(0.95)], ids=str)
def test_the_cost_of_a_memory_is_its_likelihood_and_its_parameters(setting: Autocorrelation) -> None:
    """Dense: -2 log likelihood with the covariance of each run, profiled over the size, log rows for each parameter."""
    left = wander(np.random.default_rng(8), 60, 0.5)
    starts = np.isin(np.arange(60), [0, 25])
    rho = setting.rho
    dense = block_diag(*(toeplitz(rho ** np.arange(float(n))) / (1 - rho**2) for n in (25, 35)))
    size = np.sqrt(left @ np.linalg.solve(dense, left) / 60)
    exact = -2 * multivariate_normal(cov=dense * size**2).logpdf(left) - 60 * (1 + log(2 * np.pi))
    assert_allclose(memory_cost(left, starts, setting), exact + (rho > 0) * log(60), rtol=1e-9)


def test_a_memory_is_found_where_there_is_one_and_enough_rows() -> None:
    starts = np.arange(400) == 0
    rng = np.random.default_rng(9)
    assert memory_of(wander(rng, 400, 0.6), starts) in {Autocorrelation(0.6), Autocorrelation(0.45)}
    assert memory_of(rng.normal(size=400), starts) == Autocorrelation()
    few = FEWEST_OF_MEMORY - 1
    assert memory_of(np.linspace(0, 1, few), starts[:few]) == Autocorrelation()
    assert memory_of(np.linspace(0, 1, few + 1), starts[: few + 1]) != Autocorrelation()


def own_score(there: Calibration) -> float:
    """How unlikely the model as it is is, where what it leaves has the memory that suits it best."""
    extended = Extended(there)
    made = Competition(extended, (), sample(there), ResponseCurves(extended))
    made.keep(nothing(made.sample, extended))
    return made.own_score(made.null)


def test_noise_of_its_own_memory_is_only_for_rows_with_an_order(tmp_path: Path) -> None:
    left = wander(np.random.default_rng(10), 150, 0.87)
    there = machine(tmp_path, left, tolerances={})
    assert has_order(there)
    timeless = {name: item for name, item in there.records.covariates.items() if item.role != "time"}
    unordered = replace(there, records=replace(there.records, covariates=timeless))
    assert not has_order(unordered)
    assert own_score(there) < own_score(unordered) - 100  # the logarithm of 1 - 0.87^2 is worth 211, its number 10


def learn(there: Calibration, used: float = 0.0) -> NoiseModel:
    return learnt(sample(there), there.base, used)["deflection"]


def test_the_scale_that_is_learnt_is_that_of_what_is_left_free_numbers_counted(tmp_path: Path) -> None:
    found = learn(machine(tmp_path, noise()), used=10)
    assert_allclose(found.scale / UM, np.sqrt(noise() @ noise() / 140), rtol=1e-6)
    assert (found.memory, found.tails.freedom) == (Autocorrelation(), inf)
    assert_allclose(found.weights, 1)


def test_for_the_scale_a_reading_that_lies_too_far_out_counts_as_where_the_tails_end(tmp_path: Path) -> None:
    error = noise()
    error[70] += 40
    found = learn(machine(tmp_path, error))
    limit = found.tails.limit * robust_sd(error)
    assert_allclose(found.scale / UM, np.sqrt(np.mean(np.clip(error, -limit, limit) ** 2)), rtol=1e-6)


def test_a_spread_that_is_learnt_is_undone_by_weights(tmp_path: Path) -> None:
    """The noise is four times as large at the largest loads as at none: exp(slope z) with z the standardised driver."""
    size = np.exp(0.7 * (np.abs(BENCH.load) - np.abs(BENCH.load).mean()) / np.abs(BENCH.load).std())
    found = learn(machine(tmp_path, noise() * size))
    assert found.spread.driver == "size of load"
    assert_allclose(found.weights, size ** (-found.spread.slope / 0.7), rtol=1e-6)
    assert_allclose(found.spread.slope, 0.7, atol=4 / np.sqrt(2 * 150))


def test_a_memory_is_learnt_with_the_rows_in_order(tmp_path: Path) -> None:
    error = wander(np.random.default_rng(12), 150, 0.75)
    found = learn(machine(tmp_path, error))
    assert found.memory.rho > 0.4
