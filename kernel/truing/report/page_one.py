"""Page one of a calculation: limits, key results, the figure that shows the thing, changed inputs, warnings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from truing.calculation import Calculation
from truing.declare.model import Model
from truing.report.chapters import result_table
from truing.report.document import (
    BlockView,
    Chapter,
    Column,
    FigureView,
    Items,
    Marked,
    Paragraph,
    TableView,
    Text,
    joined,
    label_of,
)
from truing.report.given import input_value
from truing.report.limits import check_table
from truing.setup import Setup

MOST_CHECKS, MOST_RESULTS, MOST_CHANGES, MOST_WARNINGS = 8, 10, 6, 3
"""So many limits, results, changed inputs and warnings stand on page one; what is more stands behind it."""
MOST_ROWS, FEWEST_RESULTS = 20, 4
"""So many rows of all of them have room on a page; results give way first, down to so few."""
SAME = 1e-12
"""Share by which two inputs differ only by how they are rounded."""


def page_one(
    calculation: Calculation, example: Setup | None, figure: FigureView | None, warnings: Sequence[str]
) -> Iterator[Chapter]:  # fmt: skip
    """Give what stands between the verdict and the signatures."""
    if calculation.checks:
        yield Chapter("Checks", (check_table(calculation, most=MOST_CHECKS),), "checks")
    changed = [] if example is None else changed_inputs(calculation.setup, example)
    others = (len(calculation.checks), MOST_CHECKS), (len(changed), MOST_CHANGES), (len(warnings), MOST_WARNINGS)
    room = MOST_ROWS - sum(min(count, most) for count, most in others)
    results = key_results(calculation)[: min(max(room, FEWEST_RESULTS), MOST_RESULTS)]
    if results:
        yield Chapter("Key results", (result_table(calculation, results),), "key-results")
    if figure is not None:
        yield Chapter(figure.title, (figure,), "key-figure")
    if example is not None:
        yield Chapter("Inputs against the example", tuple(_changed(calculation.setup, example, changed)), "changes")
    if warnings:
        shown, left = tuple(warnings[:MOST_WARNINGS]), len(warnings) - MOST_WARNINGS
        more = (f"{left} more are in the chapter of warnings.",) if left > 0 else ()
        yield Chapter("Warnings", (Items("warnings", (*shown, *more)),), "warnings" if left <= 0 else "first-warnings")


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
    return [name for name in setup.model.input_fields if _differs(setup, example, name)]


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
    for name in names:
        field = setup.model.input_fields[name]
        symbol = Marked("symbol", field.symbol) if field.symbol else ""
        values = (input_value(each, field, _inputs(each)[name]) for each in (setup, example))
        rows.append((symbol, label_of(field.spec.note, name), *values))
    return TableView("", columns, tuple(rows), kind="key")


def _inputs(setup: Setup) -> Mapping[str, Any]:
    return setup.model.read_inputs(setup.inputs)


def _differs(setup: Setup, example: Setup, name: str) -> bool:
    """Whether an input is another one than in the example: another number but for rounding, word or file."""
    if setup.model.input_fields[name].kind == "file":
        own, other = (each.source.tables.get(name, {}) for each in (setup, example))
        return any(own.get(key) != other.get(key) for key in {*own, *other} - {"file"}) or _file(own) != _file(other)
    own, other = (_inputs(each)[name] for each in (setup, example))
    if isinstance(own, (str, bool)) or isinstance(other, (str, bool)):
        return bool(own != other)
    return np.shape(own) != np.shape(other) or not np.allclose(own, other, rtol=SAME, atol=0, equal_nan=True)


def _file(table: Mapping[str, Any]) -> str:
    return str(table.get("file", "")).replace("\\", "/").rpartition("/")[2]
