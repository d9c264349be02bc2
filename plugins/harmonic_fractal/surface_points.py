"""Columns of points: which one is which, and how they become a profile or a grid of equal spacing."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal.surface import EQUAL
from harmonic_fractal.surface_text import TextTable

Array = NDArray[np.float64]
ROLES = {
    "x": "x", "position": "x", "distance": "x", "y": "y", "z": "z", "height": "z", "depth": "z", "valid": "valid",
}  # fmt: skip
NAMED = re.compile(r"\"?([A-Za-z]+)\"?\s*(?:[\[(]([^\])]*)[\])]|/\s*(\S+))?\"?")
UNIT = re.compile(r"\"?[\[(]([^\])]*)[\])]\"?")


@dataclass(frozen=True)
class Column:
    """A column of a file: its place, and its unit, empty where it states none."""

    place: int
    unit: str


def columns_of(table: TextTable, named: Sequence[str] = ()) -> dict[str, Column]:
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


def _from_header(table: TextTable) -> dict[str, Column] | None:
    lines = [line.lstrip("#").strip() for line in table.header]
    cells = [[cell.strip() for cell in _split(line, table.separator)] for line in lines]
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


def _split(line: str, separator: str | None) -> list[str]:
    return line.split(separator) if separator is not None else re.findall(r"\S+(?:\s+[\[(][^\])]*[\])])?", line)


def _roles(cells: list[str], units: list[str]) -> dict[str, Column] | None:
    """Return the columns by role, or None where a cell is no known name; a name that occurs twice is refused."""
    found: dict[str, Column] = {}
    for place, cell in enumerate(cells):
        match = NAMED.fullmatch(cell.strip())
        role = ROLES.get(match[1].lower()) if match else None
        if match is None or role is None:
            return None
        if role in found:
            raise ValueError(f"two columns are {role}: {'; '.join(cells)}")
        unit = match[2] or match[3] or ""
        found[role] = Column(place, unit.strip() or (units[place].strip() if units else ""))
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
