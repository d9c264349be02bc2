"""The three objectives of the paper: sum of the shifts, difference of the root stresses, difference of sliding."""

from dataclasses import dataclass

import numpy as np

from roller_screw_shift.geometry import Geometry, geometry_of, sliding
from roller_screw_shift.quantities import Pair
from roller_screw_shift.strength import ring_tooth, roller_tooth
from truing import Float


@dataclass(frozen=True, kw_only=True)
class Objectives:
    """f1 (to be large), f2 in Pa and f3 (to be small)."""

    shift_sum: Float
    stress_difference: Float
    sliding_difference: Float


def objectives_of(pair: Pair) -> Objectives:
    """Return the objectives of one shift or of many; NaN where one does not exist, never an exception.

    The stresses are nominal: the neutral factors of load, rim and face width do not change the choice of the shift.
    """
    with np.errstate(all="ignore"):
        geometry = geometry_of(pair)
        difference = np.abs(roller_tooth(pair).stress - ring_tooth(pair, geometry).stress)
        return Objectives(
            shift_sum=pair.roller_shift + geometry.ring_shift,
            stress_difference=difference,
            sliding_difference=sliding_difference(pair, geometry),
        )


def sliding_difference(pair: Pair, geometry: Geometry) -> Float:
    """Return the difference of the magnitudes of specific sliding that count of both gears."""
    roller, ring = sliding(pair, geometry)
    return np.abs(roller - ring)
