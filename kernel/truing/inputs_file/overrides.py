"""What ``--set name=value`` puts in the place of what the file says."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

from truing.declare.model import Model
from truing.errors import Fault
from truing.inputs_file.document import Document
from truing.units.grammar import shown

SECTIONS = ("sheet", "inputs", "tolerances", "conditions", "effects", "calibrated", "studies", "units")


def apply_overrides(document: Document, model: Model[Any, Any], overrides: Sequence[str], label: str) -> None:
    """Write every "name=value" into the document; faults of these are named ``LABEL name=value``."""
    for text in overrides:
        name, equals, value = text.partition("=")
        name, value = name.strip(), value.strip()
        place = f"{label} {_one_line(text)}".strip()
        document.overrides.append(place)
        if not equals or not name:
            document.faults.append(Fault("write name=value, such as load='3 kN'", place))
            continue
        path = _path(name, model)
        if len(path) == 3 and path[0] == "inputs":
            _open_table(document, path[1], place)
        _put(document, path, _value(path, value, model), place)


def _one_line(text: str) -> str:
    return text if text.isprintable() and len(text) <= 120 else shown(text)[1:-1]


def _path(name: str, model: Model[Any, Any]) -> tuple[str, ...]:
    """Return the section and name that a dotted name means; a plain name is an input or a condition.

    Behind the name of an input that is read from a data file stands an option of its reader.
    """
    first, _, rest = name.partition(".")
    if rest and first in SECTIONS:
        if first in {"effects", "studies"}:
            return (first, *rest.split(".", 1))
        return (first, rest)
    if rest and first in model.input_fields and model.input_fields[first].kind == "file":
        return ("inputs", first, rest)
    if name not in model.input_fields and name in model.known_conditions:
        return ("conditions", name)
    if name not in model.input_fields and name in {"seed", "detail"}:
        return ("studies" if name == "seed" else "sheet", name)
    return ("inputs", name)


def _value(path: tuple[str, ...], text: str, model: Model[Any, Any]) -> Any:
    """Return the TOML value that a text on the command line means in this place."""
    item = model.input_fields.get(path[1]) if path[0] in {"inputs", "calibrated"} else None
    as_toml = path[0] == "studies" or (item is not None and item.kind in {"switch", "integer", "series", "file"})
    if not as_toml and not text.startswith(("{", "[", '"', "'")):
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError, KeyError):
        return text


def _open_table(document: Document, name: str, place: str) -> None:
    """Let options stand beside the data file of an input, also where the file is all that was written."""
    inputs = document.data.get("inputs")
    if isinstance(inputs, dict) and isinstance(inputs.get(name), str):
        inputs[name] = {"file": inputs[name]}
    document.places["inputs", name] = (place, None)


def _put(document: Document, path: tuple[str, ...], value: Any, place: str) -> None:
    inner: Any = document.data
    for length, name in enumerate(path[:-1], start=1):
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            return
        document.places.setdefault(path[:length], (place, None))
    inner[path[-1]] = value
    document.places[path] = (place, None)
