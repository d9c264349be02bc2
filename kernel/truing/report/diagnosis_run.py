"""From a finished diagnosis to its sheets and its folder, all or nothing."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from truing.diagnosis.result import DiagnosisResult
from truing.report.diagnosis_sheet import DiagnosisSheet, diagnosis_html, diagnosis_markdown, make_diagnosis_sheet
from truing.report.run import add_pdf, run_info
from truing.runs.diagnosis_folder import data_digests, write_diagnosis
from truing.runs.provenance import provenance_of


def write_diagnosed(diagnosis: DiagnosisResult, folder: Path, *, started: float, pdf: bool = False) -> str:
    """Write sheets and folder of a diagnosis; return what became of the printing, nothing without one."""
    sheet = diagnosis_sheet_of(diagnosis, started)
    sheets: dict[str, str | bytes] = {"sheet.html": diagnosis_html(sheet), "sheet.md": diagnosis_markdown(sheet)}
    note = add_pdf(sheets, folder) if pdf else ""
    write_diagnosis(folder, diagnosis, provenance=sheet.provenance, run_info=run_info(started), sheets=sheets)
    return note


def diagnosis_sheet_of(diagnosis: DiagnosisResult, started: float) -> DiagnosisSheet:
    """Return the sheet of a diagnosis, with where its numbers and its data come from."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    return make_diagnosis_sheet(diagnosis, provenance=provenance)
