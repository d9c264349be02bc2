"""State equations of many machines at once: each has its own step, its own error, its own events and its own end.

The pair of Dormand and Prince of orders 8(5, 3) with the coefficients of ``scipy.integrate.DOP853``; what it cannot
follow because the system is stiff goes to scipy's BDF. n machines of d states are arrays (d, n).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from truing.arrays import Indices, Mask, Matrix
from truing.heavy import integrate, sparse

ORDER = 8
STAGES = 12
SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0
"""Of the next step: how careful it is, and how much shorter or longer than the last one it may be."""
ROUNDING = 2.0**-52
LEAST_STEP = 16 * ROUNDING
"""Shortest step, as a share of the time that is reached."""
LOOKS, MOST_ROUNDS = 8, 60
"""How often a step is looked at for events, and in how many rounds at the most the time of one is found."""
TOGETHER = 4096
"""So many machines take their steps together: of more the stages no longer fit the cache."""
WRITTEN = 65_536
"""States at so many stamps are calculated at once."""
MOST_EVENTS = 10_000
CLOSE, TINY = 1e-12, 1e-300
"""More events of one machine in one record, or events so close (a share of the record), have no end. What has just
passed 0 counts as being beyond it, by ``TINY`` at the least: it does not pass again."""
LEAST_TOLERANCE = 1e-13
STIFF, STIFF_STEPS = 5.0, 15
"""Step times rate constant near the edge of stability, which is at 6; so many steps there make a machine stiff."""

GROWS = "a state grows beyond all bounds"
STEP_LIMIT = "the step limit is reached"
ENDLESS = "comes again and again without end"


class System(Protocol):
    """The state equation of n machines; t is (n,), y is (d, n), ``interval`` (n,) counts the stretch between breaks."""

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return dy/dt, (d, n)."""

    def crossing(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return what passes 0 when an event happens, (n,)."""

    def after(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return the state after an event, (d, n)."""

    def part(self, machines: Indices) -> System:
        """Return the equation of some of the machines."""


@dataclass(frozen=True)
class EventRule:
    """What makes an event: it counts where its value rises (1), falls (-1) or does either (0) through 0."""

    direction: int
    ends: bool = False
    sets: bool = False
    """Whether it sets the state anew."""
    name: str = ""


@dataclass(frozen=True, kw_only=True)
class InitialValueProblem:
    """What is to be integrated: from ``start`` (d, n) at the first of ``stamps`` (k,), which rise, to the last.

    ``breaks`` rise and begin and end with the stamps: no step passes one. An error is held below ``tolerance`` times
    the size of a state, of which ``sizes`` (d,) are the least.
    """

    system: System
    start: Matrix
    stamps: Matrix
    breaks: Matrix
    sizes: Matrix
    events: Sequence[EventRule] = ()
    begin: tuple[Matrix, Indices] | None = None
    """When each machine begins, (n,), and in which stretch, where that is not the first stamp."""
    tolerance: float = 1e-8
    most_steps: int = 100_000


@dataclass(frozen=True)
class Slopes:
    """Derivatives of m steps: by the state that each begins with, (m, d, d); and of the event that ends it.

    Those of its value, (m, d + 1), and of the states after it, (m, d, d + 1), are by the states and the time there. Of
    n machines all have one more dimension in front.
    """

    step: Matrix
    value: Matrix
    after: Matrix

    def some(self, machines: Indices) -> Slopes:
        """Return those of some machines."""
        return Slopes(self.step[machines], self.value[machines], self.after[machines])

    def of(self, machine: int, steps: int) -> Slopes:
        """Return those of the first steps of one machine."""
        return Slopes(*(np.array(each[machine, :steps]) for each in (self.step, self.value, self.after)))


@dataclass(frozen=True)
class Path:
    """The m steps of one machine: times (m + 1,) and states (d, m + 1) at which they begin and the last one ends.

    ``interval`` (m,) is the stretch between breaks of each, ``event`` (m,) what ended it, -1 where nothing did.
    """

    t: Matrix
    y: Matrix
    interval: Indices
    event: Indices
    slopes: Slopes | None = None

    def then(self, rest: Path) -> Path:
        """Return this path and another one behind it, which begins where it ends."""
        return Path(
            np.append(self.t[:-1], rest.t), np.column_stack([self.y[:, :-1], rest.y]),
            np.append(self.interval, rest.interval), np.append(self.event, rest.event),
        )  # fmt: skip


@dataclass
class Solution:
    """States at the stamps, (d, n, k), NaN where a machine did not come to; ``reasons`` by machine, and when.

    ``counts`` and ``first``, (events, n), say how often and when first each event happened, NaN where it never did.
    """

    states: Matrix
    counts: Matrix
    first: Matrix
    reasons: dict[int, tuple[str, float]] = field(default_factory=dict)
    steps: int = 0
    taken: list[tuple[Any, ...]] | None = None
    """What was taken, where it is to be kept: machines, begin, end, state at the begin, stretch, event at the end."""

    def paths(self, problem: InitialValueProblem) -> dict[int, Path]:
        """Return the path of every machine that came to the end of its record, by steps of this method alone."""
        if not self.taken:
            return {}
        machine, t, end, y, interval, event = (np.concatenate(each, axis=-1) for each in zip(*self.taken, strict=True))
        order = np.argsort(machine, kind="stable")
        made = {}
        for number, own in enumerate(np.split(order, np.searchsorted(machine[order], range(1, self.states.shape[1])))):
            is_whole = len(own) and (
                end[own[-1]] == problem.stamps[-1] or (event[own[-1]] >= 0 and problem.events[event[own[-1]]].ends)
            )
            if is_whole and number not in self.reasons:
                states = np.column_stack([y[:, own], self.states[:, number, -1]])
                made[number] = Path(np.append(t[own], end[own[-1]]), states, interval[own], event[own])
        return made


def solve(
    problem: InitialValueProblem, solution: Solution | None = None, *, keeps_paths: bool = False
) -> Solution:  # fmt: skip
    """Integrate every machine; one that comes to no end has NaN from there on, and a reason.

    Machines that begin later are given with a solution that holds what is before.
    """
    solution = solution or empty_solution(problem)
    solution.taken = [] if keeps_paths else None
    with np.errstate(all="ignore"):
        everyone = np.arange(problem.start.shape[1])
        for machines in np.split(everyone, range(TOGETHER, len(everyone), TOGETHER)):
            stiff = _march(problem, machines, solution)
            _stiff(problem, stiff, solution)
    return solution


def empty_solution(problem: InitialValueProblem) -> Solution:
    """Return a solution that knows the starts alone."""
    events, machines = len(problem.events), problem.start.shape[1]
    states = np.full((*problem.start.shape, len(problem.stamps)), np.nan)
    states[:, :, 0] = problem.start
    return Solution(states, np.zeros((events, machines)), np.full((events, machines), np.nan))


@lru_cache(maxsize=1)
def method() -> Any:
    """Return the coefficients; scipy is loaded when they are first needed."""
    return integrate.DOP853


@dataclass
class _Going:
    """Machines on their way: number, time, state, rate and next step of each, and where each stands in its record."""

    machine: Indices
    t: Matrix
    y: Matrix
    rate: Matrix
    step: Matrix
    interval: Indices
    stamp: Indices
    value: Matrix
    taken: Indices
    at_edge: Indices
    last_event: Matrix
    is_stale: bool = False
    """Whether the rates are those before a jump."""

    def some(self, places: Indices) -> _Going:
        """Return some of them."""
        arrays = {name: value[..., places] for name, value in vars(self).items() if name != "is_stale"}
        return _Going(**arrays)


@dataclass(frozen=True)
class Step:
    """A step that was taken, of some machines: from ``t`` and ``y`` by ``length`` to ``end`` and ``reached``."""

    t: Matrix
    y: Matrix
    length: Matrix
    end: Matrix
    reached: Matrix
    rate: Matrix
    """That at the end."""


def _march(problem: InitialValueProblem, machines: Indices, solution: Solution) -> Indices:
    """Take steps until every machine has come to an end; return those that are left because they are stiff."""
    system = problem.system.part(machines)
    begin = problem.begin and (problem.begin[0][machines], problem.begin[1][machines])
    going = _begun(replace(problem, system=system, start=problem.start[:, machines], begin=begin), machines)
    stiff: list[Indices] = []
    while len(going.machine):
        ended = _one_step(problem, system, going, solution)
        at_edge = ~ended & (going.at_edge >= STIFF_STEPS)
        stiff.append(going.machine[at_edge])
        ended = ended | at_edge
        if ended.any():
            on = np.flatnonzero(~ended)
            system, going = system.part(on), going.some(on)
    return np.concatenate([np.zeros(0, dtype=np.intp), *stiff])


def _begun(problem: InitialValueProblem, machines: Indices) -> _Going:
    count, events = problem.start.shape[1], range(len(problem.events))
    t, interval = problem.begin or (np.full(count, problem.stamps[0]), np.zeros(count, dtype=np.intp))
    t, interval = np.array(t), np.array(interval)
    y = np.array(problem.start, dtype=float)
    rate = problem.system.rate(t, y, interval)
    values = [problem.system.crossing(event, t, y, interval) for event in events]
    if problem.begin is not None:  # an event may just have happened
        short = 1e-6 * (problem.stamps[-1] - problem.stamps[0])
        gained = [_gained(event, problem.system, (t, y, interval), short) for event in events]
        beyond = [_beyond(value, gain, [gain, gain]) for value, gain in zip(values, gained, strict=True)]
        values = [np.where(t > problem.stamps[0], *each) for each in zip(beyond, values, strict=True)]
    return _Going(
        machine=machines, t=t, y=y, rate=rate, step=_first_step(problem, (t, y, rate), interval),
        interval=interval, stamp=np.searchsorted(problem.stamps, t, side="right"),
        value=np.array(values).reshape(len(events), count), taken=np.zeros(count, dtype=np.intp),
        at_edge=np.zeros(count, dtype=np.intp), last_event=np.full(count, -np.inf),
    )  # fmt: skip


def scale_of(problem: InitialValueProblem, *states: Matrix) -> Matrix:
    """Return what errors of states are held below, (d, n)."""
    largest = problem.sizes[:, None]
    for state in states:
        largest = np.maximum(largest, np.abs(state))
    return np.asarray(problem.tolerance * largest)


def _mean_square(errors: Matrix) -> Matrix:
    return np.asarray(np.mean(errors * errors, axis=0))


def _first_step(problem: InitialValueProblem, at: tuple[Matrix, Matrix, Matrix], interval: Indices) -> Matrix:
    """Guess a first step from time, state and rate, and how fast this changes (Hairer, Norsett, Wanner, II.4)."""
    t, y, rate = at
    scale, whole = scale_of(problem, y), problem.stamps[-1] - problem.stamps[0]
    size, slope = (np.sqrt(_mean_square(each / scale)) for each in (y, rate))
    guess = np.where((size < 1e-5) | (slope < 1e-5), 1e-6 * whole, 0.01 * size / slope)
    guess = np.minimum(guess, whole)
    bent = problem.system.rate(t + guess, y + guess * rate, interval)
    change = np.maximum(slope, np.sqrt(_mean_square((bent - rate) / scale)) / guess)
    better = np.where(change <= 1e-15 / whole, np.maximum(1e-6 * whole, guess * 1e-3), (0.01 / change) ** (1 / ORDER))
    step = np.minimum(np.minimum(100 * guess, better), whole)
    return np.asarray(np.where(np.isfinite(step) & (step > 0), step, 1e-6 * whole))


def _one_step(problem: InitialValueProblem, system: System, going: _Going, solution: Solution) -> Mask:
    """Try one step of every machine; return those that have come to an end, good or bad."""
    until = problem.breaks[going.interval + 1]
    is_last = going.step >= until - going.t
    length = np.where(is_last, until - going.t, going.step)
    end = np.where(is_last, until, going.t + length)
    stages, last = stages_of(system, (going.t, going.y, going.rate, length), going.interval)
    reached = going.y + length * combined(method().B, stages)
    stages[STAGES] = system.rate(end, reached, going.interval)
    constant = _mean_square(stages[STAGES] - stages[STAGES - 1]) / _mean_square(reached - last)
    going.at_edge = np.where(length * np.sqrt(constant) > STIFF, going.at_edge + 1, np.maximum(going.at_edge - 1, 0))
    error = error_of(stages, length, scale_of(problem, going.y, reached))
    is_good = error < 1
    factor = np.clip(np.where(error > 0, SAFETY * error ** (-1 / ORDER), GROW), SHRINK, GROW)
    factor = np.where(np.isfinite(error), factor, SHRINK)
    grown = np.where(is_last, np.maximum(going.step, length * factor), length * factor)
    going.step = np.where(is_good, grown, length * np.minimum(factor, SAFETY))
    going.taken += 1
    solution.steps += 1
    ended = _stopped(problem, going, is_good, solution)
    good = np.flatnonzero(is_good & ~ended)
    if len(good):
        own = (going.t, going.y, length, end, reached, stages[STAGES])
        step = Step(*(each[..., good] for each in own))
        dense = OwnDense(system.part(good), going.interval[good], step, stages[..., good])
        ended[good] |= _arrive(problem, going, good, dense, solution)
        if going.is_stale:
            going.rate, going.is_stale = system.rate(going.t, going.y, going.interval), False
    return ended


def combined(weights: Matrix, stages: Matrix) -> Matrix:
    """Return a weighted sum of stages, (d, n)."""
    return np.asarray((weights @ stages[: len(weights)].reshape(len(weights), -1)).reshape(stages.shape[1:]))


def stages_of(system: System, step: tuple[Matrix, Matrix, Matrix, Matrix], interval: Indices) -> tuple[Matrix, Matrix]:
    """Return the rates at the stages of a step from t, y, the rate there, by a length; and the state at the last one.

    Shapes (16, d, n), the last four left empty, and (d, n).
    """
    t, y, rate, length = step
    stages, last = np.empty((16, *y.shape)), y
    stages[0] = rate
    for stage in range(1, STAGES):
        last = y + length * combined(method().A[stage, :stage], stages)
        stages[stage] = system.rate(t + method().C[stage] * length, last, interval)
    return stages, last


def error_of(stages: Matrix, length: Matrix, scale: Matrix) -> Matrix:
    """Return the error of a step in multiples of what is allowed, (n,): estimates of two orders in one."""
    fifth = _mean_square(combined(method().E5, stages) / scale)
    third = _mean_square(combined(method().E3, stages) / scale)
    mixed = fifth + 0.01 * third
    return np.asarray(np.where(mixed == 0, 0.0, np.abs(length) * fifth / np.sqrt(np.where(mixed == 0, 1.0, mixed))))


def _stopped(problem: InitialValueProblem, going: _Going, is_good: Mask, solution: Solution) -> Mask:
    """Note the machines that can go no further, with the reason and the time; return them."""
    tiny = ~is_good & (going.step < LEAST_STEP * np.maximum(np.abs(going.t), problem.stamps[-1] - problem.stamps[0]))
    many = ~tiny & (going.taken >= problem.most_steps) & (problem.stamps[-1] > going.t)
    for place in np.flatnonzero(tiny | many):
        reason = GROWS if tiny[place] else STEP_LIMIT
        solution.reasons[int(going.machine[place])] = (reason, float(going.t[place]))
    return np.asarray(tiny | many)


@dataclass(frozen=True)
class _Arrival:
    """Where machines are after a step, by their ``places`` among those on their way; by which ``event`` (-1: none)."""

    places: Indices
    event: Indices
    t: Matrix
    y: Matrix


def _arrive(problem: InitialValueProblem, going: _Going, places: Indices, dense: _Dense, solution: Solution) -> Mask:
    """Go where a step ends, or where an event stops it, and fill in the stamps on the way; return who is at the end."""
    arrival = _first_event(problem, dense, going, places)
    if solution.taken is not None and isinstance(dense, OwnDense):
        begin = dense.step.t, arrival.t, dense.step.y
        solution.taken.append((going.machine[places], *begin, dense.interval, arrival.event))
    _write(problem, dense, going, arrival, solution)
    t = arrival.t
    going.t[places], going.rate[:, places] = t, dense.step.rate
    going.y = np.array(going.y)
    going.y[:, places] = arrival.y
    happened = arrival.event >= 0
    at_break = (t == problem.breaks[going.interval[places] + 1]) & ~happened
    ended = at_break & (t == problem.stamps[-1])
    going.interval[places] += at_break & ~ended
    if happened.any():
        ended |= _happen(problem, dense.system, going, arrival, solution)
    going.is_stale = bool(happened.any() or (at_break & ~ended).any())
    return np.asarray(ended)


def _write(problem: InitialValueProblem, dense: _Dense, going: _Going, arrival: _Arrival, solution: Solution) -> None:
    """Fill in the states at the stamps that were passed."""
    machine, begin = going.machine[arrival.places], going.stamp[arrival.places]
    end = np.searchsorted(problem.stamps, arrival.t, side="right")
    going.stamp[arrival.places] = end
    exact = (end > begin) & (problem.stamps[end - 1] == arrival.t)
    solution.states[:, machine[exact], end[exact] - 1] = arrival.y[:, exact]
    count = end - begin - exact
    if not count.any():
        return
    place = np.repeat(np.arange(len(count)), count)
    stamp = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count) + begin[place]
    for first in range(0, len(place), WRITTEN):
        some = slice(first, first + WRITTEN)
        solution.states[:, machine[place[some]], stamp[some]] = dense.at(problem.stamps[stamp[some]], place[some])


