"""An explanation as fitted: its numbers, the inputs, what the model then says, and what is left of the readings."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf, log

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter
from truing.diagnosis.result import AT_BOUND, OUTSIDE
from truing.diagnosis.sample import Sample

STEP = 1e-4
"""Of a number, or of a hundredth of its range: by how much it is moved for a difference."""
WIDE = 0.05
"""The same where the model jumps or scatters by itself: of a number, or of a fifth of its range."""


@dataclass(frozen=True, eq=False)
class Fit:
    """An explanation as fitted: numbers of every cause (SI), directions of the inputs, and what the model then says.

    ``predicted`` holds results by name, SI on all rows of the records; ``left`` what is left of the sample's rows in
    units of the noise. ``cost`` is -2 log likelihood plus the prior of the inputs, in the noise that it was fitted in.
    ``slopes`` holds by result what the numbers draw, (n, numbers), SI per SI or per logarithm, and ``moves`` what the
    directions of the inputs draw, (n, K), SI, both as the fit left them; nothing where they were not taken.
    """

    causes: tuple[Candidate, ...]
    values: tuple[Matrix, ...]
    inputs: Matrix
    predicted: dict[str, Matrix]
    left: Matrix
    cost: float
    sample: Sample = field(repr=False)
    slopes: dict[str, Matrix] = field(default_factory=dict, repr=False)
    moves: dict[str, Matrix] = field(default_factory=dict, repr=False)

    @property
    def key(self) -> frozenset[str]:
        """Which causes are on, whatever their order."""
        return frozenset(cause.tag for cause in self.causes)

    @property
    def names(self) -> tuple[str, ...]:
        """What the answer calls its causes, each once."""
        return tuple(dict.fromkeys(cause.name for cause in self.causes))

    @property
    def size(self) -> int:
        """How many numbers its causes have."""
        return sum(cause.size for cause in self.causes)

    @property
    def weakest_first(self) -> tuple[int, list[tuple[int, bool, int, str]]]:
        """Which of several explanations that are as good is taken: fewest causes, under the weakest of their names."""
        return len(self.causes), sorted(cause.weakest_first for cause in self.causes)

    @property
    def moved(self) -> Matrix:
        """How far each tolerated input is moved, in standard deviations from its mean."""
        return moved_by(self.sample, self.inputs)

    def of(self, cause: Candidate) -> Matrix:
        """Return the numbers of one of its causes, SI."""
        return self.values[[each.tag for each in self.causes].index(cause.tag)]

    def less(self, index: int) -> tuple[tuple[Candidate, ...], tuple[Matrix, ...]]:
        """Return its causes, and their numbers, but for one."""
        return self.causes[:index] + self.causes[index + 1 :], self.values[:index] + self.values[index + 1 :]

    def in_sample(self, sample: Sample) -> Fit:
        """Return the same numbers judged in other noise or on other rows."""
        left = sample.left(self.predicted)
        inputs, moves = self.inputs, self.moves
        if sample.directions is not self.sample.directions:
            is_seen = sample.directions.size > 0
            solved = np.linalg.lstsq(sample.directions, self.moved, rcond=None)[0] if is_seen else np.zeros(0)
            inputs, moves = np.asarray(solved)[: sample.directions.shape[1]], {}
        cost = sample.cost(left, inputs)
        return replace(self, left=left, inputs=inputs, cost=cost, sample=sample, moves=moves)


def moved_by(sample: Sample, inputs: Matrix) -> Matrix:
    """Return by how many standard deviations directions move each tolerated input from its mean."""
    return sample.directions @ inputs if len(inputs) else np.zeros(len(sample.machine.inputs))


def inward(number: Parameter, size: float) -> tuple[float, float]:
    """Return the bounds of a number as the fit sees it: a logarithm, or in units of ``size``."""
    if number.is_log:
        return log(number.low), log(number.high)
    return number.low / size, number.high / size


def size_of(number: Parameter, scales: dict[str, float]) -> float:
    """Return the unit in which a fit counts a number: its largest bound, or the noise of the result that it adds to."""
    largest = max(abs(number.low), abs(number.high))
    return largest if largest < inf else scales.get(number.name.rpartition(":")[0], 1.0)


def steps_of(u: Matrix, log: Matrix, *, is_rough: bool) -> Matrix:
    """Return by how much numbers, as a fit sees them, are moved for their derivatives."""
    if is_rough:
        return WIDE * np.where(log, 1.0, np.maximum(np.abs(u), 0.2))
    return np.asarray(STEP * np.maximum(np.abs(u), np.where(log, 1.0, 1e-2)))


def differ(one: Fit, other: Fit) -> float:
    """Return how far two explanations draw apart: sum of squares in units of the noise that the first leaves."""
    sample = one.sample
    apart = sample.left(one.predicted) - sample.left(other.predicted)
    return float(np.sum((sample.roots(one.left) * apart) ** 2))


def input_value(fit: Fit, index: int) -> float:
    """Return a tolerated input as calibrated and shifted, SI."""
    machine = fit.sample.machine
    shifts = zip(fit.causes, fit.values, strict=True)
    off = float(fit.moved[index]) + sum(float(values[0]) for cause, values in shifts if cause.tolerated == index)
    tolerated = machine.inputs[index]
    return float(machine.start.nominal(tolerated.name)) + tolerated.mean + off * tolerated.sd


def signs_of_wrong(fit: Fit) -> int:
    """Count what a wrong explanation looks like: unknowns at their bounds, inputs far outside of their tolerances."""
    registered = [pair for pair in zip(fit.causes, fit.values, strict=True) if pair[0].effect is not None]
    numbers = [pair for cause, values in registered for pair in zip(cause.numbers, values, strict=True)]
    return sum(is_at_bound(number, float(value)) for number, value in numbers) + len(far_inputs(fit))


def is_at_bound(number: Parameter, value: float) -> bool:
    """Whether a fitted number lies at an end of its declared range, other than at zero."""
    if not number.is_free:
        return False
    reach = AT_BOUND * (number.high - number.low)
    return any(end and abs(end) < inf and abs(value - end) <= reach for end in (number.low, number.high))


def far_inputs(fit: Fit) -> list[int]:
    """Return the places of inputs that no cause shifts and that were moved far beyond their tolerances."""
    shifted = {cause.tolerated for cause in fit.causes}
    free = [(index, tolerated) for index, tolerated in enumerate(fit.sample.machine.inputs) if index not in shifted]
    return [
        index for index, tolerated in free if abs((input_value(fit, index) - tolerated.design) / tolerated.sd) > OUTSIDE
    ]
