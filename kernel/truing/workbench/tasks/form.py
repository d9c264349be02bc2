"""The form of an inputs file: what it asks, what the text beside it states, a change of that text, what is wrong."""

from __future__ import annotations

import hashlib
import json
import textwrap
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from difflib import SequenceMatcher
from functools import lru_cache
from pathlib import Path
from typing import Any

from truing.declare.model import Model
from truing.errors import Fault, InputError, TruingError, UsageError
from truing.example_file import middle_of
from truing.inputs_file import setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.inputs_file.document import InputsDocument, read_document
from truing.inputs_file.entries import sections
from truing.inputs_file.files import LARGEST_INPUTS, refuse_file, text_of
from truing.inputs_file.values import FileEntry, InputsRead
from truing.numbers import STATED_DIGITS, format_difference, format_value, with_unit
from truing.setup import Setup
from truing.units import from_si, read_quantity
from truing.units.names import PURE
from truing.workbench.tasks.fields import Field, FieldGroup, groups_of
from truing.workbench.tasks.loaded import loaded, version_of
from truing.workbench.written import Written, changed_text, literal_in, switched_text

WIDTH = 110
"""Characters of a line beyond which a list of studies is written in several."""
MOST_DIFFERENCES = 200
"""So many places of a conflict are shown."""


def _groups(plugin: str) -> list[FieldGroup]:
    return _made(plugin, version_of(plugin))[0]


def _fields(plugin: str) -> dict[str, Field]:
    return _made(plugin, version_of(plugin))[1]


@lru_cache(maxsize=8)
def _made(plugin: str, version: tuple[int, int]) -> tuple[list[FieldGroup], dict[str, Field]]:
    """Return the form of a calculation, and its fields by their keys."""
    groups = groups_of(loaded(plugin))
    return groups, {each.key: each for group in groups for part in group.parts for each in part.fields}


def opened(path: str, called: str) -> dict[str, Any]:
    """Return the text of a file, the calculation it names, and its digest. Raises InputError with one sentence."""
    file = Path(path)
    try:
        refuse_file(file, largest=LARGEST_INPUTS, instead="`calc init` writes an example", is_table=False)
        content = file.read_bytes()
        text = text_of(content, file).replace("\r\n", "\n")
    except InputError as error:
        raise InputError([Fault(f"{called}: {fault.message}", called, fault.line) for fault in error.faults]) from None
    except OSError as error:
        raise InputError([Fault(f"{called}: cannot be read: {error.strerror}", called)]) from None
    plugin = read_document(text, called).data.get("plugin", "")
    digest = hashlib.sha256(content).hexdigest()
    return {"text": text, "plugin": plugin if isinstance(plugin, str) else "", "digest": digest}


def described(plugin: str) -> dict[str, Any]:
    """Return title and groups of fields of a calculation."""
    model = loaded(plugin).model
    groups = [
        {"title": group.title, "text": group.text, "parts": [part.as_json for part in group.parts]}
        for group in _groups(plugin)
    ]
    return {"title": model.title, "summary": model.summary, "name": model.name, "groups": groups}


