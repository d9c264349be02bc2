"""Running a model: alone, in batches, split, with effects at their three places, and when something goes wrong."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Reliability,
    Require,
    Sensitivity,
    Tolerance,
    Unknown,
    axis,
    column,
    either,
    feasible,
    found,
    given,
    inputs,
    normal,
    repeated,
    results,
    rows,
)
from truing.calculation import calculate
from truing.declare import remembered
from truing.errors import InfeasibleError, PluginError, UsageError
from truing.evaluate import answered, evaluate, evaluate_rows
from truing.setup import Setup, SwitchedOn, default_setup, effect_column
from truing.studies.verdicts import sentence_of

CALLS: list[int] = []


@inputs
class Lever:
    """A lever in balance."""

    force: Float = given(10.0, "N")
    arm: Float = given(2.0, "m")
    other_arm: Float = given(1.0, "m")
    measured: Float = given(None, "N")
    bearings: int = given(1)
    kind: Literal["plain", "double"] = given("plain")
    extra: Float = given(0.0, "N")


@results
class Balance:
    """What holds it."""

    hold: Float = found("N")
    torque: Float = found("N*m", formula="force * arm")


def balance(lever: Lever) -> Balance:
    """Hold the lever; a double one needs half the force."""
    CALLS.append(np.size(lever.force))
    feasible(lever.arm > 0, "the arm has no length")
    feasible(lever.force < 1000, "the lever breaks")
    share = 0.5 if lever.kind == "double" else 1.0
    torque = (lever.force + lever.extra) * lever.arm
    return Balance(hold=either(lever.measured, share * torque / lever.other_arm / lever.bearings), torque=torque)


def setup_with(effects: list[SwitchedOn] | None = None, errors: list[Any] | None = None, **values: Any) -> Setup:
    model = Model(name="lever", title="", function=balance, errors=errors or [])
    return replace(default_setup(model, **values), effects=tuple(effects or ()))


# One calculation


def test_a_single_calculation_answers_in_numbers_and_what_is_given_replaces_what_is_computed() -> None:
    answer = evaluate(setup_with())
    assert (answer.hold, answer.torque) == (20.0, 20.0)
    assert type(answer.hold) is float
    assert evaluate(setup_with(measured="7 N")).hold == 7.0


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"arm": 0.0}, "the arm has no length"),
        ({"arm": float("nan")}, "the arm has no length"),
        ({"other_arm": 0.0}, "the result 'hold' of lever is not finite"),
    ],
)
def test_what_does_not_hold_or_has_no_value_ends_a_single_calculation(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(InfeasibleError, match=sentence):
        evaluate(setup_with(**values))


# Results that do not exist


def swung(lever: Lever) -> Balance:
    """Hold the lever; without a force there is no torque to speak of."""
    feasible(lever.force > 0, "nothing turns it", only=["torque"])
    return replace(balance(lever), torque=lever.force / np.where(lever.force < 5, 0.0, 1.0))


def still(force: float, *, limit: bool = False) -> Setup:
    limits = [Require("torque", at_most="5 N*m", reliability=0.9 if limit else None)]
    scatter = [Tolerance("arm", normal(sd="1 %"), why="")]
    model = Model(
        name="lever", title="", function=swung, objectives=[*limits, Require("hold", at_most="90 N")], errors=scatter,
        studies=[Sensitivity(of=("hold", "torque")), Reliability(draws=100)] if limit else [],
    )  # fmt: skip
    return default_setup(model, force=force)


def test_a_result_that_does_not_exist_has_its_reason_and_leaves_the_others() -> None:
    found = answered(still(-3.0))
    assert (found.results.hold, found.absent) == (-6.0, {"torque": "nothing turns it"})
    assert np.isnan(found.results.torque)
    with pytest.raises(InfeasibleError, match="'torque' of lever is not finite"):
        evaluate(still(3.0))


def test_a_row_that_lacks_a_result_keeps_the_others() -> None:
    columns = {"force": np.array([-1.0, 20.0, 2e3]), "kind": ["plain", "double", "plain"]}
    rows_ = evaluate_rows(still(1.0), columns, 3)
    assert rows_.results["hold"].tolist()[:2] == [-2.0, 20.0]
    assert np.isnan(rows_.results["torque"]).tolist() == [True, False, True]
    assert (rows_.reasons, rows_.absent) == ({2: "the lever breaks"}, {"torque": {0: "nothing turns it"}})
    complete = rows_.complete()
    assert complete.reasons == {0: "nothing turns it", 2: "the lever breaks"}
    assert (complete.failed.tolist(), np.isnan(complete.results["hold"]).tolist()) == ([True, False, True],) * 2


@pytest.mark.parametrize("limit", [False, True])
def test_a_limit_on_a_result_that_does_not_exist_is_not_kept(limit: bool) -> None:
    done = calculate(still(-3.0, limit=limit))
    of = {check.name: check for check in done.checks}
    assert (of["torque"].state, done.verdict) == ("undecided", "undecided")
    assert sentence_of(done.decided).startswith("1 of 2 checks is undecided: torque. Its result does not exist")
    if limit:
        assert set(done.outcomes["sensitivity"].derivatives) == {"hold"}  # type: ignore[attr-defined]
        assert any("'torque' has no probability: nothing turns it" in text for text in done.warnings)
    else:
        assert of["hold"].state == "passes"


def test_a_name_that_is_no_result_is_the_plugins_fault() -> None:
    def misspelt(lever: Lever) -> Balance:
        feasible(lever.force > 100, "", only=["torqe"])
        return balance(lever)

    model = Model(name="lever", title="", function=misspelt)
    with pytest.raises(
        PluginError, match=r"feasible\(only=...\) names 'torqe', which is no result. Did you mean 'torque'"
    ):
        evaluate(default_setup(model))


# Batches


NO_ARM = "the arm has no length"


@pytest.mark.parametrize(
    ("columns", "reasons", "hold"),
    [
        (
            {"arm": [1.0, 0.0, np.nan, 1.0, -1.0], "force": [1.0, 1.0, 1.0, 2000.0, 2000.0]},
            {1: NO_ARM, 2: NO_ARM, 3: "the lever breaks", 4: NO_ARM}, [1.0],
        ),
        ({"other_arm": [1.0, 0.0]}, {1: "the result 'hold' is not finite"}, [20.0]),
        # a batch is split by what has one value per call, and keeps the rows of its reasons
        ({"arm": [1.0, 0, 1, 0], "kind": ["plain", "double", "double", "plain"]}, {1: NO_ARM, 3: NO_ARM}, [10, 5]),
        (
            {"force": [1, 2, 3, 4, 5], "kind": ["plain", "double"] * 2 + ["plain"], "bearings": [1, 1, 2, 1, 1]},
            {}, [2.0, 2.0, 3.0, 4.0, 10.0],
        ),
    ],
    ids=["first reason", "not finite", "split with reasons", "split"],
)  # fmt: skip
def test_rows_of_a_batch_have_their_own_answers_and_reasons(
    columns: dict[str, list[Any]], reasons: dict[int, str], hold: list[float]
) -> None:
    CALLS.clear()
    rows_ = max(map(len, columns.values()))
    batch = evaluate_rows(setup_with(), {name: np.array(values) for name, values in columns.items()}, rows_)
    assert batch.reasons == reasons
    assert np.flatnonzero(batch.failed).tolist() == list(reasons)
    for values in batch.results.values():
        assert np.isnan(values).tolist() == batch.failed.tolist()
    assert batch.results["hold"][~batch.failed].tolist() == hold
    if "bearings" in columns:
        assert sorted(CALLS) == [1, 2, 2]


def test_rows_that_do_not_differ_are_computed_once() -> None:
    CALLS.clear()
    batch = evaluate_rows(setup_with(), {"force": 3.0}, 4)
    assert batch.results["torque"].tolist() == [6.0] * 4
    assert len(CALLS) == 1
    failed = evaluate_rows(setup_with(arm=0.0), {}, 3)
    assert failed.reasons == dict.fromkeys(range(3), "the arm has no length")


def test_a_batch_without_rows_is_empty() -> None:
    batch = evaluate_rows(setup_with(), {"force": np.zeros(0)}, 0)
    assert {name: values.shape for name, values in batch.results.items()} == {"hold": (0,), "torque": (0,)}


def test_only_what_is_wanted_comes_back() -> None:
    assert list(evaluate_rows(setup_with(), {"force": np.ones(2)}, 2, wanted={"torque"}).results) == ["torque"]


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        (
            {"forse": np.ones(3)},
            "the column 'forse' is no input, condition or effect that is on. Did you mean 'force'?",
        ),
        ({"force": np.ones(4)}, r"the column 'force' has the shape \(4,\); expected one value or \(3,\)"),
        ({"kind": ["plain"] * 2}, "the column 'kind' has 2 values for 3 rows"),
        ({"effects.warm.slope": np.ones(3)}, "the column 'effects.warm.slope' is no input"),
    ],
)
def test_columns_that_nobody_knows(columns: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UsageError, match=sentence):
        evaluate_rows(setup_with(), columns, 3)


# Axes and tables


@inputs
class Shaft:
    """A shaft with a load that travels."""

    load: Float = given(1.0, "N")
    steps: int = given(3)


@results
class Travel:
    """Its deflection along the travel."""

    place: Float = axis("m")
    bow: Float = found("m", along="place")
    level: Float = found("m", along="place")
    most: Float = found("m")


def travel(shaft: Shaft) -> Travel:
    """Bow in proportion to the load."""
    place = np.linspace(0.0, 1.0, shaft.steps)
    bow = column(shaft.load) * place
    feasible(bow < 100, "it bows too far")
    return Travel(place=place, bow=bow, level=column(shaft.load) * 1.0, most=np.max(bow, axis=-1))


TRAVEL = default_setup(Model(name="shaft", title="", function=travel))


@pytest.mark.parametrize("count", [1, 3, 5])
def test_along_an_axis_a_batch_is_a_matrix(count: int) -> None:
    loads = np.arange(1.0, count + 1)
    batch = evaluate_rows(TRAVEL, {"load": loads}, count)
    assert batch.results["bow"].tolist() == [[0.0, load / 2, load] for load in loads]
    assert batch.results["place"].tolist() == [[0.0, 0.5, 1.0]] * count
    assert batch.results["level"].tolist() == [[load] * 3 for load in loads]
    assert batch.results["most"].tolist() == loads.tolist()


def test_a_condition_along_an_axis_fails_the_row() -> None:
    batch = evaluate_rows(TRAVEL, {"load": np.array([1.0, 200.0, 2.0, 300.0])}, 4)
    assert batch.failed.tolist() == [False, True, False, True]
    with pytest.raises(InfeasibleError, match="it bows too far"):
        evaluate(default_setup(TRAVEL.model, load=200.0))
    alike = evaluate_rows(default_setup(TRAVEL.model, load=200.0), {}, 2)
    assert alike.failed.all()


def test_axes_of_different_length_are_filled_up() -> None:
    batch = evaluate_rows(TRAVEL, {"load": np.array([1.0, 2.0]), "steps": [2, 3]}, 2)
    np.testing.assert_array_equal(batch.results["bow"], [[0.0, 1.0, np.nan], [0.0, 1.0, 2.0]])
    assert not batch.failed.any()


@inputs
class Pile:
    """Groups of parts."""

    size: Float = given(2.0, "")


@results
class Groups:
    """As many groups as it takes."""

    group: Float = rows("one per group")
    content: Float = found("", along="group")
    count: Float = found("")


def grouped(pile: Pile) -> Groups:
    """Call with one row at a time: the length is known only afterwards."""
    CALLS.append(np.ndim(pile.size))
    count = int(pile.size)
    feasible(count > 0, "nothing to group")
    return Groups(group=np.arange(count), content=np.full(count, pile.size), count=count)


def test_tables_are_made_row_by_row() -> None:
    CALLS.clear()
    setup = default_setup(Model(name="pile", title="", function=grouped))
    batch = evaluate_rows(setup, {"size": np.array([2.0, 0.0, 3.0])}, 3)
    assert CALLS == [0, 0, 0]
    np.testing.assert_array_equal(batch.results["count"], [2.0, np.nan, 3.0])
    np.testing.assert_array_equal(batch.results["group"], [[0, 1, np.nan], [np.nan] * 3, [0, 1, 2]])
    assert batch.reasons == {1: "nothing to group"}


def test_a_table_of_rows_that_are_alike_is_made_once() -> None:
    CALLS.clear()
    setup = default_setup(Model(name="pile", title="", function=grouped))
    for columns in ({}, {"size": 2.0}):
        batch = evaluate_rows(setup, columns, 3)
        np.testing.assert_array_equal(batch.results["content"], [[2.0, 2.0]] * 3)
    assert CALLS == [0, 0]
    assert evaluate_rows(setup, {"size": 0.0}, 2).reasons == {0: "nothing to group", 1: "nothing to group"}


# Effects


def pushed(lever: Lever, *, push: Float) -> Lever:
    return replace(lever, extra=lever.extra + push)


def doubled(lever: Lever, *, gain: Float) -> Lever:
    return replace(lever, extra=lever.extra * (1 + gain))


def rubbing(lever: Lever, base: Balance, *, rub: Float) -> Balance:
    return replace(base, hold=base.hold + rub * lever.bearings)


def misread(lever: Lever, base: Balance, *, gain: Float, room: Float) -> Balance:
    return replace(base, hold=base.hold * (1 + gain * (room - 293.15)))


ROOM = Condition("room", "degC", reference=20)
PUSHED = Effect("pushed", on_inputs=pushed, unknowns=[Unknown("push", 0, 5, "N")])
DOUBLED = Effect("doubled", on_inputs=doubled, unknowns=[Unknown("gain", 0, 5)])
RUBBING = Effect("rubbing", on_results=rubbing, unknowns=[Unknown("rub", 0, 5, "N")])
MISREAD = Effect("misread", on_reading=misread, needs=[ROOM], unknowns=[Unknown("gain", -1, 1, "1/K")])
ERRORS = [MISREAD, PUSHED, RUBBING, DOUBLED]
ON = [
    SwitchedOn(DOUBLED, {"gain": 1.0}),
    SwitchedOn(RUBBING, {"rub": 3.0}),
    SwitchedOn(MISREAD, {"gain": 0.1}),
    SwitchedOn(PUSHED, {"push": 2.0}),
]


def test_effects_act_in_order_at_their_places() -> None:
    setup = setup_with(ON, ERRORS)
    assert [item.effect.name for item in setup.effects] == ["misread", "pushed", "rubbing", "doubled"]
    answer = evaluate(setup)
    assert (answer.torque, answer.hold) == (28.0, 31.0)  # (10 + 2*2) * 2, then + 3


def test_readings_act_only_when_they_are_read() -> None:
    setup = replace(setup_with(ON, ERRORS), conditions={"room": 303.15})
    assert evaluate(setup).hold == 31.0
    assert evaluate(setup, reading=True).hold == pytest.approx(62.0)
    assert evaluate(setup, reading=True).torque == 28.0
    at_reference = setup_with(ON, ERRORS)
    assert evaluate(at_reference, reading=True).hold == pytest.approx(31.0)


def test_unknowns_and_conditions_are_columns() -> None:
    setup = setup_with(ON, ERRORS)
    columns = {
        "room": np.array([293.15, 303.15]),
        "effects.rubbing.rub": np.array([3.0, 0.0]),
        "force": np.array([10, 0]),
    }
    batch = evaluate_rows(setup, columns, 2, reading=True)
    np.testing.assert_allclose(batch.results["hold"], [31.0, 16.0])
    np.testing.assert_allclose(evaluate_rows(setup, columns, 2).results["hold"], [31.0, 8.0])


def test_an_effect_is_known_to_the_model_and_on_once() -> None:
    with pytest.raises(UsageError, match="the effect 'pushed' is switched on twice"):
        setup_with([SwitchedOn(PUSHED, {"push": 1.0})] * 2, ERRORS)
    with pytest.raises(UsageError, match="lever has no effect 'pushed'"):
        setup_with([SwitchedOn(PUSHED, {"push": 1.0})])


# What a plugin can do wrong


def dividing(lever: Lever) -> Balance:
    """Fail in the plugin's own line."""
    raise ZeroDivisionError("no arm")


