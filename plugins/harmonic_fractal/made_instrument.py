"""What an instrument makes of a surface: lateral filter, noise, steps of its scale, spikes and holes."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

from harmonic_fractal.generators import Array

ISO_16610 = "ISO 16610-21"
DEVIATION = float(np.sqrt(np.log(2.0) / 2.0) / np.pi)  # of the Gaussian weight over the wave that is halved, 0.1874
REACH = 4.0  # standard deviations to which the weight is taken


@dataclass(frozen=True, kw_only=True)
class Instrument:
    """A profilometer: everything 0 is a perfect one.

    ``cutoff`` is the wave length, m, of which half the amplitude passes the Gaussian lateral filter; ``noise`` the
    standard deviation of the height of each point, m; ``step`` the smallest difference of height it tells, m.
    ``spikes`` and ``holes`` are shares of the points, each alone; a spike stands ``spike_height``, m, up or down.
    """

    cutoff: float = 0.0
    noise: float = 0.0
    step: float = 0.0
    spikes: float = 0.0
    spike_height: float = 0.0
    holes: float = 0.0

    def margin(self, spacing: float) -> int:
        """Return how many points beyond its edge the filter needs on each side."""
        return int(np.ceil(REACH * DEVIATION * self.cutoff / spacing))


def as_measured(
    heights: Array, spacing: float, instrument: Instrument, rng: np.random.Generator, *, across: bool = True
) -> Array:
    """Return heights (rows, points), m, as the instrument gives them, NaN in its holes.

    The filter takes ``instrument.margin(spacing)`` points away on each side; without ``across`` it acts along the rows
    only, and takes nothing away across them. Order: filter, noise, steps, spikes, holes.
    """
    seen = _filtered(heights, spacing, instrument, across=across)
    seen = seen + instrument.noise * rng.standard_normal(seen.shape)
    if instrument.step > 0.0:
        seen = np.round(seen / instrument.step) * instrument.step
    flat = seen.ravel()
    order = rng.permutation(flat.size)
    spikes, holes = (round(share * flat.size) for share in (instrument.spikes, instrument.holes))
    flat[order[:spikes]] += instrument.spike_height * rng.choice([-1.0, 1.0], spikes)
    flat[order[flat.size - holes :]] = np.nan
    return np.asarray(flat.reshape(seen.shape), dtype=np.float64)


def _filtered(heights: Array, spacing: float, instrument: Instrument, *, across: bool) -> Array:
    """Weigh with a Gaussian along the rows, and across them where asked, and cut the margin off."""
    margin = instrument.margin(spacing)
    if not margin:
        return heights.copy()
    deviation = DEVIATION * instrument.cutoff / spacing
    seen = gaussian_filter(heights, (deviation if across else 0.0, deviation), truncate=REACH)
    rows = slice(margin, -margin) if across else slice(None)
    return np.asarray(seen[rows, margin:-margin], dtype=np.float64)
