"""Writing MathML Core: what every current browser sets without a script."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Final

from truing.formulas.layout import Writer
from truing.formulas.symbols import printable, read_number, read_symbol

THIN_GAP: Final = '<mspace width="0.1667em"></mspace>'
SIGNS: Final = {
    "+": "<mo>+</mo>", "-": "<mo>−</mo>", "dot": "<mo>⋅</mo>", "gap": f"<mo>\N{INVISIBLE TIMES}</mo>{THIN_GAP}",
    ",": "<mo>,</mo>", "==": "<mo>=</mo>", "!=": "<mo>≠</mo>", "<": "<mo>&lt;</mo>", "<=": "<mo>≤</mo>",
    ">": "<mo>&gt;</mo>", ">=": "<mo>≥</mo>", "and": f"<mtext>{chr(0xA0)}and{chr(0xA0)}</mtext>",
    "or": f"<mtext>{chr(0xA0)}or{chr(0xA0)}</mtext>",
}  # fmt: skip
WITHOUT_SPACE: Final = frozenset("°'′\"″")
"""Units that follow their number closely."""


def row(*parts: str) -> str:
    """Group elements into one."""
    return f"<mrow>{''.join(parts)}</mrow>"


def number_mathml(text: str) -> str:
    """Write a formatted number as MathML: "1.2e-05" as 1.2 × 10⁻⁵; what is no number is printed as text."""
    number = read_number(text)
    if number is None:
        return f"<mtext>{escape(printable(text))}</mtext>"
    parts = [_unsigned(number.digits, number.negative)]
    if number.exponent:
        exponent = _unsigned(number.exponent.removeprefix("−"), number.exponent.startswith("−"))
        parts += ["<mo>×</mo>", f"<msup><mn>10</mn>{exponent}</msup>"]
    return parts[0] if len(parts) == 1 else row(*parts)


def _unsigned(digits: str, negative: bool) -> str:
    number = f"<mn>{escape(digits)}</mn>"
    return row('<mo form="prefix">−</mo>', number) if negative else number


def _piece(run: str) -> str:
    """Write digits, a comma, a letter in italics, or upright letters."""
    text = escape(run)
    if run.isascii() and run.isdigit():
        return f"<mn>{text}</mn>"
    if run == ",":
        return '<mo separator="true">,</mo>'
    return f"<mi>{text}</mi>" if len(run) == 1 and run.isalpha() else upright_mathml(text)


def upright_mathml(text: str) -> str:
    """Write upright letters, and say that they are: style sheets slant the others in a font that every machine has."""
    return f'<mi mathvariant="normal">{text}</mi>'


def _grouped(runs: Sequence[str]) -> str:
    parts = [_piece(run) for run in runs]
    return parts[0] if len(parts) == 1 else row(*parts)


def symbol_mathml(text: str, exponent: str | None = None) -> str:
    """Write a declared symbol ("theta_11", "Delta z", "F_N,max", "z_2'") as MathML; any text is safe.

    A subscript and an exponent stand above each other.
    """
    symbol = read_symbol(text)
    *before, last = symbol.base
    core = _piece(last)
    raised = exponent or (f"<mo>{'′' * symbol.primes}</mo>" if symbol.primes else "")
    if symbol.subscript and raised:
        core = f"<msubsup>{core}{_grouped(symbol.subscript)}{raised}</msubsup>"
    elif symbol.subscript:
        core = f"<msub>{core}{_grouped(symbol.subscript)}</msub>"
    elif raised:
        core = f"<msup>{core}{raised}</msup>"
    if not before:
        return core
    first = upright_mathml(before[0]) if symbol.is_difference else _piece(before[0])
    return row(first, *map(_piece, before[1:]), core)


def _word(name: str) -> str:
    return f"<mtext>{escape(printable(name.replace('_', ' ')))}</mtext>"


def _quantity(number: str, unit: str) -> str:
    """Write a number, a thin space and an upright unit."""
    unit = printable(unit)
    if not unit:
        return number_mathml(number)
    gap = "<mo>×</mo>" if unit[0].isdigit() else "" if unit in WITHOUT_SPACE else THIN_GAP
    return row(number_mathml(number), gap, f"<mtext>{escape(unit)}</mtext>")


def _infix(left: str, sign: str, right: str) -> str:
    return row(left, SIGNS[sign], right)


def _function(name: str, exponent: str | None) -> str:
    if name == "∑":
        return '<mo largeop="true">∑</mo>'
    if name == "log10":
        return f"<msub>{upright_mathml('log')}<mn>10</mn></msub>"
    upright = upright_mathml(name)
    return upright if exponent is None else f"<msup>{upright}{exponent}</msup>"


def _table(rows: Sequence[tuple[str, str]]) -> str:
    cell = '<mtd style="text-align: left; padding: 0.2em 0.5em 0.2em 0">'
    body = "".join(f"<mtr>{cell}{value}</mtd>{cell}{condition}</mtd></mtr>" for value, condition in rows)
    return row('<mo form="prefix" stretchy="true">{</mo>', f'<mtable displaystyle="true">{body}</mtable>')


MATHML: Final = Writer(
    opening="<mrow></mrow>",
    symbol=symbol_mathml,
    word=_word,
    quantity=_quantity,
    pi=upright_mathml("π"),
    minus='<mrow><mo form="prefix">−</mo>{}</mrow>'.format,
    infix=_infix,
    parenthesised='<mrow><mo form="prefix">(</mo>{}<mo form="postfix">)</mo></mrow>'.format,
    bars='<mrow><mo form="prefix" stretchy="true">|</mo>{}<mo form="postfix" stretchy="true">|</mo></mrow>'.format,
    fraction="<mfrac>{}{}</mfrac>".format,
    power="<msup>{}{}</msup>".format,
    sqrt="<msqrt>{}</msqrt>".format,
    cbrt="<mroot>{}<mn>3</mn></mroot>".format,
    function=_function,
    applied="<mrow>{}<mo>\N{FUNCTION APPLICATION}</mo>{}</mrow>".format,
    applied_bare=f"<mrow>{{}}<mo>\N{FUNCTION APPLICATION}</mo>{THIN_GAP}{{}}</mrow>".format,
    table=_table,
    condition=f"<mrow><mtext>if{chr(0xA0)}</mtext>{{}}</mrow>".format,
    prose="<mtext>{}</mtext>".format,
)
