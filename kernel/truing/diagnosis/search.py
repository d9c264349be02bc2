"""Scoring every explanation under every noise filter, and learning what the noise is like from the best of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from truing.diagnosis.columns import in_blocks
from truing.diagnosis.evidence import (
    Channel,
    Products,
    Reduced,
    combined,
    products_of,
    reduced,
    starts_of,
)
from truing.diagnosis.hypotheses import NOTHING, Batch, Hypothesis, Kind, batches_of
from truing.diagnosis.machine import Machine, gram_of
from truing.diagnosis.noise import (
    SETTINGS,
    Spread,
    Tails,
    clipped,
    colour,
    robust_sd,
    spread_of,
    standardised,
    tails_of,
    weights_of,
    whiten,
)
from truing.diagnosis.problem import Problem
from truing.diagnosis.scoring import Scores, coefficients, scores_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

KEPT_SETTINGS = 4
REMEMBERED = 20
FILTERS_AT_ONCE = 16
"""Their reduced problems are held together, so fewer than are remembered."""
DOUBTS = 12
SMALLEST_SHARE = 1e-6
ROUNDING = 1e-4
"""Innovations this small beside the smallest noise that is thought of are rounding: nothing of them is clipped."""


@dataclass(frozen=True)
class Evidence:
    """The rows as the search sees them: channels, their inner products, and the directions of the tolerated inputs.

    ``directions`` has shape (inputs, K): u directions move the inputs by ``directions @ u`` standard deviations.
    ``counts`` is what the rows of each channel are worth: an estimate from clipped innovations has the variance of
    one from a share of the rows, (1 - clipped)^2.
    """

    channels: tuple[Channel, ...]
    products: tuple[tuple[Products, ...], ...]
    directions: Matrix
    counts: tuple[float, ...]
    known: dict[tuple[int, ...], Reduced] = field(default_factory=dict, compare=False, repr=False)

    @property
    def rows(self) -> int:
        """Number of measured values."""
        return sum(len(channel) for channel in self.channels)

    def case(self, setting: tuple[int, ...]) -> Reduced:
        """Return the reduced problem of the measured residuals under one noise filter per channel."""
        if setting not in self.known:
            chosen = [products[place] for products, place in zip(self.products, setting, strict=True)]
            if len(self.known) >= REMEMBERED:
                self.known.pop(next(iter(self.known)))
            self.known[setting] = reduced(chosen, self.counts, self.directions.shape[1])
        return self.known[setting]


@dataclass(frozen=True)
class NoiseModel:
    """What is known of the noise of each result so far: scale (SI), weights per row of the records, clipped tails.

    ``given`` are the weights that a stated standard deviation of the readings asks for, in any case.
    """

    given: Mapping[str, Matrix]
    scales: Mapping[str, float]
    weights: Mapping[str, Matrix]
    residuals: Mapping[str, Matrix]
    spreads: Mapping[str, Spread]
    tails: Mapping[str, Tails]


@dataclass(frozen=True)
class Found:
    """The scores of a list of hypotheses on the measured residuals, each at its best noise filter."""

    hypotheses: tuple[Hypothesis, ...]
    score: Matrix
    likelihood: Matrix
    setting: tuple[tuple[int, ...], ...]

    def best(self, accept: Callable[[Hypothesis], bool] = lambda _: True) -> int:
        """Return the place of the best accepted hypothesis, -1 where there is none."""
        import numpy as np

        places = [place for place, item in enumerate(self.hypotheses) if accept(item)]
        if not places or not np.isfinite(self.score[places]).any():
            return -1
        return places[int(np.argmax(self.score[places]))]

    def ranked(self, *kinds: Kind) -> Iterator[int]:
        """Give the best place of every explanation, whatever its variant, best first; only of some kinds if named."""
        import numpy as np

        seen = set()
        for place in np.argsort(-self.score, kind="stable")[: np.isfinite(self.score).sum()].tolist():
            hypothesis = self.hypotheses[place]
            if hypothesis.key not in seen and (not kinds or hypothesis.kind in kinds):
                seen.add(hypothesis.key)
                yield place


def residuals_of(machine: Machine) -> dict[str, Matrix]:
    """Return measured minus predicted at the mean of the tolerances, SI, NaN where missing."""
    measured = machine.records.measured
    return {name: values - machine.base[name] - machine.shifts[name] for name, values in measured.items()}


def moved_to(noise: NoiseModel, here: Machine, there: Machine) -> NoiseModel:
    """Return the noise with its residuals counted from another start of the calibration."""
    off = {
        name: here.base[name] + here.shifts[name] - there.base[name] - there.shifts[name] for name in noise.residuals
    }
    return replace(noise, residuals={name: values + off[name] for name, values in noise.residuals.items()})


def evidence_of(problem: Problem, noise: NoiseModel, rows: NDArray[np.bool_]) -> Evidence:
    """Reduce the chosen rows of the records to inner products, in units of the noise."""
    machine = problem.machine
    places = {name: np.flatnonzero(rows & np.isfinite(noise.residuals[name])) for name in noise.scales}
    total = sum(len(here) for here in places.values())
    gram = sum(gram_of(machine.slopes[name], here) / noise.scales[name] ** 2 for name, here in places.items())
    directions = machine.directions(np.asarray(gram), total)
    channels = []
    for name, scale in noise.scales.items():
        here = places[name]
        channels.append(
            Channel(
                name,
                scale,
                here,
                starts_of(_pieces(machine, rows), here),
                noise.weights[name][here],
                noise.residuals[name][here] / scale,
                machine.slopes[name],
                directions,
                problem.designs[name],
            )
        )
    products = tuple(tuple(products_of(channel)) for channel in channels)
    counts = [max(len(channel) * (1 - noise.tails[channel.name].clipped) ** 2, 1.0) for channel in channels]
    return Evidence(tuple(channels), products, directions, tuple(counts))


def _pieces(machine: Machine, rows: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Number the pieces of runs that are left when only some rows are taken: a gap starts the noise anew."""
    runs = machine.records.run_of
    gap = np.zeros(len(rows), dtype=np.intp)
    gap[1:] = (runs[1:] != runs[:-1]) | (rows[1:] & ~rows[:-1])
    return np.cumsum(gap)


