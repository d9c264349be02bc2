"""TOML text to data, with the line of every name; a broken line does not hide the faults of the others.

Every statement is read on its own, so that its line is known, all broken ones are named at once and the rest is still
checked. ``tomllib`` has the last word on what is valid and what it says.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from truing.declare.model import Model
from truing.errors import Fault
from truing.units.grammar import shown

KeyPath = tuple[str, ...]

# An unclosed quotation mark takes the rest of its line with it: a scan that fails there and tries again at the next
# character takes a time that grows with the square of the text.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:\\.|[^"\\\n])*+"|'[^'\n]*+')"""
_KEY = rf"{_PART}(?:[ \t]*+\.[ \t]*+{_PART})*+"
_ASSIGNMENT = re.compile(rf"\s*+({_KEY})[ \t]*+=(.*)", re.DOTALL)
_HEADER = re.compile(rf"\s*+(\[\[?)[ \t]*+({_KEY})[ \t]*+(\]\]?)[ \t]*+(?:#.*)?\s*+")
_TEXT = r"""(?:"(?:\\.|[^"\\\n])*+"?|'[^'\n]*+'?)"""
_TOKEN = re.compile(rf"""\"{{3}}|'{{3}}|{_TEXT}|#[^\n]*|[\[\]{{}}\n]""")
_LONG_TEXT = r"""(?:\"{3}(?:[^"\\]|\\.|"{1,2}(?!"))*+(?:"{3})?|'{3}(?:[^']|'{1,2}(?!'))*+(?:'{3})?)"""
_NAMES = re.compile(rf"(?:[A-Za-z0-9_-]++|{_LONG_TEXT}|{_TEXT})", re.DOTALL)
_DOTTED = re.compile(rf"#[^\n]*|{_NAMES.pattern}(?:[ \t]*+\.[ \t]*+{_NAMES.pattern})*+", re.DOTALL)
_OPENS = re.compile(r"""[\[{]|\"{3}|'{3}""")
MOST_DOTS = 40
MOST_STATEMENTS = 20_000
"""An inputs file says a few hundred things; one that says more than this is something else."""
_TOO_LONG = f"holds a name with more than {MOST_DOTS} dots"
_NEXT_BEGINS = re.compile(r"[ \t]*(?:[A-Za-z_][\w.-]*[ \t]*=[^=]|\[+[A-Za-z_][\w.]*\]+[ \t]*(?:#.*)?$)", re.MULTILINE)
_PLACE = re.compile(r" \(at (?:line \d+, column \d+|end of document)\)$")


