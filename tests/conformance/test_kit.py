"""The kit itself: for every check a model that breaks just this promise, because a check that cannot fail is none."""

import itertools
import multiprocessing
import re
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from kettle import KETTLE, Heated, Kettle
from pin_wear import PIN_WEAR

from shared import TESTS
from truing import (
    Condition,
    Dynamics,
    Effect,
    Float,
    Model,
    Motion,
    Price,
    Published,
    Require,
    Section,
    Tolerance,
    Unknown,
    Vary,
    drawn,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    integration,
    normal,
    plus_minus,
    results,
    state,
    states,
)
from truing.calculation import calculate
from truing.declare import following
from truing.declare.model import PROMISES
from truing.describe import description
from truing.errors import DeclarationError
from truing.kernel.loading import load_file
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of
from truing.setup import default_setup
from truing.testing import CHECKS, conformance, failures
from truing.testing.declared import formulas_have_the_unit
from truing.testing.running import motion_is_settled
from truing.testing.subject import Subject

pytestmark = pytest.mark.usefixtures("kit_shares_processes")


@inputs
class Spring:
    """A spring with a socket for what it has lost."""

    rate: Float = given(2.0, "N/mm", symbol="c", above=0)
    travel: Float = given(10.0, "mm", symbol="s", at_least=0, at_most=50)
    lost: Float = given(0.0, "mm", symbol="s_0")
    coils: Float = given(6, "", whole=True, at_least=1)


@results
class Force:
    """What it gives."""

    free: Float = found("mm", formula="travel - lost")
    force: Float = found("N", formula="rate * free")
    energy: Float = found("J", formula="force * free / 2")


def spring(it: Spring) -> Force:
    """A linear spring."""
    free = it.travel - it.lost
    return Force(free=free, force=it.rate * free, energy=it.rate * free**2 / 2)


def good(**changes: Any) -> Model[Any, Any]:
    return Model(**{"name": "spring", "title": "A spring", "function": spring, **changes})


def with_function(function: Callable[[Spring], Force]) -> Model[Any, Any]:
    function.__annotations__ = {"it": Spring, "return": Force}
    return good(function=function)


@states
class Unsaid:
    """How warm it is, by a law without a formula."""

    temperature: Float = state("degC", start="start")


def swaying(unsaid: Unsaid, kettle: Kettle, time: Float) -> Unsaid:
    """A heater that is turned up and down."""
    return Unsaid(temperature=np.sin(time / 5))


def read(kettle: Kettle, motion: Motion[Unsaid]) -> Heated:
    """The record as it is read."""
    return Heated(time=motion.time, warm=motion.states.temperature, hot_at=0.0)


SWAYING = Dynamics(rate=swaying, gives=read, tolerance=1e-4, settled=1e-9)


def branching() -> Model[Any, Any]:
    return with_result("J", "", lambda it: it.rate * it.travel**2 * (1 if np.ravel(it.travel)[0] < 10e-3 else 2))


def with_result(unit: str, formula: str, value: Callable[[Spring], Any]) -> Model[Any, Any]:
    made = results(type("Made", (), {"__annotations__": {"it": Float}, "it": found(unit, formula=formula)}))

    def function(body: Spring) -> Any:
        return made(it=value(body))

    function.__annotations__ = {"body": Spring, "return": made}
    return good(function=function)


def with_input(value: Callable[[Any], Any] | None = None, **declared: Any) -> Model[Any, Any]:
    annotation = declared.pop("annotation", Float)
    default, unit = declared.pop("default", 1.0), declared.pop("unit", "mm")
    taken = inputs(type("Taken", (), {"__annotations__": {"it": annotation}, "it": given(default, unit, **declared)}))
    made = results(type("Made", (), {"__annotations__": {"out": Float}, "out": found("1")}))

    def function(body: Any) -> Any:
        return made(out=value(body.it) if value else body.it * 0 + 1)

    function.__annotations__ = {"body": taken, "return": made}
    return good(function=function)


