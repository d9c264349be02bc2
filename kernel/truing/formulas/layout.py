"""How a formula is set: where parentheses, fractions and multiplication dots go, once for every output language."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum
from itertools import pairwise
from typing import Final

from truing.formulas.symbols import read_number, read_symbol
from truing.formulas.tree import CONSTANTS, SIGNS, Formula, Node, simplified


@dataclass(frozen=True, kw_only=True)
class Writer:
    """The marks of one output language; what they are given is finished markup, but for names, texts and signs.

    ``symbol`` writes a declared symbol, with an exponent beside its subscript if there is one; ``quantity`` a number
    and its unit ("" for a pure number); ``infix`` joins two sides by a sign: + - dot gap , == != < <= > >= and or.
    ``function`` takes a printed name and an exponent directly on it (sin squared); ``applied`` joins function and
    argument, ``applied_bare`` one without parentheses; ``table`` sets rows of value and condition behind a brace.
    """

    opening: str = ""
    """What stands before a sign at the beginning of a line, so that it is set as a sign between two sides."""
    symbol: Callable[[str, str | None], str]
    word: Callable[[str], str]
    quantity: Callable[[str, str], str]
    pi: str
    minus: Callable[[str], str]
    infix: Callable[[str, str, str], str]
    parenthesised: Callable[[str], str]
    bars: Callable[[str], str]
    fraction: Callable[[str, str], str]
    power: Callable[[str, str], str]
    sqrt: Callable[[str], str]
    cbrt: Callable[[str], str]
    function: Callable[[str, str | None], str]
    applied: Callable[[str, str], str]
    applied_bare: Callable[[str, str], str]
    table: Callable[[Sequence[tuple[str, str]]], str]
    condition: Callable[[str], str]
    prose: Callable[[str], str]


class Binding(IntEnum):
    """How firmly a piece holds together; what is looser than its place asks gets parentheses."""

    CASES = 0
    OR = 1
    AND = 2
    COMPARISON = 3
    SUM = 4
    PRODUCT = 5
    TIGHT = 6
    ATOM = 7


class Edge(Enum):
    """What a piece shows to its neighbour in a product."""

    DIGIT = "digit"
    WORD = "word"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Markup:
    """Finished markup and what its surroundings must know of it."""

    markup: str
    level: Binding
    negative: bool = False
    begins: Edge = Edge.OTHER
    ends: Edge = Edge.OTHER


PRINTED: Final = {
    "log": "ln", "asin": "arcsin", "acos": "arccos", "atan": "arctan", "sign": "sgn", "sum": "∑", "Phi": "Φ",
}  # fmt: skip
"""Functions printed under another name."""

SQUARED_ON_NAME: Final = frozenset({"sin", "cos", "tan", "cot", "sinh", "cosh", "tanh"})
MAY_BE_BARE: Final = SQUARED_ON_NAME | {"asin", "acos", "atan", "log", "log10", "inv", "sum"}


@dataclass(frozen=True)
class Layout:
    """Sets formulas with one writer: in ``symbols``, or where ``numbers`` are given with these in their place.

    Both are by name; a number comes with its unit. What has neither is a word. Numbers have dots between all factors.
    """

    writer: Writer
    symbols: Mapping[str, str]
    numbers: Mapping[str, tuple[str, str]] | None = None

    def formula(self, formula: Formula) -> str:
        """Set an expression, or both sides of an equation."""
        right = self.piece(simplified(formula.right)).markup
        if formula.left is None:
            return right
        return self.writer.infix(self.at_least(simplified(formula.left), Binding.SUM).markup, "==", right)

    def piece(self, node: Node, *, bare: bool = True) -> Markup:
        """Set one node; ``bare`` lets a function stand without parentheses (``sin x``)."""
        match node:
            case ast.Constant(_, str() as text):
                return number_piece(text, self.writer.quantity(text, ""))
            case ast.Name(name):
                return Markup(self.writer.pi, Binding.ATOM) if name in CONSTANTS else self.leaf(name)
            case ast.UnaryOp(_, operand):
                inner = self.at_least(operand, Binding.PRODUCT, signed=False)
                return Markup(self.writer.minus(inner.markup), Binding.PRODUCT, negative=True)
            case ast.BinOp(left, (ast.Add() | ast.Sub()) as sign, right):
                return self.sum(SIGNS[type(sign)], left, right)
            case ast.BinOp(_, ast.Mult(), _):
                return self.product(node)
            case ast.BinOp(above, ast.Div(), below):
                return Markup(self.writer.fraction(self.piece(above).markup, self.piece(below).markup), Binding.TIGHT)
            case ast.BinOp(base, _, exponent):
                return self.power(base, exponent, bare=bare)
            case ast.Call(ast.Name(function), arguments):
                return self.call(function, arguments, bare=bare)
            case ast.Compare(first, signs, others):
                operands = [self.at_least(operand, Binding.SUM) for operand in (first, *others)]
                return Markup(self.chained(operands, [SIGNS[type(sign)] for sign in signs]), Binding.COMPARISON)
            case ast.BoolOp(joint, conditions):
                level = Binding.AND if isinstance(joint, ast.And) else Binding.OR
                operands = [self.at_least(condition, level) for condition in conditions]
                return Markup(self.chained(operands, [SIGNS[type(joint)]] * (len(operands) - 1)), level)
        raise AssertionError("parsing lets nothing else through")

    def leaf(self, name: str) -> Markup:
        """Set what stands for a quantity: its number, its symbol, else its name as a word."""
        if self.numbers is not None and name in self.numbers:
            number, unit = self.numbers[name]
            return number_piece(number, self.writer.quantity(number, unit), unit=unit)
        if self.numbers is None and (symbol := self.symbols.get(name)):
            is_plain = read_symbol(symbol).is_plain
            return Markup(self.writer.symbol(symbol, None), Binding.ATOM if is_plain else Binding.TIGHT)
        level = Binding.ATOM if "_" not in name else Binding.TIGHT
        return Markup(self.writer.word(name), level, begins=Edge.WORD, ends=Edge.WORD)

    def at_least(self, node: Node, level: Binding, *, signed: bool = True, bare: bool = True) -> Markup:
        """Set a node, in parentheses if it is looser than ``level`` or begins with a minus where none may stand."""
        piece = self.piece(node, bare=bare)
        if piece.level >= level and (signed or not piece.negative):
            return piece
        return Markup(self.writer.parenthesised(piece.markup), Binding.ATOM)

    def sum(self, sign: str, left: Node, right: Node) -> Markup:
        """Set a sum or a difference."""
        first = self.at_least(left, Binding.SUM)
        second = self.at_least(right, Binding.SUM if sign == "+" else Binding.PRODUCT, signed=False)
        return Markup(self.writer.infix(first.markup, sign, second.markup), Binding.SUM, negative=first.negative)

    def product(self, node: Node) -> Markup:
        """Set all factors in a row: a thin gap where it reads well, a dot beside digits and words."""
        row = factors(node)
        pieces = []
        for index, factor in enumerate(row):
            bare = index == len(row) - 1 or begins_with_function(row[index + 1])
            pieces.append(self.at_least(factor, Binding.PRODUCT, signed=index == 0, bare=bare))
        dots = (
            self.numbers is not None or after.begins is not Edge.OTHER or before.ends is Edge.WORD
            for before, after in pairwise(pieces)
        )  # fmt: skip
        markup = self.chained(pieces, ["dot" if dot else "gap" for dot in dots])
        return Markup(markup, Binding.PRODUCT, pieces[0].negative, begins=pieces[0].begins, ends=pieces[-1].ends)

    def power(self, base: Node, exponent: Node, *, bare: bool) -> Markup:
        """Set a power: on the name of sin and its like, beside a subscript, or on a base in parentheses."""
        raised = self.piece(exponent).markup
        match base:
            case ast.Call(ast.Name(function), arguments) if function in SQUARED_ON_NAME and is_small_count(exponent):
                return self.applied(self.function(function, raised), arguments[0], may_be_bare=bare)
        symbol = self.symbols.get(base.id) if isinstance(base, ast.Name) and self.numbers is None else None
        if symbol and read_symbol(symbol).is_plain:
            return Markup(self.writer.symbol(symbol, raised), Binding.TIGHT)
        below = self.at_least(base, Binding.ATOM, signed=False)
        return Markup(self.writer.power(below.markup, raised), Binding.TIGHT, begins=below.begins)

    def call(self, function: str, arguments: Sequence[Node], *, bare: bool) -> Markup:
        """Set a function, a root, absolute bars, or alternatives."""
        if function == "cases":
            return self.cases(arguments)
        if function == "either":
            return self.either(*arguments)
        if function in ("sqrt", "cbrt"):
            root = self.writer.sqrt if function == "sqrt" else self.writer.cbrt
            return Markup(root(self.piece(arguments[0]).markup), Binding.TIGHT)
        if function == "abs":
            return Markup(self.writer.bars(self.piece(arguments[0]).markup), Binding.ATOM)
        head = self.function(function)
        if len(arguments) == 1:
            return self.applied(head, arguments[0], may_be_bare=bare and function in MAY_BE_BARE)
        inner = self.chained([self.at_least(each, Binding.SUM) for each in arguments], [","] * (len(arguments) - 1))
        return Markup(self.writer.applied(head, self.writer.parenthesised(inner)), Binding.TIGHT)

    def function(self, name: str, exponent: str | None = None) -> str:
        """Set the name of a function."""
        return self.writer.function(PRINTED.get(name, name), exponent)

    def applied(self, head: str, argument: Node, *, may_be_bare: bool) -> Markup:
        """Set a function of one argument."""
        piece = self.piece(argument)
        if may_be_bare and piece.level is Binding.ATOM and piece.ends is not Edge.WORD:
            return Markup(self.writer.applied_bare(head, piece.markup), Binding.TIGHT)
        return Markup(self.writer.applied(head, self.writer.parenthesised(piece.markup)), Binding.TIGHT)

    def chained(self, operands: Sequence[Markup], signs: Sequence[str]) -> str:
        """Join operands by the signs between them."""
        markup = operands[0].markup
        for sign, operand in zip(signs, operands[1:], strict=True):
            markup = self.writer.infix(markup, sign, operand.markup)
        return markup

    def cases(self, arguments: Sequence[Node]) -> Markup:
        """Set alternatives behind a brace."""
        conditions = [self.writer.condition(self.piece(condition).markup) for condition in arguments[1::2]]
        return self.alternatives(arguments[::2], [*conditions, self.writer.prose("otherwise")])

    def either(self, first: Node, second: Node) -> Markup:
        """Set "the first if it is given, otherwise the second"; with numbers at hand only the one that counts."""
        if self.numbers is not None and isinstance(first, ast.Name) and first.id in self.numbers:
            return self.piece(first if read_number(self.numbers[first.id][0]) is not None else second)
        return self.alternatives((first, second), [self.writer.prose("if given"), self.writer.prose("otherwise")])

    def alternatives(self, values: Sequence[Node], conditions: Sequence[str]) -> Markup:
        """Set values behind a brace, each with what is said of it."""
        markups = [self.piece(value).markup for value in values]
        return Markup(self.writer.table(list(zip(markups, conditions, strict=True))), Binding.CASES)


def factors(node: Node) -> list[Node]:
    """Return what a product multiplies, in order."""
    match node:
        case ast.BinOp(left, ast.Mult(), right):
            return factors(left) + factors(right)
    return [node]


def begins_with_function(node: Node) -> bool:
    """Tell whether a factor begins with the name of a function, so that ``sin x cos y`` cannot be misread."""
    match node:
        case ast.Call(ast.Name(function), _):
            return function in MAY_BE_BARE
        case ast.BinOp(ast.Call(ast.Name(function), _), ast.Pow(), exponent):
            return function in SQUARED_ON_NAME and is_small_count(exponent)
    return False


def is_small_count(exponent: Node) -> bool:
    """Tell whether an exponent may stand on a function's name: a whole number (-1 would be an inverse)."""
    return isinstance(exponent, ast.Constant) and (exponent.kind or "").isdigit()


def number_piece(text: str, markup: str, *, unit: str = "") -> Markup:
    """Wrap a printed number: how firmly it holds depends on its sign, power of ten and unit."""
    number = read_number(text)
    if number is None:
        return Markup(markup, Binding.OR, begins=Edge.WORD, ends=Edge.WORD)
    loose = unit or number.negative or number.exponent
    level = Binding.PRODUCT if loose else Binding.ATOM
    return Markup(markup, level, number.negative, begins=Edge.DIGIT)


def symbolic(writer: Writer, formula: Formula, symbols: Mapping[str, str]) -> str:
    """Set a formula in symbols."""
    return Layout(writer, symbols).formula(formula)


def substituted(writer: Writer, formula: Formula, numbers: Mapping[str, tuple[str, str]]) -> str:
    """Set a formula with the numbers in place of the symbols."""
    return Layout(writer, {}, numbers).formula(formula)
