"""The sheet of a made flank, its figures, and the calculation as truing knows it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_geometry.drawing import BLUE, GREY, INK, ORANGE, PALE, panels, quiet
from harmonic_fractal import made_flank as making
from harmonic_fractal.estimate import Estimate, straight_fit
from harmonic_fractal.figures import MICRO, NANO, from_above, set_off
from harmonic_fractal.structure import log_roughness_of, structure_function
from harmonic_fractal.surface import Surface, quantisation, spikes_of, without_form
from truing import Array, Block, Drawing, Model, Record, Section, Table, Words

# The figures of a made flank: the patch, some of its lines, and its structure function beside the truth

DrawnCurve = tuple[Array, Array]
SHOWN = 5  # lines that are drawn


def map_figure(surface: Surface) -> "Figure":
    """The patch from above, less its mean plane; holes are orange."""
    rows, points = surface.heights.shape
    size = MICRO * np.array([(points - 1) * surface.spacing_x, (rows - 1) * surface.spacing_y])
    level = NANO * without_form(surface.heights, "plane")
    return from_above(level, size, ("x, along the lines, µm", "y, µm"), np.nanpercentile(level, (0.1, 99.9)), 7.0)


def lines_figure(surface: Surface) -> "Figure":
    """Some lines, evenly over the patch, one above the other."""
    rows, points = surface.heights.shape
    chosen = np.unique(np.linspace(0, rows - 1, min(rows, SHOWN)).round().astype(int))
    names = [f"y = {MICRO * surface.spacing_y * row:.4g} µm" for row in chosen] if rows > 1 else []
    level = NANO * without_form(surface.heights, "plane")[chosen]
    return set_off(MICRO * surface.spacing_x * np.arange(points, dtype=float), level, "x", names)


def structure_figure(made: making.Made, truth: making.Truth, answer: making.MadeFlank, found: Estimate) -> "Figure":
    """S of this flank beside the exact one and what was fitted; the same over the power law; local slopes."""
    figure, (upper, middle, lower) = panels(3, 7.6, sharex=True, height_ratios=(3, 2, 2))
    shown = np.asarray(answer.lag, dtype=np.float64)
    lags = np.geomspace(shown[0], shown[-1], 400)
    exact = making.exact_structure_function(made, lags)
    own = np.asarray(answer.structure_function, dtype=np.float64)
    curves = ((shown, own), (lags, exact), (shown, making.levelled_structure_function(made, shown)))
    for panel, over in ((upper, None), (middle, truth)):
        _curves(panel, over, curves, found)
    upper.set_yscale("log")
    quiet(upper, "", "S, nm²")
    upper.legend(loc="best")
    low, high = middle.get_ylim()
    middle.set_ylim(max(low, 0.0), min(high, 3.0))
    quiet(middle, "", "S over power law")
    _local_slopes(lower, truth, (lags, exact), found)
    return figure


def _curves(
    panel: Any, over: making.Truth | None, curves: tuple[DrawnCurve, DrawnCurve, DrawnCurve], found: Estimate
) -> None:
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


def _local_slopes(panel: Any, truth: making.Truth, exact: DrawnCurve, found: Estimate) -> None:
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
    quiet(panel, "lag, µm", "local dimension of profiles")
    panel.legend(loc="best")


MadeRun = Record[making.Made, making.MadeFlank]

FOUND_AGAIN = (
    "The estimator sees the flank as it would see a measured one: each line without its own straight line, and one "
    "power law through S from the spacing to a tenth of a line, as far as the local slopes agree. What it misses of "
    "the truth here it misses on a measured flank too: levelling and noise raise the dimension, a lateral filter "
    "lowers it."
)
TRUTH = {
    "areal": "A sum of plane waves in many directions, each with a random phase. Their amplitudes are fixed, so flanks "
    "of one truth scatter less than ground ones do; S has a faint ripple, because the frequencies are a row of powers "
    "of the density.",
    "brownian": "Fractional Brownian motion: Gaussian, alike in all directions, S a power law without end or ripple.",
    "profile": "Each line is a sum of waves with phases of its own. Neighbouring lines know nothing of one another, so "
    "only the direction along the lines means anything.",
}


def truth(record: "MadeRun") -> "Sequence[Block]":
    """What kind of surface this is."""
    return [Words(TRUTH[record.inputs.kind])]


def look(record: "MadeRun") -> "Sequence[Block]":
    """The patch and some of its lines."""
    surface = making.surface_of(record.inputs)
    lines = Drawing("Lines of the flank", partial(lines_figure, surface))
    if surface.is_profile:
        return [lines]
    holes = " Orange: not measured." if np.isnan(surface.heights).any() else ""
    caption = f"Less its mean plane.{holes}"
    return [Drawing("The flank from above", partial(map_figure, surface), caption), lines]


def structure(record: "MadeRun") -> "Sequence[Block]":
    """The structure function beside the truth."""
    made, surface = record.inputs, making.surface_of(record.inputs)
    found = making.estimate_along(made, surface, "x")
    caption = (
        "Middle: the same S over the power law of the truth. At long lags one flank strays from the mean of all, and "
        "levelled lines fall below it as the dotted line says. Below: the dimension between neighbouring lags; dashed: "
        "the true one."
    )
    draw = partial(structure_figure, made, making.truth_of(made), record.results, found)
    return [Drawing("Structure function and local slopes", draw, caption)]


def found_again(record: "MadeRun") -> "Sequence[Block]":
    """Both directions beside the truth, and the verdict."""
    made, surface, true = record.inputs, making.surface_of(record.inputs), making.truth_of(record.inputs)
    along = making.estimate_along(made, surface, "x")
    found = [("along the lines, x", along)]
    if made.spikes > 0.0:
        found.append(("the same, spikes taken out", making.estimate_along(made, _cleaned(surface), "x")))
    if making.is_patch(made, true) and made.directions > 1:
        found.append(("across the lines, y", making.estimate_along(made, surface, "y")))
    rows = [_row(name, each) for name, each in found]
    table = Table(
        "Truth and what was found",
        ("", "D", "half width", "G", "half width", "R²", "self-affine range", "verdict"),
        [("truth", true.dimension + 1.0, None, true.areal, None, None, "", ""), _expected(made, along), *rows],
        ("", "", "", "m", "decades", "", "µm", ""),
        note="Half width: of the 95 % interval by resampling lines, neighbours together. It cannot see what all lines "
        "of one flank share: flanks of other seeds stray by up to twice as much about what levelling lets expect.",
    )
    return [Words(FOUND_AGAIN), table, *_said(along)]


def _expected(made: making.Made, found: Estimate) -> tuple[str | float | None, ...]:
    """What levelling alone makes of the truth, over the lags of the fit."""
    law = straight_fit(found.lags, making.levelled_structure_function(made, found.lags))
    dimension = 2.0 - float(law.slope) / 2.0
    roughness = float(np.exp(log_roughness_of(law.intercept, dimension)))
    return ("expected along levelled lines", dimension + 1.0, None, roughness, None, float(law.r_squared), "", "")


def _cleaned(surface: Surface) -> Surface:
    """Take out spikes as it is done with a measured flank."""
    spikes = spikes_of(surface.heights, quantisation(surface.heights))
    return replace(surface, heights=np.where(spikes, np.nan, surface.heights))


def _row(name: str, found: Estimate) -> tuple[str | float | None, ...]:
    low, high = found.range
    reach = f"{1e6 * low:.3g} to {1e6 * high:.3g}" if found.is_accepted else "none"
    widths = _half_widths(found)
    verdict = "accepted" if found.is_accepted else "refused"
    return (name, found.dimension + 1.0, widths[0], found.roughness, widths[1], found.r_squared, reach, verdict)


def _half_widths(found: Estimate) -> tuple[float | None, float | None]:
    """Half of the central 95 % of D, and of log10 G; None without resamples."""
    if len(found.resampled) < 2:
        return None, None
    low, high = np.percentile(found.resampled, (2.5, 97.5), axis=0)
    half = 0.5 * (high - low)
    return float(half[0]), float(half[1] / np.log(10.0))


def _said(found: Estimate) -> list[Words]:
    """Say why the estimator refuses the flank, or what it doubts."""
    if found.reason:
        text = f"The estimator refuses this flank: {found.reason}. What was fitted stands for comparison only."
        return [Words(text, "finding")]
    return [Words(f"The estimator says: {text}.", "warning") for text in found.warnings]


SECTIONS = [
    Section(
        "Truth",
        "profile_dimension", "areal_roughness", "points", "lines", "longest", "shortest",
        blocks=truth,
    ),
    Section("The flank", "rms_height", "height", blocks=look),
    Section("Structure function", "lag", "structure_function", "exact", "power_law", blocks=structure),
    Section(
        "Found again",
        "fitted_dimension", "dimension_error", "fitted_roughness", "roughness_error", "accepted",
        blocks=found_again,
    ),
]  # fmt: skip


LITERATURE = [
    "Majumdar, A., Tien, C. L., Fractal characterization and simulation of rough surfaces, Wear 136 (1990), p. 313.",
    "Yan, W., Komvopoulos, K., Contact analysis of elastic-plastic fractal surfaces, Journal of Applied Physics 84 "
    "(1998), p. 3617.",
    "Davies, R. B., Harte, D. S., Tests for Hurst effect, Biometrika 74 (1987), p. 95.",
    "Stein, M. L., Fast and exact simulation of fractional Brownian surfaces, Journal of Computational and Graphical "
    "Statistics 11 (2002), p. 587.",
    "ISO 16610-21, Geometrical product specifications: filtration, linear profile filters: Gaussian filters.",
]

MADE_FLANK = Model(
    name="made_flank",
    title="Made flank: a rough surface of known truth",
    function=making.made_flank,
    studies=[making.FlankFile()],
    sheet=SECTIONS,
    cites=LITERATURE,
    example=Path(__file__).with_name("made_flank.toml"),
    summary="What does a flank of a given fractal dimension and roughness look like, and does an estimator find them "
    "again through noise, filter, holes and spikes? The flank is written as a file.",
)
