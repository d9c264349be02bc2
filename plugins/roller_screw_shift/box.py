"""The complex method of Box: the least cost within limits, by a cloud of vertices that walks, shrinks and settles.

Sources: M. J. Box, The Computer Journal 8 (1965) 42; J. A. Guin, The Computer Journal 10 (1968) 416, for the way back
that ends at the best vertex. The limits need no derivative and no penalty: a point that misses one has no cost.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from truing import TruingError

Values = NDArray[np.float64]
Cost = Callable[[Values], Values]
"""Of points (n, d) their costs (n,): small is good, and not finite where a point misses a limit."""

AT_ONCE = 64
HELD = 0.8  # of the way from the best vertex to the middle is left as the goal of the way back, after every try
ALIKE = 4e-16  # of the largest cost: what differs by less cannot be told apart


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How the cloud is made and when it has settled: ``spread`` is its largest extent along any direction.

    At most ``draws`` points are drawn for the first vertices, and ``most`` costs asked for after them.
    """

    vertices: int = 9
    reflection: float = 1.3
    spread: float = 1e-8
    most: int = 5000
    draws: int = 50_000

    def __post_init__(self) -> None:
        if self.vertices < 3:
            raise TruingError(f"vertices = {self.vertices}, but a complex has at least 3, and one more than directions")
        if not self.reflection > 1:
            raise TruingError(f"reflection = {self.reflection:g} must lie above 1: a complex would shrink where it is")
        if not self.spread > 0:
            raise TruingError(f"spread = {self.spread:g} must lie above 0")
        if min(self.most, self.draws) < 1:
            raise TruingError(f"most = {self.most} and draws = {self.draws} are at least 1")


@dataclass(frozen=True, eq=False)
class Found:
    """The best vertex (d,), its cost, how wide the cloud still is, and what it took.

    Of the ``evaluations`` so many were ``drawn`` for the first vertices.
    """

    point: Values
    cost: float
    spread: float
    evaluations: int
    drawn: int
    reflections: int
    settled: bool


def complex_method(
    cost: Cost, span: tuple[Values, Values], rng: np.random.Generator, plan: Plan | None = None
) -> Found:
    """Return the point of least cost between the ends of ``span``, each (d,).

    Raises TruingError with a sentence where too few points keep the limits to make the first vertices.
    """
    plan = plan or Plan()
    low, high = (np.atleast_1d(np.asarray(end, dtype=float)) for end in span)
    if not (np.isfinite(low).all() and np.isfinite(high).all() and (low < high).all()):
        raise TruingError("the complex method searches between a lower and a higher end, both finite")
    cloud, drawn = _first(cost, (low, high), rng, plan)
    asked = reflections = 0
    while not cloud.settled(plan.spread) and asked < plan.most:
        cloud, tries = _stepped(cost, cloud, (low, high), plan)
        asked, reflections = asked + tries, reflections + 1
    best = cloud.best
    return Found(
        cloud.points[best].copy(), float(cloud.costs[best]), cloud.spread, drawn + asked, drawn, reflections,
        settled=cloud.settled(plan.spread),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Cloud:
    points: Values  # (k, d), all within the limits
    costs: Values  # (k,)

    @property
    def best(self) -> int:
        return int(np.argmin(self.costs))

    @property
    def worst(self) -> int:
        return int(np.argmax(self.costs))

    @property
    def spread(self) -> float:
        return float(np.ptp(self.points, axis=0).max())

    def settled(self, spread: float) -> bool:
        """Whether the cloud is as small as asked, or its costs differ by rounding alone."""
        return self.spread < spread or bool(np.ptp(self.costs) <= ALIKE * np.abs(self.costs).max())


def _first(cost: Cost, span: tuple[Values, Values], rng: np.random.Generator, plan: Plan) -> tuple[_Cloud, int]:
    """Draw evenly, and again where a limit is missed, until every vertex keeps them all."""
    low, high = span
    points, costs = np.empty((0, len(low))), np.empty(0)
    drawn = 0
    while len(points) < plan.vertices and drawn < plan.draws:
        tried = low + (high - low) * rng.random((AT_ONCE, len(low)))
        found = cost(tried)
        kept = np.isfinite(found)
        points, costs = np.concatenate([points, tried[kept]]), np.concatenate([costs, found[kept]])
        drawn += AT_ONCE
    if len(points) < plan.vertices:
        told = "no point keeps" if not len(points) else f"only {len(points)} points keep"
        raise TruingError(f"{told} every limit among {drawn} drawn evenly; {plan.vertices} vertices are needed")
    return _Cloud(points[: plan.vertices], costs[: plan.vertices]), drawn


def _stepped(cost: Cost, cloud: _Cloud, span: tuple[Values, Values], plan: Plan) -> tuple[_Cloud, int]:
    """Reflect the worst vertex through the middle of the others; halve the way back until it is better than it was.

    The place to which it comes back begins at that middle and ends at the best vertex, which the worst then joins.
    """
    worst = cloud.worst
    others, costs = np.delete(cloud.points, worst, axis=0), np.delete(cloud.costs, worst)
    best = int(np.argmin(costs))
    middle, goal = others.mean(axis=0), others[best]
    point = np.clip(middle + plan.reflection * (middle - cloud.points[worst]), *span)
    value, tries = float(cost(point[None, :])[0]), 1
    while not value < cloud.costs[worst]:
        if np.abs(point - goal).max() < 0.5 * plan.spread:
            point, value = goal, float(costs[best])
            break
        held = HELD**tries
        point = 0.5 * (point + held * middle + (1.0 - held) * goal)
        value, tries = float(cost(point[None, :])[0]), tries + 1
    return _Cloud(np.vstack([others, point]), np.append(costs, value)), tries
