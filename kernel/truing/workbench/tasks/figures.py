"""Figures while one edits: that of page one, and curves along an input with their limits."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from truing.api.study import MOST_CURVES
from truing.calculation import Calculation
from truing.errors import UsageError
from truing.executors import open_executor
from truing.numbers import format_number, with_unit
from truing.report.figures import draw
from truing.report.live import live_figure
from truing.report.page_one import key_results
from truing.report.sheet_units import outcome_as_printed
from truing.studies.bench import Bench
from truing.studies.checks import requirements
from truing.studies.sweep import Sweep, Swept, curves
from truing.units import unit_text
from truing.workbench.tasks.results import nominal

POINTS, FEWEST = 61, 11
"""So many points a curve has, and so few where the model is slow."""
PATIENCE = 2.0
"""Seconds that the points of a curve may take, as far as one calculation tells."""


def first(plugin: str, file: str, folder: str, text: str) -> dict[str, str]:
    """Return the figure of page one as SVG with its words, or nothing where the model has none."""
    view = live_figure(nominal(plugin, file, folder, text))
    return {"svg": "", "caption": ""} if view is None else {"svg": view.svg, "caption": view.caption}


def sweep(plugin: str, file: str, folder: str, text: str, *, over: str, low: str, high: str) -> dict[str, Any]:
    """Return curves along an input between two ends (texts with units) as SVG, where limits are met, and what fails.

    Raises UsageError for a range that is none, and where nothing changes along it.
    """
    started = time.perf_counter()
    calculation = nominal(plugin, file, folder, text)
    points = int(np.clip(PATIENCE / (time.perf_counter() - started), FEWEST, POINTS))
    asked = Sweep(over=over, at=f"{low.strip()}..{high.strip()}", points=points, results=_wanted(calculation))
    swept, moving = _along(calculation, asked)
    if not moving:
        swept, moving = _along(calculation, replace(asked, results=()))
    if not moving:
        raise UsageError(f"no result changes along '{over}' between {low} and {high}")
    svg = draw(curves(swept, moving[:MOST_CURVES]), title=f"Along {over.replace('_', ' ')}", ident="s")
    return {"svg": svg, "said": [*_met(swept), *swept.gaps()]}


def _along(calculation: Calculation, asked: Sweep) -> tuple[Swept, list[str]]:
    """Return results along an input, as they are printed, and those of them that change."""
    with open_executor("serial") as executor:
        bench = Bench(calculation.setup, calculation.results, executor, calculation.answers, absent=calculation.absent)
        swept = outcome_as_printed(asked.run(bench), calculation.setup)
    return swept, [name for name in swept.moving() if np.nanmin(swept.results[name]) != np.nanmax(swept.results[name])]


def _wanted(calculation: Calculation) -> tuple[str, ...]:
    """Return what is drawn: results with a limit, and key results; nothing means every result that changes."""
    fields = calculation.setup.model.own_result_fields
    named = [*(require.result for require in requirements(calculation.setup)), *key_results(calculation)]
    return tuple(name for name in dict.fromkeys(named) if name in fields and not fields[name].along)


def _met(swept: Swept) -> list[str]:
    """Say in a sentence each where limits are kept along the input."""
    unit = unit_text(swept.units[swept.over])
    return [
        f"{str(result).replace('_', ' ')} {limit}: "
        + (f"kept {kept}" if not isinstance(at, float) else f"met at {with_unit(format_number(at), unit)}, kept {kept}")
        for result, limit, at, kept in swept.limit_table().rows
    ]
