"""What keeps a diagnosis from inventing causes: finer grids, doubtful second causes, names, calibration, the noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import log
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    UM,
    Array,
    Asked,
    Bench,
    Deflection,
    Drive,
    drive_model,
    gauge,
    name_sets,
    names_of_piece,
    plain_contest,
    wide,
)
from numpy.testing import assert_allclose
from scipy.stats import t

from truing import Effect, Float, Unknown
from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.decide import Decision, Thresholds
from truing.diagnosis.engine import _certain
from truing.diagnosis.evidence import products_of
from truing.diagnosis.fit import fit, may_be_zero
from truing.diagnosis.hypotheses import Hypothesis
from truing.diagnosis.machine import machine_of
from truing.diagnosis.noise import SETTINGS, Setting, Tails, whiten
from truing.diagnosis.problem import FINEST, Problem, problem_of, sharpened
from truing.diagnosis.search import NoiseModel, evidence_of, first_noise
from truing.diagnosis.significance import Null

WHITE = (0,)
BENCH = wide(150, seed=31)
PROPER = Asked(drive_model())


def read(error: Array | float = 0.0, bench: Bench = BENCH) -> dict[str, Array]:
    """A record of BENCH with noise of 1 um and an error (um)."""
    return bench.columns(gauge(bench.load, bench.travel) + error + noise())


@dataclass(frozen=True)
class Start:
    """Everything that a contest begins with."""

    problem: Problem
    noise: NoiseModel
    rows: Array


def start_of(folder: Path, columns: Mapping[str, Array], runs: Sequence[str] = ()) -> Start:
    """Lay out the search on a record of the drive with all its effects."""
    records = PROPER.records(folder, columns, runs)
    machine = machine_of(PROPER.setup, records)
    learnt = first_noise(machine)
    return Start(problem_of(machine, learnt.scales), learnt, ~records.held_out)


def noise() -> Array:
    return np.random.default_rng(31).normal(0, 1, len(BENCH))


# Grids become finer about the best


def laid_out(folder: Path) -> Problem:
    return problem_of(machine_of(PROPER.setup, PROPER.records(folder, read())), {"deflection": UM})


def places_of(problem: Problem, name: str, shape: str) -> dict[float, int]:
    """By value of a shape the place among the pieces of causes, in order of the value."""
    found = {
        problem.terms[piece.place].shape[shape]: place
        for place, piece in enumerate(problem.term_pieces)
        if problem.candidates[piece.owner].name == name
    }
    return dict(sorted(found.items()))


def around(problem: Problem, value: float) -> Problem:
    return sharpened(problem, [problem.term_pieces[places_of(problem, "warm_up", "time_constant")[value]]])


def test_a_grid_becomes_finer_on_both_sides_of_the_best(tmp_path: Path) -> None:
    before = laid_out(tmp_path)
    grid = list(places_of(before, "warm_up", "time_constant"))
    low, best, high = grid[5:8]
    after = around(before, best)
    new = sorted(set(places_of(after, "warm_up", "time_constant")) - set(grid))
    below, above = [value for value in new if value < best], [value for value in new if value > best]
    assert_allclose(below, [best - (best - low) * share for share in (0.75, 0.5, 0.25, 0.1)])
    assert_allclose(above, [best + (high - best) * share for share in (0.1, 0.25, 0.5, 0.75)])
    for term in after.terms[len(before.terms) :]:
        exact = 1 - np.exp(-BENCH.time * 3600 / term.shape["time_constant"])
        assert_allclose(term.curves[0]["deflection"], exact, rtol=1e-9)  # of the model, not interpolated
    assert after.columns[: len(before.columns)] == before.columns
    assert after.term_pieces[: len(before.term_pieces)] == before.term_pieces


def test_at_the_end_of_a_grid_values_are_added_on_its_inner_side(tmp_path: Path) -> None:
    before = laid_out(tmp_path)
    grid = list(places_of(before, "warm_up", "time_constant"))
    for end, (low, high) in ((grid[0], (grid[0], grid[1])), (grid[-1], (grid[-2], grid[-1]))):
        new = set(places_of(around(before, end), "warm_up", "time_constant")) - set(grid)
        assert len(new) == 4
        assert all(low < value < high for value in new)


def test_a_grid_that_is_fine_enough_stays_as_it_is(tmp_path: Path) -> None:
    """Every round brings the neighbours ten times nearer; below a ten-thousandth no two curves differ."""
    problem = laid_out(tmp_path)
    best = list(places_of(problem, "warm_up", "time_constant"))[6]
    sizes = [len(problem.terms)]
    while len(sizes) < 9:
        problem = around(problem, best)
        sizes.append(len(problem.terms))
    added = np.diff(sizes)
    assert added[0] == 8
    assert added[-1] == 0
    assert (np.diff(added) <= 0).all()
    steps = [(b - a) / a for a, b in pairwise(places_of(problem, "warm_up", "time_constant"))]
    assert FINEST / 10 < min(steps) <= FINEST


def test_whole_numbers_and_places_of_steps_do_not_become_finer(tmp_path: Path) -> None:
    problem = laid_out(tmp_path)
    names = {"step", "periodic_order_of_rotation", "lead_error"}
    pieces = [piece for piece in problem.term_pieces if problem.candidates[piece.owner].name in names]
    assert len(pieces) > 80
    assert sharpened(problem, pieces) == problem


@pytest.mark.parametrize(
    ("time_constant", "rise"),
    [
        *((hours, 100.0) for hours in (0.14, 0.23, 1.7, 6.2, 12.0)),
        (0.23, 500.0),
        (6.2, 500.0),
    ],
)
def test_a_large_effect_between_two_values_of_its_grid_is_named_alone(
    tmp_path: Path, time_constant: float, rise: float
) -> None:
    found = PROPER.diagnosed(tmp_path, read(rise * (1 - np.exp(-BENCH.time / time_constant))))
    assert name_sets(found) == [{"warm_up"}]
    size, hours = found.causes[0].unknowns
    assert size.low is not None
    assert size.high is not None
    assert size.low <= rise * UM <= size.high
    assert hours.low is not None
    assert hours.high is not None
    assert hours.low <= time_constant * 3600 <= hours.high
    assert found.wrong[0].noise.autocorrelation == 0
    assert_allclose(found.wrong[0].noise_floor.value / UM, 1, atol=4 / np.sqrt(2 * 150))


@pytest.mark.parametrize("time_constant", [0.14, 1.7, 6.2, 12.0])
def test_without_the_finer_grid_something_else_would_take_what_is_left(tmp_path: Path, time_constant: float) -> None:
    begin = start_of(tmp_path, read(100 * (1 - np.exp(-BENCH.time / time_constant))))
    names = []
    for sharpen in (False, True):
        full = contest(begin.problem, begin.noise, begin.rows, sharpen=sharpen)
        best = full.found.best()
        pieces = full.found.hypotheses[best].pieces
        names.append(([names_of_piece(full, piece) for piece in pieces if piece.kind == "term"], len(pieces)))
        if sharpen:
            assert SETTINGS[full.found.setting[best][0]] == Setting()
    assert names[1] == ([("warm_up",)], 1)
    assert names[0] != names[1]


# A second cause that may be zero


def pair_of(full: Contest, first: str, second: str) -> int:
    """The place of the best pair of these causes, whichever of their names they go by."""

    def is_it(item: Hypothesis) -> bool:
        names = [names_of_piece(full, piece) for piece in item.pieces] if item.kind == "two" else []
        return any(first in each for each in names) and any(second in each for each in names)

    return full.found.best(is_it)


def decision_for(winner: int) -> Decision:
    return Decision(winner, 0.001, 0.02, Null(np.zeros(3), 0.001), Thresholds(1.0, 0.5))


@pytest.mark.parametrize(("growth", "stays"), [(0.0, False), (0.3, True)])
def test_a_second_cause_whose_interval_contains_zero_is_dropped(tmp_path: Path, growth: float, stays: bool) -> None:
    """Growth per K with 1 um of noise over 150 rows and 15..45 degC: a standard error of about 0.005 um/K."""
    error = 0.05 * BENCH.travel + growth * (BENCH.temperature - 20)
    one = Asked(drive_model(tolerances={}))
    full = plain_contest(one, one.records(tmp_path, read(error)), UM)
    pair = pair_of(full, "lead_error", "thermal_growth")
    alone = full.found.best(lambda hypothesis: len(hypothesis.pieces) == 1)
    design = np.column_stack([BENCH.travel, BENCH.temperature - 20])
    size = np.linalg.lstsq(design, error + noise())[0][1]
    by_hand = t.ppf(0.975, 148) * np.sqrt(np.linalg.inv(design.T @ design)[1, 1])  # with noise of 1 um
    assert (abs(size) > by_hand) == stays
    fitted = fit(full, pair)
    pieces = fitted.hypothesis.pieces
    certain = {names_of_piece(full, piece)[0] for place, piece in enumerate(pieces) if not may_be_zero(fitted, place)}
    assert certain == ({"lead_error", "thermal_drift"} if stays else {"lead_error"})  # growth goes by this name
    asked = decision_for(pair)
    best, decided = _certain(full, asked)
    assert decided == replace(asked, winner=pair if stays else alone)
    assert best.hypothesis == full.found.hypotheses[decided.winner]
    if not stays:
        assert names_of_piece(full, best.hypothesis.pieces[0]) == ("lead_error",)
        assert _certain(full, decided)[1] == decided


# One curve under several names


def eccentricity(screw: Drive, base: Deflection, *, sine: Float, cosine: Float) -> Deflection:
    """Go round with the screw, once per turn."""
    wave = sine * np.sin(screw.rotation) + cosine * np.cos(screw.rotation)
    return replace(base, deflection=base.deflection + wave)


def test_the_first_order_of_a_gauge_goes_by_the_name_of_the_models_own(tmp_path: Path) -> None:
    """Orders 2 and 3 are nobody else's and stay."""
    model = drive_model(["lead_error"])
    known = [Unknown("sine", -50, 50, "um"), Unknown("cosine", -50, 50, "um")]
    own = Effect("eccentricity", on_results=eccentricity, unknowns=known)
    orders = {}
    for errors in (model.errors, [*model.errors, own]):
        asked = Asked(replace(model, errors=errors))
        found = problem_of(machine_of(asked.setup, asked.records(tmp_path, read())), {"deflection": UM})
        names = {found.candidates[place].name: same for place, same in found.same_as.items()}
        orders[len(errors)] = list(places_of(found, "periodic_order_of_rotation", "deflection_order"))
        assert names["periodic_order_of_rotation"] == ()
    assert list(orders.values()) == [[1, 2, 3], [2, 3]]
    assert names["eccentricity"] == ("periodic_order_of_rotation",)
    assert len([each for each in found.term_pieces if found.candidates[each.owner].name == "eccentricity"]) == 1


