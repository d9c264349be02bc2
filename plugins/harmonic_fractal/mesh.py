"""All engaged pairs of teeth together: who carries how much, how stiff the mesh is, and its torsion."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import micro
from harmonic_fractal.contact import Contact
from harmonic_fractal.quantities import Drive
from truing import Float

# Pairs that come to bear only under torque: how many times as many as stated there are at a torque

STEPS = 60  # of Newton's iteration at most, kept within its bracket
FINE = 1e-15


@dataclass(frozen=True, kw_only=True)
class Engagement:
    """Pairs over those stated: without torque, and the gain at a large one; 63 % of it at ``scale``, N m."""

    start: Float
    gain: Float
    scale: Float

    def factor(self, torque: Float) -> Float:
        """Return how many times as many pairs as stated are engaged at a torque of either sense, N m."""
        found: Float = self.start * (1.0 - self.gain * np.expm1(-np.abs(torque) / self.scale))
        return found

    def torque_of(self, share: Float) -> Float:
        """Return the torque above 0 that is ``share`` for each of as many pairs as stated, N m.

        More torque is more for each, however many come to bear, so there is one.
        """
        wanted = np.log(share)
        low = wanted + np.log(self.start)
        high = low + np.log1p(self.gain)
        way = np.asarray(low, dtype=float)
        for _ in range(STEPS):
            torque = np.exp(way)
            off = way - np.log(self.factor(torque)) - wanted
            low, high = np.where(off < 0.0, way, low), np.where(off > 0.0, way, high)
            rise = self.start * self.gain * torque / self.scale * np.exp(-torque / self.scale) / self.factor(torque)
            tried = way - off / (1.0 - rise)
            after = np.where((tried > low) & (tried < high), tried, 0.5 * (low + high))
            moved, way = np.abs(after - way), after
            if not (moved > FINE * (1.0 + np.abs(way))).any():
                break
        found: Float = np.exp(way)
        return found

    def of_rows(self, index: NDArray[np.intp], rows: int, axes: int) -> "Engagement":
        """Return that of these rows out of so many, with axes behind."""
        numbers = (np.broadcast_to(np.asarray(value, dtype=float), (rows,))[index] for value in vars(self).values())
        start, gain, scale = (value[(..., *(np.newaxis,) * axes)] for value in numbers)
        return Engagement(start=start, gain=gain, scale=scale)


def engagement_of(drive: Drive) -> Engagement:
    """Return the engagement of a drive."""
    return Engagement(start=drive.engaged_factor, gain=drive.engaged_gain, scale=drive.engaged_torque)


# All engaged pairs of teeth together: who carries how much, and how stiff the mesh is

CHUNK = 2**15  # numbers at a time: they stay in the cache, and memory stays flat


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
        logarithms: NDArray[np.float64] = np.log(self.shares / self.shares[0])
        return logarithms


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

    def of_rows(self, index: NDArray[np.intp], rows: int, axes: int) -> "ToothPair":
        """Return the pair of these rows out of so many, with axes behind."""

        def taken(value: Float) -> NDArray[np.float64]:
            many: NDArray[np.float64] = np.broadcast_to(np.asarray(value, dtype=float), (rows,))[index]
            return many[(..., *(np.newaxis,) * axes)]

        law = micro.ContactLaw(taken(self.law.dimension), taken(self.law.pressure_ratio))
        numbers = {name: taken(getattr(self, name)) for name in ("scale", "film", "area_ratio", "compliance")}
        return ToothPair(law=law, **numbers)

    @property
    def numbers(self) -> tuple[Float, ...]:
        """All numbers of it."""
        return (
            self.law.dimension, self.law.pressure_ratio, self.scale, self.film, self.area_ratio, self.compliance,
        )  # fmt: skip

    def rough(self, size: Float) -> Float:
        """Return the stiffness of the rough contact alone at u, N/m."""
        return self.scale * micro.stiffness_share(size, self.law)

    def around(self, rough: Float, size: Float) -> Float:
        """Return the stiffness of the whole pair, N/m, from that of its rough contact."""
        if np.any(self.film):
            ratio, real = micro.area_shares(size, self.law)
            rough = rough + self.film * np.maximum(1.0 - self.area_ratio * ratio * real, 0.0)
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
    def plastic_share(self) -> Float:
        """The torque at which the first contact would turn elastic if there were just the pairs stated, N m."""
        torque: Float = self.plastic_limit * self.radius / self.arcs.shares[0]
        return torque

    @property
    def plastic_torque(self) -> Float:
        """The torque at which the first contact turns elastic, that of the pair that carries most, N m."""
        return self.engagement.torque_of(self.plastic_share)


def effective_radius(drive: Drive) -> Float:
    """Return the lever of the normal force of a pair about the axis, m."""
    return drive.pitch_radius * np.cos(drive.pressure_angle)


def mesh_of(drive: Drive, contact: Contact) -> DriveMesh:
    """Return the mesh of a drive; with more pairs each carries less."""
    return DriveMesh(
        pair=pair_of(drive, contact), arcs=arcs_of(drive.engaged_pairs), engagement=engagement_of(drive),
        radius=effective_radius(drive), plastic_limit=contact.plastic_limit,
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
    load: Float = np.abs(torque) * mesh.arcs.shares[0] / (mesh.radius * mesh.engagement.factor(torque))
    return load


def torque_logarithm(torque: Float, mesh: DriveMesh) -> Float:
    """Return ln(F/F_c) of the pair that carries most at a torque; for none a number far below 0."""
    return np.log(np.maximum(np.abs(torque), 1e-300) / (mesh.engagement.factor(torque) * mesh.plastic_share))


def normal_stiffness(torque: Float, mesh: DriveMesh) -> Float:
    """Return the stiffness of all engaged pairs along their normals, N/m; 0 where every contact is plastic."""
    given, factor = mesh.with_rows(torque_logarithm(torque, mesh), mesh.engagement.factor(torque))
    first, factor = np.atleast_1d(given), np.atleast_1d(factor)
    rows, found = len(first), np.empty(len(first))
    step = max(CHUNK // len(mesh.arcs.shares), 1)
    for start in range(0, rows, step):
        index = np.arange(start, min(start + step, rows))
        pair = mesh.pair.of_rows(index, rows, 1)
        size = micro.size_of(first[index, np.newaxis] + mesh.arcs.offsets, pair.law)
        found[index] = factor[index] * (pair.around(pair.rough(size), size) @ mesh.arcs.counts)
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


@dataclass(frozen=True)
class Panels:
    """Pieces of the ways of integration of all rows: the row, where a piece begins and how wide it is."""

    row: NDArray[np.intp]
    start: NDArray[np.float64]
    width: NDArray[np.float64]

    def in_pieces(self, count: int) -> "Iterator[Panels]":
        """Yield so many at a time."""
        for start in range(0, len(self.row), count):
            some = slice(start, start + count)
            yield Panels(self.row[some], self.start[some], self.width[some])


def mesh_torsion(torque: Float, reference: Float, mesh: DriveMesh) -> tuple[Float, Float]:
    """Return the torsion of the mesh from the reference to the size of the torque, rad, and that of its roughness.

    Both are 0 below the reference, and infinite where all contacts are plastic at the reference. The second one leaves
    out films and springs. Accuracy: 1e-9 of the value; with more than 250 pairs and a reference near the plastic limit
    1e-7.
    """
    begin, lever = mesh.plastic_torque, np.square(mesh.radius)
    given = mesh.with_rows(np.log(np.maximum(np.abs(torque), 1e-300) / begin), np.log(reference / begin), lever)
    last, first, lever = (np.atleast_1d(item) for item in given)
    rows = len(last)
    whole, rough = np.zeros(rows), np.zeros(rows)
    active = np.flatnonzero((last > first) & (first > 0.0))  # NaN is not
    for start in range(0, len(active), ROWS):
        index = active[start : start + ROWS]
        for piece in _panels(index, first, last, mesh).in_pieces(CHUNK // (len(RULE[0]) * len(mesh.arcs.shares)) + 1):
            for total, part in zip((whole, rough), _integrals(piece, mesh, rows), strict=True):
                np.add.at(total, piece.row, part)
    endless = (first <= 0.0) & (last > first)
    both = (np.where(endless, np.inf, total / lever) for total in (whole, rough))
    all_of_it, of_roughness = (value if np.ndim(given[0]) else value[0] for value in both)
    return all_of_it, of_roughness


def _way(size: Float) -> Float:
    """Return the variable of integration at u: like ln u where u is small, in proportion to u where it is large."""
    return np.log(np.expm1(TURN * size))


def _panels(index: NDArray[np.intp], first: NDArray[np.float64], last: NDArray[np.float64], mesh: DriveMesh) -> Panels:
    """Cut the way of these rows where a pair turns elastic, and further until no piece is too wide."""
    law = mesh.pair.of_rows(index, len(first), 1).law
    low, high = first[index, np.newaxis], last[index, np.newaxis]
    offsets = mesh.arcs.offsets
    some = np.unique(np.linspace(0, len(offsets) - 1, min(KINKS, len(offsets))).astype(int))
    ends = _onsets(index, offsets[some], mesh, len(first))
    kinks = np.log(ends[:, 1:] / ends[:, :1])
    marks = np.concatenate([low, np.clip(kinks, low, high), high], axis=1)
    ends = np.asarray(_way(micro.size_of(marks, law)))
    widths = np.nan_to_num(np.diff(ends, axis=1))  # rows that are refused have none
    counts = np.ceil(widths / WIDEST).astype(int).ravel()
    width = np.repeat(widths.ravel() / np.maximum(counts, 1), counts)
    behind = np.arange(len(width)) - np.repeat(np.cumsum(counts) - counts, counts)
    start = np.repeat(ends[:, :-1].ravel(), counts) + behind * width
    row = np.repeat(np.repeat(index, widths.shape[1]), counts)
    return Panels(row, start, width)


def _onsets(index: NDArray[np.intp], offsets: NDArray[np.float64], mesh: DriveMesh, rows: int) -> NDArray[np.float64]:
    """Return the torques at which pairs with these shares turn elastic, (rows asked for, shares)."""
    share = np.broadcast_to(np.asarray(mesh.plastic_share, dtype=float), (rows,))[index, np.newaxis]
    return np.asarray(mesh.engagement.of_rows(index, rows, 1).torque_of(share * np.exp(-offsets)))


def _integrals(panels: Panels, mesh: DriveMesh, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Integrate torque over stiffness on every panel: of the whole mesh, and of its roughness alone."""
    nodes, weights = RULE
    pair = mesh.pair.of_rows(panels.row, rows, 2)
    grown = np.exp(panels.start[:, np.newaxis] + panels.width[:, np.newaxis] * 0.5 * (nodes + 1.0))[..., np.newaxis]
    size = np.log1p(grown) / TURN
    begin, share = (
        np.broadcast_to(np.asarray(value, dtype=float), (rows,))[panels.row][:, np.newaxis, np.newaxis]
        for value in (mesh.plastic_torque, mesh.plastic_share)
    )
    torque = begin * np.exp(micro.load_logarithm(size, pair.law))
    factor = mesh.engagement.of_rows(panels.row, rows, 2).factor(torque)
    step = torque / factor * micro.load_slope(size, pair.law) * grown / ((1.0 + grown) * TURN)
    loads = np.log(torque / (factor * share)) + mesh.arcs.offsets
    whole, rough = _sums(np.asarray(micro.size_of(loads, pair.law)), pair, mesh)
    shares = 0.5 * panels.width[:, np.newaxis] * weights * step[..., 0]
    return (shares / whole).sum(axis=1), (shares / rough).sum(axis=1)


def _sums(
    size: NDArray[np.float64], pair: ToothPair, mesh: DriveMesh
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sums of the stiffnesses of all pairs: as they stand, and of their rough contacts alone."""
    alone = pair.rough(size)
    whole = pair.around(alone, size)
    rough: NDArray[np.float64] = alone @ mesh.arcs.counts
    return rough if whole is alone else whole @ mesh.arcs.counts, rough
