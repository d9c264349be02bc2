"""How much room the columns of a table need, so that on paper they can share the page in proportion to it."""

from __future__ import annotations

import re
from html import unescape
from itertools import zip_longest
from typing import Final

TABLE: Final = re.compile(r'<table class="grid.*?</table>', re.DOTALL)
ROW: Final = re.compile(r"<tr\b.*?</tr>", re.DOTALL)
CELL: Final = re.compile(r"<(t[hd]\b[^>]*)>(.*?)</t[hd]>", re.DOTALL)
UNBROKEN: Final = re.compile(r'^td\b.*class="[^"]*\b(number|units|given|date)\b', re.DOTALL)
TAG: Final = re.compile(r"<(/?\w+)[^>]*>")
BREAKS: Final = frozenset({"wbr", "br", "/span", "span"})
"""Tags beside which a line may end."""

ONE_LINE: Final = 20
"""So many characters a number, a unit or a date may have to stand on one line; a longer one (an interval) may break."""
LONGEST: Final = 24
"""So many characters of a word stay together; a longer word breaks anywhere."""
PADDING: Final = 2
"""The gap to the next column, in characters."""


def with_room(page: str) -> str:
    """Write into the tables of a page how many characters their columns need: ``--own`` each, ``--room`` together.

    The style sheet makes of them the least width of a column in print, and a smaller type where all do not fit.
    """
    return TABLE.sub(lambda table: _measured(table[0]), page)


def _measured(table: str) -> str:
    rows = [[_longest(*cell) for cell in CELL.findall(row)] for row in ROW.findall(table)]
    needs = [max(column) + PADDING for column in zip_longest(*rows, fillvalue=0)]
    head, tail = table.split("</tr>", 1)
    widths = iter(needs)
    head = re.sub(r"<th\b[^>]*", lambda start: f'{start[0]} style="--own: {next(widths, PADDING)}"', head)
    return head.replace(">", f' style="--room: {sum(needs)}">', 1) + "</tr>" + tail


def _longest(tag: str, markup: str) -> int:
    """Return the characters of the longest part of a cell that should stay on one line."""
    spaced = TAG.sub(lambda inner: "\n" if inner[1] in BREAKS else "", markup)
    text = re.sub(r"[ \t]+", " ", unescape(spaced)).strip()
    is_unbroken = UNBROKEN.match(tag) and len(text) <= ONE_LINE
    return min(LONGEST, max(map(len, text.split("\n") if is_unbroken else re.split(r"[ \n]|(?<=-)", text))))
