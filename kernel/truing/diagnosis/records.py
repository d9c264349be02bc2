"""Measured rows ready to be explained: in SI, sorted by time inside each run, every oddity counted and said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import pi
from pathlib import PurePath
from typing import Literal

import numpy as np

from truing.arrays import Indices, Mask, Matrix, Sides, first_alike
from truing.measurements import RowCount, RowsFile

Role = Literal["input", "condition", "time", "other", "order"]
FULL_TURN = 1.5 * pi
"""An angle that covers so much of a turn goes round: waves describe it better than powers."""
FEWEST_READINGS = 8
"""Fewer readings tell no cause from chance."""


@dataclass(frozen=True)
class Covariate:
    """Something the error may depend on: one value per row, in SI, NaN where missing.

    ``role`` is "order" for the place in the record where no time was measured. ``unit`` is the one to print it in.
    ``is_angle`` where it is one of something that turns, or may.
    """

    name: str
    values: Matrix
    unit: str
    role: Role
    is_angle: bool = False

    @cached_property
    def filled(self) -> Matrix:
        """The values with their mean where one is missing."""
        return np.where(np.isfinite(self.values), self.values, np.nanmean(self.values))

    @property
    def goes_round(self) -> bool:
        """Whether it covers nearly a whole turn, as an angle of a design never does."""
        finite = self.values[np.isfinite(self.values)]
        return len(finite) > 0 and float(np.ptp(finite)) >= FULL_TURN

    @property
    def is_constant(self) -> bool:
        """Whether it never changed on this data, so that nothing can be seen of what depends on it."""
        finite = self.values[np.isfinite(self.values)]
        return len(finite) == 0 or bool(np.ptp(finite) <= 1e-9 * np.abs(finite).max())

    def moves_with(self, other: Covariate, least: float) -> bool:
        """Whether the correlation with another one is above ``least``, of either sign."""
        both = np.isfinite(self.values) & np.isfinite(other.values)
        return bool(both.sum() > 2 and abs(np.corrcoef(self.values[both], other.values[both])[0, 1]) > least)


@dataclass(frozen=True)
class SuspectedUnit:
    """A unit that was probably written wrong: the column, the factor that would set it right, in words."""

    column: str
    factor: float
    text: str


@dataclass(frozen=True, kw_only=True)
class Records:
    """Rows of one or several files, n of them, runs one after another and sorted by time inside each.

    ``rows`` is what the model is evaluated with (inputs, conditions as effects see them, series, axes; its ``runs``
    are unique over all files). ``file_of`` and ``run_of`` number the file and run of each row from 0; ``lines`` is
    where it stands in its file. ``measured`` and ``sigma`` hold results by name, SI, shape (n,), NaN where missing.
    ``covariates`` holds everything an error may depend on, by name. ``held_out`` marks rows that only judge.
    ``notes`` says, one sentence each, what was kept, merged, sorted, unwrapped or left out, with counts.
    """

    files: tuple[str, ...]
    rows: RowsFile
    file_of: Indices
    run_of: Indices
    lines: Indices
    measured: Mapping[str, Matrix]
    sigma: Mapping[str, Matrix]
    covariates: Mapping[str, Covariate]
    held_out: Mask
    notes: tuple[str, ...] = ()
    unit_errors: tuple[SuspectedUnit, ...] = ()
    absent: frozenset[str] = field(default_factory=frozenset)
    """Conditions of effects that no column gives: not measured."""
    sides: Mapping[str, Sides] = field(default_factory=dict)
    """Of results with censored rows."""
    counts: tuple[RowCount, ...] = ()
    """What became of every row of each file, in the order of ``files``."""
    digests: Mapping[str, str] = field(default_factory=dict)
    """The SHA-256 of each file when it was read."""
    units: Mapping[str, str] = field(default_factory=dict)
    """The unit of every column as the first file that has it gives it; "" for none."""

    @cached_property
    def readings(self) -> int:
        """Number of measured values that may be fitted; those of rows that differ in their order alone count once."""
        known = [np.where(self.known(name), values, np.nan) for name, values in self.measured.items()]
        measured = np.column_stack(known)[~self.held_out]
        settings = [
            covariate.values[~self.held_out] for covariate in self.covariates.values() if covariate.role != "order"
        ]
        return int(np.isfinite(measured[np.unique(first_alike([*measured.T, *settings]))]).sum())

    @property
    def moved(self) -> list[Covariate]:
        """The covariates that changed, without the place of a row in its file."""
        return [each for each in self.covariates.values() if not each.is_constant and each.role != "order"]

    def known(self, name: str) -> Mask:
        """Mark the rows in which the value of a result was read: neither missing nor censored."""
        there = np.isfinite(self.measured[name])
        return np.asarray(there & (self.sides[name] == 0)) if name in self.sides else np.asarray(there)

    def __len__(self) -> int:
        return len(self.run_of)

    def part(self, places: Indices) -> Records:
        """Return some of the rows, by their places in order."""
        return replace(
            self,
            rows=self.rows.taken(places),
            file_of=self.file_of[places],
            run_of=self.run_of[places],
            lines=self.lines[places],
            measured={name: values[places] for name, values in self.measured.items()},
            sigma={name: values[places] for name, values in self.sigma.items()},
            covariates={
                name: replace(covariate, values=covariate.values[places]) for name, covariate in self.covariates.items()
            },
            held_out=self.held_out[places],
            sides={name: values[places] for name, values in self.sides.items()},
        )


def file_labels(files: Sequence[str]) -> list[str]:
    """Return how data files are named: without their folders where that tells them apart."""
    names = [PurePath(file.replace("\\", "/")).name for file in files]
    return names if len(set(names)) == len(names) else list(files)
