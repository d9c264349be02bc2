"""What changes the load of a tooth and so every stress: misalignment, resonance, sharing, width and tip that carry."""

from dataclasses import replace

import numpy as np

from gear_geometry.mesh_load import shaken_by_error
from rv_gearing.loads import load_of
from rv_gearing.quantities import Gearing
from truing import Float

LEAST_FORCE = 1e-3  # N, of an idle mesh: even that touches somewhere


def face_misalignment(stage: Gearing, *, misalignment: Float, per_load: Float) -> Gearing:
    """The teeth do not meet along their whole width: by so much at any load, and by so much per newton of a mesh."""
    out_of_line = misalignment + per_load * load_of(stage).tangential_force
    return replace(stage, extra_misalignment=stage.extra_misalignment + out_of_line)


def structural_resonance(stage: Gearing, *, strength: Float, resonance_speed: Float, damping: Float) -> Gearing:
    """Shaft, carrier or housing answers to the meshing teeth as one degree of freedom that their error shakes.

    ``strength`` is the error, by the stiffness that it works against, over the load: the dynamic factor gains
    ``strength`` N² / sqrt((1 - N²)² + (2 zeta N)²), nothing at rest and strength/(2 zeta) at the resonance. Speeds are
    those of the sun relative to the carrier, which the frequency of the mesh follows.
    """
    answer = strength * shaken_by_error(load_of(stage).mesh_speed / resonance_speed, damping)
    return replace(stage, extra_dynamic_factor=stage.extra_dynamic_factor + answer)


def planet_load_sharing(stage: Gearing, *, lead: Float) -> Gearing:
    """One planet is ahead of the mean of all and is loaded more, until its mesh has given way by as much."""
    return replace(stage, sharing_error=stage.sharing_error + lead)


def crowned_contact(stage: Gearing, *, full_line_load: Float) -> Gearing:
    """Crowned teeth touch over a width that grows with the cube root of the force, until the whole face carries.

    Of a parabola, on a bed of springs and on Hertz's half space alike. The mean over this width is what is raised; how
    uneven the load is across it stays with the face load factor.
    """
    force = np.maximum(load_of(stage).tangential_force, LEAST_FORCE)
    share = np.cbrt(force / np.maximum(force, full_line_load * stage.face_width))
    return replace(stage, carrying_share=stage.carrying_share * share)


def relief_error(stage: Gearing, *, missing: Float) -> Gearing:
    """The tip is relieved by less than was meant, or by more: the tooth takes its load nearer to the tip, or lower."""
    return replace(stage, relief_deviation=stage.relief_deviation + missing)
