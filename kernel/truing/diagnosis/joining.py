"""Files of one machine joined to one table; what was not measured, and rows in which something is missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.diagnosis.data_file import ColumnRole, DataRows, is_missing, objects
from truing.errors import Fault, InputError
from truing.measurements import RowsFile
from truing.numbers import counted
from truing.setup import Setup
from truing.units import same_dimension
from truing.units.grammar import shown
from truing.units.names import PURE

MOST_MISSING = 0.5
"""A condition that is empty in a larger share of the rows is not measured."""


def join(files: Sequence[DataRows], setup: Setup) -> DataRows:
    """Put files one behind another. Raises InputError where they cannot be rows of one table.

    An input that a file does not give is as the inputs file says; anything else is missing in its rows.
    """
    if faults := list(_contradictions(files)):
        raise InputError(faults)
    parts = _parts(files)
    return DataRows(
        files=tuple(name for file in files for name in file.files),
        columns={name: np.concatenate([_cells(file, name, parts[name], setup) for file in files]) for name in parts},
        parts=parts,
        units={name: unit for file in reversed(files) for name, unit in file.units.items()},
        file_of=np.repeat(np.arange(len(files)), [len(file) for file in files]),
        lines=np.concatenate([file.lines for file in files]),
        runs=np.concatenate([file.runs for file in files]),
        held_out=np.concatenate([file.held_out for file in files]),
        counts=tuple(count for file in files for count in file.counts),
        notes=tuple(note for file in files for note in file.notes),
    )


def _contradictions(files: Sequence[DataRows]) -> Iterator[Fault]:
    """Say which columns differ so much between files that they cannot be one."""
    first: dict[str, DataRows] = {}
    for file in files:
        for name, part in file.parts.items():
            before = first.setdefault(name, file)
            units = before.units.get(name, ""), file.units.get(name, "")
            is_number = part == before.parts[name] == "other"
            if is_number and not same_dimension(*("" if unit in PURE else unit for unit in units)):
                words = f"column {shown(name)} is in [{units[1]}], but in [{units[0]}] in {before.files[0]}"
                yield Fault(f"{words}; give both the same kind of unit", file.files[0])
    for name in {name for file in files for name in file.named("series")}:
        for file in files:
            if name not in file.columns:
                words = f"has no column '{name}', but another file has; a record needs the whole series"
                yield Fault(words, file.files[0])


def _parts(files: Sequence[DataRows]) -> dict[str, ColumnRole]:
    """Return the part of every column; what holds words in one file is words in all."""
    parts: dict[str, ColumnRole] = {}
    for file in files:
        for name, part in file.parts.items():
            parts[name] = "label" if "label" in {part, parts.get(name)} else part
    return parts


def _cells(file: DataRows, name: str, part: ColumnRole, setup: Setup) -> NDArray[Any]:
    """Return a column of a file, as it is filled up where the file has none."""
    values = file.columns.get(name)
    if values is not None and (part != "label" or values.dtype == object):
        return values
    if part in {"label", "word"}:
        texts = [""] * len(file) if values is None else [f"{value:.12g}" for value in values.tolist()]
        return objects([setup.nominal(name)] * len(file) if part == "word" else texts)
    value = setup.calibrated.get(name, setup.nominal(name)) if part == "input" else np.nan
    return np.full(len(file), float(value))


def settle_conditions(joined: DataRows, files: Sequence[DataRows], setup: Setup) -> DataRows:
    """Decide which conditions are measured; one that the inputs file states is the same in all rows.

    A condition that a file does not give, or that is empty in most rows, counts as not measured.
    """
    columns, parts = dict(joined.columns), dict(joined.parts)
    absent: list[str] = []
    notes: list[str] = []
    for name, condition in setup.model.known_conditions.items():
        if name in columns:
            why = _unmeasured(name, joined, files)
            if not why:
                continue
            del columns[name], parts[name]
            notes.append(why)
        value = setup.conditions.get(name, condition.zero)
        if name in setup.source.stated and value != condition.zero:
            columns[name], parts[name] = np.full(len(joined), value), "condition"
            notes.append(f"'{name}' is not measured and taken as the inputs file states it, the same in all rows")
        else:
            absent.append(name)
    if absent:
        listed = ", ".join(f"'{name}'" for name in absent)
        notes.append(f"not measured: {listed}; what depends on it cannot be seen")
    return replace(joined, columns=columns, parts=parts, absent=frozenset(absent)).noted(*notes)


def _unmeasured(name: str, joined: DataRows, files: Sequence[DataRows]) -> str:
    """Say why the column of a condition does not measure it, or nothing."""
    lacking = [file.files[0] for file in files if name not in file.columns]
    if lacking:
        return f"'{name}' is not in {', '.join(lacking)}, so it counts as not measured"
    missing = int(np.isnan(joined.columns[name]).sum())
    if missing > MOST_MISSING * len(joined):
        return f"'{name}' is empty in {missing} of {len(joined)} rows, so it counts as not measured"
    return ""


def complete_rows(joined: DataRows, setup: Setup) -> DataRows:
    """Leave out rows in which an input or a condition is missing, or in which nothing was measured.

    Rows of a record (a series along an axis) stay, whatever was measured in them: they are its history.
    """
    notes: list[str] = []
    for name in joined.named("input", "word", "series", "condition"):
        field = setup.model.input_fields.get(name)
        empty = is_missing(joined.columns[name])
        if empty.any() and not (field is not None and field.is_optional):
            joined = joined.without(empty, f"'{name}' is empty")
            notes.append(f"{counted(int(empty.sum()), 'row is', 'rows are')} left out where '{name}' is empty")
    before, joined = len(joined), measured_rows(joined)
    if len(joined) < before:
        notes.append(f"{counted(before - len(joined), 'row is', 'rows are')} left out where nothing was measured")
    for name, values in joined.named("measured").items():
        if missing := int(np.isnan(values).sum()):
            notes.append(f"'{name}' is missing in {missing} of {len(joined)} rows")
    return joined.noted(*notes)


def measured_rows(joined: DataRows) -> DataRows:
    """Leave out rows in which nothing that is used was measured; the rows of a record stay."""
    nothing = np.full(len(joined), not joined.named("series"))
    for values in joined.named("measured").values():
        nothing &= np.isnan(values)
    return joined.without(nothing, "nothing was measured that is used") if nothing.any() else joined


def rows_of(joined: DataRows) -> RowsFile:
    """Return the rows as the model is evaluated with them."""
    words = {name: values.tolist() for name, values in joined.named("word").items()}
    return RowsFile(
        file=", ".join(joined.files),
        columns={**joined.named("input", "condition"), **words},
        series=joined.named("series"),
        cells={},
        lines=tuple(joined.lines.tolist()),
        others=tuple(joined.named("other", "label")),
        axes=joined.named("axis"),
        runs=tuple(joined.runs.tolist()),
    )
