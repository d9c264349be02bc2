"""What is not excluded beside the winner: scores of exact fits, and when their difference decides."""

from __future__ import annotations

from dataclasses import replace
from math import comb
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, drive_model, fit_of, gauge, plain_competition, wide
from numpy.testing import assert_allclose

from truing.diagnosis import choice
from truing.diagnosis.choice import (
    CLOSE,
    SURE,
    SURELY,
    TWIN,
    Law,
    _certain,
    _is_vaguer,
    _rivals,
    _says_the_same,
    unsure,
)
from truing.diagnosis.competition import MARGIN, Competition, beside
from truing.diagnosis.fitted import Fit
from truing.diagnosis.noise import Autocorrelation
from truing.diagnosis.sample import sample_of

ROWS = 90
PLAIN = Asked(drive_model(tolerances={}))


def competing(folder: Path, error: Array, asked: Asked = PLAIN, *, load: Array | None = None) -> Competition:
    """All causes of a gauge that is off by this much (um), with noise of 1 um; only the model as it is is fitted."""
    bench = wide(ROWS, seed=21)
    bench = bench if load is None else replace(bench, load=load)
    noise = np.random.default_rng(3).normal(0, 1, ROWS)
    columns = bench.columns(gauge(bench.load, bench.travel) + error + noise)
    return plain_competition(asked, asked.records(folder, columns), UM)


def searched(folder: Path, error: Array) -> Competition:
    """Every single effect that promises anything, fitted."""
    made = competing(folder, error)
    made.forward(made.null, len(made.causes), lambda cause: cause.effect is not None)
    return made


def causes_in(several: list[Fit]) -> set[str]:
    return {cause.tag for found in several for cause in found.causes}


def near(made: Competition, best: Fit) -> list[Fit]:
    return [rival.fit for rival in _rivals(made, best, 1)]


@pytest.mark.parametrize(("name", "curve"), [("lead_error", "travel"), ("clearance", "sign")])
def test_the_score_of_a_cause_that_acts_in_proportion_is_worked_out_by_hand(
    tmp_path: Path, name: str, curve: str
) -> None:
    """n ln(mean square) left, ln n for its number, 2 ln N for the choice of one of N causes."""
    bench = wide(ROWS, seed=21)
    error = 0.03 * bench.travel + 2 * np.sign(bench.load)
    made = competing(tmp_path, error)
    values = error + np.random.default_rng(3).normal(0, 1, ROWS)
    column = {"travel": bench.travel, "sign": np.sign(bench.load)}[curve]
    left = values - column * (column @ values) / (column @ column)
    expected = ROWS * np.log(np.mean(left**2)) + np.log(ROWS) + 2 * np.log(len(made.causes))
    assert_allclose(made.score(fit_of(made, name)), expected, rtol=0, atol=1e-3)
    assert_allclose(made.score(made.null), ROWS * np.log(np.mean(values**2)), rtol=1e-9)
    both = fit_of(made, "lead_error", "clearance")
    design = np.column_stack([bench.travel, np.sign(bench.load)])
    rest = values - design @ np.linalg.lstsq(design, values)[0]
    chosen = 2 * np.log(comb(len(made.causes), 2))
    assert_allclose(made.score(both), ROWS * np.log(np.mean(rest**2)) + 2 * np.log(ROWS) + chosen, rtol=0, atol=1e-3)


def test_a_number_at_its_bound_costs_as_much_as_a_sign_of_a_wrong_cause(tmp_path: Path) -> None:
    """700 um of a clearance where 500 were declared: score and cost differ by the price and one margin."""
    bench = wide(ROWS, seed=21)
    made = competing(tmp_path, 700 * np.sign(bench.load))
    found = fit_of(made, "clearance")
    left = 200 * np.sign(bench.load) + np.random.default_rng(3).normal(0, 1, ROWS)
    expected = ROWS * np.log(np.mean(left**2)) + np.log(ROWS) + 2 * np.log(len(made.causes)) + MARGIN
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
    made = plain_competition(asked, asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel))), UM)
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


