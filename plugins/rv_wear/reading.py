"""Reading wear off the histories: which exposure of which mesh a row of a batch has, and how deep it has worn."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rv_wear.courses import Unworn, all_histories
from rv_wear.history import Histories
from rv_wear.mesh import Array, Mesh
from truing import Float

FEW_ROWS = 4  # so many rows of a mesh are read together with those of the others


@dataclass(frozen=True)
class Meshes:
    """The distinct meshes that can be calculated, and for every row its place among them (-1: none, None: all one)."""

    mesh: Mesh
    count: int
    place: NDArray[np.intp] | None

    def to_rows(self, values: Array) -> Float:
        """Give every row the value of its mesh; NaN where it has none."""
        if self.place is None:
            return np.float64(values[0]) if self.count else np.float64(np.nan)
        return np.append(values, np.nan)[self.place]


def depth_at(meshes: Meshes, new: Unworn, exposure: Float) -> tuple[Float, Float]:
    """Largest wear (m) and its phase angle at an exposure of every row; NaN where a row has no mesh or goes too far."""
    rows = np.atleast_1d(np.asarray(exposure, dtype=float))
    if meshes.place is not None:
        return _of_many(meshes, meshes.place, new, np.broadcast_to(rows, meshes.place.shape))
    depth = angle = np.full(rows.shape, np.nan)
    for _, history in all_histories(meshes.mesh, _reach(rows, None, meshes.count), new.first_step):
        depth, angle = _read(history, 0, rows)
    return (depth, angle) if np.ndim(exposure) else (np.float64(depth[0]), np.float64(angle[0]))


def _of_many(meshes: Meshes, place: NDArray[np.intp], new: Unworn, rows: Array) -> tuple[Array, Array]:
    """Read every row from the history of its own mesh."""
    depth, angle = np.full(rows.shape, np.nan), np.full(rows.shape, np.nan)
    order = np.argsort(place, kind="stable")
    ends = np.searchsorted(place[order], np.arange(meshes.count + 1))
    for places, history in all_histories(meshes.mesh, _reach(rows, place, meshes.count), new.first_step):
        parts = [order[ends[mesh] : ends[mesh + 1]] for mesh in places]
        mine = np.concatenate(parts)
        if len(mine) <= FEW_ROWS * len(places):
            columns = np.repeat(np.arange(len(places)), [len(part) for part in parts])
            depth[mine], angle[mine] = _read_each(history, columns, rows[mine])
            continue
        for column, part in enumerate(parts):
            depth[part], angle[part] = _read(history, column, rows[part])
    return depth, angle


def _read_each(history: Histories, columns: NDArray[np.intp], exposure: Array) -> tuple[Array, Array]:
    """Depth and angle at exposures (n,), each of its own mesh; the depth is NaN beyond the last node."""
    last = len(history.exposure) - 1
    nodes = history.exposure[:, columns]
    passed = np.minimum((nodes <= exposure).sum(axis=0), last)
    before = np.maximum(passed - 1, 0), columns
    after = passed, columns
    slope = (history.depth[after] - history.depth[before]) / (history.exposure[after] - history.exposure[before])
    depth = slope * (exposure - history.exposure[before]) + history.depth[before]
    at = np.minimum((nodes < exposure).sum(axis=0), last)
    return np.where(exposure <= nodes[-1], depth, np.nan), history.angle[at, columns]


def _reach(rows: Array, place: NDArray[np.intp] | None, count: int) -> Array:
    """How far (m,) the histories are asked for; a row without a number asks for nothing."""
    reach = np.zeros(count)
    if place is None:
        most = rows.max(initial=0.0)
        reach[:] = most if np.isfinite(most) else rows.max(initial=0.0, where=np.isfinite(rows))
    else:
        asked = (place >= 0) & np.isfinite(rows)
        np.maximum.at(reach, place[asked], rows[asked])
    return reach


def _read(history: Histories, column: int, exposure: Array) -> tuple[Array, Array]:
    """Depth and angle at exposures (n,) of one mesh; the depth is NaN beyond the last node."""
    nodes, depths, angles = (values[:, column] for values in (history.exposure, history.depth, history.angle))
    if len(exposure) > len(nodes) and np.isfinite(exposure).all():  # most rows of a batch lie close together
        first, last = np.searchsorted(nodes, [exposure.min(), exposure.max()])
        kept = slice(max(first - 1, 0), last + 1)
        nodes, depths, angles = nodes[kept], depths[kept], angles[kept]
    depth = np.interp(exposure, nodes, depths, right=np.nan)
    turns = np.flatnonzero(angles[1:] != angles[:-1])
    if not len(turns):
        return depth, np.full(exposure.shape, angles[-1])
    return depth, np.append(angles[turns], angles[-1])[np.searchsorted(nodes[turns], exposure)]