def search(evidence: Evidence, hypotheses: Sequence[Hypothesis], settings: Sequence[tuple[int, ...]]) -> Found:
    """Score every hypothesis under every given noise filter and keep the best of each."""
    best = np.full(len(hypotheses), -np.inf)
    likelihood = np.full(len(hypotheses), -np.inf)
    chosen = np.zeros(len(hypotheses), dtype=int)
    for begin, found in _scored(evidence, hypotheses, settings):
        place = found.score[..., 0].argmax(axis=0)
        top = np.take_along_axis(found.score[..., 0], place[None], 0)[0]
        better = np.flatnonzero(top > best)
        best[better] = top[better]
        likelihood[better] = found.likelihood[place[better], better, 0]
        chosen[better] = begin + place[better]
    return Found(tuple(hypotheses), best, likelihood, tuple(settings[place] for place in chosen))


def _scored(
    evidence: Evidence, hypotheses: Sequence[Hypothesis], settings: Sequence[tuple[int, ...]]
) -> Iterator[tuple[int, Scores]]:
    """Give the scores under some noise filters at a time, with the place of the first of them."""
    batches = batches_of(hypotheses)
    for begin in range(0, len(settings), FILTERS_AT_ONCE):
        cases = [evidence.case(setting) for setting in settings[begin : begin + FILTERS_AT_ONCE]]
        yield begin, scores_of(cases, batches, evidence.rows)


