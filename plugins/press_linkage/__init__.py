"""Servo-press linkage: exact slider position and its errors; and the press in motion, with its torque and forces."""

from typing import Any

from press_linkage.model import PRESS_LINKAGE
from press_linkage.motion_sheet import MOTION
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Any, Any]]":
    """Offer two calculations: press_linkage, and press_linkage.motion for forces over a stroke."""
    return [PRESS_LINKAGE, MOTION]
