"""What changes the load of a tooth, or how the root bears it: tilt, resonance, sharing, cut teeth, a soft rim."""

from dataclasses import replace

import numpy as np

from gear_geometry.mesh_load import face_factor, shaken_by_error
from roller_screw_shift.loads import load_of
from roller_screw_shift.quantities import Pair
from truing import Float

LEAST_FORCE = 1e-3  # N, of an idle mesh: even that touches somewhere


def line_stiffness(pair: Pair) -> Float:
    """Return the force by which a mesh answers to an approach of the flanks, N/m."""
    return pair.mesh_stiffness * pair.face_width


def mean_force(pair: Pair) -> Float:
    """Return the tangential load of a mesh at the mean, N, never quite 0."""
    return np.maximum(load_of(pair).tangential_force, LEAST_FORCE)


def face_misalignment(pair: Pair, *, misalignment: Float, per_load: Float) -> Pair:
    """The teeth do not meet along their whole width: by so much at any load, and by so much per newton of axial load.

    A load that reverses tilts the roller the other way, from where it stands without any.
    """
    gap = np.abs(misalignment + per_load * pair.axial_load)
    uneven = face_factor(gap * line_stiffness(pair) / (2.0 * mean_force(pair)))
    return replace(pair, face_load_factor=pair.face_load_factor * uneven)


def mesh_resonance(
    pair: Pair, *, excitation: Float, resonance_speed: Float, damping: Float, screw_speed: Float
) -> Pair:
    """Roller and mesh swing as one degree of freedom that the teeth shake once per mesh.

    The load in motion is that at rest and ``excitation`` N² / sqrt((1 - N²)² + (2 zeta N)²) of it: nothing at rest, a
    peak of excitation/(2 zeta) at the resonance, and ``excitation`` far above it, where the roller stands still and the
    error of the teeth alone works the mesh.
    """
    swing = excitation * shaken_by_error(screw_speed / resonance_speed, damping)
    return replace(pair, dynamic_factor=pair.dynamic_factor * (1.0 + swing))


def roller_load_sharing(pair: Pair, *, lead: Float) -> Pair:
    """The flank of this roller stands ahead of the mean of the others: it carries more, until its mesh has given way.

    All rollers move with a rigid carrier, so that this one takes ``lead`` (n_r - 1)/n_r times the stiffness of its mesh
    more than the mean. One that stays behind by much carries nothing.
    """
    ahead = lead * (pair.rollers - 1) / pair.rollers
    share = np.maximum(1.0 + ahead * line_stiffness(pair) / mean_force(pair), 0.0)
    return replace(pair, sharing_factor=pair.sharing_factor * share)


def interrupted_tooth(pair: Pair, *, lost: Float, phase: Float, screw_angle: Float) -> Pair:
    """The thread of the roller runs through its teeth: where it meets the ring, less of the face carries.

    The share that does not carry is lost (1 + cos(roller angle - phase))/2: nothing where the groove is on the far
    side, ``lost`` where it is in the middle of the mesh. The angle of the roller is counted against the carrier.
    """
    there = load_of(pair).roller_order * screw_angle - phase
    missing = 0.5 * lost * (1.0 + np.cos(there))
    return replace(pair, carrying_share=pair.carrying_share * (1.0 - missing))


def rim_compliance(pair: Pair, *, softness: Float) -> Pair:
    """A thin rim bends under its teeth: the root of the ring bears so much more stress than in a solid one."""
    return replace(pair, rim_factor=pair.rim_factor * (1.0 + softness))
