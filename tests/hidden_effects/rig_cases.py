"""What a case on a rig is to be like, and how one is made: rows, a machine within its tolerances, and noise."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

from hidden_effects.noises import Kind, held_out, noise_of, title_of
from hidden_effects.rows import Array, Hidden, MeasuredRows

RowsT = TypeVar("RowsT", bound=MeasuredRows)
MachineT = TypeVar("MachineT")


@dataclass(frozen=True, kw_only=True)
class RigWish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered."""

    seed: int
    hidden: Hidden = field(default_factory=dict)
    design: str
    kind: Kind = "gaussian"
    results: tuple[str, ...]
    count: int
    strange: Callable[[Any], Any] | None = None

    @property
    def title(self) -> str:
        """What the case is called in the list of tests."""
        return title_of(self.hidden, self.strange, self.design, self.kind, "+".join(self.results))


@dataclass(frozen=True, kw_only=True)
class RigCase(Generic[RowsT]):
    """A record with its readings, rows held out with theirs, and what is true of both."""

    wish: Any
    rows: RowsT
    held: RowsT
    readings: Mapping[str, Array]
    held_readings: Mapping[str, Array]
    true_readings: Callable[[RowsT], dict[str, Array]]
    """What the gauges would show without noise."""


@dataclass(frozen=True, kw_only=True)
class RigCases(Generic[RowsT, MachineT]):
    """How the cases of a machine are made: rows of a design, a machine, what its gauges show, and their noise.

    ``spread`` says, row by row, how noise that grows compares; ``noise`` is its root mean square by result.
    """

    stream: int
    held: int
    measured: Callable[[Any, int, np.random.Generator], RowsT]
    machine: Callable[[np.random.Generator], MachineT]
    true: Callable[[Any, RowsT, MachineT], dict[str, Array]]
    spread: Callable[[RowsT], Array]
    noise: Mapping[str, float]

    def made(self, wish: RigWish) -> RigCase[RowsT]:
        """Draw a machine within its tolerances, measure it, and put the noise on."""
        rng = np.random.default_rng([wish.seed, self.stream])
        every = self.measured(wish.design, wish.count + self.held, rng)
        rows, held = (every.taken(places) for places in held_out(len(every), self.held, rng))
        machine = self.machine(rng)
        read = []
        for part in (rows, held):
            true = self.true(wish, part, machine)
            noise = {name: noise_of(wish.kind, self.spread(part), self.noise[name], rng) for name in wish.results}
            read.append({name: true[name] + noise[name] for name in wish.results})
        return RigCase(
            wish=wish, rows=rows, held=held, readings=read[0], held_readings=read[1],
            true_readings=lambda some: self.true(wish, some, machine),
        )  # fmt: skip
