"""Options of a study that an inputs file may set: its dataclass fields, with the types they are annotated with."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Sequence
from typing import Any, get_origin, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic.errors import PydanticUserError

from truing.declare.model import Study
from truing.inputs_file.values import written


def options_of(study: Study) -> dict[str, Any]:
    """Return the type of every option by name; functions and the study's own name are none."""
    if not dataclasses.is_dataclass(study):
        return {}
    return {
        item.name: _hint(type(study), item, getattr(study, item.name))
        for item in dataclasses.fields(study)
        if item.init and item.name not in {"name", "gives"} and not callable(getattr(study, item.name))
    }


def _hint(owner: type[Any], item: dataclasses.Field[Any], value: Any) -> Any:
    """Return the annotation, or the type of the present value where the annotation names what is not imported."""
    if not isinstance(item.type, str):
        return item.type

    class Holder:
        pass

    Holder.__annotations__ = {item.name: item.type}
    try:
        return get_type_hints(Holder, globalns=vars(sys.modules[owner.__module__]))[item.name]
    except NameError:
        return type(value) if value is not None else Any


def read_option(study: Study, name: str, hint: Any, raw: Any) -> Any:
    """Return an option as the study wants it. Raises ValueError with one sentence."""
    if isinstance(raw, bool) and not _takes_bool(hint):
        raise ValueError(f"study '{study.name}': {name} = {written(raw)} is no {_spoken(hint)}")
    try:
        config = None if dataclasses.is_dataclass(hint) else ConfigDict(arbitrary_types_allowed=True)
        value = TypeAdapter(hint, config=config).validate_python(raw)
    except ValidationError as error:
        raise ValueError(f"study '{study.name}': {_wrong(name, hint, raw, error)}") from None
    except PydanticUserError:
        raise ValueError(f"study '{study.name}': {name} cannot be set in a file") from None
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"study '{study.name}': {name} is not a finite number")
    if isinstance(value, int) and abs(value) >= 2**63:
        raise ValueError(f"study '{study.name}': {name} is too large")
    return value


def _takes_bool(hint: Any) -> bool:
    return hint is Any or hint is bool or bool in getattr(hint, "__args__", ())


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


def option_schema(hint: Any) -> dict[str, Any]:
    """Return the JSON Schema of an option's type; an empty one where the type has none."""
    try:
        config = None if dataclasses.is_dataclass(hint) else ConfigDict(arbitrary_types_allowed=True)
        return TypeAdapter(hint, config=config).json_schema()
    except (PydanticUserError, TypeError):
        return {}
