"""A motion all at once: every step of a path that is known from a machine nearby, at the same time, until they meet.

Unknown are the states at the ends of all steps and the times of the events. Newton's method makes the end of every
step the start of the next one (multiple shooting; J. Stoer, R. Bulirsch, Introduction to numerical analysis, 7.3.5).
A step is the one of ``truing.integration``, with its error and its events: what is not within the tolerance, or meets
other events than the path, is left to be followed step by step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from truing.arrays import Indices, Mask, Matrix
from truing.integration import (
    LOOKS,
    ORDER,
    STAGES,
    InitialValueProblem,
    OwnDense,
    Path,
    Slopes,
    Solution,
    Step,
    System,
    combined,
    error_of,
    method,
    passes,
    scale_of,
    stages_of,
    values_at_looks,
)

FIRST_ROUNDS, MOST_ROUNDS = 3, 10
"""So many rounds of Newton's method are taken, however they go, and at the most."""
MET = 0.02
"""Steps meet when the states are to move by less than this share of the tolerance."""
ASIDE = 1e-6
"""Share of a state, or of its size, and of the record, by which it is moved for a derivative."""
CONTRACTS = 0.5
"""A round that is to move more than this share of what the one before moved leads nowhere."""
MOST_GUESSES = 8
"""So often a machine is followed along a path that is better than the one before."""
MOST_PARTS, NEARLY = 8, 0.5
"""Steps are parted into so many at the most, where their error is above this share of what it may be."""
MOST_STEPS = 20_000
"""A path that needs more of them is left to be followed step by step: it may be stiff."""
FAR, SLOW = 1e6, 0.02
"""Derivatives are taken anew where states move by more than so many tolerances, or than this share of before."""


@dataclass(frozen=True)
class _Grid:
    """n machines with N steps each; one that has fewer is filled up with steps of no length.

    ``t`` (n, N + 1) and ``y`` (d, n, N + 1) hold the ends of the steps. A stretch lies between two ends that are held
    or are events; inside of it times move in proportion: ``share`` (2, n, N) says where in its stretch a step begins
    and ends, ``stretch`` and ``place`` (n, N) which stretch it is in and the how manieth of it, ``is_last`` whether it
    is the last one. ``is_empty`` marks steps of no length.
    """

    system: System
    t: Matrix
    y: Matrix
    interval: Indices
    event: Indices
    share: Matrix
    stretch: Indices
    place: Indices
    is_last: Mask
    is_empty: Mask
    slopes: Slopes

    @property
    def shape(self) -> tuple[int, int]:
        """Machines and steps."""
        machines, steps = self.event.shape
        return machines, steps

    def some(self, machines: Indices) -> _Grid:
        """Return some of the machines."""
        flat = _steps_of(machines, self.shape[1])
        return _Grid(
            self.system.part(flat), self.t[machines], self.y[:, machines], self.interval[machines],
            self.event[machines], self.share[:, machines], self.stretch[machines], self.place[machines],
            self.is_last[machines], self.is_empty[machines], self.slopes.some(machines),
        )  # fmt: skip


@dataclass(frozen=True)
class _Shot:
    """All steps, from where they begin now: lengths, stages (16, d, m), where they lead and go on, (d, n, N).

    ``value`` (n, N) is that of the event which is to end a step.
    """

    length: Matrix
    stages: Matrix
    reached: Matrix
    after: Matrix
    value: Matrix

    @property
    def rate(self) -> Matrix:
        """The rates at the ends, (d, n, N)."""
        return np.asarray(self.stages[STAGES].reshape(self.reached.shape))


@dataclass(frozen=True)
class Followed:
    """Paths by machine: of those that were followed ``whole``, and of those that were followed up to the ``end``."""

    whole: dict[int, Path] = field(default_factory=dict)
    part: dict[int, Path] = field(default_factory=dict)


def at_once(problem: InitialValueProblem, paths: Mapping[int, Path], solution: Solution) -> Followed:
    """Fill in the solution for some machines as far as they can be followed along paths; return their own paths.

    Steps whose error is not within the tolerance are parted, and the machine is followed along the finer path. Where
    another event comes than that of the path, or the path is too far away, its first part remains.
    """
    followed = Followed()
    left = dict(paths)
    with np.errstate(all="ignore"):
        for _ in range(MOST_GUESSES):
            if not left:
                break
            machines, guesses = np.array([*left]), [*left.values()]
            own = replace(problem, system=problem.system.part(machines), start=problem.start[:, machines])
            left = _along(_Several(own, machines, left, solution, followed), _grid(own, guesses))
    return followed


