"""Rows of measured files: every column in SI with the part it plays, put in order and joined to one table.

In a file no block stands twice, rows are sorted by time inside each run, angles are in one piece, histories made.
Nothing is done in silence: every function notes what it did, and every fault of a file is told at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from truing.arrays import Indices, Mask, Matrix, first_alike
from truing.declare.fields import Axis
from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.errors import Fault, InputError, UnitError
from truing.inputs_file.values import SIGMA, broken_bound
from truing.kernel import Offer
from truing.measurements import RowsFile
from truing.measurements.csv_text import Faults, RowCount, TableSource
from truing.measurements.derived import TIME, histories
from truing.measurements.table import NOT_NAMED, RUN, WORDS, DataTable, Known, is_number, read_table
from truing.numbers import counted
from truing.setup import NamedColumn, Setup
from truing.units import check_unit, same_dimension
from truing.units.grammar import shown
from truing.units.names import PURE

ColumnRole = Literal["input", "word", "series", "condition", "axis", "measured", "sigma", "other", "label"]
FEW_DEGREES, SWEEPING, MOST_JUMPS = 90.0, 0.95, 0.25
"""An angle sweeps where such a share of its steps is smaller than so many degrees, turns taken out, and where no
larger share of them jumps by a turn."""
FEWEST_IN_BLOCK = 3
"""Fewer rows that repeat earlier ones may be chance where the gauge is coarse."""
BLOCK_AGAIN = "in a block that repeats an earlier one in every cell, times included"
MOST_MISSING = 0.5
"""A condition that is empty in a larger share of the rows is not measured."""


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


def read_data_files(
    paths: Iterable[TableSource], offer: Offer, named: Mapping[str, NamedColumn] = NOT_NAMED
) -> list[DataRows]:
    """Read files for this calculation; ``named`` says what their columns are, by what the files call them.

    Raises InputError with every fault of every file: headers, cells, bounds.
    """
    faults: list[Fault] = []
    files: list[DataRows] = []
    for path in paths:
        try:
            files.append(_read(path, offer, named))
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return files


def _read(path: TableSource, offer: Offer, named: Mapping[str, NamedColumn]) -> DataRows:
    model = offer.model
    table, faults = read_table(path, _known(model), named=named, results=model.measurable)
    columns: dict[str, NDArray[Any]] = {}
    for name, values in table.columns.items():
        if sentence := _unknown_unit(name, table, model):
            faults.add(sentence, table.header_line, name)
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
        notes=table.notes,
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


def tidy(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Return the rows of a file in order."""
    return with_histories(in_one_piece(in_time_order(each_block_once(data)), model), model)


def numbered(labels: NDArray[Any]) -> Indices:
    """Return the number of each label (n,), from 0 in the order they first appear."""
    known: dict[Any, int] = {}
    return np.array([known.setdefault(label, len(known)) for label in labels.tolist()], dtype=np.intp)


def each_block_once(data: DataRows) -> DataRows:
    """Leave out blocks of rows that were written twice: where the clock goes back and the rows that follow are there.

    A block has three rows or more over two times at the least, each equal in every cell, its time included, to the row
    that follows in the earlier block. Single rows that are alike are real repeats of a coarse gauge, and are kept.
    """
    time = _time(data)
    if time is None or not (np.diff(time) < 0).any():
        return data
    cells = (data.runs, *data.columns.values())
    like = first_alike([numbered(cell) if cell.dtype == object else cell for cell in cells])
    is_again = np.zeros(len(data), dtype=bool)
    for start in np.flatnonzero((np.diff(time) < 0) & (like[1:] <= np.arange(len(time) - 1))) + 1:
        first = like[start]
        rows = min(len(data) - start, start - first)
        differ = np.flatnonzero(like[start : start + rows] != like[first : first + rows])
        end = start + (int(differ[0]) if len(differ) else rows)
        if end - start >= FEWEST_IN_BLOCK and np.ptp(time[start:end]) > 0:
            is_again[start:end] = True
    if not is_again.any():
        return data
    again = counted(int(is_again.sum()), "row is", "rows are")
    return data.without(is_again, BLOCK_AGAIN).noted(f"{again} left out: {BLOCK_AGAIN}")


