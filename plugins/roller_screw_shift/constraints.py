"""The constraints g1 to g10 of the paper and of gear geometry as margins: above 0 is safe."""

from dataclasses import dataclass

import numpy as np

from roller_screw_shift.geometry import (
    Geometry,
    contact_ratio,
    crossing_of,
    geometry_of,
    involute_margin,
    tip_land,
)
from roller_screw_shift.objectives import sliding_difference
from roller_screw_shift.quantities import Pair
from truing import Float


@dataclass(frozen=True, kw_only=True)
class Margins:
    """The constraints in the order of their numbers, named as the results are."""

    margin_ring_base: Float
    margin_roller_base: Float
    margin_contact_ratio: Float
    margin_interference: Float
    margin_opposite_tips: Float
    margin_roller_root: Float
    margin_ring_root: Float
    margin_involute: Float
    margin_undercut: Float
    margin_tip_land: Float
    margin_sliding: Float


def margins_of(pair: Pair) -> Margins:
    """Return the margins of one shift or of many; NaN where one does not exist, never an exception.

    Where a tip circle lies inside its base circle, what depends on the angle at the tip does not exist; where the tip
    of the ring meets no involute, sliding does not. Another margin is below 0 then.
    """
    with np.errstate(all="ignore"):
        return margins_at(pair, geometry_of(pair))


def margins_at(pair: Pair, geometry: Geometry) -> Margins:
    """Return the margins of a pair whose geometry is known."""
    roller, ring, distance = geometry.roller, geometry.ring, geometry.mounted_distance
    return Margins(
        margin_ring_base=ring.tip_radius / ring.base_radius - 1.0,
        margin_roller_base=roller.tip_radius / roller.base_radius - 1.0,
        margin_contact_ratio=contact_ratio(geometry) - pair.least_contact_ratio,
        margin_interference=crossing_of(geometry).clearance - pair.interference_margin,
        margin_opposite_tips=_over(pair, ring.tip_radius - roller.tip_radius + distance),
        margin_roller_root=_over(pair, ring.tip_radius - roller.root_radius - distance),
        margin_ring_root=_over(pair, ring.root_radius - roller.tip_radius - distance),
        margin_involute=involute_margin(geometry),
        margin_undercut=pair.roller_shift - undercut_limit(pair),
        margin_tip_land=tip_land(pair, geometry) / pair.module - pair.least_tip_land,
        margin_sliding=pair.most_sliding_difference - sliding_difference(pair, geometry),
    )


def _over(pair: Pair, clearance: Float) -> Float:
    """Return a clearance in modules over the least."""
    return clearance / pair.module - pair.least_clearance


def undercut_limit(pair: Pair) -> Float:
    """Return the shift below which the rack undercuts the roller."""
    sine = np.sin(pair.pressure_angle)
    straight = pair.addendum + pair.clearance - pair.roller_fillet * (1.0 - sine)
    return straight - 0.5 * pair.roller_teeth * sine**2
