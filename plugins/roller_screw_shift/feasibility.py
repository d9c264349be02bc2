"""What a pair needs before it can be calculated: the sentence names the inputs and what to do."""

import numpy as np
from numpy.typing import NDArray

from gear_geometry.roots import Fillet, gap_offset
from roller_screw_shift.geometry import Geometry, involute_margin
from roller_screw_shift.quantities import Pair
from roller_screw_shift.strength import Tooth, is_cut, ring_rack
from truing import Float, feasible

FEWEST = 8  # teeth of the ring beyond those of the roller


def require_pair(pair: Pair, geometry: Geometry) -> None:
    """Refuse pairs that do not fit into one another; NaN does not fit."""
    feasible(
        pair.ring_teeth - pair.roller_teeth >= FEWEST,
        f"the formulas hold for ring_teeth at least {FEWEST} above roller_teeth: enlarge ring_teeth",
    )
    feasible(
        _real(geometry.working_angle),
        "the base circles are farther apart than the centres: centre_distance must exceed "
        "module * (ring_teeth - roller_teeth) * cos(pressure_angle) / 2",
    )
    feasible(
        _real(geometry.mounted_angle),
        "the base circles are farther apart than the centres as mounted: centre_distance + centre_distance_deviation "
        "must exceed module * (ring_teeth - roller_teeth) * cos(pressure_angle) / 2",
    )
    feasible(
        geometry.roller.tip_radius > geometry.roller.base_radius,
        "the tip circle of the roller lies inside its base circle: enlarge roller_shift or addendum",
    )
    feasible(
        geometry.ring.tip_radius > geometry.ring.base_radius,
        "the tip circle of the ring lies inside its base circle: enlarge roller_shift, which the shift of the ring "
        "follows, or reduce addendum",
    )
    feasible(
        involute_margin(geometry) > 0.0,
        "involute interference: the tip of the ring would meet the roller below its base circle; enlarge roller_shift, "
        "or reduce addendum",
    )


def require_roots(pair: Pair, roller: Tooth, ring: Tooth, fillet: Fillet) -> None:
    """Refuse teeth without a critical section; ``fillet`` is that of the rack of the roller."""
    for gear, offset, cut in (("roller", fillet.offset, False), ("ring", gap_offset(ring_rack(pair)), is_cut(pair))):
        feasible(
            cut | (np.asarray(offset) >= 0.0),
            f"the rack of the {gear} is pointed before it is round: reduce {gear}_fillet, addendum or clearance",
        )
    feasible(
        ~is_cut(pair) | (pair.cutter_teeth <= pair.ring_teeth - FEWEST),
        f"the cutter does not fit into the ring: cutter_teeth must be at least {FEWEST} below ring_teeth",
    )
    feasible(
        ~is_cut(pair) | np.isfinite(ring.root.chord + ring.arm.height),
        "the cutter makes no such ring: its tip is pointed before it is round; reduce cutter_fillet or cutter_addendum",
    )
    feasible(
        np.isfinite(fillet.angle),
        "the fillet of the roller has no tangent of 30 degrees: reduce roller_shift or enlarge roller_teeth",
    )
    for gear, tooth in (("roller", roller), ("ring", ring)):
        feasible(
            tooth.root.chord > 0.0,
            f"the tooth of the {gear} has no thickness at its root: reduce addendum, clearance or pressure_angle",
        )
        feasible(
            (tooth.root.fillet > 0.0) & np.isfinite(tooth.root.fillet),
            f"the root of the {gear} has no radius: {gear}_fillet must be greater than 0",
        )
        feasible(
            tooth.arm.height > 0.0,
            f"the load at the tip of the {gear} has no arm about its root: enlarge addendum or clearance",
        )


def _real(angle: Float) -> NDArray[np.bool_]:
    """Whether an angle exists and is one of a pair that turns."""
    real: NDArray[np.bool_] = np.asarray(angle) > 0.0
    return real
