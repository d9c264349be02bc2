"""What an optimisation is for: objectives and limits of many designs at once.

A margin is that of every check: (limit - value)/|limit|, absolute where the limit is 0, and above 0 safe.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.checks import TOTAL_PRICE
from truing.declare.fields import in_si
from truing.declare.goals import Maximise, Minimise, Require
from truing.errors import UsageError
from truing.setup import Setup
from truing.studies.checks import check_name, requirements


@dataclass(frozen=True)
class Aim:
    """A number that should be small or large: a result of the function, an input, or the sum of the prices."""

    name: str
    maximise: bool
    unit: str

    @property
    def sign(self) -> float:
        """What turns it into something that should be small."""
        return -1.0 if self.maximise else 1.0

    @property
    def sense(self) -> str:
        """The word for it."""
        return "maximise" if self.maximise else "minimise"


@dataclass(frozen=True)
class Bound:
    """A limit that a design must keep: itself, or with a probability (``goal``, or the input that holds it)."""

    name: str
    require: Require
    by_chance: bool
    unit: str

    @property
    def result(self) -> str:
        """The result it limits."""
        return self.require.result


@dataclass(frozen=True)
class World:
    """Designs (m,) without scatter: nominal inputs that differ, results, prices; ``own`` results without effects."""

    setup: Setup
    columns: Mapping[str, Any]
    results: Mapping[str, NDArray[np.float64]]
    own: Mapping[str, NDArray[np.float64]]
    prices: NDArray[np.float64] | None
    known: Mapping[str, float] = field(default_factory=dict)

    def value(self, name: str) -> Any:
        """Return a result, an input or the sum of the prices: a number for all designs or an array (m, ...)."""
        if name in self.results:
            return self.results[name]
        if name == TOTAL_PRICE and self.prices is not None:
            return self.prices
        if name in self.columns:
            return self.columns[name]
        return self.known[name] if name in self.known else float(self.setup.nominal(name))

    def goal(self, bound: Bound) -> Any:
        """Return the probability that a limit asks for."""
        goal = bound.require.reliability
        return self.value(goal) if isinstance(goal, str) else goal

    def limit(self, bound: Bound) -> Any:
        """Return the stated limit in SI."""
        stated = bound.require.limit
        setup = self.setup
        if (
            stated in setup.model.input_fields
            or stated in self.results
            or stated in self.known
            or stated == TOTAL_PRICE
        ):
            return self.value(stated)
        return in_si(stated, setup.model.result_fields[bound.result].unit)

    def ends(self, bound: Bound) -> tuple[Any, Any]:
        """Return the lower and the upper limit of the result."""
        amount, infinity = self.limit(bound), float("inf")
        if bound.require.kind == "at_most":
            return -infinity, amount
        if bound.require.kind == "at_least":
            return amount, infinity
        centre = self.own.get(bound.result, self.results.get(bound.result, self.prices))
        return centre - beside(amount, centre), centre + beside(amount, centre)


def beside(limit: Any, values: Any) -> Any:
    """Make a number per design meet values that run along further axes."""
    deeper = np.ndim(values) - np.ndim(limit)
    return limit if deeper <= 0 or np.ndim(limit) == 0 else np.expand_dims(limit, tuple(range(-deeper, 0)))


def aims_of(setup: Setup, study: str) -> tuple[Aim, ...]:
    """Return the objectives. Raises UsageError where there is none, or one that is no single number."""
    own = setup.model.own_result_fields
    aims = []
    for item in setup.model.objectives:
        if not isinstance(item, (Minimise, Maximise)) or (name := item.result) in given_by_studies(setup):
            continue
        if name in own and own[name].along:
            raise UsageError(f"study '{study}': the objective '{name}' runs along an axis; it must be one number")
        aims.append(Aim(name, isinstance(item, Maximise), setup.print_unit(name)))
    if not aims:
        raise UsageError(
            f"study '{study}': {setup.model.name} says of no result of its function and of no price that it should be "
            "small or large; add Minimise(result) or Maximise(result) to its objectives"
        )
    return tuple(aims)


def given_by_studies(setup: Setup) -> set[str]:
    """Return the results that only studies give: no design has them while it is searched."""
    return {name for fields in setup.model.study_result_fields.values() for name in fields}


def bounds_of(setup: Setup) -> tuple[Bound, ...]:
    """Return the limits on results of the function and on the sum of the prices, those by chance last."""
    requires = requirements(setup)
    known = {*setup.model.own_result_fields, TOTAL_PRICE}
    found: list[Bound] = []
    for item in sorted(
        (item for item in requires if item.result in known), key=lambda item: item.reliability is not None
    ):
        name, by_chance = check_name(item, requires), item.reliability is not None
        taken = any(bound.name == name for bound in found)
        name = f"{name} by chance" if taken and by_chance else name
        found.append(Bound(name, item, by_chance, setup.print_unit(item.result)))
    return tuple(found)


def left_out(setup: Setup) -> tuple[str, ...]:
    """Say which objectives and limits the search cannot see."""
    theirs = given_by_studies(setup)
    goals = [item for item in setup.model.objectives if isinstance(item, (Minimise, Maximise))]
    named = [item.result for item in (*goals, *requirements(setup))]
    return tuple(
        f"'{name}' is given by a study once per run, so the search does not follow it"
        for name in dict.fromkeys(named)
        if name in theirs
    )


def constants(setup: Setup, answers: Mapping[str, Any]) -> tuple[tuple[str, float], ...]:
    """Return the limits that are results of earlier studies: they stay what they are."""
    limits = {item.limit for item in requirements(setup)}
    theirs = limits & given_by_studies(setup) & set(answers)
    return tuple((name, float(answers[name])) for name in sorted(theirs) if np.ndim(answers[name]) == 0)


def margins(bound: Bound, world: World, rows: int) -> NDArray[np.float64]:
    """Return how far every design (m,) keeps a limit on itself; along an axis the smallest margin."""
    values = np.asarray(world.value(bound.result), dtype=float)
    low, high = world.ends(bound)
    if bound.require.kind == "within":
        half = (high - low) / 2
        above, scale = half - np.abs(values - (low + high) / 2), half
    elif bound.require.kind == "at_least":
        scale = beside(low, values)
        above = values - scale
    else:
        scale = beside(high, values)
        above = scale - values
    size = np.broadcast_to(np.abs(np.asarray(scale, dtype=float)), values.shape)
    margin = np.where(size > 0, above / np.where(size > 0, size, 1.0), above)
    return np.broadcast_to(margin.min(axis=tuple(range(1, margin.ndim))) if margin.ndim > 1 else margin, (rows,))


def results_needed(setup: Setup, aims: Sequence[Aim], bounds: Sequence[Bound]) -> tuple[str, ...]:
    """Return the results of the function that objectives and limits name, in the order of declaration."""
    named = {aim.name for aim in aims} | {name for bound in bounds for name in (bound.result, bound.require.limit)}
    return tuple(name for name in setup.model.own_result_fields if name in named)
