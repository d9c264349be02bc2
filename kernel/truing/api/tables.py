"""Dataframes of any library: rows come in through the reader of files, and go out as what is installed."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import narwhals as nw

from truing.errors import InputError, UsageError

LIBRARIES = ("pandas", "polars", "pyarrow")
LABEL = "dataframe"
"""What sentences call a table that is no file; its first row is line 2, as in a file with a header."""


def frame_of(columns: Mapping[str, Sequence[Any]]) -> Any:
    """Return columns as a dataframe of pandas, polars or pyarrow, whichever is installed first in this order."""
    library = next((name for name in LIBRARIES if find_spec(name)), None)
    if library is None:
        raise UsageError(f"a table in Python needs one of {', '.join(LIBRARIES)}: pip install pandas")
    return nw.from_dict(dict(columns), backend=library).to_native()  # type: ignore[arg-type]


def beside(frame: Any, columns: Mapping[str, Any]) -> Any:
    """Return a dataframe with further columns, of the library that it came from."""
    table = nw.from_native(frame, eager_only=True)
    made = [nw.new_series(name, list(values), backend=table.implementation) for name, values in columns.items()]
    return table.with_columns(*made).to_native()


@contextmanager
def as_file(frame: Any, units: Mapping[str, str]) -> Iterator[Path]:
    """Give a dataframe as a file that the readers of files read; faults speak of the dataframe. See ``write_frame``."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{LABEL}.csv"
        write_frame(frame, path, units, gaps=False)
        try:
            yield path
        except InputError as error:
            raise InputError([replace(fault, file=_label(fault.file, path)) for fault in error.faults]) from None


def write_frame(frame: Any, path: Path, units: Mapping[str, str], *, gaps: bool) -> None:
    """Write a dataframe as a file that the readers of files read.

    A column is named "load [N]", or "load" with its unit in ``units``. With ``gaps`` NaN is an empty cell; without,
    it is a fault to the readers. Raises UsageError where the dataframe is none, or has no rows, or a row of nothing.
    """
    try:
        table = nw.from_native(frame, eager_only=True)
    except TypeError:
        raise UsageError(f"{type(frame).__name__} is no dataframe of {', '.join(LIBRARIES)}") from None
    names = [str(name) for name in table.columns]
    unknown = [name for name in units if name not in names]
    if unknown:
        raise UsageError(f"units names '{unknown[0]}', which is no column; the columns are {', '.join(names)}")
    rows = [[_cell(cell, gaps=gaps) for cell in row] for row in table.iter_rows()]
    empty = next((number for number, row in enumerate(rows, start=1) if not any(row)), 0)
    if empty or not rows:
        raise UsageError(f"row {empty} of the dataframe holds nothing" if empty else "the dataframe holds no rows")
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([f"{name} [{units[name]}]" if name in units else name for name in names])
        writer.writerows(rows)


def _cell(value: Any, *, gaps: bool) -> str:
    if value is None or (gaps and value != value):
        return ""
    plain = value.item() if hasattr(value, "item") else value
    return repr(plain) if isinstance(plain, float) else str(plain)


def _label(file: str, path: Path) -> str:
    return LABEL if file == str(path) else file
