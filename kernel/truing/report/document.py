"""What a run or a diagnosis says, without markup: chapters of blocks, which every printer prints in its own way.

A block is a paragraph, a list, a table, a figure, or a result with its formula. Its texts are made of pieces: words,
numbers with units, symbols, names. HTML (``html_printer``), Markdown (``markdown_printer``) and the notebook print
them. Texts in here are raw: they come from users and plugins, and only the printers know how to make them harmless.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from truing.errors import UnitError
from truing.formulas import Formula, symbol_text
from truing.numbers import pretty, with_unit
from truing.runs.provenance import Provenance
from truing.studies.checks import SHORT
from truing.templating import ENGLISH
from truing.units import unit_text

MARKS = {
    "passes": "✓", "proposed": "!", "undecided": "?", "fails": "✗", "none": "○", "calm": "✓", "found": "●", "open": "?",
}  # fmt: skip
"""The sign before a verdict: of a limit or a run, and of a diagnosis (calm, found, open)."""
STATES = {str(state): (MARKS[state], word) for state, word in SHORT.items()}
"""The sign and the word for the state of a limit."""


# Pieces of a text


@dataclass(frozen=True)
class Value:
    """A number as printed, with the unit as printed."""

    text: str
    unit: str = ""


@dataclass(frozen=True)
class Marked:
    """A text that is set in a way of its own.

    ``kind``: symbol (of a quantity, as declared: h_0), code (a name as it stands in files; bracketed where it stands
    behind words that say the same), strong (what is to be seen first), aside (what is less important than the words
    before it), source (literature), break (the end of a line; on a single line its text stands there),
    state (of a limit: a sign and a word).
    """

    kind: Literal["symbol", "code", "bracketed code", "strong", "aside", "source", "break", "state"]
    text: str | Value
    word: str = ""
    """Of a state: what it is called, where that is not the English word."""


Piece: TypeAlias = str | Value | Marked
Text: TypeAlias = Piece | tuple[Piece, ...]


def label_of(note: str, name: str, symbol: str = "") -> tuple[Piece, ...]:
    """Say what a quantity is, and its name in files."""
    shown = (" ", Marked("symbol", symbol)) if symbol else ()
    return (note or name.replace("_", " "), *shown, " ", Marked("bracketed code", name))


def symbol_cell(symbol: str) -> Text:
    """Write a symbol alone; nothing where there is none."""
    return Marked("symbol", symbol) if symbol else ""


def lines_of(text: str, width: int) -> int:
    """Count the lines of so many characters that a text takes, one at the least."""
    return max(1, -(-len(text) // width))


def joined(parts: Iterable[Text], between: Piece = ", ") -> tuple[Piece, ...]:
    """Join texts to one."""
    pieces: list[Piece] = []
    for part in parts:
        pieces += [*([between] if pieces else []), *(part if isinstance(part, tuple) else (part,))]
    return tuple(pieces)


def plain_text(text: Text) -> str:
    """Write a text without markup, on one line."""
    return "".join(map(_plain, text if isinstance(text, tuple) else (text,)))


def _plain(piece: Piece) -> str:
    match piece:
        case str():
            return pretty(piece)
        case Value(number, unit):
            return with_unit(pretty(number), unit)
        case Marked("symbol", symbol):
            return symbol_text(str(symbol))
        case Marked("bracketed code" | "source", name):
            return f"({name})"
        case Marked("break" | "code", text):
            return str(text)
        case Marked("state"):
            return " ".join(state_words(piece))
        case Marked(_, inner):
            return _plain(inner)


def state_words(state: Marked) -> tuple[str, str]:
    """Return the sign and the word for the state of a limit."""
    sign, word = STATES[str(state.text)]
    return sign, state.word or word


def unit_as_said(unit: str) -> str:
    """Write a unit for print; a heading that is no unit stays as it is."""
    try:
        return unit_text(unit) if unit else ""
    except UnitError:
        return unit


def with_source(words: str, source: str) -> Text:
    """Return words with the literature behind them."""
    return joined(filter(None, (words, Marked("source", source) if source else "")), " ")


# Blocks


@dataclass(frozen=True)
class Paragraph:
    """A paragraph: a note, a finding, a warning, or an aside."""

    text: Text
    kind: str = "note"


@dataclass(frozen=True)
class Items:
    """A list of texts, with or without a label for each. ``kind``: warnings, references, findings, provenance."""

    kind: str
    texts: tuple[Text, ...]
    labels: tuple[str, ...] = ()


@dataclass(frozen=True)
class Column:
    """The head of a column: its title, the unit of its numbers, and the kind of its cells.

    ``kind``: "" (texts), number, name (what the row is about), symbol, units, given, relation, verdict-cell.
    """

    title: str
    unit: str = ""
    kind: str = ""

    @property
    def heading(self) -> str:
        """The title, with its unit in brackets."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


