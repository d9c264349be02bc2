"""What a mesh needs before its forces can be asked for: the sentence names the inputs and what to do."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rv_wear import cycloid
from rv_wear.mesh import Mesh
from truing import feasible

ROUNDING = 1e-12  # m; interference below it is rounding of the inputs


class Demand(NamedTuple):
    """What must hold, one truth value per mesh, with the sentence for the engineer where it does not."""

    holds: NDArray[np.bool_]
    sentence: str


def demands(mesh: Mesh) -> Iterator[Demand]:
    """What the geometry must satisfy, in the order in which it builds up; NaN does not hold."""
    short_width = np.atleast_1d(np.asarray(mesh.short_width))
    yield Demand(
        (short_width > 0.0) & (short_width < 1.0),
        "the short-width coefficient must lie between 0 and 1: reduce eccentricity or pin_count, or enlarge "
        "pin_circle_radius, until eccentricity * pin_count < pin_circle_radius",
    )
    yield Demand(
        np.atleast_1d(mesh.pin_radius < cycloid.smallest_convex_radius(mesh)),
        "the pins undercut the disc: pin_radius must be smaller than the smallest radius of the convex flank; reduce "
        "pin_radius or eccentricity, or enlarge pin_circle_radius",
    )
    yield Demand(
        np.atleast_1d(mesh.pin_radius < mesh.pin_circle_radius * np.sin(np.pi / mesh.choices.pin_count)),
        "neighbouring pins overlap: reduce pin_radius or pin_count, or enlarge pin_circle_radius, until "
        "pin_radius < pin_circle_radius * sin(pi / pin_count)",
    )
    yield Demand(
        np.atleast_1d(mesh.radial_clearance >= -ROUNDING),
        "the radial clearance is negative: equidistant_modification must not be smaller than shift_modification",
    )
    yield Demand(
        np.atleast_1d(mesh.root * mesh.equidistant - mesh.shift >= -ROUNDING),
        "disc and pins interfere: equidistant_modification lies above its upper limit at this radial clearance; "
        "reduce equidistant_modification, or shift_modification, until "
        "sqrt(1 - short_width^2) * equidistant_modification >= shift_modification",
    )


def holding(mesh: Mesh) -> tuple[NDArray[np.bool_], list[Demand]]:
    """Which meshes (m,) can be calculated, and the demands that some of them do not meet."""
    count = np.broadcast_shapes(*(np.shape(np.atleast_1d(x)) for x in (mesh.short_width, mesh.shift, mesh.pin_radius)))
    good = np.ones(count, dtype=bool)
    broken = []
    with np.errstate(invalid="ignore", divide="ignore"):
        for demand in demands(mesh):
            good = good & demand.holds
            if not demand.holds.all():
                broken.append(demand)
    return good, broken


def refuse(broken: list[Demand], mesh_of_row: NDArray[np.intp] | None) -> None:
    """Refuse the rows whose mesh cannot be calculated, each with the first sentence that applies."""
    for demand in broken:
        feasible(bool(demand.holds[0]) if mesh_of_row is None else demand.holds[mesh_of_row], demand.sentence)
