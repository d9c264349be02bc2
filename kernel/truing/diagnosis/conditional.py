"""What causes could draw beside an explanation: their curves, once its numbers and the inputs have taken their part.

Curves of many causes are compared at once with what the explanation leaves, without the memory of the noise. Those of
shapes that nobody registered are too many on long records to keep what each leaves: each result is passed through block
by block, and what is needed of it is small; shapes of several results are put together from what their results gave.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Indices, Mask, Matrix
from truing.diagnosis.causes import Candidate
from truing.diagnosis.curves import VALUES_KEPT, Bundle, ResponseCurves, TermTable
from truing.diagnosis.exact import slopes_left
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.machine import Predicted, in_blocks
from truing.diagnosis.sample import Sample

BLOCK = 500_000
"""So many values are passed through at once."""
DEPENDS = 1e-6
"""Share of a column that is left beside others when it depends on them."""
KEPT = 3
"""So many points of a cause begin exact fits."""
NEAR_LEVEL = 2.0
"""A curve that bends stands for amplitudes up to so many times its own, and down to one over it; the smallest ones for
all that are smaller."""
AS_ONE = 0.98
"""Share of its curves, squared, that one point must draw of another one to be no further start."""
FAINTEST_CURVE = 1e-9
"""A curve that is smaller, squared and in units of the noise, is rounding."""
OWN = 0.03
"""Share of a curve that must be left beside an explanation for it to count as one more that was tried."""


@dataclass(frozen=True)
class Conditional:
    """What an explanation leaves, weighted (rows + K,), once its numbers and the inputs have taken their part.

    ``taken`` (rows + K, t) is an orthonormal basis of what they can draw; ``roots`` weigh the rows of the sample, and
    ``at`` is what the explanation predicts, None for the prediction that the noise was learnt about.
    """

    sample: Sample
    roots: Matrix
    left: Matrix
    taken: Matrix
    at: Predicted | None = None

    def drawn(self, curves: Matrix) -> Matrix:
        """Return curves (M, q, readings), SI, as weighted rows of the sample, (M, q, rows)."""
        by_result = np.split(curves.T, len(self.sample.machine.records.measured))
        added = dict(zip(self.sample.machine.records.measured, by_result, strict=True))
        return self.sample.curve(added, self.at).T * self.roots

    def beyond(self, rows: Matrix) -> Matrix:
        """Return what only these curves (M, q, rows) can draw, (M, q, rows + K)."""
        made = -(rows @ self.taken[: rows.shape[-1]]) @ self.taken.T
        made[..., : rows.shape[-1]] += rows
        return np.asarray(made)


class Pass:
    """A table passed through one result of a sample beside an explanation, every row in units of its noise.

    ``right`` (M, c) is what it shares with what is left, ``taken`` (M, c, t) with what the explanation draws itself,
    ``normal`` (M, c, c) with itself and ``next`` (M - 1, c, c) with the next point. ``part`` is where the rows of the
    result stand among all rows of the sample.
    """

    def __init__(self, table: TermTable, conditional: Conditional, index: int) -> None:
        self.table, self.conditional = table, conditional
        self.channel, self.part = conditional.sample.channels[index], conditional.sample.parts[index]
        against = np.column_stack([conditional.left[self.part], conditional.taken[self.part]])
        shared, normal, following = [], [], []
        last = np.zeros((0, table.terms.shape[1], len(self.channel)))
        for block in blocks_of(table.terms):
            rows = self.rows(block)
            shared.append(rows @ against)
            normal.append(rows @ rows.swapaxes(1, 2))
            whole = np.concatenate([last, rows])
            following.append(whole[1:] @ whole[:-1].swapaxes(1, 2))
            last = rows[-1:]
        every = np.concatenate(shared)
        self.right, self.taken = every[..., 0], every[..., 1:]
        self.normal, self.next = np.concatenate(normal), np.concatenate(following)

    def rows(self, block: slice) -> Matrix:
        """Return the terms at some points in units of the noise, (m, c, rows of the result)."""
        terms = np.asarray(self.table.terms[block], dtype=float)
        at = self.conditional.at
        own = None if at is None else at[self.channel.name]
        flat = self.channel.curve(terms.reshape(-1, terms.shape[-1]).T, own).T
        return np.asarray(flat.reshape(*terms.shape[:2], -1) * self.conditional.roots[self.part])

    def inner(self, drawn: Matrix) -> Matrix:
        """Return what the terms share with draws (rows + K, draws), (M, c, draws)."""
        own, (count, c, _) = drawn[self.part].astype(np.float32), self.table.terms.shape
        rows = (self.rows(block).astype(np.float32).reshape(-1, len(own)) for block in blocks_of(self.table.terms))
        return np.concatenate([each @ own for each in rows]).reshape(count, c, -1)


@dataclass(frozen=True, eq=False)
class ProjectedCurves:
    """The curves of a shape over some results, once the explanation and the inputs have taken their part.

    ``units`` (M, q, q) make them orthonormal within a point, ``points`` (m,) are those that draw anything.
    """

    passes: tuple[Pass, ...]
    units: Matrix
    points: Indices

    def inner(self, drawn: Matrix, known: dict[Pass, Matrix]) -> Matrix:
        """Return what they share with draws that the explanation has no part in, (m, q, draws); each pass made once."""
        for each in self.passes:
            if each not in known:
                known[each] = each.inner(drawn)
        raw = np.concatenate([known[each][self.points] for each in self.passes], axis=1)
        return np.asarray(self.units[self.points] @ raw)

    def vectors(self, index: int) -> Matrix:
        """Return the orthonormal curves at one of the points, (q, rows + K)."""
        conditional, at = self.passes[0].conditional, int(self.points[index])
        rows = np.zeros((len(self.passes), self.units.shape[1] // len(self.passes), conditional.sample.rows))
        for each, kept in zip(self.passes, rows, strict=True):
            kept[:, each.part] = each.rows(slice(at, at + 1))[0]
        return np.asarray(self.units[at] @ conditional.beyond(rows.reshape(-1, conditional.sample.rows)))


def blocks_of(several: NDArray[Any]) -> Iterator[slice]:
    """Give the points of some curves (M, c, n), so many at once as memory has room for; at least one block."""
    return in_blocks(max(len(several), 1), max(1, BLOCK // max(prod(several.shape[1:]), 1)))


def side_by_side(blocks: list[Matrix]) -> Matrix:
    """Return square blocks (M, c, c) as the diagonal of larger ones."""
    ends = np.cumsum([0, *(each.shape[-1] for each in blocks)])
    made = np.zeros((len(blocks[0]), int(ends[-1]), int(ends[-1])))
    for begin, end, each in zip(ends, ends[1:], blocks, strict=False):
        made[:, begin:end, begin:end] = each
    return made


def without_taken(passes: tuple[Pass, ...]) -> tuple[Matrix, Matrix, Matrix]:
    """Return squares within every point with and without what is taken, and those with the next point without it."""
    taken = np.concatenate([each.taken for each in passes], axis=1)
    raw = side_by_side([each.normal for each in passes])
    following = side_by_side([each.next for each in passes]) - taken[1:] @ taken[:-1].swapaxes(1, 2)
    return raw, raw - taken @ taken.swapaxes(1, 2), following


def units_of(normal: Matrix) -> Matrix:
    """Return what makes columns with these squares (M, q, q) orthonormal, turned as little as can be.

    Those that depend on one another share what they draw (P.-O. Löwdin, J. Chem. Phys. 18, 1950, 365).
    """
    size = np.sqrt(np.maximum(np.einsum("mqq->mq", normal), 1e-300))
    squares, axes = np.linalg.eigh(np.nan_to_num(normal / (size[:, :, None] * size[:, None, :])))
    lengths = np.where(squares > DEPENDS**2, np.sqrt(np.maximum(squares, DEPENDS**2)), np.inf)
    return np.asarray((axes / lengths[:, None]) @ axes.swapaxes(1, 2) / size[:, None])


@dataclass(frozen=True, eq=False)
class Spanned:
    """Curves of a cause beside an explanation, (M, q, rows + K), orthonormal within a point."""

    basis: Matrix

    def inner(self, drawn: Matrix, known: object) -> Matrix:
        """Return what they share with draws (rows + K, draws), (M, q, draws)."""
        flat = self.basis.reshape(-1, self.basis.shape[-1])
        return np.asarray((flat @ drawn.astype(flat.dtype)).reshape(*self.basis.shape[:2], -1))

    def vectors(self, index: int) -> Matrix:
        """Return the curves at one of the points, (q, rows + K)."""
        return np.asarray(self.basis[index])


@dataclass(frozen=True)
class ConditionalGain:
    """What a cause could draw beside an explanation: gains in score with the numbers to begin with, the best first.

    ``tries`` counts its independent curves, which ``span`` holds or makes again.
    """

    starts: tuple[tuple[float, Matrix], ...]
    tries: float
    span: Spanned | ProjectedCurves


def conditional_on(fit: Fit, extended: Extended) -> Conditional:
    """Return an explanation as other causes see it."""
    sample, k = fit.sample, len(fit.inputs)
    roots = sample.roots(fit.left)
    slopes = np.column_stack(slopes_left(fit, extended)) * roots[:, None]
    columns = np.concatenate([slopes, np.eye(k, fit.size + k, fit.size)])
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    taken = np.asarray(basis[:, size > 1e-9 * size.max()] if size.size else basis)
    left = np.concatenate([roots * fit.left, -fit.inputs])
    return Conditional(sample, roots, left - taken @ (taken.T @ left), taken, fit.predicted)


def look(curves: ResponseCurves, at: Fit, causes: Sequence[Candidate]) -> Mapping[str, ConditionalGain]:
    """Compare all causes with what an explanation leaves, by their tag."""
    conditional = conditional_on(at, curves.extended)
    effects = [cause for cause in causes if cause.effect is not None] if curves.extended.is_moving else []
    curves.extended.side_by_side([partial(curves.of, cause, at) for cause in effects])
    bundles = (curves.of(cause, at) for cause in causes)  # one after another: those of effects may be large
    made = {tag: each for group in _grouped(bundles) for tag, each in compared(group, conditional)}
    passes: dict[tuple[TermTable, int], Pass] = {}
    for bundle in (curves.of(cause, at) for cause in causes if cause.shape is not None):
        if bundle.table is not None and (each := _swept(bundle, bundle.table, conditional, passes)) is not None:
            made[bundle.cause.tag] = each
    return made


def _swept(
    bundle: Bundle, table: TermTable, conditional: Conditional, passes: dict[tuple[TermTable, int], Pass]
) -> ConditionalGain | None:
    """Compare a table with what an explanation leaves; each result is passed through once."""
    shape, names = bundle.cause.shape, [channel.name for channel in conditional.sample.channels]
    places = [names.index(name) for name in (shape.results if shape is not None else ())]
    for index in places:
        if (table, index) not in passes:
            passes[table, index] = Pass(table, conditional, index)
    own = tuple(passes[table, index] for index in places)
    raw, normal, following = without_taken(own)
    sizes = [np.sqrt(np.maximum(np.einsum("mqq->mq", each), 0.0)) for each in (normal, raw)]
    points, is_own = np.flatnonzero(_draws(*sizes)), (sizes[0] > OWN * sizes[1]).any(axis=1)
    if not len(points):
        return None
    right, span = np.concatenate([each.right for each in own], axis=1), ProjectedCurves(own, units_of(normal), points)
    inner = span.units[1:] @ following @ span.units[:-1].swapaxes(1, 2)
    tries = 1.0 + _turned(inner[is_own[1:] & is_own[:-1]], normal.shape[1])
    return ConditionalGain(_best(*_starts(bundle, points, right, normal), span, conditional), tries, span)


def _draws(size: Matrix, raw: Matrix) -> Mask:
    """Mark the points at which curves of these sizes, with and without what is taken, draw anything."""
    return np.asarray(((size > 1e-6 * raw) & (raw > FAINTEST_CURVE)).any(axis=1))


def _turned(inner: Matrix, q: int) -> float:
    """Return how many curves more lie on the way between neighbours that share so much."""
    same = np.clip((inner**2).sum(axis=(1, 2)) / q, 0, 1)
    return float(np.sqrt(1 - same).sum() / 2)


def _grouped(bundles: Iterable[Bundle]) -> Iterator[list[Bundle]]:
    """Give bundles of one number of columns together, so many at once as memory has room for."""
    waiting: dict[int, list[Bundle]] = {}
    for bundle in (each for each in bundles if each.table is None):
        several = waiting.setdefault(bundle.curves.shape[1], [])
        if several and sum(each.curves.size for each in several) + bundle.curves.size > BLOCK:
            yield waiting.pop(bundle.curves.shape[1])
            waiting[bundle.curves.shape[1]] = several = []
        several.append(bundle)
    yield from waiting.values()


def compared(bundles: list[Bundle], conditional: Conditional) -> Iterator[tuple[str, ConditionalGain]]:
    """Compare the curves of causes with what an explanation leaves; those that draw nothing here are left out."""
    curves = np.concatenate([bundle.curves for bundle in bundles]) if len(bundles) > 1 else bundles[0].curves
    kept, is_own, basis, right, normal = _weighed(curves, conditional)
    begin = 0
    for bundle in bundles:
        end = begin + len(bundle.points)
        own = begin + np.flatnonzero(kept[begin:end])
        if len(own):
            starts = _starts(bundle, own - begin, right[begin:end], normal[begin:end])
            drawn = Spanned(basis[own] if len(own) < len(basis) else basis)
            is_sweep = bundle.is_straight and len(bundle.cause.shapes) <= 1  # neighbouring points draw alike
            tries = independent(basis[own[is_own[own]]], is_sweep=is_sweep)
            yield bundle.cause.tag, ConditionalGain(_best(*starts, drawn, conditional), tries, drawn)
        begin = end


def _weighed(curves: Matrix, conditional: Conditional) -> tuple[Any, Any, Matrix, Matrix, Matrix]:
    """Return which points draw anything, which something of their own, and their bases, right and normal sides.

    Bases of many curves are kept in single precision.
    """
    kind = np.float32 if curves.size > VALUES_KEPT else np.float64
    basis = np.empty((*curves.shape[:2], len(conditional.left)), dtype=kind)
    parts = []
    for block in blocks_of(curves):
        rows = conditional.drawn(curves[block])
        weighed = conditional.beyond(rows)
        raw, size = np.linalg.norm(rows, axis=-1), np.linalg.norm(weighed, axis=-1)
        normal = weighed @ weighed.swapaxes(1, 2)
        basis[block] = units_of(normal) @ weighed
        parts.append((_draws(size, raw), (size > OWN * raw).any(axis=1), weighed @ conditional.left, normal))
    kept, is_own, right, normal = (np.concatenate(each) for each in zip(*parts, strict=True))
    return kept, is_own, basis, right, normal


def _best(
    gains: Matrix, values: Matrix, span: Spanned | ProjectedCurves, conditional: Conditional
) -> tuple[tuple[float, Matrix], ...]:
    """Return the best points that do not draw the same, with what each is worth in score."""
    chosen: list[int] = []
    for index in np.argsort(-gains, kind="stable")[:200].tolist():
        if not gains[index] > 0 or len(chosen) == KEPT:  # the gains fall from here on
            break
        own, others = span.vectors(index), [span.vectors(other) for other in chosen]
        if not any(np.linalg.norm(own @ other.T) ** 2 > AS_ONE * min(len(own), len(other)) for other in others):
            chosen.append(index)
    known, whole = conditional.sample.known, float(conditional.left @ conditional.left)
    rest = np.maximum(1 - gains[chosen] / max(whole, known, 1.0), 1e-9)  # of the squares; the noise is what is left
    return tuple(zip((-known * np.log(rest)).tolist(), values[chosen], strict=True))


def _starts(bundle: Bundle, places: Indices, right: Matrix, normal: Matrix) -> tuple[Matrix, Matrix]:
    """Return what each point lowers the sum of squares by within the bounds of the cause, and the numbers there."""
    points, right, normal = bundle.points[places], right[places], normal[places]
    scale = np.sqrt(np.maximum(np.einsum("mqq->mq", normal), 1e-300))
    scaled = normal / (scale[:, :, None] * scale[:, None, :])
    np.einsum("mqq->mq", scaled)[...] += 1e-9
    solved = np.linalg.solve(scaled, (right / scale)[..., None])[..., 0] / scale
    values, own = np.array(points), bundle.cause.amplitudes
    low, high = bundle.cause.ends
    if bundle.is_straight:
        values[:, own] = solved = np.clip(solved, low, high)
    else:  # below its smallest amplitudes a curve is in proportion, if anywhere
        levels = np.max(np.abs(points[:, own]) / np.maximum(np.abs(low), np.abs(high)), axis=1)
        least = np.where(levels <= NEAR_LEVEL * levels.min(), 0.0, 1 / NEAR_LEVEL)
        solved = np.clip(solved, least[:, None], NEAR_LEVEL)
        values[:, own] = np.clip(points[:, own] * solved[:, :1], low, high)
    gains = 2 * np.einsum("mq,mq->m", solved, right) - np.einsum("mq,mqp,mp->m", solved, normal, solved)
    return gains, values


def independent(basis: Matrix, *, is_sweep: bool) -> float:
    """Return how many independent curves a set of points draws: the way along a sweep, else the rank that counts."""
    if len(basis) < 2:
        return 1.0
    q = max(round(float(np.einsum("mqn,mqn->m", basis, basis).max())), 1)
    if is_sweep:
        return 1.0 + _turned(basis[1:] @ basis[:-1].swapaxes(1, 2), q)
    flat = basis.reshape(-1, basis.shape[-1])
    gram = flat @ flat.T
    return float(np.trace(gram) ** 2 / max(float((gram**2).sum()), 1e-300) / q)
