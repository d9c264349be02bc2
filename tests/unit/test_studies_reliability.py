"""Reliability: probabilities that are known in closed form, and the same answer wherever it is computed."""

import hashlib
import json
from dataclasses import replace
from functools import reduce
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
from truing.studies.sampling import BLOCK, Moments, generator, joined, scatter_of

QUICK = Reliability(draws=40_000)
GAP_LIMITS = [Require("gap", at_most="10.2 mm", reliability=0.5), Require("gap", at_least="9.9 mm", reliability=0.5)]


def odds_of(setup, study=QUICK, executor=None):
    return calculate(replace(setup, studies=(study,)), executor=executor).outcomes["reliability"]


@pytest.fixture(scope="module")
def of_chain():
    """The odds of the dimension chain as it is declared, which many tests look at."""
    return odds_of(setup_of(CHAIN))


def within_sampling_error(probability, expected, draws):
    return abs(probability - expected) <= 4 * sqrt(expected * (1 - expected) / draws)


# ---- first order --------------------------------------------------------------------------------------------------


def half_of_the_limit(two: Two) -> Sum:
    """The load takes half of the strength with it."""
    return Sum(total=two.x + 0.5 * two.y)


CLOSED = [  # model, nominals, and the standard normal quantiles of what lies between the limits
    (CHAIN, {}, "gap", (-0.2 / 0.13, 0.2 / 0.13)),
    (CHAIN, {}, "twice", (-np.inf, 0.3 / 0.26)),
    (STRENGTH, {"y": 10.0}, "total", (-np.inf, 2.0)),  # load N(0, 3) against strength N(10, 4)
    (STRENGTH, {"y": -5.0}, "total", (-np.inf, -1.0)),  # the nominal machine misses
    (replace(STRENGTH, function=half_of_the_limit), {"y": 10.0}, "total", (-np.inf, 5 / sqrt(13))),  # of x - y/2
    (JOINT, {}, "total", (-1.0, 1.0)),  # x = c and y = -c/2: the sum has half the spread
    (replace(CHAIN, objectives=GAP_LIMITS), {}, "gap at most", (-np.inf, 0.2 / 0.13)),
    (replace(CHAIN, objectives=GAP_LIMITS), {}, "gap at least", (-np.inf, 0.1 / 0.13)),
]


@pytest.mark.parametrize(("model", "values", "limit", "quantiles"), CLOSED)
def test_a_linear_sum_of_normals_is_exact(model, values, limit, quantiles):
    """To first order, by the tangent plane (FORM), and within its error the sampling; also where the limit moves."""
    odds = odds_of(setup_of(model, **values))
    expected = norm.cdf(quantiles[1]) - norm.cdf(quantiles[0])
    near = 0.01 if model.name == "joint" else 1e-9  # 65536 draws stand for the joint spread
    assert odds.analytic[limit] == pytest.approx(expected, rel=near)
    assert odds.form[limit].probability == pytest.approx(expected, rel=max(near, 1e-6))
    assert within_sampling_error(odds.probability[limit], expected, odds.draws)
    low, high = odds.interval[limit]
    error = sqrt(odds.probability[limit] * (1 - odds.probability[limit]) / odds.draws)
    assert odds.as_json()[limit]["standard_error"] == pytest.approx(error, rel=1e-12)
    assert high - low == pytest.approx(2 * 1.96 * error, rel=0.01)


def test_the_shift_of_a_zone_is_in_the_mean():
    """Zone 0 to 6 um: mean 3 um, sd 1 um; ISO 286-1 Table 1: IT9 is 87, 62, 36 um."""
    odds = odds_of(setup_of(STACK))
    sd = sqrt((87 / 6) ** 2 + (1.5 * 62 / 6) ** 2 + (0.5 * 36 / 6) ** 2 + 1)
    expected = norm.cdf((15 - 3) / sd) - norm.cdf((-15 - 3) / sd)
    assert odds.analytic["height"] == pytest.approx(expected, rel=1e-9)
    assert within_sampling_error(odds.probability["height"], expected, odds.draws)
    assert 1e6 * (odds.mean["height"] - 0.155) == pytest.approx(3, abs=4 * sd / sqrt(odds.draws))


CHANCES = [
    (0.0, 1.0, -1.0, 1.0, 0.6826894921370859),  # the 68-95-99.7 rule
    (0.0, 1.0, 5.0, float("inf"), 2.866515718791939e-07),
    (0.0, 1.0, 8.0, 9.0, norm.sf(8) - norm.sf(9)),
    (0.0, 1.0, -9.0, -8.0, norm.cdf(-8) - norm.cdf(-9)),
    (1.0, 0.0, 0.0, 2.0, 1.0),
    (3.0, 0.0, 0.0, 2.0, 0.0),
]
# Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3 (score): successes, trials, lower, upper.
NEWCOMBE = [(81, 263, 0.2553, 0.3662), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]


