"""Reliability: probabilities that are known in closed form, and the same answer wherever it is computed."""

import json
from dataclasses import replace
from math import hypot, log, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm
from study_models import (
    CHAIN,
    JOINT,
    LOGNORMAL,
    ROOT,
    SADDLE,
    STACK,
    STRENGTH,
    UNIFORMS,
    WEAR,
    Sum,
    Two,
    setup_of,
)  # fmt: skip

from truing import Reliability, Require, Tolerance, normal
from truing.calculation import calculate
from truing.declare.spreads import Off
from truing.errors import UsageError
from truing.setup import SwitchedOn
from truing.studies.checks import normal_chance, wilson
from truing.studies.sampling import Moments, joined, scatter_of

QUICK = Reliability(draws=40_000)


def odds_of(setup, study=QUICK, executor=None):
    return calculate(replace(setup, studies=(study,)), executor=executor).outcomes["reliability"]


@pytest.fixture(scope="module")
def of_chain():
    """The odds of the dimension chain as it is declared, which many tests look at."""
    return odds_of(setup_of(CHAIN))


def within_sampling_error(probability, expected, draws):
    return abs(probability - expected) <= 4 * sqrt(expected * (1 - expected) / draws)


# ---- first order --------------------------------------------------------------------------------------------------


def test_a_linear_sum_of_normals_is_exact(of_chain):
    gap, twice = 2 * norm.cdf(0.2 / 0.13) - 1, norm.cdf(0.3 / 0.26)
    assert of_chain.analytic == pytest.approx({"gap": gap, "twice": twice}, rel=1e-12)
    assert of_chain.form["gap"].probability == pytest.approx(gap, rel=1e-9)
    assert of_chain.form["twice"].probability == pytest.approx(twice, rel=1e-9)
    assert within_sampling_error(of_chain.probability["gap"], gap, of_chain.draws)
    assert within_sampling_error(of_chain.probability["twice"], twice, of_chain.draws)


def test_the_shift_of_a_zone_is_in_the_mean():
    """Zone 0 to 6 um: mean 3 um, sd 1 um; ISO 286-1 Table 1: IT9 is 87, 62, 36 um."""
    odds = odds_of(setup_of(STACK))
    sd = sqrt((87 / 6) ** 2 + (1.5 * 62 / 6) ** 2 + (0.5 * 36 / 6) ** 2 + 1)
    expected = norm.cdf((15 - 3) / sd) - norm.cdf((-15 - 3) / sd)
    assert odds.analytic["height"] == pytest.approx(expected, rel=1e-9)
    assert within_sampling_error(odds.probability["height"], expected, odds.draws)
    assert 1e6 * (odds.mean["height"] - 0.155) == pytest.approx(3, abs=4 * sd / sqrt(odds.draws))


@pytest.mark.parametrize(
    ("mean", "sd", "low", "high", "expected"),
    [
        (0.0, 1.0, -1.0, 1.0, 0.6826894921370859),  # the 68-95-99.7 rule
        (0.0, 1.0, 5.0, float("inf"), 2.866515718791939e-07),
        (0.0, 1.0, 8.0, 9.0, norm.sf(8) - norm.sf(9)),
        (0.0, 1.0, -9.0, -8.0, norm.cdf(-8) - norm.cdf(-9)),
        (1.0, 0.0, 0.0, 2.0, 1.0),
        (3.0, 0.0, 0.0, 2.0, 0.0),
    ],
)
def test_the_normal_chance_is_exact_in_both_tails(mean, sd, low, high, expected):
    assert normal_chance(mean, sd, low, high) == pytest.approx(expected, rel=1e-12)


# Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3 (score): successes, trials, lower, upper.
NEWCOMBE = [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]


@pytest.mark.parametrize(("hits", "draws", "low", "high"), NEWCOMBE)
def test_the_interval_is_wilsons(hits, draws, low, high):
    assert wilson(hits, draws) == pytest.approx((low, high), abs=5e-5)
    assert wilson(draws - hits, draws) == pytest.approx((1 - high, 1 - low), abs=5e-5)


