"""How steeply does each result follow each source? Central differences of the exact model, all in one batch.

For every source the model is evaluated at steps that halve from the widest on. Richardson's extrapolation turns each
three neighbouring central differences into a value of sixth order; of all these the one that agrees best with both its
neighbours is taken. So the step finds itself between truncation and rounding, and the disagreement says what the
derivative is worth. Where one side of a point is infeasible, one-sided differences are taken and said so.
Source: W. H. Press et al., Numerical Recipes, 3rd ed., section 5.7 (Ridders' method).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.errors import TruingError
from truing.evaluate import evaluate_rows
from truing.setup import Setup, effect_column
from truing.studies.sampling import Scatter
from truing.units import unit_factor

LEVELS = 15
WIDEST_SHARE = 1 / 16  # of the nominal value
WIDEST_SDS = 32.0
DOUBTFUL = 1e-4


@dataclass(frozen=True)
class Slopes:
    """Derivatives at the nominal point, SI: ``of[result][column]``, a number or an array along the result's axis.

    ``nominal`` holds the results there. NaN where the model gives no answer beside the point.
    """

    nominal: Mapping[str, Any]
    of: Mapping[str, Mapping[str, Any]]
    warnings: tuple[str, ...] = ()


def nominal_of(setup: Setup, column: str) -> float:
    """Return the value of an input, a condition or ``effects.NAME.UNKNOWN`` in force."""
    for active in setup.effects:
        for unknown in active.unknowns:
            if column == effect_column(active.effect.name, unknown.name):
                return float(active.values[unknown.name])
    return float(setup.nominal(column))


def slopes(setup: Setup, results: Sequence[str], columns: Sequence[str], scatter: Scatter) -> Slopes:
    """Differentiate these results by these columns about the nominal point, in one call of the model."""
    nominals = np.array([nominal_of(setup, column) for column in columns])
    widest = np.array([_widest(setup, column, scatter) for column in columns])
    steps = widest[:, None] * 0.5 ** np.arange(LEVELS)  # (columns, levels), falling
    block = 2 * LEVELS
    rows = 1 + block * len(columns)
    batch: dict[str, NDArray[np.float64]] = {}
    for index, column in enumerate(columns):
        values = np.full(rows, nominals[index])
        start = 1 + block * index
        values[start : start + LEVELS] += steps[index]
        values[start + LEVELS : start + block] -= steps[index]
        batch[column] = values
    answer = evaluate_rows(setup, batch, rows, wanted=results)
    of: dict[str, dict[str, Any]] = {}
    warnings: list[str] = []
    for result in results:
        values = answer.results[result]
        of[result] = {}
        matters = DOUBTFUL * _largest(values - values[0])
        for index, column in enumerate(columns):
            start = 1 + block * index
            points = batch[column][start : start + block] - nominals[index]
            slope, remark = _slope(points, values[start : start + block], values[0], matters / widest[index])
            of[result][column] = slope
            if remark:
                warnings.append(f"the derivative of '{result}' by '{column}' {remark}")
    nominal = {result: _plain(answer.results[result][0]) for result in results}
    return Slopes(nominal, of, tuple(warnings))


def exact_slopes(setup: Setup) -> Mapping[str, Mapping[str, Any]]:
    """Return the derivatives that the model states, where they hold: not where an effect stands between."""
    if setup.model.derivatives is None or any(active.effect.place != "reading" for active in setup.effects):
        return {}
    return setup.model.derivatives(setup.inputs)


def _widest(setup: Setup, column: str, scatter: Scatter) -> float:
    """Return the widest step worth trying: a part of the value, or many standard deviations, or one unit."""
    value = nominal_of(setup, column)
    sd = scatter.sd_of(column) or _sd_when_on(setup, column)
    by_sd = WIDEST_SDS * sd
    by_value = WIDEST_SHARE * abs(value)
    if by_sd and by_value:
        return max(min(by_sd, by_value), 1e-4 * by_value)
    return by_sd or by_value or _one_unit(setup, column)


def _sd_when_on(setup: Setup, column: str) -> float:
    """Return the scatter that is declared for a column whose tolerance is off."""
    for tolerance in setup.model.tolerances.values():
        if column in tolerance.on:
            try:
                resolved = setup.settled(tolerance.spread).resolve(setup.target(column))
            except TruingError:
                return 0.0
            return resolved.sd if resolved is not None else 0.0
    return 0.0


def _one_unit(setup: Setup, column: str) -> float:
    for active in setup.effects:
        for unknown in active.unknowns:
            if column == effect_column(active.effect.name, unknown.name):
                return (unknown.high - unknown.low) * unit_factor(unknown.unit) / WIDEST_SDS
    return unit_factor(setup.unit_of(column))


def _largest(values: NDArray[np.float64]) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def _slope(
    points: NDArray[np.float64], values: NDArray[np.float64], centre: NDArray[np.float64], matters: float
) -> tuple[Any, str]:
    """Return one derivative and what is to be said of it where its uncertainty is large enough to matter.

    ``points`` (2 * LEVELS,) are the steps from the nominal point, those above first; ``values`` the results there.
    """
    shape = (LEVELS,) + (1,) * (values.ndim - 1)
    up, down = values[:LEVELS], values[LEVELS:]
    above, below = points[:LEVELS].reshape(shape), points[LEVELS:].reshape(shape)
    with np.errstate(all="ignore"):
        central = (up - down) / (above - below)
        for power in (4.0, 16.0):
            central = (power * central[1:] - central[:-1]) / (power - 1)
        slope, doubt = _best(central)
        remark = ""
        if not np.isfinite(slope).all():
            sides = [(up - centre) / above, (down - centre) / below]
            slope, doubt = _one_sided(sides, slope)
            remark = (
                "was taken from one side only: the other is infeasible"
                if np.isfinite(slope).all()
                else ("does not exist: the model gives no answer beside the nominal point")
            )
        elif (doubt > np.maximum(DOUBTFUL * np.abs(slope), matters)).any():
            remark = f"is uncertain by {float(np.max(doubt)):.2g} in SI units: the model is not smooth there"
    return _plain(slope), remark


def _best(estimates: NDArray[np.float64]) -> tuple[Any, Any]:
    """Return, per component, the estimate that agrees best with both its neighbours, and how well it does."""
    apart = np.abs(np.diff(estimates, axis=0))
    score = np.maximum(apart[:-1], apart[1:])
    score = np.where(np.isfinite(score), score, np.inf)
    index = np.argmin(score, axis=0)[None]
    best = np.take_along_axis(estimates[1:-1], index, axis=0)[0]
    doubt = np.take_along_axis(score, index, axis=0)[0]
    return np.where(np.isfinite(doubt), best, np.nan), doubt


def _one_sided(sides: Sequence[NDArray[np.float64]], slope: Any) -> tuple[Any, Any]:
    """Extrapolate first differences of the side that is feasible to third order."""
    doubt = np.full(np.shape(slope), np.nan)
    for side in sides:
        for power in (2.0, 4.0):
            side = (power * side[1:] - side[:-1]) / (power - 1)
        estimate, its_doubt = _best(side)
        missing = ~np.isfinite(slope) & np.isfinite(estimate)
        slope, doubt = np.where(missing, estimate, slope), np.where(missing, its_doubt, doubt)
    return slope, doubt


def _plain(value: Any) -> Any:
    array = np.asarray(value)
    return float(array) if array.ndim == 0 else np.array(array)