def test_the_normal_chance_is_exact_in_both_tails_and_the_interval_is_wilsons():
    for mean, sd, low, high, expected in CHANCES:
        assert normal_chance(mean, sd, low, high) == pytest.approx(expected, rel=1e-12)
    for hits, draws, low, high in NEWCOMBE:
        assert wilson(hits, draws) == pytest.approx((low, high), abs=5e-5)
        assert wilson(draws - hits, draws) == pytest.approx((1 - high, 1 - low), abs=5e-5)


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
    words = "study 'reliability': 'total' is checked for the values as stated only; of the machines that scatter"
    assert [text.startswith(words) for text in odds.warnings()] == [True] * (limit < 1.9)  # 99.75 % keep 1.9


def test_failed_machines_count_as_missed():
    odds = odds_of(setup_of(ROOT))
    assert within_sampling_error(odds.probability["side"], norm.cdf(1.0), odds.draws)
    assert odds.failed == odds.draws - round(odds.probability["side"] * odds.draws)
    assert "no square has a negative area" in odds.warnings()[0]
    assert odds.moments["side"].count == odds.draws - odds.failed
    assert odds.as_json()["side"]["failed"] == odds.failed


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
    assert (odds.first_sd["total"], odds.sd["total"]) == (pytest.approx(5, rel=1e-9), pytest.approx(5, rel=0.02))


def test_neither_a_reading_nor_one_calibrated_machine_is_the_design(of_chain):
    on = SwitchedOn(CHAIN.effects["misread"], {"offset": 1.0}, {"offset": 1.0})
    assert odds_of(replace(setup_of(CHAIN), effects=(on,))).probability == of_chain.probability
    one = replace(setup_of(CHAIN), calibrated={"first": 31e-3})
    assert calculate(replace(one, studies=())).answers == calculate(replace(setup_of(CHAIN), studies=())).answers
    assert odds_of(one).as_json() == of_chain.as_json()


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
    odds = odds_of(setup_of(ROOT), Reliability(draws=1000, over="square", at="-1..1 m^2", points=3))
    assert [row for row, _ in odds.curve.failed] == [0]  # an impossible point keeps its reason
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


def cubic(two: Two) -> Sum:
    """A limit that bends ever more."""
    return Sum(total=3.0 - 0.6 * two.x - 0.6 * two.y - 0.1 * two.y**3)


def nearest_of_the_cubic() -> dict[str, float]:
    """Where x dx/dy + y vanishes on the curve x = 5 - y - y^3/6."""
    y = brentq(lambda y: y - (5 - y - y**3 / 6) * (1 + y**2 / 2), 0.0, 2.5, xtol=1e-14)
    return {"x": 5 - y - y**3 / 6, "y": y}


@pytest.mark.parametrize(
    ("model", "point"),
    [(SADDLE, {"x": 2.5 / sqrt(2), "y": 2.5 / sqrt(2)}), (replace(SADDLE, function=cubic), nearest_of_the_cubic())],
)
def test_form_of_a_curved_limit(model, point):
    """The benchmark 0.1 (x - y)^2 - (x + y)/sqrt 2 + 2.5, whose beta is 2.5, and a cubic one."""
    odds = odds_of(setup_of(model), Reliability(draws=400_000))
    side = odds.form["total"].sides["low"]
    assert side.beta == pytest.approx(hypot(*point.values()), rel=1e-6)
    assert side.point == pytest.approx(point, abs=1e-4 * side.beta)  # where the search ends
    assert odds.form["total"].probability == pytest.approx(norm.cdf(side.beta), rel=1e-9)
    if model is SADDLE:  # literature: P(failure) 4.21e-3 by integration, against 6.21e-3 of the tangent plane
        assert within_sampling_error(odds.probability["total"], 1 - 4.21e-3, 400_000)


def test_a_search_that_fails_is_a_status_and_no_number():
    model = replace(UNIFORMS, objectives=[Require("total", at_most="7", reliability=0.9)])
    odds = odds_of(setup_of(model))
    assert odds.form["total"].probability is None
    written = odds.as_json()["total"]["form"]
    assert set(written) == {"status"}
    assert "no convergence" in written["status"]
    assert any("FORM of the total" in getattr(block, "text", "") for block in odds.blocks())


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


@pytest.mark.parametrize("seed", [0, 7, 2**40 + 5, 2**130 + 3])
def test_a_generator_is_keyed_by_seed_block_and_the_sha256_of_the_name(seed):
    words = np.frombuffer(hashlib.sha256(b"wear").digest(), "<u4").tolist()
    keyed = np.random.SFC64(np.random.SeedSequence(seed, spawn_key=(3, *words)))
    expected = np.random.Generator(keyed).standard_normal(5)
    assert (generator(seed, 3, "wear").standard_normal(5) == expected).all()


