"""Writing MathML Core: what every current browser sets without a script."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Final

from truing.formulas.symbols import LetterRun, Style, printable, read_number, read_symbol, word_text

THIN_GAP: Final = '<mspace width="0.1667em"></mspace>'
SIGNS: Final = {
    "+": "<mo>+</mo>",
    "-": "<mo>−</mo>",
    "dot": "<mo>⋅</mo>",
    "gap": f"<mo>\N{INVISIBLE TIMES}</mo>{THIN_GAP}",
    ",": "<mo>,</mo>",
    "==": "<mo>=</mo>",
    "!=": "<mo>≠</mo>",
    "<": "<mo>&lt;</mo>",
    "<=": "<mo>≤</mo>",
    ">": "<mo>&gt;</mo>",
    ">=": "<mo>≥</mo>",
    "and": f"<mtext>{chr(0xA0)}and{chr(0xA0)}</mtext>",
    "or": f"<mtext>{chr(0xA0)}or{chr(0xA0)}</mtext>",
}
WITHOUT_SPACE: Final = frozenset("°'′\"″")
"""Units that follow their number closely."""


def row(*parts: str) -> str:
    """Group elements into one."""
    return f"<mrow>{''.join(parts)}</mrow>"


def symbol_mathml(symbol: str) -> str:
    """Write a declared symbol ("theta_11", "Delta z", "F_N,max", "z_2'") as MathML; any text is safe."""
    return MathMLWriter().symbol(symbol)


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


def _piece(piece: LetterRun) -> str:
    text = escape(piece.text)
    if piece.style is Style.DIGITS:
        return f"<mn>{text}</mn>"
    if piece.text == ",":
        return '<mo separator="true">,</mo>'
    is_upright = len(piece.text) > 1 or piece.style is Style.UPRIGHT
    return upright_mathml(text) if is_upright else f"<mi>{text}</mi>"


def upright_mathml(text: str) -> str:
    """Write upright letters, and say that they are: style sheets slant the others in a font that every machine has."""
    return f'<mi mathvariant="normal">{text}</mi>'


def _grouped(pieces: Sequence[LetterRun]) -> str:
    parts = [_piece(piece) for piece in pieces]
    return parts[0] if len(parts) == 1 else row(*parts)


class MathMLWriter:
    """The marks of MathML Core; see ``layout.Writer``."""

    def symbol(self, text: str, exponent: str | None = None) -> str:
        """Write base, subscript, primes and exponent; a subscript and an exponent stand above each other."""
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
        return row(*map(_piece, before), core) if before else core

    def word(self, name: str) -> str:
        """Write a name as an upright word."""
        return f"<mtext>{escape(word_text(name))}</mtext>"

    def quantity(self, number: str, unit: str) -> str:
        """Write a number, a thin space and an upright unit."""
        unit = printable(unit)
        if not unit:
            return number_mathml(number)
        gap = "<mo>×</mo>" if unit[0].isdigit() else "" if unit in WITHOUT_SPACE else THIN_GAP
        return row(number_mathml(number), gap, f"<mtext>{escape(unit)}</mtext>")

    def constant(self, name: str) -> str:
        """Write pi upright, as a constant."""
        return upright_mathml("π")

    def minus(self, operand: str) -> str:
        """Write minus the operand."""
        return row('<mo form="prefix">−</mo>', operand)

    def infix(self, left: str, sign: str, right: str) -> str:
        """Join two sides by a sign."""
        return row(left, SIGNS[sign], right)

    def parenthesised(self, inner: str) -> str:
        """Put parentheses that stretch."""
        return row('<mo form="prefix">(</mo>', inner, '<mo form="postfix">)</mo>')

    def bars(self, inner: str) -> str:
        """Put bars that stretch."""
        return row('<mo form="prefix" stretchy="true">|</mo>', inner, '<mo form="postfix" stretchy="true">|</mo>')

    def fraction(self, above: str, below: str) -> str:
        """Write a fraction."""
        return f"<mfrac>{above}{below}</mfrac>"

    def power(self, base: str, exponent: str) -> str:
        """Write a power."""
        return f"<msup>{base}{exponent}</msup>"

    def root(self, inner: str, index: str) -> str:
        """Write a root."""
        return f"<mroot>{inner}<mn>{index}</mn></mroot>" if index else f"<msqrt>{inner}</msqrt>"

    def function(self, name: str, exponent: str | None = None) -> str:
        """Write the upright name of a function."""
        if name == "∑":
            return '<mo largeop="true">∑</mo>'
        if name == "log10":
            return f"<msub>{upright_mathml('log')}<mn>10</mn></msub>"
        upright = upright_mathml(name)
        return upright if exponent is None else f"<msup>{upright}{exponent}</msup>"

    def applied(self, function: str, argument: str, *, bare: bool) -> str:
        """Join a function and its argument."""
        return row(function, "<mo>\N{FUNCTION APPLICATION}</mo>", THIN_GAP if bare else "", argument)

    def table(self, rows: Sequence[tuple[str, str]]) -> str:
        """Write alternatives behind a stretching brace."""
        cell = '<mtd style="text-align: left; padding: 0.2em 0.5em 0.2em 0">'
        body = "".join(f"<mtr>{cell}{value}</mtd>{cell}{condition}</mtd></mtr>" for value, condition in rows)
        return row('<mo form="prefix" stretchy="true">{</mo>', f'<mtable displaystyle="true">{body}</mtable>')

    def condition(self, inner: str) -> str:
        """Write "if" before a condition."""
        return row(f"<mtext>if{chr(0xA0)}</mtext>", inner)

    def prose(self, text: str) -> str:
        """Write plain words."""
        return f"<mtext>{escape(text)}</mtext>"
