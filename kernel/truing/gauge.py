"""What the gauge would show: the results of one machine at every row of a file, readings included."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from truing.declare.fields import Axis
from truing.errors import UsageError
from truing.evaluate import Rows, effect_column, evaluate_rows
from truing.setup import Setup

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from truing.measurements import RowsFile


@dataclass(frozen=True)
class Shown:
    """Results by name in the unit they are printed in, shape (rows,), NaN where there is none; why, by row."""

    values: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str]
    reasons: Mapping[int, str]


def one_machine(setup: Setup) -> Setup:
    """Return the setup of this one machine: its calibrated inputs in place, nothing drawn."""
    return setup.changed(setup.calibrated)


def shown_by_gauge(setup: Setup, rows: RowsFile) -> Shown:
    """Evaluate every row of a file and return the results in the units they are printed in.

    The machine is calibrated; its readings act. What lies nowhere on the axis of a result keeps the reason.
    """
    from truing.units import from_si

    machine = one_machine(setup)
    evaluated = read_by_gauge(machine, rows)
    if not evaluated.results:
        axes = sorted({item.along for item in machine.model.own_result_fields.values() if item.along})
        raise UsageError(f"every result of {machine.model.name} runs along {' or '.join(axes)}: give that column")
    units = {name: machine.print_unit(name) for name in evaluated.results}
    values = {name: from_si(value, units[name]) for name, value in evaluated.results.items()}
    reasons = {**without_place(evaluated, machine, rows), **_lacking(evaluated), **evaluated.reasons}
    return Shown(values, units, dict(sorted(reasons.items())))


def _lacking(evaluated: Rows) -> dict[int, str]:
    """Say which results a row lacks, and why."""
    said: dict[int, dict[str, list[str]]] = {}
    for name, lacking in evaluated.absent.items():
        for row, reason in lacking.items():
            said.setdefault(row, {}).setdefault(reason, []).append(name)
    return {row: "; ".join(f"no {', '.join(names)}: {why}" for why, names in of.items()) for row, of in said.items()}


def read_by_gauge(machine: Setup, rows: RowsFile, wanted: Collection[str] | None = None, repeats: int = 0) -> Rows:
    """Evaluate every row: its columns replace inputs and conditions, readings act; one value (n,) per result, SI.

    A result along an axis is read at the row's place on it (linear between points, NaN beyond its ends); without such a
    column it is left out. An axis that follows an input series is calculated just at the places of the rows. Where
    inputs run along an axis, the rows of one run are one record and one evaluation; else all rows are. Only ``wanted``
    results are returned (all by default), and a row that lacks one of them fails. Conditions that no effect needs are
    not looked at. ``machine`` is taken as it is: see ``one_machine``. ``repeats``: see ``evaluate_rows``.
    """
    columns = seen_columns(machine, rows)
    names = [name for name in _readable(machine, rows) if wanted is None or name in wanted]
    machine = _at_places(machine, rows)
    if rows.series:
        found = _by_records(machine, rows, columns, names)
    else:
        found = _row_by_row(machine, rows, columns, names, repeats)
    return found if wanted is None else found.complete()


def seen_columns(machine: Setup, rows: RowsFile) -> dict[str, Any]:
    """Return the columns that the model or an effect that is on looks at."""
    seen = {need.name for item in machine.effects for need in item.effect.needs}
    seen |= {effect_column(item.effect.name, one.name) for item in machine.effects for one in item.effect.unknowns}
    fields = machine.model.input_fields
    return {name: values for name, values in rows.columns.items() if name in fields or name in seen}


def _at_places(machine: Setup, rows: RowsFile) -> Setup:
    """Put the places of the rows into the input series that an axis follows, unless a column holds that series."""
    import numpy as np

    changes: dict[str, Any] = {}
    for name, item in machine.model.own_result_fields.items():
        series = item.spec.follows if isinstance(item.spec, Axis) else ""
        if series and series not in rows.series and name in rows.axes:
            places = np.unique(rows.axes[name][np.isfinite(rows.axes[name])])
            changes |= {series: places} if len(places) else {}
    return machine.changed(changes) if changes else machine


def without_place(evaluated: Rows, machine: Setup, rows: RowsFile) -> dict[int, str]:
    """Say which rows lie nowhere on the axis of a result, so that nothing can be read there."""
    import numpy as np

    reasons: dict[int, str] = {}
    for name, values in evaluated.results.items():
        axis = _axis_of(name, machine)
        for place in np.flatnonzero(np.isnan(values)) if axis else ():
            is_empty = np.isnan(rows.axes[axis][place])
            words = f"'{axis}' is not given" if is_empty else f"it lies beyond the axis '{axis}'"
            reasons.setdefault(int(place), f"'{name}' cannot be read at this row: {words}")
    return reasons


def _row_by_row(machine: Setup, rows: RowsFile, columns: Mapping[str, Any], names: Sequence[str], repeats: int) -> Rows:
    wanted = _asked(names, machine)
    found = evaluate_rows(machine, columns, len(rows), reading=True, wanted=wanted, repeats=repeats)
    places = range(len(rows))
    values = {name: _placed(name, found, machine, rows, places) for name in names}
    return Rows(values, found.failed, found.reasons, found.absent)


def _by_records(machine: Setup, rows: RowsFile, columns: Mapping[str, Any], names: Sequence[str]) -> Rows:
    """Evaluate each run once, with its columns as series; every row reads the record at its own place.

    Where a condition changes within a run, the record is evaluated under the condition of each of its rows.
    """
    import numpy as np

    values = {name: np.full(len(rows), np.nan) for name in names}
    asked = _asked(names, machine)
    reasons: dict[int, str] = {}
    absent: dict[str, dict[int, str]] = {}
    for record in _records(rows):
        for places in _alike(record, machine, columns, rows):
            one = {name: _one_value(name, column, places, rows) for name, column in columns.items()}
            one |= {name: column[record] for name, column in rows.series.items()}
            found = evaluate_rows(machine, one, 1, reading=True, wanted=asked)
            for name in names:
                values[name][places] = _placed(name, found, machine, rows, places)
            if found.failed[0]:
                reasons |= dict.fromkeys(places, found.reasons[0])
            for name, lacking in found.absent.items():
                absent.setdefault(name, {}).update(dict.fromkeys(places, lacking[0]))
    failed = np.zeros(len(rows), dtype=bool)
    failed[list(reasons)] = True
    return Rows(values, failed, dict(sorted(reasons.items())), absent)


def _records(rows: RowsFile) -> Iterator[list[int]]:
    """Give the rows of each run; without a column "run" the file is one."""
    yield from _places_by_run(rows.runs or ("",) * len(rows))


@lru_cache(maxsize=8)
def _places_by_run(runs: tuple[str, ...]) -> tuple[list[int], ...]:
    """Return the places of the rows of each run; a fit asks for the same ones again and again."""
    found: dict[str, list[int]] = {}
    for place, name in enumerate(runs):
        found.setdefault(name, []).append(place)
    return tuple(found.values())


def _alike(record: list[int], machine: Setup, columns: Mapping[str, Any], rows: RowsFile) -> Iterator[list[int]]:
    """Give the rows of a record that share their conditions."""
    conditions = [columns[name] for name in columns if name not in machine.model.input_fields]
    conditions = [column for column in conditions if _varies(column, record)]
    if not conditions:
        yield record
        return
    found: dict[tuple[float, ...], list[int]] = {}
    for place in record:
        found.setdefault(tuple(float(column[place]) for column in conditions), []).append(place)
    yield from found.values()


def _varies(column: Any, places: Sequence[int]) -> bool:
    """Whether an array has more than one value at these places; NaN is a value of its own."""
    import numpy as np

    is_broadcast = isinstance(column, np.ndarray) and column.strides == (0,)
    values = np.asarray(column)[[places[0]] if is_broadcast else list(places)]
    return bool(np.any(values != values[0]))


def _one_value(name: str, column: Any, places: Sequence[int], rows: RowsFile) -> Any:
    """Return the one value that a column has within a record."""
    import numpy as np

    if isinstance(column, np.ndarray) and not _varies(column, places):
        return float(column[places[0]])
    for place in places:
        if column[place] != column[places[0]]:
            line = rows.lines[place]
            raise UsageError(f"{rows.file}:{line}: {name} changes within a run, but a record is one calculation")
    return column[places[0]] if isinstance(column[places[0]], (str, bool, int)) else float(column[places[0]])


def _readable(machine: Setup, rows: RowsFile) -> Iterator[str]:
    """Give the results that have one value per row, or are read at the row's place on their axis."""
    for name in machine.model.own_result_fields:
        axis = _axis_of(name, machine)
        if not axis or (axis in rows.axes and axis != name):
            yield name


