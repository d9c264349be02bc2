"""A model as a user has it: run it, calculate rows, diagnose a record; what a diagnosis finds is a model again."""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any

from truing.api.notebook import bullets, fold, heading, html_table, joined, paragraphs, picture, table_html
from truing.api.run import Run, demand_files, performed
from truing.api.study import StudyResult
from truing.api.tables import LABEL, beside, frame_text, settings_of, text_of
from truing.declare.chain import link_to
from truing.declare.correlations import Correlated
from truing.declare.model import Study
from truing.declare.near_miss import near_miss
from truing.declare.taken import Taken
from truing.errors import DeclarationError, Fault, InputError, UsageError
from truing.example_file import example_of, text_to_fill_in
from truing.experiments import BUDGET
from truing.heavy import Later
from truing.inputs_file import read_setup, setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.inputs_file.sentences import told_by_line
from truing.kernel import Offer, chained_offer, offer_of
from truing.measurements import RowsFile, read_rows
from truing.progress import progress_bar
from truing.published import ComparedRow, compare_published
from truing.report.run import run_info, sheets_of, write_sheet
from truing.runs.folder import demand_place, write_outcome
from truing.setup import Setup, sheet_in
from truing.studies.bench import Progress
from truing.studies.frequency import Frequency
from truing.studies.sweep import Sweep
from truing.units import difference_unit
from truing.units.grammar import shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from truing import describe, gauge
    from truing.api import differences, findings
    from truing.api import plan as plans
    from truing.api import records as measured
    from truing.api.differences import Differences
    from truing.api.findings import NamedCause, Ranking, Residuals
    from truing.api.plan import Plan
    from truing.api.records import MeasuredRecord
    from truing.diagnosis import engine, reading
    from truing.diagnosis.result import DiagnosisResult, Verdict
    from truing.experiments import planning, proposal
    from truing.report import comparison_page, diagnosis_chapters, diagnosis_sheet, diagnosis_words
    from truing.report.comparison_page import Side
    from truing.runs import diagnosis_document, diagnosis_files, extension
else:  # what a call is for is loaded when it is called: a run needs no diagnosis
    describe, gauge = Later("truing.describe"), Later("truing.gauge")
    differences, findings = Later("truing.api.differences"), Later("truing.api.findings")
    plans, measured = Later("truing.api.plan"), Later("truing.api.records")
    engine, reading = Later("truing.diagnosis.engine"), Later("truing.diagnosis.reading")
    planning, proposal = Later("truing.experiments.planning"), Later("truing.experiments.proposal")
    comparison_page, diagnosis_chapters, diagnosis_sheet, diagnosis_words = (
        Later(f"truing.report.{name}")
        for name in ("comparison_page", "diagnosis_chapters", "diagnosis_sheet", "diagnosis_words")
    )
    diagnosis_document, diagnosis_files, extension = (
        Later(f"truing.runs.{name}") for name in ("diagnosis_document", "diagnosis_files", "extension")
    )


