"""State equations against solutions in closed form: errors, events, stiffness, machines that fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from truing.arrays import Indices, Matrix
from truing.integration import ENDLESS, GROWS, STEP_LIMIT, EventRule, InitialValueProblem, Solution, solve

Law = Callable[[Matrix, Matrix, Matrix], list[Matrix]]


@dataclass(frozen=True)
class Machines:
    """A law of (t, y, own) with a number of its own for each machine; the first state passes 0 at an event."""

    law: Law
    own: Matrix
    bounce: float = 0.0

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return np.array(self.law(t, y, self.own), dtype=float)

    def crossing(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return y[0]

    def after(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return np.array([0 * t, -self.bounce * y[1]])

    def part(self, machines: Indices) -> Machines:
        return Machines(self.law, self.own[machines], self.bounce)


@dataclass(frozen=True)
class Held:
    """A first order lag behind a drive that is held from one stamp to the next."""

    drive: Matrix

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        return self.drive[interval] - y

    def part(self, machines: Indices) -> Held:
        return self


def followed(system: object, start: list[float], stamps: Matrix, machines: int = 1, **options: object) -> Solution:
    settings = {"breaks": stamps[[0, -1]], "sizes": np.ones(len(start)), **options}
    y = np.repeat(np.array(start)[:, None], machines, axis=1)
    return solve(InitialValueProblem(system=system, start=y, stamps=stamps, **settings))  # type: ignore[arg-type]


def oscillator(t: Matrix, y: Matrix, own: Matrix) -> list[Matrix]:
    return [y[1], -(own**2) * y[0]]


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-12])
def test_errors_of_an_oscillator_shrink_with_the_tolerance(tolerance: float) -> None:
    """Ten periods: an error in every step adds up to a hundred times itself at the most."""
    frequencies, stamps = np.array([0.5, 1.0, 3.0]), np.linspace(0, 20, 81)
    solution = followed(Machines(oscillator, frequencies), [1, 0], stamps, 3, tolerance=tolerance)
    errors = np.abs(solution.states[0] - np.cos(frequencies[:, None] * stamps))
    assert errors.max() < 300 * tolerance


def test_a_pendulum_swings_as_its_elliptic_function_says() -> None:
    """L. M. Milne-Thomson, Jacobian elliptic functions: sin(phi/2) = k sn(K - t, k), k = sin(phi_0 / 2)."""
    release, stamps = 2.0, np.linspace(0, 25, 101)
    solution = followed(Machines(lambda t, y, own: [y[1], -np.sin(y[0])], np.ones(1)), [release, 0], stamps)
    m = np.sin(release / 2) ** 2
    sn, *_ = ellipj(ellipk(m) - stamps, m)
    assert solution.states[0, 0] == pytest.approx(2 * np.arcsin(np.sqrt(m) * sn), abs=1e-6)


def test_every_machine_has_steps_of_its_own() -> None:
    """What one machine is does not move the others by a digit."""
    together, stamps = np.array([0.5, 1.0, 30.0]), np.linspace(0, 5, 21)
    several = followed(Machines(oscillator, together), [1, 0], stamps, 3)
    for place, own in enumerate(together):
        alone = followed(Machines(oscillator, np.array([own])), [1, 0], stamps)
        assert several.states[:, place] == pytest.approx(alone.states[:, 0], rel=1e-9, abs=1e-10)


def test_a_ball_bounces_when_and_as_often_as_it_must() -> None:
    """From 1 m on a floor that returns all speed: every 2 sqrt(2 h / g), after sqrt(2 h / g) at first."""
    gravity, stamps = np.array([9.81, 1.62]), np.linspace(0, 10, 51)
    ball = Machines(lambda t, y, own: [y[1], -own], gravity, bounce=1.0)
    solution = followed(ball, [1, 0], stamps, 2, events=[EventRule(-1, sets=True)])
    first = np.sqrt(2 / gravity)
    assert solution.first[0] == pytest.approx(first, rel=1e-12)
    assert solution.counts[0].tolist() == np.floor((10 - first) / (2 * first) + 1).tolist()
    since = (stamps + first[:, None]) % (2 * first[:, None])
    height = gravity[:, None] * since * (2 * first[:, None] - since) / 2
    assert solution.states[0] == pytest.approx(height, abs=1e-9)


def test_events_without_end_are_said_with_their_time() -> None:
    """A ball that keeps half of its speed comes to rest after sqrt(2 h / g) (1 + e) / (1 - e)."""
    ball = Machines(lambda t, y, own: [y[1], -own], np.array([9.81]), bounce=0.5)
    solution = followed(ball, [1, 0], np.linspace(0, 10, 51), events=[EventRule(-1, sets=True, name="bounces")])
    reason, t = solution.reasons[0]
    assert reason == f"the event 'bounces' {ENDLESS}"
    assert t == pytest.approx(3 * np.sqrt(2 / 9.81), rel=1e-9)


@pytest.mark.parametrize(("direction", "times"), [(1, 3), (-1, 3), (0, 6)])
def test_an_event_counts_in_the_direction_asked_for(direction: int, times: int) -> None:
    """A cosine of three periods passes 0 three times down and three times up."""
    system = Machines(oscillator, np.array([2 * np.pi]))
    solution = followed(system, [1, 0], np.array([0.0, 3.0]), events=[EventRule(direction)])
    assert solution.counts[0, 0] == times


@pytest.mark.parametrize(("direction", "times"), [(1, 1), (-1, 1), (0, 2)])
def test_a_value_that_dips_within_a_step_passes_once_each_way(direction: int, times: int) -> None:
    """(t - 3) (t - 4) is integrated exactly, in a step that is longer than the dip."""
    system = Machines(lambda t, y, own: [y[1], 2 + 0 * t], np.ones(1))
    solution = followed(system, [12, -7], np.array([0.0, 8.0]), events=[EventRule(direction)])
    assert not solution.reasons
    assert solution.counts[0, 0] == times
    assert solution.first[0, 0] == pytest.approx(4 if direction > 0 else 3, rel=1e-12)


def test_an_event_that_ends_a_motion_holds_it() -> None:
    system = Machines(oscillator, np.array([2 * np.pi]))
    solution = followed(system, [1, 0], np.linspace(0, 3, 31), events=[EventRule(-1, ends=True)])
    assert solution.first[0, 0] == pytest.approx(0.25, rel=1e-8)
    assert solution.states[1, 0, 3:] == pytest.approx(-2 * np.pi, rel=1e-7)
    assert not solution.reasons


@pytest.mark.parametrize("stiffness", [1.0, 30.0, 1e4, 1e8])
def test_a_stiff_machine_follows_its_slow_solution(stiffness: float) -> None:
    """A. Prothero, A. Robinson 1974: y' = -s (y - cos t) - sin t keeps to cos t, however large s is."""
    system = Machines(lambda t, y, own: [-own * (y[0] - np.cos(t)) - np.sin(t)], np.array([stiffness, 1.0]))
    stamps = np.linspace(0, 10, 21)
    solution = followed(system, [1], stamps, 2)
    assert solution.states[0] == pytest.approx(np.array([np.cos(stamps)] * 2), abs=1e-6)
    assert solution.steps < 5000


