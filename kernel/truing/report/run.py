"""From a finished calculation to its sheets and its folder, all or nothing."""

from __future__ import annotations

import getpass
import platform
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from truing.atomic import write_files
from truing.calculation import Calculation
from truing.cases import CasesTable
from truing.declare.chain import chain_of
from truing.errors import OutputError, TruingError
from truing.inputs_file import read_setup
from truing.kernel import Offer
from truing.published import compare_published
from truing.report.document import Document
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.report.pdf import pdf_bytes
from truing.report.sheet import make_sheet, study_sheet
from truing.report.word_printer import demand_word_library, word_of
from truing.runs.provenance import provenance_of
from truing.setup import Setup
from truing.studies.bench import Progress, silent


def sheet_of(
    calculation: Calculation,
    offer: Offer,
    *,
    started: float,
    cases: CasesTable | None = None,
    alone: bool = False,
    progress: Progress = silent,
) -> Document:
    """Return the sheet of a finished calculation, the numbers that the paper prints compared.

    Of a study that was asked ``alone`` it is what that one has found, and a chain is not compared: neither with printed
    numbers nor with an example.
    """
    provenance = provenance_of(calculation.setup, date=time.strftime("%Y-%m-%d", time.localtime(started)))
    if alone:
        progress("sheet", 0, 0)
        return study_sheet(calculation, provenance=provenance)
    is_chain = chain_of(calculation.setup.model) is not None  # what a source prints is of one calculation alone
    verified = () if is_chain else compare_published(offer, progress=progress, known=calculation)
    progress("sheet", 0, 0)
    example = None if is_chain else example_setup(offer)
    return make_sheet(calculation, provenance=provenance, verified=verified, cases=cases, example=example)


def example_setup(offer: Offer) -> Setup | None:
    """Return what the shipped example says; None where there is none, or where it cannot be read."""
    if offer.model.example is None:
        return None
    try:
        return read_setup(offer.model.example, offer)
    except TruingError:
        return None


def sheets_of(document: Document, folder: Path, *, pdf: bool, word: bool) -> tuple[dict[str, str | bytes], str]:
    """Return the sheets of a document by file name, and what became of the PDF: a browser must print it.

    A run is not lost for want of a browser. Raises UsageError where the library for Word is missing.
    """
    page = html_of(document)
    sheets: dict[str, str | bytes] = {"sheet.html": page, "sheet.md": markdown_of(document)}
    if word:
        sheets["sheet.docx"] = word_of(document)
    if not pdf:
        return sheets, ""
    try:
        return {**sheets, "sheet.pdf": pdf_bytes(page)}, f"printed: {folder / 'sheet.pdf'}"
    except OutputError as error:
        return sheets, f"no PDF: {error}"


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


# Writing a sheet under a name that the user chooses


def write_sheet(path: str | Path, make: Callable[[], Document]) -> Path:
    """Write a sheet as HTML, Markdown, PDF or a Word document, as the name ends, and return its path.

    Raises OutputError for any other ending, for a PDF where no browser can print it, and where it cannot be written;
    UsageError where the library for Word is missing.
    """
    file = Path(path)
    write_files({file: WRITERS[demand_ending(file)](make())})
    return file


def demand_ending(file: Path) -> str:
    """Return the ending of a sheet's name, in small letters. Raises OutputError for one that no sheet has."""
    ending = file.suffix.lower()
    if ending not in WRITERS:
        raise OutputError(f"{file}: a sheet ends in .html, .md, .pdf or .docx")
    if ending == ".docx":
        demand_word_library()
    return ending


WRITERS: dict[str, Callable[[Document], str | bytes]] = {
    ".html": html_of, ".htm": html_of, ".md": markdown_of, ".docx": word_of,
    ".pdf": lambda document: pdf_bytes(html_of(document)),
}  # fmt: skip
"""What writes a sheet, by the ending of its name."""