class _Dense(Protocol):
    """The states along a step of some machines."""

    system: System
    interval: Indices
    step: Step

    def at(self, t: Matrix, place: Indices | slice) -> Matrix:
        """Return the states of the machines at these places of the step, each at a time of its own, (d, m)."""

    def looks(self) -> Matrix:
        """Return the states of all machines at ``LOOKS`` times of their steps, evenly from after the begin to the end,
        (d, LOOKS, n)."""


class OwnDense:
    """Those of steps of Dormand and Prince, to the seventh order; calculated where they are asked for."""

    def __init__(self, system: System, interval: Indices, step: Step, stages: Matrix) -> None:
        self.system, self.interval, self.step = system, interval, step
        self._stages, self._is_complete = stages, False
        self._parts: Matrix | None = None

    def at(self, t: Matrix, place: Indices | slice) -> Matrix:
        """Return the states of the machines at these places of the step, each at a time of its own, (d, m)."""
        if self._parts is None:
            self._parts = self._prepared()
        share = (t - self.step.t[place]) / self.step.length[place]
        parts = self._parts[:, :, place]
        y = parts[-1] * share
        for number in range(len(parts) - 2, -1, -1):
            y += parts[number]
            y *= share if number % 2 == 0 else 1 - share
        y += self.step.y[:, place]
        return np.asarray(y)

    def looks(self) -> Matrix:
        """Return the states of all machines at ``LOOKS`` times of their steps, (d, LOOKS, n)."""
        self._add_stages()
        step, stages = self.step, self._stages
        gone = (_weights_of_looks() @ stages.reshape(len(stages), -1)).reshape(LOOKS - 1, *step.y.shape)
        states = np.concatenate([step.y + step.length * gone, step.reached[None]])
        return states.swapaxes(0, 1)

    def _add_stages(self) -> None:
        """Calculate the rates that the states within the steps take beyond those at the stages."""
        if self._is_complete:
            return
        step, stages, weights_of = self.step, self._stages, method()
        for stage, (weights, share) in enumerate(zip(weights_of.A_EXTRA, weights_of.C_EXTRA, strict=True), STAGES + 1):
            y = step.y + step.length * combined(weights[:stage], stages)
            stages[stage] = self.system.rate(step.t + share * step.length, y, self.interval)
        self._is_complete = True

    def _prepared(self) -> Matrix:
        self._add_stages()
        step, stages = self.step, self._stages
        gone = step.reached - step.y
        bend = step.length * stages[0] - gone
        higher = [step.length * combined(weights, stages) for weights in method().D]
        return np.array([gone, bend, 2 * gone - step.length * (step.rate + stages[0]), *higher])


