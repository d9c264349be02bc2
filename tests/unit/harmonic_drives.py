"""Harmonic drives for the tests of their physics: the defaults but for some inputs, and the mesh of one."""

from dataclasses import replace
from typing import Any

from harmonic_fractal.contact import contact_of, interface_of
from harmonic_fractal.mesh import DriveMesh, mesh_of
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive


def drive_of(**changed: Any) -> Drive:
    """A drive with the defaults but for these inputs, SI."""
    made: Drive = replace(HARMONIC_FRACTAL.inputs(), **changed)
    return made


def mesh(drive: Drive) -> DriveMesh:
    """The engaged pairs of a drive."""
    return mesh_of(drive, contact_of(drive, interface_of(drive)))
