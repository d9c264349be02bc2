"""Writing OMML, the mathematics of Word documents: formulas that Word sets, and that can be edited there.

Every mark of a ``Writer`` is written here by elements of ECMA-376, part 1, chapter 22.1; a prefix ``m`` or ``w`` is
bound by what the markup is put into.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Final

from truing.formulas.layout import Writer
from truing.formulas.symbols import printable, read_number, read_symbol
from truing.formulas.write_mathml import WITHOUT_SPACE

_FONT: Final = '<w:rPr><w:rFonts w:ascii="Cambria Math" w:hAnsi="Cambria Math"/></w:rPr>'
_STYLES: Final = {"italic": "", "upright": '<m:rPr><m:sty m:val="p"/></m:rPr>', "words": "<m:rPr><m:nor/></m:rPr>"}


def run(text: str, style: str = "upright") -> str:
    """Write characters: letters of a symbol in "italic", numbers, signs and functions "upright", or plain "words"."""
    return f'<m:r>{_STYLES[style]}{_FONT}<m:t xml:space="preserve">{escape(text)}</m:t></m:r>'


THIN_GAP: Final = run("\N{THIN SPACE}")
SIGNS: Final = {
    "+": run("+"), "-": run("−"), "dot": run("⋅"), "gap": THIN_GAP, ",": run(",") + THIN_GAP, "==": run("="),
    "!=": run("≠"), "<": run("<"), "<=": run("≤"), ">": run(">"), ">=": run("≥"),
    "and": run("\u00a0and\u00a0", "words"), "or": run("\u00a0or\u00a0", "words"),
}  # fmt: skip


def number_omml(text: str) -> str:
    """Write a formatted number: "1.2e-05" as 1.2 × 10⁻⁵; what is no number as words."""
    number = read_number(text)
    if number is None:
        return run(printable(text), "words")
    mantissa = run(f"{'−' if number.negative else ''}{number.digits}")
    return mantissa + run("×") + _power(run("10"), run(number.exponent)) if number.exponent else mantissa


def _piece(letters: str) -> str:
    """Write a letter in italics, digits and a comma upright; what else there is as words, so that no * multiplies."""
    if len(letters) == 1 and letters.isalpha():
        return run(letters, "italic")
    return run(letters, "upright" if letters == "," or letters.isdigit() else "words")


def symbol_omml(text: str, exponent: str | None = None) -> str:
    """Write a declared symbol ("theta_11", "Delta z", "F_N,max", "z_2'"); any text is safe.

    A subscript and an exponent stand above each other.
    """
    symbol = read_symbol(text)
    *before, last = symbol.base
    core, below = _piece(last), "".join(map(_piece, symbol.subscript))
    raised = exponent or (run("′" * symbol.primes) if symbol.primes else "")
    if below and raised:
        core = f"<m:sSubSup><m:e>{core}</m:e><m:sub>{below}</m:sub><m:sup>{raised}</m:sup></m:sSubSup>"
    elif below:
        core = f"<m:sSub><m:e>{core}</m:e><m:sub>{below}</m:sub></m:sSub>"
    elif raised:
        core = _power(core, raised)
    if not before:
        return core
    first = run(before[0]) if symbol.is_difference else _piece(before[0])
    return first + "".join(map(_piece, before[1:])) + core


def _power(base: str, exponent: str) -> str:
    return f"<m:sSup><m:e>{base}</m:e><m:sup>{exponent}</m:sup></m:sSup>"


def _word(name: str) -> str:
    return run(printable(name.replace("_", " ")), "words")


def _quantity(number: str, unit: str) -> str:
    """Write a number, a thin space and an upright unit."""
    unit = printable(unit)
    if not unit:
        return number_omml(number)
    gap = run("×") if unit[0].isdigit() else "" if unit in WITHOUT_SPACE else THIN_GAP
    return number_omml(number) + gap + run(unit, "words")


def _infix(left: str, sign: str, right: str) -> str:
    return f"{left}{SIGNS[sign]}{right}"


def _enclosed(content: str, begin: str, end: str) -> str:
    ends = f'<m:begChr m:val="{begin}"/><m:endChr m:val="{end}"/>'
    return f"<m:d><m:dPr>{ends}</m:dPr><m:e>{content}</m:e></m:d>"


def _function(name: str, exponent: str | None) -> str:
    if name == "log10":
        return f"<m:sSub><m:e>{run('log')}</m:e><m:sub>{run('10')}</m:sub></m:sSub>"
    return run(name) if exponent is None else _power(run(name), exponent)


def _table(rows: Sequence[tuple[str, str]]) -> str:
    columns = '<m:mc><m:mcPr><m:count m:val="2"/><m:mcJc m:val="left"/></m:mcPr></m:mc>'
    body = "".join(f"<m:mr><m:e>{value}</m:e><m:e>{condition}</m:e></m:mr>" for value, condition in rows)
    return _enclosed(f"<m:m><m:mPr><m:mcs>{columns}</m:mcs></m:mPr>{body}</m:m>", "{", "")


def _prose(text: str) -> str:
    return run(text, "words")


OMML: Final = Writer(
    opening=run("\N{ZERO WIDTH SPACE}", "words"),
    symbol=symbol_omml,
    word=_word,
    quantity=_quantity,
    pi=run("π"),
    minus=f"{run('−')}{{}}".format,
    infix=_infix,
    parenthesised=lambda content: _enclosed(content, "(", ")"),
    bars=lambda content: _enclosed(content, "|", "|"),
    fraction="<m:f><m:num>{}</m:num><m:den>{}</m:den></m:f>".format,
    power=_power,
    sqrt='<m:rad><m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/><m:e>{}</m:e></m:rad>'.format,
    cbrt=f"<m:rad><m:deg>{run('3')}</m:deg><m:e>{{}}</m:e></m:rad>".format,
    function=_function,
    applied="<m:func><m:fName>{}</m:fName><m:e>{}</m:e></m:func>".format,
    applied_bare="<m:func><m:fName>{}</m:fName><m:e>{}</m:e></m:func>".format,
    table=_table,
    condition=f"{run('if' + chr(0xA0), 'words')}{{}}".format,
    prose=_prose,
)
