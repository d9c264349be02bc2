"""A chain of calculations on the sheet: which of them goes on with what of which other, as a drawing and a table."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text

from truing.declare.chain import Chain, chain_of, prefix_of
from truing.evaluate import taken_values
from truing.numbers import RESULT_DIGITS, format_value
from truing.report.document import Chapter, Column, Paragraph, TableView, label_of
from truing.setup import Setup

TITLE = "Chain of calculations"
BOX_WIDTH, BOX_HEIGHT, GAP = 2.0, 0.62, 1.9
"""Size of a box in the drawing and way between two columns of them, inches."""
LINE, MARGIN = 0.17, 0.15


def chain_chapter(setup: Setup, view: Any) -> Iterator[Chapter]:
    """Draw the graph of a chain and list what is taken; ``view(title, draw, caption)`` draws. Nothing of one alone."""
    chain = chain_of(setup.model)
    if chain is None:
        return
    caption = "The calculations of the chain; along each arrow what one takes from the other."
    said = (
        "Every calculation goes on with what those before it answer, machine by machine: what scatters there, and the "
        "effects that are on there, act here too."
    )
    yield Chapter(
        TITLE, (Paragraph(said), view(TITLE, partial(graph_figure, chain), caption), links_table(setup, chain)), "chain"
    )


def links_table(setup: Setup, chain: Chain) -> TableView:
    """List what is taken from where, with its value; what is stated in its place says so."""
    values = taken_values(setup)
    columns = (
        Column("Input", kind="name"), Column("Calculation"), Column("Taken", kind="name"), Column("From"),
        Column("Value", kind="number"), Column("Unit", kind="units"),
    )  # fmt: skip
    rows = []
    for name, link in chain.taken.items():
        field = setup.model.input_fields[name]
        taken = chain.field_of(link)
        value, unit = format_value(values[name], setup.print_unit(name), RESULT_DIGITS) if name in values else ("", "")
        rows.append(
            (
                label_of(chain.model_of(link.owner).input_fields[link.input].spec.note, link.input, field.symbol),
                link.owner or chain.last.name, label_of(taken.spec.note, link.result, taken.symbol), link.source,
                value or "stated", unit,
            )
        )  # fmt: skip
    return TableView("What is taken", columns, tuple(rows))


def depths(chain: Chain) -> dict[str, int]:
    """Return how many calculations stand before each, "" being the last one."""
    depth: dict[str, int] = {}
    for name in [*chain.sources, ""]:
        depth[name] = max((depth[link.source] + 1 for link in chain.links if link.owner == name), default=0)
    return depth


def graph_figure(chain: Chain) -> Figure:
    """Draw the calculations as boxes, from left to right, and what is taken as arrows with the names of it."""
    depth = depths(chain)
    columns = [[name for name in depth if depth[name] == column] for column in range(max(depth.values()) + 1)]
    taken: dict[tuple[str, str], list[str]] = {}
    for link in chain.links:
        word = link.input if link.input == link.result else f"{link.result} → {link.input}"
        taken.setdefault((link.source, link.owner), []).append(word)
    row = BOX_HEIGHT + 2 * MARGIN + LINE * max(map(len, taken.values()))
    high, wide = row * max(map(len, columns)), len(columns) * BOX_WIDTH + (len(columns) - 1) * GAP + 2 * MARGIN
    figure = Figure(figsize=(wide, high))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0, wide), ylim=(0, high))
    axes.set_axis_off()
    boxes: dict[str, Text] = {}
    for place, names in enumerate(columns):
        for index, name in enumerate(names):
            centre = MARGIN + BOX_WIDTH / 2 + place * (BOX_WIDTH + GAP), high * (1 - (index + 0.5) / len(names))
            box = {"boxstyle": "round,pad=0.5", "facecolor": "#eef2f6", "edgecolor": "#333333", "linewidth": 0.8}
            said = chain.name_in_words(name).replace(", ", "\n")
            boxes[name] = axes.text(*centre, said, ha="center", va="center", bbox=box, fontsize=9)
    for (source, owner), words in taken.items():
        start, end = boxes[source], boxes[owner]
        ends = {"patchA": start.get_bbox_patch(), "patchB": end.get_bbox_patch()}
        style = {"arrowstyle": "-|>", "color": "#333333", "linewidth": 1.0, **ends}
        axes.annotate("", xy=end.get_position(), xytext=start.get_position(), arrowprops=style)
        x, y = np.mean([start.get_position(), end.get_position()], axis=0)
        label = {"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none"}
        listed = "\n".join(word.replace("_", " ") for word in words)
        axes.text(x, y, listed, ha="center", va="center", fontsize=7.5, bbox=label)
    return figure


def head_of_calculation(chain: Chain, of: str) -> Chapter:
    """Return the chapter that begins what is said of one calculation of a chain."""
    own = chain.model_of(of)
    said = f"Names begin with {prefix_of(of)} in files." if of else "Names stand in files as they are."
    words = [Paragraph(own.summary)] if own.summary else []
    return Chapter(f"{own.title} ({chain.name_in_words(of)})", (*words, Paragraph(said, "aside")))
