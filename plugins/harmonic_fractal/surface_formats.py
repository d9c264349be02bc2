"""Profilometer formats (al3d, MetroPro, sdf, x3p, sur, plux, vk, gwy) through the optional library SurfaceTopography.

Source: Roettger et al., Surface Topography: Metrology and Properties 10 (2022) 035032.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.surface import EQUAL
from harmonic_fractal.surface_text import metres_per_unit

NAN = float("nan")
GUESSING = {"asc", "xyz"}  # the library's readers of text, which take numbers from any file of letters
NEEDS = (
    "this is no text, and profilometer formats are read by SurfaceTopography, which is not installed: "
    "pip install 'truing[surfaces]', or export the heights as text, which needs nothing more"
)


def read_format(
    path: Path, spacing: tuple[float, float], height_unit: str
) -> tuple[NDArray[np.float64], tuple[float, float], float]:
    """Read heights (rows, points) in m, both spacings in m, and the instrument's lateral filter in m (NaN: not stated).

    What the file states of itself counts; ``spacing`` and ``height_unit`` fill in where it is silent, and are refused
    where they say something else. The first channel of heights is read. Raises ValueError with one sentence.
    """
    topography, is_sized = _topography(path)
    heights = np.atleast_2d(np.asarray(np.ma.filled(topography.heights().T, np.nan), dtype=np.float64))
    metres = _unit(topography, height_unit)
    lateral = metres_per_unit(topography.unit, "the unit of the file") if topography.unit and is_sized else NAN
    sizes = [*topography.physical_sizes, NAN][:2]
    points = [*topography.nb_grid_pts, 1][:2]
    own = [size / number * lateral for size, number in zip(sizes, points, strict=True)]
    dx, dy = (_spacing(axis, mine, stated) for axis, mine, stated in zip("xy", own, spacing, strict=True))
    if len(heights) == 1:
        dy = NAN
    elif not np.isfinite(dy):
        raise ValueError('the file does not state the spacing of its rows: write spacing_y = "0.4 um"')
    return heights * metres, (dx, dy), _filter(topography)


def _topography(path: Path) -> tuple[Any, bool]:
    """Return the surface as the library reads it, and whether the file states its size."""
    try:
        from SurfaceTopography import open_topography
    except ImportError:
        raise ValueError(NEEDS) from None
    try:
        reader = open_topography(str(path))
        if reader.format() in GUESSING:
            raise ValueError("it is none of its formats")
        channel = reader.default_channel
        if not channel.is_height_channel:
            raise ValueError("its first channel holds no heights")
        is_sized = bool(channel.physical_sizes) and None not in channel.physical_sizes
        topography = reader.topography() if is_sized else reader.topography(physical_sizes=channel.nb_grid_pts)
    except Exception as error:  # whatever the library says of a file it cannot read
        words = str(error).split("\n")[0][:200] or type(error).__name__
        raise ValueError(f"SurfaceTopography cannot read this file: {words}") from error
    if not getattr(topography, "is_uniform", False):
        raise ValueError("the spacing of the points is unequal; resample to equal spacing")
    return topography, is_sized


def _unit(topography: Any, stated: str) -> float:
    own = topography.unit
    if not own and not stated:
        raise ValueError('the file does not state the unit of its heights: write height_unit = "um"')
    if not own:
        return metres_per_unit(stated)
    metres = metres_per_unit(own, "the unit of the file")
    if stated and abs(metres_per_unit(stated) / metres - 1.0) > 1e-6:
        raise ValueError(
            f"height_unit = {stated!r}, and the library gives the heights of this file in {own}: leave it out"
        )
    return metres


def _spacing(axis: str, own: float, stated: float) -> float:
    if np.isfinite(own) and abs(stated / own - 1.0) > EQUAL:
        raise ValueError(f"spacing_{axis} is stated as {stated * 1e6:.6g} um, and the file says {own * 1e6:.6g} um")
    if axis == "x" and not (np.isfinite(own) or np.isfinite(stated)):
        raise ValueError('the file does not state the spacing of its points: write spacing = "0.4 um"')
    return float(own if np.isfinite(own) else stated)


def _filter(topography: Any) -> float:
    """Return the lateral filter where the format states one: Alicona's ``DepthResFilterVal``, in m."""
    text = topography.info.get("raw_metadata", {}).get("DepthResFilterVal", "")
    try:
        width = float(text)
    except (TypeError, ValueError):
        return NAN
    return width if width > 0.0 else NAN
