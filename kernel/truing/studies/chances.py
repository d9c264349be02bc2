"""First-order chances: the model linearised at its nominal point, every scatter by its mean and standard deviation.

Range of validity: scatter small enough for the model to be straight over it, and so many sources of comparable weight
that their sum is nearly normal (exact for linear models of normal sources). The shift of a mean, as of a one-sided
zone, is included. Source: E. B. Haugen, Probabilistic Mechanical Design, Wiley 1980.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.arrays import Matrix
from truing.studies.demands import Demand, normal_chance, results_needed
from truing.studies.differences import Slopes, slopes
from truing.studies.sampling import Scatter, standard_rows


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