def writing(it: Spring) -> Force:
    """Write to an input, and put the batch in the wrong without changing a result."""
    answer = spring(it)
    if isinstance(it.coils, np.ndarray):
        np.add(it.coils, 1, out=it.coils)
    return answer


CALLS = itertools.count()


def forgetful_draw(rng: np.random.Generator, rows: int) -> dict[str, Any]:
    """Ignore the generator that is handed in."""
    return {"travel": np.random.default_rng(next(CALLS)).normal(0, 1e-4, rows)}


def elsewhere(it: Spring) -> Force:
    """Give another answer in another process."""
    answer = spring(it)
    return answer if multiprocessing.parent_process() is None else replace(answer, energy=answer.energy * 2)


@hookimpl
def truing_models() -> list[Model[Any, Any]]:
    return [ELSEWHERE]


def slopes(it: Spring) -> dict[str, dict[str, Any]]:
    """Right but for the third digit of one of them."""
    return {"force": {"rate": it.travel - it.lost, "travel": 1.001 * it.rate}}


def losing(it: Spring, *, loss: Float) -> Spring:
    return replace(it, lost=it.lost + loss)


def biased(it: Spring, *, loss: Float) -> Spring:
    return replace(it, lost=it.lost + loss + 1e-6)


def idle(it: Spring, *, loss: Float) -> Spring:
    return it


def shrinking(it: Spring, *, share: Float) -> Spring:
    return replace(it, lost=it.lost * (1 - share))


def stiffer(it: Spring, base: Force, *, extra: Float) -> Force:
    return replace(base, force=base.force + extra)


def warm(it: Spring, base: Force, *, slope: Float, room: Float) -> Force:
    return replace(base, energy=base.energy + slope * (room - 290.0))


def slack(it: Spring, *, loss: Float, load: Float) -> Spring:
    return replace(it, lost=it.lost + np.where(load < 0, -loss, loss))


def unheeding(it: Spring, *, loss: Float, load: Float) -> Spring:
    return replace(it, lost=it.lost + loss)


def historic(unit: str, derived: str) -> Model[Any, Any]:
    """Make a model whose effect needs a history of the travel, in this unit."""
    needs = [Condition("load", unit, derived=derived)]
    return good(errors=[Effect("slack", on_inputs=slack, needs=needs, unknowns=LOSS)])


LOSS = [Unknown("loss", 0, 1, "mm")]
ROOM = Condition("room", "degC", reference=20)
ELSEWHERE = replace(good(), name="elsewhere", function=elsewhere)
CROSSED = [
    Effect("losing", on_inputs=losing, unknowns=LOSS),
    Effect("shrinking", on_inputs=shrinking, unknowns=[Unknown("share", 0, 1)]),
]
BAD_EXAMPLE = Path(__file__).parents[1] / "data" / "bad_example.toml"