@dataclass
class InputsDocument:
    """What a text says: nested data, the file and line of every name, and what was wrong with its spelling.

    ``overrides`` are the places that are no lines of the file, in the order given.
    """

    file: str
    data: dict[str, Any] = field(default_factory=dict)
    places: dict[KeyPath, tuple[str, int | None]] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    overrides: list[str] = field(default_factory=list)

    def fault(self, path: KeyPath, message: str) -> Fault:
        """Return a fault at the place of a name, or of the nearest section around it."""
        return Fault(message, *self.place(path))

    def place(self, path: KeyPath) -> tuple[str, int | None]:
        """Return file and line of a name, or of the nearest section around it."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.places:
                return self.places[path[:length]]
        return self.file, None


@dataclass(frozen=True)
class Statement:
    """One statement of a TOML text: a heading or ``name = value``, and the line it begins in."""

    line: int
    text: str


def read_document(text: str, file: str) -> InputsDocument:
    """Read a TOML text; what cannot be read stands in ``faults`` and the rest in ``data``."""
    document = InputsDocument(file, places={(): (file, 1)})
    text = text.replace("\r\n", "\n")
    long_key = _long_key(text)
    if long_key is not None:
        line = text.count("\n", 0, long_key) + 1
        document.faults.append(Fault(_TOO_LONG, file, line))
        return document
    stated = list(statements(text))
    if len(stated) > MOST_STATEMENTS:
        many = f"holds {len(stated)} names and headings; at most {MOST_STATEMENTS} are read"
        document.faults.append(Fault(many, file, stated[MOST_STATEMENTS].line))
        return document
    _Reader(document).run(stated)
    try:
        document.data, document.faults = tomllib.loads(text), []
    except (ValueError, RecursionError) as error:
        if not document.faults:
            document.faults.append(Fault(_sentence(error), file, _line(error) or text.count("\n") + 1))
    return document


def _long_key(text: str) -> int | None:
    """Return where a name begins that is nested too deeply to be read, or None."""
    if text.count(".") <= MOST_DOTS:
        return None
    for dotted in _DOTTED.finditer(text):
        is_long = dotted.end() - dotted.start() > 2 * MOST_DOTS and not dotted[0].startswith("#")
        if is_long and len(_NAMES.findall(dotted[0])) > MOST_DOTS + 1:
            return dotted.start()
    return None


def statements(text: str) -> Iterator[Statement]:
    """Split a text into statements; one that never closes ends with its line."""
    position, line, may_continue = 0, 1, True
    while position < len(text):
        end = text.find("\n", position)
        end = len(text) if end < 0 else end
        first = text[position:end].strip()
        if first and not first.startswith("#"):
            if may_continue and _OPENS.search(first):
                closed = _end_of_statement(text, position)
                may_continue = closed is not None
                end = end if closed is None else closed
            yield Statement(line, text[position:end])
        line += text.count("\n", position, end) + 1
        position = end + 1


def heading_of(statement: str) -> KeyPath | None:
    """Return the path of a heading such as ``[effects.warm_up]``; None for any other text."""
    header = _HEADER.fullmatch(statement)
    return _parts(header[2]) if header is not None and (header[1], header[3]) == ("[", "]") else None


def name_of(statement: str) -> KeyPath | None:
    """Return the path that ``name = value`` gives a value, below its heading; None for any other text."""
    assignment = _ASSIGNMENT.match(statement)
    return _parts(assignment[1]) if assignment is not None else None


def _end_of_statement(text: str, position: int) -> int | None:
    """Return where the statement ends, or None when it never closes."""
    start, depth = position, 0
    while True:
        token = _TOKEN.search(text, position)
        if token is None:
            return len(text) if depth <= 0 else None
        position = token.end()
        mark = token[0]
        if mark in ('"""', "'''"):
            position = _after_long_text(text, position, mark)
            if position < 0:
                return None
        elif mark in "[{":
            depth += 1
        elif mark in "]}":
            depth -= 1
        elif mark == "\n" and (depth <= 0 or _NEXT_BEGINS.match(text, position)):
            return token.start() if token.start() >= start else start


def _after_long_text(text: str, position: int, mark: str) -> int:
    while True:
        end = text.find(mark, position)
        if end < 0:
            return -1
        backslashes = end - len(text[position:end].rstrip("\\")) - position
        if mark == '"""' and backslashes % 2:
            position = end + 1
            continue
        end += 3
        while text.startswith(mark[0], end):
            end += 1
        return end


def _parts(key: str) -> KeyPath:
    if re.fullmatch(r"[A-Za-z0-9_-]+", key):
        return (key,)
    path: list[str] = []
    inner: Any = tomllib.loads(f"{key} = 0")
    while isinstance(inner, dict):
        name, inner = next(iter(inner.items()))
        path.append(name)
    return tuple(path)


def _note(document: InputsDocument, path: KeyPath, line: int) -> None:
    for length in range(1, len(path) + 1):
        document.places.setdefault(path[:length], (document.file, line))