def inside_numpy(lever: Lever) -> Balance:
    """Fail inside a library: the plugin's line is named, not the library's."""
    return Balance(hold=float(np.linalg.inv(np.zeros((2, 2)))[0, 0]), torque=0.0)


def leaving(lever: Lever) -> Balance:
    """End the program."""
    raise SystemExit(0)


def forgetting(lever: Lever) -> Balance:
    """Return nothing."""


def wrong_shape(lever: Lever) -> Balance:
    """Return three values whatever was asked."""
    return Balance(hold=np.arange(3.0), torque=0.0)


def a_text(lever: Lever) -> Balance:
    """Return words."""
    return Balance(hold="plenty", torque=0.0)  # type: ignore[arg-type]


WRONG_FUNCTIONS = [
    (dividing, r"test_evaluate\.py:\d+: lever failed: ZeroDivisionError: no arm"),
    (inside_numpy, r"test_evaluate\.py:\d+: lever failed: LinAlgError: Singular matrix"),
    (leaving, r"test_evaluate\.py:\d+: lever failed: SystemExit: 0"),
    (forgetting, "lever returned None, which is no Balance"),
    (wrong_shape, r"lever: the result 'hold' has the shape \(3,\) in a call of"),
    (a_text, "lever: the result 'hold' is 'plenty' in a call of"),
]


