"""Effects that are not in proportion to their size: one that begins late, and one that is so large that it has bent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Array, Asked, assert_sized, plain_competition

from truing import Effect, Float, Model, Unknown, found, given, inputs, results
from truing.diagnosis.causes import Candidate
from truing.diagnosis.competition import Competition

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


def asked(effects: Sequence[Effect] = EFFECTS) -> Asked:
    model = Model(name="bearing", title="Bearing", function=bearing, errors=list(effects))
    return Asked(model, units={"path": "km", "speed": "m/s", "lost": "um"})


def record(film: float = 0.0, growth: float = 0.0, clog: float = 0.0) -> dict[str, Array]:
    """Rows of a bearing with this film, growth and clogging, with the noise of its gauge."""
    rng = np.random.default_rng(8)
    path, speed = np.sort(rng.uniform(0, 20, 80)), rng.uniform(0.3, 2.0, 80)
    lost = worn(path, speed, film, growth, clog) + rng.normal(0, NOISE, 80)
    return {"path": path, "speed": speed, "lost": np.asarray(lost)}


@pytest.mark.parametrize(
    ("film", "growth", "name"), [(8.0, 0.0, "filmed"), (13.0, 0.0, "filmed"), (0.0, 0.05, "hastened")]
)
def test_a_cause_that_is_not_in_proportion_to_its_size_is_named_alone(
    tmp_path: Path, film: float, growth: float, name: str
) -> None:
    """A film has no slope at no film; exp(1) is far from its slope: what that leaves is no second cause."""
    answer = asked().diagnosed(tmp_path, record(film, growth))
    assert answer.verdict in {"named", "one_of"}
    (cause,) = answer.causes
    assert (cause.effect, answer.remainder) == (name, None)
    (unknown,) = cause.unknowns
    assert_sized(unknown, film or growth / 1e3, within=0.2)


def test_a_cause_far_below_the_smallest_size_looked_at_is_fitted(tmp_path: Path) -> None:
    """Its bound is ten million times what is there: it bends at every size looked at, and is a line where it is."""
    clogged = Effect("clogged", on_inputs=clogging, unknowns=[Unknown("rate", 0, 1e6, "um/km")])
    answer = asked([*EFFECTS, clogged]).diagnosed(tmp_path, record(clog=0.2))
    (cause,) = answer.causes
    assert cause.effect == "clogged"
    (unknown,) = cause.unknowns
    assert_sized(unknown, 0.2e-9, within=0.2)


def test_a_film_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    answer = asked().diagnosed(tmp_path, record())
    assert (answer.causes, answer.remainder) == ((), None)


def laid_out(folder: Path, film: float = 0.0) -> tuple[dict[str, Candidate], Competition, Array, Array]:
    """The effects by name, what competes, and path and speed of every row, SI."""
    records = asked().records(folder, record(film))
    made = plain_competition(asked(), records, 1e-6)
    path, speed = (np.asarray(records.rows.columns[name], dtype=float) for name in ("path", "speed"))
    return (
        {cause.name: cause for cause in made.causes if cause.is_registered and not cause.is_kernel},
        made,
        path,
        speed,
    )


def test_curves_of_what_bends_are_those_of_the_model_at_sizes_up_to_the_bound(tmp_path: Path) -> None:
    """Of what goes in proportion there is one, per unit of its amplitude: a share takes the path away, 1 um per km."""
    causes, made, path, speed = laid_out(tmp_path)
    plain = worn(path / 1e3, speed, 0.0, 0.0)
    film, growth, share = (made.curves.of(causes[name], made.null) for name in ("filmed", "hastened", "slowed"))
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
    causes, made, *_ = laid_out(tmp_path, film=8.0)
    null = made.null
    starts = made.look(null, list(causes.values()))["filmed"].starts
    bundle = made.curves.of(causes["filmed"], null)
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
