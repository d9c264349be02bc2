"""A long record: rows in blocks, a search on some of them, a model that is seldom called."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
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
    ends,
    gauge,
    name_sets,
    wide,
)
from numpy.testing import assert_allclose

from truing import Effect, Float, Model, Tolerance, Unknown, normal
from truing.diagnosis import engine, machine
from truing.diagnosis import extended as under_test
from truing.diagnosis.causes import Candidate, effects_of
from truing.diagnosis.engine import diagnose
from truing.diagnosis.exact import Asking, alone, fitting, held_without, together
from truing.diagnosis.extended import Extended, Request
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import calibration_of, times
from truing.diagnosis.sample import sample_of


def test_many_rows_times_a_vector_are_summed_in_double_precision() -> None:
    rng = np.random.default_rng(4)
    matrix = rng.normal(size=(20_000, 3)).astype(np.float32)
    vector = np.array([1.0, 1e-6, -1.0])
    made: Any = times(matrix, vector)  # type: ignore[arg-type]
    assert_allclose(made, matrix.astype(float) @ vector, rtol=1e-12)


def test_the_first_idea_of_the_noise_is_what_least_squares_leave(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench, rng = wide(400, turning=True), np.random.default_rng(5)
    measured = gauge(bench.load, bench.travel, 3.3) + 0.01 * bench.temperature**2 + rng.normal(0, 2, 400)
    asked = Asked(drive_model())
    there = machine.calibration_of(asked.setup, asked.records(tmp_path, bench.columns(measured)))
    powers = [np.asarray(values) ** power for values in vars(bench).values() for power in (1, 2)]
    loads = [bench.contact, bench.load * bench.travel]
    design = np.column_stack([np.ones(400), *powers, *loads])
    design /= np.sqrt(np.mean(design**2, axis=0))
    left = measured - gauge(bench.load, bench.travel)
    rest = left - design @ np.linalg.lstsq(design, left)[0]
    expected = 1e-6 * np.sqrt(rest @ rest / (400 - design.shape[1]))
    assert_allclose(first_noise(there)["deflection"].scale, expected, rtol=1e-6)
    monkeypatch.setattr("truing.diagnosis.machine.ROWS_AT_ONCE", 60)
    assert_allclose(first_noise(there)["deflection"].scale, expected, rtol=1e-6)


def test_a_search_looks_at_one_row_of_every_stretch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "LONG", 40)
    bench, asked = wide(130), Asked(drive_model(("lead_error",)))
    records = asked.records(tmp_path, bench.columns(0.0 * bench.time), ["a"] * 30 + ["b"] * 100)
    few = engine.searched(records, seed=1)
    taken = np.searchsorted(bench.time * 3600, few.covariates["time"].values - 1e-6)
    assert (np.floor((taken + 1) * 40 / 130 - 1e-9).astype(int) == np.arange(40)).all()  # stretches of 3.25 rows
    assert_allclose(few.covariates["travel"].values, bench.travel[taken] * 1e-3)
    assert [few.rows.runs[place] for place in (0, -1)] == [records.rows.runs[0], records.rows.runs[-1]]
    assert (few.lines == records.lines[taken]).all()
    assert len(np.unique(np.diff(taken))) > 3  # no regular step, which would fold a wave into another one
    assert engine.searched(few, seed=1) is few
    along = replace(records, rows=replace(records.rows, series=("travel",)))
    assert engine.searched(along, seed=1) is along  # its rows are one path: of some the model would draw another one


def test_what_a_search_of_some_rows_came_to_is_fitted_to_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "LONG", 80)
    bench, asked = wide(300), Asked(drive_model(("lead_error",), {}))
    error = 0.03 * bench.travel + np.random.default_rng(9).normal(size=300)
    found = asked.diagnosed(tmp_path, bench.drawn(error))
    assert name_sets(found) == [{"lead_error"}]
    exact = bench.travel @ error / (bench.travel @ bench.travel)  # by all rows
    (size,) = found.causes[0].unknowns
    assert_allclose(size.value, exact * 1e-3, rtol=1e-5)
    low, high = ends(size)
    wide_apart = 2 * 1.97e-3 / np.sqrt(bench.travel @ bench.travel)  # of a slope through zero in noise of 1 um
    assert_allclose(high - low, wide_apart, rtol=0.1)


def ripple(order: int) -> Effect[Any, Any]:
    """Wave along the travel."""

    def acting(screw: Drive, base: Deflection, *, size: Float) -> Deflection:
        return replace(base, deflection=base.deflection + size * np.cos(order * screw.travel / 0.03))

    return Effect(f"ripple_{order}", on_results=acting, unknowns=[Unknown("size", -100, 100, "um")])


def calls_of(tmp_path: Path, extra: int, tolerances: Mapping[str, str]) -> int:
    """How often the model is called where so many effects are looked for beside the true one."""
    calls = []

    def counting(screw: Drive) -> Deflection:
        """The screw drive."""
        calls.append(screw)
        return drive(screw)

    spreads = [Tolerance(name, normal(sd=sd), why="drawing") for name, sd in tolerances.items()]
    errors: list[Any] = [*spreads, EFFECTS["lead_error"], *(ripple(order) for order in range(1, extra + 1))]
    asked = Asked(Model(name="drive", title="Deflection of a screw drive", function=counting, errors=errors))
    bench = wide(50)
    error = 0.03 * bench.travel + np.random.default_rng(8).normal(size=50)
    records = asked.records(tmp_path, bench.drawn(error))
    calls.clear()
    found = diagnose(asked.setup, records)
    assert [cause.effect for cause in found.causes] == ["lead_error"]
    assert found.unique
    return len(calls)


@pytest.mark.parametrize(("tolerances", "extra", "most", "most_more"), [({}, 6, 1, 2 * 6), (TOLERANCES, 5, 300, 5 * 5)])
def test_effects_on_results_cost_few_calls_of_a_slow_model_however_many_pairs_there_are(
    tmp_path: Path, tolerances: Mapping[str, str], extra: int, most: int, most_more: int
) -> None:
    """What acts after the model needs it for the rows alone, whose answer is known since they were read.

    Of an effect that was not fitted the model is asked twice whether it fails with it. Where inputs have tolerances
    every explanation that is fitted has inputs of its own, and the model is called there; not for all of ten pairs.
    """
    none, more = (calls_of(tmp_path, effects, tolerances) for effects in (0, extra))
    assert none <= most
    assert more - none <= most_more


def test_every_linear_algebra_has_one_thread_in_a_fresh_process() -> None:
    """Small matrices on several threads cost ten times the processor, and numpy and scipy each bring their own."""
    code = """
