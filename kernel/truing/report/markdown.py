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


def escaped(text: object, *, begins: bool = True) -> str:
    """Write any text so that Markdown prints it as it is: one line, no markup, no link, no formula, no HTML.

    ``begins``: it may stand at the beginning of a line, where a number or a dash would make a list.
    """
    words = printable(str(text))
    safe = _MARK.sub(lambda found: ENTITIES.get(found[0], f"\\{found[0]}"), words)
    safe = _AUTOLINK.sub(lambda found: f"{found[1]}&#{ord(found[2])};", safe)
    return _LINE_START.sub(r"\1\\\2", safe) if begins else safe
