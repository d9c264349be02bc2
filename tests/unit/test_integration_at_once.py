"""All steps of a path at once: against closed forms, and how far a path leads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from truing.arrays import Indices, Matrix
from truing.integration import EventRule, InitialValueProblem, Path, Solution, empty_solution, solve
from truing.integration_at_once import Followed, at_once


@dataclass(frozen=True)
class Balls:
    """Balls that fall by a gravity of their own, and keep a share of their speed where they meet the floor."""

    gravity: Matrix
    bounce: float = 1.0

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return np.array([y[1], -self.gravity])

    def crossing(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return y[0]

    def after(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return np.array([0 * t, -self.bounce * y[1]])

    def part(self, machines: Indices) -> Balls:
        return replace(self, gravity=self.gravity[machines])


@dataclass(frozen=True)
class Pendulums:
    """Pendulums of frequencies of their own; their angle passes 0 at an event that sets nothing."""

    frequency: Matrix

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return np.array([y[1], -(self.frequency**2) * np.sin(y[0])])

    def crossing(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return y[0]

    def part(self, machines: Indices) -> Pendulums:
        return Pendulums(self.frequency[machines])


@dataclass(frozen=True)
class Lags:
    """Lags of their own times behind a drive that is held from one stamp to the next; how they lag bends."""

    lag: Matrix
    drive: Matrix

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return (self.drive[interval] - np.sqrt(np.abs(y))) / self.lag

    def part(self, machines: Indices) -> Lags:
        return replace(self, lag=self.lag[machines])


def problem_of(
    system: object, start: Sequence[float], stamps: Matrix, count: int, **options: object
) -> InitialValueProblem:
    y = np.repeat(np.array(start, dtype=float)[:, None], count, axis=1)
    settings = {"breaks": stamps[[0, -1]], "sizes": np.ones(len(start)), **options}
    return InitialValueProblem(system=system, start=y, stamps=stamps, **settings)  # type: ignore[arg-type]


def path_of(problem: InitialValueProblem) -> Path:
    """The path of the one machine of a problem, taken step by step."""
    return solve(problem, keeps_paths=True).paths(problem)[0]


def along(problem: InitialValueProblem, path: Path) -> tuple[Followed, Solution]:
    solution = empty_solution(problem)
    return at_once(problem, dict.fromkeys(range(problem.start.shape[1]), path), solution), solution


def test_machines_follow_the_path_of_one_nearby() -> None:
    """Periods and states are those of single steps, within what the errors of these add up to."""
    stamps, frequency = np.linspace(0, 12, 61), np.array([1.0, 1.0001, 0.99, 1.05])
    rule = EventRule(0)
    path = path_of(problem_of(Pendulums(np.ones(1)), [1, 0], stamps, 1, events=[rule]))
    several = problem_of(Pendulums(frequency), [1, 0], stamps, 4, events=[rule])
    followed, solution = along(several, path)
    assert sorted(followed.whole) == [0, 1, 2, 3]
    finest = solve(replace(several, tolerance=1e-12))
    assert solution.states == pytest.approx(finest.states, abs=2e-7)
    assert solution.counts.tolist() == finest.counts.tolist()
    assert solution.first == pytest.approx(finest.first, abs=1e-8)


def test_events_come_when_they_must() -> None:
    """A ball bounces after sqrt(2 h / g), and then every 2 sqrt(2 h / g)."""
    stamps, gravity, rules = np.linspace(0, 4, 41), np.array([9.81, 9.9, 9.7]), [EventRule(-1, sets=True)]
    path = path_of(problem_of(Balls(gravity[:1]), [1, 0], stamps, 1, events=rules))
    followed, solution = along(problem_of(Balls(gravity), [1, 0], stamps, 3, events=rules), path)
    assert sorted(followed.whole) == [0, 1, 2]
    first = np.sqrt(2 / gravity)
    assert solution.first[0] == pytest.approx(first, rel=1e-12)
    since = (stamps + first[:, None]) % (2 * first[:, None])
    assert solution.states[0] == pytest.approx(gravity[:, None] * since * (2 * first[:, None] - since) / 2, abs=1e-9)


def height_of_ball(gravity: float, t: Matrix) -> Matrix:
    """Height at some times of a ball that falls from 1 m."""
    first = np.sqrt(2 / gravity)
    since = (t + first) % (2 * first)
    return np.asarray(gravity * since * (2 * first - since) / 2)


def test_a_path_leads_beyond_the_record_where_less_happens() -> None:
    """Of less gravity a ball bounces less often in the record."""
    stamps, rules = np.linspace(0, 4.1, 42), [EventRule(-1, sets=True)]
    path = path_of(problem_of(Balls(np.array([9.81])), [1, 0], stamps, 1, events=rules))
    followed, solution = along(problem_of(Balls(np.array([9.0])), [1, 0], stamps, 1, events=rules), path)
    assert path.event.tolist().count(0) == 5
    assert (solution.counts[0, 0], [*followed.whole], followed.part) == (4, [0], {})
    assert solution.states[0, 0] == pytest.approx(height_of_ball(9.0, stamps), abs=1e-9)


def test_a_path_leads_up_to_where_other_events_come() -> None:
    """Of more gravity a ball bounces more often in the record: its path ends before, and is right so far.

    From there it is followed step by step.
    """
    gravity, stamps, rules = 10.5, np.linspace(0, 4.9, 42), [EventRule(-1, sets=True)]
    path = path_of(problem_of(Balls(np.array([9.81])), [1, 0], stamps, 1, events=rules))
    problem = problem_of(Balls(np.array([gravity])), [1, 0], stamps, 1, events=rules)
    followed, solution = along(problem, path)
    part, first = followed.part[0], np.sqrt(2 / gravity)
    assert not followed.whole
    bounces = np.floor((stamps[-1] - first) / (2 * first) + 1)
    assert solution.counts[0, 0] >= bounces - 1
    height = height_of_ball(gravity, stamps)
    is_known = stamps <= part.t[-1]
    assert solution.states[0, 0, is_known] == pytest.approx(height[is_known], abs=1e-9)
    assert np.isnan(solution.states[0, 0, ~is_known]).all()
    solve(replace(problem, start=part.y[:, -1:], begin=(part.t[-1:], part.interval[-1:])), solution)
    assert solution.states[0, 0] == pytest.approx(height, abs=1e-9)
    assert solution.counts[0, 0] == bounces
    assert solution.first[0, 0] == pytest.approx(first, rel=1e-12)


def test_steps_that_are_too_long_are_parted() -> None:
    """At three times the frequency a pendulum needs shorter steps than the path has."""
    stamps = np.linspace(0, 3, 16)
    path = path_of(problem_of(Pendulums(np.ones(1)), [1, 0], stamps, 1))
    faster = problem_of(Pendulums(np.array([3.0])), [1, 0], stamps, 1)
    followed, solution = along(faster, path)
    assert len(followed.whole[0].event) > len(path.event)
    assert solution.states == pytest.approx(solve(replace(faster, tolerance=1e-12)).states, abs=2e-7)


def test_a_driven_machine_needs_no_path_but_its_stamps() -> None:
    drive, stamps = np.random.default_rng(7).uniform(1, 2, 40), np.arange(41.0)
    several = problem_of(Lags(np.array([3.0, 20.0]), drive), [1.5], stamps, 2, breaks=stamps)
    still = Path(stamps, np.full((1, 41), 1.5), np.arange(40), np.full(40, -1))
    followed, solution = along(several, still)
    assert sorted(followed.whole) == [0, 1]
    assert solution.states == pytest.approx(solve(replace(several, tolerance=1e-12)).states, abs=1e-7)


def test_an_event_that_ends_a_motion_holds_it() -> None:
    """A ball stays where it first meets the floor, sooner in more gravity and later in less."""
    stamps, gravity, rules = np.linspace(0, 2, 21), np.array([9.81, 11.0, 9.0]), [EventRule(-1, ends=True)]
    path = path_of(problem_of(Balls(gravity[:1]), [1, 0], stamps, 1, events=rules))
    followed, solution = along(problem_of(Balls(gravity), [1, 0], stamps, 3, events=rules), path)
    assert sorted(followed.whole) == [0, 1, 2]
    assert solution.first[0] == pytest.approx(np.sqrt(2 / gravity), rel=1e-12)
    assert solution.states[1, :, -1] == pytest.approx(-np.sqrt(2 * gravity), rel=1e-9)
