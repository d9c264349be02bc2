"""What is hidden: an effect with its unknowns, made by its own function or by one of the author's own."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.declare.sources import Effect, Unknown
from truing.errors import TruingError, UsageError
from truing.setup import Setup, SwitchedOn
from truing.units import from_si, read_quantity

Size: TypeAlias = str | float | Mapping[str, str | float]
Strange: TypeAlias = Callable[..., Any]
STRANGE = "hidden_by_the_test"
ENDLESS = 1e6
"""Bounds as wide as these say nothing of how large an effect is."""


def effect_of(model: Model[Any, Any], name: str | None, faults: list[str]) -> Effect[Any, Any] | None:
    """Return the effect of this name, of the model or of the kernel."""
    if name is None or name in model.known_effects:
        return model.known_effects[name] if name is not None else None
    known = list(model.known_effects)
    faults.append(f"no effect '{name}'.{near_miss(name, known) or ' It has ' + ', '.join(known)}")
    return None


def truth_of(
    effect: Effect[Any, Any] | None, size: Size | None, measured: Sequence[str], faults: list[str]
) -> dict[str, float]:
    """Return the unknowns of the effect in SI."""
    if effect is None:
        if size is not None and not faults:
            faults.append(f"size is {size!r}, but no effect is hidden; leave it out")
        return {}
    stated = _stated(effect, size, measured, faults)
    found: dict[str, float] = {}
    for name, said in stated.items():
        unknown = next((one for one in effect.unknowns if one.name == name), None)
        if unknown is None:
            known = [one.name for one in effect.unknowns]
            faults.append(f"effect '{effect.name}' has no unknown '{name}'.{near_miss(name, known)}")
            continue
        try:
            found[name] = _value(effect, unknown, said)
        except TruingError as error:
            faults.append(f"size of '{name}': {error}")
    touched = [part for part in effect.groups() if any(one.name in stated for one in part)]
    missing = [one.name for part in touched for one in part if one.name not in stated]
    if missing:
        faults.append(f"effect '{effect.name}': say {' and '.join(missing)} as well, size={{...}}")
    if found and not any(one.is_amplitude and found.get(one.name) for one in effect.unknowns) and not missing:
        faults.append(f"effect '{effect.name}' of size 0 hides nothing; hide(None, ...) does that")
    return found


def _stated(
    effect: Effect[Any, Any], size: Size | None, measured: Sequence[str], faults: list[str]
) -> Mapping[str, str | float]:
    """Return what is said of each unknown; a plain size is that of the only amplitude."""
    if isinstance(size, Mapping):
        return size
    parts = effect.groups()
    if effect.parts:  # one gauge each: that of what is measured
        parts = tuple(part for part in parts if any(one.name in measured for one in part)) or parts
    if size is None:
        return _half(effect, parts, faults)
    if len(parts) == 1 and len(parts[0]) == 1:
        return {parts[0][0].name: size}
    names = [one.name for part in parts for one in part]
    faults.append(
        f"effect '{effect.name}' has the unknowns {', '.join(names)}: say which is {size}, "
        f'size={{"{names[0]}": "{size}", ...}}'
    )
    return {}


def _half(effect: Effect[Any, Any], parts: Sequence[Sequence[Unknown]], faults: list[str]) -> dict[str, str]:
    """Take half of what the bounds of an amplitude allow, and the middle of those of a shape."""
    if len(parts) != 1 or any(abs(one.high) >= ENDLESS for one in parts[0]):
        faults.append(f"say how large '{effect.name}' is: size={{...}}; its bounds are no measure of it")
        return {}
    found = {}
    for one in parts[0]:
        if one.is_amplitude:
            value = max((one.low, one.high), key=abs) / 2
        else:
            value = math.sqrt(one.low * one.high) if one.low > 0 else (one.low + one.high) / 2
        found[one.name] = f"{round(value) if one.whole else value!r} {one.unit}".strip()
    return found


def _value(effect: Effect[Any, Any], unknown: Unknown, said: str | float) -> float:
    """Read one unknown, SI. Raises UsageError where it is no quantity of its kind, or out of its bounds."""
    value = float(read_quantity(said if isinstance(said, str) else repr(said), unknown.unit))
    number = float(from_si(value, unknown.unit))
    slack = 1e-9 * max(abs(unknown.low), abs(unknown.high))
    if not unknown.low - slack <= number <= unknown.high + slack:
        raise UsageError(
            f"{said} lies outside of its bounds, {unknown.low:g} to {unknown.high:g} {unknown.unit}".rstrip()
            + ", where no diagnosis looks"
        )
    if unknown.whole and not number.is_integer():
        raise UsageError(f"{said} is no whole number")
    return value


def check_by(by: Strange | None, effect: Effect[Any, Any] | None, model: Model[Any, Any], faults: list[str]) -> None:
    """Say where a function of the author's own does not take what the effect has."""
    if by is None:
        return
    parameters = list(inspect.signature(by).parameters.values())
    if any(item.kind is inspect.Parameter.VAR_KEYWORD for item in parameters):
        return
    named = {item.name for item in parameters[2:]}
    if effect is None:
        unknown = sorted(named - set(model.known_conditions))
        if unknown:
            faults.append(f"by takes {', '.join(unknown)}, which is no condition of the model")
        return
    wanted = {one.name for one in effect.unknowns} | {need.name for need in effect.needs}
    needed = {item.name for item in parameters[2:] if item.default is inspect.Parameter.empty}
    if len(parameters) < 2 or not needed <= wanted <= named:
        faults.append(
            f"by takes {', '.join(item.name for item in parameters) or 'nothing'}; it is called with inputs, results "
            f"and the keywords {', '.join(sorted(wanted))}"
        )


def wrong_machine(
    setup: Setup, effect: Effect[Any, Any] | None, truth: Mapping[str, float], by: Strange | None
) -> Setup:
    """Return the machine as it truly is: the effect on, made by its own function or by the author's."""
    if by is None:
        return replace(setup, effects=(SwitchedOn(effect, truth),)) if effect is not None else setup
    model = setup.model
    made = _by_hand(by, effect, model)
    errors = [source for source in model.errors if source.name != made.name]
    changed = replace(model, errors=[*errors, made])
    on = SwitchedOn(made, truth if effect is not None else {made.unknowns[0].name: 1.0})
    return replace(setup, model=changed, effects=(on,))


def _by_hand(by: Strange, effect: Effect[Any, Any] | None, model: Model[Any, Any]) -> Effect[Any, Any]:
    """Make an effect on the reading of the author's own function."""
    if effect is not None:
        return Effect(effect.name, on_reading=by, unknowns=effect.unknowns, needs=effect.needs, parts=effect.parts)
    named = [*inspect.signature(by).parameters][2:]
    needs = [model.known_conditions[name] for name in named if name in model.known_conditions]

    def function(inputs: Any, results: Any, **known: Any) -> Any:
        return by(inputs, results, **{name: known[name] for name in named})

    return Effect(STRANGE, on_reading=function, unknowns=[Unknown("size", 0, 1)], needs=needs)