def test_a_rival_stays_open_where_the_rows_contradict_one_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = searched(tmp_path, 0.012 * wide(ROWS, seed=21).travel)
    best = fit_of(made, "lead_error")
    behind = sorted(made.score(found) - made.score(best) for found in made.ranked(lambda each: len(each.causes) == 1))
    assert behind[0] == 0
    assert CLOSE < behind[1] < 60
    assert _rivals(made, best, 1) == []
    monkeypatch.setattr(choice, "unsure", lambda one, other: 1.01 * behind[1] / SURE)
    (open_one,) = _rivals(made, best, 1)
    assert open_one.behind == pytest.approx(behind[1])


def test_nothing_has_no_rivals(tmp_path: Path) -> None:
    made = searched(tmp_path, np.zeros(ROWS))
    assert _rivals(made, made.null, 1) == []


def test_what_acts_beside_the_winner_is_no_rival(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two causes draw two curves: each alone leaves the other, so that neither stands for it, however near they are."""
    bench = wide(ROWS, seed=21)
    monkeypatch.setattr(choice, "unsure", lambda one, other: 1e6)
    made = searched(tmp_path, 0.01 * bench.travel + 1.6 * np.sign(bench.load))
    one = fit_of(made, "lead_error")
    assert "clearance" in causes_in(near(made, one))
    fit_of(made, "lead_error", "clearance")
    assert "clearance" not in causes_in([found for found in near(made, one) if len(found.causes) == 1])


# What may as well be zero


@pytest.mark.parametrize(("worth", "stays"), [(SURELY - 5, False), (SURELY + 5, True)])
def test_an_effect_without_which_much_is_lost_stays_although_its_interval_holds_zero(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, worth: float, stays: bool
) -> None:
    made = competing(tmp_path, 0.05 * wide(ROWS, seed=21).travel + 1)
    best = fit_of(made, "lead_error", "sensor_offset")
    scores = {best.key: 0.0, best.key - {best.causes[1].tag}: worth, best.key - {best.causes[0].tag}: 1e3}
    monkeypatch.setattr(made, "score", lambda found: scores.get(found.key, 2e3))
    monkeypatch.setattr(choice, "may_be_zero", lambda found, certainty, cause: cause.name == "sensor_offset")
    assert (len(_certain(made, best).causes) == 2) is stays


# Vaguer words


def shaped(made: Competition, tag: str) -> Fit:
    """One shape that nobody registered, fitted."""
    (cause,) = (each for each in made.causes if each.tag == f"unknown:{tag}:deflection")
    *_, found = made.fit_each(beside(made.null, cause, made.look(made.null, [cause])[cause.tag].starts))
    assert found is not None
    return found


def test_a_shape_is_vaguer_that_draws_98_percent_of_what_the_winner_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parabola holds a line and no jump of the same covariate; how much of the jump it draws is a projection."""
    bench = wide(ROWS, seed=21)
    made = competing(tmp_path, 0.05 * bench.travel + 5 * np.sign(bench.load))
    lead, jump = fit_of(made, "lead_error"), fit_of(made, "clearance")
    travel, load = shaped(made, "trend.3:travel"), shaped(made, "trend.3:load")
    assert _is_vaguer(made, lead, travel)
    assert not _is_vaguer(made, lead, load)
    assert not _is_vaguer(made, jump, load)
    sign, powers = np.sign(bench.load), np.column_stack([bench.load**power for power in range(3)])
    rest = sign - powers @ np.linalg.lstsq(powers, sign)[0]
    share = 1 - float(rest @ rest / (sign @ sign))
    assert share < TWIN
    for wanted, is_vaguer in ((share - 1e-3, True), (share + 1e-3, False)):
        monkeypatch.setattr(choice, "TWIN", wanted)
        assert _is_vaguer(made, jump, load) is is_vaguer


def test_shapes_over_the_same_covariates_say_the_same(tmp_path: Path) -> None:
    bench = wide(ROWS, seed=21)
    made = competing(tmp_path, 9 * ((bench.travel - 150) / 150) ** 4 + 5 * np.sign(bench.load))
    low, high, other = (shaped(made, tag) for tag in ("trend.3:travel", "trend.5:travel", "trend.3:load"))
    assert _says_the_same(low, high)
    assert _is_vaguer(made, high, low)
    assert not _says_the_same(low, other)
    assert not _is_vaguer(made, low, other)
    lead, jump = fit_of(made, "lead_error"), fit_of(made, "clearance")
    assert not _says_the_same(lead, lead)  # nothing registered is vague
    assert not _says_the_same(lead, jump)
    assert not _says_the_same(low, lead)
    beside = replace(low, causes=(*low.causes, *jump.causes), values=(*low.values, *jump.values))
    assert not _says_the_same(low, beside)
    assert _says_the_same(beside, replace(beside, causes=(*high.causes, *jump.causes)))


# What may be there as well


@pytest.mark.parametrize(
    ("above", "carried", "is_told"),
    [(0.05, 1.1, True), (0.2, 1.1, False), (0.05, 0.9, False)],
    ids=["told", "chance", "predicts nothing"],
)
def test_one_more_cause_may_be_there_where_chance_seldom_gives_as_much(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, above: float, carried: float, is_told: bool
) -> None:
    """``above`` is the share of simulated searches that gain more from noise."""
    bench = wide(ROWS, seed=21)
    made = searched(tmp_path, 0.012 * bench.travel)
    best, more = fit_of(made, "lead_error"), fit_of(made, "lead_error", "wear")
    gain = made.score(best) - made.score(more)
    simulated = gain + np.where(np.arange(100) < 100 * above, 1.0, -1.0)
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(simulated, above))
    monkeypatch.setattr(choice, "carries_over", lambda *_: carried)
    told = [found.key for found in near(made, best) if best.key < found.key]
    assert told == ([more.key] if is_told else [])