@lru_cache(maxsize=1)
def _weights_of_looks() -> Matrix:
    """Return by what each stage takes part in the state at each look but the last, (LOOKS - 1, 16)."""
    rate, last = np.eye(16)[[0, STAGES]]
    gone = np.append(method().B, np.zeros(16 - STAGES))
    parts = [gone, rate - gone, 2 * gone - last - rate, *method().D]
    share = np.arange(1, LOOKS)[:, None] / LOOKS
    weights = np.zeros((LOOKS - 1, 16))
    for number in range(len(parts) - 1, -1, -1):
        weights = (weights + parts[number]) * (share if number % 2 == 0 else 1 - share)
    return weights


# Events: what passes 0 within a step is bracketed, the earliest of each machine ends its step there


def _first_event(problem: InitialValueProblem, dense: _Dense, going: _Going, good: Indices) -> _Arrival:
    """Return where machines are after their step, or at the earliest event in it."""
    step = dense.step
    event, t, y = np.full(len(good), -1), np.array(step.end), np.array(step.reached)
    if not problem.events:
        return _Arrival(good, event, t, y)
    times, states = np.linspace(step.t, step.end, LOOKS + 1), dense.looks()
    for number, rule in enumerate(problem.events):
        values = np.array([going.value[number, good], *values_at_looks(number, dense, times[1:], states)])
        going.value[number, good] = values[-1]
        happens = passes(values, rule)
        places = np.flatnonzero(happens.any(axis=0))
        if len(places):
            look = happens[:, places].argmax(axis=0)
            beyond = values[look + 1, places]
            going.value[number, good[places]] = beyond  # it may come back in the same step
            ends = [(times[each, places], values[each, places]) for each in (look, look + 1)]
            when = _crossed(number, dense, places, ends)
            sooner = (when < t[places]) | (event[places] < 0)
            event[places[sooner]], t[places[sooner]] = number, when[sooner]
    happened = np.flatnonzero(event >= 0)
    if len(happened):
        y[:, happened] = dense.at(t[happened], happened)
    return _Arrival(good, event, t, y)


