"""Workbooks written: real numbers with the digits that are printed, text that never becomes a formula."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from math import isfinite, isnan
from typing import Any

from truing.errors import UsageError
from truing.heavy import openpyxl

LONGEST_TEXT = 32_767
MOST_ROWS = 1_048_575
"""A sheet of Excel has no more rows below its header."""
WIDEST, NARROWEST = 60, 8
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
_PRINTED = re.compile(r"-?\d+(?:\.(?P<decimals>\d+))?(?P<exponent>e[+-]?\d+)?", re.ASCII)
_DATE = re.compile(rb"(<dcterms:(created|modified)[^>]*>)[^<]*")


@dataclass(frozen=True)
class Printed:
    """A number, and the text that is printed of it elsewhere, by which the cell shows as many digits."""

    value: float | int | None
    text: str


@dataclass(frozen=True)
class SheetTable:
    """A sheet: its title, the cells of its header, its rows, and which cells of a column (0: the first) offer a choice.

    ``choices`` is by row (0: the first below the header) and column.
    """

    title: str
    headers: Sequence[str]
    rows: Iterable[Sequence[Any]]
    choices: Mapping[tuple[int, int], Sequence[Any]] = field(default_factory=dict)


def workbook_bytes(sheets: Sequence[SheetTable]) -> bytes:
    """Return a workbook, the same bytes whenever it is made. Raises UsageError where it cannot be."""
    demand_library()
    book = openpyxl.Workbook(write_only=True)
    lists: list[Sequence[Any]] = []
    for table in sheets:
        _write(book.create_sheet(table.title), table, lists)
    if lists:
        _write_lists(book.create_sheet("choices"), lists)
    stream = BytesIO()
    book.save(stream)
    return undated(stream.getvalue())


def demand_library() -> None:
    """Raise UsageError where the library is not installed that writes workbooks: asked before a long calculation."""
    try:
        assert openpyxl.Workbook
    except ImportError:
        raise UsageError("a workbook needs openpyxl, which is not installed: pip install 'truing[excel]'") from None


def _write(sheet: Any, table: SheetTable, lists: list[Sequence[Any]]) -> None:
    rows = list(table.rows)
    if len(rows) > MOST_ROWS:
        raise UsageError(f"{len(rows)} rows are more than a sheet of a workbook has ({MOST_ROWS}); write them as CSV")
    sheet.freeze_panes = "A2"
    for place, header in enumerate(table.headers):
        longest = max([len(header), *(len(_shown(row[place])) for row in rows[:200])])
        letter = openpyxl.get_column_letter(place + 1)
        sheet.column_dimensions[letter].width = min(max(longest + 2, NARROWEST), WIDEST)
    for (row, place), offered in table.choices.items():
        if offered not in lists:
            lists.append(offered)
        letter = openpyxl.get_column_letter(lists.index(offered) + 1)
        source = f"choices!${letter}$1:${letter}${len(offered)}"
        rule = openpyxl.DataValidation("list", formula1=source, allow_blank=True, showErrorMessage=True)
        rule.add(f"{openpyxl.get_column_letter(place + 1)}{row + 2}")
        sheet.data_validations.append(rule)
    bold = openpyxl.Font(bold=True)
    head = [_cell(sheet, header) for header in table.headers]
    for cell in head:
        cell.font = bold
    sheet.append(head)
    for values in rows:
        sheet.append([_cell(sheet, value) for value in values])


def _write_lists(sheet: Any, lists: Sequence[Sequence[Any]]) -> None:
    """Write what the cells of other sheets offer into a sheet that is hidden, a list in each column."""
    sheet.sheet_state = "hidden"
    for row in range(max(map(len, lists))):
        sheet.append([_cell(sheet, offered[row] if row < len(offered) else None) for offered in lists])


def _cell(sheet: Any, value: Any) -> Any:
    """Return what the sheet takes: None, a number, or a cell with a format; of a text one that is no formula."""
    text = value.text if isinstance(value, Printed) else ""
    value = value.value if isinstance(value, Printed) else value
    plain = value.item() if hasattr(value, "item") else value
    if isinstance(plain, float) and not isfinite(plain):
        plain = None if isnan(plain) else str(plain)
    if isinstance(plain, (bool, int, float)) or plain is None:
        shape = number_format(text)
        if shape is None or plain is None:
            return plain
        cell = openpyxl.WriteOnlyCell(sheet, value=plain)
        cell.number_format = shape
        return cell
    words = _CONTROL.sub("\N{REPLACEMENT CHARACTER}", str(plain))[:LONGEST_TEXT]
    cell = openpyxl.WriteOnlyCell(sheet, value=words)
    if cell.data_type != "s":  # what begins with = would be a formula, "#N/A" an error
        cell.data_type = "s"
    cell.quotePrefix = words[:1] in set("=+-@#")
    return cell


def number_format(text: str) -> str | None:
    """Return the format by which Excel shows as many digits as a text has: "0.00", "0.0E+00"; None for other texts."""
    match = _PRINTED.fullmatch(text)
    if match is None:
        return None
    decimals = "." + "0" * len(match["decimals"]) if match["decimals"] else ""
    return f"0{decimals}{'E+00' if match['exponent'] else ''}"


def _shown(value: Any) -> str:
    return value.text if isinstance(value, Printed) else "" if value is None else str(value)


def undated(content: bytes) -> bytes:
    """Return a workbook, or another Office document, without the times at which it and its parts were written."""
    stream = BytesIO()
    with zipfile.ZipFile(BytesIO(content)) as before, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as after:
        for part in before.infolist():
            entry = zipfile.ZipInfo(part.filename, date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            text = before.read(part)
            if part.filename == "docProps/core.xml":
                text = _DATE.sub(rb"\g<1>1980-01-01T00:00:00Z", text)
            after.writestr(entry, text)
    return stream.getvalue()
