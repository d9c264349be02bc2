"""The worked example of ultrasound in metal: what NIST certifies, and two laws that draw one curve."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from example_rows import ExampleRows, Rows, explanations, spoken_of, the_others
from measured import Document, read_document
from numpy.typing import NDArray
from scipy.optimize import least_squares

from truing.kernel.loading import load_file

CHWIRUT = ExampleRows("ultrasonic_calibration", "chwirut2.csv")
CERTIFIED = (1.6657666537e-1, 5.1653291286e-3, 1.2150007096e-2)
"""NIST StRD, Chwirut2: ``exp(-b1 x) / (b2 + b3 x)``."""
CERTIFIED_SUM_OF_SQUARES = 513.04802941
CERTIFIED_DIVERGENCE = CERTIFIED[2] / CERTIFIED[1]  # b3/b2, in 1/mm
SPREADING, HARDENING = frozenset({"beam_spreading"}), frozenset({"pulse_hardening"})
Values = NDArray[np.float64]
DISTANCE, RESPONSE = CHWIRUT.numbers(0, 1)
PLUGIN = load_file(CHWIRUT.folder / "ultrasonic_calibration.py")


def sorted_by_distance(rows: Rows) -> Rows:
    return sorted(rows, key=lambda row: float(row.split(",")[0]))


@pytest.fixture(scope="module")
def whole(shown_runs: Callable[[str], Path]) -> Document:
    return read_document(shown_runs("ultrasonic_calibration") / "chwirut2")


def test_with_the_certified_numbers_the_function_is_that_of_nist() -> None:
    """And leaves of the shipped rows what NIST certifies."""
    b1, b2, b3 = CERTIFIED
    path = PLUGIN.ULTRASONIC_CALIBRATION.inputs(
        distance=DISTANCE * 1e-3, first_response=1 / b2, attenuation=b1 * 1e3, divergence=b3 / b2 * 1e3
    )
    expected = np.exp(-b1 * DISTANCE) / (b2 + b3 * DISTANCE)
    assert PLUGIN.ultrasonic_calibration(path).response == pytest.approx(expected, rel=1e-12)
    assert np.sum((RESPONSE - expected) ** 2) == pytest.approx(CERTIFIED_SUM_OF_SQUARES, rel=1e-9)


# Laws fitted apart from any diagnosis: unknowns are the first response, the attenuation, and one more


def spreading(x: Values, unknowns: Values) -> Values:
    return np.asarray(unknowns[0] * np.exp(-unknowns[1] * x) / (1 + unknowns[2] * x))


def hardening(x: Values, unknowns: Values) -> Values:
    return np.asarray(unknowns[0] * np.exp(-unknowns[1] * x ** (1 - unknowns[2])))


def fitted(
    law: Callable[[Values, Values], Values], start: list[float], rows: Values | slice = slice(None)
) -> tuple[Values, float]:
    """Fit a law by plain least squares; return its unknowns and the residual standard deviation."""
    distance, response = DISTANCE[rows], RESPONSE[rows]
    found = least_squares(lambda unknowns: law(distance, unknowns) - response, start)
    return np.asarray(found.x), float(np.sqrt(2 * found.cost / (len(distance) - len(start))))


def test_without_weights_and_tolerances_both_laws_leave_what_the_page_says() -> None:
    page = (CHWIRUT.folder / "README.md").read_text(encoding="utf-8")
    left = fitted(spreading, [200.0, 0.2, 2.0])[1], fitted(hardening, [300.0, 1.5, 0.5])[1]
    assert f"with the divisor {left[0]:.3f} is\nleft, with the hardened pulse {left[1]:.3f}" in page


# What the diagnosis says. A table has no time: its order means nothing


def test_spreading_is_among_the_explanations_with_its_certified_size(whole: Document, tmp_path: Path) -> None:
    """The law that draws the same curve is one, too; the scatter grows with the response, which falls with distance."""
    another_order = CHWIRUT.diagnosed(tmp_path, sorted_by_distance)
    assert explanations(another_order) == explanations(whole) >= {SPREADING, HARDENING}
    for document in (whole, another_order):
        assert document["verdict"] == "one_of"
        (cause,) = document["causes"]
        assert cause["effect"] == "beam_spreading"
        low, high = cause["unknowns"]["divergence"]["interval95"]
        assert cause["unknowns"]["divergence"]["unit"] == "1/mm"
        assert low < CERTIFIED_DIVERGENCE < high
        said = document["wrong"]["response"]["noise"]["spread"]
        assert said in {"falls with distance", "grows with size of response"}


def test_half_of_the_rows_leave_spreading_among_the_explanations(tmp_path: Path) -> None:
    """And they are not surer than all: the law that draws the same curve is left too."""
    half = CHWIRUT.diagnosed(tmp_path, the_others)
    assert half["verdict"] in {"named", "one_of", "undecided"}  # 27 rows may say too little, never something else
    assert ({SPREADING, HARDENING} <= explanations(half)) == (half["verdict"] != "undecided")


def test_of_every_effect_something_is_said(whole: Document) -> None:
    sources = PLUGIN.ULTRASONIC_CALIBRATION.errors
    effects = {source.name for source in sources} - {"first_response", "attenuation"}
    assert len(effects) == 6
    assert effects <= spoken_of(whole)


def test_rows_held_out_are_predicted_as_well_as_by_the_certified_law(tmp_path: Path) -> None:
    judge = np.array(CHWIRUT.words(2)) == "judge"
    found, _ = fitted(spreading, [200.0, 0.2, 2.0], ~judge)
    by_hand = float(np.sqrt(np.mean((spreading(DISTANCE, found) - RESPONSE)[judge] ** 2)))
    gain = CHWIRUT.diagnosed(tmp_path, hold_out="judged = judge")["gain"]["response"]["held_out"]
    assert gain["rmse_after"]["value"] == pytest.approx(by_hand, rel=0.1)
    assert 3 <= gain["rmse_after"]["value"] < 4  # as the page says
    assert gain["rmse_before"]["value"] > 1.3 * by_hand
