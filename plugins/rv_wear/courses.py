"""Forces and histories of many meshes, which each are calculated once; those of a few are remembered."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rv_wear import coefficient, contact, cycloid
from rv_wear.history import NEVER, Histories, growth, histories
from rv_wear.mesh import Array, Choices, Film, Mesh, columns_of, some_of, with_columns
from rv_wear.sharing import shared, start_scale
from rv_wear.teeth import teeth_of

CHUNK = 256  # meshes at a time: their contacts stay in the cache of a core
FEW = 8  # so many meshes are looked for among the remembered ones
REMEMBERED = 64
FINENESS = 4  # a history reaches to the next power of two ^ (1 / 4), so that batches ask for the same one


@dataclass(frozen=True)
class Unworn:
    """The new mesh: forces (N), approach (m), pressure (Pa), contact part of the wear coefficient; one per mesh (m,).

    ``first_step`` is the exposure until the first reconstruction, ``lowest_equidistant`` the bound of equation 17.
    """

    scale: Array
    approach: Array
    largest_force: Array
    loaded_pins: Array
    pressure: Array
    contact_part: Array
    lowest_equidistant: Array
    first_step: Array


Key = tuple[tuple[float, ...], Choices, bool]


def key_of(mesh: Mesh, place: int) -> Key:
    """One of many meshes as plain numbers."""
    return tuple(float(np.asarray(column)[place]) for column in columns_of(mesh)), mesh.choices, mesh.film is not None


def mesh_from(key: Key) -> Mesh:
    """The mesh of a key."""
    numbers, choices, has_film = key
    film = Film(0.0, 0.0, 0.0, 0.0, 0.0) if has_film else None
    blank = Mesh(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, choices, film)
    return with_columns(blank, [np.array([number]) for number in numbers])


def unworn(mesh: Mesh) -> Unworn:
    """Solve the new meshes (m,) at every position of the disc."""
    teeth = teeth_of(mesh)
    loads = shared(teeth, teeth.slack, start_scale(teeth))
    force = loads.force.reshape(-1, teeth.count)
    radius = teeth.relative_radius.reshape(-1, teeth.count)
    place = force.argmax(axis=0)[None]
    largest, its_radius = (np.take_along_axis(values, place, axis=0)[0] for values in (force, radius))
    fastest = growth(teeth, loads)(loads.force).max(axis=(0, 1))
    return Unworn(
        scale=loads.scale.max(axis=0),
        approach=loads.approach.max(axis=0),
        largest_force=largest,
        loaded_pins=(loads.force > 0.0).sum(axis=0).max(axis=0).astype(float),
        pressure=np.asarray(contact.mean_pressure(teeth.mesh, loads.force, teeth.relative_radius)).max(axis=(0, 1)),
        contact_part=np.asarray(
            coefficient.contact_part(teeth.mesh.equivalent_modulus, largest / teeth.mesh.width, its_radius)
        ),
        lowest_equidistant=np.asarray(cycloid.lowest_equidistant(teeth.mesh)),
        first_step=np.where(fastest > 0.0, teeth.mesh.threshold / np.maximum(fastest, 1.0 / NEVER), NEVER),
    )


@lru_cache(maxsize=REMEMBERED)
def unworn_of_one(key: Key) -> Unworn:
    """The new mesh of a key."""
    return unworn(mesh_from(key))


@lru_cache(maxsize=REMEMBERED)
def history_of_one(key: Key, power: int) -> Histories:
    """The history of a key to the exposure 2 ^ (power / FINENESS)."""
    return histories(teeth_of(mesh_from(key)), np.array([2.0 ** (power / FINENESS)]))


def all_unworn(mesh: Mesh, count: int) -> Unworn:
    """The new meshes, all of them."""
    if count == 0:
        return unworn_of_nothing()
    if count <= FEW:
        parts = [unworn_of_one(key_of(mesh, place)) for place in range(count)]
    else:
        places = np.arange(count)
        parts = [unworn(some_of(mesh, places[start : start + CHUNK])) for start in range(0, count, CHUNK)]
    names = Unworn.__dataclass_fields__
    return Unworn(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def unworn_of_nothing() -> Unworn:
    """The answer where no mesh can be calculated."""
    return Unworn(*(np.empty(0) for _ in Unworn.__dataclass_fields__))


def all_histories(mesh: Mesh, reach: Array, first_step: Array) -> Iterator[tuple[NDArray[np.intp], Histories]]:
    """Histories to an exposure (m,) each, in groups of about the same length: the places of their meshes, and they."""
    if len(reach) <= FEW:
        for place, most in enumerate(reach):
            power = int(np.ceil(FINENESS * np.log2(max(float(most), 1e-300))))
            yield np.array([place]), history_of_one(key_of(mesh, place), power)
        return
    order = np.argsort(reach / first_step, kind="stable")
    for start in range(0, len(order), CHUNK):
        places = order[start : start + CHUNK]
        yield places, histories(teeth_of(some_of(mesh, places)), reach[places])
