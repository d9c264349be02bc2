"""The pydantic model of an inputs file, made from the declaration of a calculation when a file is read.

Every check reads one value to SI and puts it into the ``InputsRead`` that travels as pydantic's context, so that values
that are right are known even where others are wrong. The JSON Schema for editors comes from the same model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from functools import lru_cache, partial
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, ValidationInfo, WithJsonSchema, create_model

from truing.declare.fields import InputField
from truing.declare.model import Model, Study
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.declare.specs import Given, Loaded
from truing.inputs_file import checks
from truing.inputs_file.assemble import default_of, spread_text
from truing.inputs_file.document import SECTIONS
from truing.inputs_file.study_options import NAME, diagnose_schema, of_diagnose, option_schema, options_of
from truing.inputs_file.values import ValueCheck, bounds_in_words, plain
from truing.setup import DEFAULT_SEED
from truing.units.names import PURE

HEAD = (
    "project", "drawing", "revision", "prepared_by", "checked_by", "approved_by", "date", "company", "logo",
)  # fmt: skip
DETAILS = ("short", "normal", "full")


@dataclass(frozen=True)
class SectionEntry:
    """One name of a section: its check, its JSON Schema, and whether it must be there."""

    check: ValueCheck
    schema: Mapping[str, Any]
    required: bool = False


@lru_cache(maxsize=16)
def file_model(model: Model[Any, Any]) -> type[BaseModel]:
    """Make the pydantic model of this calculation's inputs files."""
    entries = _entries(model)
    fields: dict[str, Any] = {}
    for index, (name, words) in enumerate(SECTIONS.items()):
        section = _effects(model) if name == "effects" else _section(name.capitalize(), entries[name])
        fields[f"part_{index}"] = (section, Field(default_factory=dict, alias=name, title=name, description=words))
    plugin = {"type": "string", "description": "The calculation this file is for."}
    fields["part_plugin"] = _field("plugin", SectionEntry(checks.stored("plugin", checks.text), plugin))
    return create_model("InputsFile", __config__=_config(), __doc__=f"Inputs of {model.name}: {model.title}", **fields)


def schemas(model: Model[Any, Any]) -> dict[str, dict[str, Mapping[str, Any]]]:
    """Return the JSON Schema of every name by section; an effect holds those of its unknowns as ``properties``."""
    known = {section: _schemas(entries) for section, entries in _entries(model).items()}
    known["effects"] = {
        name: {**effect_schema(effect), "properties": _schemas(_effect(effect))}
        for name, effect in model.known_effects.items()
    }
    return known


def _schemas(entries: Mapping[str, SectionEntry]) -> dict[str, Mapping[str, Any]]:
    return {name: entry.schema for name, entry in entries.items()}


def _entries(model: Model[Any, Any]) -> dict[str, dict[str, SectionEntry]]:
    """Return the names of every section but that of effects."""
    return {
        "sheet": _sheet(),
        "inputs": _inputs(model),
        "tolerances": _tolerances(model),
        "conditions": _conditions(model),
        "calibrated": _calibrated(model),
        "studies": _studies(model),
        "units": _units(model),
    }


def _config() -> Any:
    return ConfigDict(extra="forbid", arbitrary_types_allowed=True)


def _field(name: str, entry: SectionEntry) -> tuple[Any, Any]:
    def check(value: Any, info: ValidationInfo[Any]) -> Any:
        return entry.check(value, info.context)

    kind = Annotated[Any, PlainValidator(check), WithJsonSchema(dict(entry.schema))]
    if entry.required:
        return kind, Field(alias=name, title=name)
    return kind, Field(default_factory=lambda: None, alias=name, title=name)


def _section(title: str, entries: Mapping[str, SectionEntry]) -> type[BaseModel]:
    """Make the model of one section; fields have neutral names inside, so that no input can clash with pydantic's."""
    fields: dict[str, Any] = {f"entry_{index}": _field(name, one) for index, (name, one) in enumerate(entries.items())}
    return create_model(title, __config__=_config(), **fields)


def _sheet() -> dict[str, SectionEntry]:
    entries = {
        name: SectionEntry(checks.stored(("sheet", name), checks.head_text), {"type": ["string", "number"]})
        for name in HEAD
    }
    schema = {"enum": list(DETAILS), "default": "normal", "description": "How much the sheet shows."}
    check = checks.one_of(DETAILS)
    return {**entries, "detail": SectionEntry(checks.stored(("sheet", "detail"), check), schema)}


def _is_required(field: InputField) -> bool:
    return isinstance(field.spec, Loaded) and field.spec.default is MISSING


