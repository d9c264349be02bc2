"""The figures of a made flank: the patch, some of its lines, and its structure function beside the truth."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from harmonic_fractal.cleaning import without_form
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.generators import Array
from harmonic_fractal.made_answers import MadeFlank
from harmonic_fractal.made_calculation import exact_structure_function, levelled_structure_function
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.made_truth import Truth
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.surface import Surface

Curve = tuple[Array, Array]
BLUE, ORANGE, GREEN, INK, GREY, PALE = "#1f5a8a", "#c8641e", "#2f6b4f", "#22262b", "#7d838c", "#e8eff5"
WIDTH = 6.4
MICRO, NANO = 1e6, 1e9
SHOWN = 5  # lines that are drawn


def map_figure(surface: Surface) -> "Figure":
    """The patch from above, less its mean plane; holes are orange."""
    rows, points = surface.heights.shape
    extent = (0.0, (points - 1) * surface.spacing_x * MICRO, 0.0, (rows - 1) * surface.spacing_y * MICRO)
    height = float(np.clip(0.8 * WIDTH * extent[3] / extent[1], 1.2, 7.0))
    figure = Figure(figsize=(WIDTH, height + 0.6), layout="constrained")
    panel = figure.subplots()
    level = NANO * without_form(surface.heights, "plane")
    low, high = np.nanpercentile(level, (0.1, 99.9))
    colours = colormaps["viridis"].with_extremes(bad=ORANGE)
    image = panel.imshow(level, origin="lower", extent=extent, cmap=colours, vmin=low, vmax=high,
                         interpolation="nearest")  # fmt: skip
    panel.set_xlabel("x, along the lines, µm")
    panel.set_ylabel("y, µm")
    figure.colorbar(image, ax=panel, label="height, nm", shrink=0.9, extend="both")
    return figure


def lines_figure(surface: Surface) -> "Figure":
    """Some lines, evenly over the patch, one above the other."""
    rows, points = surface.heights.shape
    chosen = np.unique(np.linspace(0, rows - 1, min(rows, SHOWN)).round().astype(int))
    level = NANO * without_form(surface.heights, "plane")[chosen]
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
    """S of this flank beside the exact one and what was fitted; the same over the power law; local slopes."""
    figure = Figure(figsize=(WIDTH, 7.6), layout="constrained")
    upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
    shown = np.asarray(answer.lag, dtype=np.float64)
    lags = np.geomspace(shown[0], shown[-1], 400)
    exact = exact_structure_function(made, lags)
    own = np.asarray(answer.structure_function, dtype=np.float64)
    curves = ((shown, own), (lags, exact), (shown, levelled_structure_function(made, shown)))
    for panel, over in ((upper, None), (middle, truth)):
        _curves(panel, over, curves, found)
    upper.set_yscale("log")
    _quiet(upper, "", "S, nm²")
    upper.legend(loc="best")
    low, high = middle.get_ylim()
    middle.set_ylim(max(low, 0.0), min(high, 3.0))
    _quiet(middle, "", "S over power law")
    _local_slopes(lower, truth, (lags, exact), found)
    return figure


def _curves(panel: Any, over: Truth | None, curves: tuple[Curve, Curve, Curve], found: Estimate) -> None:
    """Draw S of this flank, the exact one and that of levelled lines: in nm^2, or over the power law of the truth."""
    own, exact, levelled = curves

    def shown(lags: Array, values: Array) -> Array:
        return NANO**2 * values if over is None else values / structure_function(lags, over.dimension, over.areal)

    law = np.asarray(structure_function(found.lags, found.dimension, found.roughness))
    panel.semilogx(MICRO * exact[0], shown(*exact), color=INK, linewidth=1.0, label="exact, of all such flanks")
    panel.semilogx(MICRO * levelled[0], shown(*levelled), color=INK, linestyle=":", label="the same, lines levelled")
    panel.semilogx(MICRO * own[0], shown(*own), "o", color=BLUE, markersize=4, markerfacecolor="none",
                   label="this flank as measured")  # fmt: skip
    panel.semilogx(MICRO * found.lags, shown(found.lags, found.values), ".", color=ORANGE, markersize=5,
                   label="its lines levelled, as fitted")  # fmt: skip
    panel.semilogx(MICRO * found.lags, shown(found.lags, law), color=ORANGE, linewidth=1.0, label="power law fitted")
    if over is not None:
        panel.axhline(1.0, color=GREY, linestyle="--", linewidth=1.0)


def _local_slopes(panel: Any, truth: Truth, exact: Curve, found: Estimate) -> None:
    """Draw the dimension between neighbouring lags, of the levelled lines and of the exact S."""
    edges = np.linspace(np.log(exact[0][0]), np.log(exact[0][-1]), 11)
    slopes = np.diff(np.interp(edges, np.log(exact[0]), np.log(exact[1]))) / np.diff(edges)
    middles = MICRO * np.exp(0.5 * (edges[1:] + edges[:-1]))
    panel.semilogx(middles, 2.0 - slopes / 2.0, color=INK, linewidth=1.0, label="exact")
    panel.semilogx(MICRO * found.local_lags, found.local_dimensions, "o-", color=ORANGE, markersize=4, linewidth=0.8,
                   label="this flank, lines levelled")  # fmt: skip
    panel.axhline(truth.dimension, color=GREY, linestyle="--", linewidth=1.0)
    if found.is_accepted:
        panel.axvspan(MICRO * found.range[0], MICRO * found.range[1], color=PALE, zorder=0, label="self-affine range")
    panel.set_ylim(0.95, 2.05)
    _quiet(panel, "lag, µm", "local dimension of profiles")
    panel.legend(loc="best")


def _quiet(panel: Any, x_label: str, y_label: str) -> None:
    panel.set_xlabel(x_label)
    panel.set_ylabel(y_label)
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)