from types import SimpleNamespace
from threadpoolctl import threadpool_info
from truing.diagnosis import engine
class Held(Exception):
    pass
def begun(setup, records):
    raise Held([(pool["internal_api"], pool["num_threads"]) for pool in threadpool_info()])
engine._check_options = lambda setup: None
engine.calibration_of = begun
try:
    engine.diagnose(SimpleNamespace(model=SimpleNamespace(dynamics=None)), SimpleNamespace(readings=99))
except Held as held:
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


# Several fits that ask the model at one time: each is told what it would be told alone, in fewer calls.

LOADS = np.linspace(-20, 20, 40)


def shift(before: Drive, *, more: Float) -> Drive:
    return replace(before, zero=before.zero + more)


def reset(before: Drive, *, amount: Float) -> Drive:
    """It sets what the shift adds to: beside that one it undoes what it adds. Beyond 1 mm there is no answer."""
    return replace(before, zero=np.where(np.asarray(amount) > 1e-3, np.nan, amount))


SHIFTED = replace(
    drive_model(["stiffness_loss"], {}),
    errors=[
        EFFECTS["stiffness_loss"],
        Effect("shift", on_inputs=shift, unknowns=[Unknown("more", 0, 2, "mm")]),
        Effect("reset", on_inputs=reset, unknowns=[Unknown("amount", 0, 2, "mm")]),
    ],
)


def shown_at(loss: float = 0.0, offset: float = 0.0) -> Array:
    """What the gauge shows at LOADS, SI, with a loss of stiffness and an offset, by the formula of the textbook."""
    return np.asarray(1e-6 * gauge((1 + loss) * LOADS, 0 * LOADS) + offset)


@pytest.fixture
def asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Extended, dict[str, Candidate], list[int]]:
    """The drive as a diagnosis asks it, its causes by name, and by call the number of points."""
    one = Asked(SHIFTED)
    machine = calibration_of(one.setup, one.records(tmp_path, {"load": LOADS, "deflection": 1e6 * shown_at()}))
    calls: list[int] = []
    ask = under_test.predict_each

    def counted(setup, records, trials):  # type: ignore[no-untyped-def]
        calls.append(len(trials))
        return ask(setup, records, trials)

    monkeypatch.setattr(under_test, "predict_each", counted)
    return Extended(machine), {cause.name: cause for cause in effects_of(machine)}, calls


