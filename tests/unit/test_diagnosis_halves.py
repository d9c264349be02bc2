"""Whether the two halves of a record say the same: sizes of a cause in each, by least squares."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, chosen_as, drive_model, fit_of, gauge, name_sets, plain_competition, wide
from numpy.testing import assert_allclose

from truing.diagnosis.choice import Chosen
from truing.diagnosis.gain import CONTRADICTING, FEWEST_PER_NUMBER, contradictions_of

ROWS = 160
BENCH = wide(ROWS, seed=41)
NOISE = np.random.default_rng(41).normal(0, 1, ROWS)
IS_LATE = np.arange(ROWS) >= ROWS // 2
LEAD = 0.05
"""um/mm."""


def lead_of(error: Array, rows: Array) -> tuple[float, float]:
    """The lead that some rows say by least squares, and its standard error."""
    travel, own = BENCH.travel[rows], error[rows]
    size = travel @ own / (travel @ travel)
    return size, float(np.std(own - size * travel) / np.linalg.norm(travel))


def changing(by: float) -> Array:
    """An error whose lead differs between the halves, as they are measured, by so many standard errors."""
    error = LEAD * BENCH.travel + NOISE
    (first, one), (second, two) = (lead_of(error, rows) for rows in (~IS_LATE, IS_LATE))
    return np.asarray(error + np.where(IS_LATE, by * np.hypot(one, two) - (second - first), 0) * BENCH.travel)


def taken(folder: Path, error: Array, rows: Array | slice = slice(None)) -> Chosen:
    """The lead as if it had been chosen."""
    one = Asked(drive_model(["lead_error"], {}))
    columns = BENCH.columns(gauge(BENCH.load, BENCH.travel) + error)
    records = one.records(folder, {name: column[rows] for name, column in columns.items()})
    made = plain_competition(one, records, UM)
    return chosen_as(made, fit_of(made, "lead_error"))


@pytest.mark.parametrize(
    ("by", "is_apart"), [(0.0, False), (0.7 * CONTRADICTING, False), (1.4 * CONTRADICTING, True), (30.0, True)]
)
def test_halves_contradict_where_a_size_differs_by_more_than_four_standard_errors(
    tmp_path: Path, by: float, is_apart: bool
) -> None:
    error = changing(by)
    found = contradictions_of(taken(tmp_path, error))
    assert bool(found) is is_apart
    for each in found:
        assert (each.effect, each.unknown, each.first.unit) == ("lead_error", "lead", "um/mm")
        by_hand = [lead_of(error, rows)[0] * 1e-3 for rows in (~IS_LATE, IS_LATE)]
        assert_allclose([each.first.value, each.second.value], by_hand, rtol=1e-3)


def test_halves_of_few_rows_say_nothing(tmp_path: Path) -> None:
    """Ten rows for the one number in either half."""
    error, middle = changing(60.0), ROWS // 2
    for rows, is_told in ((2 * FEWEST_PER_NUMBER - 2, False), (2 * FEWEST_PER_NUMBER, True)):
        around = slice(middle - rows // 2, middle + rows // 2)
        assert bool(contradictions_of(taken(tmp_path, error, around))) is is_told


def test_rows_without_an_order_are_parted_at_random(tmp_path: Path) -> None:
    """What changes from the first rows of a file to the last means nothing where rows have no order."""
    chosen = taken(tmp_path, changing(30.0))
    machine = chosen.best.sample.machine
    timeless = {name: item for name, item in machine.records.covariates.items() if item.role != "time"}
    unordered = replace(machine, records=replace(machine.records, covariates=timeless))
    best = replace(chosen.best, sample=replace(chosen.best.sample, machine=unordered))
    assert contradictions_of(chosen)
    assert contradictions_of(replace(chosen, best=best)) == ()


def test_shapes_and_the_model_as_it_is_have_no_halves(tmp_path: Path) -> None:
    chosen = taken(tmp_path, changing(30.0))
    assert contradictions_of(replace(chosen, best=chosen.null)) == ()


def test_consistent_halves_leave_a_cause_its_name(tmp_path: Path) -> None:
    one = Asked(drive_model(["lead_error", "clearance"], {}))
    error = LEAD * BENCH.travel + NOISE
    found = one.diagnosed(tmp_path, BENCH.columns(gauge(BENCH.load, BENCH.travel) + error))
    assert (name_sets(found), found.contradictions, found.verdict) == ([{"lead_error"}], (), "named")
    (wrong,) = found.wrong  # of its mean square all but the noise can go
    assert_allclose(wrong.reducible_share, 1 - (NOISE @ NOISE) / (error @ error), rtol=0, atol=0.002)


def test_contradicting_halves_take_a_cause_its_name(tmp_path: Path) -> None:
    one = Asked(drive_model(["lead_error", "clearance"], {}))
    found = one.diagnosed(tmp_path, BENCH.columns(gauge(BENCH.load, BENCH.travel) + changing(5.0)))
    assert name_sets(found) == [{"lead_error"}]
    (said,) = found.contradictions
    assert said.effect == "lead_error"
    assert any("in one half of the rows" in warning for warning in found.warnings)
    assert found.verdict != "named"
    alone = replace(found, alternatives=())
    assert alone.verdict == "undecided"
    assert replace(alone, contradictions=()).verdict == "named"
