"""Limits: what a requirement demands, in numbers, and the margin that is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from math import isnan
from typing import Any, Literal

import numpy as np
from scipy.special import ndtr

from truing.declare.fields import in_si
from truing.declare.goals import Require
from truing.evaluate import evaluate
from truing.executors import keepable
from truing.numbers import STATED_DIGITS, format_value, with_unit
from truing.setup import Setup
from truing.units import difference_unit, from_si


@keepable
@dataclass(frozen=True)
class Check:
    """A limit and how far it is kept: margin > 0 is safe, everywhere. Values are in ``unit``, probabilities have none.

    Value and margin are those of the design as stated; ``passed`` says that this one keeps the limit. ``proposed`` is
    the same limit for the design that a study proposes. Where no study of the run decides the limit, ``undecided`` says
    which one would, and value and margin are NaN. ``compared`` says what the value is, as P(backlash ≤ 1′); empty: the
    result called ``name``. ``relation`` is read from the margin where it is not given. A ``flag`` is a yes or a no.
    ``method`` says how a probability was found.
    """

    name: str
    value: float
    limit: float
    unit: str
    margin: float
    passed: bool
    note: str = ""
    method: str = ""
    _: KW_ONLY
    relation: Literal["", "≤", "≥"] = ""
    compared: str = ""
    chance: bool = False
    flag: bool = False
    undecided: str = ""
    proposed: Check | None = None

    def __post_init__(self) -> None:
        if not self.relation:
            safe_above = (self.limit - self.value) * self.margin < 0
            object.__setattr__(self, "relation", "≥" if safe_above else "≤")

    @property
    def state(self) -> State:
        """Whether the limit is kept: by the design as stated, by the one proposed, or by neither."""
        if self.undecided:
            return "undecided"
        if self.passed:
            return "passes"
        return "proposed" if self.proposed is not None and self.proposed.passed else "fails"


@keepable
@dataclass(frozen=True)
class Proposal:
    """Another design that a study proposes: what it changes, as (name, stated, proposed), and limits as it keeps them.

    A limit that the changes do not touch is not among the checks.
    """

    study: str
    what: str
    changes: tuple[tuple[str, str, str], ...]
    checks: tuple[Check, ...]


@dataclass(frozen=True)
class Limit:
    """A requirement in SI: ``low <= result <= high``, and the probability it asks for (None: it must simply hold).

    The limits are numbers, or arrays along the axis of the result.
    """

    name: str
    result: str
    low: Any
    high: Any
    goal: Any
    require: Require


def margin_of(value: float, limit: float, *, at_least: bool = False) -> float:
    """Return (limit - value)/|limit|, negated for a lower limit; absolute when the limit is 0."""
    distance = (value - limit) if at_least else (limit - value)
    return distance / abs(limit) if limit else distance


def limits(setup: Setup, answers: dict[str, Any]) -> list[Limit]:
    """Return every requirement of the model in numbers whose results are known; ``answers`` holds them in SI."""
    requires = requirements(setup)
    known = [require for require in requires if is_known(require, setup, answers)]
    centres = {
        require.result: of_design(setup, require.result, answers) for require in known if require.kind == "within"
    }
    return [limit_of(check_name(require, requires), require, setup, answers, centres) for require in known]


def limit_of(name: str, require: Require, setup: Setup, values: Mapping[str, Any], centres: Mapping[str, Any]) -> Limit:
    """Return a requirement in numbers; ``centres`` are the results from which ``within`` is measured.

    ``values`` holds results in SI, and inputs that are not those of the setup: numbers, or arrays (m,) of m designs.
    """
    amount = limit_amount(require, setup, values)
    low, high = -float("inf"), float("inf")
    if require.kind == "at_most":
        high = amount
    elif require.kind == "at_least":
        low = amount
    else:
        centre = centres[require.result]
        low, high = centre - beside(amount, centre), centre + beside(amount, centre)
    return Limit(name, require.result, low, high, goal_of(require, setup, values), require)


def beside(limit: Any, values: Any) -> Any:
    """Make one limit per row meet values along an axis."""
    deeper = np.ndim(values) - np.ndim(limit)
    return limit if deeper <= 0 or np.ndim(limit) == 0 else np.expand_dims(limit, tuple(range(-deeper, 0)))


def is_known(require: Require, setup: Setup, answers: Mapping[str, Any]) -> bool:
    """Tell whether the results that a requirement reads are answered: its own, and one that is its limit."""
    read = {require.result, require.limit} & {require.result, *setup.model.result_fields}
    return read <= answers.keys()


def requirements(setup: Setup) -> list[Require]:
    """Return the requirements of the model; one whose limit is an input that is not given asks for nothing."""
    fields = setup.model.input_fields
    every = [objective for objective in setup.model.objectives if isinstance(objective, Require)]
    return [
        require for require in every if require.limit not in fields or not isnan(float(setup.nominal(require.limit)))
    ]


def goal_of(require: Require, setup: Setup, values: Mapping[str, Any] | None = None) -> Any:
    """Return the probability that a requirement asks for, None where it must simply hold; ``values`` as of limits."""
    goal = require.reliability
    if not isinstance(goal, str):
        return goal
    return values[goal] if values and goal in values else float(setup.nominal(goal))


def of_design(setup: Setup, result: str, answers: dict[str, Any]) -> Any:
    """Return a result of the design itself, from which ``within`` is measured.

    No part of the design are effects that are on, and deviations that the inputs state: inputs with a tolerance whose
    declared default is 0.
    """
    acts = any(active.effect.place != "reading" for active in setup.effects)
    deviating = dict.fromkeys((name for name in sockets_of(setup) if setup.nominal(name) != 0), 0.0)
    if not (acts or deviating) or result not in setup.model.own_result_fields:
        return answers[result]
    design = replace(setup.changed(deviating), effects=())
    return setup.model.read_results(evaluate(design))[result]


def sockets_of(setup: Setup) -> list[str]:
    """Return the inputs that are deviations of the design: those with a tolerance whose declared default is 0."""
    fields = setup.model.input_fields
    names = {name for tolerance in setup.model.tolerances.values() for name in tolerance.on if name in fields}
    return [name for name in sorted(names) if getattr(fields[name].spec, "default", None) == 0]


def limit_amount(require: Require, setup: Setup, values: Mapping[str, Any]) -> Any:
    """Return the stated limit in SI: an input, a result or a quantity in the unit of the result."""
    if require.limit in values:
        return values[require.limit]
    if require.limit in setup.model.input_fields:
        return float(setup.nominal(require.limit))
    return float(in_si(require.limit, setup.model.result_fields[require.result].unit))


def check_name(require: Require, others: list[Require]) -> str:
    """Return the name of a check: the result's, with the kind where one result has several limits."""
    twins = [other for other in others if other.result == require.result]
    return require.result if len(twins) == 1 else f"{require.result} {require.kind.replace('_', ' ')}"


