"""calc sweep: how the results run along one input, or two, drawn with their limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from truing.api.study import StudyResult
from truing.cli.console import Settings, aligned, broken, out, out_json
from truing.cli.load import find_model, say_example
from truing.declare.blocks import Table
from truing.numbers import format_number
from truing.studies.sweep import Swept
from truing.texts import one_line
from truing.units import unit_text

MOST_ROWS, MOST_COLUMNS = 11, 8
"""So many points and results are printed; the file of the points holds all."""


def sweep(settings: Settings, asked: SimpleNamespace) -> int:
    """Evaluate results along an input, print a few points and where limits are met, write sheet and points."""
    model = find_model(asked.plugin, settings, asked.changed, asked.language)
    say_example(asked.inputs, asked.plugin, settings)
    folder = asked.output or Path("runs") / f"{asked.inputs.stem if asked.inputs else model.name}_sweep"
    results = tuple(name.strip() for name in asked.results.split(",") if name.strip())
    found = model.sweep(
        asked.input, f"{asked.range} {asked.unit}".strip(), over=asked.over, results=results, points=asked.steps,
        inputs=asked.inputs, output=folder, progress=not settings.quiet,
    )  # fmt: skip
    assert isinstance(found.outcome, Swept)
    for warning in found.warnings:
        settings.say(f"warning: {one_line(warning)}")
    if asked.as_json:
        out_json(found.document)
    else:
        out("\n".join([f"{model.name}: {one_line(model.title)}", "", *_lines(found, found.outcome, folder)]))
    return 0 if len(found.outcome.failed) < len(found.outcome.axis) else 1


def _lines(found: StudyResult, swept: Swept, folder: Path) -> Iterator[str]:
    names = swept.moving()
    if names:
        yield from _points(swept, names[:MOST_COLUMNS])
    if len(names) > MOST_COLUMNS:
        yield f"{len(names) - MOST_COLUMNS} further results stand in the file of the points"
    limits = swept.limit_table()
    if limits.rows:
        yield ""
        yield from _table(limits)
    for text in swept.gaps():
        yield ""
        yield from broken(one_line(text), 0)
    yield ""
    yield f"sheet: {folder / 'sheet.html'}"
    yield f"points: {folder / 'points.csv'}"


def _points(swept: Swept, names: Sequence[str]) -> Iterator[str]:
    """Give evenly chosen points of every line, first and last among them."""
    columns = swept.printed_columns(names)
    count = len(np.unique(swept.by_axis)) if swept.by else 1
    line = len(swept.axis) // count
    chosen = np.unique(np.linspace(0, line - 1, min(line, MOST_ROWS)).round().astype(int))
    rows = [[format_number(values[start + at]) for values in columns.values()]
            for start in range(0, line * count, line) for at in chosen]  # fmt: skip
    units = [unit_text(swept.units[name]) for name in (*swept.columns, *names)]
    yield from aligned([[*swept.columns, *names], units, *rows], right=range(len(columns)))


def _table(table: Table) -> Iterator[str]:
    """Write a table of a study: its titles with units, then its rows."""
    units = (f" [{unit_text(unit)}]" if unit else "" for unit in table.units)
    heads = [f"{name}{unit}" for name, unit in zip(table.columns, units, strict=True)]
    cells = [[cell if isinstance(cell, str) else format_number(cell) for cell in row] for row in table.rows]
    numbers = [index for index in range(len(heads)) if not isinstance(table.rows[0][index], str)]
    yield from aligned([heads, *cells], right=numbers)
