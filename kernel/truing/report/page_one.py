"""Page one of a calculation: limits, key results, the figure that shows the thing, changed inputs, warnings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from truing.calculation import Calculation
from truing.declare.model import Model
from truing.report.chapters import result_table
from truing.report.document import (
    BlockView,
    Chapter,
    Column,
    Items,
    Paragraph,
    TableView,
    Text,
    joined,
    label_of,
    lines_of,
    symbol_cell,
)
from truing.report.given import input_value
from truing.report.limits import MOST_CHECKS, check_table
from truing.setup import Setup

MOST_RESULTS, MOST_CHANGES, MOST_WARNINGS = 10, 6, 3
"""So many results, changed inputs and warnings stand on page one; what is more stands behind it."""
LINES, FEWEST_LINES = 25, 9
"""Lines of tables and lists that have room on a page, and those that are kept for results and figure."""
WIDE, NARROW = 90, 28
"""Characters of a line: over the whole page, and in the table of results beside the figure."""
LINE, CAPTION, HIGHEST = 4.6, 14.0, 66.0
"""Height of a line, of the words below a figure, and of a figure beside the results at the most, mm."""
LOW_BELOW, HIGH_BELOW = 75.0, 112.0
"""Where so much room is left below the results, the figure stands there, over the whole width, at the most so high."""
SAME = 1e-12
"""Share by which two inputs differ only by how they are rounded."""


@dataclass(frozen=True)
class PageOne:
    """What stands between the verdict and the signatures; how high its figure is on paper (mm), and where."""

    chapters: tuple[Chapter, ...]
    figure_height: float
    figure_below: bool


def page_one(
    calculation: Calculation, example: Setup | None, figure: Chapter | None, warnings: Sequence[str]
) -> PageOne:  # fmt: skip
    """Put page one together: what there is besides leaves its room to the key results and the figure."""
    setup = calculation.setup
    checks = [Chapter("Checks", (check_table(calculation, most=MOST_CHECKS),), "checks")] if calculation.checks else []
    changed = [] if example is None else changed_inputs(setup, example)
    besides = sum(2 if check.chance else 1 for check in calculation.checks[:MOST_CHECKS])
    besides += sum(lines_of(setup.model.input_fields[name].spec.note, WIDE) for name in changed[:MOST_CHANGES])
    besides += sum(lines_of(text, WIDE) for text in warnings[:MOST_WARNINGS])
    room = max(LINES - besides, FEWEST_LINES)
    results = list(_fitting(calculation, key_results(calculation), room, NARROW if figure else WIDE))
    keys = [Chapter("Key results", (result_table(calculation, results),), "key-results")] if results else []
    changes = () if example is None else tuple(_changed(setup, example, changed))
    chapters = [
        *checks, *keys, *([figure] if figure else []),
        *([Chapter("Inputs against the example", changes, "changes")] if changes else []), *_warned(warnings),
    ]  # fmt: skip
    notes = [setup.model.result_fields[name].spec.note for name in results]
    below = LINE * (room - sum(lines_of(note, WIDE) for note in notes)) - CAPTION
    if below >= LOW_BELOW:
        return PageOne(tuple(chapters), min(HIGH_BELOW, below), figure_below=True)
    return PageOne(tuple(chapters), min(HIGHEST, LINE * room - CAPTION), figure_below=False)


def _warned(warnings: Sequence[str]) -> Iterator[Chapter]:
    left = len(warnings) - MOST_WARNINGS
    more = (f"{left} more are in the chapter of warnings.",) if left > 0 else ()
    if warnings:
        items = Items("warnings", (*warnings[:MOST_WARNINGS], *more))
        yield Chapter("Warnings", (items,), "first-warnings" if more else "warnings")


def _fitting(calculation: Calculation, names: Sequence[str], room: int, width: int) -> Iterator[str]:
    """Give the first results whose rows have room together."""
    fields = calculation.setup.model.result_fields
    for name in names[:MOST_RESULTS]:
        room -= lines_of(fields[name].spec.note, width)
        if room < 0:
            return
        yield name


def key_results(calculation: Calculation) -> list[str]:
    """Return the results that are declared as keys; else, where there is no limit, the first that are one number."""
    model, answers = calculation.setup.model, calculation.answers
    checked = {check.name for check in calculation.checks if not check.chance}
    known = [name for name in in_order_of_sheet(model) if name in answers or name in calculation.absent]
    keys = [name for name in known if getattr(model.result_fields[name].spec, "key", False)]
    if keys or calculation.checks:
        return [name for name in keys if name not in checked]
    return [name for name in known if getattr(answers.get(name), "ndim", 0) == 0]


def in_order_of_sheet(model: Model[Any, Any]) -> list[str]:
    """Return all results, those first that the sections name."""
    named = (name for section in model.sheet for name in section.names if name in model.result_fields)
    return list(dict.fromkeys([*named, *model.result_fields]))


# Inputs that differ from the example, and what acts besides


def changed_inputs(setup: Setup, example: Setup) -> list[str]:
    """Return the inputs that are others than those of the example."""
    values = _inputs(setup), _inputs(example)
    return [name for name in setup.model.input_fields if _differs(setup, example, name, values)]


def _changed(setup: Setup, example: Setup, names: Sequence[str]) -> Iterator[BlockView]:
    if names:
        yield _change_table(setup, example, names[:MOST_CHANGES])
    else:
        yield Paragraph("All inputs are those of the shipped example.")
    if len(names) > MOST_CHANGES:
        yield Paragraph(f"{len(names) - MOST_CHANGES} more are among the inputs.", "aside")
    if setup.effects:
        effects = joined(active.effect.name.replace("_", " ") for active in setup.effects)
        yield Paragraph(("Effects that are on: ", *effects, "."))


def _change_table(setup: Setup, example: Setup, names: Sequence[str]) -> TableView:
    columns = (
        Column("Symbol", kind="symbol"), Column("Input", kind="name"), Column("Value", kind="number"),
        Column("In the example", kind="number"),
    )  # fmt: skip
    rows: list[tuple[Text, ...]] = []
    known = [(setup, _inputs(setup)), (example, _inputs(example))]
    for name in names:
        field = setup.model.input_fields[name]
        shown = (input_value(each, field, values[name]) for each, values in known)
        rows.append((symbol_cell(field.symbol), label_of(field.spec.note, name), *shown))
    return TableView("", columns, tuple(rows), kind="key")


def _inputs(setup: Setup) -> Mapping[str, Any]:
    return setup.model.read_inputs(setup.inputs)


def _differs(setup: Setup, example: Setup, name: str, values: Sequence[Mapping[str, Any]]) -> bool:
    """Whether an input is another one than in the example: another number but for rounding, word or file."""
    if setup.model.input_fields[name].kind == "file":
        own, other = (each.source.tables.get(name, {}) for each in (setup, example))
        return any(own.get(key) != other.get(key) for key in {*own, *other} - {"file"}) or _file(own) != _file(other)
    own, other = (each[name] for each in values)
    if isinstance(own, (str, bool)) or isinstance(other, (str, bool)):
        return bool(own != other)
    return np.shape(own) != np.shape(other) or not np.allclose(own, other, rtol=SAME, atol=0, equal_nan=True)


def _file(table: Mapping[str, Any]) -> str:
    return str(table.get("file", "")).replace("\\", "/").rpartition("/")[2]
