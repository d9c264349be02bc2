"""A measured or made surface, its lines along either direction, and how its heights become those of roughness."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.levelling import Levelling
from truing import Array

Direction = Literal["x", "y", "both"]
EQUAL = 0.01  # relative difference up to which two spacings are the same


@dataclass(frozen=True, eq=False)
class Lines:
    """Parallel lines of one direction: heights (lines, points) in m, NaN where not measured, and their spacing in m.

    ``levelling`` says what was taken from them, where that is known: then its bias can be taken out.
    """

    heights: NDArray[np.float64]
    spacing: float
    levelling: Levelling | None = None


@dataclass(frozen=True, eq=False)
class Surface:
    """Heights (rows, points) in m, NaN where not measured; x runs along a row, y across the rows.

    A profile is a surface of one row, and its ``spacing_y`` is NaN.
    """

    heights: NDArray[np.float64]
    spacing_x: float
    spacing_y: float
    name: str

    @property
    def is_profile(self) -> bool:
        """Whether there is one line only."""
        return bool(self.heights.shape[0] == 1)

    @property
    def is_square(self) -> bool:
        """Whether the points are as far apart along y as along x, so that lines of both directions can be pooled."""
        return not self.is_profile and abs(self.spacing_x / self.spacing_y - 1.0) <= EQUAL

    def lines(self, direction: Direction) -> Lines:
        """Return the lines along x, along y, or both one after the other (the shorter ones filled up with NaN)."""
        if direction == "x":
            return Lines(self.heights, self.spacing_x)
        if direction == "y":
            return Lines(self.heights.T, self.spacing_y)
        return pooled(self.lines("x"), self.lines("y"))


def pooled(first: Lines, second: Lines) -> Lines:
    """Put the lines of two directions into one set; their spacings must agree within 1 %."""
    if not abs(first.spacing / second.spacing - 1.0) <= EQUAL:
        raise ValueError(
            f"lines {first.spacing * 1e6:.6g} um and {second.spacing * 1e6:.6g} um apart from point to point "
            "cannot be pooled; use one direction"
        )
    points = max(first.heights.shape[1], second.heights.shape[1])
    filled = [
        np.pad(lines.heights, ((0, 0), (0, points - lines.heights.shape[1])), constant_values=np.nan)
        for lines in (first, second)
    ]
    taken = first.levelling, second.levelling
    both = None
    if taken[0] is not None and taken[1] is not None:
        both = replace(taken[0], shapes=(*taken[0].shapes, *taken[1].shapes))
    return Lines(np.concatenate(filled), first.spacing, both)


# From the heights of a file to those of roughness: rectangle, form, spikes, the straight line of each line
#
# Every function leaves its arguments alone and passes holes (NaN) through.

Form = Literal["none", "plane", "second_order"]
WINDOW = 11  # points of the spike filter
FEWEST = 6  # measured points of a window that can tell: as many as at the end of a line
LIMIT = 4.0  # robust standard deviations from the median of the window
ROBUST = 1.482602218505602  # standard deviation of a normal spread over its median absolute deviation
AT_ONCE = 1 << 17  # points whose windows are sorted together


def cut(surface: Surface, size: tuple[float, ...], corner: tuple[float, ...] | None = None) -> Surface:
    """Return the rectangle of this length along x and y, m: in the middle, or from a corner (distances from the first).

    A profile has one length. Raises ValueError where the rectangle leaves the surface.
    """
    spacings = (surface.spacing_x,) if surface.is_profile else (surface.spacing_x, surface.spacing_y)
    counts = surface.heights.shape[::-1]
    if len(size) != len(spacings) or (corner is not None and len(corner) != len(spacings)):
        wanted = "one length: the file holds a profile" if surface.is_profile else "two lengths, along x and along y"
        raise ValueError(f"rectangle and corner need {wanted}")
    ranges = []
    for place, (spacing, count) in enumerate(zip(spacings, counts, strict=False)):
        points = math.floor(size[place] / spacing + 1e-6) + 1
        points = count if points == count + 1 else points  # "200 um" of 500 points 0.4 um apart means all of them
        first = (count - points) // 2 if corner is None else math.ceil(corner[place] / spacing - 1e-6)
        if points > count or first < 0 or first + points > count:
            raise ValueError(
                f"the rectangle leaves the surface along {'xy'[place]}: {size[place] * 1e6:.6g} um"
                f"{'' if corner is None else f' from {corner[place] * 1e6:.6g} um'}, and there are "
                f"{(count - 1) * spacing * 1e6:.6g} um"
            )
        ranges.append(slice(first, first + points))
    columns = ranges[0]
    rows = ranges[1] if len(ranges) > 1 else slice(None)
    return Surface(surface.heights[rows, columns].copy(), surface.spacing_x, surface.spacing_y, surface.name)


def without_form(heights: Array, form: Form) -> Array:
    """Return the heights (rows, points) less their least-squares plane or full second-order surface (with x y).

    Of one row the straight line or the parabola; "none" leaves them as they are. Holes take no part.
    """
    if form == "none":
        return heights.copy()
    rows, points = heights.shape
    x, y = _scaled(points)[None, :], _scaled(rows)[:, None]
    terms = [np.ones_like(x), x, y] if form == "plane" else [np.ones_like(x), x, y, x * x, x * y, y * y]
    basis = [np.broadcast_to(term, heights.shape) for term in (terms if rows > 1 else terms[:2] + terms[3:4])]
    known = np.isfinite(heights)
    design = np.stack([term[known] for term in basis])
    gram = design @ design.T
    rest = heights - np.mean(heights[known])
    for _ in range(2):  # the second time removes what rounding left of a steep form
        factors = np.linalg.lstsq(gram, design @ rest[known], rcond=None)[0]
        rest = rest - sum(factor * term for factor, term in zip(factors, basis, strict=True))
    return np.asarray(rest, dtype=np.float64)


def without_line(heights: Array) -> Array:
    """Return the lines (lines, points) each less its own least-squares straight line; holes take no part.

    A line of fewer than two measured points has no slope: only its mean goes.
    """
    known = np.isfinite(heights)
    number = np.maximum(known.sum(axis=1, keepdims=True), 1)
    filled = np.where(known, heights, 0.0)
    filled = np.where(known, filled - filled.sum(axis=1, keepdims=True) / number, 0.0)
    x = np.broadcast_to(_scaled(heights.shape[1]), heights.shape)
    centred = np.where(known, x - np.where(known, x, 0.0).sum(axis=1, keepdims=True) / number, 0.0)
    spread = np.square(centred).sum(axis=1, keepdims=True)
    slope = (centred * filled).sum(axis=1, keepdims=True) / np.where(spread > 0.0, spread, 1.0)
    return np.where(known, filled - slope * centred, np.nan)


def spikes_of(heights: Array, step: float = 0.0) -> NDArray[np.bool_]:
    """Return which points (lines, points) are spikes: Hampel's filter along the lines.

    A spike is further from the median of its 11 neighbours (itself among them, fewer at the ends) than 4 robust
    standard deviations, 1.4826 times their median absolute deviation, and than 4 steps of the instrument's numbers. The
    median takes measured points only, and fewer than 6 of them judge nothing.

    Source: Hampel, Journal of the American Statistical Association 69 (1974), p. 383.
    """
    found = np.zeros(heights.shape, dtype=np.bool_)
    rows = max(1, AT_ONCE // heights.shape[1])
    for start in range(0, heights.shape[0], rows):
        found[start : start + rows] = _spikes(heights[start : start + rows], step)
    return found


def _spikes(heights: Array, step: float) -> NDArray[np.bool_]:
    half = WINDOW // 2
    padded = np.pad(heights, ((0, 0), (half, half)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, WINDOW, axis=1)
    middle = _median(windows)
    deviation = _median(np.abs(windows - middle[..., None]))
    enough = np.isfinite(windows).sum(axis=-1) >= FEWEST
    with np.errstate(invalid="ignore"):
        return np.asarray(enough & (np.abs(heights - middle) > LIMIT * np.maximum(ROBUST * deviation, step)))


def _median(windows: Array) -> Array:
    """Return the medians along the last axis of what is no hole; NaN where there is nothing."""
    ranked = np.sort(windows, axis=-1)  # holes come last
    number = np.isfinite(ranked).sum(axis=-1, keepdims=True)
    low = np.take_along_axis(ranked, np.maximum(number - 1, 0) // 2, axis=-1)
    high = np.take_along_axis(ranked, number // 2, axis=-1)
    return np.asarray(0.5 * (low + high)[..., 0], dtype=np.float64)


def quantisation(heights: Array) -> float:
    """Return the step of the instrument's numbers, m: the least difference of two heights as they were read.

    Of numbers with many digits that is next to nothing, as it should be.
    """
    levels = np.unique(heights[np.isfinite(heights)])
    if len(levels) < 2:
        return 0.0
    steps = np.diff(levels)
    real = steps[steps > 1e-9 * (levels[-1] - levels[0])]  # below that, rounding of equal numbers
    return float(real.min())


def root_mean_square(heights: Array) -> float:
    """Return S_q (R_q of a profile) about the mean, m; holes take no part."""
    return float(np.nanstd(heights))


def _scaled(count: int) -> Array:
    return np.linspace(-1.0, 1.0, count) if count > 1 else np.zeros(1)
