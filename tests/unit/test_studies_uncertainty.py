"""Uncertainty budgets: example H.1 of the Guide, sources alone and together, degrees of freedom, what is refused."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from study_models import CHAIN, JOINT, ROOT, STRENGTH, UNIFORMS, setup_of

from truing import Float, Model, Tolerance, Uncertainty, Words, feasible, found, given, inputs, normal, results, uniform
from truing.calculation import calculate
from truing.errors import UsageError
from truing.setup import SwitchedOn


def budgets_of(model, study=None, **changes):
    study = study or Uncertainty(draws=0)
    return calculate(replace(setup_of(model), studies=(study,), **changes)).outcomes["uncertainty"]


@inputs
class Comparison:
    """An end gauge compared with a standard of the same nominal length: JCGM 100:2008, H.1."""

    standard: Float = given(50.000623, "mm", note="length of the standard, from its certificate")
    difference: Float = given(215.0, "nm", note="mean of five observations")
    random: Float = given(0.0, "nm", note="random effects of the comparator")
    systematic: Float = given(0.0, "nm", note="systematic effects of the comparator")
    expansion: Float = given(11.5e-6, "1/K", note="of the standard")
    warmth: Float = given(-0.1, "K", note="mean deviation of the table from 20 degC")
    cycle: Float = given(0.0, "K", note="cyclic variation of the temperature")
    other_expansion: Float = given(0.0, "1/K", note="difference of the expansions")
    other_warmth: Float = given(0.0, "K", note="difference of the temperatures")


@results
class Gauge:
    """What is asked."""

    length: Float = found("mm")


def end_gauge(at: Comparison) -> Gauge:
    """Equation (H.3) of the Guide."""
    thermal = at.other_expansion * (at.warmth + at.cycle) + at.expansion * at.other_warmth
    return Gauge(length=at.standard + at.difference + at.random + at.systematic - at.standard * thermal)


# The standard deviations as H.1.3 states them; 0.35 K is that of an arcsine of amplitude 0.5 K, drawn as a normal here
END_GAUGE = Model(
    name="end_gauge", title="Calibration of an end gauge", function=end_gauge,
    errors=[
        Tolerance("standard", normal(sd="25 nm")), Tolerance("difference", normal(sd="5.8 nm")),
        Tolerance("random", normal(sd="3.9 nm")), Tolerance("systematic", normal(sd="6.7 nm")),
        Tolerance("expansion", uniform("2e-6 1/K")), Tolerance("warmth", normal(sd="0.2 K")),
        Tolerance("cycle", normal(sd="0.35 K")), Tolerance("other_expansion", uniform("1e-6 1/K")),
        Tolerance("other_warmth", uniform("0.05 K")),
    ],
)  # fmt: skip
DEGREES = {"standard": 18, "difference": 24, "random": 5, "systematic": 8, "other_expansion": 50, "other_warmth": 2}


def test_the_end_gauge_of_the_guide_to_first_order() -> None:
    """JCGM 100:2008, H.1: u_c = 32 nm, 16 effective degrees of freedom, U = 93 nm at 99 %."""
    study = Uncertainty(level=0.99, degrees=DEGREES, type_a=("difference",), draws=0)
    found = budgets_of(END_GAUGE, study)
    budget = found.budgets["length"]
    nanometres = {source.name: round(1e9 * source.contribution, 1) for source in budget.sources}
    assert nanometres == {
        "standard": 25.0, "difference": 5.8, "random": 3.9, "systematic": 6.7, "expansion": 0.0, "warmth": 0.0,
        "cycle": 0.0, "other_expansion": 2.9, "other_warmth": 16.6,
    }  # fmt: skip
    assert 1e18 * budget.combined**2 == pytest.approx(1002, abs=1)
    assert round(1e9 * budget.combined) == 32
    assert math.floor(budget.degrees) == 16
    assert round(budget.factor, 2) == 2.92
    # the Guide multiplies what it has rounded to 32 nm; unrounded it is 92.5 nm
    assert round(budget.factor * 32) == 93
    assert 1e9 * budget.expanded == pytest.approx(92.5, abs=0.1)
    assert found.sentence("length") == "length = (50.000838 ± 0.000092) mm, k = 2.92, coverage 99 %."
    kinds = {source.name: (source.type, source.shape) for source in budget.sources}
    assert kinds["difference"] == ("A", "normal")
    assert kinds["other_warmth"] == ("B", "rectangular")


def test_what_the_first_order_leaves_out_of_the_end_gauge_is_said() -> None:
    """H.1.7: with two terms of second order u_c is 34 nm; machines drawn from the model itself have them too."""
    first = budgets_of(END_GAUGE).budgets["length"].combined
    length, kelvin = 0.050000623, math.hypot(0.2, 0.35)
    second = math.hypot(first, length * 1e-6 / 3**0.5 * kelvin, length * 2e-6 / 3**0.5 * 0.05 / 3**0.5)
    assert round(1e9 * second) == 34
    found = budgets_of(END_GAUGE, Uncertainty(draws=200_000))
    assert found.budgets["length"].drawn == pytest.approx(second, rel=0.01)
    (warning,) = found.warnings()
    assert "by +7 % of its first order: the expanded uncertainty is too small" in warning
    drawn = f"{1e8 * found.budgets['length'].drawn:.3f} × 10⁻⁵ mm"
    assert f"200000 machines drawn from the model itself have u = {drawn}." in found.blocks()[0].note


def test_a_linear_model_has_the_uncertainty_of_its_drawn_machines() -> None:
    found = budgets_of(CHAIN, Uncertainty(of="gap", draws=100_000))
    budget = found.budgets["gap"]
    assert 1e3 * budget.combined == pytest.approx(0.13, rel=1e-9)
    assert budget.drawn == pytest.approx(budget.combined, rel=0.01)
    assert found.warnings() == []
    assert [(source.name, budget.share(source)) for source in budget.ranked()] == [
        ("third", pytest.approx(144 / 169)), ("second", pytest.approx(16 / 169)), ("first", pytest.approx(9 / 169)),
    ]  # fmt: skip
    assert budget.expanded == pytest.approx(1.959964 * budget.combined, rel=1e-6)


def test_degrees_of_freedom_add_up_after_welch_and_satterthwaite_and_are_cut() -> None:
    budget = budgets_of(STRENGTH, Uncertainty(degrees={"x": 7.5}, draws=0)).budgets["total"]
    assert budget.degrees == pytest.approx(7.5)
    assert budget.factor == pytest.approx(2.364624, rel=1e-6)  # t of 7 degrees, 97.5 %
    both = budgets_of(CHAIN, Uncertainty(of="gap", degrees={"third": 4, "second": 9}, draws=0)).budgets["gap"]
    assert both.degrees == pytest.approx(0.13**4 / (0.12**4 / 4 + 0.04**4 / 9))


def test_inputs_that_move_together_are_one_source_and_apart_one_each() -> None:
    apart = budgets_of(UNIFORMS).budgets["total"]
    assert [source.name for source in apart.sources] == ["x", "y"]
    assert apart.combined == pytest.approx((2 / 3) ** 0.5, rel=1e-9)
    degrees = budgets_of(UNIFORMS, Uncertainty(degrees={"both": 6}, draws=0)).budgets["total"]
    assert degrees.degrees == pytest.approx(12)
    found = budgets_of(JOINT, Uncertainty(draws=100_000))
    budget = found.budgets["total"]
    (together,) = budget.sources
    assert (together.column, together.shape) == ("", "drawn together")
    assert budget.combined == pytest.approx(budget.drawn, rel=0.02)
    assert found.blocks()[0].rows[0][4:8] == [None, "", None, ""]


def test_a_diagnosed_effect_is_of_type_a_with_its_covariance() -> None:
    active = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5}, {"strain": 2e-6})
    conditions = {"warmth": 273.15 + 120}
    study = Uncertainty(of="gap", degrees={"effects.grow": 12}, draws=0)
    budget = budgets_of(CHAIN, study, effects=(active,), conditions=conditions).budgets["gap"]
    (grow,) = [source for source in budget.sources if source.type == "A"]
    assert (grow.name, grow.shape, grow.degrees) == ("effects.grow.strain", "normal", 12)
    assert 1e3 * grow.contribution == pytest.approx(10 * 100 * 2e-6, rel=1e-6)
    assert not any(source.type == "A" for source in budgets_of(CHAIN).budgets["gap"].sources)


def test_what_is_written_has_no_infinities_and_what_does_not_scatter_no_budget() -> None:
    found = budgets_of(CHAIN, Uncertainty(of="gap", level=0.9, draws=0))
    written = json.loads(json.dumps(found.as_json(), allow_nan=False))["gap"]
    assert written["standard_uncertainty"] == pytest.approx(0.13)
    assert written["expanded_uncertainty"] == pytest.approx(0.13 * 1.644854, rel=1e-6)
    assert (written["degrees_of_freedom"], written["unit"]) == (None, "mm")
    assert sum(source["share"] for source in written["sources"]) == pytest.approx(1)
    still = replace(CHAIN, errors=[])
    (words,) = budgets_of(still, Uncertainty(of="gap")).blocks()
    assert isinstance(words, Words)
    assert "Nothing that scatters moves the gap" in words.text


def test_drawn_machines_without_an_answer_are_counted() -> None:
    found = budgets_of(ROOT, Uncertainty(draws=1000))
    answered = found.budgets["side"].answered
    assert 800 < answered < 880  # a normal square of mean and standard deviation 1 is above 0 with 84 %
    assert f"{answered} machines drawn" in found.blocks()[0].note
    assert f"; {1000 - answered} more have no answer." in found.blocks()[0].note


def needle(at: Comparison) -> Gauge:
    """An answer at the nominal point alone."""
    feasible(at.random == 0, "the needle has fallen")
    return Gauge(length=at.standard + at.random)


def test_a_result_without_a_derivative_has_no_budget_and_says_so() -> None:
    model = Model(name="needle", title="Needle", function=needle, errors=[Tolerance("random", normal(sd="1 nm"))])
    found = budgets_of(model, Uncertainty(draws=100))
    assert found.budgets["length"].answered == 0
    (words,) = found.blocks()
    assert isinstance(words, Words)
    assert words.text == "The length has no budget: there is no derivative by random."
    assert any("does not exist" in text for text in found.warnings())
    assert json.loads(json.dumps(found.as_json(), allow_nan=False))["length"]["expanded_uncertainty"] is None
    with pytest.raises(UsageError, match="no derivative by random"):
        found.sentence("length")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"of": "gep"}, "no result 'gep'.*Did you mean 'gap'"),
        ({"level": 1.0}, "lies between 0 and 1"),
        ({"level": np.nan}, "lies between 0 and 1"),
        ({"degrees": {"thrid": 3}}, "'thrid' is no source that scatters. Did you mean 'third'"),
        ({"degrees": {"third": 0}}, "degrees of freedom lie above 0"),
        ({"type_a": ("whatever",)}, r"is no source that scatters. \(sources: first, second, third\)"),
        ({"draws": -1}, "no fewer than 0"),
    ],
)
def test_bad_options_are_one_sentence(options, sentence) -> None:
    with pytest.raises(UsageError, match=sentence) as caught:
        budgets_of(CHAIN, Uncertainty(**options))
    assert "\n" not in str(caught.value)