def likely_settings(evidence: Evidence, hypotheses: Sequence[Hypothesis]) -> list[tuple[int, ...]]:
    """Return the noise filters worth trying: all of one channel; of several, the likeliest few of each.

    ``hypotheses`` are the simple ones: nothing, single causes, shapes. Each channel is scanned with the others held.
    """
    count = len(evidence.products[0])
    if len(evidence.channels) == 1:
        return list(combined([count]))
    held = [0] * len(evidence.channels)
    kept: list[list[int]] = []
    for _ in range(2):
        kept = []
        for channel in range(len(held)):
            trials = [(*held[:channel], place, *held[channel + 1 :]) for place in range(count)]
            scores = np.concatenate([found.score[..., 0] for _, found in _scored(evidence, hypotheses, trials)])
            none, best = scores[:, 0], scores.max(axis=1)
            held[channel] = int(np.argmax(best))
            order = [place for pair in zip(np.argsort(-best), np.argsort(-none), strict=True) for place in pair]
            kept.append([int(place) for place in dict.fromkeys(order)][:KEPT_SETTINGS])
    chosen = combined([len(places) for places in kept])
    return [tuple(kept[channel][place] for channel, place in enumerate(each)) for each in chosen]


@dataclass(frozen=True)
class Solution:
    """A hypothesis solved: coefficients of its columns, of the directions, and what is left, by channel.

    ``fitted`` and ``innovations`` have shape (n,), in units of the noise, of the rows of the channel.
    """

    hypothesis: Hypothesis
    setting: tuple[int, ...]
    coefficients: Matrix
    directions: Matrix
    fitted: tuple[Matrix, ...]
    innovations: tuple[Matrix, ...]


def solve(evidence: Evidence, hypothesis: Hypothesis, setting: tuple[int, ...], doubt: float = 1.0) -> Solution:
    """Solve one hypothesis under one noise filter per channel; ``doubt`` multiplies the scale of the noise."""
    columns = list(hypothesis.columns)
    b = np.zeros(0)
    if columns:
        batch: Batch = batches_of([hypothesis])[0]
        b = coefficients(evidence.case(setting), batch)[0, :, 0]
    u = _directions(evidence, setting, columns, b, doubt)
    fitted, left = [], []
    for channel, place in zip(evidence.channels, setting, strict=True):
        made = channel.directions @ u
        for column, value in zip(columns, b, strict=True):
            item = channel.columns[column]
            if channel.name in item.parts:
                made = made + item.parts[channel.name][channel.rows] * (item.per / channel.scale * value)
        fitted.append(made)
        left.append(whiten((channel.residual - made) * channel.weights, channel.starts, SETTINGS[place]))
    return Solution(hypothesis, setting, b, u, tuple(fitted), tuple(left))


def base_solution(evidence: Evidence, setting: tuple[int, ...]) -> Solution:
    """Calibrate the model as it is, with no cause at all: as far as tolerances and its own misfit make likely.

    What is left may be far more than noise; inputs are not driven out of their tolerances to draw it.
    """
    trials = [solve(evidence, NOTHING, setting, doubt=2.0**power) for power in range(DOUBTS)]

    def likelihood(trial: Solution) -> float:
        sizes = [len(left) * float(np.log(max(float(left @ left), 1e-300) / len(left))) for left in trial.innovations]
        return -sum(sizes) - float(trial.directions @ trial.directions)

    return max(trials, key=likelihood)


def _directions(
    evidence: Evidence, setting: tuple[int, ...], columns: Sequence[int], b: Matrix, doubt: float
) -> Matrix:
    k = evidence.directions.shape[1]
    chosen = [products[place].matrix for products, place in zip(evidence.products, setting, strict=True)]
    total = sum(chosen[1:], chosen[0])
    right = total[1 : 1 + k, 0] - total[1 : 1 + k][:, [1 + k + column for column in columns]] @ b
    return np.asarray(np.linalg.solve(total[1 : 1 + k, 1 : 1 + k] + doubt**2 * np.eye(k), right))


