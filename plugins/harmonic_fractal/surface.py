"""A measured or made surface: heights on a rectangular grid, and its lines along either direction."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Direction = Literal["x", "y", "both"]
EQUAL = 0.01  # relative difference up to which two spacings are the same


@dataclass(frozen=True, eq=False)
class Lines:
    """Parallel lines of one direction: heights (lines, points) in m, NaN where not measured, and their spacing in m."""

    heights: NDArray[np.float64]
    spacing: float


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
    return Lines(np.concatenate(filled), first.spacing)
