"""What is declared in words with units: which of it cannot be read."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from truing.declare.fields import Given, InputField, ResultField
from truing.declare.goals import Require, Vary, prices_in
from truing.declare.model import TOTAL_PRICE, Model, rate_scope
from truing.declare.near_miss import near_miss
from truing.declare.spreads import Target
from truing.errors import DeclarationError, UnitError, UsageError
from truing.formulas import Formula, evaluate_quantities, parse
from truing.units import check_unit, difference_unit, human_dimension, pint_quantity, read_quantity, same_dimension

BOUNDS = ("above", "below", "at_least", "at_most")


@dataclass(frozen=True)
class Unread:
    """Something declared that cannot be read: what declares it, as it is written there, and what is wrong with it."""

    owner: str
    written: Any
    sentence: str


def unread_quantities(model: Model[Any, Any]) -> Iterator[Unread]:
    """Give everything that a model declares with a unit and that is no unit, no quantity, or one of another kind."""
    yield from unread_units(model)
    yield from _motion(model)
    yield from unread_goals(model)
    yield from _spreads(model)
    yield from _not_finite(model)
    yield from _studied(model)


def unread_units(model: Model[Any, Any]) -> Iterator[Unread]:
    """Give units that are none, bounds that are no numbers, and prices of a width of another kind."""
    for owner, what, unit in _declared_units(model):
        if isinstance(unit, str):
            yield from _refused(owner, unit, f"{what} is declared in '{unit}'", partial(check_unit, unit))
        else:
            yield Unread(owner, unit, f"{what} is declared in {unit!r}; a unit is a text such as 'mm'")
    yield from _bounds(model.input_fields)
    yield from _widths(model)


def _declared_units(model: Model[Any, Any]) -> Iterator[tuple[str, str, Any]]:
    """Give what declares a unit, what it is called, and the unit."""
    fields: dict[str, InputField | ResultField] = {**model.input_fields, **model.result_fields}
    fields.pop(TOTAL_PRICE, None)  # in the unit of the prices
    for name, field in fields.items():
        yield name, f"'{name}'", field.spec.unit if field.spec.unit is not None else ""
    for name, state in model.dynamics.state_fields.items() if model.dynamics is not None else ():
        yield name, f"state '{name}'", state.unit
    for condition in model.conditions.values():
        yield condition.name, f"condition '{condition.name}'", condition.unit
    for effect in model.effects.values():
        for unknown in effect.unknowns:
            yield unknown.name, f"unknown '{unknown.name}' of effect '{effect.name}'", unknown.unit
    for tolerance in model.tolerances.values():
        for price in prices_in(tolerance.price):
            yield tolerance.name, f"the width of tolerance '{tolerance.name}'", price.width
            yield tolerance.name, f"the price of tolerance '{tolerance.name}'", price.unit


def _motion(model: Model[Any, Any]) -> Iterator[Unread]:
    """Give starts of states that are of another kind than the state, and rates that are not the state per second."""
    dynamics = model.dynamics
    if dynamics is None:
        return
    for name, spec in dynamics.state_fields.items():
        begins = model.input_fields.get(str(spec.start))
        if not _is_known(spec.unit) or (begins is not None and not _is_known(begins.unit)):
            continue
        if begins is not None and not same_dimension(begins.unit, spec.unit):
            kinds = f"is in '{spec.unit or '1'}' and starts at '{spec.start}', which is in '{begins.unit or '1'}'"
            yield Unread(name, spec.start, f"state '{name}' {kinds}")
        elif begins is None and isinstance(spec.start, str):
            yield from _quantity(name, spec.start, spec.unit, f"the start of state '{name}'")
        if spec.rate:
            sentence = _misfit(model, parse(spec.rate), rate_unit(spec.unit, in_steps=dynamics.step is not None))
            yield from [Unread(name, spec.rate, f"the rate of state '{name}' {sentence}")] if sentence else ()


def rate_unit(unit: str, *, in_steps: bool) -> str:
    """Return the unit of the rate of a state; in steps the law gives the state itself."""
    return f"{difference_unit(unit) or '1'}{'' if in_steps else '/s'}"


def _misfit(model: Model[Any, Any], formula: Formula, unit: str) -> str:
    """Say what a rate is in if not in its unit; nothing where a part of it cannot be read, which is said elsewhere."""
    scope = rate_scope(model)
    if not _is_known(*(scope[name].unit for name in formula.names)):
        return ""
    defaults = {name: getattr(scope[name].spec, "default", 1.0) for name in formula.names}
    values = {name: value if isinstance(value, float) else 1.0 for name, value in defaults.items()}
    try:
        quantity = evaluate_quantities(
            formula, {name: pint_quantity(value, scope[name].unit) for name, value in values.items()}
        )
    except (UnitError, DeclarationError) as error:
        return f"cannot be: {error}"
    if has_dimension(quantity, formula, unit):
        return ""
    return f"({formula.text}) gives {quantity.dimensionality}, not {human_dimension(unit)} ('{unit}')"


def has_dimension(quantity: Any, formula: Formula, unit: str) -> bool:
    """Tell whether what a formula gives is of the dimension of a unit; a literal 0 is of every one."""
    is_nothing = isinstance(formula.right, ast.Constant) and formula.right.value == 0
    return is_nothing or bool(quantity.dimensionality == pint_quantity(1.0, unit).dimensionality)


def _bounds(fields: Mapping[str, InputField]) -> Iterator[Unread]:
    for name, field in fields.items():
        for word in BOUNDS if isinstance(field.spec, Given) else ():
            bound = getattr(field.spec, word)
            if bound is not None and (isinstance(bound, bool) or not isinstance(bound, (int, float))):
                yield Unread(name, bound, f"'{name}' has the bound {word}={bound!r}; it is a number in its unit")


def unread_goals(model: Model[Any, Any]) -> Iterator[Unread]:
    """Give bounds of variables and limits that are no quantities of the right kind."""
    known: dict[str, InputField | ResultField] = {**model.input_fields, **model.result_fields}
    for goal in model.objectives:
        if isinstance(goal, Vary) and not goal.by:
            for text in (goal.low, goal.high):
                yield from _quantity(goal.input, text, known[goal.input].unit, f"Vary('{goal.input}')")
            if goal.step and _is_known(unit := known[goal.input].unit):
                yield from _quantity(goal.input, goal.step, difference_unit(unit), f"Vary('{goal.input}')")
        elif isinstance(goal, Require) and goal.result in known:
            unit, what = known[goal.result].unit, f"Require('{goal.result}')"
            unit = difference_unit(unit) if goal.kind == "within" and _is_known(unit) else unit
            if goal.limit not in known:
                yield from _quantity(goal.result, goal.limit, unit, what)
            elif _is_known(unit, known[goal.limit].unit) and not same_dimension(known[goal.limit].unit, unit):
                kinds = f"{unit or 'a pure number'} with '{goal.limit}' in {known[goal.limit].unit or 'pure numbers'}"
                yield Unread(goal.result, goal.limit, f"{what} compares {kinds}")


def _quantity(owner: str, text: str, unit: str, what: str) -> Iterator[Unread]:
    if _is_known(unit):
        yield from _refused(owner, text, what, partial(read_quantity, text, unit))


def _spreads(model: Model[Any, Any]) -> Iterator[Unread]:
    """Resolve every declared tolerance at the defaults; those of inputs without one are left to the inputs file."""
    nominals: dict[str, Any] = {
        name: condition.zero for name, condition in model.conditions.items() if _is_known(condition.unit)
    }
    for name, field in model.input_fields.items():
        if isinstance(field.spec, Given) and _is_known(field.unit):
            faults = [*_refused(name, field.spec.default, f"the default of '{name}'", field.spec.initial)]
            yield from faults
            nominals |= {} if faults else {name: field.spec.initial()}
    for tolerance in model.tolerances.values():
        for name in tolerance.on:
            nominal = nominals.get(name)
            if not isinstance(nominal, float) or math.isnan(nominal):
                continue
            target = Target(name, nominal, _unit_of(name, model), nominals.__getitem__)
            what = f"tolerance '{tolerance.name}'"
            yield from _refused(tolerance.name, tolerance.spread.text, what, partial(tolerance.spread.resolve, target))


def _not_finite(model: Model[Any, Any]) -> Iterator[Unread]:
    for name, field in model.input_fields.items():
        default = field.spec.default if isinstance(field.spec, Given) else None
        if isinstance(default, float) and not math.isfinite(default):
            yield Unread(name, f"{default}", f"the default of '{name}' is {default}, which is no finite number")


def _studied(model: Model[Any, Any]) -> Iterator[Unread]:
    """Give results and inputs that the kernel's own studies are declared with and that the model has not."""
    for study in model.studies:
        if not type(study).__module__.startswith("truing."):
            continue
        of, over = getattr(study, "of", ()), getattr(study, "over", "")
        inputs = {**model.input_fields, **model.conditions}
        asked = ("result", (of,) if isinstance(of, str) else of, model.own_result_fields)
        varied = ("input", (over,) if isinstance(over, str) and over else (), inputs)
        for kind, names, known in (asked, varied):
            for name in (name for name in names if name not in known):
                sentence = f"study '{study.name}': {model.name} has no {kind} '{name}'.{near_miss(name, known)}"
                yield Unread(name, name, sentence)


