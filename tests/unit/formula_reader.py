"""Reads printed formulas back, as a person would: only what is visible counts, no hidden grouping.

``<mrow>`` only groups, is invisible and therefore ignored: what it holds becomes Python text, whose rules for signs,
products, powers and conditions are those of school. An exponent belongs to the one thing it stands on, a function
without parentheses takes one symbol or number; what a person could read in two ways is refused.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

SAME_NAME = ("sin", "cos", "tan", "cot", "sinh", "cosh", "tanh", "inv", "exp", "min", "max", "mean", "atan2")
FUNCTIONS = dict(zip(SAME_NAME, SAME_NAME, strict=True)) | {
    "ln": "log", "log10": "log10", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "sgn": "sign", "∑": "sum",
}  # fmt: skip
WORDS = {"if", "if given", "otherwise"}
FUNCTION_APPLICATION, INVISIBLE_TIMES = "\u2061", "\u2062"
SIGNS = {
    "+": "+", "−": "-", "⋅": "*", "×": "*", INVISIBLE_TIMES: "*", "=": "==", "≠": "!=", "<": "<", "≤": "<=", ">": ">",
    "≥": ">=", ",": ",", "(": "(", ")": ")", "and": " and ", "or": " or ",
}  # fmt: skip
NOT_SEEN = {FUNCTION_APPLICATION, "{"}
Token = tuple[str, str]
"""Its kind and text: number, name, function, sign, exponent, unit, word, block (a fraction or a root), or cases."""


class MisprintError(Exception):
    """A person could not read this, or could read it in two ways."""


@dataclass(frozen=True)
class Reader:
    """What the names look like in print, and which units may follow numbers."""

    names: Mapping[str, str]
    units: frozenset[str] = frozenset()

    def mathml(self, markup: str) -> str:
        """Read MathML; an equation becomes a difference."""
        tokens = self.tokens(ElementTree.fromstring(f"<r>{markup}</r>"))
        if ("sign", "==") not in tokens:
            return self.python(tokens)
        middle = tokens.index(("sign", "=="))
        return f"({self.python(tokens[:middle])}) - ({self.python(tokens[middle + 1 :])})"

    def tokens(self, elements: Iterable[ElementTree.Element]) -> list[Token]:
        """Flatten elements into tokens."""
        return [token for element in elements for token in self.read(element)]

    def inside(self, *elements: ElementTree.Element) -> str:
        """Read what has a place of its own, such as below a bar or in an exponent."""
        return f"({self.python(self.tokens(elements))})"

    def read(self, element: ElementTree.Element) -> list[Token]:
        """Turn one element into tokens."""
        text = visible(element)
        parts = list(element)
        match element.tag:
            case "mrow":
                return self.tokens(parts)
            case "mn":
                return [("number", f"N('{text}')")]
            case "mi" | "mtext" | "mo":
                return self.text(text, element.get("form"))
            case "mspace":
                return []
            case "mfrac":
                return [("block", f"({self.inside(parts[0])} / {self.inside(parts[1])})")]
            case "msqrt":
                return [("block", f"sqrt{self.inside(*parts)}")]
            case "mroot" if visible(parts[1]) == "3":
                return [("block", f"cbrt{self.inside(parts[0])}")]
            case "msub" if text == "log10":
                return [("function", text)]
            case "msub":
                return [("name", "_".join(map(visible, parts)))]
            case "msup" | "msubsup":
                return self.raised(*parts)
            case "mtable":
                return [("cases", self.cases(element))]
        raise MisprintError(f"element {element.tag} is not MathML Core as we use it")

    def text(self, text: str, form: str | None) -> list[Token]:
        """Tell what a text is."""
        if text in NOT_SEEN:
            return []
        if text == "|":
            return [("sign", "abs(" if form == "prefix" else ")")]
        if text in SIGNS:
            return [("sign", SIGNS[text])]
        if text in FUNCTIONS:
            return [("function", FUNCTIONS[text])]
        return [("word" if text in WORDS else "unit" if text in self.units else "name", text)]

    def raised(self, *parts: ElementTree.Element) -> list[Token]:
        """Read an exponent, or the primes of a name."""
        *base, exponent = parts
        key = "_".join(map(visible, base))
        if set(visible(exponent)) == {"′"}:
            return [("name", key + visible(exponent))]
        tokens: list[Token] = [("name", key)] if len(base) == 2 else self.read(base[0])
        kind, text = tokens[-1]
        if kind in {"block", "cases", "exponent", "unit"} or (kind == "name" and set(text) & set(" ′")):
            raise MisprintError("an exponent on a fraction, a root or several words without parentheses, or on another")
        return [*tokens, ("exponent", f" ** {self.inside(exponent)}")]

    def cases(self, table: ElementTree.Element) -> str:
        """Read alternatives, each a value and what is said of it."""
        arguments = []
        for value, condition in table:
            (_, word), *said = self.tokens(condition)
            arguments.append(self.inside(*value))
            if word == "if given":
                return f"either({arguments[0]}, {self.inside(*table[1][0])})"
            if word == "if":
                arguments.append(f"({self.python(said)})")
        return f"cases({', '.join(arguments)})"

    def python(self, tokens: Iterable[Token]) -> str:
        """Turn tokens into Python text."""
        rest, pieces, before = list(tokens), [""], ""
        while rest:
            kind, text = rest.pop(0)
            if kind == "function":
                pieces.append(self.applied(text, rest))
            elif kind == "name":
                pieces.append(self.name(text, rest))
            elif kind == "unit" and before not in {"number", "exponent"}:
                raise MisprintError("a unit without its number")
            elif kind == "cases" and rest and rest[0] != ("sign", ")"):
                raise MisprintError("something goes on behind a brace that has no end")
            elif text == "-" and pieces[-1] in {"+", "-", "*"}:
                raise MisprintError("a sign behind a sign")
            elif kind != "unit":
                pieces.append(text)
            before = kind
        return "".join(pieces)

    def name(self, key: str, rest: list[Token]) -> str:
        """Read a name; a difference is two letters, which carry no exponent."""
        if key == "Δ":
            key += rest.pop(0)[1]
            if rest and rest[0][0] == "exponent":
                raise MisprintError("an exponent on two letters without parentheses")
        return self.names[key]

    def applied(self, function: str, rest: list[Token]) -> str:
        """Read the argument of a function, all within parentheses or bars, or one symbol or number."""
        exponent = rest.pop(0)[1] if rest[0][0] == "exponent" else ""
        taken = [rest.pop(0) for _ in range(enclosed(rest))]
        is_bare = taken[0] != ("sign", "(")
        argument = self.python(taken if is_bare else taken[1:-1])
        behind = [*rest[:2], ("end", ""), ("end", "")]
        if behind[0][0] == "exponent":
            raise MisprintError("sin x with an exponent behind: of the sine or of x?")
        if is_bare and behind[0] == ("sign", "*") and behind[1][0] != "function":
            raise MisprintError("sin x y: what belongs to the sine?")
        return f"{function}({argument}){exponent}"


def enclosed(tokens: list[Token]) -> int:
    """Return how many tokens stand within the parentheses or bars that begin here; 1 where none do."""
    depth = 0
    for count, (kind, text) in enumerate(tokens, start=1):
        depth += kind == "sign" and text in {"(", "abs("}
        depth -= kind == "sign" and text == ")"
        if not depth:
            if count == 1 and kind not in {"name", "number"}:
                raise MisprintError("a function without parentheses takes one symbol or number")
            return count
    raise MisprintError("a bracket is not closed")


def visible(element: ElementTree.Element) -> str:
    """Return the text of an element and of all that it holds."""
    return "".join(element.itertext()).replace("\xa0", " ").strip()
