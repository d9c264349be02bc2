"""calc describe: what a model takes, what it answers, what could make it wrong."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from truing.cli.console import Settings, aligned, out, out_json
from truing.cli.load import find_model
from truing.describe import sections
from truing.inputs_file import json_schema
from truing.texts import one_line


def describe(settings: Settings, *, plugin: str, as_json: bool, as_schema: bool) -> int:
    """Show inputs, results, error sources and objectives: symbols, units, bounds, sources."""
    model = find_model(plugin, settings)
    if as_schema:
        out_json(json_schema(model.offer))
    elif as_json:
        out_json(model.describe())
    else:
        out("\n".join(_lines(model.describe())))
    return 0


def _lines(said: dict[str, Any]) -> Iterator[str]:
    yield f"{said['name']} ({said['plugin']['version'] or 'a file'}): {one_line(said['title'])}"
    if said["summary"]:
        yield one_line(said["summary"])
    for title, rows in sections(said).items():
        yield ""
        yield title
        yield from aligned([("  " + one_line(row[0]), *map(one_line, row[1:])) for row in rows])
    if said["studies"]:
        yield ""
        yield "Studies: " + ", ".join(said["studies"])
    for addition in said["added"]:
        yield f"'{addition['what']}' was added by {addition['plugin']} {addition['version']}"