def _widths(model: Model[Any, Any]) -> Iterator[Unread]:
    """Say which prices are formulas in a width of another kind than the inputs that scatter."""
    for tolerance in model.tolerances.values():
        for price, name in ((price, name) for price in prices_in(tolerance.price) for name in tolerance.on):
            unit = _unit_of(name, model)
            if _is_known(price.width, unit) and not same_dimension(price.width, difference_unit(unit)):
                what = f"the width of tolerance '{tolerance.name}' is in '{price.width or '1'}'"
                yield Unread(tolerance.name, price.width, f"{what}, but '{name}' is in '{unit or '1'}'")


def _unit_of(name: str, model: Model[Any, Any]) -> str:
    field = model.input_fields.get(name)
    return field.unit if field is not None else model.conditions[name].unit


def _is_known(*units: Any) -> bool:
    """Tell whether units can be read; where not, that is said of what declares them."""
    try:
        for unit in units:
            check_unit(unit)
    except (UnitError, TypeError, AttributeError):
        return False
    return True


def _refused(owner: str, written: Any, what: str, read: Callable[[], Any]) -> Iterator[Unread]:
    try:
        read()
    except UnitError as error:
        yield Unread(owner, written, f"{what}: {error}")
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError, UsageError):
        return  # not of units: an input that a spread asks for has no default, or the nominal allows none
