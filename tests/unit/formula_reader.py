"""Reads printed formulas back, as a person would: only what is visible counts, no hidden grouping.

``<mrow>`` only groups, is invisible and therefore ignored; an exponent belongs to the one thing it stands on; what a
person could read in two ways is refused. The result is Python text for ``eval``.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

FUNCTIONS = {
    **{name: name for name in ("sin", "cos", "tan", "cot", "sinh", "cosh", "tanh", "inv", "exp", "min", "max", "mean")},
    **dict(zip(("ln", "arcsin", "arccos", "arctan"), ("log", "asin", "acos", "atan"), strict=True)),
    "atan2": "atan2",
    "sgn": "sign",
    "∑": "sum",
}
WORDS = {"if", "otherwise", "if given", "and", "or"}
COMPARISONS = {"=": "==", "≠": "!=", "<": "<", "≤": "<=", ">": ">", "≥": ">="}
INVISIBLE_TIMES = "\u2062"
Token = tuple[str, Any]


class MisprintError(Exception):
    """A person could not read this, or could read it in two ways."""


@dataclass
class Reader:
    """What the names look like in print, and which units may follow numbers."""

    names: Mapping[str, str]
    units: frozenset[str] = frozenset()
    tokens: list[Token] = field(default_factory=list)

    def python(self, tokens: Iterable[Token]) -> str:
        """Turn tokens into Python; an equation becomes a difference."""
        parser = Parser(list(tokens), self)
        left = parser.expression()
        if parser.at("op", "="):
            parser.take()
            left = f"(({left}) - ({parser.expression()}))"
        parser.end()
        return left

    def upright(self, text: str) -> Token:
        """Tell what an upright text is: a function, a word of the alternatives, a name, a unit."""
        bare = text.replace("\xa0", " ").strip()
        if bare in FUNCTIONS:
            return ("function", FUNCTIONS[bare])
        if bare in WORDS:
            return ("word", bare)
        if bare in self.units:
            return ("unit", bare)
        return ("name" if bare in self.names or len(bare) == 1 else "text", bare)

    def mathml(self, markup: str) -> str:
        """Read MathML."""
        return self.python(self.elements(ElementTree.fromstring(f"<r>{markup}</r>")))

    def elements(self, parent: Iterable[ElementTree.Element]) -> list[Token]:
        """Flatten all children into tokens."""
        return [token for child in parent for token in self.element(child)]

    def element(self, element: ElementTree.Element) -> list[Token]:
        """Turn one element into tokens."""
        text = "".join(element.itertext()).strip()
        parts = list(element)
        match element.tag:
            case "mrow":
                return self.elements(parts)
            case "mn":
                return [("number", text)]
            case "mi" | "mtext":
                return [self.upright(text)]
            case "mo":
                return self.operator(text, element)
            case "mspace":
                return []
            case "mfrac":
                above, below = (self.python(self.element(part)) for part in parts)
                return [("block", f"(({above}) / ({below}))")]
            case "msqrt":
                return [("block", f"sqrt({self.python(self.elements(parts))})")]
            case "mroot":
                assert parts[1].text == "3"
                return [("block", f"cbrt({self.python(self.element(parts[0]))})")]
            case "msub" if text == "log10":
                return [("function", "log10")]
            case "msub":
                return [("name", self.visible(parts[0]) + "_" + self.visible(parts[1]))]
            case "msup" | "msubsup":
                return self.raised(parts)
            case "mtable":
                rows = [[self.elements(cell) for cell in row] for row in element]
                return [("cases", rows)]
        raise MisprintError(f"element {element.tag} is not MathML Core as we use it")

    def visible(self, element: ElementTree.Element) -> str:
        return "".join(element.itertext()).strip()

    def operator(self, text: str, element: ElementTree.Element) -> list[Token]:
        if text == "\u2061":
            return []
        if text in "(|" and element.get("form") == "prefix":
            return [("open", text)]
        if text in ")|":
            return [("close", text)]
        if text == "∑":
            return [("function", "sum")]
        return [("op", {"−": "-", INVISIBLE_TIMES: "gap"}.get(text, text))]

    def raised(self, parts: list[ElementTree.Element]) -> list[Token]:
        *base, exponent = parts
        key = "_".join(self.visible(part) for part in base)
        if set(self.visible(exponent)) == {"′"}:
            return [("name", key + self.visible(exponent))]
        tokens = [("name", key)] if len(base) == 2 else self.element(base[0])
        return [*tokens, ("sup", self.element(exponent))]


@dataclass
class Parser:
    """The rules a reader has learnt at school."""

    tokens: list[Token]
    reader: Reader

    def at(self, kind: str, *values: str) -> bool:
        return bool(self.tokens) and self.tokens[0][0] == kind and (not values or self.tokens[0][1] in values)

    def take(self) -> Any:
        return self.tokens.pop(0)[1]

    def end(self) -> None:
        if self.tokens:
            raise MisprintError(f"left over: {self.tokens}")

    def expression(self) -> str:
        """Read terms joined by + and -; a sign may stand at the very front only."""
        result = self.signed_term()
        while self.at("op", "+", "-"):
            sign = self.take()
            result = f"{result} {sign} {self.term()}"
        return f"({result})"

    def signed_term(self) -> str:
        if self.at("op", "-"):
            self.take()
            return f"-{self.term()}"
        return self.term()

    def term(self) -> str:
        result, bare = self.factor()
        while self.at("op", "⋅", "×", "gap"):
            self.take()
            if bare and not self.at("function"):
                raise MisprintError("sin x y: what belongs to the sine?")
            factor, bare = self.factor()
            result = f"{result} * {factor}"
        return f"({result})"

    def factor(self) -> tuple[str, bool]:
        """Read one factor with its exponent or its unit."""
        if self.at("function"):
            return self.function()
        if self.at("op", "{"):
            self.take()
        kind = self.tokens[0][0] if self.tokens else "nothing"
        key = str(self.tokens[0][1]) if self.tokens else ""
        result = self.primary()
        if kind == "cases" and self.tokens and not self.at("close"):
            raise MisprintError("something goes on behind a brace that has no end")
        if self.at("sup"):
            if kind in ("block", "cases") or (kind == "name" and (set(key) & set(" ′Δ"))):
                raise MisprintError("an exponent on a fraction, a root or several words without parentheses")
            result = f"({result} ** {self.reader.python(self.take())})"
        if self.at("sup"):
            raise MisprintError("two exponents in a row")
        self.unit(kind)
        return result, False

    def unit(self, kind: str) -> None:
        if self.at("op", "gap") and len(self.tokens) > 1 and self.tokens[1][0] == "unit":
            self.take()
        if self.at("unit"):
            self.take()
            if kind != "number" or self.at("sup"):
                raise MisprintError("a unit without its number, or with an exponent that could be the number's")

    def primary(self) -> str:
        if self.at("number"):
            return f"N('{self.take()}')"
        if self.at("name"):
            key = self.take()
            if key == "Δ":
                key += self.take()
            return self.reader.names[key]
        if self.at("block"):
            return str(self.take())
        if self.at("open", "("):
            return self.bracketed("(")[0]
        if self.at("open", "|"):
            return f"abs({self.bracketed('|')[0]})"
        if self.at("cases"):
            return self.cases()
        raise MisprintError(f"cannot stand here: {self.tokens[:3]}")

    def bracketed(self, bracket: str) -> list[str]:
        assert self.take() == bracket
        parts = [self.expression()]
        while self.at("op", ","):
            self.take()
            if self.at("op", "gap"):
                self.take()
            parts.append(self.expression())
        if not self.at("close", ")" if bracket == "(" else bracket):
            raise MisprintError(f"a bracket is not closed: {self.tokens[:3]}")
        self.take()
        return parts

    def function(self) -> tuple[str, bool]:
        name = self.take()
        exponent = self.reader.python(self.take()) if self.at("sup") else ""
        if self.at("op", "gap"):
            self.take()
        bare = not self.at("open", "(")
        if bare and not (self.at("name") or self.at("number") or self.at("open", "|")):
            raise MisprintError("a function without parentheses takes one symbol or number")
        arguments = [self.primary()] if bare else self.bracketed("(")
        if self.at("sup"):
            raise MisprintError("sin x with an exponent behind: of the sine or of x?")
        result = f"{name}({', '.join(arguments)})"
        return (f"({result} ** {exponent})" if exponent else result), bare

    def cases(self) -> str:
        arguments = []
        rows = self.take()
        for value, condition in rows:
            word = condition[0][1]
            arguments.append(self.reader.python(value))
            if word == "if given":
                return f"either({arguments[0]}, {self.reader.python(rows[1][0])})"
            if word == "if":
                parser = Parser(condition[1:], self.reader)
                arguments.append(parser.alternatives())
                parser.end()
        return f"cases({', '.join(arguments)})"

    def alternatives(self) -> str:
        result = self.conjunction()
        while self.at("word", "or"):
            self.take()
            result = f"{result} or {self.conjunction()}"
        return f"({result})"

    def conjunction(self) -> str:
        result = self.comparison()
        while self.at("word", "and"):
            self.take()
            result = f"{result} and {self.comparison()}"
        return f"({result})"

    def comparison(self) -> str:
        if self.at("open", "(") and (inside := self.logic_in_parentheses()):
            return inside
        result = self.expression()
        while self.at("op", *COMPARISONS):
            result = f"{result} {COMPARISONS[self.take()]} {self.expression()}"
        return f"({result})"

    def logic_in_parentheses(self) -> str:
        """Read ``(a < b or c < d)`` if that is what the parentheses hold."""
        depth = 0
        for kind, value in self.tokens:
            depth += {"open": 1, "close": -1}.get(kind, 0)
            if depth == 1 and (kind == "word" or (kind == "op" and value in COMPARISONS)):
                self.take()
                result = self.alternatives()
                assert self.take() == ")"
                return result
            if depth == 0:
                break
        return ""
