"""A planned experiment as a user has it: a sentence, its readings as a table, a file to fill in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from truing.api.notebook import heading, joined, paragraphs, table_html
from truing.api.tables import frame_of
from truing.atomic import write_files
from truing.diagnosis.result import Amount, Chance
from truing.errors import UsageError
from truing.experiments.planning import Planned
from truing.kernel import Offer
from truing.measurements import table_text
from truing.report.diagnosis_sizes import amount_text, readable
from truing.report.diagnosis_statistics import readings_table
from truing.report.diagnosis_words import experiment_text, listed, spoken
from truing.runs.diagnosis_document import plan_document
from truing.runs.spreadsheet import column_sheet
from truing.units import difference_unit, from_si
from truing.workbooks.writing import workbook_bytes


@dataclass(frozen=True)
class Plan:
    """An experiment that was planned before any data exist.

    ``sentences`` say what to hold and what to vary, what it tells apart and with which chance; ``document`` is what
    ``calc plan --json`` prints; ``planned`` has everything in SI.
    """

    offer: Offer
    planned: Planned

    def __repr__(self) -> str:
        return f"<Plan for {self.offer.name}: {' '.join(self.sentences)}>"

    @property
    def chance(self) -> Chance | None:
        """The simulated chance of naming the right cause, with its interval; None where nothing tells them apart."""
        return None if self.planned.experiment is None else self.planned.experiment.chance

    @cached_property
    def sentences(self) -> tuple[str, ...]:
        """The experiment in words, then how large the causes were taken to be and how well is read."""
        noise = [
            f"{spoken(name)} {amount_text(readable(Amount(sd, difference_unit(self.planned.setup.print_unit(name)))))}"
            for name, sd in self.planned.noise.items()
        ]
        experiment, names = self.planned.experiment, listed([spoken(name) for name in self.planned.causes])
        if experiment is None:
            within = f"no experiment of {self.planned.budget} readings or a hundred tells {names} apart"
            return (f"Within what can be varied here {within}: measure another result, or vary more.",)
        words = experiment_text(experiment)
        sizes = [f"{spoken(name)} {amount_text(readable(size))}" for name, size in experiment.sizes.items()]
        return (
            f"{words[:1].upper()}{words[1:]}.",
            f"So it is where {listed(sizes)}, with a standard deviation of one reading of {listed(noise)}.",
        )

    @cached_property
    def document(self) -> dict[str, Any]:
        """What ``calc plan --json`` prints."""
        return plan_document(self.planned)

    def frame(self) -> Any:
        """Return the readings to take as a dataframe, with units in the names and an empty column for every result.

        Raises UsageError where no experiment tells the causes apart.
        """
        return frame_of(self._columns())

    def save(self, path: str | Path) -> Path:
        """Write the readings to take, to be filled in and diagnosed: CSV, or a workbook where the name ends in .xlsx.

        Raises UsageError and OutputError.
        """
        columns = self._columns()
        if Path(path).suffix.lower() == ".xlsx":
            table = column_sheet("readings", columns, self.planned.setup.model)
            write_files({Path(path): workbook_bytes([table])})
        else:
            write_files({Path(path): table_text(list(columns), list(columns.values()))})
        return Path(path)

    def _columns(self) -> Mapping[str, list[float]]:
        experiment = self.planned.experiment
        if experiment is None:
            raise UsageError(self.sentences[0])
        units = {name: self.planned.setup.print_unit(name) for name in experiment.results}
        settings = {
            f"{name} [{experiment.units[name] or '1'}]": np.asarray(from_si(values, experiment.units[name])).tolist()
            for name, values in experiment.settings.items()
        }
        empty = [float("nan")] * experiment.readings
        return settings | {f"{name} [{unit or '1'}]": empty for name, unit in units.items()}

    def _repr_html_(self) -> str:
        experiment = self.planned.experiment
        table = "" if experiment is None else table_html(readings_table(experiment))
        return joined(heading(f"An experiment for {self.offer.name}"), paragraphs(self.sentences), table)