def values_at_looks(event: int, dense: _Dense, times: Matrix, states: Matrix) -> Matrix:
    """Return the value of an event at several times (m, n) of steps, in states (d, m, n), (m, n)."""
    pairs = zip(times, states.swapaxes(0, 1), strict=True)
    return np.array([dense.system.crossing(event, t, y, dense.interval) for t, y in pairs])


def passes(values: Matrix, rule: EventRule) -> Mask:
    """Mark between which of the values (m + 1, n) an event happens, (m, n); one that is known begins at 0 as well."""
    before, after = values[:-1], values[1:]
    if rule.direction == 0:
        return np.asarray(before * after < 0)
    signed = rule.direction
    return np.asarray((signed * before <= 0) & (signed * after > 0))


def _crossed(number: int, dense: _Dense, places: Indices, ends: Sequence[tuple[Matrix, Matrix]]) -> Matrix:
    """Return when the value of an event is 0 between two ends (time, value): regula falsi after Illinois."""
    (low, under), (high, over) = ends
    system, interval, after = dense.system.part(places), dense.interval[places], np.sign(over)
    close = 1e-14 * (high - low) + ROUNDING * np.abs(high)
    when, is_found, has_passed = high, np.zeros(len(places), dtype=bool), np.ones(len(places), dtype=bool)
    for _ in range(MOST_ROUNDS):
        before, middle = when, (low + high) / 2
        line = (low * over - high * under) / (over - under)
        when = np.where(is_found, when, np.where((under == 0) | (over == under), middle, line))
        value = system.crossing(number, when, dense.at(when, places), interval)
        is_found |= (np.abs(when - before) <= close) | ((value == 0) & (under != 0))
        if is_found.all():
            break
        again, has_passed = has_passed == (value * after > 0), value * after > 0
        low, high = np.where(has_passed, low, when), np.where(has_passed, when, high)
        under, over = (
            np.where(has_passed, np.where(again, under / 2, under), value),
            np.where(has_passed, value, np.where(again, over / 2, over)),
        )
    return np.asarray(when)


