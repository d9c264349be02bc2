"""From an explanation to one cause more: what may follow it, and what is believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from math import comb, inf, log
from pathlib import Path
from typing import Any

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
    wide,
)
from numpy.testing import assert_allclose

from truing.diagnosis import choice
from truing.diagnosis.causes import Candidate, Parameter, are_exclusive
from truing.diagnosis.choice import (
    CLOSE,
    DRAWS,
    FIRST_DRAWS,
    HOPELESS,
    LARGEST_RHO,
    LEAST_IN_PLACE,
    MANY_CURVES,
    SURE,
    SURELY,
    TWIN,
    WANDER,
    Law,
    _beats,
    _best,
    _candidates,
    _certain,
    _drawn,
    _is_vaguer,
    _largest,
    _rivals,
    _step,
    carried,
    law_of,
    unsure,
)
from truing.diagnosis.competition import MARGIN, UNREGISTERED, Competition, beside, search
from truing.diagnosis.conditional import ConditionalGain
from truing.diagnosis.fitted import Fit, differ, far_inputs, is_at_bound
from truing.diagnosis.folds import ends_of, folds_of
from truing.diagnosis.noise import Autocorrelation
from truing.diagnosis.sample import sample_of

ROWS = 150
BENCH = wide(ROWS, seed=51)
NOISE = np.random.default_rng(51).normal(0, 1, ROWS)
LINE = (BENCH.travel - 150) / 150
WAVE = 2 * np.pi * 9 * np.arange(ROWS) / ROWS


def competing(folder: Path, error: Array, bench: Bench = BENCH, seed: int = 51) -> Competition:
    """The effects of a drive on a record with an error (um) and noise of 1 um; nothing searched."""
    noise = np.random.default_rng(seed).normal(0, 1, len(bench))
    return Asked(drive_model(tolerances={})).competing(folder, bench.shown(error + noise))


def shape_of(made: Competition, tag: str) -> Candidate:
    (found,) = (cause for cause in made.causes if cause.tag == f"unknown:{tag}:deflection")
    return found


def shape(made: Competition, *tags: str, at: Fit | None = None) -> Fit:
    """Shapes beside an explanation, each fitted from where its curves say."""
    found = at or made.null
    for tag in tags:
        cause = shape_of(made, tag)
        *_, joined = made.fit_each(beside(found, cause, made.look(found, [cause])[cause.tag].starts))
        assert joined is not None
        found = joined
    return found


# What stands in the place of a polynomial


def drawn_share(error: Array) -> float:
    """The share of what a parabola of the travel takes away that a lead takes away, by least squares."""
    values = error + NOISE
    whole = np.column_stack([np.ones(ROWS), LINE, LINE**2])
    left = [np.sum((values - each @ np.linalg.lstsq(each, values)[0]) ** 2) for each in (BENCH.travel[:, None], whole)]
    return float((values @ values - left[0]) / (values @ values - left[1]))


@pytest.mark.parametrize(
    ("error", "name", "is_enough"),
    [
        (0.3 * BENCH.travel + 6 * (LINE**2 - 1 / 3), "lead_error", True),
        (0.3 * BENCH.travel + 40 * (LINE**2 - 1 / 3), "lead_error", False),
        (30 + 6 * LINE**2, "sensor_offset", False),
    ],
    ids=["lead", "bend", "offset"],
)
def test_an_effect_of_the_model_that_draws_nearly_all_stands_before_a_polynomial(
    tmp_path: Path, error: Array, name: str, is_enough: bool
) -> None:
    """A lead and a bend: the parabola is far better, and of what it takes away the lead takes 98 % or does not.

    An offset of the gauge, which every model has, is no better word than a shape.
    """
    assert (drawn_share(error) >= 0.98) is is_enough
    made = competing(tmp_path, error)
    registered, trend = fit_of(made, name), shape(made, "trend.3:travel")
    assert made.score(trend) < made.score(registered)
    offered = list(_candidates(made, made.null, 1))
    assert [found.key for found in offered] == ([registered.key] if is_enough else []) + [trend.key]


def test_a_shape_is_what_is_left_beside_an_effect_that_draws_nearly_all(tmp_path: Path) -> None:
    """Beside the lead no two causes without it follow, however good: the bend comes beside it."""
    made = competing(tmp_path, 0.3 * BENCH.travel + 6 * (LINE**2 - 1 / 3))
    lead = fit_of(made, "lead_error")
    without = shape(made, "trend.3:travel", at=fit_of(made, "clearance"))
    assert made.score(without) < made.score(lead) - 50
    (more,) = _candidates(made, lead, 2)
    assert more.key > lead.key
    assert len(more.causes) == 2


def test_one_new_shape_at_most_comes_in_a_step(tmp_path: Path) -> None:
    """Two shapes fit a bend and a wave, and are not believed at once; one beside another one is."""
    made = competing(tmp_path, 9 * LINE**2 + 8 * np.sin(WAVE))
    first = shape(made, "trend.3:travel")
    both = shape(made, "wave:time", at=first)
    beside = shape(made, "trend.3:travel", at=fit_of(made, "clearance"))
    assert made.ranked()[0].key == both.key
    best = _best(made, made.null, 2)
    assert best is not None
    assert best.key == beside.key
    further = _best(made, first, 2)
    assert further is not None
    assert further.key == both.key


# What a step must be better by


def of_causes(made: Competition, *names: str) -> Fit:
    """An explanation by name, its numbers left open: for where scores are stated."""
    causes = tuple(cause_of(made, name) for name in names)
    return replace(made.null, causes=causes, values=tuple(np.ones(cause.size) for cause in causes))


BESIDE, IN_PLACE = (["lead_error"], ["lead_error", "wear"]), (["lead_error"], ["clearance", "wear"])
EXCHANGED, FIRST = (["clearance"], ["lead_error"]), ([], ["wear"])


@pytest.mark.parametrize(
    ("step", "gain", "p_value", "carried", "is_believed"),
    [
        (BESIDE, WANDER - 0.1, 0.003, 99.0, False),
        (BESIDE, WANDER + 0.1, 0.003, 99.0, True),
        (IN_PLACE, LEAST_IN_PLACE - 0.1, 0.003, 99.0, False),
        (IN_PLACE, LEAST_IN_PLACE + 0.1, 0.003, 99.0, True),
        (EXCHANGED, WANDER - 0.1, 0.003, 99.0, False),
        (EXCHANGED, WANDER + 0.1, 0.003, 99.0, True),
        (FIRST, -0.1, 0.003, 99.0, False),
        (FIRST, 0.1, 0.003, 99.0, True),
        (BESIDE, 30.0, 0.003, 1.1, True),
        (BESIDE, 30.0, 0.02, 9.0, False),
        (BESIDE, 30.0, 0.003, 0.9, False),
        (EXCHANGED, 30.0, 0.003, 0.1, True),
        (EXCHANGED, 30.0, 0.003, -0.1, False),
        (IN_PLACE, 30.0, 0.003, 0.9, False),
        (IN_PLACE, 30.0, 0.003, 1.1, True),
    ],
)
def test_a_step_must_be_better_than_chance_than_noise_with_a_memory_and_on_rows_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: tuple[list[str], list[str]], gain: float, p_value: float,
    carried: float, is_believed: bool,
) -> None:  # fmt: skip
    """What is exchanged for no more numbers is judged by its score, and may not predict worse."""
    made = competing(tmp_path, 0.0 * LINE)
    at, more = (of_causes(made, *names) for names in step)
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.zeros(299), p_value))
    monkeypatch.setattr(choice, "carries_over", lambda *_: carried)
    monkeypatch.setattr(made, "score", lambda found: gain if found.key == at.key else 0.0)
    monkeypatch.setattr(made, "own_score", made.score)
    folds: Any = None
    assert _step(made, at, more, folds, seed=1).is_believed is is_believed
    assert LEAST_IN_PLACE > WANDER  # or the cases in place of others say nothing


# Waves that beat


def waves(folder: Path, further: Array) -> tuple[Competition, Fit, Fit]:
    """One wave over the time, and a further cause of many curves beside it."""
    made = competing(folder, 8 * np.sin(WAVE) + further)
    one = shape(made, "wave:time")
    both = shape(made, "wave:temperature", at=one)
    made.tries.update({cause.tag: MANY_CURVES + 1.0 for cause in both.causes})
    return made, one, both


def test_a_further_wave_must_carry_over_to_the_ends_of_the_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By two standard errors, both ends left out in turn; a first wave, and a cause of few curves, need not."""
    made, one, both = waves(tmp_path, 0.0 * LINE)
    for known, is_beat in ((1.9, True), (2.1, False)):
        asked = []

        def measured(*given: Any, known: float = known, asked: list[Any] = asked) -> float:
            asked.append(given[3])
            return known

        monkeypatch.setattr(choice, "carries_over", measured)
        assert _beats(made, one, both) is is_beat
        (ends,) = asked
        assert ends.count == 2
        assert_allclose(ends.block_of, ends_of(made.sample).block_of)
        assert not _beats(made, made.null, one)
        made.tries.update({cause.tag: MANY_CURVES - 1.0 for cause in both.causes if cause.tag not in one.key})
        assert not _beats(made, one, both)
        made.tries.update({cause.tag: MANY_CURVES + 1.0 for cause in both.causes})


