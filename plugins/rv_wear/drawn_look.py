"""What the figures share: colours, grids, and the inputs that a run was made with."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from rv_wear.answers import Wear
from rv_wear.quantities import Reducer
from truing import Record

Run = Record[Reducer, Wear]

BLUE, ORANGE, GREEN, INK, GREY = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c"
WIDTH = 6.4
MICRO, HOUR, ARCMIN = 1e-6, 3600.0, np.pi / 10800.0
SHADES = ("#12314d", "#1f5a8a", "#4f86b3", "#7d9a3c", "#c8941e", "#c8541e")
DASHES = ("-", "--", "-.", (0, (1, 1)), (0, (6, 1, 1, 1)), (0, (3, 1)))


def hours_of(reducer: Reducer) -> str:
    """The working time in words."""
    return f"{float(reducer.working_time) / HOUR:.4g} h"


def one_panel(height: float) -> "tuple[Figure, Any]":
    """A figure as wide as the sheet with one panel."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots()


def over_phase(panel: Any, label: str) -> None:
    """Axes over the phase angle."""
    panel.set_xlabel("phase angle of the pin from the crank line, °")
    panel.set_ylabel(label)
    panel.set_xlim(0, 180)
    panel.set_xticks(range(0, 181, 30))
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)


def over_hours(panel: Any, hours: ArrayLike, label: str) -> None:
    """Axes over the working time."""
    panel.set_xlabel("working time, h")
    panel.set_ylabel(label)
    panel.set_xlim(0, float(np.max(np.asarray(hours), initial=1.0)))
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)


def signed(value: float, digits: str = ".4g") -> str:
    """A number with a true minus."""
    return f"{value:{digits}}".replace("-", "−")


def degrees(angle: ArrayLike) -> NDArray[np.float64]:
    """Angles in degrees."""
    return np.asarray(np.degrees(angle), dtype=float)