def test_the_standard_error_is_that_of_a_share(of_chain):
    share = of_chain.probability["gap"]
    assert of_chain.as_json()["gap"]["standard_error"] == pytest.approx(sqrt(share * (1 - share) / 40_000), rel=1e-12)


# ---- Monte Carlo --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("limit", [0.1, 0.5, 1.0, 1.9])
def test_a_sum_of_two_uniforms_is_a_triangle(limit):
    """P(|x + y| <= t) = 1 - (2 - t)^2/4 for x and y uniform in -1..1."""
    model = replace(UNIFORMS, objectives=[Require("total", within=str(limit))])
    odds = odds_of(setup_of(model), Reliability(draws=200_000))
    assert within_sampling_error(odds.probability["total"], 1 - (2 - limit) ** 2 / 4, 200_000)
    assert odds.sd["total"] == pytest.approx(sqrt(2 / 3), rel=0.01)
    assert odds.moments["total"].smallest >= -2
    assert odds.moments["total"].largest <= 2
    assert odds.checks() == []  # no goal, nothing to decide


def test_failed_machines_count_as_missed():
    odds = odds_of(setup_of(ROOT))
    assert within_sampling_error(odds.probability["side"], norm.cdf(1.0), odds.draws)
    assert odds.failed == odds.draws - round(odds.probability["side"] * odds.draws)
    assert "no square has a negative area" in odds.warnings()[0]
    assert odds.moments["side"].count == odds.draws - odds.failed
    assert odds.as_json()["side"]["failed"] == odds.failed


def test_a_limit_that_scatters_moves_with_the_machine():
    """Load N(0, 3) against strength N(10, 4): P = Phi(10/5)."""
    odds = odds_of(setup_of(STRENGTH, y=10.0))
    assert odds.analytic["total"] == pytest.approx(norm.cdf(2), rel=1e-9)
    assert odds.form["total"].sides["high"].beta == pytest.approx(2, rel=1e-6)
    assert within_sampling_error(odds.probability["total"], norm.cdf(2), odds.draws)


def test_a_limit_that_moves_the_result_too():
    """The result x + y/2 against its own limit y: the distance x - y/2 has the spread sqrt(9 + 4), not sqrt(9 + 36)."""
    model = replace(STRENGTH, function=half_of_the_limit)
    odds = odds_of(setup_of(model, y=10.0))
    expected = norm.cdf(5 / sqrt(13))
    assert odds.analytic["total"] == pytest.approx(expected, rel=1e-9)
    assert odds.form["total"].probability == pytest.approx(expected, rel=1e-6)
    assert within_sampling_error(odds.probability["total"], expected, odds.draws)


def half_of_the_limit(two: Two) -> Sum:
    """The load takes half of the strength with it."""
    return Sum(total=two.x + 0.5 * two.y)


def test_inputs_that_scatter_together():
    """x = c and y = -c/2 with c normal: the sum has half its spread."""
    odds = odds_of(setup_of(JOINT))
    assert within_sampling_error(odds.probability["total"], 2 * norm.cdf(1) - 1, odds.draws)
    assert odds.sd["total"] == pytest.approx(0.5, rel=0.02)


def test_conditions_scatter_and_effects_carry_it():
    """gap = 10 mm (1 + 1e-4/K (T - 20 degC)) with T scattering by 10 K: 10 um more beside 130 um."""
    model = replace(CHAIN, errors=[*CHAIN.errors, Tolerance("room", normal(sd="10 K"), on=["warmth"])])
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-4})
    odds = odds_of(replace(setup_of(model), effects=(on,)), Reliability(draws=400_000))
    assert odds.first_sd["gap"] == pytest.approx(sqrt(0.13**2 + 0.01**2) * 1e-3, rel=1e-6)
    assert odds.first_mean["gap"] == pytest.approx(10e-3, rel=1e-9)
    assert odds.sd["gap"] == pytest.approx(sqrt(0.13**2 + 0.01**2) * 1e-3, rel=0.005)


