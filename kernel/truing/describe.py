"""A model in words: inputs, results, error sources, objectives, as plain data for people and programs."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping, Sequence
from typing import Any

from truing.declare.builtin import may_stand
from truing.declare.chain import acts_on
from truing.declare.fields import Axis, Given, InputField, Loaded, ResultField
from truing.declare.goals import Maximise, Minimise, Require, Vary
from truing.declare.model import Model
from truing.declare.published import Published
from truing.declare.sources import Condition, Effect, Tolerance
from truing.formulas import symbol_text
from truing.inputs_file.values import bounds_in_words
from truing.kernel import Offer
from truing.units import unit_text

LONGEST_SERIES = 12
"""A longer default is shown by its ends."""
WHERE_MEASURED = (
    ("thermal_drift_of_INPUT", "", "", "where a record varies an input in K"),
    ("periodic_order_of_INPUT", "", "", "where a record turns an input round that is an angle"),
)


def description(offer: Offer) -> dict[str, Any]:
    """Return everything the model declares, as one JSON-ready document."""
    model = offer.model
    built_in = [effect for name, effect in model.known_effects.items() if name not in model.effects]
    return {
        "name": offer.name,
        "title": model.title,
        "summary": model.summary,
        "plugin": {"name": offer.origin.name, "version": offer.origin.version},
        "inputs": [_input(field) for field in model.input_fields.values()],
        "results": [_result(field) for field in model.result_fields.values()],
        **_motion(model),
        "tolerances": [_tolerance(tolerance) for tolerance in model.tolerances.values()],
        "correlations": [_named(pair, CORRELATION) for pair in model.correlations],
        "effects": [_effect(model, effect) for effect in model.effects.values()],
        "conditions": [_condition(condition) for condition in model.conditions.values()],
        "built_in": {
            "effects": [_effect(model, effect) for effect in built_in if not may_stand(effect)],
            "where_measured": [_effect(model, effect) for effect in built_in if may_stand(effect)],
            "conditions": [
                _condition(condition)
                for name, condition in model.known_conditions.items()
                if name not in model.conditions
            ],
        },
        "objectives": [_objective(objective) for objective in model.objectives],
        "studies": [study.name for study in model.studies],
        "sheet": [{"title": section.title, "results": list(section.names)} for section in model.sheet],
        "published": [_published(printed) for printed in model.published],
        "findings": [dataclasses.asdict(finding) for finding in model.findings],
        "exceptions": {str(name): reason for name, reason in model.exceptions.items()},
        "cites": list(model.cites),
        "added": [addition.as_json for addition in offer.added],
    }


def _motion(model: Model[Any, Any]) -> dict[str, Any]:
    """Return the states and events of a model that moves; nothing of any other."""
    dynamics = model.dynamics
    if dynamics is None:
        return {}
    states = [
        {"name": name, **_named(spec, ("symbol", "unit", "start", "rate", "note"))}
        for name, spec in dynamics.state_fields.items()
    ]
    return {"states": states, "events": [_named(event, ("name", "when", "ends", "note")) for event in dynamics.events]}


def _input(field: InputField) -> dict[str, Any]:
    spec = field.spec
    default = spec.default if isinstance(spec, Given) else None
    taken = spec.taken if isinstance(spec, Given) else None
    return {
        **_named(field, ("name", "symbol", "kind", "unit")),
        "default": list(default) if isinstance(default, tuple) else default,
        "optional": field.is_optional,
        "choices": list(field.choices),
        "options": list(inspect.signature(spec.reader).parameters)[1:] if isinstance(spec, Loaded) else [],
        "bounds": bounds_in_words(field, with_unit=False),
        "role": getattr(spec, "role", ""),
        **_named(spec, ("note", "source")),
        **({"from": {"calculation": taken.model, "result": taken.result}} if taken is not None else {}),
    }


def _result(field: ResultField) -> dict[str, Any]:
    spec = field.spec
    kind = ("table" if spec.is_table else "axis") if isinstance(spec, Axis) else "result"
    return {
        **_named(field, ("name", "symbol")),
        "kind": kind,
        "unit": field.unit,
        **{name: getattr(spec, name, "") for name in ("note", "formula", "method", "source")},
        "along": field.along if kind == "result" else "",
    }


UNKNOWN = ("name", "low", "high", "unit", "note")
CONDITION = ("name", "unit", "reference", "note", "derived", "low", "high")
CORRELATION = ("first", "second", "coefficient", "why", "source")
PUBLISHED = ("name", "result", "value", "unit", "where", "settings", "printed")
JUDGED = ("within", "verdict", "obtained", "why")
"""What is said of an unknown before its kind, of a condition, of a correlation, of a printed number about its kind."""


def _named(declared: Any, names: Sequence[str]) -> dict[str, Any]:
    return {name: getattr(declared, name) for name in names}


def _condition(condition: Condition) -> dict[str, Any]:
    return {**_named(condition, CONDITION), "role": condition.does, "rate": condition.rate}


def _tolerance(tolerance: Tolerance) -> dict[str, Any]:
    return {
        "name": tolerance.name,
        "spread": tolerance.spread.text,
        "on": list(tolerance.on),
        **_named(tolerance, ("why", "source")),
        "price": dataclasses.asdict(tolerance.price) if tolerance.price else None,
    }


def _effect(model: Model[Any, Any], effect: Effect[Any, Any]) -> dict[str, Any]:
    return {
        "name": effect.name,
        "acts_on": acts_on(model, effect),
        **_named(effect, ("looks_like", "why", "source")),
        "unknowns": [
            {**_named(unknown, UNKNOWN), "amplitude": unknown.is_amplitude, **_named(unknown, ("whole", "along"))}
            for unknown in effect.unknowns
        ],
        "needs": [need.name for need in effect.needs],
        "parts": [list(part) for part in effect.parts],
    }


def _published(published: Published) -> dict[str, Any]:
    said = {**_named(published, PUBLISHED), "kind": published.rule, **_named(published, JUDGED)}
    return {**said, "settings": dict(published.settings)}


def _objective(objective: Any) -> dict[str, Any]:
    kinds: Mapping[type[Any], str] = {Vary: "vary", Minimise: "minimise", Maximise: "maximise", Require: "require"}
    names = [field.name for field in dataclasses.fields(objective)]
    if isinstance(objective, Require):
        names = ["result", "limit", "reliability", "is_flag"]
    limit = {"limit_kind": objective.kind} if isinstance(objective, Require) else {}
    return {"kind": kinds[type(objective)], **_named(objective, names), **limit}


def sections(said: Mapping[str, Any]) -> dict[str, list[Sequence[str]]]:
    """Return a description as tables for people: rows of texts by title, those that have any."""
    results = [result["name"] for result in said["results"]]
    built_in = [_built_in_row(effect, results) for effect in said["built_in"]["effects"]]
    varied = [effect["name"] for effect in said["built_in"]["where_measured"]]
    measured = [
        row for row in WHERE_MEASURED if any(name.startswith(row[0].removesuffix("_of_INPUT")) for name in varied)
    ]
    tables: dict[str, list[Sequence[str]]] = {
        "Inputs": [_input_row(entry) for entry in said["inputs"]],
        "Results": [
            (result["name"], _symbol(result), _unit(result["unit"]), result["note"]) for result in said["results"]
        ],
        "States": [
            (state["name"], _symbol(state), _unit(state["unit"]), state["note"]) for state in said.get("states", ())
        ],
        "Tolerances": [
            (tolerance["name"], tolerance["spread"], "on " + ", ".join(tolerance["on"]), tolerance["why"])
            for tolerance in said["tolerances"]
        ],
        "Correlations": [
            (pair["first"], f"with {pair['second']}", f"{pair['coefficient']:g}", pair["why"])
            for pair in said["correlations"]
        ],
        "Effects": [_effect_row(effect) for effect in said["effects"]],
        "Conditions": [_condition_row(condition) for condition in said["conditions"]],
        "Built-in effects, on the reading of each RESULT": [*built_in, *measured],
        "Built-in conditions": [_condition_row(condition) for condition in said["built_in"]["conditions"]],
        "Objectives": [(*_objective_words(objective), "", "") for objective in said["objectives"]],
    }
    return {title: rows for title, rows in tables.items() if rows}


def _symbol(described: dict[str, Any]) -> str:
    return symbol_text(described["symbol"]) if described["symbol"] else ""


def _unit(unit: str) -> str:
    return unit_text(unit) or "-"


def _input_row(described: dict[str, Any]) -> tuple[str, ...]:
    default = described["default"]
    if "from" in described:
        default = f"from {described['from']['calculation']}"
    elif default == [] or (default is None and described["optional"]):
        default = "optional"
    elif isinstance(default, list) and len(default) > LONGEST_SERIES:
        default = f"{default[0]} .. {default[-1]}, {len(default)} values"
    unit = " | ".join(described["choices"]) or ("a file" if described["kind"] == "file" else _unit(described["unit"]))
    options = f"options: {', '.join(described['options'])}" if described["options"] else ""
    note = "; ".join(text for text in (described["note"], described["bounds"], options, described["source"]) if text)
    return (described["name"], _symbol(described), "" if default is None else str(default), unit, note)


def _condition_row(condition: dict[str, Any]) -> tuple[str, ...]:
    made = f"made: {condition['derived']}" if condition["derived"] else ""
    goes = {"goes_on": "only goes on", "follows": "follows from others"}.get(condition["role"], "")
    rate = f", by {condition['rate']} times time" if condition["rate"] else ""
    words = "; ".join(text for text in (condition["note"], made, f"{goes}{rate}") if text)
    return (condition["name"], f"reference {condition['reference']:g}", _unit(condition["unit"]), words)


def _built_in_row(effect: dict[str, Any], results: list[str]) -> tuple[str, ...]:
    """Name the unknowns of any result by those of the first."""
    first = effect["parts"][0]
    own = max((name for name in results if all(one.startswith(name) for one in first)), key=len)
    unknowns = ", ".join("RESULT" + name.removeprefix(own) for name in first)
    needs = "needs " + ", ".join(effect["needs"]) if effect["needs"] else ""
    return (effect["name"], unknowns, needs, effect["looks_like"])


def _effect_row(effect: dict[str, Any]) -> tuple[str, ...]:
    unknowns = ", ".join(
        f"{one['name']} {one['low']:g}..{one['high']:g} {_unit(one['unit'])}" for one in effect["unknowns"]
    )
    needs = "needs " + ", ".join(effect["needs"]) if effect["needs"] else ""
    return (effect["name"], f"on {effect['acts_on']}", unknowns, needs, effect["looks_like"])


def _objective_words(objective: dict[str, Any]) -> tuple[str, str]:
    if objective["kind"] == "vary":
        return f"vary {objective['input']}", objective["by"] or f"{objective['low']} .. {objective['high']}"
    if objective["kind"] == "require":
        goal = f" with reliability {objective['reliability']}" if objective["reliability"] is not None else ""
        return (
            f"require {objective['result']}",
            f"{objective['limit_kind'].replace('_', ' ')} {objective['limit']}{goal}",
        )
    return f"{objective['kind']} {objective['result']}", ""
