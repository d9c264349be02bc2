"""Demanding that a diagnosis finds what was hidden, and nothing where nothing was; saying what was found instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from truing.declare.model import Model
from truing.declare.sources import Effect
from truing.diagnosis.result import Amount, Cause, DiagnosisResult, VisibleSize, explanations_of
from truing.errors import UsageError
from truing.report.diagnosis_sizes import fitted_text
from truing.report.diagnosis_words import cause_text, listed, settings_text
from truing.testing.hiding import Hidden, hide
from truing.testing.subject import fail
from truing.units import difference_unit, from_si, unit_factor

WITHIN = 1.2


def assert_finds(hidden: Hidden, *, within: float = WITHIN) -> DiagnosisResult:
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


def assert_finds_nothing(hidden: Hidden) -> DiagnosisResult:
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


def _demand_name(hidden: Hidden, diagnosis: DiagnosisResult) -> Cause:
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


def _demand_unknown(hidden: Hidden, diagnosis: DiagnosisResult) -> None:
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
            notes = "; ".join(hidden.answered.diagnosis.records.notes) or "no reason is given"
            fail(f"{_model(hidden)}: '{result}' was measured and is not used; {notes}")
        error = hidden.answered.error_of(result)
        if not error <= within * noise:
            unit = hidden.setup.print_unit(result)
            sizes = difference_text(error, unit), difference_text(noise, unit)
            fail(
                f"{_model(hidden)}: on rows that were not fitted the error of '{result}' is {sizes[0]}, "
                f"{error / noise:.2f} times its noise ({sizes[1]}); {within:g} times was demanded: fit more "
                "rows, or the curve is not what was hidden"
            )


def _found(diagnosis: DiagnosisResult) -> str:
    """Say what was found, in one clause."""
    parts = [f"'{cause.effect}' was named ({cause_text(cause)})" for cause in diagnosis.causes]
    remainder = diagnosis.remainder
    if remainder is not None:
        over = listed([f"'{name}'" for name in remainder.depends_on])
        parts.append(f"something unregistered over {over} was found ({remainder.shape})")
    return listed(parts) if parts else "nothing was found"


def _model(hidden: Hidden) -> str:
    return hidden.setup.model.name


# What to change where a hidden effect was not found


def advice_on(hidden: Hidden) -> str:
    """Say what to change so that the effect is found."""
    name, diagnosis = hidden.effect or "", hidden.answered.diagnosis
    missing = diagnosis.not_measured.get(name)
    if missing:
        return f"not measured: add {', '.join(missing)} to over"
    known = {visible.name: visible for visible in diagnosis.seen}
    names = (name, *(f"{name}.{unknown}" for unknown in hidden.truth))
    seen = next((known[each] for each in names if each in known), None)
    if seen is not None and seen.smallest is None:
        return f"not excited: {_vary(hidden)}"
    if diagnosis.remainder is not None and not diagnosis.causes:
        return f"what was hidden is not the curve of '{name}': look for a sign, a unit, the place where it acts"
    rivals = [alternative for alternative in diagnosis.alternatives if name in alternative.causes]
    if rivals and diagnosis.causes:
        return f"cannot be told apart from '{diagnosis.causes[0].effect}': {_next(diagnosis)}"
    if seen is not None and seen.smallest is not None:
        return _too_small(hidden, seen, seen.smallest)
    return f"too small for this noise, or what was hidden is not its curve: hide more, or {_vary(hidden)}"


def _too_small(hidden: Hidden, seen: VisibleSize, least: Amount) -> str:
    """Compare the first amplitude that was hidden with what can be seen."""
    smallest = quantity_text(least.value, least.unit)
    amplitudes = [unknown.name for unknown in _effect(hidden).unknowns if unknown.is_amplitude]
    size = next((abs(hidden.truth[name]) for name in amplitudes if hidden.truth.get(name)), 0.0)
    if seen.sight == "hidden in the tolerances":
        return (
            f"hidden in the tolerances: what is left of it beside them is seen from {smallest} on; hide more, measure "
            "a result that they do not move, or vary more (over)"
        )
    if size < least.value:
        return f"too small: it is seen from {smallest} on; hide more, measure more rows, or with less noise"
    return (
        f"to be seen from {smallest} on: try another seed; if it is never found, the curve that was hidden is not that "
        f"of '{hidden.effect}' (a sign, a unit), or {_vary(hidden)}"
    )


def _effect(hidden: Hidden) -> Effect[Any, Any]:
    return hidden.setup.model.known_effects[hidden.effect or ""]


def _vary(hidden: Hidden) -> str:
    """Say what to vary: the conditions of the effect, else the inputs."""
    effect = _effect(hidden)
    names = [*(need.made_from or need.name for need in effect.needs), *effect.reads]
    records = hidden.answered.diagnosis.records.covariates
    steady = [name for name in names if name not in records or records[name].is_constant]
    if steady:
        return f"vary {', '.join(steady)} (over)"
    return f"vary {', '.join(names)} further, or an input that brings it out (over)" if names else (
        "vary an input that brings it out (over), or measure a result that it changes (measure)"
    )  # fmt: skip


def _next(diagnosis: DiagnosisResult) -> str:
    """Say what the diagnosis asks for to tell two causes apart."""
    if not diagnosis.next:
        return "nothing that can be measured here tells them apart; measure another result"
    point = diagnosis.next[0]
    return f"measure {settings_text(point)}" if point.measure else f"measure at {settings_text(point)}"


def hidden_words(hidden: Hidden) -> str:
    """Say what was hidden, with its size."""
    if hidden.effect is None:
        return "something unregistered"
    units = {unknown.name: unknown.unit for unknown in _effect(hidden).unknowns}
    sizes = ", ".join(f"{name} {quantity_text(value, units[name])}" for name, value in hidden.truth.items())
    return f"'{hidden.effect}' ({sizes})"


def quantity_text(value: float, unit: str) -> str:
    """Write an SI number in its unit."""
    return f"{float(from_si(value, unit)):.4g} {unit}".strip()


def difference_text(value: float, unit: str) -> str:
    """Write a difference (an error, a noise), which is SI, in the unit of its result."""
    own = difference_unit(unit)
    return f"{value / unit_factor(own):.3g} {own}".strip()
