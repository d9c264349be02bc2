"""The sheet of a diagnosis in SI or in inches and pounds: its amounts in other units, and the words around them."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

from truing.diagnosis import result as found
from truing.diagnosis.records import Covariate, Records, SuspectedUnit
from truing.diagnosis.result import DiagnosisResult
from truing.report.document import FigureView, Head, Items, Marked
from truing.report.sheet_units import SheetUnits, printing, relabelled, sheet_units
from truing.runs.provenance import Provenance

KINDS = (
    found.Amount, found.NoiseSummary, found.ResidualFinding, found.Wrong, found.FittedUnknown, found.Cause,
    found.Alternative, found.Remainder, found.Calibrated, found.Gain, found.NextPoint, found.Experiment, found.Fact,
    found.Tie, found.VisibleSize, found.Contradiction, found.DiagnosisResult, Covariate, Records, SuspectedUnit,
)  # fmt: skip
"""What a diagnosis says its amounts with: numbers in SI, and the unit in which each is printed."""
AS_THEY_ARE = frozenset({"code", "bracketed code", "source", "state", "symbol"})
"""Pieces of a text that are names."""
WORDLESS = frozenset({"kind", "mood", "ident", "number", "states", "paper", "detail", "unit"})
"""Parts of a document that are no sentences."""


def diagnosis_as_printed(diagnosis: DiagnosisResult) -> DiagnosisResult:
    """Return a diagnosis as its sheet prints it; itself where the sheet has the declared units."""
    units = sheet_units(diagnosis.setup)
    if not units.system:
        return diagnosis
    printed: DiagnosisResult = relabelled(diagnosis, units, KINDS)
    records = replace(printed.records, units=diagnosis.records.units)  # what the files say stays
    return replace(printed, setup=printing(diagnosis.setup), records=records)


def words_as_printed(value: Any, units: SheetUnits) -> Any:
    """Return a document, or a part of one, with the quantities in its sentences in the units of the sheet.

    The title block, literature, provenance, names and finished figures stay.
    """
    if not units.system or isinstance(value, (Head, Provenance)):
        return value
    if isinstance(value, str):
        return units.text(value)
    if isinstance(value, tuple):
        return tuple(words_as_printed(each, units) for each in value)
    is_name = isinstance(value, Marked) and value.kind in AS_THEY_ARE
    if not is_dataclass(value) or is_name or (isinstance(value, Items) and value.kind in {"references", "provenance"}):
        return value
    names = {"caption", "title"} if isinstance(value, FigureView) else {each.name for each in fields(value)} - WORDLESS
    changed = {name: words_as_printed(getattr(value, name), units) for name in names}
    return replace(value, **changed)  # type: ignore[type-var]
