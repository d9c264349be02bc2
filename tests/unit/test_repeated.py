"""Rows that come again and again cost the model one call, whatever acts after it; answers are those of all rows."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from truing import Effect, Float, Model, Unknown, feasible, found, given, inputs, repeated, results
from truing.evaluate import evaluate_rows
from truing.setup import Setup, SwitchedOn, default_setup, effect_column

ROWS, COPIES = 5, 4


@inputs
class Beam:
    """A beam under a load."""

    load: Float = given(1.0, "N")
    length: Float = given(2.0, "m", at_most=10.0)
    spare: Float = given(float("nan"), "m")


@results
class Bent:
    """How far it bends."""

    sag: Float = found("m")
    slope: Float = found("m")


CALLS: list[int] = []


def bend(beam: Beam) -> Bent:
    CALLS.append(np.size(beam.load))
    feasible(beam.load < 4.5, "too much load")
    feasible(beam.load < 3.5, "no slope under such a load", only=["slope"])
    return Bent(sag=beam.load * beam.length**3, slope=beam.load * beam.length**2)


def offset(beam: Beam, bent: Bent, *, size: Float) -> Bent:
    return replace(bent, sag=bent.sag + size)


def softer(beam: Beam, *, share: Float) -> Beam:
    return replace(beam, load=beam.load * (1 + share))


BENDING = Model(
    name="bending",
    title="Bending of a beam",
    function=bend,
    errors=[
        Effect("offset", on_results=offset, unknowns=[Unknown("size", -1, 1, "m")], looks_like="a constant"),
        Effect("softer", on_inputs=softer, unknowns=[Unknown("share", 0, 1)], looks_like="a larger load"),
    ],
)


def asked(effect: str, unknown: str, values: Any, *, repeats: int) -> Any:
    """The answers to rows that come in copies, each with another unknown."""
    setup: Setup = default_setup(BENDING)
    setup = setup.with_effects([SwitchedOn(BENDING.effects[effect], {unknown: 0.0})])
    columns = {
        "load": np.tile(np.arange(1.0, ROWS + 1), COPIES),
        "spare": np.full(ROWS * COPIES, np.nan),
        effect_column(effect, unknown): np.repeat(values, ROWS),
    }
    CALLS.clear()
    return evaluate_rows(setup, columns, ROWS * COPIES, repeats=repeats)


def test_the_model_is_called_for_one_copy_where_effects_act_after_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repeated, "_ANSWERS", OrderedDict())
    sizes = np.array([0.0, 0.1, 0.2, 0.3])
    answer = asked("offset", "size", sizes, repeats=COPIES)
    assert CALLS == [ROWS]
    sag = np.tile(8.0 * np.arange(1, 6), COPIES) + np.repeat(sizes, ROWS)
    fails = np.tile([False] * 4 + [True], COPIES)
    np.testing.assert_allclose(answer.results["sag"], np.where(fails, np.nan, sag))
    np.testing.assert_array_equal(answer.failed, fails)


def test_what_is_known_is_not_calculated_again() -> None:
    asked("offset", "size", np.zeros(COPIES), repeats=COPIES)
    asked("offset", "size", np.full(COPIES, 0.7), repeats=COPIES)
    assert CALLS == []


@pytest.mark.parametrize(("effect", "unknown"), [("offset", "size"), ("softer", "share")])
def test_answers_reasons_and_gaps_are_those_of_all_rows(effect: str, unknown: str) -> None:
    values = np.array([0.0, 0.05, 0.1, 0.2])
    together, plain = (asked(effect, unknown, values, repeats=count) for count in (COPIES, 0))
    for name in ("sag", "slope"):
        np.testing.assert_array_equal(together.results[name], plain.results[name])
    assert together.reasons == plain.reasons
    assert together.absent == plain.absent
    assert plain.absent["slope"]


def test_copies_that_differ_are_all_calculated() -> None:
    asked("softer", "share", np.array([0.0, 0.05, 0.1, 0.2]), repeats=COPIES)
    assert CALLS == [ROWS * COPIES]


def heavy(beam: Beam) -> Bent:
    return Bent(sag=beam.load, slope=beam.load)


def test_another_model_of_the_same_inputs_is_asked_itself() -> None:
    load = {"load": np.tile(np.arange(1.0, 4.0), 2)}
    for function, factor in ((bend, 8.0), (heavy, 1.0), (bend, 8.0)):
        answer = evaluate_rows(default_setup(replace(BENDING, function=function)), load, 6, repeats=2)
        np.testing.assert_allclose(answer.results["sag"], factor * load["load"])


def worn(beam: Beam, bent: Bent, *, size: Float) -> Bent:
    sag: Any = bent.sag
    sag += size  # in place, as a careless effect does
    return bent


def test_an_effect_that_changes_an_array_in_place_changes_nothing_that_is_remembered() -> None:
    effect = Effect("worn", on_results=worn, unknowns=[Unknown("size", -1, 1, "m")], looks_like="a constant")
    setup = default_setup(replace(BENDING, errors=[effect])).with_effects([SwitchedOn(effect, {"size": 0.5})])
    load = {"load": np.array([1.0, 2.0, 3.0])}
    for _ in range(3):
        np.testing.assert_allclose(evaluate_rows(setup, load, 3, repeats=1).results["sag"], 8.0 * load["load"] + 0.5)


def test_inputs_that_differ_are_told_apart() -> None:
    """Also where their texts read alike one behind another: 1 and 12 are not 11 and 2."""
    several = [(1, 12), (11, 2), (112, ""), (1.0, 12), (np.array([1.0]), 12), (np.array([1.0, 12.0]), 12), ("1", "12")]
    keys = {repeated._key({("one",): one, ("other",): other}) for one, other in several}
    assert len(keys) == len(several)
