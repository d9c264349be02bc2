"""The value of a formula, plain numpy on numbers or arrays; and the proof of its dimensions with pint quantities."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import Any, NoReturn

import numpy as np
import pint
from pint.util import UnitsContainer
from scipy.special import ndtr

from truing.errors import DeclarationError, UnitError
from truing.formulas.tree import CONSTANTS, SIGNS, Formula, Node, source
from truing.units import human_dimension
from truing.units import registry as shared_registry


def evaluate(formula: Formula, values: Mapping[str, Any]) -> Any:
    """Compute a formula from numbers or arrays, by numpy's rules of broadcasting.

    ``values`` holds every name of the formula as a number or an array, all in one coherent system of units (SI), or
    for a numeric formula in the declared units. Batches of shape (n,) meet an axis of length k as columns (n, 1).
    ``sum`` and ``mean`` (and ``min``, ``max`` of one argument) work over the last axis; a number is its own sum.
    An equation gives left minus right, which is 0 where it holds. Outside its domain a function gives NaN or
    infinity without a warning: the caller looks at what came back. A comparison with NaN does not hold.

    Raises:
        DeclarationError: a name of the formula has no value, or its value is no number.
    """
    numbers = {name: _as_number(formula, name, values) for name in sorted(formula.names)}
    with np.errstate(all="ignore"):
        result = value_of(formula.right, numbers)
        if formula.left is not None:
            result = value_of(formula.left, numbers) - result
    result = np.asarray(result)
    return result.item() if result.ndim == 0 else result


def _as_number(formula: Formula, name: str, values: Mapping[str, Any]) -> Any:
    if name not in values:
        known = ", ".join(sorted(values)) or "nothing"
        raise DeclarationError(f"formula {formula.text!r} names {name!r}, which has no value here (known: {known})")
    array = np.asarray(values[name])
    if array.dtype.kind in "biu":
        return array.astype(np.float64)
    if array.dtype.kind not in "fc":
        raise DeclarationError(f"formula {formula.text!r} needs a number for {name!r}, not {values[name]!r:.60}")
    return array


def value_of(node: Node, values: Mapping[str, Any]) -> Any:
    """Compute one node from arrays; ``evaluate`` is the door for callers."""
    match node:
        case ast.Constant(float() as number):
            return np.float64(number)
        case ast.Name(name):
            return np.float64(CONSTANTS[name]) if name in CONSTANTS else values[name]
        case ast.UnaryOp(_, operand):
            return -value_of(operand, values)
        case ast.BinOp(left, sign, right):
            return OPERATORS[SIGNS[type(sign)]](value_of(left, values), value_of(right, values))
        case ast.Call(ast.Name("cases"), arguments):
            result = value_of(arguments[-1], values)
            for case, condition in reversed(list(zip(arguments[:-1:2], arguments[1::2], strict=True))):
                result = np.where(value_of(condition, values), value_of(case, values), result)
            return result
        case ast.Call(ast.Name(function), arguments):
            return FUNCTIONS[function](*(value_of(argument, values) for argument in arguments))
        case ast.Compare(first, signs, others):
            sides = [value_of(operand, values) for operand in (first, *others)]
            links = [OPERATORS[SIGNS[type(sign)]](sides[i], sides[i + 1]) for i, sign in enumerate(signs)]
            return np.logical_and.reduce(np.broadcast_arrays(*links))
        case ast.BoolOp(joint, operands):
            parts = np.broadcast_arrays(*(value_of(operand, values) for operand in operands))
            return (np.logical_and if isinstance(joint, ast.And) else np.logical_or).reduce(parts)
    raise AssertionError("parsing lets nothing else through")


OPERATORS: Mapping[str, Callable[..., Any]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": np.power,
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **{name: getattr(np, name) for name in ("sqrt", "cbrt", "exp", "log", "log10", "abs", "sign", "sin", "cos")},
    **{name: getattr(np, name) for name in ("tan", "sinh", "cosh", "tanh")},
    "cot": lambda x: 1 / np.tan(x),
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "inv": lambda x: np.tan(x) - x,
    "hypot": lambda *sides: reduce(np.hypot, sides),
    "min": lambda *given: reduce(np.minimum, given) if len(given) > 1 else _over_last_axis(np.min, given[0]),
    "max": lambda *given: reduce(np.maximum, given) if len(given) > 1 else _over_last_axis(np.max, given[0]),
    "Phi": ndtr,
    "sum": lambda x: _over_last_axis(np.sum, x),
    "mean": lambda x: _over_last_axis(np.mean, x),
    "either": lambda first, second: np.where(np.isnan(first), second, first),
}


def _over_last_axis(function: Callable[..., Any], values: Any) -> Any:
    return function(values, axis=-1) if np.ndim(values) else values


# The proof of dimensions: a formula evaluated with pint quantities


KEEPS_DIMENSION = frozenset({"abs", "sum", "mean"})
OF_LIKES = frozenset({"min", "max", "hypot", "either"})
OF_ANGLE = frozenset({"sin", "cos", "tan", "cot", "inv"})


def evaluate_quantities(formula: Formula, values: Mapping[str, pint.Quantity[Any]]) -> pint.Quantity[Any]:
    """Evaluate a formula with units and prove its dimensions; the quantity comes back in base units.

    Angles count as pure numbers (a radian is one). A literal 0 fits every dimension: ``max(x, 0)``, ``x > 0``. A power
    of a dimensional base needs one exponent for all points. Numbers without units are taken as pure numbers.
    An equation gives left minus right, after both sides were found to agree.

    Raises:
        UnitError: unlike dimensions are added, compared or offered as alternatives, or a function that needs a pure
            number got something else; the sentence names the part of the formula.
        DeclarationError: a name of the formula has no value.
    """
    registries = (getattr(value, "_REGISTRY", None) for value in values.values())
    registry: Any = next(filter(None, registries), None) or shared_registry()
    magnitudes: dict[str, Any] = {}
    dimensions: dict[str, UnitsContainer] = {}
    for name in formula.names & values.keys():
        quantity = registry.Quantity(values[name]).to_base_units()
        magnitudes[name] = np.asarray(quantity.magnitude, dtype=float)
        powers = {unit: power for unit, power in quantity.unit_items() if not registry.Unit(unit).dimensionless}
        exact = {unit: _exact(power) for unit, power in powers.items()}  # without radians and counts
        dimensions[name] = UnitsContainer(exact, non_int_type=Fraction)
    magnitude = evaluate(formula, magnitudes)
    proof = _Proof(formula, dimensions, magnitudes)
    dimension = proof.of(formula.right)
    if formula.left is not None:
        dimension = proof.alike((formula.left, formula.right), "the two sides of the equation")
    exponents = {unit: _exact(power) for unit, power in (dimension or {}).items()}
    units = {unit: int(power) if power.denominator == 1 else float(power) for unit, power in exponents.items()}
    result: pint.Quantity[Any] = registry.Quantity(magnitude, registry.UnitsContainer(units))
    return result


def _exact(exponent: Any) -> Fraction:
    return Fraction(exponent).limit_denominator(10**6)


def _power(base: UnitsContainer, exponent: Fraction) -> UnitsContainer:
    return base**exponent if exponent else PURE_NUMBER


PURE_NUMBER = UnitsContainer({}, non_int_type=Fraction)
_SHORT = {"meter": "m", "kilogram": "kg", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol", "candela": "cd"}


def _spoken(dimension: UnitsContainer | None) -> str:
    """Say a dimension in the engineer's words: "a force", "a pure number"."""
    if not dimension:
        return "a pure number"
    exponents = {_SHORT.get(unit, unit): _exact(power) for unit, power in sorted(dimension.items())}
    unit = "*".join(f"{unit}^{n if n.denominator == 1 else f'({n})'}" for unit, n in exponents.items())
    try:
        return human_dimension(unit)
    except UnitError:
        return unit