@dataclass(frozen=True)
class TableView:
    """A table of finished texts. ``states`` says of each row how it looks: as a limit of that state, or "marked"."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Text, ...], ...]
    note: Text = ""
    states: tuple[str, ...] = ()
    kind: str = ""


@dataclass(frozen=True)
class FigureView:
    """A figure as SVG, with the words that stand for it where it cannot be seen.

    ``drawing`` makes the matplotlib Figure anew, for a printer that needs another form of it.
    """

    title: str
    svg: str
    caption: str
    number: int
    drawing: Callable[[], Any] = field(repr=False, compare=False)


@dataclass(frozen=True)
class FigurePair:
    """A figure of two sheets side by side: as it was and as it is, None where one of the two has none."""

    title: str
    number: int
    before: FigureView | None
    after: FigureView | None


@dataclass(frozen=True)
class Equation:
    """A formula ready to be set: in symbols, in numbers (None where a name runs along an axis), and its result."""

    formula: Formula
    name: str
    symbol: str
    symbols: Mapping[str, str]
    numbers: Mapping[str, tuple[str, str]] | None
    results: tuple[Value, ...]
    change: str = ""
    """Of a state: the formula is its "rate", or what it is at the "next" time."""
    departs: bool = False
    """Whether the calculation's own answer is another one than the formula's: an effect on the results is on."""


@dataclass(frozen=True)
class ResultEntry:
    """One result: its formula with numbers, what is said of its value beside that, and how it was found."""

    name: str
    label: Text
    equation: Equation | None = None
    value: Text = ""
    method: Text = ""


@dataclass(frozen=True)
class Fold:
    """What stands behind the words: a screen shows the title until more is asked for, paper all if ``printed``."""

    title: str
    blocks: tuple[BlockView, ...]
    printed: bool = True


BlockView: TypeAlias = "Paragraph | Items | TableView | FigureView | FigurePair | ResultEntry | Fold"


def table_of(
    title: str, columns: Sequence[str], rows: Iterable[Sequence[Text]], numeric: Sequence[int] = (), note: str = ""
) -> TableView:
    """Return a table of texts; ``numeric`` holds the indices of the columns that are set to the right."""
    heads = tuple(Column(column, kind="number" if index in numeric else "") for index, column in enumerate(columns))
    return TableView(title, heads, tuple(map(tuple, rows)), note)


# The whole


@dataclass(frozen=True)
class Chapter:
    """A part of the sheet with a number and a title."""

    title: str
    blocks: tuple[BlockView, ...]
    ident: str = ""
    number: str = ""
    inside: bool = False
    """Whether it belongs to the chapter before it: one calculation of several has a chapter of chapters."""
    lines: tuple[str, ...] = ()
    """What a terminal and a notebook print of it; a line that begins with spaces belongs to the one above."""


@dataclass(frozen=True)
class Head:
    """The title block."""

    title: str
    model: str
    fields: tuple[tuple[str, str], ...]
    signatures: tuple[tuple[str, str], ...]
    footer: str
    logo: str = ""
    """A picture as a data address, or nothing."""
    letter: tuple[str, ...] = ()
    """Who writes: the company, and its address below."""
    style: str = ""
    """The text of a style sheet of the engineer's own, which comes after that of the sheet."""


@dataclass(frozen=True)
class Banner:
    """The verdict below the title block: ``mood`` is how it looks, a key of ``MARKS``; the headline, then sentences."""

    mood: str
    headline: str
    sentences: tuple[Text, ...]


@dataclass(frozen=True, kw_only=True)
class Document:
    """Everything that a calculation or a diagnosis says, in order."""

    kind: str
    title: str
    """What the document is called by itself, without its title block."""
    head: Head
    detail: str
    summary: str
    banner: Banner
    alarms: tuple[str, ...] = ()
    """Suspected errors in the units of a record."""
    front: tuple[Chapter, ...] = ()
    """What stands on page one, before the signatures."""
    figure_height: float = 95.0
    """How high the figure of page one is on paper, mm."""
    figure_below: bool = False
    """Whether it stands there below the key results, instead of beside them."""
    chapters: tuple[Chapter, ...]
    warnings: tuple[str, ...]
    provenance: Provenance
    paper: str = "A4"
    """On which it is printed: a name that CSS knows."""
    language: str = ENGLISH
