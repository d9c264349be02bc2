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
from truing.units import split_quantity
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


def diagnose_section(model: Model[Any, Any]) -> FileSection:
    """Return what may be asked of a diagnosis."""
    ranges = {name: f"0..10 {unit}".strip() for name, unit in _settable(model).items()}
    results = model.measurable
    beyond = "Rows whose true value lies {} what was read, by result: a column of the data and the word it holds there."
    words = {
        "per_file": "Effects, single unknowns (effect.unknown) and inputs that every file has for itself.",
        "hold_out": "Rows that only judge, by a column of the data and the word it holds there.",
        "box": "Where an input or condition can be set, for the next measurement.",
        "clipped": "The ends of a gauge, by result, with a unit; one of them may be left out.",
        "lognormal": "Results whose errors are in proportion: they are compared as logarithms.",
        "at_least": beyond.format("above"),
        "at_most": beyond.format("below"),
        "budget": "How many calls of the model on all rows the search may make; 0 leaves it to how long one takes.",
    }
    effects = {"items": {"type": "string"}, "examples": [list(model.known_effects)[:1]]}
    kinds: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
        "per_file": (_per_file, {"type": "array", "default": [], **effects}),
        "hold_out": (_hold_out, {"type": "string", "default": "", "examples": ["record = validation"]}),
        "box": (_box, _texts(ranges)),
        "clipped": (_clipped, _texts(dict.fromkeys(results, "0..10"))),
        "lognormal": (_lognormal, {"type": "array", "default": [], "items": {"enum": results}}),
        "at_least": (partial(_marks, "at_least"), _texts(dict.fromkeys(results, "outcome = runout"))),
        "at_most": (partial(_marks, "at_most"), _texts(dict.fromkeys(results, "outcome = below detection"))),
        "budget": (_budget, {"type": "integer", "minimum": 0, "default": 0, "examples": [1000]}),
    }
    entries = {
        name: FileEntry(partial(read, model), {**schema, "description": words[name]})
        for name, (read, schema) in kinds.items()
    }
    return FileSection("", "What is asked of a diagnosis.", entries)


def _texts(examples: Mapping[str, str]) -> dict[str, Any]:
    texts = {name: {"type": "string", "examples": [example]} for name, example in examples.items()}
    return {"type": "object", "properties": texts, "additionalProperties": False}


def _settable(model: Model[Any, Any]) -> dict[str, str]:
    """Return the units of what can be set for a measurement: numbers among the inputs, and conditions."""
    inputs = {name: field.unit for name, field in model.input_fields.items() if field.varies}
    return {**inputs, **{name: known.unit for name, known in model.known_conditions.items()}}


def _per_file(model: Model[Any, Any], raw: Any, _: InputsRead) -> tuple[str, ...]:
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f'per_file = {written(raw)} is no list of names; write ["sensor_offset"]')
    effects = model.known_effects
    unknowns = [f"{name}.{unknown.name}" for name, effect in effects.items() for unknown in effect.unknowns]
    known = [*effects, *unknowns, *(name for name, field in model.input_fields.items() if field.varies)]
    for index, name in enumerate(raw):
        if name not in known:
            near = near_miss(name[:80], known)
            hint = near or f" (effects: {', '.join(effects) or 'none'})"
            raise SentenceError(
                f"per_file names {shown(name)}, which is no effect, unknown or number among the "
                f"inputs of {model.name}.{hint}"
            )
        if name in raw[:index]:
            raise SentenceError(f"per_file names '{name}' twice")
    return tuple(raw)


def _hold_out(model: Model[Any, Any], raw: Any, _: InputsRead) -> str:
    """Take "column = word"; nothing holds no row out."""
    if not isinstance(raw, str):
        raise SentenceError(f'hold_out = {written(raw)} is no text; write "record = validation"')
    if raw.strip() and not all(DiagnoseOptions(hold_out=raw).held_out):
        raise SentenceError(
            f"hold_out = {shown(raw)} names no rows; write a column and the word it holds, "
            'such as "record = validation"'
        )
    return raw.strip()


def _budget(model: Model[Any, Any], raw: Any, _: InputsRead) -> int:
    if not isinstance(raw, int) or isinstance(raw, bool) or raw < 0:
        raise SentenceError(f"budget = {written(raw)} is no number of calls; write budget = 1000")
    return raw


def _box(model: Model[Any, Any], raw: Any, _: InputsRead) -> dict[str, tuple[float, float]]:
    """Take ranges of inputs and conditions, in SI."""
    if not isinstance(raw, dict):
        raise SentenceError(f'box = {written(raw)} is no table; write box = {{ NAME = "0..10 kN" }}')
    known = _settable(model)
    for name in raw:
        if name not in known:
            raise SentenceError(
                f"box names {shown(name)}, which is no condition and no number among the inputs of "
                f"{model.name}.{near_miss(name[:80], known)}"
            )
    box = {}
    for name, text in raw.items():
        box[name] = low, high = _ends("box", name, text, known[name])
        field = model.input_fields.get(name)
        sentence = "" if field is None else broken_bound(field, low) or broken_bound(field, high)
        if sentence:
            raise SentenceError(f"box: {sentence}")
    return box


def _ends(option: str, name: str, raw: Any, unit: str, *, may_be_open: bool = False) -> tuple[float, float]:
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


def _by_result(option: str, raw: Any, model: Model[Any, Any], like: str) -> dict[str, Any]:
    if not isinstance(raw, dict):
        raise SentenceError(f'{option} = {written(raw)} is no table; write {option} = {{ RESULT = "{like}" }}')
    for name in raw:
        _demand_measurable(option, name, model)
    return raw


def _demand_measurable(option: str, name: str, model: Model[Any, Any]) -> None:
    known = model.measurable
    if name not in known:
        hint = near_miss(name[:80], known) or f" (results: {', '.join(known)})"
        said = f"{option} names {shown(name)}, which is no result of {model.name} that can be measured in rows"
        raise SentenceError(f"{said}.{hint}")


def _marks(option: str, model: Model[Any, Any], raw: Any, _: InputsRead) -> dict[str, str]:
    """Take the columns that mark censored readings, "column = word" by result."""
    for name, text in _by_result(option, raw, model, "outcome = runout").items():
        if not isinstance(text, str) or not all(column_and_word(text)):
            raise SentenceError(
                f"{option}: {name} = {written(text)} marks no rows; write a column and the word it "
                f'holds, such as {name} = "outcome = runout"'
            )
    return {name: text.strip() for name, text in raw.items()}


def _clipped(model: Model[Any, Any], raw: Any, _: InputsRead) -> dict[str, tuple[float, float]]:
    fields = model.own_result_fields
    ends = _by_result("clipped", raw, model, "0..10 kN")
    return {name: _ends("clipped", name, text, fields[name].unit, may_be_open=True) for name, text in ends.items()}


def _lognormal(model: Model[Any, Any], raw: Any, _: InputsRead) -> tuple[str, ...]:
    if not isinstance(raw, list) or not all(isinstance(name, str) for name in raw):
        raise SentenceError(f'lognormal = {written(raw)} is no list of results; write ["life"]')
    for name in raw:
        _demand_measurable("lognormal", name, model)
    return tuple(dict.fromkeys(raw))
