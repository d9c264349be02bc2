"""What a formula is made of: a small tree of frozen nodes, and the functions it may call."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce
from typing import Final, TypeAlias


@dataclass(frozen=True, slots=True)
class NumberNode:
    """A number written in the formula; the text is kept as its author wrote it."""

    text: str
    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A quantity, called by its name."""

    name: str


@dataclass(frozen=True, slots=True)
class Constant:
    """A number that has a name of its own: pi."""

    name: str


@dataclass(frozen=True, slots=True)
class Negative:
    """Minus the operand."""

    operand: Node


@dataclass(frozen=True, slots=True)
class Binary:
    """Two operands joined by ``+``, ``-``, ``*``, ``/`` or ``**``."""

    operator: str
    left: Node
    right: Node


@dataclass(frozen=True, slots=True)
class Call:
    """A known function and its arguments."""

    function: str
    arguments: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Comparison:
    """``a < b``, or a chain ``a < b <= c``; stands only as a condition of ``cases``."""

    operators: tuple[str, ...]
    operands: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Logic:
    """Conditions joined by ``and`` or ``or``; stands only as a condition of ``cases``."""

    operator: str
    operands: tuple[Node, ...]


Node: TypeAlias = NumberNode | Name | Constant | Negative | Binary | Call | Comparison | Logic


@dataclass(frozen=True)
class Formula:
    """An expression, or an equation with two sides.

    ``left`` is None unless the text is an equation; ``names`` holds every quantity name used.
    """

    text: str
    left: Node | None
    right: Node
    names: frozenset[str]


CONSTANTS: Final = {"pi": 3.141592653589793}

ANY_NUMBER: Final = 10**6
ARGUMENTS: Final[dict[str, tuple[int, int]]] = {
    **dict.fromkeys(("sqrt", "cbrt", "exp", "log", "log10", "abs", "sign"), (1, 1)),
    **dict.fromkeys(("sin", "cos", "tan", "cot", "asin", "acos", "atan", "sinh", "cosh", "tanh", "inv"), (1, 1)),
    **dict.fromkeys(("sum", "mean", "Phi"), (1, 1)),
    **dict.fromkeys(("atan2", "either"), (2, 2)),
    "hypot": (2, ANY_NUMBER),
    **dict.fromkeys(("min", "max"), (1, ANY_NUMBER)),
    "cases": (3, ANY_NUMBER),
}
"""How many arguments each function takes, at least and at most."""


def children(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly below one."""
    match node:
        case Negative(operand):
            return (operand,)
        case Binary(_, left, right):
            return (left, right)
        case Call(_, arguments):
            return arguments
        case Comparison(_, operands) | Logic(_, operands):
            return operands
    return ()


def walk(node: Node) -> Iterator[Node]:
    """Yield a node and everything below it."""
    yield node
    for child in children(node):
        yield from walk(child)


BINDING: Final = {"or": 1, "and": 2, "compare": 3, "+": 4, "-": 4, "*": 5, "/": 5, "negative": 6, "**": 7}
_ATOM: Final = 8


def source(node: Node) -> str:
    """Write a node as a declaration would: the text that sentences to the user quote."""
    return _source(node)[0]


def _source(node: Node) -> tuple[str, int]:
    match node:
        case NumberNode(text, _):
            return text, _ATOM
        case Name(name) | Constant(name):
            return name, _ATOM
        case Negative(operand):
            return f"-{_bound(operand, BINDING['negative'])}", BINDING["negative"]
        case Binary(operator, left, right):
            level = BINDING[operator]
            if operator == "**":
                return f"{_bound(left, _ATOM)}**{_bound(right, BINDING['negative'])}", level
            return f"{_bound(left, level)} {operator} {_bound(right, level + 1)}", level
        case Call(function, arguments):
            return f"{function}({', '.join(source(argument) for argument in arguments)})", _ATOM
        case Comparison(operators, operands):
            parts = [_bound(operands[0], BINDING["+"])]
            for operator, operand in zip(operators, operands[1:], strict=True):
                parts += [operator, _bound(operand, BINDING["+"])]
            return " ".join(parts), BINDING["compare"]
        case Logic(operator, operands):
            level = BINDING[operator]
            return f" {operator} ".join(_bound(operand, level + 1) for operand in operands), level


def _bound(node: Node, at_least: int) -> str:
    text, level = _source(node)
    return text if level >= at_least else f"({text})"


def simplified(node: Node) -> Node:
    """Return the tree as it is printed, equal in value.

    ``hypot`` becomes a root of squares, ``a / b / c`` becomes ``a / (b * c)``, and a minus at the front of a product or
    a fraction goes before the whole.
    """
    match node:
        case Negative(operand):
            return Negative(simplified(operand))
        case Binary("*" | "/" as operator, left, right):
            return _simplified_product(operator, simplified(left), simplified(right))
        case Binary(operator, left, right):
            return Binary(operator, simplified(left), simplified(right))
        case Call("hypot", arguments):
            squares = (Binary("**", simplified(argument), NumberNode("2", 2.0)) for argument in arguments)
            return Call("sqrt", (reduce(lambda total, square: Binary("+", total, square), squares),))
        case Call(function, arguments):
            return Call(function, tuple(simplified(argument) for argument in arguments))
        case Comparison(_, operands) | Logic(_, operands):
            return replace(node, operands=tuple(simplified(operand) for operand in operands))
    return node


def _simplified_product(operator: str, left: Node, right: Node) -> Node:
    match operator, left:
        case _, Negative(operand):
            return Negative(_simplified_product(operator, operand, right))
        case "/", Binary("/", above, below):
            return Binary("/", above, _simplified_product("*", below, right))
    return Binary(operator, left, right)
