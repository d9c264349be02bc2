"""A run from order to folder: calculate, write the sheets, print them, all or nothing."""

from __future__ import annotations

import getpass
import platform
import time
from collections.abc import Mapping
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from truing.calculation import Calculation, calculate
from truing.cases import CasesTable, run_cases
from truing.errors import OutputError
from truing.executors import BatchLog, KeptExecutor, Place, open_executor
from truing.kernel import Offer
from truing.measurements import read_cases
from truing.published import compare_published
from truing.report.context import Sheet
from truing.report.pdf import pdf_bytes
from truing.report.render import html_of, markdown_of
from truing.report.sheet import make_sheet
from truing.runs.folder import demand_place, write_run
from truing.runs.partial import code_of, identity_of, kept_batches
from truing.runs.provenance import provenance_of
from truing.setup import Setup
from truing.studies.bench import Progress, silent
from truing.studies.checks import State

UNDISTURBED: Mapping[str, Any] = {"resumed": 0, "warnings": []}
"""What run.json says beside ``run_info`` of a run in one process."""


@dataclass(frozen=True)
class RunOrder:
    """What the command line asks of a run."""

    folder: Path
    cases: Path | None = None
    workers: int = 1
    cluster: str = ""
    resume: bool = False
    pdf: bool = False
    excel: bool = False

    @property
    def place(self) -> str:
        """Where it is computed, as ``open_executor`` reads it."""
        return place_of(self.workers, self.cluster)


def place_of(workers: int, cluster: str = "") -> str:
    """Return where it is computed, as ``open_executor`` reads it."""
    if cluster:
        return f"dask:{cluster}"
    return "serial" if workers == 1 else f"processes:{workers}"


@dataclass(frozen=True)
class Done:
    """A finished run: its calculation (of the governing case), results.json, and what is to be said of the printing.

    ``remarks`` say what befell the workers, which is no part of the results; ``resumed`` is the number of finished
    batches that were taken up.
    """

    calculation: Calculation
    document: Mapping[str, Any]
    cases: CasesTable | None = None
    note: str = ""
    remarks: tuple[str, ...] = ()
    resumed: int = 0

    @property
    def verdict(self) -> State:
        """The worst state of all checks, of all cases."""
        return self.calculation.verdict if self.cases is None else self.cases.verdict


def perform(setup: Setup, offer: Offer, order: RunOrder, progress: Progress) -> Done:
    """Run and write the folder; it is complete or absent, whatever happens.

    With ``resume`` finished batches are kept beside it until then, and those of an interrupted run are taken up.
    """
    demand_place(order.folder)
    with kept_batches(order.folder, identity_of(setup, code_of(setup))) if order.resume else nullcontext() as log:
        return _perform(setup, offer, order, progress=progress, log=log)


def _perform(setup: Setup, offer: Offer, order: RunOrder, *, progress: Progress, log: BatchLog | None) -> Done:
    started = time.time()
    with open_executor(order.place) as place:
        if order.cluster:
            place.compare(code_of(setup))
        executor = place if log is None else KeptExecutor(place, log)
        calculation, cases = _calculate(setup, offer, order, executor=executor, progress=progress)
        place.settle()
        computed = _computed(executor)
    document, note = write_calculation(
        order.folder, calculation, offer, started=started, computed=computed, cases=cases, pdf=order.pdf,
        excel=order.excel, progress=progress,
    )  # fmt: skip
    return Done(calculation, document, cases, note, tuple(computed["warnings"]), computed["resumed"])


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
) -> tuple[dict[str, Any], str]:
    """Write sheets and folder of a finished calculation; return results.json and what became of the printing."""
    sheet = sheet_of(calculation, offer, started=started, cases=cases, progress=progress)
    sheets: dict[str, str | bytes] = {"sheet.html": html_of(sheet), "sheet.md": markdown_of(sheet)}
    if pdf:
        progress("printing", 0, 0)
    note = add_pdf(sheets, folder) if pdf else ""
    document = write_run(
        folder,
        calculation,
        offer,
        provenance=sheet.provenance,
        run_info={**run_info(started), **computed},
        sheets=sheets,
        cases=cases,
        excel=excel,
    )
    return document, note


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


def _computed(place: Place) -> dict[str, Any]:
    """Return what run.json says of where it was computed: workers, what befell them, batches that were taken up."""
    return {
        "workers": {"count": place.workers, "lost": place.losses, "where": place.where},
        "resumed": place.resumed if isinstance(place, KeptExecutor) else 0,
        "warnings": place.remarks(),
    }


def add_pdf(sheets: dict[str, str | bytes], folder: Path) -> str:
    """Add the PDF where a browser can print it, and say what became of it: a run is not lost for want of a browser."""
    try:
        sheets["sheet.pdf"] = pdf_bytes(str(sheets["sheet.html"]))
    except OutputError as error:
        return f"no PDF: {error}"
    return f"printed: {folder / 'sheet.pdf'}"


def _calculate(
    setup: Setup, offer: Offer, order: RunOrder, *, executor: Executor, progress: Progress
) -> tuple[Calculation, CasesTable | None]:
    if order.cases is None:
        return calculate(setup, executor=executor, progress=progress), None
    return run_cases(setup, read_cases(order.cases, offer, setup), executor=executor, progress=progress)


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
