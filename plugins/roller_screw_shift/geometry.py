"""Geometry of roller and ring in mesh. The roller is named first in every pair of values; a shift of the ring is
positive outward.

The shift of the ring follows from the nominal centre distance, at which there is no backlash. All that happens in mesh
(contact ratio, sliding, interference, clearances) is that of the centre distance as mounted.
"""

from dataclasses import dataclass

import numpy as np

from gear_geometry import pairs
from roller_screw_shift.quantities import Pair
from truing import Float

APART = 2.0 * np.pi  # rad; clearance of tips whose circles do not cross: a whole pitch


@dataclass(frozen=True, kw_only=True)
class PairGear:
    """Circles of one gear, m, the pressure angle at its tip, rad, and its teeth."""

    teeth: Float
    base_radius: Float
    tip_radius: Float
    root_radius: Float
    tip_angle: Float


@dataclass(frozen=True, kw_only=True)
class Geometry:
    """The pair without backlash and as mounted; lengths in m, angles in rad. NaN where something does not exist."""

    working_angle: Float
    shift_difference: Float
    ring_shift: Float
    mounted_distance: Float
    mounted_angle: Float
    roller: PairGear
    ring: PairGear


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """Where the tip circles cross, seen from roller and ring, rad, and the clearance of the tips there."""

    roller: Float
    ring: Float
    clearance: Float


def geometry_of(pair: Pair) -> Geometry:
    """Return the geometry of the pair; every Float is a number or an array (n,)."""
    alpha, difference = pair.pressure_angle, pair.ring_teeth - pair.roller_teeth
    base_distance = 0.5 * pair.module * difference * np.cos(alpha)
    working = pairs.working_angle_at(pair.centre_distance, base_distance)
    shift_difference = difference * pairs.shift_per_tooth(working, alpha)
    mounted_distance = pair.centre_distance + pair.centre_distance_deviation
    ring_shift = pair.roller_shift + shift_difference
    return Geometry(
        working_angle=working,
        shift_difference=shift_difference,
        ring_shift=ring_shift,
        mounted_distance=mounted_distance,
        mounted_angle=pairs.working_angle_at(mounted_distance, base_distance),
        roller=_gear(pair, pair.roller_teeth, pair.roller_shift, outward=1.0),
        ring=_gear(pair, pair.ring_teeth, ring_shift, outward=-1.0),
    )


def _gear(pair: Pair, teeth: Float, shift: Float, *, outward: float) -> PairGear:
    """Return one gear; the tip lies ``outward`` of the reference circle, or inward for -1."""
    base = 0.5 * pair.module * teeth * np.cos(pair.pressure_angle)
    tip = pair.module * (0.5 * teeth + outward * pair.addendum + shift)
    root = pair.module * (0.5 * teeth - outward * (pair.addendum + pair.clearance) + shift)
    with np.errstate(invalid="ignore", divide="ignore"):
        angle = np.arccos(np.where(np.asarray(tip) > base, base / tip, np.nan))
    return PairGear(teeth=teeth, base_radius=base, tip_radius=tip, root_radius=root, tip_angle=angle)


def contact_ratio(geometry: Geometry) -> Float:
    """Return the contact ratio as mounted."""
    return pairs.internal_contact_ratio(_teeth(geometry), _tip_angles(geometry), geometry.mounted_angle)


def involute_margin(geometry: Geometry) -> Float:
    """Return what must be above 0 for the tip of the ring to meet an involute of the roller."""
    return pairs.clear_of_base(_teeth(geometry), geometry.ring.tip_angle, geometry.mounted_angle)


def tips_count(pair: Pair) -> float:
    """Return 1 where the sliding at the tips counts, 0 where that at the roots alone does."""
    return 1.0 if pair.sliding_reading == "path" else 0.0


def sliding_at_roots(geometry: Geometry) -> tuple[Float, Float]:
    """Return the magnitudes of specific sliding at the roots of roller and ring; NaN under involute interference."""
    return pairs.internal_sliding(_teeth(geometry), _tip_angles(geometry), geometry.mounted_angle)


def sliding_at_tips(geometry: Geometry) -> tuple[Float, Float]:
    """Return the magnitudes of specific sliding at the tips of roller and ring."""
    return pairs.internal_tip_sliding(_teeth(geometry), _tip_angles(geometry), geometry.mounted_angle)


def half_angle_at_tip(pair: Pair, geometry: Geometry) -> Float:
    """Return half the angle of the tooth of the roller at its tip, rad; below 0 the tooth is pointed before."""
    half = (0.5 * np.pi + 2.0 * pair.roller_shift * np.tan(pair.pressure_angle)) / pair.roller_teeth
    return half + pairs.involute(pair.pressure_angle) - pairs.involute(geometry.roller.tip_angle)


def tip_land(pair: Pair, geometry: Geometry) -> Float:
    """Return the width of the tip of the tooth of the roller along its tip circle, m."""
    return 2.0 * geometry.roller.tip_radius * half_angle_at_tip(pair, geometry)


def crossing_of(geometry: Geometry) -> Crossing:
    """Return where the tip circles cross and how much room the tips have there, as an angle that counts 2 pi a tooth.

    Where the circles do not cross no tip can meet another: the clearance is a whole pitch.
    """
    roller, ring, distance = geometry.roller, geometry.ring, geometry.mounted_distance
    squares = ring.tip_radius**2 - roller.tip_radius**2
    at_roller = np.arccos(np.clip((squares - distance**2) / (2.0 * distance * roller.tip_radius), -1.0, 1.0))
    at_ring = np.arccos(np.clip((squares + distance**2) / (2.0 * distance * ring.tip_radius), -1.0, 1.0))
    clearance = (
        roller.teeth * (at_roller + pairs.involute(roller.tip_angle))
        - ring.teeth * (at_ring + pairs.involute(ring.tip_angle))
        + (ring.teeth - roller.teeth) * pairs.involute(geometry.mounted_angle)
    )
    crossing = np.asarray(distance + roller.tip_radius > ring.tip_radius)
    return Crossing(roller=at_roller, ring=at_ring, clearance=np.where(crossing, clearance, APART))


def backlash(geometry: Geometry) -> Float:
    """Return the arc between free flanks at the pitch circle as mounted, m: gap of the ring less tooth of the roller.

    Exact for involutes. It is 0 at the nominal centre distance and close to -2 Delta a tan(alpha_w) beside it: the
    roller lies inside the ring, so that centres farther apart press it into the ring's teeth.
    """
    opened = pairs.involute(geometry.working_angle) - pairs.involute(geometry.mounted_angle)
    return 2.0 * geometry.mounted_distance * opened


def _teeth(geometry: Geometry) -> tuple[Float, Float]:
    return geometry.roller.teeth, geometry.ring.teeth


def _tip_angles(geometry: Geometry) -> tuple[Float, Float]:
    return geometry.roller.tip_angle, geometry.ring.tip_angle