@pytest.mark.parametrize(("function", "sentence"), WRONG_FUNCTIONS)
def test_a_failing_plugin_is_named_with_its_place(function: Any, sentence: str) -> None:
    setup = default_setup(Model(name="lever", title="", function=function))
    with pytest.raises(PluginError, match=sentence) as caught:
        evaluate(setup)
    if function is dividing:
        line = int(str(caught.value).split(".py:")[1].split(":")[0])
        assert "ZeroDivisionError" in Path(__file__).read_text(encoding="utf-8").splitlines()[line - 1]
    with pytest.raises(PluginError, match=sentence):
        evaluate_rows(setup, {"force": np.ones(2)}, 2)


def dividing_numbers(lever: Lever) -> Balance:
    """Divide by a number that may be zero: infinite alone as it is in a batch."""
    return Balance(hold=1 / lever.extra, torque=lever.force ** (lever.arm * -400))


def test_alone_and_in_a_batch_numbers_behave_alike() -> None:
    setup = default_setup(Model(name="lever", title="", function=dividing_numbers))
    with pytest.raises(InfeasibleError, match="'hold' of lever is not finite"):
        evaluate(setup)
    assert evaluate_rows(setup, {"extra": np.array([0.0, 1.0])}, 2).reasons == {0: "the result 'hold' is not finite"}


