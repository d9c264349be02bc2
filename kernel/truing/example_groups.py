"""The inputs of a model in groups: the paragraphs of the example that its author wrote."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

_TABLE = re.compile(r"^(?:# )?\[")
_INPUT = re.compile(r"^(?P<left_out># ?)?(?P<name>\w+) *=")
_WORDS = re.compile(r"# ?[^ #]")
_END = re.compile(r"[.:;](?= |$)")


@dataclass
class Group:
    """A paragraph of the example: its first words, what it says besides, its inputs, and remarks between them.

    ``is_left_out``: every input of it is commented out, so the example runs without any of them.
    """

    title: str
    text: str = ""
    names: list[str] = field(default_factory=list)
    remarks: dict[str, str] = field(default_factory=dict)
    is_left_out: bool = True


def groups(example: str, names: Collection[str]) -> list[Group]:
    """Put all inputs of a model in groups by the text of its example; those that it does not name come last."""
    result: list[Group] = []
    for lines in _paragraphs(example):
        group = _group(lines, {name for name in names if not any(name in other.names for other in result)})
        if group.names and not group.title and result:
            result[-1].names += group.names
            result[-1].is_left_out &= group.is_left_out
        elif group.names:
            result.append(group)
    rest = [name for name in names if not any(name in group.names for group in result)]
    if rest:
        result.append(Group("Not in the example" if result else "", names=rest, is_left_out=bool(result)))
    return result


def _paragraphs(example: str) -> Iterator[list[str]]:
    """Give the lines of each paragraph of ``[inputs]``."""
    _, _, text = f"\n{example}".partition("\n[inputs]\n")
    lines: list[str] = []
    for line in text.splitlines():
        if _TABLE.match(line):
            break
        if line.strip():
            lines.append(line)
        elif lines:
            yield lines
            lines = []
    if lines:
        yield lines


def _group(lines: list[str], names: Collection[str]) -> Group:
    """Read a paragraph: words before its first input are of all, words before another of that one."""
    group, words = Group(""), list[str]()
    for line in lines:
        named = _INPUT.match(line)
        if named and named["name"] in names:
            if group.names and words:
                group.remarks[named["name"]] = " ".join(words)
            elif words:
                group.title, group.text = _headed(" ".join(words))
            words = []
            group.is_left_out &= named["left_out"] is not None
            if named["name"] not in group.names:
                group.names.append(named["name"])
        elif _WORDS.match(line) and not named:
            words.append(line.lstrip("# "))
    return group


def _headed(words: str) -> tuple[str, str]:
    """Part a text behind the first words that end with a stop."""
    end = _END.search(words)
    if end is None:
        return words, ""
    rest = words[end.end() :].strip()
    return words[: end.start()], rest[:1].upper() + rest[1:]
