"""Options of a study that an inputs file may set: its dataclass fields, with the types they are annotated with."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import inf
from typing import Any, get_origin, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic.errors import PydanticUserError

from truing.declare.model import Model, Study
from truing.declare.near_miss import near_miss
from truing.errors import UnitError
from truing.inputs_file.values import (
    FileEntry,
    FileSection,
    InputsRead,
    SentenceError,
    StatedValues,
    broken_bound,
    read_number,
    written,
)  # fmt: skip
from truing.setup import DiagnoseOptions, column_and_word
from truing.units import difference_unit, split_quantity
from truing.units.grammar import shown


def options_of(study: Study) -> dict[str, Any]:
    """Return the type of every option by name; functions and the study's own name are none."""
    if not dataclasses.is_dataclass(study):
        return {}
    return {
        field.name: _hint(type(study), field, getattr(study, field.name))
        for field in dataclasses.fields(study)
        if field.init and field.name not in {"name", "gives"} and not callable(getattr(study, field.name))
    }


def _hint(owner: type[Any], option: dataclasses.Field[Any], value: Any) -> Any:
    """Return the annotation, or the type of the present value where the annotation names what is not imported."""
    if not isinstance(option.type, str):
        return option.type

    class Holder:
        pass

    Holder.__annotations__ = {option.name: option.type}
    try:
        return get_type_hints(Holder, globalns=vars(sys.modules[owner.__module__]))[option.name]
    except NameError:
        return type(value) if value is not None else Any


def study_section(study: Study) -> FileSection:
    """Return the options of a study that a file may set."""
    entries = {}
    for name, hint in options_of(study).items():
        value = getattr(study, name)
        default = {"default": value} if isinstance(value, (bool, int, float, str)) else {}
        entries[name] = FileEntry(partial(_read_option, name, hint), {**_option_schema(hint), **default})
    summary = (type(study).__doc__ or "").strip().splitlines()
    return FileSection("", summary[0] if summary else study.name, entries)


def _read_option(name: str, hint: Any, raw: Any, _: InputsRead) -> Any:
    """Return an option as the study wants it. Raises ValueError with one sentence."""
    takes_bool = hint is Any or hint is bool or bool in getattr(hint, "__args__", ())
    if isinstance(raw, bool) and not takes_bool:
        raise SentenceError(f"{name} = {written(raw)} is no {_spoken(hint)}")
    try:
        value = _adapter(hint).validate_python(raw)
    except ValidationError as error:
        raise SentenceError(_wrong(name, hint, raw, error)) from None
    except PydanticUserError:
        raise SentenceError(f"{name} cannot be set in a file") from None
    if isinstance(value, float) and not math.isfinite(value):
        raise SentenceError(f"{name} is not a finite number")
    if isinstance(value, int) and abs(value) >= 2**63:
        raise SentenceError(f"{name} is too large")
    return value


def _adapter(hint: Any) -> TypeAdapter[Any]:
    return TypeAdapter(
        hint, config=None if dataclasses.is_dataclass(hint) else ConfigDict(arbitrary_types_allowed=True)
    )


def _wrong(name: str, hint: Any, raw: Any, error: Any) -> str:
    """Say in one sentence what an option should be; pydantic's own words where the type is not a plain one."""
    if hint in {int, float, str}:
        return f"{name} = {written(raw)} is no {_spoken(hint)}"
    if get_origin(hint) in {tuple, list, Sequence} and not isinstance(raw, (list, str)):
        return f"{name} = {written(raw)} is no list; write {name} = [...]"
    words = error.errors(include_url=False, include_input=False)[0]["msg"]
    return f"{name} = {written(raw)}: {words[:1].lower()}{words[1:]}"


def _spoken(hint: Any) -> str:
    words = {int: "whole number", float: "number", str: "text"}
    return words.get(hint, "value of its kind")


def _option_schema(hint: Any) -> dict[str, Any]:
    """Return the JSON Schema of an option's type; an empty one where the type has none."""
    try:
        return _adapter(hint).json_schema()
    except (PydanticUserError, TypeError):
        return {}


# ``[studies.diagnose]``: what is asked of a diagnosis, checked when the file is read


DIAGNOSE = "diagnose"


def diagnose_options(model: Model[Any, Any], values: StatedValues) -> DiagnoseOptions:
    """Return the options that were read, the others as they are by default; a study of that name has its own."""
    if any(study.name == DIAGNOSE for study in model.studies):
        return DiagnoseOptions()
    return DiagnoseOptions(**{path[2]: value for path, value in values.items() if path[:2] == ("studies", DIAGNOSE)})


