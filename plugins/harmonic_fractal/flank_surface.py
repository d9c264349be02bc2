"""A surface made ready for its structure function: cut, form removed, spikes out, and what is to be said about it."""

from dataclasses import dataclass

import numpy as np

from harmonic_fractal.cleaning import cut, quantisation, root_mean_square, spikes_of, without_form
from harmonic_fractal.estimate import FEWEST_POINTS
from harmonic_fractal.flank_options import Options
from harmonic_fractal.surface import Surface

FEW_MISSING, MANY_MISSING = 0.05, 0.20  # shares of the points: above the one a warning, above the other an error
FEW_SPIKES = 0.02


@dataclass(frozen=True, eq=False, kw_only=True)
class Prepared:
    """A surface after cleaning, the shares that were missing and spiked, S_q in m before and after form removal."""

    surface: Surface
    missing: float
    spiked: float
    sq_raw: float
    sq_plane: float
    sq_second_order: float
    warnings: tuple[str, ...]


def prepared(raw: Surface, options: Options) -> Prepared:
    """Cut the rectangle, count the holes, remove the form, take out spikes. Raises ValueError with one sentence."""
    surface = cut(raw, options.rectangle, options.corner) if options.rectangle else raw
    _demand_points(surface)
    missing = float(np.mean(~np.isfinite(surface.heights)))
    if missing > MANY_MISSING:
        raise ValueError(
            f"{missing:.1%} of the points are missing, more than {MANY_MISSING:.0%}: cut another rectangle"
        )
    plane, second = without_form(surface.heights, "plane"), without_form(surface.heights, "second_order")
    heights = {"none": surface.heights, "plane": plane, "second_order": second}[options.form]
    step = quantisation(surface.heights)
    spikes = spikes_of(heights, step)
    spiked = float(spikes.sum() / np.isfinite(heights).sum())
    if options.spikes == "remove":
        heights = np.where(spikes, np.nan, heights)
    clean = Surface(np.array(heights), surface.spacing_x, surface.spacing_y, surface.name)
    return Prepared(
        surface=clean, missing=missing, spiked=spiked, sq_raw=root_mean_square(surface.heights),
        sq_plane=root_mean_square(plane), sq_second_order=root_mean_square(second),
        warnings=(*_shares(missing, spiked, options), *_steps(clean, step)),
    )  # fmt: skip


def _demand_points(surface: Surface) -> None:
    rows, points = surface.heights.shape
    if max(rows, points) < FEWEST_POINTS:
        raise ValueError(f"{rows} x {points} points (rows x points) are too few: a line needs {FEWEST_POINTS} or more")


def _shares(missing: float, spiked: float, options: Options) -> list[str]:
    said = []
    if missing > FEW_MISSING:
        said.append(f"{missing:.1%} of the points are missing, more than {FEW_MISSING:.0%}")
    if spiked > FEW_SPIKES:
        done = "taken out" if options.spikes == "remove" else "kept"
        said.append(f"{spiked:.1%} of the points are spikes, more than {FEW_SPIKES:.0%}; they were {done}")
    return said


def _steps(surface: Surface, step: float) -> list[str]:
    """Say where the numbers of the instrument are coarser than the roughness from point to point."""
    said = []
    for axis in ("x",) if surface.is_profile else ("x", "y"):
        change = np.diff(surface.heights, axis=1 if axis == "x" else 0)
        known = change[np.isfinite(change)]
        least = float(np.sqrt(np.mean(np.square(known)))) if known.size else float("inf")
        if step > least:
            said.append(
                f"the heights come in steps of {step * 1e9:.3g} nm, more than they change from point to point along "
                f"{axis}, {least * 1e9:.3g} nm: short lags show the steps"
            )
    return said
