"""How a hidden record is taken: which columns vary, between which ends, and where each row lies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from truing.declare.fields import Axis
from truing.declare.goals import Vary
from truing.declare.near_miss import near_miss
from truing.declare.sources import SINCE_START, Condition, Effect, Tolerance
from truing.errors import TruingError, UsageError
from truing.evaluate import evaluate
from truing.inputs_file.values import broken_bound
from truing.measurements.table import WORDS, read_word
from truing.setup import Setup
from truing.studies.reading import read_range
from truing.studies.sweep import Sweep
from truing.units import from_si, split_quantity, to_si

USUAL = {"time": "0..24 h", "temperature": "15..35 degC", "angle": "0..360 deg"}
"""The ranges of the kernel's own conditions, which no model declares."""
STEPS = 100_000
"""A range is written in so many steps: as fine as any gauge, and short to read."""
RUN = "run"


@dataclass(frozen=True)
class DesignColumn:
    """A column that varies: the unit in its header, its ends (or the ``levels`` it takes) in that unit.

    One that ``rises`` goes from end to end with the rows, as a clock does; one that ``places`` the rows on an axis does
    so in every run. ``words`` are the values of a choice.
    """

    name: str
    unit: str
    low: float = 0.0
    high: float = 0.0
    levels: tuple[float, ...] = ()
    words: tuple[str, ...] = ()
    rises: bool = False
    places: bool = False
    whole: bool = False

    def at(self, shares: NDArray[np.float64]) -> Any:
        """Return the values (n,) at these shares of the range, 0 to 1."""
        if self.words or self.levels:
            chosen: Any = np.array(self.words or self.levels, dtype=object if self.words else float)
            return chosen[np.minimum((shares * len(chosen)).astype(int), len(chosen) - 1)]
        values = self.low + (self.high - self.low) * shares
        decimals = 0 if self.whole else -math.floor(math.log10((self.high - self.low) / STEPS))
        return np.clip(np.round(values, decimals), self.low, self.high)


@dataclass(frozen=True)
class RecordDesign:
    """How many rows in how many runs, and what varies. Where a result runs along an axis every run is a record."""

    columns: tuple[DesignColumn, ...]
    rows: int
    runs: int

    @property
    def is_record(self) -> bool:
        """Whether the rows of a run are places on an axis."""
        return any(column.places for column in self.columns)

    def drawn(self, rng: np.random.Generator) -> dict[str, Any]:
        """Return the columns by header, as they are written: space-filling, and in the order of the clock."""
        count = self.rows * self.runs
        spread = [column for column in self.columns if not (column.rises or column.places)]
        points = self.runs if self.is_record else count
        shares = qmc.Halton(max(len(spread), 1), seed=rng).random(points)
        shares = np.repeat(shares, self.rows, axis=0) if self.is_record else shares
        found: dict[str, Any] = {RUN: np.repeat(np.arange(1, self.runs + 1), self.rows)} if self.runs > 1 else {}
        clock = (np.arange(count) + rng.random(count)) / count
        for column in self.columns:
            if column.places:
                own = np.tile(np.linspace(0.0, 1.0, self.rows), self.runs)
            else:
                own = clock if column.rises else shares[:, spread.index(column)]
            found[f"{column.name} [{column.unit or '1'}]" if not column.words else column.name] = column.at(own)
        return found


def columns_of(
    setup: Setup, effect: Effect[Any, Any] | None, measured: Sequence[str], over: Mapping[str, Any] | None
) -> tuple[list[DesignColumn], list[str]]:
    """Return the columns that vary, and what is wrong with what was asked for, a sentence each.

    ``over`` names them all; without it they are what the effect needs and what is declared to vary. The axis of a
    measured result is a column in any case.
    """
    asked: dict[str, Any] = dict(over) if over is not None else dict(_by_default(setup, effect))
    for axis in _axes(setup, measured):
        asked.setdefault(axis, _whole_axis(setup, axis))
    columns, faults = [], []
    for name, said in asked.items():
        try:
            columns.append(_column(setup, name, said, measured))
        except TruingError as error:
            faults.append(f"over, '{name}': {error}")
    faults += _not_varied(setup, effect, set(asked), is_stated=over is not None)
    if not columns and not faults:
        faults.append('nothing varies: say what is set from row to row, over={"load": "10..90 N"}')
    return columns, faults


def _by_default(setup: Setup, effect: Effect[Any, Any] | None) -> Iterator[tuple[str, str]]:
    """Give what is declared to vary, and what the effect needs.

    What a study sweeps over varies in use; only where none does it is what may be chosen (``Vary``), unless that is
    made once, which its tolerance says.
    """
    yield from dict(_swept(setup) or _chosen(setup)).items()
    for condition in effect.needs if effect is not None else ():
        said = usual_range(condition)
        if said and condition.made_from in {"", condition.name}:
            yield condition.name, said


def _swept(setup: Setup) -> list[tuple[str, str]]:
    """Return the ranges over which the model's studies sweep."""
    known = {*setup.model.input_fields, *setup.model.known_conditions}
    sweeps = [study for study in setup.model.studies if isinstance(study, Sweep)]
    return [(study.over, study.at) for study in sweeps if study.over in known and study.at]


def _chosen(setup: Setup) -> list[tuple[str, str]]:
    """Return the ranges of what may be chosen and has no tolerance."""
    model = setup.model
    made = {name for source in model.errors if isinstance(source, Tolerance) for name in source.on}
    goals = [goal for goal in model.objectives if isinstance(goal, Vary) and not goal.by and goal.input not in made]
    fields = model.input_fields
    return [(goal.input, f"{goal.low}..{goal.high}") for goal in goals if fields[goal.input].kind == "float"]


