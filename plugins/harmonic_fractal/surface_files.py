"""Surfaces from files: texts by our own reader, profilometer formats through an optional library."""

import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.surface import EQUAL, Surface
from truing import Array, TruingError, quantity

# Text files of heights: from bytes to numbers with holes, what the header says, and which line each row stands on

HOLES = re.compile(r"\*+|-+|nan|n/?a|null|none|bad|invalid|", re.IGNORECASE)
STATED = re.compile(r"#?\s*(spacing|spacing_x|spacing_y|height_unit|filter_width)\s*[=:]\s*(.+?)\s*")
NUMBER = re.compile(r"[+-]?(?:\d|\.\d)")


@dataclass(frozen=True, eq=False, kw_only=True)
class TextTable:
    """The numbers of a text file (rows, columns), NaN where a cell is a hole, and all that stands around them.

    ``lines`` (rows,) are the numbers of the lines in the file, ``header`` the lines before the numbers and the
    comments, ``stated`` what the header states as ``name = value``, ``separator`` None for spaces.
    """

    values: NDArray[np.float64]
    lines: NDArray[np.int64]
    header: tuple[str, ...]
    stated: dict[str, str]
    separator: str | None


def is_text(content: bytes) -> bool:
    """Whether these bytes are text: UTF-16 by its mark, else without a zero byte or other control characters."""
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return True
    return not content[:65536].translate(None, bytes(range(32, 256)) + b"\t\n\r\f\x1a")