def request(extended: Extended, causes: Sequence[Candidate], *points: Sequence[float]) -> Request:
    still = np.zeros(len(extended.machine.inputs))
    return causes, [([np.array([value]) for value in values], still) for values in points]


Points = tuple[str, list[float]]


@pytest.mark.parametrize(
    ("points", "expected", "calls"),
    [
        (  # points of the same causes are one call, and what is known is not asked again
            [("stiffness_loss", [0.5]), ("stiffness_loss", [0.2]), ("stiffness_loss sensor_offset", [0.2, 1e-3]),
             ("stiffness_loss", [0.2]), ("stiffness_loss", [0.75])],
            [(0.5, 0.0), (0.2, 0.0), (0.2, 1e-3), (0.2, 0.0), (0.75, 0.0)], [3, 1],
        ),
        (  # effects act where they are asked for alone: one sets what another one adds to, and is declared later
            [("shift", [2e-4]), ("reset shift", [1e-4, 2e-4]), ("reset", [1e-4])],
            [(0.0, 2e-4), (0.0, 1e-4), (0.0, 1e-4)], [1, 1, 1],
        ),
        (  # causes that come in another order are not mistaken for one another
            [("stiffness_loss shift", [0.5, 0.25]), ("shift stiffness_loss", [0.5, 0.25]),
             ("shift stiffness_loss", [0.25, 0.5])],
            [(0.5, 0.25), (0.25, 0.5), (0.5, 0.25)], [2],
        ),
        (  # a point at which the model has no answer leaves the others theirs
            [("reset", [1e-4]), ("reset", [2e-3]), ("reset", [2e-4])],
            [(0.0, 1e-4), (0.0, np.nan), (0.0, 2e-4)], [3],
        ),
    ],
    ids=["one call", "alone", "order", "no answer"],
)  # fmt: skip
def test_points_that_are_asked_at_one_time_are_answered_as_alone(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
    points: list[Points], expected: list[tuple[float, float]], calls: list[int],
) -> None:  # fmt: skip
    extended, causes, counted = asked
    answers = extended.at_each(
        [request(extended, [causes[name] for name in names.split()], at) for names, at in points]
    )
    assert counted == calls
    for (shown,), known in zip(answers, expected, strict=True):
        assert_allclose(shown["deflection"], shown_at(*known), rtol=1e-9, atol=1e-15)


def test_searches_that_end_at_different_times_each_return_their_own(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    soft = causes["stiffness_loss"]

    def asking(share: float, rounds: int) -> Asking[list[float]]:
        largest = []
        for turn in range(rounds):
            (shown,) = yield request(extended, [soft], [share * (turn + 1)])
            largest.append(float(shown["deflection"].max()))
        return largest

    made = together(extended, [asking(0.125, 3), asking(0.25, 0), asking(0.375, 1)])
    for own, shares in zip(made, ([0.125, 0.25, 0.375], [], [0.375]), strict=True):
        assert_allclose(own, [shown_at(share).max() for share in shares], rtol=1e-9)
    assert calls == [2, 1], "the last point is known by then"


def test_without_one_of_its_causes_the_rest_of_an_explanation_is_held(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, _ = asked
    soft, adds = causes["stiffness_loss"], causes["shift"]
    sample = sample_of(extended.machine, first_noise(extended.machine), np.ones(len(LOADS), dtype=bool))
    both, values = (soft, adds), [np.array([0.5]), np.array([2e-4])]
    fit = alone(extended, fitting(sample, extended, both, values, held=[*soft.numbers, *adds.numbers]))
    assert fit is not None
    held = held_without(fit, 0, sample, extended)
    assert held.causes == (adds,)
    np.testing.assert_array_equal(held.of(adds), [2e-4])
    assert_allclose(held.predicted["deflection"], shown_at(offset=2e-4), rtol=1e-9)


def test_readings_that_the_model_meets_to_the_last_digit_have_nothing_wrong(tmp_path: Path) -> None:
    one = Asked(SHIFTED)
    answer = one.diagnosed(tmp_path, {"load": LOADS, "deflection": 1e6 * shown_at()})
    assert (answer.verdict, answer.causes, answer.p_any, answer.warnings) == ("none", (), 1.0, ())