def _happen(problem: InitialValueProblem, system: System, going: _Going, arrival: _Arrival, solution: Solution) -> Mask:
    """Let events happen: count them, set the states, hold those that end. Return the machines that are ended."""
    ended = np.zeros(len(arrival.t), dtype=bool)
    for number, rule in enumerate(problem.events):
        places = np.flatnonzero(arrival.event == number)
        if not len(places):
            continue
        own, part = arrival.places[places], system.part(places)
        t, interval, before = going.t[own], going.interval[own], going.y[:, own]
        if rule.sets:
            going.y[:, own] = part.after(number, t, going.y[:, own], interval)
        ended[places] = _count(problem, solution, number, going.machine[own], (going.last_event[own], t))
        going.last_event[own] = t
        for place in own[~ended[places]] if rule.ends else ():
            solution.states[:, going.machine[place], going.stamp[place] :] = going.y[:, place, None]
        ended[places] |= rule.ends
        after = going.value[number, own]
        for other in range(len(problem.events)):
            going.value[other, own] = part.crossing(other, t, going.y[:, own], interval)
        short = 1e-6 * going.step[own]
        gains = [_gained(number, part, (t, y, interval), short) for y in (before, going.y[:, own])]
        going.value[number, own] = _beyond(going.value[number, own], after, gains)
    return ended


