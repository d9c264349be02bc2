"""How the pins share the torque, and what a mesh needs before its forces can be asked for."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rv_wear import geometry
from rv_wear.geometry import Mesh, Teeth, pitch_number
from truing import Array, feasible

# How the pins share the torque: equations 1b to 4 with rigid take-up, solved for all meshes and positions at once
#
# The *slack* of a pin is its clearance over its relative arm: how far the pitch point must move until the pin touches.
# Before each solution the least slack of a position is taken up, since the disc turns freely until the first pin
# touches. Then pin i bears what is left of the approach:
#
#     F_i = (F / delta) (l_i / l_max) (delta - slack_i),   delta from F by equation 1b   (linear sharing)
#     F_i by equation 1b from (l_i / l_max) (delta - slack_i) with its own radii          (Hertz sharing)
#
# The torque is convex in F, so Newton's rule with the pins that bear at the moment comes down to the answer from above;
# each position stops for itself, so an answer does not depend on what else is calculated in the same call.

CLOSE = 1e-8  # Newton's rule squares it with its last step
ROUNDS = 100


@dataclass(frozen=True)
class Loads:
    """Force at the longest arm, approach there and take-up (phases, m), forces of the pins (pins, phases, m)."""

    scale: Array
    approach: Array
    taken: Array
    force: Array


def start_scale(teeth: Teeth) -> Array:
    """Forces (phases, m) from which the first solution starts: those without clearance."""
    return np.broadcast_to(np.asarray(teeth.mesh.start_force), teeth.torque.shape).copy()


def shared(teeth: Teeth, slack: Array, guess: Array) -> Loads:
    """Forces of all pins for these slacks (pins, phases, m), by the sharing that the mesh was given.

    *guess* are forces at the longest arm (phases, m), above 0.
    """
    taken = slack.min(axis=0)
    if teeth.mesh.choices.load_sharing == "hertz":
        scale, approach, force = hertz(teeth, slack - taken, guess)
    else:
        scale, approach, force = linear(teeth, slack, taken, guess)
    return Loads(scale, approach, taken, force)


class Line(NamedTuple):
    """Numbers of positions (k,): compliance and depth number of equation 1b, torque and take-up."""

    compliance: Array
    number: Array
    torque: Array
    taken: Array

    def approach(self, scale: Array) -> Array:
        """Approach at the longest arm under the force there, equation 1b."""
        return self.compliance * scale * (self.number - np.log(scale))


def linear(teeth: Teeth, slack: Array, taken: Array, guess: Array) -> tuple[Array, Array, Array]:
    """Forces in proportion to the approach, as in the paper: scale, approach, pin forces."""
    pins = len(slack)
    line = Line(*(values.reshape(-1) for values in (teeth.compliance, teeth.depth_number, teeth.torque, taken)))
    settled = _settled(teeth.weight.reshape(pins, -1), slack.reshape(pins, -1), line, guess.reshape(-1))
    scale, approach = (values.reshape(guess.shape) for values in settled)
    force = (approach + taken) - slack
    np.maximum(force, teeth.nothing, out=force)  # much faster than with the number 0
    force *= teeth.relative_arm
    force *= scale / approach
    return scale, approach, force


def _settled(weight: Array, slack: Array, line: Line, scale: Array) -> tuple[Array, Array]:
    """Force and approach at the longest arm (k,) of positions with pins (pins, k), all with the pins that then bear.

    Where other pins bear than were thought, those positions are solved again.
    """
    touching = slack < line.approach(scale) + line.taken
    bearing = weight * touching
    stiffness = _total(bearing)
    bearing *= slack
    scale = _balanced(stiffness, _total(bearing) - line.taken * stiffness, line, scale)
    approach = line.approach(scale)
    others = (slack < approach + line.taken) != touching
    if others.any():
        again = np.flatnonzero(others.any(axis=0))
        some = Line(*(values[again] for values in line))
        scale[again], approach[again] = _settled(weight[:, again], slack[:, again], some, scale[again])
    return scale, approach


def _total(values: Array) -> Array:
    """Sum over the pins, in the same order however many positions there are."""
    positions = values.shape[1]
    wide = values if positions > 1 else np.repeat(values, 2, axis=1)  # of a single column numpy would add pairs
    value: Array = wide.sum(axis=0)[:positions]
    return value


def _balanced(stiffness: Array, lost: Array, line: Line, scale: Array) -> Array:
    """Force at which these pins hold the torque: F A - (F / delta) B = T, solved by Newton's rule."""
    compliance, number, torque, _ = line
    moving = np.ones(scale.shape, dtype=bool)
    for _ in range(ROUNDS):
        left = number - np.log(scale)
        reduced = lost / (compliance * left)  # (F / delta) B
        step = (scale * stiffness - reduced - torque) / (stiffness - reduced / (scale * left))
        scale = np.where(moving, np.maximum(scale - step, 0.1 * scale), scale)
        moving = moving & (np.abs(step) > CLOSE * scale)
        if not moving.any():
            break
    return scale


