"""From a finished calculation to its sheets and its folder, all or nothing."""

from __future__ import annotations

import getpass
import platform
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from truing.calculation import Calculation
from truing.cases import CasesTable
from truing.errors import OutputError
from truing.kernel import Offer
from truing.published import compare_published
from truing.report.context import Sheet
from truing.report.pdf import pdf_bytes
from truing.report.render import html_of, markdown_of
from truing.report.sheet import make_sheet
from truing.runs.folder import write_run
from truing.runs.provenance import provenance_of
from truing.studies.bench import Progress, silent

UNDISTURBED: Mapping[str, Any] = {"resumed": 0, "warnings": []}
"""What run.json says beside ``run_info`` of a run in one process."""


def write_calculation(
    folder: Path,
    calculation: Calculation,
    offer: Offer,
    *,
    started: float,
    computed: Mapping[str, Any] = UNDISTURBED,
    cases: CasesTable | None = None,
    pdf: bool = False,
    excel: bool = False,
    progress: Progress = silent,
) -> str:
    """Write sheets and folder of a finished calculation; return what became of the printing, nothing without one."""
    sheet = sheet_of(calculation, offer, started=started, cases=cases, progress=progress)
    sheets: dict[str, str | bytes] = {"sheet.html": html_of(sheet), "sheet.md": markdown_of(sheet)}
    if pdf:
        progress("printing", 0, 0)
    note = add_pdf(sheets, folder) if pdf else ""
    write_run(
        folder,
        calculation,
        provenance=sheet.provenance,
        run_info={**run_info(started), **computed},
        sheets=sheets,
        cases=cases,
        excel=excel,
    )
    return note


def sheet_of(
    calculation: Calculation,
    offer: Offer,
    *,
    started: float,
    cases: CasesTable | None = None,
    progress: Progress = silent,
) -> Sheet:
    """Return the sheet of a finished calculation, the numbers that the paper prints compared."""
    verified = compare_published(offer, progress=progress, known=calculation)
    progress("sheet", 0, 0)
    provenance = provenance_of(calculation.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    return make_sheet(calculation, provenance=provenance, verified=verified, cases=cases)


def add_pdf(sheets: dict[str, str | bytes], folder: Path) -> str:
    """Add the PDF where a browser can print it, and say what became of it: a run is not lost for want of a browser."""
    try:
        sheets["sheet.pdf"] = pdf_bytes(str(sheets["sheet.html"]))
    except OutputError as error:
        return f"no PDF: {error}"
    return f"printed: {folder / 'sheet.pdf'}"


def run_info(started: float) -> dict[str, Any]:
    """Return what may differ between two equal runs: date, duration, machine, user, workers."""
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):
        user = ""
    return {
        "date": time.strftime("%Y-%m-%dT%H:%M:%S%z", time.localtime(started)),
        "duration_s": round(time.time() - started, 3),
        "machine": platform.node(),
        "system": platform.platform(),
        "user": user,
        "workers": {"count": 1, "lost": 0, "where": "serial"},
    }