def test_a_diagnosed_effect_scatters_by_its_uncertainty():
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-4}, {"strain": 4e-4}, ((1.6e-7,),))
    quiet = {name: Off() for name in CHAIN.tolerances}
    setup = replace(setup_of(CHAIN), effects=(on,), spreads=quiet, conditions={"warmth": 293.15 + 25})
    odds = odds_of(setup)
    # 10 mm times 25 K times 4e-4/K
    assert odds.sd["gap"] == pytest.approx(0.1e-3, rel=0.02)
    assert odds.mean["gap"] == pytest.approx(10e-3 * (1 + 25e-4), rel=1e-4)


def test_two_tolerances_on_one_input_add_up():
    model = replace(STRENGTH, errors=[*STRENGTH.errors, Tolerance("more", normal(sd="4"), on=["x"])])
    odds = odds_of(setup_of(replace(model, objectives=[Require("total", at_most="5", reliability=0.5)])))
    assert odds.first_sd["total"] == pytest.approx(5, rel=1e-9)
    assert odds.sd["total"] == pytest.approx(5, rel=0.02)


def test_a_reading_never_fails_a_machine(of_chain):
    on = SwitchedOn(CHAIN.effects["misread"], {"offset": 1.0}, {"offset": 1.0})
    assert odds_of(replace(setup_of(CHAIN), effects=(on,))).probability == of_chain.probability


def test_one_calibrated_machine_is_not_the_design():
    setup = setup_of(CHAIN)
    one = replace(setup, calibrated={"first": 31e-3})
    assert calculate(replace(one, studies=())).answers == calculate(replace(setup, studies=())).answers
    assert odds_of(one).as_json() == odds_of(setup).as_json()


def test_where_nothing_scatters_chance_is_certain():
    quiet = replace(setup_of(CHAIN), spreads={name: Off() for name in CHAIN.tolerances})
    odds = odds_of(quiet)
    assert odds.probability == {"gap": 1.0, "twice": 1.0}
    assert odds.analytic == {"gap": 1.0, "twice": 1.0}
    assert odds.form["gap"].probability is None
    assert "nothing scatters" in odds.warnings()[0]
    json.dumps(odds.as_json(), allow_nan=False)


def test_a_result_along_an_axis_has_a_chance_at_every_place():
    """Rate N(2, 0.5) um/h, two stages: P(4 h: 16 um <= 20 um) = Phi(1) and so on."""
    odds = odds_of(setup_of(WEAR), Reliability(draws=100_000))
    expected = norm.cdf((20 / (2 * np.array([1, 4, 9])) - 2) / 0.5)
    assert odds.analytic["course"] == pytest.approx(expected, abs=1e-9)
    for found, sure in zip(odds.probability["course"], expected, strict=True):
        assert abs(found - sure) <= 4 * sqrt(sure * (1 - sure) / 100_000) + 1e-12
    check = next(check for check in odds.checks() if check.name == "course")
    assert check.value == odds.probability["course"].min()
    assert odds.form["course"].status == "not done: the result runs along an axis"
    json.dumps(odds.as_json(), allow_nan=False)


def test_the_curve_over_an_input():
    """depth = rate time, two stages: P(rate <= 25 um/time) along the working time."""
    study = Reliability(draws=50_000, over="working_time", at="5..20 h", points=4)
    odds = odds_of(setup_of(WEAR), study)
    expected = norm.cdf((50 / (2 * np.array([5, 10, 15, 20])) - 2) / 0.5)
    assert odds.curve is not None
    assert odds.curve.axis == pytest.approx(3600 * np.array([5, 10, 15, 20]))
    assert odds.curve.analytic["depth"] == pytest.approx(expected, abs=1e-9)
    assert odds.curve.probability["depth"] == pytest.approx(expected, abs=0.01)
    assert odds.curve.probability["depth"][1] == odds.probability["depth"]  # the same random numbers
    assert (odds.curve.at_least["depth"] <= odds.curve.probability["depth"]).all()
    written = json.loads(json.dumps(odds.as_json(), allow_nan=False))["depth"]["curve"]
    assert written["at"] == pytest.approx([5, 10, 15, 20])
    assert odds.blocks()[-1].draw().axes


