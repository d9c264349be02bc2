"""Tables to files: numbers that read back exactly, a file that is complete or absent."""

from __future__ import annotations

import csv
import math
import os
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TextIO

from truing.errors import OutputError


def write_table(target: Path | TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]]) -> None:
    """Write columns under headers such as "depth [um]"; the numbers are in these units already.

    Numbers are written so that they read back exactly (at most 17 digits), NaN and None as empty cells. A path is
    written atomically. Raises OutputError where it cannot be written.
    """
    if not isinstance(target, Path):
        _write(target, headers, columns)
        return
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=".part")
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as stream:
            _write(stream, headers, columns)
        Path(name).chmod(0o666 & ~umask())
        Path(name).replace(target)
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def umask() -> int:
    """Return what this process takes from the permissions of new files; temporary ones are made without them."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def _write(stream: TextIO, headers: Sequence[str], columns: Sequence[Iterable[Any]]) -> None:
    if len(headers) != len(columns):
        raise ValueError(f"{len(headers)} headers for {len(columns)} columns")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(headers)
    for row in zip(*(_plain(column) for column in columns), strict=True):
        writer.writerow([_cell(value) for value in row])


def _plain(column: Any) -> Iterable[Any]:
    """Return plain Python values, which are written much faster than numpy's."""
    plain: Iterable[Any] = column.tolist() if hasattr(column, "tolist") else column
    return plain


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "" if math.isnan(value) else str(value)
    return str(value)
