"""Inputs that are drawn together: the calibration may move them only as they scatter, one with the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Asked

from truing import Float, Model, Tolerance, drawn, found, given, inputs, normal, results
from truing.diagnosis.result import DiagnosisResult

SD, NOISE, ROWS = 5.0, 0.5, 80


@inputs
class Stack:
    """Two shims cut from one sheet: what one has more the other has less."""

    left: Float = given(10.0, "um")
    right: Float = given(10.0, "um")
    place: Float = given(0.0, "mm")


@results
class Height:
    """What a gauge reads, on both shims and on one of them and half of the other."""

    both: Float = found("um")
    bent: Float = found("um")


def height(stack: Stack) -> Height:
    """The place of the gauge changes nothing."""
    nothing = 0.0 * stack.place
    return Height(both=stack.left + stack.right + nothing, bent=stack.left + 0.5 * stack.right + nothing)


def cut(rng: np.random.Generator, rows: int) -> Mapping[str, Any]:
    """Return deviations that add up to nothing."""
    more = rng.normal(0.0, SD * 1e-6, rows)
    return {"left": more, "right": -more}


TOGETHER = [Tolerance("cut", drawn(cut), on=["left", "right"])]
ALONE = [Tolerance(name, normal(sd=f"{SD} um")) for name in ("left", "right")]


@pytest.fixture
def diagnosed(tmp_path: Path) -> Callable[[list[Tolerance], str, float], DiagnosisResult]:
    def diagnosed(errors: list[Tolerance], result: str, off: float) -> DiagnosisResult:
        model = Model(name="stack", title="Stack", function=height, errors=errors)
        rng = np.random.default_rng(7)
        nominal = 20.0 if result == "both" else 15.0
        columns = {"place": rng.uniform(-5, 5, ROWS), result: nominal + off + rng.normal(0, NOISE, ROWS)}
        return Asked(model, units={"place": "mm", result: "um"}).diagnosed(tmp_path, columns)

    return diagnosed


def test_what_cancels_in_every_machine_hides_no_offset(diagnosed: Callable[..., DiagnosisResult]) -> None:
    said = diagnosed(TOGETHER, "both", 3.0)
    assert [cause.effect for cause in said.causes] == ["sensor_offset"]
    (offset,) = said.causes[0].unknowns
    assert offset.value == pytest.approx(3e-6, abs=3 * NOISE * 1e-6 / ROWS**0.5)


def test_inputs_that_scatter_alone_take_the_same_offset_up(diagnosed: Callable[..., DiagnosisResult]) -> None:
    said = diagnosed(ALONE, "both", 3.0)
    assert said.verdict == "none"
    assert sum(item.value for item in said.calibrated) == pytest.approx(23e-6, abs=0.5e-6)


def test_calibration_moves_both_by_their_scatter(diagnosed: Callable[..., DiagnosisResult]) -> None:
    """Half of the deviation is read: 3 um are 6 um on the one and -6 um on the other, 1.2 standard deviations."""
    said = diagnosed(TOGETHER, "bent", 3.0)
    assert said.verdict == "none"
    moved = {item.name: item for item in said.calibrated}
    assert moved["left"].value - 10e-6 == pytest.approx(6e-6, abs=0.5e-6)
    assert moved["right"].value - 10e-6 == pytest.approx(-6e-6, abs=0.5e-6)
    assert [moved[name].of_its_sd for name in ("left", "right")] == pytest.approx([1.2, -1.2], abs=0.1)
