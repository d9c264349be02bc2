"""What a notebook shows: tables, pictures and fold-outs as HTML that asks for nothing and sets no colour of its own."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from html import escape
from io import BytesIO

from matplotlib.figure import Figure

from truing.report.document import TableView, plain_text
from truing.report.figures import styled
from truing.texts import one_line

DPI = 110
"""Dots per inch of a picture in a notebook: 700 across the usual width of 6.4 inches, some 30 kB."""
LARGEST = 95_000
"""Bytes of HTML that one object shows at most, so that a notebook of many stays small."""
LEFT_OUT = "There is more than a notebook should hold; the dataframe and the sheet have all of it."
MOST_ROWS = 60
"""So many rows of a table are shown; the dataframe holds all."""
LONGEST = 200
"""A cell with more characters is cut."""


def plotted(draw: Callable[[], Figure]) -> Figure:
    """Return a figure with the look of the sheet, which a notebook shows whether pyplot is loaded or not."""
    with styled():
        figure = draw()
    figure._repr_png_ = partial(png_of, figure)  # type: ignore[attr-defined]
    return figure


def png_of(figure: Figure) -> bytes:
    """Return a figure as PNG, on white."""
    stream = BytesIO()
    with styled():
        figure.savefig(stream, format="png", dpi=DPI)
    return stream.getvalue()


def picture(draw: Callable[[], Figure], title: str) -> str:
    """Return a figure as a picture inside of the HTML."""
    data = b64encode(png_of(plotted(draw))).decode("ascii")
    return f'<img alt="{escape(title)}" style="max-width: 100%" src="data:image/png;base64,{data}">'


def heading(text: str) -> str:
    """Return the title of an object."""
    return f"<p><b>{escape(one_line(text))}</b></p>"


def paragraphs(sentences: Iterable[str]) -> str:
    """Return sentences, each on its own."""
    return "".join(f"<p>{escape(one_line(sentence))}</p>" for sentence in sentences)


def bullets(lines: Iterable[str]) -> str:
    """Return lines as a list."""
    return "<ul>" + "".join(f"<li>{escape(one_line(line))}</li>" for line in lines) + "</ul>"


def html_table(rows: Sequence[Sequence[object]], head: Sequence[str] = ()) -> str:
    """Return rows as a table, every cell escaped and flush left; very many rows and very long cells are cut."""
    titles = f"<thead><tr>{''.join(_cell('th', title) for title in head)}</tr></thead>" if head else ""
    lines = "".join(f"<tr>{''.join(_cell('td', cell) for cell in row)}</tr>" for row in rows[:MOST_ROWS])
    more = f"<p>{len(rows) - MOST_ROWS} further rows</p>" if len(rows) > MOST_ROWS else ""
    return f"<table>{titles}<tbody>{lines}</tbody></table>{more}"


def table_html(table: TableView) -> str:
    """Return a table of a document, with its title and its note."""
    heads = [column.heading for column in table.columns]
    rows = [[plain_text(cell) for cell in row] for row in table.rows]
    note = paragraphs([plain_text(table.note)]) if table.note else ""
    return (heading(table.title) if table.title else "") + html_table(rows, heads) + note


def _cell(tag: str, content: object) -> str:
    text = one_line(content)
    return f'<{tag} style="text-align: left">{escape(text if len(text) <= LONGEST else text[:LONGEST] + "…")}</{tag}>'


def joined(*parts: str) -> str:
    """Return parts one below the other, as many as fit into ``LARGEST``, and say where some do not."""
    shown: list[str] = []
    size = 0
    for part in parts:
        size += len(part.encode())
        if size > LARGEST:
            return "".join([*shown, paragraphs([LEFT_OUT])])
        shown.append(part)
    return "".join(shown)


def fold(title: str, content: str) -> str:
    """Return what is hidden until its title is clicked, which needs no script."""
    return f"<details><summary>{escape(title)}</summary>{content}</details>" if content else ""
