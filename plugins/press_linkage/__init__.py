"""Servo-press linkage: exact slider position, error sensitivities, reliability and accuracy synthesis."""

from typing import TYPE_CHECKING

from truing import hookimpl

if TYPE_CHECKING:
    from press_linkage.quantities import Press, Slider
    from truing import Model


@hookimpl
def truing_models() -> "list[Model[Press, Slider]]":
    """Offer one calculation: press_linkage."""
    from press_linkage.model import PRESS_LINKAGE

    return [PRESS_LINKAGE]
