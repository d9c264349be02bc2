"""Harmonic drive: from the measured roughness of the flanks to contact stiffness, clearance and torsion."""

from typing import Any

from harmonic_fractal.made_sheet import MADE_FLANK
from harmonic_fractal.model import HARMONIC_FRACTAL
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Any, Any]]":
    """Offer two calculations: harmonic_fractal, and harmonic_fractal.made_flank for surfaces of known truth."""
    return [HARMONIC_FRACTAL, MADE_FLANK]
