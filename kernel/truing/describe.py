"""A model in words: inputs, results, error sources, objectives, as plain data for people and programs."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping
from typing import Any

from truing.declare.builtin import may_stand
from truing.declare.fields import Axis, Found, Given, InputField, Loaded, ResultField
from truing.declare.goals import Maximise, Minimise, Require, Vary
from truing.declare.published import Published
from truing.declare.sources import Condition
from truing.inputs_file.values import bounds_in_words
from truing.kernel import Offer


def description(offer: Offer) -> dict[str, Any]:
    """Return everything the model declares, as one JSON-ready document."""
    model = offer.model
    built_in = [effect for name, effect in model.known_effects.items() if name not in model.effects]
    return {
        "name": offer.name,
        "title": model.title,
        "summary": model.summary,
        "plugin": {"name": offer.origin.name, "version": offer.origin.version},
        "inputs": [_input(item) for item in model.input_fields.values()],
        "results": [_result(item) for item in model.result_fields.values()],
        "tolerances": [
            {
                "name": item.name,
                "spread": item.spread.text,
                "on": list(item.on),
                "why": item.why,
                "source": item.source,
                "price": dataclasses.asdict(item.price) if item.price else None,
            }
            for item in model.tolerances.values()
        ],
        "effects": [_effect(effect) for effect in model.effects.values()],
        "conditions": [_condition(item) for item in model.conditions.values()],
        "built_in": {
            "effects": [_effect(item) for item in built_in if not may_stand(item)],
            "where_measured": [_effect(item) for item in built_in if may_stand(item)],
            "conditions": [
                _condition(item) for name, item in model.known_conditions.items() if name not in model.conditions
            ],
        },
        "objectives": [_objective(item) for item in model.objectives],
        "studies": [study.name for study in model.studies],
        "sheet": [{"title": section.title, "results": list(section.names)} for section in model.sheet],
        "published": [_published(item) for item in model.published],
        "findings": [dataclasses.asdict(item) for item in model.findings],
        "exceptions": {str(name): reason for name, reason in model.exceptions.items()},
        "cites": list(model.cites),
        "added": [dataclasses.asdict(item) for item in offer.added],
    }


def _input(item: InputField) -> dict[str, Any]:
    spec = item.spec
    default = spec.default if isinstance(spec, Given) else None
    return {
        "name": item.name,
        "symbol": item.symbol,
        "kind": item.kind,
        "unit": item.unit,
        "default": list(default) if isinstance(default, tuple) else default,
        "optional": item.is_optional,
        "choices": list(item.choices),
        "options": list(inspect.signature(spec.reader).parameters)[1:] if isinstance(spec, Loaded) else [],
        "bounds": bounds_in_words(item, with_unit=False),
        "note": spec.note,
        "source": spec.source,
    }


def _result(item: ResultField) -> dict[str, Any]:
    spec = item.spec
    formula = spec.formula if isinstance(spec, Found) else ""
    kind = ("table" if spec.is_table else "axis") if isinstance(spec, Axis) else "result"
    return {
        "name": item.name,
        "symbol": item.symbol,
        "kind": kind,
        "unit": item.unit,
        "note": spec.note,
        "formula": formula,
        "method": spec.method if isinstance(spec, Found) else "",
        "source": spec.source if isinstance(spec, Found) else "",
        "along": item.along if kind == "result" else "",
    }


def _condition(item: Condition) -> dict[str, Any]:
    return {
        "name": item.name,
        "unit": item.unit,
        "reference": item.reference,
        "note": item.note,
        "derived": item.derived,
        "low": item.low,
        "high": item.high,
    }


def _effect(effect: Any) -> dict[str, Any]:
    return {
        "name": effect.name,
        "acts_on": effect.place,
        "looks_like": effect.looks_like,
        "why": effect.why,
        "source": effect.source,
        "unknowns": [
            {
                "name": item.name,
                "low": item.low,
                "high": item.high,
                "unit": item.unit,
                "note": item.note,
                "amplitude": item.is_amplitude,
                "whole": item.whole,
                "along": item.along,
            }
            for item in effect.unknowns
        ],
        "needs": [item.name for item in effect.needs],
        "parts": [list(part) for part in effect.parts],
    }


def _published(item: Published) -> dict[str, Any]:
    return {
        "name": item.name,
        "result": item.result,
        "value": item.value,
        "unit": item.unit,
        "where": item.where,
        "settings": dict(item.settings),
        "printed": item.printed,
        "kind": item.rule,
        "within": item.within,
        "verdict": item.verdict,
        "obtained": item.obtained,
        "why": item.why,
    }


def _objective(item: Any) -> dict[str, Any]:
    kinds: Mapping[type[Any], str] = {Vary: "vary", Minimise: "minimise", Maximise: "maximise", Require: "require"}
    own = {field.name: getattr(item, field.name) for field in dataclasses.fields(item) if field.name != "kind"}
    limit = {"limit_kind": item.kind} if isinstance(item, Require) else {}
    return {"kind": kinds[type(item)], **own, **limit}
