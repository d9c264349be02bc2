"""Inputs that a file takes from other calculations: the file of a chain, told as that of one calculation.

``output_torque = { from = "rv_gearing", result = "output_torque", group = 5 }`` stands under [inputs];
[from.rv_gearing] holds further inputs of that calculation, or ``inputs_file``, its own file. ``plugin`` says which
calculation a source is that goes by a name of its own. What is said of a source comes to stand where the chain has it:
its power under [inputs] as ``rv_gearing_power``, each with its own place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from truing.declare.chain import Link, chain_of, prefix_of, renamed_in
from truing.declare.model import Model
from truing.errors import DeclarationError, Fault, UsageError
from truing.inputs_file.document import InputsDocument, KeyPath, read_document
from truing.inputs_file.files import read_text
from truing.kernel import ChainError, Offer, chained_offer, offer_beside
from truing.units.grammar import shown

FROM = "from"
INPUTS_FILE = "inputs_file"
PLUGIN = "plugin"
_LINK = re.compile(rf"\s*\{{(?:.*[,\s])?{FROM}\s*=")
MOST_FILES = 20
"""A chain of more files than this goes in a circle."""
OWN_CONCERN = {"plugin", "sheet", "studies", "columns"}
"""Sections of a source's own file that a chain leaves out: the last calculation decides these."""


Place = tuple[str, int | None]


@dataclass(frozen=True)
class _Said:
    """One value as a file has it, where it stands, and the folder from which its data files are seen."""

    value: Any
    place: Place
    folder: Path


@dataclass
class _Chain:
    """What was gathered of a chain so far: links with their places, and by calculation what is said of each source."""

    offer: Offer
    document: InputsDocument
    told: dict[str, dict[KeyPath, _Said]] = field(default_factory=dict)
    links: dict[Link, Place] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    called: dict[str, str] = field(default_factory=dict)
    """Sources that go by a name of their own, and the calculation that each is."""
    files: int = 0

    def fault(self, sentence: str, place: Place) -> None:
        """Note a fault of the file."""
        self.document.faults.append(Fault(sentence, *place))

    def name_of(self, word: str) -> str:
        """Return the word that first named this calculation; a dot may be written as a line below."""
        if word in self.called:
            return word
        offers = self.offer.beside
        meant = offer_beside(self.offer, word)
        alike = [offers[name] for name in offers if name.replace(".", "_") == word]
        meant = meant or (alike[0] if len(alike) == 1 else None)
        return word if meant is None else self.words.setdefault(meant.name, meant.name if alike else word)

    def offer_of(self, source: str) -> Offer | None:
        """Return the calculation that a source is."""
        return offer_beside(self.offer, self.called.get(source, source))


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
    _read_names(chain, document)
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
    last = chain.offer.beside.get(chain.offer.name, chain.offer)
    if link.owner or link.input in last.model.input_fields:
        return link
    for name in {each.source for each in chain.links}:
        offer = chain.offer_of(name)
        own = link.input.removeprefix(prefix_of(name))
        if offer is not None and own != link.input and own in offer.model.input_fields:
            return replace(link, owner=name, input=own)
    return link


def _place_of(chain: _Chain, link: Link) -> Place:
    alike = (place for each, place in chain.links.items() if (each.owner, each.input) == (link.owner, link.input))
    return next(alike, chain.document.place((FROM, link.owner)))


def _read_names(chain: _Chain, document: InputsDocument) -> None:
    """Note what each source is that goes by a name of its own: ``plugin`` in the braces or under [from.NAME]."""
    own, sources = _tables({"inputs": document.data.get("inputs")}), _tables(document.data.get(FROM))
    links = [raw for table in (*own.values(), *sources.values()) for raw in table.values() if is_taken(raw)]
    stated = [(link[FROM], link[PLUGIN]) for link in links if PLUGIN in link]
    stated += [(word, table[PLUGIN]) for word, table in sources.items() if PLUGIN in table]
    for word, model in stated:
        if not (isinstance(word, str) and isinstance(model, str)) or model == word:
            continue
        if chain.called.setdefault(word, model) != model:
            sentence = f"{shown(word)} is {chain.called[word]} and {model}; give each its own name"
            chain.fault(sentence, document.place((FROM, word)))


def _tables(content: Any) -> dict[str, dict[str, Any]]:
    """Return what is a table in a table; faults of the rest are told where it is read."""
    return {name: each for name, each in content.items() if isinstance(each, dict)} if isinstance(content, dict) else {}


def _read_inputs(chain: _Chain, document: InputsDocument, owner: str, folder: Path) -> None:
    """Gather the inputs of one calculation: links, and for a source what is stated."""
    section = document.data.get("inputs")
    inputs: dict[str, Any] = section if isinstance(section, dict) else {}
    for name, raw in list(inputs.items()):
        path = ("inputs", name)
        said = _Said(raw, document.place(path), folder)
        if is_taken(raw):
            _read_link(chain, owner, name, said)
            if not owner:
                del inputs[name]
        elif owner:
            _state(chain, owner, path, said)


