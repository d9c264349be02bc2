"""The next measurement: settings that separate explanations which this data cannot tell apart.

Every explanation is believed in turn while its rival refits to everything so far; a setting is worth what the rival
then still gets wrong (greedy T-optimal design). The raw distance of two predictions would be the wrong criterion. The
rival refits by its derivatives at its own exact fit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate
from truing.diagnosis.choice import Chosen
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import look
from truing.diagnosis.exact import alone, fitting, slopes_at, unit_of
from truing.diagnosis.extended import Extended, elsewhere, parts_of
from truing.diagnosis.fitted import STEP, WIDE, Fit, moved_by
from truing.diagnosis.intervals import numbers_of
from truing.diagnosis.result import APART, Amount, NextPoint, readable_unit
from truing.diagnosis.sample import Sample
from truing.diagnosis.settings import FEW, TRIED, machine_there, settings_of
from truing.diagnosis.shape_words import in_unit
from truing.numbers import format_number
from truing.units import from_si

POINTS = 4
"""So many next measurements are proposed."""
MOST_POINTS = 100
"""Nobody measures more: explanations that so many points do not tell apart are told apart by a fact, or not at all."""
MOST_DUELLING = 4
"""So many of the nearest rivals are to be told apart: their pairs are compared at every setting."""
UNSEEN = 1e-9
"""Share of its own precision, or of one over its range squared, that is added to that of every number."""


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
    causes, values = list(best.causes), list(best.values)
    del causes[index], values[index]
    (predicted,) = competition.extended.at(causes, [(values, best.moved)])
    held = replace(best, causes=tuple(causes), values=tuple(values), predicted=predicted, slopes={})
    held = held.in_sample(competition.sample)
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
        weakest = min(live, key=lambda duel: duel.separation)
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
