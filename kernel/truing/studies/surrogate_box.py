"""The box of a surrogate: over what it was made, how it is sampled, and what lies outside.

A feature is an input, a condition, or a formula in them. A formula stands where the difference of two inputs matters
more than either, as a clearance does: the one input in it that is sampled in no other way follows, so that the formula
takes the sampled value. The formula has to be straight in that input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.near_miss import near_miss
from truing.errors import DeclarationError, UnitError, UsageError
from truing.formulas import Formula, evaluate, evaluate_quantities, parse
from truing.setup import Setup
from truing.studies.reading import read_range
from truing.units import pint_quantity, split_quantity, unit_factor

STEPS = 3
STRAIGHT_TO = 1e-9


@dataclass(frozen=True)
class Feature:
    """One direction of the box: a formula (often a single name), its range in SI, and the input that is set for it."""

    name: str
    formula: Formula
    sets: str
    low: float
    high: float
    unit: str
    step: float
    logarithmic: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the feature is an input or a condition itself."""
        return self.name == self.sets

    def value(self, shares: Any) -> Any:
        """Return values (SI) from places between 0 and 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** shares
        return self.low + (self.high - self.low) * shares

    def place(self, values: Any) -> Any:
        """Return places, 0 to 1 inside the range; NaN where a logarithm does not exist."""
        if not self.logarithmic:
            return (values - self.low) / (self.high - self.low)
        with np.errstate(all="ignore"):
            return np.where(values > 0, np.log(values / self.low) / np.log(self.high / self.low), np.nan)


@dataclass(frozen=True)
class Box:
    """The features, and the value (SI) that every number has in the run by name of input or condition."""

    features: tuple[Feature, ...]
    held: Mapping[str, float]

    def sampled(self, shares: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Return the columns (n,) of a batch from places (n, d), 0 to 1. Raises UsageError for a bent formula."""
        columns: dict[str, Any] = {}
        for place, feature in sorted(enumerate(self.features), key=lambda item: not item[1].is_plain):
            columns[feature.sets] = self._solved(feature, feature.value(shares[:, place]), columns)
        return columns

    def places(self, columns: Mapping[str, Any]) -> NDArray[np.float64]:
        """Return the places (n, d) of calculations; what no column holds is as in the run.

        Columns are numbers or arrays (n,) in SI. Raises UsageError for one that the surrogate does not follow.
        """
        rows = max((np.size(values) for values in columns.values()), default=1)
        self._demand_known(columns)
        values = {**self.held, **columns}
        places = [feature.place(evaluate(feature.formula, values)) for feature in self.features]
        return np.column_stack([np.broadcast_to(place, (rows,)) for place in places])

    def outside(self, columns: Mapping[str, Any]) -> NDArray[np.bool_]:
        """Say per calculation (n,) whether it lies outside the box, where nothing was learnt."""
        places = self.places(columns)
        within = (places >= -STRAIGHT_TO) & (places <= 1 + STRAIGHT_TO)
        return np.asarray(~within.all(axis=1))

    def passed(self) -> tuple[str, ...]:
        """Name the features in which the run itself lies outside the box."""
        places = self.places({})[0]
        inside = (places >= -STRAIGHT_TO) & (places <= 1 + STRAIGHT_TO)
        return tuple(item.name for item, is_inside in zip(self.features, inside, strict=True) if not is_inside)

    def _demand_known(self, columns: Mapping[str, Any]) -> None:
        followed = {name for feature in self.features for name in feature.formula.names}
        for name, values in columns.items():
            if name in followed:
                continue
            if name not in self.held:
                raise UsageError(f"the surrogate knows no '{name}'.{near_miss(name, self.held)}")
            if not np.allclose(values, self.held[name], rtol=1e-12, atol=0.0, equal_nan=True):
                raise UsageError(f"the surrogate was made for one value of '{name}'; name it in over to vary it")

    def _solved(self, feature: Feature, wanted: Any, columns: Mapping[str, Any]) -> Any:
        """Return the values of the input with which a formula takes the values that are wanted."""
        if feature.is_plain:
            return wanted
        values: dict[str, Any] = {**self.held, **columns}
        found = np.full(np.shape(wanted), self.held[feature.sets])

        def missing(tried: Any) -> Any:
            return wanted - evaluate(feature.formula, {**values, feature.sets: tried})

        for _ in range(STEPS):
            short = missing(found)
            slope = (short - missing(found + feature.step)) / feature.step
            with np.errstate(all="ignore"):
                found = found + short / slope
        if not np.all(np.abs(missing(found)) <= STRAIGHT_TO * (feature.high - feature.low)):
            raise UsageError(f"the formula '{feature.name}' is not straight in '{feature.sets}', which follows from it")
        return found


