"""The exact fits of a diagnosis: sizes, intervals and calibrated inputs against least squares done by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import log1p
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    UM,
    Array,
    Asked,
    Deflection,
    Drive,
    cause_of,
    drive_model,
    fit_of,
    size_of,
    wander,
    wide,
)
from numpy.testing import assert_allclose
from scipy.linalg import toeplitz
from scipy.optimize import brentq, least_squares, minimize, minimize_scalar
from scipy.stats import f, t
from scipy.stats import t as student

from truing import Condition, Effect, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from truing.diagnosis.competition import Competition
from truing.diagnosis.engine import diagnose
from truing.diagnosis.exact import EXACTLY, alone, fitting
from truing.diagnosis.findings import input_values
from truing.diagnosis.fitted import Fit
from truing.diagnosis.intervals import (
    Certainty,
    amplitude_interval,
    certainty_of,
    interval,
    may_be_zero,
    numbers_of,
    place_interval,
    shape_interval,
    value_of,
    whole_left,
)
from truing.diagnosis.noise import Autocorrelation, Tails
from truing.diagnosis.sample import sample_of


def drive_competition(folder: Path, error: Array, **more: object) -> Competition:
    """All causes of a drive that is off by this much (um), in white noise."""
    bench = wide(len(error), seed=21)
    asked = Asked(drive_model(**more))  # type: ignore[arg-type]
    return asked.competing(folder, bench.shown(error))


def drive_fit(folder: Path, error: Array, names: Sequence[str], **more: object) -> tuple[Competition, Fit]:
    made = drive_competition(folder, error, **more)
    return made, fit_of(made, *names)


def place_of(found: Fit, name: str) -> int:
    """Where a number stands among all of a fit."""
    return [number.name for number in numbers_of(found)].index(name)


@pytest.mark.parametrize("seed", [21, 26, 31])
def test_an_interval_is_that_of_least_squares_by_student(tmp_path: Path, seed: int) -> None:
    """By the plain covariance or the sandwich, whichever is larger: of both numbers, of the second, of the first."""
    rng = np.random.default_rng(seed)
    bench = wide(60, seed=21)
    error = 0.02 * bench.travel + 2 * np.sign(bench.load) + rng.normal(0, 1, 60)
    made, best = drive_fit(tmp_path, error, ["lead_error", "clearance"], tolerances={})
    design = np.column_stack([bench.travel, np.sign(bench.load)])
    expected = np.linalg.lstsq(design, error)[0]
    left = error - design @ expected
    inverse = np.linalg.inv(design.T @ design)
    plain = np.sqrt(np.diag(inverse) * (left @ left) / 58)
    leverage = np.einsum("ij,jk,ik->i", design, inverse, design)
    scored = design * (left / (1 - leverage))[:, None]
    robust = np.sqrt(np.diag(inverse @ scored.T @ scored @ inverse))  # HC3, MacKinnon and White (1985)
    reach = t.ppf(0.975, 58) * np.maximum(plain, robust)
    assert (robust > plain).tolist() == {21: [True, True], 26: [False, True], 31: [True, False]}[seed]
    certainty = certainty_of(best, made.extended)
    assert_allclose(certainty.freedom, 58, rtol=1e-6)
    units = np.array([UM / 1e-3, UM])
    for place, (value, half, unit) in enumerate(zip(expected, reach, units, strict=True)):
        assert numbers_of(best)[place].name == ("lead", "gap")[place]
        near = half * unit * np.sqrt(EXACTLY)  # a fit ends so many standard errors from the least, or nearer
        low, high = interval(best, certainty, place)
        assert_allclose([low, high], [(value - half) * unit, (value + half) * unit], rtol=0, atol=near)
        assert_allclose(high - low, 2 * half * unit, rtol=1e-4)
        assert_allclose(best.values[place][0], value * unit, rtol=0, atol=near)
    covariance = np.array(certainty.in_si([0, 1]))
    assert_allclose(covariance, covariance.T)
    assert_allclose(np.sqrt(np.diag(covariance)) * t.ppf(0.975, 58), reach * units, rtol=1e-4)
    correlation = inverse[0, 1] / np.sqrt(inverse[0, 0] * inverse[1, 1])
    assert_allclose(covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]), correlation, rtol=1e-5)


@pytest.mark.parametrize(("size", "may_be"), [(0.25, True), (0.27, False)])
def test_an_amplitude_may_be_zero_where_its_interval_holds_it(tmp_path: Path, size: float, may_be: bool) -> None:
    """Noise of 1 um that is square to the curve: of 60 rows the clearance has the reach t(59) / sqrt(59) = 0.261 um."""
    sign = np.sign(wide(60, seed=21).load)
    noise = np.where(np.cumsum(sign > 0) % 2 == 0, 1.0, -1.0) * (sign > 0)
    noise += np.where(np.cumsum(sign < 0) % 2 == 0, 1.0, -1.0) * (sign < 0)
    noise -= sign * (sign @ noise) / 60
    noise /= np.sqrt(np.mean(noise**2))
    made, best = drive_fit(tmp_path, size * sign + noise, ["clearance"], tolerances={})
    assert_allclose(size_of(best, "gap"), size * UM, rtol=1e-5)
    assert may_be_zero(best, certainty_of(best, made.extended), best.causes[0]) is may_be


def test_inputs_are_calibrated_by_their_prior_in_the_noise_that_is_left(tmp_path: Path) -> None:
    """-2 log likelihood with its noise free, n ln(mean square), plus the square of the input: made least by scipy."""
    rng = np.random.default_rng(22)
    bench = wide(40, seed=21)
    contact = bench.contact
    error = 0.15 * contact + 0.03 * bench.travel + rng.normal(0, 1, 40)
    _, best = drive_fit(tmp_path, error, ["lead_error"], tolerances={"contact": "3 %"})
    design = np.column_stack([bench.travel, 0.09 * contact])  # the second counts standard deviations

    def cost(x: Array) -> float:
        return float(40 * np.log(np.mean((error - design @ x) ** 2)) + x[1] ** 2)

    free = minimize(cost, [0.03, 1.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000})
    assert_allclose(size_of(best, "lead"), free.x[0] * UM / 1e-3, rtol=1e-5)
    assert_allclose(best.cost, free.fun, rtol=0, atol=1e-6)
    ((name, (value, of_its_sd)),) = input_values(best).items()
    assert name == "contact"
    assert_allclose([value / UM, of_its_sd], [3 + 0.09 * free.x[1], free.x[1]], rtol=1e-5)


@inputs
class Nothing:
    """A model must have an input."""

    size: Float = given(0.0, "", note="of nothing")


@results
class Reading:
    """What a gauge shows of nothing."""

    reading: Float = found("", note="reading")


def along_first(nothing: Nothing, base: Reading, *, one: Float, first: Float) -> Reading:
    """Follow the first condition."""
    return replace(base, reading=base.reading + one * first)


@pytest.mark.parametrize("stretched", [0.25, 0.5])
def test_an_input_in_which_the_model_bends_is_fitted_with_the_model_itself(tmp_path: Path, stretched: float) -> None:
    """(1 + stretched * size)^2 for a size of 0 +- 1, measured at 2: the slope there is 1.5 times, twice that at 0."""

    def squared(nothing: Nothing) -> Reading:
        return Reading(reading=16 * (1 + stretched * nothing.size) ** 2)

    follow = Effect(
        "along_first", on_results=along_first, needs=[Condition("first", "")], unknowns=[Unknown("one", -9, 9)]
    )
    spread = Tolerance("size", normal(sd="1"), why="drawing")
    model = Model(name="bent", title="A bent input", function=squared, errors=[spread, follow])
    first = np.linspace(-1, 1, 50)
    reading = 16 * (1 + 2 * stretched) ** 2 + 2 * first + np.random.default_rng(29).normal(0, 0.5, 50)
    asked = Asked(model, units={"first": "-", "reading": "-"})
    made = asked.competing(tmp_path, {"first": first, "reading": reading}, scale=1.0)
    best = fit_of(made, "along_first")

    def said(x: Array) -> Array:
        return np.asarray(16 * (1 + stretched * x[0]) ** 2 + x[1] * first)

    def cost(x: Array) -> float:
        return float(50 * np.log(np.mean((reading - said(x)) ** 2)) + x[0] ** 2)

    free = minimize(cost, [2.0, 2.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000})
    (value, of_its_sd) = input_values(best)["size"]
    error = 0.5 / np.sqrt(50) / (32 * stretched * (1 + 2 * stretched))
    assert of_its_sd == value
    assert_allclose(value, free.x[0], rtol=0, atol=error)
    assert_allclose(size_of(best, "one"), free.x[1], rtol=1e-5)
    assert_allclose(best.predicted["reading"], said(np.array([value, size_of(best, "one")])), rtol=1e-9)
    assert best.cost - free.fun < 1


def test_an_earlier_calibration_is_no_nominal_of_the_extended_model(tmp_path: Path) -> None:
    """A machine diagnosed again keeps the contact of its drawing; what was fitted stays a calibration."""
    bench = wide(40, seed=21)
    contact = bench.contact
    error = 0.15 * contact + 0.03 * bench.travel + np.random.default_rng(22).normal(0, 1, 40)
    asked = Asked(drive_model(["lead_error"], {"contact": "3 %"}))
    again = replace(asked.setup, calibrated={"contact": 3.1 * UM})
    done = diagnose(again, asked.records(tmp_path, bench.drawn(error)))
    assert done.extended is not None
    assert done.setup.inputs.contact == done.extended.inputs.contact == again.inputs.contact != 3.1 * UM
    assert_allclose(done.extended.calibrated["contact"] / UM, 3.15, atol=0.06)


def test_a_size_stays_inside_its_bounds(tmp_path: Path) -> None:
    """700 um lie above the 500 um that were declared; the sizes beside it are those of least squares with it held."""
    bench = wide(60, seed=21)
    error = np.random.default_rng(24).normal(0, 40, 60) + 700 * np.sign(bench.load) + 5 * bench.travel
    made = drive_competition(tmp_path, error, tolerances={})
    start = np.array([4000 * UM]), np.array([1e-3])  # outside as well
    best = alone(
        made.extended,
        fitting(made.sample, made.extended, [cause_of(made, name) for name in ("clearance", "lead_error")], start),
    )
    assert best is not None
    assert_allclose(size_of(best, "gap"), 500 * UM, rtol=1e-9)
    rest = error - 500 * np.sign(bench.load)
    beside = rest @ bench.travel / (bench.travel @ bench.travel)
    assert_allclose(size_of(best, "lead"), beside * UM / 1e-3, rtol=1e-5)


def in_noise(made: Competition, found: Fit, **more: object) -> tuple[Fit, Certainty]:
    """A fit and its certainty as if the noise had been another one."""
    noise = {name: replace(own, **more) for name, own in made.sample.noise.items()}  # type: ignore[arg-type]
    sample = sample_of(made.sample.machine, noise, made.sample.mask, made.sample.directions)
    again = alone(made.extended, fitting(sample, made.extended, found.causes, found.values, found))
    assert again is not None
    return again, certainty_of(again, made.extended)


def test_the_interval_in_heavy_tails_is_that_of_the_likelihood(tmp_path: Path) -> None:
    """Fisher's information of a place in Student's t of scale s with f degrees of freedom: (f + 1) / (f + 3) / s^2."""
    bench = wide(3000, seed=21)
    error = 0.02 * bench.travel + t(3).rvs(3000, random_state=25)
    made, best = drive_fit(tmp_path, error, ["lead_error"], tolerances={})
    _, found = in_noise(made, best, tails=Tails(3.0, 1.9))
    expected = 6 / 4 / (bench.travel @ bench.travel)  # (um/mm)^2, of a scale of 1 um
    assert_allclose(found.in_si([0])[0][0], expected * 1e-6, rtol=0.15)


def test_with_the_memory_taken_out_the_fit_is_that_of_generalised_least_squares(tmp_path: Path) -> None:
    bench = wide(200, seed=21)
    error = 0.3 * bench.time + wander(np.random.default_rng(31), 200, 0.6)
    made = drive_competition(tmp_path, error, tolerances={})
    best = fit_of(made, "sensor_drift")
    white, certainty = in_noise(made, best, memory=Autocorrelation(0.6))
    inverse = np.linalg.inv(toeplitz(0.6 ** np.arange(200.0)) / (1 - 0.36))
    time = bench.time
    precision = time @ inverse @ time
    slope = time @ inverse @ error / precision
    left = error - slope * time
    variance = left @ inverse @ left / 199 / precision
    assert_allclose(white.values[0], slope * UM / 3600, rtol=1e-5)
    assert_allclose(certainty.freedom, 199, rtol=1e-6)
    (own,) = np.diag(certainty.in_si([0]))
    assert own >= variance * (UM / 3600) ** 2 * (1 - 1e-5)  # the sandwich may be larger
    assert_allclose(own, variance * (UM / 3600) ** 2, rtol=0.3)


@pytest.mark.parametrize(("time_constant", "is_open"), [(1.5, False), (60.0, True)])
def test_the_interval_of_a_time_constant_is_its_profile(tmp_path: Path, time_constant: float, is_open: bool) -> None:
    bench = wide(120, seed=21)
    curve = 1 - np.exp(-bench.time / time_constant)
    error = 6 / curve.max() * curve + np.random.default_rng(26).normal(0, 0.5, 120)
    made, best = drive_fit(tmp_path, error, ["warm_up"], tolerances={})
    low, high = shape_interval(best, made.extended, certainty_of(best, made.extended), place_of(best, "time_constant"))

    def cost(constant: float) -> float:
        column = 1 - np.exp(-bench.time / constant)
        return float(np.sum((error - column * (column @ error) / (column @ column)) ** 2))

    def left(x: Array) -> Array:
        return np.asarray(error - x[0] * (1 - np.exp(-bench.time / x[1])))

    free = least_squares(left, [6, 2], bounds=([-99, 0.1], 20))
    least = 2 * free.cost
    level = least * (1 + f.ppf(0.95, 1, 118) / 118)
    assert low is not None
    assert_allclose(low / 3600, brentq(lambda at: cost(at) - level, 0.1, free.x[1]), rtol=5e-3)
    assert (high is None) == is_open
    if high is not None:
        assert_allclose(high / 3600, brentq(lambda at: cost(at) - level, free.x[1], 20), rtol=5e-3)


# Intervals of what is not an amplitude in proportion: places, whole numbers, and amplitudes beside a shape.

ROWS = 90
BENCH = wide(ROWS)
HOURS = BENCH.time


def waved(screw: Drive, base: Deflection, *, size: Float, order: Float) -> Deflection:
    """Go up and down along a short stroke."""
    return replace(base, deflection=base.deflection + size * np.cos(order * screw.travel / 0.3))


WAVED = Effect("waved", on_results=waved, unknowns=[Unknown("size", -9, 9, "um"), Unknown("order", 1, 6, whole=True)])


def fitted(folder: Path, name: str, error: np.ndarray, seed: int) -> tuple[Competition, Fit, Certainty, np.ndarray]:
    """One effect as fitted to an error in noise of 1 um, how certain it is, and what is measured beyond the model."""
    model = drive_model([name] if name == "warm_up" else [], {})
    model = replace(model, errors=[*model.errors, WAVED])
    beyond = error + np.random.default_rng(seed).normal(0, 1, ROWS)
    asked = Asked(model)
    made = asked.competing(folder, BENCH.shown(beyond))
    best = fit_of(made, name)
    return made, best, certainty_of(best, made.extended), beyond


def squares(beyond: np.ndarray, column: np.ndarray) -> float:
    """What a column leaves of what is measured beyond the model, by least squares."""
    return float(beyond @ beyond - (column @ beyond) ** 2 / (column @ column))


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_a_place_lies_between_the_rows_that_the_law_of_change_points_leaves(tmp_path: Path, seed: int) -> None:
    """By n ln of the sums of squares: the gap at either end is within 7.35 of the best, the next one is not."""
    made, best, _, beyond = fitted(tmp_path, "step", 1.5 * (HOURS >= 6.0), seed)
    cause = cause_of(made, "step")
    rows = np.sort(HOURS)
    left = np.array([squares(beyond, (row < HOURS).astype(float)) for row in rows[:-1]])
    own = int(np.searchsorted(rows, value_of(best, cause.shapes[0]) / 3600)) - 1
    may_be = ROWS * np.log(left / left[own]) <= 7.35
    ends = np.array(place_interval(best, made.extended, cause.shapes[0])) / 3600
    low, high = np.searchsorted(rows, ends - 1e-9)
    assert_allclose(rows[[low, high]], ends, rtol=1e-12)
    assert low <= own < high
    assert may_be[low]
    assert may_be[high - 1]
    assert low == 0 or not may_be[low - 1]
    assert high == ROWS - 1 or not may_be[high]


def test_whole_numbers_that_are_not_excluded_are_in_the_interval_and_their_amplitudes_too(tmp_path: Path) -> None:
    """Every order is fitted by hand: within 6 of the best by n ln of the sum of squares it may be the true one."""
    made, best, certainty, beyond = fitted(tmp_path, "waved", 1.1 * np.cos(2 * BENCH.travel / 300), 5)
    cause = cause_of(made, "waved")
    columns = {order: np.cos(order * BENCH.travel / 300) for order in range(1, 7)}
    left = {order: squares(beyond, column) for order, column in columns.items()}
    own = round(value_of(best, cause.shapes[0]))
    assert left[own] == min(left.values())
    others = {order for order in left if order != own and ROWS * np.log(left[order] / left[own]) < 6}
    assert others
    assert {
        round(value_of(each, cause.shapes[0])) for each in whole_left(best, made.extended, cause.shapes[0])
    } == others
    low, high = amplitude_interval(best, made.extended, certainty, cause.amplitudes[0])
    sizes = [float(columns[order] @ beyond / (columns[order] @ columns[order])) for order in (own, *others)]
    assert (low or np.inf) < 1e-6 * min(sizes)
    assert (high or 0.0) > 1e-6 * max(sizes)


def test_an_amplitude_beside_a_free_shape_has_the_ends_of_its_profile(tmp_path: Path) -> None:
    """There the least sum of squares is worth Student's t squared more; or it is the plain end."""
    made, best, certainty, beyond = fitted(tmp_path, "warm_up", 5 * (1 - np.exp(-HOURS / 4.0)), 7)
    cause = cause_of(made, "warm_up")

    def least(rise: float) -> float:
        def sum_of(log_constant: float) -> float:
            return float(np.sum((beyond - rise * (1 - np.exp(-HOURS / np.exp(log_constant)))) ** 2))

        return float(minimize_scalar(sum_of, bounds=(-3, 5), method="bounded", options={"xatol": 1e-8}).fun)

    fair = squares(beyond, 1 - np.exp(-HOURS / (best.of(cause)[cause.shapes[0]] / 3600)))
    allowed = ROWS * log1p(float(student.ppf(0.975, certainty.freedom)) ** 2 * certainty.variance / ROWS)
    place = cause.amplitudes[0]
    ends = amplitude_interval(best, made.extended, certainty, place)
    for end, plain, farthest in zip(ends, interval(best, certainty, place), (min, max), strict=True):
        assert end is not None
        assert end == farthest(end, plain)
        if end != plain:
            assert_allclose(ROWS * np.log(least(end * 1e6) / fair), allowed, rtol=0.05)
    assert ends != interval(best, certainty, place)
