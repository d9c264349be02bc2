"""What an effect changes: the model is run with it, at a size it may have, beside the model without."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from truing.declare.sources import Condition, Effect, Unknown
from truing.errors import InfeasibleError
from truing.evaluate import acting_inputs, evaluate
from truing.setup import Setup, SwitchedOn
from truing.units import to_si

SIZES = (0.5, 0.05, 0.005)
"""Shares of an amplitude's bound that are tried, until the calculation is possible."""
STEP = 10.0
"""How far from its reference a condition without a range is tried, in its unit."""
ROUNDING = 1e-12


@dataclass(frozen=True)
class Touched:
    """What changes when an effect is on: results by name with the relative change, and inputs before and after (SI).

    The change of a result that is 0 without the effect is infinite; along an axis it is the largest change over the
    largest value. ``at`` holds the unknowns and conditions of the trial, SI. None could be tried where it is empty.
    """

    at: Mapping[str, float]
    results: Mapping[str, float]
    inputs: Mapping[str, tuple[float, float]]


def touched(setup: Setup, effect: Effect[Any, Any]) -> Touched:
    """Try one effect alone, as it is where it is on, else at sizes within its bounds, its conditions off reference."""
    for values, conditions in _trials(setup, effect):
        bare = replace(setup, effects=(), conditions={**setup.conditions, **conditions})
        acting = replace(bare, effects=(SwitchedOn(effect, values),))
        try:
            without, with_it = evaluate(bare, reading=True), evaluate(acting, reading=True)
        except InfeasibleError:
            continue
        read = setup.model.read_results
        changed = dict(_changed(read(without), read(with_it)))
        inputs = dict(_moved(bare, acting)) if effect.place == "inputs" else {}
        return Touched({**values, **conditions}, changed, inputs)
    return Touched({}, {}, {})


def _trials(setup: Setup, effect: Effect[Any, Any]) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
    on = next((item for item in setup.effects if item.effect.name == effect.name), None)
    if on is not None:
        yield dict(on.values), {need.name: _off_reference(setup, need) for need in effect.needs}
    for size in SIZES:
        values = {unknown.name: _tried(setup, unknown, size) for unknown in effect.unknowns}
        yield values, {need.name: _off_reference(setup, need) for need in effect.needs}


def _tried(setup: Setup, unknown: Unknown, size: float) -> float:
    """Return a value of an unknown: an amplitude at a share of its bound, a shape amid its bounds."""
    if unknown.is_amplitude:
        return float(to_si(size * (unknown.high or unknown.low), unknown.unit))
    if unknown.whole:
        return float(to_si(unknown.low, unknown.unit))
    if unknown.low > 0:
        return float(to_si((unknown.low * unknown.high) ** 0.5, unknown.unit))
    return float(to_si((unknown.low + unknown.high) / 2, unknown.unit))


def _off_reference(setup: Setup, need: Condition) -> float:
    """Return a value of a condition that is not its reference."""
    value = setup.conditions.get(need.name, need.zero)
    if value != need.zero:
        return float(value)
    for tried in (need.high, need.low):
        if tried is not None and tried != need.reference:
            return float(to_si(tried, need.unit))
    return float(to_si(need.reference + STEP, need.unit))


def _changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for name, value in before.items():
        one, other = np.atleast_1d(np.asarray(value, dtype=float)), np.atleast_1d(np.asarray(after[name], dtype=float))
        if one.shape != other.shape:
            yield name, float("inf")
            continue
        difference = other - one
        step = float(difference[np.argmax(np.abs(difference))]) if one.size else 0.0
        size = float(np.abs(one).max()) if one.size else 0.0
        if abs(step) > ROUNDING * size:
            yield name, step / size if size else float("inf")


def _moved(bare: Setup, acting: Setup) -> Iterator[tuple[str, tuple[float, float]]]:
    model = bare.model
    before, after = model.read_inputs(bare.inputs), model.read_inputs(acting_inputs(acting))
    for name, item in model.input_fields.items():
        if item.varies and before[name] == before[name] and before[name] != after[name]:
            yield name, (float(before[name]), float(after[name]))


def all_touched(setup: Setup) -> dict[str, Touched]:
    """Try every effect of the model itself, one by one."""
    return {name: touched(setup, effect) for name, effect in setup.model.effects.items()}


def effects_on(found: Mapping[str, Touched], names: Sequence[str]) -> dict[str, float]:
    """Return the effects that change any of these results, the largest relative change first."""
    sizes = {effect: max((abs(one.results[name]) for name in names if name in one.results), default=0.0)
             for effect, one in found.items()}  # fmt: skip
    return dict(sorted(((effect, size) for effect, size in sizes.items() if size), key=lambda pair: -pair[1]))
