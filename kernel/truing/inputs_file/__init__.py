"""The inputs file: TOML to a checked Setup; every fault of the file at once, each with its line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from truing.errors import InputError
from truing.inputs_file import assemble
from truing.inputs_file.assemble import names_stated, part_faults
from truing.inputs_file.document import UNREADABLE, InputsDocument, apply_overrides, read_document
from truing.inputs_file.file_model import file_model
from truing.inputs_file.files import read_text
from truing.inputs_file.sentences import each, faults_of, in_order
from truing.inputs_file.values import InputsRead
from truing.kernel import Offer
from truing.setup import Setup
from truing.units.grammar import shown

__all__ = ["json_schema", "read_setup", "setup_from_settings", "setup_from_text"]


def read_setup(path: Path, offer: Offer, *, overrides: Sequence[str] = (), label: str = "--set") -> Setup:
    """Read an inputs file for this calculation.

    ``overrides`` are "name=value" as given with ``--set``: names of inputs or conditions, or dotted names such as
    "tolerances.load", "effects.running_in.extra" and "studies.reliability.draws"; faults of these begin with ``label``.
    Raises InputError with every fault of file and overrides.
    """
    text = read_text(path, instead=f"`calc init {offer.name}` writes an example")
    document = read_document(text, str(path))
    apply_overrides(document, offer.model, overrides, label)
    return _setup(document, offer, path.parent)


def setup_from_text(
    text: str, offer: Offer, *, file: str, folder: Path, overrides: Sequence[str] = (), label: str = "--set"
) -> Setup:
    """Read the text of an inputs file; data files are looked for in ``folder``. Raises InputError with every fault."""
    document = read_document(text, file)
    apply_overrides(document, offer.model, overrides, label)
    return _setup(document, offer, folder)


def setup_from_settings(offer: Offer, settings: Mapping[str, str]) -> Setup:
    """Return the defaults with these settings, named as with ``--set``. Raises InputError with every fault."""
    document = InputsDocument("settings")
    apply_overrides(document, offer.model, [f"{name}={value}" for name, value in settings.items()], "settings")
    return _setup(document, offer, Path())


def json_schema(offer: Offer) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of this calculation's inputs files, for editors that complete TOML."""
    schema = file_model(offer.model).model_json_schema(by_alias=True)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"{offer.name}: {offer.model.title}"}
    return {**head, **{key: value for key, value in schema.items() if key != "title"}}


def _setup(document: InputsDocument, offer: Offer, folder: Path) -> Setup:
    reading = InputsRead(folder)
    faults, more = document.faults, 0
    unreadable = _prune(document.data, ())
    _switch_off(document.data)
    reading.stated.update(names_stated(document.data, unreadable))
    document.data.setdefault("inputs", {})
    try:
        file_model(offer.model).model_validate(document.data, context=reading)
    except ValidationError as error:
        listed, more = faults_of(error, document, offer.model, unreadable)
        faults += listed
    late = [
        *reading.faults,
        *part_faults(offer.model, reading.stated),
        *_of_plugin(offer, reading),
        *assemble.take_old_names(offer, reading),
        *assemble.unexplained(offer.model, document),
    ]
    studies = assemble.studies_of(offer.model, reading.values, late)
    faults += [*each(late, document), *assemble.spread_faults(offer.model, document, reading.values)]
    if faults:
        raise InputError(in_order(faults, document, more))
    return assemble.make_setup(offer, reading, studies, document)


def _prune(table: dict[str, Any], path: tuple[str, ...]) -> set[tuple[str, ...]]:
    """Take out what was named as a fault while the text was read, and return where it stood."""
    taken: set[tuple[str, ...]] = set()
    for name, value in list(table.items()):
        if value is UNREADABLE:
            del table[name]
            taken.add((*path, name))
        elif isinstance(value, dict) and len(path) < 3:
            taken |= _prune(value, (*path, name))
    return taken


def _switch_off(data: dict[str, Any]) -> None:
    """Take out effects that a file or ``--set effects.NAME=off`` switches off."""
    effects = data.get("effects")
    if isinstance(effects, dict):
        for name in [name for name, value in effects.items() if value == "off"]:
            del effects[name]


def _of_plugin(offer: Offer, reading: Any) -> list[tuple[tuple[str, ...], str]]:
    """Say that a file is for another calculation."""
    named = reading.values.get(("plugin",), offer.name)
    if named in {offer.name, offer.model.name, offer.origin.name}:
        return []
    return [(("plugin",), f"this file is for {shown(named)}; the calculation is '{offer.name}'")]
