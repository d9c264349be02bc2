"""Measured rows as a user has them: files that were written, or a dataframe that stands for one."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

from truing.api.tables import frame_of, write_frame
from truing.diagnosis.data_file import read_data_file
from truing.errors import Fault, InputError
from truing.kernel import Offer


class HasOffer(Protocol):
    """A model that was loaded."""

    @property
    def offer(self) -> Offer:
        """What it offers."""


@dataclass(frozen=True)
class Record:
    """Measured rows of one machine: one file, or several. A dataframe stands in a file that goes with the record."""

    files: tuple[Path, ...]
    folder: TemporaryDirectory[str] | None = field(default=None, repr=False, compare=False)

    def frame(self) -> Any:
        """Return the rows of the files as written, one behind another, as a dataframe of texts."""
        columns: dict[str, list[str]] = {}
        count = 0
        for file in self.files:
            with file.open(encoding="utf-8-sig", newline="") as stream:
                rows = list(csv.DictReader(stream))
            for name in dict.fromkeys([*columns, *(rows[0] if rows else ())]):
                columns.setdefault(name, [""] * count).extend(row.get(name, "") or "" for row in rows)
            count += len(rows)
        return frame_of(columns)


def read(files: str | Path | list[str | Path], model: HasOffer) -> Record:
    """Take measured files (CSV) as a record of this model. Raises InputError with every fault of every file."""
    several = files if isinstance(files, list) else [files]
    paths = tuple(Path(file) for file in several)
    _demand_read(paths, model)
    return Record(paths)


def record(frame: Any, model: HasOffer, *, units: Mapping[str, str] | None = None, name: str = "record") -> Record:
    """Take the rows of a dataframe as a record of this model; NaN is a reading that is missing.

    Columns are named as in a file: inputs, results (measured), conditions, ``sigma_NAME``, ``run``, each with its unit
    in the name ("load [N]") or in ``units``. ``name`` is what the sheet calls it. Raises InputError with every fault.
    """
    folder = TemporaryDirectory()
    path = Path(folder.name) / f"{name}.csv"
    write_frame(frame, path, units or {}, gaps=True)
    _demand_read((path,), model)
    return Record((path,), folder)


def _demand_read(paths: tuple[Path, ...], model: HasOffer) -> None:
    faults: list[Fault] = []
    for path in paths:
        try:
            _, found = read_data_file(path, model.offer)
            found.raise_any()
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