def learned(
    problem: Problem, evidence: Evidence, solution: Solution, raw: Mapping[str, Matrix], noise: NoiseModel
) -> NoiseModel:
    """Learn scale, spread and tails of the noise from what a solution leaves, and clip what lies too far out.

    The clipped innovations are put back through the noise filter: least squares on these pseudo-observations is a
    one-step robust estimate, so that all later algebra stays linear. Measured values themselves are never clipped.
    """
    scales, weights, residuals, spreads, tails = {}, {}, {}, {}, {}
    drivers = _drivers(problem)
    free = len(solution.coefficients) / len(evidence.channels) + np.sqrt(evidence.directions.shape[1])
    for channel, fitted, place in zip(evidence.channels, solution.fitted, solution.setting, strict=True):
        setting = SETTINGS[place]
        left = raw[channel.name][channel.rows] / channel.scale - fitted
        plain = whiten(left * noise.given[channel.name][channel.rows], channel.starts, setting)
        own = {**drivers, **_size(problem, channel.name)}
        spread = spread_of(plain, {name: values[channel.rows] for name, values in own.items()})
        every = weights_of(spread, own.get(spread.driver), channel.rows, len(problem.machine.records))
        every = every * noise.given[channel.name]
        row_weights = every[channel.rows]
        innovations = whiten(left * row_weights, channel.starts, setting)
        is_noise = robust_sd(innovations) > ROUNDING
        tail = tails_of(innovations) if is_noise else noise.tails[channel.name]
        kept = clipped(innovations, tail) if is_noise else innovations
        sd = float(np.sqrt(np.sum(kept**2) / max(len(kept) - free, 1.0)))
        full = np.array(raw[channel.name])
        cleaned = fitted + colour(kept, channel.starts, setting) / row_weights
        full[channel.rows] = cleaned * channel.scale
        floor = SMALLEST_SHARE * float(np.sqrt(np.mean(raw[channel.name][channel.rows] ** 2)))
        scales[channel.name] = max(sd * channel.scale, floor, 1e-300)
        weights[channel.name], residuals[channel.name] = every, full
        spreads[channel.name], tails[channel.name] = spread, tail
    return NoiseModel(noise.given, scales, weights, residuals, spreads, tails)


def _drivers(problem: Problem) -> dict[str, Matrix]:
    """Return what the spread of noise may depend on: every covariate, and its size where it changes sign."""
    found: dict[str, Matrix] = {}
    for name, item in problem.machine.records.covariates.items():
        if item.is_constant:
            continue
        found[name] = item.values
        if np.nanmin(item.values) < 0 < np.nanmax(item.values):
            found[f"size of {name}"] = np.abs(item.values)
    return found


def _size(problem: Problem, result: str) -> dict[str, Matrix]:
    return {f"size of {result}": np.abs(problem.machine.base[result])}


def first_noise(machine: Machine) -> NoiseModel:
    """Return a first idea of the noise: what the tolerated inputs and powers of all covariates cannot explain."""
    raw = residuals_of(machine)
    scales = {}
    drivers = [standardised(item.values) for item in machine.records.covariates.values() if not item.is_constant]
    for name, values in raw.items():
        here = np.flatnonzero(np.isfinite(values) & ~machine.records.held_out)
        triangle = np.zeros((0, machine.slopes[name].shape[1] + 2 * len(drivers) + 2))
        for block in in_blocks(len(here)):
            rows = here[block]
            powers = [driver[rows] ** power for driver in drivers for power in (1, 2)]
            made = np.column_stack([machine.slopes[name][rows], np.ones(len(rows)), *powers, values[rows]])
            triangle = np.asarray(np.linalg.qr(np.concatenate([triangle, made]), mode="r"))
        sd = _unexplained(triangle, len(here))
        floor = SMALLEST_SHARE * float(np.sqrt(np.mean(values[here] ** 2)))
        scales[name] = max(sd, floor, 1e-300)
    given = {name: _stated(machine, name) for name in raw}
    nothing = {name: Tails(inf, 4.5, 0.0) for name in raw}
    return NoiseModel(given, scales, given, raw, {name: Spread() for name in raw}, nothing)


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
