"""What an inputs file may hold: its sections, and of each entry what reads it and its JSON Schema for editors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING
from functools import lru_cache, partial
from typing import Any

import numpy as np

from truing.declare.chain import acts_on
from truing.declare.fields import Given, InputField, Loaded
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.declare.spreads import read_spread
from truing.errors import UnitError
from truing.inputs_file.assemble import default_of, renamed, spread_text
from truing.inputs_file.correlations import entry_of_pair
from truing.inputs_file.document import SECTIONS
from truing.inputs_file.study_options import DIAGNOSE, diagnose_section, study_section
from truing.inputs_file.values import (
    SIGMA,
    FileEntry,
    FileSection,
    InputsRead,
    SentenceError,
    bounds_in_words,
    is_number,
    plain,
    read_input,
    read_number,
)  # fmt: skip
from truing.setup import DEFAULT_SEED, NamedColumn
from truing.templating import ENGLISH, languages
from truing.units import check_unit, demand_dimension, difference_unit, from_si, to_si, unit_factor
from truing.units.grammar import shown
from truing.units.names import PURE
from truing.units.systems import UNIT_SYSTEMS

HEAD = {
    "title": "in place of the calculation's own title", "project": "what it is for",
    "document": "number of the document", "drawing": "number of the drawing", "revision": "of the drawing or the sheet",
    "customer": "for whom", "prepared_by": "who signs first", "checked_by": "who signs second",
    "approved_by": "who signs last", "date": "without it the day of the calculation",
    "company": "head of the letter", "address": "below the company",
    "logo": "a picture beside this file: .svg, .png or .jpg",
    "style": "a style sheet beside this file (.css), after Truing's own",
}  # fmt: skip
"""What may stand in the head of the sheet, and what it is."""
DETAILS = ("short", "normal", "full")
PAPERS = ("A4", "letter")


@lru_cache(maxsize=16)
def sections(model: Model[Any, Any]) -> dict[str, FileSection]:
    """Return what the sections of a calculation's inputs files may hold."""
    makers: dict[str, Callable[[Model[Any, Any]], Mapping[str, FileEntry | FileSection]]] = {
        "sheet": _sheet, "inputs": _inputs, "tolerances": _tolerances, "conditions": _conditions,
        "effects": _effects, "calibrated": _calibrated, "studies": _studies, "units": _units,
    }  # fmt: skip
    known = {name: FileSection(name.capitalize(), SECTIONS[name], make(model)) for name, make in makers.items()}
    known["correlations"] = FileSection("Correlations", SECTIONS["correlations"], {}, partial(entry_of_pair, model))
    column = _column(model)
    known["columns"] = FileSection("Columns", SECTIONS["columns"], {}, lambda name: column)
    known["from"] = FileSection("From", SECTIONS["from"], {}, _source)
    return {name: known[name] for name in SECTIONS}


def _source(name: str) -> FileEntry:
    """Return the entry of a calculation that inputs are taken from; what it says is read beforehand."""
    file = {"type": "string", "description": "Its own inputs file; what stands beside it wins."}
    schema = {"type": "object", "properties": {"inputs_file": file}, "description": "Inputs of this calculation."}
    return FileEntry(lambda raw, _: raw, schema)


def whole_file(model: Model[Any, Any]) -> FileSection:
    """Return what an inputs file of a calculation may hold, its sections and what stands above them."""
    schema = {"type": "string", "description": "The calculation this file is for."}
    plugin = FileEntry(partial(_text, "plugin"), schema)
    return FileSection("InputsFile", f"Inputs of {model.name}: {model.title}", {**sections(model), "plugin": plugin})


def _text(name: str, raw: Any, _: InputsRead) -> str:
    if not isinstance(raw, str):
        raise SentenceError(f"{name}: a text in quotation marks is expected")
    return raw


# The head of the sheet: texts, numbers and dates


def _sheet(_: Model[Any, Any]) -> dict[str, FileEntry]:
    entries = {
        name: FileEntry(partial(_head_text, name), {"type": ["string", "number"], "description": _sentence(words)})
        for name, words in HEAD.items()
    }
    detail = {"enum": list(DETAILS), "default": "normal", "description": "How much the sheet shows."}
    paper = {"enum": list(PAPERS), "default": "A4", "description": "What the sheet is printed on."}
    units = {"enum": list(UNIT_SYSTEMS), "description": "The units of all that people read; as declared without it."}
    language = {"enum": languages(), "default": ENGLISH, "description": "The language of the sheet."}
    return {
        **entries,
        "detail": FileEntry(partial(_one_of, "detail", DETAILS), detail),
        "paper": FileEntry(partial(_one_of, "paper", PAPERS), paper),
        "units": FileEntry(partial(_one_of, "units", UNIT_SYSTEMS), units),
        "language": FileEntry(partial(_one_of, "language", languages()), language),
    }


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."


