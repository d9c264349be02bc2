"""First order: how steeply each result follows each source, and the chances that follow from it.

Derivatives are central differences of the exact model, all in one batch. For every source the model is evaluated at
steps that halve from the widest on. Richardson's extrapolation turns each three neighbouring central differences into a
value of sixth order; of all these the one that agrees best with both its neighbours is taken. So the step finds itself
between truncation and rounding, and the disagreement says what the derivative is worth. Where one side of a point is
infeasible, one-sided differences are taken and said so.
Source: W. H. Press et al., Numerical Recipes, 3rd ed., section 5.7 (Ridders' method).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.arrays import Matrix
from truing.declare.sources import Unknown
from truing.errors import TruingError
from truing.evaluate import evaluate_rows
from truing.setup import Setup, SwitchedOn, effect_column
from truing.studies.checks import Demand, normal_chance, results_needed
from truing.studies.sampling import Scatter, standard_rows
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


def unknown_columns(setup: Setup) -> dict[str, tuple[SwitchedOn, Unknown]]:
    """Return the unknowns of effects that are on by their column, ``effects.NAME.UNKNOWN``."""
    return {
        effect_column(active.effect.name, unknown.name): (active, unknown)
        for active in setup.effects
        for unknown in active.unknowns
    }


def nominal_of(setup: Setup, column: str) -> float:
    """Return the value of an input, a condition or the unknown of an effect in force."""
    if column in (unknowns := unknown_columns(setup)):
        active, unknown = unknowns[column]
        return float(active.values[unknown.name])
    return float(setup.nominal(column))


def slopes(setup: Setup, results: Sequence[str], columns: Sequence[str], scatter: Scatter) -> Slopes:
    """Differentiate these results by these columns about the nominal point, in one call of the model."""
    nominals = np.array([nominal_of(setup, column) for column in columns])
    widest = np.array([_widest(setup, column, scatter) for column in columns])
    steps = widest[:, None] * 0.5 ** np.arange(LEVELS)  # (columns, levels), falling
    block = 2 * LEVELS
    rows = 1 + block * len(columns)
    batch: dict[str, Matrix] = {}
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
    if by_sd or by_value or column not in (unknowns := unknown_columns(setup)):
        return by_sd or by_value or unit_factor(setup.unit_of(column))
    unknown = unknowns[column][1]
    return (unknown.high - unknown.low) * unit_factor(unknown.unit) / WIDEST_SDS


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


def _largest(values: Matrix) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def _slope(points: Matrix, values: Matrix, centre: Matrix, matters: float) -> tuple[Any, str]:
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


def _best(estimates: Matrix) -> tuple[Any, Any]:
    """Return, per component, the estimate that agrees best with both its neighbours, and how well it does."""
    apart = np.abs(np.diff(estimates, axis=0))
    score = np.maximum(apart[:-1], apart[1:])
    score = np.where(np.isfinite(score), score, np.inf)
    index = np.argmin(score, axis=0)[None]
    best = np.take_along_axis(estimates[1:-1], index, axis=0)[0]
    doubt = np.take_along_axis(score, index, axis=0)[0]
    return np.where(np.isfinite(doubt), best, np.nan), doubt


def _one_sided(sides: Sequence[Matrix], slope: Any) -> tuple[Any, Any]:
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


# First-order chances: the model linearised at its nominal point, every scatter by its mean and standard deviation.
# Range of validity: scatter small enough for the model to be straight over it, and so many sources of comparable weight
# that their sum is nearly normal (exact for linear models of normal sources). The shift of a mean, as of a one-sided
# zone, is included. Source: E. B. Haugen, Probabilistic Mechanical Design, Wiley 1980.


@dataclass(frozen=True)
class Straight:
    """A response as a straight line: nominal value, mean, derivatives and variance by column, SI."""

    nominal: Any
    mean: Any
    slopes: Mapping[str, Any]
    variances: Mapping[str, Any]

    @property
    def variance(self) -> Any:
        """The whole first-order variance."""
        return sum(self.variances.values(), 0.0)

    @property
    def sd(self) -> Any:
        """The first-order standard deviation."""
        return np.sqrt(np.maximum(self.variance, 0.0))


def straightened(scatter: Scatter, wanted: Sequence[Demand]) -> tuple[dict[str, Straight], Slopes]:
    """Linearise the responses of these demands; one batch of the model."""
    derivatives = slopes(scatter.setup, results_needed(scatter.setup, wanted), scatter.columns, scatter)
    lines = {}
    for demand in wanted:
        slope = demand.slopes(derivatives.of, scatter.columns)
        value = demand.response(derivatives.nominal, {})
        mean = value + sum((slope[column] * shift for column, shift in scatter.shifts().items()), 0.0)
        lines[demand.name] = Straight(value, mean, slope, scatter.variances(slope))
    return lines, derivatives


def chance(demand: Demand, straight: Straight) -> Any:
    """Return the first-order probability that the demand is met."""
    return normal_chance(straight.mean, straight.sd, demand.low, demand.high)


# First-order reliability method: the most probable machine that just misses a limit, and the chance beyond it


LimitState = Callable[[Matrix], Matrix]

STEP = 1e-3
ITERATIONS = 60
CLOSE = 1e-6
FARTHEST = 400.0  # standard deviations; no search goes beyond
HALVINGS = 8


@dataclass(frozen=True)
class Side:
    """One side of a limit: the reliability index, and the machine at the design point; or why there is none."""

    status: str  # "converged", or why there is no number
    beta: float | None = None
    point: Mapping[str, float] = field(default_factory=dict)
    iterations: int = 0

    @property
    def converged(self) -> bool:
        """Whether the search arrived."""
        return self.beta is not None


@dataclass(frozen=True)
class FormResult:
    """FORM of one demand: its sides, and the probability of meeting it (None where a search did not arrive)."""

    sides: Mapping[str, Side]
    probability: float | None
    status: str

    def as_json(self) -> dict[str, Any]:
        """Return plain data; a search that failed is a status with a reason, never a number."""
        if self.probability is None:
            return {"status": self.status}
        beta = {name: side.beta for name, side in self.sides.items()}
        return {"status": self.status, "probability": self.probability, "beta": beta}


def form(scatter: Scatter, demand: Demand) -> FormResult:
    """Find the reliability index of each side of a demand on a number."""
    if scatter.setup.model.own_result_fields[demand.result].along:
        return FormResult({}, None, "not done: the result runs along an axis")
    if not scatter.dimension:
        return FormResult({}, None, "not done: nothing scatters")
    sides: dict[str, Side] = {}
    for name, bound, sign in (("low", demand.low, 1.0), ("high", demand.high, -1.0)):
        if np.isfinite(bound):
            sides[name] = _search(_limit_state(scatter, demand, sign, bound), scatter)
    failed = [f"{name} limit: {side.status}" for name, side in sides.items() if not side.converged]
    if failed:
        return FormResult(sides, None, "; ".join(failed))
    missed = sum(float(ndtr(-side.beta)) for side in sides.values() if side.beta is not None)
    return FormResult(sides, max(0.0, 1.0 - missed), "converged")


def _limit_state(scatter: Scatter, demand: Demand, sign: float, bound: float) -> LimitState:
    """Return the distance from a limit in standard normal space: positive where it is kept, (d, n) -> (n,)."""

    def distance(standard: Matrix) -> Matrix:
        rows, columns = standard_rows(scatter, standard, results_needed(scatter.setup, [demand]))
        answer: Matrix = sign * (demand.response(rows.results, columns) - bound)
        return answer

    return distance


def _with_gradient(distance: LimitState, point: Matrix) -> tuple[float, Matrix]:
    moves = STEP * np.eye(len(point))
    batch = np.hstack([point[:, None], point[:, None] + moves, point[:, None] - moves])
    values = distance(batch)
    up, down = values[1 : 1 + len(point)], values[1 + len(point) :]
    return float(values[0]), (up - down) / (2 * STEP)


def _search(distance: LimitState, scatter: Scatter) -> Side:
    """Walk to the point of the limit nearest to the origin."""
    point = np.zeros(scatter.dimension)
    scale = 0.0
    for iteration in range(1, ITERATIONS + 1):
        value, gradient = _with_gradient(distance, point)
        steepness = float(np.sqrt(gradient @ gradient))
        if not np.isfinite(value) or not np.isfinite(steepness):
            return Side("no convergence: the model has no answer on the way to the limit")
        scale = max(scale, abs(value), steepness)
        if steepness <= 1e-12 * scale or steepness == 0:
            return Side("no convergence: nothing that scatters moves the result towards this limit")
        normal = -gradient / steepness
        ahead = float(normal @ point) + value / steepness
        if abs(ahead) > FARTHEST and iteration > 3:
            return Side("no convergence: the limit lies out of reach")
        target = ahead * normal
        if abs(value) <= CLOSE * steepness and np.abs(target - point).max() <= 1e-4 * max(1.0, abs(ahead)):
            beta = float(normal @ point) + value / steepness
            columns = scatter.from_standard(point[:, None])
            return Side("converged", beta, {name: float(values[0]) for name, values in columns.items()}, iteration)
        point = point + _length(distance, point, target - point, (value, steepness)) * (target - point)
    return Side(f"no convergence within {ITERATIONS} iterations")


def _length(distance: LimitState, point: Matrix, direction: Matrix, here: tuple[float, float]) -> float:
    """Choose the longest step of 1, 1/2, 1/4 ... that lowers the merit function; all are tried in one batch."""
    value, steepness = here
    target = point + direction
    penalty = 2 * max(np.sqrt(target @ target), np.sqrt(point @ point)) / steepness + 10 / steepness
    lengths = 0.5 ** np.arange(HALVINGS)
    tried = point[:, None] + direction[:, None] * lengths
    merit = 0.5 * (tried * tried).sum(axis=0) + penalty * np.abs(distance(tried))
    now = 0.5 * float(point @ point) + penalty * abs(value)
    better = np.flatnonzero(np.isfinite(merit) & (merit < now))
    return float(lengths[better[0]]) if better.size else float(lengths[-1])
