"""Response curves: what every cause would draw on these rows, from the model itself, over a spread of all its numbers.

A cause that acts in proportion to its amplitudes is asked for one curve of each; one that bends, for curves at sizes
from a thousandth of its bounds up to them. A shape with one number is swept as finely as its own curves change on
this record; with several, a Sobol sequence covers them. Curves are compared with what an explanation leaves once
the inputs and its own numbers have taken their part, and the best points are where exact fits begin.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter, UnregisteredShape
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit

LEVELS = (1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001)
"""Shares of its bound at which an amplitude that bends is asked for."""
FIRST, FINEST = 9, 3000
"""Points of a sweep to begin with, and at most."""
NEXT_TO = 0.7
"""Neighbours of a sweep with a smaller cosine have another curve between them."""
SPREAD = 64
"""Points over several numbers at once."""
WAVES_PER_POINT = 0.25
"""Step of a frequency, in what one wave more over the record is: its curves are known to change by then."""
PLACES = 120
"""Places of a record at which something may begin."""
STRAIGHT = 1e-4
"""Share of its size by which chords of a cause may differ while it counts as proportional."""
VALUES_KEPT = 8_000_000
"""Bundles of more values are made anew each time, and compared in single precision."""
LARGE = 1_000_000
"""Shapes that nobody registered, with more values than that in their curves, have them in a table."""
ROOM = 5_000_000
"""A bundle has no more values: a cause is looked at in fewer points on a long record, two per level at least."""


def evenly(dimensions: int, count: int) -> Matrix:
    """Return points (count, dimensions) that fill the unit cube evenly, every first part of them as well.

    Multiples of powers of the root of x^(d+1) = x + 1, less their whole parts: a Kronecker sequence (H. Niederreiter,
    Random number generation and quasi-Monte Carlo methods, SIAM 1992, chapter 3).
    """
    root = np.roots([1, *[0] * (dimensions - 1), -1, -1]).real.max()
    return np.asarray((0.5 + np.arange(count)[:, None] * root ** -np.arange(1.0, dimensions + 1)) % 1.0)


def middle(number: Parameter) -> float:
    """Return a number that is not looked at: no amplitude, the middle of a shape's range."""
    if number.is_amplitude:
        return 0.0
    if number.whole:
        return float(round((number.low + number.high) / 2))
    return float((number.low * number.high) ** 0.5) if number.is_log else (number.low + number.high) / 2


def _from_unit(number: Parameter, u: Matrix) -> Matrix:
    """Return values of a shape number for places from 0 to 1 in its range."""
    if number.whole:
        return np.minimum(np.floor(number.low + u * (number.high - number.low + 1)), number.high)
    if number.is_log and not is_known(number) and number.high / number.low > 10:
        return np.asarray(number.low * (number.high / number.low) ** u)
    return np.asarray(number.low + u * (number.high - number.low))


def placed(shapes: Sequence[Parameter], u: Matrix) -> Matrix:
    """Return the values of shape numbers (M, numbers) for places from 0 to 1 in their ranges."""
    return np.column_stack([_from_unit(number, u[:, index]) for index, number in enumerate(shapes)]) if shapes else u


def first_places(number: Parameter) -> Matrix:
    """Return where a sweep begins: every whole number, a frequency in steps that its curves are known to need."""
    if number.whole:
        count = int(number.high - number.low) + 1
        return np.asarray((np.arange(min(count, FINEST)) + 0.5) / count)
    if number.along:
        return np.linspace(0, 1, PLACES)
    if number.name == "frequency":
        waves = number.high / number.low
        return np.linspace(0, 1, int(min(FINEST, max(FIRST, waves / WAVES_PER_POINT))))
    return np.linspace(0, 1, FIRST)


def places_over(shapes: Sequence[Parameter], most: int = FINEST) -> Matrix:
    """Return where curves over some shape numbers are asked for first, (M, numbers), from 0 to 1 in their ranges."""
    if len(shapes) > 1:
        return thinned(evenly(len(shapes), SPREAD), most)
    return thinned(first_places(shapes[0])[:, None], most) if shapes else np.zeros((1, 0))


def is_known(number: Parameter) -> bool:
    """Whether a sweep begins as finely as its curves change."""
    return number.whole or bool(number.along) or number.name == "frequency"


def thinned(points: Matrix, most: int) -> Matrix:
    """Return some points, at most so many, evenly from all."""
    if len(points) <= most:
        return points
    return np.asarray(points[np.linspace(0, len(points) - 1, most).round().astype(np.intp)])


