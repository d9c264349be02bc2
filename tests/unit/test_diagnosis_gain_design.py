"""What an extension is worth, how small an effect may be to be seen, and where to measure next."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, decided, drive_model, gauge, names_of_piece, plain_contest, wide
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import toeplitz
from scipy.stats import binom, kstest, norm
from scipy.stats import t as student

from truing.diagnosis.contest import Contest
from truing.diagnosis.design import MOST_POINTS, POINTS, Proposal, next_points
from truing.diagnosis.engine import diagnose
from truing.diagnosis.gain import FOLDS, SHORTEST_BLOCK, _log_density, blocks_of, nested, sign_flip_p
from truing.diagnosis.noise import SETTINGS
from truing.diagnosis.search import first_noise, residuals_of
from truing.diagnosis.verdict import APART
from truing.diagnosis.visibility import needed, smallest_visible
from truing.setup import DiagnoseOptions

WHITE = (0,)


def test_a_gain_by_chance_is_significant_as_often_as_promised() -> None:
    blocks = np.repeat(np.arange(20), 8)
    found = []
    for seed in range(300):
        gain = np.repeat(np.random.default_rng([31, seed]).normal(size=20), 8) / 8
        found.append(sign_flip_p(gain, blocks, seed=seed))
    assert sum(p <= 0.05 for p in found) <= binom.ppf(0.99, 300, 0.05)
    assert sum(p <= 0.05 for p in found) >= binom.ppf(0.01, 300, 0.05)
    below_half = [p for p in found if p < 0.5]  # a loss counts as 1, so only the lower half is uniform
    assert kstest(below_half, "uniform", args=(0, 0.5)).pvalue > 0.01


@pytest.mark.parametrize("blocks", [4, 7])
def test_a_gain_in_every_block_is_as_rare_as_all_signs_alike(blocks: int) -> None:
    gain = np.ones(blocks * 6)
    assert sign_flip_p(gain, np.repeat(np.arange(blocks), 6), seed=1) == 2.0**-blocks
    uneven = gain * np.repeat(np.random.default_rng(blocks).uniform(0.1, 3, blocks), 6)  # sums that are rounded
    assert sign_flip_p(uneven, np.repeat(np.arange(blocks), 6), seed=1) == 2.0**-blocks


def test_of_many_blocks_some_signs_are_drawn() -> None:
    gain = np.random.default_rng(8).normal(0.3, 1, 15)
    every = 1 - 2 * (np.arange(2**15)[:, None] >> np.arange(15) & 1)
    exact = float((every @ gain >= gain.sum() - 1e-12).mean())
    found = sign_flip_p(gain, np.arange(15), seed=1)
    assert_allclose(found, exact, rtol=0, atol=4 * np.sqrt(exact / 999) + 1e-3)


def test_a_loss_a_rounding_and_a_single_block_are_no_gain() -> None:
    blocks = np.repeat(np.arange(5), 4)
    assert sign_flip_p(-np.ones(20), blocks, seed=0) == 1
    assert sign_flip_p(np.full(20, 1e-9), blocks, seed=0) == 1
    assert sign_flip_p(np.ones(20), np.zeros(20, dtype=int), seed=0) == 1
    assert sign_flip_p(np.zeros(20), blocks, seed=0) == 1


def test_rows_that_were_not_judged_and_blocks_without_rows_count_for_nothing() -> None:
    blocks = np.repeat([0, 1, 3, 6], 5)
    gain = np.where(np.arange(20) % 5 == 0, np.nan, 1.0)
    assert_allclose(sign_flip_p(gain, blocks, seed=2), sign_flip_p(np.ones(16), np.repeat(range(4), 4), seed=2))


@pytest.mark.parametrize("freedom", [3.0, 4.0, 10.0, 30.0, inf])
def test_densities_are_of_unit_variance(freedom: float) -> None:
    z = np.linspace(-5, 5, 11)
    law = norm() if freedom >= 30 else student(freedom, scale=np.sqrt((freedom - 2) / freedom))
    assert_allclose(_log_density(z, freedom), law.logpdf(z), rtol=1e-12)


def ready(folder: Path, error: Array, n: int, runs: list[str], **more: Any) -> tuple[Asked, Contest]:
    """A contest with white noise of 1 um on a wide record."""
    bench = wide(n, seed=33)
    asked = Asked(drive_model(**more))
    records = asked.records(folder, bench.columns(gauge(bench.load, bench.travel) + error), runs)
    return asked, plain_contest(asked, records, UM)


@pytest.mark.parametrize(
    ("rho", "rows", "length"), [(0.0, 90, SHORTEST_BLOCK), (0.0, 200, 10), (0.6, 90, 6), (0.95, 300, 30)]
)
def test_folds_are_blocks_of_consecutive_rows_of_one_run(tmp_path: Path, rho: float, rows: int, length: int) -> None:
    """Six rows, a twentieth of the record, or three times 1/ln(1/rho) rows, but no more than a tenth of the record."""
    runs = ["a"] * (rows // 3) + ["b"] * (rows - rows // 3)
    _, full = ready(tmp_path, np.zeros(rows), rows, runs)
    setting = next(place for place, item in enumerate(SETTINGS) if item.rho == rho and item.theta == 0)
    found = blocks_of(full, (setting,))
    run_of = full.problem.machine.records.run_of
    assert_array_equal(np.diff(found) >= 0, True)
    assert set(np.diff(found)) <= {0, 1}
    for block in np.unique(found):
        here = np.flatnonzero(found == block)
        assert_array_equal(np.diff(here), 1)
        assert len(set(run_of[here])) == 1
        assert len(here) == length or run_of[min(here[-1] + 1, rows - 1)] != run_of[here[0]] or here[-1] == rows - 1
    assert np.bincount(found).max() == length


def test_a_short_record_has_shorter_blocks_rather_than_fewer(tmp_path: Path) -> None:
    _, full = ready(tmp_path, np.zeros(24), 24, [])
    assert np.bincount(blocks_of(full, WHITE)).tolist() == [3] * 8


def test_rows_held_out_are_in_no_block_and_no_file_is_left_out_whole(tmp_path: Path) -> None:
    """Of two runs of 60 rows the first 20 of each may be used: blocks of six of these, or of ten and less per file."""
    _, full = ready(tmp_path, np.zeros(120), 120, ["a"] * 60 + ["b"] * 60)
    machine = full.problem.machine
    held = np.arange(120) % 60 >= 20
    there = replace(machine, records=replace(machine.records, held_out=held))
    found = blocks_of(replace(full, problem=replace(full.problem, machine=there)), WHITE)
    assert_array_equal(found < 0, held)
    assert np.bincount(found[~held]).tolist() == [5, 5, 5, 5] * 2
    per_file = replace(there, start=replace(there.start, diagnose=DiagnoseOptions(per_file=("lead_error",))))
    slow = next(place for place, item in enumerate(SETTINGS) if item.rho == 0.95 and item.theta == 0)
    split = blocks_of(replace(full, problem=replace(full.problem, machine=per_file)), (slow,))
    assert all(len(set(split[rows][~held[rows]])) >= 2 for rows in (slice(0, 60), slice(60, 120)))


def test_what_is_judged_was_not_used(tmp_path: Path) -> None:
    """Other values in the rows of one fold change nothing in what is predicted there."""
    rng = np.random.default_rng(34)
    bench = wide(120, seed=33)
    asked, full = ready(tmp_path, 0.03 * bench.travel + rng.normal(0, 1, 120), 120, [])
    _, decision = decided(asked.setup, full.problem.machine.records)
    raw = first_noise(full.problem.machine)
    winner = full.found.best(lambda item: item.kind == "one" and _named(full, item) == "lead_error")
    first = nested(full, winner, decision.thresholds, raw)
    fold = first.block_of % FOLDS == 0
    changed = _with_values(full, np.where(fold, rng.normal(0, 3 * UM, 120), 0.0))
    other = replace(raw, residuals=residuals_of(changed.problem.machine))
    second = nested(changed, winner, decision.thresholds, other)
    assert_array_equal(second.block_of, first.block_of)
    for before in ("before", "after"):
        one, two = (getattr(item.judged["deflection"], before) for item in (first, second))
        measured = [item.problem.machine.records.measured["deflection"] for item in (full, changed)]
        assert_allclose((measured[0] - one)[fold], (measured[1] - two)[fold], rtol=0, atol=1e-9 * UM)
        assert np.abs((measured[0] - one)[~fold] - (measured[1] - two)[~fold]).max() > 1e-3 * UM
    assert np.isfinite(first.judged["deflection"].gain).all()


def _named(full: Contest, item: Any) -> str:
    return names_of_piece(full, item.pieces[0])[0]


def _with_values(full: Contest, added: Array) -> Contest:
    machine = full.problem.machine
    measured = {"deflection": machine.records.measured["deflection"] + added}
    there = replace(machine, records=replace(machine.records, measured=measured))
    return replace(full, problem=replace(full.problem, machine=there))


def test_a_gain_is_held_against_the_calibrated_model_and_the_noise_floor(tmp_path: Path) -> None:
    rng = np.random.default_rng(35)
    bench = wide(200, seed=35)
    contact = np.sign(bench.load) * np.abs(bench.load) ** (2 / 3)
    error = 0.12 * contact + 0.02 * bench.travel + rng.normal(0, 1, 200)  # 0.12 lies inside the tolerance
    asked = Asked(drive_model())
    found = diagnose(asked.setup, asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel) + error)))
    (gain,) = found.gain
    design = np.column_stack([contact, bench.load * bench.travel])
    free = error - design @ np.linalg.lstsq(design, error)[0]
    assert_allclose(gain.rmse_before.value / UM, np.sqrt(np.mean(free**2)), rtol=0.04)
    assert_allclose(gain.noise_floor.value / UM, 1, rtol=0.15)
    assert_allclose(gain.rmse_after.value / UM, 1, rtol=0.15)
    assert gain.reducible_removed > 0.9
    assert gain.p_value <= 0.002
    assert found.stability == 1
    before, after = gain.rmse_before.value, gain.rmse_after.value
    assert_allclose(gain.log_score_gain, np.log(before / after), rtol=0.1)
    assert binom.ppf(0.001, 200, 0.9) <= 200 * gain.coverage90 <= binom.ppf(0.999, 200, 0.9)


@pytest.mark.parametrize("tolerances", [{}, {"contact": "3 %", "zero": "5 um"}])
@pytest.mark.parametrize("place", [0, 4])
def test_the_smallest_visible_size_by_dense_algebra(tmp_path: Path, tolerances: dict[str, str], place: int) -> None:
    bench = wide(60, seed=33)
    _, full = ready(tmp_path, np.zeros(60), 60, [], tolerances=tolerances, effects=("lead_error", "clearance"))
    rho = SETTINGS[place].rho
    assert SETTINGS[place].theta == 0
    seen = {item.name: item for item in smallest_visible(full, (place,))}
    noise = toeplitz(rho ** np.arange(60.0)) / (1 - rho**2)
    contact = np.sign(bench.load) * np.abs(bench.load) ** (2 / 3)
    if tolerances:
        noise = noise + np.outer(0.09 * contact, 0.09 * contact) + 25.0
    owners = {piece.owner for piece in full.problem.term_pieces}
    limit = needed(len(owners) + len(owners) * (len(owners) - 1) // 2)
    for name, curve, unit in (("lead_error", bench.travel, UM / 1e-3), ("clearance", np.sign(bench.load), UM)):
        smallest = np.sqrt(limit / (curve @ np.linalg.solve(noise, curve)))
        found = seen[name].smallest
        assert found is not None
        assert_allclose(found.value, smallest * unit, rtol=1e-5)
        assert seen[name].sight == "visible"


def test_an_offset_the_tolerances_would_take_is_hidden_in_them(tmp_path: Path) -> None:
    _, full = ready(tmp_path, np.zeros(60), 60, [], tolerances={"zero": "50 um"})
    sight = {item.name: item.sight for item in smallest_visible(full, WHITE)}
    assert sight["sensor_offset"] == "hidden in the tolerances"
    assert sight["clearance"] == "visible"


@pytest.mark.parametrize(("noise", "sight"), [(0.8, "visible"), (1.2, "not excited")])
def test_a_bound_below_the_smallest_visible_size_is_not_excited(tmp_path: Path, noise: float, sight: str) -> None:
    """Of 60 rows with this noise a clearance shows from sqrt(limit / 60) of it; 500 um are the largest it may be."""
    bench = wide(60, seed=33)
    asked = Asked(drive_model(("clearance",), {}))
    records = asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel)))
    causes = len({piece.owner for piece in plain_contest(asked, records, UM).problem.term_pieces})
    limit = needed(causes + causes * (causes - 1) // 2)
    loud = plain_contest(asked, records, noise * 500 * UM * np.sqrt(60 / limit))
    seen = {item.name: item for item in smallest_visible(loud, WHITE)}
    assert seen["clearance"].smallest is not None
    assert_allclose(seen["clearance"].smallest.value, noise * 500 * UM, rtol=1e-9)
    assert seen["clearance"].sight == sight


def one_sign(folder: Path, box: dict[str, tuple[float, float]], noise: float = 1.0) -> tuple[Contest, int, Array]:
    """A clearance of 3 um under a load of one sign: the offset is the same curve."""
    bench = wide(40, seed=36)
    bench = replace(bench, load=np.abs(bench.load) + 1)
    asked = Asked(drive_model(("clearance",), {}))
    columns = bench.columns(gauge(bench.load, bench.travel) + 3 + 0.1 * np.random.default_rng(36).normal(size=40))
    full = plain_contest(asked, asked.records(folder, columns), noise * UM)
    start = replace(full.problem.machine.start, diagnose=DiagnoseOptions(box=box))
    full = replace(full, problem=replace(full.problem, machine=replace(full.problem.machine, start=start)))
    return full, full.found.best(lambda item: item.kind == "one" and _named(full, item) == "sensor_offset"), bench.load


def test_the_separation_that_is_promised_is_that_of_a_refit_with_the_points_added(tmp_path: Path) -> None:
    full, winner, _ = one_sign(tmp_path, {"load": (-10e3, 20e3)})
    size = float(full.solution(winner).coefficients[0]) * full.problem.columns[0].per / UM
    points = next_points(full, winner, []).points
    assert len(points) == POINTS
    for count, point in enumerate(points, start=1):
        assert set(point.separates) == {"sensor_offset", "clearance"}
        assert -10e3 <= point.settings["load"].value < 0
        signs = np.array([1.0] * 40 + [-1.0] * count)  # of the load: clearance turns round, an offset does not
        offset = np.full(40 + count, abs(size))
        left = offset - signs * (signs @ offset) / (signs @ signs)
        assert_allclose(point.separation, left @ left, rtol=1e-4)


def test_where_no_setting_separates_two_causes_none_is_proposed(tmp_path: Path) -> None:
    full, winner, load = one_sign(tmp_path, {"load": (1e3, 20e3)})
    assert load.min() > 0
    assert next_points(full, winner, []) == Proposal((), (("sensor_offset", "clearance"),))


def test_rivals_are_separated_inside_the_box(tmp_path: Path) -> None:
    bench = wide(80, seed=37)
    narrow = replace(bench, travel=140 + bench.travel / 15)
    asked = Asked(drive_model(("lead_error",), {}))
    error = 0.01 * narrow.travel + np.random.default_rng(37).normal(0, 0.5, 80)
    full = plain_contest(asked, asked.records(tmp_path, narrow.columns(gauge(narrow.load, narrow.travel) + error)), UM)
    start = replace(full.problem.machine.start, diagnose=DiagnoseOptions(box={"travel": (0.0, 0.3)}))
    full = replace(full, problem=replace(full.problem, machine=replace(full.problem.machine, start=start)))
    winner, rival = (
        full.found.best(lambda item, name=name: item.kind == "one" and _named(full, item) == name)
        for name in ("lead_error", "sensor_offset")
    )
    points = next_points(full, winner, [rival]).points
    assert points
    travel = [point.settings["travel"].value for point in points]
    assert all(-1e-12 <= value <= 0.3 + 1e-12 for value in travel)
    outside = [value for value in travel if not 0.14 <= value <= 0.16]
    assert len(outside) == len(travel)
    assert [point.separation for point in points] == sorted(point.separation for point in points)


@pytest.mark.parametrize("size", [3.0, 0.8, 0.3, 0.05])
def test_it_is_said_how_many_points_would_be_needed(tmp_path: Path, size: float) -> None:
    """After 40 rows of one sign c rows of the other leave 4 * 40 c / (40 + c) of an offset as large as the noise."""
    full, winner, _ = one_sign(tmp_path, {"load": (-10e3, 20e3)}, noise=3.0 / size)
    proposal = next_points(full, winner, [])
    counts = [*range(1, POINTS + 1), *range(2 * POINTS, MOST_POINTS + 1, POINTS)]
    enough = [count for count in counts if 4 * size**2 * 40 * count / (40 + count) >= APART]
    assert {point.needed for point in proposal.points} == set(enough[:1])
    assert bool(proposal.tied) is not bool(enough)
    is_said = bool(proposal.points) and "points like these would be needed" in proposal.points[-1].why
    assert is_said is (bool(enough) and enough[0] > POINTS)
