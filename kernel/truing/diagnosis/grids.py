"""The shapes of a cause that are tried: a grid that is as fine as the curves that it makes are different."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING

from truing.declare.sources import Unknown
from truing.diagnosis.candidates import (
    LONG,
    Candidate,
    Term,
    TermColumn,
    made_term,
    si_bounds,
    stacked,
    stands_still,
    variants_of,
)
from truing.diagnosis.machine import Machine

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

GRID = 9
WIDEST_ANGLE = 0.97
DENSEST = 17
PLACES = 100
BESIDE_STEP = 5
"""So many rows must lie on either side of a step."""
NARROWEST = 0.07
"""Angle between neighbouring curves of a grid, in radians."""


def terms_of(place: int, candidate: Candidate, machine: Machine, scales: Mapping[str, float]) -> list[Term]:
    """Return the variants of a candidate that the data excites; none where it excites nothing.

    ``scales`` holds the size of the noise by result. A candidate whose every condition stood still is not excited.
    """
    if stands_still(candidate, machine):
        return []
    found: list[Term] = []
    for shape in shapes_of(candidate, machine):
        found += variants_of(place, candidate, machine, shape, scales)
    if len(candidate.shapes) == 2 and len(machine.records) <= LONG:
        return _refined_in_turn(found, candidate, machine, scales)
    return _refined(found, candidate, machine, scales)


def grid_of(unknown: Unknown, machine: Machine, count: int = GRID) -> list[float]:
    """Return the values of a shape that are tried: whole numbers, places of the record, or a grid inside its bounds."""
    import numpy as np

    low, high = si_bounds(unknown)
    if unknown.whole:
        return [float(value) for value in range(round(low), round(high) + 1)]
    if unknown.along:
        return _places(machine.records.rows.placed(unknown.along))
    if low > 0:
        return [float(value) for value in np.geomspace(low, high, count)]
    return [float(value) for value in np.linspace(low, high, count)]


def _places(along: NDArray[np.float64] | None) -> list[float]:
    """Return places of a step with rows enough on both sides: what stands off at an end of a record is an outlier."""
    import numpy as np

    if along is None:
        return []
    values = np.sort(along[np.isfinite(along)])
    if len(values) < 2 * BESIDE_STEP:
        return []
    first = max(0.01 * (len(values) - 1), BESIDE_STEP)
    last = min(0.99 * (len(values) - 1), len(values) - BESIDE_STEP)
    places = np.unique(values[np.linspace(first, last, PLACES).astype(int)])
    before = np.searchsorted(values, places)
    enough = (before >= BESIDE_STEP) & (len(values) - before >= BESIDE_STEP)
    return [float(place) for place in places[enough]]


def shapes_of(candidate: Candidate, machine: Machine) -> Iterator[dict[str, float]]:
    """Return every combination of shape values that is tried."""
    count = GRID if len(candidate.shapes) < 2 else 5
    grids = [grid_of(unknown, machine, count) for unknown in candidate.shapes]
    for values in product(*grids):
        yield dict(zip((unknown.name for unknown in candidate.shapes), values, strict=True))


def _refined(terms: list[Term], candidate: Candidate, machine: Machine, scales: Mapping[str, float]) -> list[Term]:
    """Put further values between neighbours of a grid of one shape whose curves differ too much."""
    if len(candidate.shapes) != 1 or not is_smooth(candidate.shapes[0]) or len(terms) < 2:
        return terms
    name, positive = candidate.shapes[0].name, si_bounds(candidate.shapes[0])[0] > 0
    return _densified(_between(terms, candidate, machine, scales, name), name, scales, is_log=positive)


def is_smooth(shape: Unknown) -> bool:
    """Whether a shape is neither a whole number nor a place of the record."""
    return not shape.whole and not shape.along


def _refined_in_turn(
    terms: list[Term], candidate: Candidate, machine: Machine, scales: Mapping[str, float]
) -> list[Term]:
    """Refine a grid of two shapes along one of them after the other, for each value of the other one."""
    for shape, other in (candidate.shapes, candidate.shapes[::-1]):
        if is_smooth(shape):
            lines: dict[float, list[Term]] = {}
            for term in sorted(terms, key=lambda each: each.shape[shape.name]):
                lines.setdefault(term.shape[other.name], []).append(term)
            terms = [term for line in lines.values() for term in _between(line, candidate, machine, scales, shape.name)]
    return terms


def _between(
    terms: list[Term], candidate: Candidate, machine: Machine, scales: Mapping[str, float], name: str
) -> list[Term]:
    """Put further values of one shape between neighbours whose curves differ too much; the others stay.

    A grid that is too coarse leaves a residual that a second effect would then explain.
    """
    positive = next(si_bounds(shape)[0] for shape in candidate.shapes if shape.name == name) > 0
    place = 0
    while place + 1 < len(terms) and len(terms) < DENSEST:
        if _cosine(terms[place], terms[place + 1], scales) >= WIDEST_ANGLE:
            place += 1
            continue
        a, b = terms[place].shape[name], terms[place + 1].shape[name]
        between = (a * b) ** 0.5 if positive else (a + b) / 2
        new = variants_of(terms[place].candidate, candidate, machine, {**terms[place].shape, name: between}, scales)
        if not new:
            place += 1
        terms = [*terms[: place + 1], *new[:1], *terms[place + 1 :]]
    return terms


def _densified(terms: list[Term], name: str, scales: Mapping[str, float], *, is_log: bool) -> list[Term]:
    """Put values between those of a grid until neighbours are nearly one curve, without calling the model.

    Curves between two values are those of a cubic spline over the grid. Long records keep the grid as it is.
    """
    import numpy as np
    from scipy.interpolate import CubicSpline

    first = terms[0]
    rows = len(next(iter(first.curves[0].values())))
    if len(terms) < 4 or rows > LONG or any(term.unknowns != first.unknowns for term in terms):
        return terms
    at = np.array([np.log(term.shape[name]) if is_log else term.shape[name] for term in terms])
    if np.any(np.diff(at) <= 0):
        return terms
    splines = [
        {key: CubicSpline(at, np.array([term.curves[column][key] for term in terms]), axis=0) for key in curve}
        for column, curve in enumerate(first.curves)
    ]
    made: list[Term] = []
    for term, following, begin, end in zip(terms, terms[1:], at, at[1:], strict=False):
        made.append(term)
        angle = np.arccos(min(1.0, _cosine(term, following, scales)))
        for share in np.linspace(0, 1, int(np.ceil(angle / NARROWEST)) + 1)[1:-1]:
            value = begin + share * (end - begin)
            columns = [
                TermColumn({key: spline(value) for key, spline in curves.items()}, unknown, file, low * per, high * per)
                for curves, unknown, file, low, high, per in zip(
                    splines, term.unknowns, term.files, term.low, term.high, term.per, strict=True
                )
            ]
            made += made_term(term.candidate, columns, {name: float(np.exp(value) if is_log else value)}, scales)
    return [*made, terms[-1]]


def _cosine(first: Term, second: Term, scales: Mapping[str, float]) -> float:
    import numpy as np

    a = np.column_stack([stacked(curve, scales) for curve in first.curves])
    b = np.column_stack([stacked(curve, scales) for curve in second.curves])
    return float(np.linalg.svd(np.linalg.qr(a)[0].T @ np.linalg.qr(b)[0], compute_uv=False).min())
