"""Checks of a model when it is made: every name that is said must exist."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from truing.declare.goals import Maximise, Minimise, Require, Vary
from truing.declare.sources import Condition, Effect, Tolerance
from truing.declare.spreads import Band, ByChoice, Drawn, Grade, Spread
from truing.errors import DeclarationError

if TYPE_CHECKING:
    from truing.declare.fields import InputField, ResultField
    from truing.declare.model import Model

RESERVED = {"sheet", "inputs", "tolerances", "conditions", "effects", "calibrated", "studies", "units", "plugin"}


def near_miss(name: str, known: Iterable[str]) -> str:
    """Return " Did you mean 'x'?" for a misspelt name, or nothing."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f" Did you mean '{close[0]}'?" if close else ""


def check_model(model: Model[Any, Any]) -> None:
    """Refuse a model in which something names what does not exist, all such places at once."""
    faults = [*_of_names(model), *_of_errors(model), *_of_objectives(model), *_of_sheet(model), *_of_formulas(model)]
    if faults:
        raise DeclarationError(f"model '{model.name}': " + "; ".join(faults))


def _of_names(model: Model[Any, Any]) -> Iterator[str]:
    if not model.name.replace("_", "").replace(".", "").isalnum():
        yield f"the name '{model.name}' may hold letters, digits and underscores only"
    for name in set(model.input_fields) & set(model.result_fields):
        yield f"'{name}' is an input and a result; one of them needs another name"
    for name in _twice(source.name for source in model.errors):
        yield f"two error sources are called '{name}'"
    for name in _twice(study.name for study in model.studies):
        yield f"two studies are called '{name}'"


def _twice(names: Iterable[str]) -> list[str]:
    seen: set[str] = set()
    return [name for name in names if name in seen or seen.add(name)]  # type: ignore[func-returns-value]


def _of_errors(model: Model[Any, Any]) -> Iterator[str]:
    conditions: dict[str, Condition] = {}
    for source in model.errors:
        if isinstance(source, Tolerance):
            yield from of_tolerance(source, model)
        elif isinstance(source, Effect):
            for condition in source.needs:
                if conditions.setdefault(condition.name, condition) != condition:
                    yield f"the condition '{condition.name}' is declared in two ways"
                if condition.name in model.input_fields:
                    yield f"the condition '{condition.name}' has the name of an input"


def of_tolerance(source: Tolerance, model: Model[Any, Any]) -> Iterator[str]:
    """Say what a tolerance names that the model does not have."""
    for name in source.on:
        item = model.input_fields.get(name)
        condition = name in model.conditions
        if item is None and not condition:
            yield f"tolerance '{source.name}' is on '{name}', which is no input.{near_miss(name, model.input_fields)}"
        elif item is not None and not item.varies:
            yield f"tolerance '{source.name}' is on '{name}', which cannot scatter: only a Float can"
    for name in _named_by(source.spread):
        if name not in model.input_fields:
            yield f"tolerance '{source.name}' names '{name}', which is no input.{near_miss(name, model.input_fields)}"


def _named_by(spread: Spread) -> Iterator[str]:
    if isinstance(spread, ByChoice):
        yield spread.chooser
        for inner in spread.spreads.values():
            yield from _named_by(inner)
    elif isinstance(spread, Grade) and spread.size:
        yield spread.size
    elif isinstance(spread, Band) and spread.at_radius:
        yield spread.at_radius
    elif not isinstance(spread, (Band, Grade, Drawn)) and not hasattr(spread, "resolve"):
        raise DeclarationError(f"{spread!r} is no spread")


def _of_objectives(model: Model[Any, Any]) -> Iterator[str]:
    for objective in model.objectives:
        yield from of_objective(objective, model.input_fields, model.result_fields)


def of_objective(objective: Any, inputs: Mapping[str, InputField], results: Mapping[str, ResultField]) -> Iterator[str]:
    """Say what an objective names that the model does not have."""
    if isinstance(objective, Vary):
        if objective.input not in inputs:
            yield f"Vary names '{objective.input}', which is no input.{near_miss(objective.input, inputs)}"
        return
    assert isinstance(objective, (Minimise, Maximise, Require))
    if objective.result not in results and objective.result != "tolerance_price":
        yield f"an objective names '{objective.result}', which is no result.{near_miss(objective.result, results)}"
    if isinstance(objective, Require) and isinstance(objective.reliability, str) and objective.reliability not in inputs:
        yield f"Require('{objective.result}') takes its reliability from '{objective.reliability}', which is no input"


def _of_sheet(model: Model[Any, Any]) -> Iterator[str]:
    for section in model.sheet:
        yield from of_section(section, model.result_fields)


def of_section(section: Any, results: Mapping[str, ResultField]) -> Iterator[str]:
    """Say what a section names that the model does not have."""
    for name in section.names:
        if name not in results:
            yield f"section '{section.title}' names '{name}', which is no result.{near_miss(name, results)}"


def _of_formulas(model: Model[Any, Any]) -> Iterator[str]:
    from truing.declare.scope import formula_scope
    from truing.formulas import parse

    for item in model.own_result_fields.values():
        text = getattr(item.spec, "formula", "")
        if not text:
            continue
        try:
            scope = formula_scope(model, item)
            missing = [name for name in parse(text).names if name not in scope]
        except DeclarationError as error:
            yield f"formula of '{item.name}': {error}"
            continue
        if missing:
            yield f"formula of '{item.name}' names {', '.join(sorted(missing))}, which is neither input nor result"
