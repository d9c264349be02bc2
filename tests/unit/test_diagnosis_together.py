"""Several fits that ask the model at one time: each is told what it would be told alone, in fewer calls."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked

from truing import Effect, Float, Model, Unknown, found, given, inputs, results
from truing.diagnosis import extended as under_test
from truing.diagnosis.causes import Candidate, effects_of
from truing.diagnosis.exact import Asking, together
from truing.diagnosis.extended import Extended, Request
from truing.diagnosis.machine import calibration_of

LOADS = np.linspace(-20, 20, 40)


@inputs
class Beam:
    """A beam with a support that gives way."""

    load: Float = given(0.0, "N")
    stiffness: Float = given(4.0, "N/mm", above=0)
    yielding: Float = given(0.0, "mm/N")


@results
class Sag:
    """How far it sags."""

    sag: Float = found("mm")


def beam(given: Beam) -> Sag:
    return Sag(sag=given.load / given.stiffness + given.yielding * given.load)


def softening(before: Beam, *, share: Float) -> Beam:
    return replace(before, stiffness=before.stiffness * (1 - share))


def support(before: Beam, *, more: Float) -> Beam:
    return replace(before, yielding=before.yielding + more)


def replaced_support(before: Beam, *, amount: Float) -> Beam:
    """It sets what the other support adds to: beside that one it undoes what it adds."""
    return replace(before, yielding=amount)


BEAM = Model(
    name="together_beam", title="Beam", summary="A beam on a support.", function=beam, cites=["none"],
    errors=[
        Effect("softening", on_inputs=softening, looks_like="too soft", unknowns=[Unknown("share", 0, 1)]),
        Effect("support", on_inputs=support, looks_like="gives way", unknowns=[Unknown("more", 0, 1, "mm/N")]),
        Effect(
            "replaced_support", on_inputs=replaced_support, looks_like="gives way",
            unknowns=[Unknown("amount", 0, 1, "mm/N")],
        ),
    ],
)  # fmt: skip


@pytest.fixture
def asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Extended, dict[str, Candidate], list[int]]:
    """The beam as a diagnosis asks it, its causes by name, and by call the number of points."""
    one = Asked(BEAM, units={"load": "N", "sag": "mm"})
    machine = calibration_of(one.setup, one.records(tmp_path, {"load": LOADS, "sag": LOADS / 4}))
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
    ("points", "compliances", "offsets", "calls"),
    [
        (  # points of the same causes are one call, and what is known is not asked again
            [("softening", [0.5]), ("softening", [0.2]), ("softening sensor_offset", [0.2, 1e-3]),
             ("softening", [0.2]), ("softening", [0.75])],
            [1 / 2e3, 1 / 3.2e3, 1 / 3.2e3, 1 / 3.2e3, 1 / 1e3], [0.0, 0.0, 1e-3, 0.0, 0.0], [3, 1],
        ),
        (  # effects act where they are asked for alone: one sets what another one adds to, and is declared later
            [("support", [2e-4]), ("replaced_support support", [1e-4, 2e-4]), ("replaced_support", [1e-4])],
            [1 / 4e3 + 2e-4, 1 / 4e3 + 1e-4, 1 / 4e3 + 1e-4], [0.0] * 3, [1, 1, 1],
        ),
        (  # causes that come in another order are not mistaken for one another
            [("softening support", [0.5, 0.25]), ("support softening", [0.5, 0.25]),
             ("support softening", [0.25, 0.5])],
            [1 / 2e3 + 0.25, 1 / 3e3 + 0.5, 1 / 2e3 + 0.25], [0.0] * 3, [2],
        ),
        (  # a point at which the model has no answer leaves the others theirs
            [("softening", [0.2]), ("softening", [1.0]), ("softening", [0.5])],
            [1 / 3.2e3, np.nan, 1 / 2e3], [0.0] * 3, [3],
        ),
    ],
    ids=["one call", "alone", "order", "no answer"],
)  # fmt: skip
def test_points_that_are_asked_at_one_time_are_answered_as_alone(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
    points: list[Points], compliances: list[float], offsets: list[float], calls: list[int],
) -> None:  # fmt: skip
    extended, causes, counted = asked
    answers = extended.at_each(
        [request(extended, [causes[name] for name in names.split()], at) for names, at in points]
    )
    assert counted == calls
    for (shown,), compliance, offset in zip(answers, compliances, offsets, strict=True):
        expected = compliance * LOADS + offset
        assert np.isnan(shown["sag"]).any() if np.isnan(compliance) else np.allclose(shown["sag"], expected, rtol=1e-12)


def test_searches_that_end_at_different_times_each_return_their_own(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    soft = causes["softening"]

    def asking(share: float, rounds: int) -> Asking[list[float]]:
        largest = []
        for turn in range(rounds):
            (shown,) = yield request(extended, [soft], [share * (turn + 1)])
            largest.append(float(shown["sag"].max()))
        return largest

    made = together(extended, [asking(0.125, 3), asking(0.25, 0), asking(0.375, 1)])
    expected = [[20 / 4e3 / (1 - share) for share in shares] for shares in ([0.125, 0.25, 0.375], [], [0.375])]
    for own, right in zip(made, expected, strict=True):
        np.testing.assert_allclose(own, right, rtol=1e-12)
    assert calls == [2, 1], "the last point is known by then"
