"""A zoo of machines that nobody tuned to: what a rig gives, what noise does to it, and how an answer is judged.

A family is a calculation in ``plugins/``, as a stranger would write it, and a machine in ``rigs/`` by physics of its
own. A case is one record of one machine, registered or not, under one noise. ``families`` parts them in two by a fixed
rule: one half may be looked at, the other is only measured.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from truing import Condition, Effect, Model, Unknown
from truing.diagnosis.result import UNKNOWN, DiagnosisResult, explanations_of
from truing.testing import Hidden, recorded
from truing.testing.hiding import csv_of

Array: TypeAlias = NDArray[np.float64]
Columns: TypeAlias = Mapping[str, Array]
"""By header ``name [unit]`` in the order of the file, each of shape (rows,); what was measured stands last."""
Half: TypeAlias = Literal["open", "sealed"]
Judged: TypeAlias = Literal["right", "open", "silent", "partly", "wrong"]

FOLDER = Path(__file__).parent
HALVES: tuple[Half, ...] = ("open", "sealed")
ROWS = 150
"""Rows of a record before any of them go missing."""
SMALLEST, LARGEST = 4.0, 30.0
"""How large what is hidden is at its largest place, in standard deviations of the noise: clearly visible to large."""


@dataclass(frozen=True)
class Measured:
    """A record without noise, the header of what was measured, and the standard deviation of an honest gauge of it."""

    columns: Columns
    result: str
    noise: float


class Rig(Protocol):
    """The module of a machine: what can be hidden, with the effects that are a right answer together; a record."""

    @property
    def HIDDEN(self) -> Mapping[str, tuple[str, ...]]: ...  # noqa: N802  # a constant of the module
    @property
    def NOISE(self) -> float: ...  # noqa: N802
    def measure(self, hidden: str | None, generator: np.random.Generator, rows: int) -> Columns: ...


def hideable(**effects: str) -> dict[str, tuple[str, ...]]:
    """What can be hidden: two effects by names of their own, each alone, and both."""
    singles = {name: (effect,) for name, effect in effects.items()}
    return {**singles, "_and_".join(effects): tuple(effects.values())}


def acting(
    function: Callable[..., Any], *unknowns: Unknown, needs: Sequence[Condition] = (), on: str = "inputs", **more: Any
) -> Effect[Any, Any]:
    """An effect by its function: its name, the reason that it states, and what it acts on."""
    why = (function.__doc__ or "").strip()
    return Effect(function.__name__, **{f"on_{on}": function}, unknowns=unknowns, needs=needs, why=why, **more)


def drawn_size(generator: np.random.Generator) -> float:
    """Draw how large something hidden is, in standard deviations of the noise: even on a logarithmic scale."""
    return float(np.exp(generator.uniform(np.log(SMALLEST), np.log(LARGEST))))


def sized(
    shown: Callable[[float], Array], plain: Array, size: float, high: float, *, low: float = 0.0, rtol: float
) -> float:
    """Find the strength at which what is shown lies off what it is plainly by a size, at its largest place."""

    def off(strength: float) -> float:
        return float(np.max(np.abs(shown(strength) - plain))) - size

    return float(brentq(off, low, high, rtol=rtol))


# Noise


def _white(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """Independent and normal."""
    return values + noise * generator.standard_normal(len(values))


def _drift(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """White noise on a smooth wander as large as it, with a memory of a tenth of the record."""
    places = np.arange(len(values))
    kernel = np.exp(-0.5 * ((places[:, None] - places) / (0.1 * len(values))) ** 2)
    wander = kernel @ generator.standard_normal(len(values)) / np.sqrt(np.sum(kernel**2, axis=1))
    return np.asarray(_white(values, noise, generator) + noise * wander)


def _quantised(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """White noise, read in steps of 1.5 standard deviations."""
    return np.asarray(1.5 * noise * np.round(_white(values, noise, generator) / (1.5 * noise)))


def _skewed(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """A gamma distribution of shape 2 about its mean: a skewness of 1.41."""
    return np.asarray(values + noise * (generator.gamma(2.0, size=len(values)) - 2.0) / np.sqrt(2.0))


def _heavy(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """Student's t with 2.5 degrees of freedom, of the standard deviation of the gauge."""
    return np.asarray(values + noise * generator.standard_t(2.5, len(values)) / np.sqrt(2.5 / 0.5))


def _outliers(values: Array, noise: float, generator: np.random.Generator) -> Array:
    """White noise, with 3 % of the rows off by 15 standard deviations to either side."""
    shown = _white(values, noise, generator)
    off = generator.permutation(len(values))[: max(1, round(0.03 * len(values)))]
    shown[off] += 15 * noise * generator.choice((-1.0, 1.0), len(off))
    return shown


READINGS: Mapping[str, Callable[[Array, float, np.random.Generator], Array]] = MappingProxyType(
    {
        "white": _white,
        "drift": _drift,
        "quantised": _quantised,
        "skewed": _skewed,
        "heavy": _heavy,
        "outliers": _outliers,
        "missing": _white,
        "shuffled": _white,
        "thinned": _white,
    }
)
"""What the gauge does to the readings, by the name of the noise; the last three act on the rows as well."""
NOISES = tuple(READINGS)