def state(
    plugin: str,
    file: str,
    folder: str,
    text: str,
    *,
    saved: str | None = None,
    change: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return a text, changed where that is asked, what it states by field, and what is wrong with it.

    ``change`` holds ``path`` and one of ``value`` (a typed text, a switch, a list of names, None: take it out),
    ``unit`` (state the same in this unit) and ``on`` (an effect on or off). Raises UsageError for one that is none.
    """
    if change is not None:
        text = _changed(plugin, text, saved, change)
    document = read_document(text, file)
    setup: Setup | None = None
    faults: Sequence[Fault] = ()
    try:
        setup = setup_from_text(text, loaded(plugin), file=file, folder=Path(folder))
    except InputError as error:
        faults = error.faults
    except TruingError as error:
        faults = [Fault(str(error))]
    lines = _keys_by_line(document, plugin)
    said = [{**asdict(fault), "key": _key_of(fault, lines)} for fault in faults]
    fields = _stated(plugin, document, Path(folder), Written(text), setup)
    for each in said:
        if each["key"]:
            fields.setdefault(each["key"], {}).setdefault("faults", []).append(each["message"])
    return {"text": text, "fields": fields, "faults": said, "others": list(_others(document, plugin))}


# Changes


def _changed(plugin: str, text: str, saved: str | None, change: Mapping[str, Any]) -> str:
    path = change.get("path")
    if not isinstance(path, list) or not path or not all(isinstance(name, str) for name in path):
        raise UsageError("the change names no path")
    if "on" in change:
        return _switched(loaded(plugin).model, text, saved, path, on=bool(change["on"]))
    field = _fields(plugin).get("/".join(path))
    if field is None:
        raise UsageError(f"the form has no field {json.dumps(path)[:80]}")
    value = change.get("value")
    if "unit" in change:
        value = _converted(field, read_document(text, ""), str(change["unit"]))
    order = [each.path[-1] for each in _fields(plugin).values() if each.path[:-1] == field.path[:-1]]
    place, literal = field.path, None if value is None else literal_of(field, value)
    if field.kind == "file" or (field.path[0] == "inputs" and len(field.path) == 3):
        place = (*field.path[:2], field.path[2] if len(field.path) == 3 else "file")
        if literal is not None and Written(text).holder(place) is None:
            place, literal = place[:2], f"{{ {place[2]} = {literal} }}"
    return changed_text(text, place, literal, saved=saved, order=order)


def _switched(model: Model[Any, Any], text: str, saved: str | None, path: Sequence[str], *, on: bool) -> str:
    effect = model.effects.get(path[-1]) if path[0] == "effects" and len(path) == 2 else None
    if effect is None:
        raise UsageError(f"there is no effect {json.dumps(list(path))[:80]}")
    literals = {
        unknown.name: middle_of(unknown) if unknown.unit in PURE else toml_value(middle_of(unknown))
        for unknown in effect.unknowns
    }
    return switched_text(text, path, literals, on=on, saved=saved)


def literal_of(field: Field, value: Any) -> str:
    """Return what is typed in a field as TOML. Raises UsageError where it is neither text, switch nor list of texts."""
    if isinstance(value, bool):
        return toml_value(value)
    if isinstance(value, list) and all(isinstance(name, str) for name in value):
        inline = toml_value(value)
        if len(inline) <= WIDTH:
            return inline
        return f"[\n{textwrap.indent(textwrap.fill(inline[1:-1] + ',', WIDTH + 6), '    ')}\n]"
    if not isinstance(value, str):
        raise UsageError("a field holds a text, a switch or a list of names")
    may_be_toml = field.kind in {"toml", "number"} or value.lstrip().startswith(("{", "["))
    if not may_be_toml or field.kind in {"text", "choice", "file"} or any(mark in value for mark in "\n\r#"):
        return toml_value(value)
    try:
        read = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return toml_value(value)
    is_number = isinstance(read["value"], (int, float)) and not isinstance(read["value"], bool)
    return value.strip() if is_number or field.kind != "number" else toml_value(value)


def _converted(field: Field, document: InputsDocument, unit: str) -> str:
    """Return the value of a field, stated or default, in another unit."""
    raw = _raw(document.data, field.path)
    typed = field.default if raw is None else raw
    if not isinstance(typed, str) or not typed:
        raise UsageError(f"{field.path[-1]} holds nothing that could be converted; type a value first")
    value = from_si(read_quantity(typed, field.unit), unit)
    number = f"{value:.12g}"
    return f"{number} {unit}"


# What is stated


def _raw(data: Mapping[str, Any], path: Sequence[str]) -> Any:
    """Return what the text states at a path, None where that is nothing."""
    table: Any = data
    for name in path:
        if not isinstance(table, dict) or name not in table:
            return None
        table = table[name]
    return table


def _stated(
    plugin: str, document: InputsDocument, folder: Path, written: Written, setup: Setup | None
) -> dict[str, dict[str, Any]]:
    """Return, by field, what is stated: as typed, in which line, and what it comes to."""
    model, scatter = loaded(plugin).model, setup.distributions() if setup is not None else {}
    answers: dict[str, dict[str, Any]] = {}
    for key, field in _fields(plugin).items():
        raw = _raw(document.data, field.path)
        if field.kind == "file" and isinstance(raw, dict):
            raw = raw.get("file")
        if raw is None:
            continue
        answer = _answer(model, field, raw, folder)
        if field.kind == "tolerance" and setup is not None:
            by_input = scatter.get(field.path[1], {})
            sds = {
                name: with_unit(*format_difference(each.sd, setup.unit_of(name), 4)) for name, each in by_input.items()
            }
            answer = f"sd {next(iter(sds.values()))}" if sds else "off"
        answers[key] = {"value": _shown(raw, field, written), "line": document.place(field.path)[1], "answer": answer}
    for name in model.effects:
        if isinstance(_raw(document.data, ("effects", name)), dict):
            answers[f"effects/{name}"] = {"value": True, "line": document.place(("effects", name))[1], "answer": ""}
    return answers


def _shown(raw: Any, field: Field, written: Written) -> Any:
    """Return a stated value as the field shows it: a number as it is spelled."""
    if isinstance(raw, (str, bool)) or (field.kind == "list" and isinstance(raw, list)):
        return raw
    entry = written.holder(field.path) if isinstance(raw, (int, float)) else None
    if entry is not None:
        spelled = literal_in("\n".join(written.lines_of(entry)), field.path[len(entry.section) :])
        if spelled:
            return spelled
    try:
        return toml_value(raw)
    except TypeError:  # a date
        return str(raw)


def _answer(model: Model[Any, Any], field: Field, raw: Any, folder: Path) -> str:
    """Return the value of a quantity in the declared unit; nothing where it has none or is faulty."""
    if field.kind != "quantity":
        return ""
    entry: Any = sections(model)[field.path[0]]
    for name in field.path[1:]:
        entry = entry.entries.get(name) if not isinstance(entry, FileEntry) else None
    try:
        value = entry.read(raw, InputsRead(folder)) if isinstance(entry, FileEntry) else None
    except ValueError:
        return ""
    number = value[0] if isinstance(value, tuple) else value
    return "" if number is None else f"= {with_unit(*format_value(number, field.unit, STATED_DIGITS))}"


def _keys_by_line(document: InputsDocument, plugin: str) -> dict[int, str]:
    """Return the field, or the effect, that a line is about."""
    known = {*_fields(plugin), *(f"effects/{name}" for name in loaded(plugin).model.effects)}
    lines: dict[int, str] = {}
    for path, (_, line) in sorted(document.places.items(), key=lambda placed: len(placed[0])):
        key = next(("/".join(path[:length]) for length in (3, 2) if "/".join(path[:length]) in known), "")
        if line is not None and key:
            lines[line] = key
    return lines


def _key_of(fault: Fault, lines: Mapping[int, str]) -> str:
    return lines.get(fault.line or 0, "")


def _others(document: InputsDocument, plugin: str) -> Iterator[dict[str, Any]]:
    """Give what the text states that no field of the form is about."""
    known = {each.path for each in _fields(plugin).values()}
    covered = {path[:length] for path in known for length in (1, 2, 3)}
    for path, (_, line) in document.places.items():
        is_leaf = len(path) in {2, 3} and not isinstance(_raw(document.data, path), dict)
        if is_leaf and path not in covered and not any(path[:length] in known for length in (1, 2)):
            yield {"name": ".".join(path), "line": line}


# Two texts


def differences(mine: str, theirs: str) -> list[dict[str, Any]]:
    """Return where two texts differ: the first line and the lines of either."""
    ours, others = mine.split("\n"), theirs.split("\n")
    matcher = SequenceMatcher(None, ours, others)
    changed = [opcode for opcode in matcher.get_opcodes() if opcode[0] != "equal"]
    return [
        {"mine": ours[a:b], "mine_line": a + 1, "theirs": others[c:d], "theirs_line": c + 1}
        for _, a, b, c, d in changed[:MOST_DIFFERENCES]
    ]