def test_a_point_of_the_curve_that_is_impossible_keeps_its_reason():
    odds = odds_of(setup_of(ROOT), Reliability(draws=1000, over="square", at="-1..1 m^2", points=3))
    assert [row for row, _ in odds.curve.failed] == [0]
    assert odds.as_json()["side"]["curve"]["probability"][0] is None
    assert any("negative area" in text for text in odds.warnings())


# ---- FORM ---------------------------------------------------------------------------------------------------------


def test_form_of_lognormal_load_and_strength():
    """Closed form of the reliability index of two lognormal variables, exact in standard normal space."""
    odds = odds_of(setup_of(LOGNORMAL, x=10.0, y=16.0))
    load, strength = log(1 + 0.2**2), log(1 + 0.1**2)
    beta = (log(16 / 10) + load / 2 - strength / 2) / sqrt(load + strength)
    assert odds.form["total"].sides["high"].beta == pytest.approx(beta, rel=1e-6)
    assert within_sampling_error(odds.probability["total"], norm.cdf(beta), odds.draws)
    assert abs(odds.analytic["total"] - norm.cdf(beta)) > 1e-3  # first order takes them for normal


def test_form_of_a_quadratic_limit():
    """The benchmark 0.1 (x - y)^2 - (x + y)/sqrt 2 + 2.5: the nearest point is (2.5, 2.5)/sqrt 2, beta 2.5."""
    odds = odds_of(setup_of(SADDLE), Reliability(draws=400_000))
    side = odds.form["total"].sides["low"]
    assert side.beta == pytest.approx(2.5, rel=1e-6)
    assert side.point == pytest.approx({"x": 2.5 / sqrt(2), "y": 2.5 / sqrt(2)}, rel=1e-4)
    # Literature: P(failure) 4.21e-3 by integration, against 6.21e-3 of the tangent plane.
    assert within_sampling_error(odds.probability["total"], 1 - 4.21e-3, 400_000)
    assert odds.form["total"].probability == pytest.approx(norm.cdf(2.5), rel=1e-9)


def cubic(two: Two) -> Sum:
    """A limit that bends ever more."""
    return Sum(total=3.0 - 0.6 * two.x - 0.6 * two.y - 0.1 * two.y**3)


def test_form_of_a_cubic_limit():
    """The nearest point of the curve x = 5 - y - y^3/6, where x dx/dy + y vanishes: by bisection."""
    y = brentq(lambda y: y - (5 - y - y**3 / 6) * (1 + y**2 / 2), 0.0, 2.5, xtol=1e-14)
    x = 5 - y - y**3 / 6
    side = odds_of(setup_of(replace(SADDLE, function=cubic))).form["total"].sides["low"]
    assert side.beta == pytest.approx(hypot(x, y), rel=1e-9)
    assert side.point == pytest.approx({"x": x, "y": y}, abs=1e-4 * side.beta)  # where the search ends


def test_form_when_the_nominal_machine_misses():
    odds = odds_of(setup_of(STRENGTH, y=-5.0))
    assert odds.form["total"].sides["high"].beta == pytest.approx(-1, rel=1e-6)
    assert odds.form["total"].probability == pytest.approx(norm.cdf(-1), rel=1e-6)