def plain_checks(setup: Setup, answers: dict[str, Any]) -> list[Check]:
    """Return the checks that need no probability, in the unit each result is printed in."""
    return [_plain(limit, setup, answers) for limit in limits(setup, answers) if limit.goal is None]


def _plain(limit: Limit, setup: Setup, answers: dict[str, Any]) -> Check:
    unit = setup.print_unit(limit.result)
    at_least = limit.require.kind == "at_least"
    value, stated = answers[limit.result], limit.low if at_least else limit.high
    if limit.require.kind == "within":
        unit = difference_unit(unit)
        value, stated = abs(value - (limit.low + limit.high) / 2), (limit.high - limit.low) / 2
    values, bounds = np.broadcast_arrays(*np.atleast_1d(np.asarray(value, dtype=float), stated))
    worst = int(np.argmin(values - bounds) if at_least else np.argmax(values - bounds))
    value, bound = float(from_si(values[worst], unit)), float(from_si(bounds[worst], unit))
    margin = margin_of(value, bound, at_least=at_least)
    return Check(
        limit.name, value, bound, unit, margin, margin >= 0, relation="≥" if at_least else "≤",
        compared=_subject(limit.require), flag=limit.require.is_flag,
    )  # fmt: skip


def chance_check(name: str, probability: float, goal: float, *, method: str = "", note: str = "") -> Check:
    """Return the check of a probability, found by a method, against its goal."""
    margin = margin_of(probability, goal, at_least=True)
    return Check(name, probability, goal, "", margin, margin >= 0, note, method, relation="≥", chance=True)


def compared_words(require: Require, setup: Setup, answers: Mapping[str, Any]) -> str:
    """Say what a check compares with its limit: the result, or P(result ≤ bound) where a probability is asked for."""
    if require.reliability is None:
        return _subject(require)
    relation = "≥" if require.kind == "at_least" else "≤"
    return f"P({_subject(require)} {relation} {_bound_words(require, setup, answers)})"


def _subject(require: Require) -> str:
    return f"|{require.result} − nominal|" if require.kind == "within" else require.result


def _bound_words(require: Require, setup: Setup, answers: Mapping[str, Any]) -> str:
    """Write the bound inside a probability as a number, or by its name where it moves from machine to machine."""
    scattering = {name for inner in setup.distributions().values() for name in inner}
    if require.limit in setup.model.result_fields or require.limit in scattering:
        return require.limit
    unit = setup.print_unit(require.result)
    unit = difference_unit(unit) if require.kind == "within" else unit
    return with_unit(*format_value(limit_amount(require, setup, answers), unit, STATED_DIGITS))


# What is demanded of chance: limits in numbers, also those that move with the machine, and the normal probability


Z95 = 1.959963984540054  # standard normal quantile of 97.5 %