def in_time_order(data: DataRows) -> DataRows:
    """Put runs one after another, by their first time, and sort rows by time inside each; without a time as given."""
    run_of, time = numbered(data.runs), _time(data)
    by_run = np.argsort(run_of, kind="stable")
    if time is None:
        return data.taken(by_run)
    starts = np.full(run_of.max() + 1, np.inf)
    np.fmin.at(starts, run_of, time)
    late = 0  # rows that stand behind a later one of their run
    for part in np.split(time[by_run], np.cumsum(np.bincount(run_of))[:-1]):
        known = part[np.isfinite(part)]
        late += int((known < np.maximum.accumulate(known)).sum())
    sentence = f"{counted(late, 'row was', 'rows were')} out of order and sorted by time inside the run"
    return data.taken(np.lexsort((time, run_of, starts[run_of]))).noted(*[sentence] if late else ())


def _time(data: DataRows) -> Matrix | None:
    """Return the times of the rows where they are known; a result of that name is no clock."""
    if data.parts.get(TIME) in {None, "label", "word", "measured"}:
        return None
    time = data.columns[TIME]
    return time if np.isfinite(time).any() else None


def in_one_piece(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Join angles of inputs and conditions that jump by a turn inside a sweep.

    A run is a sweep if 95 % of its steps are below 90 degrees once it is joined and at most every fourth step jumps.
    An input whose bounds would not hold stays as it is.
    """
    columns, units, notes = dict(data.columns), declared_units(model), []
    runs = np.split(np.arange(len(data)), np.flatnonzero(np.diff(numbered(data.runs))) + 1)
    for name in data.named("input", "series", "condition"):
        if not is_angle(units[name]):
            continue
        joined, jumps = np.array(columns[name]), 0
        for rows in runs:
            joined[rows], more = _joined(joined[rows])
            jumps += more
        if jumps and keeps_bounds(name, joined, model):
            columns[name] = joined
            notes.append(f"'{name}' jumps by a turn at {counted(jumps, 'place')} of a sweep and was joined there")
    return replace(data, columns=columns).noted(*notes)


def _joined(angles: Matrix) -> tuple[Matrix, int]:
    """Return a sweep without its jumps by a turn and their number; anything else as it is."""
    known = np.flatnonzero(np.isfinite(angles))
    steps = np.diff(angles[known])
    jumps = int((np.abs(steps) > np.pi).sum())
    if not 0 < jumps <= MOST_JUMPS * len(steps):
        return angles, 0
    whole = np.array(angles)
    whole[known] = np.unwrap(angles[known])
    small = np.abs(np.diff(whole[known])) < np.radians(FEW_DEGREES)
    return (whole, jumps) if small.mean() >= SWEEPING else (angles, 0)


def keeps_bounds(name: str, values: Matrix, model: Model[Any, Any]) -> bool:
    """Whether values (n,), SI, lie within the bounds of an input; anything else has none."""
    field = model.input_fields.get(name)
    return field is None or not any(broken_bound(field, float(end)) for end in (np.nanmin(values), np.nanmax(values)))


def is_angle(unit: str) -> bool:
    """Whether a unit is one of plane angles."""
    return unit not in PURE and same_dimension(unit, "rad")


def with_histories(data: DataRows, model: Model[Any, Any]) -> DataRows:
    """Make the conditions that are derived from whole runs: what has been, since the first row of the file."""
    numbers = {name: values for name, values in data.columns.items() if is_number(values)}
    made = histories(model.known_conditions.values(), numbers, numbered(data.runs), _time(data))
    parts: dict[str, ColumnRole] = dict.fromkeys(made, "condition")
    return replace(data, columns={**data.columns, **made}, parts={**data.parts, **parts})


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
