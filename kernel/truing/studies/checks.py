"""Limits: what a requirement demands, in numbers, and the margin that is left."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isnan
from typing import Any

from truing.declare.fields import in_si
from truing.declare.goals import Require
from truing.evaluate import evaluate
from truing.setup import Setup
from truing.studies.bench import Check


@dataclass(frozen=True)
class Limit:
    """A requirement in SI: ``low <= result <= high``, and the probability it asks for (None: it must simply hold).

    The limits are numbers, or arrays along the axis of the result.
    """

    name: str
    result: str
    low: Any
    high: Any
    goal: float | None
    require: Require


def margin_of(value: float, limit: float, *, at_least: bool = False) -> float:
    """Return (limit - value)/|limit|, negated for a lower limit; absolute when the limit is 0."""
    distance = (value - limit) if at_least else (limit - value)
    return distance / abs(limit) if limit else distance


def limits(setup: Setup, answers: dict[str, Any]) -> list[Limit]:
    """Return every requirement of the model in numbers; ``answers`` holds the nominal results in SI."""
    requires = requirements(setup)
    return [_limit(require, requires, setup, answers) for require in requires if require.result in answers]


def requirements(setup: Setup) -> list[Require]:
    """Return the requirements of the model; one whose limit is an input that is not given asks for nothing."""
    fields = setup.model.input_fields
    every = [item for item in setup.model.objectives if isinstance(item, Require)]
    return [item for item in every if item.limit not in fields or not isnan(float(setup.nominal(item.limit)))]


def _limit(require: Require, others: list[Require], setup: Setup, answers: dict[str, Any]) -> Limit:
    amount = limit_amount(require, setup, answers)
    low, high = -float("inf"), float("inf")
    if require.kind == "at_most":
        high = amount
    elif require.kind == "at_least":
        low = amount
    else:
        centre = of_design(setup, require.result, answers)
        low, high = centre - amount, centre + amount
    goal = require.reliability
    if isinstance(goal, str):
        goal = float(setup.nominal(goal))
    return Limit(check_name(require, others), require.result, low, high, goal, require)


def of_design(setup: Setup, result: str, answers: dict[str, Any]) -> Any:
    """Return a result of the design itself, from which ``within`` is measured.

    No part of the design are effects that are on, and deviations that the inputs state: inputs with a tolerance whose
    declared default is 0.
    """
    acts = any(item.effect.place != "reading" for item in setup.effects)
    deviating = dict.fromkeys(_deviations(setup), 0.0)
    if not (acts or deviating) or result not in setup.model.own_result_fields:
        return answers[result]
    design = replace(setup.changed(deviating), effects=())
    return setup.model.read_results(evaluate(design))[result]


def _deviations(setup: Setup) -> list[str]:
    """Return the names of the deviations that are not 0."""
    fields = setup.model.input_fields
    names = {name for tolerance in setup.model.tolerances.values() for name in tolerance.on if name in fields}
    sockets = [name for name in sorted(names) if getattr(fields[name].spec, "default", None) == 0]
    return [name for name in sockets if setup.nominal(name) != 0]


def limit_amount(require: Require, setup: Setup, answers: dict[str, Any]) -> Any:
    """Return the stated limit in SI: an input, a result or a quantity in the unit of the result."""
    if require.limit in setup.model.input_fields:
        return float(setup.nominal(require.limit))
    if require.limit in answers:
        return answers[require.limit]
    return float(in_si(require.limit, setup.model.result_fields[require.result].unit))


def check_name(require: Require, others: list[Require]) -> str:
    """Return the name of a check: the result's, with the kind where one result has several limits."""
    twins = [other for other in others if other.result == require.result]
    return require.result if len(twins) == 1 else f"{require.result} {require.kind.replace('_', ' ')}"


def plain_checks(setup: Setup, answers: dict[str, Any]) -> list[Check]:
    """Return the checks that need no probability, in the unit each result is printed in."""
    return [_plain(limit, setup, answers) for limit in limits(setup, answers) if limit.goal is None]


def _plain(limit: Limit, setup: Setup, answers: dict[str, Any]) -> Check:
    import numpy as np

    from truing.units import difference_unit, from_si

    unit = setup.print_unit(limit.result)
    at_least = limit.require.kind == "at_least"
    value, stated = answers[limit.result], limit.low if at_least else limit.high
    if limit.require.kind == "within":
        unit = difference_unit(unit)
        value, stated = abs(value - (limit.low + limit.high) / 2), (limit.high - limit.low) / 2
    values, bounds = np.broadcast_arrays(*np.atleast_1d(np.asarray(value, dtype=float), stated))
    worst = int(np.argmin(values - bounds) if at_least else np.argmax(values - bounds))
    value, bound = float(from_si(values[worst], unit)), float(from_si(bounds[worst], unit))
    margin = margin_of(value, bound, at_least=at_least)
    return Check(limit.name, value, bound, unit, margin, margin >= 0)


def chance_check(name: str, probability: float, goal: float, *, method: str = "", note: str = "") -> Check:
    """Return the check of a probability, found by a method, against its goal."""
    margin = margin_of(probability, goal, at_least=True)
    return Check(name, probability, goal, "", margin, margin >= 0, note, method)
