"""What the figures share: colours, sizes, and the outcomes of a run."""

from typing import Any

from matplotlib.figure import Figure

from roller_screw_shift.answers import Meshing
from roller_screw_shift.quantities import Pair
from truing import Record

Run = Record[Pair, Meshing]

BLUE, ORANGE, GREEN, INK, GREY, PALE = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c", "#e8eff5"
WIDTH = 6.4
MM = 1e3


def panels(rows: int, height: float, **options: Any) -> "tuple[Figure, Any]":
    """A figure as wide as the sheet with panels below one another."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, 1, squeeze=False, **options)[:, 0]


def quiet(panel: Any, x_label: str = "", y_label: str = "") -> None:
    """Labels and a grid behind the lines."""
    panel.set_xlabel(x_label)
    panel.set_ylabel(y_label)
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)
