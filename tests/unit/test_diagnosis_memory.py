"""A long record: rows in blocks, columns made when asked for, a model that is called once per unknown."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import (
    EFFECTS,
    TOLERANCES,
    Array,
    Asked,
    Deflection,
    Drive,
    drive,
    drive_model,
    gauge,
    name_sets,
    plain_contest,
    wide,
)
from numpy.testing import assert_allclose, assert_array_equal

from truing import Effect, Float, Model, Tolerance, Unknown, normal, trials
from truing.diagnosis import contest as contest_module
from truing.diagnosis import evidence, machine
from truing.diagnosis.columns import FEW, MANY, Column, Design, Made, stored, times, when_asked
from truing.diagnosis.engine import diagnose
from truing.diagnosis.evidence import Channel, products_of, starts_of
from truing.diagnosis.filtered import grams_of, mixture, parts_of
from truing.diagnosis.gain import blocks_of
from truing.diagnosis.machine import predict
from truing.diagnosis.noise import SETTINGS, whiten
from truing.diagnosis.search import first_noise

RUNS = np.array([1, 1, 18, 30, 9, 1])
"""Lengths of runs, of one row too."""


def starts() -> Any:
    """Mark the first row of each run."""
    found = np.zeros(RUNS.sum(), dtype=bool)
    found[np.cumsum([0, *RUNS[:-1]])] = True
    return found


@pytest.mark.parametrize("place", range(len(SETTINGS)))
def test_the_parts_of_all_filters_give_the_inner_products_of_each(place: int) -> None:
    rng = np.random.default_rng(1)
    columns, others = rng.normal(size=(4, RUNS.sum())), 3 + rng.normal(size=(2, RUNS.sum()))
    white, white_others = (whiten(values.T, starts(), SETTINGS[place]) for values in (columns, others))
    taken = mixture(SETTINGS)[place]
    own = np.tensordot(taken, list(grams_of(columns, starts(), SETTINGS)), 1)
    cross = np.tensordot(taken, [columns @ part.T for part in parts_of(others, starts(), SETTINGS)], 1)
    assert_allclose(own, white.T @ white, rtol=1e-11, atol=1e-11)
    assert_allclose(cross, white.T @ white_others, rtol=1e-11, atol=1e-11)


def test_a_steady_column_keeps_its_digits_under_a_slow_filter() -> None:
    """1 - rho is 0.05: a difference of large numbers would lose what is left of a constant."""
    steady, slow = np.full((1, 400), 1e3), next(item for item in SETTINGS if (item.rho, item.theta) == (0.95, 0.0))
    begin = np.arange(400) == 0
    (found,) = np.tensordot(mixture([slow]), list(grams_of(steady, begin, [slow])), 1).ravel()
    exact = 1e6 * (399 * (1 - 0.95) ** 2 + (1 - 0.95**2))  # rows after the first leave 0.05 of it, the first 1 - rho^2
    assert_allclose(found, exact, rtol=1e-13)


def long_channel(rows: int, *, is_made: bool, seed: int = 2) -> Channel:
    """Twelve waves over a record of runs of 700 rows, one gap, uneven weights."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 6, rows)

    def wave(order: int) -> Callable[[Any], Array]:
        return lambda places: np.asarray(np.sin(order * angle[places]))

    values = [Made(wave(order), rows) if is_made else wave(order)(slice(None)) for order in range(1, 13)]
    taken = np.delete(np.arange(rows), [5, 6])
    return Channel(
        "gauge",
        0.5,
        taken,
        starts_of(np.arange(rows) // 700, taken),
        rng.uniform(0.5, 2, len(taken)),
        rng.normal(size=len(taken)),
        rng.normal(size=(rows, 2)),
        np.eye(2),
        Design("gauge", [Column({"gauge": each}, 0.1) for each in values], rows),
    )


def test_blocks_give_the_inner_products_of_one_block(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = products_of(long_channel(3000, is_made=False))
    for is_made in (False, True):
        monkeypatch.setattr(evidence, "LONGEST", 700)
        item = long_channel(3000, is_made=is_made)
        assert len(item.blocks) == 4
        for found, known in zip(products_of(item), whole, strict=True):
            assert_allclose(found.matrix, known.matrix, rtol=1e-10, atol=1e-9)
            assert_allclose(found.constant, known.constant, rtol=1e-12)
        monkeypatch.undo()


def test_inner_products_are_kept_until_rows_or_weights_change() -> None:
    item = long_channel(1500, is_made=False)
    first = products_of(item)[4].matrix
    kept = next(iter(item.design.known.values()))
    other = replace(item, residual=-item.residual)
    again = products_of(other)[4].matrix
    assert next(iter(other.design.known.values())) is kept
    assert_array_equal(again[0, 1:], -first[0, 1:])
    heavier = products_of(replace(item, weights=2 * item.weights))[4].matrix
    assert_allclose(heavier, 4 * first, rtol=1e-12)


def test_memory_of_the_inner_products_does_not_grow_with_the_rows() -> None:
    peaks = []
    for rows in (20_000, 80_000):
        item = long_channel(rows, is_made=True)
        item = replace(item, design=Design("gauge", item.design.columns * 5, rows))
        tracemalloc.start()
        products_of(item)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.1 * peaks[0]


def test_columns_of_many_rows_are_made_when_asked_for() -> None:
    few, many = (when_asked(lambda rows, size=size: np.arange(float(size))[rows], size) for size in (FEW, FEW + 1))
    assert isinstance(few, np.ndarray)
    assert isinstance(many, Made)
    assert_array_equal(many[3:6], [3, 4, 5])
    assert_array_equal((many * 2)[-2:], [2 * FEW - 2, 2 * FEW])
    assert_array_equal(np.asarray(many)[np.array([7, 9])], [7, 9])


def test_curves_of_many_rows_are_stored_in_few_bytes() -> None:
    curve = np.random.default_rng(3).normal(size=MANY + 1)
    assert stored(curve[:-1]) is not None
    assert np.asarray(stored(curve[:-1])).dtype == np.float64
    kept = stored(curve)
    assert isinstance(kept, np.ndarray)
    assert kept.nbytes == 4 * len(curve)
    assert_allclose(kept, curve, rtol=6e-8)
    switch = stored((curve > 0).astype(float))
    assert isinstance(switch, Made)
    assert_array_equal(np.asarray(switch), curve > 0)
    assert_array_equal(switch[11:23], (curve > 0)[11:23])
    assert_array_equal(switch[np.array([3, MANY])], (curve > 0)[[3, MANY]])
    gap = np.where(np.arange(5) == 2, np.nan, 1.5)
    assert np.asarray(stored(gap)).tolist() == [1.5, 1.5, 0, 1.5, 1.5]
    nothing = stored(np.zeros(MANY + 1))
    assert isinstance(nothing, np.ndarray)
    assert nothing.strides == (0,)
    assert not np.any(nothing)


def test_many_rows_times_a_vector_are_summed_in_double_precision() -> None:
    rng = np.random.default_rng(4)
    matrix = rng.normal(size=(20_000, 3)).astype(np.float32)
    assert_allclose(times(matrix, np.array([1.0, 1e-6, -1.0])), matrix.astype(float) @ [1.0, 1e-6, -1.0], rtol=1e-12)


def test_rows_in_batches_are_predicted_as_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, bench = Asked(drive_model()), wide(50)
    records = asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel)), ["a"] * 30 + ["b"] * 20)
    at_once = predict(asked.setup, records)["deflection"]
    monkeypatch.setattr(trials, "AT_ONCE", 7)
    assert_allclose(predict(asked.setup, records)["deflection"], at_once, rtol=1e-12, atol=1e-15)
    assert_allclose(at_once, 1e-6 * gauge(bench.load, bench.travel), rtol=1e-12, atol=1e-15)


