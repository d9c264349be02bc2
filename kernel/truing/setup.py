"""A calculation ready to run: a model with checked inputs and everything the inputs file decided."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isnan
from typing import Any, Self

import numpy as np

from truing.declare.correlations import Correlated
from truing.declare.fields import read, with_values
from truing.declare.model import Model, Study
from truing.declare.near_miss import near_miss
from truing.declare.sources import Effect, Unknown
from truing.declare.spreads import Distribution, Off, Spread, Target, settled
from truing.errors import UsageError
from truing.kernel import Added, Origin
from truing.templating import ENGLISH, demand_language
from truing.units.systems import UNIT_SYSTEMS, UnitSystem, in_system

DEFAULT_SEED = 0


def effect_column(effect: str, unknown: str) -> str:
    """Return the column name of an effect's unknown."""
    return f"effects.{effect}.{unknown}"


@dataclass(frozen=True)
class SwitchedOn:
    """An effect that is on: its unknowns in SI, and their standard deviations and covariance where diagnosed.

    Of an effect with parts, ``values`` may hold those of some parts alone.
    """

    effect: Effect[Any, Any]
    values: Mapping[str, float]
    sds: Mapping[str, float] = field(default_factory=dict)
    covariance: tuple[tuple[float, ...], ...] = ()

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The unknowns that are stated, in the order declared, which is that of the covariance; other parts are off."""
        return tuple(unknown for unknown in self.effect.unknowns if unknown.name in self.values)

    def joined(self, other: SwitchedOn) -> SwitchedOn:
        """Return the effect with the unknowns of both, those of the other where both state one."""
        return SwitchedOn(self.effect, {**self.values, **other.values}, {**self.sds, **other.sds})


@dataclass(frozen=True, kw_only=True)
class DiagnoseOptions:
    """What is asked of a diagnosis.

    ``per_file`` names effects, single unknowns ("effect.unknown") and inputs that every file has for itself.
    ``hold_out`` marks rows that only judge, "column = word". ``box`` holds the range (SI) in which an input or
    condition can be set for the next measurement, where it is not the declared one. ``budget`` is how many calls of the
    model the search may make; 0 leaves it to how long a call takes.
    By result, ``at_least`` and ``at_most`` mark rows ("column = word") whose true value lies above or below what was
    read, and ``clipped`` holds the ends of the gauge (SI, infinite where there is none). Results in ``lognormal`` are
    compared as logarithms. ``noise`` holds the standard deviation of one reading (SI) for what is planned before data.
    """

    per_file: tuple[str, ...] = ()
    hold_out: str = ""
    box: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    budget: int = 0
    at_least: Mapping[str, str] = field(default_factory=dict)
    at_most: Mapping[str, str] = field(default_factory=dict)
    clipped: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lognormal: tuple[str, ...] = ()
    noise: Mapping[str, float] = field(default_factory=dict)

    @property
    def held_out(self) -> tuple[str, str]:
        """The column and the word in it that hold a row out."""
        return column_and_word(self.hold_out)

    @property
    def flags(self) -> set[str]:
        """The columns that mark censored readings."""
        return {column_and_word(text)[0] for text in (*self.at_least.values(), *self.at_most.values())}


def column_and_word(text: str) -> tuple[str, str]:
    """Return the two of "column = word"."""
    column, _, word = text.partition("=")
    return column.strip(), word.strip()


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is calculated: a model with its inputs, the conditions (SI) and the effects that act."""

    model: Model[Any, Any]
    inputs: Any
    conditions: Mapping[str, float] = field(default_factory=dict)
    effects: tuple[SwitchedOn, ...] = ()

    def __post_init__(self) -> None:
        """Put the effects in the order in which they act: the model's own as declared, then the kernel's."""
        names = [active.effect.name for active in self.effects]
        own = set(names) <= set(self.model.effects)
        order = list(self.model.effects if own else self.model.known_effects)
        for name in names:
            if name not in order:
                raise UsageError(f"{self.model.name} has no effect '{name}'.{near_miss(name, order)}")
            if names.count(name) > 1:
                raise UsageError(f"the effect '{name}' is switched on twice")
        ordered = sorted(self.effects, key=lambda active: order.index(active.effect.name))
        object.__setattr__(self, "effects", tuple(ordered))

    @cached_property
    def numpy_inputs(self) -> Any:
        """The inputs with numpy's numbers, so that 1/0 is infinite in a call of one value as it is in a batch."""
        varying = (input_field for input_field in self.model.input_fields.values() if input_field.varies)
        values = ((input_field.path, read(self.inputs, input_field.path)) for input_field in varying)
        numbers = {path: value if isinstance(value, np.ndarray) else np.float64(value) for path, value in values}
        return with_values(self.inputs, numbers)

    @cached_property
    def columns_looked_at(self) -> frozenset[str]:
        """The columns of a batch that the model or an effect that is on looks at."""
        needs = {need.name for on in self.effects for need in on.effect.needs}
        unknowns = {
            effect_column(on.effect.name, unknown.name) for on in self.effects for unknown in on.effect.unknowns
        }
        return frozenset({*self.model.input_fields, *needs, *unknowns})

    def changed(self, values: Mapping[str, Any]) -> Self:
        """Return the case with these inputs and conditions, by name and in SI, in place of its own."""
        fields = self.model.input_fields
        inputs = {fields[name].path: value for name, value in values.items() if name in fields}
        conditions = {name: value for name, value in values.items() if name not in fields}
        return replace(self, inputs=with_values(self.inputs, inputs), conditions={**self.conditions, **conditions})

    def with_effects(self, more: Iterable[SwitchedOn]) -> Self:
        """Return the case with further effects on; parts of one that is on join those that are stated."""
        on = {active.effect.name: active for active in self.effects}
        for active in more:
            before = on.get(active.effect.name)
            on[active.effect.name] = active if before is None else before.joined(active)
        return replace(self, effects=tuple(on.values()))

    def nominal(self, name: str) -> Any:
        """Return the nominal value in SI of an input or condition."""
        input_field = self.model.input_fields.get(name)
        if input_field is not None:
            return read(self.inputs, input_field.path)
        return self.conditions[name] if name in self.conditions else self.model.known_conditions[name].zero

    def unit_of(self, name: str) -> str:
        """Return the declared unit of an input or condition."""
        input_field = self.model.input_fields.get(name)
        return input_field.unit if input_field is not None else self.model.known_conditions[name].unit

    def target(self, name: str) -> Target:
        """Return what a spread needs to know of the input it acts on."""
        return Target(name, float(self.nominal(name)), self.unit_of(name), self.nominal)


