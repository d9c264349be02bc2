"""Workbooks read as data: a sheet, a range or a defined name, row by row, each cell with its address.

Formulas count by the values that were stored with them. Macros, links and whatever else a workbook holds are not looked
at.
"""

from __future__ import annotations

import re
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import date, datetime, time
from decimal import Decimal
from pathlib import Path
from typing import Any

from truing.errors import Fault, InputError
from truing.heavy import openpyxl
from truing.units.grammar import shown

LARGEST_UNPACKED = 1_000_000_000
"""So many bytes of unpacked text are read: 20 columns by the million rows that a sheet may have, or a trap."""
LAST_ROW = 1_048_576
LONGEST_TEXT = 32_767
"""A sheet of Excel has no more rows, and a cell no more characters."""
MOST_NAMED = 12
_NAME = re.compile(r"(?P<book>.+?\.xls[xm])(?:#(?P<place>.+))?", re.IGNORECASE | re.DOTALL)
_RANGE = re.compile(r"\$?([A-Z]{1,3})\$?([1-9]\d{0,6})?:\$?([A-Z]{1,3})\$?([1-9]\d{0,6})?", re.ASCII | re.IGNORECASE)
_MERGED = re.compile(rb'<(?:\w+:)?mergeCell\s+ref="([A-Z]{1,3}\d{1,7}:[A-Z]{1,3}\d{1,7})"')
_LITERAL = re.compile(r'"[^"]*"|\\.')
"""What a number format shows as it stands: a "%" in it multiplies nothing."""
_PLAIN_TITLE = re.compile(r"[^\W\d]\w*")


def parted(path: Path) -> tuple[Path, str]:
    """Take "book.xlsx#Sheet!A3:F60" apart: the file, and the place in it; what is no workbook has no place."""
    match = _NAME.fullmatch(path.name)
    if match is None or match["place"] is None or path.is_file():
        return path, ""
    return path.with_name(match["book"]), match["place"]


def file_of(path: Path) -> Path:
    """Return the file without a place in it."""
    return parted(path)[0]


def is_workbook(path: Path) -> bool:
    """Whether the name of a file says that it is a workbook that we read."""
    return file_of(path).suffix.lower() in {".xlsx", ".xlsm"}


@dataclass(frozen=True)
class CellRange:
    """Cells from a first to a last row and column, counted from 1; None is the last there is."""

    first_row: int = 1
    first_column: int = 1
    last_row: int | None = None
    last_column: int | None = None


@dataclass
class BookSheet:
    """A sheet of an open workbook, or a range of it; ``empty`` holds cells without a value that were passed."""

    file: Path
    title: str
    area: CellRange
    _sheet: Any
    empty: set[tuple[int, int]] = field(default_factory=set)

    def address(self, row: int, column: int) -> str:
        """Return what Excel calls a cell: Sheet1!B7."""
        title = self.title if _PLAIN_TITLE.fullmatch(self.title) else "'" + self.title.replace("'", "''") + "'"
        return f"{title}!{openpyxl.get_column_letter(column)}{row}"

    def fault(self, sentence: str, row: int, column: int) -> Fault:
        """Return a fault of a cell."""
        return Fault(sentence, str(self.file), row, self.address(row, column))

    def rows(self) -> Iterator[tuple[int, tuple[Any, ...]]]:
        """Give the number of every row that holds anything, with its cells from the first column of the range."""
        first = self.area.first_column
        with _told(self.file):
            for row, cells in self._cells(self._sheet):
                holds = False
                for column, cell in enumerate(cells, start=first):
                    if cell.value is not None:
                        holds = True
                    elif cell is not openpyxl.EMPTY_CELL and cell.data_type == "n":
                        self.empty.add((row, column))
                if holds:
                    yield row, cells

    def _cells(self, sheet: Any) -> Iterator[tuple[int, tuple[Any, ...]]]:
        sheet.reset_dimensions()  # what the file says of its size may be wrong
        area = self.area
        limits = {"min_row": area.first_row, "max_row": min(area.last_row or LAST_ROW, LAST_ROW)}
        rows = sheet.iter_rows(**limits, min_col=area.first_column, max_col=area.last_column)
        return enumerate(rows, start=area.first_row)

    def never_calculated(self) -> Iterator[tuple[int, int]]:
        """Give row and column of the formulas, among the empty cells that were passed, that have no stored value."""
        if not self.empty:
            return
        with _loaded(self.file, data_only=False) as book, _told(self.file):
            for row, cells in self._cells(book[self.title]):
                for column, cell in enumerate(cells, start=self.area.first_column):
                    if cell.data_type == "f" and (row, column) in self.empty:
                        yield row, column

    def merged(self) -> list[CellRange]:
        """Return the ranges of merged cells. The reader that streams passes over them, so they are looked for here."""
        with _told(self.file), zipfile.ZipFile(self.file) as archive:
            found: list[bytes] = []
            with archive.open(self._sheet._worksheet_path) as stream:
                rest = b""
                while part := stream.read(1 << 20):
                    found += _MERGED.findall(rest + part)
                    rest = part[part.rfind(b"<") :] if b"<" in part else b""
        ranges = [_range(text.decode()) for text in dict.fromkeys(found)]
        return [one for one in ranges if one is not None]


