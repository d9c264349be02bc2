"""What a formula is made of: Python's own syntax tree as far as ``parsing`` lets it through, and what it may call."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Final, TypeAlias

Node: TypeAlias = ast.expr
"""A number (``ast.Constant`` of a float, its ``kind`` the text as written), a name, a minus, two operands, a call; in
conditions of ``cases`` also comparisons and what joins them."""


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
SIGNS: Final[Mapping[type[ast.AST], str]] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">",
    ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.And: "and", ast.Or: "or",
}  # fmt: skip
"""What joins operands, comparands and conditions."""

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


def children(node: Node) -> list[Node]:
    """Return the nodes directly below one, in the order of the text; the name of a function is none."""
    return node.args if isinstance(node, ast.Call) else expressions_in(node)


def expressions_in(node: ast.AST) -> list[ast.expr]:
    """Return the expressions directly below a node, in the order of the text: quickly for what formulas are made of."""
    match node:
        case ast.Name() | ast.Constant():
            return []
        case ast.BinOp(left, _, right):
            return [left, right]
        case ast.Call(function, arguments):
            return [function, *arguments]
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def walk(node: Node) -> Iterator[Node]:
    """Yield a node and everything below it."""
    yield node
    for child in children(node):
        yield from walk(child)


def source(formula: Formula, node: Node) -> str:
    """Return a part of a formula as its author wrote it: what sentences to the user quote."""
    return ast.get_source_segment(one_spaced(formula.text), node) or formula.text


def one_spaced(text: str) -> str:
    """Return a formula on one line with single spaces: the text that the places of its nodes count in."""
    return re.sub(r"[ \t\r\n]+", " ", text).strip()


def simplified(node: Node) -> Node:
    """Return the tree as it is printed, equal in value.

    ``hypot`` becomes a root of squares, ``a / b / c`` becomes ``a / (b * c)``, and a minus at the front of a product or
    a fraction goes before the whole.
    """
    match node:
        case ast.UnaryOp(sign, operand):
            return ast.UnaryOp(sign, simplified(operand))
        case ast.BinOp(left, (ast.Mult() | ast.Div()) as sign, right):
            return _simplified_product(sign, simplified(left), simplified(right))
        case ast.BinOp(left, sign, right):
            return ast.BinOp(simplified(left), sign, simplified(right))
        case ast.Call(ast.Name("hypot"), arguments):
            two = ast.Constant(2.0, "2")
            squares: list[Node] = [ast.BinOp(simplified(argument), ast.Pow(), two) for argument in arguments]
            return ast.Call(
                ast.Name("sqrt"), [reduce(lambda one, other: ast.BinOp(one, ast.Add(), other), squares)], []
            )
        case ast.Call(function, arguments):
            return ast.Call(function, list(map(simplified, arguments)), [])
        case ast.Compare(first, signs, others):
            return ast.Compare(simplified(first), signs, list(map(simplified, others)))
        case ast.BoolOp(joint, operands):
            return ast.BoolOp(joint, list(map(simplified, operands)))
    return node


def _simplified_product(sign: ast.operator, left: Node, right: Node) -> Node:
    match sign, left:
        case _, ast.UnaryOp(minus, operand):
            return ast.UnaryOp(minus, _simplified_product(sign, operand, right))
        case ast.Div(), ast.BinOp(above, ast.Div(), below):
            return ast.BinOp(above, sign, _simplified_product(ast.Mult(), below, right))
    return ast.BinOp(left, sign, right)
