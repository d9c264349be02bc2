"""Checks of what is said beside the function: units, limits, goals, printed numbers, the sheet, the example."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from truing.declare.fields import Found, Given, InputField, ResultField
from truing.declare.goals import Vary
from truing.declare.model import formula_scope, rate_scope
from truing.declare.quantities import has_dimension, rate_unit, unread_goals, unread_units
from truing.errors import DeclarationError, InputError, TruingError, UnitError
from truing.evaluate import acting_inputs, evaluate
from truing.example_file import example_text
from truing.formulas import Formula, evaluate_quantities, parse
from truing.formulas.evaluation import value_of
from truing.inputs_file import setup_from_settings, setup_from_text
from truing.inputs_file.values import broken_bound
from truing.runs.inputs_written import complete_inputs
from truing.setup import Setup
from truing.testing.subject import Subject, fail
from truing.units import from_si, pint_quantity, read_quantity, same_dimension

SAME = 1e-12


def units_are_known(subject: Subject) -> None:
    """Every unit that is declared is one that Truing knows; history is in that of what it is made from, or gains."""
    model = subject.model
    for unread in unread_units(model):
        fail(f"{model.name}: {unread.sentence}")
    units = {name: field.unit for name, field in model.input_fields.items()}
    units |= {name: condition.unit for name, condition in model.conditions.items()}
    for name, condition in model.conditions.items():
        made_from = condition.made_from
        wanted = "" if condition.history == "direction" else units.get(made_from, condition.unit)
        if made_from and not same_dimension(condition.unit, wanted):
            what = f"{condition.derived}, which is in '{wanted}'" if wanted else "a direction, which has no unit"
            fail(f"{model.name}: condition '{name}' is in '{condition.unit}', but it is {what}")
        if condition.rate and not same_dimension(f"{units[condition.rate] or '1'}*s", condition.unit):
            per = f"'{condition.rate}' is in '{units[condition.rate]}'"
            fail(f"{model.name}: condition '{name}' is in '{condition.unit}', but {per}, which is not that per time")


def defaults_keep_their_bounds(subject: Subject) -> None:
    """No default lies outside the bounds that are declared beside it."""
    for name, field in subject.scattering.items():
        if isinstance(field.spec, Given):
            broken = broken_bound(field, float(subject.setup.nominal(name)))
            if broken:
                fail(f"{subject.model.name}: the default breaks its own bound: {broken}")


def goals_can_be_read(subject: Subject) -> None:
    """Bounds of variables and limits of requirements are quantities of the right dimension, in the right order."""
    model = subject.model
    for unread in unread_goals(model):
        fail(f"{model.name}: {unread.sentence}")
    for objective in model.objectives:
        if isinstance(objective, Vary) and not objective.by:
            unit = model.input_fields[objective.input].unit
            if not read_quantity(objective.low, unit) < read_quantity(objective.high, unit):
                fail(f"{model.name}: Vary('{objective.input}') runs from {objective.low} to {objective.high}: nowhere")


def printed_numbers_are_of_results(subject: Subject) -> None:
    """Every printed number names a result of the model, in a unit of its kind, and settings that can be read."""
    name = subject.model.name
    for printed in subject.model.published:
        field = subject.model.result_fields.get(printed.result)
        if field is None:
            fail(f"{name}: the printed number '{printed.name}' names '{printed.result}', which is no result")
        if not same_dimension(printed.unit, field.unit):
            fail(f"{name}: '{printed.name}' is printed in '{printed.unit}', '{printed.result}' is in '{field.unit}'")
        if printed.verdict == "differs" and not printed.why:
            fail(f"{name}: the printed number '{printed.name}' differs; say why")
        with _stating(subject, f"settings of '{printed.name}'"):
            setup_from_settings(subject.offer, printed.settings)


def sheet_is_in_order(subject: Subject) -> None:
    """No two sections share a title, no result stands on the sheet twice."""
    titles = [section.whole_title for section in subject.model.sheet]
    names = [name for section in subject.model.sheet for name in section.names]
    for what, written in (("section", titles), ("result", names)):
        for one in written:
            if written.count(one) > 1:
                fail(f"{subject.model.name}: the {what} '{one}' stands on the sheet {written.count(one)} times")


def example_can_be_read(subject: Subject) -> None:
    """The inputs file that ``calc init`` writes is read without a fault and can be calculated."""
    example = subject.model.example
    with tempfile.TemporaryDirectory() as empty:
        folder = example.parent if example is not None else Path(empty)
        with _stating(subject, "the example of `calc init`"):
            text = example_text(subject.offer)
            evaluate(setup_from_text(text, subject.offer, file="example.toml", folder=folder))


def inputs_survive_a_file(subject: Subject) -> None:
    """Inputs written as an inputs file are read back the same."""
    model = subject.model
    folder = model.example.parent if model.example is not None else Path()
    for point in ({}, *subject.points(1)):
        setup = subject.at(point)
        try:
            back = setup_from_text(complete_inputs(setup, folder), subject.offer, file="inputs.toml", folder=folder)
        except InputError as error:
            fail(f"{model.name}: inputs do not survive a file: {error}")
        before, after = (model.read_inputs(one.inputs) for one in (setup, back))
        for name, value in before.items():
            if model.input_fields[name].kind != "file" and not _same(value, after[name]):
                fail(f"{model.name}: '{name}' is {value!r} before and {after[name]!r} after a file (SI)")


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, (str, bool)) or isinstance(other, str):
        return bool(one == other)
    before, after = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return before.shape == after.shape and np.allclose(before, after, rtol=SAME, atol=0, equal_nan=True)


@contextmanager
def _stating(subject: Subject, what: str) -> Iterator[None]:
    """Turn what Truing says against a declaration into the failure of a check."""
    try:
        yield
    except TruingError as error:
        fail(f"{subject.model.name}: {what}: {error}")


# Checks of what is printed: the formulas prove their units and give what the function gives


AGREES = 1e-9
Scope = Mapping[str, InputField | ResultField]


def formulas_of(subject: Subject) -> Iterator[tuple[ResultField, Formula, bool, Scope]]:
    """Yield each result and rate that prints a formula, the formula, whether it is numeric, and what its names mean."""
    for field in subject.model.own_result_fields.values():
        text = getattr(field.spec, "formula", "")
        if text:
            yield field, parse(text), bool(getattr(field.spec, "numeric", False)), formula_scope(subject.model, field)
    dynamics = subject.model.dynamics
    if dynamics is None:
        return
    scope = rate_scope(subject.model)
    for name, spec in dynamics.state_fields.items():
        if spec.rate:
            unit = rate_unit(spec.unit, in_steps=dynamics.step is not None)
            rate = ResultField(name=f"rate of {name}", path=(name,), spec=Found(unit=unit), symbol=spec.symbol)
            yield rate, parse(spec.rate), False, scope


def formulas_have_the_unit(subject: Subject) -> None:
    """Every formula gives the dimension of its result, by calculation with units."""
    values = _values(subject, {})
    for result, formula, numeric, scope in formulas_of(subject):
        if numeric:
            continue
        try:
            quantities = {name: pint_quantity(values[scope[name].name], scope[name].unit) for name in formula.names}
            quantity = evaluate_quantities(formula, quantities)
        except (UnitError, DeclarationError) as error:
            fail(f"{subject.model.name}: formula of '{result.name}': {error}")
        if formula.left is None and not has_dimension(quantity, formula, result.unit):
            declared = pint_quantity(1.0, result.unit).dimensionality
            fail(
                f"{subject.model.name}: the formula of '{result.name}' gives {quantity.dimensionality}, "
                f"but the result is declared in '{result.unit}' ({declared})"
            )


def formulas_equal_the_function(subject: Subject) -> None:
    """Every printed formula gives what the function gives, to 1e-9, at the defaults and two points beside them."""
    for point in ({}, *subject.points(2)):
        values = _values(subject, point)
        for field, formula, numeric, scope in formulas_of(subject):
            result = values[field.name]
            if np.isnan(result).any():  # it does not exist at this point, for a reason that the function states
                continue
            expected = from_si(result, field.unit) if numeric and formula.left is None else result
            meant = {name: np.asarray(values[scope[name].name], dtype=float) for name in formula.names}
            units = {name: scope[name].unit for name in meant}
            given = {name: from_si(value, units[name]) for name, value in meant.items()} if numeric else meant
            fault = _difference(formula, given, expected)
            if fault:
                fail(f"{subject.model.name}: the formula of '{field.name}' ({formula.text}) {fault}")


def _values(subject: Subject, point: Mapping[str, float]) -> dict[str, Any]:
    """Return every input and result at a point by flat name, SI."""
    setup = subject.at(point)
    results = subject.model.read_results(evaluate(setup))
    return {**subject.model.read_inputs(acting_inputs(setup)), **results, **_of_motion(subject, setup)}


def _of_motion(subject: Subject, setup: Setup) -> dict[str, Any]:
    """Return the states of a model that moves and their rates at every time, as ``formulas_of`` calls them."""
    dynamics = subject.model.dynamics
    if dynamics is None:
        return {}
    inputs = acting_inputs(setup)
    motion = dynamics.followed(inputs)
    rates = {f"rate of {name}": rate for name, rate in dynamics.rates(inputs, motion).items()}
    states = {f"state {name}": getattr(motion.states, name) for name in dynamics.state_fields}
    return {**rates, **states, "state time": motion.time}


def _difference(formula: Formula, given: Mapping[str, Any], expected: Any) -> str:
    """Say how a formula, or the two sides of an equation, differ from what they are to give; nothing if they agree."""
    with np.errstate(all="ignore"):
        right = np.asarray(value_of(formula.right, given), dtype=float)
        other = np.asarray(expected if formula.left is None else value_of(formula.left, given), dtype=float)
    right, other = np.broadcast_arrays(right, other)
    wrong = ~(np.abs(right - other) <= AGREES * np.maximum(np.abs(right), np.abs(other)))
    if not wrong.any():
        return ""
    sides = ("it", "the function") if formula.left is None else ("its right side", "its left side")
    one, two = float(right[wrong][0]), float(other[wrong][0])
    return f"is not what is calculated: {sides[0]} gives {one:.12g}, {sides[1]} gives {two:.12g}"
