"""Checks of a model when it is made: every name that is said must exist."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass
from inspect import signature
from typing import Any, Literal, get_args

from truing.declare.declared import Declared
from truing.declare.fields import Axis, Found, InputField, ResultField, hints_of
from truing.declare.goals import Maximise, Minimise, PriceByChoice, Require, Vary, prices_in
from truing.declare.near_miss import near_miss
from truing.declare.sources import Condition, Effect, Tolerance
from truing.declare.spreads import Band, ByChoice, Drawn, Grade, Spread
from truing.errors import DeclarationError
from truing.formulas import parse

TOTAL_PRICE = "tolerance_price"


def check_model(model: Declared) -> None:
    """Refuse a model in which something names what does not exist, all such places at once."""
    faults = [
        *_of_names(model),
        *_of_axes(model),
        *_of_companions(model),
        *_of_halving(model),
        *_of_errors(model),
        *_of_objectives(model),
        *_of_sheet(model),
        *_of_formulas(model),
        *_of_exceptions(model),
    ]
    if faults:
        raise DeclarationError(f"model '{model.name}': " + "; ".join(faults))


def _of_names(model: Declared) -> Iterator[str]:
    if not model.name.replace("_", "").isalnum():
        yield f"the name '{model.name}' may hold letters, digits and underscores only"
    for name in model.input_fields:
        if name in model.result_fields:
            yield f"'{name}' is an input and a result; one of them needs another name"
    given = [name for fields in model.study_result_fields.values() for name in fields]
    if TOTAL_PRICE in {*model.input_fields, *model.own_result_fields, *given}:
        yield f"the name '{TOTAL_PRICE}' is kept for the sum of the prices"
    for name in _twice(getattr(source, "name", repr(source)) for source in model.errors):
        yield f"two error sources are called '{name}'"
    for name in _twice(study.name for study in model.studies):
        yield f"two studies are called '{name}'"


def _of_exceptions(model: Declared) -> Iterator[str]:
    for name, reason in model.exceptions.items():
        if name not in PROMISES:
            yield f"an exception is declared from '{name}', which is no check of the kit.{near_miss(name, PROMISES)}"
        elif not reason.strip():
            yield f"the exception from '{name}' gives no reason"


def _twice(names: Iterable[str]) -> list[str]:
    return [name for name, times in Counter(names).items() if times > 1]


def _of_axes(model: Declared) -> Iterator[str]:
    """Say which results and series run along an axis that nobody declares."""
    fields = model.own_result_fields
    axes = {name for name, field in fields.items() if isinstance(field.spec, Axis)}
    axes |= {name for name, field in model.input_fields.items() if field.kind == "series"}
    for name, result in fields.items():
        own = f"{result.along}_{result.scope}" if result.scope else result.along
        if isinstance(result.spec, Found) and result.along and not {own, result.along} & axes:
            yield f"the result '{name}' runs along '{result.along}', which is no axis.{near_miss(result.along, axes)}"
    for name, field in model.input_fields.items():
        along = field.spec.along
        if along and along not in axes:
            yield f"the input '{name}' runs along '{along}', which is no axis.{near_miss(along, axes)}"
    series = [name for name, field in model.input_fields.items() if field.kind == "series"]
    for name, result in fields.items():
        followed = result.spec.follows if isinstance(result.spec, Axis) else ""
        if followed and followed not in series:
            yield f"the axis '{name}' follows '{followed}', which is no input series.{near_miss(followed, series)}"


def _of_companions(model: Declared) -> Iterator[str]:
    """Say which inputs are to be stated with one that does not exist."""
    for name, field in model.input_fields.items():
        other = field.spec.stated_with
        if other and (other == name or other not in model.input_fields):
            meant = near_miss(other, model.input_fields)
            yield f"the input '{name}' is stated with '{other}', which is no other input.{meant}"


def _of_halving(model: Declared) -> Iterator[str]:
    """Say which numerical steps are no numbers, promise nothing, or name what is no result."""
    fields = model.own_result_fields
    for name, field in model.input_fields.items():
        share, but = getattr(field.spec, "halving", None), getattr(field.spec, "halving_but", {})
        if share is None and but:
            yield f"the input '{name}' has a halving_but without a halving; give the share for all other results"
        if share is not None and (field.kind not in {"float", "whole", "integer"} or not 0 < share < 1):
            yield f"the input '{name}' has the halving {share!r}; it is a share from 0 to 1, of a number or count"
        for result in but:
            if result not in fields:
                yield f"the halving of '{name}' names '{result}', which is no result.{near_miss(result, fields)}"


def _of_errors(model: Declared) -> Iterator[str]:
    conditions: dict[str, Condition] = {}
    for source in model.errors:
        if isinstance(source, Tolerance):
            yield from of_tolerance(source, model)
        elif isinstance(source, Effect):
            yield from of_effect(source, model)
            for condition in source.needs:
                if conditions.setdefault(condition.name, condition) != condition:
                    yield f"the condition '{condition.name}' is declared in two ways"
        else:
            yield f"{source!r} is neither a Tolerance nor an Effect"
    units = sorted({price.unit for tolerance in model.tolerances.values() for price in prices_in(tolerance.price)})
    if len(units) > 1:
        yield f"the prices are in {' and '.join(units)}; give all of them in one unit, so that they can be added"


def of_effect(source: Effect[Any, Any], model: Declared) -> Iterator[str]:
    """Say what keeps an effect from acting on the model: names that are taken, inputs and results of another one."""
    for condition in source.needs:
        for known, kind in ((model.input_fields, "an input"), (model.result_fields, "a result")):
            if condition.name in known:
                yield f"the condition '{condition.name}' has the name of {kind}"
    axes = {name for name, result in model.own_result_fields.items() if isinstance(result.spec, Axis)}
    readable = {*model.input_fields, *axes}
    for name in source.reads:
        if name not in readable:
            yield f"effect '{source.name}' reads '{name}', which is neither input nor axis.{near_miss(name, readable)}"
    expected = [model.input_type, model.result_type][: 1 if source.place == "inputs" else 2]
    for parameter, wanted in zip(signature(source.function).parameters.values(), expected, strict=False):
        try:
            given = hints_of(source.function).get(parameter.name)
        except TypeError:  # a callable without annotations, such as a partial: nothing to compare
            return
        if isinstance(given, type) and is_dataclass(given) and given is not wanted:
            yield f"effect '{source.name}' acts on {given.__qualname__}, but the model has {wanted.__qualname__}"


def of_tolerance(source: Tolerance, model: Declared) -> Iterator[str]:
    """Say what a tolerance names that the model does not have."""
    for name in source.on:
        field = model.input_fields.get(name)
        condition = name in model.conditions
        if field is None and not condition:
            yield f"tolerance '{source.name}' is on '{name}', which is no input.{near_miss(name, model.input_fields)}"
        elif field is not None and not field.varies:
            yield f"tolerance '{source.name}' is on '{name}', which cannot scatter: only a Float can"
    for fault in _of_spread(source.spread, model):
        yield f"tolerance '{source.name}' {fault}"
    yield from _of_price(source, model)


def _of_price(source: Tolerance, model: Declared) -> Iterator[str]:
    what = f"the price of tolerance '{source.name}'"
    if isinstance(source.price, PriceByChoice):
        for fault in _of_choices(source.price.chooser, source.price.prices, "price", model):
            yield f"{what} {fault}"
    for price in prices_in(source.price):
        names = _names_in(price.formula)
        if isinstance(names, str):
            yield f"{what}: {names}"
        elif names != {"width"}:
            yield f"{what} names {', '.join(sorted(names)) or 'nothing'}; it is a formula in width"


def _of_choices(chooser: str, branches: Mapping[str, Any], what: str, model: Declared) -> Iterator[str]:
    """Say why an input cannot choose among these branches."""
    field = model.input_fields.get(chooser)
    if field is None:
        yield f"names '{chooser}', which is no input.{near_miss(chooser, model.input_fields)}"
    elif not field.choices:
        yield f"is chosen by '{chooser}', which offers no choices"
    elif set(field.choices) != set(branches):
        yield f"has a {what} for {', '.join(branches)}, but '{chooser}' offers {', '.join(field.choices)}"


def _of_spread(spread: Spread, model: Declared) -> Iterator[str]:
    if not hasattr(spread, "resolve"):
        yield f"has the spread {spread!r}; write normal(...), plus_minus(...), grade(...) or another of the words"
    elif isinstance(spread, ByChoice):
        yield from _of_choices(spread.chooser, spread.spreads, "spread", model)
        for inner in spread.spreads.values():
            yield from _of_spread(inner, model)
    for name in _read_by(spread):
        if name not in model.input_fields:
            yield f"names '{name}', which is no input.{near_miss(name, model.input_fields)}"


def _read_by(spread: Spread) -> tuple[str, ...]:
    """Return the inputs that a spread asks for beside its own."""
    if isinstance(spread, Drawn):
        return spread.of
    name = spread.size if isinstance(spread, Grade) else spread.at_radius if isinstance(spread, Band) else ""
    return (name,) if name else ()


def _names_in(formula: str) -> frozenset[str] | str:
    """Return the names in a formula, or why it cannot be read."""
    try:
        return frozenset(parse(formula).names)
    except DeclarationError as error:
        return str(error)


def _of_objectives(model: Declared) -> Iterator[str]:
    for objective in model.objectives:
        yield from of_objective(objective, model.input_fields, model.result_fields)


def of_objective(objective: Any, inputs: Mapping[str, InputField], results: Mapping[str, ResultField]) -> Iterator[str]:
    """Say what an objective names that the model does not have."""
    if isinstance(objective, Vary):
        yield from _of_vary(objective, inputs)
    elif isinstance(objective, (Minimise, Maximise)):
        known = {**inputs, **results}
        if objective.result not in known:
            what = f"{type(objective).__name__} names '{objective.result}'"
            yield f"{what}, which is neither input nor result.{_unknown_result(objective.result, known)}"
    elif isinstance(objective, Require):
        yield from _of_require(objective, inputs, results)
    else:
        yield f"{objective!r} is no objective; write Vary, Minimise, Maximise or Require"


def _of_vary(objective: Vary, inputs: Mapping[str, InputField]) -> Iterator[str]:
    if objective.input not in inputs:
        yield f"Vary names '{objective.input}', which is no input.{near_miss(objective.input, inputs)}"
    elif not inputs[objective.input].varies and inputs[objective.input].kind != "integer":
        yield f"Vary names '{objective.input}', which is no number that may vary"
    names = _names_in(objective.by) if objective.by else frozenset()
    if isinstance(names, str):
        yield f"Vary('{objective.input}'): {names}"
    elif strange := sorted(names - set(inputs)):
        yield f"Vary('{objective.input}') follows {strange[0]}, which is no input.{near_miss(strange[0], inputs)}"


def _of_require(
    objective: Require, inputs: Mapping[str, InputField], results: Mapping[str, ResultField]
) -> Iterator[str]:
    if objective.result not in results:
        yield f"Require names '{objective.result}', which is no result.{_unknown_result(objective.result, results)}"
    if objective.result == TOTAL_PRICE and objective.reliability is not None:
        yield f"Require('{TOTAL_PRICE}') asks for a reliability, but a price does not scatter"
    limit, known = objective.limit, {**inputs, **results}
    if not any(sign.isdigit() for sign in limit) and limit not in known:
        what = f"Require('{objective.result}') has the limit '{limit}'"
        yield f"{what}, which is neither a quantity nor an input or result.{near_miss(limit, known)}"
    if isinstance(objective.reliability, str) and objective.reliability not in inputs:
        yield f"Require('{objective.result}') takes its reliability from '{objective.reliability}', which is no input"


def _unknown_result(name: str, known: Iterable[str]) -> str:
    """Return what was probably meant by a name that is no result."""
    return " No tolerance has a price." if name == TOTAL_PRICE else near_miss(name, known)


def _of_sheet(model: Declared) -> Iterator[str]:
    for section in model.sheet:
        yield from of_section(section, model.result_fields)


def of_section(section: Any, results: Mapping[str, ResultField]) -> Iterator[str]:
    """Say what a section names that the model does not have."""
    for name in section.names:
        if name not in results:
            yield f"section '{section.title}' names '{name}', which is no result.{near_miss(name, results)}"


def _of_formulas(model: Declared) -> Iterator[str]:
    for result in model.result_fields.values():
        text = getattr(result.spec, "formula", "")
        if not text:
            continue
        try:
            scope = formula_scope(model, result)
            formula = parse(text)
            missing = [name for name in formula.names if name not in scope]
        except DeclarationError as error:
            yield f"formula of '{result.name}': {error}"
            continue
        if missing:
            named = ", ".join(sorted(missing)) + f", which is neither input nor result.{near_miss(missing[0], scope)}"
            yield f"formula of '{result.name}' names {named}"
        elif formula.left is None and any(scope[name] is result for name in formula.names):
            yield f"formula of '{result.name}' names itself; write an equation with == for what is solved"


# Which quantity a name in a formula means: that of its own part first


def formula_scope(model: Declared, result: ResultField) -> Mapping[str, InputField | ResultField]:
    """Return what each name means in the formula of ``result``: own part first, then the flat names.

    The function's results know each other; what a study gives knows the results of all studies besides.
    """
    own_result = result.name in model.own_result_fields
    known: dict[str, InputField | ResultField] = {
        **model.input_fields, **(model.own_result_fields if own_result else model.result_fields),
    }  # fmt: skip
    if not result.scope:
        return known
    ending = "_" + result.scope
    own = {name.removesuffix(ending): field for name, field in known.items() if name.endswith(ending)}
    return {**known, **own}


# What every calculation promises, by the names that the conformance kit gives its checks


Promise = Literal[
    "units are known",
    "defaults keep their bounds",
    "finite at defaults",
    "goals can be read",
    "spreads resolve",
    "printed numbers are of results",
    "sheet is in order",
    "formulas have the unit",
    "formulas equal the function",
    "batch equals loop",
    "steps may be halved",
    "inputs untouched",
    "seeds decide",
    "serial equals parallel",
    "derivatives are exact",
    "bounds are answered",
    "inputs survive a file",
    "example can be read",
    "zero is the base",
    "references are neutral",
    "effects act",
    "only last results are edited",
    "order of effects",
]
"""A check of the kit, as a known exception of a model names it."""
PROMISES: tuple[str, ...] = get_args(Promise)
