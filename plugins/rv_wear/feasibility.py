"""What a mesh needs before its forces can be asked for: the sentence names the inputs and what to do."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rv_wear import cycloid
from rv_wear.mesh import Mesh
from rv_wear.teeth import pitch_number
from truing import feasible

ROUNDING = 1e-12  # m; interference below it is rounding of the inputs
LINE = 5.0  # depth number over the logarithm of the force above which the contact is narrow


class Demand(NamedTuple):
    """What must hold, one truth value per mesh, with the sentence for the engineer where it does not."""

    holds: NDArray[np.bool_]
    sentence: str


def demands(mesh: Mesh) -> Iterator[Demand]:
    """What the geometry must satisfy, in the order in which it builds up; NaN does not hold."""
    yield Demand(
        _all_positive(mesh),
        "pin_circle_radius, pin_radius, eccentricity, disc_width, output_torque, torque_share, young_modulus and "
        "reconstruction_depth must be greater than zero and finite, with all effects that act on them",
    )
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
    yield Demand(
        np.atleast_1d(np.asarray(pitch_number(mesh) - np.log(mesh.start_force)) > LINE),
        "the contact would be as wide as the pins: check the unit of output_torque, disc_width and young_modulus",
    )


def _all_positive(mesh: Mesh) -> NDArray[np.bool_]:
    """Which meshes have sizes, load and modulus to calculate with."""
    sizes = (mesh.pin_circle_radius, mesh.pin_radius, mesh.eccentricity, mesh.width)
    good: NDArray[np.bool_] = np.atleast_1d(np.asarray(mesh.equidistant + mesh.shift + mesh.poisson_ratio) < np.inf)
    for value in (*sizes, mesh.torque, mesh.young_modulus, mesh.threshold):
        good = good & (np.asarray(value) > 0.0) & (np.asarray(value) < np.inf)
    return good


def holding(mesh: Mesh) -> tuple[NDArray[np.bool_], list[Demand]]:
    """Which meshes (m,) can be calculated, and the demands that some of them do not meet."""
    good: NDArray[np.bool_] = np.ones(1, dtype=bool)
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
