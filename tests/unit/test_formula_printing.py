"""The printed formula is the computed one: random formulas are printed, read back by eye's rules, and compared.

The comparison is exact: numbers live in a finite field (modulo a prime of 61 bits), functions are arbitrary maps
of it, so a misplaced parenthesis changes the answer almost surely and rounding cannot hide it. MathML is read here and
plain text in ``test_formula_text``; the marks of LaTeX, which stand in the same places, are in ``test_formula_marks``.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from formula_printed import mathml, substituted_mathml
from formula_reader import Reader
from hypothesis import example, given, settings
from hypothesis import strategies as st

from truing.formulas import parse
from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_text import HOLD, TEXT, folded

SYMBOLS = {"load": "F", "early": "h_0", "angle": "theta_11", "way": "Delta z", "teeth": "z_2'", "limit": "F_N,max"}
SYMBOLS |= {"ratio": "xi_lh", "rate": "k_R"}
SEEN = {"F": "load", "h_0": "early", "θ_11": "angle", "Δz": "way", "z_2′": "teeth", "F_N,max": "limit"}
SEEN |= {"ξ_lh": "ratio", "k_R": "rate", "outer radius": "outer_radius", "width": "width", "π": "pi"}
NAMES = [*SYMBOLS, "outer_radius", "width"]
UNARY = ["sqrt", "cbrt", "exp", "log", "log10", "abs", "sign", "sin", "cos", "tan", "cot", "asin", "acos", "atan"]
UNARY += ["sinh", "cosh", "tanh", "inv", "sum", "mean", "min", "max"]
PRIME = 2**61 - 1


class Residue:
    """A number modulo a prime, with Python's operators."""

    def __init__(self, value: int) -> None:
        self.value = value % PRIME

    def __add__(self, other: Residue) -> Residue:
        return Residue(self.value + other.value)

    def __sub__(self, other: Residue) -> Residue:
        return Residue(self.value - other.value)

    def __mul__(self, other: Residue) -> Residue:
        return Residue(self.value * other.value)

    def __truediv__(self, other: Residue) -> Residue:
        return Residue(self.value * pow(other.value, PRIME - 2, PRIME))

    def __neg__(self) -> Residue:
        return Residue(-self.value)

    def __pow__(self, other: Residue) -> Residue:
        exponent = other.value if other.value < 1000 else other.value - PRIME
        if abs(exponent) < 1000:
            return Residue(pow(self.value, exponent % (PRIME - 1), PRIME))
        return some_map("power")(self, other)

    def __lt__(self, other: Residue) -> bool:
        return self.value < other.value

    def __le__(self, other: Residue) -> bool:
        return self.value <= other.value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Residue) and self.value == other.value

    def __hash__(self) -> int:
        return self.value


def number(text: str) -> Residue:
    exact = Fraction(text)
    return Residue(exact.numerator) / Residue(exact.denominator)


def some_map(name: str) -> Callable[..., Residue]:
    """An arbitrary function of residues, different for every name and sensitive to the order of its arguments."""
    seed = zlib.crc32(name.encode()) + 2

    def mapped(*arguments: Residue) -> Residue:
        total = seed
        for argument in arguments:
            total = (total * seed + argument.value) % PRIME
            total = (total * total * total + seed) % PRIME
        return Residue(total)

    return mapped


def choose(*arguments: Any) -> Any:
    for value, condition in zip(arguments[:-1:2], arguments[1::2], strict=True):
        if condition:
            return value
    return arguments[-1]


EXACT: dict[str, Any] = {name: some_map(name) for name in [*UNARY, "atan2", "either"]}
EXACT |= {"cases": choose, "N": number, "pi": some_map("pi")()}
EXACT |= {"hypot": lambda x, y: EXACT["sqrt"](x * x + y * y)}
EXACT |= {name: some_map(f"value of {name}")() for name in NAMES}


def exact(text: str, **names: Any) -> Residue:
    with_numbers = re.sub(r"(?<![\w.'])(\d+(?:\.\d+)?(?:e-?\d+)?)(?!')", r"N('\1')", text)
    result = eval(with_numbers, {"__builtins__": {}}, {**EXACT, **names})
    assert isinstance(result, Residue)
    return result


LEAVES = st.sampled_from([*NAMES, *NAMES, "2", "3", "0.5", "10", "1.5", "1e-3", "pi"])
KINDS = st.sampled_from(["leaf", "binary", "binary", "binary", "power", "minus", "unary", "pair", "cases"])


