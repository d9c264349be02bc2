"""Sensitivities: derivatives against calculus, shares against variances, Sobol indices against the literature."""

import json
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from study_models import CHAIN, ISHIGAMI, JOINT, ROOT, STACK, WEAR, Sum, Three, Two, setup_of

from shared import ROUNDING
from truing import Model, Sensitivity, Sweep, Tolerance, normal
from truing.calculation import calculate
from truing.declare.blocks import Drawing, Table, Words
from truing.declare.spreads import Off
from truing.errors import UsageError
from truing.setup import SwitchedOn, default_setup


def found_in(setup, study=None):
    return calculate(replace(setup, studies=(study or Sensitivity(),))).outcomes["sensitivity"]


@pytest.mark.parametrize("x1", [0.3, 1.2, 2.9, 17.0])
@pytest.mark.parametrize("x3", [0.4, -2.0])
def test_derivatives_are_those_of_calculus(x1, x3):
    found = found_in(setup_of(ISHIGAMI, x1=x1, x2=0.7, x3=x3)).derivatives["total"]
    assert found["x1"] == pytest.approx(cos(x1) * (1 + 0.1 * x3**4), rel=1e-9)
    assert found["x2"] == pytest.approx(7 * sin(1.4), rel=1e-9)
    assert found["x3"] == pytest.approx(0.4 * x3**3 * sin(x1), rel=1e-9)


@pytest.mark.parametrize("square", [1e-6, 1.0, 4e8])
def test_the_step_finds_itself_at_any_scale(square):
    found = found_in(setup_of(replace(ROOT, errors=[]), square=square))
    assert found.derivatives["side"]["square"] == pytest.approx(0.5 / sqrt(square), rel=1e-10)


def steep(two: Two) -> Sum:
    """Varies over a thousandth of its argument, far from zero."""
    return Sum(total=np.sin(1e3 * two.x) + two.y)


def test_a_small_standard_deviation_leads_the_step():
    model = Model(name="steep", title="", function=steep, errors=[Tolerance("x", normal(sd="1e-6"))])
    found = found_in(default_setup(model, x=50.0003))
    assert found.derivatives["total"]["x"] == pytest.approx(1e3 * cos(1e3 * 50.0003), rel=1e-6)


def test_a_model_that_ends_at_the_point_is_differentiated_from_one_side():
    def edge(two: Two) -> Sum:
        """Has no values below zero."""
        return Sum(total=np.where(np.asarray(two.x) < 0, np.nan, np.exp(two.x)) + two.y)

    model = Model(name="edge", title="", function=edge, errors=[Tolerance("x", normal(sd="0.01"))])
    found = found_in(default_setup(model))
    assert found.derivatives["total"]["x"] == pytest.approx(1.0, rel=1e-7)
    assert "one side only" in found.warnings()[0]


def test_what_has_no_derivative_is_left_out_and_said():
    def island(two: Two) -> Sum:
        """Has a value at zero only."""
        return Sum(total=np.where(np.asarray(two.x) == 0, 1.0, np.nan) + two.y)

    found = found_in(default_setup(Model(name="island", title="", function=island)))
    assert set(found.as_json()["total"]) == {"y"}
    assert "does not exist" in found.warnings()[0]
    json.dumps(found.as_json(), allow_nan=False)
    assert [row[0] for row in found.blocks()[0].rows] == ["y"]


def test_a_kink_beside_the_point_does_not_reach_it():
    def kink(two: Two) -> Sum:
        """Bends a twentieth of a standard deviation beside the nominal point."""
        return Sum(total=np.abs(two.x - 0.05) + two.y)

    model = Model(name="kink", title="", function=kink, errors=[Tolerance("x", normal(sd="1"))])
    assert found_in(default_setup(model)).derivatives["total"]["x"] == pytest.approx(-1.0, rel=1e-9)


def test_a_rough_model_is_said_to_be_uncertain():
    def rough(two: Two) -> Sum:
        """A slope under a noise that no step can look through."""
        return Sum(total=two.x + 0.3 * np.sin(1.2345e9 * two.x) + two.y)

    model = Model(name="rough", title="", function=rough, errors=[Tolerance("x", normal(sd="1"))])
    assert "'total' by 'x' is uncertain" in found_in(default_setup(model)).warnings()[0]


def test_shares_are_those_of_the_variances():
    found = found_in(setup_of(CHAIN), Sensitivity(of="gap"))
    assert found.sd["gap"] == pytest.approx(0.13e-3, rel=1e-12)
    assert found.share["gap"] == pytest.approx({"first": 9 / 169, "second": 16 / 169, "third": 144 / 169}, rel=1e-9)


