"""An example and the rows of its public record: in another order, fewer of them, with another declaration."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from measured import Document, documented
from numpy.typing import NDArray
from shown_in_docs import EXAMPLES

Rows = Sequence[str]


def as_they_stand(rows: Rows) -> Rows:
    return rows


def every_other(rows: Rows) -> Rows:
    return rows[::2]


def the_others(rows: Rows) -> Rows:
    return rows[1::2]


def shuffled(rows: Rows) -> Rows:
    return [rows[place] for place in np.random.default_rng(1).permutation(len(rows))]


@dataclass(frozen=True)
class ExampleRows:
    """A folder of the examples, and the file in it that was measured: one line of credit, the header, rows."""

    name: str
    file: str

    @property
    def folder(self) -> Path:
        return EXAMPLES / self.name

    @property
    def lines(self) -> list[str]:
        return (self.folder / self.file).read_text(encoding="utf-8").splitlines()

    def numbers(self, *columns: int) -> NDArray[np.float64]:
        """Return some columns as they were measured, each one a row of the answer; read without Truing."""
        return np.genfromtxt(self.folder / self.file, delimiter=",", skip_header=2, usecols=columns).T

    def words(self, column: int) -> list[str]:
        return [line.split(",")[column] for line in self.lines[2:]]

    def diagnosed(
        self, desk: Path, taken: Callable[[Rows], Rows] = as_they_stand, *, declared: Callable[[str], str] = str,
        hold_out: str | None = None, inputs: Path | None = None,
    ) -> Document:  # fmt: skip
        """Diagnose some of the rows in a folder of their own; ``declared`` may change the text of the plugin.

        ``inputs`` is another inputs file than that of the example, such as an extended one.
        """
        desk.mkdir(parents=True, exist_ok=True)
        shutil.copy(inputs or self.folder / "inputs.toml", desk / "inputs.toml")
        text = (self.folder / f"{self.name}.py").read_text(encoding="utf-8")
        (desk / f"{self.name}.py").write_text(declared(text), encoding="utf-8")
        _, header, *rows = self.lines
        measured = "\n".join([header, *taken(rows)]) + "\n"
        (desk / "rows.csv").write_text(measured, encoding="utf-8")
        stated = {} if hold_out is None else {"set": {"studies.diagnose.hold_out": hold_out}}
        return documented(desk, f"{self.name}.py", "rows.csv", **stated)


def explanations(document: Document) -> set[frozenset[str]]:
    """Return every explanation that is left, each as the set of its causes."""
    return {frozenset(causes) for causes in document["explanations"]}


def interval_of(document: Document, effect: str, unknown: str) -> tuple[float, float]:
    """Return the 95 % interval of an unknown, in the first explanation that holds it."""
    every = [{cause["effect"]: cause["unknowns"] for cause in document["causes"]}]
    every += [other["unknowns"] for other in document["alternatives"]]
    low, high = next(item[effect] for item in every if effect in item)[unknown]["interval95"]
    return low, high


def spoken_of(document: Document) -> set[str]:
    """Return the effects of which a diagnosis says anything: found, visible from some size, or out of sight."""
    lists = ("not_excited", "hidden_in_tolerances")
    found = {name for part in lists for name in document[part]} | set(document["not_measured"])
    found |= set(document["smallest_visible"]) | set(document["not_fitted"])
    for cause in document["causes"]:
        found |= {cause["effect"], *cause["same_as"]}
    for explanation in document["ranking"]:
        found |= set(explanation["causes"]) | {name for names in explanation["same_as"].values() for name in names}
    return {name.partition(".")[0] for name in found}
