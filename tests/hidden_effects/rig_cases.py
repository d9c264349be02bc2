"""What a case on a rig is to be like, and how one is made: rows, a machine within its tolerances, and noise."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from hidden_effects.noises import Kind, held_out, noise_of, title_of
from hidden_effects.rows import Array, Hidden, MeasuredRows

RowsT = TypeVar("RowsT", bound=MeasuredRows)
MachineT = TypeVar("MachineT")
Places: TypeAlias = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class RigWish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered.

    That is added to the first result, in its unit.
    """

    seed: int = 3
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

    def quieter(self, result: str) -> float:
        """How the noise of a result compares with what is usual."""
        return 1.0


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

    ``spread`` says, row by row, how noise that grows compares; ``noise`` is its root mean square by result. ``held``
    rows are held out; None: as many as are fitted. ``is_path``: what is shown follows the rows before, fitted or not.
    """

    stream: int
    held: int | None
    measured: Callable[[Any, int, np.random.Generator], RowsT]
    machine: Callable[[Any, np.random.Generator], MachineT]
    shown: Callable[[RowsT, MachineT, Hidden], Mapping[str, Array]]
    spread: Callable[[RowsT], Array]
    noise: Mapping[str, float]
    parted: Callable[[int, int, np.random.Generator], tuple[Places, Places]] = held_out
    is_path: bool = False

    def made(self, wish: RigWish) -> RigCase:
        """Draw a machine within its tolerances, measure it, and put the noise on."""
        rng = np.random.default_rng([wish.seed, self.stream])
        held = wish.count if self.held is None else self.held
        every = self.measured(wish.design, wish.count + held, rng)
        parts = self.parted(len(every), held, rng)
        machine = self.machine(wish, rng)
        whole = self._true(wish, every, machine) if self.is_path else None
        rows = [every.taken(places) for places in parts]
        true, read = [], []
        for places, part in zip(parts, rows, strict=True):
            true.append({name: whole[name][places] for name in whole} if whole else self._true(wish, part, machine))
            noise = {name: noise_of(wish.kind, self.spread(part), self._size(wish, name), rng) for name in wish.results}
            read.append({name: true[-1][name] + noise[name] for name in wish.results})
        return RigCase(
            wish=wish, rows=rows[0], held=rows[1], readings=read[0], held_readings=read[1], held_true=true[1]
        )  # fmt: skip

    def _true(self, wish: RigWish, rows: RowsT, machine: MachineT) -> dict[str, Array]:
        """What the gauges would show without noise; what nobody registered is added to the first result."""
        read = dict(self.shown(rows, machine, wish.hidden))
        if wish.strange is not None:
            read[wish.results[0]] = read[wish.results[0]] + wish.strange(rows)
        return read

    def _size(self, wish: RigWish, result: str) -> float:
        return self.noise[result] * wish.quieter(result)
