"""Cells of a table to SI numbers, and the faults of the cells that are none."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from truing.errors import UnitError
from truing.measurements.cell_text import MISSING_WORDS, NUMBER
from truing.measurements.csv_text import CsvFile, Faults, Header
from truing.units import demand_dimension, difference_unit, human_dimension, si_fault, to_si
from truing.units.grammar import number, shown
from truing.units.names import PURE

_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?|(?=[eE]|$))(?:[eE][+-]?\d+)?", re.ASCII)
_INFINITE = re.compile(r"[+-]?(?:inf|infinity|∞)", re.IGNORECASE)


def read_cell(text: str, *, decimal_comma: bool, may_be_missing_word: bool = False) -> float:
    """Return the number in a cell, NaN for an empty one. Raises ValueError with one sentence."""
    cell = text.strip()
    if not cell:
        return math.nan
    if decimal_comma and "," in cell and _COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    value = number(cell)
    if value is not None:
        return value
    if cell.lower() in MISSING_WORDS:
        if may_be_missing_word:
            return math.nan
        raise ValueError(f"{shown(text)} is no number; leave the cell empty where a value is missing")
    raise ValueError(_wrong(cell))


def _wrong(cell: str) -> str:
    if cell[0] in "<>≤≥":
        words = "write the number, and mark the row in a column of its own (at_least or at_most in [studies.diagnose])"
        return f"{shown(cell)} is no number; {words}"
    if _INFINITE.fullmatch(cell):
        return f"{shown(cell)} is not a finite number"
    if not cell.isascii() and any(character.isdigit() and not character.isascii() for character in cell):
        return f"{shown(cell)} is no number; digits are 0 to 9"
    if re.fullmatch(r"[+-]?\d+,\d+", cell):
        return f"{shown(cell)} has a decimal comma; put semicolons between the columns, or write a point"
    if re.fullmatch(r"[+-]?\d{1,3}(?:[.,' ]\d{3})+(?:[.,]\d+)?", cell):
        return f"{shown(cell)} has marks between the thousands; write the digits alone"
    if re.fullmatch(NUMBER.pattern + r"\s*[^\d\s,;.]+.*", cell):
        return f"{shown(cell)} holds more than a number; the unit stands in the header, as in 'load [N]'"
    return f"{shown(cell)} is no number"


def read_cells(
    cells: Sequence[str], lines: Sequence[int], header: Header, table: CsvFile, *, strict: bool
) -> NDArray[np.float64]:
    """Return the numbers of a column as they stand; what is none is a fault with its line."""
    fast = _plain_numbers(cells)
    if fast is not None and not (table.decimal_comma and any("." in cell for cell in cells)):
        return fast
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        try:
            values[row] = read_cell(cell, decimal_comma=table.decimal_comma, may_be_missing_word=not strict)
            table.marks.take(header.name, cell.strip(), lines[row])
        except ValueError as error:
            values[row] = math.nan
            table.faults.add(f"{header.name}: {error}", lines[row])
    return values


def _plain_numbers(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Return a column at once where every cell is a number that Python reads as we do; else None."""
    try:
        fast = np.array(list(map(float, cells)))
    except ValueError:
        return None
    together = "".join(cells)
    if not np.isfinite(fast).all() or "_" in together or not together.isascii():
        return None
    zeros = [cells[row] for row in np.flatnonzero(fast == 0).tolist()] if "e" in together or "E" in together else []
    return None if any(cell.strip(" +-0.") for cell in zeros) else fast


def column_in_si(
    values: NDArray[np.float64], lines: Sequence[int], header: Header, declared: str, faults: Faults
) -> NDArray[np.float64]:
    """Bring a column from the unit of its header to SI; a number that cannot be one of *declared* there is a fault."""
    unit = header.unit or ""
    with np.errstate(over="ignore"):
        found = values if unit in PURE else to_si(values, unit)
    odd = np.isfinite(values) & (~np.isfinite(found) | (found < 0) | ((found == 0) & (values != 0)))
    for row in np.flatnonzero(odd).tolist() if declared not in PURE or unit not in PURE else ():
        fault = si_fault(float(values[row]), float(found[row]), declared)
        if fault:
            faults.add(f"{header.name}: {shown(f'{values[row]:g} {unit}')} {fault}", lines[row])
    return found


def header_fault(header: Header, declared: str, *, is_difference: bool = False) -> str:
    """Return what is wrong with the unit in a header where ``declared`` is expected, or nothing."""
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
