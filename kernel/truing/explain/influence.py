"""How strongly a source moves a result: its share of the scatter, and what one per cent of it does."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from truing.errors import TruingError
from truing.setup import Setup
from truing.studies.bench import Progress, silent
from truing.studies.differences import exact_slopes, nominal_of, slopes
from truing.studies.scatter import Scatter, scatter_of
from truing.units import difference_unit, unit_factor
from truing.units.names import LEVELS

PATIENCE = 20.0
"""So many seconds derivatives may take; what is not reached then is said."""
NOTHING = 1e-10
"""A source that moves a result by less than this share of it, when it changes by its own size, does not move it."""


@dataclass(frozen=True)
class Influence:
    """What one source does to one result; along an axis every number is a root mean square.

    ``step`` is the change of the result (SI) as the source grows by one per cent (a level of temperature by one kelvin;
    None for a source that is 0), ``relative`` the same as a share of the result (None where that is 0), ``share`` the
    part of the first-order variance of the result that is due to the scatter of the source.
    """

    source: str
    step: float | None
    relative: float | None
    share: float
    moves: bool


@dataclass(frozen=True)
class Influences:
    """What moves each result: by result, with the standard deviation (SI) of all that scatters, and what to know."""

    of: Mapping[str, tuple[Influence, ...]]
    sd: Mapping[str, float]
    warnings: tuple[str, ...]


def differentiable(setup: Setup) -> list[str]:
    """Return the inputs and conditions that a result can be differentiated by: numbers that are given."""
    numbers = [name for name, item in setup.model.input_fields.items() if item.kind == "float"]
    return [name for name in (*numbers, *setup.conditions) if (value := nominal_of(setup, name)) == value]


def influences(
    setup: Setup, answers: Mapping[str, Any], sources: Sequence[str], *, progress: Progress = silent
) -> Influences:
    """Differentiate results of the function (by name, with their values) by sources and by all that scatters."""
    scatter = scatter_of(setup)
    columns = tuple(dict.fromkeys([*scatter.columns, *sources]))
    slopes_of, remarks = _slopes(setup, tuple(answers), columns, scatter=scatter, progress=progress)
    exact = exact_slopes(setup)
    of: dict[str, tuple[Influence, ...]] = {}
    sd: dict[str, float] = {}
    for result, answer in answers.items():
        by_source = {**slopes_of[result], **{key: v for key, v in exact.get(result, {}).items() if key in columns}}
        variance = {name: _mean(value) for name, value in scatter.variances(by_source).items()}
        whole = sum(variance.values())
        size = _size(answer)
        sd[result] = max(whole, 0.0) ** 0.5
        share = {name: part / whole if whole > 0 else 0.0 for name, part in variance.items()}
        of[result] = tuple(
            _influence(setup, scatter, name, by_source[name], size=size, share=share.get(name, 0.0)) for name in columns
        )
    return Influences(of, sd, tuple(remarks))


def _slopes(
    setup: Setup, results: Sequence[str], columns: Sequence[str], *, scatter: Scatter, progress: Progress
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Differentiate by one column after the other, as long as there is patience; NaN stands for what was not found."""
    of: dict[str, dict[str, Any]] = {result: dict.fromkeys(columns, math.nan) for result in results}
    remarks: list[str] = []
    ends = time.monotonic() + PATIENCE
    for index, column in enumerate(columns):
        progress("differentiating", index, len(columns))
        if time.monotonic() > ends:
            left = ", ".join(columns[index:])
            remarks.append(f"one calculation takes so long that these were not differentiated by: {left}")
            break
        try:
            found = slopes(setup, results, [column], scatter)
        except TruingError as error:
            remarks.append(f"no derivative by '{column}': {error}")
            continue
        remarks += found.warnings
        for result in results:
            of[result][column] = found.of[result][column]
    return of, remarks


def _influence(setup: Setup, scatter: Scatter, name: str, slope: Any, *, size: float, share: float) -> Influence:
    value = nominal_of(setup, name)
    is_level = name in _levels(setup)
    steepness = _size(slope) * (-1.0 if getattr(slope, "ndim", 0) == 0 and slope < 0 else 1.0)
    own = 1.0 if is_level else 0.01 * abs(value)
    step = steepness * own if own and steepness == steepness else None
    relative = step / size if step is not None and size else None
    widest = max(abs(value), scatter.sd_of(name), 0.0 if value else unit_factor(_unit(setup, name)))
    moves = steepness == steepness and abs(steepness) * widest > NOTHING * size
    return Influence(name, step, relative, share, moves)


def _unit(setup: Setup, name: str) -> str:
    known = name in setup.model.input_fields or name in setup.model.known_conditions
    return difference_unit(setup.unit_of(name)) if known else ""


def _levels(setup: Setup) -> set[str]:
    return {name for name in (*setup.model.input_fields, *setup.conditions) if setup.unit_of(name) in LEVELS}


def _size(value: Any) -> float:
    """Return the size of a number, or the root mean square of an array, NaN where any part is none."""
    return math.sqrt(_mean(value * value))


def _mean(value: Any) -> float:
    if not getattr(value, "ndim", 0):
        return float(value)
    return float(value.mean()) if value.size else math.nan


def by_share(found: Sequence[Influence]) -> list[Influence]:
    """Return what scatters, the largest share of the scatter first."""
    return sorted((one for one in found if one.share), key=lambda one: -abs(one.share))


def by_slope(found: Sequence[Influence]) -> list[Influence]:
    """Return what moves the result, the steepest first."""
    return sorted((one for one in found if one.moves and one.step), key=lambda one: -abs(one.step or 0.0))
