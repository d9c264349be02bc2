"""Effects that are not in proportion to their size: one that begins late, and one that is so large that it has bent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from truing import Effect, Float, Model, Unknown, found, given, inputs, results
from truing.diagnosis.causes import Candidate, effects_of
from truing.diagnosis.conditional import look
from truing.diagnosis.curves import ResponseCurves
from truing.diagnosis.engine import diagnose
from truing.diagnosis.exact import nothing
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.reading import read_records
from truing.diagnosis.result import DiagnosisResult
from truing.diagnosis.sample import sample_of
from truing.kernel import Offer, Origin
from truing.setup import Setup, default_setup

Array = NDArray[np.float64]
FIRST_FELT = 5.0
MOST_CLOGGED = 1e7  # um
NOISE = 0.5  # um


@inputs
class Bearing:
    """A bearing that loses height with the path, and less of it where a film carries."""

    path: Float = given(0.0, "km")
    speed: Float = given(1.0, "m/s", above=0)
    film: Float = given(0.0, "", note="neutral 0: thickness over that of the formula")
    growth: Float = given(0.0, "1/km", note="neutral 0: of the rate of wear")
    clog: Float = given(0.0, "um/km", note="neutral 0: worn beside, which ends at ten metres")


@results
class Height:
    """What is lost."""

    lost: Float = found("um")


def worn(path_km: Float, speed: Float, film: Float, growth: Float, clog: Float = 0.0) -> Float:
    """um: a micrometre per km, less by the film from a felt thickness on, growing; more where it clogs, to a bound."""
    carried = np.clip((film * speed - FIRST_FELT) / 10.0, 0.0, 1.0)
    grown = np.where(growth == 0, path_km, np.expm1(growth * path_km) / np.where(growth == 0, 1.0, growth))
    return (1.0 - carried) * grown + clog * path_km * speed / (1.0 + clog * path_km * speed / MOST_CLOGGED)


def bearing(it: Bearing) -> Height:
    """Lose height."""
    return Height(lost=1e-6 * worn(it.path / 1e3, it.speed, it.film, it.growth * 1e3, it.clog * 1e9))


def filmed(it: Bearing, *, thickness: Float) -> Bearing:
    return replace(it, film=it.film + thickness)


def hastened(it: Bearing, *, growth: Float) -> Bearing:
    return replace(it, growth=it.growth + growth)


def clogging(it: Bearing, *, rate: Float) -> Bearing:
    return replace(it, clog=it.clog + rate)


def slowed(it: Bearing, *, share: Float) -> Bearing:
    return replace(it, path=it.path * (1 - share))


EFFECTS = [
    Effect("filmed", on_inputs=filmed, unknowns=[Unknown("thickness", 0, 20)]),
    Effect("hastened", on_inputs=hastened, unknowns=[Unknown("growth", 0, 0.5, "1/km")]),
    Effect("slowed", on_inputs=slowed, unknowns=[Unknown("share", 0, 1)]),
]
MODEL = Model(name="bearing", title="Bearing", function=bearing, errors=EFFECTS)


def setup_and_file(
    folder: Path, film: float, growth: float, clog: float = 0.0, effects: Sequence[Effect] = EFFECTS
) -> tuple[Offer, Setup, Path]:
    """Rows of a bearing with this film, growth and clogging, with the noise of its gauge."""
    rng = np.random.default_rng(8)
    path, speed = np.sort(rng.uniform(0, 20, 80)), rng.uniform(0.3, 2.0, 80)
    lost = worn(path, speed, film, growth, clog) + rng.normal(0, NOISE, 80)
    lines = [",".join(repr(float(cell)) for cell in row) for row in zip(path, speed, lost, strict=True)]
    file = folder / "record.csv"
    file.write_text("\n".join(["path [km],speed [m/s],lost [um]", *lines]) + "\n", encoding="utf-8")
    model = replace(MODEL, errors=list(effects))
    offer = Offer("bearing", model, Origin("bearing", "1.0", "bearings", "bearing.py", "entry:bearing"))
    return offer, default_setup(model, offer.origin), file


def asked(
    folder: Path, film: float = 0.0, growth: float = 0.0, clog: float = 0.0, effects: Sequence[Effect] = EFFECTS
) -> DiagnosisResult:
    offer, setup, file = setup_and_file(folder, film, growth, clog, effects)
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


def test_a_cause_far_below_the_smallest_size_looked_at_is_fitted(tmp_path: Path) -> None:
    """Its bound is ten million times what is there: it bends at every size looked at, and is a line where it is."""
    clogged = Effect("clogged", on_inputs=clogging, unknowns=[Unknown("rate", 0, 1e6, "um/km")])
    answer = asked(tmp_path, clog=0.2, effects=[*EFFECTS, clogged])
    (cause,) = answer.causes
    assert cause.effect == "clogged"
    (unknown,) = cause.unknowns
    assert unknown.low is not None
    assert unknown.high is not None
    half = (unknown.high - unknown.low) / 2
    assert abs(unknown.value - 0.2e-9) < 1.5 * half  # three standard errors
    assert half < 0.2 * 0.2e-9


def test_a_film_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    answer = asked(tmp_path)
    assert (answer.causes, answer.remainder) == ((), None)


def curves_of(folder: Path, film: float = 0.0) -> tuple[dict[str, Candidate], ResponseCurves, Fit, Array, Array]:
    """The effects by name, their curves, the model as it is, and path and speed of every row, SI."""
    offer, setup, file = setup_and_file(folder, film, 0.0)
    records = read_records([file], offer, setup)
    machine = calibration_of(setup, records)
    extended = Extended(machine)
    sample = sample_of(machine, first_noise(machine), np.ones(len(records), dtype=bool))
    causes = {cause.name: cause for cause in effects_of(machine) if not cause.is_kernel}
    path, speed = (np.asarray(records.rows.columns[name], dtype=float) for name in ("path", "speed"))
    return causes, ResponseCurves(extended), nothing(sample, extended), path, speed


def test_curves_of_what_bends_are_those_of_the_model_at_sizes_up_to_the_bound(tmp_path: Path) -> None:
    """Of what goes in proportion there is one, per unit of its amplitude: a share takes the path away, 1 um per km."""
    causes, curves, null, path, speed = curves_of(tmp_path)
    plain = worn(path / 1e3, speed, 0.0, 0.0)
    film, growth, share = (curves.of(causes[name], null) for name in ("filmed", "hastened", "slowed"))
    assert (film.is_straight, growth.is_straight, share.is_straight) == (False, False, True)
    films = [worn(path / 1e3, speed, size, 0.0) for size in film.points[:, 0]]
    growths = [worn(path / 1e3, speed, 0.0, size * 1e3) for size in growth.points[:, 0]]
    for bundle, bent in ((film, films), (growth, growths), (share, [0.0 * plain])):
        np.testing.assert_allclose(bundle.curves[:, 0], 1e-6 * (np.array(bent) - plain), rtol=1e-9, atol=1e-15)
    assert film.points.max() == pytest.approx(20.0)
    assert growth.points.max() == pytest.approx(0.5e-3)
    assert np.sum(film.points * speed.max() > FIRST_FELT) >= 2  # below nothing is felt: a fit cannot begin there


def test_a_fit_of_a_film_begins_with_a_size_at_which_it_is_felt(tmp_path: Path) -> None:
    """Of the sizes asked for, each stretched as a line: the best by plain least squares is the first start."""
    causes, curves, null, *_ = curves_of(tmp_path, film=8.0)
    starts = look(curves, null, list(causes.values()))["filmed"].starts
    bundle = curves.of(causes["filmed"], null)
    left = null.left * null.sample.channels[0].scale
    drawn = bundle.curves[:, 0]
    inner, square = drawn @ left, np.maximum(np.sum(drawn**2, axis=1), 1e-300)
    stretched = np.clip(inner / square, 0.5, 2.0)
    gain = 2 * stretched * inner - stretched**2 * square
    best = int(np.argmax(gain))
    (worth, (size,)) = starts[0]
    assert size == pytest.approx(min(bundle.points[best, 0] * stretched[best], 20.0), rel=1e-6)
    rows = null.sample.rows
    assert worth == pytest.approx(-rows * np.log(1 - gain[best] / (left @ left)), rel=1e-6)
