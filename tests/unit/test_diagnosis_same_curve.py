"""Causes of one slope at zero: they are one cause while they are small, and part where they bend or turn about."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked, assert_sized, ends

from truing import Effect, Float, Model, Unknown, found, given, inputs, results
from truing.diagnosis import exact
from truing.diagnosis.result import DiagnosisResult

NOISE = 0.02  # MPa
ROWS = 90


@inputs
class Beam:
    """A beam under a force that may be shaken, and that may not bear along its whole width."""

    force: Float = given(10.0, "N", above=0)
    speed: Float = given(0.0, "Hz", at_least=0)
    crowding: Float = given(1.0, "", note="neutral 1: largest over mean pressure")
    lead: Float = given(0.0, "N", note="neutral 0: carried beside the force; together never below 0")
    swing: Float = given(0.0, "", note="neutral 0: in motion beside at rest")


@results
class Stress:
    """What the beam bears."""

    stress: Float = found("MPa")


def beam(it: Beam) -> Stress:
    """A megapascal per newton."""
    return Stress(stress=1e6 * np.maximum(it.force * it.crowding + it.lead, 0.0) * (1.0 + it.swing))


def tilted(it: Beam, *, tilt: Float) -> Beam:
    """1 + r of the mean, and 2 sqrt(r) where a part of the width lifts off: r = tilt over force."""
    ratio = tilt / it.force
    return replace(it, crowding=np.where(ratio <= 1, 1 + ratio, 2 * np.sqrt(np.maximum(ratio, 0.0))))


def ahead(it: Beam, *, lead: Float) -> Beam:
    return replace(it, lead=it.lead + lead)


def resonant(it: Beam, *, excitation: Float, own: Float, damping: Float) -> Beam:
    return replace(it, swing=it.swing + excitation * peak(it.speed, own, damping))


def peak(speed: Float, own: Float, damping: Float) -> Float:
    ratio = np.square(speed / own)
    made: Float = ratio / np.sqrt((1 - ratio) ** 2 + 4 * np.square(damping) * ratio)
    return made


MODEL = Model(
    name="beam",
    title="Beam",
    function=beam,
    errors=[
        Effect("tilted", on_inputs=tilted, unknowns=[Unknown("tilt", 0, 20, "N")]),
        Effect("ahead", on_inputs=ahead, unknowns=[Unknown("lead", -20, 20, "N")]),
        Effect(
            "resonant",
            on_inputs=resonant,
            unknowns=[
                Unknown("excitation", 0, 1, ""),
                Unknown("own", 5, 300, "Hz"),
                Unknown("damping", 0.03, 0.3, ""),
            ],
        ),
    ],
)


ASKED = Asked(MODEL, units={"force": "N", "speed": "Hz", "stress": "MPa"})


def asked(folder: Path, truth: str, size: float, *, low: float, gauge: float = 1.0) -> DiagnosisResult:
    """Ask about beams under forces from ``low`` on, with one thing wrong; ``gauge`` scales the noise of some rows."""
    rng = np.random.default_rng(4)
    force, speed = rng.uniform(low, 12.0, ROWS), rng.uniform(1.0, 100.0, ROWS)
    stress = {
        "tilted": lambda: np.where(size <= force, force + size, 2 * np.sqrt(size * force)),
        "ahead": lambda: np.maximum(force + size, 0.0),
        "resonant": lambda: force * (1 + size * np.asarray(peak(speed, 40.0, 0.05))),
    }[truth]()
    stress = stress + NOISE * rng.standard_normal(ROWS) * np.where(np.arange(ROWS) % 9 == 4, gauge, 1.0)
    return ASKED.diagnosed(folder, {"force": force, "speed": speed, "stress": stress})


def named(answer: DiagnosisResult) -> set[str]:
    (cause,) = answer.causes
    return {cause.effect, *cause.same_as}


@pytest.mark.parametrize("truth", ["tilted", "ahead"])
@pytest.mark.parametrize("most_kept", [exact.MOST_KEPT, -1], ids=["", "too long to keep what inputs draw"])
def test_small_ones_are_one_cause_and_small_forces_would_part_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, truth: str, most_kept: int
) -> None:
    """Under 4 N and more a tilt of 1 N adds 1 MPa at any force, as a lead of 1 N does and an offset of the gauge."""
    monkeypatch.setattr(exact, "MOST_KEPT", most_kept)
    answer = asked(tmp_path, truth, 1.0, low=4.0)
    assert {"tilted", "ahead"} <= named(answer)


@pytest.mark.parametrize(("truth", "size", "low"), [("tilted", 8.0, 0.5), ("ahead", 8.0, 0.5), ("ahead", -1.5, 0.5)])
def test_large_ones_part(tmp_path: Path, truth: str, size: float, low: float) -> None:
    """2 sqrt(r) is no 1 + r; and what lacks 1.5 N bears nothing below 1.5 N, which a tilt can never do.

    Noise is 0.25 % of the largest of them: chords of sizes nearby leave more than that.
    """
    answer = asked(tmp_path, truth, size, low=low)
    assert truth in named(answer)
    assert not ({"tilted", "ahead"} - {truth}) & named(answer)
    assert answer.remainder is None
    (cause,) = answer.causes
    (unknown,) = cause.unknowns
    size *= 1e6 if cause.effect == "sensor_offset" else 1.0  # a gauge that is off by it draws the same curve
    assert_sized(unknown, size, within=0.05)


def test_a_sharp_peak_that_few_rows_tell_is_no_set_of_outliers(tmp_path: Path) -> None:
    answer = asked(tmp_path, "resonant", 0.05, low=4.0)
    (cause,) = answer.causes
    assert (cause.effect, answer.remainder) == ("resonant", None)
    held = {item.name: ends(item) for item in cause.unknowns}
    for name, true in (("excitation", 0.05), ("own", 40.0), ("damping", 0.05)):
        low, high = held[name]
        reach = 0.5 * (high - low)
        assert low - 0.5 * reach <= true <= high + 0.5 * reach, name  # three standard errors


def test_gross_errors_stay_outliers_beside_a_peak(tmp_path: Path) -> None:
    """Every ninth reading with forty times the noise: a fit to the readings as they are would follow them."""
    answer = asked(tmp_path, "resonant", 0.1, low=4.0, gauge=40.0)
    (cause,) = answer.causes
    assert cause.effect == "resonant"
    found_at = {item.name: item.value for item in cause.unknowns}
    assert found_at["own"] == pytest.approx(40.0, rel=0.02)
    assert found_at["damping"] == pytest.approx(0.05, rel=0.3)