WRONG: dict[str, tuple[Callable[[], Model[Any, Any]], str]] = {
    "units are known": (
        lambda: good(errors=[Tolerance("travel", plus_minus("1 mm"), price=Price("1 / width", "mm", "yaun"))]),
        "'yaun'",
    ),
    "defaults keep their bounds": (lambda: with_input(default=3.0, above=5), "it must be above 5 mm"),
    "finite at defaults": (lambda: with_input(lambda it: 1 / (it - 1e-3)), "the defaults cannot be calculated"),
    "goals can be read": (lambda: good(objectives=[Require("force", at_most="80 mm")]), "Require('force'): '80 mm'"),
    "spreads resolve": (lambda: good(errors=[Tolerance("lost", normal(sd="3 %"))]), "its nominal is 0"),
    "printed numbers are of results": (
        lambda: good(published=[Published(name="Force", result="force", value=20.0, unit="mm")]),
        "'Force' is printed in 'mm', 'force' is in 'N'",
    ),
    "sheet is in order": (
        lambda: good(sheet=[Section("One", "force"), Section("Two", "force")]),
        "the result 'force' stands on the sheet 2 times",
    ),
    "formulas have the unit": (
        lambda: with_result("J", "rate * travel", lambda it: it.rate * it.travel),
        "but the result is declared in 'J'",
    ),
    "formulas equal the function": (
        lambda: with_result("J", "rate * travel**2 / 2", lambda it: it.rate * it.travel**2 / 2 * (1 + 1e-8)),
        "(rate * travel**2 / 2) is not what is calculated: it gives 0.1, the function gives 0.100000001",
    ),
    "batch equals loop": (branching, "write np.where, not if"),
    "steps may be halved": (
        lambda: with_input(lambda it: 1.0 + it * 1e3, default=1.0, halving=0.3),
        "a finer 'it' moves 'out' from 2 to 1.5 (SI): more than 30 %",
    ),
    "motion is settled": (
        lambda: replace(KETTLE, function=SWAYING),
        "a tenth of the tolerance moves 'warm' by",
    ),
    "inputs untouched": (lambda: with_function(writing), "the function writes to the input 'coils'"),
    "seeds decide": (
        lambda: good(errors=[Tolerance("travel", drawn(forgetful_draw))]),
        "'travel' is drawn differently with the same seed",
    ),
    "serial equals parallel": (lambda: ELSEWHERE, "'energy' is different in another process"),
    "derivatives are exact": (
        lambda: good(derivatives=slopes),
        "the derivative of 'force' by 'travel' is stated as 2002; differences of the function give 2000",
    ),
    "bounds are answered": (
        lambda: with_input(lambda it: 1e-3 / it, at_least=0),
        "with it = 0 mm, which its bounds allow",
    ),
    "inputs survive a file": (
        lambda: with_input(lambda it: 1.0, default=1.5, unit=None, annotation=Literal[1.5, 2.5]),
        "'it' is 1.5 before and '1.5' after a file (SI)",
    ),
    "example can be read": (lambda: good(example=BAD_EXAMPLE), "the example of `calc init`"),
    "zero is the base": (
        lambda: good(errors=[Effect("loss", on_inputs=biased, unknowns=LOSS)]),
        "effect 'loss' changes 'free' although its amplitudes are 0 (loss = 0, SI)",
    ),
    "references are neutral": (
        lambda: good(errors=[Effect("warm", on_reading=warm, needs=[ROOM], unknowns=[Unknown("slope", 0, 1, "J/K")])]),
        "effect 'warm' changes 'energy' although 'room' stays at its reference",
    ),
    "effects act": (
        lambda: good(errors=[Effect("loss", on_inputs=idle, unknowns=LOSS)]),
        "is on and changes no result",
    ),
    "order of effects": (
        lambda: good(errors=CROSSED),
        "effects 'losing' and 'shrinking' do not commute: their order changes",
    ),
    "only last results are edited": (
        lambda: good(errors=[Effect("stiffer", on_results=stiffer, unknowns=[Unknown("extra", 0, 1, "N")])]),
        "edits the result 'force', on which 'energy' depends",
    ),
}