@dataclass(frozen=True)
class _Several:
    """Machines that are followed together: their problem, which of the solution they are, along what, what is done."""

    problem: InitialValueProblem
    machines: Indices
    guesses: Mapping[int, Path]
    solution: Solution
    followed: Followed


def _along(several: _Several, grid: _Grid) -> dict[int, Path]:
    """Fill in machines as far as their steps meet; return finer paths of those whose steps are too long.

    What a step leads to depends on the steps before it alone, so that the first part of a path meets first.
    """
    problem, machines, finer = several.problem, np.arange(len(several.machines)), dict[int, Path]()
    before, slopes = np.full(grid.shape, np.inf), grid.slopes
    is_due = np.isnan(slopes.step).any(axis=(1, 2, 3))
    for count in range(MOST_ROUNDS):
        shot = _shoot(problem, grid)
        _renew(several, grid, shot, slopes, np.flatnonzero(is_due))
        moved_y, moved_t = _newton(grid, shot, slopes)
        moves = _sizes(problem, shot, moved_y, moved_t)
        moves[(np.diff(grid.t, axis=1) < 0) | (grid.t[:, 1:] > problem.stamps[-1])] = np.inf
        many = (moves < MET).cumprod(axis=1).sum(axis=1)
        first = np.minimum(many, grid.shape[1] - 1)[:, None]
        gone = np.take_along_axis(moves, first, 1) / np.take_along_axis(before, first, 1)
        is_lost = ~(gone[:, 0] < CONTRACTS) & (count >= FIRST_ROUNDS)
        is_over = (many == grid.shape[1]) | is_lost | (count == MOST_ROUNDS - 1)
        over = np.flatnonzero(is_over)
        if len(over):
            own = replace(several, machines=several.machines[machines[over]])
            finer |= _judged(own, replace(grid, slopes=slopes).some(over), _some(shot, over), many[over])
        on = np.flatnonzero(~is_over)
        if not len(on):
            break
        largest = (np.where(np.isfinite(each), each, 0.0).max(axis=1) for each in (moves, before))
        now, then = largest
        is_due = (now > np.where(then > 0, np.minimum(FAR, SLOW * then), FAR))[on]
        grid = replace(grid, t=grid.t + moved_t, y=grid.y + moved_y, slopes=slopes).some(on)
        machines, before, slopes = machines[on], moves[on], grid.slopes
    return finer


def _grid(problem: InitialValueProblem, paths: Sequence[Path]) -> _Grid:
    """Put paths side by side, each machine with the start of its own."""
    steps = max(len(path.event) for path in paths)
    fills = [steps - len(path.event) for path in paths]
    pairs = list(zip(paths, fills, strict=True))
    t = np.array([_filled_up(path.t, fill) for path, fill in pairs])
    y = np.stack([_filled_up(path.y, fill) for path, fill in pairs], axis=1)
    y[:, :, 0] = problem.start
    interval = np.array([_filled_up(path.interval, fill) for path, fill in pairs])
    event = np.array([np.append(path.event, np.full(fill, -1)) for path, fill in pairs])
    is_last = (event >= 0) | (np.diff(interval, axis=1, append=-1) != 0)
    number = np.arange(steps)
    is_empty = number >= np.array([[len(path.event)] for path in paths])
    is_last |= np.roll(is_empty, -1, axis=1) | (number == steps - 1)
    before = np.zeros_like(is_last)
    before[:, 1:] = is_last[:, :-1]
    stretch = np.cumsum(before & ~is_empty, axis=1)
    first = np.maximum.accumulate(np.where(before | (number == 0), number, 0), axis=1)
    last = np.minimum.accumulate(np.where(is_last, number, steps)[:, ::-1], axis=1)[:, ::-1]
    rows = np.arange(len(paths))[:, None]
    low, high = t[rows, first], t[rows, last + 1]
    whole = np.where(high > low, high - low, 1.0)
    share = np.array([(t[:, :-1] - low) / whole, np.where(is_last, 1.0, (t[:, 1:] - low) / whole)])
    system = problem.system.part(np.repeat(np.arange(len(paths)), steps))
    slopes = _known_slopes(paths, steps)
    return _Grid(system, t, y, interval, event, share, stretch, number - first, is_last, is_empty, slopes)


def _filled_up(values: Matrix | Indices, count: int) -> Any:
    """Return values along the last axis with the last one so many times more."""
    return np.concatenate([values, np.repeat(values[..., -1:], count, axis=-1)], axis=-1) if count else values