@dataclass(frozen=True)
class LoadedModel:
    """A model that was loaded, with the inputs of its shipped example until others are stated.

    ``stated`` holds what every run of it states, in the words of ``--set``; ``text`` the inputs file that stands in
    place of the example, its name, and the folder in which it looks for data files. ``label`` is what sentences about
    a stated value begin with.

    Every call takes values as keywords: an input, a condition, ``seed``, ``draws`` (of every study that draws) or
    ``units`` ("SI" or "inch", in which sheets are printed; the numbers of results and files stay) and ``language`` (of
    the sheet). A value is a text with its unit ("12 mm"), a number in the declared unit, or a quantity of pint. ``set``
    is a mapping of the same, for names that are no keyword or that the call itself uses:
    ``set={"tolerances.load": "off"}``.
    ``progress`` is True (a bar on a terminal or in a notebook, once the work takes two seconds), False, or a function
    ``progress(task, done, total)``.
    """

    offer: Offer
    stated: tuple[str, ...] = ()
    text: tuple[str, str, Path] | None = None
    label: str = ""

    def __repr__(self) -> str:
        return f"<LoadedModel {self.name}: {self.title}>"

    @property
    def name(self) -> str:
        """What the model is called."""
        return self.offer.name

    @property
    def title(self) -> str:
        """What it calculates, in a line."""
        return self.offer.model.title

    def given(self, *together: Correlated, set: Mapping[str, Any] | None = None, **values: Any) -> LoadedModel:
        """Return the model with these values in every run, and with inputs that scatter together.

        ``together`` holds pairs, each made by ``correlated("load", "hardness", 0.7)``.
        """
        pairs = {f"correlations.{pair.name}": pair.coefficient for pair in together}
        return replace(self, stated=(*self.stated, *self._settings({**pairs, **(set or {})}, values)))

    def taking(self, set: Mapping[str, Taken] | None = None, /, **inputs: Taken) -> LoadedModel:
        """Return the model with inputs that are taken from others: ``from_model("rv_gearing").output_torque``.

        It is a chain: inputs, results and effects of the others have their name before their own, ``rv_gearing_power``.
        ``set`` is a mapping of the same. Raises UsageError with everything that does not fit.
        """
        taken = {**(set or {}), **inputs}
        for name, value in taken.items():
            if not isinstance(value, Taken):
                raise UsageError(f'{name}: {value!r:.60} is no result of a model; write from_model("NAME").RESULT')
        links = [link_to(name, value) for name, value in taken.items()]
        try:
            offer = chained_offer(self.offer, links)
        except DeclarationError as error:
            raise UsageError(str(error)) from None
        return replace(self, offer=offer, stated=(*self.stated, *self._settings(taken, {})))

    def setup(self, inputs: str | Path | None = None, *, set: Mapping[str, Any] | None = None, **values: Any) -> Setup:
        """Return what a run would calculate: the inputs file, or the shipped example, and values in place of its own.

        Raises InputError with every fault.
        """
        overrides = [*self.stated, *self._settings(set, values)]
        if not isinstance(inputs, (str, Path, NoneType)):
            raise UsageError(f"inputs names an inputs file; a {type(inputs).__name__} of values is stated with set=")
        if inputs is not None:
            return read_setup(Path(inputs), self.offer, overrides=overrides, label=self.label)
        text, file, folder = self.text or example_of(self.offer)
        return setup_from_text(text, self.offer, file=file, folder=folder, overrides=overrides, label=self.label)

    def run(
        self,
        inputs: str | Path | None = None,
        *,
        cases: Any = None,
        workers: int | None = None,
        cluster: str = "",
        output: str | Path | None = None,
        resume: bool = False,
        pdf: bool = False,
        docx: bool = False,
        excel: bool = False,
        xlsx: bool = False,
        set: Mapping[str, Any] | None = None,
        progress: Progress | bool = True,
        **values: Any,
    ) -> Run:
        """Run the calculation and its studies: what ``calc run`` does; nothing is written without ``output``.

        ``inputs`` is an inputs file; without one the shipped example runs. ``cases`` is a file or a dataframe, in which
        every row is a case. It is computed in ``workers`` processes, or on the dask ``cluster`` at an address; the
        answer does not depend on it. ``output`` is a folder that is complete or absent, whatever happens; with
        ``resume`` finished batches are kept beside it, and those of an interrupted run are taken up; ``pdf``,
        ``docx``, ``excel`` and ``xlsx`` are as in ``Run.save``. Raises TruingError with one sentence.
        """
        setup = self.setup(inputs, set=set, **values)
        how: dict[str, Any] = {"workers": workers, "cluster": cluster, "resume": resume}
        how |= {"pdf": pdf, "docx": docx, "excel": excel, "xlsx": xlsx}
        return performed(setup, self.offer, progress, output=output, cases=cases, **how)

    def study(
        self,
        study: Study,
        inputs: str | Path | None = None,
        *,
        workers: int | None = None,
        output: str | Path | None = None,
        set: Mapping[str, Any] | None = None,
        progress: Progress | bool = True,
        **values: Any,
    ) -> StudyResult:
        """Run one study, whether the model declares it or not, and return what it found.

        ``output`` is a folder for the sheet of this study and its numbers, complete or absent, whatever happens.
        """
        if not hasattr(study, "run"):
            raise UsageError(f"{study!r:.60} is no study; hand in one, such as truing.Sensitivity()")
        setup = replace(self.setup(inputs, set=set, **values), studies=(study,))
        run = performed(setup, self.offer, progress, workers=workers, output=output, alone=True)
        return replace(run.studies[study.name], warnings=run.warnings, document=run.document)

    def sweep(
        self,
        input: str,
        at: Any,
        *,
        over: tuple[str, Any] | None = None,
        results: str | Sequence[str] = (),
        points: int = 181,
        **more: Any,
    ) -> StudyResult:
        """Evaluate results along an input or condition, whether the model declares it or not: what ``calc sweep`` does.

        ``at`` is a range, "50..100 N*m" or two ends (texts with units, or numbers in the declared unit), evenly divided
        into ``points``, or a list "50, 60, 80 N*m". ``over`` is a second input with its range: a line for each of its
        values. ``results`` names what is shown; without it every result that changes. Everything else is as in
        ``study``. A point without an answer keeps its reason.
        """
        by, by_at = over or ("", "")
        chosen = (results,) if isinstance(results, str) else tuple(results)
        lines = self._range(by, by_at)
        sweep = Sweep(over=input, at=self._range(input, at), by=by, by_at=lines, results=chosen, points=points)
        return self.study(sweep, **more)

    def _range(self, input: str, at: Any) -> str:
        """Return a range as text. Raises UsageError for what is neither a text nor two ends."""
        if isinstance(at, str):
            return at
        if not isinstance(at, Sequence) or len(at) != 2:
            raise UsageError(f'{input}: {at!r:.60} is no range; write "low..high unit" or (low, high)')
        return "..".join(text_of(self.offer.model, input, end) for end in at)

    def frequency(self, input: str = "", output: str = "", *, over: str = "", at: str = "", **more: Any) -> StudyResult:
        """Linearise a model that moves: its poles, gain and phase from an input to an output, frequencies over speed.

        ``output`` is a state or a result along time; over an input or condition ``over`` the poles are followed along
        the range ``at`` ("0..6000 rpm"). Further options are those of ``Frequency`` (``point``, ``frequencies``,
        ``orders`` ...), everything else is as in ``study``.
        """
        names = {field.name for field in fields(Frequency)}
        options = {name: more.pop(name) for name in names & {*more}}
        return self.study(Frequency(input=input, output=output, over=over, at=at, **options), **more)

    def evaluate(
        self,
        frame: Any,
        inputs: str | Path | None = None,
        *,
        units: Mapping[str, str] | None = None,
        set: Mapping[str, Any] | None = None,
        **values: Any,
    ) -> Any:
        """Calculate every row of a dataframe: it comes back with a column for every result, as the gauge would show it.

        Columns that are named like inputs and conditions replace them, each with its unit in the name ("load [N]") or
        in ``units``; results are in the units they are printed in, with these in their names. Columns of the dataframe
        that are named like these are left out. A row without an answer has NaN there, and the reason in the column
        ``fault``. Raises InputError with every fault of the dataframe.
        """
        setup = self.setup(inputs, set=set, **values)
        rows = read_rows(frame_text(frame, units or {}), self.offer, setup)
        _demand_known(rows, setup)
        with told_by_line(setup):
            shown_rows = gauge.shown_by_gauge(setup, rows)
        results: dict[str, Any] = {
            f"{name} [{shown_rows.units[name] or '1'}]": column for name, column in shown_rows.values.items()
        }
        faults = [shown_rows.reasons.get(row, "") for row in range(len(rows))]
        return beside(frame, {**results, "fault": faults}, without={*shown_rows.values, "fault"})

    def diagnose(
        self,
        record: MeasuredRecord,
        inputs: str | Path | None = None,
        *,
        hold_out: str = "",
        per_file: Sequence[str] = (),
        budget: int = 0,
        output: str | Path | None = None,
        pdf: bool = False,
        docx: bool = False,
        xlsx: bool = False,
        set: Mapping[str, Any] | None = None,
        progress: Progress | bool = True,
        **values: Any,
    ) -> Diagnosis:
        """Find what the model gets wrong on a record: what ``calc diagnose`` does.

        ``hold_out`` marks rows that only judge ("judged = yes"), ``per_file`` names what every file has for itself,
        ``budget`` is how many calls of the model the search may make (0: as many as its time allows). Nothing is
        written without ``output``, a folder that is complete or absent; ``pdf``, ``docx`` and ``xlsx`` are as in
        ``Diagnosis.save``. Raises TruingError with one sentence, or every fault of a file.
        """
        _demand_record(record)
        files = {"pdf": pdf, "docx": docx, "xlsx": xlsx}
        demand_files(output, files, "diagnosis")
        options = {"hold_out": hold_out, "per_file": list(per_file), "budget": budget}
        stated = {f"studies.diagnose.{name}": toml_value(value) for name, value in options.items() if value}
        setup = self.setup(inputs, set={**stated, **(set or {})}, **values)
        with progress_bar(progress) as report, told_by_line(setup):

            def as_one(stage: str, step: int, steps: int) -> None:
                report("diagnosis" if steps else stage, step, steps)

            started, records = time.time(), reading.read_records(record.files, self.offer, setup)
            result = engine.diagnose(setup, records, progress=as_one, propose=proposal.proposed)
            diagnosis = Diagnosis(self.offer, result, started)
            report("sheet and PDF" if pdf else "sheet", 0, 0)
            return diagnosis if output is None else replace(diagnosis, note=diagnosis.written(Path(output), **files))

    def plan(
        self,
        causes: Sequence[str],
        inputs: str | Path | None = None,
        *,
        noise: Mapping[str, Any] | None = None,
        budget: int = BUDGET,
        set: Mapping[str, Any] | None = None,
        progress: Progress | bool = True,
        **values: Any,
    ) -> Plan:
        """Design an experiment that tells causes apart, before any data exist: what ``calc plan`` does.

        ``causes`` names effects, or tolerated inputs as "input:NAME"; ``noise`` holds by result the standard deviation
        of one reading (a text with a unit, or a number in the declared unit), where the inputs file does not;
        ``budget`` is how many readings there may be. Raises TruingError with one sentence.
        """
        if isinstance(causes, str):
            raise UsageError(f'causes is a list of names, such as ["{causes}", "sensor_drift"]')
        known = self.offer.model.result_fields
        texts = {
            name: sd if isinstance(sd, str) or name not in known else f"{sd!r} {difference_unit(known[name].unit)}"
            for name, sd in (noise or {}).items()
        }
        stated = {"studies.diagnose.noise": toml_value(texts)} if texts else {}
        setup = self.setup(inputs, set={**stated, **(set or {})}, **values)
        with progress_bar(progress) as report, told_by_line(setup):
            report("experiment", 0, 0)
            return plans.Plan(self.offer, planning.planned(setup, causes, budget=budget))

    def describe(self) -> dict[str, Any]:
        """Return everything the model declares, as ``calc describe --json`` prints it."""
        return describe.description(self.offer)

    def verify(self, *, progress: Progress | bool = True) -> list[ComparedRow]:
        """Return every number that the source prints beside ours, as ``calc verify`` compares them."""
        with progress_bar(progress) as report:
            return compare_published(self.offer, progress=report)

    def example(self) -> str:
        """Return a commented inputs file that runs as it is: what ``calc init`` writes."""
        return text_to_fill_in(self.offer)

    def _repr_html_(self) -> str:
        """Show what the model takes and answers, and what could make it wrong."""
        said = self.describe()
        tables = describe.sections(said)
        inputs = html_table(tables.pop("Inputs", ()), ("input", "symbol", "default", "unit", ""))
        results = html_table(tables.pop("Results", ()), ("result", "symbol", "unit", ""))
        studies = [f"Studies: {', '.join(said['studies'])}"] if said["studies"] else []
        head = heading(f"{self.name}: {self.title}") + paragraphs([said["summary"]] if said["summary"] else [])
        rest = "".join(fold(f"{title} ({len(rows)})", html_table(rows)) for title, rows in tables.items())
        return joined(head, inputs, results, rest, paragraphs(studies))

    def _settings(self, set: Mapping[str, Any] | None, values: Mapping[str, Any]) -> list[str]:
        return settings_of(self.offer.model, {**(set or {}), **values})


