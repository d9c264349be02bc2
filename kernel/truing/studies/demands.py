"""What is demanded of chance: limits in numbers, also those that move with the machine, and the normal probability."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.setup import Setup
from truing.studies.checks import Limit, beside, limits

Z95 = 1.959963984540054  # standard normal quantile of 97.5 %


@dataclass(frozen=True)
class Demand:
    """``low <= result - moving <= high`` in SI, for every machine; numbers, or arrays along the result's axis.

    ``moving`` is empty or the result or input that a one-sided limit names: then strength meets load in each machine.
    ``still`` is the nominal value of such an input.
    """

    name: str
    result: str
    low: Any
    high: Any
    goal: float | None
    moving: str = ""
    still: float | None = None

    def response(self, results: Mapping[str, Any], columns: Mapping[str, Any]) -> Any:
        """Return what the limits hold for: the result, less a limit that moves."""
        values = results[self.result]
        if not self.moving:
            return values
        limit = results[self.moving] if self.moving in results else columns.get(self.moving, self.still)
        return values - beside(limit, values)

    def slopes(self, of: Mapping[str, Mapping[str, Any]], columns: Sequence[str]) -> dict[str, Any]:
        """Return the derivatives of the response by column."""
        own = of[self.result]
        if not self.moving:
            return {column: own[column] for column in columns}
        if self.moving in of:
            return {column: own[column] - beside(of[self.moving][column], own[column]) for column in columns}
        return {column: own[column] - float(column == self.moving) for column in columns}

    @property
    def wanted(self) -> tuple[str, ...]:
        """The names this demand needs from a calculation: results, and perhaps an input."""
        return (self.result, self.moving) if self.moving else (self.result,)


def demands(setup: Setup, answers: Mapping[str, Any], *, with_goal: bool | None = None) -> list[Demand]:
    """Return the limits on results of the function: those with a probability to reach, or all where none has one.

    ``with_goal=True`` returns only those with one. A limit on a result that does not exist (NaN) is left out.
    """
    own = setup.model.own_result_fields
    limited = [demand_of(limit, setup) for limit in limits(setup, dict(answers)) if limit.result in own]
    goals = [demand for demand in limited if demand.goal is not None]
    chosen = goals if goals or with_goal else limited
    return [demand for demand in chosen if all(exists(answers.get(name, 0.0)) for name in demand.wanted)]


def exists(answer: Any) -> bool:
    """Tell whether an answer in SI is a number, or numbers along an axis."""
    return not np.isnan(answer).any()


def demand_of(limit: Limit, setup: Setup) -> Demand:
    """Return a limit as it is demanded of every machine."""
    named, fields = limit.require.limit, setup.model.input_fields
    if limit.require.kind == "within" or not (named in setup.model.own_result_fields or named in fields):
        return Demand(limit.name, limit.result, limit.low, limit.high, limit.goal)
    infinity = float("inf")
    low, high = (0.0, infinity) if limit.require.kind == "at_least" else (-infinity, 0.0)
    still = float(setup.nominal(named)) if named in fields else None
    return Demand(limit.name, limit.result, low, high, limit.goal, named, still)


def results_needed(setup: Setup, wanted: Sequence[Demand]) -> tuple[str, ...]:
    """Return the results that these demands read, in a fixed order."""
    named = {name for demand in wanted for name in demand.wanted}
    return tuple(name for name in setup.model.own_result_fields if name in named)


def normal_chance(mean: Any, sd: Any, low: Any, high: Any) -> Any:
    """Return the probability that a normal value lies between two limits, exact to rounding in both tails.

    A standard deviation of 0 gives 1 or 0. Numbers or arrays.
    """
    mean, sd, low, high = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (mean, sd, low, high)))
    with np.errstate(all="ignore"):
        above, below = (low - mean) / sd, (high - mean) / sd
        inside = np.where(above > 0, ndtr(-above) - ndtr(-below), ndtr(below) - ndtr(above))
    certain = ((low <= mean) & (mean <= high)).astype(float)
    chance = np.where(sd > 0, inside, np.where(np.isfinite(mean), certain, np.nan))
    return float(chance) if chance.ndim == 0 else chance


def wilson(hits: Any, draws: int) -> tuple[Any, Any]:
    """Return Wilson's 95 % interval of a probability (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209)."""
    share = np.asarray(hits, dtype=float) / draws
    square = Z95 * Z95
    centre = (share + square / (2 * draws)) / (1 + square / draws)
    half = Z95 * np.sqrt(share * (1 - share) / draws + square / (4 * draws * draws)) / (1 + square / draws)
    low, high = np.clip(centre - half, 0.0, 1.0), np.clip(centre + half, 0.0, 1.0)
    return (float(low), float(high)) if low.ndim == 0 else (low, high)


def worst(value: Any) -> float:
    """Return the smallest of a curve of probabilities, or the number itself."""
    return float(np.min(value))


def as_number(value: Any) -> Any:
    """Return a number, or a list of numbers, for results.json; None where there is none."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0:
        return float(array) if np.isfinite(array) else None
    return [as_number(member) for member in array]