@dataclasses.dataclass(frozen=True)
class _Known:
    """The names that an option may hold, with the unit of each, and what a sentence calls one of them."""

    kind: str
    units: Mapping[str, str]

    def demand(self, option: str, name: str) -> None:
        """Raise with a sentence where a name is none of them."""
        if name not in self.units:
            hint = near_miss(name[:80], self.units) or f" (there are: {', '.join(self.units) or 'none'})"
            raise SentenceError(f"{option} names {shown(name)}, which is no {self.kind}.{hint}")


def diagnose_section(model: Model[Any, Any]) -> FileSection:
    """Return what may be asked of a diagnosis."""
    effects, of_model = model.known_effects, f"of {model.name}"
    causes = _competing(model)
    numbers = {name: field.unit for name, field in model.input_fields.items() if field.varies}
    unknowns = [f"{name}.{unknown.name}" for name, effect in effects.items() for unknown in effect.unknowns]
    known = {**dict.fromkeys([*effects, *unknowns], ""), **numbers}
    own = _Known(f"effect, unknown or number among the inputs {of_model}", known)
    conditions = {name: condition.unit for name, condition in model.known_conditions.items()}
    settable = _Known(f"condition and no number among the inputs {of_model}", {**numbers, **conditions})
    units = {name: model.own_result_fields[name].unit for name in model.measurable}
    deviations = {name: f"1 {difference_unit(unit)}".strip() for name, unit in units.items()}
    results = _Known(f"result {of_model} that can be measured in rows", units)
    beyond = "Rows whose true value lies {} what was read, by result: a column of the data and the word it holds there."
    options: dict[str, _Asked] = {
        "causes": ("What competes to explain the record: effects, input:NAME, unknown. Everything where it is empty.",
                   partial(_names, causes), {**_LIST, "items": {"enum": list(causes.units)}}),
        "per_file": ("Effects, single unknowns (effect.unknown) and inputs that every file has for itself.",
                     partial(_names, own), {**_LIST, "items": {"type": "string"}, "examples": [list(effects)[:1]]}),
        "hold_out": ("Rows that only judge, by a column of the data and the word it holds there.",
                     _marked, {"type": "string", "default": "", "examples": ["record = validation"]}),
        "box": ("Where an input or condition can be set, for the next measurement.",
                partial(_by_name, settable, partial(_range, model)),
                _texts({name: f"0..10 {unit}".strip() for name, unit in settable.units.items()})),
        "clipped": ("The ends of a gauge, by result, with a unit; one of them may be left out.",
                    partial(_by_name, results, _ends), _texts(dict.fromkeys(units, "0..10"))),
        "lognormal": ("Results whose errors are in proportion: they are compared as logarithms.",
                      partial(_names, results), {**_LIST, "items": {"enum": list(units)}}),
        "noise": ("Standard deviation of one reading, by result, for an experiment that is planned before any data.",
                  partial(_by_name, results, _deviation), _texts(deviations)),
        "at_least": (beyond.format("above"), partial(_by_name, results, _mark),
                     _texts(dict.fromkeys(units, "outcome = runout"))),
        "at_most": (beyond.format("below"), partial(_by_name, results, _mark),
                    _texts(dict.fromkeys(units, "outcome = below detection"))),
        "budget": ("How many calls of the model on all rows the search may make; 0 leaves it to how long one takes.",
                   _count, {"type": "integer", "minimum": 0, "default": 0, "examples": [1000]}),
    }  # fmt: skip
    return FileSection("", "What is asked of a diagnosis.", {name: _entry(name, *of) for name, of in options.items()})


_Asked = tuple[str, Callable[[str, Any], Any], dict[str, Any]]
"""What an option is for, what reads it, and its schema."""


def _entry(name: str, words: str, read: Callable[[str, Any], Any], schema: Mapping[str, Any]) -> FileEntry:
    return FileEntry(partial(_read_asked, name, read), {**schema, "description": words})


_LIST = {"type": "array", "default": []}


def _competing(model: Model[Any, Any]) -> _Known:
    """Return what may compete to explain a record."""
    tolerated = [f"input:{name}" for tolerance in model.tolerances.values() for name in tolerance.on]
    kind = f"effect of {model.name}, tolerance of it as input:NAME, or 'unknown' for a curve that nobody registered"
    return _Known(kind, dict.fromkeys([*model.known_effects, *tolerated, "unknown"], ""))