def _gained(event: int, system: System, at: tuple[Matrix, Matrix, Indices], short: Matrix | float) -> Matrix:
    """Return what the value of an event gains within a short time, (n,)."""
    t, y, interval = at
    later = system.crossing(event, t + short, y + short * system.rate(t, y, interval), interval)
    return later - system.crossing(event, t, y, interval)


def _beyond(value: Matrix, after: Matrix, gains: Sequence[Matrix]) -> Matrix:
    """Return the value of an event that has just happened: what rounding leaves of 0 lies on the side beyond it.

    ``gains`` is what it gained within a short time before the state was set, and gains after that: a machine whose
    course is set anew may well begin at 0.
    """
    is_set = np.abs(gains[1] - gains[0]) > 1e-3 * np.abs(gains[0])
    is_rounding = np.abs(value) <= np.maximum(1e-9 * np.abs(after), 1e-3 * np.abs(gains[0]))
    is_rounding &= ~(is_set & (value == 0))
    return np.asarray(np.where(is_rounding, np.copysign(np.maximum(np.abs(value), TINY), after), value))


def _count(
    problem: InitialValueProblem, solution: Solution, number: int, machine: Indices, times: tuple[Matrix, Matrix]
) -> Mask:
    """Count an event at the second of two times, the last one being at the first; return where they have no end."""
    before, t = times
    fresh = np.isnan(solution.first[number, machine])
    solution.first[number, machine[fresh]] = t[fresh]
    solution.counts[number, machine] += 1
    whole = problem.stamps[-1] - problem.stamps[0]
    endless = (t - before < CLOSE * whole) | (solution.counts[number, machine] > MOST_EVENTS)
    for place in np.flatnonzero(endless):
        reason = f"the event '{problem.events[number].name}' {ENDLESS}"
        solution.reasons[int(machine[place])] = (reason, float(t[place]))
    return np.asarray(endless)


