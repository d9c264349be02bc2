"""The table of fields of a file format, from its JSON Schema.

``python docs/site/manual/formats.py`` writes the tables into the pages.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

FORMATS = Path(__file__).parents[2] / "reference" / "files"
_TABLE = re.compile(r"^\| field \|.*?(?=\n\n|\Z)", re.DOTALL | re.MULTILINE)
Schema = Mapping[str, Any]


def with_table(page: Path) -> str:
    """Return the text of a format's page with the table of its schema in the place of the one that stands there."""
    schema = json.loads(page.with_suffix(".schema.json").read_text(encoding="utf-8"))
    rows = [f"| `{name}` | {kind} | {words} |" for name, kind, words in fields(schema, schema.get("$defs", {}))]
    table = "\n".join(["| field | | |", "|---|---|---|", *rows])
    return _TABLE.sub(lambda _: table, page.read_text(encoding="utf-8"), count=1)


def fields(schema: Schema, shared: Schema, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Give every field below a schema: its path, its kind, and what it says; of shared parts once a short name."""
    optional = set(schema.get("properties", {})) - set(schema.get("required", ()))
    for name, item in schema.get("properties", {}).items():
        place = f"{path}.{name}" if path else name
        words = item.get("description", "")
        yield place, _kind(item), f"{words} (may be absent)" if name in optional and "absent" not in words else words
        yield from _below(item, shared, place)
    rest = schema.get("additionalProperties")
    if isinstance(rest, dict):
        yield from _below(rest, shared, f"{path}.NAME" if path else "NAME")


def _below(item: Schema, shared: Schema, place: str) -> Iterator[tuple[str, str, str]]:
    """Give what is inside of a field: of an object, of the items of a list, of what may also be null."""
    inner = _resolved(item, shared)
    if _name(item) == "quantity":
        return
    if "items" in inner:
        yield from _below(inner["items"], shared, f"{place}[]")
    yield from fields(inner, shared, place)


def _resolved(item: Schema, shared: Schema) -> Schema:
    """Return the schema that an item means: behind a reference, and without the choice of null."""
    known: Schema = shared.get(_name(item), item)
    found: Schema = next((one for one in known.get("anyOf", ()) if one.get("type") != "null"), known)
    return found


def _name(item: Schema) -> str:
    return str(item.get("$ref", "")).rpartition("/")[2]


def _kind(item: Schema) -> str:
    """Say in a word or two what stands there."""
    if "const" in item:
        return f'`"{item["const"]}"`'
    if "enum" in item:
        return ", ".join(f"`{one}`" for one in item["enum"])
    if _name(item) == "quantity":
        return "`value`, `unit`"
    kinds = item.get("type", "")
    words = {"object": "object", "array": "list", "string": "text", "integer": "whole number", "boolean": "yes or no"}
    if isinstance(kinds, list):
        return " or ".join(words.get(str(one), str(one)) for one in kinds)
    if "anyOf" in item:
        return "or null"
    return words.get(str(kinds), str(kinds))


if __name__ == "__main__":
    for page in sorted(FORMATS.glob("*.md")):
        if page.with_suffix(".schema.json").is_file():
            page.write_text(with_table(page), encoding="utf-8")
