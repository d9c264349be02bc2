"""The machine as measured: what the model says at every row, and what each tolerated input would change.

All rows of a file are one machine. Its inputs lie within their tolerances: a prior of mean and standard deviation each,
and of their correlation where they scatter together. Collinear inputs are carried as few directions, each with unit
prior.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from truing.arrays import Indices, Matrix
from truing.diagnosis.records import Records
from truing.gauge import Trial, one_machine, read_trials
from truing.setup import Setup
from truing.studies.sampling import root_of, scatter_of

Predicted = Mapping[str, Matrix]
INPUT_STEP = 0.5
"""Standard deviations to each side by which an input is moved for its slope over the width of its tolerance."""
FAINTEST = 0.01
"""Root mean square, in units of the noise, below which these rows do not see a direction of the inputs."""
MANY = 200_000
"""Slopes of more rows than this are kept in single precision, and added up in double precision."""
ROWS_AT_ONCE = 8192
"""Rows that are added up in one pass, so that long records need no second copy."""


@dataclass(frozen=True)
class Tolerated:
    """One input that may be off its nominal: where the prior has its mean (from the start) and its sd, SI.

    ``design`` is the nominal value itself, SI. ``file`` is the number of the file it belongs to where every file has
    its own machine in this respect, else -1.
    """

    name: str
    mean: float
    sd: float
    design: float
    file: int = -1


@dataclass(frozen=True)
class Calibration:
    """The start of a calibration: prediction at the start, and one column per tolerated input and measured result.

    ``design`` is the setup as it is given, ``start`` that at its calibrated inputs. ``slopes[result]`` has shape
    (n, inputs): the change of the result by one standard deviation of the input.
    """

    design: Setup
    start: Setup
    records: Records
    base: Predicted
    inputs: tuple[Tolerated, ...]
    slopes: Predicted

    @cached_property
    def on(self) -> Mapping[str, Mapping[str, float]]:
        """By effect that is on at the start: its unknowns, SI."""
        return {active.effect.name: active.values for active in self.start.effects}

    @cached_property
    def shifts(self) -> Predicted:
        """By result (n,): what the means of the tolerances add to the prediction at the start."""
        means = np.array([tolerated.mean / tolerated.sd for tolerated in self.inputs])
        return {name: times(slopes, means) for name, slopes in self.slopes.items()}

    @cached_property
    def together(self) -> Matrix | None:
        """How unit directions move the inputs, in standard deviations (inputs, inputs); None where all are independent.

        Inputs that scatter together do so in one machine: one that every file has for itself, with others of its file.
        """
        names = list(dict.fromkeys(tolerated.name for tolerated in self.inputs))
        places = [names.index(tolerated.name) for tolerated in self.inputs]
        files = np.array([tolerated.file for tolerated in self.inputs])
        alike = scatter_of(self.start).alike(names)[np.ix_(places, places)] * (files[:, None] == files)
        return root_of(alike) if np.any(alike != np.eye(len(alike))) else None

    def directions(self, gram: Matrix, rows: int) -> Matrix:
        """Return the combinations of inputs that the data can see, as they are drawn: see ``directions_of``."""
        root = self.together
        return directions_of(gram, rows) if root is None else root @ directions_of(root.T @ gram @ root, rows)


def predict(setup: Setup, records: Records) -> Predicted:
    """Return what the gauge would show of every measured result, SI, shape (n,)."""
    return next(predict_each(setup, records, [{}]))


def predict_each(setup: Setup, records: Records, trials: Sequence[Trial]) -> Iterator[Predicted]:
    """Give what the gauge would show in every trial: see ``read_trials``."""
    return read_trials(setup, records.rows, trials, tuple(records.measured))


def tolerated_inputs(setup: Setup, records: Records) -> list[Tolerated]:
    """Return every input or condition that scatters and is not itself measured."""
    start = one_machine(setup)
    per_file = set(setup.diagnose.per_file) if len(records.files) > 1 else set()
    priors: dict[str, tuple[float, float]] = {}  # mean, from the nominal, and sd: two on one input add up
    for by_input in setup.distributions().values():
        for name, distribution in by_input.items():
            mean, sd = priors.get(name, (0.0, 0.0))
            off = distribution.mean - float(setup.nominal(name))
            priors[name] = (mean + off, float((sd**2 + distribution.sd**2) ** 0.5))
    tolerated: list[Tolerated] = []
    for name, (mean, sd) in priors.items():
        if name in records.rows.columns or name in records.rows.series or sd <= 0:
            continue
        design = float(setup.nominal(name))
        offset = design + mean - float(start.nominal(name))
        files = range(len(records.files)) if name in per_file else (-1,)
        tolerated += [Tolerated(name, offset, sd, design, file) for file in files]
    return tolerated


def calibration_of(setup: Setup, records: Records) -> Calibration:
    """Evaluate the model at the start and around it, twice per tolerated input."""
    start = one_machine(setup)
    inputs = tolerated_inputs(setup, records)
    base = predict(start, records)
    kind = np.float32 if len(records) > MANY else np.float64
    slopes: dict[str, Any] = {
        name: np.zeros((len(records), len(inputs)), dtype=kind, order="F") for name in records.measured
    }
    for changed, own in _slopes(start, records, inputs):
        for index, tolerated in enumerate(inputs):
            if tolerated.name != changed:
                continue
            here = slice(None) if tolerated.file < 0 else records.file_of == tolerated.file
            for name, slope in own.items():
                slopes[name][here, index] = slope[here]
    return Calibration(setup, start, records, base, tuple(inputs), slopes)


def _slopes(start: Setup, records: Records, inputs: Sequence[Tolerated]) -> Iterator[tuple[str, dict[str, Matrix]]]:
    """Give by input the central difference of every result over one standard deviation, 0 where the model fails."""
    moves = {tolerated.name: INPUT_STEP * tolerated.sd for tolerated in inputs}
    ends = [{name: float(start.nominal(name)) + sign * move} for name, move in moves.items() for sign in (1, -1)]
    answers = predict_each(start, records, ends)
    for name, up, down in zip(moves, answers, answers, strict=False):
        slopes = {result: (up[result] - down[result]) / (2 * INPUT_STEP) for result in records.measured}
        yield name, {result: np.where(np.isfinite(slope), slope, 0.0) for result, slope in slopes.items()}


def gram_of(slopes: Matrix, rows: Indices) -> Matrix:
    """Return the inner products of columns over some rows, block by block in double precision."""
    total = np.zeros((slopes.shape[1], slopes.shape[1]))
    for block in in_blocks(len(rows)):
        part = slopes[rows[block]].astype(float)
        total += part.T @ part
    return total


def directions_of(gram: Matrix, rows: int) -> Matrix:
    """Return the combinations of inputs that the data can see, shape (inputs, K), columns of unit length.

    ``gram`` holds the inner products of the slopes over ``rows`` values, in units of the noise. Kept are singular
    values above ``FAINTEST`` of the noise per row; with a prior of one standard deviation on every input, each
    direction has the same prior.
    """
    if len(gram) == 0:
        return np.zeros((0, 0))
    values, vectors = np.linalg.eigh(gram)
    kept = np.sqrt(np.maximum(values, 0) / max(rows, 1)) > FAINTEST
    vectors = vectors[:, kept][:, ::-1]
    upright = np.sign(np.linspace(1, 2, len(vectors)) ** 2 @ vectors)  # eigenvectors have no sign of their own
    return np.ascontiguousarray(vectors * np.where(upright == 0, 1.0, upright))


def in_blocks(rows: int, size: int = 0) -> Iterator[slice]:
    """Give the rows in blocks, one after another, of one size where it is given."""
    size = size or ROWS_AT_ONCE
    return (slice(begin, begin + size) for begin in range(0, rows, size))


def times(matrix: Matrix, vector: Matrix) -> Matrix:
    """Return a matrix of many rows times a vector, in double precision, block by block."""
    made = np.empty(len(matrix))
    for rows in in_blocks(len(matrix)):
        made[rows] = matrix[rows] @ vector
    return made
