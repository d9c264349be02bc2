"""Roots of roller and ring: critical section, factors Y_Fa and Y_Sa for a load at the tip, nominal stress."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_geometry.cut_rings import Cutter, cut_ring_arm, cut_ring_root
from gear_geometry.roots import (
    Arm,
    Fillet,
    Rack,
    Root,
    external_arm,
    external_root,
    fillet_of,
    form_factor,
    ring_arm,
    ring_root,
    stress_correction,
)
from roller_screw_shift.geometry import Geometry
from roller_screw_shift.loads import load_of
from roller_screw_shift.quantities import Pair
from truing import Float, either


@dataclass(frozen=True, kw_only=True)
class Tooth:
    """Critical section and arm in modules, factors of form and stress, nominal root stress in Pa."""

    root: Root
    arm: Arm
    form: Float
    correction: Float
    stress: Float


def roller_rack(pair: Pair) -> Rack:
    """Return the rack that makes the roller."""
    return _rack(pair, pair.roller_fillet)


def ring_rack(pair: Pair) -> Rack:
    """Return the rack that stands for the tooth of the ring."""
    return _rack(pair, pair.ring_fillet)


def _rack(pair: Pair, fillet: Float) -> Rack:
    return Rack(dedendum=pair.addendum + pair.clearance, fillet=fillet, pressure_angle=pair.pressure_angle)


def roller_fillet(pair: Pair) -> Fillet:
    """Return how the rounding of the rack lies to the roller."""
    return fillet_of(roller_rack(pair), pair.roller_teeth, pair.roller_shift)


def roller_tooth(pair: Pair) -> Tooth:
    """Return the tooth of the roller: made by a rack, section at the tangent of 30 degrees. Source: ISO 6336-3."""
    rack, teeth, shift = roller_rack(pair), pair.roller_teeth, pair.roller_shift
    root = external_root(rack, teeth, shift)
    return _tooth(pair, root, external_arm(rack, teeth, shift, root, teeth + 2.0 * (pair.addendum + shift)))


def ring_tooth(pair: Pair, geometry: Geometry) -> Tooth:
    """Return the tooth of the ring: that of a substitute rack, or where a cutter is given the one that it leaves.

    Sources: GB/T 3480-1997 (as DIN 3990-3), section at the tangent of 30 degrees; ISO 6336-3, at that of 60 degrees.
    """
    rack = ring_rack(pair)
    root = ring_root(rack)
    arm = ring_arm(rack, root, pair.addendum)
    cut = is_cut(pair)
    if np.any(cut):
        cut_root, cut_arm = cut_section(pair, geometry)
        root = Root(**{name: np.where(cut, value, getattr(root, name)) for name, value in vars(cut_root).items()})
        arm = Arm(**{name: np.where(cut, value, getattr(arm, name)) for name, value in vars(cut_arm).items()})
    return _tooth(pair, root, arm)


def is_cut(pair: Pair) -> NDArray[np.bool_]:
    """Return whether the ring is made by a cutter; else it is taken as a rack."""
    cut: NDArray[np.bool_] = ~np.isnan(np.asarray(pair.cutter_teeth, dtype=float))
    return cut


def cut_section(pair: Pair, geometry: Geometry) -> tuple[Root, Arm]:
    """Return section and arm of the ring as its cutter leaves it; NaN where none is given or it makes no such ring."""
    addendum = either(pair.cutter_addendum, pair.addendum + pair.clearance)
    cutter = Cutter(teeth=pair.cutter_teeth, shift=pair.cutter_shift, addendum=addendum, fillet=pair.cutter_fillet)
    with np.errstate(all="ignore"):
        root = cut_ring_root(cutter, pair.ring_teeth, geometry.ring_shift, pair.pressure_angle)
        tip = geometry.ring.tip_radius / pair.module
        return root, cut_ring_arm(root, pair.ring_teeth, geometry.ring_shift, tip, pair.pressure_angle)


def _tooth(pair: Pair, root: Root, arm: Arm) -> Tooth:
    with np.errstate(invalid="ignore", divide="ignore"):
        form, correction = form_factor(root, arm, pair.pressure_angle), stress_correction(root, arm)
    per_area = load_of(pair).tangential_force / (pair.face_width * pair.module)
    return Tooth(root=root, arm=arm, form=form, correction=correction, stress=per_area * form * correction)


def acting(pair: Pair) -> Float:
    """Return what raises the stress of both roots above the nominal one: uneven, moving and unequally shared load."""
    return pair.face_load_factor * pair.dynamic_factor * pair.sharing_factor / pair.carrying_share
