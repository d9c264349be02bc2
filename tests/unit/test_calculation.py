"""A whole run: what it warns of beside its studies, and what sections see of it."""

from dataclasses import replace

import numpy as np
import pytest
from sample_models import STAGE
from study_models import CHAIN, UNIFORMS, WEAR, setup_of

from truing import (
    Bench,
    Maximise,
    Optimise,
    Optimum,
    Reliability,
    Require,
    Tolerance,
    Vary,
    normal,
)
from truing.calculation import calculate
from truing.evaluate import evaluate
from truing.executors import open_executor
from truing.setup import SwitchedOn, default_setup
from truing.studies.checks import EXIT_CODES, chance_check, margin_of
from truing.studies.optimise import bounds_of
from truing.studies.verdicts import sentence_of

GROWING = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5})
IDLE = "effect 'grow' is on, but 'warmth' stays at its reference: it does nothing"


def test_an_effect_that_is_on_at_its_reference_is_a_warning() -> None:
    """A condition that scatters does not stay there."""
    setup = replace(setup_of(CHAIN), effects=(GROWING,))
    assert calculate(setup).warnings == (IDLE,)
    warmer = replace(setup, conditions={"warmth": setup.conditions["warmth"] + 1})
    scattering = replace(CHAIN, errors=[*CHAIN.errors, Tolerance("warmth", normal(sd="5 K"))])
    for other in (warmer, replace(setup_of(scattering), effects=(GROWING,))):
        assert calculate(other).warnings == ()


def test_sections_see_the_inputs_as_effects_leave_them() -> None:
    plain = setup_of(CHAIN)
    warmer = replace(plain, effects=(GROWING,), conditions={"warmth": plain.conditions["warmth"] + 10})
    record = calculate(warmer).record
    assert record.inputs == plain.inputs
    assert record.acting.first == pytest.approx(plain.inputs.first * (1 + 1e-4), rel=1e-12)
    assert calculate(plain).record.acting == plain.inputs


# The workbench of a study of one's own: another design, its machines, and many calculations at once.


def bench_of(**values: str) -> Bench:
    setup = setup_of(CHAIN, **values)
    results = evaluate(setup)
    return Bench(setup, results, open_executor("serial"), setup.model.read_results(results))


def test_another_design_has_its_own_results_and_widths_and_leaves_the_first_alone() -> None:
    bench = bench_of()
    name, inner = next(iter(bench.setup.distributions().items()))
    value, (scatter,) = float(bench.setup.nominal(name)), inner.values()
    moved = bench.changed({name: value + 1e-3})
    assert moved.answers["gap"] != bench.answers["gap"]
    assert moved.answers["gap"] == moved.setup.model.read_results(evaluate(moved.setup))["gap"]
    assert float(bench.setup.nominal(name)) == value
    (wide,) = bench.changed({}, {name: 2 * scatter.width}).setup.distributions()[name].values()
    assert wide.sd == pytest.approx(2 * scatter.sd, rel=1e-12)


def test_drawn_machines_are_the_first_of_the_reliability() -> None:
    """As many as one batch of the study: the same mean to the last digit."""
    bench = bench_of()
    odds = calculate(replace(bench.setup, studies=(Reliability(draws=500),))).outcomes["reliability"]
    gaps = bench.rows(bench.drawn(500), 500, "gap")["gap"]
    assert gaps.shape == (500,)
    assert np.mean(gaps) == pytest.approx(odds.mean["gap"], rel=1e-12)
    assert (np.min(gaps), np.max(gaps)) == (odds.moments["gap"].smallest, odds.moments["gap"].largest)


# Limits that need no probability: which place decides, and what happens on the limit itself.


def check_of(model, require, **values):
    (check,) = calculate(setup_of(replace(model, objectives=[require]), **values)).checks
    return check


@pytest.mark.parametrize(
    ("value", "limit", "at_least", "margin"),
    [(60.0, 80.0, False, 0.25), (100.0, 80.0, False, -0.25), (100.0, 80.0, True, 0.25), (60.0, 80.0, True, -0.25),
     (-6.0, -4.0, False, 0.5), (-6.0, -4.0, True, -0.5), (0.3, 0.0, False, -0.3), (0.3, 0.0, True, 0.3)],
)  # fmt: skip
def test_margin_is_positive_where_it_is_safe(value: float, limit: float, at_least: bool, margin: float) -> None:
    assert margin_of(value, limit, at_least=at_least) == pytest.approx(margin)