@st.composite
def expressions(draw: st.DrawFn, depth: int = 4) -> str:
    """Random formulas with a parenthesis around every operand, so that printing may keep none of them by chance."""

    def inner() -> str:
        return draw(expressions(depth - 1))

    match draw(KINDS) if depth else "leaf":
        case "leaf":
            return draw(LEAVES)
        case "binary":
            return f"({inner()}) {draw(st.sampled_from('+-*/'))} ({inner()})"
        case "power":
            exponent = draw(st.sampled_from(["2", "3", "-1", "0.5", ""]))
            return f"({inner()}) ** ({exponent or inner()})"
        case "minus":
            return f"-({inner()})"
        case "unary":
            return f"{draw(st.sampled_from(UNARY))}({inner()})"
        case "pair":
            return f"{draw(st.sampled_from(['min', 'max', 'atan2', 'hypot', 'either']))}({inner()}, {inner()})"
    more = f"{inner()}, {draw(conditions(depth - 1))}, " if draw(st.booleans()) else ""
    return f"cases({inner()}, {draw(conditions(depth - 1))}, {more}{inner()})"


@st.composite
def conditions(draw: st.DrawFn, depth: int) -> str:
    """Random comparisons, chained or joined."""
    sides = [f"({draw(expressions(min(depth, 1)))})" for _ in range(3)]
    signs = [draw(st.sampled_from(["<", "<=", ">", ">=", "==", "!="])) for _ in range(2)]
    if depth and draw(st.booleans()):
        return f"({draw(conditions(depth - 1))}) {draw(st.sampled_from(['and', 'or']))} ({draw(conditions(depth - 1))})"
    return f"{sides[0]} {signs[0]} {sides[1]}" + (f" {signs[1]} {sides[2]}" if draw(st.booleans()) else "")


TRAPS = ["load - (rate - width)", "load - (rate + width)", "(load + rate) * width", "-(load + rate)", "(-load)**2"]
TRAPS += ["-load**2", "(load / rate)**2", "2**-load", "(load**rate)**2", "load**rate**2", "load / rate / width"]
TRAPS += ["load / (rate / width)", "sin(load)**2 * rate", "sin(load)**-1", "sin(load**2)", "sin(load * rate) * width"]
TRAPS += ["sin(load) * width", "sin(load) * cos(rate) * width", "-load * -rate", "load + -rate * width", "way**2"]
TRAPS += ["load + (-rate + width)", "load * (-rate) * width", "sqrt(load)**2", "teeth**2", "outer_radius**2", "pi**2"]
TRAPS += ["(2 * load) * 3", "2 * 3", "1e-3**2", "1e-3 * load", "load * 2 ** 3", "log10(load)**2", "exp(load)**2"]
TRAPS += ["max(load, rate)**2", "cases(load, rate < 2, width) + 1", "abs(load)**2", "abs(abs(load) - abs(rate))"]
TRAPS += ["cases(load, (rate < 1 or rate > 2) and width < 3, rate)", "sum(load) * rate", "sin(outer_radius) * load"]
TRAPS += ["(load * rate)**2", "-(-load)", "-(load * rate) + width", "sin(-load)", "load**(1 / 3)", "(-load)**2 / -rate"]
TRAPS += [
    "sin(2) * 3",
    "sin(load) * sin(rate)**-1",
    "sin(load) * sin(rate)**2",
    "hypot(load, rate)**2",
    "sin(cos(load))",
]


