"""The rows as a fit sees them: readings in units of their noise, what the tolerated inputs draw, how many rows count.

Each result in its own noise. Where rows have an order that means something (a time, a path), what an explanation leaves
is alike in neighbours: this memory of the noise is taken out, so that a slow curve counts for the few independent rows
that it has, and a jump for all of them. All explanations have the memory that the fairest leaves, and its tails:
where they are those of Student's t, a reading far out says little, but the farther out the less likely it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import exp, inf, log

import numpy as np

from truing.arrays import Indices, Mask, Matrix, Sides
from truing.diagnosis.machine import Calibration, Predicted, gram_of
from truing.diagnosis.noise import (
    Autocorrelation,
    SpreadTrend,
    Tails,
    beyond,
    difference,
    expected,
    rounding,
    shares,
    whiten,
    worth,
)

WITHOUT_MEMORY, NORMAL, CONSTANT = Autocorrelation(), Tails(inf, 4.5), SpreadTrend()
MOST_SCALE_ROUNDS, SCALE_SETTLED = 50, 1e-6
"""Newton steps on the logarithm of a scale (the likelihood has one top), until it changes by a smaller share."""


@dataclass(frozen=True)
class NoiseModel:
    """What is known of the noise of one result: scale (SI), weights by row, memory, tails, spread.

    ``given`` are the weights that a stated standard deviation of the readings asks for, in any case; they and
    ``weights`` have shape (n,) over all rows of the records. ``typical`` is the geometric mean of the readings (SI)
    where they are compared as logarithms, else 0. ``at`` is the prediction about which logarithms and censored rows are
    taken as straight, (n,) SI; None where all rows are.
    """

    scale: float
    given: Matrix
    weights: Matrix
    memory: Autocorrelation = WITHOUT_MEMORY
    tails: Tails = NORMAL
    spread: SpreadTrend = CONSTANT
    typical: float = 0.0
    at: Matrix | None = None


@dataclass(frozen=True)
class Channel:
    """One measured result on the rows of a fit: their places among the records (n,), and where runs begin (n,).

    ``values`` are SI, ``weights`` one over the relative standard deviation. ``least`` is the smallest mean square, in
    units of the noise, that is more than rounding or the steps of the gauge. ``freedom`` is that of Student's t, which
    the noise follows, infinite where it is normal. ``sides`` are None where no row is censored; ``typical`` and ``at``,
    on all rows, are those of the noise.
    """

    name: str
    rows: Indices
    starts: Mask
    values: Matrix
    weights: Matrix
    scale: float
    least: float
    memory: Autocorrelation
    freedom: float = inf
    sides: Sides | None = None
    typical: float = 0.0
    at: Matrix | None = None

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def read(self) -> Indices | slice:
        """Where the rows stand whose value was read: all that are not censored."""
        return slice(None) if self.sides is None else np.flatnonzero(self.sides == 0)

    @cached_property
    def known(self) -> float:
        """Number of rows whose value was read, and what censored ones are worth beside them."""
        if self.sides is None or self.at is None:
            return float(len(self))
        return max(worth(self.off(self.at), self.sides), 1.0)

    def left(self, predicted: Matrix) -> Matrix:
        """Return what a prediction (..., all rows, SI) leaves of the readings, in units of the noise, (..., n)."""
        off = self.off(predicted)
        return off if self.sides is None else beyond(off, self.sides)

    def off(self, predicted: Matrix) -> Matrix:
        """Return what a prediction would leave were every reading the value itself, in units of the noise, (..., n)."""
        return difference(self.values, predicted[..., self.rows], self.typical) * (self.weights / self.scale)

    @cached_property
    def factors(self) -> Matrix:
        """By how much each row leaves less for what is added to its prediction, per SI, (n,)."""
        return self.factors_at(self.at)

    def factors_at(self, predicted: Matrix | None) -> Matrix:
        """Return the factors about a prediction, SI on all rows."""
        made = self.weights / self.scale
        if predicted is not None and self.typical:
            made = made * (self.typical / predicted[self.rows])
        if predicted is not None and self.sides is not None:
            made = made * shares(self.off(predicted), self.sides)
        return np.asarray(made)

    def curve(self, added: Matrix, at: Matrix | None = None) -> Matrix:
        """Return what is added to predictions (all rows,) or (all rows, c), SI, in units of the noise, (n,) or (n, c).

        Rows that are censored or compared as logarithms follow it as they do about a prediction, ``at``.
        """
        factors = self.factors if at is None or self.at is None else self.factors_at(at)
        return self.white((added[self.rows].T * factors).T)

    def white(self, values: Matrix) -> Matrix:
        """Return values in units of the noise, (n,) or (n, c), with the memory of the noise taken out."""
        return whiten(values, self.starts, self.memory)

    def square(self, left: Matrix) -> float:
        """Return the square of the scale that suits what is left best, no smaller than what is more than rounding."""
        with np.errstate(over="ignore"):  # what a wild step leaves may be beyond any number
            squares = left**2
            square = max(float(squares.sum()) / self.known, self.least)
        for _ in range(MOST_SCALE_ROUNDS if self.freedom < inf and square < inf else 0):
            outward = squares / (self.freedom * square + squares)
            total = float(outward.sum())
            steep = max(total - float(outward @ outward), 1e-300)
            rise = (total - self.known / (self.freedom + 1)) / steep
            before, square = square, max(square * exp(min(max(rise, -2.0), 2.0)), self.least)
            if abs(square - before) <= SCALE_SETTLED * square:
                break
        return square

    def losses(self, left: Matrix, square: float) -> Matrix:
        """Return by row -2 log likelihood but for constants, for a scale of this square, (n,)."""
        if self.freedom == inf:
            return np.asarray(left**2 / square)
        return np.asarray((self.freedom + 1) * np.log1p(left**2 / (self.freedom * square)))

    def shares(self, left: Matrix, square: float) -> Matrix:
        """Return by row how much of a squared reading counts, (n,): what lies far out in heavy tails says little."""
        if self.freedom == inf:
            return np.ones(len(self))
        return np.asarray((self.freedom + 1) / (self.freedom + left**2 / square))


@dataclass(frozen=True)
class Sample:
    """All measured values of a fit, one result behind another, and the directions in which the inputs may move.

    ``directions`` has shape (inputs, K): u of them move the inputs by ``directions @ u`` standard deviations from
    their means. What is left, and what is drawn, is taken without the memory of the noise. ``whole`` is the sample of
    which this one is a part, with the same directions.
    """

    machine: Calibration
    noise: Mapping[str, NoiseModel]
    channels: tuple[Channel, ...]
    directions: Matrix
    mask: Mask
    whole: Sample | None = field(default=None, repr=False)

    @property
    def rows(self) -> int:
        """Number of measured values."""
        return sum(len(channel) for channel in self.channels)

    @property
    def known(self) -> float:
        """Number of measured values; of censored ones what they are worth beside the others."""
        return sum(channel.known for channel in self.channels)

    @property
    def has_memory(self) -> bool:
        """Whether the noise of any result has a memory."""
        return any(channel.memory != WITHOUT_MEMORY for channel in self.channels)

    @cached_property
    def parts(self) -> list[slice]:
        """Where the values of each channel stand among all."""
        ends = np.cumsum([0, *(len(channel) for channel in self.channels)])
        return [slice(int(begin), int(end)) for begin, end in pairwise(ends)]

    def left(self, predicted: Predicted) -> Matrix:
        """Return what is left of all readings in units of their noise, (rows,)."""
        return np.concatenate([each.white(each.left(predicted[each.name])) for each in self.channels])

    def curve(self, added: Predicted, at: Predicted | None = None) -> Matrix:
        """Return what is added to predictions, (n,) or (n, c), in units of the noise, (rows,) or (rows, c)."""
        return np.concatenate(
            [each.curve(added[each.name], None if at is None else at[each.name]) for each in self.channels]
        )

    @cached_property
    def drawn(self) -> Matrix:
        """What the directions of the inputs add to the predictions, in units of the noise, (rows, K)."""
        return self.curve(self.moves)

    @cached_property
    def moves(self) -> dict[str, Matrix]:
        """What the directions of the inputs add to the predictions about their means, by result (n, K), SI."""
        if self.whole is not None:
            return self.whole.moves
        return {name: slopes @ self.directions for name, slopes in self.machine.slopes.items()}

    def squares(self, left: Matrix) -> list[float]:
        """Return by channel the square of the scale of what is left of its values."""
        return [channel.square(left[part]) for channel, part in zip(self.channels, self.parts, strict=True)]

    def cost(self, left: Matrix, inputs: Matrix, squares: Sequence[float] | None = None) -> float:
        """Return -2 log likelihood of what is left, noise of every result free, plus the prior of the inputs.

        ``squares`` are those of what is left, where they are known.
        """
        total = float(inputs @ inputs)
        squares = self.squares(left) if squares is None else squares
        for channel, part, square in zip(self.channels, self.parts, squares, strict=True):
            total += channel.known * log(square)
            if channel.freedom < inf:
                total += float(channel.losses(left[part], square).sum())
        return total

    def losses(self, left: Matrix, judge: Matrix) -> Matrix:
        """Return by row what is left as -2 log likelihood in noise of the scale that ``judge`` leaves, (rows,)."""
        each = zip(self.channels, self.parts, self.squares(judge), strict=True)
        return np.concatenate([channel.losses(left[part], square) for channel, part, square in each])

    def roots(self, left: Matrix, squares: Sequence[float] | None = None) -> Matrix:
        """Return by row what makes squares of what is left count: its noise is the one that it shows, (rows,)."""
        each = zip(self.channels, self.parts, self.squares(left) if squares is None else squares, strict=True)
        return np.concatenate([np.sqrt(channel.shares(left[part], square) / square) for channel, part, square in each])

    @cached_property
    def stride(self) -> float:
        """How many times a step that counts far readings by their shares may be taken: in heavy tails it is short.

        Of every result it is the full information over the expected one, below 2, so that every step leads down.
        """
        return min(((each.freedom + 3) / (each.freedom + 1) if each.freedom < inf else 1.0) for each in self.channels)

    def of_rows(self, mask: Mask) -> Sample:
        """Return some of the rows, with the same noise."""
        return replace(sample_of(self.machine, self.noise, self.mask & mask, self.directions), whole=self)


def has_order(machine: Calibration) -> bool:
    """Whether rows follow one another in a way that means something: a time that goes on, or an axis of the model."""
    records = machine.records
    has_time = any(covariate.role == "time" and not covariate.is_constant for covariate in records.covariates.values())
    return has_time or bool(records.rows.series)


def sample_of(
    machine: Calibration, noise: Mapping[str, NoiseModel], mask: Mask, directions: Matrix | None = None
) -> Sample:
    """Return the rows that are marked, where the model itself has an answer; directions are looked for if not given."""
    channels, is_again = [], np.diff(mask.astype(np.intp), prepend=0) > 0  # after a gap the noise starts anew
    pieces: Indices = np.cumsum(starts_of(machine.records.run_of, np.arange(len(mask))) | is_again)
    for name, own in noise.items():
        values = machine.records.measured[name]
        rows = np.flatnonzero(mask & np.isfinite(values) & np.isfinite(machine.base[name]))
        starts = starts_of(pieces, rows)
        sides = machine.records.sides[name][rows] if name in machine.records.sides else None
        if sides is not None:  # what a censored row leaves says nothing of its neighbours
            starts |= sides != 0
            starts[1:] |= sides[:-1] != 0
        known = rows if sides is None else rows[sides == 0]
        channels.append(
            Channel(
                name, rows, starts, values[rows], own.weights[rows], own.scale,
                _least(machine, own, name, known), own.memory, own.tails.freedom, sides, own.typical, own.at,
            )
        )  # fmt: skip
    if directions is None:
        directions = directions_seen(machine, noise, mask)
    return Sample(machine, noise, tuple(channels), directions, mask)


def directions_seen(machine: Calibration, noise: Mapping[str, NoiseModel], mask: Mask) -> Matrix:
    """Return the combinations of inputs that these rows can see in their noise."""
    measured = machine.records.measured
    places = {name: np.flatnonzero(mask & np.isfinite(measured[name])) for name in noise}
    gram = sum(
        gram_of(compared_slopes(machine, name, noise[name].typical), rows) / noise[name].scale ** 2
        for name, rows in places.items()
    )
    return machine.directions(np.asarray(gram), sum(len(rows) for rows in places.values()))


def compared_slopes(machine: Calibration, name: str, typical: float) -> Matrix:
    """Return what tolerated inputs add to a result as it is compared, (n, inputs), SI."""
    slopes = machine.slopes[name]
    return slopes * (typical / machine.base[name])[:, None] if typical else slopes


def _least(machine: Calibration, noise: NoiseModel, name: str, rows: Indices) -> float:
    """Return the smallest mean square, in units of the noise, that is more than rounding or the steps of the gauge."""
    values = machine.records.measured[name][rows]
    off = difference(values, machine.base[name][rows], noise.typical)
    return max(rounding(off, values) ** 2, resolution_of(values) ** 2 / 12) / noise.scale**2


def resolution_of(values: Matrix) -> float:
    """Return the step in which readings come where all of them are multiples of one, else 0."""
    distinct = np.unique(values)
    if len(distinct) < 3 or len(distinct) > len(values) / 2:
        return 0.0
    gaps = np.diff(distinct)
    steps = gaps / gaps.min()
    return float(gaps.min()) if np.all(np.abs(steps - np.round(steps)) < 1e-3 * steps) else 0.0


def starts_of(run_of: Indices, rows: Indices) -> Mask:
    """Mark the first row of every run."""
    return np.asarray(np.diff(run_of[rows], prepend=-1) != 0)


def residuals_of(machine: Calibration) -> dict[str, Matrix]:
    """Return measured minus predicted at the mean of the tolerances, SI, NaN where missing or censored."""
    made = {}
    for name, values in machine.records.measured.items():
        off = difference(values, machine.base[name] + machine.shifts[name], typical_of(machine, name))
        made[name] = np.where(machine.records.known(name), off, np.nan)
    return made


def typical_of(machine: Calibration, name: str) -> float:
    """Return the geometric mean of the readings of a result that is compared as logarithms; 0 of any other."""
    if name not in machine.start.diagnose.lognormal:
        return 0.0
    return float(np.exp(np.nanmean(np.log(machine.records.measured[name][~machine.records.held_out]))))


def errors_of(machine: Calibration, name: str, noise: NoiseModel, predicted: Matrix) -> Matrix:
    """Return what a prediction leaves of the readings of a result as they were read, SI on all rows, NaN where missing.

    A censored row leaves what is to be expected beyond its end, in this noise.
    """
    off, sides = difference(machine.records.measured[name], predicted, noise.typical), machine.records.sides.get(name)
    if sides is None:
        return off
    unit = noise.scale / noise.weights
    return np.asarray(expected(off / unit, sides) * unit)