@pytest.mark.parametrize(("chance", "passed"), [(0.9, True), (0.8999, False), (0.9001, True)])
def test_a_chance_below_its_goal_fails_by_however_little(chance: float, passed: bool) -> None:
    check = chance_check("gap", chance, 0.9)
    assert (check.passed, check.margin >= 0) == (passed, passed)


@pytest.mark.parametrize("kind", ["at_most", "at_least"])
def test_a_value_on_its_limit_keeps_it(kind: str) -> None:
    check = check_of(UNIFORMS, Require("total", **{kind: "0.5"}), x=0.25, y=0.25)
    assert (check.value, check.limit, check.margin, check.passed) == (0.5, 0.5, 0.0, True)


@pytest.mark.parametrize(
    ("limit", "worst", "passed"),
    [({"at_most": "40 um"}, 36.0, True), ({"at_most": "30 um"}, 36.0, False),
     ({"at_least": "3 um"}, 4.0, True), ({"at_least": "5 um"}, 4.0, False), ({"within": "1 um"}, 0.0, True)],
)  # fmt: skip
def test_along_an_axis_the_worst_place_decides(limit: dict[str, str], worst: float, passed: bool) -> None:
    """2 um/h after 1, 4 and 9 h in two stages: 4, 16 and 36 um; within is measured at every place."""
    check = check_of(WEAR, Require("course", **limit))
    assert (check.value, check.unit, check.passed) == (pytest.approx(worst), "um", passed)
    assert check.limit == pytest.approx(float(next(iter(limit.values())).split()[0]))
    assert (check.margin > 0) == passed


def test_a_limit_is_printed_in_the_unit_of_its_result() -> None:
    setup = setup_of(replace(CHAIN, objectives=[Require("gap", at_most="0.011 m")]))
    for units, unit, size in (({}, "mm", 1.0), ({"gap": "um"}, "um", 1e3)):
        (check,) = calculate(replace(setup, units=units)).checks
        assert (check.value, check.limit, check.unit) == (pytest.approx(10 * size), pytest.approx(11 * size), unit)
        assert check.margin == pytest.approx(1 / 11)


FACTORED = replace(
    STAGE,
    errors=[],
    objectives=[
        Require("ratio", at_least="face_factor"), Require("ratio", at_most="3"), Vary("teeth_sun", "5", "31"),
        Maximise("ratio"),
    ],
)  # fmt: skip


def test_a_limit_that_is_not_given_asks_for_nothing() -> None:
    """Of 31 teeth on 5 to 31 the largest ratio up to 3 is 31 on 11."""
    for asked, names in (({}, ["ratio"]), ({"face_factor": 1.2}, ["ratio at least", "ratio at most"])):
        setup = default_setup(FACTORED, surface=None, **asked)
        assert [check.name for check in calculate(setup).checks] == names
        assert sorted(bound.name for bound in bounds_of(setup)) == sorted(names)
        searched = calculate(replace(setup, studies=(Optimise(population=10, generations=12),)))
        (best,) = searched.record.outcome(Optimum).as_json()["front"]
        assert best["objectives"]["ratio"] == pytest.approx(31 / 11, rel=1e-12)


PROBABLE = replace(
    UNIFORMS, objectives=[Require("total", at_most="1.5", reliability=0.9), Require("total", at_least="0")]
)


def test_a_limit_that_no_study_of_the_run_decides_is_undecided() -> None:
    """Reliability would; without it the run neither passes nor says that there are no limits."""
    model = replace(PROBABLE, studies=[Reliability(draws=500)])
    decided = calculate(replace(setup_of(model), studies=())).decided
    assert {check.compared: (check.state, check.undecided) for check in decided.checks} == {
        "total": ("passes", ""), "P(total ≤ 1.5)": ("undecided", "reliability"),
    }  # fmt: skip
    assert (decided.verdict, EXIT_CODES[decided.verdict]) == ("undecided", 1)
    words = "1 of 2 checks is undecided: total at most. No study of this run decides it; reliability would."
    assert sentence_of(decided) == words
    assert calculate(setup_of(model)).verdict != "undecided"
    alone = calculate(setup_of(replace(PROBABLE, studies=[]))).decided
    assert sentence_of(alone).endswith("No study of the model decides it.")
