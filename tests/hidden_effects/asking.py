"""A case as files, and what Truing says to it. Everything that calls the diagnosis stands here."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from hidden_effects.candidates import HOUR
from hidden_effects.cases import Case
from hidden_effects.press_machine import POSITION, TILT, Array, Rows

if TYPE_CHECKING:
    from truing.diagnosis.result import Diagnosis
    from truing.kernel import Offer
    from truing.setup import Setup

INPUTS = (
    'plugin = "press_linkage"\n\n[inputs]\nreading = "complete"\n'
    '\n[studies.diagnose]\nbox = {crank_angle = "-60..60 deg"}\n'
)
WRITTEN = {POSITION: ("mm", 1e3), TILT: ("urad", 1e6)}


def table(rows: Rows, readings: Mapping[str, Array], counters: tuple[float, float] = (0.0, 0.0)) -> str:
    """The rows as CSV with units in the header, every digit kept."""
    columns = {
        "crank_angle [deg]": rows.crank_angle * 180 / pi,
        "forming_force [kN]": rows.forming_force / 1e3,
        "link_temperature [degC]": rows.link_temperature,
        "time [h]": (rows.time + counters[0]) / HOUR,
        "strokes [1]": rows.strokes + counters[1],
        "speed [rpm]": rows.speed * 60,
        "direction [1]": rows.direction,
        **{f"{name} [{WRITTEN[name][0]}]": values * WRITTEN[name][1] for name, values in readings.items()},
    }
    lines = [",".join(columns)]
    lines += [",".join(repr(float(cell)) for cell in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join(lines) + "\n"


def write_case(case: Case, folder: Path) -> None:
    """Write what a user would have: inputs, the record, and a second one to judge with."""
    (folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
    (folder / "measured.csv").write_text(table(case.record.rows, case.readings, case.counters), encoding="utf-8")
    (folder / "held_out.csv").write_text(table(case.held, case.held_readings, case.counters), encoding="utf-8")


@cache
def press_offer() -> Offer:
    """The press linkage as installed."""
    from truing.kernel import Kernel

    return Kernel.installed().offer("press_linkage")


@dataclass(frozen=True)
class Answer:
    """What was said to a case: the document, and what the model then predicts for rows that were held out.

    ``predicted`` is what the calibrated machine shows with every cause and shape that was found, in SI, one result
    after another, without the first row (that of the record).
    """

    document: dict[str, Any]
    predicted: Array
    seconds: float


def diagnosed(case: Case) -> Answer:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    from time import perf_counter

    from truing.diagnosis.engine import diagnose
    from truing.diagnosis.reading import read_records
    from truing.inputs_file import read_setup
    from truing.runs.diagnosis_document import diagnosis_document

    offer = press_offer()
    with TemporaryDirectory() as name:
        folder = Path(name)
        write_case(case, folder)
        setup = read_setup(folder / "inputs.toml", offer)
        start = perf_counter()
        diagnosis = diagnose(setup, read_records([folder / "measured.csv"], offer, setup))
        seconds = perf_counter() - start
        document = json.loads(json.dumps(diagnosis_document(diagnosis)))
        return Answer(document, _predicted(case, diagnosis, setup, folder / "held_out.csv"), seconds)


def _predicted(case: Case, diagnosis: Diagnosis, setup: Setup, file: Path) -> Array:
    """Predict the rows held out, one result after another, the first row (that of the record) left out."""
    from dataclasses import replace

    from truing.diagnosis.reading import read_records
    from truing.gauge import one_machine, read_by_gauge

    calibrated = {item.name: item.value for item in diagnosis.calibrated}
    machine = diagnosis.extended or replace(setup, calibrated={**setup.calibrated, **calibrated})
    records = read_records([file], press_offer(), setup)
    shown = read_by_gauge(one_machine(machine), records.rows, case.results).results
    known: dict[str, Any] = {name: one.values for name, one in records.covariates.items()}
    parts = []
    for result in case.results:
        values = shown[result]
        for term in diagnosis.remainder.terms.get(result, ()) if diagnosis.remainder else ():
            values = values + term.coefficient * np.asarray(eval(term.expression, {"np": np}, known))
        parts.append(values[1:])
    return np.concatenate(parts)