def test_the_first_idea_of_the_noise_is_what_least_squares_leave(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench, rng = wide(400), np.random.default_rng(5)
    measured = gauge(bench.load, bench.travel, 3.3) + 0.01 * bench.temperature**2 + rng.normal(0, 2, 400)
    asked = Asked(drive_model())
    there = machine.machine_of(asked.setup, asked.records(tmp_path, bench.columns(measured)))
    powers = [np.asarray(values) ** power for values in vars(bench).values() for power in (1, 2)]
    loads = [np.sign(bench.load) * np.cbrt(bench.load) ** 2, bench.load * bench.travel]
    design = np.column_stack([np.ones(400), *powers, *loads])
    design /= np.sqrt(np.mean(design**2, axis=0))
    left = measured - gauge(bench.load, bench.travel)
    rest = left - design @ np.linalg.lstsq(design, left)[0]
    expected = 1e-6 * np.sqrt(rest @ rest / (400 - design.shape[1]))
    assert_allclose(first_noise(there).scales["deflection"], expected, rtol=1e-6)
    monkeypatch.setattr("truing.diagnosis.columns.BLOCK", 60)
    assert_allclose(first_noise(there).scales["deflection"], expected, rtol=1e-6)


def test_blocks_of_a_cross_validation_lie_inside_runs(tmp_path: Path) -> None:
    bench, asked = wide(130), Asked(drive_model(("lead_error",)))
    columns = bench.columns(gauge(bench.load, bench.travel) + np.random.default_rng(6).normal(size=130))
    records = asked.records(tmp_path, columns, ["a"] * 20 + ["b"] * 110)
    found = blocks_of(plain_contest(asked, records, 1e-6), (0,))
    sizes = [6, 6, 6, 2, *[6] * 18, 2]  # a twentieth of 130 rows
    assert_array_equal(found, np.repeat(np.arange(len(sizes)), sizes))


def test_twenty_thousand_rows_are_named(tmp_path: Path) -> None:
    bench = wide(21_000, seed=7)
    error = 0.02 * (bench.temperature - 20) + np.random.default_rng(7).normal(0, 1, len(bench))
    asked = Asked(drive_model(("clearance", "lead_error", "thermal_growth")))
    found = asked.diagnosed(tmp_path, bench.columns(gauge(bench.load, bench.travel) + error))
    assert found.verdict == "one_of"  # growth, or a drift of the gauge with temperature
    assert name_sets(found) == [{"thermal_growth", "thermal_drift"}]
    (size,) = found.causes[0].unknowns
    assert size.low is not None
    assert size.high is not None
    assert size.low < 0.02e-6 < size.high
    wide_apart = 2 * 1.96e-6 / np.sqrt(np.sum((bench.temperature - 20) ** 2))  # of a slope through zero
    assert_allclose(size.high - size.low, wide_apart, rtol=0.05)


class Slow:
    """The screw drive, counting how often it is called."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, screw: Drive) -> Deflection:
        self.calls += 1
        return drive(screw)


def ripple(order: int) -> Effect[Any, Any]:
    """Wave along the travel."""

    def acting(screw: Drive, base: Deflection, *, size: Float) -> Deflection:
        return replace(base, deflection=base.deflection + size * np.cos(order * screw.travel / 0.03))

    return Effect(f"ripple_{order}", on_results=acting, unknowns=[Unknown("size", -100, 100, "um")])


def calls_of(tmp_path: Path, extra: int) -> int:
    """How often the model is called where so many effects are looked for beside the true one."""
    slow = Slow()

    def counting(screw: Drive) -> Deflection:
        """The screw drive."""
        return slow(screw)

    spreads = [Tolerance(name, normal(sd=sd), why="drawing") for name, sd in TOLERANCES.items()]
    errors = [*spreads, EFFECTS["lead_error"], *(ripple(order) for order in range(1, extra + 1))]
    asked = Asked(Model(name="drive", title="Deflection of a screw drive", function=counting, errors=errors))
    bench = wide(80)
    error = 0.03 * bench.travel + np.random.default_rng(8).normal(size=80)
    records = asked.records(tmp_path, bench.columns(gauge(bench.load, bench.travel) + error))
    slow.calls = 0
    found = diagnose(asked.setup, records)
    assert [cause.effect for cause in found.causes] == ["lead_error"]
    assert found.unique
    return slow.calls


def test_effects_on_results_cost_no_call_of_a_slow_model_however_many_pairs_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What acts after the model needs it for the rows alone, whatever the size of the effect."""
    calls = [calls_of(tmp_path, extra) for extra in (0, 5, 10)]
    assert 0 < calls[0] == calls[1] == calls[2] < 30
    monkeypatch.setattr(contest_module, "pairs", lambda terms, beside: [])
    assert [calls_of(tmp_path, extra) for extra in (0, 10)] == [calls[0], calls[2]]


def test_every_linear_algebra_has_one_thread_in_a_fresh_process() -> None:
    """Small matrices on several threads cost ten times the processor, and numpy and scipy each bring their own."""
    code = """
from threadpoolctl import threadpool_info
from truing.diagnosis import engine
engine._check_options = lambda setup: None
engine._diagnose = lambda *given: [(pool["internal_api"], pool["num_threads"]) for pool in threadpool_info()]
held = engine.diagnose(None, None)
import scipy.linalg
print(held, len(threadpool_info()))
"""
    several = {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}
    said = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **several}, check=True, capture_output=True, text=True
    ).stdout
    pools = re.findall(r"\('(\w+)', (\d+)\)", said)
    assert pools
    assert {threads for _, threads in pools} == {"1"}
    assert f" {len(pools)}\n" in said
