"""Files of one machine joined to one table; what was not measured, and rows in which something is missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from truing.diagnosis.data_file import DataFile, Part, objects
from truing.diagnosis.tidying import counted
from truing.errors import Fault, InputError
from truing.measurements import RowCount, RowsFile
from truing.setup import Setup
from truing.units import same_dimension
from truing.units.grammar import shown
from truing.units.names import PURE

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_MISSING = 0.5
"""A condition that is empty in a larger share of the rows is not measured."""


@dataclass(frozen=True)
class Joined:
    """All rows: ``data`` as one file whose runs are unique, the number of the file of each row, and its files.

    ``counts`` says of each file how many rows it holds, with those left out. ``absent`` names the conditions that are
    not measured.
    """

    data: DataFile
    file_of: NDArray[np.intp]
    files: tuple[str, ...]
    counts: tuple[RowCount, ...]
    absent: frozenset[str] = frozenset()

    def __len__(self) -> int:
        return len(self.data)

    def taken(self, rows: NDArray[Any]) -> Joined:
        """Return some of the rows, in this order."""
        return replace(self, data=self.data.taken(rows), file_of=self.file_of[rows])

    def without(self, rows: NDArray[np.bool_], reason: str) -> Joined:
        """Leave out the rows that a mask names, for a reason that the counts keep."""
        lines = [self.data.lines[rows & (self.file_of == place)].tolist() for place in range(len(self.counts))]
        counts = tuple(count.without(reason, taken) for count, taken in zip(self.counts, lines, strict=True))
        return replace(self.taken(~rows), counts=counts)

    def place(self, row: int) -> str:
        """Return "FILE:LINE" of a row."""
        return f"{self.files[int(self.file_of[row])]}:{int(self.data.lines[row])}"


def join(files: Sequence[DataFile], setup: Setup) -> Joined:
    """Put files one behind another. Raises InputError where they cannot be rows of one table.

    An input that a file does not give is as the inputs file says; anything else is missing in its rows.
    """
    faults = [*_contradictions(files)]
    if faults:
        raise InputError(faults)
    parts = _parts(files)
    units = {name: unit for file in reversed(files) for name, unit in file.units.items()}
    columns = {
        name: np.concatenate([_cells(file, name, part, setup) for file in files]) for name, part in parts.items()
    }
    data = DataFile(
        file=files[0].file if len(files) == 1 else ", ".join(file.file for file in files),
        columns=columns,
        parts=parts,
        units=units,
        lines=np.concatenate([file.lines for file in files]),
        runs=np.concatenate([_runs(file, alone=len(files) == 1) for file in files]),
    )
    file_of = np.repeat(np.arange(len(files)), [len(file) for file in files])
    return Joined(data, file_of, tuple(file.file for file in files), tuple(file.count for file in files))


def _contradictions(files: Sequence[DataFile]) -> Iterator[Fault]:
    """Say which columns differ so much between files that they cannot be one."""
    first: dict[str, DataFile] = {}
    for file in files:
        for name, part in file.parts.items():
            before = first.setdefault(name, file)
            units = before.units.get(name, ""), file.units.get(name, "")
            is_number = part == before.parts[name] == "other"
            if is_number and not same_dimension(*("" if unit in PURE else unit for unit in units)):
                words = f"column {shown(name)} is in [{units[1]}], but in [{units[0]}] in {before.file}"
                yield Fault(f"{words}; give both the same kind of unit", file.file)
    for name in {name for file in files for name in file.named("series")}:
        for file in files:
            if name not in file.columns:
                yield Fault(f"has no column '{name}', but another file has; a record needs the whole series", file.file)


def _parts(files: Sequence[DataFile]) -> dict[str, Part]:
    """Return the part of every column; what holds words in one file is words in all."""
    parts: dict[str, Part] = {}
    for file in files:
        for name, part in file.parts.items():
            parts[name] = "label" if "label" in {part, parts.get(name)} else part
    return parts


def _cells(file: DataFile, name: str, part: Part, setup: Setup) -> NDArray[Any]:
    """Return a column of a file, as it is filled up where the file has none."""
    values = file.columns.get(name)
    if values is not None and (part != "label" or values.dtype == object):
        return values
    if part in {"label", "word"}:
        texts = [""] * len(file) if values is None else [f"{value:.12g}" for value in values.tolist()]
        return objects([setup.nominal(name)] * len(file) if part == "word" else texts)
    value = setup.calibrated.get(name, setup.nominal(name)) if part == "input" else np.nan
    return np.full(len(file), float(value))


def _runs(file: DataFile, *, alone: bool) -> NDArray[Any]:
    """Return the runs of a file, told apart from those of other files."""
    if alone:
        return file.runs
    return objects(f"{file.file}: {run}" if run else file.file for run in file.runs.tolist())


def settle_conditions(joined: Joined, files: Sequence[DataFile], setup: Setup) -> tuple[Joined, list[str]]:
    """Decide which conditions are measured; one that the inputs file states is the same in all rows.

    A condition that a file does not give, or that is empty in most rows, counts as not measured.
    """
    columns, parts = dict(joined.data.columns), dict(joined.data.parts)
    absent: set[str] = set()
    notes: list[str] = []
    for name, condition in setup.model.known_conditions.items():
        if name in columns:
            why = _unmeasured(name, joined, files)
            if not why:
                continue
            del columns[name], parts[name]
            notes.append(why)
        value = setup.conditions.get(name, condition.zero)
        if name in setup.stated and value != condition.zero:
            columns[name], parts[name] = np.full(len(joined), value), "condition"
            notes.append(f"'{name}' is not measured and taken as the inputs file states it, the same in all rows")
        else:
            absent.add(name)
    if absent:
        listed = ", ".join(f"'{name}'" for name in absent_in_order(absent, setup))
        notes.append(f"not measured: {listed}; what depends on it cannot be seen")
    data = replace(joined.data, columns=columns, parts=parts)
    return replace(joined, data=data, absent=frozenset(absent)), notes


def absent_in_order(absent: set[str], setup: Setup) -> list[str]:
    """Return names of conditions in the order of their declaration."""
    return [name for name in setup.model.known_conditions if name in absent]


def _unmeasured(name: str, joined: Joined, files: Sequence[DataFile]) -> str:
    """Say why the column of a condition does not measure it, or nothing."""
    lacking = [file.file for file in files if name not in file.columns]
    if lacking:
        return f"'{name}' is not in {', '.join(lacking)}, so it counts as not measured"
    missing = int(np.isnan(joined.data.columns[name]).sum())
    if missing > MOST_MISSING * len(joined):
        return f"'{name}' is empty in {missing} of {len(joined)} rows, so it counts as not measured"
    return ""


def complete_rows(joined: Joined, setup: Setup) -> tuple[Joined, list[str]]:
    """Leave out rows in which an input or a condition is missing, or in which nothing was measured.

    Rows of a record (a series along an axis) stay, whatever was measured in them: they are its history.
    """
    notes: list[str] = []
    for name in joined.data.named("input", "word", "series", "condition"):
        item = setup.model.input_fields.get(name)
        missing = _is_missing(joined.data.columns[name])
        if missing.any() and not (item is not None and item.is_optional):
            joined = joined.without(missing, f"'{name}' is empty")
            notes.append(f"{counted(int(missing.sum()), 'row is', 'rows are')} left out where '{name}' is empty")
    joined, left = measured_rows(joined)
    if left.any():
        notes.append(f"{counted(int(left.sum()), 'row is', 'rows are')} left out where nothing was measured")
    for name in joined.data.named("measured"):
        missing = np.isnan(joined.data.columns[name])
        if missing.any():
            notes.append(f"'{name}' is missing in {int(missing.sum())} of {len(joined)} rows")
    return joined, notes


def measured_rows(joined: Joined) -> tuple[Joined, NDArray[np.bool_]]:
    """Leave out rows in which nothing that is used was measured, and say which; the rows of a record stay."""
    data = joined.data
    nothing = np.full(len(joined), not data.named("series"))
    for name in data.named("measured"):
        nothing &= np.isnan(data.columns[name])
    return (joined.without(nothing, "nothing was measured that is used") if nothing.any() else joined), nothing


def _is_missing(values: NDArray[Any]) -> NDArray[np.bool_]:
    if values.dtype == object:
        return np.array([value is None for value in values.tolist()], dtype=bool)
    missing: NDArray[np.bool_] = np.isnan(values)
    return missing


def rows_of(joined: Joined) -> RowsFile:
    """Return the rows as the model is evaluated with them."""
    data = joined.data

    def of(*parts: Part) -> Mapping[str, NDArray[Any]]:
        return {name: data.columns[name] for name in data.named(*parts)}

    words = {name: values.tolist() for name, values in of("word").items()}
    return RowsFile(
        file=data.file,
        columns={**of("input", "condition"), **words},
        series=of("series"),
        cells={},
        lines=tuple(data.lines.tolist()),
        others=tuple(data.named("other", "label")),
        axes=of("axis"),
        runs=tuple(data.runs.tolist()),
    )