def _known_slopes(paths: Sequence[Path], steps: int) -> Slopes:
    """Return the derivatives that are known with paths, NaN where they are not."""
    states = len(paths[0].y)
    shape = len(paths), steps, states
    made = Slopes(np.zeros((*shape, states)), np.zeros((*shape[:2], states + 1)), np.zeros((*shape, states + 1)))
    made.step[:] = np.eye(states)
    for row, path in enumerate(paths):
        own = path.slopes
        if own is None:
            made.step[row] = np.nan
        else:
            many = len(path.event)
            made.step[row, :many], made.value[row, :many], made.after[row, :many] = own.step, own.value, own.after
    return made


def _steps_of(machines: Indices, steps: int) -> Indices:
    """Return where all steps of some machines are, one machine behind another."""
    return np.asarray((machines[:, None] * steps + np.arange(steps)).ravel())


def _some(shot: _Shot, machines: Indices) -> _Shot:
    flat = _steps_of(machines, shot.value.shape[1])
    return _Shot(
        shot.length[flat], shot.stages[:, :, flat], shot.reached[:, machines], shot.after[:, machines],
        shot.value[machines],
    )  # fmt: skip


def _shoot(problem: InitialValueProblem, grid: _Grid) -> _Shot:
    """Take all steps."""
    begin, interval = grid.y[:, :, :-1].reshape(len(grid.y), -1), grid.interval.ravel()
    t, end = grid.t[:, :-1].ravel(), grid.t[:, 1:].ravel()
    stages, reached = _steps(grid.system, t, begin, end - t, interval)
    after, value = np.array(reached), np.zeros(len(t))
    for number, rule in enumerate(problem.events):
        own = np.flatnonzero(grid.event.ravel() == number)
        if len(own):
            at = end[own], reached[:, own], interval[own]
            part = grid.system.part(own)
            value[own] = part.crossing(number, *at)
            if rule.sets:
                after[:, own] = part.after(number, *at)
    shape = len(begin), *grid.shape
    return _Shot(end - t, stages, reached.reshape(shape), after.reshape(shape), value.reshape(grid.shape))


def _steps(system: System, t: Matrix, y: Matrix, length: Matrix, interval: Indices) -> tuple[Matrix, Matrix]:
    """Return the stages of steps, with the rate at their ends, and where they lead."""
    stages, _ = stages_of(system, (t, y, system.rate(t, y, interval), length), interval)
    reached = y + length * combined(method().B, stages)
    stages[STAGES] = system.rate(t + length, reached, interval)
    return stages, reached


def _slopes(problem: InitialValueProblem, grid: _Grid, shot: _Shot) -> Slopes:
    """Take derivatives of all steps, and of all events, by differences."""
    begin, interval = grid.y[:, :, :-1].reshape(len(grid.y), -1), grid.interval.ravel()
    states, many = begin.shape
    aside = ASIDE * np.maximum(np.abs(begin), problem.sizes[:, None])
    several = np.tile(np.arange(many), states)
    moved = np.concatenate([begin + aside * unit[:, None] for unit in np.eye(states)], axis=1)
    t = grid.t[:, :-1].ravel()
    _, reached = _steps(grid.system.part(several), t[several], moved, shot.length[several], interval[several])
    made = (reached.reshape(states, states, many) - shot.reached.reshape(states, 1, many)) / aside
    step = np.moveaxis(made, -1, 0).reshape(*grid.shape, states, states)
    value, after = np.zeros((many, states + 1)), np.zeros((many, states, states + 1))
    for number, rule in enumerate(problem.events):
        own = np.flatnonzero(grid.event.ravel() == number)
        if len(own):
            _event_slopes(problem, grid, shot, (number, own), (value, after), is_set=rule.sets)
    return Slopes(step, value.reshape(*grid.shape, -1), after.reshape(*grid.shape, states, -1))


def _renew(several: _Several, grid: _Grid, shot: _Shot, slopes: Slopes, machines: Indices) -> None:
    """Take derivatives of some machines anew, in place."""
    if len(machines):
        new = _slopes(several.problem, grid.some(machines), _some(shot, machines))
        slopes.step[machines], slopes.value[machines], slopes.after[machines] = new.step, new.value, new.after


