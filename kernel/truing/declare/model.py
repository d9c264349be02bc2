"""The model: one plain function with everything that is said about it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass
from functools import cached_property
from inspect import signature
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar, get_args

import numpy as np

from truing.declare.blocks import Block
from truing.declare.builtin import builtin_effects
from truing.declare.correlations import Correlated, contradictions
from truing.declare.dynamics import Dynamics
from truing.declare.fields import (
    ROLES,
    Axis,
    Found,
    InputField,
    ResultField,
    hints_of,
    in_si,
    input_fields,
    make,
    read,
    result_fields,
)
from truing.declare.goals import Maximise, Minimise, Objective, PriceByChoice, Require, Vary, prices_in
from truing.declare.near_miss import near_miss
from truing.declare.published import Finding, Published
from truing.declare.sources import Condition, Effect, ErrorSource, Tolerance
from truing.declare.spreads import Band, ByChoice, Drawn, Grade, Spread
from truing.errors import DeclarationError, UsageError
from truing.formulas import parse

I = TypeVar("I")  # noqa: E741  # inputs, as in Model[I, R]
R = TypeVar("R")
T = TypeVar("T")
Level = Literal["short", "normal", "full"]


TOTAL_PRICE = "tolerance_price"
Promise = Literal[
    "units are known",
    "defaults keep their bounds",
    "finite at defaults",
    "goals can be read",
    "spreads resolve",
    "printed numbers are of results",
    "sheet is in order",
    "formulas have the unit",
    "formulas equal the function",
    "batch equals loop",
    "steps may be halved",
    "motion is settled",
    "inputs untouched",
    "seeds decide",
    "serial equals parallel",
    "derivatives are exact",
    "bounds are answered",
    "inputs survive a file",
    "example can be read",
    "zero is the base",
    "references are neutral",
    "effects act",
    "only last results are edited",
    "order of effects",
]
"""A check of the kit, as a known exception of a model names it."""
PROMISES: tuple[str, ...] = get_args(Promise)


class Study(Protocol):
    """A question asked of a model: a frozen dataclass with one method."""

    @property
    def name(self) -> str:
        """The key in results.json and in ``[studies]``."""

    @property
    def gives(self) -> Callable[[Any], Any] | None:
        """Turns the outcome into results of the model, or None."""

    def run(self, bench: Any) -> Any:
        """Answer, with the workbench ``truing.studies.bench.Bench`` that holds model, inputs and error sources."""


@dataclass(frozen=True)
class Record(Generic[I, R]):
    """A finished run as sections see it: inputs and results in SI, every answer by flat name, outcomes by study.

    ``inputs`` are as stated, ``acting`` as the effects that are on leave them.
    """

    inputs: I
    results: R
    answers: Mapping[str, Any]
    studies: Mapping[str, Any]
    function: Callable[[I], R]
    acting: I

    def outcome(self, kind: type[T]) -> T | None:
        """Return the outcome of the first study of this kind, None where none ran."""
        return next((outcome for outcome in self.studies.values() if isinstance(outcome, kind)), None)


@dataclass(frozen=True, init=False)
class Section:
    """A part of the sheet: results by name with their formulas, words, and what ``figure`` draws.

    ``figure(record)`` returns a matplotlib Figure; ``blocks(record)`` a sequence of words, tables and drawings. The
    first figure of a ``key`` section stands on page one; where none is marked, that of the first section with one.
    In a chain ``of`` names the source to whose chapter it belongs.
    """

    title: str
    names: tuple[str, ...]
    text: str
    figure: Callable[[Record[Any, Any]], Any] | None
    blocks: Callable[[Record[Any, Any]], Sequence[Block]] | None
    level: Level
    caption: str
    key: bool
    of: str

    def __init__(
        self,
        title: str,
        *names: str,
        text: str = "",
        figure: Callable[[Record[Any, Any]], Any] | None = None,
        blocks: Callable[[Record[Any, Any]], Sequence[Block]] | None = None,
        level: Level = "normal",
        caption: str = "",
        key: bool = False,
        of: str = "",
    ) -> None:
        values = {"title": title, "names": names, "text": text, "figure": figure, "blocks": blocks, "level": level}
        for name, value in {**values, "caption": caption, "key": key, "of": of}.items():
            object.__setattr__(self, name, value)

    @property
    def whole_title(self) -> str:
        """Its title; in a chain, where two calculations may have the same, behind the source to which it belongs."""
        return f"{self.of}: {self.title}" if self.of else self.title


@dataclass(frozen=True, kw_only=True, eq=False)
class Model(Generic[I, R]):
    """A calculation: ``function`` takes SI floats or arrays (n,) and returns the same, no I/O, no globals.

    ``derivatives(inputs)`` may give exact ones, ``{result: {input: value}}`` in SI. ``example`` is the commented inputs
    file that ``calc init`` writes. ``exceptions`` names checks of the conformance kit that the model does not pass,
    each with the reason. Everything is checked when the model is made; a fault raises DeclarationError.
    """

    name: str
    title: str
    function: Callable[[I], R]
    errors: Sequence[ErrorSource[I, R]] = ()
    objectives: Sequence[Objective] = ()
    studies: Sequence[Study] = ()
    sheet: Sequence[Section] = ()
    cites: Sequence[str] = ()
    published: Sequence[Published] = ()
    findings: Sequence[Finding] = ()
    derivatives: Callable[[I], Mapping[str, Mapping[str, Any]]] | None = None
    example: Path | None = None
    summary: str = ""
    exceptions: Mapping[Promise, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_model(self)

    @cached_property
    def known(self) -> dict[str, Any]:
        """What was calculated of this model alone, by the name of who asked: it holds as long as the model lives."""
        return {}

    @property
    def dynamics(self) -> Dynamics[Any, I, R] | None:
        """The state equation of a model that moves, None of any other."""
        return self.function if isinstance(self.function, Dynamics) else None

    @cached_property
    def input_type(self) -> type[I]:
        """The dataclass of inputs."""
        return self._annotated()[0]

    @cached_property
    def result_type(self) -> type[R]:
        """The dataclass of results."""
        return self._annotated()[1]

    def _annotated(self) -> tuple[type[Any], type[Any]]:
        if self.dynamics is not None:
            return self.dynamics.input_type, self.dynamics.result_type
        hints = hints_of(self.function)
        answer = hints.pop("return", None)
        if len(hints) != 1 or answer is None:
            raise DeclarationError(
                f"{self.name}: the function takes one annotated class of inputs and returns one of results"
            )
        return next(iter(hints.values())), answer

    @cached_property
    def input_fields(self) -> dict[str, InputField]:
        """Every input by flat name."""
        return input_fields(self.input_type)

    @cached_property
    def own_result_fields(self) -> dict[str, ResultField]:
        """Every result of the function by flat name."""
        return result_fields(self.result_type)

    @cached_property
    def axes(self) -> dict[str, str]:
        """The flat name of the axis that each result runs along, its own part's where that has one; "" for a number."""
        fields = self.own_result_fields
        own = {name: f"{result.along}_{result.scope}" for name, result in fields.items()}
        return {name: own[name] if own[name] in fields else result.along for name, result in fields.items()}

    @cached_property
    def measurable(self) -> list[str]:
        """The results that rows of a record can hold: numbers and curves, no axes and nothing of a table."""
        fields = self.own_result_fields
        tables = {name for name, result in fields.items() if isinstance(result.spec, Axis) and result.spec.is_table}
        return [
            name
            for name, result in fields.items()
            if not isinstance(result.spec, Axis) and not {result.along, f"{result.along}_{result.scope}"} & tables
        ]

    @cached_property
    def study_result_fields(self) -> dict[str, dict[str, ResultField]]:
        """The results that studies give, by study name."""
        given: dict[str, dict[str, ResultField]] = {}
        for study in self.studies:
            if study.gives is not None:
                answer = hints_of(study.gives).get("return")
                if answer is None:
                    raise DeclarationError(
                        f"{self.name}: {study.gives.__name__} must say which @results class it returns"
                    )
                given[study.name] = result_fields(answer)
        return given

    @cached_property
    def result_fields(self) -> dict[str, ResultField]:
        """Every result: the function's, the studies', and where tolerances have prices the sum of these."""
        fields = dict(self.own_result_fields)
        for of_study in self.study_result_fields.values():
            for name, result in of_study.items():
                if name in fields:
                    raise DeclarationError(f"{self.name}: the result '{name}' occurs twice")
                fields[name] = result
        for name, result in self._price_field().items():
            fields.setdefault(name, result)
        return fields

    def _price_field(self) -> dict[str, ResultField]:
        """Return the sum of the prices as a result, where any tolerance has one."""
        units = [price.unit for tolerance in self.tolerances.values() for price in prices_in(tolerance.price)]
        if not units:
            return {}
        note, method = "price of all tolerances in force", "sum of their prices, each at its full width"
        spec = Found(unit=units[0], note=note, method=method)
        return {TOTAL_PRICE: ResultField(name=TOTAL_PRICE, path=(TOTAL_PRICE,), spec=spec, symbol="")}

    @cached_property
    def tolerances(self) -> dict[str, Tolerance]:
        """The tolerances by name."""
        return {source.name: source for source in self.errors if isinstance(source, Tolerance)}

    @property
    def correlations(self) -> tuple[Correlated, ...]:
        """The inputs that scatter together, pair by pair."""
        return tuple(source for source in self.errors if isinstance(source, Correlated))

    @property
    def effects(self) -> dict[str, Effect[I, R]]:
        """The effects by name, as declared."""
        return {source.name: source for source in self.errors if isinstance(source, Effect)}

    @property
    def conditions(self) -> dict[str, Condition]:
        """The conditions of all effects by name."""
        return {condition.name: condition for effect in self.effects.values() for condition in effect.needs}

    @cached_property
    def known_effects(self) -> dict[str, Effect[I, R]]:
        """Every effect that can be switched on or diagnosed, by name: the model's own, then the kernel's.

        They act in this order. The kernel's are those on every reading (``declare.builtin``).
        """
        return {**self.effects, **builtin_effects(self)}

    @cached_property
    def known_conditions(self) -> dict[str, Condition]:
        """Every condition that an effect may need, by name: the model's own, then the kernel's."""
        needed = {need.name: need for effect in self.known_effects.values() for need in effect.needs}
        return {**self.conditions, **{name: need for name, need in needed.items() if name not in self.conditions}}

    def inputs(self, **values: Any) -> I:
        """Make inputs by flat name; texts carry units (``load="3 kN"``), numbers are SI, the rest is default."""
        changed = {}
        for name, value in values.items():
            input_field = self.input_fields.get(name)
            if input_field is None:
                raise UsageError(f"{self.name} has no input '{name}'.{near_miss(name, self.input_fields)}")
            if input_field.choices and str(value) not in input_field.choices:
                raise UsageError(f"'{name}' of {self.name} is one of {', '.join(input_field.choices)}, not '{value}'")
            changed[input_field.path] = _in_si(value, input_field)
        return make(self.input_type, changed)

    def read_inputs(self, inputs: I) -> dict[str, Any]:
        """Return every input by flat name, SI."""
        return {name: read(inputs, input_field.path) for name, input_field in self.input_fields.items()}

    def read_results(self, results: R, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Return these results of the function by flat name, SI; all by default."""
        fields = self.own_result_fields
        return {name: read(results, fields[name].path) for name in (fields if names is None else names)}


def _in_si(value: Any, input_field: InputField) -> Any:
    """Turn texts, alone or in a series, into SI; everything else is SI already."""
    if input_field.kind not in {"float", "whole", "series"}:
        return value
    if isinstance(value, str):
        return in_si(value, input_field.unit)
    if not isinstance(value, (tuple, list)):
        return value
    numbers = tuple(in_si(number, input_field.unit) if isinstance(number, str) else number for number in value)
    if not input_field.spec.along:
        return numbers
    return np.array(numbers, dtype=float)


# Checks of a model when it is made: every name that is said must exist


def check_model(model: Model[Any, Any]) -> None:
    """Refuse a model in which something names what does not exist, all such places at once."""
    faults = [
        *_of_names(model),
        *_of_axes(model),
        *_of_dynamics(model),
        *_of_companions(model),
        *_of_halving(model),
        *_of_roles(model),
        *_of_errors(model),
        *(fault for objective in model.objectives for fault in _of_objective(objective, model)),
        *_of_sheet(model),
        *_of_formulas(model),
        *_of_exceptions(model),
    ]
    if faults:
        raise DeclarationError(f"model '{model.name}': " + "; ".join(faults))


def _of_names(model: Model[Any, Any]) -> Iterator[str]:
    if not model.name.replace("_", "").isalnum():
        yield f"the name '{model.name}' may hold letters, digits and underscores only"
    for name in model.input_fields:
        if name in model.result_fields:
            yield f"'{name}' is an input and a result; one of them needs another name"
    given = [name for fields in model.study_result_fields.values() for name in fields]
    if TOTAL_PRICE in {*model.input_fields, *model.own_result_fields, *given}:
        yield f"the name '{TOTAL_PRICE}' is kept for the sum of the prices"
    sources = [source for source in model.errors if not isinstance(source, Correlated)]
    for name in _twice(getattr(source, "name", repr(source)) for source in sources):
        yield f"two error sources are called '{name}'"
    for name in _twice(study.name for study in model.studies):
        yield f"two studies are called '{name}'"


def _of_exceptions(model: Model[Any, Any]) -> Iterator[str]:
    for name, reason in model.exceptions.items():
        if name not in PROMISES:
            yield f"an exception is declared from '{name}', which is no check of the kit.{near_miss(name, PROMISES)}"
        elif not reason.strip():
            yield f"the exception from '{name}' gives no reason"


def _twice(names: Iterable[str]) -> list[str]:
    return [name for name, times in Counter(names).items() if times > 1]


def _of_axes(model: Model[Any, Any]) -> Iterator[str]:
    """Say which results and series run along an axis that nobody declares."""
    fields = model.own_result_fields
    axes = {name for name, input_field in fields.items() if isinstance(input_field.spec, Axis)}
    axes |= {name for name, input_field in model.input_fields.items() if input_field.kind == "series"}
    for name, result in fields.items():
        own = f"{result.along}_{result.scope}" if result.scope else result.along
        if isinstance(result.spec, Found) and result.along and not {own, result.along} & axes:
            yield f"the result '{name}' runs along '{result.along}', which is no axis.{near_miss(result.along, axes)}"
    for name, input_field in model.input_fields.items():
        along = input_field.spec.along
        if along and along not in axes:
            yield f"the input '{name}' runs along '{along}', which is no axis.{near_miss(along, axes)}"
    series = [name for name, input_field in model.input_fields.items() if input_field.kind == "series"]
    for name, result in fields.items():
        followed = result.spec.follows if isinstance(result.spec, Axis) else ""
        if followed and followed not in series:
            yield f"the axis '{name}' follows '{followed}', which is no input series.{near_miss(followed, series)}"


def _of_dynamics(model: Model[Any, Any]) -> Iterator[str]:
    """Say what keeps a state equation from being followed: no times, starts that are nothing, formulas of nobody."""
    dynamics = model.dynamics
    if dynamics is None:
        return
    fields = model.input_fields
    series = [name for name, each in fields.items() if each.kind == "series" and each.spec.along]
    if dynamics.times not in series:
        near = near_miss(dynamics.times, series)
        yield f"the times of the motion are '{dynamics.times}', which is no input series.{near}"
        return
    for name in _twice(event.name for event in dynamics.events):
        yield f"two events are called '{name}'"
    known = rate_scope(model)
    for name, spec in dynamics.state_fields.items():
        if isinstance(spec.start, str) and spec.start.isidentifier() and spec.start not in fields:
            near = near_miss(spec.start, fields)
            yield f"state '{name}' starts at '{spec.start}', which is no input and no quantity.{near}"
        names = _names_in(spec.rate) if spec.rate else frozenset()
        if isinstance(names, str):
            yield f"the rate of state '{name}': {names}"
            continue
        for missing in sorted(names - set(known)):
            near = near_miss(missing, known)
            yield f"the rate of state '{name}' names '{missing}', which is no state, input or result.{near}"


def _of_companions(model: Model[Any, Any]) -> Iterator[str]:
    """Say which inputs are to be stated with one that does not exist."""
    for name, input_field in model.input_fields.items():
        other = input_field.spec.stated_with
        if other and (other == name or other not in model.input_fields):
            meant = near_miss(other, model.input_fields)
            yield f"the input '{name}' is stated with '{other}', which is no other input.{meant}"


def _of_halving(model: Model[Any, Any]) -> Iterator[str]:
    """Say which numerical steps are no numbers, promise nothing, or name what is no result."""
    fields = model.own_result_fields
    for name, input_field in model.input_fields.items():
        share, but = getattr(input_field.spec, "halving", None), getattr(input_field.spec, "halving_but", {})
        if share is None and but:
            yield f"the input '{name}' has a halving_but without a halving; give the share for all other results"
        if share is not None and (input_field.kind not in {"float", "whole", "integer"} or not 0 < share < 1):
            yield f"the input '{name}' has the halving {share!r}; it is a share from 0 to 1, of a number or count"
        for result in but:
            if result not in fields:
                yield f"the halving of '{name}' names '{result}', which is no result.{near_miss(result, fields)}"


def _of_roles(model: Model[Any, Any]) -> Iterator[str]:
    """Say which roles are none, and which rates name nothing that could be a speed."""
    known = {**model.input_fields, **model.conditions}
    for name, input_field in model.input_fields.items():
        if (role := getattr(input_field.spec, "role", "")) not in {"", *ROLES}:
            meant = near_miss(role, ROLES)
            yield f"the input '{name}' has the role '{role}'; the roles are {', '.join(ROLES)}.{meant}"
    for name, condition in model.conditions.items():
        if condition.rate and (condition.rate == name or condition.rate not in known):
            meant = near_miss(condition.rate, known)
            yield f"the condition '{name}' has the rate '{condition.rate}', which is no input or condition.{meant}"


def _of_errors(model: Model[Any, Any]) -> Iterator[str]:
    conditions: dict[str, Condition] = {}
    for source in model.errors:
        if isinstance(source, Tolerance):
            yield from _of_tolerance(source, model)
        elif isinstance(source, Effect):
            yield from _of_effect(source, model)
            for condition in source.needs:
                if conditions.setdefault(condition.name, condition) != condition:
                    yield f"the condition '{condition.name}' is declared in two ways"
        elif not isinstance(source, Correlated):
            yield f"{source!r} is neither a Tolerance nor an Effect"
    yield from _of_correlations(model)
    units = sorted({price.unit for tolerance in model.tolerances.values() for price in prices_in(tolerance.price)})
    if len(units) > 1:
        yield f"the prices are in {' and '.join(units)}; give all of them in one unit, so that they can be added"


def _of_correlations(model: Model[Any, Any]) -> Iterator[str]:
    """Say which correlated inputs no tolerance is on, which pairs are stated twice, and which contradict each other."""
    scattering = {name for tolerance in model.tolerances.values() for name in tolerance.on}
    for stated in model.correlations:
        for name in (stated.first, stated.second):
            if name not in scattering:
                yield f"'{name}' is correlated, but no tolerance is on it.{near_miss(name, scattering)}"
    for pair, times in Counter(stated.pair for stated in model.correlations).items():
        if times > 1:
            yield f"the correlation of {' and '.join(repr(name) for name in sorted(pair))} is declared twice"
    yield from (contradiction.text for contradiction in contradictions(model.correlations))


def _of_effect(source: Effect[Any, Any], model: Model[Any, Any]) -> Iterator[str]:
    """Say what keeps an effect from acting on the model: names that are taken, inputs and results of another one."""
    for condition in source.needs:
        for known, kind in ((model.input_fields, "an input"), (model.result_fields, "a result")):
            if condition.name in known:
                yield f"the condition '{condition.name}' has the name of {kind}"
    axes = {name for name, result in model.own_result_fields.items() if isinstance(result.spec, Axis)}
    readable = {*model.input_fields, *axes}
    for name in source.reads:
        if name not in readable:
            yield f"effect '{source.name}' reads '{name}', which is neither input nor axis.{near_miss(name, readable)}"
    expected = [model.input_type, model.result_type][: 1 if source.place == "inputs" else 2]
    for parameter, wanted in zip(signature(source.function).parameters.values(), expected, strict=False):
        try:
            given = hints_of(source.function).get(parameter.name)
        except TypeError:  # a callable without annotations, such as a partial: nothing to compare
            return
        if isinstance(given, type) and is_dataclass(given) and not issubclass(wanted, given):
            yield f"effect '{source.name}' acts on {given.__qualname__}, but the model has {wanted.__qualname__}"


def _of_tolerance(source: Tolerance, model: Model[Any, Any]) -> Iterator[str]:
    for name in source.on:
        input_field = model.input_fields.get(name)
        condition = name in model.conditions
        if input_field is None and not condition:
            yield f"tolerance '{source.name}' is on '{name}', which is no input.{near_miss(name, model.input_fields)}"
        elif input_field is not None and not input_field.varies:
            yield f"tolerance '{source.name}' is on '{name}', which cannot scatter: only a Float can"
    for fault in _of_spread(source.spread, model):
        yield f"tolerance '{source.name}' {fault}"
    yield from _of_price(source, model)


def _of_price(source: Tolerance, model: Model[Any, Any]) -> Iterator[str]:
    what = f"the price of tolerance '{source.name}'"
    if isinstance(source.price, PriceByChoice):
        for fault in _of_choices(source.price.chooser, source.price.prices, "price", model):
            yield f"{what} {fault}"
    for price in prices_in(source.price):
        names = _names_in(price.formula)
        if isinstance(names, str):
            yield f"{what}: {names}"
        elif names != {"width"}:
            yield f"{what} names {', '.join(sorted(names)) or 'nothing'}; it is a formula in width"


def _of_choices(chooser: str, branches: Mapping[str, Any], what: str, model: Model[Any, Any]) -> Iterator[str]:
    """Say why an input cannot choose among these branches."""
    input_field = model.input_fields.get(chooser)
    if input_field is None:
        yield f"names '{chooser}', which is no input.{near_miss(chooser, model.input_fields)}"
    elif not input_field.choices:
        yield f"is chosen by '{chooser}', which offers no choices"
    elif set(input_field.choices) != set(branches):
        yield f"has a {what} for {', '.join(branches)}, but '{chooser}' offers {', '.join(input_field.choices)}"


def _of_spread(spread: Spread, model: Model[Any, Any]) -> Iterator[str]:
    if not hasattr(spread, "resolve"):
        yield f"has the spread {spread!r}; write normal(...), plus_minus(...), grade(...) or another of the words"
    elif isinstance(spread, ByChoice):
        yield from _of_choices(spread.chooser, spread.spreads, "spread", model)
        for inner in spread.spreads.values():
            yield from _of_spread(inner, model)
    for name in _read_by(spread):
        if name not in model.input_fields:
            yield f"names '{name}', which is no input.{near_miss(name, model.input_fields)}"


def _read_by(spread: Spread) -> tuple[str, ...]:
    """Return the inputs that a spread asks for beside its own."""
    if isinstance(spread, Drawn):
        return spread.of
    name = spread.size if isinstance(spread, Grade) else spread.at_radius if isinstance(spread, Band) else ""
    return (name,) if name else ()


def _names_in(formula: str) -> frozenset[str] | str:
    """Return the names in a formula, or why it cannot be read."""
    try:
        return frozenset(parse(formula).names)
    except DeclarationError as error:
        return str(error)


def _of_objective(objective: Any, model: Model[Any, Any]) -> Iterator[str]:
    inputs, results = model.input_fields, model.result_fields
    if isinstance(objective, Vary):
        yield from _of_vary(objective, inputs)
    elif isinstance(objective, (Minimise, Maximise)):
        known = {**inputs, **results}
        if objective.result not in known:
            what = f"{type(objective).__name__} names '{objective.result}'"
            yield f"{what}, which is neither input nor result.{_unknown_result(objective.result, known)}"
    elif isinstance(objective, Require):
        yield from _of_require(objective, inputs, results)
    else:
        yield f"{objective!r} is no objective; write Vary, Minimise, Maximise or Require"


def _of_vary(objective: Vary, inputs: Mapping[str, InputField]) -> Iterator[str]:
    if objective.input not in inputs:
        yield f"Vary names '{objective.input}', which is no input.{near_miss(objective.input, inputs)}"
    elif not inputs[objective.input].varies and inputs[objective.input].kind != "integer":
        yield f"Vary names '{objective.input}', which is no number that may vary"
    names = _names_in(objective.by) if objective.by else frozenset()
    if isinstance(names, str):
        yield f"Vary('{objective.input}'): {names}"
    elif strange := sorted(names - set(inputs)):
        yield f"Vary('{objective.input}') follows {strange[0]}, which is no input.{near_miss(strange[0], inputs)}"


def _of_require(
    objective: Require, inputs: Mapping[str, InputField], results: Mapping[str, ResultField]
) -> Iterator[str]:
    if objective.result not in results:
        yield f"Require names '{objective.result}', which is no result.{_unknown_result(objective.result, results)}"
    if objective.result == TOTAL_PRICE and objective.reliability is not None:
        yield f"Require('{TOTAL_PRICE}') asks for a reliability, but a price does not scatter"
    limit, known = objective.limit, {**inputs, **results}
    if not any(sign.isdigit() for sign in limit) and limit not in known:
        what = f"Require('{objective.result}') has the limit '{limit}'"
        yield f"{what}, which is neither a quantity nor an input or result.{near_miss(limit, known)}"
    if isinstance(objective.reliability, str) and objective.reliability not in inputs:
        yield f"Require('{objective.result}') takes its reliability from '{objective.reliability}', which is no input"


def _unknown_result(name: str, known: Iterable[str]) -> str:
    """Return what was probably meant by a name that is no result."""
    return " No tolerance has a price." if name == TOTAL_PRICE else near_miss(name, known)


def _of_sheet(model: Model[Any, Any]) -> Iterator[str]:
    for section in model.sheet:
        for name in section.names:
            if name not in model.result_fields:
                meant = near_miss(name, model.result_fields)
                yield f"section '{section.title}' names '{name}', which is no result.{meant}"


def _of_formulas(model: Model[Any, Any]) -> Iterator[str]:
    for result in model.result_fields.values():
        text = getattr(result.spec, "formula", "")
        if not text:
            continue
        try:
            scope = formula_scope(model, result)
            formula = parse(text)
            missing = [name for name in formula.names if name not in scope]
        except DeclarationError as error:
            yield f"formula of '{result.name}': {error}"
            continue
        if missing:
            named = ", ".join(sorted(missing)) + f", which is neither input nor result.{near_miss(missing[0], scope)}"
            yield f"formula of '{result.name}' names {named}"
        elif formula.left is None and any(scope[name] is result for name in formula.names):
            yield f"formula of '{result.name}' names itself; write an equation with == for what is solved"


# Which quantity a name in a formula means: that of its own part first


def rate_scope(model: Model[Any, Any]) -> dict[str, InputField | ResultField]:
    """Return what each name means in the rate of a state: states and ``time`` first, then inputs and results.

    A state is known as a result of the name ``state NAME``.
    """
    assert model.dynamics is not None
    states = {
        name: ResultField(name=f"state {name}", path=(name,), spec=Found(unit=spec.unit), symbol=spec.symbol)
        for name, spec in model.dynamics.state_fields.items()
    }
    time = ResultField(name="state time", path=("time",), spec=Found(unit="s"), symbol="t")
    return {**model.result_fields, **model.input_fields, "time": time, **states}


def formula_scope(model: Model[Any, Any], result: ResultField) -> Mapping[str, InputField | ResultField]:
    """Return what each name means in the formula of ``result``: own part first, then the flat names.

    The function's results know each other; what a study gives knows the results of all studies besides.
    """
    own_result = result.name in model.own_result_fields
    known: dict[str, InputField | ResultField] = {
        **model.input_fields, **(model.own_result_fields if own_result else model.result_fields),
    }  # fmt: skip
    if result.prefix:
        known = {
            name.removeprefix(result.prefix): each for name, each in known.items() if name.startswith(result.prefix)
        }
    if not result.scope:
        return known
    ending = "_" + result.scope
    own = {name.removesuffix(ending): input_field for name, input_field in known.items() if name.endswith(ending)}
    return {**known, **own}
