"""The value of a formula, plain numpy on numbers or arrays; and the proof of its dimensions with pint quantities."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial, reduce
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.errors import DeclarationError, UnitError
from truing.formulas.tree import CONSTANTS, SIGNS, Formula, Node, source
from truing.heavy import pint
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


def _held(formula: Formula, name: str, values: Mapping[str, Any]) -> Any:
    if name not in values:
        known = ", ".join(sorted(values)) or "nothing"
        raise DeclarationError(f"formula {formula.text!r} names {name!r}, which has no value here (known: {known})")
    return values[name]


def _as_number(formula: Formula, name: str, values: Mapping[str, Any]) -> Any:
    array = np.asarray(_held(formula, name, values))
    if array.dtype.kind in "biu":
        return array.astype(np.float64)
    if array.dtype.kind not in "fc":
        raise DeclarationError(f"formula {formula.text!r} needs a number for {name!r}, not {values[name]!r:.60}")
    return array


class _UnlikeError(Exception):
    """Quantities that do not go together, and the part of a formula in which they meet."""

    def __init__(self, node: Node, error: pint.DimensionalityError) -> None:
        super().__init__(f"{_spoken(error.units1)} does not go with {_spoken(error.units2)}")
        self.node = node


def value_of(node: Node, values: Mapping[str, Any]) -> Any:
    """Compute one node from arrays or quantities; ``evaluate`` is the door for callers."""
    try:
        return _value_of(node, values)
    except pint.DimensionalityError as error:
        raise _UnlikeError(node, error) from None


def _value_of(node: Node, values: Mapping[str, Any]) -> Any:
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


def _pure(values: Any) -> Any:
    """Return numbers as they are, and those of a quantity that has no dimension."""
    return values.m_as("") if hasattr(values, "m_as") else values


def _power(base: Any, exponent: Any) -> Any:
    """Raise numbers or a quantity; one with a dimension needs one exponent for all points."""
    power = _pure(exponent)
    if not hasattr(base, "m_as") or base.dimensionless:
        return np.power(_pure(base), power)
    one = np.unique(np.asarray(power, dtype=float))
    if one.size != 1 or not np.isfinite(one[0]):
        raise pint.DimensionalityError(base.units, "a power that is not one finite number")
    return _raised(base, float(one[0]), np.power(base.magnitude, one[0]))


def _raised(base: Any, power: float, magnitude: Any) -> Any:
    """Return a quantity whose dimension is that of the base to an exact power."""
    exact = {unit: own * _exact(power) for unit, own in base.unit_items()}
    return base._REGISTRY.Quantity(magnitude, pint.util.UnitsContainer(exact, non_int_type=Fraction))


def _root(function: Callable[..., Any], degree: int, values: Any) -> Any:
    is_quantity = hasattr(values, "m_as")
    return _raised(values, 1 / degree, function(values.magnitude)) if is_quantity else function(values)


def _normal_probability(x: Any) -> Any:
    return ndtr(_pure(x))


def _alike(equality: Callable[..., Any], first: Any, second: Any) -> Any:
    """Compare what may be compared at all: pint from 0.26 on calls quantities of unlike dimensions unequal."""
    if hasattr(first, "m_as") or hasattr(second, "m_as"):
        np.less(first, second)
    return equality(first, second)


OPERATORS: Mapping[str, Callable[..., Any]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": _power,
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
    "==": partial(_alike, np.equal), "!=": partial(_alike, np.not_equal),
}  # fmt: skip
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **{name: getattr(np, name) for name in ("exp", "log", "log10", "abs", "sign", "sin", "cos")},
    "sqrt": partial(_root, np.sqrt, 2),
    "cbrt": partial(_root, np.cbrt, 3),
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
    "Phi": _normal_probability,
    "sum": lambda x: _over_last_axis(np.sum, x),
    "mean": lambda x: _over_last_axis(np.mean, x),
    "either": lambda first, second: np.where(np.isnan(first), second, first),
}


def _over_last_axis(function: Callable[..., Any], values: Any) -> Any:
    return function(values, axis=-1) if np.ndim(values) else values


# The proof of dimensions: a formula evaluated with pint quantities


def evaluate_quantities(formula: Formula, values: Mapping[str, pint.Quantity[Any]]) -> pint.Quantity[Any]:
    """Evaluate a formula with units and prove its dimensions; the quantity comes back in base units.

    Angles count as pure numbers (a radian is one). A literal 0 fits every dimension: ``max(x, 0)``, ``x > 0``. A power
    of a dimensional base needs one exponent for all points. Numbers without units are taken as pure numbers.
    An equation gives left minus right, after both sides were found to agree.

    Raises:
        UnitError: unlike dimensions meet, or a function that needs a pure number got something else; the sentence names
            the part of the formula.
        DeclarationError: a name of the formula has no value.
    """
    registries = (getattr(value, "_REGISTRY", None) for value in values.values())
    registry: Any = next(filter(None, registries), None) or shared_registry()
    held: dict[str, Any] = {}
    for name in formula.names:
        quantity = registry.Quantity(_held(formula, name, values)).to_base_units()
        exact = pint.util.UnitsContainer(_powers(quantity), non_int_type=Fraction)
        held[name] = registry.Quantity(np.asarray(quantity.magnitude, dtype=float), exact)
    equation = None if formula.left is None else ast.BinOp(formula.left, ast.Sub(), formula.right)
    try:
        with np.errstate(all="ignore"):
            found = registry.Quantity(value_of(equation or formula.right, held))
    except _UnlikeError as error:
        where = "the two sides of the equation" if error.node is equation else f"'{source(formula, error.node)}'"
        raise UnitError(f"formula {formula.text!r}: {where}: {error}") from None
    powers = _powers(found)
    units = {unit: int(power) if power.denominator == 1 else float(power) for unit, power in powers.items()}
    result: pint.Quantity[Any] = registry.Quantity(found.magnitude, registry.UnitsContainer(units))
    return result


def _powers(quantity: Any) -> dict[str, Fraction]:
    """Return the exponents of the units of a quantity, without radians and counts."""
    units = quantity._REGISTRY.Unit
    return {unit: _exact(power) for unit, power in quantity.unit_items() if not units(unit).dimensionless}


def _exact(exponent: Any) -> Fraction:
    return Fraction(exponent).limit_denominator(10**6)


_SHORT = {"meter": "m", "kilogram": "kg", "second": "s", "ampere": "A", "kelvin": "K", "mole": "mol", "candela": "cd"}


def _spoken(units: Any) -> str:
    """Say units, or what stands in their place, in the engineer's words: "a force", "a pure number"."""
    if isinstance(units, str):
        return "a pure number" if units == "dimensionless" else units
    dimension = getattr(units, "_units", units)
    if not dimension:
        return "a pure number"
    exponents = {_SHORT.get(unit, unit): _exact(power) for unit, power in sorted(dimension.items())}
    unit = "*".join(f"{unit}^{n if n.denominator == 1 else f'({n})'}" for unit, n in exponents.items())
    try:
        return human_dimension(unit)
    except UnitError:
        return unit
