"""All engaged pairs of teeth together: who carries how much, how stiff the mesh is, and its torsion."""

from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import micro
from harmonic_fractal.contact import Contact
from harmonic_fractal.quantities import Drive
from truing import Float

# Pairs that come to bear only under torque: how many times as many as stated there are at a torque

STEPS = 60  # of Newton's iteration at most, kept within its bracket
FINE = 1e-15


def _taken(value: Any, index: NDArray[np.intp], rows: int, axes: int) -> Any:
    """Return the values of these rows out of so many, with axes behind; what is one number for all stays it.

    Of a pair, or of an engagement, the same with all its numbers taken.
    """
    if is_dataclass(value) and not isinstance(value, type):
        taken = {each.name: _taken(getattr(value, each.name), index, rows, axes) for each in fields(value)}
        return replace(value, **taken)
    if np.ndim(value) == 0:
        return value
    many = np.broadcast_to(np.asarray(value, dtype=float), (rows,))[index]
    return many[(..., *(np.newaxis,) * axes)]


@dataclass(frozen=True, kw_only=True)
class Engagement:
    """Pairs over those stated: without torque, and the gain at a large one; 63 % of it at ``scale``, N m."""

    start: Float
    gain: Float
    scale: Float

    def factor(self, torque: Float) -> Float:
        """Return how many times as many pairs as stated are engaged at a torque of either sense, N m."""
        return self.start * (1.0 - self.gain * np.expm1(-np.abs(torque) / self.scale))

    def torque_of(self, share: Float) -> Float:
        """Return the torque above 0 that is ``share`` for each of as many pairs as stated, N m.

        More torque is more for each, however many come to bear, so there is one.
        """
        wanted = np.log(share)
        low = wanted + np.log(self.start)
        high = low + np.log1p(self.gain)
        way = np.broadcast_arrays(np.asarray(low, dtype=float), high, self.scale)[0]
        for _ in range(STEPS if np.any(self.gain) else 0):
            torque = np.exp(way)
            off = way - np.log(self.factor(torque)) - wanted
            low, high = np.where(off < 0.0, way, low), np.where(off > 0.0, way, high)
            rise = self.start * self.gain * torque / self.scale * np.exp(-torque / self.scale) / self.factor(torque)
            tried = way - off / (1.0 - rise)
            after = np.where((tried > low) & (tried < high), tried, 0.5 * (low + high))
            moved, way = np.abs(after - way), after
            if not (moved > FINE * (1.0 + np.abs(way))).any():
                break
        value: Float = np.exp(way)
        return value


def engagement_of(drive: Drive) -> Engagement:
    """Return the engagement of a drive."""
    return Engagement(start=drive.engaged_factor, gain=drive.engaged_gain, scale=drive.engaged_torque)


CHUNK = 2**14  # numbers at a time: they stay in the cache, and memory stays flat


@dataclass(frozen=True)
class Arcs:
    """Where pairs stand on their arcs: the share of the load of one pair at each place, and how many are there.

    Shares fall along the places; over all pairs their sum is 1.
    """

    shares: NDArray[np.float64]
    counts: NDArray[np.float64]

    @cached_property
    def offsets(self) -> NDArray[np.float64]:
        """ln of the share in parts of the largest, 0 or less."""
        value: NDArray[np.float64] = np.log(self.shares / self.shares[0])
        return value