def traps(*seconds: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Try every trap in any case, each with every one of the further arguments."""

    def decorate(function: Callable[..., None]) -> Callable[..., None]:
        for text in TRAPS:
            for more in [(second,) for second in seconds] or [()]:
                function = example(text, *more)(function)
        return function

    return decorate


@traps()
@given(expressions())
@settings(max_examples=100, deadline=None)
def test_symbols_read_back_exactly(text: str) -> None:
    reader = Reader(SEEN)
    formula = parse(text)
    wanted = exact(text)
    assert exact(reader.mathml(mathml(formula, SYMBOLS))) == wanted


UNITS = frozenset({"N·m", "mm", "°", "GPa", "%"})
SHOWN = ["360", "2.5", "-12.5", "1.2e-05", "-3.4E+7", "0.001", "-0"]


@traps([("-12.5", "mm")] * 10, [("-2.5", "")] * 10, [("1.2e-05", "")] * 10, [("360", "")] * 10, [("-3.4E+7", "°")] * 10)
@given(expressions(), st.lists(st.tuples(st.sampled_from(SHOWN), st.sampled_from(["", *UNITS])), min_size=len(NAMES)))
@settings(max_examples=100, deadline=None)
def test_numbers_read_back_exactly(text: str, shown: list[tuple[str, str]]) -> None:
    numbers = dict(zip(NAMES, shown, strict=False))
    formula = parse(text)
    values: dict[str, Any] = {name: number(shown) for name, (shown, _) in numbers.items()}
    values["either"] = lambda first, second: first
    wanted = exact(text, **values)
    reader = Reader({"π": "pi"}, UNITS)
    assert exact(reader.mathml(substituted_mathml(formula, numbers)), **values) == wanted


# A formula on one line of a terminal is the computed one: it is read back by the rules of plain text, and compared.

SPELLED = {"ln": "log", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "sgn": "sign", "∑": "sum", "√": "sqrt"}
SPELLED |= {"∛": "cbrt"}
SIGNS = {" · ": " * ", "−": "-", "^": "**", "≤": "<=", "≥": ">=", "≠": "!=", " = ": " == ", "π": "pi"}
LOWERED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
TEXT_UNITS = ["N·m", "mm", "GPa", "%", "N/mm", "°"]


def closed(text: str, start: int) -> int:
    """The place behind the parenthesis or brace that closes the one at ``start``."""
    depth = 0
    for place in range(start, len(text)):
        depth += (text[place] in "({") - (text[place] in ")}")
        if not depth:
            return place + 1
    raise AssertionError(f"never closed: {text}")


def parts(text: str, separator: str) -> list[str]:
    """The parts of a text between separators that stand in no parentheses."""
    found, depth, start = [], 0, 0
    for place, character in enumerate(text):
        depth += (character in "({") - (character in ")}")
        if not depth and text.startswith(separator, place):
            found.append(text[start:place])
            start = place + len(separator)
    return [*found, text[start:]]


def unbraced(text: str) -> str:
    """Alternatives in braces, as calls of ``cases`` and ``either``."""
    while "{" in text:
        start = text.rindex("{")
        end = closed(text, start)
        rows = parts(text[start + 2 : end - 2], "; ")
        last = rows.pop().removesuffix(" otherwise")
        if rows[0].endswith(" if given"):
            call = f"either({rows[0].removesuffix(' if given')}, {last})"
        else:
            said = [parts(row, " if ") for row in rows]
            call = "cases(" + "".join(f"{value}, {condition}, " for value, condition in said) + f"{last})"
        text = text[:start] + call + text[end:]
    return text


def python_of(text: str, names: dict[str, str]) -> str:
    """Read a line as its reader does: products before sums, a raised number or caret before both."""
    text = unbraced(text)
    while found := re.search(r"([a-z]+\d*)([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)\(", text):
        end = closed(text, found.end() - 1)
        text = f"{text[: found.start()]}({found[1]}{text[found.end() - 1 : end]}){found[2]}{text[end:]}"
    for name in sorted(names, key=len, reverse=True):
        text = re.sub(rf"(?<![\w,]){re.escape(name)}(?![\w,′]\w|′)", names[name], text)
    text = re.sub(r"·10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda found: "e" + found[1].translate(LOWERED), text)
    text = re.sub(r"[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+", lambda found: f"**({found[0].translate(LOWERED)})", text)
    text = re.sub(r"\|([^|]*)\|", r"abs(\1)", text)
    for sign, spelled in {**SPELLED, **SIGNS}.items():
        text = re.sub(rf"(?<![a-z]){sign}(?=\()", spelled, text) if sign in SPELLED else text.replace(sign, spelled)
    return text


@traps()
@given(expressions())
@settings(max_examples=15, deadline=None)
def test_a_line_of_symbols_reads_back_exactly(text: str) -> None:
    line = symbolic(TEXT, parse(text), SYMBOLS)
    assert exact(python_of(line, {**SEEN, "outer_radius": "outer_radius"})) == exact(text), line


@traps([("-12.5", "mm")] * 10, [("1.2e-05", "")] * 10)
@given(
    expressions(), st.lists(st.tuples(st.sampled_from(SHOWN), st.sampled_from(["", *TEXT_UNITS])), min_size=len(NAMES))
)
@settings(max_examples=15, deadline=None)
def test_a_line_of_numbers_reads_back_exactly(text: str, shown: list[tuple[str, str]]) -> None:
    numbers = dict(zip(NAMES, shown, strict=False))
    values: dict[str, Any] = {name: number(shown) for name, (shown, _) in numbers.items()}
    values["either"] = lambda first, second: first
    line = substituted(TEXT, parse(text), numbers)
    bare = re.sub(f"{HOLD}(?:{'|'.join(map(re.escape, TEXT_UNITS))})(?![a-z])|°", "", line)
    assert exact(python_of(bare, {}), **values) == exact(text, **values), line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("load / (rate * width)", "F / (k_R · width)"),
        ("sqrt(load**2 + rate**2)", "√(F² + k_R²)"),
        ("load / rate * width", "(F / k_R) · width"),
        ("cases(load, rate < 2, width)", "{ F if k_R < 2; width otherwise }"),
        ("inv(load) == rate + width", "inv(F) = k_R + width"),
        ("-teeth**2 / pi", "−(z_2′)² / π"),
    ],
)
def test_a_line_looks_as_it_should(text: str, line: str) -> None:
    assert symbolic(TEXT, parse(text), SYMBOLS) == line


def test_a_long_line_is_broken_before_signs_and_never_between_number_and_unit() -> None:
    numbers = dict.fromkeys(NAMES, ("123.45", "N/mm"))
    line = substituted(TEXT, parse(" + ".join(f"2 * {name}" for name in NAMES)), numbers)
    lines = list(folded(line, 30))
    assert " ".join(lines) == line
    assert max(map(len, lines)) <= 30
    assert all(part.startswith(("+", "·")) for part in lines[1:])
    assert all(part.count("123.45") == part.count(f"123.45{HOLD}N/mm") for part in lines)
