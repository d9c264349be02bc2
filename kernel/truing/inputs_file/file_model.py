"""The pydantic model of an inputs file, made from the declaration of a calculation when a file is read.

Every check reads one value to SI and puts it into the ``InputsRead`` that travels as pydantic's context, so that values
that are right are known even where others are wrong. The JSON Schema for editors comes from the same model.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from functools import lru_cache
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, ValidationInfo, WithJsonSchema, create_model

from truing.declare.fields import InputField
from truing.declare.model import Model
from truing.declare.sources import Effect
from truing.declare.specs import Given, Loaded
from truing.inputs_file import checks
from truing.inputs_file.schema_words import (
    condition_schema,
    covariance_schema,
    effect_schema,
    input_schema,
    study_schema,
    tolerance_schema,
    unit_schema,
    unknown_schema,
)
from truing.inputs_file.study_options import NAME, diagnose_schema, of_diagnose
from truing.inputs_file.values import ValueCheck
from truing.setup import DEFAULT_SEED

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


SECTIONS = {
    "sheet": "What the head of the sheet says, and how much the sheet shows.",
    "inputs": "The inputs of the calculation; what is left out is as declared.",
    "tolerances": "How inputs scatter about their nominals.",
    "conditions": "What is measured but no input of the model.",
    "effects": "Effects that are on, by name, each with its unknowns.",
    "calibrated": "Inputs as fitted to one machine.",
    "studies": "Which studies run, in which order, and their options.",
    "units": "The unit in which a result or input is printed.",
}
"""The sections of an inputs file, and what each holds."""


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


def _is_required(item: InputField) -> bool:
    return isinstance(item.spec, Loaded) and item.spec.default is MISSING


def _inputs(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    entries = {
        name: SectionEntry(checks.of_input(item, "inputs"), input_schema(item), _is_required(item))
        for name, item in model.input_fields.items()
    }
    for old, new in checks.renamed(model).items():
        if old not in entries and new in model.input_fields:
            schema = {**input_schema(model.input_fields[new]), "deprecated": True, "description": f"Now called {new}."}
            entries[old] = SectionEntry(checks.of_old_name(old, model.input_fields[new]), schema)
    return entries


def _calibrated(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    varying = {name: item for name, item in model.input_fields.items() if item.varies}
    return {
        name: SectionEntry(checks.of_input(item, "calibrated"), input_schema(item)) for name, item in varying.items()
    }


def _tolerances(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    return {
        name: SectionEntry(checks.of_tolerance(tolerance), tolerance_schema(tolerance))
        for name, tolerance in model.tolerances.items()
    }


def _conditions(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    known = model.known_conditions
    return {name: SectionEntry(checks.of_condition(item), condition_schema(item)) for name, item in known.items()}


def _effects(model: Model[Any, Any]) -> type[BaseModel]:
    fields: dict[str, Any] = {}
    for place, (name, effect) in enumerate(model.known_effects.items()):
        words = effect_schema(effect)["description"]
        section = _section(f"Effect {name}", _effect(effect))
        fields[f"effect_{place}"] = (section, Field(default_factory=dict, alias=name, title=name, description=words))
    return create_model("Effects", __config__=_config(), **fields)


def _effect(effect: Effect[Any, Any]) -> dict[str, SectionEntry]:
    entries = {
        unknown.name: SectionEntry(
            checks.of_unknown(effect, unknown), unknown_schema(unknown), required=not effect.parts
        )
        for unknown in effect.unknowns
    }
    entries.setdefault("covariance", SectionEntry(checks.of_covariance(effect), covariance_schema(effect)))
    return entries


def _studies(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    names = [study.name for study in model.studies]
    run = {"type": "array", "items": {"enum": names} if names else {}, "uniqueItems": True}
    seed = {"type": "integer", "minimum": 0, "default": DEFAULT_SEED, "description": "Where the random numbers begin."}
    entries = {
        "run": SectionEntry(checks.of_run(names), {**run, "description": "The studies that run, in this order."}),
        "seed": SectionEntry(checks.stored(("studies", "seed"), checks.seed), seed),
    }
    for study in model.studies:
        entries[study.name] = SectionEntry(checks.of_study(study), study_schema(study))
    entries.setdefault(NAME, SectionEntry(of_diagnose(model), diagnose_schema(model)))
    return entries


def _units(model: Model[Any, Any]) -> dict[str, SectionEntry]:
    declared = {name: item.unit for name, item in model.result_fields.items()}
    for name, item in model.input_fields.items():
        if isinstance(item.spec, Given) and item.spec.unit is not None:
            declared[name] = item.unit
    return {name: SectionEntry(checks.of_unit(name, unit), unit_schema(unit)) for name, unit in declared.items()}
