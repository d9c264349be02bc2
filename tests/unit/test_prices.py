"""What tolerances cost is a result like any other: printed, limited, in every case."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pin_wear import PIN_WEAR, Pin
from study_models import PAIR

from truing import (
    Allocation,
    Float,
    Model,
    Price,
    Reliability,
    Require,
    Sensitivities,
    Sensitivity,
    Tolerance,
    by_choice,
    found,
    grade,
    normal,
    off,
    plus_minus,
    results,
)
from truing.calculation import calculate
from truing.cases import CaseResult, CasesTable, case_setup, run_cases
from truing.describe import description
from truing.errors import DeclarationError
from truing.executors import open_executor
from truing.fits import tolerance
from truing.measurements import CasesFile, RowCount, StatedCase
from truing.prices import price_of, prices_at
from truing.report.limits import least_margin
from truing.runs.documents import results_document
from truing.runs.provenance import provenance_of
from truing.setup import Setup, SwitchedOn, default_setup
from truing.studies.checks import Check, Proposal
from truing.studies.verdicts import Decided
from truing.testing.sources import spreads_resolve
from truing.testing.subject import Subject

PAID = Price("40 * width**-0.5", width="N", unit="EUR")
LIMITED = replace(
    PIN_WEAR,
    errors=[
        Tolerance("load", normal(sd="3 %"), price=PAID),
        Tolerance("area", plus_minus("0.5 mm^2"), price=Price("2 / width", width="mm^2", unit="EUR")),
        Tolerance("hardness", normal(sd="6 %")),
    ],
    objectives=[Require("tolerance_price", at_most="10 EUR")],
    studies=[],
    sheet=[],
)
BAND = 6 * 0.03 * 120.0  # N: six standard deviations of 3 % of 120 N
SUM = 40 / BAND**0.5 + 2 / 1.0  # EUR: and a band of 1 mm^2


def test_the_sum_is_an_answer_and_a_check() -> None:
    setup = default_setup(LIMITED)
    found = calculate(replace(setup, units={"tolerance_price": "kEUR"}))
    assert found.answers["tolerance_price"] == pytest.approx(SUM, rel=1e-12)
    document = results_document(found, provenance_of(found.setup))
    assert document["results"]["tolerance_price"] == {"value": pytest.approx(SUM / 1000, rel=1e-12), "unit": "kEUR"}
    (check,) = calculate(setup).checks
    assert (check.name, check.unit, check.passed) == ("tolerance_price", "EUR", False)
    assert check.margin == pytest.approx((10 - SUM) / 10, rel=1e-12)
    plain = replace(LIMITED, errors=[Tolerance("load", normal(sd="3 %"))], objectives=[])
    assert "tolerance_price" not in {**plain.result_fields, **calculate(default_setup(plain)).answers}


@pytest.mark.parametrize(
    ("errors", "free", "price"),
    [
        (LIMITED.errors, ("area",), SUM - 2.0),  # what is off is not paid
        (LIMITED.errors, ("load", "area", "hardness"), 0.0),
        ([Tolerance("both", normal(sd="3 %"), on=["load", "hardness"], price=PAID)], (), SUM - 2.0),  # paid once
    ],
)
def test_every_tolerance_in_force_is_paid_once(errors: list[Any], free: tuple[str, ...], price: float) -> None:
    setup = default_setup(replace(LIMITED, errors=errors))
    setup = replace(setup, spreads={**setup.spreads, **dict.fromkeys(free, off())})
    assert calculate(setup).answers["tolerance_price"] == pytest.approx(price, rel=1e-12)


# A price that follows a choice


FORMS = {"reciprocal": lambda um: 1300 / um, "square": lambda um: 1300 / um**2}  # EUR for two bands of the same width
GRADED = replace(
    PAIR,
    errors=[replace(PAIR.tolerances["one"], spread=grade("IT8"))],
    objectives=[Require("length", within="20 um", reliability=0.9)],
)


@pytest.mark.parametrize("law", FORMS)
def test_a_price_follows_the_choice(law: str) -> None:
    """An allocation buys at this price, too."""
    setup = default_setup(PAIR, law=law)
    price = FORMS[law](24)
    assert calculate(setup).answers["tolerance_price"] == pytest.approx(price, rel=1e-14)
    settled = price_of(setup, PAIR.tolerances["one"])
    assert settled is not None
    assert prices_at(settled, np.array([24e-6, 24e-6])) == pytest.approx([price / 1.3, price / 1.3], rel=1e-14)
    allotted = calculate(replace(default_setup(GRADED, law=law), studies=(Allocation(draws=10),)))
    allocation = allotted.outcomes["allocation"]
    width = tolerance(allocation.tolerances["one"], 0.03)
    assert allocation.cost == pytest.approx(FORMS[law](1e6 * width) / 1.3, rel=1e-12)


def test_describe_tells_both_prices_and_the_kit_checks_them() -> None:
    said = description(Subject(PAIR).offer)["tolerances"][0]["price"]
    assert said["chooser"] == "law"
    assert said["prices"]["square"] == {"formula": "1000.0 / width**2", "width": "um", "unit": "EUR"}
    json.dumps(said)
    both = by_choice("law", reciprocal=EUR, square=replace(EUR, formula="-3 * width"))
    mistaken = replace(PAIR, errors=[Tolerance("one", plus_minus("0.125 mm"), price=both)])
    with pytest.raises(AssertionError, match=r"the price of tolerance .one. is -0\.75 at its declared width"):
        spreads_resolve(Subject(mistaken))


EUR = Price("1 / width", width="mm", unit="EUR")
WRONG = [
    (by_choice("lwa", reciprocal=EUR, square=EUR), "names 'lwa', which is no input.*law"),
    (by_choice("one", reciprocal=EUR, square=EUR), "is chosen by 'one', which offers no choices"),
    (by_choice("law", reciprocal=EUR), "has a price for reciprocal, but 'law' offers reciprocal, square"),
    (by_choice("law", reciprocal=EUR, square=replace(EUR, unit="yuan")), "the prices are in EUR and yuan"),
    (by_choice("law", reciprocal=EUR, square=replace(EUR, formula="1 / breadth")), "names breadth; it is a formula"),
]


@pytest.mark.parametrize(("price", "words"), WRONG)
def test_a_price_that_cannot_be_chosen_is_refused(price: Any, words: str) -> None:
    with pytest.raises(DeclarationError, match=words):
        replace(PAIR, errors=[Tolerance("one", plus_minus("0.1 mm"), price=price)])
    for laws in ({"reciprocal": EUR, "square": off()}, {}):
        with pytest.raises(DeclarationError, match="takes a spread for each choice, or a price for each"):
            by_choice("law", **laws)


# Many cases: each row changes the setup, the smallest margin governs, one that fails does not take the others away.


@results
class Steep:
    """What a study gives."""

    slope: Float = found("um/N", symbol="s", note="depth per load")


def steep(given: Sensitivities) -> Steep:
    """Depth per load."""
    return Steep(slope=given.derivatives["depth"]["load"])


BARE = replace(PIN_WEAR, objectives=[], studies=[], sheet=[])
PLAIN = replace(BARE, objectives=[Require("pressure", at_most="80 MPa")])
CHANCE = replace(
    BARE, objectives=[Require("pressure", at_most="80 MPa", reliability=0.99)], studies=[Reliability(draws=2000)]
)
STEEP = [Sensitivity(of="depth", gives=steep)]
GIVEN = replace(BARE, objectives=[Require("slope", at_most="0.2 um/N")], studies=STEEP)


def run(model: Model[Any, Any], *cases: dict[str, Any], setup: Setup | None = None) -> CasesTable:
    """Run cases given in SI, as read from a file with two lines of remarks."""
    rows = [
        StatedCase(place, place + 1, f"case {place}", values, "cases.csv")
        for place, values in enumerate(cases, start=1)
    ]
    count = RowCount("cases.csv", len(cases) + 2).without("begins with '#'", (97, 98))
    with open_executor("serial") as executor:
        calculation, table = run_cases(setup or default_setup(model), CasesFile(tuple(rows), count), executor=executor)
    governing = table.cases[table.governing]
    shown = calculation.setup.model.read_inputs(calculation.setup.inputs)
    assert all(shown[name] == value for name, value in governing.values.items() if name in shown)
    return table


def test_a_case_changes_inputs_and_conditions() -> None:
    setup = default_setup(PIN_WEAR)
    changed = case_setup(setup, StatedCase(1, 2, "a", {"load": 84.0, "probe_temperature": 300.0}))
    assert changed.inputs == replace(setup.inputs, load=84.0)
    assert isinstance(changed.inputs, Pin)
    assert changed.conditions == {"probe_temperature": 300.0}
    assert {"load", "probe_temperature"} <= changed.source.stated
    assert setup.inputs.load == 120


@pytest.mark.parametrize("model", [PLAIN, CHANCE], ids=["one call", "one by one"])
def test_the_smallest_margin_governs(model: Model[Any, Any]) -> None:
    """Pressures are 5, 82 and 10 MPa against 80 MPa."""
    table = run(model, {"load": 140.0}, {"load": 2296.0}, {"load": 280.0})
    assert table.governing == 1
    assert [case.answers["pressure"] / 1e6 for case in table.cases] == pytest.approx([5, 82, 10])
    assert [all(check.passed for check in case.checks) for case in table.cases] == [True, False, True]
    assert table.verdict == "fails"
    assert table.failed == ()
    assert table.varied == ("load",)


@pytest.mark.parametrize("model", [PLAIN, CHANCE], ids=["one call", "one by one"])
def test_a_case_that_is_impossible_keeps_its_reason(model: Model[Any, Any]) -> None:
    table = run(model, {"load": 5e5}, {"load": 140.0}, {"speed": 1.0})
    reason = "the contact flows: load exceeds hardness times area"
    assert table.failed == ((1, reason),)
    left = f"line 2 (cannot be calculated: {reason})"
    assert table.count.sentence() == f"5 rows, 2 used; 3 left out: lines 97, 98 (begins with '#'), {left}"
    assert table.cases[0].answers == {}
    assert str(table.cases[0].fault) == f"cases.csv:2: {reason}"
    assert table.verdict == "fails"
    assert table.governing == 1
    assert table.varied == ("load", "speed")


def test_what_studies_give_is_asked_in_every_case() -> None:
    """Depth over load is k v t / (A H): at twice the speed it is twice as steep, whoever decides limits."""
    for model, kept in ((GIVEN, [[True], [False]]), (replace(GIVEN, objectives=PLAIN.objectives), [[True], [True]])):
        table = run(model, {"speed": 0.5}, {"speed": 1.0})
        slopes = [case.answers["slope"] for case in table.cases]
        assert slopes[0] == pytest.approx(3e-8 * 0.5 * 720e3 / (28e-6 * 2.1e9), rel=1e-9)
        assert slopes[1] == pytest.approx(2 * slopes[0], rel=1e-9)
        assert [[check.passed for check in case.checks] for case in table.cases] == kept
        assert table.governing == (1 if model is GIVEN else 0)


def test_a_limit_that_no_study_decides_is_undecided_in_every_case() -> None:
    table = run(CHANCE, {"load": 140.0}, {"load": 280.0}, setup=replace(default_setup(CHANCE), studies=()))
    assert [table.verdict, *(case.verdict for case in table.cases)] == ["undecided"] * 3
    (check,) = calculate(replace(default_setup(GIVEN), studies=())).checks
    assert (check.name, check.limit, check.unit, check.undecided) == ("slope", 0.2, "um/N", "sensitivity")


def test_prices_effects_and_cases_without_limits() -> None:
    """Every case has its own price; an effect that is on acts in each; without limits the first one governs."""
    light, stated = (case.answers["tolerance_price"] for case in run(LIMITED, {"load": 30.0}, {"load": 120.0}).cases)
    assert (light, stated) == pytest.approx((40 / (BAND / 4) ** 0.5 + 2, SUM), rel=1e-12)
    free = replace(PLAIN, objectives=[])
    on = SwitchedOn(PLAIN.effects["running_in"], {"extra": 7e-6, "length": 10.0})
    cases = ({"load": 280.0}, {"load": 140.0})
    plain, worn = run(free, *cases), run(free, *cases, setup=replace(default_setup(free), effects=(on,)))
    added = [b.answers["depth"] - a.answers["depth"] for a, b in zip(plain.cases, worn.cases, strict=True)]
    assert added == pytest.approx([7e-6, 7e-6])
    assert (plain.governing, plain.verdict) == (0, "passes")
    assert [case.margin for case in plain.cases] == [float("inf")] * 2


def test_cases_that_pass_with_different_changes_only_do_not_pass() -> None:
    """One press cannot have two sets of grades."""
    check = Check("gap", 0.5, 0.9, "", -0.4, passed=False, proposed=Check("gap", 0.95, 0.9, "", 0.05, passed=True))
    fine, finest = (
        Decided((check,), Proposal("allocation", "grades", (("a", "IT7", to),), ())) for to in ("IT6", "IT5")
    )
    case = StatedCase(1, 2, "", {}, "cases.csv")
    verdicts = [
        CasesTable(tuple(CaseResult(case, {}, decided) for decided in pair), 0, RowCount("cases.csv", 2)).verdict
        for pair in ((fine, fine), (fine, finest))
    ]
    assert verdicts == ["proposed", "fails"]


def test_the_smallest_margin_of_a_case_says_what_it_is() -> None:
    """In shares of its limit; where one limit is 0, each margin is a distance."""
    for limit, margin, words in ((4.0, -0.25, ("-25", "%")), (0.0, -5.0, ("-5", "mm"))):
        above = Check("b", 5.0, limit, "mm", margin, passed=False)
        least = least_margin([Check("a", 8.0, 10.0, "mm", 0.2, passed=True), above])
        assert (least.text, least.unit) == words