# Rows that come again and again cost the model one call, whatever acts after it; answers are those of all rows.

ROWS, COPIES = 5, 4
FORCES = np.array([-1.0, 10.0, 20.0, 30.0, 2000.0])
"""Without a force there is no torque; the last breaks the lever."""


def asked(active: SwitchedOn, values: Any, *, repeats: int, function: Any = swung) -> Any:
    """The answers to rows that come in copies, each with another value of the one unknown."""
    model = Model(name="lever", title="", function=function, errors=[active.effect])
    rows_ = ROWS * COPIES
    columns = {
        "force": np.tile(FORCES, COPIES),
        "measured": np.full(rows_, np.nan),
        effect_column(active.effect.name, *active.values): np.repeat(values, ROWS),
    }
    CALLS.clear()
    return evaluate_rows(default_setup(model).with_effects([active]), columns, rows_, repeats=repeats)


SHARED = Model(name="lever", title="", function=swung)
RUBS, PUSHES = SwitchedOn(RUBBING, {"rub": 0.0}), SwitchedOn(PUSHED, {"push": 0.0})


@pytest.mark.parametrize(
    ("active", "calls"), [(RUBS, [ROWS]), (PUSHES, [ROWS * COPIES])], ids=["after the model", "before it"]
)
def test_the_model_is_called_for_one_copy_where_effects_act_after_it_and_answers_are_those_of_all_rows(
    monkeypatch: pytest.MonkeyPatch, active: SwitchedOn, calls: list[int]
) -> None:
    monkeypatch.setattr(repeated, "OF_MODELS", OrderedDict())
    values = np.array([0.0, 0.05, 0.1, 0.2])
    together = asked(active, values, repeats=COPIES)
    assert calls == CALLS
    plain = asked(active, values, repeats=0)
    for name in ("hold", "torque"):
        np.testing.assert_array_equal(together.results[name], plain.results[name])
    assert (together.reasons, together.absent) == (plain.reasons, plain.absent)
    assert plain.absent["torque"]
    if active is RUBS:
        hold = np.tile(2 * FORCES, COPIES) + np.repeat(values, ROWS)
        np.testing.assert_allclose(together.results["hold"], np.where(np.tile(FORCES > 1000, COPIES), np.nan, hold))


