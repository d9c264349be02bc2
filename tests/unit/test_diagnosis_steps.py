"""From an explanation to one cause more: what may follow it, and what is believed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, cause_of, drive_model, fit_of, gauge, plain_competition, wide
from numpy.testing import assert_allclose

from truing.diagnosis import steps
from truing.diagnosis.causes import Candidate
from truing.diagnosis.chance import Law
from truing.diagnosis.competition import UNREGISTERED, Competition
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import ends_of, folds_of
from truing.diagnosis.steps import (
    LEAST_IN_PLACE,
    MANY_CURVES,
    WANDER,
    _beats,
    _best,
    _candidates,
    _step,
)

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
        joined = made.joined(found, cause, made.look(found, [cause])[cause.tag].starts)
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
    monkeypatch.setattr(steps, "law_of", lambda *_, seed: Law(np.zeros(299), p_value))
    monkeypatch.setattr(steps, "carries_over", lambda *_: carried)
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
    for carried, is_beat in ((1.9, True), (2.1, False)):
        asked = []

        def measured(*given: Any, carried: float = carried, asked: list[Any] = asked) -> float:
            asked.append(given[3])
            return carried

        monkeypatch.setattr(steps, "carries_over", measured)
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
    both = made.fitted(pair[0].causes + pair[1].causes, pair[0].values + pair[1].values, None)
    assert both is not None
    assert made.score(both) < min(made.score(each) for each in pair) - 50


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
