"""A formula on one line of a terminal is the computed one: it is read back by the rules of plain text, and compared."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_formula_printing import NAMES, SEEN, SHOWN, SYMBOLS, exact, expressions, number, traps

from truing.formulas import parse
from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_text import HOLD, TEXT, folded

SPELLED = {"ln": "log", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "sgn": "sign", "∑": "sum", "√": "sqrt"}
SPELLED |= {"∛": "cbrt"}
SIGNS = {" · ": " * ", "−": "-", "^": "**", "≤": "<=", "≥": ">=", "≠": "!=", " = ": " == ", "π": "pi"}
LOWERED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
UNITS = ["N·m", "mm", "GPa", "%", "N/mm", "°"]


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
@given(expressions(), st.lists(st.tuples(st.sampled_from(SHOWN), st.sampled_from(["", *UNITS])), min_size=len(NAMES)))
@settings(max_examples=15, deadline=None)
def test_a_line_of_numbers_reads_back_exactly(text: str, shown: list[tuple[str, str]]) -> None:
    numbers = dict(zip(NAMES, shown, strict=False))
    values: dict[str, Any] = {name: number(shown) for name, (shown, _) in numbers.items()}
    values["either"] = lambda first, second: first
    line = substituted(TEXT, parse(text), numbers)
    bare = re.sub(f"{HOLD}(?:{'|'.join(map(re.escape, UNITS))})(?![a-z])|°", "", line)
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
