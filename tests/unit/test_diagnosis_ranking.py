"""What comes first where rounding alone parts two explanations: never what the processor says."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked, Deflection, Drive, drive, drive_model, wide

from truing import Effect, Float, Model, Unknown
from truing.diagnosis.competition import Competition, search
from truing.diagnosis.noise import spread_of
from truing.diagnosis.ranking import SAME, lowest_first
from truing.report.diagnosis_chapters import _sizes

BENCH = wide(60, seed=3)
LAST_DIGITS = [-1e-10, 0.0, 1e-10]


def zero_shift(screw: Drive, base: Deflection, *, level: Float) -> Deflection:
    """Show the same too much everywhere, as an offset of the gauge does."""
    return Deflection(deflection=base.deflection + level)


def twins(folder: Path, off: float, monkeypatch: pytest.MonkeyPatch) -> Competition:
    """An offset of the gauge and an effect that draws its curve, which pays so much more, on a record with both."""
    shift = Effect("zero_shift", on_results=zero_shift, unknowns=[Unknown("level", -1000, 1000, "um")])
    model = Model(name="drive", title="Deflection of a screw drive", function=drive, errors=[shift])
    made = Asked(model).competing(folder, BENCH.shown(5 + np.random.default_rng(3).normal(0, 1, len(BENCH))))
    made.causes = tuple(cause for cause in made.causes if cause.name in {"zero_shift", "sensor_offset"})
    assert [cause.name for cause in made.causes] == ["zero_shift", "sensor_offset"]
    price_of = made.price_of
    monkeypatch.setattr(made, "price_of", lambda cause: price_of(cause) + off * (cause.name == "zero_shift"))
    return made


@pytest.mark.parametrize("off", LAST_DIGITS)
def test_of_causes_of_one_curve_the_weakest_is_fitted_first_however_scores_are_rounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    made = twins(tmp_path, off, monkeypatch)
    promising = made.promising(made.look(made.null))
    assert [cause.name for cause in promising] == ["sensor_offset", "zero_shift"]


@pytest.mark.parametrize("off", LAST_DIGITS)
def test_explanations_of_one_curve_are_ranked_by_name_however_scores_are_rounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    """Nor does it matter which of the two was fitted first."""
    made = twins(tmp_path, off, monkeypatch)
    search(made)
    alone = [fit for fit in made.known.values() if len(fit.causes) == 1]
    assert abs(made.score(alone[0]) - made.score(alone[1])) < SAME
    for several in (alone, alone[::-1]):
        made.known = {fit.key: fit for fit in (made.null, *several)}
        assert [fit.names for fit in made.ranked()[:2]] == [("sensor_offset",), ("zero_shift",)]
        best = made.best(1)
        assert best is not None
        assert best.names == ("sensor_offset",)
        assert made.fairest.names == ("sensor_offset",)


@pytest.mark.parametrize(("gained", "is_kept"), [(0.0, False), (1e-10, False), (2 * SAME, True)])
def test_of_two_ways_to_one_explanation_the_first_gives_the_name_unless_the_other_is_better(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gained: float, is_kept: bool
) -> None:
    made = twins(tmp_path, 0.0, monkeypatch)
    ones = (np.ones(1), np.ones(1))
    first = made.keep(replace(made.null, causes=made.causes, values=ones))
    assert first is not None
    other = replace(first, causes=first.causes[::-1], cost=first.cost - gained)
    kept = made.keep(other)
    assert kept is (other if is_kept else first)


@pytest.mark.parametrize("worth", [0.0, 0.5 * SAME, 3.1415925, -740.25, 1e6])
@pytest.mark.parametrize("off", LAST_DIGITS)
def test_equals_stand_by_place_and_then_as_they_came(worth: float, off: float) -> None:
    """Wherever the score lies: an order by rounded scores would have an edge where the last digits decide."""
    scores = {"b": worth + off, "a": worth, "c": worth + 2 * SAME, "best": worth - 1.0}
    assert lowest_first(scores, scores.__getitem__, str) == ["best", "a", "b", "c"]
    assert lowest_first(scores, scores.__getitem__) == ["best", "b", "a", "c"]


def test_a_row_of_near_scores_is_not_one_score() -> None:
    """What counts is the distance from the best of them: else many small steps would make one place of all."""
    scores = [step * 0.6 * SAME for step in range(6)]
    assert lowest_first(scores, float, lambda score: -score) == [scores[i] for i in (1, 0, 3, 2, 5, 4)]


def test_what_has_no_finite_score_comes_last() -> None:
    scores = [inf, 2.0, inf, 1.0, -inf]
    assert lowest_first(range(5), scores.__getitem__, lambda index: -index) == [4, 3, 1, 2, 0]
    assert lowest_first([], float) == []


def test_of_drivers_that_are_one_the_first_is_named() -> None:
    """A speed in other units, from another zero: the correlations differ in their last digits, either way."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        speed = rng.uniform(1, 10, 80)
        left = speed * rng.normal(0, 1, 80)
        drivers = {"speed": speed, "turns": 9.5 * speed - 0.3}
        for names in (["speed", "turns"], ["turns", "speed"]):
            assert spread_of(left, {name: drivers[name] for name in names}).driver == names[0]


def test_of_inputs_that_moved_as_far_the_first_is_told_first(tmp_path: Path) -> None:
    """Two deviations of one sum: what rounds in the fit of the one rounds otherwise in that of the other."""
    made = Asked(drive_model([])).diagnosed(tmp_path, BENCH.shown(np.random.default_rng(3).normal(0, 1, len(BENCH))))
    for off in LAST_DIGITS:
        moved = tuple(
            replace(each, of_its_sd=sign * (0.5 + move))
            for each, sign, move in zip(made.calibrated, (-1, 1), (0.0, off), strict=True)
        )
        said = list(_sizes(replace(made, calibrated=moved)))
        assert said[-1].endswith("contact (well inside) and shaft (well inside)")
