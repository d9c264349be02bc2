"""Sensitivities: derivatives against calculus, shares against variances, Sobol indices against the literature."""

import json
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from study_models import CHAIN, ISHIGAMI, JOINT, ROOT, STACK, WEAR, Sum, Three, Two, setup_of

from shared import ROUNDING
from truing import (
    Float,
    Model,
    Require,
    Sensitivity,
    Sweep,
    Tolerance,
    feasible,
    found,
    given,
    inputs,
    normal,
    results,
)
from truing.calculation import calculate
from truing.declare.blocks import Drawing, Table, Words
from truing.declare.spreads import Off
from truing.errors import UsageError
from truing.setup import SwitchedOn, default_setup


def found_in(setup, study=None):
    return calculate(replace(setup, studies=(study or Sensitivity(),))).outcomes["sensitivity"]


@pytest.mark.parametrize(("x1", "x3"), [(0.3, 0.4), (1.2, -2.0), (2.9, 0.4), (17.0, -2.0)])
def test_derivatives_are_those_of_calculus(x1, x3):
    found = found_in(setup_of(ISHIGAMI, x1=x1, x2=0.7, x3=x3)).derivatives["total"]
    expected = {"x1": cos(x1) * (1 + 0.1 * x3**4), "x2": 7 * sin(1.4), "x3": 0.4 * x3**3 * sin(x1)}
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("square", [1e-6, 1.0, 4e8])
def test_the_step_finds_itself_at_any_scale(square):
    found = found_in(setup_of(replace(ROOT, errors=[]), square=square))
    assert found.derivatives["side"]["square"] == pytest.approx(0.5 / sqrt(square), rel=1e-10)


def of_x(function, sd=""):
    """The sensitivities of a result of one number, x, which scatters, and of another that only adds."""

    def model_of(two: Two) -> Sum:
        """The function, and the second number."""
        return Sum(total=function(two.x) + two.y)

    errors = [Tolerance("x", normal(sd=sd))] if sd else []
    return Model(name="bent", title="", function=model_of, errors=errors)


@pytest.mark.parametrize(
    ("function", "sd", "x", "slope", "near"),
    [
        (lambda x: np.sin(1e3 * x), "1e-6", 50.0003, 1e3 * cos(1e3 * 50.0003), 1e-6),  # a small sd leads the step
        (lambda x: np.where(np.asarray(x) < 0, np.nan, np.exp(x)), "0.01", 0.0, 1.0, 1e-7),  # ends at the point
        (lambda x: np.abs(x - 0.05), "1", 0.0, -1.0, 1e-9),  # bends a twentieth of an sd beside the point
    ],
)
def test_the_step_looks_through_what_lies_beside_the_point(function, sd, x, slope, near):
    assert found_in(default_setup(of_x(function, sd), x=x)).derivatives["total"]["x"] == pytest.approx(slope, rel=near)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda x: np.where(np.asarray(x) < 0, np.nan, np.exp(x)), "one side only"),
        (lambda x: x + 0.3 * np.sin(1.2345e9 * x), "'total' by 'x' is uncertain"),  # no step looks through this noise
        (lambda x: np.where(np.asarray(x) == 0, 1.0, np.nan), "does not exist"),
    ],
)
def test_what_a_derivative_is_worth_is_said(function, said):
    found = found_in(default_setup(of_x(function, "1")))
    assert said in found.warnings()[0]
    known = ["y"] if said == "does not exist" else ["x", "y"]
    assert [source for source in known if source in found.as_json()["total"]] == list(found.as_json()["total"])
    json.dumps(found.as_json(), allow_nan=False)


CHAIN_SHARES = {"first": 9 / 169, "second": 16 / 169, "third": 144 / 169}


def test_shares_are_those_of_the_variances():
    """Sobol's indices of a sum are its shares; the sheet ranks the sources."""
    found = found_in(setup_of(CHAIN), Sensitivity(of=("gap", "twice"), sobol=2**12))
    assert found.sd["gap"] == pytest.approx(0.13e-3, rel=1e-12)
    for result in ("gap", "twice"):
        assert found.share[result] == pytest.approx(CHAIN_SHARES, rel=1e-9)
        assert found.sobol_first[result] == pytest.approx(CHAIN_SHARES, abs=0.01)
        assert found.sobol_total[result] == pytest.approx(CHAIN_SHARES, abs=0.01)
    table, drawing = found.blocks()[:2]
    assert [row[0] for row in table.rows] == ["third", "second", "first"]
    assert "off" not in table.note
    bars = sorted(abs(bar.get_width()) for bar in drawing.draw().axes[0].patches)
    assert bars == pytest.approx([0.03, 0.04, 0.12], rel=1e-9)  # mm, one standard deviation each


