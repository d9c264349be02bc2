"""The record as it was read, before any cause is looked for: rows, ranges, gaps, units, a first look at the errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from truing.arrays import Indices, Matrix
from truing.diagnosis.records import Covariate, file_labels
from truing.diagnosis.result import Amount, DiagnosisResult
from truing.numbers import ABSENT, counted
from truing.report import diagnosis_figures as figures
from truing.report.chapters import Figures
from truing.report.diagnosis_sizes import amount_text
from truing.report.diagnosis_words import spoken
from truing.report.document import BlockView, Fold, Paragraph, TableView, table_of
from truing.units import difference_unit, unit_text

ROLES = {"input": "input", "condition": "condition", "time": "time", "other": "not used by the model", "order": "order"}
GAP = 3.0
"""A step of time longer than so many usual ones is a gap."""
MOST_ROWS = 200
"""So many rows of a record are printed."""


def record_blocks(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    """Say what was read, so that a wrong column is seen before any cause."""
    yield _files(diagnosis)
    for label, count in zip(file_labels(diagnosis.records.files), diagnosis.records.counts, strict=True):
        if count.unused:
            yield Paragraph(f"{label}: {count.sentence()}.")
    yield _columns(diagnosis)
    yield _readings(diagnosis)
    title = "The record as it was read"
    caption = f"{title}: what changed, and below it what was measured, row by row."
    if len(np.unique(diagnosis.records.run_of)) > 1:
        caption += " A line parts two runs."
    yield drawn.view(title, partial(figures.course_of_record, diagnosis), caption)
    for sentence in diagnosis.records.notes:
        yield Paragraph(sentence.rstrip(".") + ".")
    yield Fold("The rows as they were read", (_rows(diagnosis),), printed=False)


def _files(diagnosis: DiagnosisResult) -> TableView:
    records, rows = diagnosis.records, []
    for index, label in enumerate(file_labels(records.files)):
        of_file = records.file_of == index
        count, runs = records.counts[index], len(set(records.run_of[of_file].tolist()))
        rows.append((label, str(count.in_file), str(count.used), str(count.unused), str(runs)))
    held = int(records.held_out.sum())
    note = f"{counted(held, 'row was', 'rows were')} held out: they judge and were not fitted." if held else ""
    return table_of("Files", ("File", "Rows in the file", "Used", "Left out", "Runs"), rows, (1, 2, 3, 4), note)


def _columns(diagnosis: DiagnosisResult) -> TableView:
    """Say of everything that the readings may depend on how far it went, and how steady it was."""
    records, rows = diagnosis.records, []
    for covariate in records.covariates.values():
        low, high = _ends(covariate.values, covariate.unit)
        remark = ", ".join(_remarks(covariate, records.run_of)) or ABSENT
        as_read = _unit_read(records.units, covariate.name)
        rows.append((spoken(covariate.name), as_read, low, high, ROLES[covariate.role], remark))
    heads = ("Column", "Unit as read", "From", "To", "Taken as", "Remark")
    return table_of("What may matter", heads, rows, (2, 3))


def _readings(diagnosis: DiagnosisResult) -> TableView:
    """Say what was measured, and how far the drawn machine is from it at first sight."""
    records, rows = diagnosis.records, []
    for name in diagnosis.measured:
        values, unit = records.measured[name], diagnosis.setup.print_unit(name)
        curves = next((each for each in diagnosis.curves if each.result == name), None)
        known = np.isfinite(values)
        off = ABSENT
        drawn = None if curves is None else curves.before if curves.nominal is None else curves.nominal
        if drawn is not None and np.isfinite(values - drawn).any():
            mean = float(np.nanmean(values - drawn))
            off = amount_text(Amount(mean, diagnosis.units.get(name) or difference_unit(unit)))
        low, high = _ends(values, unit)
        rows.append((spoken(name), _unit_read(records.units, name), str(int(known.sum())), low, high, off))
    heads = ("Measured", "Unit as read", "Readings", "From", "To", "On average above the model")
    return table_of("What was measured", heads, rows, (2, 3, 4, 5))


def _unit_read(units: Mapping[str, str], name: str) -> str:
    """Say the unit that the file gives a column; nothing where the column was made from others."""
    return (unit_text(units[name]) or "none") if name in units else "made from others"


def _ends(values: Matrix, unit: str) -> tuple[str, str]:
    finite = values[np.isfinite(values)]
    if not finite.size:
        return ABSENT, ABSENT
    low, high = (amount_text(Amount(float(end), unit), 4) for end in (finite.min(), finite.max()))
    return low, high


def _remarks(covariate: Covariate, run_of: Indices) -> Iterator[str]:
    """Say how steady a column is, what is missing, and where time has gaps."""
    finite = covariate.values[np.isfinite(covariate.values)]
    distinct = len(np.unique(finite))
    if covariate.is_constant:
        yield "never changes"
    elif covariate.role == "time":
        yield from _gaps(covariate, run_of)
    elif distinct < len(finite) / 2:
        yield f"{distinct} different values"
    missing = len(covariate.values) - finite.size
    if missing:
        yield f"{missing} missing"


def _gaps(time: Covariate, run_of: Indices) -> Iterator[str]:
    """Say how often a reading was taken, and how often it paused inside of a run."""
    inside = (np.diff(run_of) == 0) & (np.diff(time.values) > 0)
    steps = np.diff(time.values)[inside]
    if not len(steps):
        return
    usual = float(np.median(steps))
    yield f"a reading every {amount_text(Amount(usual, time.unit))}"
    if pauses := int((steps > GAP * usual).sum()):
        yield f"{counted(pauses, 'gap')}, the longest {amount_text(Amount(float(steps.max()), time.unit))}"


def _rows(diagnosis: DiagnosisResult) -> TableView:
    """Write the first rows with their places in the files."""
    records = diagnosis.records
    labels = file_labels(records.files)
    shown = range(min(len(records), MOST_ROWS))
    columns = [(each.name, each.values, each.unit) for each in records.covariates.values() if each.role != "order"]
    columns += [(name, records.measured[name], diagnosis.setup.print_unit(name)) for name in diagnosis.measured]
    rows = [
        (f"{labels[records.file_of[row]]}:{records.lines[row]}",
         *(amount_text(Amount(float(values[row]), unit), 6) if np.isfinite(values[row]) else ABSENT
           for _, values, unit in columns))
        for row in shown
    ]  # fmt: skip
    heads = ("Row", *(spoken(name) for name, *_ in columns))
    more = f"The first {MOST_ROWS} of {len(records)} rows." if len(records) > MOST_ROWS else ""
    return table_of("Rows", heads, rows, tuple(range(1, len(heads))), more)
