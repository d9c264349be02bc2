"""A measured flank, read once from a file: its surface, what was cleaned away, and what each direction says."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.estimate import Estimate
from harmonic_fractal.surface import Direction, Surface


@dataclass(frozen=True, eq=False, kw_only=True)
class Flank:
    """A surface after cleaning, with the estimates along x and y and the direction whose D and G are used.

    ``chosen`` is None where no direction has a self-affine range: then ``reason`` says why and the contact is that of
    the stated D and G. ``warnings`` are sentences for the sheet. ``raw`` is the surface as it was read.
    """

    raw: Surface
    surface: Surface
    estimates: tuple[Estimate, ...]
    chosen: Direction | None
    reason: str
    warnings: tuple[str, ...]

    def __post_init__(self) -> None:
        self.surface.heights.setflags(write=False)

    @property
    def used(self) -> Estimate | None:
        """The estimate whose D and G are used, or None."""
        return next((item for item in self.estimates if item.direction == self.chosen), None)

    @property
    def height(self) -> float:
        """The height from the lowest to the highest point after cleaning, S_z, in m."""
        return float(np.nanmax(self.surface.heights) - np.nanmin(self.surface.heights))

    @property
    def resampled(self) -> NDArray[np.float64]:
        """Pairs of D and ln G (B, 2) of the chosen direction; empty without one."""
        return np.empty((0, 2)) if self.used is None else self.used.resampled


def read_flank(path: Path, *, spacing: str = "", height_unit: str = "") -> Flank:
    """Read a profilometer file."""
    raise ValueError("surfaces cannot be read yet")
