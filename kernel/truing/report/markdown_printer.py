"""A document as Markdown."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from truing.formulas.symbols import printable
from truing.formulas.write_latex import LATEX, symbol_latex
from truing.numbers import pretty
from truing.report import equations
from truing.report.document import (
    BlockView,
    Document,
    Equation,
    FigurePair,
    FigureView,
    Fold,
    Items,
    Marked,
    Paragraph,
    Piece,
    ResultEntry,
    TableView,
    Text,
    Value,
    plain_text,
    state_words,
)
from truing.report.translation import Catalogue, kernel_catalogue

LINE = 60.0
"""How wide a line of a formula may be, in em as estimated."""


def markdown_of(document: Document) -> str:
    """Write a document as Markdown: parts with an empty line between."""
    words = kernel_catalogue(document.language)
    parts = [*_head(document, words)]
    for chapter in document.front:
        parts += [f"## {escaped(chapter.title)}", *_blocks(chapter.blocks, words)]
    for chapter in document.chapters:
        parts += [f"## {chapter.number} {escaped(chapter.title)}", *_blocks(chapter.blocks, words)]
    return "\n\n".join(parts) + "\n"


def _head(document: Document, words: Catalogue) -> Iterator[str]:
    head, banner = document.head, document.banner
    if head.letter:
        yield ", ".join((f"**{escaped(head.letter[0])}**", *map(escaped, head.letter[1:])))
    yield f"# {escaped(document.title)}"
    yield from (escaped(text) for text in (head.model, document.summary) if text)
    yield _pipes(head.fields)
    if head.signatures:
        yield _pipes(head.signatures, [f"*{words.said('Date, signature')}*"] * len(head.signatures))
    sentences = [_said(sentence) for sentence in banner.sentences]
    sentences[0] = f"**{escaped(banner.headline)}.** {sentences[0]}"
    if document.warnings:
        sentences[-1] += " " + words.said(f"See the warnings ({len(document.warnings)}).")
    yield from sentences
    slip, unchanged = words.said("Suspected unit slip."), words.said("Nothing was changed.")
    yield from (f"**{slip}** {escaped(text)} {unchanged}" for text in document.alarms)


def _pipes(fields: Sequence[tuple[str, str]], *rows: Sequence[str]) -> str:
    labels, texts = ([escaped(text) for text in column] for column in zip(*fields, strict=True))
    return _rows([labels, ["---"] * len(labels), texts, *rows])


def _rows(rows: Iterable[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in rows)


def _blocks(blocks: Iterable[BlockView], words: Catalogue) -> Iterator[str]:
    for block in blocks:
        match block:
            case Paragraph(text, kind):
                head = "" if kind in ("note", "aside") else f"**{words.said(kind.capitalize())}.** "
                yield f"{head}{_said(text)}"
            case Items():
                yield "\n".join(_items(block))
            case TableView():
                yield from _table(block)
            case FigureView():
                yield _picture(block.title, block.svg)
                yield f"**{words.said('Figure')} {block.number}.** {escaped(block.caption)}"
            case FigurePair():
                yield _pair(block, words)
            case ResultEntry():
                yield from _entry(block, words)
            case Fold(title, inner):
                yield f"<details><summary>{escaped(title)}</summary>"
                yield from _blocks(inner, words)
                yield "</details>"


def _picture(title: str, svg: str) -> str:
    return f"![{escaped(title)}](data:image/svg+xml;base64,{base64.b64encode(svg.encode()).decode()})"


def _pair(pair: FigurePair, words: Catalogue) -> str:
    """Write two drawings side by side, as the cells of a table."""
    heads, none = [words.said("Before"), words.said("After")], words.said("No such figure.")
    sides = zip(heads, (pair.before, pair.after), strict=True)
    cells = [none if side is None else _picture(f"{word}: {side.title}", side.svg) for word, side in sides]
    title = f"**{words.said('Figure')} {pair.number}.** {escaped(pair.title)}"
    return f"{title}\n\n" + _rows([heads, ["---", "---"], cells])


def _items(items: Items) -> Iterator[str]:
    for index, text in enumerate(items.texts):
        mark = f"{index + 1}." if items.kind == "references" else "-"
        label = escaped(items.labels[index]) if items.labels else ""
        label = f"**{label}.** " if items.kind == "findings" else f"{label}: " if label else ""
        yield f"{mark} {label}{_said(text)}".rstrip()


def _table(table: TableView) -> Iterator[str]:
    """Write a pipe table; units stand in the headings."""
    if table.title:
        yield f"**{escaped(table.title)}**"
    titles = [escaped(column.heading) for column in table.columns]
    rule = ["---:" if column.kind == "number" else "---" for column in table.columns]
    rows = [[_said(cell) for cell in row] for row in table.rows]
    for row, state in zip(rows, table.states, strict=False):
        if state == "marked":
            row[:] = [f"**{text}**" if text else text for text in row]
    yield _rows([titles, rule, *rows])
    if table.note:
        yield _said(table.note)


def _entry(entry: ResultEntry, words: Catalogue) -> Iterator[str]:
    """Write a result: its value behind its name, or below its formula."""
    note, *rest = entry.label if isinstance(entry.label, tuple) else (entry.label,)
    label = f"**{_said(note)}**{_said(tuple(rest))}"
    if entry.equation is None:
        yield f"{label}: {_said(entry.value)}" if entry.value else label
    else:
        yield from (label, words.formula(_equation(entry.equation)), *([_said(entry.value)] if entry.value else []))
    if entry.method:
        yield _said(entry.method)


def _said(text: Text) -> str:
    """Write a text with all its pieces."""
    first, *others = (text if isinstance(text, tuple) else (text,)) or ("",)
    return "".join([_piece(first), *(_piece(piece, begins=False) for piece in others)])


def _piece(piece: Piece, *, begins: bool = True) -> str:
    match piece:
        case str():
            return _words(piece, begins=begins)
        case Value() | Marked("code" | "bracketed code" | "source", _):
            return escaped(plain_text(piece))
        case Marked("symbol", text):
            return f"${symbol_latex(str(text))}$"
        case Marked("strong", text):
            return _piece(text)
        case Marked("aside", text):
            return escaped(text)
        case Marked("state", state):
            sign, word = state_words(piece)
            return f"{sign} {word if state == 'passes' else f'**{word}**'}"
        case Marked(_, instead):
            return str(instead)


def _words(text: str, *, begins: bool) -> str:
    """Write words, with the spaces before and behind them that part them from other pieces."""
    before, behind = " " * text.startswith(" "), " " * text.endswith(" ")
    words = escaped(pretty(text), begins=begins)
    return f"{before}{words}{behind}" if words else before


def _equation(equation: Equation) -> str:
    lines = [line.markup for line in equations.lines(LATEX, equation, limit=LINE)]
    if len(lines) == 1:
        return f"$$\n{lines[0]}\n$$"
    body = " \\cr\n& ".join(lines)
    return f"$$\n\\begin{{aligned}}\n& {body}\n\\end{{aligned}}\n$$"


# Markdown from texts that nobody vouches for: whatever a user or a plugin writes is printed, never obeyed


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
    safe = _MARK.sub(lambda match: ENTITIES.get(match[0], f"\\{match[0]}"), words)
    safe = _AUTOLINK.sub(lambda match: f"{match[1]}&#{ord(match[2])};", safe)
    return _LINE_START.sub(r"\1\\\2", safe) if begins else safe
