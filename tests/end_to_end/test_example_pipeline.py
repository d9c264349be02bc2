"""The worked example of the pipeline: NIST's straight lines, a law fitted apart, a response that is concave."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from example_rows import ExampleRows, every_other, explanations, shuffled, the_others
from measured import Document, read_document
from scipy.optimize import minimize

from truing.kernel.loading import load_file

ALASKA = ExampleRows("pipeline_defects", "alaska.csv")
LAB, FIELD = ALASKA.numbers(0, 1)  # mil
CONCAVE = {"narrow_beam", "compressed_echo"}
STRAIGHT = {"sensor_gain", "sensor_offset"}
ALL = ""
"""Every row takes part: none is held out."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Document:
    return ALASKA.diagnosed(tmp_path_factory.mktemp("whole"), hold_out=ALL)


# NIST/SEMATECH e-Handbook, section 4.6.2.3 (straight line) and 4.6.2.4 (both logarithms)
def test_the_rows_are_those_of_the_handbook() -> None:
    assert len(LAB) == 107
    assert sorted(set(ALASKA.numbers(2))) == [1, 2, 3, 4, 5, 6]
    assert np.polyfit(LAB, FIELD, 1) == pytest.approx([0.731, 4.99], rel=1e-3)
    assert np.polyfit(np.log(LAB), np.log(FIELD), 1) == pytest.approx([0.885, 0.281], rel=2e-3)


def test_every_explanation_is_concave_and_the_bend_of_one_number_stands_first(whole: Document) -> None:
    """A power of two numbers fits no better: it is ranked, but need not be among them."""
    assert whole["verdict"] in {"named", "one_of"}
    assert all(causes & CONCAVE for causes in explanations(whole))
    assert whole["explanations"][0] == ["narrow_beam"]
    behind = {frozenset(item["causes"]): item["behind"] for item in whole["ranking"]}
    assert frozenset({"compressed_echo"}) in explanations(whole) or 6 < behind[frozenset({"compressed_echo"})] < 12
    noise = whole["wrong"]["field_size"]["noise"]
    assert noise["spread"] == "grows with lab_size"
    assert abs(noise["autocorrelation"]) < 0.2  # the order of the file says nothing
    assert whole["files"][0]["used"] == 107  # three rows that repeat others are coarse readings, no copies


def likeliest_beam() -> float:
    """The bend that is likeliest by hand, 1/mil, where the spread grows as a power of the size."""

    def unlikely(unknowns: Any) -> float:
        beam, power = unknowns[0] * 1e-3, unknowns[1]
        weight = (LAB / 40) ** power
        return float(
            len(LAB) / 2 * np.log(np.mean(((LAB / (1 + beam * LAB) - FIELD) / weight) ** 2)) + sum(np.log(weight))
        )

    return float(minimize(unlikely, [3.0, 0.75], method="Nelder-Mead").x[0]) * 1e-3


def test_the_size_is_that_computed_by_hand_and_grows_as_the_handbook_says(whole: Document) -> None:
    """The slope of the logarithms, 0.885 with a standard error of 0.023, by rows of the extended model."""
    (cause,) = whole["causes"]
    found = cause["unknowns"]["beam"]
    assert (cause["effect"], found["unit"]) == ("narrow_beam", "1/mil")
    low, high = found["interval95"]
    assert low < likeliest_beam() < high
    assert found["value"] == pytest.approx(likeliest_beam(), abs=(high - low) / 4)
    pipeline = load_file(ALASKA.folder / "pipeline_defects.py")
    defects = pipeline.PIPELINE_DEFECTS.inputs(lab_size=LAB * 25.4e-6, beam=found["value"] / 25.4e-6)
    shown = pipeline.pipeline_defects(defects).field_size / 25.4e-6
    assert np.polyfit(np.log(LAB), np.log(shown), 1)[0] == pytest.approx(0.885, abs=2 * 0.023)


def test_the_order_of_the_rows_means_nothing(whole: Document, tmp_path: Path) -> None:
    other = ALASKA.diagnosed(tmp_path, shuffled, hold_out=ALL)
    assert other["verdict"] == whole["verdict"]
    assert explanations(other) == explanations(whole)


@pytest.mark.parametrize("taken", [every_other, the_others])
def test_half_of_the_rows_say_the_same(taken: Any, tmp_path: Path) -> None:
    half = ALASKA.diagnosed(tmp_path, taken, hold_out=ALL)
    assert half["verdict"] in {"named", "one_of"}
    assert all(causes & CONCAVE for causes in explanations(half))


def test_without_a_concave_effect_the_rows_say_that_something_is_missing(tmp_path: Path) -> None:
    """A curve over the size is left, and no offset or gain alone: by likelihood both are far behind it."""

    def without(text: str) -> str:
        head, _, rest = text.partition("        effect(\n            compressed_echo,")
        _, _, tail = rest.partition("        effect(rough_wall")
        return head + "        effect(rough_wall" + tail

    left = ALASKA.diagnosed(tmp_path, hold_out=ALL, declared=without)
    assert left["verdict"] != "none"
    assert not CONCAVE & {name for causes in explanations(left) for name in causes}
    assert not any(causes < STRAIGHT for causes in explanations(left))


def test_rows_held_out_are_better_than_by_the_straight_line(shown_runs: Callable[[str], Path]) -> None:
    judge = np.array(ALASKA.words(3)) == "judge"
    line = np.polyfit(LAB[~judge], FIELD[~judge], 1)
    by_line = float(np.sqrt(np.mean((np.polyval(line, LAB) - FIELD)[judge] ** 2)))
    gain = read_document(shown_runs("pipeline_defects") / "alaska")["gain"]["field_size"]["held_out"]
    assert gain["rmse_before"]["value"] == pytest.approx(np.sqrt(np.mean((LAB - FIELD)[judge] ** 2)), rel=1e-6)
    assert gain["rmse_after"]["value"] < by_line
