"""Checks of error sources: effects that vanish, where they act, and whether their order matters."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from truing.declare.chain import calculation_of
from truing.declare.goals import prices_in
from truing.declare.sources import Effect, Unknown
from truing.errors import InfeasibleError, TruingError
from truing.evaluate import evaluate
from truing.setup import Setup, SwitchedOn
from truing.testing.declared import formulas_of
from truing.testing.subject import Subject, fail
from truing.units import to_si, unit_factor

SAME = 1e-12
COMMUTES = 0.01
SHAPES = (0.0, 0.5, 1.0)
SIZES = (0.5, 0.05, 5e-3, 5e-5, 5e-7)


def spreads_resolve(subject: Subject) -> None:
    """Every spread means a standard deviation at the defaults, above 0, and every price a number there."""
    for tolerance in subject.model.tolerances.values():
        for name in tolerance.on:
            try:
                target = subject.setup.target(name)
                distribution = tolerance.spread.resolve(target) if target.nominal == target.nominal else None
            except TruingError as error:
                fail(f"{subject.model.name}: tolerance '{tolerance.name}' on '{name}': {error}")
            if distribution is None:
                continue
            if not distribution.sd > 0:
                fail(f"{subject.model.name}: tolerance '{tolerance.name}' on '{name}' does not scatter; write off()")
            for price in prices_in(tolerance.price):
                paid = price.at(distribution.width)
                if not math.isfinite(paid) or paid < 0:
                    what = f"the price of tolerance '{tolerance.name}'"
                    fail(f"{subject.model.name}: {what} is {paid:g} at its declared width")


def zero_is_the_base(subject: Subject) -> None:
    """An effect whose amplitudes are 0 changes nothing, whatever its shapes and conditions."""
    for point in ({}, *subject.points(1)):
        setup = off_reference(subject.at(point))
        base = _answers(setup)
        for effect in subject.model.effects.values():
            for share in SHAPES:
                values = {
                    unknown.name: 0.0 if unknown.is_amplitude else shape(unknown, share) for unknown in effect.unknowns
                }
                changed = _changed(_answers(_with(setup, effect, values)), base)
                if changed:
                    shapes = ", ".join(f"{key} = {value:g}" for key, value in values.items())
                    fail(
                        f"{subject.model.name}: effect '{effect.name}' changes '{changed[0]}' although its amplitudes "
                        f"are 0 ({shapes}, SI)"
                    )


def references_are_neutral(subject: Subject) -> None:
    """An effect changes nothing while its conditions are at their references, unless they switch or place it."""
    base = _answers(subject.setup)
    for effect in subject.model.effects.values():
        if not effect.needs or effect.acts_at_reference:
            continue
        setup = switched(subject.setup, effect)
        changed = _changed(_answers(setup), base) if setup is not None else []
        if setup is not None and changed and not _only_switched(setup):
            needs = " and ".join(f"'{need.name}'" for need in effect.needs)
            fail(
                f"{subject.model.name}: effect '{effect.name}' changes '{changed[0]}' although {needs} stays at its "
                "reference, where it is to vanish"
            )


def _only_switched(setup: Setup) -> bool:
    """Whether the conditions only choose between states, as the sign of a load: at rest one side shows, not the other.

    The reference then belongs to one of the states. A condition that is used as it is, not from its reference on,
    differs on both sides; one that is not used at all on neither.
    """
    shown = _answers(setup)
    try:
        sides = [_answers(off_reference(setup, steps)) for steps in (10, -10)]
    except InfeasibleError:
        return False
    return sum(not _changed(answers, shown) for answers in sides) == 1


def effects_act(subject: Subject) -> None:
    """An effect that is on, off its reference, changes some result, at the defaults or at one of three other points."""
    setups = [off_reference(subject.at(point)) for point in ({}, *subject.points(3))]
    for effect in subject.model.effects.values():
        pairs = [(setup, on) for setup in setups if (on := switched(setup, effect)) is not None]
        if pairs and not any(_changed(_answers(on), _answers(setup)) for setup, on in pairs):
            fail(f"{subject.model.name}: effect '{effect.name}' is on and changes no result")


def only_last_results_are_edited(subject: Subject) -> None:
    """An effect on the results edits none that another formula depends on: it would reach nothing behind it."""
    setup = off_reference(subject.setup)
    base = _answers(setup)
    users = dict(_users(subject))
    for effect in subject.model.effects.values():
        on = switched(setup, effect) if effect.place == "results" else None
        for name in _changed(_answers(on), base) if on is not None else []:
            if name in users:
                fail(
                    f"{subject.model.name}: effect '{effect.name}' edits the result '{name}', on which '{users[name]}' "
                    "depends; let it act on the inputs (on_inputs)"
                )


def _users(subject: Subject) -> Iterator[tuple[str, str]]:
    """Yield each result that a formula names, with the result whose formula it is."""
    for field, formula, _, scope in formulas_of(subject):
        meant = {scope[name].name for name in formula.names}
        yield from ((name, field.name) for name in meant & set(subject.model.own_result_fields) - {field.name})


def order_is_free(subject: Subject) -> None:
    """Effects at one place commute: their order changes no result by more than 1 % of what they do."""
    setup = off_reference(subject.setup)
    base = _answers(setup)
    pairs: list[str] = []
    backwards = replace(setup, model=replace(setup.model, errors=list(setup.model.errors)[::-1]))
    on = {effect.name: switched(setup, effect) for effect in subject.model.effects.values()}
    for first, second in combinations(subject.model.effects.values(), 2):
        one, other = on[first.name], on[second.name]
        if calculation_of(setup.model, first.name) != calculation_of(setup.model, second.name):
            continue  # what is calculated before is acted on before
        if first.place != second.place or one is None or other is None:
            continue
        both = (*one.effects, *other.effects)
        share = _difference_by_order([replace(order, effects=both) for order in (setup, backwards)], base)
        if share > COMMUTES:
            pairs.append(f"'{first.name}' and '{second.name}' do not commute: their order changes {share:.0%} of it")
    if pairs:
        fail(
            f"{subject.model.name}: effects {'; '.join(pairs)}; they act in the order of declaration: say why that is "
            'right, exceptions={"order of effects": "..."} of the model'
        )


def _difference_by_order(orders: Sequence[Setup], base: dict[str, Any]) -> float:
    """Return the largest difference between two orders, as a share of what both effects do together."""
    try:
        answers = [_answers(setup) for setup in orders]
    except InfeasibleError:
        return 0.0
    share = 0.0
    for name, value in base.items():
        one, other = (np.asarray(answer[name], dtype=float) - value for answer in answers)
        size = float(np.max(np.abs([one, other]), initial=0.0))
        if size > SAME * float(np.max(np.abs(value), initial=0.0)):
            share = max(share, float(np.max(np.abs(one - other))) / size)
    return share


def shape(unknown: Unknown, share: float) -> float:
    """Return a shape within its bounds, on a logarithmic scale where it is positive, SI."""
    if unknown.low > 0:
        return float(to_si(unknown.low * (unknown.high / unknown.low) ** share, unknown.unit))
    return float(to_si(unknown.low + share * (unknown.high - unknown.low), unknown.unit))


def amplitude(unknown: Unknown, share: float) -> float:
    """Return an amplitude, such a share of the largest that its bounds allow, SI."""
    return float(to_si(share * max((unknown.low, unknown.high), key=abs), unknown.unit))


def switched(setup: Setup, effect: Effect[Any, Any]) -> Setup | None:
    """Return the setup with the effect on, half as large as it may be, or less; None where no size is possible."""
    for size in SIZES:
        values = {
            unknown.name: amplitude(unknown, size) if unknown.is_amplitude else shape(unknown, 0.5)
            for unknown in effect.unknowns
        }
        on = _with(setup, effect, values)
        try:
            _answers(on)
        except InfeasibleError:
            continue
        return on
    return None


def _with(setup: Setup, effect: Effect[Any, Any], values: Mapping[str, float]) -> Setup:
    return replace(setup, effects=(SwitchedOn(effect, values),))


def off_reference(setup: Setup, steps: float = 10) -> Setup:
    """Move every condition off its reference, by so many of its units and a little more from one to the next.

    An effect of the difference of two conditions would not be seen if both moved alike.
    """
    conditions = enumerate(setup.model.conditions.values())
    moved = {
        condition.name: condition.zero + steps * (1 + 0.1 * index) * unit_factor(condition.unit)
        for index, condition in conditions
    }
    return replace(setup, conditions={**setup.conditions, **moved})


def _answers(setup: Setup) -> dict[str, Any]:
    """Return what the gauge shows, by flat name."""
    return setup.model.read_results(evaluate(setup, reading=True))


def _changed(answers: dict[str, Any], base: dict[str, Any]) -> list[str]:
    changed = []
    for name, value in base.items():
        one, other = np.asarray(answers[name], dtype=float), np.asarray(value, dtype=float)
        if one.shape != other.shape or np.any(np.abs(one - other) > SAME * np.abs(other)):
            changed.append(name)
    return changed
