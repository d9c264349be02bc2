"""Known answers of the algebra of a diagnosis: likelihood, angles, separation, updates, profiles.

Expected numbers were worked out by hand or come from an independent calculation beside them.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    KN,
    STROKE,
    UM,
    Array,
    Asked,
    drive_model,
    gauge,
    names_of_piece,
    plain_contest,
    twist_model,
    warming,
    wide,
)
from numpy.testing import assert_allclose
from scipy.linalg import subspace_angles
from scipy.optimize import least_squares
from scipy.stats import multivariate_normal

from truing.diagnosis.contest import Contest
from truing.diagnosis.design import _Duel
from truing.diagnosis.fit import fit
from truing.diagnosis.hypotheses import Hypothesis, Piece
from truing.diagnosis.noise import Setting, colour, log_likelihood
from truing.diagnosis.search import Solution
from truing.diagnosis.visibility import needed, separation

WHITE = (0,)


def one_run(n: int) -> Array:
    starts = np.zeros(n, dtype=bool)
    starts[0] = True
    return starts


def piece_of(full: Contest, name: str) -> Piece:
    """The only variant of a cause, whichever of its names it goes by."""
    (found,) = [piece for piece in full.problem.term_pieces if name in names_of_piece(full, piece)]
    return found


def seen_angle(full: Contest, first: str, second: str) -> float:
    """The angle in degrees between two curves as the search sees them: whitened, without what is tolerated."""
    h = full.evidence.case(WHITE).total_h
    (i,), (j,) = piece_of(full, first).columns, piece_of(full, second).columns
    return float(np.degrees(np.arccos(h[i, j] / np.sqrt(h[i, i] * h[j, j]))))


def believed(full: Contest, name: str, amplitude: float) -> Solution:
    """An explanation with one amplitude (SI), as if it had been found."""
    piece = piece_of(full, name)
    per = full.problem.terms[piece.place].per[0]
    hypothesis = Hypothesis("one", (piece,), 0.0)
    return Solution(hypothesis, WHITE, np.array([amplitude / per]), np.zeros(0), (), ())


def rival(full: Contest, *names: str) -> Hypothesis:
    return Hypothesis("one" if len(names) == 1 else "two", tuple(piece_of(full, name) for name in names), 0.0)


def test_the_exact_likelihood_of_six_values_of_an_autoregression() -> None:
    values = np.array([0.3, -0.1, 0.4, 1.2, 0.7, -0.5])
    ours = log_likelihood(values, one_run(6), Setting(0.6), 0.8)
    lag = np.abs(np.subtract.outer(np.arange(6), np.arange(6)))
    dense = multivariate_normal(cov=0.8**2 / (1 - 0.6**2) * 0.6**lag).logpdf(values)
    assert_allclose(ours, dense, rtol=0, atol=1e-9)
    assert_allclose(ours, -6.0510384427, rtol=0, atol=1e-10)


def test_two_unit_vectors_at_thirty_degrees(tmp_path: Path) -> None:
    half = np.radians(30)
    columns = {"first": np.array([1.0, 0, 0]), "second": np.array([np.cos(half), np.sin(half), 0])}
    asked = Asked(twist_model(), units=dict.fromkeys(("first", "second", "reading"), "-"))
    full = plain_contest(asked, asked.records(tmp_path, {**columns, "reading": np.array([0.0, 1.0, 3.0])}), 1.0)
    assert_allclose(seen_angle(full, "along_first", "along_second"), 30, rtol=1e-9)
    assert_allclose(separation(full, believed(full, "along_first", 8.0), rival(full, "along_second")), 16, rtol=1e-9)


@pytest.mark.parametrize(("tolerances", "angle"), [({}, 13.75), ({"zero": "1 m"}, 22.65)])
def test_a_warm_up_and_a_drift_are_fourteen_degrees_apart(
    tmp_path: Path, tolerances: dict[str, str], angle: float
) -> None:
    bench = warming()
    asked = Asked(drive_model(tolerances=tolerances))
    full = plain_contest(asked, asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel))), UM)
    ours = seen_angle(full, "thermal_growth", "sensor_drift")
    free = np.column_stack([bench.temperature - 20, bench.time])
    free = free - free.mean(axis=0) if tolerances else free
    assert_allclose(ours, np.degrees(subspace_angles(free[:, :1], free[:, 1:])[0]), rtol=1e-6)
    assert_allclose(ours, angle, rtol=0, atol=0.005)


def test_growth_in_a_warm_up_is_visible_but_not_separable_from_a_drift(tmp_path: Path) -> None:
    bench = warming()
    asked = Asked(drive_model(tolerances={}))
    full = plain_contest(asked, asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel))), UM)
    true = believed(full, "thermal_growth", 0.05 * UM)
    curve = 0.05 * (bench.temperature - 20)

    def left(*columns: Array) -> float:
        design = np.column_stack(columns)
        return float(np.sum((curve - design @ np.linalg.lstsq(design, curve)[0]) ** 2))

    cases = [
        (separation(full, true, Hypothesis("none", (), 0.0)), float(curve @ curve), 133.7),
        (separation(full, true, rival(full, "sensor_drift")), left(bench.time), 7.55),
        (separation(full, true, rival(full, "sensor_drift", "sensor_offset")), left(bench.time, bench.time**0), 2.35),
    ]
    for ours, dense, known in cases:
        assert_allclose(ours, dense, rtol=1e-6)
        assert_allclose(ours, known, rtol=0, atol=0.05 if known > 100 else 0.005)
    assert cases[0][0] > 25 > 10 > cases[1][0] > cases[2][0]


def test_a_gain_and_a_loss_of_stiffness_are_three_degrees_apart(tmp_path: Path) -> None:
    load, travel = (each.ravel() for each in np.meshgrid(np.arange(-20.0, 21), np.arange(0.0, 301, 50)))
    bench = replace(wide(len(load)), load=load, travel=travel)
    asked = Asked(drive_model(tolerances={}))
    full = plain_contest(asked, asked.records(tmp_path, bench.columns(gauge(load, travel))), UM)
    contact = np.sign(load) * np.abs(load) ** (2 / 3)
    linear = 0.5 * load * travel / STROKE
    dense = np.degrees(subspace_angles((3 * contact + linear)[:, None], (2 * contact + linear)[:, None])[0])
    ours = seen_angle(full, "sensor_gain", "stiffness_loss")
    assert_allclose(ours, dense, rtol=1e-4)
    assert_allclose(ours, 3.32, rtol=0, atol=0.005)


def test_three_hundred_rows_that_carry_over_are_worth_seventy_five() -> None:
    setting = Setting(0.6)
    assert_allclose(300 * setting.independent_share, 75, rtol=1e-12)
    made = colour(np.eye(4000), one_run(4000), setting)  # columns: the answer to one innovation each
    variance_of_mean = float(np.sum(made.sum(axis=0) ** 2)) / 4000**2
    assert_allclose(setting.variance_ratio / variance_of_mean / 4000, 0.25, rtol=1e-3)


@pytest.mark.parametrize(("rho", "seen"), [(0.3, 0.837), (0.6, 0.632), (0.9, 0.316)])
def test_first_differences_of_noise_that_carries_over_show_too_little(rho: float, seen: float) -> None:
    made = colour(np.eye(50), one_run(50), Setting(rho)) * np.sqrt(1 - rho**2)
    covariance = made @ made.T
    assert_allclose(np.diag(covariance), 1, rtol=1e-12)
    of_differences = covariance[20, 20] - covariance[20, 21]  # half the variance of their difference
    assert_allclose(np.sqrt(of_differences), seen, rtol=0, atol=5e-4)


@pytest.mark.parametrize("gauges", [1, 2])
def test_a_setting_added_by_one_rank_is_a_full_refit(gauges: int) -> None:
    rng = np.random.default_rng(2)
    names = ["position", "tilt"][:gauges]
    data = rng.normal(size=(12, 3))
    truth = rng.normal(size=12)
    inverse = np.linalg.inv(data.T @ data + np.eye(3))
    rows = {name: rng.normal(size=(5, 3)) for name in names}
    signal = {name: rng.normal(size=5) for name in names}
    start = inverse @ data.T @ truth
    first = float(np.sum((truth - data @ start) ** 2) + start @ start)
    duel = _Duel(("a", "b"), first, start, inverse, signal, rows)
    design, target = np.concatenate([data, np.eye(3)]), np.concatenate([truth, np.zeros(3)])
    for place in (3, 0, 4):
        gain = duel.gains()[place]
        before = duel.separation
        duel.measure(place)
        design = np.concatenate([design, *(rows[name][place][None] for name in names)])
        target = np.concatenate([target, *(signal[name][place][None] for name in names)])
        refit = np.linalg.lstsq(design, target)[0]
        assert_allclose(duel.separation, np.sum((target - design @ refit) ** 2), rtol=1e-9)
        assert_allclose(duel.coefficients, refit, rtol=1e-9)
        if gauges == 1:
            assert_allclose(duel.separation, before + gain, rtol=1e-9)


@pytest.mark.parametrize("time_constant", [0.4, 2.0, 7.0])
def test_a_time_constant_from_its_grid_is_that_of_a_direct_fit(tmp_path: Path, time_constant: float) -> None:
    bench = wide(150, seed=8)
    noise = np.random.default_rng(8).normal(0, 0.3, len(bench))
    error = 4 * (1 - np.exp(-bench.time / time_constant)) + noise
    asked = Asked(drive_model(tolerances={}))
    columns = bench.columns(gauge(bench.load, bench.travel) + error)
    full = plain_contest(asked, asked.records(tmp_path, columns), 0.3 * UM)
    place = full.found.best(lambda item: item.kind == "one" and "warm_up" in names_of_piece(full, item.pieces[0]))
    best = fit(full, place)
    ours = {item.name: best.si_value(number) for number, item in enumerate(best.parameters)}
    direct = least_squares(
        lambda x: error - x[0] * (1 - np.exp(-bench.time / x[1])), [3.0, 1.0], xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    assert_allclose([ours["rise"] / UM, ours["time_constant"] / 3600], direct.x, rtol=1e-6)


@pytest.mark.parametrize(("explanations", "limit"), [(12, 17.5), (78, 22.0), (200, 24.5)])
def test_how_visible_an_effect_must_be_after_a_search(explanations: int, limit: float) -> None:
    assert_allclose(needed(explanations), limit, rtol=0, atol=0.5)


def test_the_units_of_this_file() -> None:
    assert_allclose([KN, UM, gauge(np.array([8.0]), np.array([150.0]))[0]], [1000, 1e-6, 16])
