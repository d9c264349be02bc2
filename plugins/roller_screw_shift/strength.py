"""Roots of roller and ring: critical section, factors Y_Fa and Y_Sa for a load at the tip, nominal stress."""

from dataclasses import dataclass

import numpy as np

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
from roller_screw_shift.loads import load_of
from roller_screw_shift.quantities import Pair
from truing import Float


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


def ring_tooth(pair: Pair) -> Tooth:
    """Return the tooth of the ring as that of a substitute rack. Source: GB/T 3480-1997."""
    rack = ring_rack(pair)
    root = ring_root(rack)
    return _tooth(pair, root, ring_arm(rack, root, pair.addendum))


def _tooth(pair: Pair, root: Root, arm: Arm) -> Tooth:
    with np.errstate(invalid="ignore", divide="ignore"):
        form, correction = form_factor(root, arm, pair.pressure_angle), stress_correction(root, arm)
    per_area = load_of(pair).tangential_force / (pair.face_width * pair.module)
    return Tooth(root=root, arm=arm, form=form, correction=correction, stress=per_area * form * correction)


def acting(pair: Pair) -> Float:
    """Return what raises the stress of both roots above the nominal one: uneven, moving and unequally shared load."""
    return pair.face_load_factor * pair.dynamic_factor * pair.sharing_factor / pair.carrying_share
