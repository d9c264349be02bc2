"""A run from order to folder: calculate, write the sheets, print them, all or nothing."""

from __future__ import annotations

import platform
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from truing.calculation import Calculation, calculate
from truing.cases import CasesTable, run_cases
from truing.executors import open_executor
from truing.kernel import Offer
from truing.published import ComparedRow, compare_published
from truing.report.context import Provenance
from truing.report.pdf import HOW_TO_PRINT, find_browser, print_pdf
from truing.report.render import sheet_html, sheet_markdown
from truing.run_folder import check_folder, input_hash, results_document, write_run
from truing.setup import Setup
from truing.studies.bench import Progress

PACKAGES = ("numpy", "scipy", "pint", "pydantic", "matplotlib", "jinja2")


@dataclass(frozen=True)
class RunOrder:
    """What the command line asks of a run."""

    folder: Path
    cases: Path | None = None
    workers: int = 1
    pdf: bool = False


@dataclass(frozen=True)
class Done:
    """A finished run: its calculation (of the governing case), results.json, and what is to be said of the printing."""

    calculation: Calculation
    document: Mapping[str, Any]
    cases: CasesTable | None = None
    note: str = ""

    @property
    def passed(self) -> bool:
        """Whether every check holds, in every case."""
        return self.calculation.passed if self.cases is None else self.cases.passed


def perform(setup: Setup, offer: Offer, order: RunOrder, progress: Progress) -> Done:
    """Run and write the folder; it is complete or absent, whatever happens."""
    check_folder(order.folder)
    started = time.time()
    address = "serial" if order.workers == 1 else f"processes:{order.workers}"
    with open_executor(address) as executor:
        calculation, cases = _calculate(setup, offer, order, executor=executor, progress=progress)
    verified = compare_published(offer, progress=progress) if offer.model.published else []
    provenance = provenance_of(calculation, started)
    document = results_document(calculation, provenance, cases=cases)
    info = run_info(started, workers=order.workers, provenance=provenance)
    browser = find_browser() if order.pdf else None
    with write_run(order.folder, calculation, provenance=provenance, run_info=info, cases=cases) as folder:
        _write_sheets(folder, calculation, provenance, verified, cases)
        if browser is not None:
            print_pdf(folder / "sheet.html", folder / "sheet.pdf", browser)
    note = ""
    if order.pdf:
        note = f"printed: {order.folder / 'sheet.pdf'}" if browser else HOW_TO_PRINT
    return Done(calculation, document, cases, note)


def _calculate(
    setup: Setup, offer: Offer, order: RunOrder, *, executor: Executor, progress: Progress
) -> tuple[Calculation, CasesTable | None]:
    if order.cases is None:
        return calculate(setup, executor=executor, progress=progress), None
    from truing.measurements import read_cases

    return run_cases(setup, read_cases(order.cases, offer, setup), executor=executor, progress=progress)


def _write_sheets(
    folder: Path,
    calculation: Calculation,
    provenance: Provenance,
    verified: Sequence[ComparedRow],
    cases: CasesTable | None,
) -> None:
    for name, write in (("sheet.html", sheet_html), ("sheet.md", sheet_markdown)):
        text = write(calculation, provenance=provenance, verified=verified, cases=cases)
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


def provenance_of(calculation: Calculation, started: float) -> Provenance:
    """Return where the numbers of this calculation come from."""
    from importlib import metadata

    setup = calculation.setup
    return Provenance(
        kernel=metadata.version("truing"),
        plugin=setup.origin.name,
        plugin_version=setup.origin.version,
        python=platform.python_version(),
        packages={name: metadata.version(name) for name in PACKAGES},
        input_hash=input_hash(setup),
        seed=setup.seed,
        date=time.strftime("%Y-%m-%d", time.localtime(started)),
        added=[(item.what, item.plugin, item.version) for item in setup.added],
        files=dict(setup.files),
    )


def run_info(started: float, *, workers: int, provenance: Provenance) -> dict[str, Any]:
    """Return what run.json says: everything that may differ between two equal runs."""
    import getpass

    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):
        user = ""
    return {
        "schema": "truing.run/1",
        "date": time.strftime("%Y-%m-%dT%H:%M:%S%z", time.localtime(started)),
        "duration_s": round(time.time() - started, 3),
        "machine": platform.node(),
        "system": platform.platform(),
        "user": user,
        "python": provenance.python,
        "kernel": provenance.kernel,
        "packages": dict(provenance.packages),
        "workers": {"count": workers, "lost": 0},
        "warnings": [],
    }
