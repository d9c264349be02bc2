"""Machines that move, as the integrator calls them: what tells one from another, what drives them, how they start."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import blake2b
from typing import Any, Protocol

import numpy as np

from truing.arrays import Indices, Matrix
from truing.declare.fields import InputField, in_si, read, with_values
from truing.errors import InfeasibleError
from truing.integration import GROWS, InitialValueProblem, Solution
from truing.units import difference_unit


class StateEquation(Protocol):
    """What is declared of a model that moves, as far as machines of it need it: see ``Dynamics``."""

    @property
    def times(self) -> str:
        """The input series of the stamps."""

    @property
    def start(self) -> Callable[[Any], Any] | None:
        """What gives states in place of the starts that are declared."""

    @property
    def step(self) -> Callable[..., Any] | None:
        """What gives the states at the next stamp, in place of a rate."""

    @property
    def events(self) -> Sequence[Any]:
        """What happens on the way."""

    @property
    def tolerance(self) -> float:
        """Share of each state below which errors per step are held."""

    @property
    def most_steps(self) -> int:
        """So many steps are taken."""

    @property
    def law(self) -> Callable[..., Any]:
        """The rate or the step, whichever is given."""

    @property
    def state_type(self) -> type:
        """The dataclass of states."""

    @property
    def state_fields(self) -> Mapping[str, Any]:
        """Every state by name."""

    @property
    def input_fields(self) -> Mapping[str, InputField]:
        """Every input by flat name."""

    @property
    def driving(self) -> Mapping[str, InputField]:
        """The input series that the law sees at every moment, by flat name."""

    @property
    def memory(self) -> dict[bytes, Any]:
        """What was followed last, by what tells one machine from another."""


@dataclass(frozen=True)
class Machines:
    """The state equation of ``count`` machines as the integrator calls it; ``drives`` by path (k,) or (n, k).

    ``bends`` are the places among the stamps between which the intervals of the integrator run.
    """

    dynamics: StateEquation
    inputs: Any
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

    def part(self, machines: Indices) -> Machines:
        """Return the equation of some of the machines."""
        columns = {path: value[machines] for path, value in self.columns.items()}
        drives = {path: value[machines] if value.ndim > 1 else value for path, value in self.drives.items()}
        inputs = with_values(self.inputs, columns)
        return replace(self, inputs=inputs, count=len(machines), columns=columns, drives=drives)

    def _states(self, y: Matrix) -> Any:
        states: Any = object.__new__(self.dynamics.state_type)
        states.__dict__.update(zip(self.dynamics.state_fields, y, strict=True))
        return states

    def _stacked(self, states: Any) -> Matrix:
        stacked = np.empty((len(self.dynamics.state_fields), self.count))
        for place, name in enumerate(self.dynamics.state_fields):
            stacked[place] = getattr(states, name)
        return stacked

    def _at_first(self) -> tuple[Matrix, Indices]:
        return np.full(self.count, self.stamps[0]), np.zeros(self.count, dtype=np.intp)

    def _inputs_at(self, t: Matrix, interval: Indices) -> Any:
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


def machines_of(dynamics: StateEquation, inputs: Any) -> Machines:
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
    return Machines(dynamics, inputs, stamps, count, not sizes, columns, drives, held, np.arange(len(stamps)))


def joined(several: Sequence[Machines]) -> Machines:
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


def problem_of(machines: Machines) -> InitialValueProblem:
    """Return what is to be integrated, with a break where what drives changes its course."""
    dynamics, stamps, bends = machines.dynamics, machines.stamps, machines.bent()
    sizes = [in_si(spec.size, difference_unit(spec.unit)) for spec in dynamics.state_fields.values()]
    return InitialValueProblem(
        system=replace(machines, bends=bends), start=machines.start(), stamps=stamps, breaks=stamps[bends],
        sizes=np.array(sizes),
        events=[event.rule for event in dynamics.events], tolerance=dynamics.tolerance,
        most_steps=dynamics.most_steps + len(bends),
    )  # fmt: skip


def in_steps(machines: Machines) -> Solution:
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
