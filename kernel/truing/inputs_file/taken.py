"""Inputs that a file takes from other calculations: the file of a chain, told as that of one calculation.

``output_torque = { from = "rv_gearing", result = "output_torque", group = 5 }`` stands under [inputs];
[from.rv_gearing] holds further inputs of that calculation, or ``inputs_file``, its own file. What is said of a source
comes to stand where the chain has it: its power under [inputs] as ``rv_gearing_power``, each with its own place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from truing.declare.chain import Link, chain_of, prefix_of, renamed_in
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import DeclarationError, Fault, UsageError
from truing.inputs_file.document import InputsDocument, KeyPath, read_document
from truing.inputs_file.files import read_text
from truing.kernel import ChainError, Offer, chained_offer, offer_beside
from truing.units.grammar import shown

FROM = "from"
INPUTS_FILE = "inputs_file"
_LINK = re.compile(rf"\s*\{{(?:.*[,\s])?{FROM}\s*=")
MOST_FILES = 20
"""A chain of more files than this goes in a circle."""
OWN_CONCERN = {"plugin", "sheet", "studies", "columns"}
"""Sections of a source's own file that a chain leaves out: the last calculation decides these."""


@dataclass
class _Told:
    """What the files of a chain say of one source: entries by section and name, each with its place and its folder."""

    entries: dict[KeyPath, Any] = field(default_factory=dict)
    places: dict[KeyPath, tuple[str, int | None]] = field(default_factory=dict)
    folders: dict[KeyPath, Path] = field(default_factory=dict)


@dataclass
class _Chain:
    """What was gathered of a chain so far, by the name of the calculation; links with their places."""

    offer: Offer
    document: InputsDocument
    told: dict[str, _Told] = field(default_factory=dict)
    links: dict[Link, tuple[str, int | None]] = field(default_factory=dict)
    files: int = 0

    def fault(self, sentence: str, place: tuple[str, int | None]) -> None:
        self.document.faults.append(Fault(sentence, *place))

    def name_of(self, word: str) -> str:
        """Return the whole name of a calculation, or the word where there is none."""
        offers = self.offer.beside
        meant = offer_beside(self.offer, word)
        written = [name for name in offers if prefix_of(name)[:-1] == word]
        return meant.name if meant is not None else written[0] if len(written) == 1 else word


def is_taken(raw: Any) -> bool:
    """Tell whether an input is stated as one that is taken from another calculation."""
    return isinstance(raw, dict) and FROM in raw


def is_link(override: str) -> bool:
    """Tell whether "name=value" says what an input is taken from, or something of a source."""
    name, _, value = override.partition("=")
    return name.strip().startswith(f"{FROM}.") or bool(_LINK.match(value))


def with_sources(document: InputsDocument, offer: Offer, folder: Path) -> Offer:
    """Return the calculation of a file with all that its inputs are taken from, and tell the document in its names.

    Every fault is noted in the document; then the calculation is as it was.
    """
    inputs = document.data.get("inputs")
    takes = isinstance(inputs, dict) and any(map(is_taken, inputs.values()))
    if FROM not in document.data and not takes:
        return offer
    chain = _Chain(offer, document)
    _read_inputs(chain, document, "", folder)
    _read_sources(chain, document, folder, owner="")
    chain.links = {_with_owner(chain, link): place for link, place in chain.links.items()}
    linked = _linked(chain, list(chain.links))
    _tell(chain, linked.model)
    return linked


def _linked(chain: _Chain, links: list[Link]) -> Offer:
    """Return the calculation with these links; those with faults are left out, so that the rest is still checked."""
    try:
        return chained_offer(chain.offer, links)
    except ChainError as error:
        for link, sentence in error.faults:
            chain.fault(sentence, _place_of(chain, link))
        wrong = {(link.owner, link.input) for link, _ in error.faults}
        left = [link for link in links if (link.owner, link.input) not in wrong]
        return _linked(chain, left) if len(left) < len(links) else chain.offer
    except DeclarationError as error:
        chain.fault(str(error), chain.document.place(("inputs",)))
        return chain.offer


def _with_owner(chain: _Chain, link: Link) -> Link:
    """Return a link whose input is named with the prefix of a source as one of that source."""
    if link.owner or link.input in chain.offer.model.input_fields:
        return link
    for name in {each.source for each in chain.links}:
        offer = offer_beside(chain.offer, name)
        own = link.input.removeprefix(prefix_of(name))
        if offer is not None and own != link.input and own in offer.model.input_fields:
            return replace(link, owner=name, input=own)
    return link


def _place_of(chain: _Chain, link: Link) -> tuple[str, int | None]:
    alike = (place for each, place in chain.links.items() if (each.owner, each.input) == (link.owner, link.input))
    return next(alike, chain.document.place((FROM, link.owner)))


def _read_inputs(chain: _Chain, document: InputsDocument, owner: str, folder: Path) -> None:
    """Gather the inputs of one calculation: links, and for a source what is stated."""
    section = document.data.get("inputs")
    inputs: dict[str, Any] = section if isinstance(section, dict) else {}
    for name, raw in list(inputs.items()):
        path = ("inputs", name)
        if is_taken(raw):
            _read_link(chain, owner, name, raw, document.place(path), folder)
            if not owner:
                del inputs[name]
        elif owner:
            _state(chain, owner, path, raw, document.place(path), folder)


