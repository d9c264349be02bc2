"""Servo-press linkage: exact slider position, error sensitivities, reliability and accuracy synthesis."""

from press_linkage.model import PRESS_LINKAGE
from press_linkage.quantities import Press, Slider
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Press, Slider]]":
    """Offer one calculation: press_linkage."""
    return [PRESS_LINKAGE]
