"""Measured files: what their columns are to a model, their first rows, what is wrong with them, and how they run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.model import Model
from truing.diagnosis.data_rows import DataRows, declared_units, part_of, read_data_files, tidy
from truing.errors import Fault, InputError
from truing.inputs_file import setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.inputs_file.values import SIGMA
from truing.measurements.csv_text import ColumnNames, Header, OpenTable, plain_numbers, read_cell
from truing.measurements.table import RUN, Known, opened_table
from truing.setup import NamedColumn
from truing.units import difference_unit, from_si
from truing.units.names import PURE
from truing.workbench.guesses import Column, Guess, Quantity, guesses, of_this_unit
from truing.workbench.preview import Axis, drawn
from truing.workbench.tasks.loaded import loaded, stamp_of, version_of
from truing.workbench.written import changed_text

FIRST_ROWS = 8
"""So many rows are shown from the top of a file."""
MOST_WRONG = 40
"""So many wrong rows of a file are shown; how many more there are is said."""
LONGEST_CELL = 200
ROLES = {"word": "input", "series": "input", "axis": "place along an axis", "label": "other"}


@dataclass(frozen=True)
class OpenFile:
    """A measured file: its headers, the line of every row, what is wrong with it, and what became of its rows.

    ``cells`` are the columns as text; of a file with nothing wrong only those of its beginning, and ``values`` holds
    the columns that are numbers by their places, in the units of their headers, (n,).
    """

    headers: tuple[Header, ...]
    cells: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]
    decimal_comma: bool
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    values: Mapping[int, Matrix]

    def numbers(self, column: int) -> Matrix:
        """Return a column as numbers, NaN for what is none, (n,)."""
        if not self.faults:
            return self.values.get(column, np.full(len(self.lines), np.nan))
        cells = self.cells[column]
        fast = plain_numbers(cells)
        return fast if fast is not None else np.array([_number(cell, self.decimal_comma) for cell in cells])


def _number(cell: str, decimal_comma: bool) -> float:
    try:
        return read_cell(cell, decimal_comma=decimal_comma, may_be_missing_word=True)
    except ValueError:
        return float("nan")


def columns(
    plugin: str,
    file: str,
    folder: str,
    text: str,
    *,
    changes: Sequence[Mapping[str, str]],
    data: Sequence[str],
    root: str,
) -> dict[str, Any]:
    """Return what files hold by what an inputs file says of their columns, and what is wrong with them.

    ``changes`` of what it says come first; the text with them is part of the answer.
    """
    offer = loaded(plugin)
    for change in changes:
        stated = {"name": change["name"], "unit": change["unit"]} if change["unit"] else change["name"]
        literal = toml_value(stated) if change["name"] else None
        text = changed_text(text, ("columns", change["key"]), literal, saved="")
    try:
        named: Mapping[str, NamedColumn] = setup_from_text(text, offer, file=file, folder=Path(folder)).columns
        faults: list[dict[str, Any]] = []
    except InputError as error:
        named, faults = {}, [_fault(fault) for fault in error.faults]
    files = [_of_file(plugin, Path(root) / name, name, dict(named)) for name in data]
    return {"faults": faults, "files": files, "roles": _roles(offer.model), "text": text}


def _of_file(plugin: str, path: Path, name: str, named: dict[str, NamedColumn]) -> dict[str, Any]:
    """Return what one file holds; of one that cannot be read at all, why."""
    model = loaded(plugin).model
    answer: dict[str, Any] = {"name": name, "rows": 0, "columns": [], "first": [], "wrong": [], "faults": []}
    answer |= {"notes": [], "more": 0, "figure": {}}
    try:
        opened = _opened(plugin, path, named)
    except InputError as error:
        return answer | {"faults": [_fault(fault) for fault in error.faults]}
    answer["rows"], answer["notes"] = len(opened.lines), list(opened.notes)
    answer["columns"] = list(_columns(opened, model))
    answer["figure"] = _first_figure(opened, answer["columns"], model)
    answer["first"] = [_row(opened, row) for row in range(min(FIRST_ROWS, len(opened.lines)))]
    return answer | _wrong(opened)


def _opened(plugin: str, path: Path, named: dict[str, NamedColumn]) -> OpenFile:
    return _read(plugin, path, (version_of(plugin), stamp_of(path)), tuple(sorted(named.items())))


@lru_cache(maxsize=4)
def _read(plugin: str, path: Path, stamps: tuple[Any, ...], named: tuple[tuple[str, NamedColumn], ...]) -> OpenFile:
    """Read a file; one that has not changed is read once. ``stamps`` tell it and the calculation from changed ones.

    Raises InputError where it cannot be read at all.
    """
    offer, faults, rows = loaded(plugin), tuple[Fault, ...](), None
    try:
        (rows,) = read_data_files([path], offer, dict(named))
    except InputError as error:
        faults = tuple(error.faults)
    known: dict[str, Known] = {**declared_units(offer.model), **offer.model.input_fields}
    with opened_table(path, ColumnNames(dict(named)), known, offer.model.measurable) as table:
        cells, lines = _texts(table, whole=rows is None)
        headers = table.headers
    if rows is None:
        return OpenFile(headers, cells, lines, table.decimal_comma, faults, (), {})
    values = {place: _as_written(rows, header) for place, header in enumerate(headers) if _is_number(rows, header.name)}
    tidied = tidy(rows, offer.model)
    notes = (tidied.counts[0].sentence(), *tidied.notes)
    return OpenFile(headers, cells, tuple(rows.lines.tolist()), table.decimal_comma, (), notes, values)


def _texts(table: OpenTable, *, whole: bool) -> tuple[tuple[tuple[str, ...], ...], tuple[int, ...]]:
    """Return the columns of a file as text, and the lines of its rows: of all, or of those at its beginning."""
    cells: list[list[str]] = [[] for _ in table.headers]
    lines: list[int] = []
    for chunk, lines_of in table.chunks():
        lines += lines_of
        for column, more in zip(cells, chunk, strict=True):
            column.extend(more)
        if not whole:
            break
    return tuple(map(tuple, cells)), tuple(lines)


def _is_number(rows: DataRows, name: str) -> bool:
    return name in rows.columns and rows.columns[name].dtype != object


def _as_written(rows: DataRows, header: Header) -> Matrix:
    """Return a column in the unit of its header; where nobody knows that, it is as it stands."""
    return from_si(rows.columns[header.name], "" if header.unit in PURE else header.unit or "")


def _columns(opened: OpenFile, model: Model[Any, Any]) -> Iterator[dict[str, Any]]:
    """Give every column: as written, what it is to the model, and what it may be where it is nothing."""
    units, found = _units(model), list[tuple[Header, str, Matrix]]()
    for index, header in enumerate(opened.headers):
        numbers = opened.numbers(index)
        role = RUN if header.name == RUN else part_of(header.name, model, is_number=bool(np.isfinite(numbers).any()))
        found.append((header, ROLES.get(role, role), numbers))
    guessed = _guessed([(header, role) for header, role, _ in found], model)
    own = [quantity for quantity in _quantities(model) if not quantity.name.startswith(SIGMA)]
    for index, (header, role, numbers) in enumerate(found):
        finite, key = numbers[np.isfinite(numbers)], _key(header)
        guess = guessed.get(key)
        yield {
            "index": index, "key": key, "text": header.text, "name": header.name, "role": role,
            "unit": header.unit, "declared": units.get(header.name, ""), "stated": bool(header.key),
            "values": int(finite.size), "low": _end(finite.min()) if finite.size else None,
            "high": _end(finite.max()) if finite.size else None, "guess": guess and asdict(guess),
            "of_this_unit": of_this_unit(_unknown(header), own),
        }  # fmt: skip


def _unknown(header: Header) -> Column:
    return Column(_key(header), header.name or header.text, header.unit)


def _end(value: Any) -> float:
    return float(f"{float(value):.5g}")


def _key(header: Header) -> str:
    """Return what [columns] calls a column."""
    return header.key or header.name or header.text


def _guessed(found: Sequence[tuple[Header, str]], model: Model[Any, Any]) -> dict[str, Guess]:
    """Return what columns may be that are nothing to the model, and the units of those that have none."""
    units, taken = _units(model), {header.name for header, role in found if role != "other"}
    unknown = [_unknown(each) for each, role in found if role == "other"]
    made = guesses(unknown, [quantity for quantity in _quantities(model) if quantity.name not in taken])
    for header, role in found:
        declared = units.get(header.name, "")
        if role not in {"other", RUN} and header.unit is None and declared not in PURE:
            made[_key(header)] = Guess(header.name, declared, 1.0)
    return made


def _units(model: Model[Any, Any]) -> dict[str, str]:
    """Return the declared unit of everything that a column may be, results first."""
    units, declared = declared_units(model), dict[str, str]()
    for name in (*model.measurable, *model.known_conditions, *model.input_fields):
        declared[name] = units[name]
    return declared | {f"{SIGMA}{name}": difference_unit(units[name]) for name in model.measurable}


def _quantities(model: Model[Any, Any]) -> list[Quantity]:
    about = {name: (each.spec.symbol, each.spec.note) for name, each in model.input_fields.items()}
    about |= {name: ("", condition.note) for name, condition in model.known_conditions.items()}
    results = model.own_result_fields
    about |= {name: (results[name].spec.symbol, results[name].spec.note) for name in model.measurable}
    return [Quantity(name, unit, *about.get(name, ("", ""))) for name, unit in _units(model).items()]


def _roles(model: Model[Any, Any]) -> list[dict[str, Any]]:
    """Return what a column may be, in groups, each with unit and note."""
    quantities = {quantity.name: quantity for quantity in _quantities(model)}
    groups = {
        "Conditions": list(model.known_conditions),
        "Measured results": model.measurable,
        "Inputs": list(model.input_fields),
        "Standard deviations": [f"{SIGMA}{name}" for name in model.measurable],
    }
    return [
        {"group": group, "of": [{k: getattr(quantities[name], k) for k in ("name", "unit", "note")} for name in names]}
        for group, names in groups.items()
    ]


def _row(opened: OpenFile, row: int) -> dict[str, Any]:
    return {"line": opened.lines[row], "cells": [column[row][:LONGEST_CELL] for column in opened.cells]}


def _wrong(opened: OpenFile) -> dict[str, Any]:
    """Return the rows that are wrong, each with its reasons and the columns they name; and faults of the whole file."""
    place, faults = {line: row for row, line in enumerate(opened.lines)}, opened.faults
    by_line: dict[int, list[Fault]] = {}
    others = [fault for fault in faults if fault.line is None or fault.line not in place]
    for fault in faults:
        if fault.line in place and fault.line is not None:
            by_line.setdefault(fault.line, []).append(fault)
    lines = list(by_line)[:MOST_WRONG]
    wrong = []
    for line in lines:
        reasons = [fault.message for fault in by_line[line]]
        bad = [i for i, header in enumerate(opened.headers) if header.name and _names(header.name, reasons)]
        wrong.append({**_row(opened, place[line]), "reasons": reasons, "bad": bad})
    return {"wrong": wrong, "more": len(by_line) - len(lines), "faults": [_fault(fault) for fault in others]}


def _names(name: str, reasons: Sequence[str]) -> bool:
    return any(reason.startswith((f"{name}:", f"{name} is")) for reason in reasons)


def _fault(fault: Fault) -> dict[str, Any]:
    return {**asdict(fault), "file": Path(fault.file).name}


def figure(
    plugin: str, file: str, folder: str, text: str, *, root: str, data: str, shown: int, over: int
) -> dict[str, str]:  # fmt: skip
    """Return a column of a file over another one (-1: over its rows) as SVG; wrong rows in red."""
    offer, path = loaded(plugin), Path(root) / data
    try:
        named = dict(setup_from_text(text, offer, file=file, folder=Path(folder)).columns)
    except InputError:
        named = {}
    opened = _opened(plugin, path, named)
    return {"svg": _drawn(opened, shown, over)}


def _drawn(opened: OpenFile, shown: int, over: int) -> str:
    wrong = {fault.line for fault in opened.faults}
    rows = np.array([row for row, line in enumerate(opened.lines) if line in wrong] if wrong else [], dtype=np.intp)
    y = Axis(opened.headers[shown].text, opened.numbers(shown))
    x = opened.numbers(over) if over >= 0 else np.arange(1.0, len(opened.lines) + 1)
    return drawn(Axis(opened.headers[over].text if over >= 0 else "row", x), y, rows)


def _first_figure(opened: OpenFile, known: Sequence[Mapping[str, Any]], model: Model[Any, Any]) -> dict[str, Any]:
    """Return the figure that is shown before another one is chosen: a measured result over the rows."""
    numeric = [column for column in known if column["values"] > 1]
    if not numeric:
        return {}
    results = set(model.measurable)
    measured = [each for each in numeric if each["name"] in results or (each["guess"] or {}).get("name") in results]
    shown = (measured[:1] or numeric[-1:])[0]["index"]
    return {"shown": shown, "over": -1, "svg": _drawn(opened, shown, -1)}