def runs_along_axis(machine: Setup, names: Collection[str]) -> bool:
    """Whether one of these results runs along an axis, so that one calculation answers for many rows."""
    return any(_axis_of(name, machine) for name in names)


def _asked(names: Sequence[str], machine: Setup) -> set[str]:
    """Return the results that must be calculated to read these: themselves and their axes."""
    return {*names, *(axis for name in names if (axis := _axis_of(name, machine)))}


def _axis_of(name: str, machine: Setup) -> str:
    """Return the flat name of the axis that a result runs along: its own part's where that has one."""
    fields = machine.model.own_result_fields
    item = fields[name]
    own = f"{item.along}_{item.scope}"
    return own if own in fields else item.along


def _placed(name: str, found: Rows, machine: Setup, rows: RowsFile, places: Sequence[int]) -> NDArray[np.float64]:
    """Return one value per row, read along the axis where the result has one; NaN beyond the ends of the axis."""
    import numpy as np

    values = found.results[name]
    along = _axis_of(name, machine)
    if not along:
        return values
    wanted, axes = rows.axes[along][list(places)], found.results[along]
    if len(values) == len(axes) == 1:
        return _read_at(wanted, axes[0], values[0])
    shape = (len(wanted), values.shape[1])
    curves = zip(wanted, np.broadcast_to(axes, shape), np.broadcast_to(values, shape), strict=True)
    return np.array([float(_read_at(place, axis, curve)) for place, axis, curve in curves])


def _read_at(places: Any, axis: NDArray[np.float64], curve: NDArray[np.float64]) -> NDArray[np.float64]:
    """Read a curve at places of its axis, NaN beyond its ends; these may be missed by rounding."""
    import numpy as np

    order = np.argsort(axis)
    low, high = axis[order[0]], axis[order[-1]]
    rounding = 1e-9 * max(abs(low), abs(high))
    is_inside = (places >= low - rounding) & (places <= high + rounding)
    return np.where(is_inside, np.interp(places, axis[order], curve[order]), np.nan)
