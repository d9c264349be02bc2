"""The sheet of a diagnosis in SI or in inches and pounds: its amounts in other units."""

from __future__ import annotations

from dataclasses import replace

from truing.diagnosis import result as found
from truing.diagnosis.records import Covariate, Records, SuspectedUnit
from truing.diagnosis.result import DiagnosisResult
from truing.report.sheet_units import printing, relabelled, sheet_units

KINDS = (
    found.Amount, found.NoiseSummary, found.ResidualFinding, found.Wrong, found.FittedUnknown, found.Cause,
    found.Alternative, found.Remainder, found.Calibrated, found.Gain, found.NextPoint, found.Experiment, found.Fact,
    found.Tie, found.VisibleSize, found.Contradiction, found.DiagnosisResult, Covariate, Records, SuspectedUnit,
)  # fmt: skip
"""What a diagnosis says its amounts with: numbers in SI, and the unit in which each is printed."""


def diagnosis_as_printed(diagnosis: DiagnosisResult) -> DiagnosisResult:
    """Return a diagnosis as its sheet prints it; itself where the sheet has the declared units."""
    units = sheet_units(diagnosis.setup)
    if not units.system:
        return diagnosis
    printed: DiagnosisResult = relabelled(diagnosis, units, KINDS)
    records = replace(printed.records, units=diagnosis.records.units)  # what the files say stays
    return replace(printed, setup=printing(diagnosis.setup), records=records)