def decoded(content: bytes) -> str:
    """Return the text: UTF-16 by its mark, else UTF-8, else the Western code page of older instruments."""
    if content[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return content.decode("utf-16")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def read_table(text: str, *, skip_lines: int = 0) -> TextTable:
    """Read numbers below any header: separated by semicolons, tabs, commas or spaces.

    Where the separator is no comma, a comma is the decimal sign. Empty cells, ``nan`` and ``***`` are holes. Lines that
    begin with # are comments wherever they stand, empty lines count for nothing. ``skip_lines`` lines at the top are
    header whatever they hold. Raises ValueError with the line of what is no number, or of a row that is too short.
    """
    every = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if skip_lines >= len(every):
        raise ValueError(f"skip_lines = {skip_lines}, and the file has {len(every)} lines")
    start = next((i for i in range(skip_lines, len(every)) if _is_data(every[i])), None)
    if start is None:
        raise ValueError("no line of the file holds numbers")
    rows = [(number, line) for number, line in enumerate(every[start:], start=start + 1) if _counts(line)]
    _demand_header(every[skip_lines:start], skip_lines, rows[0][1])
    header = (*every[:start], *(line for line in every[start:] if line.lstrip().startswith("#")))
    separator = separator_of(rows[0][1])
    values, lines = _values(rows, separator)
    if values.shape[1] == 1:
        _demand_no_gap(every, rows)
    stated = {match[1]: match[2] for line in header if (match := STATED.fullmatch(line.strip()))}
    header = tuple(line.strip() for line in header if line.strip())
    return TextTable(values=values, lines=lines, header=header, stated=stated, separator=separator)


def _demand_header(lines: list[str], skipped: int, first: str) -> None:
    """Refuse a line above the numbers that is a row of them but for a broken cell, so that it is not passed over."""
    separator = separator_of(first)
    width = len(first.split(separator))
    for number, line in enumerate(lines, start=skipped + 1):
        cells = [cell.strip() for cell in line.split(separator)] if _counts(line) else []
        wrong = [cell for cell in cells if not _is_number(cell, separator) and not HOLES.fullmatch(cell)]
        if len(cells) == width and wrong and 2 * len(wrong) < width:
            raise ValueError(
                f"line {number}: {wrong[0][:40]!r} is no number; holes are empty, nan or ***, and "
                f"skip_lines = {number} passes over a header"
            )


def separator_of(line: str) -> str | None:
    """Return what separates the cells of this line: a semicolon, a tab, a comma, or None for spaces.

    Between spaces ``1,5 2,5`` are two numbers with a decimal comma; ``1,5`` alone are two numbers.
    """
    for mark in (";", "\t"):
        if mark in line:
            return mark
    cells = line.split()
    is_decimal = len(cells) > 1 and all(re.fullmatch(r"[+-]?\d+(,\d+)?([eE][+-]?\d+)?|nan|\*+", c) for c in cells)
    return "," if "," in line and not is_decimal else None


def length(text: object, name: str) -> float:
    """Return a positive length in m of an option or of a header line. Raises ValueError with one sentence."""
    if not isinstance(text, str):
        raise ValueError(f'{name} = {text} needs its unit, in quotes: {name} = "0.4 um"')
    try:
        value = quantity(text, "m")
    except TruingError as error:
        raise ValueError(f"{name}: {error}") from None
    if value <= 0.0:
        raise ValueError(f"{name} = {text!r} must be above 0")
    return value


def metres_per_unit(text: object, name: str = "height_unit") -> float:
    """Return the length of one unit in m: of "um", or of "2.918e-8 m", where a file counts in steps or in radians."""
    example = 'name a length such as "um", or the length of one count, as in "2.918e-8 m"'
    if not isinstance(text, str) or not text.strip():
        raise ValueError(f"{name} = {text!r} is no unit: {example}")
    try:
        value = quantity(text if NUMBER.match(text.strip()) else f"1 {text}", "m")
    except TruingError:
        raise ValueError(f"{name} = {text!r} is no length: {example}") from None
    if value <= 0.0:
        raise ValueError(f"{name} = {text!r} must be above 0")
    return value


def _demand_no_gap(every: list[str], rows: list[tuple[int, str]]) -> None:
    """Refuse an empty line between single numbers: it may stand for a hole, and all behind it would move."""
    empty = next((i for i in range(rows[0][0], rows[-1][0]) if not every[i - 1].strip()), None)
    if empty is not None:
        raise ValueError(f"line {empty} is empty; write nan where a height is missing, or take the line out")


def _counts(line: str) -> bool:
    stripped = line.strip(" \r\f\x1a")  # a line of tabs alone is a row of holes
    return bool(stripped) and not stripped.lstrip().startswith("#")


def _is_data(line: str) -> bool:
    """Whether a line holds numbers and holes only, and at least one number or two holes."""
    if not _counts(line):
        return False
    separator = separator_of(line)
    cells = [cell.strip() for cell in line.split(separator)]
    numbers = sum(_is_number(cell, separator) for cell in cells)
    return (numbers > 0 or len(cells) > 1) and all(
        _is_number(cell, separator) or HOLES.fullmatch(cell) is not None for cell in cells
    )


def _is_number(cell: str, separator: str | None) -> bool:
    try:
        float(cell if separator == "," else cell.replace(",", "."))
    except ValueError:
        return False
    return "_" not in cell and cell.isascii()


def _values(rows: list[tuple[int, str]], separator: str | None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the numbers (rows, columns); a column of nothing behind a last separator is left out."""
    numbers = array("d")
    width = len(_cells(rows[0][1], separator))
    for number, line in rows:
        cells = _cells(line, separator)
        if len(cells) != width:
            raise ValueError(
                f"line {number} has {len(cells)} cells, and line {rows[0][0]} has {width}; every row needs as many "
                "(skip_lines passes over a header of numbers)"
            )
        try:
            found = [float(cell or "nan") for cell in cells]
        except ValueError:
            found = []
        if not found or not line.isascii():
            found = [_number(cell, number) for cell in cells]
        numbers.extend(found)
    values = np.frombuffer(numbers, dtype=np.float64).reshape(len(rows), width)
    lines = np.array([number for number, _ in rows], dtype=np.int64)
    if np.isinf(values).any():
        raise ValueError(f"line {lines[np.isinf(values).any(axis=1)][0]}: infinite is no height; leave holes empty")
    if separator is not None and all(line.rstrip(" \r").endswith(separator) for _, line in rows) and width > 1:
        values = values[:, :-1]
    return values, lines


def _cells(line: str, separator: str | None) -> list[str]:
    clean = line.strip("\x1a\f ") if separator is not None else line.strip("\x1a\f")
    return (clean if separator == "," else clean.replace(",", ".")).replace("_", "?").split(separator)


def _number(cell: str, line: int) -> float:
    if not cell or HOLES.fullmatch(cell.strip()):
        return float("nan")
    if not _is_number(cell, ","):
        raise ValueError(f"line {line}: {cell.strip()[:40]!r} is no number; holes are empty, nan or ***")
    return float(cell)


# Columns of points: which one is which, and how they become a profile or a grid of equal spacing

ROLES = {
    "x": "x", "position": "x", "distance": "x", "y": "y", "z": "z", "height": "z", "depth": "z", "valid": "valid",
}  # fmt: skip
NAMED = re.compile(r"\"?([A-Za-z]+)\"?\s*(?:[\[(]([^\])]*)[\])]|/\s*(\S+))?\"?")
UNIT = re.compile(r"\"?[\[(]([^\])]*)[\])]\"?")
SPACED = re.compile(r"\S+(?:\s+[\[(][^\])]*[\])])?")  # names between spaces, each with its unit


HeightColumn = tuple[int, str]
"""A column of a file: its place, and its unit, empty where it states none."""


def columns_of(table: TextTable, named: Sequence[str] = ()) -> dict[str, HeightColumn]:
    """Return the columns x, y, z, valid by their role; empty where the file is a plain matrix.

    Names come from ``named``, else from the last header lines: ``x [um];z [um]``, or names and a line of units below.
    x and y without z are a profile whose height is y.
    """
    width = table.values.shape[1]
    if named:
        found = _roles(list(named), [])
        if found is None or len(named) != width:
            raise ValueError(
                f'columns = {list(named)} must name the {width} columns of the file, as in ["x [um]", "z [um]"]'
            )
    else:
        found = _from_header(table)
    if found is None:
        return {}
    if "z" not in found and "y" in found:
        found["z"] = found.pop("y")
    missing = [name for name in ("x", "z") if name not in found]
    if missing:
        raise ValueError(f"no column {' and '.join(missing)} among {', '.join(found)}; name them as in 'x [um];z [um]'")
    return found


def _from_header(table: TextTable) -> dict[str, HeightColumn] | None:
    lines = [line.lstrip("#").strip() for line in table.header]
    parts = (line.split(mark) if (mark := table.separator) else SPACED.findall(line) for line in lines)
    cells = [[cell.strip() for cell in part] for part in parts]
    width = table.values.shape[1]
    units: list[str] = []
    for row in reversed(cells):
        if len(row) != width:
            continue
        marks = [UNIT.fullmatch(cell) for cell in row]
        if all(marks):
            units = [mark[1] for mark in marks if mark]
            continue
        found = _roles(row, units)
        if found is not None:
            return found
    return None


def _roles(cells: list[str], units: list[str]) -> dict[str, HeightColumn] | None:
    """Return the columns by role, or None where a cell is no known name; a name that occurs twice is refused."""
    found: dict[str, HeightColumn] = {}
    for place, cell in enumerate(cells):
        match = NAMED.fullmatch(cell.strip())
        role = ROLES.get(match[1].lower()) if match else None
        if match is None or role is None:
            return None
        if role in found:
            raise ValueError(f"two columns are {role}: {'; '.join(cells)}")
        unit = match[2] or match[3] or ""
        found[role] = place, unit.strip() or (units[place].strip() if units else "")
    return found


def profile(x: Array, z: Array) -> tuple[Array, float]:
    """Return heights (1, points) at equal spacing, and the spacing: points in any order, a gap of whole steps is holes.

    Raises ValueError where the spacing departs from its median by more than 1 %.
    """
    places, spacing = positions(x, "x")
    heights = np.full((1, int(places.max()) + 1), np.nan)
    heights[0, places] = z
    return heights, spacing


def grid(x: Array, y: Array, z: Array) -> tuple[Array, float, float]:
    """Return heights (rows, points) and both spacings from a list of points in any order; a missing one is a hole."""
    columns, spacing_x = positions(x, "x", shared=True)
    rows, spacing_y = positions(y, "y", shared=True)
    width, height = int(columns.max()) + 1, int(rows.max()) + 1
    if width * height > 20 * len(x):
        raise ValueError(f"{len(x)} points lie on no full grid: it would have {width} x {height}")
    taken = np.bincount(rows * width + columns, minlength=width * height)
    if (taken > 1).any():
        row, column = divmod(int(np.argmax(taken > 1)), width)
        raise ValueError(
            f"two points at column {column + 1} of row {row + 1}, x = {x.min() + column * spacing_x:.6g} m"
        )
    heights = np.full((height, width), np.nan)
    heights[rows, columns] = z
    return heights, spacing_x, spacing_y


def positions(values: Array, name: str, *, shared: bool = False) -> tuple[NDArray[np.int64], float]:
    """Return the whole steps (n,) from the lowest position, and the step; with ``shared`` positions may coincide.

    Raises ValueError, with the place, where neighbours are not a whole number of steps apart within 1 % of the step.
    """
    if not np.isfinite(values).all():
        raise ValueError(f"a point has no {name}; only heights may be missing")
    order = np.argsort(values, kind="stable")
    ranked = values[order]
    gaps = np.diff(ranked)
    if len(gaps) == 0 or gaps.max() <= 0.0:
        raise ValueError(f"all points have the same {name}")
    real = gaps > (0.05 * gaps.max() if shared else 0.0)
    if not real.all() and not shared:
        raise ValueError(f"two points have {name} = {ranked[np.argmin(real)]:.6g} m")
    step = float(np.median(gaps[real]))
    counts = np.where(real, np.round(gaps / step), 0.0)
    off = np.abs(gaps - counts * step) > EQUAL * step
    if off.any():
        place = int(np.argmax(off))
        raise ValueError(
            f"the spacing of {name} is unequal: {gaps[place]:.6g} m at {name} = {ranked[place]:.6g} m, {step:.6g} m "
            "elsewhere; resample to equal spacing, or export with more digits"
        )
    steps = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    places = np.empty(len(values), dtype=np.int64)
    places[order] = steps
    return places, float((ranked[-1] - ranked[0]) / steps[-1])


# Profilometer formats (al3d, MetroPro, sdf, x3p, sur, plux, vk, gwy) through the optional library SurfaceTopography
#
# Source: Roettger et al., Surface Topography: Metrology and Properties 10 (2022) 035032.

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


def _demand_alike(axis: str, own: float, stated: float, source: str) -> None:
    """Refuse a stated spacing, m, that is not the file's own; NaN is any."""
    if abs(stated / own - 1.0) > EQUAL:
        raise ValueError(f"spacing_{axis} is stated as {stated * 1e6:.6g} um, and {source} {own * 1e6:.6g} um")


def _spacing(axis: str, own: float, stated: float) -> float:
    _demand_alike(axis, own, stated, "the file says")
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


FORMATS_IN_TEXT = {".sdf"}  # those of the library that may be written in letters and digits
ASK_UNIT = (
    'the unit of the heights is not stated: write height_unit = "um", or the length of one count where the file counts '
    'in steps or radians, as in height_unit = "2.918e-8 m"'
)


@dataclass(frozen=True, kw_only=True)
class FileLayout:
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


def read_surface(path: Path, layout: FileLayout) -> Reading:
    """Read heights in m from a text or from a profilometer's file; NaN where nothing was measured.

    Texts are a matrix (one row of numbers per row of the surface), or named columns: ``x [um];z [um]`` for a profile,
    ``x, y, z`` for points on a full grid, ``valid`` 0 for holes. Header lines ``# spacing_x = 0.4 um`` and
    ``# height_unit = um`` make a file speak for itself. Raises ValueError with one sentence.
    """
    content = path.read_bytes()
    if not content.strip():
        raise ValueError("the file is empty")
    if not is_text(content) or path.suffix.lower() in FORMATS_IN_TEXT:
        reading = _from_format(path, layout)
    else:
        table = read_table(decoded(content), skip_lines=layout.skip_lines)
        columns = columns_of(table, layout.columns)
        known = _stated(table, layout)
        surface = _points(table, columns, known, path.name) if columns else _matrix(table, known, path.name)
        text = table.stated.get("filter_width", "")
        width = length(text, "filter_width in the file") if text else NAN
        reading = Reading(surface=surface, filter_width=width, remarks=_contradictions(table, layout))
    if not np.isfinite(reading.surface.heights).any():
        raise ValueError("no point of the surface is measured")
    return reading


def _from_format(path: Path, layout: FileLayout) -> Reading:
    for name, is_given in (("skip_lines", layout.skip_lines > 0), ("columns", bool(layout.columns))):
        if is_given:
            raise ValueError(f"{name} belongs to text files, and {path.name} is none")
    spacing = (layout.spacing_x, layout.spacing_y)
    heights, (dx, dy), width = read_format(path, spacing, layout.height_unit)
    return Reading(surface=Surface(heights, dx, dy, path.name), filter_width=width)


def _stated(table: TextTable, layout: FileLayout) -> FileLayout:
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


def _contradictions(table: TextTable, layout: FileLayout) -> tuple[str, ...]:
    """Say where the options override what the file says of itself."""
    said = _stated(table, FileLayout())
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


def _matrix(table: TextTable, known: FileLayout, name: str) -> Surface:
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


def _points(table: TextTable, columns: dict[str, HeightColumn], known: FileLayout, name: str) -> Surface:
    place, own_unit = columns["z"]
    unit = known.height_unit or own_unit
    if not unit:
        raise ValueError(ASK_UNIT)
    z = table.values[:, place] * metres_per_unit(unit)
    if "valid" in columns:
        z = np.where(table.values[:, columns["valid"][0]] == 0.0, np.nan, z)
    x = _place(table, columns, "x")
    if "y" in columns:
        heights, spacing_x, spacing_y = grid(x, _place(table, columns, "y"), z)
    else:
        (heights, spacing_x), spacing_y = profile(x, z), NAN
    for axis, own, stated in (("x", spacing_x, known.spacing_x), ("y", spacing_y, known.spacing_y)):
        _demand_alike(axis, own, stated, f"column {axis} has")
    return Surface(heights, spacing_x, spacing_y, name)


def _place(
    table: TextTable, columns: dict[str, HeightColumn], axis: str
) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    number, unit = columns[axis]
    if not unit:
        raise ValueError(
            f"column {axis} has no unit: head it '{axis} [um]', or name all columns in the inputs file, as in "
            'columns = ["x [um]", "z [um]"]'
        )
    place = table.values[:, number]
    if np.isnan(place).any():
        raise ValueError(
            f"line {table.lines[np.argmax(np.isnan(place))]}: the point has no {axis}; only heights may be missing"
        )
    return place * metres_per_unit(unit, f"the unit of column {axis}")
