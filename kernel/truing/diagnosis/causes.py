"""What competes to explain a record: effects or parts of them, and inputs that lie outside of their band.

A cause is a handful of numbers. Amplitudes switch it off at zero; the others give it its shape. Shapes that nobody
registered are causes too: see ``unregistered``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import inf
from pathlib import PurePath
from typing import Any, Literal

import numpy as np

from truing.arrays import Matrix
from truing.declare.builtin import BuiltinReading, may_stand
from truing.declare.sources import Effect, Unknown
from truing.diagnosis.data_rows import is_angle
from truing.diagnosis.machine import Calibration
from truing.diagnosis.records import Covariate
from truing.errors import PluginError
from truing.gauge import read_by_gauge
from truing.setup import SwitchedOn
from truing.units import to_si

ShapeKind = Literal["trend", "product", "order", "wave", "step", "jump", "kink", "dead zone", "settling"]
INPUT = "input:"
"""Begins the tag of a tolerated input that competes as a cause."""
ENDS = 0.02
"""Share of a record at each end within which nothing begins."""
LITTLE = 1e-3
"""Share of its bound at which an effect is hardly there."""


@dataclass(frozen=True)
class Parameter:
    """One number of a cause, SI: an amplitude, or a shape. ``file`` is that whose rows it acts on, -1 for all.

    A ``whole`` number, and a place ``along`` a covariate at which nothing is smooth, keep the value of their start.
    """

    name: str
    low: float
    high: float
    is_amplitude: bool = True
    whole: bool = False
    along: str = ""
    file: int = -1

    @property
    def is_free(self) -> bool:
        """Whether a fit may move it smoothly."""
        return not self.whole and not self.along

    @property
    def is_log(self) -> bool:
        """Whether it is looked for by its logarithm: a shape of one sign."""
        return not self.is_amplitude and not self.whole and self.low > 0


@dataclass(frozen=True)
class Term:
    """One term of a shape: Python over covariates in SI, and its values on all rows of some records, (n,)."""

    expression: str
    values: Matrix


@dataclass(frozen=True)
class UnregisteredShape:
    """How a shape that nobody registered is calculated: ``made`` gives its terms from covariates and shape numbers, SI.

    Its amplitudes are those of its terms, result after result.
    """

    kind: ShapeKind
    depends_on: tuple[str, ...]
    results: tuple[str, ...]
    made: Callable[..., list[Term]]

    def terms(self, numbers: Sequence[float], covariates: Mapping[str, Covariate]) -> list[Term]:
        """Return the terms on the rows of some covariates."""
        axes = ((name, covariates[name].filled) for name in self.depends_on)  # missing values are at their mean
        return self.made(*chain.from_iterable(axes), *numbers)


@dataclass(frozen=True, eq=False)
class Candidate:
    """One cause that may be on. ``tag`` tells it from every other one; ``name`` is what the answer calls it.

    Of an effect ``effect`` holds the declaration; of an input ``tolerated`` is its place among the machine's inputs; of
    a shape that nobody registered ``shape`` says how it is calculated. ``order`` is that of declaration.
    """

    name: str
    tag: str
    numbers: tuple[Parameter, ...]
    order: int = 0
    effect: Effect[Any, Any] | None = None
    tolerated: int = -1
    shape: UnregisteredShape | None = None
    is_kernel: bool = False

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return len(self.numbers)

    @cached_property
    def amplitudes(self) -> list[int]:
        """Places of the numbers that switch it off at zero."""
        return [index for index, number in enumerate(self.numbers) if number.is_amplitude]

    @cached_property
    def shapes(self) -> list[int]:
        """Places of the numbers that give it its shape."""
        return [index for index, number in enumerate(self.numbers) if not number.is_amplitude]

    @cached_property
    def ends(self) -> tuple[Matrix, Matrix]:
        """Lower and upper bounds of the amplitudes, SI."""
        numbers = [self.numbers[index] for index in self.amplitudes]
        return np.array([number.low for number in numbers]), np.array([number.high for number in numbers])

    @property
    def kept(self) -> list[int]:
        """Places of the whole numbers and of what lies along a covariate: a fit leaves them where they begin."""
        return [index for index, number in enumerate(self.numbers) if not number.is_free]

    @property
    def acts_on_inputs(self) -> bool:
        """Whether the model runs again with it, so that it may change what other causes do."""
        return self.tolerated >= 0 or (self.effect is not None and self.effect.place == "inputs")

    @property
    def is_registered(self) -> bool:
        """Whether somebody declared it: an effect or a tolerated input."""
        return self.shape is None

    @property
    def weakest_first(self) -> tuple[int, bool, int, str]:
        """Which of several names for one curve is taken: fewest numbers, the kernel's, the first declared."""
        return self.size, not self.is_kernel, self.order, self.tag


