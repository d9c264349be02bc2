"""What the text of a cell may be: a number, a word for none, or words that a spreadsheet would take for a formula."""

from __future__ import annotations

import re
from collections.abc import Sequence

MARK = "\ufeff"
"""The byte order mark: by it a spreadsheet knows UTF-8, and we a table that was written for one."""

NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
"""A comma that may be the decimal mark or part thousands: read where another number decides, written nowhere."""
MISSING_WORDS = {"nan", "na", "n/a", "#n/a", "null", "none", "-"}
_FORMULA = re.compile(r"'*(?P<words>\s*[=+\-@＝＋－＠].+)", re.DOTALL)


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
