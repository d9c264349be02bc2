"""What is wrong with an inputs file, in the engineer's words and with the line it stands in."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import isclose
from typing import Any

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import Fault, InfeasibleError, InputError
from truing.inputs_file.assemble import renamed
from truing.inputs_file.document import SECTIONS, UNREADABLE, InputsDocument
from truing.inputs_file.entries import sections, whole_file
from truing.inputs_file.values import FileEntry, FileSection, InputsRead
from truing.setup import Setup
from truing.units.grammar import shown

MOST_FAULTS = 200
_MOST_NEAR_MISSES = 50


def read_entries(document: InputsDocument, model: Model[Any, Any], reading: InputsRead) -> tuple[list[Fault], int]:
    """Read every entry of a file into ``reading``; return what is wrong, and how many faults of that are left out.

    Sentences are made for the first two hundred in the order of the file; the others are only counted.
    """
    words = _Words(document, model)
    wrong = list(words.read(document.data, whole_file(model), (), reading))
    if len(wrong) > MOST_FAULTS:
        wrong.sort(key=lambda fault: _order(document, document.place(fault[0])))
    faults = [document.fault(path, sentence or words.unknown(path)) for path, sentence in wrong[:MOST_FAULTS]]
    return faults, len(wrong) - len(faults)


def _order(document: InputsDocument, source_line: tuple[str, int | None]) -> tuple[int, int]:
    """Return the order of places: lines of the file, then overrides as given."""
    file, line = source_line
    return (
        document.overrides.index(file) + 1 if file != document.file and file in document.overrides else 0,
        line or 0,
    )


_CALLED = {
    "inputs": "input", "tolerances": "tolerance", "conditions": "condition", "effects": "effect",
    "calibrated": "input to calibrate called", "studies": "study", "units": "result or input", "sheet": "entry",
}  # fmt: skip
"""What the entries of a section are called."""


class _Words:
    """Says what is wrong; near misses are looked for only for the first fifty unknown names."""

    def __init__(self, document: InputsDocument, model: Model[Any, Any]) -> None:
        self.document = document
        self.model = model
        self.near_misses = 0

    def read(
        self, table: Mapping[str, Any], section: FileSection, path: tuple[str, ...], reading: InputsRead
    ) -> Iterator[tuple[tuple[str, ...], str]]:
        """Read a table into ``reading``; give what is wrong by path, without a sentence where a name is unknown.

        Nothing more is said of what was a fault of its spelling, and an effect may be "off".
        """
        passed_over = [UNREADABLE, "off"] if path == ("effects",) else [UNREADABLE]
        entries = section.entries
        if section.any_name is not None:
            entries = {name: section.any_name(name) for name in table}
        for name, entry in entries.items():
            here = (*path, name)
            if name not in table:
                if isinstance(entry, FileEntry) and entry.is_required:
                    yield here, self.missing(here)
            elif table[name] in passed_over:
                continue
            elif isinstance(entry, FileEntry):
                yield from _read_entry(here, entry, table[name], reading)
            elif isinstance(table[name], dict):
                yield from self.read(table[name], entry, here, reading)
            elif path == ("studies",):
                yield here, f"[studies.{name}] is a section; write its options below it"
            else:
                yield here, f"{shown(name)} is a section; write [{'.'.join(here)}] and its entries below it"
        strange = [name for name in table if name not in entries and table[name] not in passed_over]
        yield from (((*path, name), "") for name in strange)

    def unknown(self, path: tuple[str, ...]) -> str:
        """Say that a name is unknown, and what was probably meant."""
        name = path[-1]
        self.near_misses += 1
        if len(path) == 3:
            return self.unknown_inside(path)
        section = path[0] if len(path) == 2 else ""
        elsewhere = self.elsewhere(name, section)
        if elsewhere:
            return f"{shown(name)} is {elsewhere}"
        if not section:
            meant = self.near(name, ["plugin", *SECTIONS])
            return f"{shown(name)} is no section of an inputs file.{meant} (sections: {', '.join(SECTIONS)})"
        known = self.known(section)
        meant = self.near(name, known)
        hint = "" if meant else self.listed(known)
        owner = "the sheet" if section == "sheet" else self.model.name
        return f"{owner} has no {_CALLED[section]} {shown(name)}.{meant}{hint}"

    def unknown_inside(self, path: tuple[str, ...]) -> str:
        """Say that an effect has no such unknown, or a study no such option."""
        section, owner, name = path
        if section == "studies":
            known = list(sections(self.model)["studies"].schema["properties"][owner]["properties"])
            meant = near_miss(name[:80], known)
            return f"study '{owner}' has no option {shown(name)}.{meant} (options: {', '.join(known) or 'none'})"
        unknowns = [unknown.name for unknown in self.model.known_effects[owner].unknowns]
        many = len(unknowns) > 12
        listed = f"`calc describe {self.model.name}` lists them" if many else f"unknowns: {', '.join(unknowns)}"
        return f"effect '{owner}' has no unknown {shown(name)}.{self.near(name, unknowns)} ({listed})"

    def known(self, section: str) -> list[str]:
        """Return the entries of a section; not those under an old name."""
        entries = sections(self.model)[section].entries
        old = renamed(self.model) if section == "inputs" else {}
        return [name for name in entries if name not in old or name in self.model.input_fields]

    def elsewhere(self, name: str, section: str) -> str:
        """Say where a name belongs that stands in the wrong section."""
        words = {"inputs": "an input", "conditions": "a condition", "effects": "an effect"}
        for other, what in words.items():
            if other != section and section not in {"tolerances", "units", "calibrated"} and name in self.known(other):
                heading = f"[effects.{name}]" if other == "effects" else f"[{other}]"
                return f"{what}; write it under {heading}"
        if section in {"", "inputs", "conditions"} and name in self.model.result_fields:
            return "a result; it is calculated, not stated"
        if section == "tolerances" and name in self.model.input_fields:
            names = ", ".join(self.model.tolerances) or "none"
            return f"an input without a declared tolerance (tolerances: {names})"
        return ""

    def near(self, name: str, known: Any) -> str:
        """Return the nearest name with its symbol, note and unit, or nothing."""
        if self.near_misses > _MOST_NEAR_MISSES or len(name) > 80:
            return ""
        meant = near_miss(name, list(known)) or near_miss(name.lower(), list(known))
        if not meant:
            return ""
        close = meant.split("'")[1]
        field: Any = self.model.input_fields.get(close) or self.model.result_fields.get(close)
        details = [field.symbol, field.spec.note, field.unit] if field is not None else []
        inside = ", ".join(detail for detail in details if detail)
        return f" Did you mean '{close}' ({inside})?" if inside else meant

    def listed(self, names: Sequence[str]) -> str:
        if len(names) > 12:
            return f" `calc describe {self.model.name}` lists them."
        return f" (there are: {', '.join(names)})" if names else " (there is none)"

    def missing(self, path: tuple[str, ...]) -> str:
        """Say that something is missing, and how it is written."""
        name = path[-1]
        if path[0] == "effects":
            unknown = next(unknown for unknown in self.model.known_effects[path[1]].unknowns if unknown.name == name)
            bounds = f"from {unknown.low:g} to {unknown.high:g} {unknown.unit}".strip()
            return f"effect '{path[1]}' is on, so its unknown '{name}' must be given ({bounds})"
        field = self.model.input_fields[name]
        note = f" ({field.spec.note})" if field.spec.note else ""
        return (
            f"{self.model.name} needs the input '{name}'{note}; write {name} = {{ file = \"data.txt\" }} under [inputs]"
        )


def _read_entry(
    path: tuple[str, ...], entry: FileEntry, raw: Any, reading: InputsRead
) -> Iterator[tuple[tuple[str, ...], str]]:
    if isinstance(raw, dict) and UNREADABLE in raw.values():
        return
    try:
        reading.values[path] = entry.read(raw, reading)
    except ValueError as error:
        owner = f"study '{path[1]}': " if path[0] == "studies" and len(path) == 3 else ""
        yield path, f"{owner}{error}"


def in_order(faults: Sequence[Fault], document: InputsDocument, more: int = 0) -> list[Fault]:
    """Sort faults by line, those of overrides behind them as given; beyond 200 they are counted, with ``more``."""
    unique = list(dict.fromkeys(sorted(faults, key=lambda fault: _order(document, (fault.file, fault.line)))))
    more += max(len(unique) - MOST_FAULTS, 0)
    return [*unique[:MOST_FAULTS], *([Fault(f"and {more} faults more", document.file)] if more else [])]


# Which line is to blame when inputs that are well formed describe something impossible?


@contextmanager
def told_by_line(setup: Setup) -> Iterator[None]:
    """Turn InfeasibleError into InputError that begins with the place of the input most likely to blame."""
    try:
        yield
    except InfeasibleError as error:
        raise InputError([located(setup, str(error))]) from error


def located(setup: Setup, sentence: str) -> Fault:
    """Return what is impossible as a fault at the place of the likeliest input.

    Likely is what is not at its default, then what the sentence names, then what came last: with ``--set``, or farther
    down in the file. Where nothing of this is stated it is the place where the inputs begin.
    """
    names = set(re.findall(r"\w+", sentence))
    changed = _changed(setup)
    stated = [name for name in setup.source.places if name]
    ranked = sorted(enumerate(stated), key=lambda numbered: (numbered[1] in changed, numbered[1] in names, numbered[0]))
    likeliest = ranked[-1][1] if ranked and (ranked[-1][1] in changed or ranked[-1][1] in names) else ""
    return Fault(sentence, *setup.source.places.get(likeliest, ("", None)))


def _changed(setup: Setup) -> set[str]:
    """Return the inputs, conditions and effects that are not as the model has them."""
    fields = setup.model.input_fields
    values = setup.model.read_inputs(setup.inputs)
    changed = {f"effects.{active.effect.name}" for active in setup.effects}
    known = setup.model.known_conditions
    changed |= {name for name, value in setup.conditions.items() if name in known and value != known[name].zero}
    for name in setup.source.places:
        if name in fields and not _is_default(fields[name].spec, values[name]):
            changed.add(name)
    return changed


def _is_default(spec: Any, value: Any) -> bool:
    default = spec.initial() if hasattr(spec, "initial") else None
    if isinstance(value, float) and isinstance(default, (int, float)):
        return isclose(value, default, rel_tol=1e-12) or (value != value and default != default)
    return getattr(value, "ndim", 0) == 0 and bool(value == default)