def test_the_ends_are_the_first_and_the_last_quarter_of_every_run(tmp_path: Path) -> None:
    one = Asked(drive_model(tolerances={}))
    columns = BENCH.shown()
    records = one.records(tmp_path, columns, ["a"] * 40 + ["b"] * 110)
    ends = ends_of(plain_competition(one, records, UM).sample).block_of
    edges = [0, 10, 30, 40, 67, 123, 150]
    for (begin, end), block in zip(pairwise(edges), [0, -1, 1, 0, -1, 1], strict=True):
        assert (ends[begin:end] == block).all()


# What shapes pay for how much they draw


@pytest.mark.parametrize("size", [0.5, 5.0, 500.0])
def test_a_shape_pays_for_each_amplitude_the_logarithm_of_what_it_draws(tmp_path: Path, size: float) -> None:
    """3 ln(1 + variance drawn over mean square left) for a parabola; nothing for what is registered, or a constant."""
    values = size * LINE**2 + NOISE
    made = competing(tmp_path, size * LINE**2)
    found = shape(made, "trend.3:travel")
    made.again([found], 1e-6)
    found = made.known[found.key]
    design = np.column_stack([np.ones(ROWS), LINE, LINE**2])
    drawn = design @ np.linalg.lstsq(design, values)[0]
    paid = len(found.causes[0].amplitudes) * np.log1p(np.var(drawn) / np.mean((values - drawn) ** 2))
    assert_allclose(made.price_of_size(found), paid, rtol=1e-3)
    own = made.price(found) - made.price_of(found.causes[0]) - 2 * np.log(len(made.causes))
    assert_allclose(own, paid, rtol=1e-3)
    assert made.price_of(found.causes[0]) >= UNREGISTERED
    assert made.price_of_size(fit_of(made, "lead_error")) == 0
    assert made.price_of_size(made.null) == 0


