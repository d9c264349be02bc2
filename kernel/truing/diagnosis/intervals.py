"""How certain the numbers of a fit are: their covariance, intervals by Student's t, and profiles of shapes.

Rows count as far as they are independent: all of them once the memory of the noise is taken out, else fewer. What is
known of a time constant is seldom symmetric and often open on one side: the interval of a shape is that of its profile.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import exp, log, log1p, sqrt

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter
from truing.diagnosis.exact import CLOSELY, alone, fitting, slopes_at, unit_of
from truing.diagnosis.extended import Extended, parts_of
from truing.diagnosis.fitted import Fit, inward
from truing.diagnosis.machine import in_blocks

QUANTILE = 0.975
"""Of Student's t at either end of an interval: together they hold 95 %."""
LARGEST_LEVERAGE = 0.95
"""A row that holds an estimate alone leaves nothing; what it would have left is taken to be at most 20 times that."""
FEWEST_FREE = 2.0
"""Degrees of freedom of Student's t at the least, however few rows a result has."""
SINGULAR = 1e-12
"""Share of the largest eigenvalue, columns of unit length, below which a combination of numbers is not determined."""
FARTHER = 2.0
"""So many times as far is looked for the end of a profile that was not reached yet."""
SHORTEST, LONGEST = 1e-3, 0.25
"""Of the way to a bound: between these is the first step along a profile."""
END_KNOWN = 5e-3
"""Of its distance from the fitted value: how well the end of a profile is known."""
PLACE_LIMIT = 7.35
"""What the cost of a place at which something begins may rise by (B. E. Hansen, Sample splitting and threshold
estimation, Econometrica 68, 2000, 575)."""
WHOLE = 6.0
"""The same of a whole number: what is not excluded elsewhere."""
MOST_WHOLE = 12
"""So many whole numbers are tried on either side."""
HIGHEST = 100.0
"""In units of what a profile may rise by: how high it is where the model fails."""
Ends = tuple[float | None, float | None]
"""An interval, SI; None is an open end."""


@dataclass(frozen=True)
class Certainty:
    """Covariance of all numbers of a fit, as the fit sees them, with the directions of the inputs behind them.

    ``units`` is what one unit of every number is in SI; ``variance`` is that of an independent row in units of what the
    fit leaves, a little above 1 for what the numbers have used up; ``freedom`` counts the independent rows left.
    """

    covariance: Matrix
    units: Matrix
    variance: float
    freedom: float

    def reach(self, weights: Matrix) -> float:
        """Return half of the 95 % interval of a weighted sum of numbers and directions, as the fit sees them."""
        squared = max(float(weights @ self.covariance @ weights), 0.0)
        return float(stdtrit(self.freedom, QUANTILE)) * sqrt(squared)

    def reach_of(self, index: int) -> float:
        """Return half of the 95 % interval of one number, as the fit sees it."""
        return self.reach(np.eye(len(self.covariance))[index])

    def in_si(self, places: Sequence[int]) -> tuple[tuple[float, ...], ...]:
        """Return the covariance of some numbers in SI."""
        own = self.units[list(places)]
        part = self.covariance[np.ix_(list(places), list(places))] * np.outer(own, own)
        return tuple(tuple(row) for row in part.tolist())


def numbers_of(fit: Fit) -> list[Parameter]:
    """Return the numbers of all causes of a fit, one behind another: the order of places."""
    return [number for cause in fit.causes for number in cause.numbers]


def places_of(fit: Fit, cause: Candidate) -> range:
    """Return the places of the numbers of a cause among those of all."""
    position = [each.tag for each in fit.causes].index(cause.tag)
    begin = sum(each.size for each in fit.causes[:position])
    return range(begin, begin + cause.size)


def value_of(fit: Fit, index: int) -> float:
    """Return one of all numbers, SI."""
    return float(np.concatenate(fit.values)[index])


