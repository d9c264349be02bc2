"""Measured rows as a user has them: files that were written, or a dataframe that stands for one."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from truing.api.notebook import heading, html_table, joined, paragraphs
from truing.api.tables import frame_of, frame_text
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.diagnosis.data_rows import DataRows, read_data_files
from truing.errors import UsageError
from truing.inputs_file import read_setup
from truing.kernel import Offer
from truing.measurements import TableSource, read_table
from truing.measurements.table import NOT_NAMED
from truing.numbers import counted, format_number
from truing.setup import NamedColumn
from truing.units import from_si, unit_text
from truing.units.grammar import shown

PLAYED = {
    "word": "input",
    "series": "input along an axis",
    "sigma": "standard deviation",
    "other": "not declared",
    "label": "text",
}
"""What parts of columns are called, where a user does not call them as we do."""


class HasOffer(Protocol):
    """A model that was loaded."""

    @property
    def offer(self) -> Offer:
        """What it offers."""


@dataclass(frozen=True)
class RecordColumn:
    """A column of a record: what it is to the model, how many values it has, and from where to where in its unit."""

    name: str
    unit: str
    part: str
    values: int
    low: float | None
    high: float | None


@dataclass(frozen=True)
class MeasuredRecord:
    """Measured rows of one machine: one file, or several, or a dataframe.

    ``rows`` counts them; ``columns`` holds, file by file, what each column is to the model.
    """

    files: tuple[TableSource, ...]
    rows: int = 0
    columns: tuple[tuple[RecordColumn, ...], ...] = ()

    def __repr__(self) -> str:
        return f"<Record of {counted(self.rows)}: {', '.join(file.name for file in self.files)}>"

    def frame(self) -> Any:
        """Return the rows of the files as written, one behind another, as a dataframe of texts."""
        columns: dict[str, list[str]] = {}
        count = 0
        for file in self.files:
            table, _ = read_table(file, {}, is_measured=False)
            for name in {**columns, **table.cells}:
                columns.setdefault(name, [""] * count).extend(table.cells.get(name, ("",) * len(table)))
            count += len(table)
        return frame_of(columns)

    def _repr_html_(self) -> str:
        """Show what each column is to the model, and what it holds."""
        shown = []
        for file, columns in zip(self.files, self.columns, strict=False):
            rows = []
            for column in columns:
                ends = ("" if end is None else format_number(end, 5) for end in (column.low, column.high))
                rows.append((column.name, unit_text(column.unit), column.part, column.values, *ends))
            shown += [heading(file.name), html_table(rows, ("column", "unit", "is", "values", "from", "to"))]
        return joined(*shown, paragraphs([f"{counted(self.rows)} measured"]))


def read(files: str | Path | Sequence[str | Path], model: HasOffer, inputs: str | Path | None = None) -> MeasuredRecord:
    """Take measured files as a record of this model: CSV, workbooks, TDMS, MDF, MATLAB or parquet files.

    ``inputs`` is the inputs file whose [columns] says what the columns are, where the files call them otherwise.
    Raises InputError with every fault of every file.
    """
    paths = tuple(Path(file) for file in ([files] if isinstance(files, (str, Path)) else files))
    if not paths:
        raise UsageError("no file is named; a record is one measured file or several")
    if inputs is None:
        return _known(paths, model.offer)
    setup = read_setup(Path(inputs), model.offer)
    return _known(paths, replace(model.offer, model=setup.model), setup.columns)


def record(
    frame: Any, model: HasOffer, *, units: Mapping[str, str] | None = None, name: str = "record"
) -> MeasuredRecord:
    """Take the rows of a dataframe as a record of this model; NaN is a reading that is missing.

    Columns are named as in a file: inputs, results (measured), conditions, ``sigma_NAME``, ``run``, each with its unit
    in the name ("load [N]") or in ``units``. ``name`` is what the sheet calls it. Raises InputError with every fault.
    """
    if Path(name).name != name or not name:
        raise UsageError(f"'{name}' is no name for a record; write a word without a folder")
    return _known((frame_text(frame, units or {}, gaps=True, name=name),), model.offer)


def _known(
    sources: tuple[TableSource, ...], offer: Offer, named: Mapping[str, NamedColumn] = NOT_NAMED
) -> MeasuredRecord:
    files = read_data_files(sources, offer, named)
    columns = tuple(tuple(_columns(file)) for file in files)
    for text in dict.fromkeys(text for each in columns for text in _misspelt(each, offer.model)):
        warnings.warn(text, stacklevel=4)
    return MeasuredRecord(sources, sum(map(len, files)), columns)


def _misspelt(columns: tuple[RecordColumn, ...], declared: Model[Any, Any]) -> Iterator[str]:
    """Say which columns are no word of the model and are called nearly like one that is not measured."""
    names = {column.name for column in columns}
    known = [*declared.measurable, *declared.known_conditions, *declared.input_fields]
    for column in columns:
        hint = near_miss(column.name[:80], [name for name in known if name not in names])
        if column.part in (PLAYED["other"], PLAYED["label"]) and hint:
            yield f"column {shown(column.name)} is neither input, result nor condition.{hint}"


def _columns(rows: DataRows) -> Iterator[RecordColumn]:
    for name, values in rows.columns.items():
        unit, part = rows.units[name], PLAYED.get(rows.parts[name], rows.parts[name])
        if values.dtype == object:
            yield RecordColumn(name, unit, part, sum(value is not None for value in values), None, None)
            continue
        finite = values[np.isfinite(values)]
        low, high = (float(from_si(end, unit)) for end in (finite.min(), finite.max())) if finite.size else (None, None)
        yield RecordColumn(name, unit, part, finite.size, low, high)
