"""Many cases: each row changes the setup, the smallest margin governs, one that fails does not take the others away."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from typing import Any

import pytest
from pin_wear import PIN_WEAR, Pin

from truing import Float, Model, Reliability, Require, Sensitivities, Sensitivity, found, results
from truing.calculation import calculate
from truing.cases import CaseResult, CasesTable, case_setup, run_cases
from truing.errors import InputError
from truing.executors import SerialExecutor, WorkerPool, open_executor
from truing.kernel import Origin
from truing.measurements import CasesFile, RowCount, StatedCase
from truing.report.sheet import least_margin
from truing.setup import Setup, SwitchedOn, default_setup
from truing.studies.checks import Check, Proposal
from truing.studies.verdicts import Decided


@results
class Steep:
    """What a study gives."""

    slope: Float = found("um/N", symbol="s", note="depth per load")


def steep(given: Sensitivities) -> Steep:
    """Depth per load."""
    return Steep(slope=given.derivatives["depth"]["load"])


PLAIN = replace(PIN_WEAR, objectives=[Require("pressure", at_most="80 MPa")], studies=[], sheet=[])
CHANCE = replace(
    PIN_WEAR,
    objectives=[Require("pressure", at_most="80 MPa", reliability=0.99)],
    studies=[Reliability(draws=2000)],
    sheet=[],
)
GIVEN = replace(
    PIN_WEAR,
    objectives=[Require("slope", at_most="0.2 um/N")],
    studies=[Sensitivity(of="depth", gives=steep)],
    sheet=[],
)


def cases_file(cases: list[StatedCase]) -> CasesFile:
    """Return cases as read from a file with two lines of remarks."""
    return CasesFile(tuple(cases), RowCount("cases.csv", len(cases) + 2).without("begins with '#'", (97, 98)))


def run(model: Model[Any, Any], *cases: dict[str, Any], setup: Setup | None = None) -> CasesTable:
    """Run cases given in SI."""
    rows = [
        StatedCase(place, place + 1, f"case {place}", values, "cases.csv")
        for place, values in enumerate(cases, start=1)
    ]
    with open_executor("serial") as executor:
        calculation, table = run_cases(setup or default_setup(model), cases_file(rows), executor=executor)
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


@pytest.mark.parametrize("model", [PLAIN, CHANCE], ids=["one call", "one by one"])
def test_no_case_that_can_be_calculated(model: Model[Any, Any]) -> None:
    with pytest.raises(InputError) as caught:
        run(model, {"load": 5e5}, {"load": 6e5})
    assert [str(fault) for fault in caught.value.faults] == [
        f"cases.csv:{line}: the contact flows: load exceeds hardness times area" for line in (2, 3)
    ]


def test_a_limit_on_what_a_study_gives_is_asked_in_every_case() -> None:
    """Depth over load is k v t / (A H): at twice the speed it is twice as steep."""
    table = run(GIVEN, {"speed": 0.5}, {"speed": 1.0})
    slopes = [case.answers["slope"] for case in table.cases]
    assert slopes[0] == pytest.approx(3e-8 * 0.5 * 720e3 / (28e-6 * 2.1e9), rel=1e-9)
    assert slopes[1] == pytest.approx(2 * slopes[0], rel=1e-9)
    assert [[check.passed for check in case.checks] for case in table.cases] == [[True], [False]]
    assert table.governing == 1


def test_cases_without_limits_are_governed_by_the_first() -> None:
    table = run(replace(PLAIN, objectives=[]), {"load": 280.0}, {"load": 140.0})
    assert table.governing == 0
    assert table.verdict == "passes"
    assert [case.margin for case in table.cases] == [float("inf")] * 2


def test_an_effect_that_is_on_acts_in_every_case() -> None:
    worn = replace(
        default_setup(PLAIN), effects=(SwitchedOn(PLAIN.effects["running_in"], {"extra": 7e-6, "length": 10.0}),)
    )
    cases = ({"load": 140.0}, {"load": 280.0})
    plain, with_effect = run(PLAIN, *cases), run(PLAIN, *cases, setup=worn)
    added = [b.answers["depth"] - a.answers["depth"] for a, b in zip(plain.cases, with_effect.cases, strict=True)]
    assert added == pytest.approx([7e-6, 7e-6])


class Counting(WorkerPool):
    """Two workers who are in fact this process, and who count what they are asked."""

    slots = workers = 2
    where = "counting"

    def __init__(self) -> None:
        self.asked: list[str] = []

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.asked.append(getattr(getattr(args[0], "func", args[0]), "__name__", "?"))
        return SerialExecutor().submit(function, *args, **kwargs)


@pytest.mark.parametrize(
    ("count", "studies", "asked"),
    [
        (3, True, ["run_batch"] * 4),  # few cases: their batches are shared out, those of the governing one twice
        (4, True, ["_packed_case"] * 4 + ["run_batch"]),
        (1024, False, []),  # one array call stays here
        (1025, False, ["_packed_block"] * 2),
    ],
)
def test_cases_are_shared_out_where_they_are_many(count: int, studies: bool, asked: list[str]) -> None:
    origin = Origin("pin_wear", "", "", "", "module:pin_wear")
    setup = default_setup(PIN_WEAR, origin)
    setup = replace(setup, studies=(Reliability(draws=2000, gives=PIN_WEAR.studies[-1].gives),) if studies else ())
    rows = [
        StatedCase(place, place + 1, str(place), {"load": 100.0 + place}, "cases.csv") for place in range(1, count + 1)
    ]
    there = Counting()
    _, shared = run_cases(setup, cases_file(rows), executor=there)
    assert there.asked == asked
    _, alone = run_cases(setup, cases_file(rows), executor=SerialExecutor())
    assert shared == alone


def test_every_row_carries_what_studies_give_and_a_limit_that_none_decides() -> None:
    """A study that decides no limit is run for each row all the same: its results stand in every row."""
    table = run(replace(GIVEN, objectives=PLAIN.objectives), {"speed": 0.5}, {"speed": 1.0})
    slopes = [case.answers["slope"] for case in table.cases]
    assert slopes[1] == pytest.approx(2 * slopes[0], rel=1e-9)
    setup = replace(default_setup(CHANCE), studies=())
    table = run(CHANCE, {"load": 140.0}, {"load": 280.0}, setup=setup)
    assert [case.verdict for case in table.cases] == ["undecided"] * 2
    assert table.verdict == "undecided"
    (check,) = calculate(replace(default_setup(GIVEN), studies=())).checks
    assert (check.name, check.limit, check.unit, check.undecided) == ("slope", 0.2, "um/N", "sensitivity")


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


@pytest.mark.parametrize(
    ("limits", "words"),
    [((10.0, 4.0), ("-25", "%")), ((10.0, 0.0), ("-5", "mm"))],  # where one limit is 0, each margin is a distance
)
def test_the_smallest_margin_of_a_case_says_what_it_is(limits: tuple[float, float], words: tuple[str, str]) -> None:
    checks = [Check("a", 8.0, limits[0], "mm", 0.2, passed=True)]
    margin = (limits[1] - 5.0) / (limits[1] or 1.0)
    checks.append(Check("b", 5.0, limits[1], "mm", margin, passed=False))
    least = least_margin(checks)
    assert (least.text, least.unit) == words
