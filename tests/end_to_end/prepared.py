"""An example whose published record is not shipped: the record beside it, prepared, and what is said of it."""

from __future__ import annotations

import csv
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from measured import Document, calc_here, read_document
from shown_in_docs import EXAMPLES

from truing.kernel.loading import load_file

Table = list[list[str]]
HOME = Path(os.environ.get("TRUING_MEASURED", "nowhere"))


def write(file: Path, table: Table) -> None:
    with file.open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines, lineterminator="\n").writerows(table)


def table_of(file: Path) -> Table:
    with file.open(encoding="utf-8", newline="") as lines:
        return list(csv.reader(lines))


@dataclass(frozen=True)
class PreparedExample:
    """A folder of the examples, the record that its page names, and the files that ``prepare.py`` makes of it."""

    name: str
    record_name: str

    @property
    def folder(self) -> Path:
        return EXAMPLES / self.name

    @property
    def record(self) -> Path:
        return HOME / self.record_name / "data.csv"

    @property
    def needs_the_record(self) -> pytest.MarkDecorator:
        return pytest.mark.skipif(not self.record.is_file(), reason="the record is not shipped")

    def plugin(self) -> Any:
        return load_file(self.folder / f"{self.name}.py")

    def prepared(self, folder: Path, text: str) -> Any:
        """Return what ``prepare.py`` makes of a record with this text: a table, or several by the names of files."""
        (folder / "data.csv").write_text(text, encoding="utf-8")
        return load_file(self.folder / "prepare.py").prepared(folder / "data.csv")

    def desk(self, folder: Path, table: str = "") -> Path:
        """Put the example into a new folder beside its record, prepared; ``table`` names the file of a sole table."""
        shutil.copytree(self.folder, folder, ignore=shutil.ignore_patterns("__pycache__", "runs", "*.csv"))
        made = self.prepared(folder, self.record.read_text(encoding="utf-8"))
        for file, rows in (made if isinstance(made, dict) else {table: made}).items():
            write(folder / file, rows)
        return folder

    def diagnosed(self, desk: Path, rows: str) -> Document:
        """Return the diagnosis of a file of rows; it is made once, as long as its folder is there."""
        if not (desk / "runs" / rows).is_dir():
            words = ("--inputs", "inputs.toml", "--data", f"{rows}.csv")
            answer = calc_here(desk, "diagnose", f"./{self.name}.py", *words)
            assert answer.code == 0, answer.err
        return read_document(desk / "runs" / rows)