def test_a_tolerance_that_is_off_has_a_derivative_and_no_share():
    setup = setup_of(CHAIN)
    found = found_in(replace(setup, spreads={**setup.spreads, "third": Off()}), Sensitivity(of="gap"))
    assert found.derivatives["gap"]["third"] == pytest.approx(-1, rel=1e-10)
    assert found.share["gap"] == pytest.approx({"first": 9 / 25, "second": 16 / 25, "third": 0}, rel=1e-9)
    assert found.sd["gap"] == pytest.approx(0.05e-3, rel=1e-12)


def test_the_sheet_does_not_call_a_source_harmless_that_is_off():
    setup = setup_of(CHAIN)
    table = found_in(replace(setup, spreads={**setup.spreads, "third": Off()}), Sensitivity(of="gap")).blocks()[0]
    shares = {row[0]: row[3] for row in table.rows}
    assert shares == {"first": pytest.approx(36), "second": pytest.approx(64), "third": None}
    assert "the tolerance is off" in table.note
    assert "off" not in found_in(setup, Sensitivity(of="gap")).blocks()[0].note


def test_unknowns_of_effects_that_are_on_are_sources():
    grow = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5}, {"strain": 2e-6})
    read = SwitchedOn(CHAIN.effects["misread"], {"offset": 1e-4}, {"offset": 1e-4})
    setup = replace(setup_of(CHAIN), conditions={"warmth": 293.15 + 30}, effects=(grow, read))
    found = found_in(setup, Sensitivity(of="gap"))
    assert set(found.derivatives["gap"]) == {"first", "second", "third", "effects.grow.strain"}
    # 10 mm of gap grow by 30 K times the strain
    assert found.derivatives["gap"]["effects.grow.strain"] == pytest.approx(0.3, rel=1e-9)
    assert found.derivatives["gap"]["first"] == pytest.approx(1 + 30e-5, rel=1e-9)
    assert found.as_json()["gap"]["effects.grow.strain"]["unit"] == "mm/(1/K)"
    variance = (0.13e-3 * (1 + 30e-5)) ** 2 + (0.3 * 2e-6) ** 2
    assert found.sd["gap"] == pytest.approx(sqrt(variance), rel=1e-9)


def test_sources_that_scatter_together_have_the_variance_of_their_sum():
    # 65536 draws stand for the joint spread: a standard error of 0.3 %
    assert found_in(setup_of(JOINT)).sd["total"] == pytest.approx(0.5, rel=0.01)


def test_without_tolerances_every_number_is_a_source():
    found = found_in(setup_of(replace(WEAR, errors=[])), Sensitivity(of="depth"))
    assert set(found.derivatives["depth"]) == {"rate", "load", "working_time"}
    assert found.sd["depth"] == 0
    assert found.derivatives["depth"]["load"] == 0


@pytest.mark.parametrize(
    ("model", "expected"), [(CHAIN, ["gap", "twice"]), (WEAR, ["depth"]), (ISHIGAMI, ["total"]), (ROOT, ["side"])]
)
def test_results_named_by_goals_are_meant(model, expected):
    assert list(found_in(setup_of(model)).derivatives) == expected


def test_derivatives_are_written_in_result_unit_per_source_unit():
    found = found_in(setup_of(WEAR)).as_json()["depth"]["rate"]
    assert found["unit"] == "um/(um/h)"
    assert found["derivative"] == pytest.approx(20)  # 10 h, two stages
    assert found_in(setup_of(ROOT)).as_json()["side"]["square"]["unit"] == "m/m^2"


def stated(inputs: Three) -> dict:
    """Exact derivatives of the Ishigami function."""
    x1, x2, x3 = inputs.x1, inputs.x2, inputs.x3
    return {
        "total": {"x1": cos(x1) * (1 + 0.1 * x3**4), "x2": 7 * sin(2 * x2), "x3": 0.4 * x3**3 * sin(x1)},
    }


def wrong(inputs: Three) -> dict:
    """One of them is off by a part in ten thousand."""
    return {"total": {**stated(inputs)["total"], "x2": 7.0007 * sin(2 * inputs.x2)}}


def test_stated_derivatives_are_used_and_agree():
    found = found_in(setup_of(replace(ISHIGAMI, derivatives=stated), x1=1.0, x2=0.5, x3=1.5))
    assert found.derivatives["total"]["x2"] == pytest.approx(7 * sin(1.0), rel=ROUNDING)
    assert 0 <= found.agreement["total"] < 1e-9
    assert not found.warnings()


