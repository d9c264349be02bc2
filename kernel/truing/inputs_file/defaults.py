"""Declared values as an inputs file writes them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from truing.declare.fields import InputField
from truing.declare.specs import Given
from truing.declare.spreads import ByChoice, Drawn, Spread
from truing.inputs_file.values import plain
from truing.units.names import PURE


def default_of(item: InputField) -> Any:
    """Return the default of an input as a TOML value ("120 N", true, "a word"), or None where it has none."""
    default: Any = item.spec.default
    if not isinstance(item.spec, Given):
        return None
    return None if default is None else _stated(default, item)


def _stated(value: Any, item: InputField) -> Any:
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, (int, float)):
        if item.kind == "choice":
            return str(value)
        return value if item.unit in PURE else f"{plain(value)} {item.unit}"
    return [_stated(one.item() if hasattr(one, "item") else one, item) for one in value]


def spread_text(spread: Spread, choose: Mapping[str, Any] | None = None) -> str:
    """Return a spread as a file writes it; of one that follows a choice the chosen branch; nothing for a function."""
    if isinstance(spread, Drawn):
        return ""
    if isinstance(spread, ByChoice):
        branch = (choose or {}).get(spread.chooser)
        return spread_text(spread.chosen(str(branch))) if branch is not None else ""
    return spread.text


def toml_value(value: Any) -> str:
    """Write a value as TOML: texts quoted, numbers so that they read back the same."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{toml_key(key)} = {toml_value(one)}" for key, one in value.items()) + " }"
    return "[" + ", ".join(toml_value(one) for one in value) + "]"


def toml_key(name: str) -> str:
    """Write a name as a TOML key, quoted where it must be."""
    plain_key = bool(name) and all(
        character.isascii() and (character.isalnum() or character in "_-") for character in name
    )
    return name if plain_key else _quoted(name)


def _quoted(text: str) -> str:
    escapes = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(escapes.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in text) + '"'