def _kept(noise: str, rows: int, generator: np.random.Generator) -> NDArray[np.intp]:
    """The places of the rows that the file holds, in its order."""
    if noise == "missing":
        return np.sort(generator.permutation(rows)[: round(0.7 * rows)])
    if noise == "shuffled":
        return generator.permutation(rows)
    return np.arange(0, rows, 3 if noise == "thinned" else 1)


# Cases


@dataclass(frozen=True)
class Case:
    """One record: a family, what is hidden in it (None: nothing), whether that is registered, the noise, the seed."""

    family: str
    hidden: str | None
    registered: bool
    noise: str
    seed: int


def half_of(family: str) -> Half:
    """The half of a family, by its name alone."""
    return HALVES[zlib.crc32(family.encode()) % 2]


def families(half: Half | None = None) -> tuple[str, ...]:
    """The families of a half, or all, that have both a plugin and a rig."""
    both = {file.stem for file in (FOLDER / "plugins").glob("[a-z]*.py")}
    both &= {file.stem for file in (FOLDER / "rigs").glob("[a-z]*.py")}
    return tuple(sorted(name for name in both if half in (None, half_of(name))))


def rig_of(family: str) -> Rig:
    """The machine of a family."""
    return cast(Rig, import_module(f"zoo.rigs.{family}"))


@cache
def model_of(family: str, without: tuple[str, ...] = ()) -> Model[Any, Any]:
    """The calculation of a family, without some of its effects."""
    known = vars(import_module(f"zoo.plugins.{family}")).values()
    model = next(one for one in known if isinstance(one, Model))
    return replace(model, errors=[item for item in model.errors if item.name not in without]) if without else model


def can_be_unregistered(family: str, hidden: str) -> bool:
    """Whether taking the right effects out leaves no other name for them: the kernel's gauge effects always stay."""
    effects = model_of(family).effects
    return all(name in effects and effects[name].place != "reading" for name in rig_of(family).HIDDEN[hidden])


def measured_of(case: Case, rows: int = ROWS) -> Measured:
    """The record of a case without noise: the same machine under every noise, registered or not."""
    words = (case.family, case.hidden or "")
    generator = np.random.default_rng([case.seed, *(zlib.crc32(word.encode()) for word in words)])
    rig = rig_of(case.family)
    columns = rig.measure(case.hidden, generator, rows)
    return Measured(columns, list(columns)[-1], rig.NOISE)


def record_of(case: Case, rows: int = ROWS) -> str:
    """The file of a case: CSV with units in the header, every digit kept."""
    measured = measured_of(case, rows)
    words = (case.family, case.noise, "noise")
    generator = np.random.default_rng([case.seed, *(zlib.crc32(word.encode()) for word in words)])
    shown = READINGS[case.noise](measured.columns[measured.result], measured.noise, generator)
    columns = {**measured.columns, measured.result: shown}
    kept = _kept(case.noise, rows, generator)
    return csv_of({name: values[kept] for name, values in columns.items()})


def hidden_of(case: Case, rows: int = ROWS) -> Hidden:
    """The record of a case as the kit takes it, with the calculation that a diagnosis is to read it by."""
    out = () if case.registered or case.hidden is None else rig_of(case.family).HIDDEN[case.hidden]
    model = model_of(case.family, tuple(out))
    return recorded(model, inputs=f'plugin = "{case.family}"\n', measured=record_of(case, rows))


def diagnosis_of(case: Case, rows: int = ROWS) -> DiagnosisResult:
    """Diagnose the record of a case."""
    return hidden_of(case, rows).answered.diagnosis


# Judging


@dataclass(frozen=True)
class Verdict:
    """How an answer is judged, the word of the diagnosis, and the explanations that it leaves."""

    judged: Judged
    said: str
    explanations: tuple[tuple[str, ...], ...]


def judged(case: Case, diagnosis: DiagnosisResult) -> Verdict:
    """Judge a diagnosis by what is hidden."""
    explanations = explanations_of(diagnosis)
    sets = [frozenset(_plain(name) for name in names) for names in explanations]
    return Verdict(judgement(_truth(case), diagnosis.verdict, sets), diagnosis.verdict, explanations)


def _plain(name: str) -> str:
    """The name of an explanation; every shape that nobody registered has one."""
    return UNKNOWN if name.startswith(UNKNOWN) else name


def _truth(case: Case) -> frozenset[str]:
    """What should be named."""
    if case.hidden is None:
        return frozenset()
    return frozenset(rig_of(case.family).HIDDEN[case.hidden] if case.registered else (UNKNOWN,))


def judgement(truth: frozenset[str], verdict: str, sets: Sequence[frozenset[str]]) -> Judged:
    """Judge a verdict with the explanations it leaves, as sets of names, by the names that should stand there.

    right: the truth alone is left; "none" where nothing is hidden; "unknown" where what is hidden is not registered.
    open: the truth is among those left; where nothing is hidden: undecided without any. silent: none is left although
    something is hidden. partly: each is a part of the truth, or the truth and more. wrong: anything else; so is a cause
    where nothing is hidden, and "unknown" where what is hidden is registered.
    """
    if not sets:
        if truth:
            return "silent"
        return "right" if verdict == "none" else "open"
    if truth in sets:
        return "right" if verdict in ("named", "unknown") else "open"
    is_part = [bool(truth & names) and (truth <= names or names <= truth) for names in sets]
    return "partly" if all(is_part) and UNKNOWN not in truth else "wrong"
