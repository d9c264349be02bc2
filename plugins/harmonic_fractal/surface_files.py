"""Surfaces from files: texts by our own reader, profilometer formats through an optional library."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harmonic_fractal.surface import EQUAL, Surface
from harmonic_fractal.surface_formats import read_format
from harmonic_fractal.surface_points import Column, columns_of, grid, profile
from harmonic_fractal.surface_text import TextTable, decoded, is_text, length, metres_per_unit, read_table

NAN = float("nan")
FORMATS_IN_TEXT = {".sdf"}  # those of the library that may be written in letters and digits
ASK_UNIT = (
    'the unit of the heights is not stated: write height_unit = "um", or the length of one count where the file counts '
    'in steps or radians, as in height_unit = "2.918e-8 m"'
)


@dataclass(frozen=True, kw_only=True)
class Layout:
    """What the user states of a file: lengths in m (NaN: the file says), unit of the heights as written."""

    spacing_x: float = NAN
    spacing_y: float = NAN
    height_unit: str = ""
    skip_lines: int = 0
    columns: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Reading:
    """A surface as it stands in its file, the lateral filter of the instrument in m (NaN: not stated), and remarks."""

    surface: Surface
    filter_width: float = NAN
    remarks: tuple[str, ...] = ()


def read_surface(path: Path, layout: Layout) -> Reading:
    """Read heights in m from a text or from a profilometer's file; NaN where nothing was measured.

    Texts are a matrix (one row of numbers per row of the surface), or named columns: ``x [um];z [um]`` for a profile,
    ``x, y, z`` for points on a full grid, ``valid`` 0 for holes. Header lines ``# spacing_x = 0.4 um`` and
    ``# height_unit = um`` make a file speak for itself. Raises ValueError with one sentence.
    """
    content = path.read_bytes()
    if not content.strip():
        raise ValueError("the file is empty")
    if not is_text(content) or path.suffix.lower() in FORMATS_IN_TEXT:
        return _checked(_from_format(path, layout))
    table = read_table(decoded(content), skip_lines=layout.skip_lines)
    columns = columns_of(table, layout.columns)
    known = _stated(table, layout)
    surface = _points(table, columns, known, path.name) if columns else _matrix(table, known, path.name)
    text = table.stated.get("filter_width", "")
    width = length(text, "filter_width in the file") if text else NAN
    return _checked(Reading(surface=surface, filter_width=width, remarks=_contradictions(table, layout)))


def _from_format(path: Path, layout: Layout) -> Reading:
    for name, is_given in (("skip_lines", layout.skip_lines > 0), ("columns", bool(layout.columns))):
        if is_given:
            raise ValueError(f"{name} belongs to text files, and {path.name} is none")
    spacing = (layout.spacing_x, layout.spacing_y)
    heights, (dx, dy), width = read_format(path, spacing, layout.height_unit)
    return Reading(surface=Surface(heights, dx, dy, path.name), filter_width=width)


def _stated(table: TextTable, layout: Layout) -> Layout:
    """Fill in from the header of the file what the user leaves open."""
    said = table.stated
    both = said.get("spacing", "")
    along = {name: said.get(name, both) for name in ("spacing_x", "spacing_y")}
    found = {name: length(text, f"{name} in the file") for name, text in along.items() if text}
    return replace(
        layout,
        spacing_x=layout.spacing_x if np.isfinite(layout.spacing_x) else found.get("spacing_x", NAN),
        spacing_y=layout.spacing_y if np.isfinite(layout.spacing_y) else found.get("spacing_y", NAN),
        height_unit=layout.height_unit or said.get("height_unit", ""),
    )


def _contradictions(table: TextTable, layout: Layout) -> tuple[str, ...]:
    """Say where the options override what the file says of itself."""
    said = _stated(table, Layout())
    remarks = [
        f"{name} is {mine * 1e6:.6g} um as stated; the file says {file * 1e6:.6g} um"
        for name, mine, file in (
            ("spacing_x", layout.spacing_x, said.spacing_x), ("spacing_y", layout.spacing_y, said.spacing_y),
        )
        if abs(mine / file - 1.0) > 1e-6
    ]  # fmt: skip
    if layout.height_unit and said.height_unit and layout.height_unit != said.height_unit:
        remarks.append(f"the unit of the heights is {layout.height_unit} as stated; the file says {said.height_unit}")
    return tuple(remarks)


def _matrix(table: TextTable, known: Layout, name: str) -> Surface:
    heights = table.values
    if heights.shape[1] in {2, 3} and heights.shape[0] > 3:
        raise ValueError(
            f"{heights.shape[1]} columns without names: head them 'x [um];z [um]' (or x, y, z), or write "
            'columns = ["x [um]", "z [um]"]; decimal commas need semicolons between the columns'
        )
    if heights.shape[1] == 1:
        heights = heights.T
    if not np.isfinite(known.spacing_x):
        raise ValueError('the spacing of the points is not stated: write spacing = "0.4 um" (or spacing_x, spacing_y)')
    if heights.shape[0] > 1 and not np.isfinite(known.spacing_y):
        raise ValueError('the spacing of the rows is not stated: write spacing_y = "0.4 um"')
    if not known.height_unit:
        raise ValueError(ASK_UNIT)
    spacing_y = known.spacing_y if heights.shape[0] > 1 else NAN
    return Surface(heights * metres_per_unit(known.height_unit), known.spacing_x, spacing_y, name)


def _points(table: TextTable, columns: dict[str, Column], known: Layout, name: str) -> Surface:
    unit = known.height_unit or columns["z"].unit
    if not unit:
        raise ValueError(ASK_UNIT)
    z = table.values[:, columns["z"].place] * metres_per_unit(unit)
    if "valid" in columns:
        z = np.where(table.values[:, columns["valid"].place] == 0.0, np.nan, z)
    x = _place(table, columns, "x")
    if "y" in columns:
        heights, spacing_x, spacing_y = grid(x, _place(table, columns, "y"), z)
    else:
        (heights, spacing_x), spacing_y = profile(x, z), NAN
    for axis, mine, stated in (("x", spacing_x, known.spacing_x), ("y", spacing_y, known.spacing_y)):
        if abs(mine / stated - 1.0) > EQUAL:
            raise ValueError(
                f"spacing_{axis} is stated as {stated * 1e6:.6g} um, and column {axis} has {mine * 1e6:.6g} um"
            )
    return Surface(heights, spacing_x, spacing_y, name)


def _place(table: TextTable, columns: dict[str, Column], axis: str) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    column = columns[axis]
    if not column.unit:
        raise ValueError(
            f"column {axis} has no unit: head it '{axis} [um]', or name all columns in the inputs file, as in "
            'columns = ["x [um]", "z [um]"]'
        )
    place = table.values[:, column.place]
    if np.isnan(place).any():
        raise ValueError(
            f"line {table.lines[np.argmax(np.isnan(place))]}: the point has no {axis}; only heights may be missing"
        )
    return place * metres_per_unit(column.unit, f"the unit of column {axis}")


def _checked(reading: Reading) -> Reading:
    if not np.isfinite(reading.surface.heights).any():
        raise ValueError("no point of the surface is measured")
    return reading