def _head_text(name: str, raw: Any, reading: InputsRead) -> str:
    return _text(name, raw if isinstance(raw, (bool, list, dict)) else str(raw), reading)


def _one_of(name: str, words: Sequence[str], raw: Any, _: InputsRead) -> str:
    if raw not in words:
        meant = near_miss(raw[:80], words) if isinstance(raw, str) else ""
        raise SentenceError(f"{name}: choose {', '.join(words[:-1])} or {words[-1]}.{meant}")
    return str(raw)


# Inputs, and those that are fitted to one machine


def _inputs(model: Model[Any, Any]) -> dict[str, FileEntry]:
    entries = {name: _input(field) for name, field in model.input_fields.items()}
    for old, new in renamed(model).items():
        if old not in entries and new in model.input_fields:
            entry = _input(model.input_fields[new])
            entries[old] = FileEntry(
                entry.read, {**entry.schema, "deprecated": True, "description": f"Now called {new}."}
            )
    return entries


def _calibrated(model: Model[Any, Any]) -> dict[str, FileEntry]:
    return {name: _input(field) for name, field in model.input_fields.items() if field.varies}


def _input(field: InputField) -> FileEntry:
    schema: dict[str, Any] = {"description": described(field), **_type_of(field)}
    default = default_of(field)
    if default is not None:
        schema["default"] = default
    extra = {"x-symbol": field.symbol, "x-unit": field.unit}
    schema |= {key: value for key, value in extra.items() if value}
    is_required = isinstance(field.spec, Loaded) and field.spec.default is MISSING
    return FileEntry(partial(read_input, field), schema, is_required)


def described(field: InputField) -> str:
    """Say in one line what an input is: symbol, note, bounds, source."""
    parts = [
        f"{field.symbol}: {field.spec.note}" if field.symbol and field.spec.note else field.symbol or field.spec.note
    ]
    parts += [bounds_in_words(field), "optional" if field.is_optional else ""]
    parts += [f"source: {field.spec.source}" if field.spec.source else ""]
    return "; ".join(part for part in parts if part)


def _type_of(field: InputField) -> dict[str, Any]:
    if field.varies:
        number = _number_type(field)
        kinds = number["type"] if isinstance(number["type"], list) else [number["type"]]
        return {**number, "type": [*kinds, "object"], "required": ["from"]}  # a table names another calculation
    if field.kind == "integer":
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


# Tolerances; what one resolves to is checked when the nominals are known


def _tolerances(model: Model[Any, Any]) -> dict[str, FileEntry]:
    return {
        name: FileEntry(partial(_read_tolerance, tolerance), _tolerance_schema(tolerance))
        for name, tolerance in model.tolerances.items()
    }


def _read_tolerance(tolerance: Tolerance, raw: Any, _: InputsRead) -> Any:
    if not isinstance(raw, (str, dict)):
        raise SentenceError(f"{tolerance.name}: a tolerance is a text such as '±0.05 mm', 'sd 3 %', 'IT6' or 'off'")
    try:
        return read_spread(raw, tolerance.spread)
    except UnitError as error:
        raise SentenceError(f"{tolerance.name}: {error}") from None


def _tolerance_schema(tolerance: Tolerance) -> dict[str, Any]:
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


# Conditions


def _conditions(model: Model[Any, Any]) -> dict[str, FileEntry]:
    return {name: _condition(condition) for name, condition in model.known_conditions.items()}


def _condition(condition: Condition) -> FileEntry:
    def read(raw: Any, _: InputsRead) -> float:
        return read_number(condition.name, raw, condition.unit)

    reference = f"{plain(condition.reference)} {condition.unit}".strip()
    kind: Any = ["number", "string"] if condition.unit in PURE else "string"
    words = f"{condition.note or 'a condition'}; effects vanish at {reference}"
    return FileEntry(read, {"type": kind, "description": words, "default": reference})


# Effects that are on: their unknowns, and how sure these are


def _effects(model: Model[Any, Any]) -> dict[str, FileSection]:
    return {name: _effect(model, effect) for name, effect in model.known_effects.items()}


def _effect(model: Model[Any, Any], effect: Effect[Any, Any]) -> FileSection:
    entries = {
        unknown.name: FileEntry(partial(_read_unknown, unknown), _unknown_schema(unknown), not effect.parts)
        for unknown in effect.unknowns
    }
    entries.setdefault("covariance", FileEntry(partial(_read_covariance, effect), _covariance_schema(effect)))
    alone = "what is left out is off" if effect.parts else ""
    words = (
        effect.why or effect.looks_like or effect.name,
        f"acts on the {acts_on(model, effect)}",
        effect.source,
        alone,
    )
    return FileSection(f"Effect {effect.name}", "; ".join(word for word in words if word), entries)