@contextmanager
def opened_sheet(path: Path, *, preferred: str = "", stored: bool = True) -> Iterator[BookSheet]:
    """Open the sheet or range that a path names: "book.xlsx", "book.xlsx#Sheet", "...#Sheet!A3:F60", "...#a_name".

    Where it names none it is the sheet called ``preferred``, or the only one that is not hidden. A formula counts by
    its ``stored`` value, or stands as it was typed. Raises InputError with one sentence for what is no workbook, has
    no such place, or is too large.
    """
    file, place = parted(path)
    with _loaded(file, data_only=stored) as book:
        sheet, area = _found(book, file, place, preferred)
        yield BookSheet(file, sheet.title, area, sheet)


@contextmanager
def _loaded(file: Path, *, data_only: bool) -> Iterator[Any]:
    with _told(file):
        _demand_modest(file)
        book = openpyxl.load_workbook(file, read_only=True, data_only=data_only, keep_links=False)
    try:
        yield book
    finally:
        book.close()


@contextmanager
def _told(file: Path) -> Iterator[None]:
    """Turn whatever the library raises on a broken workbook, which may be any exception, into one sentence."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what the library passes over: extensions, styles, printers
        try:
            yield
        except InputError:
            raise
        except ImportError:
            needs = "a workbook needs openpyxl, which is not installed"
            raise _refused(file, f"{needs}: pip install 'truing[excel]'; or save it as CSV UTF-8") from None
        except Exception as error:
            reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
            raise _refused(file, f"cannot be read as a workbook ({shown(reason)[1:-1]}); save it anew") from error


def _refused(file: Path, sentence: str) -> InputError:
    return InputError([Fault(sentence, str(file))])


def _demand_modest(file: Path) -> None:
    """Refuse what unpacks to more than a table can be, and what tells the reader of its text to make more of it."""
    with zipfile.ZipFile(file) as archive:
        size = sum(part.file_size for part in archive.infolist())
        if size > LARGEST_UNPACKED:
            many = f"unpacks to {size / 1e6:.0f} MB, at most {LARGEST_UNPACKED / 1e6:g} MB are read"
            raise _refused(file, f"{many}; save the table alone in a new workbook")
        for part in archive.infolist():
            if part.filename.lower().endswith((".xml", ".rels")):
                with archive.open(part) as stream:
                    if b"<!DOCTYPE" in stream.read(65536):
                        raise _refused(file, f"{shown(part.filename)} in it declares a document type; save it anew")


def _found(book: Any, file: Path, place: str, preferred: str) -> tuple[Any, CellRange]:
    """Return the sheet and the range that a place names."""
    sheets = {sheet.title.casefold(): sheet for sheet in book.worksheets}
    if not sheets:
        raise _refused(file, "holds no sheet of cells that can be read; save it as an Excel workbook (.xlsx)")
    visible = [sheet for sheet in book.worksheets if sheet.sheet_state == "visible"]
    title, mark, cells = place.rpartition("!")
    whole = title or ("" if _range(place) else place)
    if mark and title[:1] == title[-1:] == "'":
        whole = title[1:-1].replace("''", "'")
    if not whole:
        only = sheets.get(preferred.casefold()) if preferred else None
        if only is None and len(visible) != 1:
            raise _refused(file, f"holds {_listed(sheets.values())}; name one: {file.name}#{_first(visible, sheets)}")
        return only or visible[0], _range(place) or CellRange()
    if whole.casefold() in sheets:
        area = _range(cells) if mark else CellRange()
        if area is None:
            raise _refused(file, f"{shown(cells)} is no range of cells; write it like {file.name}#{whole}!A3:F60")
        return sheets[whole.casefold()], area
    return _by_name(book, file, place, sheets)


def _by_name(book: Any, file: Path, place: str, sheets: dict[str, Any]) -> tuple[Any, CellRange]:
    """Return the range that a defined name stands for."""
    names = {name.casefold(): defined for name, defined in book.defined_names.items()}
    defined = names.get(place.casefold())
    if defined is None:
        listed = f" and the names {', '.join(map(shown, list(book.defined_names)[:MOST_NAMED]))}" if names else ""
        raise _refused(file, f"has no sheet {shown(place)}; it holds {_listed(sheets.values())}{listed}")
    places = list(defined.destinations)
    area = _range(places[0][1]) if len(places) == 1 else None
    if area is None or places[0][0].casefold() not in sheets:
        raise _refused(file, f"the name {shown(place)} stands for no range of one sheet; name sheet and range")
    return sheets[places[0][0].casefold()], area


def _listed(sheets: Any) -> str:
    titles = [shown(sheet.title) for sheet in sheets]
    more = f" and {len(titles) - MOST_NAMED} more" if len(titles) > MOST_NAMED else ""
    return f"the sheet{'' if len(titles) == 1 else 's'} {', '.join(titles[:MOST_NAMED])}{more}"


def _first(visible: list[Any], sheets: dict[str, Any]) -> str:
    return next((sheet.title for sheet in [*visible, *sheets.values()]), "SHEET")


def _range(text: str) -> CellRange | None:
    """Return the cells of "A3:F60" or "A:F", None for any other text."""
    match = _RANGE.fullmatch(text)
    if match is None:
        return None
    columns = sorted(openpyxl.column_index_from_string(match[group].upper()) for group in (1, 3))
    rows = sorted(int(match[group]) for group in (2, 4) if match[group])
    if len(rows) == 1:
        return CellRange(rows[0], columns[0], None, columns[1]) if match[2] else None
    return CellRange(rows[0] if rows else 1, columns[0], rows[1] if rows else None, columns[1])


# What a cell holds, as a text file would have it


def cell_text(cell: Any) -> str:
    """Return a cell as a CSV file would have it: numbers exact, dates as ISO 8601. Raises ValueError for an error."""
    value = cell.value
    if value is None:
        return ""
    if cell.data_type == "e":
        raise ValueError(
            f"holds the error {shown(str(value))[1:-1]}; mend it, or empty the cell where there is no value"
        )
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime):
        return value.date().isoformat() if value.time() == time() else value.isoformat(" ")
    if isinstance(value, (date, time)):
        return value.isoformat()
    text = str(value)
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"holds {len(text)} characters; at most {LONGEST_TEXT} are read")
    return text if text.isprintable() else " ".join(text.split())


def in_per_cent(cell: Any) -> float:
    """Return the number in a cell whose unit is per cent: 0.07 that is shown as "7 %" is 7."""
    if "%" not in _LITERAL.sub("", cell.number_format):
        return float(cell.value)
    return float(Decimal(repr(cell.value)) * 100)
