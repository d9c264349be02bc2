"""The demands on a diagnosis: what is rightly found passes, and whatever is wrong with an effect is said."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from pin_wear import PIN_WEAR, Pin, Wear

from truing import Effect, Float, Model, Unknown
from truing.errors import UsageError
from truing.testing import Hidden, assert_finds, assert_finds_nothing, finds_every_effect, hide

NOISE = {"depth": "1 um"}
LONG = {"load": "50..200 N", "time": "1..400 h", "probe_temperature": "15..40 degC"}
LATE = LONG | {"time": "0.3..40 h"}
FIRST_HOUR = LONG | {"time": "0.01..2 h"}


def backwards(pin: Pin, base: Wear, *, extra: Float, length: Float) -> Wear:
    """The surplus is there at once and goes: the curve that the effect has not."""
    return replace(base, depth=base.depth + extra * np.exp(-pin.speed * pin.time / length))


def bent(pin: Pin, base: Wear, *, probe_temperature: Float) -> Wear:
    """Nobody registered that the probe bends."""
    return replace(base, depth=base.depth + 8e-6 * ((probe_temperature - 300.65) / 12.5) ** 2)


def idle(pin: Pin, *, loss: Float) -> Pin:
    return pin


def early(pin: Pin, *, loss: Float) -> Pin:
    return replace(pin, early_depth=pin.early_depth + loss)


def harder(pin: Pin, *, loss: Float) -> Pin:
    return replace(pin, hardness=pin.hardness * (1 + loss))


def with_effect(function: Callable[..., Pin], unit: str) -> Model[Any, Any]:
    other = Effect("other", on_inputs=function, unknowns=[Unknown("loss", -1, 50, unit)])
    return replace(PIN_WEAR, errors=[*PIN_WEAR.errors, other])


CASES: dict[str, Callable[[], Hidden]] = {
    "warm probe": lambda: hide("warm_probe", "1 um/K", NOISE, model=PIN_WEAR, over=LONG, machine=3),
    "offset": lambda: hide("sensor_offset", "5 um", NOISE, model=PIN_WEAR, over=LONG),
    "nothing": lambda: hide(None, noise=NOISE, model=PIN_WEAR, over=LONG, seed=1),
    "strange": lambda: hide(None, noise=NOISE, model=PIN_WEAR, over=LONG, by=bent, rows=100),
    "running in": lambda: hide(
        "running_in", {"extra": "20 um", "length": "500 m"}, NOISE, model=PIN_WEAR, over=FIRST_HOUR
    ),
    "backwards": lambda: hide(
        "running_in", {"extra": "20 um", "length": "500 m"}, NOISE, model=PIN_WEAR, over=FIRST_HOUR, by=backwards
    ),
    "late": lambda: hide("running_in", {"extra": "6 um", "length": "500 m"}, NOISE, model=PIN_WEAR, over=LATE),
    "small": lambda: hide("sensor_offset", "0.1 um", NOISE, model=PIN_WEAR, over=LONG),
    "idle": lambda: hide("other", "20 um", NOISE, model=with_effect(idle, "um"), over=LONG),
    "in the tolerances": lambda: hide("other", "0.05", NOISE, model=with_effect(harder, ""), over=LONG),
}


@cache
def case(name: str) -> Hidden:
    """Every record is made and diagnosed once."""
    return CASES[name]()


def test_what_is_hidden_is_found() -> None:
    (cause,) = assert_finds(case("running in")).causes
    assert (cause.effect, cause.same_as) == ("running_in", ())


NAMES = [
    ("warm probe", ("thermal_drift", ("warm_probe",))),
    ("offset", ("sensor_offset", ("running_in",))),
]


@pytest.mark.parametrize(("name", "names"), NAMES, ids=[name for name, _ in NAMES])
def test_another_name_of_the_same_curve_will_do(name: str, names: tuple[str, tuple[str, ...]]) -> None:
    """After the first hour, 25 times the length of the running-in, an offset is all that it draws."""
    (cause,) = assert_finds(case(name)).causes
    assert (cause.effect, cause.same_as) == names


def test_nothing_is_found_where_nothing_is() -> None:
    assert assert_finds_nothing(case("nothing")).verdict in {"none", "undecided"}


def test_what_nobody_registered_is_called_unknown() -> None:
    assert assert_finds(case("strange")).verdict == "unknown"


OFFSET = "'sensor_offset' was named (sensor offset, depth"
WRONG: list[tuple[str, list[str]]] = [
    (
        "backwards",
        [
            "'running_in' (extra 20 um, length 500 m) was hidden, but something unregistered over 'time' was found",
            "what was hidden is not the curve of 'running_in': look for a sign, a unit, the place where it acts",
        ],
    ),
    ("late", [f"but {OFFSET}", "cannot be told apart from 'sensor_offset': nothing that can be measured here"]),
    ("small", ["'sensor_offset' (depth 0.1 um) was hidden, but nothing was found; too small: it is seen from"]),
    ("idle", ["'other' (loss 20 um) was hidden, but nothing was found; not excited: vary an input that brings it out"]),
    (
        "in the tolerances",
        ["but nothing was found; hidden in the tolerances: what is left of it beside them is seen from"],
    ),
]


def said(ask: Callable[..., Any], *arguments: Any, **more: Any) -> str:
    """The sentence with which a demand fails."""
    with pytest.raises(AssertionError) as failure:
        ask(*arguments, **more)
    return str(failure.value)


@pytest.mark.parametrize(("name", "sentences"), WRONG, ids=[name for name, _ in WRONG])
def test_what_is_not_found_is_said_with_what_to_change(name: str, sentences: list[str]) -> None:
    text = said(assert_finds, case(name))
    assert text.startswith("pin_wear: ")
    for sentence in sentences:
        assert sentence in text


def test_no_time_before_the_start_is_proposed() -> None:
    assert "time −" not in said(assert_finds, case("late"))


def claimed(name: str, **changes: Any) -> Hidden:
    """A record of which something else is claimed than was hidden; what was diagnosed stands."""
    made = replace(case(name), **changes)
    made.__dict__["answered"] = case(name).answered
    return made


def test_a_wrong_sign_or_size_is_said() -> None:
    size = case("offset").truth["depth"]
    text = said(assert_finds, claimed("offset", truth={"depth": -size}))
    assert "'sensor_offset' is named, but its size is wrong: depth" in text
    assert "hidden was -5 um; one interval in twenty misses: try another seed" in text
    assert "its size is wrong" in said(assert_finds, claimed("offset", truth={"depth": 1.5 * size}))


def test_a_part_of_another_gauge_is_another_cause() -> None:
    text = said(assert_finds, claimed("offset", truth={"distance": 1.0}))
    assert f"'sensor_offset' (distance 0.001 km) was hidden, but {OFFSET}" in text


def test_the_gain_is_demanded_on_rows_that_were_not_fitted() -> None:
    text = said(assert_finds, case("offset"), within=0.9)
    assert "on rows that were not fitted the error of 'depth' is" in text
    assert "times its noise" in text
    assert "0.9 times was demanded: fit more rows" in text


def test_something_is_found_where_nothing_is_said_to_be() -> None:
    text = said(assert_finds_nothing, claimed("offset", effect=None, truth={}))
    assert f"nothing was hidden, but {OFFSET}" in text


def test_what_was_hidden_decides_what_may_be_demanded() -> None:
    with pytest.raises(UsageError, match="nothing was hidden, so nothing can be found"):
        assert_finds(case("nothing"))
    for name in ("offset", "strange"):
        with pytest.raises(UsageError, match="was hidden; assert_finds"):
            assert_finds_nothing(case(name))


def test_something_unregistered_that_is_named_or_not_seen_is_said() -> None:
    strange = {"effect": None, "truth": {}, "is_strange": True}
    named, unseen = (said(assert_finds, claimed(name, **strange)) for name in ("offset", "nothing"))
    assert f"something unregistered was hidden, but {OFFSET}" in named
    assert "but nothing was found; make it larger, measure more rows" in unseen


# Every effect of a model

WHY = "this machine does not show it"
SIZES = {"running_in": {"extra": "20 um", "length": "500 m"}, "warm_probe": "1 um/K"}


def every(**more: Any) -> Callable[[str], None]:
    return finds_every_effect(PIN_WEAR, NOISE, over=FIRST_HOUR, sizes=SIZES, **more)


test_every_effect = every()


def test_it_is_a_test_by_effect() -> None:
    (mark,) = test_every_effect.pytestmark  # type: ignore[attr-defined]
    assert (mark.name, mark.args) == ("parametrize", ("effect", ["running_in", "warm_probe"]))


def test_an_effect_that_cannot_be_found_is_an_exception_with_a_reason() -> None:
    idling = finds_every_effect(with_effect(idle, "um"), NOISE, over=LONG, exceptions={"other": WHY})
    with pytest.raises(pytest.xfail.Exception, match=WHY):
        idling("other")
    with pytest.raises(
        AssertionError, match="'warm_probe' is found, but an exception is stated for it; take the exception away"
    ):
        every(exceptions={"warm_probe": WHY})("warm_probe")


def test_it_fails_where_an_effect_is_not_found() -> None:
    assert "'warm_probe' (slope 1 um/K) was hidden, but" in said(every(by={"warm_probe": kinked}), "warm_probe")


def kinked(pin: Pin, base: Wear, *, slope: Float, probe_temperature: Float) -> Wear:
    return replace(base, depth=base.depth + slope * np.abs(probe_temperature - 300.65))


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"exceptions": {"warm_prob": "so"}}, "pin_wear declares no effect 'warm_prob'"),
        ({"exceptions": {"warm_probe": ""}}, "say why 'warm_probe' cannot be found"),
        ({"by": {"sensor_offset": kinked}}, "pin_wear declares no effect 'sensor_offset'"),
    ],
)
def test_exceptions_sizes_and_functions_are_of_effects_of_the_model(more: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UsageError, match=sentence):
        every(**more)
