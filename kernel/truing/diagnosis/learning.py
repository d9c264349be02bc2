"""What is learnt of the noise from what an explanation leaves: its size, spread, tails and memory, result by result.

Rows whose value was read say all of it; censored ones have their say in the size alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import log

import numpy as np

from truing.arrays import Mask, Matrix
from truing.diagnosis.machine import Calibration, Predicted, in_blocks
from truing.diagnosis.noise import (
    SETTINGS,
    Autocorrelation,
    beyond,
    clipped,
    difference,
    likelihood_of,
    robust_sd,
    rounding,
    scale_of,
    spread_of,
    standardised,
    tails_of,
    weights_of,
    whiten,
)
from truing.diagnosis.sample import Channel, NoiseModel, Sample, compared_slopes, has_order, residuals_of, typical_of

FEWEST_OF_MEMORY = 20
"""Rows from which on their memory is learnt."""


def first_noise(machine: Calibration) -> dict[str, NoiseModel]:
    """Return a first idea of the noise: what the tolerated inputs and powers of all covariates cannot explain."""
    noise = {}
    drivers = [standardised(covariate.values) for covariate in machine.records.moved]
    for name, values in residuals_of(machine).items():
        here = np.flatnonzero(np.isfinite(values) & ~machine.records.held_out)
        typical = typical_of(machine, name)
        slopes = compared_slopes(machine, name, typical)
        triangle = np.zeros((0, slopes.shape[1] + 2 * len(drivers) + 2))
        for block in in_blocks(len(here)):
            rows = here[block]
            powers = [driver[rows] ** power for driver in drivers for power in (1, 2)]
            columns = np.column_stack([slopes[rows], np.ones(len(rows)), *powers, values[rows]])
            triangle = np.asarray(np.linalg.qr(np.concatenate([triangle, columns]), mode="r"))
        scale = max(_unexplained(triangle, len(here)), rounding(values[here], machine.records.measured[name][here]))
        given = _stated(machine, name, typical)
        at = machine.base[name] if typical or name in machine.records.sides else None
        noise[name] = NoiseModel(scale, given, given, typical=typical, at=at)
    return noise


def _unexplained(triangle: Matrix, rows: int) -> float:
    """Return the standard deviation that columns leave of the last one, of the triangle of their QR decomposition."""
    size = np.sqrt(np.sum(triangle[:, :-1] ** 2, axis=0))
    design = triangle[:, :-1][:, size > 0] / size[size > 0]
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    left = left[:, singular > 1e-6 * singular[0]] if len(singular) else left
    left = left[:, : max(1, rows // 3)]
    rest = triangle[:, -1] - left @ (left.T @ triangle[:, -1])
    return float(np.sqrt(rest @ rest / max(rows - left.shape[1], 1)))


def _stated(machine: Calibration, name: str, typical: float) -> Matrix:
    """Return the weights that stated standard deviations ask for: 1 where none is stated, less where it is larger."""
    stated = machine.records.sigma.get(name)
    if stated is None or not (stated > 0).any():
        return np.ones(len(machine.records))
    if typical:
        stated = stated / machine.records.measured[name]
    middle = float(np.median(stated[stated > 0]))
    return np.where(stated > 0, middle / np.where(stated > 0, stated, middle), 1.0)


def learnt(sample: Sample, predicted: Predicted, used: float) -> dict[str, NoiseModel]:
    """Learn scale, spread, tails and memory of the noise from what an explanation leaves, ``used`` its free numbers."""
    drivers, free = _drivers(sample.machine), used / len(sample.channels)
    return {
        channel.name: _learnt(sample, channel, predicted[channel.name], drivers, free) for channel in sample.channels
    }


def _learnt(
    sample: Sample, channel: Channel, predicted: Matrix, drivers: Mapping[str, Matrix], free: float
) -> NoiseModel:
    """Learn the noise of one result from the rows whose value was read; censored ones have their say in its scale.

    For the scale, readings that lie too far out count as where the tails end.
    """
    machine, before, typical = sample.machine, sample.noise[channel.name], channel.typical
    rows, measured = channel.rows[channel.read], machine.records.measured[channel.name]
    left = difference(measured[rows], predicted[rows], typical)
    own = {**drivers, f"size of {channel.name}": np.abs(machine.base[channel.name])}
    spread = spread_of(left * before.given[rows], {name: values[rows] for name, values in own.items()})
    weights = before.given * weights_of(spread, own.get(spread.driver), rows, len(machine.records))
    weighted, starts = left * weights[rows], channel.starts[channel.read]
    floor = channel.scale * channel.least**0.5
    is_known = has_order(machine) and robust_sd(weighted) > 2 * floor
    memory = memory_of(weighted, starts) if is_known else Autocorrelation()
    innovations = whiten(weighted, starts, memory)
    is_noise = robust_sd(innovations) > 2 * floor
    tails = tails_of(innovations) if is_noise else before.tails
    kept = weighted + clipped(innovations, tails) - innovations if is_noise else weighted
    scale = scale_of(kept, _short(channel, predicted, weights[channel.rows]), free)
    return NoiseModel(
        max(scale, floor), before.given, weights, memory, tails, spread, typical,
        None if before.at is None else predicted,
    )  # fmt: skip


def _short(channel: Channel, predicted: Matrix, weights: Matrix) -> Matrix:
    """Return by how much a prediction falls short of the ends of censored rows, weighted (n,), SI."""
    if channel.sides is None:
        return np.zeros(0)
    short = channel.sides * channel.off(predicted) * (channel.scale / channel.weights) * weights
    return np.asarray(short[channel.sides != 0])


def _drivers(machine: Calibration) -> dict[str, Matrix]:
    """Return what the spread of noise may depend on: every covariate, and its size where it changes sign."""
    made: dict[str, Matrix] = {}
    for covariate in machine.records.moved:
        made[covariate.name] = covariate.values
        if np.nanmin(covariate.values) < 0 < np.nanmax(covariate.values):
            made[f"size of {covariate.name}"] = np.abs(covariate.values)
    return made


def memory_of(left: Matrix, starts: Mask, fewest: int = FEWEST_OF_MEMORY) -> Autocorrelation:
    """Return the filter that makes what is left likeliest, its parameters paid for; of fewer rows none."""
    settings = SETTINGS if len(left) >= fewest else [Autocorrelation()]
    return min(settings, key=lambda setting: memory_cost(left, starts, setting))


def memory_cost(left: Matrix, starts: Mask, setting: Autocorrelation) -> float:
    """Return -2 log likelihood of what is left as noise of this filter, its size free, its parameters paid for."""
    square = max(float(np.mean(whiten(left, starts, setting) ** 2)), 1e-300)
    return len(left) * log(square) + _paid(starts, setting)


def _paid(starts: Mask, setting: Autocorrelation) -> float:
    """Return what a filter costs in -2 log likelihood: its larger noise where runs begin, and its parameters."""
    return int(starts.sum()) * log(setting.variance_ratio) + setting.size * log(max(len(starts), 2))


def as_noise(sample: Sample, predicted: Predicted) -> float:
    """Return -2 log likelihood of what is left where every result has the memory and the tails that suit it best.

    The readings are taken as they are: those that were moved in were so for the sake of another explanation.
    """
    total = 0.0
    for channel in sample.channels:
        left, starts = channel.off(predicted[channel.name])[channel.read], channel.starts[channel.read]
        if not np.ptp(left) > 0:
            continue
        memory = memory_of(left, starts, 0) if has_order(sample.machine) else Autocorrelation()
        total += _paid(starts, memory) - 2 * likelihood_of(whiten(left, starts, memory))
        short = _short(channel, predicted[channel.name], channel.weights / channel.scale)
        size = max(scale_of(left, short, 0.0), 1e-300)
        total += float(np.sum(beyond(short / size, np.ones(len(short), dtype=np.int8)) ** 2))
    return total
