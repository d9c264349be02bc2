"""Curves for figures and tests: plain numpy out of one reducer or of many, every Float a number or an array (n,); SI.

Curves over the phase angle have the shape (n, k), those over the time (n, t); n is 1 for one reducer.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from rv_wear import cycloid
from rv_wear.courses import unworn
from rv_wear.feasibility import holding, refuse
from rv_wear.history import wear_at
from rv_wear.mesh import Array, Mesh, many, mesh_of
from rv_wear.quantities import Reducer
from rv_wear.sharing import Loads, shared, start_scale
from rv_wear.teeth import Teeth, teeth_of
from rv_wear.wear import exposure_of, oil_part, worn

CLOSE = 1e-13  # m
ROUNDS = 100
Bound = Literal["double_clearance", "approach"]


@dataclass(frozen=True)
class Flank:
    """The loaded side of the disc over the phase angle (k,): clearance with wear, wear, and pin forces, each (n, k)."""

    angle: Array
    clearance: Array
    wear: Array
    force: Array


def flank(reducer: Reducer, time: float = 0.0) -> Flank:
    """Clearance, wear and forces at every contact of the loaded side after a time (s), 0: new.

    The wear is that of the law alone, without ``depth_factor`` and ``extra_wear``. Raises InfeasibleError.
    """
    teeth, loads, wear = worn_mesh(reducer, time)
    mesh = teeth.mesh
    clearance = np.asarray(cycloid.clearance(mesh, teeth.angle)) + wear
    return Flank(teeth.angle.reshape(-1), _rows(clearance), _rows(wear), _rows(loads.force))


def worn_mesh(reducer: Reducer, time: float = 0.0) -> tuple[Teeth, Loads, Array]:
    """Contacts, loads and wear (pins, phases, n) after a time (s)."""
    reducer = _in_rows(reducer)
    teeth = teeth_of(_feasible(mesh_of(reducer)))
    exposure = np.broadcast_to(np.asarray(exposure_of(reducer, oil_part(reducer), time)), (teeth.count,))
    wear = wear_at(teeth, exposure) if time > 0.0 else np.zeros_like(teeth.slack)
    return teeth, shared(teeth, teeth.slack + wear / teeth.relative_arm, start_scale(teeth)), wear


def wear_over_time(reducer: Reducer, times: ArrayLike) -> Array:
    """Largest wear (n, t) after each time (s), with everything that the inputs say. Raises InfeasibleError."""
    rows = _in_rows(reducer)
    moments = [np.asarray(worn(replace(rows, working_time=time)).depth) for time in np.asarray(times, dtype=float)]
    return np.stack([np.atleast_1d(moment) for moment in moments], axis=-1)


def clearance_over_angle(reducer: Reducer, angle: ArrayLike) -> Array:
    """Normal clearance (n, k) of the new disc at phase angles (k,) from 0 to pi."""
    mesh = many(mesh_of(reducer))
    return np.asarray(cycloid.clearance(mesh, np.asarray(angle, dtype=float)[:, None])).T


def profile_points(reducer: Reducer, count: int = 2000) -> tuple[Array, Array]:
    """Points x and y (count,) of the whole ground profile of one disc, in its own frame; the last is the first."""
    x, y = cycloid.profile(mesh_of(reducer), np.linspace(0.0, 2.0 * np.pi, count))
    return np.asarray(x), np.asarray(y)


def allowed_equidistant(reducer: Reducer, lower: Bound = "double_clearance") -> tuple[Array, Array]:
    """Smallest and largest equidistant modification (n,) of equation 17 at the radial clearance of the reducer.

    Above the largest one disc and pins interfere. Below the smallest one the clearance somewhere exceeds, as *lower*
    says, twice the radial clearance, or the approach under load at that very modification, so that pins there never
    bear. Which of them the paper meant is not stated; its printed bound follows from the first.
    """
    mesh = _feasible(mesh_of(_in_rows(reducer)))
    lowest = cycloid.lowest_equidistant(mesh)
    if lower == "approach":
        lowest = _lowest_by_approach(mesh)
    return np.asarray(lowest), np.asarray(cycloid.highest_equidistant(mesh))


def _lowest_by_approach(mesh: Mesh) -> Array:
    """The modification whose largest clearance is its own approach: tried again with what was found until it stays."""
    radial, trial = mesh.radial_clearance, np.asarray(mesh.equidistant)
    for _ in range(ROUNDS):
        tried = replace(mesh, equidistant=trial, shift=trial - radial)
        found = np.asarray(cycloid.lowest_equidistant(mesh, unworn(tried).approach))
        if np.all(np.abs(found - trial) <= CLOSE):
            break
        trial = found
    return found


def _rows(values: Array) -> Array:
    return np.ascontiguousarray(values.reshape(-1, values.shape[-1]).T)


def _feasible(mesh: Mesh) -> Mesh:
    mesh = many(mesh)
    good, broken = holding(mesh)
    refuse(broken, None if len(good) == 1 else np.arange(len(good)))
    return mesh


def _in_rows(reducer: Reducer) -> Reducer:
    """The same with every Float as long as the longest, where one is an array."""
    values = {each.name: getattr(reducer, each.name) for each in fields(reducer)}
    arrays = [value for value in values.values() if isinstance(value, np.ndarray) and value.ndim]
    if not arrays:
        return reducer
    rows = max(len(value) for value in arrays)
    wide: dict[str, Any] = {
        name: np.broadcast_to(value, (rows,))
        for name, value in values.items()
        if isinstance(value, float | np.ndarray | np.floating)
    }
    return replace(reducer, **wide)