def _event_slopes(
    problem: InitialValueProblem, grid: _Grid, shot: _Shot, event: tuple[int, Indices], made: tuple[Matrix, Matrix],
    *, is_set: bool,
) -> None:  # fmt: skip
    """Fill in the derivatives of an event at its steps, by every state and by the time."""
    (number, own), (value, after) = event, made
    y = shot.reached.reshape(len(grid.y), -1)[:, own]
    t, interval = grid.t[:, 1:].ravel()[own], grid.interval.ravel()[own]
    states, several = len(y), np.tile(np.arange(len(own)), len(y) + 1)
    aside = ASIDE * np.vstack([
        np.maximum(np.abs(y), problem.sizes[:, None]),
        np.full(len(own), problem.stamps[-1] - problem.stamps[0]),
    ])  # fmt: skip
    moved = np.hstack([y + aside[:-1] * unit[:, None] for unit in np.eye(states)] + [y])
    late = np.concatenate([np.tile(t, states), t + aside[-1]])
    part = grid.system.part(own[several])
    crossing = part.crossing(number, late, moved, interval[several]).reshape(states + 1, -1)
    value[own] = ((crossing - shot.value.ravel()[own]) / aside).T
    if not is_set:
        after[own, :, :-1] = np.eye(states)
        return
    set_to = part.after(number, late, moved, interval[several]).reshape(states, states + 1, -1)
    before = shot.after.reshape(states, -1)[:, own]
    after[own] = np.moveaxis((set_to - before[:, None]) / aside, -1, 0)


def _newton(grid: _Grid, shot: _Shot, slopes: Slopes) -> tuple[Matrix, Matrix]:
    """Return how far states (d, n, N + 1) and times (n, N + 1) are to move so that all steps meet.

    Within a stretch all is linear in the states and the time at which it begins and the time at which it ends. The end
    of one that is an event comes when its value is 0; then one stretch after another is known.
    """
    states, (machines, steps) = len(grid.y), grid.shape
    missed = np.moveaxis(shot.after - grid.y[:, :, 1:], 0, -1)
    along = _within(grid, shot, slopes, missed)
    chain, late = _stretches(grid, shot, slopes, (along, missed))
    begins = np.zeros((chain.shape[1] + 1, machines, states + 1))  # states and time at which stretches begin
    for number in range(chain.shape[1]):
        moved = np.einsum("nij,nj->ni", chain[:, number, :, :-1], begins[number])
        begins[number + 1] = moved + chain[:, number, :, -1]
    rows = np.arange(machines)[:, None]
    begin, ends = begins[grid.stretch, rows], begins[grid.stretch + 1, rows]
    whole = np.einsum("nsj,nsj->ns", late[rows, grid.stretch, :-1], begin) + late[rows, grid.stretch, -1]
    basis = np.concatenate([begin, whole[..., None], np.ones((machines, steps, 1))], axis=-1)
    moved_y, moved_t = np.zeros((states, machines, steps + 1)), np.zeros((machines, steps + 1))
    inside = np.einsum("nsij,nsj->nsi", along, basis)
    moved_y[:, :, 1:] = np.moveaxis(np.where(grid.is_last[..., None], ends[..., :-1], inside), -1, 0)
    moved_t[:, 1:] = (1 - grid.share[1]) * begin[..., -1] + grid.share[1] * whole
    moved_t[:, 1:][grid.is_empty] = np.broadcast_to(begins[-1][:, -1:], grid.shape)[grid.is_empty]
    return moved_y, moved_t


def _within(grid: _Grid, shot: _Shot, slopes: Slopes, missed: Matrix) -> Matrix:
    """Return how the state at the end of every step moves with what its stretch begins and ends with, (n, N, d, d + 3).

    The columns are the states at its begin, the times of begin and end, and what moves anyway.
    """
    states, (machines, steps) = len(grid.y), grid.shape
    rate, ended = (np.moveaxis(each, 0, -1) for each in (shot.stages[0].reshape(shot.reached.shape), shot.rate))
    carried = -np.einsum("nsij,nsj->nsi", slopes.step, rate)
    shares = grid.share[..., None]
    by_begin = carried * (1 - shares[0]) + ended * (1 - shares[1])
    by_end = carried * shares[0] + ended * shares[1]
    many = int(grid.stretch.max()) + 1
    now = np.zeros((machines * many, states, states + 3))
    now[:, :, :states] = np.eye(states)
    along = np.zeros((machines, steps, states, states + 3))
    for number in range(int(grid.place.max()) + 1):
        row, step = np.nonzero((grid.place == number) & ~grid.is_empty)
        own = row * many + grid.stretch[row, step]
        moved = slopes.step[row, step] @ now[own]
        moved[:, :, -3] += by_begin[row, step]
        moved[:, :, -2] += by_end[row, step]
        moved[:, :, -1] += missed[row, step]
        along[row, step] = now[own] = moved
    return along


