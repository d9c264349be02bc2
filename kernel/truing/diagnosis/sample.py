"""The rows as a fit sees them: readings in units of their noise, what the tolerated inputs draw, how many rows count.

Each result in its own noise. Where rows have an order that means something (a time, a path), what an explanation leaves
is alike in neighbours: this memory of the noise is taken out, so that a slow curve counts for the few independent rows
that it has, and a jump for all of them. All explanations have the memory that the fairest leaves, and its tails:
where they are those of Student's t, a reading far out says little, but the farther out the less likely it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import inf, log
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.columns import in_blocks
from truing.diagnosis.machine import Machine, Predicted, gram_of
from truing.diagnosis.noise import (
    SETTINGS,
    Setting,
    Spread,
    Tails,
    clipped,
    likelihood_of,
    robust_sd,
    spread_of,
    standardised,
    tails_of,
    weights_of,
    whiten,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

WITHOUT_MEMORY, NORMAL, CONSTANT = Setting(), Tails(inf, 4.5), Spread()
SMALLEST_SHARE = 1e-6
"""Of the readings: noise is no smaller, or it is rounding."""
ROUNDS, SETTLED = 50, 1e-9
FEWEST_OF_MEMORY = 20
"""Rows from which on their memory is learnt."""


@dataclass(frozen=True)
class Noise:
    """What is known of the noise of one result: scale (SI), weights by row, memory, tails, spread.

    ``given`` are the weights that a stated standard deviation of the readings asks for, in any case; they and
    ``weights`` have shape (n,) over all rows of the records.
    """

    scale: float
    given: Matrix
    weights: Matrix
    memory: Setting = WITHOUT_MEMORY
    tails: Tails = NORMAL
    spread: Spread = CONSTANT


@dataclass(frozen=True)
class Channel:
    """One measured result on the rows of a fit: their places among the records (n,), and where runs begin (n,).

    ``values`` are SI, ``weights`` one over the relative standard deviation. ``least`` is the smallest mean square, in
    units of the noise, that is more than rounding or the steps of the gauge. ``freedom`` is that of Student's t, which
    the noise follows, infinite where it is normal.
    """

    name: str
    rows: NDArray[np.intp]
    starts: NDArray[np.bool_]
    values: Matrix
    weights: Matrix
    scale: float
    least: float
    memory: Setting
    freedom: float = inf

    def __len__(self) -> int:
        return len(self.rows)

    def left(self, predicted: Matrix) -> Matrix:
        """Return what a prediction (..., all rows, SI) leaves of the readings, in units of the noise, (..., n)."""
        return np.asarray((self.values - predicted[..., self.rows]) * (self.weights / self.scale))

    def white(self, values: Matrix) -> Matrix:
        """Return values in units of the noise, (n,) or (n, c), with the memory of the noise taken out."""
        return whiten(values, self.starts, self.memory)

    def square(self, left: Matrix) -> float:
        """Return the square of the scale that suits what is left best, no smaller than what is more than rounding."""
        square = max(float(np.mean(left**2)), self.least)
        for _ in range(ROUNDS if self.freedom < inf else 0):
            shares = 1 / (self.freedom + left**2 / square)
            before, square = square, max(float(shares @ left**2) / float(shares.sum()), self.least)
            if abs(square - before) <= SETTLED * square:
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
    their means. What is left, and what is drawn, is taken without the memory of the noise.
    """

    machine: Machine
    noise: Mapping[str, Noise]
    channels: tuple[Channel, ...]
    directions: Matrix
    mask: NDArray[np.bool_]

    @property
    def rows(self) -> int:
        """Number of measured values."""
        return sum(len(channel) for channel in self.channels)

    @cached_property
    def parts(self) -> list[slice]:
        """Where the values of each channel stand among all."""
        ends = np.cumsum([0, *(len(channel) for channel in self.channels)])
        return [slice(int(begin), int(end)) for begin, end in pairwise(ends)]

    def left(self, predicted: Predicted) -> Matrix:
        """Return what is left of all readings in units of their noise, (rows,)."""
        return np.concatenate([each.white(each.left(predicted[each.name])) for each in self.channels])

    def curve(self, added: Predicted) -> Matrix:
        """Return what is added to predictions, (n,) or (n, c), in units of the noise, (rows,) or (rows, c)."""
        parts = []
        for each in self.channels:
            rows = added[each.name][each.rows]
            parts.append(each.white((rows.T * (each.weights / each.scale)).T))
        return np.concatenate(parts)

    @cached_property
    def drawn(self) -> Matrix:
        """What the directions of the inputs add to the predictions, in units of the noise, (rows, K)."""
        return self.curve({name: slopes @ self.directions for name, slopes in self.machine.slopes.items()})

    def squares(self, left: Matrix) -> list[float]:
        """Return by channel the square of the scale of what is left, in units of the noise."""
        return [channel.square(left[part]) for part, channel in zip(self.parts, self.channels, strict=True)]

    def cost(self, left: Matrix, inputs: Matrix) -> float:
        """Return -2 log likelihood of what is left, noise of every result free, plus the prior of the inputs."""
        total = float(inputs @ inputs)
        for part, channel, square in zip(self.parts, self.channels, self.squares(left), strict=True):
            total += len(channel) * log(square)
            if channel.freedom < inf:
                total += float(channel.losses(left[part], square).sum())
        return total

    def losses(self, left: Matrix, judge: Matrix) -> Matrix:
        """Return by row what is left as -2 log likelihood in noise of the scale that ``judge`` leaves, (rows,)."""
        each = zip(self.parts, self.channels, self.squares(judge), strict=True)
        return np.concatenate([channel.losses(left[part], square) for part, channel, square in each])

    def roots(self, left: Matrix) -> Matrix:
        """Return by row what makes squares of what is left count: its noise is the one that it shows, (rows,)."""
        each = zip(self.parts, self.channels, self.squares(left), strict=True)
        return np.concatenate([np.sqrt(channel.shares(left[part], square) / square) for part, channel, square in each])

    def of_rows(self, mask: NDArray[np.bool_]) -> Sample:
        """Return some of the rows, with the same noise."""
        return sample_of(self.machine, self.noise, self.mask & mask, self.directions)