@dataclass(frozen=True, kw_only=True)
class InputsSource:
    """Where the inputs come from, for what is said of them; nothing here changes a number.

    ``stated`` names the inputs, conditions and tolerances that are stated; the others have their defaults. ``file`` is
    the inputs file; of an input read from a file, ``files`` holds the SHA-256 of that one and ``tables`` how it is
    read. ``places`` holds file and line of what is stated, by name of input or condition and ``effects.NAME``; "" is
    where the inputs begin. ``added`` are the effects and checks of other plugins. ``units`` holds the units in which
    inputs and conditions are stated, where these are not the declared ones.
    """

    stated: frozenset[str] = frozenset()
    file: str = ""
    files: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    added: tuple[Added, ...] = ()
    warnings: tuple[str, ...] = ()
    places: Mapping[str, tuple[str, int | None]] = field(default_factory=dict, compare=False)
    units: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class NamedColumn:
    """What a column of a measured file is to the model: its name there, and its unit where that is stated, too."""

    name: str
    unit: str | None = None


@dataclass(frozen=True, kw_only=True)
class SheetOptions:
    """What stands at the head of the sheet, by name, and how much of everything: "short", "normal" or "full".

    ``paper`` is what it is printed on, "A4" or "letter"; ``units`` the system of units of all that people read, "SI" or
    "inch", "" for the units that are declared; ``language`` what its words are in, "en" or "de".
    """

    head: Mapping[str, str] = field(default_factory=dict)
    detail: str = "normal"
    paper: str = "A4"
    units: UnitSystem = ""
    language: str = ENGLISH

    def shown(self, unit: str) -> str:
        """Return the unit in which the sheet shows a quantity that has this one elsewhere."""
        return in_system(unit, self.units)