def open_box(setup: Setup, over: Mapping[str, str], logarithmic: Sequence[str], study: str) -> Box:
    """Read the ranges of the features. Raises UsageError with one sentence for a name or range that cannot be."""
    for name in logarithmic:
        if name not in over:
            raise UsageError(f"study '{study}': '{name}' is logarithmic but not in over.{near_miss(name, over)}")
    held = _held(setup)
    read = {text: _parsed(text, held, setup, study) for text in over}
    plain = {text for text, formula in read.items() if formula.names == {text}}
    features = []
    taken = set(plain)
    for text, formula in read.items():
        sets = text if text in plain else _free(formula, taken, study)
        taken.add(sets)
        low, high, unit = _range(setup, formula, over[text], study)
        if text in logarithmic and low <= 0:
            raise UsageError(f"study '{study}': '{text}' is logarithmic, so its range {over[text]} must lie above 0")
        step = abs(held[sets]) or setup_step(setup, sets)
        features.append(Feature(text, formula, sets, low, high, unit, step, text in logarithmic))
    return Box(tuple(features), held)


def setup_step(setup: Setup, name: str) -> float:
    """Return one unit of an input or condition in SI, where its value says nothing about its size."""
    return unit_factor(setup.unit_of(name))


def _held(setup: Setup) -> dict[str, float]:
    """Return the value of every number that may vary in a batch; one left open is NaN."""
    names = [name for name, item in setup.model.input_fields.items() if item.varies]
    values = {name: setup.nominal(name) for name in (*names, *setup.conditions)}
    return {name: float("nan") if value is None else float(value) for name, value in values.items()}


def _parsed(text: str, held: Mapping[str, float], setup: Setup, study: str) -> Formula:
    try:
        formula = parse(text)
    except DeclarationError as error:
        raise UsageError(f"study '{study}': {error}") from error
    if not formula.names or formula.left is not None:
        raise UsageError(f"study '{study}': '{text}' is neither an input, a condition nor a formula in them")
    for name in sorted(formula.names):
        if name not in held:
            raise UsageError(
                f"study '{study}': '{name}' is no number among the inputs of {setup.model.name}.{near_miss(name, held)}"
            )
        item = setup.model.input_fields.get(name)
        if item is not None and item.kind == "whole":
            raise UsageError(f"study '{study}': '{name}' takes whole numbers; a surrogate needs what lies between them")
    return formula


def _free(formula: Formula, taken: set[str], study: str) -> str:
    """Return the one input of a formula that is sampled in no other way."""
    free = sorted(formula.names - taken)
    if len(free) != 1:
        named = " and ".join(free) or "none"
        raise UsageError(
            f"study '{study}': of the formula '{formula.text}' one input must be left to follow, but here it is "
            f"{named}; give the others a range of their own"
        )
    return free[0]


def _range(setup: Setup, formula: Formula, text: str, study: str) -> tuple[float, float, str]:
    """Read "low..high unit"; a formula is printed in the unit of its range."""
    if text.count("..") != 1:
        raise UsageError(f"study '{study}': '{text}' is no range; write \"1000..4500 N*m\"")
    unit = setup.unit_of(formula.text) if formula.names == {formula.text} else _unit_of(setup, formula, text, study)
    low, high = read_range(text, unit, 2)
    if not low < high:
        raise UsageError(f"study '{study}': the range {text} of '{formula.text}' must rise")
    return float(low), float(high), unit


def _unit_of(setup: Setup, formula: Formula, text: str, study: str) -> str:
    """Return the unit in which the range of a formula is written, proven to be one of its own."""
    try:
        unit = split_quantity(text.rpartition("..")[2]).unit
        quantities = {name: pint_quantity(1.0, setup.unit_of(name)) for name in formula.names}
        own = evaluate_quantities(formula, quantities)
        if own.dimensionality != pint_quantity(1.0, unit).dimensionality:
            raise UnitError(f"the range {text} has another dimension than '{formula.text}'")
    except UnitError as error:
        raise UsageError(f"study '{study}': {error}") from error
    return unit
