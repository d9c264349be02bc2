"""A measured flank, read once from a file: its surface, what was cleaned away, and what each direction says.

In the inputs file: ``surface = { file = "flank.csv", spacing = "0.4 um", height_unit = "um" }``. Options of the file:

- ``spacing``, or ``spacing_x`` and ``spacing_y``: from point to point of a matrix, where the file is silent.
- ``height_unit``: "um", or the length of one count, "2.918e-8 m"; never guessed.
- ``skip_lines``: lines at the top that are no data although they look like numbers.
- ``columns``: names of columns that have none, ["x [um]", "y [um]", "z [um]"].

Of cleaning:

- ``rectangle``: ["0.2 mm", "0.1 mm"] along x and y, from the middle or from ``corner``, ["10 um", "20 um"].
- ``form``: "second_order", "plane" or "none" is removed; then each line of a patch loses its straight line.
- ``spikes``: "remove" or "keep" what lies 4 robust standard deviations from the median of 11 neighbours.

Of the fit:

- ``filter_width``: of the instrument, laterally; lags below 3 of it are left out ("0 um": whatever the file says).
- ``shortest_lag``, ``longest_lag``: limits; without them one point (or 3 filter widths) and a tenth of a line.
- ``method``: "pooled", one fit to the mean over all lines, or "per_line", the mean of the fits.
- ``noise_aware``: whether instrument noise is fitted beside the power law.
- ``fit``: over the "self_affine" range, or over "all" lags within the limits.

Of the choice:

- ``direction``: "auto", "x", "y", or "both" pooled.
- ``sliding``: "x" or "y", along the height of the tooth; used where x and y differ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank_choice import choice_of
from harmonic_fractal.flank_options import FILTERS, Options, options_of
from harmonic_fractal.flank_surface import prepared
from harmonic_fractal.surface import Direction, Surface
from harmonic_fractal.surface_files import Reading, read_surface


@dataclass(frozen=True, eq=False, kw_only=True)
class Flank:
    """A surface after cleaning, with the estimates along x and y and the direction whose D and G are used.

    ``chosen`` is None where no direction has a self-affine range: then ``reason`` says why and the contact is that of
    the stated D and G. ``both`` are the lines along x and along y pooled. ``warnings`` are sentences for the sheet.
    ``raw`` is the surface as it was read. ``missing`` and ``spiked`` are shares of the points of the rectangle, the
    ``sq`` their root mean square heights, m: as read, less the plane, less the second-order surface (spikes included).
    """

    raw: Surface
    surface: Surface
    estimates: tuple[Estimate, ...]
    chosen: Direction | None
    reason: str
    warnings: tuple[str, ...]
    missing: float = 0.0
    spiked: float = 0.0
    sq_raw: float = float("nan")
    sq_plane: float = float("nan")
    sq_second_order: float = float("nan")

    def __post_init__(self) -> None:
        self.raw.heights.setflags(write=False)
        self.surface.heights.setflags(write=False)

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self.__post_init__()  # arrays come out of another process writeable

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


def read_flank(  # the signature is the list of options of the inputs file
    path: Path,
    *,
    spacing: str = "",
    spacing_x: str = "",
    spacing_y: str = "",
    height_unit: str = "",
    skip_lines: int = 0,
    columns: Sequence[str] = (),
    rectangle: Sequence[str] = (),
    corner: Sequence[str] = (),
    form: str = "second_order",
    spikes: str = "remove",
    filter_width: str = "",
    shortest_lag: str = "",
    longest_lag: str = "",
    method: str = "pooled",
    noise_aware: bool = False,
    fit: str = "self_affine",
    direction: str = "auto",
    sliding: str = "x",
) -> Flank:
    """Read a measured flank, clean it, and look for its self-affine range; the options stand at the top of this file.

    Raises ValueError with one sentence.
    """
    options = options_of({name: value for name, value in locals().items() if name != "path"})
    reading = read_surface(path, options.layout)
    clean = prepared(reading.surface, options)
    options, filtered = _filtered(options, reading)
    choice = choice_of(clean.surface, options.estimation, options)
    noise = next((found.warnings for found in choice.estimates if found.direction == choice.chosen), ())
    return Flank(
        raw=reading.surface, surface=clean.surface, estimates=choice.estimates, chosen=choice.chosen,
        reason=choice.reason, warnings=(*reading.remarks, *filtered, *clean.warnings, *choice.warnings, *noise),
        missing=clean.missing, spiked=clean.spiked, sq_raw=clean.sq_raw, sq_plane=clean.sq_plane,
        sq_second_order=clean.sq_second_order,
    )  # fmt: skip


def _filtered(options: Options, reading: Reading) -> tuple[Options, tuple[str, ...]]:
    """Leave out lags below three widths of the instrument's filter, unless the shortest lag is stated."""
    is_stated = np.isfinite(options.filter_width)
    width = options.filter_width if is_stated else reading.filter_width
    if not width > 0.0 or np.isfinite(options.estimation.shortest_lag):
        return options, ()
    shortest = FILTERS * width
    if shortest >= options.estimation.longest_lag:
        raise ValueError(f"longest_lag lies below 3 filter widths, {shortest * 1e6:.4g} um, where lags are smoothed")
    said = (
        f"the file states a lateral filter of {width * 1e6:.4g} um: lags below {shortest * 1e6:.4g} um are left out; "
        'filter_width = "0 um" takes them in',
    )
    estimation = replace(options.estimation, shortest_lag=shortest)
    return replace(options, estimation=estimation), () if is_stated else said