def test_what_is_known_is_not_calculated_again() -> None:
    setup = default_setup(replace(SHARED, errors=[RUBBING])).with_effects([RUBS])
    columns = {"force": np.tile(FORCES, 2), "effects.rubbing.rub": np.repeat([0.0, 0.7], ROWS)}
    for _ in range(2):
        CALLS.clear()
        evaluate_rows(setup, columns, ROWS * 2, repeats=2)
    assert CALLS == []


def heavy(lever: Lever) -> Balance:
    return Balance(hold=lever.force, torque=lever.force)


def test_another_model_of_the_same_inputs_is_asked_itself() -> None:
    for function, factor in ((swung, 2.0), (heavy, 1.0), (swung, 2.0)):
        answer = asked(RUBS, np.zeros(COPIES), repeats=COPIES, function=function)
        np.testing.assert_allclose(answer.results["hold"][:4], factor * FORCES[:4])


def worn(lever: Lever, base: Balance, *, size: Float) -> Balance:
    hold: Any = base.hold
    hold += size  # in place, as a careless effect does
    return base


def test_an_effect_that_changes_an_array_in_place_changes_nothing_that_is_remembered() -> None:
    effect = Effect("worn", on_results=worn, unknowns=[Unknown("size", -1, 1, "N")], looks_like="a constant")
    setup = default_setup(replace(SHARED, errors=[effect])).with_effects([SwitchedOn(effect, {"size": 0.5})])
    force = {"force": np.array([10.0, 20.0, 30.0])}
    for _ in range(3):
        answer = evaluate_rows(setup, force, 3, repeats=1)
        np.testing.assert_allclose(answer.results["hold"], 2.0 * force["force"] + 0.5)


def test_inputs_that_differ_are_told_apart() -> None:
    """Also where their texts read alike one behind another: 1 and 12 are not 11 and 2."""
    several = [(1, 12), (11, 2), (112, ""), (1.0, 12), (np.array([1.0]), 12), (np.array([1.0, 12.0]), 12), ("1", "12")]
    keys = {remembered.key_of({("one",): one, ("other",): other}) for one, other in several}
    assert len(keys) == len(several)