def test_what_explains_as_much_in_the_place_of_the_winner_is_not_told_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.full(100, -1e9), 0.01))
    monkeypatch.setattr(choice, "carries_over", lambda *_: 9.0)
    bench = wide(ROWS, seed=21)
    made = searched(tmp_path, 0.012 * bench.travel + 1.6 * np.sign(bench.load))
    best, _, both = (fit_of(made, *names) for names in (["lead_error"], ["clearance"], ["lead_error", "clearance"]))
    assert both.key in {found.key for found in near(made, best)}
    monkeypatch.setattr(choice, "CLOSE", 1e6)
    monkeypatch.setattr(choice, "_is_near", lambda made, best, found: found.key == frozenset(["clearance"]))
    assert {found.key for found in near(made, best)} == {frozenset(["clearance"])}


def test_of_shapes_that_say_the_same_the_one_stands_that_leaves_a_name_most(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parabola over the travel takes a lead, a wave over it does not; both draw what was hidden beside it."""
    bench = wide(ROWS, seed=21)
    made = searched(tmp_path, 0.02 * bench.travel + 3 * np.sin(bench.travel / 40))
    lead = fit_of(made, "lead_error")
    both = {}
    for cause in made.causes:
        if cause.tag in {"unknown:trend.3:travel:deflection", "unknown:wave:travel:deflection"}:
            *_, joined = made.fit_each(beside(lead, cause, made.look(lead, [cause])[cause.tag].starts))
            assert joined is not None
            assert cause.shape is not None
            both[cause.shape.kind] = joined
    assert choice._worth_of_names(made, both["wave"]) > choice._worth_of_names(made, both["trend"])
    near = {found.key: 0.0 for found in both.values()}
    score = made.score
    monkeypatch.setattr(made, "score", lambda found: near.get(found.key, score(found)))
    assert choice._taking_least(made, both["trend"]).key == both["wave"].key
    near[both["wave"].key] = CLOSE + 1
    assert choice._taking_least(made, both["trend"]).key == both["trend"].key
