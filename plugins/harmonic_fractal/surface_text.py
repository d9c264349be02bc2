"""Text files of heights: from bytes to numbers with holes, what the header says, and which line each row stands on."""

import re
from array import array
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from truing import TruingError, quantity

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
    return TextTable(
        values=values, lines=lines, header=tuple(line.strip() for line in header if line.strip()),
        stated=_stated(header), separator=separator,
    )  # fmt: skip


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


def _stated(header: tuple[str, ...]) -> dict[str, str]:
    found = [STATED.fullmatch(line.strip()) for line in header]
    return {match[1]: match[2] for match in found if match is not None}