def _stretches(
    grid: _Grid, shot: _Shot, slopes: Slopes, within: tuple[Matrix, Matrix]
) -> tuple[Matrix, Matrix]:  # fmt: skip
    """Return how state and time at the end of stretches move with those at their begin, and when they end.

    Shapes (n, J, d + 1, d + 2) and (n, J, d + 2), the last column being what moves anyway.
    """
    (along, missed), states, machines = within, len(grid.y), grid.shape[0]
    many = int(grid.stretch.max()) + 1
    chain, late = np.zeros((machines, many, states + 1, states + 2)), np.zeros((machines, many, states + 2))
    chain[..., :-1] = np.eye(states + 1)
    row, step = np.nonzero(grid.is_last & ~grid.is_empty)
    reached = np.array(along[row, step])
    reached[:, :, -1] -= missed[row, step]
    known, by_end = np.delete(reached, -2, axis=2), reached[:, :, -2]
    value, is_event = slopes.value[row, step], (grid.event[row, step] >= 0)[:, None]
    risen = np.einsum("sd,sdk->sk", value[:, :-1], known)
    risen[:, -1] += shot.value[row, step]
    faster = np.einsum("sd,sd->s", value[:, :-1], by_end) + value[:, -1]
    when = np.where(is_event, -risen / faster[:, None], 0.0)
    moved = known + by_end[:, :, None] * when[:, None]
    after = slopes.after[row, step]
    after_event = after[:, :, :-1] @ moved + after[:, :, -1:] * when[:, None]
    ended = np.where(is_event[:, None], after_event, moved)
    ended[:, :, -1] += missed[row, step]
    chain[row, grid.stretch[row, step]] = np.concatenate([ended, when[:, None]], axis=1)
    late[row, grid.stretch[row, step]] = when
    return chain, late


def _sizes(problem: InitialValueProblem, shot: _Shot, moved_y: Matrix, moved_t: Matrix) -> Matrix:
    """Return how far the ends of steps are to move, in tolerances, (n, N); what comes later counts by the rates."""
    allowed = scale_of(problem, shot.after.reshape(len(shot.after), -1)).reshape(shot.after.shape)
    shifted = np.abs(moved_t[:, 1:] * shot.rate)
    sizes = ((np.abs(moved_y[:, :, 1:]) + shifted) / allowed).max(axis=0)
    return np.where(np.isfinite(sizes), sizes, np.inf)


def _judged(several: _Several, grid: _Grid, shot: _Shot, many: Indices) -> dict[int, Path]:
    """Fill in machines up to the last of so ``many`` steps that meets no other event; part steps that are too long."""
    problem, followed = several.problem, several.followed
    begin, reached = grid.y[:, :, :-1].reshape(len(grid.y), -1), shot.reached.reshape(len(grid.y), -1)
    t, end = grid.t[:, :-1].ravel(), grid.t[:, 1:].ravel()
    step = Step(t, begin, shot.length, end, reached, shot.stages[STAGES])
    dense = OwnDense(grid.system, grid.interval.ravel(), step, shot.stages)
    error = error_of(shot.stages, shot.length, scale_of(problem, begin, reached)).reshape(grid.shape)
    right = _steps_without_other(problem, grid, dense) if problem.events else np.full(len(many), grid.shape[1])
    finer: dict[int, Path] = {}
    for row, steps in enumerate(np.minimum(many, (~grid.is_empty).sum(axis=1)).tolist()):
        number, path = int(several.machines[row]), _path(grid, shot, row, steps)
        if not (error[row, :steps] < 1).all():
            finer |= _parted(number, path, dense, (error[row], row * grid.shape[1]))
            continue
        path = _path(grid, shot, row, min(steps, int(right[row])))
        before = followed.part.pop(number, None)
        if before is not None and before.t[-1] >= path.t[-1]:
            followed.part[number] = before
        elif len(path.event):
            _write(several, path, shot, dense, row)
            is_whole = len(path.event) == steps and _is_at_end(problem, path)
            (followed.whole if is_whole else followed.part)[number] = path
            if not is_whole and right[row] >= steps:
                finer |= _onward(problem, number, path, several.guesses[number])
    return finer


