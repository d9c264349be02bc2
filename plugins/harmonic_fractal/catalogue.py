"""Torsional stiffness of harmonic drives as their maker's catalogues print it, size by size, in three straight pieces.

K_1 holds from 0 to T_1, K_2 to T_2, K_3 beyond. Sources: Harmonic Drive LLC, Cup Type Component Sets, CSF and CSG
series, tables 41 and 42 (ratios 30 and 50); Harmonic Drive AG, CHA actuators, manual 1018854 (30, 50 and above). They
agree where they overlap. The values are averages over many drives.
"""

from typing import Literal, NamedTuple

import numpy as np

from harmonic_fractal.quantities import SIZES, Drive
from truing import Float

Column = Literal["30", "50", "above 50"]
UNIT = 1e3  # N m/rad

# size: T_1 and T_2 in N m, then K_1, K_2, K_3 in 1e3 N m/rad for ratios of 30, of 50, and above 50
TABLE: dict[str, tuple[float, float, dict[Column, tuple[float, float, float]]]] = {
    "14": (2.0, 6.9, {"30": (1.9, 2.4, 3.4), "50": (3.4, 4.7, 5.7), "above 50": (4.7, 6.1, 7.1)}),
    "17": (3.9, 12.0, {"30": (3.4, 4.4, 6.7), "50": (8.1, 11.0, 13.0), "above 50": (10.0, 14.0, 16.0)}),
    "20": (7.0, 25.0, {"30": (5.7, 7.1, 11.0), "50": (13.0, 18.0, 23.0), "above 50": (16.0, 25.0, 29.0)}),
    "25": (14.0, 48.0, {"30": (10.0, 13.0, 21.0), "50": (25.0, 34.0, 44.0), "above 50": (31.0, 50.0, 57.0)}),
    "32": (29.0, 108.0, {"30": (24.0, 30.0, 49.0), "50": (54.0, 78.0, 98.0), "above 50": (67.0, 110.0, 120.0)}),
    "40": (54.0, 196.0, {"50": (100.0, 140.0, 180.0), "above 50": (130.0, 200.0, 230.0)}),
    "50": (108.0, 382.0, {"50": (200.0, 280.0, 340.0), "above 50": (250.0, 400.0, 440.0)}),
    "58": (168.0, 598.0, {"50": (310.0, 440.0, 540.0), "above 50": (400.0, 610.0, 710.0)}),
}


class Polyline(NamedTuple):
    """Torsion over torque in three straight pieces: where they meet, N m, and their stiffnesses, N m/rad."""

    first_torque: float
    second_torque: float
    stiffnesses: tuple[float, float, float]

    def torsion(self, torque: Float) -> Float:
        """Return the torsion, rad, odd in the torque."""
        size, (first, second, third) = np.abs(torque), self.stiffnesses
        turned = np.minimum(size, self.first_torque) / first
        turned = turned + np.clip(size - self.first_torque, 0.0, self.second_torque - self.first_torque) / second
        return np.sign(torque) * (turned + np.maximum(size - self.second_torque, 0.0) / third)

    def stiffness(self, torque: Float) -> Float:
        """Return the stiffness of the piece in which the torque lies, N m/rad."""
        size, (first, second, third) = np.abs(torque), self.stiffnesses
        return np.where(size <= self.first_torque, first, np.where(size <= self.second_torque, second, third))


def column_of(ratio: float) -> Column:
    """Return the column of the table for a ratio: above 50, 50 from 40 on, and 30 below, the nearest of the two."""
    if ratio > 50.0:
        return "above 50"
    return "50" if ratio >= 40.0 else "30"


def polyline_of(size: SIZES, ratio: float) -> Polyline | None:
    """Return the printed pieces of a size and a ratio, or None where the catalogues print none."""
    first, second, columns = TABLE[size]
    printed = columns.get(column_of(ratio))
    if printed is None:
        return None
    return Polyline(first, second, (UNIT * printed[0], UNIT * printed[1], UNIT * printed[2]))


def ratio_of(drive: Drive) -> float:
    """Return the ratio with the circular spline at rest: half the teeth of the flexspline."""
    return drive.flexspline_teeth / 2.0
