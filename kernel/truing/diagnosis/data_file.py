"""Files of measurements: every column in SI with the part it plays, and every fault of a file at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Indices, Mask, Matrix
from truing.declare.fields import Axis
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import Fault, InputError, UnitError
from truing.kernel import Offer
from truing.measurements.csv_text import Faults, RowCount, TableSource
from truing.measurements.table import RUN, SIGMA, WORDS, DataTable, Known, is_number, read_table
from truing.units import check_unit
from truing.units.grammar import shown

ColumnRole = Literal["input", "word", "series", "condition", "axis", "measured", "sigma", "other", "label"]


@dataclass(frozen=True)
class DataRows:
    """Rows of files, one behind another: columns by name, shape (n,), in SI, NaN (words: None) where a cell is empty.

    ``parts`` says what each column is; words and labels are arrays of objects. ``units`` are those of the headers.
    ``file_of`` and ``lines`` say where each row stands, ``counts`` how many rows each file holds, with those left out;
    ``runs`` of several files are unique. ``notes`` says what was done, one sentence each. ``absent`` names the
    conditions that are not measured, ``answers`` holds what the model says by result, SI, and ``held_out`` marks the
    rows that only judge.
    """

    files: tuple[str, ...]
    columns: Mapping[str, NDArray[Any]]
    parts: Mapping[str, ColumnRole]
    units: Mapping[str, str]
    file_of: Indices
    lines: Indices
    runs: NDArray[Any]
    held_out: Mask
    counts: tuple[RowCount, ...]
    notes: tuple[str, ...] = ()
    absent: frozenset[str] = frozenset()
    answers: Mapping[str, Matrix] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.lines)

    def named(self, *parts: ColumnRole) -> dict[str, NDArray[Any]]:
        """Return the columns that play one of these parts, by name."""
        return {name: values for name, values in self.columns.items() if self.parts[name] in parts}

    def noted(self, *sentences: str) -> DataRows:
        """Return the same rows with more that was done to them."""
        return replace(self, notes=(*self.notes, *sentences))

    def taken(self, rows: NDArray[Any]) -> DataRows:
        """Return some of the rows, in this order."""
        return replace(
            self,
            columns={name: values[rows] for name, values in self.columns.items()},
            file_of=self.file_of[rows],
            lines=self.lines[rows],
            runs=self.runs[rows],
            held_out=self.held_out[rows],
            answers={name: values[rows] for name, values in self.answers.items()},
        )

    def without(self, rows: Mask, reason: str | Mapping[int, str]) -> DataRows:
        """Leave out the rows that a mask names, for a reason that the counts keep: one for all, or one by row."""
        lines: list[dict[str, list[int]]] = [{} for _ in self.counts]
        for row in np.flatnonzero(rows).tolist():
            why = reason if isinstance(reason, str) else reason[row]
            lines[int(self.file_of[row])].setdefault(why, []).append(int(self.lines[row]))
        counts = tuple(count.without_all(taken) for count, taken in zip(self.counts, lines, strict=True))
        return replace(self.taken(~rows), counts=counts)


def read_data_files(paths: Iterable[TableSource], offer: Offer) -> list[DataRows]:
    """Read files for this calculation. Raises InputError with every fault of every file: headers, cells, bounds."""
    faults: list[Fault] = []
    files: list[DataRows] = []
    for path in paths:
        try:
            files.append(_read(path, offer))
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return files


def _read(path: TableSource, offer: Offer) -> DataRows:
    model = offer.model
    table, faults = read_table(path, _known(model))
    columns: dict[str, NDArray[Any]] = {}
    for name, values in table.columns.items():
        if sentence := _unknown_unit(name, table, model):
            faults.add(sentence, table.header_line)
        elif name != RUN or name in model.input_fields:
            columns[name] = objects(values) if isinstance(values, tuple) else values
    parts = {name: part_of(name, model, is_number=values.dtype != object) for name, values in columns.items()}
    for sentence in (*_unfit(table, model), *_empty(columns, parts, faults)):
        faults.add(sentence, table.header_line)
    if not set(table.units) & set(model.measurable):
        faults.add(_nothing_measured(table, model), table.header_line)
    faults.raise_any()
    runs = table.columns.get(RUN, ()) if RUN not in model.input_fields else ()
    return DataRows(
        files=(str(path),),
        columns=columns,
        parts=parts,
        units={name: table.units[name] for name in columns},
        file_of=np.zeros(len(table), dtype=np.intp),
        lines=np.array(table.lines, dtype=np.intp),
        runs=objects(runs if isinstance(runs, tuple) and runs else ("",) * len(table)),
        held_out=np.zeros(len(table), dtype=bool),
        counts=(table.count,),
    )


def objects(values: Iterable[Any]) -> NDArray[Any]:
    """Return words, or whatever else, as an array (n,)."""
    return np.fromiter(values, dtype=object)


def is_missing(values: NDArray[Any]) -> Mask:
    """Mark the cells that are empty, (n,)."""
    if values.dtype == object:
        return np.array([value is None for value in values.tolist()], dtype=bool)
    return np.asarray(np.isnan(values))


def part_of(name: str, model: Model[Any, Any], *, is_number: bool = True) -> ColumnRole:
    """Return the part that a column of this name plays."""
    input_field = model.input_fields.get(name)
    if input_field is not None:
        return "word" if input_field.kind in WORDS else "series" if input_field.kind == "series" else "input"
    if name in model.known_conditions:
        return "condition"
    if name in model.own_result_fields:
        return "axis" if isinstance(model.own_result_fields[name].spec, Axis) else "measured"
    if name.startswith(SIGMA) and name.removeprefix(SIGMA) in model.measurable:
        return "sigma"
    return "other" if is_number else "label"


def declared_units(model: Model[Any, Any]) -> dict[str, str]:
    """Return the declared unit of every column that is known by name."""
    conditions = model.known_conditions.values()
    sources = {
        condition.made_from: condition.unit
        for condition in conditions
        if condition.derived and condition.history != "direction"
    }
    results = {name: result.unit for name, result in model.own_result_fields.items()}
    inputs = {name: input_field.unit for name, input_field in model.input_fields.items()}
    return sources | results | {condition.name: condition.unit for condition in conditions} | inputs


def _known(model: Model[Any, Any]) -> dict[str, Known]:
    return {**declared_units(model), **model.input_fields}


def _unknown_unit(name: str, table: DataTable, model: Model[Any, Any]) -> str:
    """Say which column of numbers, declared by nobody, has a unit that nobody knows."""
    if part_of(name, model, is_number=is_number(table.columns[name])) != "other":
        return ""
    try:
        check_unit(table.units[name])
    except UnitError as error:
        return f"column {shown(name)}: {error}; leave the brackets out where a number has no unit"
    return ""


def _unfit(table: DataTable, model: Model[Any, Any]) -> Iterator[str]:
    """Say which columns cannot be measured in rows, or need the place of their rows."""
    for name in table.columns:
        result = model.own_result_fields.get(name)
        if result is not None and not isinstance(result.spec, Axis) and name not in model.measurable:
            yield f"{name} is a column of a table that the calculation makes; it cannot be compared row by row"
        axis = model.own_result_fields.get(model.axes[name]) if name in model.measurable else None
        if axis is not None and axis.name not in table.columns:
            like = f"{axis.name} [{axis.unit}]" if axis.unit else axis.name
            yield f"{name} runs along '{axis.name}'; give the place of each row in a column '{like}'"


def _empty(columns: Mapping[str, NDArray[Any]], parts: Mapping[str, ColumnRole], faults: Faults) -> Iterator[str]:
    """Say which columns that must hold something hold nothing, not even what cannot be read."""
    needed = {"measured", "input", "series", "word", "axis"}
    for name, values in columns.items():
        is_empty = parts[name] in needed and len(values) > 0 and is_missing(values).all()
        if is_empty and not any(fault.message.startswith(f"{name}:") for fault in faults.found):
            yield f"column '{name}' holds no value in any row; fill it or leave it out"


def _nothing_measured(table: DataTable, model: Model[Any, Any]) -> str:
    results = model.measurable
    listed = ", ".join(f"{name} [{model.own_result_fields[name].unit or '1'}]" for name in results[:12])
    more = f" and {len(results) - 12} more" if len(results) > 12 else ""
    near = next((hint for name in table.units if (hint := near_miss(name[:80], results))), "")
    return f"no column is a result of {model.name}, so nothing is measured; it could be {listed}{more}.{near}"
