"""What an editor shows of every entry of an inputs file: descriptions, examples, defaults, as JSON Schema."""

from __future__ import annotations

from typing import Any

from truing.declare.fields import InputField
from truing.declare.model import Study
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.inputs_file.assemble import default_of, spread_text
from truing.inputs_file.study_options import option_schema, options_of
from truing.inputs_file.values import bounds_in_words, plain
from truing.units.names import PURE


def described(item: InputField) -> str:
    """Say in one line what an input is: symbol, note, bounds, source."""
    parts = [f"{item.symbol}: {item.spec.note}" if item.symbol and item.spec.note else item.symbol or item.spec.note]
    parts += [bounds_in_words(item), "optional" if item.is_optional else ""]
    parts += [f"source: {item.spec.source}" if item.spec.source else ""]
    return "; ".join(part for part in parts if part)


def input_schema(item: InputField) -> dict[str, Any]:
    """Return the schema of one input."""
    schema: dict[str, Any] = {"description": described(item), **_type_of(item)}
    default = default_of(item)
    if default is not None:
        schema["default"] = default
    extra = {"x-symbol": item.symbol, "x-unit": item.unit}
    return {**schema, **{key: value for key, value in extra.items() if value}}


def _type_of(item: InputField) -> dict[str, Any]:
    if item.kind in {"float", "whole", "integer"}:
        return _number_type(item)
    if item.kind == "choice":
        return {"enum": list(item.choices)}
    if item.kind == "file":
        table = {"type": "object", "properties": {"file": {"type": "string"}}, "required": ["file"]}
        return {"anyOf": [{"type": "string"}, table], "examples": [{"file": "data.txt"}]}
    if item.kind == "series":
        values = {"type": "array", "minItems": 1}
        table = {"type": "object", "properties": {"values": values, "unit": {"type": "string"}}}
        return {"anyOf": [values, table]} if item.unit not in PURE else values
    return {"type": {"switch": "boolean", "text": "string"}[item.kind]}


def _number_type(item: InputField) -> dict[str, Any]:
    if item.unit not in PURE:
        default = default_of(item)
        return {"type": "string", "examples": [default if isinstance(default, str) else f"1 {item.unit}"]}
    spec: Any = item.spec
    bounds = {"exclusiveMinimum": spec.above, "exclusiveMaximum": spec.below}
    bounds |= {"minimum": spec.at_least, "maximum": spec.at_most}
    kind = "integer" if item.kind == "integer" else ["number", "string"]
    return {"type": kind, **{key: bound for key, bound in bounds.items() if bound is not None}}


def tolerance_schema(tolerance: Tolerance) -> dict[str, Any]:
    """Return the schema of one tolerance."""
    zone = {
        "type": "object",
        "properties": {"zone": {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}},
        "required": ["zone"],
        "additionalProperties": False,
    }
    words = "; ".join(part for part in (f"on {', '.join(tolerance.on)}", tolerance.why, tolerance.source) if part)
    schema: dict[str, Any] = {"anyOf": [{"type": "string"}, zone], "description": words}
    declared = spread_text(tolerance.spread)
    schema["examples"] = [one for one in (declared, "±0.05 mm", "sd 3 %", "IT6", "off") if one]
    if declared:
        schema["default"] = declared
    return schema


def condition_schema(condition: Condition) -> dict[str, Any]:
    """Return the schema of one condition."""
    reference = f"{plain(condition.reference)} {condition.unit}".strip()
    words = condition.note or "a condition"
    kind: Any = ["number", "string"] if condition.unit in PURE else "string"
    return {"type": kind, "description": f"{words}; effects vanish at {reference}", "default": reference}


def effect_schema(effect: Effect[Any, Any]) -> dict[str, Any]:
    """Return the words of one effect."""
    alone = "what is left out is off" if effect.parts else ""
    words = (effect.why or effect.looks_like or effect.name, f"acts on the {effect.place}", effect.source, alone)
    return {"description": "; ".join(word for word in words if word)}


def covariance_schema(effect: Effect[Any, Any]) -> dict[str, Any]:
    """Return the schema of the covariance of an effect's unknowns."""
    size = {} if effect.parts else {"minItems": len(effect.unknowns), "maxItems": len(effect.unknowns)}
    which = "unknowns that are given" if effect.parts else "unknowns"
    words = f"Covariance of the {which} in their declared units, in the order they are declared."
    row = {"type": "array", "items": {"type": "number"}, **size}
    return {"type": "array", "items": row, **size, "description": words}


def unknown_schema(unknown: Unknown) -> dict[str, Any]:
    """Return the schema of one unknown of an effect."""
    bounds = f"from {plain(unknown.low)} to {plain(unknown.high)} {unknown.unit}".strip()
    value = {"type": ["number", "string"] if unknown.unit in PURE else "string"}
    table = {"type": "object", "properties": {"value": value, "sd": value}, "required": ["value"]}
    words = "; ".join(word for word in (unknown.note, bounds, "a whole number" if unknown.whole else "") if word)
    return {"anyOf": [value, {**table, "additionalProperties": False}], "description": words, "x-unit": unknown.unit}


def study_schema(study: Study) -> dict[str, Any]:
    """Return the schema of a study's options."""
    properties: dict[str, Any] = {}
    for name, hint in options_of(study).items():
        schema = option_schema(hint)
        value = getattr(study, name)
        if isinstance(value, (bool, int, float, str)):
            schema["default"] = value
        properties[name] = schema
    summary = (type(study).__doc__ or "").strip().splitlines()
    words = summary[0] if summary else study.name
    return {"type": "object", "properties": properties, "additionalProperties": False, "description": words}


def unit_schema(unit: str) -> dict[str, Any]:
    """Return the schema of a unit to print in."""
    return {"type": "string", "default": unit, "description": f"a unit like {unit or '1'}"}
