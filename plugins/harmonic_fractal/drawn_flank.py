"""The figures of a measured flank: from above, some of its profiles, its structure function with the local slopes."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from numpy.typing import NDArray

from harmonic_fractal.drawn_look import DIRECTIONS, GREY, INK, MICRO, NANO, ORANGE, PALE, WIDTH, panels, quiet
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.surface import Direction
from harmonic_fractal.verdict import HIGHEST, LOWEST

Array = NDArray[np.float64]
PIXELS = 400  # of the picture along either side
POINTS = 2000  # of a drawn profile
SHOWN = 4  # profiles


def map_figure(flank: "Flank") -> "Figure":
    """Draw the cleaned surface from above, its longer side across the sheet; holes are orange."""
    surface = flank.surface
    heights = NANO * surface.heights
    size = np.array([surface.spacing_x, surface.spacing_y]) * (np.array(heights.shape[::-1]) - 1) * MICRO
    names = ["x, µm", "y, µm"]
    if size[1] > size[0]:
        heights, size, names = heights.T, size[::-1], names[::-1]
    steps = [max(1, -(-count // PIXELS)) for count in heights.shape]
    height = float(np.clip(0.8 * WIDTH * size[1] / size[0], 1.0, 5.0))
    figure = Figure(figsize=(WIDTH, height + 0.7), layout="constrained")
    panel = figure.subplots()
    low, high = np.nanpercentile(heights, (0.2, 99.8))
    colours = colormaps["viridis"].with_extremes(bad=ORANGE)
    image = panel.imshow(
        heights[:: steps[0], :: steps[1]], origin="lower", extent=(0.0, size[0], 0.0, size[1]), cmap=colours,
        vmin=low, vmax=high, rasterized=True, interpolation="nearest",
    )  # fmt: skip
    panel.set_xlabel(names[0])
    panel.set_ylabel(names[1])
    figure.colorbar(image, ax=panel, label="height, nm", shrink=0.95, extend="both")
    return figure


def profiles_figure(flank: "Flank") -> "Figure":
    """Draw some lines along the direction that is used, or along x, one above the other."""
    direction: Direction = "y" if flank.chosen == "y" else "x"
    lines = flank.surface.lines(direction)
    count, points = lines.heights.shape
    chosen = np.unique(np.linspace(0, count - 1, min(count, SHOWN) + 2).round().astype(int)[1:-1]) if count > 1 else [0]
    level: Array = NANO * lines.heights[chosen]
    level -= np.nanmean(level, axis=1, keepdims=True)
    gap = 1.1 * float(np.nanmax(np.nanmax(level, axis=1) - np.nanmin(level, axis=1))) or 1.0
    figure, (panel,) = panels(1, 1.3 + 0.55 * len(level))
    place: Array = MICRO * lines.spacing * np.arange(points, dtype=float)
    for number, line in enumerate(level):
        x, z = _thinned(place, line)
        panel.plot(x, z + number * gap, color=DIRECTIONS[direction], linewidth=0.8)
    panel.set_xlim(place[0], place[-1])
    quiet(panel, f"{direction}, µm", "height, nm" if len(level) == 1 else "height, nm,\neach line set off")
    return figure


def _thinned(x: Array, z: Array) -> tuple[Array, Array]:
    """Return lowest and highest point of every piece of a long line, so that no peak is lost."""
    step = -(-2 * len(z) // POINTS)
    if step < 3:
        return x, z
    whole = len(z) // step * step
    pieces = z[:whole].reshape(-1, step)
    known = np.where(np.isfinite(pieces), pieces, np.nan)
    ends = np.stack([np.fmin.reduce(known, axis=1), np.fmax.reduce(known, axis=1)], axis=1)
    return np.repeat(x[:whole:step], 2), ends.ravel()


def structure_figure(flank: "Flank") -> "Figure":
    """Draw S over the lag with its fit along each direction; below, the local dimension of the profiles."""
    figure, (upper, lower) = panels(2, 5.6, sharex=True, height_ratios=(3, 2))
    for found in flank.estimates:
        _curve(upper, found, is_used=found.direction == flank.chosen)
        lower.semilogx(MICRO * found.local_lags, found.local_dimensions, "o-", color=DIRECTIONS[found.direction],
                       markersize=4, linewidth=0.9)  # fmt: skip
    used = flank.used
    if used is not None and np.isfinite(used.range).all():
        for panel in (upper, lower):
            panel.axvspan(MICRO * used.range[0], MICRO * used.range[1], facecolor=PALE, edgecolor=GREY, zorder=0,
                          label="self-affine range used" if panel is upper else "")  # fmt: skip
        lower.axhline(used.dimension, color=INK, linewidth=1.0, label=f"used, $D_s$ = {used.dimension:.3f}")
    for limit in (LOWEST, HIGHEST):
        lower.axhline(limit, color=GREY, linestyle=":", linewidth=1.0)
    shown = np.concatenate([found.local_dimensions for found in flank.estimates])
    shown = shown[np.isfinite(shown)]
    lower.set_ylim(min(0.95, float(shown.min(initial=1.0)) - 0.05), max(2.05, float(shown.max(initial=2.0)) + 0.05))
    quiet(upper, "", "structure function S, nm²")
    quiet(lower, "lag ξ, µm", "local $D_s$ of profiles")
    upper.legend(loc="best", fontsize=7.5, frameon=True, framealpha=0.9)
    if used is not None:
        lower.legend(loc="best", fontsize=7.5, frameon=True, framealpha=0.9)
    return figure


def _curve(panel: Any, found: "Estimate", *, is_used: bool) -> None:
    """Draw the measured points of one direction, and its fit: dashed where it is not used."""
    colour = DIRECTIONS[found.direction]
    lags, values = (found.all_lags, found.all_values) if found.all_lags.size else (found.lags, found.values)
    if not lags.size:
        return
    words = {"x": "along x", "y": "along y", "both": "both together"}[found.direction]
    panel.loglog(MICRO * lags, NANO**2 * values, "o", color=colour, markersize=3.5, markerfacecolor="none", label=words)
    if not (found.lags.size and 1.0 < found.dimension < 2.0):
        return
    law = structure_function(found.lags, found.dimension, found.roughness) + 2.0 * found.noise**2
    style = "-" if is_used else "--"
    state = "" if is_used else ", not used" if found.is_accepted else ", for comparison only"
    words = f"fit {words}{state}"
    panel.loglog(MICRO * found.lags, NANO**2 * law, style, color=colour, linewidth=1.4, label=words)