@pytest.mark.parametrize(
    ("model", "result", "sd", "near"),
    [
        # ISO 286-1 Table 1: IT9 is 87, 62 and 36 um; a zone of 6 um
        (STACK, "height", 1e-6 * sqrt((87 / 6) ** 2 + (1.5 * 62 / 6) ** 2 + (0.5 * 36 / 6) ** 2 + 1), 1e-9),
        (JOINT, "total", 0.5, 0.01),  # 65536 draws stand for the joint spread: a standard error of 0.3 %
    ],
)
def test_grades_zones_and_joint_draws_are_sources_like_any_other(model, result, sd, near):
    assert found_in(setup_of(model)).sd[result] == pytest.approx(sd, rel=near)


def test_a_tolerance_that_is_off_has_a_derivative_and_no_share():
    """The sheet does not call such a source harmless."""
    setup = setup_of(CHAIN)
    found = found_in(replace(setup, spreads={**setup.spreads, "third": Off()}), Sensitivity(of="gap"))
    assert found.derivatives["gap"]["third"] == pytest.approx(-1, rel=1e-10)
    assert found.share["gap"] == pytest.approx({"first": 9 / 25, "second": 16 / 25, "third": 0}, rel=1e-9)
    assert found.sd["gap"] == pytest.approx(0.05e-3, rel=1e-12)
    table = found.blocks()[0]
    assert {row[0]: row[3] for row in table.rows} == {
        "first": pytest.approx(36), "second": pytest.approx(64), "third": None
    }  # fmt: skip
    assert "the tolerance is off" in table.note


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


def test_without_tolerances_every_number_is_a_source():
    found = found_in(setup_of(replace(WEAR, errors=[])), Sensitivity(of="depth"))
    assert set(found.derivatives["depth"]) == {"rate", "load", "working_time"}
    assert found.sd["depth"] == found.derivatives["depth"]["load"] == 0


def test_results_named_by_goals_are_meant_and_written_in_their_unit_per_source_unit():
    for model, expected in ((CHAIN, ["gap", "twice"]), (WEAR, ["depth"]), (ISHIGAMI, ["total"]), (ROOT, ["side"])):
        assert list(found_in(setup_of(model)).derivatives) == expected
    found = found_in(setup_of(WEAR)).as_json()["depth"]["rate"]
    assert (found["unit"], found["derivative"]) == ("um/(um/h)", pytest.approx(20))  # 10 h, two stages
    assert found_in(setup_of(ROOT)).as_json()["side"]["square"]["unit"] == "m/m^2"


@pytest.mark.parametrize("factor", [7.0, 7.0007])
def test_stated_derivatives_are_used_and_compared_with_numeric_ones(factor):
    def stated(inputs: Three) -> dict:
        """Derivatives of the Ishigami function, one of them perhaps off by a part in ten thousand."""
        x1, x2, x3 = inputs.x1, inputs.x2, inputs.x3
        return {
            "total": {"x1": cos(x1) * (1 + 0.1 * x3**4), "x2": factor * sin(2 * x2), "x3": 0.4 * x3**3 * sin(x1)},
        }

    found = found_in(setup_of(replace(ISHIGAMI, derivatives=stated), x1=1.0, x2=0.5, x3=1.5))
    assert found.derivatives["total"]["x2"] == pytest.approx(factor * sin(1.0), rel=ROUNDING)
    assert found.agreement["total"] == pytest.approx(factor / 7 - 1, rel=1e-3, abs=1e-9)
    assert ["one of them is wrong" in text for text in found.warnings()] == ([True] if factor > 7 else [])


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


@pytest.mark.parametrize(("model", "reason"), [(ROOT, "machines failed"), (JOINT, "independent")])
def test_no_sobol_indices_where_they_mean_nothing(model, reason):
    found = found_in(setup_of(model), Sensitivity(sobol=64))
    assert not found.sobol_first
    assert reason in found.warnings()[0]


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
    assert any(
        isinstance(block, Words) and "1 at -1 m²: no square has a negative area" in block.text
        for block in found.blocks()
    )


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


