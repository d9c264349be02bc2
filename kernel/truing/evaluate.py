"""Running the model: one calculation, or a batch of rows in one call, with the effects that are on.

Columns of a batch are named by input, by condition, or by ``effects.NAME.UNKNOWN``; all values are SI.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.batch import FailedRows, watching
from truing.declare.chain import chain_of, filled, in_order_of_calculation
from truing.declare.fields import Axis, InputKind, read, with_values
from truing.declare.near_miss import near_miss
from truing.declare.sources import Unknown
from truing.errors import InfeasibleError, PluginError, TruingError, UsageError
from truing.kernel.blame import home_of, place_of
from truing.repeated import results_of
from truing.setup import Case, SwitchedOn, effect_column
from truing.units import to_si


@dataclass(frozen=True)
class Rows:
    """What a batch answered: results by flat name, shape (n,) or (n, k), NaN in failed rows; why rows failed.

    ``absent`` says by result and row where a row that has not failed lacks one result, NaN there.
    """

    results: Mapping[str, NDArray[np.float64]]
    failed: NDArray[np.bool_]
    reasons: Mapping[int, str]
    absent: Mapping[str, Mapping[int, str]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.failed)

    def complete(self) -> Rows:
        """Return the same rows, of which those that lack any result have failed, with that reason."""
        lacking = {row: reason for rows in self.absent.values() for row, reason in rows.items()}
        if not lacking:
            return self
        reasons = dict(sorted({**lacking, **self.reasons}.items()))
        failed = np.array(self.failed)
        failed[list(reasons)] = True
        results = {name: np.array(values) for name, values in self.results.items()}
        for values in results.values():
            values[failed] = np.nan
        return Rows(results, failed, reasons)


@dataclass(frozen=True)
class Evaluated:
    """What one calculation answered: the model's results, and why some of them, by flat name, do not exist (NaN)."""

    results: Any
    absent: Mapping[str, str]


def evaluate(case: Case, *, reading: bool = False) -> Any:
    """Run the calculation once and return the model's results; one that does not exist is NaN: see ``answered``."""
    return answered(case, reading=reading).results


def answered(case: Case, *, reading: bool = False) -> Evaluated:
    """Run the calculation once.

    Raises InfeasibleError with the sentence of the plugin where something impossible is asked, and where a result is
    not finite; PluginError, with the place, where the plugin's code fails.
    """
    with np.errstate(all="ignore"), watching(1, is_single=True) as log:
        results = _apply(case, {}, case.model.function, reading=reading)
    flat = case.model.read_results(results)
    absent = {name: reasons[0] for name, reasons in _absent(case, log, 1).items() if reasons}
    changed: dict[str, Any] = {}
    for name, value in flat.items():
        if name in absent:
            changed[name] = np.full(np.shape(value), np.nan)[()]
        elif not np.isfinite(_as_rows(case, name, flat, 1)).all():
            raise InfeasibleError(f"the result '{name}' of {case.model.name} is not finite for these inputs")
        elif np.ndim(value) == 0:
            changed[name] = float(value)
    fields = case.model.own_result_fields
    return Evaluated(with_values(results, {fields[name].path: value for name, value in changed.items()}), absent)


def _absent(case: Case, log: FailedRows, rows: int) -> dict[str, dict[int, str]]:
    """Return why results do not exist, by name and row. Raises PluginError where the plugin names no result."""
    for name in log.of:
        if name not in case.model.own_result_fields:
            near = near_miss(name, case.model.own_result_fields)
            raise PluginError(f"{case.model.name}: feasible(only=...) names '{name}', which is no result.{near}")
    return {name: own.reasons(rows) for name, own in log.of.items()}


