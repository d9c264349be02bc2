"""The figures and tables of the sheet: the flank, both flanks as one, one pair over its load, torsion."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from gear_geometry.drawing import BLUE, GREEN, GREY, INK, ORANGE, PALE, WIDTH, panels, quiet, signed
from harmonic_fractal import contact as rough_contact
from harmonic_fractal.calculation import (
    Polyline,
    around_of,
    ball_torsion,
    over,
    polyline_of,
    ratio_of,
    wave_scale,
    wave_torsion,
)
from harmonic_fractal.contact import Rough, contact_of, flanks_of, interface_of, pressed
from harmonic_fractal.estimate import HIGHEST, LOWEST, Estimate
from harmonic_fractal.flank import Flank
from harmonic_fractal.mesh import load_of_largest, mesh_of, mesh_torsion
from harmonic_fractal.quantities import Drive, Stiffness
from harmonic_fractal.structure import Convention, constant, converted, structure_function
from harmonic_fractal.surface import Direction
from truing import Array, Block, Drawing, Float, Record, Table, Words

DriveRun = Record[Drive, Stiffness]

DIRECTIONS = {"x": BLUE, "y": ORANGE, "both": GREEN}
MICRO, NANO = 1e6, 1e9


def microns(length: float, form: str = ".3g") -> str:
    """Write a length, m, in micrometres."""
    return f"{signed(length * MICRO, form)} µm"


# The figures of a measured flank: from above, some of its profiles, its structure function with the local slopes

PIXELS = 400  # of the picture along either side
PROFILE_POINTS = 2000  # of a drawn profile
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
    limits = np.nanpercentile(heights, (0.2, 99.8))
    return from_above(heights[:: steps[0], :: steps[1]], size, names, limits)


def from_above(heights: Array, size: Array, names: Sequence[str], limits: Array, tallest: float = 5.0) -> Figure:
    """Draw heights, nm, of a rectangle of this size, um; what is NaN is orange."""
    height = float(np.clip(0.8 * WIDTH * size[1] / size[0], 1.0, tallest))
    figure, panel = panels(1, height + 0.7)
    image = panel.imshow(
        heights, origin="lower", extent=(0.0, size[0], 0.0, size[1]), vmin=limits[0], vmax=limits[1],
        cmap=colormaps["viridis"].with_extremes(bad=ORANGE), rasterized=True, interpolation="nearest",
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
    place: Array = MICRO * lines.spacing * np.arange(points, dtype=float)
    return set_off(place, NANO * lines.heights[chosen], direction)


def set_off(x: Array, heights: Array, direction: Direction, names: Sequence[str] = ()) -> Figure:
    """Draw lines (lines, points), nm, over x, um, one above the other, with their names at their ends."""
    level = heights - np.nanmean(heights, axis=1, keepdims=True)
    gap = 1.1 * float(np.nanmax(np.nanmax(level, axis=1) - np.nanmin(level, axis=1))) or 1.0
    figure, panel = panels(1, 1.3 + 0.55 * len(level))
    for number, line in enumerate(level):
        along, z = _thinned(x, line)
        panel.plot(along, z + number * gap, color=DIRECTIONS[direction], linewidth=0.8)
    for number, name in enumerate(names):
        panel.annotate(name, (1.0, number * gap), xycoords=("axes fraction", "data"), fontsize=7.5, va="center")
    panel.set_xlim(x[0], x[-1])
    quiet(panel, f"{direction}, µm", "height, nm" if len(level) == 1 else "height, nm,\neach line set off")
    return figure


def _thinned(x: Array, z: Array) -> tuple[Array, Array]:
    """Return lowest and highest point of every piece of a long line, so that no peak is lost."""
    step = -(-2 * len(z) // PROFILE_POINTS)
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


# What is said of a measured flank: whether it is used and along which direction, and the tables behind that

ALONG = {"x": "along x", "y": "along y", "both": "x and y together"}
COMPARISON = (
    "Its fit stands below for comparison only: a straight line through ln S over ln lag always finds some D and G, and "
    "its R² does not tell whether the surface is self-affine."
)


def verdict(flank: "Flank", body: str, instead: str) -> "Iterator[Block]":
    """Say whether a flank is used; ``instead`` says what the contact is made of where it is refused."""
    name = flank.surface.name
    if flank.used is None:
        yield Words(
            f"REFUSED: the flank of the {body}, {name}, has no D and G. The contact below is NOT that of this surface: "
            f"{instead}. Reason: {flank.reason}. {COMPARISON}",
            "warning",
        )
    else:
        yield Words(f"The flank of the {body}, {name}, is used. {_used(flank, flank.used)}")
    for sentence in flank.warnings:
        yield Words(f"{name}: {sentence}.", "warning")
    yield Words(_cleaned(flank))


def _used(flank: "Flank", used: "Estimate") -> str:
    found = (
        f"Its profiles have the dimension {used.dimension:.3f} and G = {signed(used.roughness)} m over lags of "
        f"{microns(used.range[0])} to {microns(used.range[1])}. Structure function and roughness-length method: "
        f"{judged(used)}."
    )
    if flank.surface.is_profile:
        return f"{found} It is one profile: that the flank is the same in all directions is assumed, not measured."
    if flank.chosen == "both":
        return f"{found} Lines along x and along y agree and are pooled."
    return (
        f"{found} It is taken along {flank.chosen} only: the contact is that of a surface that looks in all directions "
        f"as this one does along {flank.chosen}."
    )


def _cleaned(flank: "Flank") -> str:
    rows, points = flank.surface.heights.shape
    surface = flank.surface
    size = f"{points} points, {microns(surface.spacing_x, '.4g')} apart"
    if not surface.is_profile:
        size = f"{points} × {rows} points, {microns(surface.spacing_x, '.4g')} apart along x"
        size += "" if surface.is_square else f" and {microns(surface.spacing_y, '.4g')} along y"
        size += " and y" if surface.is_square else ""
    return (
        f"{size}. Root mean square height: {microns(flank.sq_raw, '.4g')} as read, {microns(flank.sq_plane, '.4g')} "
        f"less the mean {'line' if surface.is_profile else 'plane'}, {microns(flank.sq_second_order, '.4g')} less the "
        f"second-order form. Not measured: {100 * flank.missing:.2g} % of the points; taken as spikes: "
        f"{100 * flank.spiked:.2g} %."
    )


def pictures(flank: "Flank") -> "Iterator[Block]":
    """The surface, some profiles, and the structure function."""
    title = f"{flank.surface.name}: "
    if not flank.surface.is_profile:
        yield Drawing(f"{title}from above", partial(map_figure, flank), "Cleaned. Orange: not measured, or a spike.")
    caption = "The form is removed; the levelling of single lines is not shown."
    yield Drawing(f"{title}profiles", partial(profiles_figure, flank), "" if flank.surface.is_profile else caption)
    yield Drawing(
        f"{title}structure function and local dimension", partial(structure_figure, flank),
        "A self-affine surface is a straight line above and a level one below. Dotted: 1.05 and 1.95, below which a "
        "surface is smooth and above which it is noise.",
    )  # fmt: skip


def tables(flank: "Flank") -> "Iterator[Block]":
    """Both directions with their verdict, and the local slopes."""
    name = flank.surface.name
    has_noise = any(found.noise > 0.0 for found in flank.estimates)
    columns = ("direction", "lags of the fit from", "to", "D_s", "G, areal", "R²", "sd of D_s over lines",
               *["noise"] * has_noise, "verdict")  # fmt: skip
    units = ("", "µm", "µm", "", "m", "", "", *["nm"] * has_noise, "")
    rows: list[tuple[str | float | None, ...]] = []
    for found in flank.estimates:
        ends = [MICRO * float(found.lags[end]) for end in (0, -1)] if found.lags.size else [None, None]
        fit = [or_none(each) for each in (found.dimension, found.roughness, found.r_squared, found.line_scatter)]
        state = "self-affine, not used" if found.is_accepted else "refused, for comparison only"
        state = "used" if found.direction == flank.chosen else state
        rows.append((ALONG[found.direction], *ends, *fit, *[NANO * found.noise] * has_noise, state))
    yield Table(f"{name}: what each direction says", columns, rows, units)
    if any(found.is_accepted for found in flank.estimates):
        yield _intervals(flank)
    yield _others(flank)
    yield _slopes(flank)


def _intervals(flank: "Flank") -> Table:
    """D and G with what levelling did to them taken out, and how sure they are."""
    rows: list[tuple[str | float | None, ...]] = []
    for found in flank.estimates:
        if found.is_accepted:
            dimension, roughness = found.dimension_interval, found.roughness_interval
            numbers = (found.levelled_dimension, found.dimension, *dimension, found.roughness, *roughness)
            rows.append((ALONG[found.direction], *(or_none(each) for each in numbers)))
    note = (
        "Levelling takes long lags from S and so raises D_s; the bias is that of a Gaussian surface of this size, and "
        "it is taken out. The intervals are those of Gaussian patches of this size, alike in all directions, or of "
        "blocks of the measured lines where these scatter more."
    )
    columns = ("direction", "D_s as levelled", "D_s", "2.5 %", "97.5 %", "G, areal", "2.5 %", "97.5 %")
    return Table(
        f"{flank.surface.name}: how sure D and G are", columns, rows, ("", "", "", "", "", "m", "m", "m"), note
    )


APART = 2.0
"""Standard deviations of their difference from which two methods disagree: by chance 5 % of surfaces do."""


def judged(found: "Estimate") -> str:
    """Say whether the roughness-length method agrees with the structure function."""
    if not found.is_accepted:
        return "no range: neither means anything"
    if not np.isfinite(found.window_sds):
        return "not known: the lags of the fit are too few for windows"
    if abs(found.window_sds) <= APART:
        return "agree within their scatter"
    return "disagree: S is no power law within the windows, or heights are not Gaussian"


def _others(flank: "Flank") -> Table:
    """The dimension by other ways, which only compare."""
    rows = [
        (
            ALONG[found.direction],
            *(or_none(value) for value in (found.dimension, found.window_dimension)),
            or_none(found.window_disagreement),
            or_none(found.window_sds),
            judged(found),
            or_none(found.noise_dimension),
            or_none(100.0 * found.noise_share),
        )
        for found in flank.estimates
    ]
    columns = ("direction", "D_s by S", "by roughness-length", "less that by S, windows calibrated", "in sd", "judged",
               "D_s by S with noise", "noise in S at the shortest lag")  # fmt: skip
    note = (
        "The roughness-length method, which the patent names, looks at windows of a line. Its difference is judged "
        "with windows within the lags of the fit, after what short windows miss was put back, in standard deviations "
        "that it has by chance. The fit with noise takes a constant beside the power law; where it differs much, D and "
        "G are partly those of the instrument."
    )
    units = ("", "", "", "", "", "", "", "%")
    return Table(f"{flank.surface.name}: D_s by other ways, for comparison", columns, rows, units, note)


def or_none(value: float) -> float | None:
    """Return a number, or None in place of NaN."""
    return value if value == value else None


def _slopes(flank: "Flank") -> Table:
    """The local slopes, the directions side by side: each has lags of its own."""
    longest = max((len(found.local_lags) for found in flank.estimates), default=0)
    rows: list[list[float | None]] = [[] for _ in range(longest)]
    for found in flank.estimates:
        for place, row in enumerate(rows):
            known = place < len(found.local_lags)
            row += [MICRO * found.local_lags[place], found.local_dimensions[place]] if known else [None, None]
    columns = [f"{ALONG[found.direction]}: {what}" for found in flank.estimates for what in ("lag", "local D_s")]
    note = (
        "Between neighbouring lags, at their geometric mean. Asked for: a decade of lags over which D_s spans less "
        "than 0.2 and stays within 1.05 to 1.95. Near 1 the instrument smooths or form is left; near 2 there is noise "
        "(short lags) or the correlation length is passed (long lags)."
    )
    return Table(f"{flank.surface.name}: local slopes", columns, rows, ("µm", "") * len(flank.estimates), note)


def said_of(flank: "Flank", body: str, instead: str) -> "Sequence[Block]":
    """Everything about one flank, in order."""
    return [*verdict(flank, body, instead), *pictures(flank), *tables(flank)]


# What is said of D and G: where they come from, both flanks as one, and G in every convention that is in use

KINDS: dict[Convention, str] = {
    "areal": "areal, ridges in all directions (used here)",
    "one_direction": "areal, ridges across the trace",
    "profile": "profile, Weierstrass-Mandelbrot, with ln γ",
}
STATED = "No flank was measured: D and G are as stated, and how sure they are is not known."


def flanks(record: "DriveRun") -> "Sequence[Block]":
    """Every measured flank with its verdict; else that nothing was measured."""
    drive = record.acting
    blocks: list[Block] = []
    if drive.surface is not None:
        blocks += said_of(drive.surface, "flexspline", _stated(drive.fractal_dimension, drive.fractal_roughness))
    if drive.mating_surface is not None:
        instead = "mating_dimension is not stated, so the circular spline is taken as smooth"
        if not np.isnan(drive.mating_dimension):
            instead = _stated(drive.mating_dimension, drive.mating_roughness)
        blocks += said_of(drive.mating_surface, "circular spline", instead)
    return blocks or [Words(STATED)]


def _stated(dimension: Float, roughness: Float) -> str:
    stated = f"D = {float(dimension):.4g} and G = {signed(float(roughness))} m"
    return f"it is that of the D and G stated in the inputs, {stated}"


def interface(record: "DriveRun") -> "Sequence[Block]":
    """Both flanks and their sum, and G in every convention."""
    return [_both(record), conventions(record)]


def _both(record: "DriveRun") -> Table:
    drive = record.acting
    first, second = flanks_of(drive)
    mating: tuple[float | None, float | None, str] = (None, None, "smooth")
    if second is not None:
        mating = (float(second.dimension), float(second.roughness), _origin(drive.mating_surface))
    rows = [
        ("flexspline", float(first.dimension), float(first.roughness), _origin(drive.surface)),
        ("circular spline", *mating),
        ("both together", float(record.answers["dimension"]), float(record.answers["roughness"]), _sum(drive, second)),
    ]
    note = "Independent flanks add their structure functions; one power law is fitted to the sum."
    return Table("Both flanks", ("flank", "D", "G, areal", "from"), rows, ("", "", "m", ""), note)


def _origin(flank: object) -> str:
    used = getattr(flank, "used", None)
    if used is None:
        return "as stated" if flank is None else "as stated: the surface is refused"
    return {"x": "measured, along x only", "y": "measured, along y only", "both": "measured, x and y"}[used.direction]


def _sum(drive: "Drive", second: "Rough | None") -> str:
    deviates = float(drive.dimension_deviation) or float(drive.roughness_deviation)
    words = "one flank alone" if second is None else "sum of the structure functions"
    return f"{words}, and the stated deviations" if deviates else words


def conventions(record: "DriveRun") -> Table:
    """G of both flanks in every convention, and by the constant that lacks a factor."""
    drive, areal = record.acting, float(record.answers["roughness"])
    profile, density = float(record.answers["profile_dimension"]), float(drive.density)
    rows = []
    for kind, words in KINDS.items():
        value = float(converted(areal, profile, density, source="areal", target=kind))
        rows.append((words, float(constant(profile, density, kind)), value, value / areal))
    shorter = (2.0 * np.pi) ** (4.0 - 2.0 * profile)
    lacking = rows[-1][2] * shorter ** (1.0 / (2.0 * (profile - 1.0)))
    usual = "profile, by the constant often printed, without (2π)^(4 − 2 D_s)"
    rows.append((usual, rows[-1][1] / shorter, lacking, lacking / areal))
    note = (
        "One and the same surface: S = C G^(2(D_s − 1)) ξ^(4 − 2 D_s). A G without its convention is no number to "
        "calculate with. The last row belongs to waves counted in radians per metre; as a G of the first it is wrong."
    )
    return Table("G in each convention", ("convention", "C", "G", "over the areal one"), rows, ("", "", "m", ""), note)


# One pair of teeth over its load: stiffness by every rule, clearance in every reading, and the table of both

Critical = Literal["hardness", "yield_onset"]
Tip = Literal["fixed", "scaled"]
LOAD_POINTS = 121
LOADS = (0.1, 1.0, 2.0, 5.0, 10.0, 25.0, 50.0, 100.0)
NAMES: dict[Critical, tuple[str, str]] = {
    "hardness": (BLUE, "elastic from load = hardness × area"),
    "yield_onset": (ORANGE, "elastic up to first yield"),
}
TIPS: dict[Tip, tuple[str, str]] = {
    "fixed": ("-", "tip radius its own"),
    "scaled": (":", "tip radius follows the area"),
}
MEAN_PLANE = 0.48  # of the rms height: how far mean planes part while the load falls by e (Persson 2007)


def clearances(drive: "Drive", load: Array) -> tuple[Array, Array]:
    """Return the clearance of equation 7 and the closing one at these loads, m; NaN where nothing can be counted."""
    contact = contact_of(drive, interface_of(drive))
    radius = np.sqrt(pressed(load, contact).largest_area / np.pi)
    reference = load_of_largest(drive.reference_torque, mesh_of(drive, contact))
    opened = sum(rough_contact.heights(drive)) / 2.0
    closed = rough_contact.approach(load, reference, contact)
    closing = np.where(np.isinf(closed), np.nan, np.maximum(opened - closed, 0.0))
    return np.asarray(rough_contact.amplitude(radius, contact, drive.density)), closing


def pair_figure(drive: "Drive") -> "Figure":
    """Draw stiffness and clearance over the load."""
    stated = float(drive.pair_load)
    load = np.geomspace(min(1e-2, stated / 10.0), max(150.0, 3.0 * stated), LOAD_POINTS)
    figure, (upper, lower) = panels(2, 6.4, sharex=True, height_ratios=(3, 2))
    _stiffnesses(upper, drive, load)
    _clearances(lower, drive, load)
    for panel in (upper, lower):
        panel.axvline(stated, color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
    lower.set_xlabel("normal load F of the pair, N")
    return figure


def _stiffnesses(panel: Any, drive: "Drive", load: Array) -> None:
    for (critical, (colour, name)), (tip, (dashes, radius)) in product(NAMES.items(), TIPS.items()):
        used = (critical, tip) == (drive.critical_rule, drive.tip_rule)
        ruled = replace(drive, critical_rule=critical, tip_rule=tip)
        values = np.asarray(pressed(load, contact_of(ruled, interface_of(ruled))).stiffness)
        panel.loglog(load, np.where(values > 0.0, values, np.nan), dashes, color=colour, linewidth=2.2 if used else 1.1,
                     label=f"{name}, {radius}{' (used)' if used else ''}")  # fmt: skip
    height = rough_contact.patch_rms(interface_of(drive), drive.patch_length, drive.density)
    panel.loglog(load, load / (MEAN_PLANE * height), "--", color=GREY, linewidth=1.1,
                 label="F / (0.48 rms height of the patch), Persson 2007")  # fmt: skip
    quiet(panel, "", "stiffness K of the pair, N/m")
    panel.legend(loc="upper left", fontsize=7)


def _clearances(panel: Any, drive: "Drive", load: Array) -> None:
    amplitude, closing = clearances(drive, load)
    for rule, multiple, dashes, words in (
        ("amplitude", 1.0, "-", "amplitude of the largest contact"),
        ("interference", 2.0, ":", "twice it: its interference"),
    ):
        panel.semilogx(load, NANO * multiple * amplitude, dashes, color=GREEN, label=f"equation 7, {words}",
                       linewidth=2.2 if drive.clearance_rule == rule else 1.1)  # fmt: skip
    contact = contact_of(drive, interface_of(drive))
    patch = float(rough_contact.amplitude(drive.patch_length / 2.0, contact, drive.density))
    panel.axhline(
        NANO * patch, color=GREY, linestyle="--", linewidth=1.1, label="equation 7, longest wave of the patch"
    )
    panel.semilogx(load, NANO * closing, color=ORANGE, linewidth=1.6, label="what closes: $b_0 - ∫dF/K$")
    panel.set_ylim(bottom=0.0)
    quiet(panel, "", "clearance, nm")
    panel.legend(loc="best", fontsize=7)


def stiffness(record: "DriveRun") -> "Sequence[Block]":
    """The pair over its load, in a figure and in numbers, with what limits the number."""
    drive = record.acting
    stated = float(drive.pair_load)
    load = np.array(sorted({*LOADS, stated}))
    pair, (amplitude, closing) = pressed(load, contact_of(drive, interface_of(drive))), clearances(drive, load)
    columns = np.array([load, pair.stiffness, pair.load_exponent, NANO * amplitude, NANO * closing])
    rows = [tuple(row) for row in columns.T.tolist()]
    blocks: list[Block] = [
        Drawing(
            "Stiffness and clearance over the load", partial(pair_figure, drive),
            "Dashed upright: the load of this run. Where a contact turns elastic and whether its tip radius follows "
            "its area are choices of the model; thick is what this run takes. Grey: an independent law for nearly "
            "all loads, from the rms height alone.",
        ),
        Table(
            "One pair over its load", ("load F", "stiffness K", "m = d ln K/d ln F", "b, amplitude", "b_c, closing"),
            rows, ("N", "N/m", "", "nm", "nm"),
        ),
    ]  # fmt: skip
    return [*_limits(record), *blocks, _single(drive, record)]


def _single(drive: "Drive", record: "DriveRun") -> Table:
    """The largest contact, and the one that just turns elastic: a sphere of its own radius under its own load."""
    contact = contact_of(drive, interface_of(drive))
    rows: list[tuple[str | float, ...]] = []
    for words, name in (("the largest", "largest_area"), ("just elastic", "critical_area")):
        area = float(record.answers[name])
        radius = np.sqrt(area / np.pi)
        interference = 2.0 * float(rough_contact.amplitude(radius, contact, drive.density))
        tip = area / (2.0 * np.pi * interference)
        force = 4.0 / 3.0 * float(contact.modulus) * np.sqrt(tip) * interference**1.5
        stiffness = 2.0 * float(contact.modulus) * np.sqrt(area / (2.0 * np.pi)) * float(contact.tip_factor)
        row = (MICRO * radius, NANO * interference, MICRO * tip, force, stiffness)
        rows.append((words, *(float(value) for value in row)))
    columns = ("contact", "radius, truncated", "interference", "tip radius", "elastic load", "stiffness")
    note = (
        "Truncated: where the undeformed flank is cut off; the real area of an elastic contact is half of it. The "
        "interference is twice the clearance of equation 7 for that radius."
    )
    return Table("Single contacts", columns, rows, ("", "µm", "nm", "µm", "N", "N/m"), note)


def _limits(record: "DriveRun") -> "Sequence[Block]":
    """Warn where the number stands on little."""
    found: list[Block] = []
    share = float(record.answers["resolved_share"])
    if share < 0.3:
        radius = share * float(record.answers["spacing"])
        found.append(
            Words(
                f"Extrapolated below resolution: the stiffness hangs on contacts of {signed(radius * NANO)} nm radius, "
                f"{signed(share)} of the sampling interval of {microns(float(record.answers['spacing']))}; less than "
                "0.3 is a power law carried on to lengths that nobody has measured.",
                "warning",
            )
        )
    if float(record.answers["stiffness"]) == 0.0:
        found.append(Words("All contacts of the pair are plastic at this load: the model gives it no stiffness.",
                           "warning"))  # fmt: skip
    return found


# Torsion over the torque: of roughness alone, of the whole model, and of the drive in the catalogue

TORQUE_POINTS = 101


def torsions(drive: "Drive", printed: Polyline, torque: Array) -> tuple[Array, Array, Array]:
    """Return the torsion, rad, at positive torques: of roughness alone, of this model, and of the catalogue."""
    mesh = mesh_of(drive, contact_of(drive, interface_of(drive)))
    whole, rough = mesh_torsion(torque, drive.reference_torque, mesh)
    beyond = np.maximum(torque - drive.reference_torque, 0.0)
    model = whole + around_of(drive)["series_compliance"] * beyond + wave_torsion(drive, torque)
    return np.asarray(rough), np.asarray(model), np.asarray(printed.torsion(torque))


def torsion(record: "DriveRun") -> "Sequence[Block]":
    """The figure, the table at the torques of the catalogue, and what follows; nothing without one of the two."""
    drive = record.acting
    printed = polyline_of(drive.catalogue_size, ratio_of(drive))
    if printed is None or np.isnan(record.answers["rough_torsion"]):
        return []
    stated = abs(float(drive.torque))
    first, second = printed.first_torque, printed.second_torque
    torque = np.array(sorted({first, second, 2.0 * second, *([stated] if stated else [])}))
    rough, model, known = torsions(drive, printed, torque)
    columns = np.array([torque, MICRO * rough, MICRO * model, MICRO * known, 100.0 * (rough / known)])
    rows = [tuple(row) for row in columns.T.tolist()]
    name = f"size {drive.catalogue_size}, ratio {ratio_of(drive):g}"
    return [
        Drawing(
            "Torsion over the torque", partial(torsion_figure, drive, printed),
            f"Catalogue: {name}. It includes cup, wave generator and bearing; knees at T_1 = {first:g} N m and T_2 = "
            f"{second:g} N m.",
        ),
        Table(
            "Torsion at the torques of the catalogue",
            ("torque", "roughness alone", "this model", f"catalogue, {name}", "share of roughness"), rows,
            ("N*m", "urad", "urad", "urad", "%"),
        ),
        _parts(drive, torque, known),
        Words(_conclusion(100.0 * float(np.max(rough / known)), float(around_of(drive)["series_compliance"]))),
    ]  # fmt: skip


FITTED = (
    " The stated share of the wave generator is not calculated: 752 urad of size 20 are fitted, with drive_compliance, "
    "to two numbers of the catalogue, K_1 and K_2. Its balls alone, calculated, miss that by a factor of 11 (71 urad, "
    "23 balls of 4 mm); what else gives way there is not known."
)


def _parts(drive: "Drive", torque: Array, known: Array) -> Table:
    """Whose torsion it is: each part's share of the catalogue's, at each torque."""
    mesh = mesh_of(drive, contact_of(drive, interface_of(drive)))
    whole, rough = mesh_torsion(torque, drive.reference_torque, mesh)
    beyond = np.maximum(torque - drive.reference_torque, 0.0)
    around = around_of(drive)
    cup = drive.cup_length / (around["shear_modulus"] * around["cup_moment"]) * beyond
    rest = drive.drive_compliance / drive.modulus_factor * beyond
    wave = wave_torsion(drive, torque)
    balls = wave * over(ball_torsion(drive), wave_scale(drive) * np.power(drive.wave_torque, 2.0 / 3.0))
    parts = np.array([rough, whole - rough, cup, balls, wave - balls, rest])
    shares = 100.0 * np.concatenate([parts, parts.sum(axis=0, keepdims=True)]) / known
    names = ("rough contacts", "teeth and line contact", "tube of the cup", "balls of the wave generator",
             "wave generator, stated", "drive_compliance", "all together")  # fmt: skip
    rows = [(name, *each) for name, each in zip(names, shares.tolist(), strict=True)]
    stated = float(drive.wave_torsion_stated)
    return Table(
        "Whose torsion it is, in parts of the catalogue's", ("part", *(f"{each:.4g} N m" for each in torque)), rows,
        ("", *["%"] * len(torque)),
        f"At 100 % all together meet the catalogue. A part that is 0 is taken as rigid here.{FITTED * bool(stated)}",
    )  # fmt: skip


def _conclusion(most: float, compliance: float) -> str:
    text = (
        f"Rough contacts alone explain at most {signed(most, '.2g')} % of the torsion in the catalogue. They are not "
        "the weakest link of the drive; bending of the teeth, cup, wave generator and bearing are."
        if most < 10.0
        else f"Rough contacts alone would explain {signed(most, '.3g')} % of the catalogue's torsion; look at D, G and "
        "the engaged pairs again, for other parts of the drive are known to carry most of it."
    )
    if compliance == 0.0:
        text += (
            " In this run everything around the mesh is rigid: state drive_compliance, or cup_length, to compare whole "
            "drives."
        )
    return text


def torsion_figure(drive: "Drive", printed: Polyline) -> "Figure":
    """Draw the torsions, and below what share of the catalogue's each explains."""
    last = max(2.0 * printed.second_torque, 1.1 * abs(float(drive.torque)))
    torque = np.linspace(last / TORQUE_POINTS, last, TORQUE_POINTS)
    rough, model, known = torsions(drive, printed, torque)
    figure, (upper, lower) = panels(2, 5.6, sharex=True, height_ratios=(3, 2))
    upper.plot(torque, MICRO * known, "-", color=INK, linewidth=1.6, label="catalogue")
    for words, values, colour, style in (("this model", model, BLUE, "-"), ("roughness alone", rough, ORANGE, "--")):
        upper.plot(torque, MICRO * values, style, color=colour, linewidth=1.6, label=words)
        lower.semilogy(torque, 100.0 * values / known, style, color=colour, linewidth=1.6)
    for knee in (printed.first_torque, printed.second_torque):
        upper.axvline(knee, color=GREY, linewidth=0.8, linestyle=":")
    lower.axhline(100.0, color=INK, linewidth=1.0)
    upper.set_xlim(0.0, last)
    upper.set_ylim(bottom=0.0)
    quiet(upper, "", "torsion θ, µrad")
    quiet(lower, "torque T, N m", "share of the\ncatalogue's torsion, %")
    upper.legend(loc="upper left", fontsize=8)
    return figure