def _inputs(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    entries = {
        name: SectionEntry(partial(checks.of_input, ("inputs", name), field), input_schema(field), _is_required(field))
        for name, field in model.input_fields.items()
    }
    for old, new in checks.renamed(model).items():
        if old not in entries and new in model.input_fields:
            schema = {**input_schema(model.input_fields[new]), "deprecated": True, "description": f"Now called {new}."}
            entries[old] = SectionEntry(partial(checks.of_input, ("old names", old), model.input_fields[new]), schema)
    return entries


def _calibrated(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    varying = {name: field for name, field in model.input_fields.items() if field.varies}
    return {
        name: SectionEntry(partial(checks.of_input, ("calibrated", name), field), input_schema(field))
        for name, field in varying.items()
    }


def _tolerances(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    return {
        name: SectionEntry(partial(checks.of_tolerance, tolerance), tolerance_schema(tolerance))
        for name, tolerance in model.tolerances.items()
    }


def _conditions(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    known = model.known_conditions
    return {
        name: SectionEntry(partial(checks.of_condition, condition), condition_schema(condition))
        for name, condition in known.items()
    }


def _effects(model: Model[Any, Any]) -> type[BaseModel]:
    fields: dict[str, Any] = {}
    for index, (name, effect) in enumerate(model.known_effects.items()):
        words = effect_schema(effect)["description"]
        section = _section(f"Effect {name}", _effect(effect))
        fields[f"effect_{index}"] = (section, Field(default_factory=dict, alias=name, title=name, description=words))
    return create_model("Effects", __config__=_config(), **fields)


def _effect(effect: Effect[Any, Any]) -> dict[str, SectionEntry]:
    entries = {
        unknown.name: SectionEntry(
            partial(checks.of_unknown, effect, unknown), unknown_schema(unknown), required=not effect.parts
        )
        for unknown in effect.unknowns
    }
    entries.setdefault("covariance", SectionEntry(partial(checks.of_covariance, effect), covariance_schema(effect)))
    return entries


def _studies(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    names = [study.name for study in model.studies]
    run = {"type": "array", "items": {"enum": names} if names else {}, "uniqueItems": True}
    seed = {"type": "integer", "minimum": 0, "default": DEFAULT_SEED, "description": "Where the random numbers begin."}
    entries = {
        "run": SectionEntry(
            partial(checks.of_run, names), {**run, "description": "The studies that run, in this order."}
        ),
        "seed": SectionEntry(checks.stored(("studies", "seed"), checks.seed), seed),
    }
    for study in model.studies:
        entries[study.name] = SectionEntry(partial(checks.of_study, study), study_schema(study))
    entries.setdefault(NAME, SectionEntry(partial(of_diagnose, model), diagnose_schema(model)))
    return entries


def _units(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    declared = {name: field.unit for name, field in model.result_fields.items()}
    for name, field in model.input_fields.items():
        if isinstance(field.spec, Given) and field.spec.unit is not None:
            declared[name] = field.unit
    return {
        name: SectionEntry(partial(checks.of_unit, name, unit), unit_schema(unit)) for name, unit in declared.items()
    }


# What an editor shows of every entry of an inputs file: descriptions, examples, defaults, as JSON Schema


def described(field: InputField) -> str:
    """Say in one line what an input is: symbol, note, bounds, source."""
    parts = [
        f"{field.symbol}: {field.spec.note}" if field.symbol and field.spec.note else field.symbol or field.spec.note
    ]
    parts += [bounds_in_words(field), "optional" if field.is_optional else ""]
    parts += [f"source: {field.spec.source}" if field.spec.source else ""]
    return "; ".join(part for part in parts if part)


def input_schema(field: InputField) -> dict[str, Any]:
    """Return the schema of one input."""
    schema: dict[str, Any] = {"description": described(field), **_type_of(field)}
    default = default_of(field)
    if default is not None:
        schema["default"] = default
    extra = {"x-symbol": field.symbol, "x-unit": field.unit}
    return {**schema, **{key: value for key, value in extra.items() if value}}


def _type_of(field: InputField) -> dict[str, Any]:
    if field.kind in {"float", "whole", "integer"}:
        return _number_type(field)
    if field.kind == "choice":
        return {"enum": list(field.choices)}
    if field.kind == "file":
        table = {"type": "object", "properties": {"file": {"type": "string"}}, "required": ["file"]}
        return {"anyOf": [{"type": "string"}, table], "examples": [{"file": "data.txt"}]}
    if field.kind == "series":
        values = {"type": "array", "minItems": 1}
        table = {"type": "object", "properties": {"values": values, "unit": {"type": "string"}}}
        return {"anyOf": [values, table]} if field.unit not in PURE else values
    return {"type": {"switch": "boolean", "text": "string"}[field.kind]}


def _number_type(field: InputField) -> dict[str, Any]:
    if field.unit not in PURE:
        default = default_of(field)
        return {"type": "string", "examples": [default if isinstance(default, str) else f"1 {field.unit}"]}
    spec: Any = field.spec
    bounds = {"exclusiveMinimum": spec.above, "exclusiveMaximum": spec.below}
    bounds |= {"minimum": spec.at_least, "maximum": spec.at_most}
    kind = "integer" if field.kind == "integer" else ["number", "string"]
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
