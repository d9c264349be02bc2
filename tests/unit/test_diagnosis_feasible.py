"""A model that cannot go everywhere: a start beyond what is feasible is moved inside, and what fails is named.

A gap lets a fluid through as the root of its width; what it loses along its length may close it.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked

from truing import Effect, Float, Model, Tolerance, Unknown, feasible, found, given, inputs, normal, results
from truing.diagnosis.result import DiagnosisResult
from truing.runs.diagnosis_document import diagnosis_document

WIDTH, LENGTH, NOISE = 100.0, 10.0, 0.3


@inputs
class Gap:
    """A gap that narrows along its length."""

    place: Float = given(0.0, "mm")
    width: Float = given(WIDTH, "um")
    loss: Float = given(0.0, "um", note="neutral 0: what is lost at the end")


@results
class Flow:
    """What comes through."""

    flow: Float = found("um")


def flow(gap: Gap) -> Flow:
    """The root of the width in units of 100 um."""
    left = gap.width - gap.loss * gap.place / (LENGTH * 1e-3)
    feasible(left > 0, "the gap is closed")
    return Flow(flow=np.sqrt(left * 1e-4))


def loses(gap: Gap, *, loss: Float) -> Gap:
    return replace(gap, loss=gap.loss + loss)


def shuts(gap: Gap, *, blow: Float) -> Gap:
    return replace(gap, width=gap.width - np.where(np.asarray(blow) != 0, 1.0, 0.0))


MODEL = Model(
    name="gap", title="Gap", function=flow,
    errors=[
        Tolerance("width", normal(sd="2 %")),
        Effect("loses", on_inputs=loses, unknowns=[Unknown("loss", 0, 200, "um")]),
        Effect("shuts", on_inputs=shuts, unknowns=[Unknown("blow", 0, 200, "um")]),
    ],
)  # fmt: skip


def asked(folder: Path, loss: float) -> DiagnosisResult:
    """Sixty readings along a gap that loses so much, in um."""
    rng = np.random.default_rng(3)
    place = np.linspace(0, LENGTH, 60)
    shown = np.sqrt((WIDTH - loss * place / LENGTH) * 100) + rng.normal(0, NOISE, 60)
    return Asked(MODEL, units={"place": "mm", "flow": "um"}).diagnosed(folder, {"place": place, "flow": shown})


def test_a_start_at_which_the_model_fails_is_moved_inside(tmp_path: Path) -> None:
    """Linear in the loss, 99 um look like far more than the 100 um that close the gap."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        answer = asked(tmp_path, 99.0)
    (cause,) = answer.causes
    (unknown,) = cause.unknowns
    assert (cause.effect, unknown.value) == ("loses", pytest.approx(99e-6, rel=0.01))


def test_what_the_model_fails_with_is_left_out_by_name(tmp_path: Path) -> None:
    answer = asked(tmp_path, 30.0)
    (unseen,) = [item for item in answer.seen if item.name == "shuts"]
    assert (unseen.sight, unseen.smallest) == ("cannot be fitted", None)
    assert unseen.text == "the model fails with it, in measured.csv:2 as the first row: the gap is closed"
    document = diagnosis_document(answer)
    assert document["not_fitted"] == {"shuts": unseen.text}
    assert "shuts" not in document["not_excited"]
