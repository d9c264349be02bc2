"""With what probability do machines of many designs keep a limit? The same standard normal draws for every design.

Common random numbers make two designs differ by what they are and not by luck, so that a search can follow the chance.
The draws are stratified in each direction (M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239).
First order is the model made straight at every design by central differences.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from truing.studies.demands import normal_chance
from truing.studies.differences import nominal_of
from truing.studies.optimise_goals import Bound, World, beside
from truing.studies.optimise_spreads import Scattered
from truing.studies.scatter import Cause, Scatter, generator

STEP = 0.1  # of a standard deviation, for central differences


class Answering(Protocol):
    """Runs the model, or what stands in for it, on a batch and returns the wanted results, NaN where a row failed."""

    def __call__(self, columns: Mapping[str, Any], rows: int, wanted: Sequence[str]) -> Mapping[str, Any]:
        """Return results by name, (rows,) or (rows, k)."""


@dataclass(frozen=True, eq=False)
class Cloud:
    """The causes of scatter, and by name standard normal values (k, n), or deviations where a function draws them."""

    causes: tuple[Cause, ...]
    standard: Mapping[str, NDArray[np.float64]]
    draws: int


@dataclass(frozen=True)
class Designs:
    """Designs (m,) with how their inputs scatter."""

    world: World
    spreads: Mapping[str, Mapping[str, Scattered]]
    rows: int

    def nominal(self, column: str) -> Any:
        """Return the nominal values (m,) of a column."""
        own = self.world.columns.get(column)
        return np.full(self.rows, nominal_of(self.world.setup, column)) if own is None else own


def cloud_of(scatter: Scatter, seed: int, study: str, draws: int) -> Cloud:
    """Draw the machines once, for all designs; other random numbers than those of any verification."""
    standard: dict[str, NDArray[np.float64]] = {}
    for cause in scatter.causes:
        rng = generator(seed, 0, f"{study}: {cause.name}")
        if cause.function is not None:
            deviations = cause.function(rng, draws)
            standard[cause.name] = np.array([np.asarray(deviations[column], dtype=float) for column in cause.columns])
        else:
            standard[cause.name] = np.array([_stratified(rng, draws) for _ in cause.columns])
    return Cloud(scatter.causes, standard, draws)


def _stratified(rng: np.random.Generator, draws: int) -> NDArray[np.float64]:
    return np.asarray(ndtri((rng.permutation(draws) + rng.random(draws)) / draws))


def by_draws(cloud: Cloud, designs: Designs, bounds: Sequence[Bound], answer: Answering) -> NDArray[np.float64]:
    """Return the share of machines (m, bounds) that keep each limit; a machine without an answer keeps none."""
    shape = (designs.rows, cloud.draws)
    columns = _machines(cloud, designs)
    flat = {name: np.ascontiguousarray(values).reshape(-1) for name, values in columns.items()}
    results = answer(flat, designs.rows * cloud.draws, _wanted(bounds))
    each = {name: np.asarray(values).reshape(*shape, *np.shape(values)[1:]) for name, values in results.items()}
    found = np.empty((designs.rows, len(bounds)))
    for place, bound in enumerate(bounds):
        low, high = _ends(designs.world, bound)
        response = each[bound.result]
        if _moves(designs.world, bound):
            limit = each.get(bound.require.limit, columns.get(bound.require.limit))
            limit = _per_design(designs.world.value(bound.require.limit), response) if limit is None else limit
            response = response - beside(limit, response)
        with np.errstate(invalid="ignore"):
            inside = (response <= _per_design(high, response)) & (response >= _per_design(low, response))
        found[:, place] = _worst(inside.mean(axis=1))
    return found


def _per_design(limit: Any, values: Any) -> Any:
    """Bring a limit, a number or (m, ...), beside values (m, n, ...)."""
    if np.ndim(limit) == 0:
        return limit
    return beside(np.expand_dims(np.asarray(limit), 1), values)


def _worst(chances: Any) -> Any:
    """Return the smallest chance of every design where a result runs along an axis."""
    return chances.min(axis=tuple(range(1, chances.ndim))) if chances.ndim > 1 else chances


def _wanted(bounds: Sequence[Bound]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for bound in bounds for name in (bound.result, bound.require.limit)))


def _moves(world: World, bound: Bound) -> bool:
    """Whether a one-sided limit is another result or an input, which is then that of the same machine."""
    model, named = world.setup.model, bound.require.limit
    return bound.require.kind != "within" and (named in model.own_result_fields or named in model.input_fields)


def _ends(world: World, bound: Bound) -> tuple[Any, Any]:
    if not _moves(world, bound):
        return world.ends(bound)
    infinity = float("inf")
    return (0.0, infinity) if bound.require.kind == "at_least" else (-infinity, 0.0)


def _machines(cloud: Cloud, designs: Designs) -> dict[str, Any]:
    """Return the columns of all machines of all designs (m, n); two tolerances on one input add their deviations."""
    shape = (designs.rows, cloud.draws)
    columns: dict[str, Any] = {}
    for cause in cloud.causes:
        for column, values in _of_cause(cause, cloud.standard[cause.name], designs):
            if column in columns:
                values = columns[column] + (values - designs.nominal(column)[:, None])
            columns[column] = np.broadcast_to(values, shape)
    for column, nominal in designs.world.columns.items():
        if column not in columns:
            columns[column] = np.broadcast_to(nominal[:, None], shape)
    return columns


def _of_cause(cause: Cause, standard: NDArray[np.float64], designs: Designs) -> list[tuple[str, Any]]:
    if cause.function is not None:
        return [(name, designs.nominal(name)[:, None] + standard[i]) for i, name in enumerate(cause.columns)]
    if cause.mixing is not None or cause.name not in designs.spreads:
        return [(column, values[None, :]) for column, _, values in cause.from_standard(standard)]
    own = designs.spreads[cause.name]
    return [(column, own[column].values(standard[place])) for place, column in enumerate(cause.columns)]


def by_first_order(
    scatter: Scatter, designs: Designs, bounds: Sequence[Bound], answer: Answering
) -> NDArray[np.float64]:
    """Return the normal probability (m, bounds) of the model made straight at every design; 0 where there is none."""
    columns = scatter.columns
    steps, variances, shifts = _moments(scatter, designs)
    values = _beside_the_designs(designs, columns, steps, _wanted(bounds), answer)
    found = np.empty((designs.rows, len(bounds)))
    for place, bound in enumerate(bounds):
        centre, slopes = _line(designs, bound, values, (columns, steps))
        low, high = _ends(designs.world, bound)
        variance, mean = variances(slopes), centre
        for column, shift in shifts.items():
            mean = mean + slopes[column] * beside(shift, slopes[column])
        sd = np.sqrt(np.maximum(variance, 0.0))
        chance = _worst(np.asarray(normal_chance(mean, sd, beside(low, mean), beside(high, mean))))
        found[:, place] = np.where(np.isfinite(chance), chance, 0.0)
    return found


def _moments(scatter: Scatter, designs: Designs) -> tuple[dict[str, Any], Any, dict[str, Any]]:
    """Return by column the step (m,), then how variances follow from slopes, and how far means lie from nominals."""
    squares: dict[str, Any] = {}
    shifts: dict[str, Any] = {}
    for cause in scatter.causes:
        own = designs.spreads.get(cause.name) if cause.mixing is None else None
        for place, column in enumerate(cause.columns):
            stated = cause.distributions[place]
            sd = np.full(designs.rows, stated.sd) if own is None else own[column].sd
            shift = stated.mean - cause.nominals[place] if own is None else own[column].mean - designs.nominal(column)
            squares[column] = squares.get(column, 0.0) + sd**2
            shifts[column] = shifts.get(column, 0.0) + shift * np.ones(designs.rows)
    steps = {column: STEP * np.sqrt(square) for column, square in squares.items()}

    def variances(slopes: Mapping[str, Any]) -> Any:
        total: Any = 0.0
        for cause in scatter.causes:
            own = designs.spreads.get(cause.name) if cause.mixing is None else None
            if own is not None:
                for column in cause.columns:
                    total = total + (slopes[column] * beside(own[column].sd, slopes[column])) ** 2
                continue
            matrix = cause.covariance()
            for i, one in enumerate(cause.columns):
                for j, other in enumerate(cause.columns):
                    total = total + slopes[one] * slopes[other] * matrix[i, j]
        return total

    return steps, variances, {column: shift for column, shift in shifts.items() if np.any(shift != 0)}


def _beside_the_designs(
    designs: Designs, columns: Sequence[str], steps: Mapping[str, Any], wanted: Sequence[str], answer: Answering
) -> dict[str, Any]:
    """Run every design, and every design with one column a step up and a step down: results (m, 1 + 2 k, ...)."""
    width = 1 + 2 * len(columns)
    batch: dict[str, Any] = {}
    for name in dict.fromkeys([*designs.world.columns, *columns]):
        values = np.repeat(designs.nominal(name)[:, None], width, axis=1)
        if name in steps:
            place = 1 + 2 * list(columns).index(name)
            values[:, place] += steps[name]
            values[:, place + 1] -= steps[name]
        batch[name] = values.reshape(-1)
    results = answer(batch, designs.rows * width, wanted)
    inputs = {name: values.reshape(designs.rows, width) for name, values in batch.items()}
    shaped = {
        name: np.asarray(values).reshape(designs.rows, width, *np.shape(values)[1:]) for name, values in results.items()
    }
    return {**inputs, **shaped}


def _line(
    designs: Designs, bound: Bound, values: Mapping[str, Any], steps: tuple[Sequence[str], Mapping[str, Any]]
) -> tuple[Any, dict[str, Any]]:
    """Return the response at every design and its slopes by column; from one side where the other has no answer."""
    response = values[bound.result]
    if _moves(designs.world, bound):
        limit = values.get(bound.require.limit)
        limit = _per_design(designs.world.value(bound.require.limit), response) if limit is None else limit
        response = response - beside(limit, response)
    centre = response[:, 0]
    slopes: dict[str, Any] = {}
    for place, column in enumerate(steps[0]):
        step = beside(steps[1][column], centre)
        up, down = response[:, 1 + 2 * place], response[:, 2 + 2 * place]
        with np.errstate(all="ignore"):
            slope = (up - down) / (2 * step)
            slope = np.where(np.isfinite(slope), slope, np.where(np.isfinite(up), up - centre, centre - down) / step)
        slopes[column] = np.where(step > 0, slope, 0.0)
    return centre, slopes
