"""What the figures and tables share: colours, sizes, numbers in words, and the inputs as effects leave them."""

from typing import Any

from matplotlib.figure import Figure

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.quantities import Drive
from truing import Record

Run = Record[Drive, Stiffness]

BLUE, ORANGE, GREEN, INK, GREY, PALE = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c", "#e8eff5"
DIRECTIONS = {"x": BLUE, "y": ORANGE, "both": GREEN}
WIDTH = 6.4
MICRO, NANO = 1e6, 1e9


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


def signed(value: float, form: str = ".3g") -> str:
    """Write a number with a true minus sign and its power of ten as such."""
    text = format(value, form)
    digits, _, power = text.partition("e")
    if power:
        exponent = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        text = f"{digits}·10{exponent}"
    return text.replace("-", "−")


def microns(length: float, form: str = ".3g") -> str:
    """Write a length, m, in micrometres."""
    return f"{signed(length * MICRO, form)} µm"