# The machine as it is


def test_a_gauge_that_is_off_by_millimetres_does_not_drive_inputs_out_of_their_tolerances(tmp_path: Path) -> None:
    """A load of one sign makes an offset look like a soft contact: by least squares one off by dozens."""
    begin = start_of(tmp_path, read(5000, replace(BENCH, load=np.abs(BENCH.load) + 1)))
    full = contest(begin.problem, begin.noise, begin.rows)
    freely = full.evidence.directions @ full.solution(0).directions
    base = full.base()
    assert np.abs(freely).max() > 20
    assert np.abs(full.evidence.directions @ base.directions).max() < 1
    (moved,) = base.fitted
    assert np.abs(moved).max() * full.evidence.channels[0].scale / UM < 2  # one deviation of both inputs at 20 kN


# What rows and filters are worth


@pytest.mark.parametrize(("clipped", "worth"), [(0.0, 150), (0.1, 121.5), (0.5, 37.5)])
def test_rows_of_which_some_are_clipped_count_less(tmp_path: Path, clipped: float, worth: float) -> None:
    """The variance of an estimate from clipped innovations is divided by the square of the share not clipped (Huber).

    Its weight in a likelihood, rows times the logarithm of the variance, must not be that of all rows.
    """
    begin = start_of(tmp_path, read())
    learnt = replace(begin.noise, tails={"deflection": Tails(3.0, 1.9, clipped)})
    evidence = evidence_of(begin.problem, learnt, begin.rows)
    assert_allclose(evidence.counts, [worth])
    assert_allclose(evidence.case(WHITE).rows, [worth])
    assert evidence.rows == 150


@pytest.mark.parametrize(("setting", "parameters"), [(Setting(), 0), (Setting(0.6), 1), (Setting(0.9, 0.5), 2)])
def test_a_noise_filter_pays_for_its_parameters(tmp_path: Path, setting: Setting, parameters: int) -> None:
    """Beside the determinant of its covariance, the logarithm of the rows for each, as any explanation does (BIC)."""
    begin = start_of(tmp_path, read(), ["a"] * 60 + ["b"] * 90)
    (channel,) = evidence_of(begin.problem, begin.noise, begin.rows).channels
    (found,) = products_of(channel, [setting])
    filter_ = whiten(np.eye(150), channel.starts, setting)
    determinant = np.linalg.slogdet(filter_)[1] + np.log(channel.weights).sum()
    assert_allclose(2 * determinant - found.constant, parameters * log(150), atol=1e-9)
