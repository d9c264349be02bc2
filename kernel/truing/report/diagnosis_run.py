"""A diagnosis from order to folder: read, diagnose, write the sheets, print them, all or nothing."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from truing.diagnosis.engine import diagnose
from truing.diagnosis.reading import read_records
from truing.diagnosis.result import DiagnosisResult
from truing.kernel import Offer
from truing.report.diagnosis_sheet import DiagnosisSheet, diagnosis_html, diagnosis_markdown, make_diagnosis_sheet
from truing.report.run import add_pdf, run_info
from truing.runs.diagnosis_folder import data_digests, write_diagnosis
from truing.runs.folder import demand_place
from truing.runs.provenance import provenance_of
from truing.setup import Setup
from truing.studies.bench import Progress


@dataclass(frozen=True)
class DiagnosisOrder:
    """What the command line asks of a diagnosis: measured files, and where everything is written."""

    data: tuple[Path, ...]
    folder: Path
    pdf: bool = False


@dataclass(frozen=True)
class Diagnosed:
    """A finished diagnosis, diagnosis.json, and what is to be said of the printing."""

    diagnosis: DiagnosisResult
    document: Mapping[str, Any]
    note: str = ""


def perform_diagnosis(setup: Setup, offer: Offer, order: DiagnosisOrder, progress: Progress) -> Diagnosed:
    """Read, diagnose and write the folder; it is complete or absent, whatever happens."""
    demand_place(order.folder, "diagnosis")
    started = time.time()
    diagnosis = diagnose(setup, read_records(order.data, offer, setup), progress=progress)
    progress("sheet and PDF" if order.pdf else "sheet", 0, 0)
    document, note = write_diagnosed(diagnosis, order.folder, started=started, pdf=order.pdf)
    return Diagnosed(diagnosis, document, note)


def write_diagnosed(
    diagnosis: DiagnosisResult, folder: Path, *, started: float, pdf: bool = False
) -> tuple[dict[str, Any], str]:
    """Write sheets and folder of a diagnosis; return diagnosis.json and what became of the printing."""
    sheet = diagnosis_sheet_of(diagnosis, started)
    sheets: dict[str, str | bytes] = {"sheet.html": diagnosis_html(sheet), "sheet.md": diagnosis_markdown(sheet)}
    note = add_pdf(sheets, folder) if pdf else ""
    document = write_diagnosis(
        folder, diagnosis, provenance=sheet.provenance, run_info=run_info(started), sheets=sheets
    )  # fmt: skip
    return document, note


def diagnosis_sheet_of(diagnosis: DiagnosisResult, started: float) -> DiagnosisSheet:
    """Return the sheet of a diagnosis, with where its numbers and its data come from."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    return make_diagnosis_sheet(diagnosis, provenance=provenance)
