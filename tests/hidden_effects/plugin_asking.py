"""A record as files, and what Truing says to it, whatever the plugin. All that calls the diagnosis stands here."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from truing.diagnosis.result import Diagnosis
    from truing.kernel import Offer
    from truing.setup import Setup

Array: TypeAlias = NDArray[np.float64]


class Case(Protocol):
    """A record with its readings, and rows held out with theirs; ``wish.results`` names what is measured."""

    @property
    def wish(self) -> Any: ...
    @property
    def rows(self) -> Any: ...
    @property
    def held(self) -> Any: ...
    @property
    def readings(self) -> Mapping[str, Array]: ...
    @property
    def held_readings(self) -> Mapping[str, Array]: ...


@dataclass(frozen=True)
class Answer:
    """What was said to a case: the document, what the extended model predicts for rows held out, and the time taken."""

    document: dict[str, Any]
    predicted: dict[str, Array]
    seconds: float


@cache
def _offer(plugin: str) -> Offer:
    """The plugin as installed."""
    from truing.kernel import Kernel

    return Kernel.installed().offer(plugin)


@dataclass(frozen=True, kw_only=True)
class Rig:
    """A plugin with the text of its inputs file, and the columns of a record and of its readings with their units."""

    plugin: str
    inputs: str
    written: Mapping[str, str]
    measured: Mapping[str, str]

    def diagnosed(self, case: Case) -> Answer:
        """Ask for a diagnosis of the record and predict the rows that were held out."""
        from time import perf_counter

        from truing.diagnosis.engine import diagnose
        from truing.diagnosis.reading import read_records
        from truing.inputs_file import read_setup
        from truing.runs.diagnosis_document import diagnosis_document

        offer = _offer(self.plugin)
        with TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "inputs.toml").write_text(self.inputs, encoding="utf-8")
            (folder / "measured.csv").write_text(self._table(case.rows, case.readings), encoding="utf-8")
            (folder / "held_out.csv").write_text(self._table(case.held, case.held_readings), encoding="utf-8")
            setup = read_setup(folder / "inputs.toml", offer)
            start = perf_counter()
            diagnosis = diagnose(setup, read_records([folder / "measured.csv"], offer, setup))
            seconds = perf_counter() - start
            document = json.loads(json.dumps(diagnosis_document(diagnosis)))
            return Answer(document, self._predicted(case, diagnosis, setup, folder / "held_out.csv"), seconds)

    def _table(self, rows: Any, readings: Mapping[str, Array]) -> str:
        """The rows as CSV with units in the header, every digit kept."""
        columns = {f"{name} [{unit}]": getattr(rows, name) for name, unit in self.written.items()}
        columns |= {f"{name} [{self.measured[name]}]": values for name, values in readings.items()}
        lines = [",".join(columns)]
        lines += [",".join(repr(float(cell)) for cell in row) for row in zip(*columns.values(), strict=True)]
        return "\n".join(lines) + "\n"

    def _predicted(self, case: Case, diagnosis: Diagnosis, setup: Setup, file: Path) -> dict[str, Array]:
        """Predict the rows held out, in the units of the file; the clock counts from the first row of the record."""
        from dataclasses import replace

        from truing.diagnosis.reading import read_records
        from truing.gauge import one_machine, read_by_gauge
        from truing.units import from_si

        calibrated = {item.name: item.value for item in diagnosis.calibrated}
        machine = diagnosis.extended or replace(setup, calibrated={**setup.calibrated, **calibrated})
        records = read_records([file], _offer(self.plugin), setup)
        shown = read_by_gauge(one_machine(machine), records.rows, case.wish.results).results
        known: dict[str, Any] = {name: one.values for name, one in records.covariates.items()}
        found = {}
        for result in case.wish.results:
            values = shown[result]
            for term in diagnosis.remainder.terms.get(result, ()) if diagnosis.remainder else ():
                values = values + term.coefficient * np.asarray(eval(term.expression, {"np": np}, known))
            found[result] = np.asarray(from_si(values, self.measured[result]))
        return found