# Stiff machines: the backward differences of scipy


def _stiff(problem: InitialValueProblem, machines: Indices, solution: Solution) -> None:
    """Integrate machines by BDF: those with events alone, the others together, parted where they come to no end."""
    waiting = [np.array([machine]) for machine in machines] if problem.events else [machines] if len(machines) else []
    while waiting:
        group = waiting.pop()
        solution.states[:, group, 1:] = np.nan
        solution.counts[:, group], solution.first[:, group] = 0, np.nan
        system = problem.system.part(group)
        going = _begun(replace(problem, system=system, start=solution.states[:, group, 0], begin=None), group)
        reason = _march_as_one(problem, system, going, solution)
        if reason and len(group) > 1:
            waiting += np.array_split(group, 2)
        elif reason:
            solution.reasons.setdefault(int(group[0]), (reason, float(going.t[0])))


def _march_as_one(problem: InitialValueProblem, system: System, going: _Going, solution: Solution) -> str:
    """Take steps that all machines share until they have come to an end; return why they have not, or nothing."""
    everyone, solver = np.arange(len(going.t)), _solver(problem, system, going)
    while True:
        y = going.y
        try:
            solver.step()
        except (RuntimeError, ValueError):  # its matrix is singular, or no longer finite
            return GROWS
        going.taken += 1
        solution.steps += 1
        reached = solver.y.reshape(len(going.t), -1).T
        if solver.status == "failed" or not np.isfinite(reached).all():
            return GROWS
        t, end = (np.full(len(going.t), each) for each in (solver.t_old, solver.t))
        step = Step(t, y, end - t, end, reached, going.rate)
        ended = _arrive(problem, going, everyone, _SharedDense(system, going.interval, step, solver), solution)
        if ended.all():
            return ""
        if going.taken[0] >= problem.most_steps:
            return STEP_LIMIT
        if solver.status == "finished" or going.t[0] != solver.t:
            solver = _solver(problem, system, going)


