"""A diagnosis from order to folder: read, diagnose, write the sheets, print them, all or nothing."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from truing.kernel import Offer
from truing.report.diagnosis_sheet import diagnosis_html, diagnosis_markdown, make_diagnosis_sheet
from truing.report.run import add_pdf, run_info
from truing.runs.diagnosis_folder import data_digests, write_diagnosis
from truing.runs.folder import demand_place
from truing.runs.provenance import provenance_of
from truing.setup import Setup
from truing.studies.bench import Progress

if TYPE_CHECKING:
    from truing.diagnosis.result import Diagnosis


@dataclass(frozen=True)
class DiagnosisOrder:
    """What the command line asks of a diagnosis: measured files, and where everything is written."""

    data: tuple[Path, ...]
    folder: Path
    pdf: bool = False


@dataclass(frozen=True)
class Diagnosed:
    """A finished diagnosis, diagnosis.json, and what is to be said of the printing."""

    diagnosis: Diagnosis
    document: Mapping[str, Any]
    note: str = ""


def perform_diagnosis(setup: Setup, offer: Offer, order: DiagnosisOrder, progress: Progress) -> Diagnosed:
    """Read, diagnose and write the folder; it is complete or absent, whatever happens."""
    demand_place(order.folder, "diagnosis")
    from truing.diagnosis.engine import diagnose
    from truing.diagnosis.reading import read_records

    started = time.time()
    diagnosis = diagnose(setup, read_records(order.data, offer, setup), progress=progress)
    progress("sheet and PDF" if order.pdf else "sheet", 0, 0)
    document, note = write_all(diagnosis, order, started)
    return Diagnosed(diagnosis, document, note)


def write_all(diagnosis: Diagnosis, order: DiagnosisOrder, started: float) -> tuple[dict[str, Any], str]:
    """Write sheets and folder of a diagnosis; return diagnosis.json and what became of the printing."""
    provenance = provenance_of(diagnosis.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    provenance = replace(provenance, files={**provenance.files, **data_digests(diagnosis)})
    sheet = make_diagnosis_sheet(diagnosis, provenance=provenance)
    sheets: dict[str, str | bytes] = {"sheet.html": diagnosis_html(sheet), "sheet.md": diagnosis_markdown(sheet)}
    note = add_pdf(sheets, order.folder) if order.pdf else ""
    document = write_diagnosis(
        order.folder, diagnosis, provenance=provenance, run_info=run_info(started), sheets=sheets
    )  # fmt: skip
    return document, note