def evaluate_rows(
    case: Case,
    columns: Mapping[str, Any],
    rows: int,
    *,
    reading: bool = False,
    wanted: Collection[str] | None = None,
    done: Callable[[int, int], None] = lambda count, rows: None,
    repeats: int = 0,
    size: int = 0,
) -> Rows:
    """Run ``rows`` calculations, as one array call wherever the declaration allows it.

    A column holds (rows,) values or one value for all. Only ``wanted`` results are returned (all by default). Failed
    rows are NaN in every result and keep their reason; a table shorter than the longest is filled up with NaN. A row
    that lacks a result keeps the others: see ``Rows.absent`` and ``Rows.complete``.
    ``done`` hears of rows that are done where they take several calls: one call has at most ``size`` rows, if that is
    given. Rows that come in so many ``repeats``, one copy of all behind another, cost no more than one of them where
    they differ in what acts after the model: see repeated.
    Raises UsageError for a column that nobody knows or that has another length.
    """
    names = [name for name in case.model.own_result_fields if wanted is None or name in wanted]
    fixed, arrays = _sorted_columns(case, columns, rows)
    parts: list[Rows] = []
    order: list[NDArray[np.intp]] = []
    finished = 0
    for index, part in _uniform_parts(case, fixed, arrays, rows, size):
        copies = repeats if len(index) == rows else 0
        parts.append(_one_call(case, part, len(index), names, reading=reading, repeats=copies))
        if len(index) == rows > 0:
            return parts[0]
        order.append(index)
        finished += len(index)
        done(finished, rows)
    return put_together(parts, order, names, rows)


def put_together(parts: Sequence[Rows], order: Sequence[NDArray[np.intp]], names: Sequence[str], rows: int) -> Rows:
    """Put the answers of parts back in the order of the rows."""
    failed = np.zeros(rows, dtype=bool)
    reasons: dict[int, str] = {}
    absent: dict[str, dict[int, str]] = {}
    for index, part in zip(order, parts, strict=True):
        failed[index] = part.failed
        reasons |= {int(index[row]): text for row, text in part.reasons.items()}
        for name, lacking in part.absent.items():
            absent.setdefault(name, {}).update({int(index[row]): text for row, text in lacking.items()})
    results = {name: _joined([part.results[name] for part in parts], order, rows) for name in names}
    return Rows(results, failed, dict(sorted(reasons.items())), absent)


def _joined(pieces: Sequence[NDArray[np.float64]], order: Sequence[NDArray[np.intp]], rows: int) -> NDArray[np.float64]:
    inner = max((piece.shape[1:] for piece in pieces), default=())
    joined = np.full((rows, *inner), np.nan)
    for index, piece in zip(order, pieces, strict=True):
        if inner:
            joined[index, : piece.shape[1]] = piece
        else:
            joined[index] = piece
    return joined


def _one_call(
    case: Case, columns: Mapping[str, Any], rows: int, names: Collection[str], *, reading: bool, repeats: int = 0
) -> Rows:
    """Call the model once for ``rows`` rows; where no column differs between rows, for one that answers for all."""
    alike = not any(isinstance(values, np.ndarray) for values in columns.values())
    called = 1 if alike else rows
    with np.errstate(all="ignore"), watching(called) as log:
        model = case.model
        is_known = alike or not repeats or model.dynamics is not None  # what moves has a memory of its own
        calculate = model.function if is_known else partial(results_of, model, repeats=repeats, failed=log)
        results = _apply(case, columns, calculate, reading=reading)
        flat = model.read_results(results, {*names, *(model.axes[name] for name in names)} & {*model.axes})
        answers = {name: _as_rows(case, name, flat, called) for name in names}
        for name, values in answers.items():
            infinite = ~np.isfinite(values)
            if infinite.any():
                known = log.of[name].codes > 0 if name in log.of else np.zeros(1, dtype=bool)
                log.add(infinite & ~known.reshape(-1, *[1] * (values.ndim - 1)), f"the result '{name}' is not finite")
    absent = {name: why for name, why in _absent(case, log, rows).items() if why and name in answers}
    reasons = log.reasons(rows)
    for name, values in answers.items():
        gaps = [*reasons, *absent.get(name, ())]
        answers[name] = np.broadcast_to(values, (rows, *values.shape[1:]))
        if gaps:
            answers[name] = np.array(answers[name])
            answers[name][gaps] = np.nan
    return Rows(answers, np.broadcast_to(log.codes > 0, (rows,)), reasons, absent)


