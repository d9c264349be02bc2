"""A record with what was hidden in it, and what a diagnosis answers to it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.model import Model
from truing.diagnosis.engine import diagnose
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.result import DiagnosisResult
from truing.gauge import one_machine, read_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.inputs_written import complete_inputs
from truing.setup import Setup
from truing.testing.subject import Subject

MEASURED, HELD_OUT, INPUTS = "measured.csv", "held_out.csv", "inputs.toml"


@dataclass(frozen=True)
class Answered:
    """What a diagnosis said, as result and as diagnosis.json, and what it is worth on rows it has never seen.

    ``held`` and ``predicted`` are those rows as measured and as the extended model predicts them, by result, in SI;
    nothing where no rows were held out. ``seconds`` is what the diagnosis took.
    """

    diagnosis: DiagnosisResult
    document: Mapping[str, Any]
    held: Mapping[str, NDArray[np.float64]]
    predicted: Mapping[str, NDArray[np.float64]]
    seconds: float

    def error_of(self, result: str) -> float:
        """Return the root mean square error on the rows held out, SI."""
        return float(np.sqrt(np.nanmean((self.held[result] - self.predicted[result]) ** 2)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Hidden:
    """A measured record whose truth is known: what ``hide`` makes, and what ``assert_finds`` judges.

    ``measured`` and ``held_out`` are CSV as a diagnosis reads it; rows held out are never fitted. ``setup`` is what the
    engineer knows of the machine. ``truth`` holds the unknowns of the effect, ``machine`` what its inputs truly are
    where they are off their nominals, ``noise`` the root mean square of what the gauge added to the rows held out, by
    result; all in SI. Without an ``effect`` nothing registered is hidden: nothing at all, unless ``is_strange``.
    """

    setup: Setup
    measured: str
    held_out: str = ""
    effect: str | None = None
    truth: Mapping[str, float] = field(default_factory=dict)
    machine: Mapping[str, float] = field(default_factory=dict)
    noise: Mapping[str, float] = field(default_factory=dict)
    is_strange: bool = False

    @cached_property
    def answered(self) -> Answered:
        """Diagnose the record, once, and predict the rows held out."""
        return _answered(self)

    def write(self, folder: Path) -> None:
        """Write inputs.toml, measured.csv and held_out.csv, to look at and to diagnose on the command line."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / INPUTS).write_text(complete_inputs(self.setup, folder), encoding="utf-8")
        (folder / MEASURED).write_text(self.measured, encoding="utf-8")
        if self.held_out:
            (folder / HELD_OUT).write_text(self.held_out, encoding="utf-8")


def recorded(
    model: Model[Any, Any],
    *,
    inputs: str,
    measured: str,
    held_out: str = "",
    effect: str | None = None,
    truth: Mapping[str, float] | None = None,
) -> Hidden:
    """Return a record that was made elsewhere: by a generator of your own, or on a machine whose error is known.

    ``inputs`` is the text of the inputs file, ``measured`` and ``held_out`` that of CSV files with units in the header,
    ``truth`` holds the unknowns of the effect in SI. Raises InputError with every fault of the inputs.
    """
    setup = setup_from_text(inputs, Subject(model).offer, file=INPUTS, folder=Path())
    return Hidden(setup=setup, measured=measured, held_out=held_out, effect=effect, truth=truth or {})


def offer_of(setup: Setup) -> Offer:
    """Return the model of a setup as the command line would offer it."""
    name = setup.model.name
    origin = setup.origin if setup.origin.name else Origin(name, "", "", "", f"entry:{name}")
    return Offer(name, setup.model, origin)


def _answered(hidden: Hidden) -> Answered:
    records = records_of(hidden.setup, hidden.measured, MEASURED)
    start = perf_counter()
    diagnosis = diagnose(hidden.setup, records)
    seconds = perf_counter() - start
    document = json.loads(json.dumps(diagnosis_document(diagnosis)))
    if not hidden.held_out:
        return Answered(diagnosis, document, {}, {}, seconds)
    judged = records_of(hidden.setup, hidden.held_out, HELD_OUT, with_unit_errors=False)
    return Answered(diagnosis, document, judged.measured, predicted(diagnosis, hidden.setup, judged), seconds)


def records_of(setup: Setup, text: str, name: str, *, with_unit_errors: bool = True) -> Records:
    """Read a record as the command line does; without a search for wrong units where nobody is told of them."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / name
        file.write_text(text, encoding="utf-8")
        return read_records([file], offer_of(setup), setup, with_unit_errors=with_unit_errors)


def predicted(diagnosis: DiagnosisResult, setup: Setup, records: Records) -> dict[str, NDArray[np.float64]]:
    """Predict rows that were not fitted, by every cause and shape that was found on the calibrated machine; SI."""
    calibrated = {item.name: item.value for item in diagnosis.calibrated}
    machine = diagnosis.extended or replace(setup, calibrated={**setup.calibrated, **calibrated})
    shown = read_by_gauge(one_machine(machine), records.rows, diagnosis.measured).results
    known: dict[str, Any] = {name: one.values for name, one in records.covariates.items()}
    found = {}
    for result in diagnosis.measured:
        values = shown[result]
        for term in diagnosis.remainder.terms.get(result, ()) if diagnosis.remainder else ():
            values = values + term.coefficient * np.asarray(eval(term.expression, {"np": np}, known))
        found[result] = values
    return found
