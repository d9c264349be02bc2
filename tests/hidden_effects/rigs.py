"""Records of the machines of each plugin from a wish: rows, a machine within its tolerances, noise, and the answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hidden_effects.rows import Array, Hidden
from truing import Kernel, Model
from truing.testing import recorded
from truing.testing.hiding import Answered, csv_of, with_memory
from truing.units import from_si

Kind: TypeAlias = Literal["gaussian", "heavy", "autocorrelated", "growing"]
KINDS: tuple[Kind, ...] = ("gaussian", "heavy", "autocorrelated", "growing")
MEMORY = 0.5
Places: TypeAlias = NDArray[np.intp]


def noise_of(
    kind: Kind, count: int, rng: np.random.Generator, *, size: float = 1.0, freedom: int = 4, memory: float = MEMORY
) -> Array:
    """Noise of this root mean square: independent and normal, heavy in its tails, or with a memory."""
    if kind == "heavy":
        return np.asarray(size * rng.standard_t(freedom, count) / np.sqrt(freedom / (freedom - 2)))
    return size * with_memory(rng.standard_normal((1, count)), memory if kind == "autocorrelated" else 0.0)[0]


def grown(noise: Array, spread: Array) -> Array:
    """Noise that grows as ``spread`` says, row by row, of the same root mean square."""
    return np.asarray(noise * spread / np.sqrt(np.mean(spread**2)))


def held_out(count: int, held: int, rng: np.random.Generator) -> tuple[Places, Places]:
    """The places of the rows that are fitted and of those that are not; the first row, where a clock begins, is."""
    return parted(count, rng.permutation(np.arange(1, count))[:held])


def parted(count: int, held: Places) -> tuple[Places, Places]:
    """The places of so many rows that are not held out, and of those that are, in their order."""
    is_held = np.isin(np.arange(count), held)
    return np.flatnonzero(~is_held), np.flatnonzero(is_held)


@dataclass(frozen=True, kw_only=True, eq=False)
class Wish:
    """What a case is to be like: hidden unknowns in the units of the registry, and what nobody registered.

    That is added to the first result, in its unit. ``held`` rows are held out; None: as many as the rig has it.
    """

    rig: Rig
    seed: int = 3
    hidden: Hidden = field(default_factory=dict)
    design: str
    kind: Kind = "gaussian"
    results: tuple[str, ...]
    count: int
    held: int | None = None
    strange: Callable[[Any], Any] | None = None

    @property
    def title(self) -> str:
        """What the case is called in the list of tests."""
        name = "+".join(self.hidden) or (self.strange.__name__ if self.strange else "nothing")
        return "-".join((name, self.design, self.kind, "+".join(self.results)))

    @cached_property
    def case(self) -> RigCase:
        """The record, made once."""
        return self.rig.make(self)

    @cached_property
    def answered(self) -> Answered:
        """What the kit says to the record, asked once; rows held out are predicted in the units of the file."""
        measured, held = self.tables()
        said = recorded(model_of(self.rig.plugin), inputs=self.rig.inputs, measured=measured, held_out=held).answered
        units = self.rig.measured
        return replace(said, predicted={name: from_si(values, units[name]) for name, values in said.predicted.items()})

    def tables(self) -> tuple[str, str]:
        """The rows that are fitted and those held out as CSV with units in the header, every digit kept."""
        case = self.case
        return self._table(case.rows, case.readings), self._table(case.held, case.held_readings)

    def _table(self, rows: Any, readings: Mapping[str, Array]) -> str:
        columns = {f"{name} [{unit}]": getattr(rows, name) for name, unit in self.rig.written.items()}
        return csv_of(columns | {f"{name} [{self.rig.measured[name]}]": values for name, values in readings.items()})


@dataclass(frozen=True, kw_only=True)
class RigCase:
    """A record with its readings, and rows held out with theirs and with what is true of them.

    ``held_true`` is what the gauges would show without noise, ``held_error`` the standard errors that readings state.
    """

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
class Rig:
    """A plugin with the text of its inputs file, the units of what is written and measured, and how a case is made."""

    plugin: str
    inputs: str
    written: Mapping[str, str]
    measured: Mapping[str, str]
    make: Callable[[Wish], RigCase]


@dataclass(frozen=True, kw_only=True)
class Bench:
    """How the cases of a machine are made: rows of a design, a machine, what its gauges show, and their noise.

    ``spread`` says, row by row, how noise that grows compares; ``noise`` is its root mean square by result. ``held``
    rows are held out; None: as many as are fitted. ``is_path``: what is shown follows the rows before, fitted or not.
    """

    stream: int
    held: int | None
    measured: Callable[[Any, int, np.random.Generator], Any]
    machine: Callable[[np.random.Generator], Any]
    shown: Callable[[Any, Any, Hidden], Mapping[str, Array]]
    spread: Callable[[Any], Array]
    noise: Mapping[str, float]
    parted: Callable[[int, int, np.random.Generator], tuple[Places, Places]] = held_out
    is_path: bool = False

    def __call__(self, wish: Wish) -> RigCase:
        """Draw a machine within its tolerances, measure it, and put the noise on."""
        rng = np.random.default_rng([wish.seed, self.stream])
        held = wish.held or self.held or wish.count
        every = self.measured(wish.design, wish.count + held, rng)
        parts = self.parted(len(every), held, rng)
        machine = self.machine(rng)
        whole = self._true(wish, every, machine) if self.is_path else None
        rows = [every.taken(places) for places in parts]
        true, read = [], []
        for places, part in zip(parts, rows, strict=True):
            true.append({name: whole[name][places] for name in whole} if whole else self._true(wish, part, machine))
            read.append({name: true[-1][name] + self._noise(wish, name, part, rng) for name in wish.results})
        return RigCase(
            rows=rows[0], held=rows[1], readings=read[0], held_readings=read[1], held_true=true[1]
        )  # fmt: skip

    def _noise(self, wish: Wish, result: str, rows: Any, rng: np.random.Generator) -> Array:
        noise = noise_of(wish.kind, len(rows), rng, size=self.noise[result])
        return grown(noise, self.spread(rows)) if wish.kind == "growing" else noise

    def _true(self, wish: Wish, rows: Any, machine: Any) -> dict[str, Array]:
        """What the gauges would show without noise; what nobody registered is added to the first result."""
        read = dict(self.shown(rows, machine, wish.hidden))
        if wish.strange is not None:
            read[wish.results[0]] = read[wish.results[0]] + wish.strange(rows)
        return read


@cache
def model_of(plugin: str) -> Model[Any, Any]:
    """The model of a plugin as installed."""
    return Kernel.installed().offer(plugin).model


def demand_named(
    document: Mapping[str, Any],
    curves: Sequence[set[str]],
    *,
    may_be_unknown: bool = False,
) -> None:
    """Ask that no explanation is left but these causes, each by any name of its curve.

    Few rows along one axis may also be drawn by a shape that nobody registered.
    """
    explanations = [set(names) for names in document["explanations"]]
    assert document["verdict"] == ("named" if len(explanations) == 1 else "one_of")
    for names in explanations:
        if may_be_unknown and all(name.startswith("unknown") for name in names):
            continue
        assert all(names & curve for curve in curves), names
        assert len(names) == len(curves), names


def demand_first(document: Mapping[str, Any], effect: str) -> bool:
    """Ask that an effect alone explains best, and every other explanation has more beside it; whether it is alone.

    What noise draws beside it is now and then not excluded: that is asked of many records together.
    """
    explanations = document["explanations"]
    assert explanations[0] == [effect]
    assert all(effect in names for names in explanations), explanations
    assert [(cause["effect"], cause["same_as"]) for cause in document["causes"]] == [(effect, [])]
    assert document["remainder"] is None
    return document["verdict"] == "named"
