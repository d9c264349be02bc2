"""Checks of what is printed: the formulas prove their units and give what the function gives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from truing.declare.fields import InputField, ResultField
from truing.declare.scope import formula_scope
from truing.errors import DeclarationError, UnitError
from truing.evaluate import evaluate
from truing.formulas import Formula, evaluate_quantities, parse
from truing.formulas.evaluation import value_of
from truing.testing.subject import Subject, fail
from truing.units import from_si, pint_quantity

AGREES = 1e-9
Scope = Mapping[str, InputField | ResultField]


def formulas_of(subject: Subject) -> Iterator[tuple[ResultField, Formula, bool, Scope]]:
    """Yield each result that prints a formula, the formula, whether it is numeric, and what its names mean."""
    for item in subject.model.own_result_fields.values():
        text = getattr(item.spec, "formula", "")
        if text:
            yield item, parse(text), bool(getattr(item.spec, "numeric", False)), formula_scope(subject.model, item)


def formulas_have_the_unit(subject: Subject) -> None:
    """Every formula gives the dimension of its result, by calculation with units."""
    values = _values(subject, {})
    for item, formula, numeric, scope in formulas_of(subject):
        if numeric:
            continue
        try:
            quantities = {name: pint_quantity(values[scope[name].name], scope[name].unit) for name in formula.names}
            found = evaluate_quantities(formula, quantities)
        except (UnitError, DeclarationError) as error:
            fail(f"{subject.model.name}: formula of '{item.name}': {error}")
        declared = pint_quantity(1.0, item.unit)
        if formula.left is None and found.dimensionality != declared.dimensionality:
            fail(
                f"{subject.model.name}: the formula of '{item.name}' gives {found.dimensionality}, "
                f"but the result is declared in '{item.unit}' ({declared.dimensionality})"
            )


def formulas_equal_the_function(subject: Subject) -> None:
    """Every printed formula gives what the function gives, to 1e-9, at the defaults and two points beside them."""
    for point in ({}, *subject.points(2)):
        values = _values(subject, point)
        for item, formula, numeric, scope in formulas_of(subject):
            result = values[item.name]
            if np.isnan(result).any():  # it does not exist at this point, for a reason that the function states
                continue
            expected = from_si(result, item.unit) if numeric and formula.left is None else result
            fault = _difference(formula, _in_formula(formula, values, numeric, scope), expected)
            if fault:
                fail(f"{subject.model.name}: the formula of '{item.name}' ({formula.text}) {fault}")


def _values(subject: Subject, point: Mapping[str, float]) -> dict[str, Any]:
    """Return every input and result at a point by flat name, SI."""
    setup = subject.at(point)
    results = subject.model.read_results(evaluate(setup))
    return {**subject.model.read_inputs(setup.inputs), **results}


def _in_formula(formula: Formula, values: Mapping[str, Any], numeric: bool, scope: Scope) -> dict[str, Any]:
    given = {}
    for name in formula.names:
        value = np.asarray(values[scope[name].name], dtype=float)
        given[name] = from_si(value, scope[name].unit) if numeric else value
    return given


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
