"""A run as a user has it: results with units, checks, a table, the sheet, the folder."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import nan
from pathlib import Path
from typing import TYPE_CHECKING, Any

from truing.api.notebook import MOST_ROWS, fold, heading, html_table, joined, paragraphs, table_html
from truing.api.study import StudyResult
from truing.api.tables import frame_of, frame_text, quantity_of
from truing.calculation import Calculation, calculate
from truing.cases import CasesTable, run_cases
from truing.declare.near_miss import near_miss
from truing.errors import UsageError
from truing.executors import BatchLog, open_executor
from truing.formulas import symbol_text
from truing.heavy import Later
from truing.inputs_file.sentences import told_by_line
from truing.kernel import Offer
from truing.measurements import read_cases
from truing.numbers import format_value, with_unit
from truing.progress import progress_bar
from truing.report.document import Document, plain_text
from truing.report.limits import check_table
from truing.report.run import run_info, sheet_of, sheets_of, write_sheet
from truing.report.sheet import banner_of, cases_table
from truing.report.sheet_units import as_printed, cases_as_printed, printing
from truing.report.word_printer import demand_word_library
from truing.runs.documents import results_document
from truing.runs.folder import FolderKind, demand_place, run_files, write_outcome
from truing.runs.partial import code_of, identity_of, kept_batches
from truing.runs.provenance import provenance_of
from truing.setup import Setup, sheet_in
from truing.studies.bench import Progress, silent
from truing.studies.checks import Check, State
from truing.units import from_si
from truing.workbooks.writing import demand_library

if TYPE_CHECKING:
    from truing.api import differences
    from truing.api.differences import Differences
    from truing.report import comparison_page
    from truing.report.comparison_page import Side
else:  # a run is seldom compared
    differences, comparison_page = Later("truing.api.differences"), Later("truing.report.comparison_page")

FIRST = 12
"""So many results are shown, in the order declared; a click shows the others."""
POINTS = "points.csv"
"""The points of a sweep that was asked alone, in its folder."""
COLUMNS = ("name", "symbol", "value", "unit", "note")


@dataclass(frozen=True)
class Run:
    """A finished run.

    ``run["stress"]`` is a quantity of pint in the unit that the sheet prints, ``run.si["stress"]`` the bare number or
    array in SI. Of a run with cases the results are those of the governing one, and ``cases`` holds all.
    ``calculation`` has everything in SI, ``computed`` is what run.json says of the workers, and ``note`` what became of
    a PDF. A run is ``alone`` where one study was asked and nothing else.
    """

    offer: Offer
    calculation: Calculation
    started: float
    cases: CasesTable | None = None
    computed: Mapping[str, Any] = field(default_factory=lambda: {"resumed": 0, "warnings": []})
    note: str = ""
    alone: bool = False

    def __repr__(self) -> str:
        return f"<Run of {self.offer.name}: {self.verdict}, {len(self.checks)} limits, {len(self.si)} results>"

    def __getitem__(self, name: str) -> Any:
        """Return a result as a quantity of pint in its print unit. Raises UsageError where there is none."""
        if name not in self.si:
            raise UsageError(f"{self.offer.name} has no result '{name}'.{near_miss(name, list(self.si))}")
        return quantity_of(self.si[name], self._setup.print_unit(name))

    @property
    def si(self) -> Mapping[str, Any]:
        """Every result by name, SI: numbers, or arrays along an axis."""
        return self.calculation.answers

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every limit with its state and margin."""
        return self.calculation.checks

    @property
    def verdict(self) -> State:
        """The worst state of all checks, of all cases: "passes", "proposed" (not as stated), "undecided" or "fails"."""
        return self.calculation.verdict if self.cases is None else self.cases.verdict

    @property
    def passed(self) -> bool:
        """Whether every limit is kept by the design as stated."""
        return self.verdict == "passes"

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is to be known beside the results: failed rows, a search without end, a worker that was lost."""
        return (*self.calculation.warnings, *self.computed["warnings"])

    @cached_property
    def studies(self) -> Mapping[str, StudyResult]:
        """What the studies found, by name."""
        return {
            name: StudyResult(f"{self._setup.model.title}: {name}", outcome, tuple(outcome.warnings()))
            for name, outcome in self.calculation.outcomes.items()
        }

    @cached_property
    def document(self) -> dict[str, Any]:
        """What results.json holds."""
        return results_document(self.calculation, provenance_of(self._setup), cases=self.cases)

    def frame(self) -> Any:
        """Return the results that are single numbers as a dataframe: name, symbol, value, unit, note.

        Values are in the unit that is printed. The dataframe is of pandas, polars or pyarrow: of the one that this
        process has imported, else of the first that is installed. With cases: see ``case_frame``.
        """
        rows = list(self._rows())
        return frame_of({name: [row[name] for row in rows] for name in COLUMNS})

    def case_frame(self) -> Any:
        """Return the cases as a dataframe: a row each, with what it changes, its results, verdict and fault.

        Numbers are in the units that are printed, which stand in the names; NaN where a case has no answer. Raises
        UsageError where the run has no cases.
        """
        if self.cases is None:
            raise UsageError("this run has no cases; state them with cases=")
        return frame_of(_case_columns(self.cases, self._setup))

    def sheet(self, path: str | Path, *, units: str = "", language: str = "") -> Path:
        """Write the calculation sheet as HTML, Markdown, PDF or a Word document, as the name ends.

        ``units`` are "SI" or "inch", ``language`` "en" or "de"; "" those of the run. Raises OutputError, and UsageError
        for others.
        """
        return write_sheet(path, partial(self._printed(units=units, language=language)._sheet, silent))

    def save(
        self, folder: str | Path, *, pdf: bool = False, docx: bool = False, excel: bool = False, xlsx: bool = False
    ) -> Path:
        """Write the folder that ``calc run`` writes: inputs, results, sheets, arrays; an earlier run there goes.

        ``pdf`` prints the sheet where a browser is installed, ``docx`` adds it as a Word document; ``excel`` writes the
        CSV tables for a spreadsheet with a decimal comma, ``xlsx`` adds them as a workbook. Raises OutputError where
        the folder is something else, or cannot be written.
        """
        target = Path(folder)
        demand_place(target)
        note = self.written(target, pdf=pdf, docx=docx, excel=excel, xlsx=xlsx)
        if note.startswith("no PDF"):
            warnings.warn(note, stacklevel=2)
        return target

    def written(
        self, folder: Path, *, pdf: bool, docx: bool, excel: bool, xlsx: bool, progress: Progress = silent
    ) -> str:
        """Write the folder and return what became of the PDF."""
        sheet = self._sheet(progress)
        if pdf:
            progress("printing", 0, 0)
        sheets, note = sheets_of(sheet, folder, pdf=pdf, word=docx)
        files = run_files(self.calculation, self.document, sheets, excel=excel, xlsx=xlsx)
        if self.alone:
            (study,) = self.studies.values()
            files |= {POINTS: text} if (text := study.points_text()) else {}
        info = {**run_info(self.started), **self.computed}
        write_outcome(
            folder, "run", self._setup, self.document, provenance=sheet.provenance, run_info=info, files=files
        )
        return note

    def compare(self, before: Run) -> Differences:
        """Return what differs from ``before`` to this run: settings, inputs, results, checks, studies."""
        return differences.differences_of(
            before.document,
            self.document,
            lambda language: (before.side("before", language), self.side("after", language)),
        )

    def side(self, name: str, language: str = "") -> Side:
        """Return what a page of two runs is written from: the document, and the figures of the sheet in a language."""
        figures = comparison_page.figures_in(self._printed(language=language)._sheet(silent))
        return comparison_page.Side(name, self.document, figures, self._setup.model, self.offer.origin.file)

    def _repr_html_(self) -> str:
        """Show the verdict, the limits, the results, and what is to be known beside them."""
        calculation, cases = as_printed(self.calculation), cases_as_printed(self.cases, self._setup)
        banner = banner_of(calculation, cases)
        limits = table_html(check_table(calculation)) if self.checks else ""
        rows = [(row["name"], row["symbol"], row["text"], row["note"]) for row in self._rows()]
        results = html_table(rows[:FIRST], ("result", "symbol", "value", ""))
        more = fold(f"{len(rows) - FIRST} further results", html_table(rows[FIRST:])) if len(rows) > FIRST else ""
        warned = paragraphs(f"Warning: {text}" for text in self.warnings)
        every = table_html(cases_table(calculation, cases, MOST_ROWS)) if cases is not None else ""
        said = " ".join(map(plain_text, banner.sentences))
        title = heading(self._setup.model.title) + paragraphs([f"{banner.headline}. {said}"])
        return joined(title, warned, limits, results, more, fold("All cases", every))

    def _printed(self, *, units: str = "", language: str = "") -> Run:
        setup = sheet_in(self._setup, units=units, language=language)
        return replace(self, calculation=replace(self.calculation, setup=setup))

    def _sheet(self, progress: Progress) -> Document:
        how: dict[str, Any] = {"started": self.started, "cases": self.cases, "alone": self.alone}
        return sheet_of(self.calculation, self.offer, progress=progress, **how)

    @property
    def _setup(self) -> Setup:
        return self.calculation.setup

    def _rows(self) -> Iterator[dict[str, Any]]:
        fields = self._setup.model.result_fields
        for name, value in self.si.items():
            if getattr(value, "ndim", 0) or name not in fields:
                continue
            unit, result = self._setup.print_unit(name), fields[name]
            number, printed = format_value(value, printing(self._setup).print_unit(name))
            yield {
                "name": name, "symbol": symbol_text(result.symbol) if result.symbol else "",
                "value": float(from_si(value, unit)), "unit": unit, "note": result.spec.note,
                "text": with_unit(number, printed),
            }  # fmt: skip


def performed(
    setup: Setup,
    offer: Offer,
    progress: Progress | bool,
    *,
    output: str | Path | None = None,
    cases: Any = None,
    workers: int | None = None,
    cluster: str = "",
    resume: bool = False,
    pdf: bool = False,
    docx: bool = False,
    excel: bool = False,
    xlsx: bool = False,
    alone: bool = False,
) -> Run:
    """Run the calculation of a setup, and write the folder ``output`` where it is named, whole or not at all.

    ``cases`` is a file or a dataframe. With ``resume`` finished batches are kept beside the folder until then, and
    those of an interrupted run are taken up. A setup of one study may ask it ``alone``: the sheet is then that of the
    study. Raises TruingError; what is impossible is said at the input that is to blame, and UsageError for what does
    not go together.
    """
    if cluster and workers is not None:
        raise UsageError("cluster and workers exclude each other: a cluster has its own workers")
    files = {"pdf": pdf, "docx": docx, "excel": excel, "xlsx": xlsx}
    demand_files(output, {"resume": resume, **files})
    folder = None if output is None else Path(output)
    keeping: AbstractContextManager[BatchLog | None] = nullcontext()
    if folder is not None and resume:
        keeping = kept_batches(folder, identity_of(setup, code_of(setup)))
    place = f"dask:{cluster}" if cluster else "serial" if workers in (None, 1) else f"processes:{workers}"
    with progress_bar(progress) as report, told_by_line(setup), keeping as log:
        run = replace(_calculated(setup, offer, cases, place=place, progress=report, log=log), alone=alone)
        if folder is not None:
            return replace(run, note=run.written(folder, **files, progress=report))
        return run


def demand_files(output: str | Path | None, files: Mapping[str, bool], kind: FolderKind = "run") -> None:
    """Raise UsageError or OutputError where what is asked for cannot be written: before anything is calculated."""
    for name in (name for name, is_asked in files.items() if is_asked and output is None):
        raise UsageError(f"{name} needs output, the folder that is written")
    if files["xlsx"]:
        demand_library()
    if files["docx"]:
        demand_word_library()
    if output is not None:
        demand_place(Path(output), kind)


def _calculated(setup: Setup, offer: Offer, cases: Any, *, place: str, progress: Progress, log: BatchLog | None) -> Run:
    started = time.time()
    with open_executor(place) as pool:
        if place.startswith("dask:"):
            pool.compare(code_of(setup))
        pool.log = log
        table = None
        if cases is None:
            calculation = calculate(setup, executor=pool, progress=progress)
        else:
            source = Path(cases) if isinstance(cases, (str, Path)) else frame_text(cases, {})
            stated = read_cases(source, offer, setup)
            calculation, table = run_cases(setup, stated, executor=pool, progress=progress)
        pool.settle()
        computed = {
            "workers": {"count": pool.workers, "lost": pool.losses, "where": pool.where},
            "resumed": 0 if log is None else log.resumed,
            "warnings": [*pool.remarks(), *(() if log is None else log.remarks())],
        }
    return Run(offer, calculation, started, table, computed)


def _case_columns(cases: CasesTable, setup: Setup) -> dict[str, list[Any]]:
    """Return a column each for name, what varies, results that are single numbers, verdict and fault."""
    answers = next((case.answers for case in cases.cases if case.reason is None), {})
    results = [name for name, value in answers.items() if not getattr(value, "ndim", 0)]
    columns: dict[str, list[Any]] = {"case": [case.name for case in cases.cases]}
    for name in (*cases.varied, *results):
        unit = setup.print_unit(name)
        values = [{**case.answers, **case.values}.get(name, nan) for case in cases.cases]
        columns[f"{name} [{unit}]" if unit else name] = [
            value if isinstance(value, (str, bool)) else float(from_si(value, unit)) for value in values
        ]
    columns["verdict"] = [case.verdict for case in cases.cases]
    return {**columns, "fault": [case.reason or "" for case in cases.cases]}
