"""The figures of a made flank: the patch, some of its lines, and its structure function beside the truth."""

from typing import TYPE_CHECKING, Any

import numpy as np

from harmonic_fractal.estimate import Estimate
from harmonic_fractal.made_calculation import Truth, exact_structure_function, without_plane
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.surface import Surface

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from harmonic_fractal.made_answers import MadeFlank

BLUE, ORANGE, GREEN, INK, GREY, PALE = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c", "#e8eff5"
WIDTH = 6.4
MICRO, NANO = 1e6, 1e9
SHOWN = 5  # lines that are drawn


def map_figure(surface: Surface) -> "Figure":
    """The patch from above, less its mean plane; holes are orange."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    rows, points = surface.heights.shape
    extent = (0.0, (points - 1) * surface.spacing_x * MICRO, 0.0, (rows - 1) * surface.spacing_y * MICRO)
    height = float(np.clip(0.8 * WIDTH * extent[3] / extent[1], 1.2, 7.0))
    figure = Figure(figsize=(WIDTH, height + 0.6), layout="constrained")
    panel = figure.subplots()
    level = NANO * without_plane(surface.heights)
    low, high = np.nanpercentile(level, (0.1, 99.9))
    colours = colormaps["viridis"].with_extremes(bad=ORANGE)
    image = panel.imshow(level, origin="lower", extent=extent, cmap=colours, vmin=low, vmax=high, rasterized=True)
    panel.set_xlabel("x, along the lines, µm")
    panel.set_ylabel("y, µm")
    figure.colorbar(image, ax=panel, label="height, nm", shrink=0.9, extend="both")
    return figure


def lines_figure(surface: Surface) -> "Figure":
    """Some lines, evenly over the patch, one above the other."""
    from matplotlib.figure import Figure

    rows, points = surface.heights.shape
    chosen = np.unique(np.linspace(0, rows - 1, min(rows, SHOWN)).round().astype(int))
    level = NANO * without_plane(surface.heights)[chosen]
    gap = 1.2 * float(np.nanmax(np.nanmax(level, axis=1) - np.nanmin(level, axis=1))) or 1.0
    figure = Figure(figsize=(WIDTH, 1.2 + 0.6 * len(chosen)), layout="constrained")
    panel = figure.subplots()
    x = MICRO * surface.spacing_x * np.arange(points)
    for place, (row, line) in enumerate(zip(chosen, level, strict=True)):
        panel.plot(x, line - np.nanmean(line) + place * gap, color=BLUE, linewidth=0.8)
        if rows > 1:
            name = f"y = {MICRO * surface.spacing_y * row:.4g} µm"
            panel.annotate(name, (1.0, place * gap), xycoords=("axes fraction", "data"), fontsize=7.5, va="center")
    panel.set_xlim(x[0], x[-1])
    _quiet(panel, "x, µm", "height, nm" if len(chosen) == 1 else "height, nm, each line set off")
    return figure


def structure_figure(made: Made, truth: Truth, answer: "MadeFlank", found: Estimate) -> "Figure":
    """S of this flank beside the exact one and what was fitted; below, the dimension by local slopes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    lags = np.geomspace(answer.lag[0], answer.lag[-1], 200)
    law = np.asarray(structure_function(lags, truth.dimension, truth.areal))
    exact = exact_structure_function(made, lags)
    upper.loglog(MICRO * lags, NANO**2 * law, color=GREY, linestyle="--", linewidth=1.0, label="power law")
    upper.loglog(MICRO * lags, NANO**2 * exact, color=INK, linewidth=1.0, label="exact, of all such flanks")
    upper.loglog(MICRO * answer.lag, NANO**2 * answer.structure_function, "o", color=BLUE, markersize=4,
                 markerfacecolor="none", label="this flank as measured")  # fmt: skip
    upper.loglog(MICRO * found.lags, NANO**2 * found.values, ".", color=ORANGE, markersize=5,
                 label="lines levelled, as fitted")  # fmt: skip
    fitted = np.asarray(structure_function(found.lags, found.dimension, found.roughness))
    upper.loglog(MICRO * found.lags, NANO**2 * fitted, color=ORANGE, label="straight line fitted")
    _quiet(upper, "", "S, nm²")
    upper.legend(loc="lower right")
    slopes = np.diff(np.log(exact)) / np.diff(np.log(lags))
    lower.semilogx(MICRO * np.sqrt(lags[1:] * lags[:-1]), 2.0 - slopes / 2.0, color=INK, linewidth=1.0, label="exact")
    lower.semilogx(MICRO * found.local_lags, found.local_dimensions, "o-", color=ORANGE, markersize=4, linewidth=0.8,
                   label="this flank, lines levelled")  # fmt: skip
    lower.axhline(truth.dimension, color=GREY, linestyle="--", linewidth=1.0)
    if found.is_accepted:
        lower.axvspan(MICRO * found.range[0], MICRO * found.range[1], color=PALE, zorder=0, label="self-affine range")
    lower.set_ylim(0.95, 2.05)
    _quiet(lower, "lag, µm", "local dimension of profiles")
    lower.legend(loc="upper left")
    return figure


def _quiet(panel: Any, x_label: str, y_label: str) -> None:
    panel.set_xlabel(x_label)
    panel.set_ylabel(y_label)
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)