@pytest.mark.parametrize("model", [CHAIN, ROOT, JOINT, WEAR])
def test_machines_are_the_same_in_every_batch_of_whole_blocks(model):
    setup = setup_of(model)
    small, large = (odds_of(setup, Reliability(draws=40_000, batch=n * BLOCK)).tally for n in (1, 2))
    assert (small.failed, small.reasons) == (large.failed, large.reasons)
    for name, hits in small.hits.items():
        assert np.all(hits == large.hits[name])
    for name, moments in small.moments.items():
        assert np.all(moments.smallest == large.moments[name].smallest)
        assert np.all(moments.largest == large.moments[name].largest)
        assert moments.mean == pytest.approx(large.moments[name].mean, rel=1e-12)
    other = odds_of(setup, Reliability(draws=40_000, batch=BLOCK + 1)).tally
    assert any(np.any(moments.mean != other.moments[name].mean) for name, moments in small.moments.items())


def test_moments_of_batches_join_to_those_of_the_whole():
    values = np.random.default_rng(5).normal(3557.6, 2.5e-2, 10_000)
    parts = [
        Moments(len(part), part.mean(), np.square(part - part.mean()).sum(), part.min(), part.max())
        for part in np.split(values, [17, 18, 4000])
    ]
    whole = reduce(joined, parts)
    assert whole.count == 10_000
    assert whole.mean == pytest.approx(np.mean(values), rel=1e-15)
    assert whole.sd == pytest.approx(np.std(values, ddof=1), rel=1e-9)
    assert (whole.smallest, whole.largest) == (values.min(), values.max())


# ---- what is said -------------------------------------------------------------------------------------------------


def test_the_sheet_is_in_percent_and_tells_differences_from_the_nominal_result(of_chain):
    """gap = 10 mm, sd 0.13 mm: in five digits the mean itself would say nothing."""
    chances, scatter = of_chain.blocks()
    assert chances.columns == ("limit kept", "goal", "Monte Carlo", "95 % from", "to", "first order", "FORM")
    assert chances.units == ("", "%", "%", "%", "%", "%", "%")
    assert "take the Monte Carlo" in chances.note
    ends = [100 * end for end in of_chain.interval["gap"]]
    gap = pytest.approx(100 * (2 * norm.cdf(0.2 / 0.13) - 1))
    expected = ["gap", pytest.approx(85), pytest.approx(100 * of_chain.probability["gap"]), *ends, gap, gap]
    assert chances.rows[0] == expected
    name, unit, mean, spread, first, smallest, largest = scatter.rows[0]
    assert (name, unit) == ("gap", "mm")
    assert abs(mean) < 4 * 0.13 / sqrt(of_chain.draws)
    assert (spread, first) == (pytest.approx(0.13, rel=0.01), pytest.approx(0.13, rel=1e-9))
    assert 3.5 * 0.13 < -smallest < 6 * 0.13
    assert 3.5 * 0.13 < largest < 6 * 0.13
    assert "differences from the result without scatter" in scatter.note


def test_checks_compare_the_chance_with_the_goal_and_say_how_it_was_found(of_chain):
    check = next(check for check in of_chain.checks() if check.name == "gap")
    assert (check.value, check.limit, check.passed) == (of_chain.probability["gap"], 0.85, True)
    assert check.margin == pytest.approx((check.value - 0.85) / 0.85)
    assert check.method == "Monte Carlo, 40000 machines"
    odds = odds_of(setup_of(CHAIN), Reliability(method=("first_order",)))
    assert odds.checks()[0].method == "first order"
    assert odds.probability == odds.analytic
    entry = odds.as_json()["gap"]
    assert (entry["method"], entry["interval95"], entry["draws"]) == ("first_order", None, 0)
    assert [block.title for block in odds.blocks()] == ["Probability"]


FEW = "draws = 19 cannot show a reliability of 0.95 of 'total'; ask for 20 or more"


@pytest.mark.parametrize(
    ("goal", "limit", "draws", "sentence", "said"),
    [
        (0.95, "5", 19, FEW, True),  # a reliability of 0.95 allows one miss in 1 / (1 - 0.95) = 20 machines
        (0.95, "5", 20, "cannot show", False),
        ("y", "100", 50, "no number of draws shows a reliability of 1 of 'total'", True),
        (norm.cdf(1.0), "3", 1000, "lies within the sampling error", True),
        (0.5, "3", 1000, "lies within the sampling error", False),
    ],
)
def test_too_few_draws_are_a_warning(goal, limit, draws, sentence, said):
    model = replace(STRENGTH, objectives=[Require("total", at_most=limit, reliability=goal)])
    warnings = odds_of(setup_of(model, y="1"), Reliability(draws=draws)).warnings()
    assert any(sentence in text for text in warnings) is said


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"draws": 0}, "at least 1"),
        ({"batch": 0}, "at least 1"),
        ({"method": ("bootstrap",)}, "not bootstrap"),
        ({"method": ()}, "not nothing"),
        ({"method": ("first_order", "form")}, "only beside a sampling"),
        ({"points": 1}, "2 to 1000"),
        ({"over": "first"}, "over and at go together"),
        ({"at": "1..2 mm"}, "over and at go together"),
    ],
)
def test_options_are_checked(options, sentence):
    with pytest.raises(UsageError, match=sentence):
        odds_of(setup_of(CHAIN), Reliability(**options))
    with pytest.raises(UsageError, match="requires nothing"):
        odds_of(setup_of(replace(CHAIN, objectives=[])))
