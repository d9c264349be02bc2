"""What the text of a cell may be: a number, a word for none, or words that a spreadsheet would take for a formula."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from truing.units.grammar import number, shown

MARK = "\ufeff"
"""The byte order mark: by it a spreadsheet knows UTF-8, and we a table that was written for one."""

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
"""A comma that may be the decimal mark or part thousands: read where another number decides, written nowhere."""
MISSING_WORDS = {"nan", "na", "n/a", "#n/a", "null", "none", "-"}
_FORMULA = re.compile(r"'*(?P<words>\s*[=+\-@＝＋－＠].+)", re.DOTALL)
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


def plain_numbers(cells: Sequence[str]) -> NDArray[np.float64] | None:
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


def guarded(cell: str) -> str:
    """Return a cell with an apostrophe before what would be a formula; numbers and other words stay."""
    return f"'{cell}" if _may_be_formula(cell) else cell


def unguarded(cell: str) -> str:
    """Return a cell as it was before it was guarded."""
    return cell[1:] if cell.startswith("'") and _may_be_formula(cell[1:]) else cell


def all_unguarded(row: Sequence[str]) -> list[str]:
    """Return the cells of a row as they were before they were guarded."""
    return [unguarded(cell) for cell in row]


def _may_be_formula(cell: str) -> bool:
    found = _FORMULA.fullmatch(cell)
    return found is not None and not NUMBER.fullmatch(found["words"].strip().replace(",", ".", 1))


def with_comma(cells: Sequence[str]) -> Sequence[str]:
    """Return a column of numbers as written with decimal commas; one that holds any other word stays as it is."""
    plain = [cell.strip() for cell in cells]
    if all(not cell or NUMBER.fullmatch(cell) or cell.lower() in MISSING_WORDS for cell in plain):
        return [cell.replace(".", ",") for cell in cells]
    return cells
