"""Servo-press linkage: exact slider position and its errors; the press in motion; and the press under load."""

from typing import Any

from press_linkage.loaded_sheet import LOADED
from press_linkage.model import PRESS_LINKAGE
from press_linkage.motion_sheet import MOTION
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Any, Any]]":
    """Offer press_linkage; press_linkage.motion for torque and joint forces; press_linkage.loaded for deflection."""
    return [PRESS_LINKAGE, LOADED, MOTION]