def _read_link(chain: _Chain, owner: str, name: str, said: _Said) -> None:
    source, result = said.value[FROM], said.value.get("result", name)
    if not isinstance(source, str) or not isinstance(result, str):
        like = f'{name} = {{ from = "rv_gearing", result = "output_torque" }}'
        chain.fault(
            f"{name} is taken from a calculation by its name, and from a result of it; write {like}", said.place
        )
        return
    source = chain.name_of(source)
    chain.links[Link(owner, name, source, result, chain.called.get(source, ""))] = said.place
    for key, value in said.value.items():
        if key not in {FROM, PLUGIN, "result"}:
            _state(chain, source, ("inputs", key), replace(said, value=value))


def _read_sources(chain: _Chain, document: InputsDocument, folder: Path, owner: str) -> None:
    """Gather what [from.NAME] says: inputs of sources, and their own files."""
    section = document.data.pop(FROM, {})
    if not isinstance(section, dict):
        chain.fault("[from] holds calculations; write [from.NAME] and its inputs below it", document.place((FROM,)))
        return
    for word, content in section.items():
        path, name = (FROM, word), chain.name_of(word)
        if not isinstance(content, dict):
            sentence = f"{shown(word)} is a section; write [from.{word}] and its inputs below it"
            chain.fault(sentence, document.place(path))
            continue
        for key, raw in content.items():
            _read_entry_of(chain, name, key, _Said(raw, document.place((*path, key)), folder))
        if not any(link.source == name for link in chain.links) and not owner:
            sources = sorted({link.source for link in chain.links})
            named = f"; inputs are taken from {', '.join(sources)}" if sources else ""
            chain.fault(f"no input is taken from {shown(word)}{named}", document.place(path))


def _read_entry_of(chain: _Chain, name: str, key: str, said: _Said) -> None:
    if key == PLUGIN:
        if not isinstance(said.value, str):
            chain.fault(f'{PLUGIN} is the calculation that {shown(name)} is; write {PLUGIN} = "NAME"', said.place)
    elif key == INPUTS_FILE:
        _read_file(chain, name, said)
    elif is_taken(said.value):
        _read_link(chain, name, key, said)
    else:
        _state(chain, name, ("inputs", key), said)


def _read_file(chain: _Chain, name: str, said: _Said) -> None:
    """Gather the inputs file of a source; what stands beside it wins, wherever it stands."""
    chain.files += 1
    if not isinstance(said.value, str) or chain.files > MOST_FILES:
        chain.fault(f'{INPUTS_FILE} is the inputs file of {name}; write {INPUTS_FILE} = "{name}.toml"', said.place)
        return
    file = said.folder / said.value
    try:
        text = read_text(file, instead=f"`calc init {name}` writes an example")
    except UsageError as error:
        chain.fault(f"{INPUTS_FILE} of {name}: {error}", said.place)
        return
    own = read_document(text, str(file))
    chain.document.faults += own.faults
    named = own.data.get("plugin", name)
    stands_for = chain.called.get(name, name)
    if isinstance(named, str) and chain.name_of(named) != chain.name_of(stands_for) and named != stands_for:
        chain.fault(f"this file is for {shown(named)}; it stands here for {stands_for}", own.place(("plugin",)))
        return
    _read_names(chain, own)
    _read_inputs(chain, own, name, file.parent)
    _read_sources(chain, own, file.parent, owner=name)
    for path, value in _entries_of(own):
        _state(chain, name, path, _Said(value, own.place(path), file.parent))


def _entries_of(document: InputsDocument) -> Iterator[tuple[KeyPath, Any]]:
    """Yield what the other sections of a source's own file say; an effect by its unknowns."""
    for section, content in document.data.items():
        if section in OWN_CONCERN or section == "inputs":
            continue
        for key, value in content.items() if isinstance(content, dict) else ():
            if section == "effects" and isinstance(value, dict):
                yield from (((section, key, inner), stated) for inner, stated in value.items())
            else:
                yield (section, key), value


def _state(chain: _Chain, name: str, path: KeyPath, said: _Said) -> None:
    """Note one thing that is said of a source: twice in one file is a fault, and its own file says it last."""
    told = chain.told.setdefault(name, {})
    before = told.get(path)
    if before is None or (said.place[0] == chain.document.file != before.place[0]):
        told[path] = said
    elif before.value != said.value and before.place[0] == said.place[0]:
        line = f" in line {before.place[1]}" if before.place[1] else ""
        sentence = (
            f"{path[-1]} of {name} is {said.value!r} here and {before.value!r}{line}; a source is calculated once, and "
            f'a second one has a name of its own: [from.second] plugin = "{chain.called.get(name, name)}"'
        )
        chain.fault(sentence, said.place)


# What is said of sources, told in the names that the chain has for it


def _tell(chain: _Chain, model: Model[Any, Any]) -> None:
    made = chain_of(model)
    if made is None:
        return
    for name, told in chain.told.items():
        if name not in made.sources:
            continue
        rename = renamed_in(made, name)
        for path, said in told.items():
            value = said.value
            if path[0] == "inputs":
                value = _from_folder(value, made.sources[name], path[-1], said.folder)
            _put(chain.document, _renamed_path(path, prefix_of(name), rename), replace(said, value=value))


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


def _put(document: InputsDocument, path: KeyPath, said: _Said) -> None:
    """Put a value where the chain has it; what the file itself says there stays, but not against ``--set``."""
    inner: Any = document.data
    for name in path[:-1]:
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            return
    if path[-1] not in inner or said.place[0] in document.overrides:
        inner[path[-1]] = said.value
        document.places[path] = said.place
        for length in range(1, len(path)):
            document.places.setdefault(path[:length], said.place)
