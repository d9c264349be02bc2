"""Markdown from texts that nobody vouches for: whatever a user or a plugin writes is printed, never obeyed."""

from __future__ import annotations

import re
from typing import Final

from truing.formulas.symbols import printable

ENTITIES: Final = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "$": "&#36;", "|": "&#124;", "{": "&#123;", "}": "&#125;"}
"""Characters that some reader takes for a mark even behind a backslash: HTML, mathematics, table cells, templates."""

BACKSLASHED: Final = frozenset("\\`*_[]#~")
_MARK = re.compile("[" + re.escape("".join(ENTITIES) + "".join(sorted(BACKSLASHED))) + "]")
_LINE_START = re.compile(r"^(\d{0,9})([-+.)=](?=[\s=-]|$))")
_AUTOLINK = re.compile(r"(?i)\b(https?|ftp|mailto|xmpp|www)([:.])")


class Raw(str):
    """Markdown that we wrote ourselves; everything else is escaped when a template prints it."""

    __slots__ = ()


def escaped(text: object) -> Raw:
    """Write any text so that Markdown prints it as it is: one line, no markup, no link, no formula, no HTML."""
    if isinstance(text, Raw):
        return text
    words = printable(str(text))
    safe = _MARK.sub(lambda found: ENTITIES.get(found[0], f"\\{found[0]}"), words)
    safe = _AUTOLINK.sub(lambda found: f"{found[1]}&#{ord(found[2])};", safe)
    return Raw(_LINE_START.sub(r"\1\\\2", safe))