def test_a_stiff_machine_has_events_too() -> None:
    """The same law passes 0 at pi/2 and 3 pi/2."""
    system = Machines(lambda t, y, own: [-own * (y[0] - np.cos(t)) - np.sin(t)], np.array([1e6]))
    solution = followed(system, [1], np.linspace(0, 6, 7), events=[EventRule(0)])
    assert solution.counts[0, 0] == 2
    assert solution.first[0, 0] == pytest.approx(np.pi / 2, abs=1e-6)


def test_machines_that_blow_up_are_named_and_the_others_go_on() -> None:
    """y' = a y^2 from 1 is 1 / (1 - a t)."""
    grows = np.array([0.1, 1.0, -1.0])
    stamps = np.linspace(0, 5, 11)
    solution = followed(Machines(lambda t, y, own: [own * y[0] ** 2], grows), [1], stamps, 3)
    assert {place: reason for place, (reason, _) in solution.reasons.items()} == {1: GROWS}
    assert solution.reasons[1][1] == pytest.approx(1.0, abs=1e-6)
    assert np.isnan(solution.states[0, 1, 3:]).all()
    fine = 1 / (1 - grows[[0, 2], None] * stamps)
    assert solution.states[0, [0, 2]] == pytest.approx(fine, rel=1e-6)


def test_a_step_limit_is_one_of_each_machine() -> None:
    frequencies = np.array([1.0, 1000.0])
    solution = followed(Machines(oscillator, frequencies), [1, 0], np.linspace(0, 10, 3), 2, most_steps=200)
    assert {place: reason for place, (reason, _) in solution.reasons.items()} == {1: STEP_LIMIT}


def test_no_step_passes_a_jump_of_the_drive() -> None:
    """Behind a held drive u a lag of 1 s goes from y to u + (y - u) exp(-t)."""
    drive, stamps = np.random.default_rng(5).normal(size=40), np.arange(41.0)
    expected = [1.0]
    for held in drive:
        expected.append(held + (expected[-1] - held) * np.exp(-1))
    solution = followed(Held(drive), [1], stamps, breaks=stamps)
    assert solution.states[0, 0] == pytest.approx(expected, abs=1e-8)