class _Reader:
    """Reads a text statement by statement, noting where each stands, naming broken ones and keeping what was meant."""

    def __init__(self, document: InputsDocument) -> None:
        self.document = document
        self.section: KeyPath | None = ()
        self.headings: dict[KeyPath, int] = {}

    def run(self, stated: list[Statement]) -> None:
        """Read all statements."""
        for statement in stated:
            try:
                self.read(statement)
            except (ValueError, RecursionError) as error:
                self.say(statement, _sentence(error))

    def say(self, statement: Statement, sentence: str) -> None:
        """Note a fault of this statement."""
        self.document.faults.append(Fault(sentence, self.document.file, statement.line))

    def read(self, statement: Statement) -> None:
        """Read one statement into the data."""
        if _long_key(statement.text) is not None:
            self.say(statement, _TOO_LONG)
            return
        if statement.text.lstrip().startswith("["):
            self.heading(statement)
            return
        assignment = _ASSIGNMENT.match(statement.text)
        if assignment is None:
            like = '"first, second" = 0.7' if self.section == ("correlations",) else 'name = "value"'
            self.say(statement, f"{shown(statement.text)} is no line of TOML; write {like}")
            return
        path = _parts(assignment[1])
        if self.section is None:
            return
        _note(self.document, (*self.section, *path), statement.line)
        try:
            value: Any = tomllib.loads(statement.text)
            for part in path:
                value = value[part]
        except ValueError as error:
            meant = None if "digits" in str(error) else _meant(assignment[1], assignment[2])
            self.say(statement, meant[0] if meant else _sentence(error))
            if meant is None or meant[1] is None:
                self.keep((*self.section, *path), None, statement)
                return
            value = meant[1]
        self.keep((*self.section, *path), value, statement)

    def heading(self, statement: Statement) -> None:
        """Begin a section."""
        header = _HEADER.fullmatch(statement.text)
        if header is None or header[1] != header[3].replace("]", "["):
            self.section = None
            self.say(statement, f"{shown(statement.text)} is no heading of a section; write it like [inputs]")
            return
        self.section = path = _parts(header[2])
        if path in self.headings:
            first = self.headings[path]
            self.say(
                statement, f"the section [{_short('.'.join(path))}] occurs twice (first in line {first}); write it once"
            )
        self.headings.setdefault(path, statement.line)
        _note(self.document, path, statement.line)
        inner = self.inner(path)
        if inner is None:
            self.say(statement, f"the section [{_short('.'.join(path))}] has the name of a value given before")
            self.section = None

    def inner(self, path: KeyPath) -> dict[str, Any] | None:
        """Return the table at a path, made where it is missing, or None where a value stands."""
        table = self.document.data
        for name in path:
            inner = table.setdefault(name, {})
            if not isinstance(inner, dict):
                return None
            table = inner
        return table

    def keep(self, path: KeyPath, value: Any, statement: Statement) -> None:
        """Put a value in its place; a name that is taken is a fault."""
        table = self.inner(path[:-1])
        if table is None or path[-1] in table:
            first = self.document.places[path][1]
            where = f" (first in line {first})" if first != statement.line else ""
            self.say(statement, f"{shown(path[-1])} is given twice{where}; write it once")
            return
        table[path[-1]] = UNREADABLE if value is None else value


UNREADABLE = object()
"""Stands for a value that was named as a fault already."""


def _meant(key: str, rest: str) -> tuple[str, str | None] | None:
    """Return what to say of ``key = rest`` and the text that was meant, where it is a text without its quotes."""
    value = rest.strip()
    if not value or value.startswith("#"):
        return f'{_short(key)} has no value; write {_short(key)} = "value"', None
    if value[0] in "\"'" and "\n" not in value and value.count(value[0]) == 1:
        value = value[1:].split("#")[0].strip()
        return f'the closing quotation mark is missing; write {_short(key)} = "{_short(value)}"', value
    value = value.split("#")[0].strip()
    if value[:1] in "\"'[{" or any(mark in value for mark in '"=\n\\'):
        return None
    comma = re.fullmatch(r"([+-]?\d*),(\d+)\s*([^\d\s,.].*)?", value)
    if comma:
        number = f"{comma[1]}.{comma[2]}"
        meant = f'"{_short(number)} {_short(comma[3])}"' if comma[3] else _short(number)
        return (
            f"{_short(key)} = {_short(value)} has a decimal comma; write {_short(key)} = {meant}",
            f"{number} {comma[3] or ''}".strip(),
        )
    return f'{_short(key)} = {_short(value)} needs quotation marks; write {_short(key)} = "{_short(value)}"', value


def _short(text: str) -> str:
    return shown(text)[1:-1]


def _sentence(error: ValueError | RecursionError) -> str:
    if isinstance(error, RecursionError):
        return "is nested too deeply"
    message = _PLACE.sub("", str(error))
    if "Unescaped '\\'" in message or "hex value" in message:
        return "a backslash stands alone in a text; put the text in 'single' marks, or write / instead"
    if "integer string conversion" in message:
        message = "a number has too many digits"
    return f"this is no TOML: {message[:1].lower()}{message[1:]}"


def _line(error: ValueError | RecursionError) -> int | None:
    match = re.search(r"\(at line (\d+),", str(error))
    return int(match[1]) if match else None