def _unknown_schema(unknown: Unknown) -> dict[str, Any]:
    bounds = f"from {plain(unknown.low)} to {plain(unknown.high)} {unknown.unit}".strip()
    value = {"type": ["number", "string"] if unknown.unit in PURE else "string"}
    table = {"type": "object", "properties": {"value": value, "sd": value}, "required": ["value"]}
    words = "; ".join(word for word in (unknown.note, bounds, "a whole number" if unknown.whole else "") if word)
    return {"anyOf": [value, {**table, "additionalProperties": False}], "description": words, "x-unit": unknown.unit}


def _read_unknown(unknown: Unknown, raw: Any, _: InputsRead) -> tuple[float, float | None]:
    """Take "5 um" or {value = "5 um", sd = "0.3 um"}; the bounds must hold."""
    table = raw if isinstance(raw, dict) else {"value": raw}
    if "value" not in table or set(table) - {"value", "sd"}:
        raise SentenceError(f'{unknown.name} is written "value unit" or {{ value = "...", sd = "..." }}')
    value = read_number(unknown.name, table["value"], unknown.unit)
    _keep_within(unknown, value)
    return value, _sd(unknown, table["sd"]) if "sd" in table else None


def _keep_within(unknown: Unknown, value: float) -> None:
    low, high = to_si(unknown.low, unknown.unit), to_si(unknown.high, unknown.unit)
    slack = 1e-9 * (high - low)
    number = from_si(value, unknown.unit)
    if not low - slack <= value <= high + slack:
        unit = "" if unknown.unit in PURE else f" {unknown.unit}"
        bounds = f"from {plain(unknown.low)} to {plain(unknown.high)}{unit}"
        raise SentenceError(f"{unknown.name} is {number:.12g}{unit}; it must lie {bounds}")
    if unknown.whole and abs(number - round(number)) > 1e-9 * max(1.0, abs(number)):
        raise SentenceError(f"{unknown.name} is {number:.12g}; it must be a whole number")


def _sd(unknown: Unknown, raw: Any) -> float:
    """Return a standard deviation in SI; that of a temperature level is a difference."""
    value = read_number(f"sd of {unknown.name}", raw, difference_unit(unknown.unit))
    if value < 0:
        raise SentenceError(f"sd of {unknown.name} is negative; a standard deviation is 0 or more")
    return value


def _covariance_schema(effect: Effect[Any, Any]) -> dict[str, Any]:
    size = {} if effect.parts else {"minItems": len(effect.unknowns), "maxItems": len(effect.unknowns)}
    which = "unknowns that are given" if effect.parts else "unknowns"
    words = f"Covariance of the {which} in their declared units, in the order they are declared."
    row = {"type": "array", "items": {"type": "number"}, **size}
    return {"type": "array", "items": row, **size, "description": words}


def _read_covariance(effect: Effect[Any, Any], raw: Any, reading: InputsRead) -> tuple[tuple[float, ...], ...]:
    """Take a symmetric matrix over the unknowns that are given, in their declared units."""
    given = reading.stated.get(effect.name, frozenset()) if effect.parts else None
    unknowns = [unknown for unknown in effect.unknowns if given is None or unknown.name in given]
    size = len(unknowns)
    names = ", ".join(f"{unknown.name} [{unknown.unit or '1'}]" for unknown in unknowns)
    rows = raw if isinstance(raw, list) else []
    if len(rows) != size or any(not isinstance(row, list) or len(row) != size for row in rows):
        rows = []
    if not rows or not all(is_number(one) and abs(one) < 1e300 for row in rows for one in row):
        raise SentenceError(f"covariance is a list of {size} rows of {size} numbers, over {names}")
    _keep_possible(rows)
    factors = [unit_factor(unknown.unit) for unknown in unknowns]
    return tuple(tuple(float(one) * factors[i] * factors[j] for j, one in enumerate(row)) for i, row in enumerate(rows))


def _keep_possible(rows: list[list[float]]) -> None:
    """Raise unless a matrix is symmetric and no combination of the unknowns has a negative variance."""
    matrix = np.array(rows, dtype=float)
    if (np.diag(matrix) < 0).any():
        raise SentenceError("covariance holds a negative variance on its diagonal")
    scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
    if (np.abs(matrix - matrix.T) > 1e-9 * scale).any():
        raise SentenceError("covariance is not symmetric")
    if (np.abs(matrix) > scale * (1 + 1e-9)).any():
        raise SentenceError("covariance holds a correlation beyond 1")
    scale[scale == 0] = 1.0
    if np.linalg.eigvalsh(matrix / scale).min() < -1e-8:
        raise SentenceError("covariance gives some combination of the unknowns a negative variance")


