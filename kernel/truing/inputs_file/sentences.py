"""What is wrong with an inputs file, in the engineer's words and with the line it stands in."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import isclose
from typing import Any

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import Fault, InfeasibleError, InputError
from truing.inputs_file.document import SECTIONS, InputsDocument
from truing.inputs_file.file_model import HEAD
from truing.setup import Setup
from truing.units.grammar import shown

MOST_FAULTS = 200
_MOST_NEAR_MISSES = 50


def faults_of(
    error: Any, document: InputsDocument, model: Model[Any, Any], unreadable: Collection[tuple[str, ...]]
) -> tuple[list[Fault], int]:
    """Turn a pydantic ValidationError into faults with places; what was named as unreadable is not missing too.

    Sentences are made for the first two hundred in the order of the file; the others are only counted.
    """
    errors = [
        (tuple(map(str, detail["loc"])), detail) for detail in error.errors(include_url=False, include_input=False)
    ]
    kept = [(path, detail) for path, detail in errors if detail["type"] != "missing" or path not in unreadable]
    if len(kept) > MOST_FAULTS:
        kept.sort(key=lambda fault: _order(document, document.place(fault[0])))
    words = _Words(document, model)
    faults = [document.fault(path, words.sentence(path, detail)) for path, detail in kept[:MOST_FAULTS]]
    return faults, len(kept) - len(faults)


def _order(document: InputsDocument, source_line: tuple[str, int | None]) -> tuple[int, int]:
    """Return the order of places: lines of the file, then overrides as given."""
    file, line = source_line
    return (
        document.overrides.index(file) + 1 if file != document.file and file in document.overrides else 0,
        line or 0,
    )


class _Words:
    """Says one fault; near misses are looked for only for the first fifty unknown names."""

    def __init__(self, document: InputsDocument, model: Model[Any, Any]) -> None:
        self.document = document
        self.model = model
        self.near_misses = 0

    def sentence(self, path: tuple[str, ...], detail: Mapping[str, Any]) -> str:
        """Return the sentence for one of pydantic's errors."""
        kind = detail["type"]
        if kind == "extra_forbidden":
            return self.unknown(path)
        if kind == "missing":
            return self.missing(path)
        if kind in {"model_type", "model_attributes_type", "dict_type"}:
            heading = f"[{'.'.join(path)}]"
            return f"{shown(path[-1])} is a section; write {heading} and its entries below it"
        stated = detail.get("ctx", {}).get("error")
        return str(stated) if stated is not None else str(detail["msg"])

    def unknown(self, path: tuple[str, ...]) -> str:
        """Say that a name is unknown, and what was probably meant."""
        name = path[-1]
        self.near_misses += 1
        if len(path) == 1:
            return self.unknown_section(name)
        if path[0] == "effects" and len(path) == 3:
            effect = self.model.known_effects[path[1]]
            unknowns = {unknown.name: unknown for unknown in effect.unknowns}
            many = len(unknowns) > 12
            known = f"`calc describe {self.model.name}` lists them" if many else f"unknowns: {', '.join(unknowns)}"
            return f"effect '{effect.name}' has no unknown {shown(name)}.{self.near(name, unknowns)} ({known})"
        what, known_names = self.known(path[0])
        elsewhere = self.elsewhere(name, path[0])
        if elsewhere:
            return f"{shown(name)} is {elsewhere}"
        meant = self.near(name, known_names)
        hint = "" if meant else self.listed(known_names)
        owner = "the sheet" if path[0] == "sheet" else self.model.name
        return f"{owner} has no {what} {shown(name)}.{meant}{hint}"

    def unknown_section(self, name: str) -> str:
        elsewhere = self.elsewhere(name, "")
        if elsewhere:
            return f"{shown(name)} is {elsewhere}"
        meant = self.near(name, ["plugin", *SECTIONS])
        return f"{shown(name)} is no section of an inputs file.{meant} (sections: {', '.join(SECTIONS)})"

    def known(self, section: str) -> tuple[str, Sequence[str]]:
        """Return what the entries of a section are called and which there are."""
        model = self.model
        studies = ["run", "seed", *(study.name for study in model.studies), "diagnose"]
        return {
            "inputs": ("input", list(model.input_fields)),
            "tolerances": ("tolerance", list(model.tolerances)),
            "conditions": ("condition", list(model.known_conditions)),
            "effects": ("effect", list(model.known_effects)),
            "calibrated": ("input to calibrate called", [n for n, field in model.input_fields.items() if field.varies]),
            "studies": ("study", studies),
            "units": ("result or input", [*model.result_fields, *model.input_fields]),
            "sheet": ("entry", [*HEAD, "detail"]),
        }[section]

    def elsewhere(self, name: str, section: str) -> str:
        """Say where a name belongs that stands in the wrong section."""
        words = {"inputs": "an input", "conditions": "a condition", "effects": "an effect"}
        for other, what in words.items():
            if (
                other != section
                and name in self.known(other)[1]
                and section not in {"tolerances", "units", "calibrated"}
            ):
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


def in_order(faults: Sequence[Fault], document: InputsDocument, more: int = 0) -> list[Fault]:
    """Sort faults by line, those of overrides behind them as given; beyond 200 they are counted, with ``more``."""
    unique = list(dict.fromkeys(sorted(faults, key=lambda fault: _order(document, (fault.file, fault.line)))))
    more += max(len(unique) - MOST_FAULTS, 0)
    return [*unique[:MOST_FAULTS], *([Fault(f"and {more} faults more", document.file)] if more else [])]


def each(faults: Sequence[tuple[tuple[str, ...], str]], document: InputsDocument) -> Iterator[Fault]:
    """Give faults that are known by the path of their name."""
    for path, sentence in faults:
        yield document.fault(path, sentence)


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
