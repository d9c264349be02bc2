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
class RigCase:
    """A record with its readings, and rows held out with theirs and with what is true of them.

    ``held_true`` is what the gauges would show without noise, ``held_error`` the standard errors that readings state.
    """

    wish: Any
    rows: Any
    held: Any
    readings: Mapping[str, Array]
    held_readings: Mapping[str, Array]
    held_true: Mapping[str, Array]
    held_error: Array | float = 1.0

    def left_over_noise(self, predicted: Mapping[str, Array], result: str) -> float:
        """Error of a prediction of the rows held out over that of the truth, which leaves the noise."""
        left, noise = (
            (self.held_readings[result] - shown[result]) / self.held_error for shown in (predicted, self.held_true)
        )
        return float(np.sqrt(np.mean(left**2) / np.mean(noise**2)))


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

    def made(self, wish: RigWish) -> RigCase:
        """Draw a machine within its tolerances, measure it, and put the noise on."""
        rng = np.random.default_rng([wish.seed, self.stream])
        every = self.measured(wish.design, wish.count + self.held, rng)
        rows, held = (every.taken(places) for places in held_out(len(every), self.held, rng))
        machine = self.machine(rng)
        true, read = [], []
        for part in (rows, held):
            true.append(self.true(wish, part, machine))
            noise = {name: noise_of(wish.kind, self.spread(part), self.noise[name], rng) for name in wish.results}
            read.append({name: true[-1][name] + noise[name] for name in wish.results})
        return RigCase(
            wish=wish, rows=rows, held=held, readings=read[0], held_readings=read[1], held_true=true[1]
        )  # fmt: skip
