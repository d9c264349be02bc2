"""calc init: a commented inputs file that holds the paper's example, and the schema by which editors complete it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from truing.atomic import write_files
from truing.cli.console import Settings, json_text, out
from truing.cli.load import find_offer
from truing.errors import OutputError
from truing.example_file import example_text, schema_name, with_schema_line
from truing.inputs_file import json_schema


def init(settings: Settings, *, plugin: str, output: Path | None, force: bool, no_schema: bool) -> int:
    """Write a commented inputs file that holds the shipped example."""
    offer = find_offer(plugin, settings)
    text = example_text(offer)
    if output is None:
        out(text.rstrip("\n"))
        return 0
    files = {output: text}
    if not no_schema:
        schema = output.parent / schema_name(offer)
        files = {output: with_schema_line(text, schema.name), schema: json_text(json_schema(offer), indent=None) + "\n"}
    if not force:
        _demand_new(output, files)
    write_files(dict(reversed(files.items())))  # after a death between the two the same command goes on
    settings.say(f"wrote {' and '.join(map(str, files))}; now: calc run {plugin} --inputs {output}")
    return 0


def _demand_new(output: Path, files: Mapping[Path, str]) -> None:
    """Raise OutputError where a file is there already, unless it is a schema that would be the same."""
    if output.exists():
        raise OutputError(f"{output} exists already; choose another name or say --force")
    for path, content in files.items():
        if path.exists() and not _holds(path, content):
            raise OutputError(f"{path} exists already and is another schema; say --force to replace it, or --no-schema")


def _holds(path: Path, content: str) -> bool:
    try:
        return path.read_bytes() == content.encode()
    except OSError:
        return False
