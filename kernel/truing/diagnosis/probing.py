"""What the model is like to call, before the search: how long a call takes, and how rough its answers are.

A model whose answers come in steps, or scatter by themselves, has no derivatives by small differences.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.budget import budget_of
from truing.diagnosis.competition import Competition
from truing.diagnosis.extended import Extended, Point
from truing.repeated import forget

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from truing.diagnosis.causes import Cause

    Matrix = NDArray[np.float64]

ASIDE = 1.23456789
"""Standard deviations, or tenths of a range, by which something is moved to see what the model is like there.

It is no round number, so that answers are multiples of a step only where the model makes them so.
"""
FINE, COARSE = 1e-9, 1e-6
"""Shares of the largest answer: what lies nearer to a multiple is one, and no step is smaller."""
FEWEST = 6
"""So many answers that differ must be multiples of one step."""


def probe(made: Competition) -> None:
    """Give a search its budget of calls, and say how rough the model is.

    Where nothing that competes moves the model itself it is called for nothing more: it needs neither.
    """
    extended, machine = made.extended, made.extended.machine
    costly = [cause for cause in made.causes if extended.costs(cause)]
    tried: list[Cause] = [] if machine.inputs else costly[:1]
    if not machine.inputs and not costly:
        return
    values = [np.array([_near_low(each.low, each.high) for each in cause.numbers]) for cause in tried]
    point = values, np.full(len(machine.inputs), ASIDE)
    extended.budget = budget_of(machine.start.diagnose.budget, len(costly), lambda: extended.at(tried, [point]))
    extended.most_points = extended.budget.points(len(costly))
    extended.grain = _grain_of(extended, tried, point)


def _near_low(low: float, high: float) -> float:
    return low + 0.1 * ASIDE * (high - low)


def _grain_of(extended: Extended, causes: list[Cause], point: Point) -> dict[str, float]:
    """Return by result how much its answers jump or scatter, SI; results that do neither are left out."""
    (first,) = extended.at(causes, [point])
    forget()
    (again,) = Extended(extended.machine).at(causes, [point])
    made = {}
    for name, shown in first.items():
        known = np.isfinite(shown) & np.isfinite(again[name])
        scatter = float(np.abs(shown - again[name])[known].max(initial=0.0))
        base = extended.machine.base[name]
        step = 0.0 if np.array_equal(shown, base, equal_nan=True) else step_of(shown[known])
        if scatter > 0 or (step > 0 and abs(step_of(base[np.isfinite(base)]) / step - 1) < COARSE):
            made[name] = max(scatter, step)
    return made


def step_of(values: Matrix) -> float:
    """Return the step of which all values are multiples, by Euclid's algorithm; 0 where there is none."""
    distinct = np.unique(np.abs(values[values != 0]))
    if len(distinct) < FEWEST:
        return 0.0
    step, least = float(distinct[0]), FINE * float(distinct[-1])
    for value in distinct.tolist():
        while (rest := abs(value - step * round(value / step))) > least:
            value, step = step, rest
    return step if step > COARSE * float(distinct[-1]) else 0.0
