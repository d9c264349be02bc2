"""Writing LaTeX for the mathematics in Markdown: the subset that LaTeX, MathJax and KaTeX share."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from truing.formulas.layout import Writer
from truing.formulas.symbols import GREEK, printable, read_number, read_symbol

SIGNS: Final = {
    "+": " + ", "-": " - ", "dot": r" \cdot ", "gap": r" \thinspace ", ",": r",\thinspace ", "==": " = ",
    "!=": r" \ne ", "<": r" \lt ", "<=": r" \le ", ">": r" \gt ", ">=": r" \ge ", "and": r"\ \mathrm{and}\ ",
    "or": r"\ \mathrm{or}\ ",
}  # fmt: skip
_LOOK_LATIN: Final = "οΑΒΕΖΗΙΚΜΝΟΡΤΧ"
LETTERS: Final = {
    **{letter: f"\\{name}" for name, letter in GREEK.items()},
    "ε": r"\varepsilon",
    "φ": r"\varphi",
    **dict(zip(_LOOK_LATIN, "oABEZHIKMNOPTX", strict=True)),
}
"""Greek letters; those that look Latin have no command of their own."""
SUPERSCRIPTS: Final = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+", strict=True))
_NAMED: Final = {
    "{": "lbrace", "}": "rbrace", "[": "lbrack", "]": "rbrack", "|": "vert", "<": "lt", ">": "gt", "µ": "mu",
}  # fmt: skip
_GROUPED: Final = {
    "\\": r"\backslash", "^": r"\wedge", "~": r"\sim", "*": r"\ast", "`": "'", "'": "'", "′": "'", '"': "''", "″": "''",
    "·": r"\cdot", "⋅": r"\cdot", "×": r"\times", "±": r"\pm", "°": r"^{\circ}",
}  # fmt: skip
ESCAPES: Final = {
    **{character: rf"\{name}{{}}" for character, name in _NAMED.items()},
    **{character: f"{{{marks}}}" for character, marks in _GROUPED.items()},
    " ": r"\ ",
    "−": "-",
    "–": r"\text{–}",
    **{character: f"\\{character}" for character in "$#%&_"},
    **{letter: f"{command}{{}}" for letter, command in LETTERS.items()},
}
"""How each character is written inside upright text: safe for LaTeX, Markdown tables and HTML alike."""
FUNCTIONS: Final = {
    name: f"\\{name}"
    for name in ("sin", "cos", "tan", "cot", "sinh", "cosh", "tanh", "arcsin", "arccos", "arctan", "ln", "exp")
}
WITHOUT_SPACE: Final = frozenset("°'′\"″")


def escaped(text: str) -> str:
    """Write any text so that it can stand inside ``\\mathrm{}``."""
    return re.sub(f"[{''.join(SUPERSCRIPTS)}]+|.", _character, printable(text))


def _character(match: re.Match[str]) -> str:
    character = match.group()
    if character[0] in SUPERSCRIPTS:
        return f"^{{{''.join(SUPERSCRIPTS[digit] for digit in character)}}}"
    return ESCAPES.get(character, character)


def upright(text: str) -> str:
    """Write any text upright."""
    return rf"\mathrm{{{escaped(text)}}}"


def upright_unit(unit: str) -> str:
    """Write a unit text upright; here "^" raises, as in mm^0.5."""
    parts = re.split(r"\^(-?\d+(?:\.\d+)?|\([-\d/]+\))", printable(unit), flags=re.ASCII)
    raised = [f"^{{{part}}}" if index % 2 else escaped(part) for index, part in enumerate(parts)]
    written = re.sub(r"(\^{[^{}]*})(?=\^)", r"\1{}", "".join(raised))  # LaTeX refuses a power of a power
    return rf"\mathrm{{{written}}}"


def number_latex(text: str) -> str:
    """Write a formatted number as LaTeX: "1.2e-05" as 1.2 times a power of ten; what is no number as text."""
    number = read_number(text)
    if number is None:
        return upright(text)
    digits = re.sub(r"[^\d.,]", r"\\thinspace ", number.digits).replace(",", "{,}")
    power = rf" \times 10^{{{number.exponent.replace('−', '-')}}}" if number.exponent else ""
    return f"{'-' if number.negative else ''}{digits}{power}"


def _piece(run: str) -> str:
    """Write digits, a comma, a letter in italics, or upright letters."""
    if run == "," or (run.isascii() and run.isdigit()):
        return run
    if run in LETTERS:
        letter = LETTERS[run]
        return letter if letter.startswith("\\") else rf"\mathrm{{{letter}}}"
    if len(run) == 1 and run.isalpha():
        return ESCAPES.get(run, run)
    return upright(run)


def _grouped(runs: Sequence[str]) -> str:
    return " ".join(map(_piece, runs)).replace(" , ", ",")


def symbol_latex(text: str, exponent: str | None = None) -> str:
    """Write a declared symbol as LaTeX: base, subscript, primes and exponent."""
    symbol = read_symbol(text)
    subscript = f"_{{{_grouped(symbol.subscript)}}}" if symbol.subscript else ""
    raised = exponent or r"\prime " * symbol.primes
    superscript = f"^{{{raised.strip()}}}" if raised else ""
    return " ".join(map(_piece, symbol.base)) + subscript + superscript


def _word(name: str) -> str:
    return upright(printable(name.replace("_", " ")))


def _quantity(number: str, unit: str) -> str:
    """Write a number, a thin space and an upright unit."""
    unit = printable(unit)
    if not unit:
        return number_latex(number)
    gap = r" \times " if unit[0].isdigit() else "" if unit in WITHOUT_SPACE else r"\thinspace "
    return f"{number_latex(number)}{gap}{upright_unit(unit)}"


def _infix(left: str, sign: str, right: str) -> str:
    return f"{left}{SIGNS[sign]}{right}"


def _function(name: str, exponent: str | None) -> str:
    if name in ("∑", "Φ"):
        return r"\sum" if name == "∑" else r"\Phi"
    if name == "log10":
        return r"\log_{10}"
    head = FUNCTIONS.get(name, rf"\mathrm{{{name}}}")
    return head if exponent is None else f"{head}^{{{exponent}}}"


def _applied_bare(function: str, argument: str) -> str:
    gap = r"\thinspace " if function.startswith(r"\mathrm") else " "
    return f"{function}{gap}{argument}"


def _table(rows: Sequence[tuple[str, str]]) -> str:
    body = r" \cr ".join(f"{value} & {condition}" for value, condition in rows)
    return rf"\begin{{cases}} {body} \end{{cases}}"


LATEX: Final = Writer(
    opening="{}",
    symbol=symbol_latex,
    word=_word,
    quantity=_quantity,
    pi=r"\pi",
    minus="-{}".format,
    infix=_infix,
    parenthesised=r"\left( {} \right)".format,
    bars=r"\left\vert {} \right\vert".format,
    fraction=r"\frac{{{}}}{{{}}}".format,
    power="{}^{{{}}}".format,
    sqrt=r"\sqrt{{{}}}".format,
    cbrt=r"\sqrt[3]{{{}}}".format,
    function=_function,
    applied="{} {}".format,
    applied_bare=_applied_bare,
    table=_table,
    condition=r"\mathrm{{if}}\ {}".format,
    prose=upright,
)
"""No command made of one punctuation mark stands in it (except in escapes): Markdown takes their backslash away."""