def arcs_of(pairs: int) -> Arcs:
    """Return the places of engaged pairs on two opposite arcs; shares follow the square of the cosine.

    The pairs of an arc stand in the middle of equal parts of it. An odd one stands on the first arc.
    """
    shares: dict[float, int] = {}
    for count in ((pairs + 1) // 2, pairs // 2):
        for place in range(count):
            way = abs(2 * place + 1 - count) / count if count else 0.0
            share = float(np.cos(0.5 * np.pi * way) ** 2)
            shares[share] = shares.get(share, 0) + 1
    ordered = sorted(shares, reverse=True)
    counts = np.array([shares[share] for share in ordered], dtype=float)
    return Arcs(np.array(ordered) / np.dot(ordered, counts), counts)


@dataclass(frozen=True, kw_only=True)
class ToothPair:
    """One pair in all that is needed for its stiffness at u: the rough contact, a film beside it, springs behind it.

    ``scale`` is that of the rough contact, N/m; ``film`` of a film over the whole flank, N/m; ``area_ratio`` the
    truncated area at a_L = a_c over that of the flank; ``compliance`` that of tooth and line contact, m/N.
    """

    law: micro.ContactLaw
    scale: Float
    film: Float
    area_ratio: Float
    compliance: Float

    @property
    def numbers(self) -> tuple[Float, ...]:
        """All numbers of it."""
        return (
            self.law.dimension, self.law.pressure_ratio, self.scale, self.film, self.area_ratio, self.compliance,
        )  # fmt: skip

    def around(self, rough: Float, touched: Float) -> Float:
        """Return the stiffness of the whole pair, N/m, from that of its rough contact.

        ``touched`` is the real area in parts of the truncated one at a_L = a_c; without a film it is not asked for.
        """
        if np.any(self.film):
            rough = rough + self.film * np.maximum(1.0 - self.area_ratio * touched, 0.0)
        return rough / (1.0 + self.compliance * rough) if np.any(self.compliance) else rough


@dataclass(frozen=True, kw_only=True)
class DriveMesh:
    """All engaged pairs: each of them, their places, how many come to bear, and the lever of their forces, m."""

    pair: ToothPair
    arcs: Arcs
    engagement: Engagement
    radius: Float
    plastic_limit: Float

    def with_rows(self, *values: Float) -> tuple[NDArray[np.float64], ...]:
        """Return values in the shape that they and all numbers of the mesh have together: () or (n,)."""
        engagement = vars(self.engagement).values()
        own = (*self.pair.numbers, *engagement, self.radius, self.plastic_limit)
        shape = np.broadcast_shapes(*(np.shape(value) for value in (*values, *own)))
        return tuple(np.broadcast_to(np.asarray(value, dtype=float), shape) for value in values)

    @property
    def law_numbers(self) -> tuple[Float, ...]:
        """The numbers on which the loads of the pairs and their a_L depend, without stiffnesses."""
        return (*self.pair.numbers[:2], *vars(self.engagement).values(), self.radius, self.plastic_limit)

    @cached_property
    def plastic_share(self) -> Float:
        """The torque at which the first contact would turn elastic if there were just the pairs stated, N m."""
        value: Float = self.plastic_limit * self.radius / self.arcs.shares[0]
        return value

    @cached_property
    def plastic_torque(self) -> Float:
        """The torque at which the first contact turns elastic, that of the pair that carries most, N m."""
        return self.engagement.torque_of(self.plastic_share)


def mesh_of(drive: Drive, contact: Contact) -> DriveMesh:
    """Return the mesh of a drive; with more pairs each carries less."""
    return DriveMesh(
        pair=pair_of(drive, contact), arcs=arcs_of(drive.engaged_pairs), engagement=engagement_of(drive),
        radius=drive.pitch_radius * np.cos(drive.pressure_angle), plastic_limit=contact.plastic_limit,
    )  # fmt: skip


def line_stiffness(drive: Drive, contact: Contact) -> Float:
    """Return the stiffness of two flanks that flatten as cylinders do, N/m (Yang and Sun 1985)."""
    return 0.5 * np.pi * contact.modulus * drive.face_width


def pair_of(drive: Drive, contact: Contact) -> ToothPair:
    """Return one pair with what stands around its rough contact."""
    tooth = 1.0 / (drive.tooth_stiffness * drive.modulus_factor)
    line = 1.0 / line_stiffness(drive, contact) if drive.line_contact else 0.0
    flank = drive.face_width * drive.flank_height
    return ToothPair(
        law=contact.law,
        scale=contact.stiffness_scale,
        film=drive.film_stiffness,
        area_ratio=contact.plastic_limit / contact.hardness / flank,
        compliance=np.where(np.isnan(tooth), 0.0, tooth) + line,
    )


def load_of_largest(torque: Float, mesh: DriveMesh) -> Float:
    """Return the normal load of the pair that carries most, N."""
    value: Float = np.abs(torque) * mesh.arcs.shares[0] / (mesh.radius * mesh.engagement.factor(torque))
    return value


def normal_stiffness(torque: Float, mesh: DriveMesh) -> Float:
    """Return the stiffness of all engaged pairs along their normals, N/m; 0 where every contact is plastic."""
    factor = mesh.engagement.factor(torque)
    logarithm = np.log(np.maximum(np.abs(torque), 1e-300) / (factor * mesh.plastic_share))  # ln(F/F_c) of the largest
    given, factor = mesh.with_rows(logarithm, factor)
    first, factor = np.atleast_1d(given), np.atleast_1d(factor)
    rows, found = len(first), np.empty(len(first))
    step = max(CHUNK // len(mesh.arcs.shares), 1)
    for start in range(0, rows, step):
        index = np.arange(start, min(start + step, rows))
        pair = _taken(mesh.pair, index, rows, 1)
        size = micro.size_of(first[index, np.newaxis] + mesh.arcs.offsets, pair.law)
        rough = pair.scale * micro.stiffness_share(size, pair.law)
        touched = micro.touched_area(size, pair.law) if np.any(pair.film) else 0.0
        found[index] = factor[index] * (pair.around(rough, touched) @ mesh.arcs.counts)
    return found if np.ndim(given) else float(found[0])


# Torsion of the mesh: the integral of its compliance over the torque, from a reference torque on
#
# From torque 0 it would be infinite: below a small load all contacts are plastic, the model has no stiffness there, and
# just above it rises in proportion to what is beyond, so that the integral of 1/K grows without end, as a logarithm.

RULE = np.polynomial.legendre.leggauss(8)  # of Gauss and Legendre on each panel
WIDEST = 1.0  # panel, in the variable of integration
TURN = 0.3  # 1/u where that variable turns from ln u to u
KINKS = 128  # places at which a panel ends because there a pair turns elastic; of more pairs each matters less
ROWS = 4096  # cut into panels at a time
REMEMBERED = 128  # torsions: a fit asks for the same ones again, with other springs and readings around the mesh
LARGEST = 2**14  # so many rows are remembered; more are calculated anew
_TORSIONS: dict[bytes, tuple[Float, Float]] = {}


@dataclass(frozen=True)
class Panels:
    """Pieces of ways of integration: whose way it is (index into the rows asked for), its begin and its width."""

    owner: NDArray[np.intp]
    start: NDArray[np.float64]
    width: NDArray[np.float64]


def mesh_torsion(torque: Float, reference: Float, mesh: DriveMesh) -> tuple[Float, Float]:
    """Return the torsion of the mesh from the reference to the size of the torque, rad, and that of its roughness.

    Both are 0 below the reference, and infinite where all contacts are plastic at the reference. The second one leaves
    out films and springs. Accuracy: 1e-9 of the value; with more than 250 pairs and a reference near the plastic limit
    1e-7. Rows that differ in their torque alone share the way of integration up to where it ends.
    """
    digest = blake2b(digest_size=16)
    for number in (torque, reference, mesh.arcs.shares, *mesh.law_numbers, *mesh.pair.numbers):
        digest.update(f"{np.shape(number)}".encode() + np.asarray(number, dtype=float).tobytes())
    key = digest.digest()
    found = _TORSIONS.pop(key, None) or _torsion(torque, reference, mesh)
    if np.size(found[0]) <= LARGEST:
        _TORSIONS[key] = found  # the latest stands last
    for old in list(_TORSIONS)[:-REMEMBERED]:
        _TORSIONS.pop(old, None)
    return found


def _torsion(torque: Float, reference: Float, mesh: DriveMesh) -> tuple[Float, Float]:
    """Return what ``mesh_torsion`` does."""
    begin, lever = mesh.plastic_torque, np.square(mesh.radius)
    given = mesh.with_rows(np.log(np.maximum(np.abs(torque), 1e-300) / begin), np.log(reference / begin), lever)
    last, first, lever = (np.atleast_1d(item) for item in given)
    totals = np.zeros((2, len(last)))
    active = np.flatnonzero((last > first) & (first > 0.0))  # NaN is not
    order, way = _alike(active, first, *mesh.law_numbers, *mesh.pair.numbers)
    active = active[order]
    for start in range(0, int(way[-1]) + 1 if len(way) else 0, ROWS):
        some = slice(*np.searchsorted(way, (start, start + ROWS)))
        totals[:, active[some]] = _torsions(active[some], way[some] - start, first, last, mesh)
    endless = (first <= 0.0) & (last > first)
    whole, rough = np.where(endless, np.inf, totals / lever)
    return (whole, rough) if np.ndim(given[0]) else (whole[0], rough[0])


def _alike(rows: NDArray[np.intp], *numbers: Float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return an order of these rows in which those with the same numbers follow each other, and their kinds, from 0."""
    varying = [np.asarray(number)[rows] for number in numbers if np.size(number) > 1]
    if not varying:
        return np.arange(len(rows)), np.zeros(len(rows), dtype=np.intp)
    order = np.lexsort(varying)
    fresh = np.zeros(len(rows), dtype=bool)
    for column in varying:
        fresh[1:] |= np.diff(column[order]) != 0.0
    return order, np.cumsum(fresh)


def _torsions(
    rows: NDArray[np.intp],
    way: NDArray[np.intp],
    first: NDArray[np.float64],
    last: NDArray[np.float64],
    mesh: DriveMesh,
) -> NDArray[np.float64]:
    """Return the integrals of torque over stiffness of these rows (2, rows): the whole mesh, its roughness alone.

    ``way`` rises from 0 on. Between the places where a pair turns elastic a way is integrated once for all its rows.
    """
    begins = np.flatnonzero(np.diff(way, prepend=-1))
    leaders, furthest = rows[begins], np.maximum.reduceat(last[rows], begins)
    marks = _marks(leaders, first, mesh)
    ends = _variable(micro.size_of(marks, _taken(mesh.pair.law, leaders, len(first), 1)))
    panels, counts = _cut(np.where(marks <= furthest[:, np.newaxis], ends, np.nan))
    behind = np.concatenate([np.zeros((len(leaders), 1), dtype=int), np.cumsum(counts, axis=1)], axis=1)
    parts = np.zeros((2, len(leaders), int(behind.max()) + 1))
    ordinal = np.arange(len(panels.owner)) - np.repeat(np.cumsum(behind[:, -1]) - behind[:, -1], behind[:, -1])
    parts[:, panels.owner, ordinal + 1] = _integrals(panels, leaders, mesh, len(first))
    passed = (marks[way] <= last[rows, np.newaxis]).sum(axis=1) - 1
    found = np.cumsum(parts, axis=2)[:, way, behind[way, passed]]
    high = _variable(micro.size_of(last[rows], _taken(mesh.pair.law, rows, len(first), 0)))
    panels, _ = _cut(np.stack([ends[way, passed], high], axis=1))
    for total, part in zip(found, _integrals(panels, rows, mesh, len(first)), strict=True):
        np.add.at(total, panels.owner, part)
    return found


def _variable(size: Float) -> NDArray[np.float64]:
    """Return the variable of integration at u: like ln u where u is small, in proportion to u where it is large."""
    return np.asarray(np.log(np.expm1(TURN * size)))


def _marks(rows: NDArray[np.intp], first: NDArray[np.float64], mesh: DriveMesh) -> NDArray[np.float64]:
    """Return where the ways of these rows begin and where on them a pair turns elastic, (rows, places), rising."""
    offsets, low = mesh.arcs.offsets, first[rows, np.newaxis]
    some = np.unique(np.linspace(0, len(offsets) - 1, min(KINKS, len(offsets))).astype(int))
    ends = _onsets(rows, offsets[some], mesh, len(first))
    return np.concatenate([low, np.maximum(np.log(ends[:, 1:] / ends[:, :1]), low)], axis=1)


def _cut(ends: NDArray[np.float64]) -> tuple[Panels, NDArray[np.intp]]:
    """Cut ways at their ends (ways, places), and further until no piece is too wide; NaN ends a way.

    Also return the numbers of pieces between the ends.
    """
    widths = np.nan_to_num(np.diff(ends, axis=1))  # rows that are refused have none
    counts = np.ceil(widths / WIDEST).astype(int)
    flat = counts.ravel()
    width = np.repeat(widths.ravel() / np.maximum(flat, 1), flat)
    behind = np.arange(len(width)) - np.repeat(np.cumsum(flat) - flat, flat)
    start = np.repeat(ends[:, :-1].ravel(), flat) + behind * width
    return Panels(np.repeat(np.arange(len(ends)), counts.sum(axis=1)), start, width), counts


def _onsets(index: NDArray[np.intp], offsets: NDArray[np.float64], mesh: DriveMesh, rows: int) -> NDArray[np.float64]:
    """Return the torques at which pairs with these shares turn elastic, (rows asked for, shares)."""
    share = _taken(mesh.plastic_share, index, rows, 1) * np.exp(-offsets)
    found = np.asarray(_taken(mesh.engagement, index, rows, 1).torque_of(share))
    return np.broadcast_to(found, (len(index), len(offsets)))


def _integrals(panels: Panels, rows: NDArray[np.intp], mesh: DriveMesh, count: int) -> NDArray[np.float64]:
    """Integrate torque over stiffness on every panel of these rows of ``count``, (2, panels)."""
    together = CHUNK // (len(RULE[0]) * len(mesh.arcs.shares)) + 1
    parts = []
    for start in range(0, len(panels.owner), together):
        piece = Panels(*(values[start : start + together] for values in vars(panels).values()))
        parts.append(_integrated(piece, rows[piece.owner], mesh, count))
    return np.concatenate([np.empty((2, 0)), *parts], axis=1)


def _integrated(panels: Panels, rows: NDArray[np.intp], mesh: DriveMesh, count: int) -> NDArray[np.float64]:
    """Integrate on a few panels: over the stiffness of the whole mesh, and of its roughness alone.

    Panels that differ in film and springs alone share loads and contacts.
    """
    some, kind = _distinct(panels, rows, mesh)
    step, size, law = _contacts(Panels(rows[some], panels.start[some], panels.width[some]), mesh, count)
    pair = _taken(mesh.pair, rows, count, 2)
    alone = pair.scale * micro.stiffness_share(size, law)[kind]
    touched = micro.touched_area(size, law)[kind] if np.any(pair.film) else 0.0
    whole, rough = pair.around(alone, touched), alone @ mesh.arcs.counts
    sums = np.stack([rough if whole is alone else whole @ mesh.arcs.counts, rough])
    value: NDArray[np.float64] = (0.5 * panels.width[:, np.newaxis] * RULE[1] * step[kind, :, 0] / sums).sum(axis=2)
    return value


def _distinct(panels: Panels, rows: NDArray[np.intp], mesh: DriveMesh) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return one panel of each kind, and the kinds of all, where those of a kind have the same loads."""
    numbers = [np.asarray(number)[rows] for number in mesh.law_numbers if np.size(number) > 1]
    order, sorted_kinds = _alike(np.arange(len(rows)), panels.start, panels.width, *numbers)
    kind = np.empty_like(sorted_kinds)
    kind[order] = sorted_kinds
    return order[np.flatnonzero(np.diff(sorted_kinds, prepend=-1))], kind


def _contacts(
    panels: Panels, mesh: DriveMesh, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], micro.ContactLaw]:
    """Return torque steps (panels, nodes, 1) and u of all pairs (panels, nodes, pairs), with the law of the contacts.

    The owners of the panels are rows of ``count``.
    """
    law: micro.ContactLaw = _taken(mesh.pair.law, panels.owner, count, 2)
    way = panels.start[:, np.newaxis] + panels.width[:, np.newaxis] * 0.5 * (RULE[0] + 1.0)
    grown = np.exp(way)[..., np.newaxis]
    size = np.log1p(grown) / TURN
    begin, share = (_taken(value, panels.owner, count, 2) for value in (mesh.plastic_torque, mesh.plastic_share))
    torque = begin * np.exp(micro.load_logarithm(size, law))
    factor = _taken(mesh.engagement, panels.owner, count, 2).factor(torque)
    step = torque / factor * micro.load_slope(size, law) * grown / ((1.0 + grown) * TURN)
    loads = np.log(torque / (factor * share)) + mesh.arcs.offsets
    return step, np.asarray(micro.size_of(loads, law)), law
