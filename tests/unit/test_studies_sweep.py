"""Sweeps: one batch along an input, failed points with their reasons."""

import json
from dataclasses import replace

import numpy as np
import pytest
from study_models import CHAIN, ROOT, WEAR, setup_of

from truing import Sweep
from truing.calculation import calculate
from truing.declare.blocks import Drawing, Table, Words
from truing.errors import UsageError
from truing.setup import SwitchedOn


def swept(model, study, **changes):
    return calculate(replace(setup_of(model), studies=(study,), **changes)).outcomes["sweep"]


@pytest.mark.parametrize(
    ("at", "points", "axis_mm"),
    [
        ("20..40 mm", 5, [20, 25, 30, 35, 40]),
        ("2 cm..40 mm", 3, [20, 30, 40]),
        ("20, 0.03, 40 mm", 2, [20, 0.03, 40]),
        ("-1..1 mm", 2, [-1, 1]),
        ("3e1 mm", 2, [30]),
    ],
)
def test_the_axis_is_read_with_its_unit(at, points, axis_mm):
    found = swept(CHAIN, Sweep(over="first", at=at, points=points))
    assert 1e3 * found.axis == pytest.approx(axis_mm, rel=1e-12)
    assert 1e3 * found.results["gap"] == pytest.approx(np.array(axis_mm) + 20 - 40, rel=1e-9, abs=1e-9)


def test_failed_points_keep_their_reason():
    found = swept(ROOT, Sweep(over="square", at="-1..3 m^2", points=5))
    assert found.results["side"] == pytest.approx([np.nan, 0, 1, 2**0.5, 3**0.5], nan_ok=True)
    assert found.failed == ((0, "no square has a negative area"),)
    written = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert written["results"]["side"]["values"][0] is None
    assert written["failed"] == [{"row": 0, "reason": "no square has a negative area"}]
    assert "1 of 5 points" in found.warnings()[0]
    assert any(isinstance(block, Words) and "number 1" in block.text for block in found.blocks())


def test_results_are_printed_in_the_chosen_unit():
    found = swept(CHAIN, Sweep(over="first", at="20..40 mm", points=3), units={"gap": "um"})
    assert found.as_json()["results"]["gap"] == {"unit": "um", "values": pytest.approx([0, 1e4, 2e4], abs=1e-6)}
    assert found.as_json()["axis"] == pytest.approx([20, 30, 40])


def test_a_condition_is_swept_and_effects_follow():
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5})
    found = swept(CHAIN, Sweep(over="warmth", at="20..60 degC", points=3), effects=(on,))
    assert found.axis == pytest.approx([293.15, 313.15, 333.15])
    assert 1e3 * found.results["gap"] == pytest.approx([10, 10 * (1 + 20e-5), 10 * (1 + 40e-5)], rel=1e-12)
    assert found.as_json()["axis"] == pytest.approx([20, 40, 60])


def test_whole_numbers_are_swept_as_such():
    found = swept(WEAR, Sweep(over="stages", at="1..4"))
    assert list(found.axis) == [1, 2, 3, 4]
    assert 1e6 * found.results["depth"] == pytest.approx([20, 40, 60, 80])
    with pytest.raises(UsageError, match="takes whole numbers"):
        swept(WEAR, Sweep(over="stages", at="1, 2.5"))


def test_results_along_their_own_axis_are_kept():
    found = swept(WEAR, Sweep(over="rate", at="1, 2 um/h"))
    assert 1e6 * found.results["course"] == pytest.approx(np.array([[2, 8, 18], [4, 16, 36]]))
    json.dumps(found.as_json(), allow_nan=False)


def test_the_table_says_where_the_extremes_are():
    found = swept(CHAIN, Sweep(over="third", at="30..50 mm", points=5))
    table = next(block for block in found.blocks() if isinstance(block, Table))
    assert table.rows[0] == ["gap", "mm", pytest.approx(0, abs=1e-12), pytest.approx(50), pytest.approx(20), 30]


def test_curves_are_drawn_where_no_section_shows_them():
    def given(found):
        raise AssertionError("not called here")

    found = swept(CHAIN, Sweep(over="third", at="30..50 mm"))
    drawing = next(block for block in found.blocks() if isinstance(block, Drawing))
    assert [len(axes.lines) for axes in drawing.draw().axes] == [1, 1]
    assert not any(isinstance(block, Drawing) for block in replace(found, shown=False).blocks())


@pytest.mark.parametrize(
    ("over", "at", "sentence"),
    [
        ("frist", "1..2 mm", "Did you mean 'first'"),
        ("first", "1..2 kg", "length"),
        ("first", "1..2", "has no unit"),
        ("first", "", "is no range"),
        ("first", "1..2..3 mm", "is no range"),
        ("first", "1..mms", "mms"),
        ("first", "one, two mm", "one"),
        ("first", "1..nan mm", "nan"),
    ],
)
def test_a_bad_range_is_one_sentence(over, at, sentence):
    with pytest.raises(UsageError, match=sentence) as caught:
        swept(CHAIN, Sweep(over=over, at=at))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("points", [1, 0, 10**9])
def test_the_number_of_points_is_bounded(points):
    with pytest.raises(UsageError, match="2 to 1000000"):
        Sweep(over="first", at="1..2 mm", points=points)
