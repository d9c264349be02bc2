"""Torsion of the mesh: the integral of its compliance over the torque, from a reference torque on.

From torque 0 it would be infinite: below a small load all contacts are plastic, the model has no stiffness there, and
just above it rises in proportion to what is beyond, so that the integral of 1/K grows without end, as a logarithm.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import micro
from harmonic_fractal.mesh import CHUNK, Mesh, Pair
from truing import Float

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


def mesh_torsion(torque: Float, reference: Float, mesh: Mesh) -> tuple[Float, Float]:
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


def _panels(index: NDArray[np.intp], first: NDArray[np.float64], last: NDArray[np.float64], mesh: Mesh) -> Panels:
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


def _onsets(index: NDArray[np.intp], offsets: NDArray[np.float64], mesh: Mesh, rows: int) -> NDArray[np.float64]:
    """Return the torques at which pairs with these shares turn elastic, (rows asked for, shares)."""
    share = np.broadcast_to(np.asarray(mesh.plastic_share, dtype=float), (rows,))[index, np.newaxis]
    return np.asarray(mesh.engagement.of_rows(index, rows, 1).torque_of(share * np.exp(-offsets)))


def _integrals(panels: Panels, mesh: Mesh, rows: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
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


def _sums(size: NDArray[np.float64], pair: Pair, mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sums of the stiffnesses of all pairs: as they stand, and of their rough contacts alone."""
    alone = pair.rough(size)
    whole = pair.around(alone, size)
    rough: NDArray[np.float64] = alone @ mesh.arcs.counts
    return rough if whole is alone else whole @ mesh.arcs.counts, rough