def test_results_are_printed_in_the_chosen_unit_and_drawn_where_no_section_shows_them():
    found = swept(CHAIN, Sweep(over="first", at="20..40 mm", points=3), units={"gap": "um"})
    assert found.as_json()["results"]["gap"] == {"unit": "um", "values": pytest.approx([0, 1e4, 2e4], abs=1e-6)}
    assert found.as_json()["axis"] == pytest.approx([20, 30, 40])
    drawing = next(block for block in found.blocks() if isinstance(block, Drawing))
    assert [len(axes.lines) for axes in drawing.draw().axes] == [3, 2]  # first the one with a limit; the stated value
    assert not any(isinstance(block, Drawing) for block in replace(found, shown=False).blocks())


def test_the_table_says_where_the_extremes_are_and_results_along_their_own_axis_are_kept():
    found = swept(CHAIN, Sweep(over="third", at="30..50 mm", points=5))
    table = next(block for block in found.blocks() if isinstance(block, Table))
    gap = next(row for row in table.rows if row[0] == "gap")
    assert gap == ["gap", "mm", pytest.approx(0, abs=1e-12), pytest.approx(50), pytest.approx(20), 30]
    found = swept(WEAR, Sweep(over="rate", at="1, 2 um/h"))
    assert 1e6 * found.results["course"] == pytest.approx(np.array([[2, 8, 18], [4, 16, 36]]))


@inputs
class Rope:
    """What pulls, and how thick the rope is."""

    pull: Float = given(5.0, "kN", at_least=0)
    area: Float = given(100.0, "mm^2")


@results
class Pulled:
    """What it must hold, and what it can."""

    force: Float = found("kN")
    strength: Float = found("kN")


def rope(at: Rope) -> Pulled:
    """A rope is as strong as it is thick."""
    feasible(at.area >= 0, "nothing is left of the rope")
    return Pulled(force=at.pull + 0 * at.area, strength=at.area * 100e6)


ROPE = Model(name="rope", title="Rope", function=rope, objectives=[Require("force", at_most="strength")])


def test_a_limit_that_is_a_result_is_drawn_where_it_exists_and_met_where_both_are_equal():
    found = swept(ROPE, Sweep(over="area", at="-50, 0, 40, 100, 150 mm^2"))
    (crossing,) = found.crossings
    assert (crossing.limit, crossing.kept) == ("force", "above")
    assert crossing.at == pytest.approx(50e-6, rel=1e-9)
    assert found.limit_table().rows == [["force", "≤ strength", pytest.approx(50), "above it"]]
    panel = next(block for block in found.blocks() if isinstance(block, Drawing)).draw().axes[0]
    limit = next(line for line in panel.lines if line.get_linestyle() == "--")
    assert limit.get_ydata() == pytest.approx([np.nan, 0, 4, 10, 15], nan_ok=True)
    assert "≤ strength" in [text.get_text() for text in panel.texts]
    assert found.gaps() == ["1 of 5 points have no answer: 1 at -50 mm²: nothing is left of the rope."]


@pytest.mark.parametrize(
    ("study", "options", "sentence"),
    [
        (Sensitivity, {"of": "gep"}, "no result 'gep'.*Did you mean 'gap'"),
        (Sensitivity, {"at_inputs": ("thrid",)}, "Did you mean 'third'"),
        *((Sensitivity, {"sobol": count}, "power of two") for count in (3, -2)),
        (Sweep, {"over": "frist", "at": "1..2 mm"}, "Did you mean 'first'"),
        *((Sweep, {"over": "first", "at": at}, "is no range") for at in ("", "1..2..3 mm")),
        *(
            (Sweep, {"over": "first", "at": f"1..{end}"}, said)
            for end, said in [("2 kg", "length"), ("2", "has no unit"), ("mms", "mms"), ("nan mm", "nan")]
        ),
        (Sweep, {"over": "first", "at": "one, two mm"}, "one"),
        *((Sweep, {"over": "first", "at": "1..2 mm", "points": points}, "2 to 1000000") for points in (1, 10**9)),
    ],
)
def test_bad_options_are_one_sentence(study, options, sentence):
    with pytest.raises(UsageError, match=sentence) as caught:
        calculate(replace(setup_of(CHAIN), studies=(study(**options),)))
    assert "\n" not in str(caught.value)
    with pytest.raises(UsageError, match="runs along an axis"):
        found_in(setup_of(WEAR), Sensitivity(of="course"))
