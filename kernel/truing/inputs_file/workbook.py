"""An inputs file that is a workbook: a row for every value, with its name as ``--set`` calls it, value and unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from truing.declare.model import Model
from truing.errors import Fault, InputError
from truing.inputs_file.document import (
    MOST_STATEMENTS,
    UNREADABLE,
    InputsDocument,
    KeyPath,
    open_table,
    path_of,
    put,
    value_of,
)
from truing.inputs_file.files import LARGEST_INPUTS, opened_book
from truing.kernel import Offer
from truing.units.grammar import shown
from truing.units.names import PURE
from truing.workbooks.reading import BookSheet, cell_text, in_per_cent

SHEET = "inputs"
COLUMNS = ("name", "value", "unit", "symbol", "note", "source")
"""The columns of the sheet; the first two are needed, and those behind the unit are for people."""


def read_book(path: Path, offer: Offer) -> InputsDocument:
    """Read the sheet ``inputs`` of a workbook, its only one, or the one that is named; an empty value states nothing.

    What cannot be read stands in ``faults`` and the rest in ``data``. Raises InputError for what is no such workbook.
    """
    document = InputsDocument(str(path), places={(): (str(path), None)})
    with opened_book(path, largest=LARGEST_INPUTS, preferred=SHEET) as sheet:
        rows = sheet.rows()
        reader = _BookReader(document, offer.model, sheet, _columns(rows, sheet, offer.name))
        for count, (row, cells) in enumerate(rows, start=1):
            if count > MOST_STATEMENTS:
                raise InputError([Fault(f"holds more than {MOST_STATEMENTS} rows", str(path))])
            reader.take(row, cells)
        reader.take_formulas()
    return document


def _columns(rows: Iterator[tuple[int, tuple[Any, ...]]], sheet: BookSheet, name: str) -> dict[str, int]:
    """Return the places of the columns by name: the first row that has ``name`` and ``value`` is the header."""
    for _, cells in rows:
        columns: dict[str, int] = {}
        for place, cell in enumerate(cells):
            columns.setdefault(str(cell.value or "").strip().casefold(), place)
        if "name" in columns and "value" in columns:
            return {column: columns[column] for column in COLUMNS if column in columns}
    instead = f"`calc init {name} -o inputs.xlsx` writes such a workbook"
    area = sheet.area
    where = sheet.address(area.first_row, area.first_column)
    raise InputError([Fault(f"no row holds the columns 'name' and 'value'; {instead}", str(sheet.file), 1, where)])


@dataclass
class _BookReader:
    """Reads row by row into a document."""

    document: InputsDocument
    model: Model[Any, Any]
    sheet: BookSheet
    columns: dict[str, int]

    def take(self, row: int, cells: tuple[Any, ...]) -> None:
        """Read one row: a value, a remark, or nothing."""
        name_cell, value_cell, unit_cell = (self._cell(cells, column) for column in ("name", "value", "unit"))
        try:
            name = "" if name_cell is None else cell_text(name_cell).strip()
            if name.startswith("#") or value_cell is None or value_cell.value is None:
                return
            if not name:
                self._say(f"{shown(str(value_cell.value))} has no name; write it in the column 'name'", row)
                return
            unit = "" if unit_cell is None else cell_text(unit_cell).strip()
        except ValueError as error:
            self._say(str(error), row, "name" if name_cell is not None and name_cell.data_type == "e" else "unit")
            return
        path, place = self._path(name), self._place(row, "value")
        if path in self.document.places and path[0] not in {"plugin"}:
            first = self.document.places[path][0].rpartition("!")[2]
            self._say(f"{shown(name)} is given twice (first in {first}); write it once", row, "name")
            return
        try:
            value = self._stated(value_cell, "" if unit in PURE or unit in {"-", "–"} else unit, path)
        except ValueError as error:
            self._say(f"{name}: {error}", row)
            value = UNREADABLE
        self.document.overrides.append(place)
        if len(path) == 3 and path[0] == "inputs":
            open_table(self.document, path[1], place)
        put(self.document, path, value, place)

    def take_formulas(self) -> None:
        """Say which values and units are formulas that were never calculated."""
        calculate = "open the workbook in Excel or LibreOffice, let it calculate, and save it"
        read = {
            self.sheet.area.first_column + self.columns[name]: name
            for name in ("name", "value", "unit")
            if name in self.columns
        }
        for row, column in self.sheet.never_calculated():
            if column in read:
                self._say(f"holds a formula whose value was never stored; {calculate}", row, read[column])

    def _cell(self, cells: tuple[Any, ...], column: str) -> Any:
        place = self.columns.get(column)
        return cells[place] if place is not None and place < len(cells) else None

    def _place(self, row: int, column: str) -> str:
        address = self.sheet.address(row, self.sheet.area.first_column + self.columns[column])
        return f"{self.sheet.file}, {address}"

    def _say(self, sentence: str, row: int, column: str = "value") -> None:
        place = self._place(row, column)
        self.document.overrides.append(place)
        self.document.faults.append(Fault(sentence, place))

    def _path(self, name: str) -> KeyPath:
        is_plugin = name == "plugin" and name not in self.model.input_fields
        return ("plugin",) if is_plugin else path_of(name, self.model)

    def _stated(self, cell: Any, unit: str, path: KeyPath) -> Any:
        """Return what TOML would state: "120 N", 0.3, true, a text."""
        value, section = cell.value, path[0]
        field = self.model.input_fields.get(path[1]) if section in {"inputs", "calibrated"} and len(path) > 1 else None
        is_text = section in {"plugin", "sheet", "units", "columns"} or (
            field is not None and field.kind in {"choice", "text"}
        )
        if isinstance(value, (bool, int, float)) and cell.data_type != "e" and not is_text:
            if isinstance(value, bool):
                return value
            number = in_per_cent(cell) if unit == "%" else value
            return f"{number!r} {unit}" if unit else number
        text = f"{cell_text(cell)} {unit}".strip()
        return text if is_text else value_of(path, text, self.model)