def _as_rows(case: Case, name: str, flat: Mapping[str, Any], rows: int) -> NDArray[np.float64]:
    """Bring a result to shape (rows,) or (rows, k); raises PluginError for any other shape."""
    result = case.model.own_result_fields[name]
    try:
        array = np.asarray(flat[name], dtype=float)
        if not result.along:
            return array.reshape(rows) if array.ndim < 2 and array.size == rows else np.broadcast_to(array, (rows,))
        axis = flat.get(case.model.axes[name], array)
        return np.broadcast_to(array, (rows, np.asarray(axis).shape[-1] if np.ndim(axis) else 1))
    except (TypeError, ValueError):
        shape = getattr(flat[name], "shape", None)
        what = f"has the shape {shape}" if shape is not None else f"is {flat[name]!r:.60}"
        wanted = "(n, k), with column(x) for a value per row" if result.along else "a number or an array (n,)"
        raise PluginError(
            f"{case.model.name}: the result '{name}' {what} in a call of {rows}; it is {wanted}"
        ) from None


def _sorted_columns(case: Case, columns: Mapping[str, Any], rows: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Check the columns and part them: those a batch is split by, and numbers (arrays where they differ)."""
    fields = case.model.input_fields
    unknowns = {effect_column(on.effect.name, unknown.name) for on in case.effects for unknown in on.effect.unknowns}
    fixed: dict[str, Any] = {}
    arrays: dict[str, Any] = {}
    for name, values in columns.items():
        if name in fields and not fields[name].varies:
            fixed[name] = values
            continue
        if name not in fields and name not in case.model.known_conditions and name not in unknowns:
            near = near_miss(name, [*fields, *case.model.known_conditions, *unknowns])
            raise UsageError(f"the column '{name}' is no input, condition or effect that is on.{near}")
        numbers = np.asarray(values, dtype=float)
        if numbers.shape not in {(), (rows,)}:
            raise UsageError(f"the column '{name}' has the shape {numbers.shape}; expected one value or ({rows},)")
        arrays[name] = numbers if numbers.ndim else np.float64(numbers)
    return fixed, arrays


# Parts of a batch in which everything but Float inputs has one value, as one call of a model needs it


def _uniform_parts(
    case: Case, fixed: Mapping[str, Any], arrays: Mapping[str, Any], rows: int, size: int
) -> Iterator[tuple[NDArray[np.intp], dict[str, Any]]]:
    """Split a batch so that everything but Float inputs has one value; tables are made row by row, equal rows once."""
    per_row = {name: _each(values, case.model.input_fields[name].kind) for name, values in fixed.items()}
    for name, values in per_row.items():
        if values is not None and len(values) != rows:
            raise UsageError(f"the column '{name}' has {len(values)} values for {rows} rows")
    common = {name: values for name, values in fixed.items() if per_row[name] is None}
    differing = {name: values for name, values in per_row.items() if values is not None}
    alone = any(
        isinstance(result.spec, Axis) and result.spec.is_table for result in case.model.own_result_fields.values()
    )
    vary = differing or any(isinstance(values, np.ndarray) for values in arrays.values())
    groups = [np.array([row]) for row in range(rows)] if alone and vary else rows_alike([*differing.values()], rows)
    size = size or max(rows, 1)
    for index in (piece for group in groups for piece in np.split(group, range(size, len(group), size))):
        part = {name: _taken(values, index, rows, alone=alone) for name, values in arrays.items()}
        yield index, {**common, **part, **{name: values[index[0]] for name, values in differing.items()}}


def _each(values: Any, kind: InputKind) -> list[Any] | None:
    """Return the value of each row, or None where there is one for all; a series is a value itself."""
    if isinstance(values, np.ndarray):
        if kind == "series" and values.ndim == 1:
            return None
        return list(values) if kind == "series" else values.tolist() if values.ndim else None
    if kind in {"series", "file"}:
        return values if isinstance(values, list) else None
    return list(values) if isinstance(values, (list, tuple)) else None


def _taken(values: Any, index: NDArray[Any], rows: int, *, alone: bool) -> Any:
    if not isinstance(values, np.ndarray) or (len(index) == rows and not alone):
        return values
    return values[index[0]] if alone else values[index]


def rows_alike(columns: Sequence[Sequence[Any]], rows: int) -> list[NDArray[np.intp]]:
    """Return the row numbers that share the values of every column, in the order they first appear; NaN equals none."""
    if not columns:
        return [np.arange(rows)] if rows else []
    places: dict[tuple[Any, ...], list[int]] = {}
    for row in range(rows):
        places.setdefault(tuple(_key(values[row]) for values in columns), []).append(row)
    return [np.array(indices) for indices in places.values()]


def _key(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    try:
        hash(value)
    except TypeError:
        return id(value)
    return value


# One call, with the effects that are on


def _apply(case: Case, columns: Mapping[str, Any], calculate: Callable[[Any], Any], *, reading: bool) -> Any:
    """Inputs, effects on inputs, model, effects on results, effects on the reading: in this order.

    ``calculate`` is the function of the model, or what remembers its results.
    """
    model = case.model
    switched = [(active, _keywords(active, case, columns)) for active in _acting_in_order(case)]
    try:
        inputs = _inputs(case, columns)
        for active, keywords in switched:
            if active.effect.place == "inputs":
                inputs = active.effect.function(inputs, **keywords)
        results = calculate(inputs)
        for acts_on in ("results", "reading") if reading else ("results",):
            for active, keywords in switched:
                if active.effect.place == acts_on:
                    results = active.effect.function(inputs, results, **keywords)
    except TruingError:
        raise
    except (Exception, SystemExit) as error:
        functions = [model.function, *(active.effect.function for active in case.effects)]
        file, line = place_of(error, [home for function in functions if (home := home_of(function))])
        where = f"{file}:{line}: " if file else ""
        raise PluginError(f"{where}{model.name} failed: {type(error).__name__}: {error}") from error
    if not isinstance(results, model.result_type):
        raise PluginError(f"{model.name} returned {results!r:.60}, which is no {model.result_type.__name__}")
    return results


def _inputs(case: Case, columns: Mapping[str, Any]) -> Any:
    """Make the inputs of a call: those of the case, and columns in place of some of them."""
    fields = case.model.input_fields
    given = {fields[name].path: value for name, value in columns.items() if name in fields and value is not None}
    return with_values(case.numpy_inputs, given) if given else case.numpy_inputs


def acting_inputs(case: Case) -> Any:
    """Return the inputs as the effects that are on leave them: what the calculation itself is called with.

    Those that are taken from other calculations are filled.
    """
    inputs = case.inputs
    for active in _acting_in_order(case):
        if active.effect.place == "inputs":
            inputs = active.effect.function(inputs, **_keywords(active, case, {}))
    return filled(case.model, inputs)


def taken_values(case: Case) -> dict[str, Any]:
    """Return by flat name what inputs take from other calculations (SI), as these answer with their effects on.

    Empty of a calculation that takes nothing; what is stated in place of a link is left out.
    """
    chain = chain_of(case.model)
    if chain is None:
        return {}
    fields, behind = case.model.input_fields, chain.last.effects
    open_names = [name for name in chain.taken if np.isnan(read(case.inputs, fields[name].path))]
    before = replace(case, effects=tuple(active for active in case.effects if active.effect.name not in behind))
    with np.errstate(all="ignore"):
        acting = acting_inputs(before)
    return {name: float(read(acting, fields[name].path)) for name in open_names}


def _acting_in_order(case: Case) -> list[SwitchedOn]:
    return in_order_of_calculation(case.model, case.effects, lambda active: active.effect)


def _keywords(active: SwitchedOn, case: Case, columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return what an effect is called with: unknowns and conditions, from the columns, else as they are held."""
    held: dict[str, Any] = {}
    for unknown in active.effect.unknowns:
        column = effect_column(active.effect.name, unknown.name)
        if column in columns:
            held[unknown.name] = columns[column]
        elif unknown.name in active.values or not (active.effect.parts and active.effect.takes_any):
            held[unknown.name] = np.float64(_held(active, unknown))
    for need in active.effect.needs:
        held[need.name] = columns.get(need.name, np.float64(case.conditions.get(need.name, need.zero)))
    return held


def _held(active: SwitchedOn, unknown: Unknown) -> float:
    """Return the value of an unknown; in a part that is off 0, or the lower bound of a shape. Raises UsageError."""
    if unknown.name in active.values:
        return active.values[unknown.name]
    if not active.effect.parts:
        raise UsageError(f"effect '{active.effect.name}' is on, so its unknown '{unknown.name}' must be given")
    return 0.0 if unknown.is_amplitude else to_si(unknown.low, unknown.unit)