# Studies


def _studies(model: Model[Any, Any]) -> dict[str, FileEntry | FileSection]:
    names = [study.name for study in model.studies]
    run = {"type": "array", "items": {"enum": names} if names else {}, "uniqueItems": True}
    seed = {"type": "integer", "minimum": 0, "default": DEFAULT_SEED, "description": "Where the random numbers begin."}
    entries: dict[str, FileEntry | FileSection] = {
        "run": FileEntry(partial(_read_run, names), {**run, "description": "The studies that run, in this order."}),
        "seed": FileEntry(_read_seed, seed),
        **{study.name: study_section(study) for study in model.studies},
    }
    entries.setdefault(DIAGNOSE, diagnose_section(model))
    return entries


def _read_run(names: list[str], raw: Any, _: InputsRead) -> tuple[str, ...]:
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f'run is a list of studies; write run = ["{names[0] if names else ""}"]')
    offered = f"studies of this model: {', '.join(names) or 'none'}"
    for index, name in enumerate(raw):
        if name not in names:
            raise SentenceError(f"run names {shown(name)}, which is no study.{near_miss(name[:80], names)} ({offered})")
        if name in raw[:index]:
            raise SentenceError(f"run names '{name}' twice")
    return tuple(raw)


def _read_seed(raw: Any, _: InputsRead) -> int:
    """Take a seed; zero is one."""
    if isinstance(raw, bool) or not isinstance(raw, int) or not 0 <= raw < 2**63:
        raise SentenceError("seed: a whole number from 0 upwards is expected")
    return raw


# Units in which something is printed


def _units(model: Model[Any, Any]) -> dict[str, FileEntry]:
    declared = {name: field.unit for name, field in model.result_fields.items()}
    for name, field in model.input_fields.items():
        if isinstance(field.spec, Given) and field.spec.unit is not None:
            declared[name] = field.unit
    return {name: _unit(name, unit) for name, unit in declared.items()}


def _unit(name: str, declared: str) -> FileEntry:
    def read(raw: Any, reading: InputsRead) -> str:
        unit = _text(name, raw, reading)
        try:
            demand_dimension(unit, declared)
        except UnitError as error:
            raise SentenceError(f"{name}: {error}") from None
        return unit

    return FileEntry(read, {"type": "string", "default": declared, "description": f"a unit like {declared or '1'}"})


# What columns of files are, whatever the files call them


def _column(model: Model[Any, Any]) -> FileEntry:
    """Return what reads "torque" or { name = "torque", unit = "N m" } behind the name that a file has for a column."""
    declared = {name: field.unit for name, field in model.input_fields.items()}
    declared |= {name: condition.unit for name, condition in model.known_conditions.items()}
    declared |= {name: result.unit for name, result in model.own_result_fields.items()}
    declared |= {f"{SIGMA}{name}": difference_unit(declared[name]) for name in model.measurable}

    def read(raw: Any, _: InputsRead) -> NamedColumn:
        table = {"name": raw} if isinstance(raw, str) else raw
        if not isinstance(table, dict) or set(table) - {"name", "unit"} or not _is_name(table.get("name")):
            wrong = (
                'a column is called by one of the model\'s names: write "torque" or { name = "torque", unit = "N m" }'
            )
            dotted = (
                "; put what the file calls it in quotation marks where it holds a dot" if isinstance(raw, dict) else ""
            )
            raise SentenceError(wrong + dotted)
        name, unit = table["name"].strip(), table.get("unit")
        try:
            if unit is not None and name in declared:
                demand_dimension(_text(f"unit of {name}", unit, _), declared[name])
            elif unit is not None and unit not in PURE:
                check_unit(_text(f"unit of {name}", unit, _))
        except UnitError as error:
            raise SentenceError(f"{name}: {error}") from None
        return NamedColumn(name, unit)

    properties = {"name": {"type": "string", "examples": list(declared)}, "unit": {"type": "string"}}
    table = {"type": "object", "properties": properties, "required": ["name"], "additionalProperties": False}
    words = "The model's name of the column, with its unit where the file states none, or a wrong one."
    return FileEntry(read, {"anyOf": [{"type": "string"}, table], "description": words})


def _is_name(name: Any) -> bool:
    return isinstance(name, str) and bool(name.strip()) and not set("[]") & set(name)