def _read_link(
    chain: _Chain, owner: str, name: str, raw: Mapping[str, Any], place: tuple[str, int | None], folder: Path
) -> None:
    source, result = raw[FROM], raw.get("result", name)
    if not isinstance(source, str) or not isinstance(result, str):
        like = f'{name} = {{ from = "rv_gearing", result = "output_torque" }}'
        chain.fault(f"{name} is taken from a calculation by its name, and from a result of it; write {like}", place)
        return
    source = chain.name_of(source)
    chain.links[Link(owner, name, source, result)] = place
    for key, value in raw.items():
        if key not in {FROM, "result"}:
            _state(chain, source, ("inputs", key), value, place, folder)


def _read_sources(chain: _Chain, document: InputsDocument, folder: Path, owner: str) -> None:
    """Gather what [from.NAME] says: inputs of sources, and their own files."""
    section = document.data.pop(FROM, {})
    if not isinstance(section, dict):
        chain.fault("[from] holds calculations; write [from.NAME] and its inputs below it", document.place((FROM,)))
        return
    for word, said in section.items():
        path = (FROM, word)
        name = chain.name_of(word)
        if not isinstance(said, dict):
            chain.fault(
                f"{shown(word)} is a section; write [from.{word}] and its inputs below it", document.place(path)
            )
            continue
        for key, raw in said.items():
            place = document.place((*path, key))
            if key == INPUTS_FILE:
                _read_file(chain, name, raw, place, folder)
            elif is_taken(raw):
                _read_link(chain, name, key, raw, place, folder)
            else:
                _state(chain, name, ("inputs", key), raw, place, folder)
        if not any(link.source == name for link in chain.links) and not owner:
            sources = sorted({link.source for link in chain.links})
            named = f"; inputs are taken from {', '.join(sources)}" if sources else ""
            chain.fault(f"no input is taken from {shown(word)}{near_miss(word, sources)}{named}", document.place(path))


def _read_file(chain: _Chain, name: str, raw: Any, place: tuple[str, int | None], folder: Path) -> None:
    """Gather the inputs file of a source; what stands beside it wins, for that came first."""
    chain.files += 1
    if not isinstance(raw, str) or chain.files > MOST_FILES:
        chain.fault(f'{INPUTS_FILE} is the inputs file of {name}; write {INPUTS_FILE} = "{name}.toml"', place)
        return
    file = folder / raw
    try:
        text = read_text(file, instead=f"`calc init {name}` writes an example")
    except UsageError as error:
        chain.fault(f"{name}: {error}", place)
        return
    own = read_document(text, str(file))
    chain.document.faults += own.faults
    named = own.data.get("plugin", name)
    if isinstance(named, str) and chain.name_of(named) != name:
        chain.fault(f"this file is for {shown(named)}; it stands here for {name}", own.place(("plugin",)))
        return
    _read_inputs(chain, own, name, file.parent)
    _read_sources(chain, own, file.parent, owner=name)
    for section, content in own.data.items():
        if section in OWN_CONCERN or section == "inputs":
            continue
        for key, value in content.items() if isinstance(content, dict) else [("", content)]:
            if isinstance(value, dict) and section == "effects":
                for inner, stated in value.items():
                    _state(chain, name, (section, key, inner), stated, own.place((section, key, inner)), file.parent)
            else:
                path = (section, key) if key else (section,)
                _state(chain, name, path, value, own.place(path), file.parent)


def _state(
    chain: _Chain, name: str, path: KeyPath, value: Any, place: tuple[str, int | None], folder: Path
) -> None:  # fmt: skip
    """Note one thing that is said of a source; the first word counts, and two that differ in one file are a fault."""
    told = chain.told.setdefault(name, _Told())
    if path not in told.entries:
        told.entries[path], told.places[path], told.folders[path] = value, place, folder
    elif told.entries[path] != value and told.places[path][0] == place[0]:
        line = told.places[path][1]
        before = f"{told.entries[path]!r} in line {line}" if line else repr(told.entries[path])
        chain.fault(f"{path[-1]} of {name} is {value!r} here and {before}; a source is calculated once", place)


# What is said of sources, told in the names that the chain has for it


def _tell(chain: _Chain, model: Model[Any, Any]) -> None:
    made = chain_of(model)
    if made is None:
        return
    for name, told in chain.told.items():
        if name not in made.sources:
            continue
        rename = renamed_in(made, name)
        for path, value in told.entries.items():
            renamed = _renamed_path(path, prefix_of(name), rename)
            if path[0] == "inputs":
                value = _from_folder(value, made.sources[name], path[-1], told.folders[path])
            _put(chain.document, renamed, value, told.places[path])


def _renamed_path(path: KeyPath, prefix: str, rename: Callable[[str], str]) -> KeyPath:
    section, *rest = path
    if not rest:
        return path
    if section == "correlations":
        return section, ", ".join(prefix + each.strip() for each in rest[0].split(","))
    if section == "conditions":
        return section, rename(rest[0])
    return section, prefix + rest[0], *rest[1:]


def _from_folder(value: Any, model: Model[Any, Any], name: str, folder: Path) -> Any:
    """Return where a data file lies whose path is as seen from the file of its source."""
    input_field = model.input_fields.get(name)
    if input_field is None or input_field.kind != "file":
        return value
    if isinstance(value, str):
        return {"file": str(folder.resolve() / value)}
    if isinstance(value, dict) and isinstance(value.get("file"), str):
        return {**value, "file": str(folder.resolve() / value["file"])}
    return value


def _put(document: InputsDocument, path: KeyPath, value: Any, place: tuple[str, int | None]) -> None:
    """Put a value where the chain has it, unless the file itself says it there."""
    inner: Any = document.data
    for name in path[:-1]:
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            return
    if path[-1] not in inner:
        inner[path[-1]] = value
        document.places[path] = place
        for length in range(1, len(path)):
            document.places.setdefault(path[:length], place)
