"""Planetary roller screw: the profile shift of roller and ring, and what it does to strength and sliding."""

from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.quantities import Meshing, Pair
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Pair, Meshing]]":
    """Offer one calculation: roller_screw_shift."""
    return [ROLLER_SCREW_SHIFT]