def test_a_search_that_fails_is_a_status_and_no_number():
    model = replace(UNIFORMS, objectives=[Require("total", at_most="7", reliability=0.9)])
    odds = odds_of(setup_of(model))
    assert odds.form["total"].probability is None
    written = odds.as_json()["total"]["form"]
    assert set(written) == {"status"}
    assert "no convergence" in written["status"]
    assert any("FORM of the total" in getattr(block, "text", "") for block in odds.blocks())


def test_form_stands_only_beside_a_sampling():
    with pytest.raises(UsageError, match="only beside a sampling"):
        Reliability(method=("first_order", "form"))


# ---- seeds and workers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [CHAIN, ROOT, JOINT, WEAR])
def test_two_processes_give_the_same_bytes(model, two_processes):
    study = Reliability(draws=10_001, batch=1024)
    serial = json.dumps(odds_of(setup_of(model), study).as_json())
    assert serial == json.dumps(odds_of(setup_of(model), study, two_processes).as_json())


def test_a_further_tolerance_reshuffles_no_other():
    alone = scatter_of(setup_of(CHAIN)).draw(1, 3, 100)
    more = replace(CHAIN, errors=[Tolerance("room", normal(sd="1 K"), on=["warmth"]), *CHAIN.errors])
    together = scatter_of(setup_of(more)).draw(1, 3, 100)
    assert "warmth" in together
    for column, values in alone.items():
        assert (together[column] == values).all()
    assert (scatter_of(setup_of(CHAIN)).draw(1, 4, 100)["first"] != alone["first"]).all()


def test_inputs_of_one_tolerance_are_drawn_independently():
    columns = scatter_of(setup_of(UNIFORMS)).draw(1, 0, 20_000)
    assert abs(np.corrcoef(columns["x"], columns["y"])[0, 1]) < 4 / sqrt(20_000)


def test_moments_of_batches_join_to_those_of_the_whole():
    rng = np.random.default_rng(5)
    values = rng.normal(3557.6, 2.5e-2, 10_000)
    parts = np.split(values, [17, 18, 4000])
    whole = None
    for part in parts:
        mean = part.mean()
        moments = Moments(len(part), mean, ((part - mean) ** 2).sum(), part.min(), part.max())
        whole = moments if whole is None else joined(whole, moments)
    assert whole.count == 10_000
    assert whole.mean == pytest.approx(np.mean(values), rel=1e-15)
    assert whole.sd == pytest.approx(np.std(values, ddof=1), rel=1e-9)
    assert (whole.smallest, whole.largest) == (values.min(), values.max())


# ---- what is said -------------------------------------------------------------------------------------------------


def test_checks_compare_the_sampling_with_the_goal(of_chain):
    check = next(check for check in of_chain.checks() if check.name == "gap")
    assert (check.value, check.limit, check.passed) == (of_chain.probability["gap"], 0.85, True)
    assert check.margin == pytest.approx((check.value - 0.85) / 0.85)
    assert "take the Monte Carlo" in of_chain.blocks()[0].note


def test_the_table_of_the_sheet_is_in_percent(of_chain):
    table = of_chain.blocks()[0]
    assert table.columns == ("limit kept", "goal", "Monte Carlo", "95 % from", "to", "first order", "FORM")
    assert table.units == ("", "%", "%", "%", "%", "%", "%")
    gap = 2 * norm.cdf(0.2 / 0.13) - 1
    noise = 1.96 * sqrt(gap * (1 - gap) / of_chain.draws)
    _, goal, sampled, low, high, first, tangent = table.rows[0]
    assert (goal, first, tangent) == (pytest.approx(85), pytest.approx(100 * gap), pytest.approx(100 * gap))
    assert sampled == pytest.approx(100 * gap, abs=200 * noise)
    assert (high - sampled, sampled - low) == pytest.approx((100 * noise, 100 * noise), rel=0.05)


def test_a_check_says_how_its_probability_was_found(of_chain):
    assert of_chain.checks()[0].method == "Monte Carlo, 40000 machines"
    assert odds_of(setup_of(CHAIN), Reliability(method=("first_order",))).checks()[0].method == "first order"


