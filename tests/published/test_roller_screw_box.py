"""Box's complex method on problems whose answers are known, over many seeds."""

from collections.abc import Callable
from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from roller_screw_shift.optimum import Plan, complex_method
from shared import ROUNDING
from truing import TruingError

Values = NDArray[np.float64]
ROOT = sqrt(3.0)
SEEDS = range(4)


def within(kept: NDArray[np.bool_], cost: Values) -> Values:
    """No cost where a limit is missed."""
    return np.where(kept, cost, np.inf)


def distance(points: Values) -> Values:
    return np.abs(points[:, 0] - 0.3)


def bounded(points: Values) -> Values:
    """The farther the better, up to a limit that no derivative announces."""
    x = points[:, 0]
    return within((x >= -0.0566) & (x <= 0.25344512345), -x)


def box_1965(points: Values) -> Values:
    """Box, The Computer Journal 8 (1965) 42; number 24 of Hock and Schittkowski: -1 at (3, sqrt 3)."""
    first, second = points.T
    line = first + ROOT * second
    kept = (second <= first / ROOT) & (line >= 0) & (line <= 6)
    return within(kept, -(9 - (first - 3) ** 2) * second**3 / (27 * ROOT))


def parcel(points: Values) -> Values:
    """Rosenbrock's parcel of length and girth up to 72 in; number 37 of Hock and Schittkowski: 3456 at (24, 12, 12)."""
    return within(points @ np.array([1.0, 2.0, 2.0]) <= 72.0, -points.prod(axis=1))


def valley(points: Values) -> Values:
    """Rosenbrock's valley, 0 at (1, 1)."""
    first, second = points.T
    return np.asarray((1 - first) ** 2 + 100 * (second - first**2) ** 2)


def two_rooms(points: Values) -> Values:
    """What is allowed is in two pieces, so the middle of the vertices may be forbidden; -1 at 2."""
    x = points[:, 0]
    return within(((x >= -1) & (x <= -0.5)) | ((x >= 1) & (x <= 2)), -x / 2)


CASES: list[tuple[Callable[[Values], Values], list[float], list[float], list[float], float]] = [
    (distance, [-1], [1], [0.3], 1e-7),
    (bounded, [-2], [3], [0.25344512345], 1e-7),
    (box_1965, [0, 0], [6, 6], [3, ROOT], 1e-5),
    (parcel, [0, 0, 0], [42, 42, 42], [24, 12, 12], 1e-5),
    (valley, [-2, -2], [2, 2], [1, 1], 1e-6),
    (two_rooms, [-2], [3], [2], 1e-7),
]


@pytest.mark.parametrize(
    ("cost", "low", "high", "answer", "close"), CASES, ids=lambda item: getattr(item, "__name__", "")
)
def test_known_answers_from_every_seed(
    cost: Callable[[Values], Values], low: list[float], high: list[float], answer: list[float], close: float
) -> None:
    for seed in SEEDS:
        found = complex_method(cost, (np.array(low), np.array(high)), np.random.default_rng(seed))
        assert found.settled
        assert found.point == pytest.approx(answer, abs=close), seed
        assert found.cost == pytest.approx(cost(found.point[None, :])[0], rel=1e-12, abs=ROUNDING)
        assert found.evaluations < 3000


def test_the_same_seed_finds_the_same_and_another_one_goes_another_way() -> None:
    def search(seed: int) -> tuple[float, int]:
        found = complex_method(box_1965, (np.zeros(2), np.full(2, 6.0)), np.random.default_rng(seed))
        return float(found.point[0]), found.evaluations

    assert search(0) == search(0)
    assert len({search(seed) for seed in range(5)}) == 5


def test_every_vertex_is_drawn_where_the_limits_are_kept_and_no_point_leaves_the_span() -> None:
    asked: list[Values] = []

    def cost(points: Values) -> Values:
        asked.append(points)
        return bounded(points)

    complex_method(cost, (np.array([-0.5]), np.array([0.4])), np.random.default_rng(3))
    every = np.concatenate(asked)
    assert every.min() >= -0.5
    assert every.max() <= 0.4


def test_nine_vertices_are_made_and_each_step_moves_one() -> None:
    """With one more cost than the first vertices need, one of them moves, and it was the worst."""
    first: list[Values] = []

    def cost(points: Values) -> Values:
        first.append(points)
        return distance(points)

    found = complex_method(cost, (np.array([-1.0]), np.array([1.0])), np.random.default_rng(0), Plan(most=1))
    assert not found.settled
    assert found.reflections == 1
    nine = first[0][:9, 0]
    worst = int(np.argmax(np.abs(nine - 0.3)))
    others = np.delete(nine, worst)
    tried = np.concatenate(first[1:])[: found.evaluations - found.drawn, 0]  # those behind the one taken do not count
    assert tried[0] == pytest.approx(np.clip(others.mean() + 1.3 * (others.mean() - nine[worst]), -1, 1))
    assert found.spread == np.ptp([*others, tried[-1]])
    assert found.cost == np.abs(np.array([*others, tried[-1]]) - 0.3).min()


@pytest.mark.parametrize(("reach", "told"), [(-1.0, "no point keeps"), (2e-4, "only")])
def test_limits_that_nothing_keeps_are_said(reach: float, told: str) -> None:
    def cost(points: Values) -> Values:
        return within(np.abs(points[:, 0]) <= reach, points[:, 0])

    with pytest.raises(TruingError, match=told):
        complex_method(cost, (np.array([-1.0]), np.array([1.0])), np.random.default_rng(0), Plan(draws=20_000))


@pytest.mark.parametrize("change", [{"vertices": 2}, {"reflection": 1.0}, {"spread": 0.0}, {"most": 0}])
def test_plans_that_make_no_sense_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(TruingError, match=next(iter(change))):
        Plan(**change)  # type: ignore[arg-type]


def test_a_span_without_width_is_refused() -> None:
    with pytest.raises(TruingError, match="lower and a higher end"):
        complex_method(distance, (np.array([1.0]), np.array([1.0])), np.random.default_rng(0))
