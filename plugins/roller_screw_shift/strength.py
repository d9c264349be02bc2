"""The load of one mesh, and the roots of roller and ring: critical section, form and stress factors, nominal stress."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_geometry import roots
from roller_screw_shift.geometry import Geometry
from roller_screw_shift.quantities import Pair
from truing import Float, either

# The load of one mesh of roller and ring, and how often its parts turn while the screw turns once


@dataclass(frozen=True, kw_only=True)
class Load:
    """Load of one mesh, N, the orders of carrier and roller: turns per turn of the screw; and meshes.

    ``ring_meshes`` are those of a tooth of the ring per mesh of a tooth of a roller.
    """

    tangential_force: Float
    carrier_order: Float
    roller_order: Float
    ring_meshes: Float


def load_of(pair: Pair) -> Load:
    """Return the load of the mesh of one roller at the mean: without the neutral factors, never negative.

    The nut stands still and the thread of the roller rolls between those of screw and nut: the carrier makes k/(2 (k +
    1)) turns per turn of the screw, k = d_s/d_r, and with respect to the carrier a roller makes z_I/z_E times as many.
    In one turn of the carrier each roller passes each tooth of the ring once, and a tooth of a roller meets the ring
    z_I/z_E times.
    """
    ratio = pair.screw_diameter / pair.roller_diameter
    carrier = ratio / (2.0 * (ratio + 1.0))
    return Load(
        tangential_force=pair.tangential_share * np.abs(pair.axial_load),
        carrier_order=carrier,
        roller_order=carrier * pair.ring_teeth / pair.roller_teeth,
        ring_meshes=pair.rollers * pair.roller_teeth / pair.ring_teeth,
    )


# Roots of roller and ring: critical section, factors Y_Fa and Y_Sa for a load at the tip, nominal stress


@dataclass(frozen=True, kw_only=True)
class Tooth:
    """Critical section and arm in modules, factors of form and stress, nominal root stress in Pa."""

    root: roots.Root
    arm: roots.Arm
    form: Float
    correction: Float
    stress: Float


def rack_of(pair: Pair, fillet: Float) -> roots.Rack:
    """Return the rack that makes the roller, or stands for the tooth of the ring, by its fillet."""
    return roots.Rack(dedendum=pair.addendum + pair.clearance, fillet=fillet, pressure_angle=pair.pressure_angle)


def roller_fillet(pair: Pair) -> roots.Fillet:
    """Return how the rounding of the rack lies to the roller."""
    return roots.fillet_of(rack_of(pair, pair.roller_fillet), pair.roller_teeth, pair.roller_shift)


def roller_tooth(pair: Pair, fillet: roots.Fillet) -> Tooth:
    """Return the tooth of the roller: made by a rack, section at the tangent of 30 degrees. Source: ISO 6336-3."""
    rack, teeth, shift = rack_of(pair, pair.roller_fillet), pair.roller_teeth, pair.roller_shift
    root = roots.external_root(rack, teeth, shift, fillet)
    return _tooth(pair, root, roots.external_arm(rack, teeth, shift, root, teeth + 2.0 * (pair.addendum + shift)))


def ring_tooth(pair: Pair, geometry: Geometry) -> Tooth:
    """Return the tooth of the ring: that of a substitute rack, or where a cutter is given the one that it leaves.

    Sources: GB/T 3480-1997 (as DIN 3990-3), section at the tangent of 30 degrees; ISO 6336-3, at that of 60 degrees.
    """
    rack = rack_of(pair, pair.ring_fillet)
    root = roots.ring_root(rack)
    arm = roots.ring_arm(rack, root, pair.addendum)
    cut = is_cut(pair)
    if np.any(cut):
        cut_root, cut_arm = cut_section(pair, geometry)
        root = roots.Root(**{name: np.where(cut, value, getattr(root, name)) for name, value in vars(cut_root).items()})
        arm = roots.Arm(**{name: np.where(cut, value, getattr(arm, name)) for name, value in vars(cut_arm).items()})
    return _tooth(pair, root, arm)


def is_cut(pair: Pair) -> NDArray[np.bool_]:
    """Return whether the ring is made by a cutter; else it is taken as a rack."""
    value: NDArray[np.bool_] = ~np.isnan(np.asarray(pair.cutter_teeth, dtype=float))
    return value


def cut_section(pair: Pair, geometry: Geometry) -> tuple[roots.Root, roots.Arm]:
    """Return section and arm of the ring as its cutter leaves it; NaN where none is given or it makes no such ring."""
    addendum = either(pair.cutter_addendum, pair.addendum + pair.clearance)
    cutter = roots.Cutter(
        teeth=pair.cutter_teeth, shift=pair.cutter_shift, addendum=addendum, fillet=pair.cutter_fillet
    )
    with np.errstate(all="ignore"):
        root = roots.cut_ring_root(cutter, pair.ring_teeth, geometry.ring_shift, pair.pressure_angle)
        tip = geometry.ring.tip_radius / pair.module
        return root, roots.cut_ring_arm(root, pair.ring_teeth, geometry.ring_shift, tip, pair.pressure_angle)


def _tooth(pair: Pair, root: roots.Root, arm: roots.Arm) -> Tooth:
    with np.errstate(invalid="ignore", divide="ignore"):
        form, correction = roots.form_factor(root, arm, pair.pressure_angle), roots.stress_correction(root, arm)
    per_area = load_of(pair).tangential_force / (pair.face_width * pair.module)
    return Tooth(root=root, arm=arm, form=form, correction=correction, stress=per_area * form * correction)


def acting(pair: Pair) -> Float:
    """Return what raises the stress of both roots above the nominal one: uneven, moving and unequally shared load."""
    return pair.face_load_factor * pair.dynamic_factor * pair.sharing_factor / pair.carrying_share