def hertz(teeth: Teeth, slack: Array, guess: Array) -> tuple[Array, Array, Array]:
    """Forces by equation 1b at every pin with its own radii: force at the longest arm, approach, pin forces."""
    mesh = teeth.mesh
    profile_radius = np.asarray(geometry.profile_radius(mesh, teeth.angle))
    number = np.asarray(geometry.depth_number(mesh, profile_radius, teeth.relative_radius))
    approach = teeth.compliance * guess * (teeth.depth_number - np.log(guess))
    lever = teeth.weight / teeth.relative_arm
    moving = np.ones(approach.shape, dtype=bool)
    for _ in range(ROUNDS):
        force = np.asarray(geometry.force_of(mesh, teeth.relative_arm * (approach - slack), number))
        soft = teeth.compliance * np.maximum(number - np.log(np.where(force > 0.0, force, 1.0)) - 1.0, 1.0)
        slope = np.where(force > 0.0, teeth.weight / soft, 0.0).sum(axis=0)
        step = ((force * lever).sum(axis=0) - teeth.torque) / slope
        approach = np.where(moving, np.maximum(approach - step, 0.5 * approach), approach)
        moving = moving & (np.abs(step) > CLOSE * approach)
        if not moving.any():
            break
    force = np.asarray(geometry.force_of(mesh, teeth.relative_arm * (approach - slack), number))
    return np.asarray(geometry.force_of(mesh, approach, teeth.depth_number)), approach, force


# What a mesh needs before its forces can be asked for: the sentence names the inputs and what to do

ROUNDING = 1e-12  # m; interference below it is rounding of the inputs
LINE = 5.0  # depth number over the logarithm of the force above which the contact is narrow


MeshDemand = tuple[NDArray[np.bool_], str]
"""Where something holds that must, one truth value per mesh, and the sentence for the engineer where it does not."""


def demands(mesh: Mesh) -> Iterator[MeshDemand]:
    """What the geometry must satisfy, in the order in which it builds up; NaN does not hold."""
    yield (
        _all_positive(mesh),
        "pin_circle_radius, pin_radius, eccentricity, disc_width, output_torque, torque_share, young_modulus and "
        "reconstruction_depth must be greater than zero and finite, with all effects that act on them",
    )
    short_width = np.atleast_1d(np.asarray(mesh.short_width))
    yield (
        (short_width > 0.0) & (short_width < 1.0),
        "the short-width coefficient must lie between 0 and 1: reduce eccentricity or pin_count, or enlarge "
        "pin_circle_radius, until eccentricity * pin_count < pin_circle_radius",
    )
    yield (
        np.atleast_1d(mesh.pin_radius < geometry.smallest_convex_radius(mesh)),
        "the pins undercut the disc: pin_radius must be smaller than the smallest radius of the convex flank; reduce "
        "pin_radius or eccentricity, or enlarge pin_circle_radius",
    )
    yield (
        np.atleast_1d(mesh.pin_radius < mesh.pin_circle_radius * np.sin(np.pi / mesh.choices.pin_count)),
        "neighbouring pins overlap: reduce pin_radius or pin_count, or enlarge pin_circle_radius, until "
        "pin_radius < pin_circle_radius * sin(pi / pin_count)",
    )
    yield (
        np.atleast_1d(mesh.radial_clearance >= -ROUNDING),
        "the radial clearance is negative: equidistant_modification must not be smaller than shift_modification",
    )
    yield (
        np.atleast_1d(mesh.root * mesh.equidistant - mesh.shift >= -ROUNDING),
        "disc and pins interfere: equidistant_modification lies above its upper limit at this radial clearance; "
        "reduce equidistant_modification, or shift_modification, until "
        "sqrt(1 - short_width^2) * equidistant_modification >= shift_modification",
    )
    yield (
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


def holding(mesh: Mesh) -> tuple[NDArray[np.bool_], list[MeshDemand]]:
    """Which meshes (m,) can be calculated, and the demands that some of them do not meet."""
    good: NDArray[np.bool_] = np.ones(1, dtype=bool)
    broken = []
    with np.errstate(invalid="ignore", divide="ignore"):
        for demand in demands(mesh):
            good = good & demand[0]
            if not demand[0].all():
                broken.append(demand)
    return good, broken


def refuse(broken: list[MeshDemand], mesh_of_row: NDArray[np.intp] | None) -> None:
    """Refuse the rows whose mesh cannot be calculated, each with the first sentence that applies."""
    for holds, sentence in broken:
        feasible(bool(holds[0]) if mesh_of_row is None else holds[mesh_of_row], sentence)