def has_order(machine: Machine) -> bool:
    """Whether rows follow one another in a way that means something: a time that goes on, or an axis of the model."""
    records = machine.records
    times = [item for item in records.covariates.values() if item.role == "time" and not item.is_constant]
    return bool(times) or bool(records.rows.series)


def sample_of(
    machine: Machine, noise: Mapping[str, Noise], mask: NDArray[np.bool_], directions: Matrix | None = None
) -> Sample:
    """Return the rows that are marked, where the model itself has an answer; directions are looked for if not given."""
    channels = []
    for name, own in noise.items():
        values = machine.records.measured[name]
        rows = np.flatnonzero(mask & np.isfinite(values) & np.isfinite(machine.base[name]))
        starts = starts_of(_pieces(machine, mask), rows)
        channels.append(
            Channel(
                name, rows, starts, values[rows], own.weights[rows], own.scale,
                _least(machine, name, rows, own.scale), own.memory, own.tails.freedom,
            )
        )  # fmt: skip
    if directions is None:
        directions = directions_seen(machine, noise, mask)
    return Sample(machine, noise, tuple(channels), directions, mask)


def directions_seen(machine: Machine, noise: Mapping[str, Noise], mask: NDArray[np.bool_]) -> Matrix:
    """Return the combinations of inputs that these rows can see in their noise."""
    measured = machine.records.measured
    places = {name: np.flatnonzero(mask & np.isfinite(measured[name])) for name in noise}
    gram = sum(gram_of(machine.slopes[name], rows) / noise[name].scale ** 2 for name, rows in places.items())
    return machine.directions(np.asarray(gram), sum(len(rows) for rows in places.values()))


