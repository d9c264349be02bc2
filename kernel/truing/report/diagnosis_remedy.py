"""What the machine does with the named causes, and would do without them: limits and measured results side by side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from truing.calculation import Calculation, calculate
from truing.diagnosis.result import Amount, DiagnosisResult
from truing.errors import InfeasibleError, PluginError
from truing.numbers import ABSENT, with_unit
from truing.report.diagnosis_sizes import amount_text, readable
from truing.report.diagnosis_words import spoken
from truing.report.document import Column, Marked, TableView, Text
from truing.report.limits import check_rows
from truing.setup import Setup
from truing.units import difference_unit

DIGITS = 8
TITLE = "What the machine does now, and would do without what was named"
NOTE = (
    "For the inputs as they are stated, fitted to this machine within their tolerances, and conditions as in the "
    "middle of the record."
)


def then_table(diagnosis: DiagnosisResult) -> TableView | None:
    """Set limits and measured results with the named causes beside those without; None where none is named for sure."""
    if diagnosis.extended is None or diagnosis.verdict != "named":
        return None
    try:
        now, then = (calculate(replace(setup, studies=())) for setup in _setups(diagnosis, diagnosis.extended))
    except (InfeasibleError, PluginError):
        return None
    rows = [*_limits(now, then), *_results(diagnosis, now, then)]
    heads = (
        Column("", kind="name"), Column("Now", kind="number"), Column("Without it", kind="number"),
        Column("Limit", kind="number"), Column("Verdict"),
    )  # fmt: skip
    return TableView(TITLE, heads, tuple(rows), NOTE) if rows else None


def _setups(diagnosis: DiagnosisResult, extended: Setup) -> tuple[Setup, Setup]:
    """Return the machine as it is, and with its causes mended: effects off, inputs at their nominal values."""
    named = {cause.effect.removeprefix("input:") for cause in diagnosis.causes}
    mended = replace(
        extended,
        effects=tuple(active for active in extended.effects if active.effect.name not in named),
        calibrated={name: value for name, value in extended.calibrated.items() if name not in named},
    )
    return extended, mended


def _limits(now: Calculation, then: Calculation) -> Iterator[tuple[Text, ...]]:
    """Give every limit that needs no study, before and after."""
    mended = {row.check.name: row for row in check_rows(then)}
    for row in check_rows(now):
        after = mended.get(row.check.name)
        if after is None or row.check.undecided or row.check.chance:
            continue
        limit = f"{row.check.relation} {with_unit(row.limit.text, row.limit.unit)}"
        states = [Marked("state", state) for state in dict.fromkeys((row.check.state, after.check.state))]
        verdict: Text = states[0] if len(states) == 1 else (states[0], ", then ", states[1])
        yield row.note or spoken(row.check.name), row.value, after.value, limit, verdict


def _results(diagnosis: DiagnosisResult, now: Calculation, then: Calculation) -> Iterator[tuple[Text, ...]]:
    """Give by how much every measured result would change."""
    for name in diagnosis.measured:
        before, after = (np.asarray(each.answers.get(name, np.nan), dtype=float) for each in (now, then))
        if before.ndim or not np.isfinite(after - before) or after == before:
            continue
        unit = diagnosis.setup.print_unit(name)
        change = readable(Amount(float(after - before), diagnosis.units.get(name) or difference_unit(unit)))
        sizes = (amount_text(Amount(float(value), unit), DIGITS) for value in (before, after))
        yield spoken(name), *sizes, ABSENT, f"changes by {amount_text(change)}"