def si_bounds(unknown: Unknown) -> tuple[float, float]:
    """Return the bounds of an unknown in SI."""
    return float(to_si(unknown.low, unknown.unit)), float(to_si(unknown.high, unknown.unit))


def reading_of(effect: Effect[Any, Any]) -> BuiltinReading | None:
    """Return the reading of a built-in effect; None for other effects."""
    return effect.function if isinstance(effect.function, BuiltinReading) else None


def gauged(cause: Candidate, measured: Iterable[str]) -> str:
    """Return the measured result whose reading a part of a built-in effect changes, or nothing."""
    reading = None if cause.effect is None else reading_of(cause.effect)
    names = {number.name for number in cause.numbers}
    for result, roles in reading.roles if reading is not None else ():
        if result.name in set(measured) and names == set(roles.values()):
            return result.name
    return ""


def followed_by(effect: Effect[Any, Any] | None) -> str:
    """Return the name of the input, condition or axis that a built-in effect follows; nothing for an offset or gain."""
    reading = None if effect is None else reading_of(effect)
    return reading.seen.name if reading is not None and reading.seen is not None else ""


def effects_of(machine: Calibration) -> list[Candidate]:
    """Return every effect, or part of one, that could act: the model's in the order of declaration, the kernel's last.

    Effects, and parts of effects, that are on already are part of the model; an effect whose conditions nobody measured
    is left out, and so is one that follows only what never moved.
    """
    model, candidates = machine.start.model, list[Candidate]()
    for order, effect in enumerate(model.known_effects.values()):
        if any(need.name in machine.records.absent for need in effect.needs) or _stands_still(effect, machine):
            continue
        parts = effect.parts or (tuple(unknown.name for unknown in effect.unknowns),)
        is_kernel = effect.name not in model.effects
        for index, part in enumerate(parts):
            if not set(part) & set(machine.on.get(effect.name, ())):
                tag = effect.name if len(parts) == 1 else f"{effect.name}.{index}"
                numbers = tuple(_numbers(effect, part, machine))
                candidates.append(Candidate(effect.name, tag, numbers, order, effect, is_kernel=is_kernel))
    return [cause for cause in candidates if not cause.is_kernel or _is_offered(cause, machine)]


def _numbers(effect: Effect[Any, Any], part: Sequence[str], machine: Calibration) -> Iterator[Parameter]:
    """Give the numbers of a part of an effect, one for every file where they are fitted file by file."""
    per_file, files = set(machine.start.diagnose.per_file), len(machine.records.files)
    for unknown in effect.unknowns:
        if unknown.name not in part:
            continue
        is_split = bool(per_file & {effect.name, f"{effect.name}.{unknown.name}"}) and files > 1
        ends = _within_record(unknown, machine) if unknown.along else si_bounds(unknown)
        for file in range(files) if is_split and unknown.is_amplitude else (-1,):
            yield Parameter(unknown.name, *ends, unknown.is_amplitude, unknown.whole, unknown.along, file)


def _within_record(unknown: Unknown, machine: Calibration) -> tuple[float, float]:
    """Return between which places of the record something may begin: not at its very ends."""
    low, high = si_bounds(unknown)
    covariate = machine.records.covariates.get(unknown.along)
    if covariate is None or covariate.is_constant:
        return low, high
    first, last = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
    return max(low, first + ENDS * (last - first)), min(high, last - ENDS * (last - first))


