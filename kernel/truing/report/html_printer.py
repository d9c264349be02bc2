"""A document as HTML: one page that asks for nothing, or its blocks alone."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from functools import lru_cache
from html import unescape
from itertools import groupby, zip_longest
from typing import Any, Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup, escape

from truing.formulas.symbols import printable
from truing.formulas.write_mathml import MATHML, symbol_mathml
from truing.numbers import pretty, with_unit
from truing.report import equations
from truing.report.document import (
    MARKS,
    BlockView,
    Document,
    Equation,
    Marked,
    Piece,
    ResultEntry,
    Text,
    Value,
    state_words,
)
from truing.report.translation import kernel_catalogue
from truing.templating import template_folder

COLUMN = equations.LINE
"""How wide a formula may be, in em, beside the words of its result; a wider one stands below them."""
WIDEST = 1.3
"""How much wider than estimated a formula may come out, in the widest of usual fonts; paper keeps room for that."""
LONG = 7
"""A sheet with more chapters than this has a table of contents."""
UNBROKEN = 30
"""A number with its unit that has fewer characters stays on one line."""


def html_of(document: Document) -> str:
    """Write a document as a page."""
    has_contents = document.detail != "short" and len(document.chapters) > LONG
    return page(
        "sheet.html.j2", document.head.footer, paper=document.paper, own_style=document.head.style, sheet=document,
        has_contents=has_contents, language=document.language,
    )  # fmt: skip


def page(
    template: str, footer: str, *, styles: Sequence[str] = ("sheet.css",), paper: str = "A4", own_style: str = "",
    **said: Any,
) -> str:  # fmt: skip
    """Write a page from its template; the footer stands in the margin of every page but the first.

    A style sheet that a user states comes last, and cannot end the element that holds it.
    """
    style = "".join((template_folder() / name).read_text(encoding="utf-8") for name in styles)
    style += f'\n@page {{ size: {paper}; @top-left {{ content: "{css_text(footer)}"; }} }}'
    style += "\n@page :first { @top-left { content: none; } }\n" + own_style.replace("<", "\\3c ")
    return with_room(_environment().get_template(template).render(style=_markup(style), **said)) + "\n"


def css_text(text: str) -> str:
    """Write any text inside a CSS string: everything but letters and digits as a code point."""
    short = printable(text)[:110]
    return "".join(c if c.isascii() and c.isalnum() else f"\\{ord(c):x} " for c in short)


def _markup(text: str) -> Any:
    return Markup(text)  # only for what this package wrote itself


@lru_cache(maxsize=1)
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(template_folder()), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        autoescape=True, finalize=_printable,
    )  # fmt: skip
    environment.filters.update(
        said=_said,
        formula=_equation,
        picture=_picture,
        groups=_groups,
        breakable=_breakable,
        unbroken=_unbroken,
        own=_markup,
        word=_word,
    )
    environment.tests["wide"] = _is_wide
    environment.globals["marks"] = MARKS
    return environment


@pass_context
def _word(context: Context, text: str) -> str:
    """Write a word of the templates in the language of the page."""
    return kernel_catalogue(context["language"]).said(text)


def _printable(value: Any) -> Any:
    """Take control and direction characters out of every text that is no markup of ours."""
    return _one_line(value) if type(value) is str else value


def _one_line(text: str) -> str:
    """Return a text on one line, without characters that hide or turn what is written."""
    return text if text.isprintable() else printable(text)


def _groups(views: Sequence[BlockView]) -> list[tuple[str, list[BlockView]]]:
    """Return blocks with the name of their kind, neighbours of one kind together."""
    return [(kind, list(group)) for kind, group in groupby(views, lambda view: type(view).__name__)]


def _said(text: Text) -> Any:
    """Write a text with all its pieces."""
    return _markup("".join(map(_piece, text if isinstance(text, tuple) else (text,))))


def _piece(piece: Piece) -> str:
    match piece:
        case str():
            return escape(_one_line(pretty(piece)))
        case Value(text, unit):
            number = _one_line(with_unit(pretty(text), unit))
            return escape(number.replace(" ", "\u00a0") if len(number) < UNBROKEN else number)
        case Marked("symbol", text):
            return f"<math>{symbol_mathml(str(text))}</math>"
        case Marked("code" | "bracketed code", name):
            return f"<code>{_breakable(str(name))}</code>"
        case Marked("strong", text):
            return f"<strong>{_piece(text)}</strong>"
        case Marked("aside", text):
            return f'<span class="aside">{_piece(text)}</span>'
        case Marked("source", text):
            return f'<span class="aside">[{_piece(text)}]</span>'
        case Marked("state"):
            sign, word = state_words(piece)
            return f'<span aria-hidden="true">{sign}</span> {word}'
        case Marked():
            return "<br>"


def _picture(svg: str) -> str:
    """Return a drawing as the address of a picture, so that nothing in it can touch the page or another drawing."""
    return f"data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()}"


def _breakable(name: str) -> Any:
    """Let a long name break behind its underscores."""
    return _markup(str(escape(_one_line(name))).replace("_", "_<wbr>"))


def _unbroken(markup: str) -> Any:
    """Keep the two ends of an interval on one line."""
    return _markup(markup.replace(" … ", "\u00a0…\u00a0"))


def _is_wide(entry: ResultEntry) -> bool:
    """Tell whether the formula of an entry needs the whole width of the page."""
    return entry.equation is not None and max(line.width for line in equations.lines(MATHML, entry.equation)) > COLUMN


@pass_context
def _equation(context: Context, equation: Equation) -> Any:
    """Set a formula as blocks of MathML, one a line; ``--room`` is the width in em for which paper keeps room."""
    alternative = escape(f"{equation.name} = {equation.formula.text}")
    blocks = []
    lines = equations.lines(MATHML, equation)
    room = f' style="--room: {WIDEST * max(line.width for line in lines):.0f}"'
    for index, line in enumerate(lines):
        label = f' alttext="{alternative}"' if index == 0 else ""
        markup = kernel_catalogue(context["language"]).formula(line.markup)
        mathematics = f'<math display="block"{label}><mrow>{markup}</mrow></math>'
        blocks.append(f'<div class="line{" next" if index else ""}"{room}>{mathematics}</div>')
    return _markup("".join(blocks))


# How much room the columns of a table need, so that on paper they can share the page in proportion to it


TABLE: Final = re.compile(r'<table class="grid.*?</table>', re.DOTALL)
ROW: Final = re.compile(r"<tr\b.*?</tr>", re.DOTALL)
CELL: Final = re.compile(r"<(t[hd]\b[^>]*)>(.*?)</t[hd]>", re.DOTALL)
SHORT_CELL: Final = re.compile(r'^td\b.*class="[^"]*\b(number|units|given|date)\b', re.DOTALL)
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
    is_unbroken = SHORT_CELL.match(tag) and len(text) <= ONE_LINE
    return min(LONGEST, max(map(len, text.split("\n") if is_unbroken else re.split(r"[ \n]|(?<=-)", text))))
