"""What the model is like to call, before the search: how long a call takes, and how rough its answers are.

The number of calls that a search may make is stated with ``[studies.diagnose] budget``. Where it is not, a model that
answers at once has none, and a slow one gets what takes some minutes: the time of one call to a power of ten, so that
two machines mostly agree. A model whose answers come in steps, or scatter by themselves, has no derivatives by small
differences.
"""

from __future__ import annotations

from collections.abc import Callable
from math import log10
from time import perf_counter

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate
from truing.diagnosis.competition import Competition
from truing.diagnosis.extended import LEAST_PER_EFFECT, CallBudget, Extended, Point
from truing.repeated import forget

QUICK_CALL = 0.03
"""Seconds of a call below which a search needs no budget: it makes a few thousand calls."""
MINUTES = 300.0
"""Seconds that the calls of a search may take where no budget is stated."""
CURVES = 0.25
"""Share of the calls in which all curves are to be made."""
FEWEST_POINTS = 6
"""At so many points at least an effect is looked at: fewer say nothing about how it bends."""
PROBE = 1.23456789
"""Standard deviations, or tenths of a range, by which something is moved to see what the model is like there.

It is no round number, so that answers are multiples of a step only where the model makes them so.
"""
FINE, COARSE = 1e-9, 1e-6
"""Shares of the largest answer: what lies nearer to a multiple is one, and no step is smaller."""
FEWEST_DISTINCT = 6
"""So many answers that differ must be multiples of one step."""
ROUNDING = 1e-12
"""Share of the largest answer by which two calls may differ: how libraries round depends on where an array lies."""


def probe(competition: Competition) -> None:
    """Give a search its budget of calls, and say how rough the model is.

    Where nothing that competes moves the model itself it is called for nothing more: it needs neither.
    """
    extended, machine = competition.extended, competition.extended.machine
    costly = [cause for cause in competition.causes if extended.costs(cause)]
    tried: list[Candidate] = [] if machine.inputs else costly[:1]
    if not machine.inputs and not costly:
        return
    values = [
        np.array([number.low + 0.1 * PROBE * (number.high - number.low) for number in cause.numbers]) for cause in tried
    ]
    point = values, np.full(len(machine.inputs), PROBE)
    extended.budget = budget_of(machine.start.diagnose.budget, len(costly), lambda: extended.at(tried, [point]))
    if extended.budget.is_dear:
        extended.budget.points = max(FEWEST_POINTS, int(CURVES * extended.budget.calls / max(len(costly), 1)))
    extended.grain = _grain_of(extended, tried, point)


def budget_of(stated: int, effects: int, call: Callable[[], object]) -> CallBudget:
    """Return the stated budget; else, by how long one ``call`` takes, none or one of some minutes."""
    if stated:
        return CallBudget(stated)
    begin = perf_counter()
    call()
    seconds = perf_counter() - begin
    if seconds < QUICK_CALL:
        return CallBudget()
    takes = 10.0 ** round(log10(seconds))
    return CallBudget(max(round(MINUTES / takes), LEAST_PER_EFFECT * max(effects, 1)), takes)


def _grain_of(extended: Extended, causes: list[Candidate], point: Point) -> dict[str, float]:
    """Return by result how much its answers jump or scatter, SI; results that do neither are left out."""
    (first,) = extended.at(causes, [point])
    forget()
    (again,) = Extended(extended.machine).at(causes, [point])
    made = {}
    for name, shown in first.items():
        known = np.isfinite(shown) & np.isfinite(again[name])
        scatter = float(np.abs(shown - again[name])[known].max(initial=0.0))
        scatter = scatter if scatter > ROUNDING * float(np.abs(shown)[known].max(initial=0.0)) else 0.0
        base = extended.machine.base[name]
        step = 0.0 if np.array_equal(shown, base, equal_nan=True) else step_of(shown[known])
        if scatter > 0 or (step > 0 and abs(step_of(base[np.isfinite(base)]) / step - 1) < COARSE):
            made[name] = max(scatter, step)
    return made


def step_of(values: Matrix) -> float:
    """Return the step of which all values are multiples, by Euclid's algorithm; 0 where there is none."""
    distinct = np.unique(np.abs(values[values != 0]))
    if len(distinct) < FEWEST_DISTINCT:
        return 0.0
    step, least = float(distinct[0]), FINE * float(distinct[-1])
    for value in distinct.tolist():
        while (rest := abs(value - step * round(value / step))) > least:
            value, step = step, rest
    return step if step > COARSE * float(distinct[-1]) else 0.0
