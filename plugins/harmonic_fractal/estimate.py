"""From the lines of a surface to fractal dimension and roughness: settings, and what was found."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.surface import Direction


@dataclass(frozen=True, kw_only=True)
class Estimation:
    """How D and G are read from a structure function; lags in m, NaN where the data decide."""

    method: Literal["pooled", "per_line"] = "pooled"
    noise_aware: bool = False
    shortest_lag: float = float("nan")
    longest_lag: float = float("nan")
    count: int = 16
    resamples: int = 400
    block: int = 10


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """What the lines of one direction say: structure function, local slopes, fit, verdict, and pairs of (D, ln G).

    ``dimension`` is that of the profile, ``roughness`` G in m in the areal convention (many ridge directions).
    ``lags`` (k,) in m and ``values`` (k,) in m^2 are those of the fit; ``local_lags`` and ``local_dimensions`` (j,) the
    slopes between neighbouring lags. ``range`` is the longest self-affine range, m, NaN where there is none; then
    ``reason`` says why and the fit is for comparison only. ``resampled`` (B, 2) holds D of the surface and ln G of
    bootstrap samples of blocks of lines, as pairs because their errors go together.
    """

    direction: Direction
    lags: NDArray[np.float64]
    values: NDArray[np.float64]
    local_lags: NDArray[np.float64]
    local_dimensions: NDArray[np.float64]
    dimension: float
    roughness: float
    r_squared: float
    line_scatter: float
    noise: float
    range: tuple[float, float]
    reason: str
    resampled: NDArray[np.float64]
    spacing: float

    @property
    def is_accepted(self) -> bool:
        """Whether there is a self-affine range, so that D and G mean something."""
        return not self.reason
