"""Response curves: what every cause would draw on these rows, from the model itself, over a spread of all its numbers.

A cause that acts in proportion to its amplitudes is asked for one curve of each; one that bends, for curves at sizes
from a thousandth of its bounds up to them. A shape with one number is swept as finely as its own curves change on
this record; with several, a Sobol sequence covers them. Curves are compared with what an explanation leaves once
the inputs and its own numbers have taken their part, and the best points are where exact fits begin.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import qmc

from truing.diagnosis.causes import Cause
from truing.diagnosis.exact import slopes_at
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.points import LEVELS, SPREAD, first_places, middle, placed, refined, spread

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

KEPT = 3
"""So many points of a cause begin exact fits."""
STRAIGHT = 1e-4
"""Share of its size by which chords of a cause may differ while it counts as proportional."""
NEAR_LEVEL = 2.0
"""A curve that bends stands for amplitudes up to so many times its own, and down to one over it."""
FAINT = 1e-9
OWN = 0.03
"""Share of a curve that must be left beside an explanation for it to count as one more that was tried."""


@dataclass(frozen=True)
class Bundle:
    """Curves of one cause: ``points`` (M, numbers) SI, and ``curves`` (M, q, readings) by columns, SI per coefficient.

    Of a bundle in proportion, column j is the change per unit of amplitude j and coefficients are amplitudes; else
    there is one column, the change itself, and its coefficient is near 1.
    """

    cause: Cause
    points: Matrix
    curves: Matrix
    is_straight: bool


@dataclass(frozen=True)
class Looked:
    """What a cause could draw beside an explanation: gains in score with the numbers to begin with, the best first.

    ``tries`` counts its independent curves; ``basis`` (M, q, rows + K) is orthonormal within a point.
    """

    starts: tuple[tuple[float, Matrix], ...]
    tries: float
    basis: Matrix


class Curves:
    """The curves of all causes of a machine, asked for once beside nothing and anew where causes act on the inputs."""

    def __init__(self, extended: Extended) -> None:
        self.extended = extended
        self._alone: dict[str, Bundle] = {}
        self._straight: dict[str, bool] = {}

    def of(self, cause: Cause, beside: Fit) -> Bundle:
        """Return the curves of a cause beside an explanation; those beside nothing where that makes no difference."""
        if cause.shape is not None or cause.tolerated >= 0 or not self._matters(cause, beside):
            if cause.tag not in self._alone:
                self._alone[cause.tag] = self._made(cause, _Place(self.extended, beside, ()))
            return self._alone[cause.tag]
        return self._made(cause, _Place(self.extended, beside, beside.causes))

    @staticmethod
    def _matters(cause: Cause, beside: Fit) -> bool:
        """Whether a cause may draw something else beside an explanation than alone."""
        on = [each for each in beside.causes if each.effect is not None]
        return bool(on) and (cause.acts_on_inputs or any(each.acts_on_inputs for each in on))

    def _made(self, cause: Cause, place: _Place) -> Bundle:
        if cause.shape is not None:
            return _swept(cause, lambda values: place.of_shape(cause, values), is_straight=True)
        if cause.tolerated >= 0:
            return place.of_input(cause)
        if cause.tag not in self._straight:
            self._straight[cause.tag] = place.is_straight(cause)
        if self._straight[cause.tag]:
            return _swept(cause, lambda values: place.slopes(cause, values), is_straight=True)
        return place.bent(cause)


class _Place:
    """An explanation beside which curves are asked for."""

    def __init__(self, extended: Extended, beside: Fit, causes: tuple[Cause, ...]) -> None:
        self.extended, self.causes, self.machine = extended, causes, extended.machine
        self.values = [beside.of(cause) for cause in causes]
        self.moved = beside.moved if causes else np.zeros_like(beside.moved)
        self.base = self._stacked([])[0] if causes else None

    def _stacked(self, added: Sequence[tuple[Cause, Matrix]]) -> Matrix:
        """Return what the gauges show with each of some causes on beside the others, (points, readings), SI."""
        if not added:
            made = self.extended.at(self.causes, [(self.values, self.moved)])
        else:
            own = (*self.causes, added[0][0])
            made = self.extended.at(own, [([*self.values, values], self.moved) for _, values in added])
        return np.array([np.concatenate([each[name] for name in self.machine.records.measured]) for each in made])

    def changes(self, cause: Cause, points: Matrix) -> Matrix:
        """Return what a cause changes at some points (M, numbers), (M, readings)."""
        if self.base is None:
            self.base = self._stacked([])[0]
        return np.asarray(self._stacked([(cause, point) for point in points]) - self.base)

    def is_straight(self, cause: Cause) -> bool:
        """Whether a cause is proportional to its amplitudes, and several of them do no more than their sum."""
        still = np.array([middle(number) for number in cause.numbers])
        ends = list(cause.amplitudes)
        points, shares = [], (1.0, 0.1, LEVELS[-1])
        for place in ends:
            for side in (cause.numbers[place].low, cause.numbers[place].high):
                for share in shares if side else ():
                    point = still.copy()
                    point[place] = side * share
                    points.append(point)
        together = still.copy()
        together[ends] = [0.5 * max((n.low, n.high), key=abs) for n in (cause.numbers[place] for place in ends)]
        made = self.changes(cause, np.array([*points, together]))
        if not np.isfinite(_known(made)).all():
            return False
        made = np.nan_to_num(made)
        slopes = {place: np.zeros(made.shape[1]) for place in ends}
        for point, curve in zip(points, made, strict=False):
            (place,) = (each for each in ends if point[each])
            slope, largest = curve / point[place], np.abs(curve).max() / abs(point[place])
            if not slopes[place].any():
                slopes[place] = slope
            elif np.abs(slope - slopes[place]).max() > STRAIGHT * max(largest, np.abs(slopes[place]).max()):
                return False
        summed = sum((slopes[place] * together[place] for place in ends), np.zeros(made.shape[1]))
        return bool(np.abs(made[-1] - summed).max() <= STRAIGHT * max(float(np.abs(summed).max()), 1e-300) * len(ends))

    def slopes(self, cause: Cause, shapes: Matrix) -> Matrix:
        """Return the change per unit of every amplitude at some shapes (M, shape numbers), (M, q, readings)."""
        sizes = [max((n.low, n.high), key=abs) for n in (cause.numbers[place] for place in cause.amplitudes)]
        points = np.zeros((len(shapes), len(sizes), cause.size))
        points[:, :, cause.shapes] = shapes[:, None]
        for column, (place, size) in enumerate(zip(cause.amplitudes, sizes, strict=True)):
            points[:, column, place] = size
        made = self.changes(cause, points.reshape(-1, cause.size)).reshape(len(shapes), len(sizes), -1)
        return np.asarray(made / np.array(sizes)[None, :, None])

    def bent(self, cause: Cause) -> Bundle:
        """Return the curves of a cause that bends, at amplitudes of many sizes and at shapes all over."""
        points = spread(cause, SPREAD if self.causes else 4 * SPREAD)
        made = self.changes(cause, points)
        works = np.isfinite(_known(made)).all(axis=1)
        return Bundle(cause, points[works], np.nan_to_num(made[works])[:, None, :], is_straight=False)

    def of_shape(self, cause: Cause, shapes: Matrix) -> Matrix:
        """Return the terms of a shape that nobody registered, result after result, (M, q, readings)."""
        measured, rows = list(self.machine.records.measured), len(self.machine.records)
        made = np.zeros((len(shapes), len(cause.amplitudes), len(measured) * rows))
        shape = cause.shape
        for point, values in enumerate(shapes if shape is not None else ()):
            terms = shape.terms(values.tolist(), self.machine.records.covariates) if shape is not None else []
            column = 0
            for name in shape.results if shape is not None else ():
                begin = measured.index(name) * rows
                for term in terms:
                    made[point, column, begin : begin + rows] = term.values
                    column += 1
        return made

    def of_input(self, cause: Cause) -> Bundle:
        """Return the slope of an input, per standard deviation."""
        slopes = [self.machine.slopes[name][:, cause.tolerated] for name in self.machine.records.measured]
        return Bundle(cause, np.zeros((1, 1)), np.concatenate(slopes)[None, None, :], is_straight=True)


def _known(made: Matrix) -> Matrix:
    """Return changes with those readings as 0 in which the model fails whatever the point."""
    return np.where(np.isnan(made).all(axis=0), 0.0, made)


def _swept(cause: Cause, make: Callable[[Matrix], Matrix], *, is_straight: bool) -> Bundle:
    """Return curves over all shapes of a cause; along one number as finely as they change."""
    shapes = [cause.numbers[place] for place in cause.shapes]
    if not shapes:
        u = np.zeros((1, 0))
    elif len(shapes) == 1:
        u = first_places(shapes[0])[:, None]
    else:
        u = qmc.Sobol(len(shapes), seed=1).random(SPREAD)
    values = placed(shapes, u)
    made = make(values)
    if len(shapes) == 1 and not shapes[0].whole and not shapes[0].along:
        u, made = refined(shapes, u, made, make)
        values = placed(shapes, u)
    works = np.isfinite(_known(made.reshape(len(made), -1))).all(axis=1)
    points = np.zeros((len(values), cause.size))
    points[:, cause.shapes] = values
    return Bundle(cause, points[works], np.nan_to_num(made[works]), is_straight)


@dataclass(frozen=True)
class Beside:
    """What an explanation leaves, weighted (rows + K,), once its numbers and the inputs have taken their part.

    ``taken`` (rows + K, t) is an orthonormal basis of what they can draw; ``index`` and ``factor`` turn readings of all
    records into weighted rows of the sample.
    """

    left: Matrix
    taken: Matrix
    index: NDArray[np.intp]
    factor: Matrix
    total: float

    def weighed(self, curves: Matrix) -> Matrix:
        """Return curves (..., readings, SI) as what only they can draw, (..., rows + K)."""
        rows = curves[..., self.index] * self.factor
        k = len(self.left) - len(self.index)
        made = np.concatenate([rows, np.zeros((*rows.shape[:-1], k))], axis=-1)
        return np.asarray(made - (rows @ self.taken[: len(self.index)]) @ self.taken.T)


def beside_of(found: Fit, extended: Extended) -> Beside:
    """Return an explanation as other causes see it."""
    sample, k = found.sample, len(found.inputs)
    roots = sample.roots(found.left)
    if found.causes:
        own, inputs = slopes_at(found, extended)
    else:
        own, inputs = np.zeros((sample.rows, 0)), sample.drawn
    columns = np.concatenate(
        [np.column_stack([own, inputs]) * roots[:, None], np.column_stack([np.zeros((k, own.shape[1])), np.eye(k)])]
    )
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    taken = basis[:, size > 1e-9 * size.max()] if size.size else basis
    left = np.concatenate([roots * found.left, -found.inputs])
    left = left - taken @ (taken.T @ left)
    names, rows = list(sample.machine.records.measured), len(sample.machine.records)
    index = np.concatenate([names.index(channel.name) * rows + channel.rows for channel in sample.channels])
    factor = np.concatenate([channel.weights / channel.scale for channel in sample.channels]) * roots
    return Beside(left, np.asarray(taken), index, factor, sample.total)


def looked(bundle: Bundle, beside: Beside) -> Looked | None:
    """Compare the curves of a cause with what an explanation leaves; None where it draws nothing here."""
    weighed = beside.weighed(bundle.curves)
    raw = np.linalg.norm(bundle.curves[..., beside.index] * beside.factor, axis=-1)
    size = np.linalg.norm(weighed, axis=-1)
    kept = ((size > 1e-6 * raw) & (raw > FAINT)).any(axis=1)
    if not kept.any():
        return None
    is_own = (size > OWN * raw).any(axis=1)[kept]
    weighed, points = weighed[kept], bundle.points[kept]
    basis = _orthonormal(weighed)
    gains, values = _starts(bundle, points, weighed, beside)
    order = np.argsort(-gains, kind="stable")
    chosen: list[int] = []
    for place in order[:200].tolist():
        if gains[place] > 0 and not any(_is_same(basis[place], basis[other]) for other in chosen):
            chosen.append(place)
        if len(chosen) == KEPT:
            break
    starts = tuple((_score(float(gains[place]), beside.total), values[place]) for place in chosen)
    return Looked(
        starts, independent(basis[is_own], is_sweep=bundle.is_straight and len(bundle.cause.shapes) <= 1), basis
    )


def _score(gain: float, total: float) -> float:
    """Return what a fall of the sum of squares is worth where the noise is the one that is left."""
    return -total * log(max(1 - gain / max(total, 1e-300), 1e-9))


def _is_same(one: Matrix, other: Matrix) -> bool:
    """Whether two sets of columns draw nearly the same."""
    return bool(np.linalg.norm(one @ other.T) ** 2 > 0.98 * min(len(one), len(other)))


def _orthonormal(weighed: Matrix) -> Matrix:
    """Return columns (M, q, rows) orthonormal within each point; 0 for those that depend on others."""
    made = np.array(weighed)
    size = np.linalg.norm(weighed, axis=-1)
    for column in range(made.shape[1]):
        for _ in range(2):
            for before in range(column):
                inner = np.einsum("mn,mn->m", made[:, before], made[:, column])
                made[:, column] -= inner[:, None] * made[:, before]
        left = np.linalg.norm(made[:, column], axis=-1)
        is_own = left > 1e-6 * np.maximum(size[:, column], 1e-300)
        made[:, column] *= np.where(is_own, 1 / np.maximum(left, 1e-300), 0.0)[:, None]
    return made


def _starts(bundle: Bundle, points: Matrix, weighed: Matrix, beside: Beside) -> tuple[Matrix, Matrix]:
    """Return what each point lowers the sum of squares by within the bounds of the cause, and the numbers there."""
    right = weighed @ beside.left
    normal = np.einsum("mqn,mpn->mqp", weighed, weighed)
    diagonal = np.einsum("mqq->mq", normal)
    scale = np.sqrt(np.maximum(diagonal, 1e-300))
    scaled = normal / (scale[:, :, None] * scale[:, None, :]) + 1e-9 * np.eye(normal.shape[1])
    solved = np.linalg.solve(scaled, (right / scale)[..., None])[..., 0] / scale
    values = np.array(points)
    if bundle.is_straight:
        numbers = [bundle.cause.numbers[place] for place in bundle.cause.amplitudes]
        solved = np.clip(solved, [number.low for number in numbers], [number.high for number in numbers])
        values[:, bundle.cause.amplitudes] = solved
    else:
        solved = np.clip(solved, 1 / NEAR_LEVEL, NEAR_LEVEL)
        for place in bundle.cause.amplitudes:
            number = bundle.cause.numbers[place]
            values[:, place] = np.clip(points[:, place] * solved[:, 0], number.low, number.high)
    gains = 2 * np.einsum("mq,mq->m", solved, right) - np.einsum("mq,mqp,mp->m", solved, normal, solved)
    return gains, values


def independent(basis: Matrix, *, is_sweep: bool) -> float:
    """Return how many independent curves a set of points draws: the way along a sweep, else the rank that counts."""
    if len(basis) < 2:
        return 1.0
    q = max(int((np.linalg.norm(basis, axis=-1) > 0.5).sum(axis=1).max()), 1)
    if is_sweep:
        inner = np.einsum("mqn,mpn->mqp", basis[1:], basis[:-1])
        same = np.clip((inner**2).sum(axis=(1, 2)) / q, 0, 1)
        return float(1 + np.sqrt(1 - same).sum() / 2)
    flat = basis.reshape(-1, basis.shape[-1])
    gram = flat @ flat.T
    return float(np.trace(gram) ** 2 / max(float((gram**2).sum()), 1e-300) / q)


def look(curves: Curves, at: Fit, causes: Sequence[Cause]) -> Mapping[str, Looked]:
    """Compare all causes with what an explanation leaves, by their tag."""
    beside = beside_of(at, curves.extended)
    on = at.key
    every = ((cause.tag, looked(curves.of(cause, at), beside)) for cause in causes if cause.tag not in on)
    return {tag: each for tag, each in every if each is not None}
