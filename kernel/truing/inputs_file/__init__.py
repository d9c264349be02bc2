"""The inputs file: TOML to a checked Setup; every fault of the file at once, each with its line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from truing.errors import InputError
from truing.inputs_file import assemble
from truing.inputs_file.assemble import names_stated, part_faults
from truing.inputs_file.correlations import correlation_faults
from truing.inputs_file.document import InputsDocument, apply_overrides, read_document
from truing.inputs_file.entries import whole_file
from truing.inputs_file.files import read_text
from truing.inputs_file.sentences import in_order, read_entries
from truing.inputs_file.taken import is_link, with_sources
from truing.inputs_file.values import FileEntry, FileSection, InputsRead
from truing.inputs_file.workbook import read_book
from truing.kernel import Offer
from truing.setup import Setup
from truing.units.grammar import shown
from truing.workbooks.reading import is_workbook

__all__ = ["json_schema", "read_setup", "setup_from_settings", "setup_from_text"]


def read_setup(path: Path, offer: Offer, *, overrides: Sequence[str] = (), label: str = "--set") -> Setup:
    """Read an inputs file for this calculation, TOML or a workbook.

    ``overrides`` are "name=value" as given with ``--set``: names of inputs or conditions, or dotted names such as
    "tolerances.load", "effects.running_in.extra" and "studies.reliability.draws"; faults of these begin with ``label``.
    Raises InputError with every fault of file and overrides.
    """
    if is_workbook(path):
        document = read_book(path, offer)
    else:
        text = read_text(path, instead=f"`calc init {offer.name}` writes an example")
        document = read_document(text, str(path))
    return _setup(document, offer, path.parent, overrides, label)


def setup_from_text(
    text: str, offer: Offer, *, file: str, folder: Path, overrides: Sequence[str] = (), label: str = "--set"
) -> Setup:
    """Read the text of an inputs file; data files are looked for in ``folder``. Raises InputError with every fault."""
    return _setup(read_document(text, file), offer, folder, overrides, label)


def setup_from_settings(offer: Offer, settings: Mapping[str, str]) -> Setup:
    """Return the defaults with these settings, named as with ``--set``. Raises InputError with every fault."""
    overrides = [f"{name}={value}" for name, value in settings.items()]
    return _setup(InputsDocument("settings"), offer, Path(), overrides, "settings")


def json_schema(offer: Offer) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of this calculation's inputs files, for editors that complete TOML."""
    known: dict[str, Any] = {}
    whole = whole_file(offer.model)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"{offer.name}: {offer.model.title}",
        "description": whole.words,
        "type": "object",
        "properties": {name: _schema(name, entry, known) for name, entry in whole.entries.items()},
        "additionalProperties": False,
        "$defs": known,
    }


def _schema(name: str, entry: FileEntry | FileSection, known: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of an entry; sections are put into ``known`` by their title and referred to."""
    if isinstance(entry, FileEntry) or not entry.title:
        return {**entry.schema, "title": name}
    title = entry.title.replace(" ", "_")
    properties = {inner: _schema(inner, each, known) for inner, each in entry.entries.items()}
    required = [inner for inner, each in entry.entries.items() if isinstance(each, FileEntry) and each.is_required]
    table = {"type": "object", "title": entry.title, "properties": properties, "additionalProperties": entry.further}
    known[title] = {**table, "required": required} if required else table
    return {"$ref": f"#/$defs/{title}", "description": entry.words, "title": name}


def _setup(document: InputsDocument, offer: Offer, folder: Path, overrides: Sequence[str], label: str) -> Setup:
    links = [text for text in overrides if is_link(text)]
    apply_overrides(document, offer.model, links, label)
    offer = with_sources(document, offer, folder)
    apply_overrides(document, offer.model, [text for text in overrides if text not in links], label)
    reading = InputsRead(folder, stated=names_stated(document.data))
    document.data.setdefault("inputs", {})
    listed, more = read_entries(document, offer.model, reading)
    late = [
        *part_faults(offer.model, reading.stated),
        *_of_plugin(offer, reading),
        *assemble.take_old_names(offer, reading),
        *assemble.unexplained(offer.model, document),
    ]
    studies = assemble.studies_of(offer.model, reading.values, document, late)
    listed += [document.fault(path, sentence) for path, sentence in late]
    faults = [
        *document.faults,
        *listed,
        *assemble.spread_faults(offer.model, document, reading.values),
        *correlation_faults(offer.model, document, reading.values),
    ]
    if faults:
        raise InputError(in_order(faults, document, more))
    return assemble.make_setup(offer, reading, studies, document)


def _of_plugin(offer: Offer, reading: InputsRead) -> list[tuple[tuple[str, ...], str]]:
    named = reading.values.get(("plugin",), offer.name)
    if named in {offer.name, offer.model.name, offer.origin.name}:
        return []
    return [(("plugin",), f"this file is for {shown(named)}; the calculation is '{offer.name}'")]
