"""Cells of a table to SI numbers, and the faults of the cells that are none."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from truing.errors import UnitError
from truing.measurements.cell_text import MISSING_WORDS, NUMBER
from truing.measurements.csv_text import Faults, Header
from truing.units.grammar import shown
from truing.units.names import PURE

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?|(?=[eE]|$))(?:[eE][+-]?\d+)?")
_INFINITE = re.compile(r"[+-]?(?:inf|infinity|∞)", re.IGNORECASE)


def read_cell(text: str, *, decimal_comma: bool, may_be_missing_word: bool = False) -> float:
    """Return the number in a cell, NaN for an empty one. Raises ValueError with one sentence."""
    cell = text.strip()
    if not cell:
        return math.nan
    if decimal_comma and "," in cell and _COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    if NUMBER.fullmatch(cell):
        value = float(cell)
        if math.isfinite(value):
            return value
        raise ValueError(f"{shown(text)} is too large for a number")
    if cell.lower() in MISSING_WORDS:
        if may_be_missing_word:
            return math.nan
        raise ValueError(f"{shown(text)} is no number; leave the cell empty where a value is missing")
    raise ValueError(_wrong(cell))


def _wrong(cell: str) -> str:
    if _INFINITE.fullmatch(cell):
        return f"{shown(cell)} is not a finite number"
    if re.fullmatch(r"[+-]?\d+,\d+", cell):
        return f"{shown(cell)} has a decimal comma; put semicolons between the columns, or write a point"
    if re.fullmatch(r"[+-]?\d{1,3}(?:[.,' ]\d{3})+(?:[.,]\d+)?", cell):
        return f"{shown(cell)} has marks between the thousands; write the digits alone"
    if re.fullmatch(NUMBER.pattern + r"\s*[^\d\s,;.]+.*", cell):
        return f"{shown(cell)} holds more than a number; the unit stands in the header, as in 'load [N]'"
    return f"{shown(cell)} is no number"


def read_cells(
    cells: Sequence[str], lines: Sequence[int], header: Header, faults: Faults, *, decimal_comma: bool, strict: bool
) -> NDArray[np.float64]:
    """Return the numbers of a column as they stand; what is none is a fault with its line."""
    import numpy as np

    try:
        fast = np.array(list(map(float, cells)))
        if np.isfinite(fast).all() and "_" not in "".join(cells):
            return fast
    except ValueError:
        pass
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        try:
            values[row] = read_cell(cell, decimal_comma=decimal_comma, may_be_missing_word=not strict)
        except ValueError as error:
            values[row] = math.nan
            faults.add(f"{header.name}: {error}", lines[row])
    return values


def header_fault(header: Header, declared: str, *, is_difference: bool = False) -> str:
    """Return what is wrong with the unit in a header where ``declared`` is expected, or nothing."""
    from truing.units import demand_dimension, difference_unit, human_dimension

    wanted = difference_unit(declared) if is_difference else declared
    if header.unit is None:
        if wanted in PURE:
            return ""
        return f"column '{header.name}' has no unit; it is {human_dimension(wanted)}: write '{header.name} [{wanted}]'"
    try:
        demand_dimension(header.unit, wanted)
    except UnitError as error:
        return f"column {shown(header.text)}: {error}"
    return ""
