"""Response curves: what every cause would draw on these rows, from the model itself, over a spread of all its numbers.

A cause that acts in proportion to its amplitudes is asked for one curve of each; one that bends, for curves at sizes
from a thousandth of its bounds up to them. A shape with one number is swept as finely as its own curves change on
this record; with several, a Sobol sequence covers them. Curves are compared with what an explanation leaves once
the inputs and its own numbers have taken their part, and the best points are where exact fits begin.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, UnregisteredShape
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.points import FINEST, LEVELS, SPREAD, is_known, middle, placed, places_over, refined, spread
from truing.diagnosis.sweeps import TermTable

STRAIGHT = 1e-4
"""Share of its size by which chords of a cause may differ while it counts as proportional."""
VALUES_KEPT = 8_000_000
"""Bundles of more values are made anew each time, and compared in single precision."""
LARGE = 1_000_000
"""Shapes that nobody registered, with more values than that in their curves, have them in a table."""
ROOM = 5_000_000
"""A bundle has no more values: a cause is looked at in fewer points on a long record, two per level at least."""


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

    def _stacked(self, causes: tuple[Candidate, ...], points: Sequence[Sequence[Matrix]]) -> Matrix:
        """Return what the gauges show with some causes on at several points, (points, readings), SI."""
        made = self.extended.at(causes, [(values, self.moved) for values in points])
        return np.array([np.concatenate([each[name] for name in self.machine.records.measured]) for each in made])

    @cached_property
    def _base(self) -> Matrix:
        """What the gauges show with the explanation alone, (1, readings), SI."""
        return self._stacked(self.causes, [self.values])

    def changes(self, cause: Candidate, points: Matrix) -> Matrix:
        """Return what a cause changes at some points (M, numbers), (M, readings)."""
        base = self._base  # asked for first: what was shown last is where a fit goes on
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
