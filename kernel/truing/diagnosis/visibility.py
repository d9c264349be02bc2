"""How small an effect may be and still be seen here, and what this design of the experiment cannot separate."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import asin, comb, inf, log, sin, sqrt
from operator import itemgetter

import numpy as np
from scipy.optimize import lsq_linear
from scipy.special import ndtri

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter, failure_of, idle_of
from truing.diagnosis.choice import Chosen
from truing.diagnosis.conditional import Conditional
from truing.diagnosis.curves import LEVELS
from truing.diagnosis.exact import slopes_at, unit_of
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit, inward
from truing.diagnosis.intervals import Certainty, certainty_of, numbers_of, places_of, value_of
from truing.diagnosis.machine import Calibration
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import APART, Alike, Amount, Trade, Visibility, VisibleSize
from truing.diagnosis.sentences import say

POWER, LEVEL = 0.9, 0.05
"""A size is visible that is found with this power at this level, the choice among all explanations paid for."""
SWALLOWED = 0.1
"""Share of a curve, squared and in units of the noise, below which the tolerances have swallowed it."""
FAINT = 1e-18
"""A curve that is smaller, squared and in units of the noise at its bound, is rounding."""
INSEPARABLE = 0.01
"""Share of a curve, squared, that is left beside another one below which the two are inseparable."""
SAME = 1e-9
"""Squared sine of an angle below which two curves are one."""
TIED = 0.995
"""Correlation above which two settings of a record were moved together."""
FEW_SHAPES = 5
"""At so many shapes a cause that bends in several amplitudes is asked for each of them alone."""
NEXT_LEVEL = 0.3
"""An amplitude that bends is asked for again at so much of it: its curve stands for no sizes beyond that."""

TRADED = 0.95
"""Correlation of an amplitude and an input above which they trade. With the input held at its value the standard error
of the amplitude would be sqrt(1 - 0.95^2) of what it is, a third: so much is lost to the tolerance of the input."""


def needed(explanations: int) -> float:
    """Return the noncentrality that shows one parameter with 90 % power after so many explanations were searched.

    22 for 78 explanations (12 effects and their pairs), 17 for 12.
    """
    return float((ndtri(1 - LEVEL / (2 * max(explanations, 1))) + ndtri(POWER)) ** 2)


def _eye(chosen: Chosen) -> Conditional:
    """Return what curves are seen with on the rows that were searched, once the inputs have taken their part.

    The noise is that which the answer leaves; a row counts as many times as the record has rows for it.
    """
    best = chosen.searched.best
    roots = best.sample.roots(best.left) * sqrt(chosen.rows_searched)
    drawn = best.sample.drawn * roots[:, None]
    taken = np.linalg.qr(np.concatenate([drawn, np.eye(drawn.shape[1])]))[0]
    return Conditional(best.sample, roots, best.left, taken)


@dataclass(frozen=True)
class _Look:
    """How a cause is seen best by one of its amplitudes: the smallest size that shows, SI, and its curve there.

    ``seen`` and ``raw`` are squares of the curve with and without what the inputs take; ``curve`` (rows + K,).
    """

    size: float
    seen: float
    raw: float
    curve: Matrix


def smallest_visible(chosen: Chosen) -> list[VisibleSize]:
    """Return for every effect how small it may be, whether the tolerances hide it, whether it was excited."""
    machine, eye = chosen.competition.extended.machine, _eye(chosen)
    effects = [cause for cause in chosen.competition.causes if cause.effect is not None]
    known, unseen = chosen.searched.competition.known, chosen.searched.competition.extended.budget.unseen
    unfitted = [cause for cause in effects if frozenset({cause.tag}) not in known]
    reasons = {cause.name: failure_of(machine, cause) for cause in unfitted}
    failing = {name: why for name, why in reasons.items() if why}
    skipped = {*failing, *unseen}
    limit = needed(len(effects) + comb(len(effects), 2))
    names = [cause.name for cause in effects]
    sizes: dict[str, list[VisibleSize]] = {}
    for cause in effects:
        amplitudes = {cause.numbers[index].name for index in cause.amplitudes}
        several = names.count(cause.name) > 1 or len(amplitudes) > 1
        for index in cause.amplitudes if cause.name not in skipped else ():
            number, look = cause.numbers[index], _look(chosen, eye, cause, index, limit)
            name = f"{cause.name}.{number.name}" if several else cause.name
            sizes.setdefault(name, []).append(_seen(name, cause, number, look))
    smallest = [min(each, key=lambda seen: seen.smallest.value if seen.smallest else inf) for each in sizes.values()]
    still = [VisibleSize(name, None, "not excited") for name in idle_of(machine) if name not in failing]
    return [*smallest, *still, *(VisibleSize(name, None, "cannot be fitted", why) for name, why in failing.items())]


def _seen(name: str, cause: Candidate, number: Parameter, look: _Look | None) -> VisibleSize:
    """Say how an effect is seen by one of its amplitudes."""
    if look is None or cause.effect is None:
        return VisibleSize(name, None, "not excited")
    sight: Visibility = "hidden in the tolerances" if look.seen < SWALLOWED * look.raw else "visible"
    if look.size > max(abs(number.low), abs(number.high)):
        sight = "not excited"
    unit = next(unknown.unit for unknown in cause.effect.unknowns if unknown.name == number.name)
    return VisibleSize(name, Amount(look.size, unit), sight)


def _look(chosen: Chosen, eye: Conditional, cause: Candidate, index: int, limit: float) -> _Look | None:
    """Return how an amplitude of a cause is seen best; None where nothing moves with it.

    A curve that bends stands for sizes from its own down and up to the next level.
    """
    number, best = cause.numbers[index], None
    for amplitude, curve in _curves(chosen, cause, index):
        end = abs(number.high if amplitude > 0 else number.low) if amplitude else max(abs(number.low), abs(number.high))
        own = abs(amplitude) or 1.0
        raw = eye.drawn(curve)
        square, rest = float(raw @ raw), eye.beyond(raw)
        if square * (end / own) ** 2 <= FAINT:
            continue
        seen = float(rest @ rest)
        size = own * sqrt(limit / max(seen, 1e-300))
        if amplitude and own < NEXT_LEVEL * end and size > own / NEXT_LEVEL:
            continue
        if own > 1.001 * LEVELS[-1] * end and amplitude:
            size = max(size, NEXT_LEVEL * own)
        if best is None or size < best.size:
            best = _Look(size, seen, square, rest)
    return best


def _curves(chosen: Chosen, cause: Candidate, index: int) -> Iterator[tuple[float, Matrix]]:
    """Give the curves of one amplitude of a cause alone, (readings,), SI, with its size.

    Of a cause in proportion the size is 0, and the curve is the one per unit.
    """
    searched = chosen.searched
    bundle = searched.competition.curves.of(cause, searched.null)
    if bundle.is_straight:
        column = cause.amplitudes.index(index)
        yield from ((0.0, curve) for curve in bundle.curves[:, column])
    elif len(cause.amplitudes) == 1:
        yield from zip(bundle.points[:, index].tolist(), bundle.curves[:, 0], strict=True)
    elif len(bundle.points):
        yield from _one_by_one(searched, cause, index, bundle.points[:FEW_SHAPES])


def _one_by_one(chosen: Chosen, cause: Candidate, index: int, shapes: Matrix) -> Iterator[tuple[float, Matrix]]:
    """Give the curves of one amplitude of a cause that bends in several, the others at zero."""
    number, extended = cause.numbers[index], chosen.competition.extended
    sizes = [level * end for end in (number.low, number.high) if end for level in LEVELS]
    distinct = shapes if cause.shapes else shapes[:1]
    still = np.zeros(len(extended.machine.inputs))
    (base,) = extended.at((), [((), still)])
    for values in distinct:
        points = np.tile(values, (len(sizes), 1))
        points[:, cause.amplitudes] = 0.0
        points[:, index] = sizes
        for size, shown in zip(sizes, extended.at((cause,), [([point], still) for point in points]), strict=True):
            yield size, np.nan_to_num(np.concatenate([shown[name] - base[name] for name in base]))


def inseparable(machine: Calibration, alike: Sequence[Alike]) -> Iterator[str]:
    """Say which causes this design cannot separate whatever their size, and which covariates are tied."""
    for each in alike:
        kind = "not distinguished" if sin(each.angle) ** 2 < SAME else "hardly distinguished"
        yield say(kind, one=each.one, other=each.other)
    yield from _moved_alike(machine)


def alike_of(chosen: Chosen) -> tuple[Alike, ...]:
    """Return the pairs of causes without a shape of their own that draw nearly the same."""
    eye, apart = _eye(chosen), dict[tuple[str, str], float]()
    effects = [cause for cause in chosen.competition.causes if cause.effect is not None]
    plain = [cause for cause in effects if len(cause.amplitudes) == 1 and not cause.shapes]
    looks = [(cause.name, _look(chosen, eye, cause, 0, needed(1))) for cause in plain]
    drawn = [(name, look.curve) for name, look in looks if look is not None and look.seen > 1e-6 * look.raw]
    for (one, first), (other, second) in combinations(drawn, 2):
        square = 1 - float(first @ second) ** 2 / float((first @ first) * (second @ second))
        if one != other and square < INSEPARABLE:
            apart[one, other] = min(max(square, 0.0), apart.get((one, other), inf))
    return tuple(Alike(*names, asin(sqrt(square))) for names, square in apart.items())


def _moved_alike(machine: Calibration) -> Iterator[str]:
    """Say which covariates are tied, and which conditions that can have either sign had one sign only."""
    moved = [covariate for covariate in machine.records.covariates.values() if not covariate.is_constant]
    for first, second in combinations(moved, 2):
        if first.moves_with(second, TIED):
            yield say("moved together", one=first.name, other=second.name)
    for name, condition in machine.start.model.known_conditions.items():
        covariate, low, high = machine.records.covariates.get(name), condition.low, condition.high
        if covariate is None or low is None or high is None or not low < 0 < high:
            continue
        if np.nanmin(covariate.values) >= 0 or np.nanmax(covariate.values) <= 0:
            yield say("never changed sign", covariate=name)


def trades_of(chosen: Chosen) -> tuple[Trade, ...]:
    """Return the named effects that this record does not separate from one of the tolerated inputs.

    The correlation is that of the exact fit, with the tolerances in force: an input that is known well enough has none.
    A cause that is far from zero even with every input free is separated all the same: only what ``APART`` calls
    separable at most weakly is returned.
    """
    best, inputs, trades = chosen.best, chosen.best.sample.machine.inputs, list[Trade]()
    named = [cause for cause in best.causes if cause.effect is not None]
    if not named or not len(best.inputs):
        return ()
    certainty = certainty_of(best, chosen.competition.extended)
    alike = _correlations(best, certainty)
    alike[:, [cause.tolerated for cause in best.causes if cause.tolerated >= 0]] = 0.0
    for cause in named:
        places = [places_of(best, cause)[index] for index in cause.amplitudes]
        (number, column), _ = lowest_first(np.ndenumerate(-np.abs(alike[places])), itemgetter(1))[0]
        correlation = float(alike[places[number], column])
        values = np.array([value_of(best, index) for index in places]) / certainty.units[places]
        inverse = np.linalg.pinv(certainty.covariance[np.ix_(places, places)], hermitian=True)
        separation = float(values @ inverse @ values)  # the squares that are lost without the cause, all else free
        if abs(correlation) > TRADED and separation < APART:
            unknown = cause.numbers[cause.amplitudes[number]].name
            trades.append(Trade(cause.name, unknown, inputs[column].name, correlation, separation))
    return tuple(trades)


def _correlations(best: Fit, certainty: Certainty) -> Matrix:
    """Return the correlation of every number with every input, (numbers, inputs).

    Of what the rows do not see of an input its tolerance is all that is known.
    """
    size, directions = best.size, best.sample.directions
    covariance = certainty.covariance
    seen = np.einsum("ij,jk,ik->i", directions, covariance[size:, size:], directions)
    variance = seen + np.maximum(1 - np.sum(directions**2, axis=1), 0.0)
    own = np.outer(np.diag(covariance)[:size], variance)
    return np.asarray(covariance[:size, size:] @ directions.T / np.sqrt(np.maximum(own, 1e-300)))


def separation(true: Fit, rival: Fit, extended: Extended) -> float:
    """Return lambda: the deviance that is lost if an explanation is true and a rival is refitted in its place.

    Both are taken on the machine as the true one has calibrated it; the rival is linear about its own fit, within the
    bounds of its numbers and the prior of the inputs. The noise is the one that the true one leaves.
    """
    sample, k = true.sample, len(true.inputs)
    moved = replace(rival.in_sample(sample), inputs=true.inputs)
    (shown,) = extended.at(rival.causes, [(rival.values, true.moved)])
    roots = sample.roots(true.left)
    apart = roots * np.nan_to_num(sample.left(shown) - sample.left(true.predicted))
    slopes = np.column_stack(slopes_at(moved, extended)) * roots[:, None]
    columns = np.concatenate([slopes, np.eye(k, moved.size + k, moved.size)])
    ends = np.full((2, columns.shape[1]), [[-inf], [inf]])
    for index, (number, unit) in enumerate(zip(numbers_of(moved), unit_of(moved).tolist(), strict=True)):
        low, high = np.subtract(inward(number, unit), log(unit) if number.is_log else value_of(moved, index) / unit)
        ends[:, index] = min(low, -1e-12), max(high, 1e-12)
    size = np.linalg.norm(columns, axis=0)
    used = size > 0
    target = np.concatenate([apart, np.zeros(k)])
    if not used.any():
        return float(target @ target)
    low, high = ends[:, used] * size[used]
    return float(2 * lsq_linear(columns[:, used] / size[used], target, (low, high), method="bvls").cost)
