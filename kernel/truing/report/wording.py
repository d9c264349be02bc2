"""A document whose texts are said anew: with its quantities in other units, or in another language.

One walk reaches every text that somebody reads, and leaves names, symbols and numbers alone. How a text is said is up
to the units of the sheet (``sheet_units``) or to the words of a language (``translation``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Final, Protocol, Self

from truing.report.document import (
    STATES,
    Banner,
    BlockView,
    Chapter,
    Document,
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
)

STUDY: Final = "study"
"""The place of the texts in the chapter of a study."""
READ_ELSEWHERE: Final = frozenset({"references", "provenance"})
"""Kinds of ``Items`` that are places: titles of literature, and names of files and versions."""


class Wording(Protocol):
    """How texts are said anew."""

    def said(self, text: str) -> str:
        """Return a text as it is to be said; itself where nothing is known of it."""

    def name(self, note: str) -> str:
        """Return what a quantity is called, of which its author says this."""

    def at(self, place: str) -> Self:
        """Return how texts of a place are said: ``STUDY``, one of ``READ_ELSEWHERE``, a label of the provenance."""


def in_words(document: Document, words: Wording) -> Document:
    """Return a document as some wording says it. The title block stays, and the lines for the terminal."""
    banner = document.banner
    return replace(
        document,
        kind=words.said(document.kind),
        title=words.said(document.title),
        summary=words.said(document.summary),
        banner=Banner(banner.mood, words.said(banner.headline), _texts(banner.sentences, words)),
        alarms=tuple(map(words.said, document.alarms)),
        front=tuple(_chapter(chapter, words) for chapter in document.front),
        chapters=tuple(_chapter(chapter, words) for chapter in document.chapters),
        warnings=tuple(map(words.said, document.warnings)),
    )


def _chapter(chapter: Chapter, words: Wording) -> Chapter:
    inside = words.at(STUDY) if chapter.title.startswith("Study: ") else words
    return replace(chapter, title=words.said(chapter.title), blocks=_blocks(chapter.blocks, inside))


def _blocks(blocks: Iterable[BlockView], words: Wording) -> tuple[BlockView, ...]:
    return tuple(_block(block, words) for block in blocks)


def _block(block: BlockView, words: Wording) -> BlockView:
    match block:
        case Paragraph(text):
            return replace(block, text=_text(text, words))
        case Items():
            return _items(block, words)
        case TableView():
            return _table(block, words)
        case FigureView():  # its drawing has them since it was drawn
            return replace(block, title=words.said(block.title), caption=words.said(block.caption))
        case FigurePair(title):  # each of the two has the words of its own sheet
            return replace(block, title=words.said(title))
        case ResultEntry():
            label, value, method = (_text(text, words) for text in (block.label, block.value, block.method))
            return replace(block, label=label, value=value, method=method)
        case Fold(title, inner):
            return replace(block, title=words.said(title), blocks=_blocks(inner, words))


def _items(items: Items, words: Wording) -> Items:
    inside = words.at(items.kind) if items.kind in READ_ELSEWHERE else words
    labels = tuple(map(words.said, items.labels))
    if items.kind != "provenance":
        return replace(items, texts=_texts(items.texts, inside), labels=labels)
    pairs = zip(items.texts, items.labels, strict=True)
    return replace(items, texts=tuple(_text(text, inside.at(label)) for text, label in pairs), labels=labels)


def _table(table: TableView, words: Wording) -> TableView:
    columns = tuple(replace(column, title=words.said(words.name(column.title))) for column in table.columns)
    rows = tuple(_texts(row, words) for row in table.rows)
    return replace(table, title=words.said(table.title), columns=columns, rows=rows, note=_text(table.note, words))


def _texts(texts: Iterable[Text], words: Wording) -> tuple[Text, ...]:
    return tuple(_text(text, words) for text in texts)


def _text(text: Text, words: Wording) -> Text:
    """Say every piece anew; where a name in files follows, the first piece is what its author calls it."""
    if not isinstance(text, tuple):
        return _piece(text, words.said, words)
    is_label = any(isinstance(piece, Marked) and piece.kind == "bracketed code" for piece in text)
    first: Callable[[str], str] = words.name if is_label else words.said
    return tuple(_piece(piece, words.said if index else first, words) for index, piece in enumerate(text))


def _piece(piece: Piece, said: Callable[[str], str], words: Wording) -> Piece:
    match piece:
        case str():
            return said(piece)
        case Value(text, unit):
            return Value(words.said(text), unit)
        case Marked("strong" | "aside", Value(text, unit)):
            return replace(piece, text=Value(words.said(text), unit))
        case Marked("strong" | "aside" | "break", str() as text):
            return replace(piece, text=words.said(text))
        case Marked("state", state):
            return replace(piece, word=words.said(STATES[str(state)][1]))
        case _:
            return piece
