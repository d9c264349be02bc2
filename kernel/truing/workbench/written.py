"""A change of an inputs file as text: a value stated, replaced or taken out; comments and order stay.

Only the lines of that value change. A statement is changed by tomlkit, which keeps its spelling; where statements stand
is known from their text, line by line, so that a line that is no TOML yet does not stop a change of another.

What an example holds as a comment (``# tilt_limit = "0.0013 deg"``) shows where a value belongs: it is stated below
that line, or by that line itself where it says the same. What is taken out again leaves the text as it was saved.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from truing.errors import UsageError
from truing.heavy import Later
from truing.inputs_file.assemble import toml_key, toml_value
from truing.inputs_file.document import SECTIONS, KeyPath, heading_of, name_of, statements

tomlkit: Any = Later("tomlkit")

_COMMENT = re.compile(r"[ \t]*#[ \t]?(?=\S)")
_GOES_ON = re.compile(r"[ \t]*#[ \t]{3,}")
"""A comment that goes on from the line above: it is set in from the mark."""
MOST_COMMENTED_LINES = 60
"""So many lines may an example in comments have."""


@dataclass(frozen=True)
class Entry:
    """A heading or a value, stated or in comments: its whole path, and its lines ``first`` to before ``last``.

    ``section`` is the path of the heading it stands below.
    """

    path: KeyPath
    section: KeyPath
    first: int
    last: int
    is_heading: bool
    is_commented: bool


class Written:
    """The lines of a text, and what stands in them."""

    def __init__(self, text: str) -> None:
        self.lines = text.split("\n")
        self._entries: list[Entry] | None = None

    @property
    def entries(self) -> list[Entry]:
        """What stands in the text, in its order."""
        if self._entries is None:
            self._entries = sorted(_entries(self.text, self.lines), key=lambda entry: entry.first)
        return self._entries

    @property
    def text(self) -> str:
        """The text as it is now."""
        return "\n".join(self.lines)

    def put(self, first: int, last: int, lines: Sequence[str]) -> None:
        """Put other lines in the place of some."""
        self.lines[first:last] = lines
        self._entries = None

    def lines_of(self, entry: Entry) -> list[str]:
        """Return the lines of an entry."""
        return self.lines[entry.first : entry.last]

    def find(self, path: KeyPath, *, heading: bool = False, commented: bool = False) -> Entry | None:
        """Return the first entry with a path, or None."""
        kind = (heading, commented)
        return next((e for e in self.entries if e.path == path and (e.is_heading, e.is_commented) == kind), None)

    def holder(self, path: KeyPath) -> Entry | None:
        """Return the statement that holds the value of a path: its own, or that of a table around it."""
        stated = (e for e in self.entries if not e.is_heading and not e.is_commented)
        return next((e for e in stated if e.path == path[: len(e.path)]), None)

    def below(self, heading: Entry) -> list[Entry]:
        """Return what stands, stated or in comments, between a heading and the next one, in comments or not."""
        end = next((e.first for e in self.entries if e.is_heading and e.first > heading.first), len(self.lines))
        return [e for e in self.entries if heading.first < e.first < end]

    def is_free(self, line: int) -> bool:
        """Tell whether a heading can stand in a line without taking statements from the heading above."""
        after = next((e for e in self.entries if e.first >= line and not e.is_commented), None)
        return after is None or after.is_heading


def _entries(text: str, lines: Sequence[str]) -> Iterator[Entry]:
    """Give the statements of a text, then what its comments state."""
    section: KeyPath = ()
    headings: list[tuple[int, KeyPath]] = []
    taken: set[int] = set()
    for statement in statements(text):
        first, last = statement.line - 1, statement.line + statement.text.count("\n")
        taken.update(range(first, last))
        heading, name = _path(heading_of, statement.text), _path(name_of, statement.text)
        if heading is not None:
            section = heading
            headings.append((first, heading))
        if heading is not None or name is not None:
            yield Entry(heading or (*section, *(name or ())), section, first, last, heading is not None, False)
    yield from _commented(lines, taken, dict(headings))


def _path(reader: Any, text: str) -> KeyPath | None:
    with suppress(ValueError, RecursionError):  # a key that is no key
        path: KeyPath | None = reader(text)
        return path
    return None


def _commented(lines: Sequence[str], taken: set[int], headings: Mapping[int, KeyPath]) -> Iterator[Entry]:
    section: KeyPath = ()
    done = 0
    for first, line in enumerate(lines):
        if first in headings:
            section = headings[first]
        if first in taken or first < done or not _COMMENT.match(line):
            continue
        bare = _COMMENT.sub("", line, count=1)
        heading = _path(heading_of, bare) if bare.startswith("[") else None
        if heading is not None and heading[0] in SECTIONS:
            section = heading
            yield Entry(heading, heading, first, first + 1, True, True)
        elif (name := _path(name_of, bare)) is not None:
            last = _end_of_example(lines, first)
            if last:
                done = last
                yield Entry((*section, *name), section, first, last, False, True)


def _end_of_example(lines: Sequence[str], first: int) -> int:
    """Return the line behind a statement in comments that begins here; 0 where it is none."""
    text = ""
    for last in range(first, min(first + MOST_COMMENTED_LINES, len(lines))):
        if not lines[last].lstrip().startswith("#"):
            return 0
        text += f"{_uncommented(lines[last])}\n"
        with suppress(ValueError, RecursionError):
            tomllib.loads(text)
            return last + 1
        if not re.search(r"[\[{]", text):
            return 0
    return 0


def _uncommented(line: str) -> str:
    return re.sub(r"#[ \t]?", "", line, count=1)


# Changes


def changed_text(
    text: str, path: Sequence[str], literal: str | None, *, saved: str | None = None, order: Sequence[str] = ()
) -> str:
    """Return the text with the value at a path ("inputs", "load") stated as TOML; None takes it out.

    ``saved`` is the text as the file has it: a value that it states is put in comments when it is taken out, any other
    goes without a trace. ``order`` holds the names of the section in the order in which a new one is put among them.
    Raises UsageError where the line of the value cannot be read.
    """
    written, whole = Written(text), tuple(path)
    holder = written.holder(whole)
    if literal is None:
        if holder is not None:
            _take_out(written, holder, whole[len(holder.path) :], Written(text if saved is None else saved))
    elif holder is not None:
        statement = "\n".join(written.lines_of(holder))
        key = whole[len(holder.section) :]
        written.put(holder.first, holder.last, _restated(statement, key, literal, holder).split("\n"))
    else:
        _insert(written, whole, literal, order)
    return written.text


def switched_text(
    text: str, section: Sequence[str], literals: Mapping[str, str], *, on: bool, saved: str | None = None
) -> str:
    """Return the text with a section on, with all its names, or off; what it stated stays in comments.

    ``literals`` holds what is stated under a name that the text has neither stated nor in comments.
    """
    path = tuple(section)
    if on:
        for name, literal in literals.items():
            written = Written(text)
            example = written.find((*path, name), commented=True)
            if written.holder((*path, name)) is None:
                stated = literal if example is None else _literal_of(written, example) or literal
                text = changed_text(text, (*path, name), stated, order=list(literals))
        return text
    written, before = Written(text), Written(text if saved is None else saved)
    while (entry := _next_below(written, path)) is not None:
        _take_out(written, entry, (), before)
    heading = written.find(path, heading=True)
    if heading is not None:
        _close(written, heading, before, always=True)
    return written.text


def _next_below(written: Written, path: KeyPath) -> Entry | None:
    stated = (e for e in written.entries if not e.is_heading and not e.is_commented)
    return next((e for e in stated if e.path[: len(path)] == path), None)


def _restated(statement: str, key: KeyPath, literal: str | None, entry: Entry) -> str:
    """Return a statement with another value at a key, or without it."""
    try:
        document = tomlkit.parse(statement)
    except Exception:  # tomlkit has a family of errors, all of which say that the statement is no TOML
        if literal is None or key != entry.path[len(entry.section) :]:
            raise UsageError(f"line {entry.first + 1} is no TOML as it stands; mend it in the text first") from None
        name, _, rest = statement.partition("=")
        _, mark, comment = rest.partition("#")
        return f"{name.rstrip()} = {literal}{'  # ' if mark else ''}{comment.strip()}"
    table, names = document, list(key)
    for index, name in enumerate(names[:-1]):
        if not isinstance(table.get(name), Mapping):  # "flank.csv" becomes { file = "flank.csv" }
            if names[index + 1 :] == ["file"] and isinstance(table.get(name), str):
                break
            file = f"file = {toml_value(str(table[name]))}" if isinstance(table.get(name), str) else ""
            table[name] = tomlkit.value(f"{{ {file} }}")
        table = table[name]
    else:
        index = len(names) - 1
    if literal is None:
        table.pop(names[index], None)
    else:
        _put(table, names[index], literal)
    stated: str = tomlkit.dumps(document)
    return re.sub(r"(?<=[^\s{])\}(?=\s*(#.*)?\Z)", " }", stated) if "= { " in stated else stated


def _put(table: Any, name: str, literal: str) -> None:
    """State a value in a table; one that is the same keeps its spelling, and a text its kind of quotation marks."""
    value, before = tomlkit.value(literal), table.get(name)
    if before is not None:
        same = type(before) is type(value) and before == value
        if same and not isinstance(value, float):
            return
        single = before.as_string().startswith("'") if hasattr(before, "as_string") else False
        if single and isinstance(value, str) and "'" not in value and value.isprintable():
            value = tomlkit.string(str(value), literal=True)
    table[name] = value


def _take_out(written: Written, entry: Entry, inner: KeyPath, saved: Written) -> None:
    """Take a value out: as it was saved, or in comments where it was stated then."""
    lines = written.lines_of(entry)
    if inner and inner != ("file",):
        key = (*entry.path[len(entry.section) :], *inner)
        written.put(entry.first, entry.last, _restated("\n".join(lines), key, None, entry).split("\n"))
        return
    example, stated = written.find(entry.path, commented=True), saved.find(entry.path)
    before = saved.find(entry.path, commented=True)
    has_comment = "#" in lines[-1]
    if stated is not None and (has_comment or example is None or not _follows(written, example, entry)):
        written.put(entry.first, entry.last, [f"# {line}" if line.strip() else "#" for line in lines])
    elif stated is None and example is None and before is not None:
        written.put(entry.first, entry.last, saved.lines_of(before))
    else:
        written.put(entry.first, entry.last, [])
    heading = written.find(entry.section, heading=True)
    if heading is not None:
        _close(written, heading, saved)


def _follows(written: Written, example: Entry, entry: Entry) -> bool:
    return _behind(written, example) == entry.first


def _close(written: Written, heading: Entry, saved: Written, *, always: bool = False) -> None:
    """Put a heading that has nothing below it any more back as it was saved."""
    if any(not e.is_heading and not e.is_commented and e.section == heading.path for e in written.entries):
        return
    before = saved.find(heading.path, heading=True, commented=True)
    if saved.find(heading.path, heading=True) is not None:
        if always:
            written.put(heading.first, heading.last, [f"# {line}" for line in written.lines_of(heading)])
    elif before is not None:
        written.put(heading.first, heading.last, saved.lines_of(before))
    else:
        is_apart = heading.first > 0 and not written.lines[heading.first - 1].strip()
        written.put(heading.first - is_apart, heading.last, [])


def _insert(written: Written, path: KeyPath, literal: str, order: Sequence[str]) -> None:
    """State a value that was not stated: at its example in comments, among its neighbours, or in a new section."""
    section, line = path[:-1], f"{toml_key(path[-1])} = {literal}"
    heading = _opened(written, section)
    if heading is None:
        dotted = [
            e for e in written.entries
            if not (e.is_heading or e.is_commented) and e.path[: len(section)] == section and e.section != section
        ]  # fmt: skip
        if dotted and section:
            rest = path[len(dotted[-1].section) :]
            written.put(dotted[-1].last, dotted[-1].last, [f"{'.'.join(map(toml_key, rest))} = {literal}"])
            return
        heading = _begun(written, section)
    below = written.below(heading)
    example = next((e for e in below if e.path == path and e.is_commented), None)
    if example is not None and _literal_value(_literal_of(written, example)) == _literal_value(literal):
        written.put(example.first, example.last, [_uncommented(line) for line in written.lines_of(example)])
        return
    before = list(order[: order.index(path[-1])]) if path[-1] in order else list(order)
    ranked = [e for name in reversed(before) for e in below if e.path == (*section, name)]
    stated = [e for e in below if not e.is_commented]
    near = example or (ranked or stated[-1:] or [heading])[0]
    last = near if near is heading or near is example else _last_of(below, near)
    written.put(_behind(written, last), _behind(written, last), [line])


def _last_of(below: Sequence[Entry], near: Entry) -> Entry:
    """Return the last entry of the name of this one: what is stated stands below its example."""
    return [e for e in below if e.path == near.path][-1]


def _behind(written: Written, entry: Entry) -> int:
    """Return the line behind an entry and the comments that go on from it."""
    line = entry.last
    while line < len(written.lines) and not entry.is_heading and _GOES_ON.match(written.lines[line]):
        line += 1
    return line


def _opened(written: Written, section: KeyPath) -> Entry | None:
    """Return the heading of a section; one in comments is made one where it takes nothing from that above."""
    if not section:
        return Entry((), (), 0, 0, True, False)
    heading = written.find(section, heading=True)
    if heading is not None:
        return heading
    commented = written.find(section, heading=True, commented=True)
    is_dotted = any(e.path[: len(section)] == section and not (e.is_heading or e.is_commented) for e in written.entries)
    if commented is None or is_dotted or not written.is_free(commented.last):
        return None
    written.put(commented.first, commented.last, [_uncommented(line) for line in written.lines_of(commented)])
    return written.find(section, heading=True)


def _begun(written: Written, section: KeyPath) -> Entry:
    """Put a heading behind its like, or at the end, with an empty line before it."""
    alike = [e for e in written.entries if e.path[:1] == section[:1]]
    line = _behind(written, alike[-1]) if alike else 0
    if not alike or not written.is_free(line):
        line = len(written.lines) - (not written.lines[-1].strip())
    written.put(line, line, ["", f"[{'.'.join(map(toml_key, section))}]"])
    heading = written.find(section, heading=True)
    assert heading is not None
    return heading


def _literal_of(written: Written, example: Entry) -> str:
    """Return the value of a statement in comments, as TOML without what stands behind it."""
    return literal_in("\n".join(map(_uncommented, written.lines_of(example))), example.path[len(example.section) :])


def literal_in(statement: str, key: Sequence[str]) -> str:
    """Return the value that a statement gives a key, spelled as it is there; nothing where it cannot be read."""
    with suppress(Exception):  # whatever tomlkit does not read has no value
        table: Any = tomlkit.parse(statement)
        for name in key:
            table = table[name]
        literal: str = table.as_string() if hasattr(table, "as_string") else toml_value(table)
        return literal
    return ""


def _literal_value(literal: str) -> Any:
    with suppress(ValueError, RecursionError):
        return tomllib.loads(f"value = {literal}")["value"]
    return literal
