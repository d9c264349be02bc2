"""Writing a formula on one line of plain characters, for a terminal: ``F = T / (K · d)``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from truing.formulas.layout import Writer
from truing.formulas.symbols import printable, read_number, symbol_text

SIGNS: Final = {
    "+": " + ", "-": " − ", "dot": " · ", "gap": " · ", ",": ", ", "==": " = ", "!=": " ≠ ", "<": " < ", "<=": " ≤ ",
    ">": " > ", ">=": " ≥ ", "and": " and ", "or": " or ",
}  # fmt: skip
RAISED: Final = str.maketrans("0123456789-−", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁻")
CLOSE: Final = frozenset("°'′\"″")
HOLD: Final = "\u00a0"
"""Between a number and its unit: no line is broken there."""
OPENING, CLOSING = "([{", ")]}"


def open_text(text: str) -> str:
    """Return the text outside of all parentheses and bars."""
    kept, depth, bars = [], 0, 0
    for character in text:
        depth += character in OPENING
        if not depth and not bars:
            kept.append(character)
        bars = 1 - bars if character == "|" and not depth else bars
        depth -= character in CLOSING
    return "".join(kept)


def _is_one(text: str) -> bool:
    """Tell whether a text holds together without parentheses: no sign and no unit outside of its own."""
    return not any(mark in open_text(text) for mark in (" ", HOLD, "/"))


def _symbol(text: str, exponent: str | None) -> str:
    """Write a symbol; an exponent stands behind the subscript."""
    return symbol_text(text) + ("" if exponent is None else _raised(exponent))


def _quantity(number: str, unit: str) -> str:
    plain, unit = _number(number), printable(unit)
    return f"{plain}{'' if not unit or unit in CLOSE else HOLD}{unit}"


def _infix(left: str, sign: str, right: str) -> str:
    """Join two sides by a sign; a fraction in a product is set in parentheses."""
    if sign in {"dot", "gap"}:
        left, right = (f"({side})" if " / " in open_text(side) else side for side in (left, right))
    return f"{left}{SIGNS[sign]}{right}"


def _parenthesised(inner: str) -> str:
    """Put round parentheses, but not around one pair that holds the whole text."""
    is_closed = inner.startswith("(") and inner.endswith(")") and not open_text(inner)
    return inner if is_closed else f"({inner})"


def _bars(inner: str) -> str:
    """Put the bars of an absolute value; around others nobody could tell which is which."""
    return f"abs({inner})" if "|" in inner else f"|{inner}|"


def _fraction(above: str, below: str) -> str:
    """Write a fraction with a slash; what its bar would group gets parentheses."""
    outside = open_text(above)
    grouped = any(mark in outside for mark in (" + ", " − ", " / ", "/"))
    return f"{f'({above})' if grouped else above} / {below if _is_one(below) else f'({below})'}"


def _power(base: str, exponent: str) -> str:
    return (base if _is_one(base) else f"({base})") + _raised(exponent)


def _function(name: str, exponent: str | None) -> str:
    return name + ("" if exponent is None else _raised(exponent))


def _table(rows: Sequence[tuple[str, str]]) -> str:
    """Write alternatives in braces, one behind the other."""
    return f"{{ {'; '.join(f'{value} {condition}' for value, condition in rows)} }}"


def _raised(exponent: str) -> str:
    """Write an exponent: a raised number, or a caret."""
    if exponent.lstrip("−-").isdecimal() and exponent.isprintable():
        return exponent.translate(RAISED)
    alone = _is_one(exponent) and "^" not in open_text(exponent) and exponent[:1] != "−"
    return f"^{exponent if alone else f'({exponent})'}"


def _number(text: str) -> str:
    """Write a number: 1.2e-05 as 1.2·10⁻⁵."""
    number = read_number(text)
    if number is None:
        return printable(text)
    power = f"·10{number.exponent.translate(RAISED)}" if number.exponent else ""
    return f"{'−' if number.negative else ''}{number.digits}{power}"


TEXT: Final = Writer(
    symbol=_symbol,
    word=printable,
    quantity=_quantity,
    pi="π",
    minus="−{}".format,
    infix=_infix,
    parenthesised=_parenthesised,
    bars=_bars,
    fraction=_fraction,
    power=_power,
    sqrt="√({})".format,
    cbrt="∛({})".format,
    function=_function,
    applied="{}{}".format,
    applied_bare="{}({})".format,
    table=_table,
    condition="if {}".format,
    prose="{}".format,
)


def folded(text: str, width: int) -> Iterator[str]:
    """Give the lines of a formula that is no wider than ``width``; broken in front of a sign where there is one."""
    words = text.split(" ")
    line = words[0]
    for index, word in enumerate(words[1:], start=1):
        following = words[index + 1] if index + 1 < len(words) and _is_sign(word) else ""
        if len(line) + 1 + len(word) + (1 + len(following) if following else 0) > width and not _is_sign(
            words[index - 1]
        ):
            yield line
            line = word
        else:
            line = f"{line} {word}"
    yield line


def _is_sign(word: str) -> bool:
    return f" {word} " in SIGNS.values() or word == "/"
