"""Demanding that a diagnosis finds what was hidden, and nothing where nothing was; saying what was found instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from truing.declare.model import Model
from truing.diagnosis.result import Cause, Diagnosis, explanations_of
from truing.errors import UsageError
from truing.report.diagnosis_words import cause_text, fitted_text, listed
from truing.testing.advice import advice_on, difference_text, hidden_words, quantity_text
from truing.testing.hidden import Hidden
from truing.testing.hiding import hide
from truing.testing.subject import fail

WITHIN = 1.2


def assert_finds(hidden: Hidden, *, within: float = WITHIN) -> Diagnosis:
    """Diagnose the record and demand what was hidden: the name, the size, and the gain; return the diagnosis.

    The name is that of the only cause, or stands in its ``same_as`` (on this record both draw one curve). Every size
    lies in its 95 % interval. On the rows held out, which were never fitted, the error of every measured result falls
    to ``within`` times the noise or less. Where something unregistered was hidden, the verdict is "unknown".
    Raises AssertionError with one sentence on what was found instead and what to change, and UsageError where nothing
    was hidden.
    """
    __tracebackhide__ = True
    if hidden.effect is None and not hidden.is_strange:
        raise UsageError("nothing was hidden, so nothing can be found; assert_finds_nothing(hidden) is for that")
    diagnosis = hidden.answered.diagnosis
    if hidden.effect is None:
        _demand_unknown(hidden, diagnosis)
    else:
        _demand_sizes(hidden, _demand_name(hidden, diagnosis))
    _demand_gain(hidden, within)
    return diagnosis


def assert_finds_nothing(hidden: Hidden) -> Diagnosis:
    """Diagnose the record and demand that nothing is named and no remainder seen; return the diagnosis.

    Raises AssertionError with what was found, and UsageError where something was hidden.
    """
    __tracebackhide__ = True
    if hidden.effect is not None or hidden.is_strange:
        raise UsageError(f"{hidden_words(hidden)} was hidden; assert_finds(hidden) is for that")
    diagnosis = hidden.answered.diagnosis
    if explanations_of(diagnosis):
        fail(
            f"{_model(hidden)}: nothing was hidden, but {_found(diagnosis)}; a diagnosis errs in some records of a "
            "hundred: try another seed, and if it is found there too, state the tolerances as wide as they are"
        )
    return diagnosis


def finds_every_effect(
    model: Model[Any, Any],
    noise: str | Mapping[str, str],
    *,
    sizes: Mapping[str, Any] | None = None,
    by: Mapping[str, Callable[..., Any]] | None = None,
    exceptions: Mapping[str, str] | None = None,
    **more: Any,
) -> Callable[[str], None]:
    """Return a pytest test, parametrised by effect, that every effect the model declares is found where it is hidden.

    ``noise`` and all ``more`` are those of ``hide``; ``sizes`` and ``by`` are by effect, without a size it is half of
    what the bounds allow. ``exceptions`` says of an effect why it cannot be found; it is then expected to fail, and one
    that is found all the same fails: take the exception away. Raises UsageError for an effect that is not declared.
    """
    import pytest

    stated, reasons, made = dict(sizes or {}), dict(exceptions or {}), dict(by or {})
    unknown = sorted({*stated, *reasons, *made} - set(model.effects))
    if unknown or not model.effects:
        what = f"no effect '{unknown[0]}'" if unknown else "no effect of its own"
        raise UsageError(f"{model.name} declares {what}")
    for name, reason in reasons.items():
        if not reason.strip():
            raise UsageError(f"{model.name}: say why '{name}' cannot be found; an exception needs its reason")

    @pytest.mark.parametrize("effect", list(model.effects))
    def test(effect: str) -> None:
        hidden = hide(effect, stated.get(effect), noise, model=model, by=made.get(effect), **more)
        try:
            assert_finds(hidden)
        except AssertionError:
            if effect in reasons:
                pytest.xfail(reasons[effect])
            raise
        if effect in reasons:
            fail(f"{model.name}: '{effect}' is found, but an exception is stated for it; take the exception away")

    return test


def _demand_name(hidden: Hidden, diagnosis: Diagnosis) -> Cause:
    """Return the cause that carries the name of what was hidden, and demand that it is the only one."""
    __tracebackhide__ = True
    name = hidden.effect
    named = [cause for cause in diagnosis.causes if _carries(cause, hidden)]
    if not named:
        fail(f"{_model(hidden)}: {hidden_words(hidden)} was hidden, but {_found(diagnosis)}; {advice_on(hidden)}")
    if len(diagnosis.causes) > 1 or diagnosis.remainder is not None:
        fail(
            f"{_model(hidden)}: {hidden_words(hidden)} was hidden and '{name}' is named, but something beside it too: "
            f"{_found(diagnosis)}; try another seed; if it stays, the curve of '{name}' is not what was hidden"
        )
    return named[0]


def _carries(cause: Cause, hidden: Hidden) -> bool:
    """Whether a cause is what was hidden: by its name and, of an effect with parts, of the right part; or the same."""
    if cause.effect == hidden.effect:
        return {unknown.name for unknown in cause.unknowns} == set(hidden.truth)
    return hidden.effect in cause.same_as


def _demand_sizes(hidden: Hidden, cause: Cause) -> None:
    """Demand that every interval holds the truth; a cause with another name has other unknowns."""
    __tracebackhide__ = True
    if cause.effect != hidden.effect:
        return
    for unknown in cause.unknowns:
        true = hidden.truth[unknown.name]
        slack = 1e-9 * abs(true)
        above = unknown.low is None or unknown.low - slack <= true
        if above and (unknown.high is None or true <= unknown.high + slack):
            continue
        fail(
            f"{_model(hidden)}: '{cause.effect}' is named, but its size is wrong: {fitted_text(unknown)}, hidden was "
            f"{quantity_text(true, unknown.unit)}; one interval in twenty misses: try another seed; if that misses "
            "too, another effect or a tolerance takes a part of it, or the curve is not what was hidden"
        )


def _demand_unknown(hidden: Hidden, diagnosis: Diagnosis) -> None:
    """Demand that what nobody registered is called unknown."""
    __tracebackhide__ = True
    if diagnosis.verdict == "unknown":
        return
    if diagnosis.causes or diagnosis.alternatives:
        advice = "it draws nearly the same curve; measure another result, or vary more (over)"
    else:
        advice = "make it larger, measure more rows, or with less noise"
    fail(f"{_model(hidden)}: something unregistered was hidden, but {_found(diagnosis)}; {advice}")


def _demand_gain(hidden: Hidden, within: float) -> None:
    """Demand that rows that were never fitted are predicted about as well as their noise allows."""
    __tracebackhide__ = True
    for result, noise in hidden.noise.items():
        if result not in hidden.answered.predicted:
            fail(f"{_model(hidden)}: '{result}' was measured and is not used; {_notes(hidden)}")
        error = hidden.answered.error_of(result)
        if not error <= within * noise:
            unit = hidden.setup.print_unit(result)
            sizes = difference_text(error, unit), difference_text(noise, unit)
            fail(
                f"{_model(hidden)}: on rows that were not fitted the error of '{result}' is {sizes[0]}, "
                f"{error / noise:.2f} times its noise ({sizes[1]}); {within:g} times was demanded: fit more "
                "rows, or the curve is not what was hidden"
            )


def _notes(hidden: Hidden) -> str:
    return "; ".join(hidden.answered.diagnosis.records.notes) or "no reason is given"


def _found(diagnosis: Diagnosis) -> str:
    """Say what was found, in one clause."""
    parts = [f"'{cause.effect}' was named ({cause_text(cause)})" for cause in diagnosis.causes]
    remainder = diagnosis.remainder
    if remainder is not None:
        over = listed([f"'{name}'" for name in remainder.depends_on])
        parts.append(f"something unregistered over {over} was found ({remainder.shape})")
    return listed(parts) if parts else "nothing was found"


def _model(hidden: Hidden) -> str:
    return hidden.setup.model.name