def test_the_order_of_a_file_without_an_order_leaves_the_folds_as_they_are(tmp_path: Path) -> None:
    """The rows that are left out together are the same in a shuffled file."""
    order = np.random.default_rng(9).permutation(ROWS)
    marked = []
    for place, rows in enumerate((np.arange(ROWS), order)):
        columns = BENCH.shown(NOISE)
        columns = {name: values[rows] for name, values in columns.items() if name != "time"}
        folder = tmp_path / str(place)
        folder.mkdir()
        one = Asked(drive_model(tolerances={}))
        made = one.competing(folder, columns)
        folds = folds_of(made.sample)
        marked.append({float(columns["travel"][row]): int(folds.block_of[row]) % folds.count for row in range(ROWS)})
    assert marked[0] == marked[1]
    assert set(marked[0].values()) == set(range(5))


# What is not excluded beside the winner: scores of exact fits, and when their difference decides.

FEW = wide(90, seed=21)


def searched(folder: Path, error: Array) -> Competition:
    """Every single effect that promises anything, fitted."""
    made = competing(folder, error, FEW, 3)
    made.forward(made.null, len(made.causes), lambda cause: cause.effect is not None)
    return made


def test_a_number_at_its_bound_costs_as_much_as_a_sign_of_a_wrong_cause(tmp_path: Path) -> None:
    """700 um of a clearance where 500 were declared: score and cost differ by the price and one margin."""
    made = competing(tmp_path, 700 * np.sign(FEW.load), FEW, 3)
    found = fit_of(made, "clearance")
    left = 200 * np.sign(FEW.load) + np.random.default_rng(3).normal(0, 1, len(FEW))
    expected = len(FEW) * np.log(np.mean(left**2)) + np.log(len(FEW)) + 2 * np.log(len(made.causes)) + MARGIN
    assert_allclose(made.score(found), expected, rtol=0, atol=1e-3)


