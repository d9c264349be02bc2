"""What an optimisation may choose: inputs between bounds, inputs that follow a formula, the widths of what is priced.

A design is a row of numbers, one per variable: an input in SI, the full width of a tolerance in SI, or the place of
its grade in the standard's list. Everything here works on many designs at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, floor, isnan
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import InputField
from truing.declare.goals import Vary
from truing.declare.near_miss import near_miss
from truing.declare.sources import Tolerance
from truing.declare.spreads import Band, Distribution, Grade, Zone
from truing.declare.widths import with_width
from truing.errors import TruingError, UnitError, UsageError
from truing.fits import GRADES
from truing.formulas import Formula, evaluate, parse
from truing.inputs_file.values import broken_bound
from truing.prices import price_of
from truing.setup import Setup
from truing.units import read_quantity

Kind = Literal["number", "whole", "width", "grade"]
SLACK = 1e-9


@dataclass(frozen=True)
class Brief:
    """What is asked of the search beside the model's objectives; plain values, so that a worker can have them."""

    study: str
    vary: tuple[str, ...] = ()
    tightest: float = 1.0
    widest: float = 2.0
    finest: str = "IT5"
    chance: Literal["draws", "first_order"] = "draws"
    draws: int = 4096
    parts: int = 1
    known: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Variable:
    """One thing that may be chosen, between ``low`` and ``high`` (SI, or places of grades), and where it starts."""

    name: str
    kind: Kind
    low: float
    high: float
    unit: str
    start: float

    @property
    def discrete(self) -> bool:
        """Whether it takes whole numbers only."""
        return self.kind in {"whole", "grade"}

    @property
    def is_input(self) -> bool:
        """Whether it is an input; else it is a tolerance."""
        return self.kind in {"number", "whole"}

    @property
    def key(self) -> str:
        """Its name beside all others: that of the input, or ``tolerances.NAME``."""
        return self.name if self.is_input else f"tolerances.{self.name}"


@dataclass(frozen=True)
class Follower:
    """An input that a formula makes follow, in SI."""

    name: str
    formula: Formula
    unit: str


