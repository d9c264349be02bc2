"""Machines that are followed, and what is remembered of them: a fit asks for the same ones again, among others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace

import numpy as np

from truing.arrays import Indices, Matrix
from truing.declare.batch import feasible
from truing.declare.machines import Machines, in_steps, joined, problem_of
from truing.errors import ConvergenceError, InfeasibleError, TruingError
from truing.integration import (
    ENDLESS,
    STEP_LIMIT,
    InitialValueProblem,
    Path,
    Solution,
    empty_solution,
    solve,
)
from truing.integration_at_once import MOST_STEPS, at_once

WHAT_NOW = {
    STEP_LIMIT: "; a coarser tolerance or a larger most_steps would let it go on",
    ENDLESS: "; end the motion there (ends=True), or let the event set a state in which the machine rests",
}
"""What can be done where a motion comes to no end."""
MOST_NEARBY = 64
"""More machines in one call, unless they are known, are drawn: nobody asks for them again, and none is remembered."""
MOST_REMEMBERED, MOST_MACHINES, MOST_NEAR = 10_000_000, 4096, 256
"""So many values of states, and so many machines, are remembered; of so many the nearest one is looked for."""
MOST_DRIVEN = 16
"""So many driven machines are followed at all stamps at once; of more the stamps one after another take less time."""
NEAR, FAR, TINY = 1e-3, 6, 1e-300
"""Sum of the shares by which numbers of machines differ that are followed along one path; and at the most."""


@dataclass(frozen=True)
class Followed:
    """One machine as it was followed: states (d, k), by event how often and when first, (e,); why it came to no end.

    ``numbers`` are what it differs by from others, ``path`` the steps that it took.
    """

    states: Matrix
    counts: Matrix
    first: Matrix
    reason: tuple[str, float] | None
    numbers: Matrix
    path: Path | None


class NotedError(TruingError):
    """A call that ended where its machines were noted."""


@dataclass
class MachinesAsked:
    """Machines that were asked for, and how many of them had to be followed."""

    several: list[Machines] = field(default_factory=list)
    new: int = 0


_ASKED: ContextVar[MachinesAsked | None] = ContextVar("truing_machines_asked", default=None)


def is_noting() -> bool:
    """Whether machines are noted, to be followed later."""
    return _ASKED.get() is not None


@contextmanager
def following_together() -> Iterator[MachinesAsked]:
    """Note which machines are asked for inside, where each call ends with ``NotedError``, and follow all at the end.

    What is asked for again afterwards is known then.
    """
    asked = MachinesAsked()
    token = _ASKED.set(asked)
    try:
        yield asked
    finally:
        _ASKED.reset(token)
    by_record: dict[tuple[int, bytes], list[Machines]] = {}
    for machines in asked.several:
        by_record.setdefault((id(machines.dynamics), machines.record), []).append(machines)
    for group in by_record.values():
        machines = joined(group)
        asked.new += len({*machines.keys} - {*machines.dynamics.memory})
        _follow(machines, _beside_others)


def remembered(machines: Machines) -> Solution:
    """Return what is known of machines; those that are not known are followed, or noted alone: ``NotedError``."""
    asked = _ASKED.get()
    if asked is not None:
        asked.several.append(machines)
        raise NotedError("these machines are followed later, with others")
    if machines.count > MOST_NEARBY and machines.keys[0] not in machines.dynamics.memory:
        return _all_steps(machines)
    known = _follow(machines, _by_themselves)
    reasons = {place: each.reason for place, each in enumerate(known) if each.reason}
    return Solution(
        np.stack([each.states for each in known], axis=1), np.stack([each.counts for each in known], axis=1),
        np.stack([each.first for each in known], axis=1), reasons,
    )  # fmt: skip


def _follow(
    machines: Machines, follow: Callable[[Machines], list[Followed]]
) -> list[Followed]:  # fmt: skip
    """Return what is known of machines, those that are not known followed in one call."""
    memory, keys = machines.dynamics.memory, machines.keys
    places = {key: place for place, key in enumerate(keys) if key not in memory}
    made = {key: memory[key] for key in keys if key in memory}
    if places:
        new = machines.part(np.array(list(places.values())))
        made |= dict(zip(places, follow(new), strict=True))
        most = min(MOST_MACHINES, max(1, MOST_REMEMBERED // max(made[keys[0]].states.size, 1)))
        memory.update((key, made[key]) for key in places)
        for old in list(memory)[:-most]:
            del memory[old]
    return [made[key] for key in keys]


def _all_steps(machines: Machines) -> Solution:
    return solve(problem_of(machines)) if machines.dynamics.step is None else in_steps(machines)


def _by_themselves(new: Machines) -> list[Followed]:
    """Follow a few machines that are driven at all stamps at once, others step by step."""
    straight = _straight(new) if new.count <= MOST_DRIVEN else {}
    if not straight:
        return _step_by_step(new)
    made: dict[int, Followed] = {}
    _add(made, new, _numbers(new), straight)
    return [made[place] for place in range(new.count)]


def _step_by_step(new: Machines) -> list[Followed]:
    """Follow machines step by step."""
    solution = _all_steps(new)
    return [_one_of(solution, machine, np.zeros(0), None) for machine in range(new.count)]


def _beside_others(new: Machines) -> list[Followed]:
    """Follow machines: along a path that is known, else near one another, else step by step."""
    if new.dynamics.step is not None:
        return _step_by_step(new)
    numbers = _numbers(new)
    known = [each for key, each in new.dynamics.memory.items() if each.path is not None and key.startswith(new.record)]
    made: dict[int, Followed] = {}
    leaders = _leaders(numbers)
    firsts = np.unique(leaders).tolist()
    near = {**_straight(new), **_nearest(known[-MOST_NEAR:], numbers)}
    _add(made, new, numbers, {place: near.get(place) for place in firsts})
    _add(made, new, numbers, {place: made[int(first)].path for place, first in enumerate(leaders) if place not in made})
    return [made[place] for place in range(new.count)]


def _numbers(new: Machines) -> Matrix:
    """Return what machines differ by, (n, numbers)."""
    return np.column_stack([np.zeros(new.count), *(each for each in new.numbers.values() if each.ndim == 1)])


def _straight(new: Machines) -> dict[int, Path]:
    """Return a path for machines that are driven: one step from each stamp to the next, at rest where it starts."""
    if not new.drives or new.dynamics.events or new.dynamics.step is not None or len(new.stamps) > MOST_STEPS:
        return {}
    start, steps = new.start(), len(new.stamps) - 1
    interval = np.searchsorted(new.bent(), np.arange(steps), side="right") - 1
    no_event = np.full(steps, -1)
    states = (np.repeat(start[:, place, None], steps + 1, axis=1) for place in range(new.count))
    return {place: Path(new.stamps, each, interval, no_event) for place, each in enumerate(states)}


def _leaders(numbers: Matrix) -> Indices:
    """Return for every machine the first one that is near it, itself where none is, (n,)."""
    scaled = numbers / np.maximum(np.abs(numbers).max(axis=0, initial=0.0), TINY)
    leaders, firsts = np.zeros(len(numbers), dtype=np.intp), np.zeros(0, dtype=np.intp)
    for place, row in enumerate(scaled):
        off = np.abs(scaled[firsts] - row).sum(axis=1)
        if not (off < NEAR).any():
            firsts = np.append(firsts, place)
            off = np.append(off, 0.0)
        leaders[place] = firsts[np.argmin(off)]
    return leaders


def _nearest(known: Sequence[Followed], numbers: Matrix) -> dict[int, Path]:
    """Return the path of what is known nearest to each machine; none where that is far."""
    if not known:
        return {}
    several = np.array([each.numbers for each in known])
    size = np.maximum(np.abs(several), np.abs(numbers[:, None]))
    off = (np.abs(several - numbers[:, None]) / np.maximum(size, TINY)).sum(axis=2)
    nearest = np.argmin(np.where(np.isnan(off), np.inf, off), axis=1)
    pairs = [(place, known[best], off[place, best]) for place, best in enumerate(nearest)]
    return {place: best.path for place, best, far in pairs if best.path is not None and far < FAR}


def _add(made: dict[int, Followed], new: Machines, numbers: Matrix, along: Mapping[int, Path | None]) -> None:
    """Follow some machines along paths, and step by step from where these no longer lead, or where there is none.

    Machines beside one another then have the same steps, so that their differences are not those of errors.
    """
    if not along:
        return
    places = np.array([*along])
    problem = problem_of(new.part(places))
    solution = empty_solution(problem)
    known = {row: path for row, path in enumerate(along.values()) if path is not None}
    followed = at_once(problem, known, solution)
    rest = [row for row in range(len(places)) if row not in followed.whole]
    parts = {row: followed.part.get(row) or _nothing_of(problem, row) for row in rest}
    whole = followed.whole | _gone_on(problem, parts, solution)
    for row, place in enumerate(places.tolist()):
        made[place] = _one_of(solution, row, numbers[place], whole.get(row))


def _gone_on(problem: InitialValueProblem, parts: Mapping[int, Path], solution: Solution) -> dict[int, Path]:
    """Follow machines step by step from the ends of their paths; return the whole paths of those that have one.

    Those that had none yet are followed along it once more, for its derivatives.
    """
    if not parts:
        return {}
    machines, paths = np.array([*parts]), [*parts.values()]
    t, interval = np.array([path.t[-1] for path in paths]), np.array([path.interval[-1:].sum() for path in paths])
    interval += t == problem.breaks[interval + 1]
    own = Solution(solution.states[:, machines], solution.counts[:, machines], solution.first[:, machines])
    start = np.array([path.y[:, -1] for path in paths]).T
    rest = replace(problem, system=problem.system.part(machines), start=start, begin=(t, interval))
    taken = solve(rest, own, keeps_paths=True).paths(rest)
    _put(own, np.arange(len(machines)), solution, machines)
    solution.reasons.update((int(machines[row]), reason) for row, reason in own.reasons.items())
    whole = {int(machines[row]): paths[row].then(path) for row, path in taken.items()}
    again = empty_solution(problem)
    new = {row: whole[row] for row, path in parts.items() if row in whole and not len(path.event)}
    followed = at_once(problem, new, again).whole
    _put(again, [*followed], solution, [*followed])
    return whole | followed


def _put(made: Solution, rows: Sequence[int] | Indices, solution: Solution, machines: Sequence[int] | Indices) -> None:
    """Put some machines of one solution into their places in another one."""
    solution.states[:, machines] = made.states[:, rows]
    solution.counts[:, machines], solution.first[:, machines] = made.counts[:, rows], made.first[:, rows]


def _nothing_of(problem: InitialValueProblem, machine: int) -> Path:
    """Return the path of a machine that stands where it starts."""
    none = np.zeros(0, dtype=np.intp)
    return Path(problem.stamps[:1], problem.start[:, [machine]], none, none)


def _one_of(solution: Solution, machine: int, numbers: Matrix, path: Path | None) -> Followed:
    """Return one machine of a solution."""
    return Followed(
        np.array(solution.states[:, machine]), np.array(solution.counts[:, machine]),
        np.array(solution.first[:, machine]), solution.reasons.get(machine), numbers, path,
    )  # fmt: skip


def say_why(solution: Solution, machines: Machines) -> None:
    """Let the machines that came to no end fail, each with its reason and time; a single one ends the calculation."""
    failed: dict[tuple[str, str], list[int]] = {}
    for at, (reason, t) in sorted(solution.reasons.items()):
        failed.setdefault((reason, f"{t:.6g}"), []).append(at)
    for (reason, when), places in failed.items():
        holds = np.ones(machines.count, dtype=bool)
        holds[places] = False
        hint = next((words for part, words in WHAT_NOW.items() if part in reason), "")
        sentence = f"the motion cannot be followed beyond t = {when} s: {reason}{hint}"
        error = ConvergenceError if reason == STEP_LIMIT else InfeasibleError
        feasible(holds[0] if machines.is_single else holds, sentence, error=error)
