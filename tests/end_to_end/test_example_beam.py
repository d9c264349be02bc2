"""The worked example of a beam: a wave whose period nobody knew, fitted apart from any diagnosis, and its aliases."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from example_rows import ExampleRows, every_other, explanations, the_others
from measured import Document, read_document
from numpy.typing import NDArray
from scipy.optimize import fmin
from scipy.stats import t as student

LEW = ExampleRows("beam_deflection", "lew.csv")
PERIOD = 3.3134
"""Of the wave by least squares over all rows, s."""
HALVES_APART = 0.015
"""By how much the period of rows 1-130 and that of rows 131-200 differ, in s: the wave keeps it no better."""
KNOWN_NEARLY = '"period", 3.0, 3.6'
Values = NDArray[np.float64]


def period_known_nearly(text: str) -> str:
    """Return the plugin of somebody who knows the period within a tenth."""
    assert '"period", 2.1, 60' in text
    return text.replace('"period", 2.1, 60', KNOWN_NEARLY)


def without_a_wave(text: str) -> str:
    """Return the plugin of somebody who thought of slow waves only."""
    return text.replace('"period", 2.1, 60', '"period", 20, 60')


# NIST/SEMATECH e-Handbook, section 1.4.2.5.2: mean and standard deviation of the 200 rows
def test_the_rows_are_those_of_the_handbook() -> None:
    time, deflection = LEW.numbers(0, 1)
    assert time.tolist() == list(range(1, 201))
    assert (deflection.mean(), deflection.std(ddof=1)) == pytest.approx((-177.435, 277.332), abs=1e-3)


# Waves fitted apart from any diagnosis


def curves(time: Values, period: float) -> Values:
    turned = 2 * np.pi * time / period
    return np.column_stack([np.ones_like(time), np.sin(turned), np.cos(turned)])


TAILS = 3
"""Degrees of freedom of Student's t: the first rows lie far off, where the wave is out of step."""


def heavy_tailed(last: int) -> tuple[float, float, Values]:
    """Fit the wave to the first rows with Student's t; return period, amplitude and the errors of all rows."""
    time, deflection = LEW.numbers(0, 1)
    fitted = time <= last
    level, sine, cosine = np.linalg.lstsq(curves(time[fitted], PERIOD), deflection[fitted], rcond=None)[0]

    def unlikely(unknowns: Values) -> float:
        errors = (curves(time, unknowns[3]) @ unknowns[:3] - deflection)[fitted] / np.exp(unknowns[4])
        return float(fitted.sum() * unknowns[4] - student.logpdf(errors, TAILS).sum())

    start = [level, sine, cosine, PERIOD, 4.6]
    found = np.asarray(fmin(unlikely, start, xtol=1e-7, ftol=1e-7, maxiter=20000, maxfun=20000, disp=False))
    return float(found[3]), float(np.hypot(*found[1:3])), curves(time, found[3]) @ found[:3] - deflection


# What the diagnosis says


def assert_names_the_wave(document: Document) -> None:
    assert document["verdict"] == "named"
    assert explanations(document) == {frozenset({"forced_vibration"})}
    (cause,) = document["causes"]
    period, amplitude, _ = heavy_tailed(200)
    assert cause["unknowns"]["period"]["value"] == pytest.approx(period, abs=HALVES_APART)
    sizes = [cause["unknowns"][name]["value"] for name in ("sine", "cosine")]
    assert np.hypot(*sizes) == pytest.approx(amplitude, rel=0.1)


def test_the_wave_is_named(shown_runs: Callable[[str], Path]) -> None:
    assert_names_the_wave(read_document(shown_runs("beam_deflection") / "lew"))


def test_without_a_cause_that_could_draw_it_no_cause_is_named(tmp_path: Path) -> None:
    document = LEW.diagnosed(tmp_path, declared=without_a_wave)
    assert document["verdict"] in {"undecided", "unknown"}
    assert document["causes"] == []


def test_the_wave_is_named_where_its_period_is_known_nearly(tmp_path: Path) -> None:
    """Its alternation is no autocorrelation then; outliers are where the wave is out of step, as in the handbook."""
    document = LEW.diagnosed(tmp_path, declared=period_known_nearly)
    assert_names_the_wave(document)
    low, high = document["causes"][0]["unknowns"]["period"]["interval95"]
    period, _, errors = heavy_tailed(200)
    assert low < period < high
    noise = document["wrong"]["deflection"]["noise"]
    assert abs(noise["autocorrelation"]) < 0.2
    assert noise["sd"]["value"] < 0.6 * 277.332
    lines = {outlier["line"] - 1 for outlier in noise["outliers"]}  # below the header
    assert {2, 8, 158} & lines
    for line in lines:  # the scatter falls with time, so that each half has its own
        half = np.abs(errors[:100] if line <= 100 else errors[100:])
        assert abs(errors[line - 1]) > 3 * np.median(half)


@pytest.mark.parametrize("taken", [every_other, the_others])
def test_half_of_the_rows_name_the_wave(taken: Any, tmp_path: Path) -> None:
    """Two seconds between readings have an alias at 5.05 s, outside of the range that is known."""
    assert_names_the_wave(LEW.diagnosed(tmp_path, taken, declared=period_known_nearly))


def test_half_of_the_rows_name_the_wave_or_its_alias(tmp_path: Path) -> None:
    document = LEW.diagnosed(tmp_path, every_other)
    assert explanations(document) == {frozenset({"forced_vibration"})}
    alias = 1 / (1 / 2 - 1 / PERIOD)
    value = document["causes"][0]["unknowns"]["period"]["value"]
    assert min(abs(value - PERIOD) / PERIOD, abs(value - alias) / alias) < 0.01


def test_rows_held_out_are_predicted(tmp_path: Path) -> None:
    """The first rows lie far off and pull the period, but not far enough to lose the wave in the last 70."""
    document = LEW.diagnosed(tmp_path, declared=period_known_nearly, hold_out="half = judge")
    low, high = document["causes"][0]["unknowns"]["period"]["interval95"]
    assert low < heavy_tailed(130)[0] < high
    gain = document["gain"]["deflection"]["held_out"]
    assert gain["rmse_before"]["value"] == pytest.approx(282, abs=1)
    assert gain["rmse_after"]["value"] < 0.6 * gain["rmse_before"]["value"]
