"""State equations: what changes by itself, how fast, from where on, and what a record of it answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from functools import cached_property
from typing import Any, Generic, Literal, TypeVar, cast, dataclass_transform

import numpy as np

from truing.arrays import Matrix
from truing.declare.fields import KEY, Float, InputField, hints_of, input_fields, with_values
from truing.declare.following import Followed, remembered, say_why
from truing.declare.machines import machines_of
from truing.errors import DeclarationError
from truing.integration import EventRule

I = TypeVar("I")  # noqa: E741  # inputs, as in Model[I, R]
R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")


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
    def memory(self) -> dict[bytes, Followed]:
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
        machines = machines_of(self, inputs)
        known = self.state_fields
        solution = remembered(machines)
        say_why(solution, machines)
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
        machines, stamps = machines_of(self, inputs), motion.time
        interval = np.minimum(np.arange(len(stamps)), len(stamps) - 2)
        along = replace(machines.part(np.zeros(len(stamps), dtype=np.intp)), stamps=stamps)
        y = np.array([getattr(motion.states, name) for name in self.state_fields])
        return dict(zip(self.state_fields, along.rate(stamps, y, interval), strict=True))

    def starts_of(self, inputs: I) -> Matrix:
        """Return the states in which machines start, (d, n); (d, 1) of one."""
        return machines_of(self, inputs).start()

    def law_at(self, inputs: I, states: Matrix, t: float | None = None) -> Matrix:
        """Return what the law says of n machines in these states (d, n), of one or n inputs; by default at first."""
        machines, several = machines_of(self, inputs), np.zeros(states.shape[1], dtype=np.intp)
        machines = machines.part(several) if machines.is_single else machines
        stamps = machines.stamps
        at = stamps[0] if t is None else t
        interval = np.clip(np.searchsorted(stamps, at, side="right") - 1, 0, len(stamps) - 2)
        return machines.rate(np.full(len(several), at), states, several + interval)

    def begun(self, inputs: I, stamps: int) -> I:
        """Return the inputs of a record that ends after so many stamps."""
        machines = machines_of(self, inputs)
        series = {self.input_fields[self.times].path: machines.stamps, **machines.drives}
        return with_values(inputs, {path: values[..., :stamps] for path, values in series.items()})

    def shown_at(self, inputs: I, states: Matrix) -> R:
        """Return the results of n machines that stand in these states (d, n) at the first two times."""
        inputs = self.begun(inputs, 2)
        standing = {name: np.repeat(states[row][:, None], 2, axis=1) for row, name in enumerate(self.state_fields)}
        never = {event.name: np.full(states.shape[1], np.nan) for event in self.events}
        counts, stamps = {name: np.zeros(states.shape[1]) for name in never}, machines_of(self, inputs).stamps
        return self.gives(inputs, Motion(stamps, self.state_type(**standing), counts, never))


def _fields(kind: Any) -> tuple[Any, ...]:
    return fields(kind) if hasattr(kind, "__dataclass_fields__") else ()


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", repr(function))
