"""The next measurement: settings, or further results, that separate explanations which this data cannot tell apart.

Every explanation is believed in turn while its rival refits to everything so far; a setting is worth what the rival
then still gets wrong (greedy T-optimal design). The raw distance of two predictions would be the wrong criterion. The
rival refits by its derivatives at its own exact fit.

Two causes may draw one curve on everything measured and still differ in a result that nobody measured. What the rivals
say of it at the rows there are, each as it is fitted, is held against what machines within their tolerances differ in
it: no gauge is known for it, so this is the only noise.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations
from math import log1p, pi, sqrt
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.fields import Axis
from truing.declare.goals import Maximise, Minimise, Require
from truing.diagnosis.causes import Candidate
from truing.diagnosis.choice import Chosen
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import look
from truing.diagnosis.curves import evenly
from truing.diagnosis.data_rows import is_angle
from truing.diagnosis.exact import alone, fitting, held_without, slopes_at, unit_of
from truing.diagnosis.extended import Extended, elsewhere, parts_of, switched_on
from truing.diagnosis.findings import in_unit
from truing.diagnosis.fitted import STEP, WIDE, Fit, input_value, moved_by
from truing.diagnosis.intervals import numbers_of
from truing.diagnosis.machine import Calibration, Predicted, calibration_of, predict
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import APART, Amount, Fact, NextPoint, Tie, readable_unit
from truing.diagnosis.sample import Sample
from truing.measurements import RowsFile
from truing.numbers import format_number
from truing.units import from_si, read_quantity, to_si
from truing.units.names import PURE

TRIED, FEW = 512, 32
"""So many points inside of the box are tried, and so many corners; few where calls of the model are dear."""
FEW_VALUES = 3
"""A column of so few values has no values between them: it is set to one of these."""
POINTS = 4
"""So many next measurements are proposed."""
MOST_POINTS = 100
"""Nobody measures more: explanations that so many points do not tell apart are told apart by a fact, or not at all."""
MOST_DUELLING = 4
"""So many of the nearest rivals are to be told apart: their pairs are compared at every setting."""
UNSEEN = 1e-9
"""Share of its own precision, or of one over its range squared, that is added to that of every number."""
ROWS = 40
"""So many rows of the record are asked what the rivals differ in."""
CLEAR = sqrt(APART)
"""Beyond this many standard deviations of machines within their tolerances a difference tells explanations apart."""
SEPARATION_DIGITS = 3
"""Decimal places of the logarithm of a separation that count: two names of one curve are told from a third alike."""
NEARLY = 0.95
"""Of several rows that tell as clearly the one is told in which the difference is largest."""
LEAST_SHARE = 1e-3
"""Of the result itself: no gauge is trusted with less."""


def settings_of(machine: Calibration, tried: int = TRIED) -> dict[str, Matrix]:
    """Return the settings that are tried, by input or condition, SI: so many corners of the box and points in it."""
    covariates = machine.records.covariates
    ranges = ((name, _box(machine, name, covariate)) for name, covariate in covariates.items())
    boxes = {name: box for name, box in ranges if box is not None and box[1] > box[0]}
    if not boxes:
        return {}
    unit = evenly(len(boxes), tried)
    edges = np.random.Generator(np.random.SFC64(0)).integers(0, 3, size=(tried, len(boxes))) / 2
    every = np.concatenate([unit, edges])
    settings = {}
    for column, (name, (low, high)) in enumerate(boxes.items()):
        values = low + (high - low) * every[:, column]
        measured = covariates[name].values
        if len(np.unique(measured[np.isfinite(measured)])) <= FEW_VALUES:
            values = np.where(every[:, column] < 0.5, low, high)
        settings[name] = values
    return settings


def _box(machine: Calibration, name: str, covariate: Covariate) -> tuple[float, float] | None:
    """Return the range in which something can be set: asked for, declared, or half as wide again as measured."""
    start = machine.start
    if name in start.diagnose.box:
        return start.diagnose.box[name]
    condition, field = start.model.known_conditions.get(name), start.model.input_fields.get(name)
    if condition is not None:
        low = np.nanmin(covariate.values) if condition.low is None else to_si(condition.low, condition.unit)
        high = np.nanmax(covariate.values) if condition.high is None else to_si(condition.high, condition.unit)
        return float(low), float(high)
    if field is None or not field.varies:
        return None
    low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
    declared = [getattr(field.spec, key, None) for key in ("at_least", "above", "at_most", "below")]
    lows = [float(to_si(value, field.unit)) for value in declared[:2] if isinstance(value, (int, float))]
    highs = [float(to_si(value, field.unit)) for value in declared[2:] if isinstance(value, (int, float))]
    if is_angle(field.unit) and not lows and not highs:
        return min(low, -pi), max(high, pi)
    reach = (high - low) / 2
    lows += [min(low, 0.0)] if covariate.role == "time" else []
    return max([low - reach, *lows]), min([high + reach, *highs])


def machine_there(machine: Calibration, settings: Mapping[str, Matrix]) -> Calibration:
    """Return the machine at the settings that are tried; what is not set has the middle of what was measured."""
    count = len(next(iter(settings.values())))
    columns = {
        name: np.full(count, np.nanmedian(values))
        for name, values in machine.records.rows.columns.items()
        if isinstance(values, np.ndarray) and values.dtype.kind == "f"
    }
    known = machine.records.covariates
    records = replace(
        machine.records.part(np.zeros(count, dtype=np.intp)),
        rows=RowsFile("", columns | dict(settings), {}, {}, tuple(range(count))),
        covariates={name: replace(known[name], values=values) for name, values in settings.items()},
    )
    return replace(machine, records=records, base={}, slopes={})


@dataclass
class _Duel:
    """One explanation believed, a rival refitted to it: the rival's coefficients and inverse normal matrix.

    ``signal`` (R, T) is what the believed one says of every result at every setting, ``rows`` (R, T, p) the rival's
    rows there, both in units of the noise of one value.
    """

    names: tuple[str, str]
    separation: float
    coefficients: Matrix
    inverse: Matrix
    signal: Matrix
    rows: Matrix

    def gains(self) -> Matrix:
        """Return what every setting would add to the separation, shape (T,)."""
        leverage = np.einsum("rti,ij,rtj->rt", self.rows, self.inverse, self.rows)
        return np.asarray(np.sum(self.left() ** 2 / (1 + leverage), axis=0))

    def left(self) -> Matrix:
        """Return what the rival gets wrong at every setting, (R, T)."""
        return np.asarray(self.signal - self.rows @ self.coefficients)

    def needed(self, places: Sequence[int]) -> int | None:
        """Return how many points at these settings, each as often as the others, tell the two apart; None: too many.

        ``times`` readings at every setting leave the rival ``left' (1 / times + R inverse R')^-1 left`` more than now,
        R its rows there and ``left`` what it gets wrong before it is fitted to them.
        """
        rows = self.rows[:, list(places)].reshape(-1, self.rows.shape[-1])
        left, carried = self.left()[:, list(places)].ravel(), rows @ self.inverse @ rows.T
        point = np.arange(len(rows)) % max(len(places), 1)
        counts: list[int] = [*range(1, len(places)), *range(len(places), MOST_POINTS + 1, len(places) or MOST_POINTS)]
        for count in counts:
            few = np.flatnonzero(point < count)
            normal = carried[np.ix_(few, few)] + np.eye(len(few)) / max(count // max(len(places), 1), 1)
            if self.separation + float(left[few] @ np.linalg.solve(normal, left[few])) >= APART:
                return count
        return None

    def measure(self, index: int) -> None:
        """Add one setting to the data: the rival refits (exact rank-one update)."""
        for signal, row in zip(self.signal[:, index], self.rows[:, index], strict=True):
            carried = self.inverse @ row
            scale = 1 + float(row @ carried)
            left = float(signal - row @ self.coefficients)
            self.separation += left**2 / scale
            self.coefficients = self.coefficients + carried * (left / scale)
            self.inverse = self.inverse - carried[:, None] * carried[None, :] / scale


@dataclass(frozen=True)
class NextPoints:
    """Settings to measure, and the pairs of explanations that they do not tell apart, however often measured."""

    points: tuple[NextPoint, ...] = ()
    tied: tuple[tuple[str, str], ...] = ()


def next_points(chosen: Chosen) -> NextPoints:
    """Return up to four settings that separate the winner and its rivals, with the reason for each.

    Shapes that nobody registered say nothing beyond the rows they were fitted to, so they are no rivals here. Of
    results along an axis nothing is proposed: what could be set there is a whole record.
    """
    several = rival_fits(chosen)
    if len(several) < 2:
        return NextPoints()
    machine = chosen.competition.sample.machine
    fields = machine.start.model.own_result_fields
    is_along = any(fields[name].along for name in machine.records.measured)
    settings = {} if is_along else settings_of(machine, FEW if chosen.competition.extended.budget.is_dear else TRIED)
    duels = _duels(chosen, several, settings) if settings else []
    live = _live(_live(duels))  # what is the same chooses no setting for the others
    winner = name_of(chosen.best)
    pairs = [(winner, name_of(fit)) for fit in several[1:]] if is_physical(chosen.best) else []
    apart = {frozenset(duel.names) for duel in live}
    tied = tuple(pair for pair in pairs if frozenset(pair) not in apart)
    return NextPoints(tuple(_points(chosen, settings, live)), tied)


def is_physical(fit: Fit) -> bool:
    """Whether an explanation is made of effects and inputs alone, so that it says something at other settings."""
    return bool(fit.causes) and all(cause.is_registered for cause in fit.causes)


def name_of(fit: Fit) -> str:
    """Return what an explanation is called: the names of its causes, each once."""
    return " + ".join(fit.names)


def rival_fits(chosen: Chosen) -> list[Fit]:
    """Return the winner, the winner under its other names and the first rivals, one fit for every name.

    Explanations with a shape that nobody registered are left out.
    """
    rivals = [rival.fit for rival in chosen.rivals if is_physical(rival.fit)][:MOST_DUELLING]
    own = [chosen.best, *_renamed(chosen)] if is_physical(chosen.best) else []
    by_name: dict[frozenset[str], Fit] = {}
    for fit in (*own, *rivals):
        by_name.setdefault(frozenset(fit.names), fit)
    return list(by_name.values())


def _renamed(chosen: Chosen) -> Iterator[Fit]:
    """Give the winner with one cause exchanged for each that draws the same curve, as large as that is here."""
    best, competition = chosen.best, chosen.competition
    for index, cause in enumerate(best.causes):
        for name in chosen.same.get(cause.tag, ()):
            others = [other for other in competition.causes if other.name == name and other.tag not in best.key]
            keys = [(best.key - {cause.tag}) | {other.tag} for other in others]
            fits = [competition.known[key] for key in keys if key in competition.known]
            fits = fits or [fit for other in others for fit in _exchanged(competition, best, index, other)]
            if fits:
                yield min(fits, key=lambda fit: fit.cost)


def _exchanged(competition: Competition, best: Fit, index: int, other: Candidate) -> Iterator[Fit]:
    """Give exact fits of an explanation with one cause exchanged for another, from where its curves say."""
    held = held_without(best, index, competition.sample, competition.extended)
    causes, values = held.causes, held.values
    seen = look(competition.curves, held, [other]).get(other.tag) if np.isfinite(held.left).all() else None
    for _, start in seen.starts if seen is not None else ():
        several, begun = (*causes[:index], other, *causes[index:]), (*values[:index], start, *values[index:])
        extended = competition.extended
        fit = alone(extended, fitting(competition.sample, extended, several, begun, held))
        if fit is not None:
            yield fit


def _live(duels: Sequence[_Duel]) -> list[_Duel]:
    """Return the duels that the settings best for all of them decide."""
    taken = _greedy(duels)
    return [duel for duel in duels if duel.needed(taken) is not None]


def _greedy(duels: Sequence[_Duel]) -> list[int]:
    """Return the places of the settings that separate most, one after another, none twice."""
    if not duels:
        return []
    now = [replace(duel) for duel in duels]
    chosen: list[int] = []
    for _ in range(POINTS):
        worth = np.sum([np.log1p(duel.separation + duel.gains()) for duel in now], axis=0)
        worth[chosen] = -np.inf
        index = int(np.argmax(np.where(np.isfinite(worth), worth, -np.inf)))
        if not np.isfinite(worth[index]):
            break
        chosen.append(index)
        for duel in now:
            duel.measure(index)
    return chosen


def _points(chosen: Chosen, settings: Mapping[str, Matrix], live: Sequence[_Duel]) -> Iterator[NextPoint]:
    """Give the settings with what they are for, and how many like them are needed to tell all pairs apart."""
    taken, start = _greedy(live), chosen.competition.sample.machine.start
    needed = max((duel.needed(taken) or MOST_POINTS for duel in live), default=0)
    for count, index in enumerate(taken, start=1):
        weakest = min(live, key=lambda duel: round(log1p(duel.separation), SEPARATION_DIGITS))
        why = _why(chosen, settings, index, weakest)
        for duel in live:
            duel.measure(index)
        if count == len(taken) < needed:
            why += f"; {needed} points like these would be needed to tell them apart"
        least = min(duel.separation for duel in live)
        amounts = {name: Amount(float(values[index]), start.print_unit(name)) for name, values in settings.items()}
        yield NextPoint(amounts, weakest.names, why, least, needed=needed)


@dataclass(frozen=True)
class _Seen:
    """An explanation on the data and at the settings that are tried.

    ``there`` is what it predicts of the results at the settings (R, T), SI. Columns are derivatives by its free
    numbers, as the fit sees them, and by the directions of the inputs: of the sample's rows in units of the noise,
    (rows, p), and at the settings in SI, (R, T, p).
    """

    fit: Fit
    columns: Matrix
    there: Matrix
    columns_there: Matrix


def _duels(chosen: Chosen, several: Sequence[Fit], settings: Mapping[str, Matrix]) -> list[_Duel]:
    """Set up every explanation, believed, against every other one, unless that is the same with something added."""
    competition = chosen.competition
    tried = elsewhere(competition.extended, machine_there(competition.sample.machine, settings))
    roots = competition.sample.roots(chosen.best.in_sample(competition.sample).left)
    seen = [_seen(fit.in_sample(competition.sample), competition.extended, tried) for fit in several]
    spreads = np.array(list(_spreads(competition.sample, chosen.best).values()))[:, None]
    return [_duel(a, b, roots, spreads) for a, b in permutations(seen, 2) if not a.fit.key <= b.fit.key]


def _spreads(sample: Sample, best: Fit) -> dict[str, float]:
    """Return the standard deviation of one new value of every result as the winner leaves it, SI."""
    squares = sample.squares(sample.left(best.predicted))
    return {each.name: each.scale * square**0.5 for each, square in zip(sample.channels, squares, strict=True)}


def _duel(true: _Seen, rival: _Seen, roots: Matrix, spreads: Matrix) -> _Duel:
    """Set up one believed explanation against one rival, which refits to what the believed one says of this data.

    The rival pays for its inputs what they are off their means, the believed one has paid for its own already.
    """
    k = len(rival.fit.inputs)
    design = rival.columns * roots[:, None]
    count = design.shape[1]
    at = np.concatenate([np.zeros(count - k), rival.fit.inputs])  # coefficients are moves, of inputs all of them
    apart = (rival.fit.left - true.fit.left) * roots + design @ at
    normal = design.T @ design
    normal += np.diag([0.0] * (count - k) + [1.0] * k) + UNSEEN * np.diag(np.maximum(np.diag(normal), 1.0))
    inverse: Matrix = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    start = inverse @ (design.T @ apart)
    left = apart - design @ start
    paid = float(start[count - k :] @ start[count - k :]) - float(true.fit.inputs @ true.fit.inputs)
    rows = rival.columns_there / spreads[..., None]
    signal = (true.there - rival.there) / spreads + rows @ at
    names = name_of(true.fit), name_of(rival.fit)
    return _Duel(names, max(0.0, float(left @ left) + paid), start, inverse, signal, rows)


def _seen(fit: Fit, extended: Extended, tried: Extended) -> _Seen:
    """Return what an explanation predicts and how it changes, on the data and at the settings that are tried."""
    numbers, sample, k, units = numbers_of(fit), fit.sample, len(fit.inputs), unit_of(fit)
    flat = np.concatenate(fit.values)
    steps = (WIDE if tried.grain else STEP) * np.maximum(np.abs(flat), 1e-2 * np.abs(units))
    steps = np.where(flat + steps > [number.high for number in numbers], -steps, steps)
    moves = np.diag([step if number.is_free else 0.0 for step, number in zip(steps, numbers, strict=True)])
    points = [(parts_of(fit.causes, flat + move), fit.moved) for move in (np.zeros(len(flat)), *moves)]
    for half in 0.5 * np.eye(k):
        points += [(list(fit.values), moved_by(sample, fit.inputs + sign * half)) for sign in (1, -1)]
    names = [channel.name for channel in sample.channels]
    base, *moved = np.array([[shown[name] for name in names] for shown in tried.at(fit.causes, points)])
    rises, ups, downs = moved[: len(flat)], moved[len(flat) :: 2], moved[len(flat) + 1 :: 2]
    slopes = [(each - base) * unit / step for each, unit, step in zip(rises, units, steps, strict=True)]
    slopes += [up - down for up, down in zip(ups, downs, strict=True)]
    own = np.column_stack(slopes_at(fit, extended))
    free = np.array([*(number.is_free for number in numbers), *[True] * k])
    return _Seen(fit, own[:, free], base, np.stack(slopes, axis=-1)[..., free])


def _why(chosen: Chosen, settings: Mapping[str, Matrix], index: int, duel: _Duel) -> str:
    """Say what makes a setting worth measuring: how far the two then differ, and what leaves the record farthest.

    Only what the effects of the two explanations follow is looked at, where they follow anything.
    """
    sample = chosen.competition.sample
    gaps = np.abs(duel.left()[:, index])
    name, spread = list(_spreads(sample, chosen.best).items())[int(np.argmax(gaps))]
    unit = readable_unit(sample.machine.start.print_unit(name), spread)
    words = f"{duel.names[0]} and {duel.names[1]} there differ by {in_unit(float(gaps.max()) * spread, unit)} in {name}"
    known = sample.machine.start.model.known_effects
    effects = [known[effect_name] for name in duel.names for effect_name in name.split(" + ") if effect_name in known]
    asked = {key for effect in effects for key in (*(need.name for need in effect.needs), *effect.reads)}
    beyond, reach = "", 0.05
    for key in [setting for setting in settings if not asked or setting in asked]:
        covariate, value = sample.machine.records.covariates[key], float(settings[key][index])
        low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
        out = max(low - value, value - high) / max(high - low, 1e-300)
        if out > reach:
            begin = format_number(float(from_si(low, covariate.unit)), 3)
            beyond, reach = f"; {key} was only {begin} to {in_unit(high, covariate.unit, 3)} so far", out
    return words + beyond


@dataclass(frozen=True)
class _Gap:
    """What two explanations differ in a result that was not measured: where it is clearest, by one value, SI."""

    result: str
    names: tuple[str, str]
    size: float
    scatter: float
    clearness: float
    """The difference over the scatter of machines; a result that does not scatter is as clear as can be."""


def with_results(chosen: Chosen, proposal: NextPoints) -> tuple[list[NextPoint], list[Tie]]:
    """Return the next points with the result that separates the rivals, and what neither of them tells apart.

    The result comes first where settings leave something open that it does not.
    """
    machine = chosen.competition.sample.machine
    explanations = rival_fits(chosen) if is_physical(chosen.best) else []
    asked, apart = _result_to_measure(machine, explanations)
    tied = [pair for pair in proposal.tied if frozenset(pair) not in apart]
    ties = [_tie(names, explanations) for names in _joined(tied)]
    points = list(proposal.points)
    if asked is not None:
        suffices = points and points[-1].needed <= len(points) and not proposal.tied
        points = [*points, asked] if suffices else [asked, *points]
    return points, ties


def _joined(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Join pairs that share an explanation to groups."""
    groups: list[tuple[str, ...]] = []
    for pair in pairs:
        own = [group for group in groups if set(group) & set(pair)]
        groups = [group for group in groups if group not in own]
        groups.append(tuple(dict.fromkeys(name for group in (*own, pair) for name in group)))
    return groups


def _tie(names: Sequence[str], explanations: Sequence[Fit]) -> Tie:
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


def _result_to_measure(
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
        gaps = sorted((gap for gap in pairs if gap is not None), key=lambda gap: gap.clearness)
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
    words = f"measure {gap.result}, too: {gap.names[0]} and {gap.names[1]} differ by {in_unit(gap.size, unit)} in it"
    if gap.scatter > 0:
        words += f", machines within their tolerances by {in_unit(gap.scatter, unit)}"
    return NextPoint({}, gap.names, words, gap.clearness**2, (gap.result,))