def usual_range(condition: Condition) -> str:
    """Return the range of a condition that is declared, or usual for one of the kernel's, or nothing."""
    if condition.low is not None and condition.high is not None:
        return f"{condition.low}..{condition.high} {condition.unit}".strip()
    return USUAL.get(condition.name, "")


def _axes(setup: Setup, measured: Sequence[str]) -> Iterator[str]:
    """Give the axes that the measured results run along."""
    fields = setup.model.own_result_fields
    for name in measured:
        item = fields[name]
        if item.along:
            own = f"{item.along}_{item.scope}"
            yield own if own in fields else item.along


def _whole_axis(setup: Setup, axis: str) -> str:
    """Return the range of an axis at the defaults."""
    unit = setup.model.own_result_fields[axis].unit
    places = from_si(np.asarray(setup.model.read_results(evaluate(setup))[axis], dtype=float), unit)
    return f"{float(np.min(places))!r}..{float(np.max(places))!r} {unit}".strip()


def _column(setup: Setup, name: str, said: Any, measured: Sequence[str]) -> DesignColumn:
    """Read one range, or the values that a column takes. Raises UsageError with a sentence."""
    model = setup.model
    item = model.input_fields.get(name)
    if item is not None and item.kind in WORDS:
        return _words(item, said)
    unit = _unit_of(setup, name, measured)
    if unit is None:
        known = [*model.input_fields, *model.known_conditions, *_sources(setup)]
        raise UsageError(f"{model.name} has no input or condition of that name.{near_miss(name, known)}")
    if item is not None and item.kind not in {"float", "whole"}:
        raise UsageError("a file or a series cannot change from row to row")
    low, high, levels, shown = _ends(said, unit)
    if item is not None:
        _demand_bounds(item, [low, high, *levels], shown)
    return DesignColumn(
        name, shown, low, high, levels,
        rises=name == "time" or _is_counted(setup, name),
        places=name in set(_axes(setup, measured)),
        whole=item is not None and item.kind == "whole",
    )  # fmt: skip


def _ends(said: Any, unit: str) -> tuple[float, float, tuple[float, ...], str]:
    """Read "low..high unit" or "a, b, c unit" in the unit in which it is written, checked against the declared one."""
    text = said if isinstance(said, str) else ", ".join(str(one) for one in said)
    values = read_range(text, unit, 2)
    shown = split_quantity(text.replace("..", ",").split(",")[-1].strip()).unit or unit
    written = [float(f"{float(from_si(float(value), shown)):.12g}") for value in values]
    if ".." not in text:
        return min(written), max(written), tuple(written), shown
    low, high = written
    if not low < high:
        raise UsageError(f"it goes from {low:g} to {high:g} {shown}: lower end first".rstrip())
    return low, high, (), shown


def _words(item: Any, said: Any) -> DesignColumn:
    """Read the values of a choice, a switch or a whole number. Raises UsageError with a sentence."""
    words = [word.strip() for word in said.split(",")] if isinstance(said, str) else [str(word) for word in said]
    for word in words:
        try:
            read_word(item, word, decimal_comma=False)
        except ValueError as error:
            raise UsageError(str(error)) from error
    return DesignColumn(item.name, "", words=tuple(words))


def _demand_bounds(item: Any, ends: Sequence[float], unit: str) -> None:
    """Raise UsageError where a range leaves the bounds of an input."""
    for end in ends:
        broken = broken_bound(item, float(to_si(end, unit)))
        if broken:
            raise UsageError(broken)


def _unit_of(setup: Setup, name: str, measured: Sequence[str]) -> str | None:
    """Return the declared unit of a column, None where nobody knows it."""
    model = setup.model
    if name in model.input_fields:
        return model.input_fields[name].unit
    if name in model.known_conditions:
        return model.known_conditions[name].unit
    if name in set(_axes(setup, measured)):
        return model.own_result_fields[name].unit
    return _sources(setup).get(name)


def _sources(setup: Setup) -> dict[str, str]:
    """Return the columns from which conditions are made that are neither input nor condition, with their units."""
    model = setup.model
    made = [item for item in model.known_conditions.values() if item.made_from and item.history != "direction"]
    found = {item.made_from: item.unit for item in made}
    axes = {name: item.unit for name, item in model.own_result_fields.items() if isinstance(item.spec, Axis)}
    found |= {item.made_from: "" for item in model.known_conditions.values() if item.history == "direction"} | found
    return {name: unit for name, unit in found.items() if name not in axes}


def _is_counted(setup: Setup, name: str) -> bool:
    condition = setup.model.known_conditions.get(name)
    return condition is not None and condition.history == SINCE_START


def _not_varied(setup: Setup, effect: Effect[Any, Any] | None, asked: set[str], *, is_stated: bool) -> Iterator[str]:
    """Say which columns an effect needs and nobody varies, one sentence each: without them it cannot be found."""
    missing: dict[str, list[Condition]] = {}
    for condition in effect.needs if effect is not None else ():
        if condition.name not in asked and condition.made_from not in asked:
            missing.setdefault(condition.made_from or condition.name, []).append(condition)
    for source, conditions in missing.items():
        names = " and ".join(f"'{condition.name}'" for condition in conditions)
        made = f" (made from '{source}')" if source != conditions[0].name else ""
        unit = _unit_of(setup, source, ()) or ""
        usual = usual_range(conditions[0]) if not made else ""
        why = "over does not vary it" if is_stated else "no range is declared for it"
        yield (
            f"effect '{effect.name if effect else ''}' needs {names}{made}, and {why}: "
            f'add "{source}": "{usual or f"LOW..HIGH {unit}".strip()}" to over'
        )
