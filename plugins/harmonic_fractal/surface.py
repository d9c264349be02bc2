"""A measured or made surface: heights on a rectangular grid, and its lines along either direction."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Direction = Literal["x", "y"]


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

    def lines(self, direction: Direction) -> Lines:
        """Return the lines along x, or along y."""
        if direction == "x":
            return Lines(self.heights, self.spacing_x)
        return Lines(self.heights.T, self.spacing_y)