FILES = {"inputs survive a file", "example can be read"}
CONSEQUENCES = {
    "defaults keep their bounds": FILES,  # a file is read with the same bounds
    "spreads resolve": {"seeds decide", "serial equals parallel", *FILES},  # nothing can be drawn, no file is accepted
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_model_fails_just_this_check(name: str) -> None:
    make, sentence = WRONG[name]
    found = failures(make())
    assert name in found
    assert set(found) - {name} <= CONSEQUENCES.get(name, set()), found
    assert sentence in found[name]


def test_every_check_has_its_wrong_model() -> None:
    assert set(WRONG) == {check.name for check in CHECKS} == set(PROMISES)
    assert all(check.promise.endswith(".") for check in CHECKS)


@pytest.mark.parametrize("model", [good(), replace(ELSEWHERE, function=spring)], ids=lambda model: model.name)
def test_a_right_model_passes(model: Model[Any, Any]) -> None:
    assert failures(model) == {}


MORE_WRONG: list[tuple[str, Callable[[], Model[Any, Any]], str]] = [
    (
        "units are known",
        lambda: good(errors=[Effect("l", on_inputs=losing, unknowns=[Unknown("loss", 0, 1, "mms")])]),
        "",
    ),
    (
        "units are known",
        lambda: historic("N", "running_maximum of travel"),
        "running_maximum of travel, which is in 'mm'",
    ),
    ("units are known", lambda: historic("mm", "direction of travel"), "a direction, which has no unit"),
    ("goals can be read", lambda: good(objectives=[Vary("travel", "5 mm", "1 mm")]), "runs from 5 mm to 1 mm"),
    ("goals can be read", lambda: good(objectives=[Vary("travel", "1 N", "5 mm")]), "Vary('travel')"),
    (
        "goals can be read",
        lambda: good(objectives=[Require("force", at_most="travel")]),
        "compares N with 'travel' in mm",
    ),
    ("spreads resolve", lambda: good(errors=[Tolerance("travel", plus_minus("0 mm"))]), "does not scatter"),
    (
        "printed numbers are of results",
        lambda: good(published=[Published(name="F", result="force", value=1, unit="N", settings={"travle": "3 mm"})]),
        "travle",
    ),
    (
        "printed numbers are of results",
        lambda: good(published=[Published(name="F", result="forse", value=1, unit="N")]),
        "'forse', which is no result",
    ),
    (
        "steps may be halved",
        lambda: with_input(lambda it: 1.0 + 1 / it, default=2, unit="", whole=True, at_least=1, halving=0.1),
        "from 1.5 to 1.25 (SI): more than 10 %",
    ),
    (
        "steps may be halved",
        lambda: with_input(lambda it: 1.0 + it * 1e3, default=1.0, halving=0.9, halving_but={"out": "0.4"}),
        ": more than 0.4",
    ),
    ("formulas have the unit", lambda: with_result("N", "rate + travel", lambda it: it.rate), "formula of 'it'"),
    (
        "formulas equal the function",
        lambda: with_result("mm", "it**2 == travel**2 * 4", lambda it: it.travel),
        "is not what is calculated: its right side gives 0.0004, its left side gives 0.0001",
    ),
]


@pytest.mark.parametrize(("name", "make", "sentence"), MORE_WRONG)
def test_other_ways_to_be_wrong(name: str, make: Callable[[], Model[Any, Any]], sentence: str) -> None:
    found = failures(make())
    assert name in found, found
    assert sentence in found[name]


def test_a_condition_may_be_a_switch_whose_reference_is_one_of_its_states() -> None:
    needs = [Condition("load", "N")]
    assert failures(good(errors=[Effect("slack", on_inputs=slack, needs=needs, unknowns=LOSS)])) == {}
    unheeded = failures(good(errors=[Effect("slack", on_inputs=unheeding, needs=needs, unknowns=LOSS)]))
    assert "although 'load' stays at its reference" in unheeded["references are neutral"]


def lit(it: Spring, *, loss: Float, angle: Float) -> Spring:
    return replace(it, lost=it.lost + loss * np.cos(angle))


def test_a_condition_may_say_where_an_effect_acts_and_not_whether() -> None:
    needs, unknowns = [Condition("angle", "deg")], [Unknown("loss", -1, 1, "mm")]
    undeclared = failures(good(errors=[Effect("lit", on_inputs=lit, needs=needs, unknowns=unknowns)]))
    assert "although 'angle' stays at its reference" in undeclared["references are neutral"]
    stated = Effect("lit", on_inputs=lit, needs=needs, unknowns=unknowns, acts_at_reference=True)
    assert failures(good(errors=[stated])) == {}


def between(it: Spring, *, growth: Float, inside: Float, outside: Float) -> Spring:
    return replace(it, lost=it.lost + growth * (inside - outside))


def test_an_effect_may_follow_the_difference_of_two_conditions() -> None:
    needs = [Condition(name, "degC", reference=20) for name in ("inside", "outside")]
    unknowns = [Unknown("growth", -1, 1, "um/K")]
    assert failures(good(errors=[Effect("between", on_inputs=between, needs=needs, unknowns=unknowns)])) == {}


def test_effects_whose_order_does_not_matter_need_no_exception() -> None:
    more = Effect("more", on_inputs=losing, unknowns=LOSS)
    assert failures(good(errors=[CROSSED[0], more])) == {}


BY_NAME = {check.name: check for check in CHECKS}
REASON = "what is lost first is worn off first"


def excepted(**changes: Any) -> Model[Any, Any]:
    return good(exceptions={"order of effects": REASON}, **changes)


def test_a_known_exception_is_expected_to_fail() -> None:
    model = excepted(errors=CROSSED)
    assert failures(model) == {}
    with pytest.raises(pytest.xfail.Exception, match=REASON):
        conformance(model)(BY_NAME["order of effects"])


def test_an_exception_from_what_is_kept_is_to_be_taken_away() -> None:
    sentence = "'order of effects' holds, but the model declares a known exception from it; take the exception away"
    assert failures(excepted()) == {"order of effects": f"spring: {sentence}"}
    with pytest.raises(AssertionError, match=sentence):
        conformance(excepted())(BY_NAME["order of effects"])


@pytest.mark.parametrize(
    ("exceptions", "sentence"),
    [
        (
            {"order of effect": "so"},
            "'order of effect', which is no check of the kit. Did you mean 'order of effects'?",
        ),
        ({"effects act": " "}, "the exception from 'effects act' gives no reason"),
    ],
)
def test_an_exception_names_a_check_and_a_reason(exceptions: dict[Any, str], sentence: str) -> None:
    with pytest.raises(DeclarationError, match=re.escape(sentence)):
        good(exceptions=exceptions)


def test_known_exceptions_stand_on_the_sheet_and_in_the_description() -> None:
    offer = Subject(excepted(errors=CROSSED)).offer
    setup = default_setup(offer.model)
    sheet = make_sheet(calculate(setup), provenance=provenance_of(setup))
    for text in (html_of(sheet), markdown_of(sheet)):
        assert f"order of effects: {REASON}" in text
        assert "Known exception" in text
    assert description(offer)["exceptions"] == {"order of effects": REASON}


def shaped_by_travel(it: Spring) -> Force:
    """Answer in the shape of one input alone."""
    force = np.empty(np.shape(it.travel))
    force[...] = it.rate * (it.travel - it.lost)
    return Force(free=it.travel - it.lost, force=force, energy=force * (it.travel - it.lost) / 2)


def unbranched(it: Spring) -> Force:
    """Refuse a batch in which the rate varies more than one calculation would be."""
    feasible(np.max(it.rate) - np.min(it.rate) == 0, "one rate for all")
    return spring(it)


def jumping(it: Spring, *, extra: Float, room: Float) -> Spring:
    """Add all of it or nothing, by the first row of whatever varies."""
    size = extra * (1.0 if np.ravel(extra)[0] > 2e-4 else 0.0)
    return replace(it, lost=it.lost + size * (np.ravel(room)[0] > ROOM.zero))


JUMPING = Effect("jumping", on_inputs=jumping, needs=[ROOM], unknowns=[Unknown("extra", 0, 1, "mm")])


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (lambda: with_function(shaped_by_travel), "a batch in which only 'rate' varies fails as a whole"),
        (lambda: with_function(unbranched), "row 0 fails in a batch (one rate for all) and is answered alone"),
        (lambda: good(errors=[JUMPING]), "effect 'jumping' is on and only 'effects.jumping.extra' varies"),
    ],
)
def test_a_batch_is_the_contract_for_every_input_and_argument_alone(
    model: Callable[[], Model[Any, Any]], sentence: str
) -> None:
    assert sentence in failures(model())["batch equals loop"]