def _solver(problem: InitialValueProblem, system: System, going: _Going) -> Any:
    """Return a solver for machines that stand at one time, up to the next break; their states are one behind another.

    The mean square of all errors is held so low that each machine keeps the tolerance.
    """
    states, machines = going.y.shape
    own = problem.tolerance / np.sqrt(machines)

    def rate(t: float, y: Matrix) -> Matrix:
        return system.rate(np.full(machines, t), y.reshape(machines, states).T, going.interval).T.ravel()

    return integrate.BDF(
        rate, float(going.t[0]), going.y.T.ravel(), float(problem.breaks[going.interval[0] + 1]),
        rtol=max(own, LEAST_TOLERANCE), atol=own * np.tile(problem.sizes, machines),
        jac_sparsity=sparse.kron(sparse.eye_array(machines), np.ones((states, states))) if machines > 1 else None,
    )  # fmt: skip


class _SharedDense:
    """The states along a step that all machines share."""

    def __init__(self, system: System, interval: Indices, step: Step, solver: Any) -> None:
        self.system, self.interval, self.step = system, interval, step
        self._at = solver.dense_output()

    def at(self, t: Matrix, place: Indices | slice) -> Matrix:
        """Return the states of the machines at these places, each at a time of its own, (d, m)."""
        y = self._at(t).reshape(len(self.interval), -1, len(t))
        return np.asarray(y[np.arange(len(y))[place], :, np.arange(len(t))].T)

    def looks(self) -> Matrix:
        """Return the states of all machines at ``LOOKS`` times of their step, (d, LOOKS, n)."""
        times = np.linspace(self.step.t[0], self.step.end[0], LOOKS + 1)[1:]
        return np.asarray(self._at(times).reshape(len(self.interval), -1, LOOKS).transpose(1, 2, 0))