# What ``--set name=value`` puts in the place of what the file says


SECTIONS = {
    "sheet": "What the head of the sheet says, and how much the sheet shows.",
    "inputs": "The inputs of the calculation; what is left out is as declared.",
    "from": "Other calculations from which inputs are taken, by name: inputs of them, or their own inputs file.",
    "tolerances": "How inputs scatter about their nominals.",
    "correlations": "Which inputs scatter together, and how much.",
    "conditions": "What is measured but no input of the model.",
    "effects": "Effects that are on, by name, each with its unknowns.",
    "calibrated": "Inputs as fitted to one machine.",
    "studies": "Which studies run, in which order, and their options.",
    "units": "The unit in which a result or input is printed.",
    "columns": "What columns of measured files and of cases are, by what the files call them.",
}
"""The sections of an inputs file, and what each holds."""


def apply_overrides(document: InputsDocument, model: Model[Any, Any], overrides: Sequence[str], label: str) -> None:
    """Write every "name=value" into the document; faults of these are named ``LABEL name=value``."""
    for text in overrides:
        name, equals, value = text.partition("=")
        name, value = name.strip(), value.strip()
        override = f"{label} {_one_line(text)}".strip()
        document.overrides.append(override)
        if not equals or not name:
            document.faults.append(Fault("write name=value, such as load='3 kN'", override))
            continue
        path = _as_stated(path_of(name, model), document)
        if len(path) == 3 and path[0] == "inputs":
            open_table(document, path[1], override)
        put(document, path, value_of(path, value, model), override)


def _as_stated(path: tuple[str, ...], document: InputsDocument) -> tuple[str, ...]:
    """Return a path; of a pair of correlated inputs as the file names it, which may be the other way round."""
    stated = document.data.get("correlations")
    if path[0] != "correlations" or not isinstance(stated, dict):
        return path
    names = {name.strip() for name in path[1].split(",")}
    return (path[0], next((key for key in stated if {name.strip() for name in key.split(",")} == names), path[1]))


def _one_line(text: str) -> str:
    return text if text.isprintable() and len(text) <= 120 else shown(text)[1:-1]


def path_of(name: str, model: Model[Any, Any]) -> tuple[str, ...]:
    """Return the section and name that a dotted name means; a plain name is an input or a condition.

    Behind the name of an input that is read from a data file stands an option of its reader.
    """
    first, _, rest = name.partition(".")
    if rest and first in SECTIONS:
        if first == "from":
            return (first, *rest.rsplit(".", 1))
        if first in {"effects", "studies"}:
            return (first, *rest.split(".", 1))
        return (first, rest)
    if rest and first in model.input_fields and model.input_fields[first].kind == "file":
        return ("inputs", first, rest)
    if name not in model.input_fields and name in model.known_conditions:
        return ("conditions", name)
    if name not in model.input_fields and name in {"seed", "detail", "language"}:
        return ("studies" if name == "seed" else "sheet", name)
    return ("inputs", name)


def value_of(path: tuple[str, ...], text: str, model: Model[Any, Any]) -> Any:
    """Return the TOML value that a text on the command line means in this place."""
    input_field = model.input_fields.get(path[1]) if path[0] in {"inputs", "calibrated"} else None
    as_toml = path[0] in {"studies", "correlations", "from"} or (
        input_field is not None and input_field.kind in {"switch", "integer", "series", "file"}
    )
    if not as_toml and not text.startswith(("{", "[", '"', "'")):
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError, KeyError):
        return text


def open_table(document: InputsDocument, name: str, override: str) -> None:
    """Let options stand beside the data file of an input, also where the file is all that was written."""
    inputs = document.data.get("inputs")
    if isinstance(inputs, dict) and isinstance(inputs.get(name), str):
        inputs[name] = {"file": inputs[name]}
    document.places["inputs", name] = (override, None)


def put(document: InputsDocument, path: tuple[str, ...], value: Any, override: str) -> None:
    """Put a value in its place, stated at a place that is no line of the file."""
    inner: Any = document.data
    for length, name in enumerate(path[:-1], start=1):
        inner = inner.setdefault(name, {})
        if not isinstance(inner, dict):
            return
        document.places.setdefault(path[:length], (override, None))
    inner[path[-1]] = value
    document.places[path] = (override, None)
