"""What figures of several calculations share: colours, panels as wide as the sheet, and numbers as they are printed."""

from typing import Any

from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, INK, GREY, PALE = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c", "#e8eff5"
WIDTH = 6.4


def panels(rows: int, height: float, columns: int = 1, **options: Any) -> tuple[Figure, Any]:
    """Return a figure as wide as the sheet with its panels, or with the one panel that there is."""
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(rows, columns, **options)


def quiet(panel: Any, x_label: str = "", y_label: str = "", *, axis: str = "both", alpha: float = 0.4) -> None:
    """Put labels, and a grid behind the lines."""
    panel.set_xlabel(x_label)
    panel.set_ylabel(y_label)
    panel.grid(axis=axis, alpha=alpha)
    panel.set_axisbelow(True)


def signed(value: float, form: str = ".3g") -> str:
    """Write a number with a true minus sign and its power of ten as such."""
    text = format(value, form)
    digits, _, power = text.partition("e")
    if power:
        exponent = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        text = f"{digits}·10{exponent}"
    return text.replace("-", "−")
