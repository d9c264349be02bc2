"""Which effects an inputs file switches on, with all unknowns or, of an effect with parts, with some."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from truing.declare.model import Model
from truing.declare.sources import Effect, Unknown
from truing.setup import SwitchedOn

Values = Mapping[tuple[str, ...], Any]
MOST_NAMED = 4


def names_stated(data: Mapping[str, Any], unreadable: Collection[tuple[str, ...]] = ()) -> dict[str, frozenset[str]]:
    """Return what stands under each [effects.NAME], readable or not."""
    effects = data.get("effects")
    tables = effects if isinstance(effects, dict) else {}
    found = {name: set(table) for name, table in tables.items() if isinstance(table, dict)}
    for path in unreadable:
        if len(path) == 3 and path[0] == "effects" and path[1] in found:
            found[path[1]].add(path[2])
    return {name: frozenset(names) for name, names in found.items()}


def part_faults(model: Model[Any, Any], stated: Mapping[str, frozenset[str]]) -> Iterator[tuple[tuple[str, ...], str]]:
    """Say which effects with parts are on without any of them, and which parts are not stated whole."""
    for name, names in stated.items():
        effect = model.known_effects.get(name)
        if effect is None or not effect.parts:
            continue
        if not names - {"covariance"}:
            yield ("effects", name), f"effect '{name}' is on, but none of its unknowns is given: {_some(effect)}"
        for part in effect.groups():
            sentence = _unfinished(part, names)
            if sentence:
                first = next(unknown.name for unknown in part if unknown.name in names)
                yield ("effects", name, first), f"effect '{name}': {sentence}"


def _some(effect: Effect[Any, Any]) -> str:
    names = [unknown.name for unknown in effect.unknowns]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(names[:MOST_NAMED]) + more


def _unfinished(part: Sequence[Unknown], names: Collection[str]) -> str:
    """Return what a part still needs that is stated at all: its shapes, and one amplitude; or nothing."""
    given = [unknown for unknown in part if unknown.name in names]
    missing = [unknown for unknown in part if unknown.name not in names and not unknown.is_amplitude]
    if not given:
        return ""
    if missing:
        bounds = f"from {missing[0].low:g} to {missing[0].high:g} {missing[0].unit}".strip()
        return f"'{given[0].name}' is given, so '{missing[0].name}' must be given too ({bounds})"
    if not any(unknown.is_amplitude for unknown in given):
        sizes = " or ".join(f"'{unknown.name}'" for unknown in part if unknown.is_amplitude)
        return f"'{given[0].name}' is given, but without {sizes} nothing happens; give it, or leave both out"
    return ""


def effects_of(model: Model[Any, Any], values: Values) -> tuple[SwitchedOn, ...]:
    """Return the effects that are on, in the order in which they act."""
    on = []
    for name, effect in model.known_effects.items():
        keys = {unknown.name: ("effects", name, unknown.name) for unknown in effect.unknowns}
        stated = {unknown: float(values[key]) for unknown, key in keys.items() if key in values}
        if not stated or (len(stated) < len(keys) and not effect.parts):
            continue
        covariance = values.get(("effects", name, "covariance"), ()) if "covariance" not in keys else ()
        sds = {
            unknown: values[("effects", name, unknown, "sd")]
            for unknown in stated
            if ("effects", name, unknown, "sd") in values
        }
        if covariance:
            sds = {unknown: math.sqrt(covariance[place][place]) for place, unknown in enumerate(stated)} | sds
        on.append(SwitchedOn(effect, stated, sds, covariance))
    return tuple(on)