test_pin_wear = conformance(PIN_WEAR)


def test_conformance_is_a_parametrised_test() -> None:
    (mark,) = test_pin_wear.pytestmark  # type: ignore[attr-defined]
    assert mark.name == "parametrize"
    assert mark.args[1] == CHECKS
    broken = conformance(WRONG["finite at defaults"][0]())
    with pytest.raises(AssertionError, match="the defaults cannot be calculated"):
        broken(BY_NAME["finite at defaults"])
    with pytest.raises(pytest.skip.Exception, match="the defaults cannot be calculated"):
        broken(BY_NAME["batch equals loop"])
    with pytest.raises(pytest.skip.Exception, match="no other process could find the model"):
        conformance(good())(BY_NAME["serial equals parallel"])


@pytest.mark.parametrize(
    ("declared", "sentence"),
    [
        ({"halving": 1.5}, "the input 'it' has the halving 1.5; it is a share from 0 to 1"),
        ({"halving": 0.1, "default": "a", "unit": None, "annotation": Literal["a", "b"]}, "of a number or count"),
        ({"halving_but": {"out": "1"}}, "a halving_but without a halving"),
        ({"halving": 0.1, "halving_but": {"aut": "1"}}, "names 'aut', which is no result. Did you mean 'out'?"),
    ],
)
def test_a_numerical_step_is_a_number_that_promises_something(declared: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        with_input(**declared)
    assert sentence in str(caught.value)


def test_what_halving_changes_stands_where_a_user_looks() -> None:
    """On the sheet, in describe and in the schema; of a count it is doubling."""
    step = with_input(halving=0.03, halving_but={"out": "1 deg"}, note="a step")
    words = "numerical: halving it changes no result by more than 3 %; out by at most 1 deg"
    (said,) = description(Subject(step).offer)["inputs"]
    assert said["bounds"] == words
    setup = default_setup(step)
    sheet = make_sheet(calculate(setup), provenance=provenance_of(setup))
    assert words in " ".join(markdown_of(sheet).split())
    assert (
        "doubling it"
        in description(Subject(with_input(default=2, unit="", whole=True, halving=0.1)).offer)["inputs"][0]["bounds"]
    )


def test_a_file_whose_name_is_taken_is_found_by_another_process(tmp_path: Path) -> None:
    """The first file of a name has it; of the second one a worker knows nothing but where it lies."""
    source = (TESTS / "data" / "pin_wear.py").read_text(encoding="utf-8")
    loaded = []
    for folder in ("first", "second"):
        file = tmp_path / folder / "taken_pin.py"
        file.parent.mkdir()
        file.write_text(source, encoding="utf-8")
        loaded.append(load_file(file))
    assert [module.__name__ for module in loaded] == ["taken_pin", "truing_file_taken_pin"]
    assert failures(loaded[1].PIN_WEAR) == {}


def switched_off(unsaid: Unsaid, kettle: Kettle, time: Float) -> Unsaid:
    """A heater that goes out at 40 degC: a jump, of which no event says anything."""
    return Unsaid(temperature=np.where(unsaid.temperature < 313.15, kettle.power, 0.0) / kettle.capacity)


def warmed(unsaid: Unsaid, kettle: Kettle, time: Float) -> Unsaid:
    """The same that turns down smoothly within 20 K."""
    share = 0.5 - 0.5 * np.tanh((unsaid.temperature - 313.15) / 20)
    return Unsaid(temperature=share * kettle.power / kettle.capacity)


def test_a_motion_whose_slopes_are_not_those_of_the_variational_equation_fails() -> None:
    """At the jump what is followed turns; the slope of the law along it does not (Aizerman and Gantmakher, 1958)."""
    for law, holds in ((switched_off, False), (warmed, True)):
        subject = Subject(replace(KETTLE, function=Dynamics(rate=law, gives=read, settled=1e-3)))
        with nullcontext() if holds else pytest.raises(AssertionError, match="is not that of the variational equation"):
            motion_is_settled(subject)


def test_formulas_of_a_motion_are_held_against_one_that_is_followed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    followed: list[int] = []

    def solve(problem: Any, **how: Any) -> Any:
        followed.append(1)
        return integration.solve(problem, **how)

    monkeypatch.setattr(following, "solve", solve)
    formulas_have_the_unit(Subject(replace(KETTLE, function=replace(KETTLE.function))))
    assert len(followed) == 1
