"""From a finished diagnosis to its document, its sheets and its folder, all or nothing."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from truing.diagnosis.result import Amount, DiagnosisResult
from truing.report.chapters import Figures, numbered
from truing.report.diagnosis_chapters import diagnosis_chapters
from truing.report.diagnosis_words import amount_text, headline, verdict_word
from truing.report.document import Banner, Document
from truing.report.run import run_info, sheets_of
from truing.report.sheet import end_chapters, head_of, logo_of
from truing.runs.diagnosis_document import file_labels
from truing.runs.folder import data_digests, write_diagnosis
from truing.runs.provenance import Provenance, provenance_of

DIAGNOSIS = "Diagnosis"


def write_diagnosed(diagnosis: DiagnosisResult, folder: Path, *, started: float, pdf: bool = False) -> str:
    """Write sheets and folder of a diagnosis; return what became of the printing, nothing without one."""
    document = diagnosis_sheet_of(diagnosis, started)
    sheets, note = sheets_of(document, folder, pdf=pdf)
    write_diagnosis(folder, diagnosis, provenance=document.provenance, run_info=run_info(started), sheets=sheets)
    return note


def diagnosis_sheet_of(diagnosis: DiagnosisResult, started: float) -> Document:
    """Return what a diagnosis says, with where its numbers and its data come from."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    return make_diagnosis_sheet(diagnosis, provenance=provenance)


def make_diagnosis_sheet(diagnosis: DiagnosisResult, *, provenance: Provenance) -> Document:
    """Say everything that stands on the sheet of a diagnosis."""
    drawn = Figures()
    chapters = list(diagnosis_chapters(diagnosis, drawn))
    warnings = tuple(filter(None, [logo_of(diagnosis.setup)[1], *drawn.failures]))
    head = head_of(diagnosis.setup, provenance)
    return Document(
        kind=DIAGNOSIS,
        title=f"{DIAGNOSIS}: {head.title}",
        head=replace(head, footer=" · ".join(part for part in (DIAGNOSIS, head.footer) if part)),
        detail=diagnosis.setup.sheet.detail,
        summary=data_words(diagnosis),
        banner=Banner(_mood(diagnosis), verdict_word(diagnosis), tuple(headline(diagnosis))),
        alarms=tuple(unit_error.text for unit_error in diagnosis.records.unit_errors),
        chapters=numbered([*chapters, *end_chapters(warnings, provenance)]),
        warnings=warnings,
        provenance=provenance,
    )


def questions(diagnosis: DiagnosisResult) -> dict[str, tuple[str, ...]]:
    """Return what a diagnosis says to each of its questions, line by line."""
    chapters = diagnosis_chapters(diagnosis, Figures(skipped=True))
    return {
        chapter.title.removesuffix(" measurement"): chapter.lines for chapter in chapters if chapter.ident != "data"
    }


def data_line(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, how long it took, and which model it was held against."""
    time = next((item for item in diagnosis.records.covariates.values() if item.role == "time"), None)
    lasting = ""
    if time is not None:
        hours = Amount(float(np.nanmax(time.values) - np.nanmin(time.values)), time.unit)
        lasting = f", {amount_text(hours)}"
    model = diagnosis.setup.model
    return (
        f"{data_words(diagnosis)}{lasting}; {model.name}: {model.title}, {len(diagnosis.calibrated)} inputs calibrated"
    )


def _mood(diagnosis: DiagnosisResult) -> str:
    if diagnosis.verdict == "none":
        return "calm"
    return "found" if diagnosis.verdict == "named" and diagnosis.remainder is None else "open"


def data_words(diagnosis: DiagnosisResult) -> str:
    """Say what was measured, in a line."""
    records = diagnosis.records
    runs = len(set(records.run_of.tolist()))
    in_files = sum(count.in_file for count in records.counts)
    of_all = f" of {in_files}" if in_files > len(records) else ""
    counted = f"{len(records)}{of_all} rows, {runs} run{'' if runs == 1 else 's'}"
    return f"{', '.join(file_labels(records.files))}: {counted}"