def _onward(problem: InitialValueProblem, number: int, path: Path, guess: Path) -> dict[int, Path]:
    """Return a path that goes on from the end of what is known as the guess does; none where series set the times."""
    known, late = len(path.event), path.t[-1] - guess.t[len(path.event)]
    t = guess.t[known:] + late
    steps = int((t[:-1] < problem.stamps[-1]).sum())
    if len(problem.breaks) > 2 or not steps:
        return {}
    event = np.array(guess.event[known : known + steps])
    if t[steps] > problem.stamps[-1] or event[-1] < 0:
        t[steps], event[-1] = problem.stamps[-1], -1
    y = np.column_stack([path.y[:, -1], guess.y[:, known + 1 : known + steps + 1]])
    return {number: path.then(Path(t[: steps + 1], y, guess.interval[known : known + steps], event))}


def _is_at_end(problem: InitialValueProblem, path: Path) -> bool:
    """Whether a path leads to the end of the record, or to an event that ends it."""
    return bool(path.t[-1] == problem.stamps[-1] or (path.event[-1] >= 0 and problem.events[path.event[-1]].ends))


def _write(several: _Several, path: Path, shot: _Shot, dense: OwnDense, row: int) -> None:
    """Fill in one machine up to the end of its path: its states at the stamps, and its events."""
    number, ends, solution = several.machines[row], path.t[1:], several.solution
    stamps, problem = several.problem.stamps, several.problem
    which = np.searchsorted(ends, stamps[1:])
    within = np.flatnonzero(which < len(ends))
    flat = row * shot.value.shape[1] + which[within]
    solution.states[:, number, 1 + within] = dense.at(stamps[1 + within], flat)
    if path.event[-1] >= 0 and problem.events[path.event[-1]].ends:
        solution.states[:, number, 1 + len(within) :] = path.y[:, -1, None]
    for event in range(len(problem.events)):
        times = ends[path.event == event]
        solution.counts[event, number] = len(times)
        solution.first[event, number] = times[0] if len(times) else np.nan


def _path(grid: _Grid, shot: _Shot, row: int, steps: int) -> Path:
    """Return so many steps of the path of one machine."""
    y = np.column_stack([grid.y[:, row, :steps], shot.after[:, row, max(steps - 1, 0)]])
    return Path(
        grid.t[row, : steps + 1], y, grid.interval[row, :steps], grid.event[row, :steps], grid.slopes.of(row, steps)
    )


def _parted(number: int, path: Path, dense: OwnDense, where: tuple[Matrix, int]) -> dict[int, Path]:
    """Return a path with shorter steps where their errors are too large, or nearly so; none where it gets too long.

    ``where`` holds the errors of its steps, and where in all steps it begins.
    """
    error, first = where[0][: len(path.event)], where[1]
    parts = np.where(error > NEARLY, np.ceil((error / NEARLY) ** (1 / ORDER)).clip(2, MOST_PARTS), 1).astype(np.intp)
    if parts.sum() > MOST_STEPS:
        return {}
    which = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
    begin = path.t[which] + part / parts[which] * (path.t[which + 1] - path.t[which])
    y = np.where(part == 0, path.y[:, which], dense.at(begin, first + which))
    event = np.where(part == parts[which] - 1, path.event[which], -1)
    y, t = np.column_stack([y, path.y[:, -1]]), np.append(begin, path.t[-1])
    return {number: Path(t, y, path.interval[which], event)}


def _steps_without_other(problem: InitialValueProblem, grid: _Grid, dense: OwnDense) -> Indices:
    """Return after how many steps another event is met than that of the path, or it in the wrong direction, (n,)."""
    (machines, steps), step = grid.shape, dense.step
    times = step.t + np.arange(LOOKS + 1)[:, None] / LOOKS * step.length
    states = np.concatenate([step.y[:, None], dense.looks()], axis=1)
    is_empty, event = grid.is_empty.ravel(), grid.event.ravel()
    begins_after = np.roll(event, 1) >= 0
    begins_after[::steps] = False
    is_right = np.ones((machines, steps), dtype=bool)
    for number, rule in enumerate(problem.events):
        values = values_at_looks(number, dense, times, states)
        ends_here = event == number
        is_wrong = ends_here & (values[-2] * rule.direction > 0)
        values[:, is_empty] = np.nan
        values[0, begins_after] = values[-1, ends_here] = np.nan  # what has just passed 0, or is just to pass it
        is_wrong |= passes(values, rule).any(axis=0)
        is_right &= ~is_wrong.reshape(machines, steps)
    return np.asarray(is_right.cumprod(axis=1).sum(axis=1))