def _is_offered(cause: Candidate, machine: Calibration) -> bool:
    """Whether an effect of the kernel makes sense here: its result is measured, and what is to turn goes round."""
    covariates, effect = machine.records.covariates, cause.effect
    if effect is None or not gauged(cause, machine.records.measured):
        return False
    own = [covariates[name] for name in effect.reads if name in covariates]
    return not may_stand(effect) or any(not is_angle(covariate.unit) or covariate.goes_round for covariate in own)


def _stands_still(effect: Effect[Any, Any], machine: Calibration) -> bool:
    """Whether nothing that an effect follows has moved; one that acts at the references follows nothing."""
    if effect.acts_at_reference:
        return False
    covariates = machine.records.covariates
    names = [*(need.name for need in effect.needs), *effect.reads]
    return bool(names) and all(name not in covariates or covariates[name].is_constant for name in names)


def inputs_of(machine: Calibration) -> list[Candidate]:
    """Return every tolerated input that moves a measured result, as a cause that shifts it by standard deviations."""
    return [
        Candidate(
            INPUT + tolerated.name,
            f"{INPUT}{tolerated.name}.{tolerated.file}",
            (Parameter(tolerated.name, -inf, inf),),
            tolerated=index,
        )
        for index, tolerated in enumerate(machine.inputs)
        if any(np.any(slopes[:, index]) for slopes in machine.slopes.values())
    ]


def idle_of(machine: Calibration) -> tuple[str, ...]:
    """Return the names of effects that nothing in this record excites, and of which it is worth saying so."""
    model, names = machine.start.model, []
    for effect in model.known_effects.values():
        if effect.name in machine.on or any(need.name in machine.records.absent for need in effect.needs):
            continue
        followed = "" if effect.name in model.effects else followed_by(effect)
        if _stands_still(effect, machine) and (not followed or followed in machine.records.covariates):
            names.append(effect.name)
    return tuple(names)


def at_rest(cause: Candidate, machine: Calibration) -> dict[str, float]:
    """Return every unknown of the effect of a cause where it does nothing: no amplitude, any shape."""
    effect = cause.effect
    if effect is None:
        return {}
    before = machine.on.get(effect.name, {})
    own = {number.name for number in cause.numbers}
    takes_any = effect.parts and effect.takes_any
    resting = [each for each in effect.unknowns if (each.name in own if takes_any else each.name not in before)]
    return {each.name: 0.0 if each.is_amplitude else si_bounds(each)[0] for each in resting}


def failure_of(machine: Calibration, cause: Candidate) -> str:
    """Return why the model fails with an effect that is hardly there, in some row that was measured; else nothing."""
    if cause.effect is None or reading_of(cause.effect) is not None:
        return ""
    rest = at_rest(cause, machine)
    measured = np.logical_or.reduce([np.isfinite(values) for values in machine.records.measured.values()])
    for number in cause.numbers:
        for end in filter(None, (number.low, number.high)) if number.is_amplitude else ():
            on = SwitchedOn(cause.effect, {**rest, number.name: LITTLE * end})
            setup = machine.start.with_effects([on])
            try:
                reasons = read_by_gauge(setup, machine.records.rows, tuple(machine.records.measured)).reasons
            except PluginError as error:
                return f"the model fails with it: {error}"
            row = next((row for row in sorted(reasons) if measured[row]), None)
            if row is not None:
                records = machine.records
                source_line = f"{PurePath(records.files[records.file_of[row]]).name}:{records.lines[row]}"
                return f"the model fails with it, in {source_line} as the first row: {reasons[row]}"
    return ""


def are_exclusive(causes: Sequence[Candidate]) -> bool:
    """Whether causes cannot stand beside one another: two shapes of one kind over the same, one effect's same part."""
    shapes = [cause.shape for cause in causes if cause.shape is not None]
    kinds = [(shape.kind, shape.depends_on) for shape in shapes if shape.kind != "wave"]
    return len(kinds) != len(set(kinds)) or len({cause.tag for cause in causes}) != len(causes)