def _texts(examples: Mapping[str, str]) -> dict[str, Any]:
    texts = {name: {"type": "string", "examples": [example]} for name, example in examples.items()}
    return {"type": "object", "properties": texts, "additionalProperties": False}


def _read_asked(option: str, read: Callable[[str, Any], Any], raw: Any, _: InputsRead) -> Any:
    return read(option, raw)


def _names(known: _Known, option: str, raw: Any) -> tuple[str, ...]:
    """Take a list of names, each once."""
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f'{option} = {written(raw)} is no list of names; write {option} = ["NAME"]')
    for index, name in enumerate(raw):
        known.demand(option, name)
        if name in raw[:index]:
            raise SentenceError(f"{option} names '{name}' twice")
    return tuple(raw)


def _by_name(known: _Known, read: Callable[[str, str, Any, str], Any], option: str, raw: Any) -> dict[str, Any]:
    """Take a table, each name with what ``read(option, name, text, unit)`` makes of its text."""
    if not isinstance(raw, dict):
        raise SentenceError(f'{option} = {written(raw)} is no table; write {option} = {{ NAME = "..." }}')
    for name in raw:
        known.demand(option, name)
    return {name: read(option, name, text, known.units[name]) for name, text in raw.items()}


def _marked(option: str, raw: Any) -> str:
    """Take "column = word"; nothing marks no row."""
    return "" if isinstance(raw, str) and not raw.strip() else _mark("", option, raw, "")


def _mark(option: str, name: str, raw: Any, _: str) -> str:
    """Take the column and the word by which rows are marked, "column = word"."""
    if not isinstance(raw, str) or not all(column_and_word(raw)):
        owner = f"{option}: " if option else ""
        like = f'{name} = "outcome = runout"'
        raise SentenceError(f"{owner}{name} = {written(raw)} marks no rows; write a column and its word, as in {like}")
    return raw.strip()


def _count(option: str, raw: Any) -> int:
    if not isinstance(raw, int) or isinstance(raw, bool) or raw < 0:
        raise SentenceError(f"{option} = {written(raw)} is no number of calls; write {option} = 1000")
    return raw


def _deviation(option: str, name: str, raw: Any, unit: str) -> float:
    """Take the standard deviation of a result, SI."""
    own = difference_unit(unit)
    try:
        value = float(read_number(name, raw, own))
    except (UnitError, SentenceError) as error:
        raise SentenceError(f"{option}: {error}") from None
    if not value > 0:
        raise SentenceError(f'{option}: {name} = {written(raw)} is no standard deviation; write {name} = "1 {own}"')
    return value


def _range(model: Model[Any, Any], option: str, name: str, raw: Any, unit: str) -> tuple[float, float]:
    """Take the range of an input or condition, in SI, both ends of which keep its bounds."""
    low, high = _ends(option, name, raw, unit, may_be_open=False)
    field = model.input_fields.get(name)
    sentence = "" if field is None else broken_bound(field, low) or broken_bound(field, high)
    if sentence:
        raise SentenceError(f"{option}: {sentence}")
    return low, high


def _ends(option: str, name: str, raw: Any, unit: str, *, may_be_open: bool = True) -> tuple[float, float]:
    """Return "low..high unit" in SI, infinite where an end may be, and is, left out.

    The unit of the upper end holds for a lower one without.
    """
    like = f'"0..10 {unit}"'.replace(' "', '"')
    ends = [end.strip() for end in raw.split("..")] if isinstance(raw, str) else []
    if len(ends) != 2 or not (any(ends) if may_be_open else all(ends)):
        raise SentenceError(f"{option}: {name} = {written(raw)} is no range; write {name} = {like}")
    try:
        common = split_quantity(ends[1]).unit if ends[1] else ""
        ends = [end if not end or split_quantity(end).unit else f"{end} {common}".strip() for end in ends]
        low, high = (
            read_number(name, end, unit) if end else sign * inf for end, sign in zip(ends, (-1, 1), strict=True)
        )
    except (UnitError, SentenceError) as error:
        raise SentenceError(f"{option}: {error}") from None
    if low >= high:
        raise SentenceError(f"{option}: {name} = {written(raw)} goes from its higher end; lower first")
    return low, high
