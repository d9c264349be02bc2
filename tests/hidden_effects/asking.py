"""A press with something wrong as files, and what the kit says to it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import pi
from pathlib import Path

from hidden_effects.candidates import HOUR
from hidden_effects.cases import Case
from hidden_effects.press_machine import POSITION, TILT, Array, Rows
from hidden_effects.rigs import model_of
from truing import Kernel
from truing.kernel import Offer
from truing.testing import recorded
from truing.testing.hiding import Answered, csv_of

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
    return csv_of(columns)


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


def diagnosed(case: Case) -> Answered:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    measured, held = tables(case)
    return recorded(model_of("press_linkage"), inputs=INPUTS, measured=measured, held_out=held).answered
