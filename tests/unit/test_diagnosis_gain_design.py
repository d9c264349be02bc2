"""What an extension is worth, how small an effect may be to be seen, and where to measure next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import (
    STROKE,
    UM,
    Array,
    Asked,
    chosen_as,
    drive_model,
    fit_of,
    gauge,
    of_size_one,
    wander,
    white_noise,
    wide,
)
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import subspace_angles, toeplitz
from scipy.stats import binom, norm

from truing.diagnosis.choice import Chosen
from truing.diagnosis.competition import Competition
from truing.diagnosis.fitted import Fit
from truing.diagnosis.folds import FOLDS, SHORTEST_BLOCK, Folds, carries_over, errors_left_out, folds_of
from truing.diagnosis.gain import _log_density, nested, sign_flip_p
from truing.diagnosis.noise import Autocorrelation
from truing.diagnosis.sample import Sample, sample_of
from truing.diagnosis.visibility import alike_of, inseparable, needed, separation, smallest_visible
from truing.setup import DiagnoseOptions


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
    everywhere = sign_flip_p(np.ones(40), np.arange(40), seed=1)
    assert everywhere == 1 / 1000  # the least that 999 draws can show: none of them is as good as what was found


def test_a_loss_a_rounding_a_single_block_and_rows_that_were_not_judged_are_no_gain() -> None:
    blocks = np.repeat(np.arange(5), 4)
    for gain, of in ((-1.0, blocks), (1e-9, blocks), (1.0, 0 * blocks), (0.0, blocks)):
        assert sign_flip_p(np.full(20, gain), of, seed=0) == 1
    partly = np.where(np.arange(20) % 5 == 0, np.nan, 1.0)
    expected = sign_flip_p(np.ones(16), np.repeat(range(4), 4), seed=2)
    assert_allclose(sign_flip_p(partly, np.repeat([0, 1, 3, 6], 5), seed=2), expected)


@pytest.mark.parametrize("freedom", [3.0, 4.0, 10.0, 30.0, inf])
def test_densities_are_of_unit_variance(freedom: float) -> None:
    whole, variance = (
        quad(lambda z, power=power: z**power * float(np.exp(_log_density(z, freedom))), -inf, inf)[0]
        for power in (0, 2)
    )
    assert_allclose([whole, variance], 1, rtol=1e-6)


def ready(folder: Path, error: Array, runs: list[str] | None = None, **more: Any) -> Competition:
    """What competes on a wide record that is off by this much (um), in white noise."""
    bench = wide(len(error), seed=33)
    options = more.pop("diagnose", DiagnoseOptions())
    asked = Asked(drive_model(**more), diagnose=options)
    return asked.competing(folder, bench.shown(error), runs or [])


def remembering(sample: Sample, rho: float, *, held: NDArray[np.bool_] | None = None) -> Sample:
    """The same rows, some held out, as if their noise carried this much over."""
    noise = {name: replace(own, memory=Autocorrelation(rho)) for name, own in white_noise(sample.machine, UM).items()}
    return sample_of(sample.machine, noise, sample.mask if held is None else ~held, sample.directions)


@pytest.mark.parametrize(
    ("rho", "rows", "length"), [(0.0, 24, 3), (0.0, 90, SHORTEST_BLOCK), (0.0, 200, 10), (0.6, 90, 6), (0.95, 300, 30)]
)
def test_folds_are_blocks_of_consecutive_rows_of_one_run(tmp_path: Path, rho: float, rows: int, length: int) -> None:
    """Six rows, a twentieth of the record, or three times 1/ln(1/rho) rows, but no more than a tenth of the record.

    A short record has shorter blocks rather than fewer.
    """
    runs = ["a"] * (rows // 3) + ["b"] * (rows - rows // 3)
    folds = folds_of(remembering(ready(tmp_path, np.zeros(rows), runs).sample, rho))
    assert folds.count == FOLDS
    assert_array_equal(np.diff(folds.block_of) >= 0, True)
    assert set(np.diff(folds.block_of)) <= {0, 1}
    for block in np.unique(folds.block_of):
        here = np.flatnonzero(folds.block_of == block)
        assert_array_equal(np.diff(here), 1)
        assert len({runs[row] for row in here}) == 1
        assert len(here) == length or here[-1] == rows - 1 or runs[here[-1] + 1] != runs[here[0]]
    assert np.bincount(folds.block_of).max() == length


def test_rows_held_out_are_in_no_block_and_no_file_is_left_out_whole(tmp_path: Path) -> None:
    """Of two runs of 60 rows the first 20 of each may be used: blocks of an eighth of these, or fewer per file."""
    runs, held = ["a"] * 60 + ["b"] * 60, np.arange(120) % 60 >= 20
    folds = folds_of(remembering(ready(tmp_path, np.zeros(120), runs).sample, 0.0, held=held))
    assert_array_equal(folds.block_of < 0, held)
    assert not any(folds.test(fold)[held].any() for fold in range(folds.count))
    assert np.bincount(folds.block_of[~held]).tolist() == [5, 5, 5, 5] * 2
    per_file = ready(tmp_path, np.zeros(120), runs, diagnose=DiagnoseOptions(per_file=("lead_error",)))
    split = folds_of(remembering(per_file.sample, 0.95, held=held)).block_of
    assert all(len(set(split[rows][~held[rows]])) >= 2 for rows in (slice(0, 60), slice(60, 120)))


def left_out(error: Array, columns: Sequence[Array], folds: Folds) -> Array:
    """What least squares on the other rows leaves of the rows of each fold."""
    design, found = np.column_stack(columns), np.full(len(error), np.nan)
    for fold in range(folds.count):
        test = folds.test(fold)
        found[test] = error[test] - design[test] @ np.linalg.lstsq(design[~test], error[~test])[0]
    return found


def test_what_is_judged_was_not_used(tmp_path: Path) -> None:
    """Held against least squares by hand without the rows of every fold.

    A fit without a fold ends within a hundredth of a score unit: a tenth of the standard error of its size.
    """
    bench = wide(120, seed=33)
    error = 0.03 * bench.travel + np.random.default_rng(34).normal(0, 1, 120)
    made = ready(tmp_path, error, tolerances={})
    less, more = fit_of(made, "lead_error"), fit_of(made, "lead_error", "clearance")
    judged = nested(chosen_as(made, less))
    folds, answers = judged.folds, judged.judged["deflection"]
    curves = bench.travel, np.sign(bench.load)
    before, after = left_out(error, curves[:1], folds), left_out(error, curves, folds)
    assert_allclose(errors_left_out(less, made.extended, folds), before, rtol=0, atol=0.005)
    assert_allclose(errors_left_out(more, made.extended, folds), after, rtol=0, atol=0.005)
    kept = error - np.column_stack(curves) @ np.linalg.lstsq(np.column_stack(curves), error)[0]
    fallen = (before**2 - after**2) / np.mean(kept**2)
    ours = carries_over(less, more, made.extended, folds)
    assert_allclose(ours, fallen.sum() / (fallen.std() * np.sqrt(120)), rtol=0, atol=0.02)
    assert ours < 0  # nothing there is a clearance
    assert carries_over(made.null, less, made.extended, folds) > 1
    assert_allclose(answers.before / UM, error, rtol=0, atol=1e-9)
    assert_allclose(answers.after / UM, before, rtol=0, atol=0.005)
    assert np.abs(before - (error - bench.travel * (bench.travel @ error) / (bench.travel @ bench.travel))).max() > 0.05
    assert judged.stability == 1
    for fold in range(folds.count):
        test = folds.test(fold)
        rest = np.linalg.lstsq(bench.travel[~test, None], error[~test])[1] / (~test).sum()
        expected = norm(0, np.sqrt(rest)).logpdf(before[test])
        expected -= norm(0, np.sqrt(np.mean(error[~test] ** 2))).logpdf(error[test])
        assert_allclose(answers.gain[test], expected, rtol=0, atol=0.01)


def test_what_is_chosen_without_a_fold_is_counted(tmp_path: Path) -> None:
    """A clearance in the rows of one fold only: without these nothing is there to be chosen, with them it is."""
    bench = wide(120, seed=33)
    noise = of_size_one(np.random.default_rng(38), 120)
    folds = folds_of(ready(tmp_path, noise, tolerances={}).sample)
    error = noise + np.where(folds.test(2), 12.0, 0.0) * np.sign(bench.load)
    made = ready(tmp_path, error, tolerances={})
    judged = nested(chosen_as(made, fit_of(made, "clearance")))
    own = judged.folds.test(2)
    assert judged.stability == pytest.approx(0.8)
    assert_array_equal(judged.judged["deflection"].after[own], judged.judged["deflection"].before[own])
    assert not np.any(judged.judged["deflection"].after[~own] == judged.judged["deflection"].before[~own])


def test_a_gain_is_held_against_the_calibrated_model_and_the_noise_floor(tmp_path: Path) -> None:
    rng = np.random.default_rng(35)
    bench = wide(200, seed=35)
    contact = bench.contact
    error = 0.12 * contact + 0.02 * bench.travel + rng.normal(0, 1, 200)  # 0.12 lies inside the tolerance
    found = Asked(drive_model(["lead_error"])).diagnosed(tmp_path, bench.drawn(error))
    (gain,) = found.gain
    design = np.column_stack([contact, bench.load * bench.travel])
    free = error - design @ np.linalg.lstsq(design, error)[0]
    assert_allclose(gain.rmse_before.value / UM, np.sqrt(np.mean(free**2)), rtol=0.04)
    assert_allclose(gain.noise_floor.value / UM, 1, rtol=0.15)
    assert_allclose(gain.rmse_after.value / UM, 1, rtol=0.15)
    assert gain.reducible_removed > 0.9
    assert gain.p_value <= 0.002
    assert found.stability == 1
    before, after, floor = gain.rmse_before.value, gain.rmse_after.value, gain.noise_floor.value
    removed = (before**2 - after**2) / (before**2 - floor**2)
    assert_allclose(gain.reducible_removed, min(removed, 1.0), rtol=1e-9)
    assert_allclose(gain.log_score_gain, np.log(before / after), rtol=0.1)
    assert binom.ppf(0.001, 200, 0.9) <= 200 * gain.coverage90 <= binom.ppf(0.999, 200, 0.9)


def unmoved(made: Competition) -> Chosen:
    """The model as it was drawn, as if it had been chosen: what it leaves is the error that a test has made."""
    base = made.extended.machine.base
    left, still = made.sample.left(base), np.zeros(made.sample.directions.shape[1])
    return chosen_as(made, Fit((), (), still, dict(base), left, made.sample.cost(left, still), made.sample))


def limit_of(made: Competition) -> float:
    """What must be seen of an effect where all effects and their pairs were looked for."""
    effects = sum(cause.effect is not None for cause in made.causes)
    return needed(effects + effects * (effects - 1) // 2)


@pytest.mark.parametrize("tolerances", [{}, {"contact": "3 %", "zero": "5 um"}])
@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_the_smallest_visible_size_by_dense_algebra(tmp_path: Path, tolerances: dict[str, str], rho: float) -> None:
    """In noise whose innovations have the mean square 1 to the last digit."""
    bench = wide(60, seed=33)
    noise = toeplitz(rho ** np.arange(60.0)) / (1 - rho**2)
    error = wander(np.random.default_rng(33), 60, rho)
    error /= np.sqrt(error @ np.linalg.solve(noise, error) / 60)
    made = ready(tmp_path, error, tolerances=tolerances, effects=("lead_error", "clearance"))
    made.sample = remembering(made.sample, rho)
    seen = {item.name: item for item in smallest_visible(unmoved(made))}
    contact = bench.contact
    if tolerances:
        noise = noise + np.outer(0.09 * contact, 0.09 * contact) + 25.0
    for name, curve, unit in (("lead_error", bench.travel, UM / 1e-3), ("clearance", np.sign(bench.load), UM)):
        smallest = np.sqrt(limit_of(made) / (curve @ np.linalg.solve(noise, curve)))
        found = seen[name].smallest
        assert found is not None
        assert_allclose(found.value, smallest * unit, rtol=1e-5)
        assert seen[name].sight == "visible"


def test_an_offset_the_tolerances_would_take_is_hidden_in_them(tmp_path: Path) -> None:
    made = ready(tmp_path, of_size_one(np.random.default_rng(33), 60), tolerances={"zero": "50 um"})
    sight = {item.name: item.sight for item in smallest_visible(unmoved(made))}
    assert sight["sensor_offset"] == "hidden in the tolerances"
    assert sight["clearance"] == "visible"


@pytest.mark.parametrize(("size", "sight"), [(0.8, "visible"), (1.2, "not excited")])
def test_a_bound_below_the_smallest_visible_size_is_not_excited(tmp_path: Path, size: float, sight: str) -> None:
    """Of 60 rows with this noise a clearance shows from sqrt(limit / 60) of it; 500 um are the largest it may be."""
    noise = of_size_one(np.random.default_rng(33), 60)
    limit = limit_of(ready(tmp_path, noise, effects=("clearance",), tolerances={}))
    loud = ready(tmp_path, size * 500 * np.sqrt(60 / limit) * noise, effects=("clearance",), tolerances={})
    seen = {item.name: item for item in smallest_visible(unmoved(loud))}
    assert seen["clearance"].smallest is not None
    assert_allclose(seen["clearance"].smallest.value, size * 500 * UM, rtol=1e-9)
    assert seen["clearance"].sight == sight


# Known answers of the algebra of a diagnosis: angles, separation, and what must be seen.


@pytest.mark.parametrize(("length", "apart"), [(1.0, 16.0), (1.5, 36 + (12 * np.sqrt(0.75) - 10) ** 2)])
def test_two_curves_at_thirty_degrees(tmp_path: Path, length: float, apart: float) -> None:
    """A curve of 8 leaves 8 sin 30; of 12 the rival would need 10.4 and has 10: it leaves 6 across and 0.39 along.

    The curves are the temperature beyond 20 degC and the travel, without a load; ten rows beside them hold noise of
    mean square one over all twelve.
    """
    first, second, noise = np.zeros(12), np.zeros(12), np.zeros(12)
    first[0], second[:2] = length, (np.sqrt(0.75), 0.5)
    noise[2:] = np.sqrt(1.2) * np.resize([1, -1], 10)
    columns = {"load": 0 * first, "temperature": 20 + first, "travel": second, "deflection": 8 * first + noise}
    made = Asked(drive_model(["thermal_growth", "lead_error"], {})).competing(tmp_path, columns)
    true, rival = fit_of(made, "thermal_growth"), fit_of(made, "lead_error")
    assert_allclose(separation(true, rival, made.extended), apart, rtol=1e-6)
    assert_allclose(separation(true, true, made.extended), 0, rtol=0, atol=1e-9)


def test_a_gain_and_a_loss_of_stiffness_are_three_degrees_apart(tmp_path: Path) -> None:
    load, travel = (each.ravel() for each in np.meshgrid(np.arange(-20.0, 21), np.arange(0.0, 301, 50)))
    bench = replace(wide(len(load)), load=load, travel=travel)
    asked = Asked(drive_model(tolerances={}))
    noise = of_size_one(np.random.default_rng(43), len(bench))
    made = asked.competing(tmp_path, bench.columns(gauge(load, travel) + noise))
    contact = np.sign(load) * np.abs(load) ** (2 / 3)
    linear = 0.5 * load * travel / STROKE
    dense = np.degrees(subspace_angles((3 * contact + linear)[:, None], (2 * contact + linear)[:, None])[0])
    assert_allclose(dense, 3.32, rtol=0, atol=0.005)
    pairs = {frozenset((each.one, each.other)): each for each in alike_of(chosen_as(made, made.null))}
    both = pairs[frozenset(("sensor_gain", "stiffness_loss"))]
    assert_allclose(np.degrees(both.angle), dense, rtol=0, atol=0.05)
    said = list(inseparable(made.sample.machine, (both,)))
    assert said[0].startswith(f"{both.one} and {both.other} draw nearly the same curve on this data")


@pytest.mark.parametrize(("explanations", "limit"), [(12, 17.5), (78, 22.0), (200, 24.5)])
def test_how_visible_an_effect_must_be_after_a_search(explanations: int, limit: float) -> None:
    assert_allclose(needed(explanations), limit, rtol=0, atol=0.5)
