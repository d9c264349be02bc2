"""From an explanation to one cause more: what may follow it, and what is believed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, cause_of, drive_model, fit_of, gauge, plain_competition, wide
from numpy.testing import assert_allclose

from truing.diagnosis import choice
from truing.diagnosis.causes import Candidate
from truing.diagnosis.choice import (
    FURTHER_LEVEL,
    LEAST_IN_PLACE,
    MANY_CURVES,
    Law,
    _beats,
    _best,
    _candidates,
    _step,
    shapes_in,
)
from truing.diagnosis.competition import UNREGISTERED, Competition, Start, beside
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import ends_of, folds_of

ROWS = 150
BENCH = wide(ROWS, seed=51)
NOISE = np.random.default_rng(51).normal(0, 1, ROWS)
LINE = (BENCH.travel - 150) / 150
WAVE = 2 * np.pi * 9 * np.arange(ROWS) / ROWS


def competing(folder: Path, error: Array) -> Competition:
    """The effects of a drive on a record of BENCH with an error (um) and noise of 1 um; nothing searched."""
    one = Asked(drive_model(tolerances={}))
    return plain_competition(
        one, one.records(folder, BENCH.columns(gauge(BENCH.load, BENCH.travel) + error + NOISE)), UM
    )


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


def names_of(several: list[Fit]) -> list[list[str]]:
    return [[cause.name for cause in found.causes] for found in several]


# What stands in the place of a polynomial


def drawn_share(error: Array) -> float:
    """The share of what a parabola of the travel takes away that a lead takes away, by least squares."""
    values = error + NOISE
    whole = np.column_stack([np.ones(ROWS), LINE, LINE**2])
    left = [np.sum((values - each @ np.linalg.lstsq(each, values)[0]) ** 2) for each in (BENCH.travel[:, None], whole)]
    return float((values @ values - left[0]) / (values @ values - left[1]))


@pytest.mark.parametrize(("bend", "is_enough"), [(6.0, True), (40.0, False)])
def test_an_effect_of_the_model_that_draws_nearly_all_stands_before_a_polynomial(
    tmp_path: Path, bend: float, is_enough: bool
) -> None:
    """A lead and a bend: the parabola is far better, and of what it takes away the lead takes 98 % or does not."""
    error = 0.3 * BENCH.travel + bend * (LINE**2 - 1 / 3)
    share = drawn_share(error)
    assert (share >= 0.98) is is_enough
    made = competing(tmp_path, error)
    lead, trend = fit_of(made, "lead_error"), shape(made, "trend.3:travel")
    assert made.score(trend) < made.score(lead) - 50
    offered = list(_candidates(made, made.null, 1))
    assert [found.key for found in offered] == ([lead.key] if is_enough else []) + [trend.key]


def test_what_the_gauge_has_of_its_own_stands_in_the_place_of_no_polynomial(tmp_path: Path) -> None:
    """An offset of the gauge, which every model has, is no better word than a shape."""
    made = competing(tmp_path, 30 + 6 * LINE**2)
    gauge_fit, trend = fit_of(made, "sensor_offset"), shape(made, "trend.3:travel")
    assert made.score(trend) < made.score(gauge_fit)
    assert [found.key for found in _candidates(made, made.null, 1)] == [trend.key]


def test_a_shape_is_what_is_left_beside_an_effect_that_draws_nearly_all(tmp_path: Path) -> None:
    """Beside the lead no two causes without it follow, however good: the bend comes beside it."""
    made = competing(tmp_path, 0.3 * BENCH.travel + 6 * (LINE**2 - 1 / 3))
    lead = fit_of(made, "lead_error")
    without = shape(made, "trend.3:travel", at=fit_of(made, "clearance"))
    assert made.score(without) < made.score(lead) - 50
    (more,) = _candidates(made, lead, 2)
    assert more.key > lead.key
    assert shapes_in(more) == 1


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


def test_beside_a_cause_with_a_name_there_is_one_shape_at_most(tmp_path: Path) -> None:
    """A second shape fits the bend, and would take from what the clearance draws."""
    made = competing(tmp_path, 9 * LINE**2 + 8 * np.sin(WAVE))
    beside = shape(made, "wave:time", at=fit_of(made, "clearance"))
    second = shape(made, "trend.3:travel", at=beside)
    assert made.score(second) < made.score(beside)
    best = _best(made, beside, 3)
    assert best is None or best.key != second.key


# What a step must be better by


@dataclass
class Stated:
    """A competition of which the scores are stated."""

    scores: Mapping[frozenset[str], float]
    sample: Any = None
    extended: Any = None
    tries: Mapping[str, float] = field(default_factory=dict)

    def score(self, found: Fit) -> float:
        return self.scores[found.key]

    own_score = score

    def without(self, found: Fit, place: int) -> None:
        return None


def of_causes(made: Competition, *names: str) -> Fit:
    """An explanation by name, its numbers left open: for where scores are stated."""
    causes = tuple(cause_of(made, name) for name in names)
    return replace(made.null, causes=causes, values=tuple(np.ones(cause.size) for cause in causes))


@pytest.mark.parametrize(
    ("before", "after", "least"),
    [
        (["lead_error"], ["lead_error", "wear"], choice.WANDER),
        (["lead_error"], ["clearance", "wear"], LEAST_IN_PLACE),
        (["lead_error"], ["wear"], choice.WANDER),
        ([], ["wear"], 0.0),
    ],
    ids=["one more", "more in its place", "another in its place", "the first"],
)
def test_what_comes_beside_a_cause_or_takes_its_place_must_be_better_than_noise_with_a_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: list[str], after: list[str], least: float
) -> None:
    made = competing(tmp_path, 0.0 * LINE)
    at, more = of_causes(made, *before), of_causes(made, *after)
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.zeros(299), 1 / 300))
    monkeypatch.setattr(choice, "carries_over", lambda *_: 99.0)
    folds: Any = None
    for gain, is_believed in ((least - 0.1, False), (least + 0.1, True)):
        stated: Any = Stated({at.key: gain, more.key: 0.0})
        assert _step(stated, at, more, folds, seed=1).is_believed is is_believed
    assert LEAST_IN_PLACE > choice.WANDER  # or the case above says nothing


@pytest.mark.parametrize(
    ("p_value", "carried", "is_believed"), [(0.003, 1.1, True), (0.02, 9, False), (0.003, 0.9, False)]
)
def test_a_further_cause_must_pass_chance_and_carry_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, p_value: float, carried: float, is_believed: bool
) -> None:
    made = competing(tmp_path, 0.0 * LINE)
    at, more = of_causes(made, "lead_error"), of_causes(made, "lead_error", "wear")
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.zeros(299), p_value))
    monkeypatch.setattr(choice, "carries_over", lambda *_: carried)
    stated: Any = Stated({at.key: 30.0, more.key: 0.0})
    folds: Any = None
    assert FURTHER_LEVEL < 0.02
    assert _step(stated, at, more, folds, seed=1).is_believed is is_believed


@pytest.mark.parametrize(
    ("before", "after", "carried", "is_believed"),
    [
        (["clearance"], ["lead_error"], 0.1, True),
        (["clearance"], ["lead_error"], -0.1, False),
        (["lead_error"], ["clearance", "wear"], 0.9, False),
        (["lead_error"], ["clearance", "wear"], 1.1, True),
    ],
    ids=["exchanged", "exchanged, and worse", "more numbers", "more numbers that predict"],
)
def test_only_what_adds_numbers_must_predict_better(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: list[str], after: list[str], carried: float,
    is_believed: bool,
) -> None:  # fmt: skip
    """What is exchanged for no more numbers is judged by its score, and may not predict worse."""
    made = competing(tmp_path, 0.0 * LINE)
    at, more = of_causes(made, *before), of_causes(made, *after)
    monkeypatch.setattr(choice, "law_of", lambda *_, seed: Law(np.zeros(299), 1 / 300))
    monkeypatch.setattr(choice, "carries_over", lambda *_: carried)
    stated: Any = Stated({at.key: 30.0, more.key: 0.0})
    folds: Any = None
    assert _step(stated, at, more, folds, seed=1).is_believed is is_believed


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
    for carried, is_beat in ((1.9, True), (2.1, False)):
        asked = []

        def measured(*given: Any, carried: float = carried, asked: list[Any] = asked) -> float:
            asked.append(given[3])
            return carried

        monkeypatch.setattr(choice, "carries_over", measured)
        assert _beats(made, one, both) is is_beat
        (ends,) = asked
        assert ends.count == 2
        assert_allclose(ends.block_of, ends_of(made.sample).block_of)
        assert not _beats(made, made.null, one)
        made.tries.update({cause.tag: MANY_CURVES - 1.0 for cause in both.causes if cause.tag not in one.key})
        assert not _beats(made, one, both)
        made.tries.update({cause.tag: MANY_CURVES + 1.0 for cause in both.causes})


def test_a_wave_that_is_there_carries_over_to_the_ends(tmp_path: Path) -> None:
    made, one, both = waves(tmp_path, 8 * np.sin((BENCH.temperature - 15) / 3))
    assert not _beats(made, one, both)
    false, one, both = waves(tmp_path, 0.0 * LINE)
    assert _beats(false, one, both)


def test_the_ends_are_the_first_and_the_last_quarter_of_every_run(tmp_path: Path) -> None:
    one = Asked(drive_model(tolerances={}))
    columns = BENCH.columns(gauge(BENCH.load, BENCH.travel))
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


def test_two_parabolas_pay_for_no_constant_that_only_their_sum_shows(tmp_path: Path) -> None:
    warm = (BENCH.temperature - BENCH.temperature.mean()) / np.ptp(BENCH.temperature)
    made = competing(tmp_path, 9 * LINE**2 + 36 * warm**2)
    pair = [shape(made, f"trend.3:{name}") for name in ("travel", "temperature")]
    both = made.fit_each([Start(pair[0].causes + pair[1].causes, pair[0].values + pair[1].values, None)])[0]
    assert both is not None
    assert made.score(both) < min(made.score(each) for each in pair) - 50


def test_folds_and_ends_leave_rows_out_that_judge_only(tmp_path: Path) -> None:
    made = competing(tmp_path, 0.0 * LINE)
    few = made.sample.of_rows(np.arange(ROWS) < 100)
    for folds in (folds_of(few), ends_of(few)):
        assert (folds.block_of[100:] == -1).all()
        assert (folds.block_of[:100] >= 0).any()


def test_the_order_of_a_file_without_an_order_leaves_the_folds_as_they_are(tmp_path: Path) -> None:
    """The rows that are left out together are the same in a shuffled file."""
    order = np.random.default_rng(9).permutation(ROWS)
    marked = []
    for place, rows in enumerate((np.arange(ROWS), order)):
        columns = BENCH.columns(gauge(BENCH.load, BENCH.travel) + NOISE)
        columns = {name: values[rows] for name, values in columns.items() if name != "time"}
        folder = tmp_path / str(place)
        folder.mkdir()
        one = Asked(drive_model(tolerances={}))
        made = plain_competition(one, one.records(folder, columns), UM)
        folds = folds_of(made.sample)
        marked.append({float(columns["travel"][row]): int(folds.block_of[row]) % folds.count for row in range(ROWS)})
    assert marked[0] == marked[1]
    assert set(marked[0].values()) == set(range(5))
