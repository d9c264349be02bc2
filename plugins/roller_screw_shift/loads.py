"""The load of one mesh of roller and ring, and how often its parts turn while the screw turns once."""

from dataclasses import dataclass

import numpy as np

from roller_screw_shift.quantities import Pair
from truing import Float


@dataclass(frozen=True, kw_only=True)
class Load:
    """Load of one mesh, N, its direction, the orders of carrier and roller: turns per turn of the screw; and meshes.

    ``ring_meshes`` are those of a tooth of the ring per mesh of a tooth of a roller.
    """

    tangential_force: Float
    direction: Float
    carrier_order: Float
    roller_order: Float
    ring_meshes: Float


def load_of(pair: Pair) -> Load:
    """Return the load of the mesh of one roller at the mean: without the neutral factors, never negative.

    The direction is +1, or -1 where the axial load is negative. The nut stands still and the thread of the roller rolls
    between those of screw and nut: the carrier makes k/(2 (k + 1)) turns per turn of the screw, k = d_s/d_r, and with
    respect to the carrier a roller makes z_I/z_E times as many. In one turn of the carrier each roller passes each
    tooth of the ring once, and a tooth of a roller meets the ring z_I/z_E times.
    """
    ratio = pair.screw_diameter / pair.roller_diameter
    carrier = ratio / (2.0 * (ratio + 1.0))
    return Load(
        tangential_force=pair.tangential_share * np.abs(pair.axial_load),
        direction=np.where(np.asarray(pair.axial_load) < 0.0, -1.0, 1.0),
        carrier_order=carrier,
        roller_order=carrier * pair.ring_teeth / pair.roller_teeth,
        ring_meshes=pair.rollers * pair.roller_teeth / pair.ring_teeth,
    )
