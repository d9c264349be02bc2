"""The search and what it gains by chance: against all subsets by least squares, and noise by the recursion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from math import comb, inf, log
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    UM,
    Array,
    Asked,
    Bench,
    cause_of,
    drive_model,
    fit_of,
    gauge,
    plain_competition,
    warming,
)
from numpy.testing import assert_allclose

from truing.diagnosis.causes import Parameter, are_exclusive
from truing.diagnosis.choice import DRAWS, FIRST_DRAWS, HOPELESS, LARGEST_RHO, _drawn, _largest, carried, law_of
from truing.diagnosis.competition import Competition, beside, search
from truing.diagnosis.conditional import ConditionalGain, conditional_on
from truing.diagnosis.fitted import differ, far_inputs, is_at_bound
from truing.diagnosis.noise import Autocorrelation
from truing.diagnosis.sample import sample_of

ROWS = 150
NAMES = ("lead_error", "clearance", "wear", "thermal_growth", "sensor_offset", "sensor_gain", "sensor_drift")
BENCH = warming(ROWS, seed=5)
NOISE = np.random.default_rng(5).normal(0, 1, ROWS)


def columns_of(bench: Bench) -> dict[str, Array]:
    """What each cause draws per unit, by its formula."""
    return {
        "lead_error": bench.travel,
        "clearance": np.sign(bench.load),
        "wear": bench.time * np.sign(bench.load),
        "thermal_growth": bench.temperature - 20,
        "sensor_offset": np.ones(len(bench)),
        "sensor_gain": gauge(bench.load, bench.travel),
        "sensor_drift": bench.time,
    }


def competing(folder: Path, error: Array, names: Sequence[str] = NAMES, *, tolerated: bool = False) -> Competition:
    """These causes alone on a record of BENCH with an error (um) and noise of 1 um, in white noise."""
    own = [name for name in names if not name.startswith(("sensor", "input", "unknown", "step"))]
    one = Asked(drive_model(own, {"contact": "3 %", "shaft": "3 %"} if tolerated else {}))
    records = one.records(folder, BENCH.columns(gauge(BENCH.load, BENCH.travel) + error + NOISE))
    made = plain_competition(one, records, UM)
    made.causes = tuple(cause for cause in made.causes if cause.name in names)
    return made


# The search


@pytest.mark.parametrize(
    "sizes",
    [
        {"lead_error": 0.02},
        {"thermal_growth": 0.8, "sensor_drift": -1.4},  # nearly take one another away
        {"lead_error": 0.02, "wear": 0.4, "sensor_offset": -1.5},
        {"clearance": 2, "sensor_gain": 0.1, "thermal_growth": 0.3, "lead_error": -0.02},
    ],
    ids=lambda sizes: "+".join(sizes),
)
def test_the_search_ends_at_the_best_of_all_subsets(tmp_path: Path, sizes: dict[str, float]) -> None:
    """n ln(mean square) + k ln n + 2 ln C(7, k) by least squares of each subset; all fitted sizes are in bounds."""
    columns = columns_of(BENCH)
    error = np.asarray(sum(size * columns[name] for name, size in sizes.items()))
    made = competing(tmp_path, error)
    search(made)
    scores = {}
    for many in range(6):
        for names in combinations(NAMES, many):
            design = np.column_stack([np.zeros(ROWS), *(columns[name] for name in names)])
            solved = np.linalg.lstsq(design, error + NOISE)[0][1:]
            if all(value >= 0 for name, value in zip(names, solved, strict=True) if name in {"clearance", "wear"}):
                left = error + NOISE - design[:, 1:] @ solved
                price = many * log(ROWS) + 2 * log(comb(len(NAMES), many))
                scores[frozenset(names)] = ROWS * log(np.mean(left**2)) + price
    best = min(scores, key=lambda names: scores[names])
    found = made.ranked()[0]
    assert {cause.name for cause in found.causes} == best
    gained = made.score(made.null) - made.score(found)
    assert_allclose(gained, scores[frozenset()] - scores[best], atol=0.01 * len(best) + 1e-3 * gained)


def test_what_is_no_longer_needed_goes(tmp_path: Path) -> None:
    made = competing(tmp_path, 0.02 * BENCH.travel)
    several = fit_of(made, "sensor_offset", "sensor_drift", "lead_error")
    assert [cause.name for cause in made.backward(several).causes] == ["lead_error"]


def test_the_end_of_a_fit_is_what_the_model_shows_not_what_a_rough_fit_promised(tmp_path: Path) -> None:
    """Where inputs bend, slopes of them may promise a cost that the model does not reach: here 50 less."""
    made = competing(tmp_path, 0.02 * BENCH.travel, tolerated=True)
    true = made.exact(fit_of(made, "lead_error"))
    made.known[true.key] = promised = replace(true, cost=true.cost - 50)
    assert_allclose(made.exact(promised).cost, true.cost, atol=1e-4)


def test_a_step_is_looked_for_anew_beside_a_large_offset(tmp_path: Path) -> None:
    """Alone the step stands at the first row, where it draws the offset; beside the offset its place is another."""
    late = (np.arange(ROWS) >= 100).astype(float)
    made = competing(tmp_path, 300 - 4 * late, ["sensor_offset", "step"])
    search(made)
    found = made.ranked()[0]
    assert {cause.name for cause in found.causes} == {"sensor_offset", "step"}
    (step,) = (cause for cause in found.causes if cause.name == "step")
    after = [value for number, value in zip(step.numbers, found.of(step), strict=True) if not number.is_free]
    hours = BENCH.time[[99, 100]] * 3600
    assert hours[0] < after[0] <= hours[1]


def test_two_explanations_differ_by_what_they_draw_apart(tmp_path: Path) -> None:
    made = competing(tmp_path, 0.02 * BENCH.travel + 0.1 * (BENCH.temperature - 20))
    one, other = fit_of(made, "lead_error"), fit_of(made, "thermal_growth")
    drawn = [
        column * (column @ (0.02 * BENCH.travel + 0.1 * (BENCH.temperature - 20) + NOISE)) / (column @ column)
        for column in (BENCH.travel, BENCH.temperature - 20)
    ]
    left = 0.02 * BENCH.travel + 0.1 * (BENCH.temperature - 20) + NOISE - drawn[0]
    assert_allclose(differ(one, other), np.sum((drawn[0] - drawn[1]) ** 2) / np.mean(left**2), rtol=1e-4)


# Signs of a wrong explanation


@pytest.mark.parametrize(
    ("value", "low", "high", "is_there"),
    [
        (9.96, -10, 10, True),
        (9.89, -10, 10, False),  # nearer than a two hundredth of the range: 0.1
        (-9.96, -10, 10, True),
        (0.0, 0, 10, False),  # no end, but nothing at all
        (5.0, -inf, inf, False),
    ],
)
def test_a_number_at_an_end_of_its_range_lies_there(value: float, low: float, high: float, is_there: bool) -> None:
    assert is_at_bound(Parameter("size", low, high), value) is is_there
    assert not is_at_bound(replace(Parameter("size", low, high), whole=True), value)


def test_an_input_far_outside_of_its_tolerance_is_a_sign_unless_it_is_the_cause(tmp_path: Path) -> None:
    """The contact gives way 30 % more, ten standard deviations: the prior alone holds it where it is calibrated."""
    error = gauge(BENCH.load, BENCH.travel, 3.9) - gauge(BENCH.load, BENCH.travel)
    made = competing(tmp_path, error, ["input:contact", "input:shaft"], tolerated=True)
    cube = np.sign(BENCH.load) * np.cbrt(BENCH.load) ** 2
    slopes, weight, moved = np.column_stack([0.09 * cube, 0.015 * BENCH.load * BENCH.travel / 150]), 1.0, np.zeros(2)
    for _ in range(40):
        moved = np.linalg.solve(weight * slopes.T @ slopes + np.eye(2), weight * slopes.T @ (error + NOISE))
        weight = float(1 / np.mean((error + NOISE - slopes @ moved) ** 2))
    assert_allclose(made.null.moved, moved, rtol=1e-4)
    assert moved[0] > 5
    assert far_inputs(made.null) == [0]
    assert far_inputs(fit_of(made, "input:contact")) == []
    assert far_inputs(competing(tmp_path, 0.45 * error, ["input:contact"], tolerated=True).null) == [0]
    assert far_inputs(competing(tmp_path, 0.2 * error, ["input:contact"], tolerated=True).null) == []


def test_two_shapes_of_one_kind_over_the_same_are_one_explanation_too_many(tmp_path: Path) -> None:
    made = competing(tmp_path, 0.0 * BENCH.time, [*NAMES, "unknown"])
    by_tag = {cause.tag: cause for cause in made.causes}
    trend, higher = by_tag["unknown:trend.3:travel:deflection"], by_tag["unknown:trend.5:travel:deflection"]
    other, wave = by_tag["unknown:trend.3:time:deflection"], by_tag["unknown:wave:time:deflection"]
    assert are_exclusive([trend, higher])
    assert not are_exclusive([trend, other])
    assert not are_exclusive([wave, trend])
    assert are_exclusive([by_tag["lead_error"], by_tag["lead_error"]])


# What chance gains


def test_simulations_carry_over_a_little_more_than_was_fitted() -> None:
    assert_allclose(carried(0.6, 100), 0.6 + (1 + 1.8) / 100 + 0.5 * np.sqrt((1 - 0.36) / 100))
    assert carried(0.97, 30) == LARGEST_RHO
    assert carried(0.0, 30) == 0


@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_noise_is_drawn_by_the_recursion_from_what_is_left(tmp_path: Path, rho: float) -> None:
    """Innovations are drawn from those of the better explanation, carried on, and freed of the memory that is known."""
    made = competing(tmp_path, 0.02 * BENCH.travel, tolerated=True)
    noise = {name: replace(own, memory=Autocorrelation(rho)) for name, own in made.sample.noise.items()}
    sample = sample_of(made.sample.machine, noise, made.sample.mask)
    at, more = made.null.in_sample(sample), fit_of(made, "lead_error").in_sample(sample)
    drawn = _drawn(at, more, 7, np.random.default_rng(11))
    pool = more.left - more.left.mean()  # the memory is taken out
    generator, rho_used = np.random.default_rng(11), carried(rho, ROWS)
    innovations, by_hand = generator.choice(pool, size=(ROWS, 7)), np.zeros((ROWS, 7))
    by_hand[0] = innovations[0] / np.sqrt(1 - rho_used**2)
    for row in range(1, ROWS):
        by_hand[row] = rho_used * by_hand[row - 1] + innovations[row]
    by_hand[1:] -= rho * by_hand[:-1]
    by_hand[0] *= np.sqrt(1 - rho**2)
    assert_allclose(drawn[:ROWS], by_hand / np.sqrt(np.mean(pool**2)), rtol=1e-9, atol=1e-12)
    assert_allclose(drawn[ROWS:], generator.standard_normal((2, 7)))


def test_the_largest_gain_of_a_draw_is_that_of_all_curves_tried_one_by_one(tmp_path: Path) -> None:
    """Greedily: the curve that lowers most once paid for, then the best beside it."""
    names = ["lead_error", "sensor_gain", "warm_up"]
    made = competing(tmp_path, 0.0 * BENCH.time, names)
    seen = made.look(made.null)
    assert set(seen) >= {"lead_error", "warm_up"}
    drawn = np.random.default_rng(12).normal(size=(ROWS, 9))
    for steps in (1, 2):
        by_hand = [_greedy(made, seen, drawn[:, draw], steps) for draw in range(9)]
        assert_allclose(_largest(made, seen, drawn, 140.0, steps), by_hand, rtol=1e-9)


def _greedy(made: Competition, seen: dict[str, ConditionalGain] | object, values: Array, steps: int) -> float:
    """The gain of one draw after so many steps, each projected off before the next."""
    assert isinstance(seen, dict)
    total, left = 0.0, values
    for _ in range(steps):
        tried = []
        for cause in made.causes:
            for basis in seen[cause.tag].span.basis if cause.tag in seen else ():
                rest = left - basis.T @ (basis @ left)
                gain = 140.0 * log((left @ left) / (rest @ rest)) - made.price_of(cause)
                tried.append((gain, rest))
        gain, left = max(tried, key=lambda each: each[0])
        total += gain
    return total


def test_a_law_counts_the_draws_that_gain_as_much(tmp_path: Path) -> None:
    strong = competing(tmp_path, 0.02 * BENCH.travel)
    strong.look(strong.null)
    law = law_of(strong, strong.null, fit_of(strong, "lead_error"), seed=1)
    assert len(law.gains) == DRAWS
    assert law.p_value == 1 / (DRAWS + 1)
    weak = competing(tmp_path, 0.0 * BENCH.time)
    seen = weak.look(weak.null)
    starts = [beside(weak.null, cause_of(weak, name), seen[name].starts) for name in ("wear", "clearance")]
    best = max((weak.fit_each(each)[-1] for each in starts if each), key=lambda found: found.cost if found else 0.0)
    assert best is not None
    law = law_of(weak, weak.null, best, seed=1)
    gain = weak.score(weak.null) - weak.score(best)
    assert len(law.gains) == FIRST_DRAWS  # the answer is plain
    assert (law.gains >= gain).sum() >= HOPELESS
    assert law.p_value == (1 + (law.gains >= gain).sum()) / (1 + FIRST_DRAWS)


def test_chance_is_uniform_where_there_is_nothing(tmp_path: Path) -> None:
    """The best of three causes on 100 records of noise: of p-values as many lie below a level as the level says."""
    values = []
    for seed in range(100):
        noise = np.random.default_rng([13, seed]).normal(0, 1, ROWS)
        made = competing(tmp_path, noise - NOISE, ["lead_error", "sensor_drift", "sensor_gain"])
        for tag, each in made.look(made.null).items():
            made.fit_each(beside(made.null, cause_of(made, tag.partition(".")[0]), each.starts))
        best = made.best(1)
        assert best is not None
        values.append(law_of(made, made.null, best, seed=seed).p_value)
    below = [sum(value <= level for value in values) for level in (0.1, 0.3, 0.6)]
    assert_allclose(below, [10, 30, 60], atol=15)  # three standard deviations of a binomial law at 0.5


def test_curves_beside_an_explanation_leave_what_it_draws(tmp_path: Path) -> None:
    """Beside the lead the lead draws nothing, and a gain what is orthogonal to it."""
    made = competing(tmp_path, 0.02 * BENCH.travel)
    lead = fit_of(made, "lead_error")
    beside = conditional_on(lead, made.extended)
    travel, gain = BENCH.travel, gauge(BENCH.load, BENCH.travel)
    left = 0.02 * travel + NOISE
    left = left - travel * (travel @ left) / (travel @ travel)
    weight = 1 / np.sqrt(np.mean(left**2))
    assert_allclose(beside.left, left * weight, atol=1e-4)
    drawn = beside.beyond(beside.drawn(np.array([[travel], [gain]]) * UM))[:, 0]
    derivatives = 1e-5 * np.abs(travel * weight).max()  # differences tell a curve to so much of its size
    assert_allclose(drawn[0], 0 * travel, atol=derivatives)
    expected = (gain - travel * (travel @ gain) / (travel @ travel)) * weight
    assert_allclose(drawn[1], expected, atol=derivatives)
