"""Further results, and facts from elsewhere, that tell explanations apart where no setting does.

Two causes may draw one curve on everything measured and still differ in a result that nobody measured. What the rivals
say of it at the rows there are, each as it is fitted, is held against what machines within their tolerances differ in
it: no gauge is known for it, so this is the only noise.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import log, sqrt
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.fields import Axis
from truing.declare.goals import Maximise, Minimise, Require
from truing.diagnosis.extended import switched_on
from truing.diagnosis.findings import in_unit
from truing.diagnosis.fitted import Fit, input_value
from truing.diagnosis.machine import Calibration, Predicted, calibration_of, predict
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import APART, Amount, Fact, NextPoint, Tie, readable_unit
from truing.diagnosis.sentences import say
from truing.experiments.duels import name_of
from truing.units import read_quantity
from truing.units.names import PURE

ROWS = 40
"""So many rows of the record are asked what the rivals differ in."""
CLEAR = sqrt(APART)
"""Beyond this many standard deviations of machines within their tolerances a difference tells explanations apart."""
NEARLY = 0.95
"""Of several rows that tell as clearly the one is told in which the difference is largest."""
LEAST_SHARE = 1e-3
"""Of the result itself: no gauge is trusted with less."""


@dataclass(frozen=True)
class _Gap:
    """What two explanations differ in a result that was not measured: where it is clearest, by one value, SI."""

    result: str
    names: tuple[str, str]
    size: float
    scatter: float
    clearness: float
    """The difference over the scatter of machines; a result that does not scatter is as clear as can be."""


def joined_pairs(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Join pairs that share an explanation to groups."""
    groups: list[tuple[str, ...]] = []
    for pair in pairs:
        own = [group for group in groups if set(group) & set(pair)]
        groups = [group for group in groups if group not in own]
        groups.append(tuple(dict.fromkeys(name for group in (*own, pair) for name in group)))
    return groups


def tie_of(names: Sequence[str], explanations: Sequence[Fit]) -> Tie:
    """Return explanations that cannot be told apart, with what would have to be so for each of them alone."""
    tied = [each for each in explanations if name_of(each) in names]
    facts = [fact for each in tied for fact in _facts(each)]
    stated = Counter(fact.quantity for fact in facts)
    return Tie(tuple(names), tuple(fact for fact in facts if len(tied) < 2 or stated[fact.quantity] < len(tied)))


def _facts(fit: Fit) -> Iterator[Fact]:
    """Give the quantities that an explanation states: unknowns that are not zero, and inputs outside of their band."""
    start = fit.sample.machine.start
    for on in switched_on(fit.causes, fit.values, fit.sample.machine):
        for unknown in on.effect.unknowns:
            if value := on.values.get(unknown.name, 0.0):
                quantity = f"{on.effect.name}.{unknown.name}"
                yield Fact(name_of(fit), quantity, Amount(float(value), unknown.unit), unknown.note)
    for name, value in _shifted(fit).items():
        declared, known = start.model.input_fields.get(name), start.model.known_conditions
        note = known[name].note if declared is None else declared.spec.note
        yield Fact(name_of(fit), f"input:{name}", Amount(value, start.unit_of(name)), note)


def _shifted(fit: Fit) -> dict[str, float]:
    """Return the inputs that an explanation has outside of their band, SI; of files the first one's."""
    made: dict[str, float] = {}
    for cause in fit.causes:
        if cause.tolerated >= 0:
            made.setdefault(fit.sample.machine.inputs[cause.tolerated].name, input_value(fit, cause.tolerated))
    return made


def result_to_measure(
    machine: Calibration, explanations: Sequence[Fit]
) -> tuple[NextPoint | None, set[frozenset[str]]]:
    """Return the result that separates most explanations from the first one, and the pairs that it tells apart.

    None where no result tells any two apart. A result with a unit or a goal comes before a pure number, for which there
    is no gauge; then the one that parts most explanations from the first, the one that a goal names, the one that
    separates most pairs, the clearest.
    """
    start, measured = machine.start, machine.records.measured
    fields = start.model.own_result_fields
    alone = [name for name, field in fields.items() if not field.along and not isinstance(field.spec, Axis)]
    names = [name for name in alone if name not in measured]
    if not names or machine.records.rows.series or len(explanations) < 2:
        return None, set()
    few = machine.records.part(np.arange(0, len(machine.records), max(1, len(machine.records) // ROWS)))
    there = calibration_of(start, replace(few, measured={name: np.zeros(len(few)) for name in names}, sigma={}))
    predictions: list[tuple[str, Predicted]] = []
    for explanation in explanations:
        setup = start.with_effects(switched_on(explanation.causes, explanation.values, machine)).changed(
            _shifted(explanation)
        )
        predictions.append((name_of(explanation), predict(setup, there.records)))
    goals = {goal.result for goal in start.model.objectives if isinstance(goal, (Require, Minimise, Maximise))}
    ranked: list[tuple[tuple[Any, ...], list[_Gap]]] = []
    for index, name in enumerate(names):
        pairs = (
            _gap(there, name, (a, b), one[name] - other[name]) for (a, one), (b, other) in combinations(predictions, 2)
        )
        gaps = lowest_first((gap for gap in pairs if gap is not None), lambda gap: log(gap.clearness))
        if gaps:
            parted = sum(predictions[0][0] in gap.names for gap in gaps)
            is_goal, clearness = name in goals, float(f"{gaps[0].clearness:.2g}")
            has_gauge = is_goal or fields[name].unit not in PURE
            ranked.append(((has_gauge, parted, is_goal, len(gaps), clearness, -index), gaps))
    if not ranked:
        return None, set()
    _, gaps = max(ranked, key=lambda each: each[0])
    return _point(start, gaps[0]), {frozenset(gap.names) for gap in gaps}


def _gap(there: Calibration, name: str, names: tuple[str, str], apart: Matrix) -> _Gap | None:
    """Return where two explanations are clearest apart in a result; None where they hardly are."""
    apart = np.abs(apart)
    slopes = there.slopes[name] if there.together is None else there.slopes[name] @ there.together
    scatter = np.sqrt(np.sum(slopes**2, axis=1))
    largest, model = float(np.nanmax(np.abs(there.base[name]), initial=0.0)), there.start.model
    jumps = [getattr(field.spec, "halving_but", {}).get(name) for field in model.input_fields.values()]
    resolutions = [read_quantity(most, model.own_result_fields[name].unit) for most in jumps if most]
    least = max(LEAST_SHARE * largest, *resolutions, 0.0)  # a numerical step alone moves a result that jumps
    seen = np.isfinite(apart + there.base[name]) & (apart > least) & (apart > CLEAR * scatter)
    if not seen.any():
        return None
    worth = np.where(seen, apart, 0.0) / np.maximum(scatter, np.where(seen, 1e-6 * apart, 1e-300))
    index = int(np.argmax(np.where(worth > NEARLY * worth.max(), apart, -1.0)))
    size, alone = float(apart[index]), float(scatter[index])
    return _Gap(name, names, size, alone, size / alone if alone > 0 else 1e6)


def _point(start: Any, gap: _Gap) -> NextPoint:
    unit = readable_unit(start.print_unit(gap.result), gap.size)
    (one, other), size = gap.names, in_unit(gap.size, unit)
    words = say("differ in", result=gap.result, one=one, other=other, size=size)
    if gap.scatter > 0:
        scatter = in_unit(gap.scatter, unit)
        words = say("differ more than machines", result=gap.result, one=one, other=other, size=size, scatter=scatter)
    return NextPoint({}, gap.names, words, gap.clearness**2, (gap.result,))
