"""Points over the numbers of a cause at which curves are asked for: sweeps as fine as curves change, and spreads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter

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
