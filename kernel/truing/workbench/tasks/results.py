"""What the text of an inputs file gives, without studies: numbers, the inputs that matter most, the whole sheet."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from truing.arrays import one_thread
from truing.calculation import Calculation, calculate
from truing.declare.fields import InputField
from truing.declare.goals import Vary
from truing.errors import UnknownPluginError
from truing.evaluate import evaluate_rows
from truing.inputs_file import setup_from_text
from truing.inputs_file.sentences import told_by_line
from truing.inputs_file.values import broken_demand
from truing.numbers import format_number
from truing.report.html_printer import html_of
from truing.report.live import live_sheet
from truing.report.page_one import key_results
from truing.report.run import sheet_of
from truing.runs.folder import load_either
from truing.runs.inputs_written import input_hash
from truing.setup import Setup
from truing.studies.checks import is_known, limit_amount, requirements
from truing.studies.reading import read_range
from truing.studies.sampling import Scatter, scatter_of
from truing.studies.sweep import Sweep
from truing.units import from_si, unit_factor, unit_text
from truing.workbench.tasks.loaded import changed_since, loaded

MOST_SLIDERS = 6
PLACES = 200
"""So many places a slider has."""
AROUND = 0.25
"""A slider reaches so far to both sides, as a share of its value, where neither bounds nor a variation are declared."""
FEWEST_WHOLE = 3
"""A whole number is dragged by so much to both sides at the least."""
LEAST = 1e-3
"""An input that moves no result by more than such a part of what the strongest does has no slider by itself."""
NEARER = 10
"""So often the end of a slider that breaks a bound is brought half the way to where the input stands."""
SHARE = 0.01
"""An input without a tolerance is moved by so much of its value to see how much it matters."""


def nominal(plugin: str, file: str, folder: str, text: str) -> Calculation:
    """Calculate a text without its studies. Raises InputError with every fault, or with what is impossible."""
    return _without_studies(setup_from_text(text, loaded(plugin), file=file, folder=Path(folder)))


def _without_studies(setup: Setup) -> Calculation:
    with told_by_line(setup):
        return calculate(replace(setup, studies=()))


def numbers(
    plugin: str, file: str, folder: str, text: str, *, run: str = "", called: str = "", last: str = ""
) -> dict[str, Any]:  # fmt: skip
    """Return the live sheet of a text; beside a run, in the folder ``run`` and called ``called``, where one is.

    Limits that only studies decide are as the run in the folder ``last`` has decided them, where that is of this text.
    """
    setup = setup_from_text(text, loaded(plugin), file=file, folder=Path(folder))
    calculation = _without_studies(setup)
    saved = load_either(Path(run)) if run else None
    own = run_of(setup, plugin, Path(last)) if last and calculation.verdict == "undecided" else None
    return asdict(live_sheet(calculation, saved, called, own))


def run_of(setup: Setup, plugin: str, folder: Path) -> dict[str, Any] | None:
    """Return what a run folder holds, where it is of these inputs and of the calculation as it is now."""
    try:
        document = load_either(folder)
    except UnknownPluginError:
        return None
    is_same = document.get("input_hash") == input_hash(setup) and not changed_since(plugin, folder, document)
    return document if is_same else None


def whole(plugin: str, file: str, folder: str, text: str) -> dict[str, str]:
    """Return the whole sheet of a text as a page."""
    calculation = nominal(plugin, file, folder, text)
    return {"html": html_of(sheet_of(calculation, loaded(plugin), started=time.time()))}


# Sliders: the inputs that matter most


@dataclass(frozen=True)
class Slider:
    """An input to be dragged: where it stands, and from where to where, in ``unit``, as it is stated.

    ``printed`` is the unit as people read it; ``why`` says how much the input moves, where that was looked at.
    """

    name: str
    note: str
    unit: str
    printed: str
    value: float
    low: float
    high: float
    step: float
    why: str = ""


def sliders(plugin: str, file: str, folder: str, text: str, *, ranked: bool = True) -> dict[str, Any]:
    """Return every input that can be dragged, and the names of those that matter most, the strongest first.

    To find these an input is moved to both sides by its standard deviation where it scatters, else by 1 % of the range
    in which the model varies or sweeps it, else of its value. What counts is the largest change of any limit or key
    result, as a share of the limit, or of the result.
    """
    setup = setup_from_text(text, loaded(plugin), file=file, folder=Path(folder))
    scatter = scatter_of(setup)
    known = {name: slider for name in setup.model.input_fields if (slider := _slider(setup, scatter, name)) is not None}
    if not ranked:
        return {"inputs": [asdict(slider) for slider in known.values()], "most": []}
    steps = {name: step for name in known if (step := _step(setup, scatter, name)) > 0}
    effects = _effects(setup, steps, _targets(nominal(plugin, file, folder, text)))
    least = LEAST * max((share for share, _ in effects.values()), default=0.0)
    order = sorted((name for name, (share, _) in effects.items() if share > least), key=lambda name: -effects[name][0])
    for name, (share, result) in effects.items():
        part = "it" if _declared_range(setup, setup.model.input_fields[name]) is None else "its range"
        by = "its scatter" if scatter.sd_of(name) else f"1 % of {part}"
        why = f"{by} moves {result.replace('_', ' ')} by {format_number(100 * share, 2)} %"
        known[name] = replace(known[name], why=why)
    return {"inputs": [asdict(slider) for slider in known.values()], "most": order[:MOST_SLIDERS]}


def _step(setup: Setup, scatter: Scatter, name: str) -> float:
    """Return by how much an input is moved; 0 for a whole number, and for 0 that does not scatter."""
    if setup.model.input_fields[name].kind != "float":
        return 0.0
    declared = _declared_range(setup, setup.model.input_fields[name])
    size = abs(float(setup.nominal(name))) if declared is None else declared[1] - declared[0]
    return scatter.sd_of(name) or SHARE * size


def _targets(calculation: Calculation) -> dict[str, float]:
    """Return the results that are looked at, each with the size (SI) that a change of it is compared with."""
    setup, answers, sizes = calculation.setup, calculation.answers, {}
    requires = requirements(setup)
    limits = {require.result: abs(float(limit_amount(require, setup, answers))) for require in requires
              if require.kind != "within" and not require.is_flag and is_known(require, setup, answers)
              and np.ndim(limit_amount(require, setup, answers)) == 0}  # fmt: skip
    for name in dict.fromkeys([*(require.result for require in requires), *key_results(calculation)]):
        field, value = setup.model.own_result_fields.get(name), answers.get(name)
        if field is not None and not field.along and value is not None and np.ndim(value) == 0 and isfinite(value):
            sizes[name] = limits.get(name) or abs(float(value)) or 1.0
    return sizes


@one_thread()
def _effects(setup: Setup, steps: Mapping[str, float], targets: Mapping[str, float]) -> dict[str, tuple[float, str]]:
    """Return by input the largest relative change of any target, and of which: central differences, in one batch."""
    names, rows = [*steps], 2 * len(steps)
    columns = {}
    for index, name in enumerate(names):
        values = np.full(rows, float(setup.nominal(name)))
        values[2 * index] += steps[name]
        values[2 * index + 1] -= steps[name]
        columns[name] = values
    answer = evaluate_rows(setup, columns, rows, wanted=[*targets]).results if names and targets else {}
    effects: dict[str, tuple[float, str]] = {}
    for index, name in enumerate(names):
        changes = {
            target: abs(float(answer[target][2 * index] - answer[target][2 * index + 1])) / 2 / size
            for target, size in targets.items()
            if answer
        }
        known = {target: change for target, change in changes.items() if isfinite(change)}
        if known:
            target = max(known, key=lambda each: known[each])
            effects[name] = known[target], target
    return effects


def _slider(setup: Setup, scatter: Scatter, name: str) -> Slider | None:
    """Make the slider of an input; None for one that is no number, or cannot be moved."""
    field, unit = setup.model.input_fields[name], setup.stated_unit(name)
    if field.kind not in {"float", "whole", "integer"} or not isfinite(value := float(setup.nominal(name))):
        return None
    low, high = (float(from_si(end, unit)) for end in _reach(setup, scatter, field, value))
    if not high > low:
        return None
    step = 10.0 ** np.floor(np.log10((high - low) / PLACES)) if field.kind == "float" else 1.0
    low, high, step = (float(f"{each:.12g}") for each in (round(low / step) * step, round(high / step) * step, step))
    return Slider(
        name=name, note=field.spec.note or name.replace("_", " "), unit=unit, printed=unit_text(unit) if unit else "",
        value=float(f"{float(from_si(value, unit)):.12g}"), low=low, high=high, step=step,
    )  # fmt: skip


def _reach(setup: Setup, scatter: Scatter, field: InputField, value: float) -> tuple[float, float]:
    """Return between which ends (SI) an input is dragged: as the model varies or sweeps it, else about its value."""
    if (declared := _declared_range(setup, field)) is not None:
        return min(declared[0], value), max(declared[1], value)
    around = AROUND * abs(value) or 6 * scatter.sd_of(field.name) or unit_factor(field.unit)
    if field.kind != "float":
        around = max(round(around), FEWEST_WHOLE)
    return _kept(field, value, value - around), _kept(field, value, value + around)


def _declared_range(setup: Setup, field: InputField) -> tuple[float, float] | None:
    """Return between which ends (SI) the model itself varies or sweeps an input; None where it does neither."""
    ranges = [f"{each.low}..{each.high}" for each in setup.model.objectives
              if isinstance(each, Vary) and each.input == field.name and each.low]  # fmt: skip
    studies = (each for each in setup.model.studies if isinstance(each, Sweep) and each.over == field.name)
    ranges += [each.at for each in studies if each.at]
    if not ranges:
        return None
    points = read_range(ranges[0], field.unit, 2)
    return float(points.min()), float(points.max())


def _kept(field: InputField, value: float, end: float) -> float:
    """Bring an end nearer until it keeps the declared bounds."""
    for _ in range(NEARER):
        if not broken_demand(field, end):
            return end
        end = (end + value) / 2 if field.kind == "float" else float(round((end + value) / 2))
    return value
