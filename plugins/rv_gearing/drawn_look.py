"""What the figures share: colours, panels, and what a finished run knows."""

from typing import Any

from matplotlib.figure import Figure

from gear_geometry.roots import Rack
from rv_gearing.answers import Strength
from rv_gearing.quantities import Gearing
from truing import Record

Run = Record[Gearing, Strength]

BLUE, ORANGE, GREEN, INK, GREY = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c"
SUN_FILL, PLANET_FILL = "#e8eff5", "#fbeee3"
WIDTH = 6.4
MM, MPA = 1e3, 1e-6


def number(record: "Run", name: str) -> float:
    """One result, SI."""
    return float(record.answers[name])


def rack_of(stage: Gearing) -> Rack:
    """The rack of both gears in the normal section, in modules."""
    return Rack(dedendum=float(stage.dedendum), fillet=float(stage.fillet), pressure_angle=float(stage.pressure_angle))


def one_panel(height: float) -> "tuple[Figure, Any]":
    """A figure as wide as the sheet with one panel."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots()


def minus(text: str) -> str:
    """A text of numbers with a true minus."""
    return text.replace("-", "−")