@dataclass(frozen=True, eq=False)
class Space:
    """All variables of one setup, and the inputs that follow, each behind what it follows."""

    setup: Setup
    variables: tuple[Variable, ...]
    followers: tuple[Follower, ...]

    @cached_property
    def scatter(self) -> dict[str, dict[str, Distribution]]:
        """What scatters in the design that the inputs file states, by tolerance and input."""
        return self.setup.distributions()

    @property
    def moved(self) -> frozenset[str]:
        """The inputs that differ between designs."""
        return frozenset(item.name for item in self.variables if item.is_input) | {item.name for item in self.followers}

    @property
    def start(self) -> NDArray[np.float64]:
        """The design that the inputs file states, as a row."""
        return np.array([variable.start for variable in self.variables])

    def designs(self, units: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return designs (m, v) from places in the unit cube; whole variables are at their steps."""
        low, high, discrete = self._ends()
        values = low + units * (high - low)
        return np.where(discrete, np.rint(values), np.clip(values, low, high))

    def units(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places of designs in the unit cube, where they lie outside of it those nearest to them."""
        low, high, _ = self._ends()
        return np.clip((designs - low) / (high - low), 0.0, 1.0)

    def _ends(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        low = np.array([variable.low for variable in self.variables])
        high = np.array([variable.high for variable in self.variables])
        return low, high, np.array([variable.discrete for variable in self.variables])

    def columns(self, designs: NDArray[np.float64], *, as_stated: bool = False) -> dict[str, Any]:
        """Return the nominal inputs (m,) that differ; ``as_stated`` leaves followers as the file states them."""
        fields = self.setup.model.input_fields
        columns: dict[str, Any] = {
            variable.name: designs[:, place] for place, variable in enumerate(self.variables) if variable.is_input
        }
        for follower in self.followers:
            held = {name: self.setup.nominal(name) for name in follower.formula.names}
            stated = self.setup.nominal(follower.name)
            found = stated if as_stated else evaluate(follower.formula, {**held, **columns})
            columns[follower.name] = np.broadcast_to(np.asarray(found, dtype=float), (len(designs),))
        return {
            name: np.rint(values).astype(np.int64) if fields[name].kind == "integer" else values
            for name, values in columns.items()
        }

    def choices(self, designs: NDArray[np.float64]) -> dict[str, tuple[Variable, NDArray[np.float64]]]:
        """Return the tolerances that differ, by name: the variable and its values (m,)."""
        return {
            variable.name: (variable, designs[:, place])
            for place, variable in enumerate(self.variables)
            if not variable.is_input
        }

    def setup_of(self, design: NDArray[np.float64]) -> Setup:
        """Return the setup of one design, as an inputs file would state it."""
        columns = {name: values[0].item() for name, values in self.columns(design[None, :]).items()}
        setup = self.setup.changed(columns)
        spreads = dict(setup.spreads)
        for name, (variable, values) in self.choices(design[None, :]).items():
            spread = setup.spread_of(name)
            if variable.kind == "grade":
                assert isinstance(spread, Grade)  # _of_tolerance has chosen these
                spreads[name] = replace(spread, grade=GRADES[round(values[0])])
            else:
                first = next(iter(self.scatter[name]))
                spreads[name] = with_width(spread, setup.target(first), float(values[0]))
        return replace(setup, spreads=spreads)


def open_space(setup: Setup, brief: Brief) -> Space:
    """Collect what may be chosen. Raises UsageError where there is nothing, or a name or range makes no sense."""
    stated = [item for item in setup.model.objectives if isinstance(item, Vary)]
    inputs = [item for item in stated if not item.by]
    tolerances = [item for item in setup.model.tolerances.values() if price_of(setup, item) is not None]
    _demand_known(setup, brief, {*(item.input for item in inputs), *(item.name for item in tolerances)})

    def kept(name: str) -> bool:
        return not brief.vary or name in brief.vary

    variables = [_of_input(setup, item, brief) for item in inputs if kept(item.input)]
    found = (_of_tolerance(setup, item, brief) for item in tolerances if kept(item.name))
    variables += [variable for variable in found if variable is not None]
    if not variables:
        raise UsageError(
            f"study '{brief.study}': {setup.model.name} has nothing to choose; add Vary(input, low, high) to its "
            "objectives or a price to a tolerance that is not off"
        )
    return Space(setup, tuple(variables), tuple(_followers(setup, stated, brief)))


def _demand_known(setup: Setup, brief: Brief, known: set[str]) -> None:
    for name in brief.vary:
        if name not in known:
            raise UsageError(
                f"study '{brief.study}': vary names '{name}', which {setup.model.name} may not choose."
                f"{near_miss(name, sorted(known))}"
            )


def _of_input(setup: Setup, vary: Vary, brief: Brief) -> Variable:
    item = setup.model.input_fields[vary.input]
    what = f"study '{brief.study}': Vary('{vary.input}')"
    low, high = (_end(item, text, what) for text in (vary.low, vary.high))
    whole = item.kind in {"whole", "integer"}
    if whole:
        low, high = float(ceil(low)), float(floor(high))
    if not low < high:
        raise UsageError(f"{what} runs from {vary.low} to {vary.high}, which leaves nothing to choose")
    start = float(setup.nominal(vary.input))
    if isnan(start):
        raise UsageError(f"{what} has no value to start from; give '{vary.input}' in the inputs")
    return Variable(vary.input, "whole" if whole else "number", low, high, setup.print_unit(vary.input), start)


def _end(item: InputField, text: str, what: str) -> float:
    """Read one end of a range in SI. Raises UsageError for a text that is none, or beyond the bounds of the input."""
    try:
        value = read_quantity(text, item.unit)
    except UnitError as error:
        raise UsageError(f"{what}: {error}") from None
    broken = "" if item.kind == "whole" else broken_bound(item, value)
    if broken:
        raise UsageError(f"{what}: {broken}")
    return value


def _of_tolerance(setup: Setup, tolerance: Tolerance, brief: Brief) -> Variable | None:
    """Return a tolerance as a variable; None where it is off, drawn by a function, or has a single grade to take."""
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance)
    scattering = setup.distributions().get(tolerance.name, {})
    assert price is not None  # open_space has chosen these
    if not scattering or not isinstance(spread, (Band, Grade, Zone)):
        return None
    width = next(iter(scattering.values())).width
    if isinstance(spread, Grade):
        return _of_grade(setup, tolerance, spread, brief, width)
    return Variable(tolerance.name, "width", brief.tightest * width, brief.widest * width, price.width, width)


def _of_grade(setup: Setup, tolerance: Tolerance, spread: Grade, brief: Brief, width: float) -> Variable | None:
    """Return a tolerance whose grade is chosen: from the finest allowed to the coarsest that is not too wide."""
    target, start = setup.target(tolerance.on[0]), GRADES.index(spread.grade)
    places = []
    for place, name in enumerate(GRADES):
        try:
            size = replace(spread, grade=name).width(target)
        except TruingError:  # ISO 286 has no such grade for the size
            continue
        if place == start or (place >= GRADES.index(brief.finest) and size <= brief.widest * width * (1 + SLACK)):
            places.append(place)
    if len(places) < 2:
        return None
    return Variable(tolerance.name, "grade", float(min(places)), float(max(places)), "", float(start))


def _followers(setup: Setup, stated: list[Vary], brief: Brief) -> Iterator[Follower]:
    """Yield the inputs that follow, each behind those it follows itself. Raises UsageError for a circle."""
    formulas = {item.input: parse(item.by) for item in stated if item.by}
    done: set[str] = set()
    while len(done) < len(formulas):
        ready = [
            name
            for name, formula in formulas.items()
            if name not in done and not (set(formula.names) & set(formulas)) - done
        ]
        if not ready:
            circle = " and ".join(f"'{name}'" for name in formulas if name not in done)
            raise UsageError(f"study '{brief.study}': {circle} follow each other by their formulas in a circle")
        for name in ready:
            done.add(name)
            yield Follower(name, formulas[name], setup.print_unit(name))