@dataclass(frozen=True, kw_only=True)
class Setup(Case):
    """What one inputs file says, checked, in SI: the case, what scatters about it, and what is asked.

    ``spreads`` holds the tolerances in force and ``calibrated`` the inputs (SI) as a diagnosis fitted them to one
    machine, by name; ``units`` the units in which results are printed, where these are not the declared ones.
    ``columns`` says what columns of files are, by what the files call them.
    ``correlations`` are those in force, stated or declared; one of an input that does not scatter says nothing.
    """

    origin: Origin
    spreads: Mapping[str, Spread] = field(default_factory=dict)
    correlations: tuple[Correlated, ...] = ()
    calibrated: Mapping[str, float] = field(default_factory=dict)
    studies: tuple[Study, ...] = ()
    seed: int = DEFAULT_SEED
    diagnose: DiagnoseOptions = DiagnoseOptions()
    units: Mapping[str, str] = field(default_factory=dict)
    columns: Mapping[str, NamedColumn] = field(default_factory=dict)
    sheet: SheetOptions = SheetOptions()
    source: InputsSource = InputsSource()

    def print_unit(self, name: str) -> str:
        """Return the unit in which a result or input is printed."""
        if name in self.units:
            return self.units[name]
        result = self.model.result_fields.get(name)
        return result.unit if result is not None else self.unit_of(name)

    def stated_unit(self, name: str) -> str:
        """Return the unit in which an input or condition is stated, the declared one where it has its default."""
        return self.source.units.get(name) or self.unit_of(name)

    def settled(self, spread: Spread) -> Spread:
        """Return a spread itself, or of one that follows a choice the branch that is chosen."""
        return settled(spread, self.nominal)

    def spread_of(self, tolerance: str) -> Spread:
        """Return the spread of a tolerance in force, settled where it follows a choice."""
        return self.settled(self.spreads.get(tolerance, self.model.tolerances[tolerance].spread))

    def distributions(self) -> dict[str, dict[str, Distribution]]:
        """Return, by tolerance and input, every scatter that is not off; an input left open does not scatter."""
        distributions: dict[str, dict[str, Distribution]] = {}
        for tolerance in self.model.tolerances.values():
            spread = self.spread_of(tolerance.name)
            if isinstance(spread, Off):
                continue
            targets = [self.target(name) for name in tolerance.on]
            resolved = {target.name: spread.resolve(target) for target in targets if not isnan(target.nominal)}
            kept = {name: distribution for name, distribution in resolved.items() if distribution is not None}
            if kept:
                distributions[tolerance.name] = kept
        return distributions

    def scattering_together(self) -> tuple[Correlated, ...]:
        """Return the correlations of inputs that scatter, also those that are stated to be 0."""
        if not self.correlations:
            return ()
        scattering = {name for by_input in self.distributions().values() for name in by_input}
        return tuple(each for each in self.correlations if each.pair <= scattering)


def sheet_in(setup: Setup, *, units: str = "", language: str = "") -> Setup:
    """Return a setup with its sheet in these units and this language; "" leaves what it has.

    Raises UsageError for units or a language that are not known.
    """
    demand_language(language)
    systems = {str(system): system for system in UNIT_SYSTEMS}
    if units and units not in systems:
        raise UsageError(f"units: choose {' or '.join(systems)}, not '{units:.40}'.")
    sheet = setup.sheet
    return replace(
        setup, sheet=replace(sheet, units=systems.get(units, sheet.units), language=language or sheet.language)
    )


def default_setup(model: Model[Any, Any], origin: Origin | None = None, **values: Any) -> Setup:
    """Return the model at its defaults, with some inputs replaced (texts carry units)."""
    origin = origin or Origin(model.name, "", "", "", f"entry:{model.name}")
    conditions = {name: condition.zero for name, condition in model.conditions.items()}
    return Setup(
        model=model,
        origin=origin,
        inputs=model.inputs(**values),
        source=InputsSource(stated=frozenset(values)),
        spreads={name: tolerance.spread for name, tolerance in model.tolerances.items()},
        correlations=model.correlations,
        conditions=conditions,
        studies=tuple(model.studies),
    )