def certainty_of(fit: Fit, extended: Extended) -> Certainty:
    """Return how certain the numbers of a fit are.

    The larger of the model-based covariance and the sandwich (HC3; J. G. MacKinnon, H. White, J. Econometrics 29, 1985,
    305), number by number. Of noise that is Student's t with f degrees of freedom a row tells (f + 1) / (f + 3) of what
    its weight says.
    """
    sample, units = fit.sample, unit_of(fit)
    roots = sample.roots(fit.left)
    told = np.concatenate([np.full(len(channel), sqrt(1 - 2 / (channel.freedom + 3))) for channel in sample.channels])
    slopes = np.column_stack(slopes_at(fit, extended)) * (roots * told)[:, None]
    prior = np.diag(np.append(np.zeros(len(units)), np.ones(len(fit.inputs))))
    normal = slopes.T @ slopes
    inverse = _inverse(normal + prior)
    used = float(np.trace(inverse @ normal))
    variance = sample.known / max(sample.known - used, 1.0)
    scores = _scores(slopes, roots * fit.left / told, inverse)
    plain, sandwich = inverse * variance, inverse @ (scores + variance * prior) @ inverse
    ratio = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(plain), 1e-300), 1.0))
    return Certainty(plain * np.outer(ratio, ratio), units, variance, max(sample.known - used, FEWEST_FREE))


def _inverse(normal: Matrix) -> Matrix:
    """Return the inverse of a normal matrix; 0 for numbers that the rows say nothing of."""
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    scale = np.outer(size, size)
    return np.asarray(np.linalg.pinv(normal / scale, rcond=SINGULAR, hermitian=True) / scale)


def _scores(slopes: Matrix, left: Matrix, inverse: Matrix) -> Matrix:
    """Return the covariance of the gradient as the rows show it."""
    made = np.zeros_like(inverse)
    for block in in_blocks(len(slopes)):
        own = slopes[block]
        leverage = np.einsum("ij,ij->i", own @ inverse, own)
        scores = own * (left[block] / (1 - np.minimum(leverage, LARGEST_LEVERAGE)))[:, None]
        made += scores.T @ scores
    return made


def interval(fit: Fit, certainty: Certainty, index: int) -> tuple[float, float]:
    """Return the 95 % interval of an amplitude in SI, within its bounds."""
    number, value = numbers_of(fit)[index], value_of(fit, index)
    reach = certainty.reach_of(index) * float(certainty.units[index])
    return max(value - reach, min(number.low, value)), min(value + reach, max(number.high, value))


def may_be_zero(fit: Fit, certainty: Certainty, cause: Candidate) -> bool:
    """Tell whether the 95 % interval of every amplitude of a cause contains zero."""
    own = places_of(fit, cause)
    ends = [interval(fit, certainty, own[index]) for index in cause.amplitudes]
    return all(low <= 0 <= high for low, high in ends)


def ends_of(fit: Fit, extended: Extended, certainty: Certainty, index: int) -> Ends:
    """Return the 95 % interval of any number, SI: of a whole one between those that are not excluded."""
    number = numbers_of(fit)[index]
    if number.whole:
        values = [value_of(each, index) for each in (fit, *whole_left(fit, extended, index))]
        return min(values), max(values)
    if number.along:
        return place_interval(fit, extended, index)
    return (amplitude_interval if number.is_amplitude else shape_interval)(fit, extended, certainty, index)


def shape_interval(fit: Fit, extended: Extended, certainty: Certainty, index: int) -> Ends:
    """Return the 95 % profile interval of a number in SI; an end is None where the profile stays open to its bound."""
    profile = _Profile(fit, extended, certainty, index)
    low, high = extended.side_by_side([partial(profile.end, bound) for bound in profile.bounds])
    return low, high


def amplitude_interval(fit: Fit, extended: Extended, certainty: Certainty, index: int) -> Ends:
    """Return the 95 % interval of an amplitude in SI, with its profile where its cause has a shape that is free.

    Where its cause has a whole number, it holds the intervals at every one that is not excluded.
    """
    (cause,) = (cause for cause in fit.causes if index in places_of(fit, cause))
    numbers, begin = [cause.numbers[shape] for shape in cause.shapes], places_of(fit, cause)[0]
    own = interval(fit, certainty, index)
    if any(number.is_free for number in numbers):
        low, high = shape_interval(fit, extended, certainty, index)
        return None if low is None else min(low, own[0]), None if high is None else max(high, own[1])
    whole = [begin + shape for shape in cause.shapes if cause.numbers[shape].whole]
    fits = (each for shape in whole for each in whole_left(fit, extended, shape))
    several = [own, *(interval(fit, certainty_of(fit, extended), index) for fit in fits)]
    return min(low for low, _ in several), max(high for _, high in several)


