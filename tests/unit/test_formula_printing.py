"""The printed formula is the computed one: random formulas are printed, read back by eye's rules, and compared.

The comparison is exact: numbers live in a finite field (modulo a prime of 61 bits), functions are arbitrary maps
of it, so a misplaced parenthesis changes the answer almost surely and rounding cannot hide it. MathML is read here, and
OMML must show the same; the marks of LaTeX, which stand in the same places, are in ``test_formula_marks``.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from formula_reader import Reader
from formulas_shown import shown_by_mathml, shown_by_omml
from hypothesis import example, given, settings
from hypothesis import strategies as st

from truing.formulas import parse
from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_mathml import MATHML
from truing.formulas.write_omml import OMML
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


TRAPS = [
    "load - (rate - width)", "load - (rate + width)", "(load + rate) * width", "-(load + rate)", "(-load)**2",
    "-load**2", "(load / rate)**2", "2**-load", "(load**rate)**2", "load**rate**2", "load / rate / width",
    "load / (rate / width)", "sin(load)**2 * rate", "sin(load)**-1", "sin(load**2)", "sin(load * rate) * width",
    "sin(load) * width", "sin(load) * cos(rate) * width", "-load * -rate", "load + -rate * width", "way**2",
    "load + (-rate + width)", "load * (-rate) * width", "sqrt(load)**2", "teeth**2", "outer_radius**2", "pi**2",
    "(2 * load) * 3", "2 * 3", "1e-3**2", "1e-3 * load", "load * 2 ** 3", "log10(load)**2", "exp(load)**2",
    "max(load, rate)**2", "cases(load, rate < 2, width) + 1", "abs(load)**2", "abs(abs(load) - abs(rate))",
    "cases(load, (rate < 1 or rate > 2) and width < 3, rate)", "sum(load) * rate", "sin(outer_radius) * load",
    "(load * rate)**2", "-(-load)", "-(load * rate) + width", "sin(-load)", "load**(1 / 3)", "(-load)**2 / -rate",
    "sin(2) * 3", "sin(load) * sin(rate)**-1", "sin(load) * sin(rate)**2", "hypot(load, rate)**2", "sin(cos(load))",
]  # fmt: skip


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
    assert exact(reader.mathml(symbolic(MATHML, formula, SYMBOLS))) == wanted


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
    assert exact(reader.mathml(substituted(MATHML, formula, numbers)), **values) == wanted


@traps([("-12.5", "mm")] * 10, [("1.2e-05", "10⁻⁶/K")] * 10)
@given(expressions(), st.lists(st.tuples(st.sampled_from(SHOWN), st.sampled_from(["", *UNITS])), min_size=len(NAMES)))
@settings(max_examples=40, deadline=None)
def test_word_shows_what_mathml_shows(text: str, shown: list[tuple[str, str]]) -> None:
    formula, numbers = parse(text), dict(zip(NAMES, shown, strict=False))
    assert shown_by_omml(symbolic(OMML, formula, SYMBOLS)) == shown_by_mathml(symbolic(MATHML, formula, SYMBOLS))
    mathml, omml = (substituted(writer, formula, numbers) for writer in (MATHML, OMML))
    assert shown_by_omml(omml) == shown_by_mathml(mathml)


# A formula on one line of a terminal: the parentheses that a bar, a root and a raised number save must be written.


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("load / (rate * width)", "F / (k_R · width)"),
        ("load / rate * width", "(F / k_R) · width"),
        ("(load + rate) / width / angle", "(F + k_R) / (width · θ_11)"),
        ("load / (rate / width)", "F / (k_R / width)"),
        ("load - (rate - width)", "F − (k_R − width)"),
        ("sqrt(load**2 + rate**2)", "√(F² + k_R²)"),
        ("-cbrt(way)**2 * -log10(load)", "−(∛(Δz))² · (−log10(F))"),
        ("-(load + rate) * (-width)**2", "−(F + k_R) · (−width)²"),
        ("early**2 * teeth", "h_0² · z_2′"),
        ("-teeth**2 / pi", "−(z_2′)² / π"),
        ("load**rate**2 + load**-rate", "F^k_R² + F^(−k_R)"),
        ("(load**rate)**2 - load**(rate / width)", "(F^k_R)² − F^(k_R / width)"),
        ("(load / rate)**2 * (load - 1e-3)", "(F / k_R)² · (F − 1·10⁻³)"),
        ("sin(load)**2 * cos(rate * width)", "sin²(F) · cos(k_R · width)"),
        ("abs(abs(load) - early) * abs(width)", "abs(|F| − h_0) · |width|"),
        ("max(load, rate)**2", "(max(F, k_R))²"),
        ("cases(load, rate < 2, width)", "{ F if k_R < 2; width otherwise }"),
        ("either(load, rate) - width", "({ F if given; k_R otherwise }) − width"),
        (
            "cases(load, (rate < 1 or rate >= 2) and width != 3, rate, width == 1, 2)",
            "{ F if (k_R < 1 or k_R ≥ 2) and width ≠ 3; k_R if width = 1; 2 otherwise }",
        ),
        ("inv(load) == rate + width", "inv(F) = k_R + width"),
    ],
)
def test_a_line_looks_as_it_should(text: str, line: str) -> None:
    assert symbolic(TEXT, parse(text), SYMBOLS) == line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("load**2 - early / angle", "(−12.5 mm)² − 1.2·10⁻⁵ / 30°"),
        ("(load - way)**2 / way", "(−12.5 mm − 2 N/mm)² / (2 N/mm)"),
        ("load * -early + way * -load", "−12.5 mm · (−1.2·10⁻⁵) + 2 N/mm · (−(−12.5 mm))"),
        ("load / way / angle", "−12.5 mm / (2 N/mm · 30°)"),
    ],
)
def test_a_line_of_numbers_looks_as_it_should(text: str, line: str) -> None:
    numbers = {"load": ("-12.5", "mm"), "early": ("1.2e-05", ""), "angle": ("30", "°"), "way": ("2", "N/mm")}
    assert substituted(TEXT, parse(text), numbers).replace(HOLD, " ") == line


def test_a_long_line_is_broken_before_signs_and_never_between_number_and_unit() -> None:
    numbers = dict.fromkeys(NAMES, ("123.45", "N/mm"))
    line = substituted(TEXT, parse(" + ".join(f"2 * {name}" for name in NAMES)), numbers)
    lines = list(folded(line, 30))
    assert " ".join(lines) == line
    assert max(map(len, lines)) <= 30
    assert all(part.startswith(("+", "·")) for part in lines[1:])
    assert all(part.count("123.45") == part.count(f"123.45{HOLD}N/mm") for part in lines)
