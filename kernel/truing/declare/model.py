"""The model: one plain function with everything that is said about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar

import numpy as np

from truing.declare.blocks import Block
from truing.declare.builtin import builtin_effects
from truing.declare.checks import TOTAL_PRICE, Promise, check_model
from truing.declare.fields import (
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
from truing.declare.goals import Objective, prices_in
from truing.declare.near_miss import near_miss
from truing.declare.published import Finding, Published
from truing.declare.sources import Condition, Effect, ErrorSource, Tolerance
from truing.errors import DeclarationError, UsageError

I = TypeVar("I")  # noqa: E741  # inputs, as in Model[I, R]
R = TypeVar("R")
T = TypeVar("T")
Level = Literal["short", "normal", "full"]


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

    ``figure(record)`` returns a matplotlib Figure; ``blocks(record)`` a sequence of words, tables and drawings.
    """

    title: str
    names: tuple[str, ...]
    text: str
    figure: Callable[[Record[Any, Any]], Any] | None
    blocks: Callable[[Record[Any, Any]], Sequence[Block]] | None
    level: Level
    caption: str

    def __init__(
        self,
        title: str,
        *names: str,
        text: str = "",
        figure: Callable[[Record[Any, Any]], Any] | None = None,
        blocks: Callable[[Record[Any, Any]], Sequence[Block]] | None = None,
        level: Level = "normal",
        caption: str = "",
    ) -> None:
        values = {"title": title, "names": names, "text": text, "figure": figure, "blocks": blocks, "level": level}
        for key, value in {**values, "caption": caption}.items():
            object.__setattr__(self, key, value)


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

    @cached_property
    def input_type(self) -> type[I]:
        """The dataclass of inputs."""
        return self._annotated()[0]

    @cached_property
    def result_type(self) -> type[R]:
        """The dataclass of results."""
        return self._annotated()[1]

    def _annotated(self) -> tuple[type[Any], type[Any]]:
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

    @property
    def tolerances(self) -> dict[str, Tolerance]:
        """The tolerances by name."""
        return {source.name: source for source in self.errors if isinstance(source, Tolerance)}

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