def _demand_record(record: Any) -> None:
    """Raise UsageError, saying how a record is made, for anything else."""
    if not isinstance(record, measured.MeasuredRecord):
        made = "truing.read(files, model) or truing.record(dataframe, model)"
        raise UsageError(f"a {type(record).__name__} is no record; make one with {made}")


def _demand_known(rows: RowsFile, setup: Setup) -> None:
    """Raise InputError for a column that changes nothing and is called nearly like one that would."""
    known = [*setup.model.input_fields, *setup.conditions]
    faults = []
    for name in rows.others:
        hint = near_miss(name[:80], [one for one in known if one not in rows.columns])
        if hint and name not in setup.model.result_fields:
            faults.append(Fault(f"column {shown(name)} changes nothing.{hint} Rename it or leave it out", LABEL, 1))
    if faults:
        raise InputError(faults)


@dataclass(frozen=True)
class Diagnosis:
    """A finished diagnosis.

    ``verdict`` is "named", "one_of", "unknown", "none" or "undecided"; ``sentences`` say it in words; ``document`` is
    what diagnosis.json holds; ``result`` has everything in SI; ``note`` says what became of a PDF.
    """

    offer: Offer
    result: DiagnosisResult
    started: float
    note: str = ""

    def __repr__(self) -> str:
        said = [f"{diagnosis_words.verdict_word(self.result)}.", *self.sentences]
        return f"<Diagnosis of {self.offer.name}: {' '.join(said)}>"

    @property
    def verdict(self) -> Verdict:
        """What may be said in one word."""
        return self.result.verdict

    @property
    def sentences(self) -> tuple[str, ...]:
        """The verdict in words: what is wrong, how sure, what to do."""
        return tuple(diagnosis_words.headline(self.result))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What speaks against the causes that are named."""
        return self.result.warnings

    @property
    def notes(self) -> tuple[str, ...]:
        """What was done to the record, and which of its columns may be misspelt or in another unit than written."""
        records = self.result.records
        slips = (f"suspected unit slip: {slip.text} (nothing was changed)" for slip in records.unit_errors)
        unused = (f"{count.file}: {count.sentence()}" for count in records.counts if count.unused)
        return (*slips, *unused, *records.notes)

    @cached_property
    def causes(self) -> tuple[NamedCause, ...]:
        """The causes that are named, the largest first."""
        return findings.causes_of(self.result)

    @cached_property
    def document(self) -> dict[str, Any]:
        """What diagnosis.json holds."""
        return diagnosis_document.diagnosis_document(self.result)

    @property
    def ranking(self) -> Ranking:
        """The explanations that were compared, the best first."""
        return findings.Ranking(self.result)

    @property
    def residuals(self) -> Residuals:
        """What the model leaves of the readings, before and after."""
        return findings.Residuals(self.result)

    @property
    def extended(self) -> LoadedModel:
        """The model with the causes on and its inputs calibrated. Raises UsageError where nothing was found."""
        text = extension.extended_text(self.result)
        if not text:
            raise UsageError("nothing was named and nothing calibrated: there is no extended model")
        return LoadedModel(self.offer, (), (text, "extended.toml", Path.cwd()))

    def plot(self) -> Figure:
        """Draw what convinces: the residuals before and after, over what the cause depends on."""
        return self.residuals.plot()

    def sheet(self, path: str | Path, *, units: str = "", language: str = "") -> Path:
        """Write the sheet as HTML, Markdown, PDF or a Word document, as the name ends.

        ``units`` are "SI" or "inch", ``language`` "en" or "de"; "" those of the diagnosis. Raises OutputError, and
        UsageError for others.
        """
        result = replace(self.result, setup=sheet_in(self.result.setup, units=units, language=language))
        return write_sheet(path, partial(diagnosis_sheet.diagnosis_sheet_of, result, self.started))

    def save(self, folder: str | Path, *, pdf: bool = False, docx: bool = False, xlsx: bool = False) -> Path:
        """Write the folder that ``calc diagnose`` writes; an earlier diagnosis there goes.

        ``pdf`` prints the sheet where a browser is installed, ``docx`` adds it as a Word document, ``xlsx`` adds a
        workbook. Raises OutputError.
        """
        target = Path(folder)
        demand_place(target, "diagnosis")
        note = self.written(target, pdf=pdf, docx=docx, xlsx=xlsx)
        if note.startswith("no PDF"):
            warnings.warn(note, stacklevel=2)
        return target

    def written(self, folder: Path, *, pdf: bool = False, docx: bool = False, xlsx: bool = False) -> str:
        """Write the folder and return what became of the PDF."""
        sheet = diagnosis_sheet.diagnosis_sheet_of(self.result, self.started)
        sheets, note = sheets_of(sheet, folder, pdf=pdf, word=docx)
        info = {**run_info(self.started), "data": dict(self.result.records.digests)}
        write_outcome(
            folder, "diagnosis", self.result.setup, self.document, provenance=sheet.provenance, run_info=info,
            files=diagnosis_files.diagnosis_files(self.result, sheets, folder, xlsx=xlsx),
        )  # fmt: skip
        return note

    def compare(self, before: Diagnosis) -> Differences:
        """Return what differs from ``before`` to this diagnosis: data, verdict, causes, errors, gain."""
        return differences.differences_of(
            before.document,
            self.document,
            lambda language: (before.side("before", language), self.side("after", language)),
        )

    def side(self, name: str, language: str = "") -> Side:
        """Return what a page of two diagnoses is written from: the document, and the figures of the sheet."""
        result = replace(self.result, setup=sheet_in(self.result.setup, language=language))
        figures = comparison_page.figures_in(diagnosis_sheet.diagnosis_sheet_of(result, self.started))
        return comparison_page.Side(name, self.document, figures, result.setup.model, self.offer.origin.file)

    def _repr_html_(self) -> str:
        """Show the verdict, the causes, the residuals before and after, and the rest folded away."""
        said = [f"{diagnosis_words.verdict_word(self.result)}. {' '.join(self.sentences)}"]
        warned = [f"Warning: {text}" for text in self.warnings]
        table = table_html(diagnosis_chapters.fitted_table(self.result)) if self.causes else ""
        lines = {**diagnosis_sheet.questions(self.result), **({"Record": list(self.notes)} if self.notes else {})}
        rest = "".join(fold(title, bullets(texts)) for title, texts in lines.items())
        head = heading(f"Diagnosis of {self.result.setup.model.title}, {diagnosis_sheet.data_words(self.result)}")
        shown = picture(self.residuals.drawn, "Residuals before and after")
        return joined(head + paragraphs([*said, *warned]), table, shown, fold("More", rest))


# Loading a model: the first call of a user


def load(plugin: str | Path) -> LoadedModel:
    """Load a model: an installed plugin by its name, one model of several as "plugin.model", or a file (``.py``).

    Plugins that are broken are left out, with a warning each. Raises UnknownPluginError where there is no such model,
    PluginError where the plugin that is named is broken.
    """
    return LoadedModel(offer_of(str(plugin), lambda text: warnings.warn(text, stacklevel=4)))


def compare(
    before: str | Path, after: str | Path, *, plugin: str = "", progress: Progress | bool = True
) -> Differences:  # fmt: skip
    """Return what differs between two runs, or two diagnoses: what ``calc compare`` does.

    Each is a folder that was written, or an inputs file (.toml, .xlsx), which runs now; ``plugin`` runs it where it
    names none. Raises TruingError with one sentence.
    """
    return differences.differences_of_paths(
        before, after, lambda name, file: load(name).run(file, progress=progress), plugin=plugin
    )  # fmt: skip
