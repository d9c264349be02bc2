"""The noise of a diagnosis: filters against dense covariances, tails and spreads against simulated ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, log
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import TOLERANCES, UM, Array, Asked, drive_model, gauge, wander, white_noise, wide
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import block_diag, solve_triangular, toeplitz
from scipy.optimize import approx_fprime, minimize_scalar
from scipy.stats import halfnorm, linregress, multivariate_normal, norm, rankdata, t

from truing.diagnosis.learning import FEWEST_OF_MEMORY, learnt, memory_cost, memory_of
from truing.diagnosis.machine import Calibration, calibration_of, directions_of
from truing.diagnosis.noise import (
    LARGEST_EXPONENT,
    SETTINGS,
    TAILS,
    Autocorrelation,
    SpreadTrend,
    Tails,
    colour,
    robust_sd,
    spread_of,
    standardised,
    tails_of,
    weights_of,
    whiten,
)
from truing.diagnosis.sample import NoiseModel, Sample, resolution_of, sample_of

RUNS = (7, 1, 12, 2)


def starts_of(lengths: tuple[int, ...]) -> Array:
    starts = np.zeros(sum(lengths), dtype=bool)
    starts[np.cumsum([0, *lengths[:-1]])] = True
    return starts


def covariance(rho: float, theta: float, n: int) -> Array:
    """Of eta_i = rho eta_{i-1} + u_i - theta u_{i-1} with unit innovations, by the textbook (Box and Jenkins)."""
    first = (1 + theta**2 - 2 * rho * theta) / (1 - rho**2)
    second = (1 - rho * theta) * (rho - theta) / (1 - rho**2)
    return np.asarray(toeplitz([first, *(second * rho ** np.arange(n - 1))][:n]))


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
@pytest.mark.parametrize("columns", [(), (3,)], ids=["vector", "matrix"])
def test_colour_undoes_whiten_over_several_runs(setting: Autocorrelation, columns: tuple[int, ...]) -> None:
    values = np.random.default_rng(1).normal(size=(sum(RUNS), *columns))
    starts = starts_of(RUNS)
    white = whiten(values, starts, setting)
    assert white.shape == values.shape
    assert_allclose(colour(white, starts, setting), values, rtol=0, atol=1e-12)
    assert_allclose(whiten(colour(values, starts, setting), starts, setting), values, rtol=0, atol=1e-12)


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.87, 0.95])
def test_whitening_an_autoregression_is_the_inverse_root_of_its_covariance(rho: float) -> None:
    dense = block_diag(*(covariance(rho, 0, n) for n in RUNS))
    root = np.linalg.cholesky(dense)
    values = np.random.default_rng(2).normal(size=(sum(RUNS), 2))
    ours = whiten(values, starts_of(RUNS), Autocorrelation(rho))
    assert_allclose(ours, solve_triangular(root, values, lower=True), rtol=0, atol=1e-11)


@pytest.mark.parametrize(("rho", "theta"), [(0.8, 0.4), (0.9, 0.7), (0.96, 0.8)])
def test_a_wander_beside_white_noise_has_the_variance_of_the_formula_and_is_whitened_after_a_transient(
    rho: float, theta: float
) -> None:
    n, setting = 60, Autocorrelation(rho, theta)
    dense = covariance(rho, theta, n)
    assert_allclose(setting.variance_ratio, dense[0, 0], rtol=1e-12)
    assert_allclose(setting.neighbours, dense[0, 1] / dense[0, 0], rtol=1e-12)
    weights = np.array([1.0, *((rho - theta) * rho ** np.arange(3000))])  # of innovations, oldest last
    assert_allclose(setting.variance_ratio, weights @ weights, rtol=1e-9)
    filter_ = whiten(np.eye(n), starts_of((n,)), setting)
    left = filter_ @ dense @ filter_.T
    assert_allclose(np.diag(left)[0], 1, rtol=1e-12)
    settled = slice(int(np.ceil(log(1e-3) / log(theta))) if theta < 0.75 else 31, n)
    assert_allclose(left[settled, settled], np.eye(n)[settled, settled], rtol=0, atol=2e-3)
    assert 0.5 < np.diag(left).min() <= np.diag(left).max() < 1.5


def innovations(freedom: float, seed: int, n: int = 2000) -> Array:
    rng = np.random.default_rng([seed, 9])
    return np.asarray(rng.normal(size=n) if freedom == inf else rng.standard_t(freedom, n)) * 3e-6


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("freedom", "expected"), [(3.0, {3.0}), (4.0, {3.0, 4.0, 6.0}), (6.0, {4.0, 6.0, 10.0}), (inf, {10.0, inf})]
)
def test_tails_are_recovered_from_two_thousand_innovations(freedom: float, expected: set[float], seed: int) -> None:
    found = tails_of(innovations(freedom, seed))
    assert found.freedom in expected
    assert found.limit == TAILS[found.freedom]
    assert ("heavy" in found.words) == (found.freedom < inf)


def test_the_robust_deviation_is_that_of_a_normal_law_and_ignores_spikes() -> None:
    values = np.random.default_rng(7).normal(2.0, 0.3, 20_000)
    assert_allclose(robust_sd(values), 0.3, rtol=0.03)
    spoilt = values.copy()
    spoilt[:1000] += 100
    assert_allclose(robust_sd(spoilt), 0.3, rtol=0.15)


@pytest.mark.parametrize("slope", [0.4, -0.5])
def test_a_spread_that_follows_a_driver_is_found_with_its_slope(slope: float) -> None:
    rng = np.random.default_rng(11)
    load, speed = rng.uniform(0, 20, 400), rng.uniform(1, 5, 400)
    z = (load - load.mean()) / load.std()
    noise = rng.normal(size=400) * np.exp(slope * z)
    found = spread_of(noise, {"speed": speed, "load": load})
    assert found.driver == "load"
    line = linregress(load, halfnorm.ppf(rankdata(np.abs(noise)) / 401))
    assert_allclose(found.p_value, 2 * line.pvalue, rtol=1e-9)  # two drivers
    assert found.p_value < 0.002
    assert_allclose(found.slope, slope, rtol=0, atol=4 / np.sqrt(2 * 400))
    assert found.words == f"{'grows' if slope > 0 else 'falls'} with load"


def test_a_constant_spread_stays_silent() -> None:
    alarms = 0
    for seed in range(200):
        rng = np.random.default_rng([12, seed])
        drivers = {name: rng.uniform(-1, 1, 120) for name in ("load", "speed", "time")}
        alarms += bool(spread_of(rng.normal(size=120), drivers).driver)
    assert alarms <= 7  # 1 % each: eight or more of 200 come in one of 1000 such samples
    assert SpreadTrend().words == "constant"


def test_a_spread_is_not_looked_for_where_nothing_drives_it_or_all_is_alike_or_rows_are_few() -> None:
    values = np.random.default_rng(13).normal(size=100)
    assert spread_of(values, {}) == SpreadTrend()
    assert spread_of(values, {"load": np.ones(100)}) == SpreadTrend()
    assert spread_of(values[:19], {"load": np.arange(19.0)}) == SpreadTrend()
    assert spread_of(np.tile([1.0, -1.0], 30), {"load": np.arange(60.0)}) == SpreadTrend()


def test_weights_undo_the_spread_they_were_learnt_from_and_what_is_missing_lies_at_its_mean() -> None:
    assert_allclose(standardised(np.array([1.0, np.nan, 3.0])), [-np.sqrt(1.5), 0, np.sqrt(1.5)])
    assert_array_equal(standardised(np.ones(3)), 0)
    driver = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 100.0, np.nan])
    learnt, spread = np.arange(5), SpreadTrend("load", 0.7, 1e-6)
    z = (driver - 2) / np.sqrt(2)
    expected = [*np.exp(-0.7 * z[:5]), np.exp(-LARGEST_EXPONENT), 1]
    assert_allclose(weights_of(spread, driver, learnt, 7), expected)
    for plain in (weights_of(SpreadTrend(), driver, learnt, 7), weights_of(spread, None, learnt, 7)):
        assert_array_equal(plain, np.ones(7))


# The rows as a fit sees them: their noise, its memory and tails, how many count, and what the inputs draw.

BENCH = wide(150, seed=31)


def machine(
    folder: Path, error: Array, runs: Sequence[str] = (), *, tolerances: Mapping[str, str] = TOLERANCES
) -> Calibration:
    """A record of BENCH with an error in um."""
    one = Asked(drive_model((), tolerances))
    columns = BENCH.shown(error)
    return calibration_of(one.setup, one.records(folder, columns, runs))


def noise(seed: int = 31) -> Array:
    return np.random.default_rng(seed).normal(0, 1, 150)


def sample(there: Calibration, *, scale: float = UM, **known: object) -> Sample:
    """All rows, in noise of a known standard deviation and what else is known of it."""
    own = {name: replace(each, **known) for name, each in white_noise(there, scale).items()}  # type: ignore[arg-type]
    return sample_of(there, own, ~there.records.held_out)


# Rows


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
    contact = 0.09 * BENCH.contact
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


def test_the_step_of_a_gauge_is_found_in_what_it_shows() -> None:
    """Noise of two steps, rounded; where one reading in three was rescaled all are multiples of nothing."""
    shown = np.round(2 * np.random.default_rng(4).normal(size=400)) * 0.1
    assert_allclose([resolution_of(shown), resolution_of(shown + 17.3)], 0.1, rtol=1e-9)
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
