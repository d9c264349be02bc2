"""A press with something wrong as files, and what the kit says to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from hidden_effects.candidates import HOUR
from hidden_effects.cases import Case
from hidden_effects.press_machine import POSITION, TILT, Array, Rows
from truing import Kernel
from truing.kernel import Offer
from truing.testing import recorded

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


def tables(case: Case) -> tuple[str, str]:
    """The record, and a second one to judge with."""
    measured = table(case.record.rows, case.readings, case.counters)
    return measured, table(case.held, case.held_readings, case.counters)


def write_case(case: Case, folder: Path) -> None:
    """Write what a user would have: inputs, the record, and a second one to judge with."""
    names = ("inputs.toml", "measured.csv", "held_out.csv")
    for name, text in zip(names, (INPUTS, *tables(case)), strict=True):
        (folder / name).write_text(text, encoding="utf-8")


@cache
def press_offer() -> Offer:
    """The press linkage as installed."""
    return Kernel.installed().offer("press_linkage")


@dataclass(frozen=True)
class Answer:
    """What was said to a case: the document, and what the model then predicts for rows that were held out.

    ``predicted`` is what the calibrated machine shows with every cause and shape that was found, in SI, one result
    after another, without the first row (that of the record).
    """

    document: Mapping[str, Any]
    predicted: Array
    seconds: float


def diagnosed(case: Case) -> Answer:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    measured, held = tables(case)
    said = recorded(press_offer().model, inputs=INPUTS, measured=measured, held_out=held).answered
    predicted = np.concatenate([said.predicted[result][1:] for result in case.results])
    return Answer(said.document, predicted, said.seconds)
