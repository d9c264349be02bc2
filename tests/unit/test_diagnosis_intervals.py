"""Intervals of what is not an amplitude in proportion: places, whole numbers, and amplitudes beside a shape."""

from dataclasses import replace
from math import log1p
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import UM, Asked, Deflection, Drive, cause_of, drive_model, fit_of, gauge, plain_competition, wide
from numpy.testing import assert_allclose
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

from truing import Effect, Float, Unknown
from truing.diagnosis.competition import Competition
from truing.diagnosis.fitted import Fit
from truing.diagnosis.intervals import (
    Certainty,
    amplitude_interval,
    certainty_of,
    interval,
    place_interval,
    value_of,
    whole_left,
)

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
    records = asked.records(folder, BENCH.columns(gauge(BENCH.load, BENCH.travel) + beyond))
    made = plain_competition(asked, records, UM)
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
