"""A formula of a cell as the expression of a plugin: names instead of cells, ``**`` instead of ``^``."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from truing.heavy import openpyxl

FUNCTIONS = {
    **{name.upper(): name for name in ("sqrt", "sin", "cos", "tan", "abs", "min", "max", "exp", "log10")},
    "LN": "log",
}
"""Functions of a spreadsheet that a formula of a plugin has too, by what they are called there."""
_SIGNS: dict[str, ast.operator] = {
    "+": ast.Add(), "-": ast.Sub(), "*": ast.Mult(), "/": ast.Div(), "^": ast.Pow(),
}  # fmt: skip
_LEVELS = ("+-", "*/", "^")
"""What binds loosely to what binds tightly. All go from left to right, ``^`` too, and a minus binds tighter."""


def translated(text: str, name_of: Callable[[str], str]) -> str:
    """Return the formula of a cell, ``=C5*C6^2``, as the expression of a plugin, ``force * length**2``.

    ``name_of`` gives the name for a cell such as ``C5`` or ``Sheet!C5``, without ``$``. RADIANS is left out, as angles
    are in radians within a plugin. Raises ValueError with what cannot be translated, also as ``name_of`` raises it.
    """
    try:
        parts = openpyxl.Tokenizer(text).items
        tokens = _Tokens([part for part in parts if part.type != "WHITE-SPACE"], name_of)
        tree = _joined(tokens, 0)
    except (openpyxl.TokenizerError, IndexError, RecursionError):  # it takes an IndexError for a bracket too many
        raise ValueError("it cannot be read") from None
    if tokens.rest:
        raise ValueError(f"{tokens.rest[0].value} cannot be translated")
    return ast.unparse(tree).replace(" ** ", "**")


@dataclass
class _Tokens:
    """What is left of a formula, and the names of cells."""

    rest: list[Any]
    name_of: Callable[[str], str]

    def next_is(self, kind: str, values: str = "") -> bool:
        """Whether the next part is of a kind, and one of these signs."""
        return bool(self.rest) and self.rest[0].type == kind and (not values or self.rest[0].value in values)

    def take(self) -> Any:
        """Return the next part."""
        if not self.rest:
            raise ValueError("it ends too early")
        return self.rest.pop(0)


def _joined(tokens: _Tokens, level: int) -> ast.expr:
    if level == len(_LEVELS):
        return _signed(tokens)
    tree = _joined(tokens, level + 1)
    while tokens.next_is("OPERATOR-INFIX", _LEVELS[level]):
        sign = _SIGNS[tokens.take().value]
        tree = ast.BinOp(tree, sign, _joined(tokens, level + 1))
    return tree


def _signed(tokens: _Tokens) -> ast.expr:
    if tokens.next_is("OPERATOR-PREFIX"):
        is_minus = tokens.take().value == "-"
        operand = _signed(tokens)
        return ast.UnaryOp(ast.USub(), operand) if is_minus else operand
    tree = _operand(tokens)
    while tokens.next_is("OPERATOR-POSTFIX"):
        tokens.take()
        tree = ast.BinOp(tree, ast.Div(), ast.Constant(100))
    return tree


def _operand(tokens: _Tokens) -> ast.expr:
    token = tokens.take()
    if (token.type, token.subtype) == ("OPERAND", "NUMBER"):
        number = float(token.value)
        return ast.Constant(int(number) if number.is_integer() and abs(number) < 1e15 else number)
    if (token.type, token.subtype) == ("OPERAND", "RANGE"):
        return ast.Name(tokens.name_of(token.value.replace("$", "")))
    if (token.type, token.subtype) == ("PAREN", "OPEN"):
        tree = _joined(tokens, 0)
        _close(tokens)
        return tree
    if (token.type, token.subtype) == ("FUNC", "OPEN"):
        return _call(token.value.removesuffix("(").upper(), tokens)
    raise ValueError(f"{token.value} cannot be translated")


def _call(function: str, tokens: _Tokens) -> ast.expr:
    if function not in FUNCTIONS.keys() | {"PI", "RADIANS"}:
        raise ValueError(f"{function} cannot be translated")
    arguments: list[ast.expr] = []
    while not (tokens.next_is("FUNC") and tokens.rest[0].subtype == "CLOSE"):
        arguments.append(_joined(tokens, 0))
        if tokens.next_is("SEP"):
            tokens.take()
        elif not tokens.next_is("FUNC"):
            raise ValueError(f"{tokens.take().value} cannot be translated")
    _close(tokens)
    if len(arguments) != 1 and function not in {"PI", "MIN", "MAX"}:
        raise ValueError(f"{function} of {len(arguments)} arguments cannot be translated")
    if function == "PI":
        return ast.Name("pi")
    if function == "RADIANS":
        return arguments[0]
    return ast.Call(ast.Name(FUNCTIONS[function]), arguments, [])


def _close(tokens: _Tokens) -> None:
    token = tokens.take()
    if token.subtype != "CLOSE":
        raise ValueError(f"{token.value} cannot be translated")
