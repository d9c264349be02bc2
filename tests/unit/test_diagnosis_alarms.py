"""Every alarm: a record at which it must sound, and one beside it at which it must not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    HEADER,
    UM,
    Array,
    Asked,
    chosen_as,
    drive_model,
    fit_of,
    name_sets,
    of_size_one,
    plain_competition,
    wander,
    wide,
)
from diagnosis_samples import named
from numpy.testing import assert_allclose

from truing.diagnosis.choice import Chosen
from truing.diagnosis.engine import _answer
from truing.diagnosis.gain import CONTRADICTING, FEWEST_PER_NUMBER, contradictions_of, every_second, thinned_of
from truing.diagnosis.noise import SETTINGS, Autocorrelation
from truing.diagnosis.result import Amount, Contradiction, DiagnosisResult, Thinned, Trade
from truing.diagnosis.visibility import TRADED, trades_of
from truing.report.diagnosis_words import headline
from truing.runs.diagnosis_document import diagnosis_document
from truing.setup import DiagnoseOptions
from truing.studies.bench import silent

ROWS = 160
BENCH = wide(ROWS, seed=51)
NOISE = of_size_one(np.random.default_rng(51), ROWS)
"""um."""
COLD = replace(BENCH, temperature=np.full(ROWS, 20.0))
LEAD = 0.05
"""um/mm: over the stroke of 300 mm, fifteen times the noise."""


def asked(effects: Sequence[str] = ("lead_error",), tolerances: Mapping[str, str] | None = None) -> Asked:
    """A drive with few errors, so that a search is short."""
    return Asked(drive_model(effects, tolerances or {}))


def taken(
    folder: Path, one: Asked, columns: Mapping[str, Array], name: str, *others: str, runs: Sequence[str] = ()
) -> Chosen:
    """One cause as if it had been chosen, others fitted beside it, in white noise of 1 um."""
    made = one.competing(folder, columns, runs)
    for other in others:
        fit_of(made, other)
    return chosen_as(made, fit_of(made, name))


def answered(chosen: Chosen) -> DiagnosisResult:
    """What a diagnosis answers with this choice."""
    return _answer(chosen, chosen.competition.sample.machine.design, silent)


def is_told(found: DiagnosisResult, words: str) -> bool:
    """Whether an alarm with these words, and no other one, takes the name of a cause."""
    assert len(found.causes) == 1
    sounded = [each for each in found.warnings if words in each]
    assert list(found.warnings) == sounded
    assert replace(found, alternatives=()).verdict == ("undecided" if sounded else "named")
    return bool(sounded)


@pytest.mark.parametrize(
    ("lead", "held_out", "off", "noise", "stated", "words"),
    [
        (10.0, 10.0, 0.0, 1.0, 1.8, "lead of lead_error was fitted at the bound"),
        (LEAD, LEAD, 3.6, 0.1, 0.18, "contact had to move 3.6 times as far"),
        (LEAD, -LEAD, 0.0, 1.0, 1.8, "on the rows held out the error of deflection grows"),
        (LEAD, LEAD, 0.0, 1.0, 2.4, "is far below the scatter stated for it, 2.4 um"),
        (9.7, 9.7, 2.4, 1.0, 1.8, ""),
    ],
    ids=["at its bound", "input far off", "other machine", "less noise than stated", "nothing"],
)
def test_an_alarm_sounds_alone(
    tmp_path: Path, lead: float, held_out: float, off: float, noise: float, stated: float, words: str
) -> None:
    """Nearer to the bound of 10 um/mm than 0.5 % of 20; more than three times its 3 %; below half of what is stated.

    Of the rows held out the lead is that of another machine, or the same.
    """
    one = replace(
        asked(tolerances={"contact": "3 %"}), diagnose=DiagnoseOptions(hold_out="run = b"),
        units={**HEADER, "sigma_deflection": "um"},
    )  # fmt: skip
    error = np.where(np.arange(ROWS) < 120, lead, held_out) * BENCH.travel + noise * NOISE
    columns = COLD.shown(error, contact=3.0 * (1 + 0.03 * off)) | {"sigma_deflection": np.full(ROWS, stated)}
    found = answered(taken(tmp_path, one, columns, "lead_error", runs=["a"] * 120 + ["b"] * 40))
    assert is_told(found, words or "no warning has these words") is bool(words)


@pytest.mark.parametrize(("first", "sounds"), [(0.0, True), (10.0, False)])
def test_an_error_that_grows_in_the_folds(tmp_path: Path, first: float, sounds: bool) -> None:
    """Two warm rows: what is learnt of the second, 12 um, says 12 um of the first, where there is nothing."""
    temperature = 20 + np.sin(np.arange(ROWS))
    error, warm = NOISE.copy(), [20, 65]
    temperature[warm], error[warm] = 45.0, (first, 12.0)
    columns = replace(BENCH, temperature=temperature).shown(error)
    found = answered(taken(tmp_path, asked(["thermal_growth"]), columns, "thermal_growth"))
    assert is_told(found, "on rows that were not fitted the error of deflection grows") is sounds


@pytest.mark.parametrize(("name", "sounds"), [("thermal_growth", True), ("lead_error", False)])
def test_folds_that_name_something_else(tmp_path: Path, name: str, sounds: bool) -> None:
    """What is there is chosen in every fold, whatever was chosen of all rows."""
    one = asked(["lead_error", "thermal_growth"])
    columns = BENCH.shown(LEAD * BENCH.travel + 0.2 * (BENCH.temperature - 20) + NOISE)
    found = answered(taken(tmp_path, one, columns, name, "lead_error"))
    assert found.stability == (0.0 if sounds else 1.0)
    assert any("the record names the same causes never" in each for each in found.warnings) is sounds


SWAP = np.where(np.arange(ROWS) % 2, 1.0, -1.0)
WARM = BENCH.temperature - 20


def left_by(curve: Array, error: Array) -> float:
    """-2 log likelihood of what least squares leave of an error, but for a constant."""
    left = error - curve * (curve @ error) / (curve @ curve)
    return float(len(left) * np.log(left @ left))


@pytest.mark.parametrize(
    ("sign", "sounds"), [(SWAP, True), (-SWAP, True), (np.random.default_rng(52).permutation(SWAP), False)]
)
def test_every_second_row_says_something_else(tmp_path: Path, sign: Array, sounds: bool) -> None:
    """A little of the travel, and 0.3 um/K of one sign and the other in turn, which cancels over all rows."""
    one = asked(["lead_error", "thermal_growth"])
    error = 0.01 * BENCH.travel + 0.3 * sign * WARM + NOISE
    chosen = taken(tmp_path, one, BENCH.shown(error), "lead_error", "thermal_growth")
    told = thinned_of(chosen)
    assert bool(told) is sounds
    assert {each.rows for each in told} == (
        {"every second row, from the first", "every second row, from the second"} if sounds else set()
    )
    for begin, each in enumerate(told):
        rows = slice(begin, None, 2)
        costs = [left_by(curve[rows], error[rows]) for curve in (BENCH.travel, WARM)]
        assert each.causes == ("thermal_growth",)
        assert each.ahead == pytest.approx(costs[0] - costs[1], abs=0.02)
    assert (
        any("explains more: rows that should say the same do not" in each for each in answered(chosen).warnings)
        is sounds
    )


@pytest.mark.parametrize(("size", "sounds"), [(2.0, True), (0.0, False)])
def test_a_wave_that_is_left(tmp_path: Path, size: float, sounds: bool) -> None:
    """Twelve waves over the travel; they are no alarm, and take no name."""
    wave = size * np.sin(2 * np.pi * 12 * np.argsort(np.argsort(BENCH.travel)) / ROWS)
    found = answered(taken(tmp_path, asked(), COLD.shown(LEAD * BENCH.travel + wave + NOISE), "lead_error"))
    assert any("there are 12 waves over the range of travel" in each for each in found.warnings) is sounds
    assert ("12 waves over the range of travel" in " ".join(headline(found))) is sounds
    assert found.verdict == "named"


def test_few_rows_are_not_thinned(tmp_path: Path) -> None:
    """Ten rows for the one number in either half."""
    one = asked(["lead_error", "thermal_growth"])
    for rows, is_told in ((18, False), (20, True)):
        columns = {name: column[:rows] for name, column in BENCH.shown(0.01 * BENCH.travel + 2 * SWAP * WARM).items()}
        folder = tmp_path / str(rows)
        folder.mkdir()
        assert bool(thinned_of(taken(folder, one, columns, "lead_error", "thermal_growth"))) is is_told


@pytest.mark.parametrize(("sign", "sounds"), [(SWAP, True), (np.abs(SWAP), False)])
def test_rows_that_are_thinned_may_be_censored(tmp_path: Path, sign: Array, sounds: bool) -> None:
    """A gauge that ends at the top tenth of the readings."""
    one = asked(["lead_error", "thermal_growth"])
    error = 0.01 * BENCH.travel + 0.3 * sign * WARM + NOISE
    columns = dict(BENCH.shown(error))
    end = float(np.quantile(columns["deflection"], 0.9))
    sides = (columns["deflection"] > end).astype(np.int8)
    columns["deflection"] = np.minimum(columns["deflection"], end)
    records = replace(one.records(tmp_path, columns), sides={"deflection": sides})
    made = plain_competition(one, records, UM)
    fits = {name: fit_of(made, name) for name in ("lead_error", "thermal_growth")}
    told = thinned_of(chosen_as(made, fits["lead_error" if sounds else "thermal_growth"]))
    assert bool(told) is sounds


@pytest.mark.parametrize("memory", SETTINGS, ids=str)
def test_every_second_value_of_noise_is_as_alike_as_before(memory: Autocorrelation) -> None:
    """Autocorrelations from the response to an impulse: those of lag 2k are those of lag k."""

    def lag(setting: Autocorrelation, k: int) -> float:
        rho, theta = setting.rho, setting.theta
        impulse = np.array([1.0, *((rho - theta) * rho**step for step in range(400))])
        return float(impulse[k:] @ impulse[: len(impulse) - k] / (impulse @ impulse))

    thinned = every_second(memory)
    assert_allclose([lag(thinned, k) for k in (1, 2, 5)], [lag(memory, 2 * k) for k in (1, 2, 5)], atol=1e-12)


def test_slow_noise_is_nearly_a_random_walk_and_no_contradiction_of_thinned_rows(tmp_path: Path) -> None:
    """Every second row of noise with a memory holds as little of a slow cause as all rows do."""
    error = LEAD * BENCH.travel + wander(np.random.default_rng(53), ROWS, 0.97)
    found = asked(["lead_error", "warm_up"]).diagnosed(tmp_path, COLD.shown(error))
    assert is_told(found, "the scatter of deflection wanders slowly")
    assert found.thinned == ()


# A cause that trades against an input: an error of the lead, and the zero of the gauge, far from the beginning

TRAVEL = np.random.default_rng(55).uniform(200, 300, ROWS)
FAR = replace(COLD, travel=TRAVEL)
BOTH = np.column_stack([TRAVEL, np.ones(ROWS)])
ASIDE = NOISE - BOTH @ np.linalg.lstsq(BOTH, NOISE, rcond=None)[0]
ASIDE /= np.sqrt(np.mean(ASIDE**2))
"""Noise of 1 um in which there is nothing of the lead and of the zero."""
SMALL, LARGE = 0.0125, 0.02
"""um/mm: 4.5 and 7.2 standard errors, if nothing is known of the zero."""


def by_hand(lead: float, sd: float) -> tuple[float, float]:
    """Correlation of lead and zero, and the squares that are lost without the lead; a zero of this tolerance, um."""
    covariance = np.linalg.inv(BOTH.T @ BOTH + np.diag([0, sd**-2]))
    correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    return float(correlation), float(lead**2 / covariance[0, 0])


@pytest.mark.parametrize(
    ("lead", "sd", "sounds"),
    [(SMALL, 1000.0, True), (LARGE, 1000.0, False), (SMALL, 0.05, False), (LARGE, 0.05, False)],
)
def test_a_cause_trades_against_an_input(tmp_path: Path, lead: float, sd: float, sounds: bool) -> None:
    """A zero that is known to 0.05 um, or a lead that is seen with any zero, trades against nothing."""
    correlation, separation = by_hand(lead, sd)
    assert (abs(correlation) > TRADED, separation < 25) == (sd > 1, lead == SMALL and sd > 1)
    one = asked(tolerances={"zero": f"{sd} um"})
    found = answered(taken(tmp_path, one, FAR.shown(lead * TRAVEL + ASIDE), "lead_error"))
    assert is_told(found, "lead of lead_error and zero can stand for one another") is sounds
    for each in found.trades:
        assert (each.effect, each.unknown, each.input) == ("lead_error", "lead", "zero")
        assert each.correlation == pytest.approx(correlation, abs=2e-3)
        assert each.separation == pytest.approx(separation, rel=0.15)


def test_an_input_that_is_a_cause_itself_trades_against_nothing(tmp_path: Path) -> None:
    one = asked(tolerances={"zero": "1000 um"})
    made = one.competing(tmp_path, FAR.shown(SMALL * TRAVEL + ASIDE))
    assert trades_of(chosen_as(made, fit_of(made, "lead_error")))
    assert trades_of(chosen_as(made, fit_of(made, "input:zero"))) == ()
    assert trades_of(chosen_as(made, made.null)) == ()


def test_alarms_are_data() -> None:
    """Numbers of the document in the units that stand beside them."""
    fields = ("contradictions", "thinned", "trades")
    plain = diagnosis_document(named())
    assert [plain[field] for field in fields] == [[], [], []]
    first, second = named().wrong
    made = replace(
        named(),
        contradictions=(Contradiction("rod_heating", "expansion", Amount(8e-6, "um/(m*K)"), Amount(15e-6, "1/K")),),
        thinned=(Thinned("every second row, from the first", ("sensor_drift", "unknown"), 7.5),),
        trades=(Trade("rod_heating", "expansion", "rod", -0.97, 14.5),),
        wrong=(replace(first, stated=Amount(15e-6, "um")), second),
    )
    document = diagnosis_document(made)
    (apart,), (thinned,), (trade,) = (document[field] for field in fields)
    assert (apart["effect"], apart["unknown"]) == ("rod_heating", "expansion")
    assert apart["first"] == {"value": pytest.approx(8.0), "unit": "um/(m*K)"}
    assert apart["second"] == {"value": pytest.approx(15e-6), "unit": "1/K"}
    assert (thinned, trade) == (
        {"rows": "every second row, from the first", "causes": ["sensor_drift", "unknown"], "ahead": 7.5},
        {"effect": "rod_heating", "unknown": "expansion", "input": "rod", "correlation": -0.97, "separation": 14.5},
    )
    stated = [item["stated_noise"] for item in document["wrong"].values()]
    assert stated == [{"value": pytest.approx(15.0), "unit": "um"}, None]
    assert len(document["warnings"]) == len(document["undecided"]) == 4


# Whether the two halves of a record say the same: sizes of a cause in each, by least squares.

IS_LATE = np.arange(ROWS) >= ROWS // 2


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


def lead_taken(folder: Path, error: Array, rows: Array | slice = slice(None)) -> Chosen:
    """The lead as if it had been chosen."""
    return taken(folder, asked(), {name: column[rows] for name, column in COLD.shown(error).items()}, "lead_error")


@pytest.mark.parametrize(
    ("by", "is_apart"), [(0.0, False), (0.7 * CONTRADICTING, False), (1.4 * CONTRADICTING, True), (30.0, True)]
)
def test_halves_contradict_where_a_size_differs_by_more_than_four_standard_errors(
    tmp_path: Path, by: float, is_apart: bool
) -> None:
    error = changing(by)
    found = answered(lead_taken(tmp_path, error))
    assert is_told(found, "in one half of the rows") is is_apart
    for each in found.contradictions:
        assert (each.effect, each.unknown, each.first.unit) == ("lead_error", "lead", "um/mm")
        by_hand = [lead_of(error, rows)[0] * 1e-3 for rows in (~IS_LATE, IS_LATE)]
        assert_allclose([each.first.value, each.second.value], by_hand, rtol=1e-3)


def test_halves_of_few_rows_say_nothing(tmp_path: Path) -> None:
    """Ten rows for the one number in either half."""
    error, middle = changing(60.0), ROWS // 2
    for rows, is_told in ((2 * FEWEST_PER_NUMBER - 2, False), (2 * FEWEST_PER_NUMBER, True)):
        around = slice(middle - rows // 2, middle + rows // 2)
        assert bool(contradictions_of(lead_taken(tmp_path, error, around))) is is_told


def test_rows_without_an_order_are_parted_at_random(tmp_path: Path) -> None:
    """What changes from the first rows of a file to the last means nothing where rows have no order."""
    chosen = lead_taken(tmp_path, changing(30.0))
    machine = chosen.best.sample.machine
    timeless = {name: item for name, item in machine.records.covariates.items() if item.role != "time"}
    unordered = replace(machine, records=replace(machine.records, covariates=timeless))
    best = replace(chosen.best, sample=replace(chosen.best.sample, machine=unordered))
    assert contradictions_of(chosen)
    assert contradictions_of(replace(chosen, best=best)) == ()


def test_consistent_halves_leave_a_cause_its_name(tmp_path: Path) -> None:
    error = LEAD * BENCH.travel + NOISE
    found = answered(taken(tmp_path, asked(["lead_error", "clearance"]), COLD.shown(error), "lead_error", "clearance"))
    assert (name_sets(found), found.contradictions, found.verdict) == ([{"lead_error"}], (), "named")
    (wrong,) = found.wrong  # of its mean square all but the noise can go
    assert_allclose(wrong.reducible_share, 1 - (NOISE @ NOISE) / (error @ error), rtol=0, atol=0.002)