@dataclass(frozen=True)
class _Proof:
    """Walks a formula and finds the dimension of each part (None: a literal 0), or the sentence why there is none."""

    formula: Formula
    dimensions: Mapping[str, UnitsContainer]
    magnitudes: Mapping[str, Any]

    def of(self, node: Node) -> UnitsContainer | None:
        match node:
            case ast.Constant(0.0):
                return None
            case ast.Name(name) if name not in CONSTANTS:
                return self.dimensions[name]
            case ast.UnaryOp(_, operand):
                return self.of(operand)
            case ast.BinOp(left, (ast.Add() | ast.Sub()) as sign, right):
                verb = "added" if isinstance(sign, ast.Add) else "subtracted"
                return self.alike((left, right), f"'{self.quoted(node)}': what is {verb}")
            case ast.BinOp(base, ast.Pow(), exponent):
                return self.power(node, base, exponent)
            case ast.BinOp(left, sign, right):
                above, below = self.of(left), self.of(right)
                if above is None:
                    return None
                power = Fraction(1 if isinstance(sign, ast.Mult) else -1)
                product: UnitsContainer = above * _power(below or PURE_NUMBER, power)
                return product
            case ast.Call(ast.Name(function), arguments):
                return self.call(node, function, arguments)
            case ast.Compare(first, _, others):
                self.alike((first, *others), f"'{self.quoted(node)}': what is compared")
            case ast.BoolOp(_, operands):
                for operand in operands:
                    self.of(operand)
        return PURE_NUMBER

    def call(self, node: Node, function: str, arguments: Sequence[Node]) -> UnitsContainer | None:
        where = f"'{self.quoted(node)}'"
        if function == "cases":
            for condition in arguments[1::2]:
                self.of(condition)
            return self.alike((*arguments[:-1:2], arguments[-1]), f"{where}: what is chosen from")
        if function in OF_LIKES:
            return self.alike(arguments, f"{where}: what {function} takes")
        if function in KEEPS_DIMENSION:
            return self.of(arguments[0])
        if function in ("sqrt", "cbrt"):
            base = self.of(arguments[0])
            return None if base is None else _power(base, Fraction(1, 2 if function == "sqrt" else 3))
        if function == "atan2":
            self.alike(arguments, f"{where}: what atan2 takes")
        elif function == "sign":
            self.of(arguments[0])
        else:
            wanted = "an angle or a pure number" if function in OF_ANGLE else "a pure number"
            self.pure(arguments[0], f"{where}: {function} needs {wanted}")
        return PURE_NUMBER

    def quoted(self, node: Node) -> str:
        return source(self.formula, node)

    def pure(self, node: Node, sentence: str) -> None:
        if dimension := self.of(node):
            self.fail(f"{sentence}, not {_spoken(dimension)} ('{self.quoted(node)}')")

    def power(self, node: Node, base: Node, exponent: Node) -> UnitsContainer | None:
        self.pure(exponent, f"'{self.quoted(node)}': an exponent must be a pure number")
        dimension = self.of(base)
        if not dimension:
            return dimension
        with np.errstate(all="ignore"):
            value = np.unique(np.asarray(value_of(exponent, self.magnitudes)))
        if value.size != 1 or not np.isfinite(value[0]):
            self.fail(f"'{self.quoted(node)}': {_spoken(dimension)} is raised to a power that is not one finite number")
        return _power(dimension, _exact(float(value[0])))

    def alike(self, nodes: Sequence[Node], sentence: str) -> UnitsContainer | None:
        """Return the dimension all nodes share; a literal zero shares any."""
        known = ((node, dimension) for node in nodes if (dimension := self.of(node)) is not None)
        first, shared = next(known, (None, None))
        for node, dimension in known:
            if first is not None and dimension != shared:
                self.fail(
                    f"{sentence} must have one dimension, but '{self.quoted(first)}' is {_spoken(shared)} "
                    f"and '{self.quoted(node)}' is {_spoken(dimension)}"
                )
        return shared

    def fail(self, sentence: str) -> NoReturn:
        raise UnitError(f"formula {self.formula.text!r}: {sentence}")
