"""Shapes that nobody registered, made from the covariates without physics, each with its numbers.

Trends and products of covariates, orders of an angle, waves of any period, steps; where a covariate changes its sign a
jump, a kink and a dead zone; in time a settling. Amplitudes are numbers without bounds, one for every term and result;
a frequency, a place, a width or a time constant is looked for like a shape of any effect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations
from math import inf, pi

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import ENDS, Candidate, Parameter, ShapeKind, Term, UnregisteredShape
from truing.diagnosis.records import Covariate, Records
from truing.diagnosis.result import UNKNOWN

DEGREES, HIGHEST_ORDER = (2, 4), 16
"""Degrees of the polynomials over a covariate, and the highest order over an angle."""
FEWEST_VALUES = 12
"""A covariate of fewer distinct values orders nothing: no wave, no step, no settling over it."""
MOST_WAVES = 3000
"""So many periods of a wave lie in a record at most: the frequencies to look at grow with it."""
EITHER_SIDE = 0.1
"""Share of the rows on each side of zero from which on something may happen where a covariate changes its sign."""
SHORTEST_SETTLING, LONGEST_SETTLING = 0.02, 1.0
"""Time constants that are looked for, in lengths of the record."""
Family = tuple[ShapeKind, tuple[str, ...], int, tuple[Parameter, ...], Callable[..., list[Term]]]


def shapes_of(records: Records, registered: Mapping[str, Sequence[int]], *, has_steps: bool) -> list[Candidate]:
    """Return the shapes over every covariate that moved, for every result alone and for all of them together.

    ``registered`` holds the orders of each angle that an effect looks for already; ``has_steps`` says that steps in
    time are looked for already. Of covariates that move as one the first has the shapes; the place of a row in a file
    is none.
    """
    moved = _apart(records.moved)
    results = tuple(records.measured)
    groups = [(name,) for name in results] + ([results] if len(results) > 1 else [])
    shapes = []
    for kind, on, count, numbers, terms in _families(moved, registered, has_steps=has_steps, rows=len(records)):
        for group in groups:
            shape = UnregisteredShape(kind, on, group, terms)
            amplitudes = [Parameter(f"{name}:{index}", -inf, inf) for name in group for index in range(count)]
            detail = f".{count}" if kind in {"trend", "product"} else ""
            tag = f"{UNKNOWN}:{kind}{detail}:{','.join(on)}:{','.join(group)}"
            shapes.append(Candidate(UNKNOWN, tag, (*amplitudes, *numbers), 10**6, shape=shape))
    return shapes


def _apart(moved: Sequence[Covariate]) -> list[Covariate]:
    """Return the covariates but those that another one moves as one with."""
    kept: list[Covariate] = []
    for covariate in moved:
        is_alone = not any(covariate.moves_with(other, 0.99999) for other in kept)
        if is_alone or (covariate.is_angle and covariate.goes_round):
            kept.append(covariate)
    return kept


def _families(
    moved: Sequence[Covariate], registered: Mapping[str, Sequence[int]], *, has_steps: bool, rows: int
) -> Iterator[Family]:
    """Give every family of shapes: kind, covariates, terms a result, shape numbers, and how its terms are made."""
    for covariate in moved:
        distinct = len(np.unique(np.round(covariate.values[np.isfinite(covariate.values)], 12)))
        is_round = covariate.goes_round and covariate.is_angle
        if is_round:
            yield "trend", (covariate.name,), 3, (), _harmonics
        for degree in DEGREES:
            if distinct > degree and not is_round:
                yield "trend", (covariate.name,), degree + 1, (), partial(_powers, degree)
        yield from _at_zero(covariate)
        if distinct >= FEWEST_VALUES:
            yield from _ordered(covariate, registered.get(covariate.name, ()), has_steps=has_steps, rows=rows)
    for first, second in combinations(moved, 2):
        for degree in (1, 2):
            yield "product", (first.name, second.name), len(_exponents(degree)), (), partial(_products, degree)


def _at_zero(covariate: Covariate) -> Iterator[Family]:
    """Give what may happen where a covariate changes its sign: a jump, a kink, a dead zone."""
    values = covariate.values[np.isfinite(covariate.values)]
    if min((values > 0).mean(), (values < 0).mean()) < EITHER_SIDE or (covariate.is_angle and covariate.goes_round):
        return
    on, largest = (covariate.name,), float(np.abs(values).max())
    yield "jump", on, 1, (), _jump
    yield "kink", on, 1, (), _kink
    if len(np.unique(values)) >= FEWEST_VALUES:
        width = Parameter("width", 0.02 * largest, 0.9 * largest, is_amplitude=False)
        yield "dead zone", on, 1, (width,), _dead_zone


def _ordered(covariate: Covariate, registered: Sequence[int], *, has_steps: bool, rows: int) -> Iterator[Family]:
    """Give waves of whole orders over an angle, of any period over all else, steps and settling in time."""
    values = covariate.values[np.isfinite(covariate.values)]
    span, on = float(np.ptp(values)), (covariate.name,)
    if covariate.is_angle:
        low = max(registered, default=0) + 1
        high = min(HIGHEST_ORDER, highest_order(covariate.values))
        if high > low:
            order = Parameter("order", low, high, is_amplitude=False, whole=True)
            yield "order", on, 2, (order,), partial(_waves, 1.0)
        return
    most = min(0.5 * len(np.unique(values)), 0.5 * rows, MOST_WAVES)
    frequency = Parameter("frequency", 1.0 / span, max(most, 2.0) / span, is_amplitude=False)
    yield "wave", on, 2, (frequency,), partial(_waves, 2 * pi)
    if covariate.role == "time":
        if not has_steps:
            ends = (float(values.min() + ENDS * span), float(values.max() - ENDS * span))
            position = Parameter("place", *ends, is_amplitude=False, along=covariate.name)
            yield "step", on, 1, (position,), _step
        reach = (SHORTEST_SETTLING * span, LONGEST_SETTLING * span)
        yield "settling", on, 2, (Parameter("constant", *reach, is_amplitude=False),), _settling


def highest_order(angle: Matrix) -> int:
    """Return the highest order that this sampling of an angle shows as itself; above it, it folds back."""
    places = np.unique(np.round(np.mod(angle[np.isfinite(angle)], 2 * pi), 9))
    if len(places) < 3:
        return 0
    gaps = np.diff([*places, places[0] + 2 * pi])
    inner = gaps[gaps < gaps.max()] if len(gaps) > 2 else gaps
    is_regular = len(inner) > 0 and float(np.ptp(inner)) < 1e-3 * float(inner.mean())
    if not is_regular:
        return 10**6
    return int(np.ceil(pi / float(inner.mean()) - 1e-6)) - 1  # places are rounded to 1e-9


def _scaled(name: str, values: Matrix) -> tuple[str, Matrix]:
    """Return a covariate from -1 to 1 over the record, as Python and its values."""
    middle, half = float(values.max() + values.min()) / 2, float(np.ptp(values)) / 2 or 1.0
    return f"(({name} - {middle!r}) / {half!r})", (values - middle) / half


def _powers(degree: int, name: str, values: Matrix) -> list[Term]:
    text, z = _scaled(name, values)
    return [Term("1" if not power else f"{text}**{power}", z**power) for power in range(degree + 1)]


def _harmonics(name: str, values: Matrix) -> list[Term]:
    return [Term("1", np.ones(len(values))), *_waves(1.0, name, values, 1.0)]


def _exponents(degree: int) -> list[tuple[int, int]]:
    """Return the powers of two covariates in a product: bilinear, or with squares."""
    return [(0, 0), (1, 0), (0, 1), (1, 1), *([(2, 0), (0, 2), (2, 1), (1, 2)] if degree > 1 else [])]


def _products(degree: int, first: str, of_first: Matrix, second: str, of_second: Matrix) -> list[Term]:
    (one, a), (other, b) = _scaled(first, of_first), _scaled(second, of_second)
    return [Term(f"{one}**{i} * {other}**{j}", a**i * b**j) for i, j in _exponents(degree)]


def _waves(turn: float, name: str, values: Matrix, number: float) -> list[Term]:
    angle = turn * number
    return [Term(f"np.{word}({angle!r} * {name})", getattr(np, word)(angle * values)) for word in ("sin", "cos")]


def _step(name: str, values: Matrix, position: float) -> list[Term]:
    return [Term(f"({name} >= {position!r})", (values >= position).astype(float))]


def _settling(name: str, values: Matrix, constant: float) -> list[Term]:
    start = float(values.min())
    text = f"np.exp(-({name} - {start!r}) / {constant!r})"
    return [Term("1", np.ones(len(values))), Term(text, np.exp(-(values - start) / constant))]


def _jump(name: str, values: Matrix) -> list[Term]:
    return [Term(f"np.sign({name})", np.sign(values))]


def _kink(name: str, values: Matrix) -> list[Term]:
    largest = float(np.abs(values).max())
    return [Term(f"np.abs({name}) / {largest!r}", np.abs(values) / largest)]


def _dead_zone(name: str, values: Matrix, width: float) -> list[Term]:
    largest = float(np.abs(values).max())
    text = f"np.sign({name}) * np.maximum(np.abs({name}) - {width!r}, 0) / {largest!r}"
    return [Term(text, np.sign(values) * np.maximum(np.abs(values) - width, 0) / largest)]
