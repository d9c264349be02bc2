"""All engaged pairs of teeth together: who carries how much, and how stiff the mesh is."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import micro
from harmonic_fractal.contact import Contact
from harmonic_fractal.engagement import Engagement, engagement_of
from harmonic_fractal.quantities import Drive
from truing import Float

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
class Pair:
    """One pair in all that is needed for its stiffness at u: the rough contact, a film beside it, springs behind it.

    ``scale`` is that of the rough contact, N/m; ``film`` of a film over the whole flank, N/m; ``area_ratio`` the
    truncated area at a_L = a_c over that of the flank; ``compliance`` that of tooth and line contact, m/N.
    """

    law: micro.Law
    scale: Float
    film: Float
    area_ratio: Float
    compliance: Float

    def of_rows(self, index: NDArray[np.intp], rows: int, axes: int) -> "Pair":
        """Return the pair of these rows out of so many, with axes behind."""

        def taken(value: Float) -> NDArray[np.float64]:
            many: NDArray[np.float64] = np.broadcast_to(np.asarray(value, dtype=float), (rows,))[index]
            return many[(..., *(np.newaxis,) * axes)]

        law = micro.Law(taken(self.law.dimension), taken(self.law.pressure_ratio))
        numbers = {name: taken(getattr(self, name)) for name in ("scale", "film", "area_ratio", "compliance")}
        return Pair(law=law, **numbers)

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
class Mesh:
    """All engaged pairs: each of them, their places, how many come to bear, and the lever of their forces, m."""

    pair: Pair
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


def mesh_of(drive: Drive, contact: Contact) -> Mesh:
    """Return the mesh of a drive; with more pairs each carries less."""
    return Mesh(
        pair=pair_of(drive, contact), arcs=arcs_of(drive.engaged_pairs), engagement=engagement_of(drive),
        radius=effective_radius(drive), plastic_limit=contact.plastic_limit,
    )  # fmt: skip


def line_stiffness(drive: Drive, contact: Contact) -> Float:
    """Return the stiffness of two flanks that flatten as cylinders do, N/m (Yang and Sun 1985)."""
    return 0.5 * np.pi * contact.modulus * drive.face_width


def pair_of(drive: Drive, contact: Contact) -> Pair:
    """Return one pair with what stands around its rough contact."""
    tooth = 1.0 / (drive.tooth_stiffness * drive.modulus_factor)
    line = 1.0 / line_stiffness(drive, contact) if drive.line_contact else 0.0
    flank = drive.face_width * drive.flank_height
    return Pair(
        law=contact.law,
        scale=contact.stiffness_scale,
        film=drive.film_stiffness,
        area_ratio=contact.plastic_limit / contact.hardness / flank,
        compliance=np.where(np.isnan(tooth), 0.0, tooth) + line,
    )


def load_of_largest(torque: Float, mesh: Mesh) -> Float:
    """Return the normal load of the pair that carries most, N."""
    load: Float = np.abs(torque) * mesh.arcs.shares[0] / (mesh.radius * mesh.engagement.factor(torque))
    return load


def torque_logarithm(torque: Float, mesh: Mesh) -> Float:
    """Return ln(F/F_c) of the pair that carries most at a torque; for none a number far below 0."""
    return np.log(np.maximum(np.abs(torque), 1e-300) / (mesh.engagement.factor(torque) * mesh.plastic_share))


def normal_stiffness(torque: Float, mesh: Mesh) -> Float:
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
