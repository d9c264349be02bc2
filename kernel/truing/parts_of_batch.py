"""A batch split into parts in which everything but Float inputs has one value, as one call of a model needs it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Axis, InputKind
from truing.errors import UsageError
from truing.setup import Case


def uniform_parts(
    case: Case, fixed: Mapping[str, Any], arrays: Mapping[str, Any], rows: int
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
    groups = [np.array([row]) for row in range(rows)] if alone and vary else _groups(differing, rows)
    for index in groups:
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


def _groups(differing: Mapping[str, list[Any]], rows: int) -> list[NDArray[Any]]:
    """Return the row numbers that share the values of every differing column, in the order they first appear."""
    if not differing:
        return [np.arange(rows)] if rows else []
    places: dict[tuple[Any, ...], list[int]] = {}
    for row in range(rows):
        places.setdefault(tuple(_key(values[row]) for values in differing.values()), []).append(row)
    return [np.array(indices) for indices in places.values()]


def _key(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    try:
        hash(value)
    except TypeError:
        return id(value)
    return value
