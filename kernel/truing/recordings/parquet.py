"""Parquet files, read by pyarrow: columns of one length, their unit in the metadata of the field or in its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.errors import OutputError
from truing.heavy import pyarrow
from truing.recordings.channels import (
    INSTALL,
    Channel,
    Recording,
    UnreadableError,
    as_column,
    demand_modest,
    unit_or_none,
)
from truing.units.grammar import shown

UNIT = b"unit"
"""The key of a field's metadata under which its unit stands."""


def read_channels(path: Path) -> Recording:
    """Read every column of numbers, truth values, stamps or texts."""
    with pyarrow.ParquetFile(path, page_checksum_verification=True) as file:
        demand_modest(file.metadata.num_rows * file.metadata.num_columns, file.metadata.num_columns)
        table = file.read()
    names = table.column_names
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise UnreadableError(f"holds the column {shown(twice)} twice; name the columns apart")
    channels, notes = [], []
    for field, column in zip(table.schema, table.columns, strict=True):
        values = _values(column)
        if values is None:
            notes.append(
                f"column {shown(field.name)} holds {shown(str(field.type))[1:-1]} and no numbers, and is left out"
            )
        else:
            stated = (field.metadata or {}).get(UNIT)
            unit = None if stated is None else unit_or_none(stated.decode("utf-8", "replace"))
            unit = "s" if pyarrow.types.is_duration(field.type) else unit
            channels.append(Channel(field.name, "", unit, values))
    return Recording(tuple(channels), tuple(notes))


def _values(column: Any) -> NDArray[Any] | None:
    kinds = pyarrow.types
    if kinds.is_dictionary(column.type):
        column = column.cast(column.type.value_type)
    if kinds.is_decimal(column.type):
        column = column.cast(pyarrow.float64())
    if kinds.is_timestamp(column.type) or kinds.is_date(column.type):
        column = column.cast(pyarrow.timestamp("ns"))
    if kinds.is_null(column.type):
        return np.full(len(column), np.nan)
    if kinds.is_nested(column.type):
        return None
    if column.null_count and (kinds.is_integer(column.type) or kinds.is_boolean(column.type)):
        return np.array([_text(value) for value in column.to_pylist()], dtype=object)
    return as_column(column.to_numpy())


def _text(value: int | bool | None) -> str | None:
    """Return a whole number or a truth value as a table has it: they have no NaN."""
    return None if value is None else str(value).lower()


def parquet_bytes(columns: Mapping[str, Sequence[Any]]) -> bytes:
    """Write columns as a parquet file: numbers, truth values and texts; "load [N]" puts N in the metadata, too.

    Raises OutputError where pyarrow is not installed.
    """
    try:
        as_array = pyarrow.array
    except ImportError:
        raise OutputError(f"a parquet file needs pyarrow, which is not installed: {INSTALL}") from None
    fields, arrays = [], []
    for header, values in columns.items():
        plain = values.tolist() if isinstance(values, np.ndarray) else list(values)
        if any(isinstance(value, str) for value in plain):
            plain = [None if value is None else str(value) for value in plain]
        array = as_array(plain)
        unit = header.partition("[")[2].removesuffix("]")
        fields.append(pyarrow.field(header, array.type, metadata={UNIT: unit.encode()} if unit else None))
        arrays.append(array)
    stream = BytesIO()
    pyarrow.write_table(pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields)), stream)
    return stream.getvalue()
