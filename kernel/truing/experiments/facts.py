"""Further results, and measurements of other quantities, that tell explanations apart where no setting does.

Two causes may draw one curve on everything measured and still differ in a result that nobody measured. What the rivals
say of it at the rows there are, each as it is fitted, is held against what machines within their tolerances differ in
it: no gauge is known for it, so this is the only noise.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import hypot, log, sqrt
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.fields import Axis
from truing.declare.goals import Maximise, Minimise, Require
from truing.diagnosis.causes import INPUT
from truing.diagnosis.competition import Competition
from truing.diagnosis.extended import switched_on
from truing.diagnosis.findings import in_unit
from truing.diagnosis.fitted import Fit, input_value
from truing.diagnosis.intervals import certainty_of, places_of
from truing.diagnosis.machine import Calibration, Predicted, calibration_of, predict
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import APART, Amount, Fact, NextPoint, Tie, readable_unit
from truing.diagnosis.sentences import say
from truing.experiments.duels import name_of
from truing.units import difference_unit, read_quantity
from truing.units.names import PURE

ROWS = 40
"""So many rows of the record are asked what the rivals differ in."""
CLEAR = sqrt(APART)
"""Beyond this many standard deviations of machines within their tolerances a difference tells explanations apart."""
NEARLY = 0.95
"""Of several rows that tell as clearly the one is told in which the difference is largest."""
LEAST_SHARE = 1e-3
"""Of the result itself: no gauge is trusted with less."""
FINEST = 0.05
"""Of an unknown itself: what is known of it by other means (a coefficient of expansion, of friction, a stiffness) is
seldom better, and nothing finer is asked for."""
NORMAL = 1.96
"""Standard deviations within which 95 % of all machines are."""


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


def tie_of(names: Sequence[str], explanations: Sequence[Fit], competition: Competition) -> Tie:
    """Return explanations that cannot be told apart, with the measurements of other quantities that would.

    A quantity is named where it can be told from what another explanation says of it: their distance is more than how
    well both are known from the record, and what is left of it, either way, is the accuracy that is needed. What asks
    for more than anybody knows (``FINEST``) is left away.
    """
    tied = [each for each in explanations if name_of(each) in names]
    stated = [_stated(each, competition) for each in tied]
    facts = []
    for fit, own in zip(tied, stated, strict=True):
        for quantity in own.values():
            others = [each for each in stated if quantity.name not in each] if len(tied) > 1 else [{}]
            distances = [quantity.clear_of(each) for each in others]
            accuracy = min(distances, default=0.0) / 2
            if accuracy > quantity.finest:
                size = Amount(quantity.value, quantity.unit)
                needed = Amount(accuracy, difference_unit(quantity.unit))
                facts.append(Fact(name_of(fit), quantity.name, size, quantity.note, needed))
    return Tie(tuple(names), tuple(facts))


@dataclass(frozen=True)
class _Stated:
    """A quantity that an explanation states, SI: its value, half of its 95 % interval, and the same without a cause."""

    name: str
    value: float
    reach: float
    unit: str
    note: str
    otherwise: float = 0.0
    otherwise_reach: float = 0.0

    def clear_of(self, other: Mapping[str, _Stated]) -> float:
        """Return how far it is from what another explanation says of it, beyond what is known of both.

        What bears its name there but for a number at the end ("expansion", "expansion_1") is the same quantity. An
        explanation without it says that there is nothing, or of an input that it is within its tolerance.
        """
        alike = [each for each in other.values() if (each.stem, each.unit) == (self.stem, self.unit)]
        values = [(each.value, each.reach) for each in alike] or [(self.otherwise, self.otherwise_reach)]
        return min(abs(self.value - value) - hypot(self.reach, reach) for value, reach in values)

    @property
    def finest(self) -> float:
        """How well it can be known by other means, either way: a part as well as its tolerance asks."""
        return 0.0 if self.name.startswith(INPUT) else FINEST * abs(self.value)

    @property
    def stem(self) -> str:
        """The name of the unknown, or of the input, without its number."""
        return re.sub(r"_?\d+$", "", re.split("[.:]", self.name)[-1])


def _stated(fit: Fit, competition: Competition) -> dict[str, _Stated]:
    """Return the quantities that an explanation states, by name: amplitudes, and inputs outside of their band."""
    fit = fit.in_sample(competition.sample)
    machine, start = fit.sample.machine, fit.sample.machine.start
    certainty = certainty_of(fit, competition.extended)
    reach: dict[str, float] = {}
    made: dict[str, _Stated] = {}
    for cause in fit.causes:
        for index in cause.amplitudes:
            place = places_of(fit, cause)[index]
            half = certainty.reach_of(place) * float(certainty.units[place])
            if cause.tolerated < 0:
                reach.setdefault(f"{cause.name}.{cause.numbers[index].name}", half)
                continue
            tolerated = machine.inputs[cause.tolerated]
            declared, known = start.model.input_fields.get(tolerated.name), start.model.known_conditions
            note = known[tolerated.name].note if declared is None else declared.spec.note
            name = f"{INPUT}{tolerated.name}"
            made.setdefault(name, _Stated(
                name, input_value(fit, cause.tolerated), half * tolerated.sd, start.unit_of(tolerated.name), note,
                tolerated.design, NORMAL * tolerated.sd,
            ))  # fmt: skip
    for on in switched_on(fit.causes, fit.values, machine):
        for unknown in on.effect.unknowns:
            name, value = f"{on.effect.name}.{unknown.name}", float(on.values.get(unknown.name, 0.0))
            if value and name in reach:
                made[name] = _Stated(name, value, reach[name], unknown.unit, unknown.note)
    return made


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
