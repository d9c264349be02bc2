"""A record of a first stage as files, and what Truing says to it. Everything that calls the diagnosis stands here."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from hidden_effects.gearing_cases import UNIT, Case
from hidden_effects.gearing_machine import Rows
from hidden_effects.gearing_stage import Array

if TYPE_CHECKING:
    from truing.diagnosis.result import Diagnosis
    from truing.kernel import Offer
    from truing.setup import Setup

INPUTS = 'plugin = "rv_gearing"\n[inputs]\nsun_teeth = 20\nplanet_teeth = 55\n'
WRITTEN = {
    "time": "h", "load_torque": "N*m", "input_speed": "rpm", "oil_temperature": "degC", "input_angle": "deg",
}  # fmt: skip


@dataclass(frozen=True)
class Answer:
    """What was said to a case: the document, what the extended model predicts for rows held out, and the time taken."""

    document: dict[str, Any]
    predicted: dict[str, Array]
    seconds: float


def table(rows: Rows, readings: Mapping[str, Array]) -> str:
    """The rows as CSV with units in the header, every digit kept."""
    columns = {f"{name} [{unit}]": getattr(rows, name) for name, unit in WRITTEN.items()}
    columns |= {f"{name} [{UNIT[name]}]": values for name, values in readings.items()}
    lines = [",".join(columns)]
    lines += [",".join(repr(float(cell)) for cell in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join(lines) + "\n"


@cache
def gearing_offer() -> Offer:
    """The gearing as installed."""
    from truing.kernel import Kernel

    return Kernel.installed().offer("rv_gearing")


def diagnosed(case: Case) -> Answer:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    from time import perf_counter

    from truing.diagnosis.engine import diagnose
    from truing.diagnosis.reading import read_records
    from truing.inputs_file import read_setup
    from truing.runs.diagnosis_document import diagnosis_document

    offer = gearing_offer()
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
        (folder / "measured.csv").write_text(table(case.rows, case.readings), encoding="utf-8")
        (folder / "held_out.csv").write_text(table(case.held, case.held_readings), encoding="utf-8")
        setup = read_setup(folder / "inputs.toml", offer)
        start = perf_counter()
        diagnosis = diagnose(setup, read_records([folder / "measured.csv"], offer, setup))
        seconds = perf_counter() - start
        document = json.loads(json.dumps(diagnosis_document(diagnosis)))
        return Answer(document, _predicted(case, diagnosis, setup, folder / "held_out.csv"), seconds)


def _predicted(case: Case, diagnosis: Diagnosis, setup: Setup, file: Path) -> dict[str, Array]:
    """Predict the rows held out, in the units of the file."""
    from dataclasses import replace

    from truing.diagnosis.reading import read_records
    from truing.gauge import one_machine, read_by_gauge
    from truing.units import from_si

    calibrated = {item.name: item.value for item in diagnosis.calibrated}
    machine = diagnosis.extended or replace(setup, calibrated={**setup.calibrated, **calibrated})
    records = read_records([file], gearing_offer(), setup)
    found = read_by_gauge(one_machine(machine), records.rows, case.wish.results).results
    return {name: np.asarray(from_si(found[name], UNIT[name])) for name in case.wish.results}
