"""Formulas on the sheet: symbol = expression = numbers = result, broken into lines where one would be too wide."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from truing.declare.fields import Found, InputField, ResultField
from truing.declare.model import Model, formula_scope, rate_scope
from truing.errors import DeclarationError
from truing.evaluate import acting_inputs
from truing.formulas import Formula, evaluate, parse, symbol_text
from truing.formulas.layout import Binding, Layout, Writer, symbolic
from truing.formulas.tree import CONSTANTS, SIGNS, Node, children, simplified
from truing.numbers import ABSENT, format_value
from truing.report.document import Equation, Value
from truing.setup import Setup
from truing.units import difference_unit, from_si, to_si

LINE = 34.0
"""How wide a line may be, in em as estimated (it may come out a sixth wider): the column of formulas on A4 is 38."""

INPUT_DIGITS = 7


@dataclass(frozen=True)
class EquationLine:
    """One line of a formula, finished markup, with its width in em as estimated."""

    markup: str
    width: float


def equation_of(setup: Setup, answers: Mapping[str, Any], result: ResultField) -> Equation | None:
    """Return the formula of a result with everything that is printed of it, or None where it has none.

    The numbers are those that the function itself was called with: after the effects on the inputs.
    """
    if not isinstance(result.spec, Found) or not result.spec.formula:
        return None
    formula = parse(result.spec.formula)
    fields = {name: field for name, field in formula_scope(setup.model, result).items() if name in formula.names}
    known = {**setup.model.read_inputs(acting_inputs(setup)), **answers}
    values = {name: known.get(field.name) for name, field in sorted(fields.items())}
    plain = all(_is_single(value) for value in (*values.values(), answers.get(result.name)))
    numbered = values if plain else {}
    numeric = result.spec.numeric
    departing = _departing(formula, fields, numbered, answers.get(result.name), result) if plain else None
    shown = answers.get(result.name) if departing is None else departing
    printed = setup.print_unit(result.name)
    units = (result.unit, printed) if numeric and printed != result.unit else (printed,)
    return Equation(
        formula=formula,
        name=result.name,
        symbol=result.symbol,
        symbols={name: field.symbol for name, field in fields.items() if field.symbol},
        numbers={n: _number(setup, fields[n], v, numeric=numeric) for n, v in numbered.items()} if plain else None,
        results=tuple(Value(*format_value(shown, unit, result.digits)) for unit in units) if _is_single(shown) else (),
        departs=departing is not None,
    )


def state_equation(model: Model[Any, Any], name: str) -> Equation | None:
    """Return the rate of a state in symbols, or what it is at the next time; None where no formula is declared."""
    dynamics = model.dynamics
    if dynamics is None or not dynamics.state_fields[name].rate:
        return None
    spec, scope = dynamics.state_fields[name], rate_scope(model)
    formula = parse(spec.rate)
    symbols = {each: scope[each].symbol for each in formula.names if scope[each].symbol}
    change = "rate" if dynamics.step is None else "next"
    return Equation(formula, name, spec.symbol, symbols, numbers=None, results=(), change=change)


def _departing(
    formula: Formula, fields: Mapping[str, InputField | ResultField], values: Mapping[str, Any], answer: Any,
    result: ResultField,
) -> float | None:  # fmt: skip
    """Return what the formula itself gives, in SI, where that is not the calculation's answer (an effect is on).

    Rounding is no difference: neither a millionth of the value nor what a billionth of any operand makes of it. None
    also for an equation that is solved, and where the formula gives no number.
    """
    numeric = isinstance(result.spec, Found) and result.spec.numeric
    if formula.left is not None or answer is None or any(value is None for value in values.values()):
        return None
    numbers = {name: from_si(value, fields[name].unit) if numeric else value for name, value in values.items()}
    stated = from_si(float(answer), result.unit) if numeric else float(answer)
    try:
        value = float(evaluate(formula, numbers))
        nearby = [float(evaluate(formula, {**numbers, name: numbers[name] * (1 + 1e-9)})) for name in numbers]
    except (DeclarationError, TypeError, ValueError):
        return None
    rounding = sum(abs(near - value) for near in nearby)
    if not abs(value - stated) > 1e-6 * max(abs(value), abs(stated)) + rounding:
        return None
    return float(to_si(value, result.unit)) if numeric else value


def _is_single(value: Any) -> bool:
    return getattr(value, "ndim", 0) == 0


def _number(setup: Setup, field: InputField | ResultField, value: Any, *, numeric: bool) -> tuple[str, str]:
    """Return what stands for a name: in the printed unit (temperature levels in kelvin) or bare in the declared one."""
    if value is None or value != value:
        return ABSENT, ""
    digits = INPUT_DIGITS if isinstance(field, InputField) else field.digits
    if numeric:
        return format_value(value, field.unit, digits)[0], ""
    return format_value(value, difference_unit(setup.print_unit(field.name)), digits)


def lines(writer: Writer, equation: Equation, *, limit: float = LINE) -> list[EquationLine]:
    """Set an equation: on one line if it fits, otherwise a line each for expression, numbers and result."""
    formula = equation.formula
    left = writer.symbol(equation.symbol, None) if equation.symbol else writer.word(equation.name)
    if equation.change == "rate":
        change, second = (writer.infix(writer.word("d"), "gap", each) for each in (left, writer.symbol("t", None)))
        left = writer.fraction(change, second)
    elif equation.change == "next":
        left = writer.applied(writer.word("next"), writer.parenthesised(left))
    name = EquationLine(left, _name_width(equation.symbol or equation.name) + (1.5 if equation.change else 0))
    if formula.left is not None:
        return _solved(writer, equation, name)
    said = _broken(writer, formula, equation, None, limit - name.width)
    first = EquationLine(writer.infix(name.markup, "==", said[0].markup), name.width + said[0].width + 1.2)
    rest = [_after(writer, "==", EquationLine(*_quantity(writer, value))) for value in equation.results]
    if equation.numbers is not None and formula.names:
        numbers = _broken(writer, formula, equation, equation.numbers, limit)
        rest = [_after(writer, "==", numbers[0]), *numbers[1:], *rest]
    return _packed([first, *said[1:], *rest], limit)


def _solved(writer: Writer, equation: Equation, name: EquationLine) -> list[EquationLine]:
    """Set what is solved for: the equation that holds, then the solution."""
    formula = equation.formula
    width = _width(formula.right, equation.symbols) + 1.2
    width += _width(formula.left, equation.symbols) if formula.left is not None else 0.0
    written = [EquationLine(symbolic(writer, formula, equation.symbols), width)]
    if equation.results:
        markup = name.markup
        for value in equation.results:
            markup = writer.infix(markup, "==", _quantity(writer, value)[0])
        written.append(EquationLine(markup, name.width + 8))
    return written


def _quantity(writer: Writer, value: Value) -> tuple[str, float]:
    return writer.quantity(value.text, value.unit), 0.55 * len(value.text) + 0.6 * len(value.unit)


def _after(writer: Writer, sign: str, line: EquationLine) -> EquationLine:
    """Begin a line with a sign, as the continuation of the line above."""
    return EquationLine(writer.infix(writer.opening, sign, line.markup), line.width + 1.2)


def _packed(steps: list[EquationLine], limit: float) -> list[EquationLine]:
    """Put as many steps on a line as fit: markup of a step that begins with a sign joins directly."""
    packed = [steps[0]]
    for step in steps[1:]:
        last = packed[-1]
        if last.width + step.width <= limit:
            packed[-1] = EquationLine(last.markup + step.markup, last.width + step.width)
        else:
            packed.append(step)
    return packed


def _broken(
    writer: Writer, formula: Formula, equation: Equation, numbers: Mapping[str, tuple[str, str]] | None, limit: float
) -> list[EquationLine]:
    """Set one side, in one line or, if it is a sum too wide for that, in lines that begin with plus or minus."""
    texts = equation.symbols if numbers is None else {name: " ".join(pair) for name, pair in numbers.items()}
    layout = Layout(writer, equation.symbols, numbers)
    width = _width(formula.right, texts)
    (_, first), *others = _terms(formula.right)
    if width <= limit or not others:
        return [EquationLine(layout.formula(replace(formula, left=None)), width)]
    written = [EquationLine(layout.at_least(simplified(first), Binding.SUM).markup, _width(first, texts))]
    for sign, node in others:
        piece = layout.at_least(simplified(node), Binding.SUM if sign == "+" else Binding.PRODUCT, signed=False)
        written.append(_after(writer, sign, EquationLine(piece.markup, _width(node, texts))))
    return _packed(written, limit)


def _terms(node: Node) -> list[tuple[str, Node]]:
    """Take a sum apart into signs and terms."""
    match node:
        case ast.BinOp(left, (ast.Add() | ast.Sub()) as sign, right):
            return [*_terms(left), (SIGNS[type(sign)], right)]
    return [("", node)]


def _width(node: Node, texts: Mapping[str, str]) -> float:
    """Estimate the width of a node in em."""
    match node:
        case ast.Constant(_, str() as text):
            return 0.55 * len(text)
        case ast.Name(name):
            return 0.6 if name in CONSTANTS else _name_width(texts.get(name) or name)
        case ast.BinOp(above, ast.Div(), below):
            return max(_width(above, texts), _width(below, texts)) + 0.3
        case ast.BinOp(base, ast.Pow(), exponent):
            return _width(base, texts) + 0.7 * _width(exponent, texts)
        case ast.BinOp(left, sign, right):
            return _width(left, texts) + _width(right, texts) + (0.6 if isinstance(sign, ast.Mult) else 1.2)
        case ast.Call(ast.Name("cases" | "either"), arguments):
            values, conditions = arguments[::2], arguments[1::2]
            widest = max(_width(value, texts) for value in values)
            return widest + max((_width(condition, texts) for condition in conditions), default=4.0) + 3
        case ast.Call(ast.Name(function), arguments):
            inner = sum(_width(argument, texts) for argument in arguments)
            return inner + (1.0 if function == "sqrt" else 0.5 * len(function) + 0.8)
    return sum(_width(child, texts) for child in children(node)) + 1.2


def _name_width(text: str) -> float:
    """Estimate a symbol or a number with its unit; a subscript is smaller."""
    if " " in text or text[:1].isdigit() or text[:1] == "-":
        return 0.58 * len(text) + 0.2
    base, _, subscript = symbol_text(text).partition("_")
    return 0.6 * len(base) + 0.42 * len(subscript)
