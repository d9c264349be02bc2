"""Rows left out in turn: blocks of neighbours where rows have an order, else rows at random, in five folds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import log, sqrt

import numpy as np

from truing.arrays import Indices, Mask, Matrix
from truing.diagnosis.exact import alone, refitting
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.sample import Sample, has_order

FOLDS = 5
"""So many folds of the cross-validation: each leaves a fifth of the blocks out."""
SHORTEST_BLOCK = 6
"""Rows of the shortest block of a record that is not short: neighbours stay together."""
FEWEST_BLOCKS = 8
"""A short record has shorter blocks rather than fewer: of four that all gain the best significance is 1/16."""
BLOCKS = 20
"""A record has so many blocks at the most: the sign of each is one piece of evidence for the gain."""


@dataclass(frozen=True)
class Folds:
    """The block that each row of the records lies in (n,), -1 for rows that only judge, and the number of folds."""

    block_of: Indices
    count: int

    def test(self, fold: int) -> Mask:
        """Mark the rows that one fold leaves out."""
        return np.asarray((self.block_of >= 0) & (self.block_of % self.count == fold))


def folds_of(sample: Sample) -> Folds:
    """Number blocks of consecutive rows inside each run: a twentieth of the rows, six, or three correlation times.

    A record of fewer than 48 rows has blocks of an eighth of it. Where something is fitted file by file, a run has two
    blocks at least: no fold may leave out all that is known of a file. Rows without an order are blocks of their own.
    """
    records = sample.machine.records
    usable = np.flatnonzero(sample.mask)
    block_of = np.full(len(records), -1, dtype=np.intp)
    if not has_order(sample.machine):
        covariates = (covariate.values for covariate in records.covariates.values() if covariate.role != "order")
        order = np.lexsort([values[usable] for values in (*covariates, *records.measured.values())])  # not of the file
        block_of[usable[order]] = np.random.Generator(np.random.SFC64(1)).permutation(len(usable))
        return Folds(block_of, min(FOLDS, max(len(usable), 1)))
    runs = records.run_of[usable]
    first = np.flatnonzero(np.append(True, runs[1:] != runs[:-1]))
    sizes = np.diff(np.append(first, len(runs)))
    largest = max(channel.memory.rho for channel in sample.channels)
    reach = -1 / log(largest) if largest > 0 else 0.0
    shortest = min(SHORTEST_BLOCK, max(2, len(runs) // FEWEST_BLOCKS))
    length = int(max(shortest, len(runs) // BLOCKS, min(3 * reach, len(runs) // (2 * FOLDS))))
    if sample.machine.start.diagnose.per_file:
        length = min(length, max(int(sizes.min()) // 2, 1))
    blocks = -(-sizes // length)
    within = (np.arange(len(runs)) - np.repeat(first, sizes)) // length
    block_of[usable] = np.repeat(np.cumsum(blocks) - blocks, sizes) + within
    return Folds(block_of, min(FOLDS, int(block_of.max()) + 1))


def ends_of(sample: Sample) -> Folds:
    """Return the first and the last quarter of every run as two folds: what carries over to them is no mere beat."""
    records = sample.machine.records
    usable = np.flatnonzero(sample.mask)
    block_of = np.full(len(records), -1, dtype=np.intp)
    for run in np.unique(records.run_of[usable]):
        rows = usable[records.run_of[usable] == run]
        quarter = max(len(rows) // 4, 1)
        block_of[rows[:quarter]], block_of[rows[-quarter:]] = 0, 1
    return Folds(block_of, 2)


def refitted(fits: Sequence[Fit], extended: Extended, test: Mask) -> list[Fit | None]:
    """Fit explanations to the rows that are not left out, each from where it is; None where that cannot be done."""
    samples = {id(fit.sample): fit.sample for fit in fits}
    rest = {key: sample.of_rows(~test) for key, sample in samples.items()}
    if not all(len(channel) for sample in rest.values() for channel in sample.channels):
        return [None] * len(fits)

    def again(fit: Fit) -> Fit | None:
        return alone(extended, refitting(fit, rest[id(fit.sample)], extended))

    return extended.side_by_side([partial(again, fit) for fit in fits])


def errors_left_out(fit: Fit, extended: Extended, folds: Folds) -> Matrix:
    """Return the errors of all rows of the sample, each predicted without its fold, in units of the noise, (rows,).

    NaN where the model fails without the fold.
    """
    made = np.full(fit.sample.rows, np.nan)
    rows = np.concatenate([channel.rows for channel in fit.sample.channels])
    tests = [folds.test(fold) for fold in range(folds.count)]
    tasks = [partial(refitted, [fit], extended, test) for test in tests]
    for test, (again,) in zip(tests, extended.side_by_side(tasks), strict=True):
        if again is not None:
            made = np.where(test[rows], fit.sample.left(again.predicted), made)
    return made


def carries_over(at: Fit, more: Fit, extended: Extended, folds: Folds) -> float:
    """Return by how many standard errors rows left out are likelier under one explanation than under another.

    What the inputs no longer have to move counts as well: an explanation that fits by moving them far predicts as well
    as the true one, and is unlikely all the same.
    """
    errors = extended.side_by_side([partial(errors_left_out, each, extended, folds) for each in (at, more)])
    before, after = (more.sample.losses(each, more.left) for each in errors)
    fallen = (before - after)[np.isfinite(before - after)]
    if len(fallen) < 2:
        return 0.0
    inputs = float(at.inputs @ at.inputs) - float(more.inputs @ more.inputs)
    error = float(fallen.std()) * sqrt(len(fallen))
    return (float(fallen.sum()) + inputs) / max(error, 1e-300)