def _least(machine: Machine, name: str, rows: NDArray[np.intp], scale: float) -> float:
    """Return the smallest mean square, in units of the noise, that is more than rounding or the steps of the gauge."""
    values = machine.records.measured[name][rows]
    rounding = SMALLEST_SHARE * float(np.sqrt(np.mean((values - machine.base[name][rows]) ** 2))) if len(rows) else 0.0
    return max(rounding**2, resolution_of(values) ** 2 / 12, 1e-300) / scale**2


def resolution_of(values: Matrix) -> float:
    """Return the step in which readings come where all of them are multiples of one, else 0."""
    distinct = np.unique(values)
    if len(distinct) < 3 or len(distinct) > len(values) / 2:
        return 0.0
    gaps = np.diff(distinct)
    step = float(gaps.min())
    steps = gaps / step
    return step if step > 0 and bool(np.all(np.abs(steps - np.round(steps)) < 1e-3 * steps)) else 0.0


def starts_of(run_of: NDArray[np.intp], rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Mark the first row of every run."""
    runs = run_of[rows]
    starts = np.ones(len(rows), dtype=bool)
    starts[1:] = runs[1:] != runs[:-1]
    return starts


def _pieces(machine: Machine, mask: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Number the pieces of runs that are left when only some rows are taken: a gap starts the noise anew."""
    runs = machine.records.run_of
    gap = np.zeros(len(mask), dtype=np.intp)
    gap[1:] = (runs[1:] != runs[:-1]) | (mask[1:] & ~mask[:-1])
    return np.cumsum(gap)


def residuals_of(machine: Machine) -> dict[str, Matrix]:
    """Return measured minus predicted at the mean of the tolerances, SI, NaN where missing."""
    measured = machine.records.measured
    return {name: values - machine.base[name] - machine.shifts[name] for name, values in measured.items()}


def first_noise(machine: Machine) -> dict[str, Noise]:
    """Return a first idea of the noise: what the tolerated inputs and powers of all covariates cannot explain."""
    made = {}
    moved = [item for item in machine.records.covariates.values() if not item.is_constant and item.role != "order"]
    drivers = [standardised(item.values) for item in moved]
    for name, values in residuals_of(machine).items():
        here = np.flatnonzero(np.isfinite(values) & ~machine.records.held_out)
        triangle = np.zeros((0, machine.slopes[name].shape[1] + 2 * len(drivers) + 2))
        for block in in_blocks(len(here)):
            rows = here[block]
            powers = [driver[rows] ** power for driver in drivers for power in (1, 2)]
            columns = np.column_stack([machine.slopes[name][rows], np.ones(len(rows)), *powers, values[rows]])
            triangle = np.asarray(np.linalg.qr(np.concatenate([triangle, columns]), mode="r"))
        floor = SMALLEST_SHARE * float(np.sqrt(np.mean(values[here] ** 2))) if len(here) else 0.0
        scale = max(_unexplained(triangle, len(here)), floor, 1e-300)
        given = _stated(machine, name)
        made[name] = Noise(scale, given, given)
    return made


def _unexplained(triangle: Matrix, rows: int) -> float:
    """Return the standard deviation that columns leave of the last one, of the triangle of their QR decomposition."""
    size = np.sqrt(np.sum(triangle[:, :-1] ** 2, axis=0))
    design = triangle[:, :-1][:, size > 0] / size[size > 0]
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    left = left[:, singular > 1e-6 * singular[0]] if len(singular) else left
    left = left[:, : max(1, rows // 3)]
    rest = triangle[:, -1] - left @ (left.T @ triangle[:, -1])
    return float(np.sqrt(rest @ rest / max(rows - left.shape[1], 1)))


def _stated(machine: Machine, name: str) -> Matrix:
    """Return the weights that stated standard deviations ask for: 1 where none is stated, less where it is larger."""
    stated = machine.records.sigma.get(name)
    if stated is None or not (stated > 0).any():
        return np.ones(len(machine.records))
    middle = float(np.median(stated[stated > 0]))
    return np.where(stated > 0, middle / np.where(stated > 0, stated, middle), 1.0)


def learnt(sample: Sample, predicted: Predicted, used: float) -> dict[str, Noise]:
    """Learn scale, spread, tails and memory of the noise from what an explanation leaves, ``used`` its free numbers.

    For the scale, readings that lie too far out count as where the tails end.
    """
    machine, drivers = sample.machine, _drivers(sample.machine)
    made = {}
    for channel in sample.channels:
        before, rows = sample.noise[channel.name], channel.rows
        left = machine.records.measured[channel.name][rows] - predicted[channel.name][rows]
        own = {**drivers, f"size of {channel.name}": np.abs(machine.base[channel.name])}
        spread = spread_of(left * before.given[rows], {name: values[rows] for name, values in own.items()})
        weights = before.given * weights_of(spread, own.get(spread.driver), rows, len(machine.records))
        weighted = left * weights[rows]
        floor = channel.scale * channel.least**0.5
        is_known = has_order(machine) and robust_sd(weighted) > 2 * floor
        memory = memory_of(weighted, channel.starts) if is_known else Setting()
        innovations = whiten(weighted, channel.starts, memory)
        is_noise = robust_sd(innovations) > 2 * floor
        tails = tails_of(innovations) if is_noise else before.tails
        kept = _moved_in(weighted, innovations, tails) if is_noise else weighted
        free = used / len(sample.channels)
        scale = float(np.sqrt(np.sum(kept**2) / max(len(rows) - free, 1.0)))
        made[channel.name] = Noise(max(scale, floor, 1e-300), before.given, weights, memory, tails, spread)
    return made


def _moved_in(weighted: Matrix, innovations: Matrix, tails: Tails) -> Matrix:
    """Return what is left with the rows that are too far from what their neighbours say moved to where tails end."""
    return weighted + clipped(innovations, tails) - innovations


def _drivers(machine: Machine) -> dict[str, Matrix]:
    """Return what the spread of noise may depend on: every covariate, and its size where it changes sign."""
    made: dict[str, Matrix] = {}
    for name, item in machine.records.covariates.items():
        if item.is_constant or item.role == "order":
            continue
        made[name] = item.values
        if np.nanmin(item.values) < 0 < np.nanmax(item.values):
            made[f"size of {name}"] = np.abs(item.values)
    return made


def memory_of(left: Matrix, starts: NDArray[np.bool_]) -> Setting:
    """Return the filter that makes what is left likeliest, its parameters paid for."""
    if len(left) < FEWEST_OF_MEMORY:
        return Setting()
    costs = [memory_cost(left, starts, setting) for setting in SETTINGS]
    return SETTINGS[int(np.argmin(costs))]


def memory_cost(left: Matrix, starts: NDArray[np.bool_], setting: Setting) -> float:
    """Return -2 log likelihood of what is left as noise of this filter, its size free, its parameters paid for."""
    white = whiten(left, starts, setting)
    square = max(float(np.mean(white**2)), 1e-300)
    ratio = int(starts.sum()) * log(setting.variance_ratio)
    return len(left) * log(square) + ratio + setting.size * log(max(len(left), 2))


def as_noise(sample: Sample, predicted: Predicted) -> float:
    """Return -2 log likelihood of what is left where every result has the memory and the tails that suit it best."""
    settings = SETTINGS if has_order(sample.machine) else (Setting(),)
    total = 0.0
    for channel in sample.channels:
        measured = sample.machine.records.measured[channel.name]
        left = ((measured - predicted[channel.name])[channel.rows]) * (channel.weights / channel.scale)
        if not np.ptp(left) > 0:
            continue
        costs = [memory_cost(left, channel.starts, each) for each in settings]
        memory = settings[int(np.argmin(costs))]
        paid = int(channel.starts.sum()) * log(memory.variance_ratio) + memory.size * log(max(len(left), 2))
        total += paid - 2 * likelihood_of(whiten(left, channel.starts, memory))
    return total
