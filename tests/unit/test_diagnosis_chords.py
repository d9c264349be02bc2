"""Effects that are not in proportion to their size: one that begins late, and one that is so large that it has bent."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from truing import Effect, Float, Model, Unknown, found, given, inputs, results
from truing.diagnosis.chords import are_faint, late_terms
from truing.diagnosis.engine import diagnose
from truing.diagnosis.grids import terms_of
from truing.diagnosis.machine import machine_of
from truing.diagnosis.problem import problem_of
from truing.diagnosis.reading import read_records
from truing.diagnosis.result import Diagnosis
from truing.kernel import Offer, Origin
from truing.setup import Setup, default_setup

Array = NDArray[np.float64]
FIRST_FELT = 5.0
NOISE = 0.5  # um


@inputs
class Bearing:
    """A bearing that loses height with the path, and less of it where a film carries."""

    path: Float = given(0.0, "km")
    speed: Float = given(1.0, "m/s", above=0)
    film: Float = given(0.0, "", note="neutral 0: thickness over that of the formula")
    growth: Float = given(0.0, "1/km", note="neutral 0: of the rate of wear")


@results
class Height:
    """What is lost."""

    lost: Float = found("um")


def worn(path_km: Float, speed: Float, film: Float, growth: Float) -> Float:
    """um: a micrometre per km, less by the film from a felt thickness on, growing exponentially."""
    carried = np.clip((film * speed - FIRST_FELT) / 10.0, 0.0, 1.0)
    grown = np.where(growth == 0, path_km, np.expm1(growth * path_km) / np.where(growth == 0, 1.0, growth))
    return (1.0 - carried) * grown


def bearing(it: Bearing) -> Height:
    """Lose height."""
    return Height(lost=1e-6 * worn(it.path / 1e3, it.speed, it.film, it.growth * 1e3))


def filmed(it: Bearing, *, thickness: Float) -> Bearing:
    return replace(it, film=it.film + thickness)


def hastened(it: Bearing, *, growth: Float) -> Bearing:
    return replace(it, growth=it.growth + growth)


def slowed(it: Bearing, *, share: Float) -> Bearing:
    return replace(it, path=it.path * (1 - share))


EFFECTS = [
    Effect("filmed", on_inputs=filmed, unknowns=[Unknown("thickness", 0, 20)]),
    Effect("hastened", on_inputs=hastened, unknowns=[Unknown("growth", 0, 0.5, "1/km")]),
    Effect("slowed", on_inputs=slowed, unknowns=[Unknown("share", 0, 1)]),
]
MODEL = Model(name="bearing", title="Bearing", function=bearing, errors=EFFECTS)


def setup_and_file(folder: Path, film: float, growth: float) -> tuple[Offer, Setup, Path]:
    """Rows of a bearing with this film and growth, with the noise of its gauge."""
    rng = np.random.default_rng(8)
    path, speed = np.sort(rng.uniform(0, 20, 80)), rng.uniform(0.3, 2.0, 80)
    lost = worn(path, speed, film, growth) + rng.normal(0, NOISE, 80)
    lines = [",".join(repr(float(cell)) for cell in row) for row in zip(path, speed, lost, strict=True)]
    file = folder / "record.csv"
    file.write_text("\n".join(["path [km],speed [m/s],lost [um]", *lines]) + "\n", encoding="utf-8")
    offer = Offer("bearing", MODEL, Origin("bearing", "1.0", "bearings", "bearing.py", "entry:bearing"))
    return offer, default_setup(MODEL, offer.origin), file


def asked(folder: Path, film: float = 0.0, growth: float = 0.0) -> Diagnosis:
    offer, setup, file = setup_and_file(folder, film, growth)
    return diagnose(setup, read_records([file], offer, setup))


@pytest.mark.parametrize(
    ("film", "growth", "name"), [(8.0, 0.0, "filmed"), (13.0, 0.0, "filmed"), (0.0, 0.05, "hastened")]
)
def test_a_cause_that_is_not_in_proportion_to_its_size_is_named_alone(
    tmp_path: Path, film: float, growth: float, name: str
) -> None:
    """A film has no slope at no film; exp(1) is far from its slope: what that leaves is no second cause."""
    answer = asked(tmp_path, film, growth)
    assert answer.verdict in {"named", "one_of"}
    (cause,) = answer.causes
    assert (cause.effect, answer.remainder) == (name, None)
    (unknown,) = cause.unknowns
    size = film or growth / 1e3
    assert unknown.low is not None
    assert unknown.high is not None
    half = (unknown.high - unknown.low) / 2
    assert abs(unknown.value - size) < 1.5 * half  # three standard errors
    assert half < 0.2 * size


def test_a_film_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    answer = asked(tmp_path)
    assert (answer.causes, answer.remainder) == ((), None)


def test_chords_are_those_of_the_exact_curve(tmp_path: Path) -> None:
    offer, setup, file = setup_and_file(tmp_path, 0.0, 0.0)
    records = read_records([file], offer, setup)
    machine, scales = machine_of(setup, records), {"lost": NOISE * 1e-6}
    problem = problem_of(machine, scales)
    place = next(at for at, item in enumerate(problem.candidates) if item.name == "filmed")
    candidate = problem.candidates[place]
    assert are_faint(terms_of(place, candidate, machine, scales), scales)
    chords = late_terms(place, candidate, machine, scales)
    assert [term.at for term in chords] == pytest.approx([20.0, 12.0, 7.0, 4.0])  # of 2.0 nothing is felt
    path, speed = (np.asarray(records.rows.columns[name], dtype=float) for name in ("path", "speed"))
    for term in chords:
        change = 1e-6 * (worn(path / 1e3, speed, term.at, 0.0) - worn(path / 1e3, speed, 0.0, 0.0))
        assert np.asarray(term.curves[0]["lost"]) * term.at == pytest.approx(change, abs=1e-15)
        assert (term.low[0], term.high[0] * term.per[0]) == pytest.approx((0.0, 20.0))


def test_an_effect_whose_slope_shows_has_no_late_chords(tmp_path: Path) -> None:
    offer, setup, file = setup_and_file(tmp_path, 0.0, 0.0)
    problem = problem_of(machine_of(setup, read_records([file], offer, setup)), {"lost": NOISE * 1e-6})
    for name, many in (("filmed", 4), ("hastened", 1)):
        own = [term for term in problem.terms if problem.candidates[term.candidate].name == name]
        assert len(own) == many
        assert all((term.at != 0) == (name == "filmed") for term in own)