def test_stated_derivatives_that_are_wrong_are_said():
    found = found_in(setup_of(replace(ISHIGAMI, derivatives=wrong), x1=1.0, x2=0.5, x3=1.5))
    assert found.agreement["total"] == pytest.approx(1e-4, rel=1e-3)
    assert "one of them is wrong" in found.warnings()[0]


def test_stated_derivatives_do_not_speak_for_an_effect():
    def nothing(inputs):
        return {"gap": {"first": 123.0}}

    grow = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5})
    setup = replace(setup_of(replace(CHAIN, derivatives=nothing)), effects=(grow,))
    assert found_in(setup).derivatives["gap"]["first"] == pytest.approx(1, rel=1e-9)


# A = 7, B = 0.1: closed forms in T. Ishigami, T. Homma, An importance quantification technique, ISUMA 1990.
V1, V2, V13 = 0.5 * (1 + 0.1 * pi**4 / 5) ** 2, 7**2 / 8, 0.1**2 * pi**8 * (1 / 18 - 1 / 50)
WHOLE = V1 + V2 + V13


def test_sobol_indices_of_ishigami():
    found = found_in(setup_of(ISHIGAMI), Sensitivity(sobol=2**13))
    first = {"x1": V1 / WHOLE, "x2": V2 / WHOLE, "x3": 0.0}
    total = {"x1": (V1 + V13) / WHOLE, "x2": V2 / WHOLE, "x3": V13 / WHOLE}
    assert found.sobol_first["total"] == pytest.approx(first, abs=0.01)
    assert found.sobol_total["total"] == pytest.approx(total, abs=0.01)
    assert found.as_json()["total"]["x1"]["sobol_first"] == found.sobol_first["total"]["x1"]


def test_sobol_indices_of_a_sum_are_its_shares():
    found = found_in(setup_of(CHAIN), Sensitivity(of=("gap", "twice"), sobol=2**12))
    for result in ("gap", "twice"):
        assert found.sobol_first[result] == pytest.approx(found.share[result], abs=0.01)
        assert found.sobol_total[result] == pytest.approx(found.share[result], abs=0.01)


@pytest.mark.parametrize(("model", "reason"), [(ROOT, "machines failed"), (JOINT, "independent")])
def test_no_sobol_indices_where_they_mean_nothing(model, reason):
    found = found_in(setup_of(model), Sensitivity(sobol=64))
    assert not found.sobol_first
    assert reason in found.warnings()[0]


@pytest.mark.parametrize(
    ("study", "sentence"),
    [
        (Sensitivity(of="gep"), "no result 'gep'.*Did you mean 'gap'"),
        (Sensitivity(at_inputs=("thrid",)), "Did you mean 'third'"),
    ],
)
def test_unknown_names_are_refused(study, sentence):
    with pytest.raises(UsageError, match=sentence):
        found_in(setup_of(CHAIN), study)


def test_a_result_along_an_axis_is_refused():
    with pytest.raises(UsageError, match="runs along an axis"):
        found_in(setup_of(WEAR), Sensitivity(of="course"))


@pytest.mark.parametrize("sobol", [3, 1000, -2])
def test_the_sobol_sample_is_a_power_of_two(sobol):
    with pytest.raises(UsageError, match="power of two"):
        Sensitivity(sobol=sobol)


def test_the_sheet_ranks_the_sources():
    found = found_in(setup_of(CHAIN), Sensitivity(of="gap"))
    table, drawing = found.blocks()
    assert [row[0] for row in table.rows] == ["third", "second", "first"]
    assert isinstance(drawing, Drawing)
    bars = sorted(abs(bar.get_width()) for bar in drawing.draw().axes[0].patches)
    assert bars == pytest.approx([0.03, 0.04, 0.12], rel=1e-9)  # mm, one standard deviation each


def test_grades_and_zones_are_sources_like_any_other():
    found = found_in(setup_of(STACK))
    assert found.derivatives["height"] == pytest.approx(
        {"large": 1, "middle": 1.5, "small": -0.5, "shift": 1}, rel=1e-9
    )
    # ISO 286-1 Table 1: IT9 is 87, 62 and 36 um
    variance = (87e-6 / 6) ** 2 + (1.5 * 62e-6 / 6) ** 2 + (0.5 * 36e-6 / 6) ** 2 + (1e-6) ** 2
    assert found.sd["height"] == pytest.approx(sqrt(variance), rel=1e-9)


# Sweeps: one batch along an input, failed points with their reasons.


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