@dataclass(frozen=True)
class Demand:
    """``low <= result - moving <= high`` in SI, for every machine; numbers, or arrays along the result's axis.

    ``moving`` is empty or the result or input that a one-sided limit names: then strength meets load in each machine.
    ``still`` is the nominal value of such an input.
    """

    name: str
    result: str
    low: Any
    high: Any
    goal: float | None
    moving: str = ""
    still: float | None = None

    def response(self, results: Mapping[str, Any], columns: Mapping[str, Any]) -> Any:
        """Return what the limits hold for: the result, less a limit that moves."""
        values = results[self.result]
        if not self.moving:
            return values
        limit = results[self.moving] if self.moving in results else columns.get(self.moving, self.still)
        return values - beside(limit, values)

    def slopes(self, of: Mapping[str, Mapping[str, Any]], columns: Sequence[str]) -> dict[str, Any]:
        """Return the derivatives of the response by column."""
        own = of[self.result]
        if not self.moving:
            return {column: own[column] for column in columns}
        if self.moving in of:
            return {column: own[column] - beside(of[self.moving][column], own[column]) for column in columns}
        return {column: own[column] - float(column == self.moving) for column in columns}

    @property
    def wanted(self) -> tuple[str, ...]:
        """The names this demand needs from a calculation: results, and perhaps an input."""
        return (self.result, self.moving) if self.moving else (self.result,)


def demands(setup: Setup, answers: Mapping[str, Any], *, with_goal: bool | None = None) -> list[Demand]:
    """Return the limits on results of the function: those with a probability to reach, or all where none has one.

    ``with_goal=True`` returns only those with one. A limit on a result that does not exist (NaN) is left out.
    """
    own = setup.model.own_result_fields
    limited = [demand_of(limit, setup) for limit in limits(setup, dict(answers)) if limit.result in own]
    goals = [demand for demand in limited if demand.goal is not None]
    chosen = goals if goals or with_goal else limited
    return [demand for demand in chosen if all(exists(answers.get(name, 0.0)) for name in demand.wanted)]


def exists(answer: Any) -> bool:
    """Tell whether an answer in SI is a number, or numbers along an axis."""
    return not np.isnan(answer).any()


def demand_of(limit: Limit, setup: Setup) -> Demand:
    """Return a limit as it is demanded of every machine."""
    named, fields = limit.require.limit, setup.model.input_fields
    if limit.require.kind == "within" or not (named in setup.model.own_result_fields or named in fields):
        return Demand(limit.name, limit.result, limit.low, limit.high, limit.goal)
    infinity = float("inf")
    low, high = (0.0, infinity) if limit.require.kind == "at_least" else (-infinity, 0.0)
    still = float(setup.nominal(named)) if named in fields else None
    return Demand(limit.name, limit.result, low, high, limit.goal, named, still)


def results_needed(setup: Setup, wanted: Sequence[Demand]) -> tuple[str, ...]:
    """Return the results that these demands read, in a fixed order."""
    named = {name for demand in wanted for name in demand.wanted}
    return tuple(name for name in setup.model.own_result_fields if name in named)


def normal_chance(mean: Any, sd: Any, low: Any, high: Any) -> Any:
    """Return the probability that a normal value lies between two limits, exact to rounding in both tails.

    A standard deviation of 0 gives 1 or 0. Numbers or arrays.
    """
    mean, sd, low, high = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (mean, sd, low, high)))
    with np.errstate(all="ignore"):
        above, below = (low - mean) / sd, (high - mean) / sd
        inside = np.where(above > 0, ndtr(-above) - ndtr(-below), ndtr(below) - ndtr(above))
    certain = ((low <= mean) & (mean <= high)).astype(float)
    chance = np.where(sd > 0, inside, np.where(np.isfinite(mean), certain, np.nan))
    return float(chance) if chance.ndim == 0 else chance


def wilson(hits: Any, draws: int) -> tuple[Any, Any]:
    """Return Wilson's 95 % interval of a probability (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209)."""
    share = np.asarray(hits, dtype=float) / draws
    square = Z95 * Z95
    centre = (share + square / (2 * draws)) / (1 + square / draws)
    half = Z95 * np.sqrt(share * (1 - share) / draws + square / (4 * draws * draws)) / (1 + square / draws)
    low, high = np.clip(centre - half, 0.0, 1.0), np.clip(centre + half, 0.0, 1.0)
    return (float(low), float(high)) if low.ndim == 0 else (low, high)


def worst(value: Any) -> float:
    """Return the smallest of a curve of probabilities, or the number itself."""
    return float(np.min(value))


def as_number(value: Any) -> Any:
    """Return a number, or a list of numbers, for results.json; None where there is none."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0:
        return float(array) if np.isfinite(array) else None
    return array.tolist() if np.isfinite(array).all() else [as_number(member) for member in array]


# The four verdicts and their words, apart from what calculates: the command line knows them before it loads that


State = Literal["passes", "proposed", "undecided", "fails"]
"""What is said of a limit and of a run: kept as stated, kept by a design that a study proposes, not decided, missed."""

EXIT_CODES: Mapping[State, int] = {"passes": 0, "proposed": 0, "undecided": 1, "fails": 1}
"""Exit codes by verdict, the best first."""
HEADLINES: Mapping[State, str] = {
    "passes": "Passes",
    "proposed": "Passes with the proposed changes, not as stated",
    "undecided": "Undecided",
    "fails": "Fails",
}
SHORT: Mapping[State, str] = {
    "passes": "pass",
    "proposed": "not as stated",
    "undecided": "UNDECIDED",
    "fails": "FAILS",
}