def refined(
    shapes: Sequence[Parameter], u: Matrix, curves: Matrix, make: Callable[[Matrix], Matrix], most: int = FINEST
) -> tuple[Matrix, Matrix]:
    """Put points between neighbours that are no longer alike, until all are or there are enough."""
    while len(u) < most:
        flat = np.nan_to_num(curves.reshape(len(curves), -1))
        size = np.linalg.norm(flat, axis=1)
        cosine = np.abs(np.einsum("ij,ij->i", flat[1:], flat[:-1])) / np.maximum(size[1:] * size[:-1], 1e-300)
        gaps = np.flatnonzero((cosine < NEXT_TO) & (np.diff(u[:, 0]) > 1e-5) & (np.minimum(size[1:], size[:-1]) > 0))
        if not len(gaps):
            break
        new = (u[gaps] + u[gaps + 1])[: most - len(u)] / 2
        order = np.argsort(np.concatenate([u, new])[:, 0], kind="stable")
        curves = np.concatenate([curves, make(placed(shapes, new))])[order]
        u = np.concatenate([u, new])[order]
    return u, curves


def spread(cause: Candidate, count: int, most: int = FINEST) -> Matrix:
    """Return points over amplitudes of many sizes, to both sides, and over all shapes; so many over several numbers.

    There are at most so many, evenly from all.
    """
    shapes = [cause.numbers[index] for index in cause.shapes]
    points = []
    if len(cause.amplitudes) == 1 and len(shapes) <= 1:
        (index,), places = cause.amplitudes, places_over(shapes)
        ends = filter(None, (cause.numbers[index].low, cause.numbers[index].high))
        for end, level, values in product(ends, LEVELS, placed(shapes, places[:: max(1, len(places) // FIRST)])):
            point = np.zeros(cause.size)
            point[cause.shapes], point[index] = values, level * end
            points.append(point)
        return thinned(np.array(points), most)
    for u in evenly(cause.size + 1, count):
        point = np.zeros(cause.size)
        point[cause.shapes] = placed(shapes, u[None, : len(shapes)])[0]
        level = 10 ** (-3 * u[-1])
        for v, index in zip(u[len(shapes) :], cause.amplitudes, strict=False):
            number = cause.numbers[index]
            side = number.high if (v >= 0.5 or not number.low) and number.high else number.low
            share = abs(2 * v - 1) if number.low and number.high else v
            point[index] = level * side * (0.05 + 0.95 * share)
        points.append(point)
    return thinned(np.array(points), most)


@dataclass(frozen=True, eq=False)
class TermTable:
    """Terms of a shape at many points, on all rows of the records, (M, c, n)."""

    terms: NDArray[np.float32]


@dataclass(frozen=True)
class Bundle:
    """Curves of one cause: ``points`` (M, numbers) SI, and ``curves`` (M, q, readings) by columns, SI per coefficient.

    Of a bundle in proportion, column j is the change per unit of amplitude j and coefficients are amplitudes; else
    there is one column, the change itself, and its coefficient is near 1. At ``lost`` points more the model fails.
    The curves of a shape on a long record are in a ``table`` instead.
    """

    cause: Candidate
    points: Matrix
    curves: Matrix
    is_straight: bool
    lost: int = 0
    table: TermTable | None = None


class ResponseCurves:
    """The curves of all causes of a machine, asked for once beside nothing and anew where causes act on the inputs."""

    def __init__(self, extended: Extended) -> None:
        self.extended = extended
        self.lost: dict[str, tuple[int, int]] = {}
        """By effect: at how many points the model fails with it, of how many that were tried where it fails at all."""
        self._alone: dict[str, Bundle] = {}
        self._straight: dict[str, bool] = {}
        self._tables: dict[tuple[str, ...], TermTable] = {}

    def of(self, cause: Candidate, conditional: Fit) -> Bundle:
        """Return the curves of a cause beside an explanation; those beside nothing where that makes no difference.

        So they are too where the budget of calls has ended.
        """
        if self._matters(cause, conditional):
            return self._made(cause, _Place(self.extended, conditional, conditional.causes))
        if cause.tag in self._alone:
            return self._alone[cause.tag]
        bundle = self._first(cause, _Place(self.extended, conditional, ()))
        if bundle.curves.size <= VALUES_KEPT:
            self._alone[cause.tag] = bundle
        return bundle

    def _matters(self, cause: Candidate, conditional: Fit) -> bool:
        """Whether an effect may draw something else beside an explanation than alone."""
        on = [each for each in conditional.causes if each.effect is not None]
        acts = cause.effect is not None and bool(on) and any(each.acts_on_inputs for each in (cause, *on))
        return acts and self.extended.lasts

    def _first(self, cause: Candidate, beside: _Place) -> Bundle:
        """Return the curves of a cause beside nothing; none where the budget of calls does not last for them."""
        if self.extended.lasts or not self.extended.costs(cause):
            bundle = self._made(cause, beside)
            if bundle.lost:
                lost, tried = self.lost.get(cause.name, (0, 0))
                self.lost[cause.name] = lost + bundle.lost, tried + bundle.lost + len(bundle.points)
            return bundle
        self.extended.budget.unseen.append(cause.name)
        return Bundle(cause, np.zeros((0, cause.size)), np.zeros((0, 1, beside.readings)), is_straight=False)

    def _made(self, cause: Candidate, beside: _Place) -> Bundle:
        if cause.shape is not None:
            return self._of_shape(cause, cause.shape, beside)
        if cause.tolerated >= 0:
            slopes = [each[:, cause.tolerated] for each in self.extended.machine.slopes.values()]
            return Bundle(cause, np.zeros((1, 1)), np.concatenate(slopes)[None, None, :], is_straight=True)
        if cause.tag not in self._straight:
            self._straight[cause.tag] = beside.is_straight(cause)
        if self._straight[cause.tag]:
            return _swept(cause, lambda values: beside.slopes(cause, values), most=beside.most(cause))
        return beside.bent(cause)

    def _of_shape(self, cause: Candidate, shape: UnregisteredShape, beside: _Place) -> Bundle:
        """Return the curves of a shape; of one with many, on a long record, a table that all results share."""
        records = self.extended.machine.records
        shapes = [cause.numbers[number] for number in cause.shapes]
        u = places_over(shapes) if len(shapes) == 1 and is_known(shapes[0]) else np.zeros((0, 1))

        def terms(values: Matrix) -> list[list[Matrix]]:
            return [[term.values for term in shape.terms(each.tolist(), records.covariates)] for each in values]

        if len(u) * len(cause.amplitudes) * beside.readings <= LARGE:
            acts = np.array([[float(each == name) for each in records.measured] for name in shape.results])
            several = len(cause.amplitudes), beside.readings
            return _swept(cause, lambda v: np.einsum("rs,mtn->mrtsn", acts, terms(v)).reshape(-1, *several))
        family = shape.kind, *shape.depends_on
        values = placed(shapes, u)
        if family not in self._tables:
            self._tables[family] = TermTable(np.array(terms(values), dtype=np.float32))
        curves = np.zeros((0, len(cause.amplitudes), beside.readings))
        return Bundle(cause, _points(cause, values), curves, is_straight=True, table=self._tables[family])


class _Place:
    """An explanation beside which curves are asked for."""

    def __init__(self, extended: Extended, conditional: Fit, causes: tuple[Candidate, ...]) -> None:
        self.extended, self.causes, self.machine = extended, causes, extended.machine
        self.values = [conditional.of(cause) for cause in causes]
        self.moved = conditional.moved if causes else np.zeros_like(conditional.moved)
        self._base: Matrix | None = None
        """What the gauges show with the explanation alone, (1, readings), SI."""

    def _stacked(self, causes: tuple[Candidate, ...], points: Sequence[Sequence[Matrix]]) -> Matrix:
        """Return what the gauges show with some causes on at several points, (points, readings), SI."""
        made = self.extended.at(causes, [(values, self.moved) for values in points])
        return np.array([np.concatenate([each[name] for name in self.machine.records.measured]) for each in made])

    def changes(self, cause: Candidate, points: Matrix) -> Matrix:
        """Return what a cause changes at some points (M, numbers), (M, readings)."""
        if self._base is None:  # asked for first: what was shown last is where a fit goes on
            self._base = self._stacked(self.causes, [self.values])
        base = self._base
        return np.asarray(self._stacked((*self.causes, cause), [[*self.values, point] for point in points]) - base)

    @property
    def readings(self) -> int:
        """How many values a curve has."""
        return len(self.machine.records.measured) * len(self.machine.records)

    def most(self, cause: Candidate) -> int:
        """Return at how many points memory and the budget of calls allow to look at a cause."""
        room = max(2 * len(LEVELS), min(FINEST, ROOM // max(self.readings, 1)))
        points = self.extended.budget.points if self.extended.costs(cause) else None
        return room if points is None else min(points, room)

    def is_straight(self, cause: Candidate) -> bool:
        """Whether a cause is proportional to its amplitudes, and several of them do no more than their sum."""
        still = np.array([middle(number) for number in cause.numbers])
        ends, together = cause.amplitudes, still.copy()
        together[ends] = 0.5 * _largest(cause)
        points = [
            np.where(np.arange(cause.size) == index, side * share, still)
            for index in ends
            for side in filter(None, (cause.numbers[index].low, cause.numbers[index].high))
            for share in (1.0, 0.1, LEVELS[-1])
        ]
        changes = self.changes(cause, np.array([*points, together]))
        if not (np.isfinite(changes) | np.isnan(changes).all(axis=0)).all():
            return False
        rows, curves = len(self.machine.records), np.nan_to_num(changes)
        grain = np.repeat([4 * self.extended.grain.get(name, 0.0) for name in self.machine.records.measured], rows)
        slopes = {index: np.zeros(curves.shape[1]) for index in ends}
        for point, curve in zip(points, curves, strict=False):
            (moved,) = (each for each in ends if point[each])
            slope, largest = curve / point[moved], np.abs(curve).max() / abs(point[moved])
            if not slopes[moved].any():
                slopes[moved] = slope
            elif np.any(
                np.abs(slope - slopes[moved])
                > STRAIGHT * max(largest, np.abs(slopes[moved]).max()) + grain / abs(point[moved])
            ):
                return False
        summed = sum((slopes[index] * together[index] for index in ends), np.zeros(curves.shape[1]))
        few = STRAIGHT * max(float(np.abs(summed).max()), 1e-300) * len(ends)
        return bool(np.all(np.abs(curves[-1] - summed) <= few + 2 * len(ends) * grain))

    def slopes(self, cause: Candidate, shapes: Matrix) -> Matrix:
        """Return the change per unit of every amplitude at some shapes (M, shape numbers), (M, q, readings)."""
        sizes = _largest(cause)
        points = np.repeat(_points(cause, shapes)[:, None], len(sizes), axis=1)
        points[:, range(len(sizes)), cause.amplitudes] = sizes
        made = self.changes(cause, points.reshape(-1, cause.size)).reshape(len(shapes), len(sizes), -1)
        return np.asarray(made / sizes[:, None])

    def bent(self, cause: Candidate) -> Bundle:
        """Return the curves of a cause that bends, at amplitudes of many sizes and at shapes all over."""
        points = spread(cause, SPREAD if self.causes else 4 * SPREAD, self.most(cause))
        return _bundle(cause, points, self.changes(cause, points)[:, None, :], is_straight=False)


def _largest(cause: Candidate) -> Matrix:
    """Return the bound of every amplitude that is farther from zero, SI."""
    return np.array([max((cause.numbers[index].low, cause.numbers[index].high), key=abs) for index in cause.amplitudes])


def _points(cause: Candidate, values: Matrix) -> Matrix:
    """Return points (M, numbers) with shape numbers of these values and no amplitude."""
    points = np.zeros((len(values), cause.size))
    points[:, cause.shapes] = values
    return points


def _bundle(cause: Candidate, points: Matrix, made: Matrix, *, is_straight: bool) -> Bundle:
    """Return curves (M, q, readings) at the points at which the model shows every reading that it shows at any.

    Where it fails whatever the point they are 0; there is no copy without need.
    """
    flat = made.reshape(len(made), -1)
    finite = np.isfinite(flat)
    works = (finite | np.isnan(flat).all(axis=0)).all(axis=1) & finite.any(axis=1)
    kept = np.nan_to_num(made if works.all() else made[works], copy=False)
    return Bundle(cause, points[works], kept, is_straight, int((~works).sum()))


def _swept(cause: Candidate, make: Callable[[Matrix], Matrix], most: int = FINEST) -> Bundle:
    """Return curves over all shapes of a cause; along one number as finely as they change."""
    shapes = [cause.numbers[index] for index in cause.shapes]
    u = places_over(shapes, most)
    values = placed(shapes, u)
    made = make(values)
    if len(shapes) == 1 and not is_known(shapes[0]):
        u, made = refined(shapes, u, made, make, most)
        values = placed(shapes, u)
    return _bundle(cause, _points(cause, values), made, is_straight=True)
