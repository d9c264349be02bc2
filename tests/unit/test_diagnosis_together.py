"""Several fits that ask the model at one time: each is told what it would be told alone, in fewer calls."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from truing import Effect, Float, Model, Unknown, found, given, hookimpl, inputs, results
from truing.diagnosis import extended as under_test
from truing.diagnosis.causes import Candidate, effects_of
from truing.diagnosis.exact import Asking, together
from truing.diagnosis.extended import Extended, Request
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.reading import read_records
from truing.inputs_file import read_setup
from truing.kernel import Kernel

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


@hookimpl
def truing_models() -> list[Model[Beam, Sag]]:
    return [BEAM]


@pytest.fixture
def asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Extended, dict[str, Candidate], list[int]]:
    """The beam as a diagnosis asks it, its causes by name, and by call the number of points."""
    offer = next(each for each in Kernel([sys.modules[__name__]], strict=True).offers.values() if each.model is BEAM)
    rows = "".join(f"{load!r},{load / 4!r}\n" for load in LOADS.tolist())
    (tmp_path / "measured.csv").write_text("load [N],sag [mm]\n" + rows, encoding="utf-8")
    (tmp_path / "inputs.toml").write_text("[inputs]\n", encoding="utf-8")
    setup = read_setup(tmp_path / "inputs.toml", offer)
    machine = calibration_of(setup, read_records([tmp_path / "measured.csv"], offer, setup))
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


def test_requests_of_the_same_causes_are_one_call(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    soft, offset = causes["softening"], causes["sensor_offset"]
    alone, moved, again = extended.at_each(
        [
            request(extended, [soft], [0.5], [0.2]),
            request(extended, [soft, offset], [0.2, 1e-3]),
            request(extended, [soft], [0.2], [0.75]),
        ]
    )
    assert calls == [3, 1]
    np.testing.assert_allclose(alone[0]["sag"], LOADS / 2e3, rtol=1e-12)
    np.testing.assert_allclose(alone[1]["sag"], LOADS / 3.2e3, rtol=1e-12)
    np.testing.assert_allclose(moved[0]["sag"], LOADS / 3.2e3 + 1e-3, rtol=1e-12)
    np.testing.assert_allclose(again[1]["sag"], LOADS / 1e3, rtol=1e-12)
    assert extended.calls == 3, "points that differ in what acts after the model are one"


def test_effects_act_where_they_are_asked_for_alone(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    adds, sets = causes["support"], causes["replaced_support"]
    added, both, laid = extended.at_each(
        [
            request(extended, [adds], [2e-4]),
            request(extended, [sets, adds], [1e-4, 2e-4]),
            request(extended, [sets], [1e-4]),
        ]
    )
    np.testing.assert_allclose(added[0]["sag"], LOADS * (1 / 4e3 + 2e-4), rtol=1e-12)
    np.testing.assert_allclose(both[0]["sag"], LOADS * (1 / 4e3 + 1e-4), rtol=1e-12)  # it is declared later
    np.testing.assert_allclose(laid[0]["sag"], LOADS * (1 / 4e3 + 1e-4), rtol=1e-12)
    assert calls == [1, 1, 1]


def test_causes_that_come_in_another_order_are_not_mistaken_for_one_another(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    soft, adds = causes["softening"], causes["support"]
    (one,), (other,), (same,) = extended.at_each(
        [
            request(extended, [soft, adds], [0.5, 0.25]),
            request(extended, [adds, soft], [0.5, 0.25]),
            request(extended, [adds, soft], [0.25, 0.5]),
        ]
    )
    np.testing.assert_allclose(one["sag"], LOADS * (1 / 2e3 + 0.25), rtol=1e-12)
    np.testing.assert_allclose(other["sag"], LOADS * (1 / 3e3 + 0.5), rtol=1e-12)
    np.testing.assert_array_equal(same["sag"], one["sag"])
    assert calls == [2]


def test_a_point_at_which_the_model_has_no_answer_leaves_the_others_theirs(
    asked: tuple[Extended, dict[str, Candidate], list[int]],
) -> None:
    extended, causes, calls = asked
    soft = causes["softening"]
    fine, broken = extended.at_each([request(extended, [soft], [0.2]), request(extended, [soft], [1.0], [0.5])])
    np.testing.assert_allclose(fine[0]["sag"], LOADS / 3.2e3, rtol=1e-12)
    assert np.isnan(broken[0]["sag"]).any()
    np.testing.assert_allclose(broken[1]["sag"], LOADS / 2e3, rtol=1e-12)
    assert calls == [3]


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
