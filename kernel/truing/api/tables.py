"""Dataframes of any library: rows come in through the reader of files, and go out as the library in use."""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from importlib.util import find_spec
from numbers import Number
from typing import Any

import narwhals as nw

from truing.errors import UsageError
from truing.measurements import TableText, table_text

LIBRARIES = ("pandas", "polars", "pyarrow")
LABEL = "dataframe"
"""What sentences call a table that is no file; its first row is line 2, as in a file with a header."""


def frame_of(columns: Mapping[str, Sequence[Any]]) -> Any:
    """Return columns as a dataframe of pandas, polars or pyarrow, the first of them that this process has imported.

    Where it has imported none it is the first that is installed. Raises UsageError where none is.
    """
    in_use = [name for name in LIBRARIES if sys.modules.get(name) is not None]
    library = next(iter([*in_use, *(name for name in LIBRARIES if find_spec(name))]), None)
    if library is None:
        raise UsageError(f"a table in Python needs one of {', '.join(LIBRARIES)}: pip install pandas")
    return nw.from_dict(dict(columns), backend=library).to_native()  # type: ignore[arg-type]


def beside(frame: Any, columns: Mapping[str, Any], *, without: Collection[str] = ()) -> Any:
    """Return a dataframe with further columns, of the library that it came from, and without its own of some names."""
    table = nw.from_native(frame, eager_only=True)
    table = table.select(name for name in table.columns if name_in(str(name)) not in without)
    made = [nw.new_series(name, list(values), backend=table.implementation) for name, values in columns.items()]
    return table.with_columns(*made).to_native()


def name_in(header: str) -> str:
    """Return the name in a header: "load" of "load [N]"."""
    return header.partition("[")[0].strip()


def frame_text(frame: Any, units: Mapping[str, str], *, gaps: bool = False, name: str = LABEL) -> TableText:
    """Return a dataframe as the text that the readers of files read.

    A column is named "load [N]", or "load" with its unit in ``units``. With ``gaps`` NaN is an empty cell; without,
    it is a fault to the readers. Raises UsageError where the dataframe is none, or has no rows, or a row of nothing,
    where its index names a row twice or a column holds numbers and texts.
    """
    table = _table(frame)
    names = [str(name) for name in table.columns]
    unknown = [name for name in units if name not in names]
    if unknown:
        raise UsageError(f"units names '{unknown[0]}', which is no column; the columns are {', '.join(names)}")
    _demand_one_kind(table)
    columns = [[_cell(cell, gaps=gaps) for cell in table[name].to_list()] for name in table.columns]
    empty = next((number for number, row in enumerate(zip(*columns, strict=True), start=1) if not any(row)), 0)
    if empty or not len(table):
        raise UsageError(f"row {empty} of the dataframe holds nothing" if empty else "the dataframe holds no rows")
    headers = [f"{name} [{units[name]}]" if name in units else name for name in names]
    return TableText(name, table_text(headers, columns))


def _table(frame: Any) -> Any:
    """Return a dataframe as narwhals has it. Raises UsageError where it is none, or names a row or column twice."""
    try:
        table = nw.from_native(frame, eager_only=True)
    except TypeError:
        raise UsageError(f"{type(frame).__name__} is no dataframe of {', '.join(LIBRARIES)}") from None
    except Exception as error:  # narwhals' own, for columns of one name
        raise UsageError(f"the dataframe cannot be read: {error}") from None
    index = nw.maybe_get_index(table)
    if index is not None and not index.is_unique:
        twice = index[index.duplicated()].tolist()[0]
        raise UsageError(f"the index of the dataframe names the row {twice!r} twice; reset_index() numbers the rows")
    return table


def _demand_one_kind(table: Any) -> None:
    """Raise UsageError where a column holds numbers in one row and texts in another."""
    for name in table.columns:
        if table[name].dtype not in (nw.Object, nw.String):
            continue
        kinds = {_kind(value) for value in table[name].to_list() if not _is_missing(value)}
        if len(kinds) > 1:
            raise UsageError(f"column '{name}' of the dataframe holds {' and '.join(sorted(kinds))}; make it one kind")


def _kind(value: Any) -> str:
    if isinstance(value, bool):
        return "truth values"
    return "numbers" if isinstance(value, Number) else "texts" if isinstance(value, str) else type(value).__name__


def _is_missing(value: Any) -> bool:
    """Whether a cell holds nothing: None, or the NA of pandas, which equals neither itself nor anything else."""
    return value is None or type(value).__name__ in {"NAType", "NaTType"}


def _cell(value: Any, *, gaps: bool) -> str:
    if _is_missing(value) or (gaps and value != value):
        return ""
    plain = value.item() if hasattr(value, "item") else value
    return repr(plain) if isinstance(plain, float) else str(plain)
