"""Forces and histories of many meshes, which each are calculated once; those of a few are remembered."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rv_wear import coefficient, contact, cycloid
from rv_wear.history import NEVER, Histories, growth, histories, states
from rv_wear.mesh import Array, Choices, Film, Mesh, columns_of, with_columns
from rv_wear.sharing import shared, start_scale
from rv_wear.teeth import teeth_of

CHUNK = 256  # meshes at a time: their contacts stay in the cache of a core
FEW = 8  # so many meshes are calculated and remembered one by one
FEW_REMEMBERED = 64
GROUPS_REMEMBERED = 8  # a fit asks for the same rows again and again
FINENESS = 32  # a history reaches to the next power of two ^ (1 / 32), so that batches ask for the same one
SHORTEST = 1e-9
ROUNDING = 1e-9


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


@dataclass(frozen=True)
class Key:
    """Meshes as something to remember an answer by: their numbers as bytes, how many they are, and their choices."""

    numbers: bytes
    count: int
    choices: Choices
    has_film: bool


def key_of(mesh: Mesh, places: NDArray[np.intp]) -> Key:
    """Some of many meshes (m,)."""
    table = np.stack([np.asarray(column)[places] for column in columns_of(mesh)])
    return Key(table.tobytes(), len(places), mesh.choices, mesh.film is not None)


def mesh_from(key: Key) -> Mesh:
    """The meshes of a key."""
    film = Film(0.0, 0.0, 0.0, 0.0, 0.0) if key.has_film else None
    blank = Mesh(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, key.choices, film)
    return with_columns(blank, list(np.frombuffer(key.numbers).reshape(-1, key.count)))


def unworn(mesh: Mesh) -> Unworn:
    """Solve the new meshes (m,) at every position of the disc."""
    teeth = teeth_of(mesh)
    loads = shared(teeth, teeth.slack, start_scale(teeth))
    force = loads.force.reshape(-1, teeth.count)
    at_pitch_point = cycloid.relative_radius(teeth.mesh, cycloid.longest_arm_angle(teeth.mesh))
    scale = loads.scale.max(axis=0)
    fastest = growth(teeth, loads)(loads.force).max(axis=(0, 1))
    return Unworn(
        scale=scale,
        approach=loads.approach.max(axis=0),
        largest_force=force.max(axis=0),
        loaded_pins=(loads.force > 0.0).sum(axis=0).max(axis=0).astype(float),
        pressure=np.asarray(contact.mean_pressure(teeth.mesh, loads.force, teeth.relative_radius)).max(axis=(0, 1)),
        contact_part=np.asarray(
            coefficient.contact_part(teeth.mesh.equivalent_modulus, scale / teeth.mesh.width, at_pitch_point)
        ),
        lowest_equidistant=np.asarray(cycloid.lowest_equidistant(teeth.mesh)),
        first_step=np.where(fastest > 0.0, teeth.mesh.threshold / np.maximum(fastest, 1.0 / NEVER), NEVER),
    )


def history(key: Key, power: int) -> Histories:
    """Histories of the meshes of a key, each over 2 ^ (power / FINENESS) times the exposure of its first step."""
    teeth = teeth_of(mesh_from(key))
    return histories(teeth, next(states(teeth)).lasts * 2.0 ** (power / FINENESS))


unworn_of_one = lru_cache(maxsize=FEW_REMEMBERED)(lambda key: unworn(mesh_from(key)))
unworn_of_group = lru_cache(maxsize=GROUPS_REMEMBERED)(lambda key: unworn(mesh_from(key)))
history_of_one = lru_cache(maxsize=FEW_REMEMBERED)(history)
history_of_group = lru_cache(maxsize=GROUPS_REMEMBERED)(history)


def groups(order: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Part meshes into groups that are calculated at once; a few of them are alone each."""
    size = CHUNK if len(order) > FEW else 1
    return [order[start : start + size] for start in range(0, len(order), size)]


def all_unworn(mesh: Mesh, count: int) -> Unworn:
    """The new meshes, all of them."""
    if count == 0:
        return unworn_of_nothing()
    solve = unworn_of_group if count > FEW else unworn_of_one
    parts = [solve(key_of(mesh, places)) for places in groups(np.arange(count))]
    names = Unworn.__dataclass_fields__
    return Unworn(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def unworn_of_nothing() -> Unworn:
    """The answer where no mesh can be calculated."""
    return Unworn(*(np.empty(0) for _ in Unworn.__dataclass_fields__))


def all_histories(mesh: Mesh, reach: Array, first_step: Array) -> Iterator[tuple[NDArray[np.intp], Histories]]:
    """Histories to an exposure (m,) each, in groups of about the same length: the places of their meshes, and they."""
    steps = np.maximum(reach / first_step, SHORTEST)
    follow = history_of_group if len(reach) > FEW else history_of_one
    order = np.argsort(steps, kind="stable") if len(reach) > CHUNK else np.arange(len(reach))
    for places in groups(order):
        power = int(np.ceil(FINENESS * np.log2(steps[places].max()) + ROUNDING))
        yield places, follow(key_of(mesh, places), power)