@pytest.mark.parametrize("apart", [6.0, 25.0, 60.0])
@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_where_what_is_left_is_noise_a_difference_d_is_unsure_by_two_roots_of_d(
    tmp_path: Path, apart: float, rho: float
) -> None:
    """Of two fits of which one misses a curve c of the noise: d = |c|^2 with the variance 4 |c|^2.

    What is left has no memory any more, so that it is the same under every filter.
    """
    bench = wide(4000, seed=21)
    asked = Asked(drive_model(("clearance",), {}))
    made = asked.competing(tmp_path, bench.shown())
    noise = {name: replace(own, memory=Autocorrelation(rho)) for name, own in made.sample.noise.items()}
    sample = sample_of(made.sample.machine, noise, made.sample.mask)
    curve = np.sin(np.arange(4000) / 50)
    curve *= np.sqrt(apart) / np.linalg.norm(curve)
    rng, said = np.random.default_rng(0), []
    for _ in range(40):
        left = rng.normal(0, 1, 4000)
        said.append(unsure(*(replace(made.null, left=each, sample=sample) for each in (left, left + curve))))
    assert np.mean(said) == pytest.approx(2 * np.sqrt(apart), rel=0.05)
    assert SURE * 2 * np.sqrt(CLOSE) == pytest.approx(CLOSE)


# Vaguer words


def test_a_shape_is_vaguer_that_draws_98_percent_of_what_the_winner_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parabola holds a line and no jump of the same covariate; how much of the jump it draws is a projection."""
    made = competing(tmp_path, 0.05 * FEW.travel + 5 * np.sign(FEW.load), FEW, 3)
    lead, jump = fit_of(made, "lead_error"), fit_of(made, "clearance")
    travel, load = shape(made, "trend.3:travel"), shape(made, "trend.3:load")
    assert _is_vaguer(made, lead, travel)
    assert not _is_vaguer(made, lead, load)
    assert not _is_vaguer(made, jump, load)
    sign, powers = np.sign(FEW.load), np.column_stack([FEW.load**power for power in range(3)])
    rest = sign - powers @ np.linalg.lstsq(powers, sign)[0]
    share = 1 - float(rest @ rest / (sign @ sign))
    assert share < TWIN
    for wanted, is_vaguer in ((share - 1e-3, True), (share + 1e-3, False)):
        monkeypatch.setattr(choice, "TWIN", wanted)
        assert _is_vaguer(made, jump, load) is is_vaguer


# The search and what it gains by chance: against all subsets by least squares, and noise by the recursion.

NAMES = ("lead_error", "clearance", "wear", "thermal_growth", "sensor_offset", "sensor_gain", "sensor_drift")
WARMING = warming(ROWS, seed=5)
WARMING_NOISE = np.random.default_rng(5).normal(0, 1, ROWS)


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


def named_competing(
    folder: Path, error: Array, names: Sequence[str] = NAMES, *, tolerated: bool = False
) -> Competition:
    """These causes alone on a record of WARMING with an error (um) and noise of 1 um, in white noise."""
    own = [name for name in names if not name.startswith(("sensor", "input", "unknown", "step"))]
    one = Asked(drive_model(own, {"contact": "3 %", "shaft": "3 %"} if tolerated else {}))
    made = one.competing(folder, WARMING.shown(error + WARMING_NOISE))
    made.causes = tuple(cause for cause in made.causes if cause.name in names)
    return made


# The search


@pytest.mark.parametrize(("worth", "stays"), [(SURELY - 5, False), (SURELY + 5, True)])
def test_an_effect_without_which_much_is_lost_stays_although_its_interval_holds_zero(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, worth: float, stays: bool
) -> None:
    made = competing(tmp_path, 0.05 * FEW.travel + 1, FEW, 3)
    best = fit_of(made, "lead_error", "sensor_offset")
    scores = {best.key: 0.0, best.key - {best.causes[1].tag}: worth, best.key - {best.causes[0].tag}: 1e3}
    monkeypatch.setattr(made, "score", lambda found: scores.get(found.key, 2e3))
    monkeypatch.setattr(choice, "may_be_zero", lambda found, certainty, cause: cause.name == "sensor_offset")
    assert (len(_certain(made, best).causes) == 2) is stays


@pytest.mark.parametrize(
    ("above", "carried", "is_told"),
    [(0.05, 1.1, True), (0.2, 1.1, False), (0.05, 0.9, False)],
    ids=["told", "chance", "predicts nothing"],
)
def test_one_more_cause_may_be_there_where_chance_seldom_gives_as_much(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, above: float, carried: float, is_told: bool
) -> None:
    """``above`` is the share of simulated searches that gain more from noise."""
    made = searched(tmp_path, 0.012 * FEW.travel)
    best, more = fit_of(made, "lead_error"), fit_of(made, "lead_error", "wear")
    gain = made.score(best) - made.score(more)
    simulated = gain + np.where(np.arange(100) < 100 * above, 1.0, -1.0)
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(simulated, above))
    monkeypatch.setattr(choice, "carries_over", lambda *_: carried)
    told = [rival.fit.key for rival in _rivals(made, best, 1) if best.key < rival.fit.key]
    assert told == ([more.key] if is_told else [])


def test_what_explains_as_much_in_the_place_of_the_winner_is_not_told_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.full(100, -1e9), 0.01))
    monkeypatch.setattr(choice, "carries_over", lambda *_: 9.0)
    made = searched(tmp_path, 0.012 * FEW.travel + 1.6 * np.sign(FEW.load))
    best, _, both = (fit_of(made, *names) for names in (["lead_error"], ["clearance"], ["lead_error", "clearance"]))
    assert both.key in {rival.fit.key for rival in _rivals(made, best, 1)}
    monkeypatch.setattr(choice, "CLOSE", 1e6)
    monkeypatch.setattr(choice, "_is_near", lambda made, best, fit: fit.key == frozenset(["clearance"]))
    assert {rival.fit.key for rival in _rivals(made, best, 1)} == {frozenset(["clearance"])}


def test_of_shapes_that_say_the_same_the_one_stands_that_leaves_a_name_most(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parabola over the travel takes a lead, a wave over it does not; both draw what was hidden beside it."""
    made = searched(tmp_path, 0.02 * FEW.travel + 3 * np.sin(FEW.travel / 40))
    lead = fit_of(made, "lead_error")
    both = {kind: shape(made, f"{tag}:travel", at=lead) for kind, tag in (("trend", "trend.3"), ("wave", "wave"))}
    assert choice._worth_of_names(made, both["wave"]) > choice._worth_of_names(made, both["trend"])
    near = {found.key: 0.0 for found in both.values()}
    score = made.score
    monkeypatch.setattr(made, "score", lambda found: near.get(found.key, score(found)))
    assert choice._taking_least(made, both["trend"]).key == both["wave"].key
    near[both["wave"].key] = CLOSE + 1
    assert choice._taking_least(made, both["trend"]).key == both["trend"].key


