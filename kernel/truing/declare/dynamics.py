"""State equations: what changes by itself, how fast, from where on, and what a record of it answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from functools import cached_property
from hashlib import blake2b
from typing import Any, Generic, Literal, TypeVar, cast, dataclass_transform

import numpy as np

from truing.arrays import Indices, Matrix
from truing.declare.batch import feasible
from truing.declare.fields import KEY, Float, InputField, hints_of, in_si, input_fields, read, with_values
from truing.errors import ConvergenceError, DeclarationError, InfeasibleError, TruingError
from truing.integration import (
    ENDLESS,
    GROWS,
    STEP_LIMIT,
    EventRule,
    InitialValueProblem,
    Path,
    Solution,
    empty_solution,
    solve,
)
from truing.integration_at_once import MOST_STEPS, at_once
from truing.units import difference_unit

WHAT_NOW = {
    STEP_LIMIT: "; a coarser tolerance or a larger most_steps would let it go on",
    ENDLESS: "; end the motion there (ends=True), or let the event set a state in which the machine rests",
}
"""What can be done where a motion comes to no end."""
I = TypeVar("I")  # noqa: E741  # inputs, as in Model[I, R]
R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")
MOST_NEARBY = 64
"""More machines in one call, unless they are known, are drawn: nobody asks for them again, and none is remembered."""
MOST_REMEMBERED, MOST_MACHINES, MOST_NEAR = 10_000_000, 4096, 256
"""So many values of states, and so many machines, are remembered; of so many the nearest one is looked for."""
MOST_DRIVEN = 16
"""So many driven machines are followed at all stamps at once; of more the stamps one after another take less time."""
NEAR, FAR, TINY = 1e-3, 6, 1e-300
"""Sum of the shares by which numbers of machines differ that are followed along one path; and at the most."""


@dataclass(frozen=True, kw_only=True)
class StateSpec:
    """One state as declared; ``start`` names an input or is a quantity, ``size`` is in ``unit``."""

    unit: str
    start: str | float
    symbol: str = ""
    note: str = ""
    rate: str = ""
    size: float = 1.0


def state(
    unit: str, *, start: str | float, symbol: str = "", note: str = "", rate: str = "", size: float = 1.0
) -> Any:  # fmt: skip
    """Declare a state with its unit: something that has a value at every time and changes at a rate.

    ``start`` is where it begins: the name of an input, a text with a unit, or a number in ``unit``. ``rate`` is the
    formula of its change that the sheet prints, in names of states, inputs and ``time``; a test holds it against the
    function. ``size`` (in ``unit``) is a value that counts as small: below it the error is held absolutely.
    """
    spec = StateSpec(unit=unit, start=start, symbol=symbol, note=note, rate=rate, size=size)
    return field(metadata={KEY: spec})


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(state,))
def states(cls: type[T]) -> type[T]:
    """Make a frozen, keyword-only dataclass of states; every field comes from ``state``."""
    declared = dataclass(frozen=True, kw_only=True)(cls)
    for each in fields(cast(Any, declared)):
        spec = each.metadata.get(KEY)
        if not isinstance(spec, StateSpec):
            raise DeclarationError(f"{cls.__qualname__}: '{each.name}' is no state: write state(...)")
        if not (math.isfinite(spec.size) and spec.size > 0):
            raise DeclarationError(f"{cls.__qualname__}: the size of '{each.name}' is {spec.size}; it is above 0")
    return declared


@dataclass(frozen=True)
class Event(Generic[S, I]):
    """Something that happens when ``value(states, inputs, time)`` passes 0: a contact opens, a body sticks.

    It counts where the value ``rises``, ``falls`` or does ``either``. ``then(states, inputs, time)`` returns the states
    with which it goes on (as they are without it); with ``ends`` the machine stays as it is then.
    """

    name: str
    value: Callable[[S, I, Float], Float]
    _: KW_ONLY
    when: Literal["rises", "falls", "either"] = "either"
    then: Callable[[S, I, Float], S] | None = None
    ends: bool = False
    note: str = ""

    @property
    def rule(self) -> EventRule:
        """The rule as the integrator knows it."""
        direction = {"rises": 1, "falls": -1, "either": 0}[self.when]
        return EventRule(direction, self.ends, self.then is not None, self.name)


@dataclass(frozen=True)
class Motion(Generic[S]):
    """A record that was integrated: ``time`` (k,), states (k,) of one machine or (n, k).

    ``counts`` and ``first`` say by event how often and when first it happened, numbers or (n,); NaN where it never did.
    """

    time: Matrix
    states: S
    counts: Mapping[str, Float]
    first: Mapping[str, Float]


@dataclass(frozen=True, kw_only=True)
class Dynamics(Generic[S, I, R]):
    """The function of a model that moves: the states are followed from the first of ``times`` to the last.

    ``rate(states, inputs, time)`` returns what every state gains per second, in the class of the states; each field is
    a number or an array (n,). Inputs that are series have there the value of that moment. In place of it
    ``step(states, inputs, time)`` returns the states at the next of ``times``. ``gives(inputs, motion)`` makes results.
    ``times`` names the input series of the stamps at which the states are asked for, ``start(inputs)`` gives states in
    place of the starts that are declared.

    Errors per step are held below ``tolerance`` of each state; one tenth of it changes no result by more than the share
    ``settled`` of its largest value, which the kit checks. ``most_steps`` are taken: then there is no answer.
    """

    gives: Callable[[I, Motion[S]], R]
    rate: Callable[[S, I, Float], S] | None = None
    step: Callable[[S, I, Float], S] | None = None
    times: str = "times"
    start: Callable[[I], S] | None = None
    events: Sequence[Event[S, I]] = ()
    tolerance: float = 1e-8
    settled: float = 1e-5
    most_steps: int = 100_000

    def __post_init__(self) -> None:
        if (self.rate is None) == (self.step is None):
            raise DeclarationError("dynamics need one of rate(states, inputs, time) and step(states, inputs, time)")
        object.__setattr__(self, "events", tuple(self.events))
        object.__setattr__(self, "__wrapped__", self.law)  # where the calculation is written: for who looks for a fault
        object.__setattr__(self, "__module__", self.law.__module__)
        if self.step is not None and self.events:
            raise DeclarationError("dynamics in steps have no events: they happen between the times")
        if not 1e-13 <= self.tolerance <= 1e-2:
            raise DeclarationError(f"the tolerance of dynamics is {self.tolerance:g}; it lies between 1e-13 and 0.01")
        _ = self.state_type, self.input_type, self.result_type

    @property
    def law(self) -> Callable[[S, I, Float], S]:
        """The rate or the step, whichever is given."""
        return cast("Callable[[S, I, Float], S]", self.rate or self.step)

    @cached_property
    def state_type(self) -> type[S]:
        """The dataclass of states, as the law is annotated."""
        hints = hints_of(self.law)
        kind = hints.get("return")
        if kind is None or not any(isinstance(each.metadata.get(KEY), StateSpec) for each in _fields(kind)):
            raise DeclarationError(f"{_name(self.law)} must say which @states class it takes and returns")
        return cast("type[S]", kind)

    @cached_property
    def input_type(self) -> type[I]:
        """The dataclass of inputs, as ``gives`` is annotated."""
        hints = hints_of(self.gives)
        hints.pop("return", None)
        if len(hints) != 2:
            raise DeclarationError(f"{_name(self.gives)} takes an annotated class of inputs and Motion[...]")
        return cast("type[I]", next(iter(hints.values())))

    @cached_property
    def result_type(self) -> type[R]:
        """The dataclass of results, as ``gives`` is annotated."""
        answer = hints_of(self.gives).get("return")
        if answer is None:
            raise DeclarationError(f"{_name(self.gives)} must say which @results class it returns")
        return cast("type[R]", answer)

    @cached_property
    def state_fields(self) -> dict[str, StateSpec]:
        """Every state by name."""
        return {each.name: each.metadata[KEY] for each in _fields(self.state_type)}

    @cached_property
    def input_fields(self) -> dict[str, InputField]:
        """Every input by flat name."""
        return input_fields(self.input_type)

    @cached_property
    def memory(self) -> dict[bytes, _Followed]:
        """What was followed last, by what tells one machine from another."""
        return {}

    @cached_property
    def driving(self) -> dict[str, InputField]:
        """The input series that the law sees at every moment, by flat name."""
        along = self.input_fields[self.times].spec.along
        return {
            name: each for name, each in self.input_fields.items() if each.spec.along == along and name != self.times
        }

    def __call__(self, inputs: I) -> R:
        """Follow the states, and make results: of one machine, or of n where inputs are arrays (n,)."""
        return self.gives(inputs, self.followed(inputs))

    def followed(self, inputs: I) -> Motion[S]:
        """Follow the states of one machine, or of n where inputs are arrays (n,).

        Raises InfeasibleError or ConvergenceError, or lets a machine of a batch fail, where one cannot be followed.
        """
        machines = _machines(self, inputs)
        known = self.state_fields
        solution = _remembered(machines)
        _say_why(solution, machines)
        one: Any = 0 if machines.is_single else slice(None)
        names = [event.name for event in self.events]
        return Motion(
            time=machines.stamps,
            states=self.state_type(**{name: solution.states[place, one] for place, name in enumerate(known)}),
            counts={name: solution.counts[place, one] for place, name in enumerate(names)},
            first={name: solution.first[place, one] for place, name in enumerate(names)},
        )

    def rates(self, inputs: I, motion: Motion[S]) -> dict[str, Matrix]:
        """Return what the law says of one machine at every time of its motion, (k,) by state."""
        machines, stamps = _machines(self, inputs), motion.time
        interval = np.minimum(np.arange(len(stamps)), len(stamps) - 2)
        along = replace(machines.part(np.zeros(len(stamps), dtype=np.intp)), stamps=stamps)
        y = np.array([getattr(motion.states, name) for name in self.state_fields])
        return dict(zip(self.state_fields, along.rate(stamps, y, interval), strict=True))

    def starts_of(self, inputs: I) -> Matrix:
        """Return the states in which machines start, (d, n); (d, 1) of one."""
        return _machines(self, inputs).start()

    def law_at(self, inputs: I, states: Matrix, t: float | None = None) -> Matrix:
        """Return what the law says of n machines in these states (d, n), of one or n inputs; by default at first."""
        machines, several = _machines(self, inputs), np.zeros(states.shape[1], dtype=np.intp)
        machines = machines.part(several) if machines.is_single else machines
        stamps = machines.stamps
        at = stamps[0] if t is None else t
        interval = np.clip(np.searchsorted(stamps, at, side="right") - 1, 0, len(stamps) - 2)
        return machines.rate(np.full(len(several), at), states, several + interval)

    def begun(self, inputs: I, stamps: int) -> I:
        """Return the inputs of a record that ends after so many stamps."""
        machines = _machines(self, inputs)
        series = {self.input_fields[self.times].path: machines.stamps, **machines.drives}
        return with_values(inputs, {path: values[..., :stamps] for path, values in series.items()})

    def shown_at(self, inputs: I, states: Matrix) -> R:
        """Return the results of n machines that stand in these states (d, n) at the first two times."""
        inputs = self.begun(inputs, 2)
        standing = {name: np.repeat(states[row][:, None], 2, axis=1) for row, name in enumerate(self.state_fields)}
        never = {event.name: np.full(states.shape[1], np.nan) for event in self.events}
        counts, stamps = {name: np.zeros(states.shape[1]) for name in never}, _machines(self, inputs).stamps
        return self.gives(inputs, Motion(stamps, self.state_type(**standing), counts, never))


# What was followed is remembered machine by machine: a fit asks for the same ones again, among others


@dataclass(frozen=True)
class _Followed:
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

    several: list[_Machines[Any, Any, Any]] = field(default_factory=list)
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
    by_record: dict[tuple[int, bytes], list[_Machines[Any, Any, Any]]] = {}
    for machines in asked.several:
        by_record.setdefault((id(machines.dynamics), machines.record), []).append(machines)
    for group in by_record.values():
        machines = _joined(group)
        asked.new += len({*machines.keys} - {*machines.dynamics.memory})
        _follow(machines, _beside_others)


def _remembered(machines: _Machines[Any, Any, Any]) -> Solution:
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
    machines: _Machines[Any, Any, Any], follow: Callable[[_Machines[Any, Any, Any]], list[_Followed]]
) -> list[_Followed]:  # fmt: skip
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


def _all_steps(machines: _Machines[Any, Any, Any]) -> Solution:
    return solve(_problem(machines)) if machines.dynamics.step is None else _in_steps(machines)


def _by_themselves(new: _Machines[Any, Any, Any]) -> list[_Followed]:
    """Follow a few machines that are driven at all stamps at once, others step by step."""
    straight = _straight(new) if new.count <= MOST_DRIVEN else {}
    if not straight:
        return _step_by_step(new)
    made: dict[int, _Followed] = {}
    _add(made, new, _numbers(new), straight)
    return [made[place] for place in range(new.count)]


def _step_by_step(new: _Machines[Any, Any, Any]) -> list[_Followed]:
    """Follow machines step by step."""
    solution = _all_steps(new)
    return [_one_of(solution, machine, np.zeros(0), None) for machine in range(new.count)]


def _beside_others(new: _Machines[Any, Any, Any]) -> list[_Followed]:
    """Follow machines: along a path that is known, else near one another, else step by step."""
    if new.dynamics.step is not None:
        return _step_by_step(new)
    numbers = _numbers(new)
    known = [each for key, each in new.dynamics.memory.items() if each.path is not None and key.startswith(new.record)]
    made: dict[int, _Followed] = {}
    leaders = _leaders(numbers)
    firsts = np.unique(leaders).tolist()
    near = {**_straight(new), **_nearest(known[-MOST_NEAR:], numbers)}
    _add(made, new, numbers, {place: near.get(place) for place in firsts})
    _add(made, new, numbers, {place: made[int(first)].path for place, first in enumerate(leaders) if place not in made})
    return [made[place] for place in range(new.count)]


def _numbers(new: _Machines[Any, Any, Any]) -> Matrix:
    """Return what machines differ by, (n, numbers)."""
    return np.column_stack([np.zeros(new.count), *(each for each in new.numbers.values() if each.ndim == 1)])


def _straight(new: _Machines[Any, Any, Any]) -> dict[int, Path]:
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


def _nearest(known: Sequence[_Followed], numbers: Matrix) -> dict[int, Path]:
    """Return the path of what is known nearest to each machine; none where that is far."""
    if not known:
        return {}
    several = np.array([each.numbers for each in known])
    size = np.maximum(np.abs(several), np.abs(numbers[:, None]))
    off = (np.abs(several - numbers[:, None]) / np.maximum(size, TINY)).sum(axis=2)
    nearest = np.argmin(np.where(np.isnan(off), np.inf, off), axis=1)
    pairs = [(place, known[best], off[place, best]) for place, best in enumerate(nearest)]
    return {place: best.path for place, best, far in pairs if best.path is not None and far < FAR}


def _add(
    made: dict[int, _Followed], new: _Machines[Any, Any, Any], numbers: Matrix, along: Mapping[int, Path | None]
) -> None:
    """Follow some machines along paths, and step by step from where these no longer lead, or where there is none.

    Machines beside one another then have the same steps, so that their differences are not those of errors.
    """
    if not along:
        return
    places = np.array([*along])
    problem = _problem(new.part(places))
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


def _one_of(solution: Solution, machine: int, numbers: Matrix, path: Path | None) -> _Followed:
    """Return one machine of a solution."""
    return _Followed(
        np.array(solution.states[:, machine]), np.array(solution.counts[:, machine]),
        np.array(solution.first[:, machine]), solution.reasons.get(machine), numbers, path,
    )  # fmt: skip


def _problem(machines: _Machines[Any, Any, Any]) -> InitialValueProblem:
    dynamics, stamps, bends = machines.dynamics, machines.stamps, machines.bent()
    sizes = [in_si(spec.size, difference_unit(spec.unit)) for spec in dynamics.state_fields.values()]
    return InitialValueProblem(
        system=replace(machines, bends=bends), start=machines.start(), stamps=stamps, breaks=stamps[bends],
        sizes=np.array(sizes),
        events=[event.rule for event in dynamics.events], tolerance=dynamics.tolerance,
        most_steps=dynamics.most_steps + len(bends),
    )  # fmt: skip


@dataclass(frozen=True)
class _Machines(Generic[S, I, R]):
    """The state equation of ``count`` machines as the integrator calls it; ``drives`` by path (k,) or (n, k).

    ``bends`` are the places among the stamps between which the intervals of the integrator run.
    """

    dynamics: Dynamics[S, I, R]
    inputs: I
    stamps: Matrix
    count: int
    is_single: bool
    columns: Mapping[tuple[str, ...], Matrix]
    drives: Mapping[tuple[str, ...], Matrix]
    held: frozenset[tuple[str, ...]]
    bends: Indices

    def bent(self) -> Indices:
        """Return the places of the stamps at which something that drives changes its course, the ends among them."""
        bends = np.zeros(len(self.stamps), dtype=bool)
        bends[[0, -1]] = True
        for path, series in self.drives.items():
            changes = (np.diff(series) != 0).reshape(-1, len(bends) - 1).any(axis=0)
            bends[1:-1] |= changes[:-1] if path in self.held else changes[:-1] | changes[1:]
        return np.flatnonzero(bends)

    @cached_property
    def record(self) -> bytes:
        """What tells the record of these machines from that of others: every input that all machines share."""
        wide = {path for path, value in self.drives.items() if value.ndim > 1}
        digest = blake2b(digest_size=16)
        for each in self.dynamics.input_fields.values():
            if not each.varies and each.path not in wide:
                value = read(self.inputs, each.path)
                digest.update(value.tobytes() if isinstance(value, np.ndarray) else f"{value!r}\0".encode())
        return digest.digest()

    @cached_property
    def numbers(self) -> dict[tuple[str, ...], Matrix]:
        """By path what may differ between machines, (n,) or (n, k)."""
        fields_of = [each for each in self.dynamics.input_fields.values() if each.varies]
        values = {each.path: read(self.inputs, each.path) for each in fields_of}
        made = {path: value if np.ndim(value) else np.full(self.count, value) for path, value in values.items()}
        return made | {path: value for path, value in self.drives.items() if value.ndim > 1}

    @cached_property
    def keys(self) -> list[bytes]:
        """What tells every machine from any other one."""
        rows = np.column_stack([np.zeros(self.count), *self.numbers.values()])
        return [self.record + row.tobytes() for row in rows]

    def start(self) -> Matrix:
        """Return the states at the first stamp, (d, n)."""
        dynamics = self.dynamics
        if dynamics.start is not None:
            return self._stacked(dynamics.start(self._inputs_at(*self._at_first())))
        values = []
        for spec in dynamics.state_fields.values():
            source = dynamics.input_fields.get(str(spec.start))
            values.append(in_si(spec.start, spec.unit) if source is None else read(self.inputs, source.path))
        return np.array([np.broadcast_to(value, (self.count,)) for value in values], dtype=float)

    def rate(self, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return what the law says, (d, n)."""
        return self._stacked(self.dynamics.law(self._states(y), self._inputs_at(t, interval), t))

    def crossing(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return what passes 0 when an event happens, (n,)."""
        value = self.dynamics.events[event].value(self._states(y), self._inputs_at(t, interval), t)
        return np.array(np.broadcast_to(value, t.shape), dtype=float)

    def after(self, event: int, t: Matrix, y: Matrix, interval: Indices) -> Matrix:
        """Return the state after an event, (d, n)."""
        then = self.dynamics.events[event].then
        assert then is not None
        return self._stacked(then(self._states(y), self._inputs_at(t, interval), t))

    def part(self, machines: Indices) -> _Machines[S, I, R]:
        """Return the equation of some of the machines."""
        columns = {path: value[machines] for path, value in self.columns.items()}
        drives = {path: value[machines] if value.ndim > 1 else value for path, value in self.drives.items()}
        inputs = with_values(self.inputs, columns)
        return replace(self, inputs=inputs, count=len(machines), columns=columns, drives=drives)

    def _states(self, y: Matrix) -> S:
        states: S = object.__new__(self.dynamics.state_type)
        states.__dict__.update(zip(self.dynamics.state_fields, y, strict=True))
        return states

    def _stacked(self, states: S) -> Matrix:
        stacked = np.empty((len(self.dynamics.state_fields), self.count))
        for place, name in enumerate(self.dynamics.state_fields):
            stacked[place] = getattr(states, name)
        return stacked

    def _at_first(self) -> tuple[Matrix, Indices]:
        return np.full(self.count, self.stamps[0]), np.zeros(self.count, dtype=np.intp)

    def _inputs_at(self, t: Matrix, interval: Indices) -> I:
        """Return the inputs with every series at its value of the moment."""
        if not self.drives:
            return self.inputs
        values: dict[tuple[str, ...], Any] = {}
        for path, series in self.drives.items():
            rows = (np.arange(len(t)),) if series.ndim > 1 else ()
            begins, ends = self.bends[interval], self.bends[interval + 1]
            begin = series[(*rows, begins)]
            if path not in self.held:
                low, high = self.stamps[begins], self.stamps[ends]
                begin = begin + (series[(*rows, ends)] - begin) * (t - low) / (high - low)
            values[path] = begin
        return with_values(self.inputs, values)


def _machines(dynamics: Dynamics[S, I, R], inputs: I) -> _Machines[S, I, R]:
    """Take inputs apart: what is one machine, what differs between machines, what drives them."""
    fields_of = dynamics.input_fields
    stamps = np.atleast_1d(np.asarray(read(inputs, fields_of[dynamics.times].path), dtype=float))
    _demand(len(stamps) > 1 and np.isfinite(stamps).all(), f"{dynamics.times}: a motion needs two times or more")
    _demand((np.diff(stamps) > 0).all(), f"{dynamics.times}: the times of a record rise; two are equal or fall")
    drives = {each.path: np.asarray(read(inputs, each.path), dtype=float) for each in dynamics.driving.values()}
    for name, each in dynamics.driving.items():
        series = np.atleast_1d(drives[each.path])
        if series.shape[-1] == 1:
            series = np.broadcast_to(series, (*series.shape[:-1], len(stamps)))
        drives[each.path], values = series, series.shape[-1]
        wanted = "give one for each, of rows of a file in a column of that name, or one for all"
        _demand(values == len(stamps), f"{name} has {values} values at {len(stamps)} {dynamics.times}; {wanted}")
        _demand(np.isfinite(series).all(), f"{name} is missing at some of the {dynamics.times}")
    numbers = {each.path: read(inputs, each.path) for each in fields_of.values() if each.varies}
    columns = {path: value for path, value in numbers.items() if np.ndim(value) == 1}
    sizes = {len(value) for value in columns.values()} | {len(value) for value in drives.values() if value.ndim > 1}
    count = max(sizes, default=1)
    columns = {path: np.broadcast_to(value, (count,)) for path, value in columns.items()}
    held = frozenset(each.path for each in dynamics.driving.values() if getattr(each.spec, "between", "") == "hold")
    return _Machines(dynamics, inputs, stamps, count, not sizes, columns, drives, held, np.arange(len(stamps)))


def _joined(several: Sequence[_Machines[S, I, R]]) -> _Machines[S, I, R]:
    """Return machines of one record as one batch; what is the same for all of them stays a number."""
    first, *others = several
    if not others:
        return first
    numbers = {path: np.concatenate([each.numbers[path] for each in several]) for path in first.numbers}
    alone = {path: value for path, value in numbers.items() if value.ndim == 1}
    columns = {path: value for path, value in alone.items() if (value != value[0]).any()}
    inputs = with_values(first.inputs, {path: columns.get(path, value[0]) for path, value in alone.items()})
    drives = {path: numbers.get(path, value) for path, value in first.drives.items()}
    count = sum(each.count for each in several)
    return replace(first, inputs=inputs, count=count, is_single=False, columns=columns, drives=drives)


def _demand(holds: Any, sentence: str) -> None:
    """Refuse a record that no machine can be followed along, one alone or a batch."""
    if not holds:
        raise InfeasibleError(sentence)


def _in_steps(machines: _Machines[Any, Any, Any]) -> Solution:
    """Follow the states from one stamp to the next by the step."""
    y, stamps = machines.start(), machines.stamps
    states = np.empty((*y.shape, len(stamps)))
    states[:, :, 0] = y
    interval = np.zeros(machines.count, dtype=np.intp)
    with np.errstate(all="ignore"):
        for place, t in enumerate(stamps[:-1]):
            y = machines.rate(np.full(machines.count, t), y, interval + place)
            states[:, :, place + 1] = y
    bad = ~np.isfinite(y).all(axis=0)
    ends = {int(at): float(stamps[np.isfinite(states[:, at]).all(axis=0)][-1]) for at in np.flatnonzero(bad)}
    return Solution(states, np.zeros((0, machines.count)), np.zeros((0, machines.count)),
                    {at: (GROWS, t) for at, t in ends.items()})  # fmt: skip


def _say_why(solution: Solution, machines: _Machines[Any, Any, Any]) -> None:
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


def _fields(kind: Any) -> tuple[Any, ...]:
    return fields(kind) if hasattr(kind, "__dataclass_fields__") else ()


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", repr(function))
