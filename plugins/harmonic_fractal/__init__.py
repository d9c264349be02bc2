"""Harmonic drive: from the measured roughness of the flanks to contact stiffness, clearance, torsion and vibration."""

from typing import Any

from harmonic_fractal.made_sheet import MADE_FLANK
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.vibration_sheet import RUN_UP, VIBRATION
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Any, Any]]":
    """Offer four calculations: the drive, surfaces of known truth, and its vibration over the speed and in time."""
    return [HARMONIC_FRACTAL, MADE_FLANK, RUN_UP, VIBRATION]