def whole_left(fit: Fit, extended: Extended, index: int) -> list[Fit]:
    """Return the fits at other whole numbers that the readings do not exclude."""
    number, own = numbers_of(fit)[index], round(value_of(fit, index))
    ends = max(number.low, own - MOST_WHOLE), min(number.high, own + MOST_WHOLE)
    others = [value for value in range(round(ends[0]), round(ends[1]) + 1) if value != own]
    fits = extended.side_by_side([partial(_kept_at, fit, extended, index, float(value)) for value in others])
    return [each for each in fits if each is not None and each.cost < fit.cost + WHOLE]


def _kept_at(near: Fit, extended: Extended, index: int, value: float) -> Fit | None:
    """Fit again from nearby with one number held at another value, SI."""
    flat = np.concatenate(near.values)
    flat[index] = value
    held = [numbers_of(near)[index]]
    values = parts_of(near.causes, flat)
    return alone(extended, fitting(near.sample, extended, near.causes, values, near, until=CLOSELY, held=held))


def place_interval(fit: Fit, extended: Extended, index: int) -> tuple[float, float]:
    """Return the rows of the record, SI, between which lies, at 95 %, a place at which something begins."""
    number, value = numbers_of(fit)[index], value_of(fit, index)
    covariate = fit.sample.machine.records.covariates.get(number.along)
    if covariate is None:
        return value, value
    rows = np.unique(covariate.values[np.isfinite(covariate.values)])
    own = int(np.searchsorted(rows, value))

    def holds(gap: int) -> bool:
        made = _kept_at(fit, extended, index, float(rows[gap - 1 : gap + 1].mean()))
        return made is not None and made.cost <= fit.cost + PLACE_LIMIT

    last = len(rows) - 1
    low = own - 1 - _farthest(lambda off: holds(own - off), own - 1)
    high = own + _farthest(lambda off: holds(own + off), last - own)
    return float(rows[max(low, 0)]), float(rows[min(high, last)])


def _farthest(holds: Callable[[int], bool], limit: int) -> int:
    """Return how far something holds, from 0 on, in doubled steps and then between."""
    near, far = 0, 1
    while far <= limit and holds(far):
        near, far = far, 2 * far
    far = min(far, limit + 1)
    while far - near > 1:
        middle = (near + far) // 2
        near, far = (middle, far) if holds(middle) else (near, middle)
    return near


class _Profile:
    """The least cost with one number held, everything else fitted again from the nearest point that is known."""

    def __init__(self, fit: Fit, extended: Extended, certainty: Certainty, index: int) -> None:
        self.extended, self.place, self.number = extended, index, numbers_of(fit)[index]
        self.unit = 1.0 if self.number.is_log else float(certainty.units[index])
        self.bounds = inward(self.number, self.unit)
        value = value_of(fit, index)
        self.start = log(value) if self.number.is_log else value / self.unit
        self.known = {self.start: _kept_at(fit, extended, index, self.outward(self.start)) or fit}
        student = float(stdtrit(certainty.freedom, QUANTILE))
        known = fit.sample.known
        self.allowed = known * log1p(student**2 * certainty.variance / known)
        self.reach = certainty.reach_of(index)

    def outward(self, u: float) -> float:
        """Return the number in SI."""
        return exp(u) if self.number.is_log else u * self.unit

    def above(self, u: float) -> float:
        """Return how far a place lies outside of the interval: by the root of what the cost rises, nearly a line."""
        if u not in self.known:
            nearest = self.known[min(self.known, key=lambda other: abs(other - u))]
            made = _kept_at(nearest, self.extended, self.place, self.outward(u))
            if made is None:
                return sqrt(HIGHEST * self.allowed)
            self.known[u] = made
        risen = self.known[u].cost - self.known[self.start].cost
        return sqrt(min(max(risen, 0.0), HIGHEST * self.allowed)) - sqrt(self.allowed)

    def end(self, bound: float) -> float | None:
        """Return where the interval ends on the way to a bound; None where it does not."""
        way = bound - self.start
        if not way:
            return None
        step, before = float(np.clip(self.reach / abs(way), SHORTEST, LONGEST)), 0.0
        while self.above(self.start + step * way) <= 0:
            if step >= 1.0:
                return None
            before, step = step, min(FARTHER * step, 1.0)
        at = brentq(lambda share: self.above(self.start + share * way), before, step, xtol=END_KNOWN * step)
        return self.outward(self.start + float(at) * way)
