"""The value of a formula: plain numpy on numbers or arrays."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from scipy.special import ndtr

from truing.errors import DeclarationError
from truing.formulas.tree import (
    CONSTANTS,
    Binary,
    Call,
    Comparison,
    Constant,
    Formula,
    Logic,
    Name,
    Negative,
    Node,
    NumberNode,
)


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
        case NumberNode(_, value):
            return np.float64(value)
        case Constant(name):
            return np.float64(CONSTANTS[name])
        case Name(name):
            return values[name]
        case Negative(operand):
            return -value_of(operand, values)
        case Binary(operator, left, right):
            return _operators()[operator](value_of(left, values), value_of(right, values))
        case Call("cases", arguments):
            return _cases(arguments, values)
        case Call(function, arguments):
            return _functions()[function](*(value_of(argument, values) for argument in arguments))
        case Comparison(operators, operands):
            sides = [value_of(operand, values) for operand in operands]
            links = [_operators()[sign](sides[i], sides[i + 1]) for i, sign in enumerate(operators)]
            return np.logical_and.reduce(np.broadcast_arrays(*links))
        case Logic(word, operands):
            parts = np.broadcast_arrays(*(value_of(operand, values) for operand in operands))
            return (np.logical_and if word == "and" else np.logical_or).reduce(parts)


def _cases(arguments: tuple[Node, ...], values: Mapping[str, Any]) -> Any:
    result = value_of(arguments[-1], values)
    for index in range(len(arguments) - 3, -1, -2):
        condition = value_of(arguments[index + 1], values)
        result = np.where(condition, value_of(arguments[index], values), result)
    return result


@cache
def _operators() -> dict[str, Callable[..., Any]]:
    return {
        "+": np.add,
        "-": np.subtract,
        "*": np.multiply,
        "/": np.divide,
        "**": np.power,
        "<": operator.lt,
        "<=": operator.le,
        ">": operator.gt,
        ">=": operator.ge,
        "==": operator.eq,
        "!=": operator.ne,
    }


@cache
def _functions() -> dict[str, Callable[..., Any]]:
    return {
        **{name: getattr(np, name) for name in ("sqrt", "cbrt", "exp", "log", "log10", "abs", "sign", "sin", "cos")},
        **{name: getattr(np, name) for name in ("tan", "sinh", "cosh", "tanh")},
        "cot": lambda x: 1 / np.tan(x),
        "asin": np.arcsin,
        "acos": np.arccos,
        "atan": np.arctan,
        "atan2": np.arctan2,
        "inv": lambda x: np.tan(x) - x,
        "hypot": lambda *sides: _pairwise(np.hypot, sides),
        "min": lambda *given: _pairwise(np.minimum, given) if len(given) > 1 else _over_last_axis(np.min, given[0]),
        "max": lambda *given: _pairwise(np.maximum, given) if len(given) > 1 else _over_last_axis(np.max, given[0]),
        "Phi": _normal_probability,
        "sum": lambda x: _over_last_axis(np.sum, x),
        "mean": lambda x: _over_last_axis(np.mean, x),
        "either": lambda first, second: np.where(np.isnan(first), second, first),
    }


def _normal_probability(x: Any) -> Any:
    """Return the chance that a standard normal value stays below x."""
    return ndtr(x)


def _pairwise(function: Callable[[Any, Any], Any], given: tuple[Any, ...]) -> Any:
    result = given[0]
    for other in given[1:]:
        result = function(result, other)
    return result


def _over_last_axis(function: Callable[..., Any], values: Any) -> Any:
    return function(values, axis=-1) if np.ndim(values) else values