def test_a_rival_stays_open_where_the_rows_contradict_one_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = searched(tmp_path, 0.012 * FEW.travel)
    best = fit_of(made, "lead_error")
    behind = sorted(made.score(found) - made.score(best) for found in made.ranked(lambda each: len(each.causes) == 1))
    assert behind[0] == 0
    assert CLOSE < behind[1] < 60
    assert _rivals(made, best, 1) == ()
    monkeypatch.setattr(choice, "unsure", lambda one, other: 1.01 * behind[1] / SURE)
    (open_one,) = _rivals(made, best, 1)
    assert open_one.behind == pytest.approx(behind[1])


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
    columns = columns_of(WARMING)
    error = np.asarray(sum(size * columns[name] for name, size in sizes.items()))
    made = named_competing(tmp_path, error)
    search(made)
    scores = {}
    for many in range(6):
        for names in combinations(NAMES, many):
            design = np.column_stack([np.zeros(ROWS), *(columns[name] for name in names)])
            solved = np.linalg.lstsq(design, error + WARMING_NOISE)[0][1:]
            if all(value >= 0 for name, value in zip(names, solved, strict=True) if name in {"clearance", "wear"}):
                left = error + WARMING_NOISE - design[:, 1:] @ solved
                price = many * log(ROWS) + 2 * log(comb(len(NAMES), many))
                scores[frozenset(names)] = ROWS * log(np.mean(left**2)) + price
    best = min(scores, key=lambda names: scores[names])
    found = made.ranked()[0]
    assert {cause.name for cause in found.causes} == best
    gained = made.score(made.null) - made.score(found)
    assert_allclose(gained, scores[frozenset()] - scores[best], atol=0.01 * len(best) + 1e-3 * gained)


