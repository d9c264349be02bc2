"""What the teeth know of a reducer: one entry per distinct mesh, and which row of a batch runs on which mesh."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from rv_wear.quantities import Reducer
from truing import Float

Array = NDArray[np.float64]
Truths = NDArray[np.bool_]


@dataclass(frozen=True)
class Choices:
    """What is one value for a whole call: numbers of pins and positions, and the ways of calculating."""

    pin_count: int = 40
    phases: int = 8
    load_sharing: str = "linear"
    wear_coefficient: str = "pointwise"


@dataclass(frozen=True)
class Film:
    """Oil between disc and pins: pressure-viscosity coefficient, viscosity, output speed (1/s), roughness, share."""

    pressure_viscosity: Float
    viscosity: Float
    speed: Float
    roughness: Float
    factor: Float


@dataclass(frozen=True)
class Mesh:
    """One disc among its pins, or many of them: every field but the last two is a number or an array (m,), in SI."""

    pin_circle_radius: Float
    pin_radius: Float
    eccentricity: Float
    width: Float
    equidistant: Float
    shift: Float
    torque: Float
    young_modulus: Float
    poisson_ratio: Float
    threshold: Float
    choices: Choices = Choices()
    film: Film | None = None

    @property
    def short_width(self) -> Float:
        """Short-width coefficient K_1."""
        return self.eccentricity * self.choices.pin_count / self.pin_circle_radius

    @property
    def root(self) -> Float:
        """Sine q of the phase angle of the longest arm."""
        return np.sqrt(1.0 - self.short_width**2)

    @property
    def longest_arm(self) -> Float:
        """Radius of the pitch circle of the disc, where the arm of the contact force is longest."""
        return self.eccentricity * (self.choices.pin_count - 1)

    @property
    def radial_clearance(self) -> Float:
        """Clearance between disc and pins before the disc is turned."""
        return self.equidistant - self.shift

    @property
    def equivalent_modulus(self) -> Float:
        """Modulus E' of the contact in the convention of film theory."""
        return self.young_modulus / (1.0 - self.poisson_ratio**2)

    @property
    def start_force(self) -> Float:
        """Largest force between disc and pins without any clearance, equation 1."""
        return 4.0 * self.torque / (self.short_width * (self.choices.pin_count - 1) * self.pin_circle_radius)


NUMBERS = tuple(each.name for each in fields(Mesh) if each.name not in {"choices", "film"})
FILM_NUMBERS = tuple(each.name for each in fields(Film))


def mesh_of(reducer: Reducer) -> Mesh:
    """The mesh of a reducer, numbers and arrays as they are; the oil belongs to it only where a film is asked for."""
    film = Film(
        pressure_viscosity=reducer.pressure_viscosity,
        viscosity=reducer.oil_viscosity,
        speed=reducer.output_speed,
        roughness=reducer.composite_roughness,
        factor=reducer.film_factor,
    )
    return Mesh(
        pin_circle_radius=reducer.pin_circle_radius,
        pin_radius=reducer.pin_radius,
        eccentricity=reducer.eccentricity,
        width=reducer.disc_width,
        equidistant=reducer.equidistant_modification,
        shift=reducer.shift_modification,
        torque=reducer.torque_share * reducer.output_torque,
        young_modulus=reducer.young_modulus,
        poisson_ratio=reducer.poisson_ratio,
        threshold=reducer.reconstruction_depth,
        choices=Choices(reducer.pin_count, reducer.phases, reducer.load_sharing, reducer.wear_coefficient),
        film=film if np.any(np.asarray(reducer.film_factor) > 0.0) else None,
    )


def columns_of(mesh: Mesh) -> list[Float]:
    """The numbers of a mesh in a fixed order, those of its film last."""
    own: list[Float] = [getattr(mesh, name) for name in NUMBERS]
    return own + ([] if mesh.film is None else [getattr(mesh.film, name) for name in FILM_NUMBERS])


def with_columns(mesh: Mesh, columns: list[Float]) -> Mesh:
    """The same choices with other numbers, in the order of ``columns_of``."""
    own = dict(zip(NUMBERS, columns, strict=False))
    film = Film(**dict(zip(FILM_NUMBERS, columns[len(NUMBERS) :], strict=True))) if mesh.film is not None else None
    return Mesh(**own, choices=mesh.choices, film=film)


def distinct(mesh: Mesh) -> tuple[Mesh, NDArray[np.intp] | None]:
    """The distinct meshes (m,) and the mesh of every row; None where all rows have the same one.

    Rows that follow each other with the same mesh are taken together first: a batch usually comes design by design.
    """
    columns = [np.asarray(column, dtype=float) for column in columns_of(mesh)]
    varying = [place for place, column in enumerate(columns) if column.ndim and (column != column[0]).any()]
    heads = [column.reshape(-1)[:1] for column in columns]
    if not varying:
        return with_columns(mesh, list(heads)), None
    table = np.stack([columns[place] for place in varying])
    starts = np.flatnonzero(np.concatenate([[True], (table[:, 1:] != table[:, :-1]).any(axis=0)]))
    found, back = np.unique(table[:, starts], axis=1, return_inverse=True)
    for row, place in enumerate(varying):
        heads[place] = found[row]
    filled = [np.broadcast_to(head, found.shape[1:]) for head in heads]
    runs = np.diff(np.append(starts, table.shape[1]))
    return with_columns(mesh, list(filled)), np.repeat(back.reshape(-1), runs)


def some_of(mesh: Mesh, index: NDArray[np.intp]) -> Mesh:
    """Some of many meshes (m,), in the order of ``index``."""
    return with_columns(mesh, [np.ascontiguousarray(np.asarray(column)[index]) for column in columns_of(mesh)])


def many(mesh: Mesh) -> Mesh:
    """The same with every number as an array (m,), also where there is one mesh only."""
    columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(column, dtype=float)) for column in columns_of(mesh)))
    return with_columns(mesh, [np.ascontiguousarray(column) for column in columns])