def test_the_sheet_tells_mean_and_extremes_from_the_nominal_result(of_chain):
    """gap = 10 mm, sd 0.13 mm: in five digits the mean itself would say nothing."""
    table = next(block for block in of_chain.blocks() if block.title == "Scatter of the results")
    name, unit, mean, spread, first, smallest, largest = table.rows[0]
    assert (name, unit) == ("gap", "mm")
    assert abs(mean) < 4 * 0.13 / sqrt(of_chain.draws)
    assert (spread, first) == (pytest.approx(0.13, rel=0.01), pytest.approx(0.13, rel=1e-9))
    assert 3.5 * 0.13 < -smallest < 6 * 0.13
    assert 3.5 * 0.13 < largest < 6 * 0.13
    assert "differences from the result without scatter" in table.note


def test_a_goal_within_the_sampling_error_is_said():
    model = replace(CHAIN, objectives=[Require("gap", within="0.2 mm", reliability=0.876)])
    warnings = odds_of(setup_of(model), Reliability(draws=1000)).warnings()
    assert any("within the sampling error" in text for text in warnings)


def test_several_limits_on_one_result_have_names_of_their_own():
    limits = [Require("gap", at_most="10.2 mm", reliability=0.5), Require("gap", at_least="9.9 mm", reliability=0.5)]
    odds = odds_of(setup_of(replace(CHAIN, objectives=limits)))
    assert odds.analytic == pytest.approx(
        {"gap at most": norm.cdf(0.2 / 0.13), "gap at least": norm.cdf(0.1 / 0.13)}, rel=1e-9
    )


def test_without_sampling_the_chance_is_first_order():
    odds = odds_of(setup_of(CHAIN), Reliability(method=("first_order",)))
    assert odds.probability == odds.analytic
    assert odds.draws == 0
    entry = odds.as_json()["gap"]
    assert entry["method"] == "first_order"
    assert entry["interval95"] is None
    assert [block.title for block in odds.blocks()] == ["Probability"]


def test_nothing_required_is_said():
    with pytest.raises(UsageError, match="requires nothing"):
        odds_of(setup_of(replace(CHAIN, objectives=[])))


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"draws": 0}, "at least 1"),
        ({"batch": 0}, "at least 1"),
        ({"method": ("bootstrap",)}, "not bootstrap"),
        ({"method": ()}, "not nothing"),
        ({"points": 1}, "2 to 1000"),
    ],
)
def test_options_are_checked(options, sentence):
    with pytest.raises(UsageError, match=sentence):
        Reliability(**options)


@pytest.mark.parametrize("options", [{"over": "first"}, {"at": "1..2 mm"}])
def test_a_curve_needs_input_and_range(options):
    with pytest.raises(UsageError, match="over and at go together"):
        odds_of(setup_of(CHAIN), Reliability(**options))


@pytest.mark.parametrize(("draws", "warned"), [(19, True), (20, False), (1000, False)])
def test_fewer_draws_than_one_miss_may_be_among_are_a_warning(draws, warned):
    """A reliability of 0.95 allows one miss in 1 / (1 - 0.95) = 20 machines."""
    model = replace(STRENGTH, objectives=[Require("total", at_most="5", reliability=0.95)])
    words = odds_of(setup_of(model), Reliability(draws=draws)).warnings()
    said = "study 'reliability': draws = 19 cannot show a reliability of 0.95 of 'total'; ask for 20 or more"
    assert any(text.startswith(said) for text in words) is warned


def test_a_reliability_of_one_cannot_be_shown():
    """It may come from an input; how many machines were drawn is said."""
    model = replace(STRENGTH, objectives=[Require("total", at_most="100", reliability="y")])
    odds = odds_of(setup_of(model, y="1"), Reliability(draws=50))
    assert odds.checks()[0].passed
    assert "no number of draws shows a reliability of 1 of 'total'" in " ".join(odds.warnings())