def test_a_step_is_looked_for_anew_beside_a_large_offset(tmp_path: Path) -> None:
    """Alone the step stands at the first row, where it draws the offset; beside the offset its place is another."""
    late = (np.arange(ROWS) >= 100).astype(float)
    made = named_competing(tmp_path, 300 - 4 * late, ["sensor_offset", "step"])
    search(made)
    found = made.ranked()[0]
    assert {cause.name for cause in found.causes} == {"sensor_offset", "step"}
    (step,) = (cause for cause in found.causes if cause.name == "step")
    after = [value for number, value in zip(step.numbers, found.of(step), strict=True) if not number.is_free]
    hours = WARMING.time[[99, 100]] * 3600
    assert hours[0] < after[0] <= hours[1]


def test_two_explanations_differ_by_what_they_draw_apart(tmp_path: Path) -> None:
    made = named_competing(tmp_path, 0.02 * WARMING.travel + 0.1 * (WARMING.temperature - 20))
    one, other = fit_of(made, "lead_error"), fit_of(made, "thermal_growth")
    drawn = [
        column
        * (column @ (0.02 * WARMING.travel + 0.1 * (WARMING.temperature - 20) + WARMING_NOISE))
        / (column @ column)
        for column in (WARMING.travel, WARMING.temperature - 20)
    ]
    left = 0.02 * WARMING.travel + 0.1 * (WARMING.temperature - 20) + WARMING_NOISE - drawn[0]
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
    error = gauge(WARMING.load, WARMING.travel, 3.9) - gauge(WARMING.load, WARMING.travel)
    made = named_competing(tmp_path, error, ["input:contact", "input:shaft"], tolerated=True)
    cube = WARMING.contact
    slopes, weight, moved = (
        np.column_stack([0.09 * cube, 0.015 * WARMING.load * WARMING.travel / 150]),
        1.0,
        np.zeros(2),
    )
    for _ in range(40):
        moved = np.linalg.solve(weight * slopes.T @ slopes + np.eye(2), weight * slopes.T @ (error + WARMING_NOISE))
        weight = float(1 / np.mean((error + WARMING_NOISE - slopes @ moved) ** 2))
    assert_allclose(made.null.moved, moved, rtol=1e-4)
    assert moved[0] > 5
    assert far_inputs(made.null) == [0]
    assert far_inputs(fit_of(made, "input:contact")) == []
    assert far_inputs(named_competing(tmp_path, 0.45 * error, ["input:contact"], tolerated=True).null) == [0]
    assert far_inputs(named_competing(tmp_path, 0.2 * error, ["input:contact"], tolerated=True).null) == []


def test_two_shapes_of_one_kind_over_the_same_are_one_explanation_too_many(tmp_path: Path) -> None:
    made = named_competing(tmp_path, 0.0 * WARMING.time, [*NAMES, "unknown"])
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
    made = named_competing(tmp_path, 0.02 * WARMING.travel, tolerated=True)
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
    made = named_competing(tmp_path, 0.0 * WARMING.time, names)
    seen = made.look(made.null)
    assert set(seen) >= {"lead_error", "warm_up"}
    drawn = np.random.default_rng(12).normal(size=(ROWS, 9))
    for steps in (1, 2):
        by_hand = [_greedy(made, seen, drawn[:, draw], steps) for draw in range(9)]
        assert_allclose(_largest(made, seen, drawn, 140.0, steps), by_hand, rtol=1e-9)


def _greedy(made: Competition, seen: Mapping[str, ConditionalGain], values: Array, steps: int) -> float:
    """The gain of one draw after so many steps, each projected off before the next."""
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
    strong = named_competing(tmp_path, 0.02 * WARMING.travel)
    strong.look(strong.null)
    law = law_of(strong, strong.null, fit_of(strong, "lead_error"), seed=1)
    assert len(law.gains) == DRAWS
    assert law.p_value == 1 / (DRAWS + 1)
    weak = named_competing(tmp_path, 0.0 * WARMING.time)
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
    """The best of three causes on 50 records of noise: of p-values as many lie below a level as the level says."""
    values = []
    for seed in range(50):
        noise = np.random.default_rng([13, seed]).normal(0, 1, ROWS)
        made = named_competing(tmp_path, noise - WARMING_NOISE, ["lead_error", "sensor_drift", "sensor_gain"])
        for tag, each in made.look(made.null).items():
            made.fit_each(beside(made.null, cause_of(made, tag.partition(".")[0]), each.starts))
        best = made.best(1)
        assert best is not None
        values.append(law_of(made, made.null, best, seed=seed).p_value)
    below = [sum(value <= level for value in values) for level in (0.1, 0.3, 0.6)]
    assert_allclose(below, [5, 15, 30], atol=10.6)  # three standard deviations of a binomial law at 0.5
