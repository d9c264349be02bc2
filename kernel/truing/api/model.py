"""A model as a user has it: run it, calculate rows, diagnose a record; what a diagnosis finds is a model again."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from truing.api.findings import NamedCause, Ranking, Residuals, causes_of
from truing.api.records import Record
from truing.api.run import Run, html_table
from truing.api.settings import settings_of
from truing.api.tables import as_file, beside
from truing.atomic import write_files
from truing.calculation import calculate
from truing.declare.model import Study
from truing.diagnosis import result as found
from truing.diagnosis.engine import diagnose
from truing.diagnosis.reading import read_records
from truing.diagnosis.result import Verdict
from truing.errors import UsageError
from truing.example_file import example_of
from truing.executors import open_executor
from truing.gauge import shown_by_gauge
from truing.inputs_file import read_setup, setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.kernel import Offer
from truing.measurements import read_rows
from truing.report.diagnosis_run import diagnosis_sheet_of, write_diagnosed
from truing.report.diagnosis_sheet import diagnosis_html, diagnosis_markdown
from truing.report.diagnosis_words import headline
from truing.report.run import place_of
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.extension import extended_text
from truing.runs.folder import demand_place
from truing.setup import Setup
from truing.studies.bench import Progress, silent
from truing.studies.sweep import Sweep


@dataclass(frozen=True)
class LoadedModel:
    """A model that was loaded, with the inputs of its shipped example until others are stated.

    ``stated`` holds what every run of it states, in the words of ``--set``; ``text`` the inputs file that stands in
    place of the example, its name, and the folder in which it looks for data files.
    """

    offer: Offer
    stated: tuple[str, ...] = ()
    text: tuple[str, str, Path] | None = None

    @property
    def name(self) -> str:
        """What the model is called."""
        return self.offer.name

    @property
    def title(self) -> str:
        """What it calculates, in a line."""
        return self.offer.model.title

    def given(self, **values: Any) -> LoadedModel:
        """Return the model with these values in every run: see ``run``."""
        return replace(self, stated=(*self.stated, *settings_of(self.offer.model, values)))

    def setup(self, inputs: str | Path | None = None, **values: Any) -> Setup:
        """Return what a run would calculate: the inputs file, or the shipped example, and values in place of its own.

        Raises InputError with every fault.
        """
        overrides = [*self.stated, *settings_of(self.offer.model, values)]
        if inputs is not None:
            return read_setup(Path(inputs), self.offer, overrides=overrides, label="")
        text, file, folder = self.text or example_of(self.offer)
        return setup_from_text(text, self.offer, file=file, folder=folder, overrides=overrides, label="")

    def run(
        self, inputs: str | Path | None = None, *, workers: int = 1, progress: Progress = silent, **values: Any
    ) -> Run:
        """Run the calculation and its studies: what ``calc run`` does, without writing anything.

        ``inputs`` is an inputs file; without one the shipped example runs. Every other argument states an input, a
        condition, ``seed`` or ``draws``: a text with its unit ("12 mm"), a number in the declared unit, or a quantity
        of pint. Names with a dot are passed as ``**{"tolerances.load": "off"}``. Raises TruingError with one sentence.
        """
        return self._ran(self.setup(inputs, **values), workers=workers, progress=progress)

    def study(self, study: Study, inputs: str | Path | None = None, *, workers: int = 1, **values: Any) -> Any:
        """Run one study, whether the model declares it or not, and return its outcome."""
        setup = replace(self.setup(inputs, **values), studies=(study,))
        return self._ran(setup, workers=workers).outcomes[study.name]

    def sweep(self, over: str, low: str, high: str, points: int = 181, **values: Any) -> Any:
        """Evaluate every result along one input or condition, from ``low`` to ``high``, texts with units."""
        return self.study(Sweep(over=over, at=f"{_number_of(low, high)}..{high}", points=points), **values)

    def evaluate(self, frame: Any, *, units: Mapping[str, str] | None = None, **values: Any) -> Any:
        """Calculate every row of a dataframe: it comes back with a column for every result, as the gauge would show it.

        Columns that are named like inputs and conditions replace them, each with its unit in the name ("load [N]") or
        in ``units``; results are in the units they are printed in, with these in their names. A row without an answer
        has NaN there, and the reason in the column ``fault``. Raises InputError with every fault of the dataframe.
        """
        setup = self.setup(**values)
        with as_file(frame, units or {}) as path:
            rows = read_rows(path, self.offer, setup)
        shown = shown_by_gauge(setup, rows)
        results: dict[str, Any] = {
            f"{name} [{shown.units[name] or '1'}]": column for name, column in shown.values.items()
        }
        return beside(frame, {**results, "fault": [shown.reasons.get(row, "") for row in range(len(rows))]})

    def diagnose(
        self,
        record: Record,
        inputs: str | Path | None = None,
        *,
        hold_out: str = "",
        per_file: Sequence[str] = (),
        budget: int = 0,
        progress: Progress = silent,
        **values: Any,
    ) -> Diagnosis:
        """Find what the model gets wrong on a record: what ``calc diagnose`` does, without writing anything.

        ``hold_out`` marks rows that only judge ("judged = yes"), ``per_file`` names what every file has for itself,
        ``budget`` is how many calls of the model the search may make (0: as many as its time allows). ``inputs`` and
        ``values`` are those of ``run``. Raises TruingError with one sentence, or every fault of a file.
        """
        started = time.time()
        options = {"hold_out": hold_out, "per_file": list(per_file), "budget": budget}
        stated = {f"studies.diagnose.{name}": toml_value(value) for name, value in options.items() if value}
        setup = self.setup(inputs, **stated, **values)
        records = read_records(record.files, self.offer, setup)
        return Diagnosis(self.offer, diagnose(setup, records, progress=progress), started)

    def _ran(self, setup: Setup, *, workers: int = 1, progress: Progress = silent) -> Run:
        started = time.time()
        with open_executor(place_of(workers)) as executor:
            calculation = calculate(setup, executor=executor, progress=progress)
        return Run(self.offer, calculation, started)


def _number_of(low: str, high: str) -> str:
    """Return the number of the lower end. Raises UsageError where the two ends are in different units."""
    number, _, unit = low.strip().partition(" ")
    if unit.strip() != high.strip().partition(" ")[2].strip():
        raise UsageError(f"a sweep from '{low}' to '{high}': write both ends in one unit")
    return number


@dataclass(frozen=True)
class Diagnosis:
    """A finished diagnosis; nothing of it is written until ``sheet`` or ``save`` is asked.

    ``verdict`` is "named", "one_of", "unknown", "none" or "undecided"; ``sentences`` say it in words; ``document`` is
    what diagnosis.json holds; ``result`` has everything in SI.
    """

    offer: Offer
    result: found.DiagnosisResult
    started: float

    @property
    def verdict(self) -> Verdict:
        """What may be said in one word."""
        return self.result.verdict

    @property
    def sentences(self) -> tuple[str, ...]:
        """The verdict in words: what is wrong, how sure, what to do."""
        return tuple(headline(self.result))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What speaks against the causes that are named."""
        return self.result.warnings

    @cached_property
    def causes(self) -> tuple[NamedCause, ...]:
        """The causes that are named, the largest first."""
        return causes_of(self.result)

    @cached_property
    def document(self) -> dict[str, Any]:
        """What diagnosis.json holds."""
        return diagnosis_document(self.result)

    @property
    def ranking(self) -> Ranking:
        """The explanations that were compared, the best first."""
        return Ranking(self.result)

    @property
    def residuals(self) -> Residuals:
        """What the model leaves of the readings, before and after."""
        return Residuals(self.result)

    @property
    def extended(self) -> LoadedModel:
        """The model with the causes on and its inputs calibrated. Raises UsageError where nothing was found."""
        text = extended_text(self.result)
        if not text:
            raise UsageError("nothing was named and nothing calibrated: there is no extended model")
        return LoadedModel(self.offer, (), (text, "extended.toml", Path.cwd()))

    def sheet(self, path: str | Path) -> Path:
        """Write the sheet: HTML, or Markdown where the name ends in ``.md``."""
        file = Path(path)
        sheet = diagnosis_sheet_of(self.result, self.started)
        write_files({file: diagnosis_markdown(sheet) if file.suffix == ".md" else diagnosis_html(sheet)})
        return file

    def save(self, folder: str | Path) -> Path:
        """Write the folder that ``calc diagnose`` writes; an earlier diagnosis there goes."""
        place = Path(folder)
        demand_place(place, "diagnosis")
        write_diagnosed(self.result, place, started=self.started)
        return place

    def _repr_html_(self) -> str:
        """Show the verdict, the causes and the ranking; inert and self-contained."""
        said = "".join(f"<p>{escape(sentence)}</p>" for sentence in self.sentences)
        return f"<h4>{escape(self.result.setup.model.title)}</h4>{said}{html_table(self._cells())}"

    def _cells(self) -> Iterator[Sequence[str]]:
        for cause in self.causes:
            for name, each in cause.unknowns.items():
                ends = " … ".join("open" if end is None else f"{end:.4g}" for end in each.interval95)
                yield cause.effect, name, f"{each.value:.4g} {each.unit}".rstrip(), f"95 %: {ends}"
